// SPDX-License-Identifier: GPL-3.0-or-later
// `scree profile`: what is written for quarry_a, the three modes, and what is said about bad input.
#include "cli/program.hpp"
#include "cli/results.hpp"
#include "gis/input_files.hpp"
#include "support/paths.hpp"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>

namespace scree::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;
namespace fs = std::filesystem;

const std::string kQuarry = (quarry_a() / "site.toml").string();
constexpr double kModelAgainstDtm = 1.2;  // [m] the model of 1 m departs from the DTM by up to 1.11 m, on the rock cuts

Outcome profile(const fs::path& output, const std::vector<std::string>& changes = {}) {
    std::vector<std::string> args{"profile", kQuarry, "--output", output.string()};
    for (const std::string& change : changes) {
        args.emplace_back("--set");
        args.push_back(change);
    }
    return scree_program(args);
}

/// One vertex of profiles.csv.
struct Row {
    int profile = 0;
    double s = 0.0, x = 0.0, y = 0.0, z = 0.0;  // map frame [m]
    std::string soil, course;
};
std::vector<Row> rows_of(const fs::path& folder) {
    std::istringstream in(text_of(folder / "profiles.csv"));
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, "profile,s_m,easting_m,northing_m,height_m,soil,course");
    std::vector<Row> rows;
    while (std::getline(in, line)) {
        std::istringstream fields(line);
        std::vector<std::string> f(7);
        for (std::string& field : f) std::getline(fields, field, ',');
        rows.push_back(
            {std::stoi(f[0]), std::stod(f[1]), std::stod(f[2]), std::stod(f[3]), std::stod(f[4]), f[5], f[6]});
    }
    return rows;
}

/// A guide across quarry_a: down its axis, then to the north on the platform.
fs::path write_guide(const TempDir& folder, const std::string& wkt) {
    const fs::path file = folder / "guide.gpkg";
    write_vector(file.string(), {.layer = "guide", .rows = {{wkt, "a", {}}}});
    return file;
}
const char* const kGuide = "LINESTRING (890020 6670045, 890080 6670038, 890100 6670060)";

TEST(ProfileCommand, WritesLayersTableAndPictures) {
    const TempDir folder;
    const fs::path out = folder / "out";
    const Outcome made = profile(out);
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("ends at the rim of the terrain (rim)"));
    EXPECT_THAT(made.out, HasSubstr("screen ES2-A at s = "));
    const fs::path gpkg = out / "results.gpkg";
    EXPECT_THAT(fields_of(gpkg, "profiles"), IsSupersetOf({"profile", "end_reason", "length_m", "start_s_m", "fall_m",
                                                           "straight_m", "joins_profile", "soil"}));
    EXPECT_THAT(fields_of(gpkg, "profile_reaches"),
                IsSupersetOf({"profile", "soil", "course", "from_s_m", "to_s_m", "fall_m", "slope_deg"}));
    for (const char* layer : {"profiles", "profile_reaches", "profile_starts", "screens"})
        EXPECT_EQ(crs_code_of(gpkg, layer), "2154") << layer;
    for (const char* file : {"results.qgs", "profiles.csv", "profiles.svg", "profile_1.svg"})
        EXPECT_TRUE(fs::exists(out / file)) << file;
    EXPECT_THAT(text_of(out / "profile_1.svg"), HasSubstr("loose waste"));

    const GDALDatasetUniquePtr data(GDALDataset::Open(gpkg.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
    OGRLayer* lines = data->GetLayerByName("profiles");
    EXPECT_EQ(lines->GetGeomType(), wkbLineString25D);
    EXPECT_EQ(lines->GetFeatureCount(), 1);
    // the stretches by soil make up the profile
    double from = 0.0;
    std::set<std::string> soils;
    for (const auto& feature : *data->GetLayerByName("profile_reaches")) {
        EXPECT_NEAR(feature->GetFieldAsDouble("from_s_m"), from, 1e-9);
        from = feature->GetFieldAsDouble("to_s_m");
        soils.insert(feature->GetFieldAsString("soil"));
    }
    const OGRFeatureUniquePtr whole(lines->GetNextFeature());
    EXPECT_NEAR(from, whole->GetFieldAsDouble("length_m"), 1e-9);
    EXPECT_NEAR(whole->GetGeometryRef()->toLineString()->get_Length(), from, 1e-6);
    EXPECT_EQ(soils, (std::set<std::string>{"loose waste", "compact waste"}));
}

TEST(ProfileCommand, TableIsTheGround) {
    const TempDir folder;
    ASSERT_EQ(profile(folder / "out").code, 0);
    const std::vector<Row> rows = rows_of(folder / "out");
    ASSERT_GT(rows.size(), 150U) << "a vertex at every edge of the facets of 1 m";
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double dtm = raster_at(quarry_a() / "data" / "dtm.tif", rows[k].x, rows[k].y);
        EXPECT_NEAR(rows[k].z, std::isnan(dtm) ? rows[k].z : dtm, kModelAgainstDtm) << "s = " << rows[k].s;
        if (k == 0) continue;
        EXPECT_GT(rows[k].s, rows[k - 1].s);
        EXPECT_NEAR(rows[k].s - rows[k - 1].s, std::hypot(rows[k].x - rows[k - 1].x, rows[k].y - rows[k - 1].y), 5e-6);
    }
    EXPECT_EQ(rows.front().soil, "\"loose waste\"");
    EXPECT_EQ(rows[rows.size() - 2].soil, "\"compact waste\"");
    EXPECT_EQ(rows.back().soil, "") << "no reach begins at the last vertex";
}

// The site's README: the path leaves the release towards the east, turned 7 degrees to the south, over a track from s = 39.5 to 47.5 m.
TEST(ProfileCommand, FollowsTheAxisOfQuarryA) {
    const TempDir folder;
    ASSERT_EQ(profile(folder / "out").code, 0);
    const Vec2 start(890021.98, 6670045.0), axis(std::cos(7 * 3.14159265 / 180), -std::sin(7 * 3.14159265 / 180));
    bool track_is_straight = false;
    for (const Row& row : rows_of(folder / "out")) {
        const Vec2 d = Vec2(row.x, row.y) - start;
        EXPECT_NEAR(axis.x() * d.y() - axis.y() * d.x(), 0.0, 2.0) << "s = " << row.s;
        if (axis.dot(d) > 42.0 && axis.dot(d) < 44.0) track_is_straight = row.course == "straight";
    }
    EXPECT_TRUE(track_is_straight);
}

TEST(ProfileCommand, RepetitionDoesNotChangeAByte) {
    const TempDir folder;
    for (const char* name : {"one", "two"}) ASSERT_EQ(profile(folder / name, {"profile.spacing=2"}).code, 0);
    EXPECT_THAT(differing_files(folder / "one", folder / "two"), IsEmpty());
    for (const auto& [name, bytes] : contents_of(folder / "one"))
        EXPECT_EQ(bytes.find(quarry_a().string()), std::string::npos) << name;
}

TEST(ProfileCommand, SpacingGivesMoreLinesAndConvergingFewer) {
    const TempDir folder;
    ASSERT_EQ(profile(folder / "keep", {"profile.spacing=1", "profile.pictures=1"}).code, 0);
    const Outcome drop = profile(folder / "drop", {"profile.spacing=1", "profile.converging=drop"});
    EXPECT_THAT(drop.out, HasSubstr("more ran into these and were left out"));
    const auto count = [](const fs::path& out) { return rows_of(out).back().profile; };
    EXPECT_GT(count(folder / "keep"), 9);
    EXPECT_LT(count(folder / "drop"), count(folder / "keep"));
    EXPECT_FALSE(fs::exists(folder / "keep" / "profile_2.svg"));
    EXPECT_THAT(text_of(folder / "keep" / "profiles.svg"), HasSubstr("profiles"));
}

TEST(ProfileCommand, SectionAlongALine) {
    const TempDir folder;
    const fs::path guide = write_guide(folder, kGuide);
    const Outcome made = profile(folder / "out", {"profile.mode=line", "profile.guide=" + guide.string()});
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("(line_end)"));
    const std::vector<Row> rows = rows_of(folder / "out");
    EXPECT_NEAR(rows.back().s, std::hypot(60, 7) + std::hypot(20, 22), 1e-5);
    EXPECT_EQ(rows.front().course, "given");
    EXPECT_THAT(fields_of(folder / "out" / "results.gpkg", "profile_guides"), Not(IsEmpty()));
}

TEST(ProfileCommand, GuidedStaysNearTheGuide) {
    const TempDir folder;
    const fs::path guide = write_guide(folder, kGuide);
    const Outcome made = profile(folder / "out", {"profile.mode=guided", "profile.guide=" + guide.string()});
    ASSERT_EQ(made.code, 0) << made.err;
    double north = -kInfinity;
    for (const Row& row : rows_of(folder / "out")) {
        if (row.x < 890080) {
            EXPECT_NEAR(row.y, 6670045 - 7 * (row.x - 890020) / 60, 10.0);
        }
        north = std::max(north, row.y);
    }
    EXPECT_GT(north, 6670055) << "it turns with the guide on the platform";
}

TEST(ProfileCommand, ALineThatLeavesTheTerrainSaysSo) {
    const TempDir folder;
    const fs::path guide = write_guide(folder, "LINESTRING (890020 6670045, 890300 6670045)");
    const Outcome made = profile(folder / "out", {"profile.mode=line", "profile.guide=" + guide.string()});
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.err, HasSubstr("leaves the terrain at s = 139 m"));
    EXPECT_THAT(made.out, HasSubstr("(rim)"));
}

TEST(ProfileCommand, SomeStartsOffTheTerrainAreAWarning) {
    const TempDir folder;
    const fs::path starts = folder / "starts.gpkg";
    write_vector(starts.string(), {.rows = {{"POINT (890030 6670040)", "", {}}, {"POINT (890000 6669000)", "", {}}}});
    const Outcome made = profile(folder / "out", {"profile.start=" + starts.string()});
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.err, HasSubstr("1 of 2 starting points lie off the terrain"));
}

struct BadProfile {
    const char* name;
    const char* wkt;  ///< of the file GUIDE
    std::vector<std::string> changes;
    std::vector<std::string> fragments;  ///< of the error
};
void PrintTo(const BadProfile& bad, std::ostream* out) {
    *out << bad.name;
}

const BadProfile kBad[] = {
    {"GuideMissing", kGuide, {"profile.mode=guided"}, {"profile.mode = \"guided\" needs profile.guide"}},
    {"ModeUnknown", kGuide, {"profile.mode=free"}, {"profile.mode = 'free'", "\"steepest\", \"guided\", \"line\""}},
    {"NegativeSmoothing", kGuide, {"profile.smoothing=-1"}, {"profile.smoothing = -1", "from 0 to 100"}},
    {"NoSuchFile", kGuide, {"profile.start=nothing.gpkg"}, {"nothing.gpkg"}},
    {"GuideIsPoints",
     "POINT (890020 6670045)",
     {"profile.mode=line", "profile.guide=GUIDE"},
     {"guiding lines", "guide.gpkg"}},
    {"GuideBeginsOutside",
     "LINESTRING (889900 6670045, 890080 6670038)",
     {"profile.mode=guided", "profile.guide=GUIDE"},
     {"feature 1", "begins off the terrain"}},
    {"DrawnUphill",
     "LINESTRING (890150 6670040, 890020 6670045)",
     {"profile.mode=line", "profile.guide=GUIDE"},
     {"feature 1", "m higher than it begins", "Reverse line direction"}},
    {"GuidedUphill",
     "LINESTRING (890150 6670040, 890020 6670045)",
     {"profile.mode=guided", "profile.guide=GUIDE"},
     {"feature 1", "m higher than it begins"}},
    {"StartsOutside", "POINT (800000 6670045)", {"profile.start=GUIDE"}, {"guide.gpkg", "outside"}},
    {"TooMany",
     "POLYGON ((890005 6670005, 890150 6670005, 890150 6670075, 890005 6670075, 890005 6670005))",
     {"profile.start=GUIDE", "profile.spacing=0.5"},
     {"starting points; at most 2000", "profile.spacing"}},
};

class BadProfiles : public testing::TestWithParam<BadProfile> {};

TEST_P(BadProfiles, AreRefusedWithOneSentence) {
    const TempDir folder;
    const fs::path guide = write_guide(folder, GetParam().wkt);
    std::vector<std::string> changes;
    for (std::string change : GetParam().changes) {
        const auto at = change.find("GUIDE");
        if (at != std::string::npos) change.replace(at, 5, guide.string());
        changes.push_back(change);
    }
    const Outcome outcome = profile(folder / "out", changes);
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err.rfind("error: ", 0), 0U) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    for (const std::string& fragment : GetParam().fragments) EXPECT_THAT(outcome.err, HasSubstr(fragment));
    EXPECT_FALSE(fs::exists(folder / "out"));
}
INSTANTIATE_TEST_SUITE_P(Table, BadProfiles, testing::ValuesIn(kBad),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(ProfileCommand, LevelGroundIsRefused) {
    const TempDir folder;
    RasterSpec level;
    level.value = [](int, int) { return 1200.0; };
    write_raster((folder / "dtm.tif").string(), level);
    write_vector((folder / "release.gpkg").string(), {.rows = {{"POINT (900050 6400050)", "", {}}}});
    put(folder / "site.toml",
        "[terrain]\ndtm = 'dtm.tif'\n[[soil]]\nname = 'ground'\n[release]\nfile = 'release.gpkg'\n");
    const Outcome outcome =
        scree_program({"profile", (folder / "site.toml").string(), "--output", (folder / "out").string()});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("release.gpkg: no profile can begin there"));
    EXPECT_THAT(outcome.err, HasSubstr("1 on level ground"));
}

}  // namespace
}  // namespace scree::test
