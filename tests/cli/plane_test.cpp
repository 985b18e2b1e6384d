// SPDX-License-Identifier: GPL-3.0-or-later
// `scree run` and `scree check` with model.dimension = 2 on quarry_a: layers, tables and pictures, counts that close, the same bytes on any number of
// threads, screens by line and by chainage, and what is said where a site does not suit a 2D model.
#include "cli/plane_model.hpp"
#include "cli/program.hpp"
#include "cli/results.hpp"
#include "gis/input_files.hpp"
#include "scree/base/error.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace scree::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;
namespace fs = std::filesystem;

constexpr int kBlocks = 20;
const std::set<std::string> kPathsDiffer{"run.toml",
                                         "SHA256SUMS"};  // run.toml leads from the folder of results to the inputs

/// Runs quarry_a in 2D with these changes.
Outcome run_2d(const fs::path& output, const std::vector<std::string>& changes = {},
               const std::vector<std::string>& options = {}) {
    std::vector<std::string> more{"--set", "model.dimension=2"};
    for (const std::string& change : changes) {
        more.emplace_back("--set");
        more.push_back(change);
    }
    more.insert(more.end(), options.begin(), options.end());
    return run_quarry_a(output, more);
}
Outcome check_2d(const std::vector<std::string>& changes) {
    std::vector<std::string> args{"check", (quarry_a() / "site.toml").string(), "--set", "model.dimension=2"};
    for (const std::string& change : changes) {
        args.emplace_back("--set");
        args.push_back(change);
    }
    return scree_program(args);
}

// It was found out when all was computed, and all was lost.
TEST(Plane, ADepositZoneThatNoProfileMeetsIsEmpty) {
    const TempDir folder;
    VectorSpec zones;
    zones.text_field = "name";
    const char* const area = "POLYGON((890000 6670000,890160 6670000,890160 6670015,890000 6670015,890000 6670000))";
    zones.rows = {{area, "beside", 1.0}, {area, "beside", 1.0}};
    write_vector((folder / "zones.gpkg").string(), zones);
    const Outcome run = run_2d(folder / "out", {"deposit_zones.file=" + (folder / "zones.gpkg").string()});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("deposit zone beside lies on no profile"));
    EXPECT_THAT(run.err, HasSubstr("2 features are called 'beside': a run counts in each of them"));
    EXPECT_THAT(run.out, HasSubstr("beside: lies where no block can stop"));
}

// The profile of the lower polygon has its head above the upper one, on whose part of it blocks start, too; and who falls off a profile is told where.
TEST(Plane, NoBlockFallsOffTheHeadOfAProfile) {
    const TempDir folder;
    VectorSpec areas;
    areas.rows = {{"POLYGON((890019.77 6670043.26,890023.74 6670042.77,890024.23 6670046.74,890020.26 "
                   "6670047.23,890019.77 6670043.26))",
                   "upper", 1.0},
                  {"POLYGON((890027.71 6670042.28,890030.69 6670041.92,890031.18 6670045.89,890028.20 "
                   "6670046.25,890027.71 6670042.28))",
                   "lower", 1.0}};
    write_vector((folder / "two.gpkg").string(), areas);
    const std::string release = "release.file=" + (folder / "two.gpkg").string();
    const Outcome run = run_2d(folder / "out", {release, "release.count=200"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr(" 0 left_terrain"));
    VectorSpec line;
    line.rows = {{"LINESTRING(890028.5 6670044.2,890060 6670041,890120 6670030)", "", 1.0}};
    write_vector((folder / "line.gpkg").string(), line);
    const Outcome drawn = run_2d(folder / "drawn", {release, "release.count=200", "profile.mode=line",
                                                    "profile.guide=" + (folder / "line.gpkg").string()});
    EXPECT_THAT(drawn.err, HasSubstr(" at an upper end: raise profile.head, or draw the line from farther up"));
    EXPECT_THAT(
        run_2d(folder / "short", {"profile.longest=20"}).err,
        HasSubstr("20 of 20 blocks passed an end of their profile: how far they run and what they would pass is "
                  "unknown; 20 at a lower end (length_limit): raise profile.longest"));
}

// What nobody knows of a block is not told in silence.
TEST(Run, SaysThatManyBlocksLeftOrWereStillMoving) {
    const TempDir folder;
    const Outcome late = run_2d(folder / "late", {"model.time_limit=1"});
    ASSERT_EQ(late.code, 0);
    EXPECT_THAT(late.err, HasSubstr("20 of 20 blocks were still moving at the time limit"));
    EXPECT_THAT(run_2d(folder / "usual").err, Not(HasSubstr(" of 20 blocks ")));
}

// Cells of the results are no cells of the release.
TEST(Plane, TheCellOfTheResultsMovesNoBlock) {
    const TempDir folder;
    const auto stops = [&](const char* name, const char* cell) {
        const Outcome run = run_2d(folder / name, {"release.pattern=cells", std::string("output.resolution=") + cell});
        EXPECT_EQ(run.code, 0) << run.err;
        std::vector<double> eastings;
        for (const PointRow& row : read_points(folder / name / "results.gpkg", "stopping_points"))
            eastings.push_back(row.at.x());
        return eastings;
    };
    EXPECT_EQ(stops("model", "0"), stops("fine", "0.25"));
}

TEST(Plane, WarnsOfWhatDoesNotSuitTheMode) {
    const auto berm = [](const std::string& place) {
        const TempDir folder;
        const std::string site =
            quarry_with(folder.path(), "[[effect]]\nkind = \"berm\"\nwidth = 3.0\nheight = 0.5\n" + place);
        return scree_program({"check", site, "--set", "model.dimension=2"}).err;
    };
    EXPECT_THAT(berm("file = \"data/screens.gpkg\"\n"), HasSubstr("its crest is cut down"));
    EXPECT_THAT(berm("from = 30.0\n"), Not(HasSubstr("its crest is cut down"))) << "exact along a profile";
    EXPECT_THAT(check_2d({"profile.guide=data/screens.gpkg"}).err, HasSubstr("profile.guide is not read"));
    const TempDir folder;
    write_vector((folder / "guide.gpkg").string(), {.rows = {{"LINESTRING (890020 6670045, 890120 6670035)", "", {}}}});
    EXPECT_THAT(check_2d({"profile.guide=" + (folder / "guide.gpkg").string(), "profile.mode=line",
                          "profile.start=data/release.gpkg"})
                    .err,
                HasSubstr("profile.start is not read"));
    EXPECT_THAT(check_2d({}).err, Not(HasSubstr("is not read")));
    EXPECT_THAT(check_2d({"model.mode=moreau_jean"}).err, HasSubstr("the paper's is 0.001 s"));
    EXPECT_THAT(check_2d({"model.mode=moreau_jean", "model.time_step=1e-3"}).err, Not(HasSubstr("the paper's is")));
    EXPECT_THAT(check_2d({"screens.file=", "screens.chainages=A = 3"}).err, Not(HasSubstr("places along a profile")));
    EXPECT_THAT(check_2d({"screens.file=", "screens.chainages=A = 3", "model.dimension=3"}).err,
                HasSubstr("places along a profile"));
    EXPECT_THAT(check_2d({"screens.file=", "screens.chainages=A=3;B=4"}).err, HasSubstr("\"A=3;B=4\" is no screen"));
}

/// Rows of profile_curves.csv, by column.
std::vector<std::map<std::string, std::string>> curves_of(const fs::path& folder) {
    std::istringstream in(text_of(folder / "profile_curves.csv"));
    std::string line;
    std::getline(in, line);
    auto cut = [](const std::string& text) {
        std::vector<std::string> words;
        std::istringstream fields(text + ",");
        for (std::string word; std::getline(fields, word, ',');) words.push_back(word);
        return words;
    };
    const std::vector<std::string> names = cut(line);
    std::vector<std::map<std::string, std::string>> rows;
    while (std::getline(in, line)) {
        const std::vector<std::string> values = cut(line);
        EXPECT_EQ(values.size(), names.size());
        auto& row = rows.emplace_back();
        for (std::size_t k = 0; k < names.size(); ++k) row[names[k]] = values[k];
    }
    return rows;
}

TEST(Plane, WritesLayersTableAndPicture) {
    const TempDir folder;
    const fs::path out = folder / "out";
    const Outcome run = run_2d(out);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("20 blocks thrown"));
    EXPECT_THAT(run.out, HasSubstr("profile 1"));
    EXPECT_THAT(run.out, HasSubstr("screen         ES1-A: 100 % pass"));
    for (const char* name : {"results.gpkg", "results.qgs", "run.toml", "profile_curves.csv", "profile_1.svg"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    const fs::path gpkg = out / "results.gpkg";
    EXPECT_THAT(fields_of(gpkg, "stopping_points"),
                IsSupersetOf({"block", "block_id", "stop_reason", "runout_m", "profile", "s_m", "release_s_m"}));
    EXPECT_THAT(fields_of(gpkg, "release_points"), IsSupersetOf({"profile", "s_m"}));
    EXPECT_THAT(fields_of(gpkg, "trajectories"), IsSupersetOf({"block", "profile"}));
    EXPECT_THAT(fields_of(gpkg, "screen_crossings"), IsSupersetOf({"screen", "speed_ms", "profile", "s_m"}));
    EXPECT_THAT(fields_of(gpkg, "deposit_zones"), IsSupersetOf({"name", "count", "percent", "percent_low"}));
    EXPECT_THAT(fields_of(gpkg, "profile_curves"), IsSupersetOf({"profile", "from_s_m", "passages", "deposits",
                                                                 "energy_kj_p95", "height_m_max", "speed_ms_mean"}));
    for (const char* layer :
         {"profiles", "profile_reaches", "profile_curves", "screens", "release_zones", "deposit_zones"})
        EXPECT_EQ(crs_code_of(gpkg, layer), "2154") << layer;
    const std::string picture = text_of(out / "profile_1.svg");
    for (const char* words : {"Quarry A (synthetic): run on profile 1", "20 blocks in 2D", "ES2-A, s = ", "Stops [%]",
                              "Energy [kJ]", "Height [m]", "95 % quantile"})
        EXPECT_THAT(picture, HasSubstr(words));
    EXPECT_THAT(picture, Not(HasSubstr("nan")));
}

TEST(Plane, CountsClose) {
    const TempDir folder;
    const fs::path out = folder / "out";
    ASSERT_EQ(run_2d(out).code, 0);
    const auto stops = read_points(out / "results.gpkg", "stopping_points");
    ASSERT_EQ(stops.size(), kBlocks);
    std::map<std::string, int> reasons;
    std::map<int, int> stops_in_cell;
    for (const PointRow& stop : stops) {
        ++reasons[stop.values.at("stop_reason")];
        if (stop.values.at("stop_reason") == "at_rest") ++stops_in_cell[static_cast<int>(stop.number("s_m"))];
        EXPECT_NEAR(stop.number("runout_m"), stop.number("s_m") - stop.number("release_s_m"), 1e-9);
    }
    EXPECT_EQ(reasons["at_rest"] + reasons["left_terrain"] + reasons["time_limit"] + reasons["failed"], kBlocks);
    int deposits = 0;
    for (const auto& row : curves_of(out)) {
        const int cell = static_cast<int>(std::stod(row.at("from_s_m")) + 0.5);
        EXPECT_EQ(std::stoi(row.at("deposits")), stops_in_cell[cell]) << cell;
        EXPECT_EQ(row.at("energy_kj_mean").empty(), row.at("passages") == "0") << cell;
        deposits += std::stoi(row.at("deposits"));
    }
    EXPECT_EQ(deposits, reasons["at_rest"]);
}

// A probability that one block in many makes keeps its digits.
TEST(Plane, SmallProbabilitiesKeepTheirDigits) {
    const TempDir folder;
    const fs::path out = folder / "out";
    ASSERT_EQ(run_2d(out, {"release.count=700"}).code, 0);
    double least = 1.0;
    for (const auto& row : curves_of(out)) {
        const double share = std::stod(row.at("passages")) / 700.0;
        EXPECT_NEAR(std::stod(row.at("reach_probability")), share, 1e-3 * share);
        if (share > 0.0) least = std::min(least, share);
    }
    EXPECT_LT(least, 0.01);
}

TEST(Plane, ThreadsAndRepetitionDoNotChangeAByte) {
    const TempDir folder;
    const fs::path out = folder / "out";
    const std::vector<std::string> changes{"profile.spacing=1.5"};  // several profiles
    ASSERT_EQ(run_2d(out, changes, {"--threads", "1"}).code, 0);
    fs::rename(out, folder / "first");
    for (const char* threads : {"1", "3"}) {
        ASSERT_EQ(run_2d(out, changes, {"--threads", threads}).code, 0);
        EXPECT_THAT(differing_files(folder / "first", out), IsEmpty()) << threads << " threads";
        fs::remove_all(out);
    }
}

TEST(Plane, RunTomlReproducesTheRun) {
    const TempDir folder;
    const fs::path out = folder / "out", again = folder / "again";
    ASSERT_EQ(run_2d(out).code, 0);
    const Outcome rerun = scree_program({"run", (out / "run.toml").string(), "--output", again.string()});
    ASSERT_EQ(rerun.code, 0) << rerun.err;
    EXPECT_THAT(differing_files(out, again, kPathsDiffer), IsEmpty());
}

// A screen drawn as a line and one at the same chainage see the same blocks.
TEST(Plane, ScreensByLineAndByChainageAgree) {
    const TempDir folder;
    ASSERT_EQ(run_2d(folder / "out").code, 0);
    const auto drawn = read_points(folder / "out" / "results.gpkg", "screen_crossings");
    std::map<std::string, std::string> at;
    for (const PointRow& c : drawn) at.emplace(c.values.at("screen"), c.values.at("s_m"));
    ASSERT_EQ(at.size(), 2u);
    ASSERT_EQ(run_2d(folder / "two",
                     {"screens.file=''", "screens.chainages='first = " + at["ES1-A"] + ", ES2-A=" + at["ES2-A"] + "'"})
                  .code,
              0);
    const auto given = read_points(folder / "two" / "results.gpkg", "screen_crossings");
    ASSERT_EQ(given.size(), drawn.size());
    for (std::size_t k = 0; k < given.size(); ++k) {
        EXPECT_EQ(given[k].values.at("block"), drawn[k].values.at("block"));
        EXPECT_NEAR(given[k].number("speed_ms"), drawn[k].number("speed_ms"), 1e-4) << "s_m is known to micrometres";
    }
    EXPECT_THAT(text_of(folder / "two" / "profile_1.svg"), HasSubstr("first, s = "));
}

// Lines of one name, as the parts of one line, are one screen: a block is measured at the first that it meets.
TEST(Plane, AScreenOfSeveralLinesCountsABlockOnce) {
    const TempDir folder;
    const fs::path lines = folder / "screens.gpkg";
    write_vector(
        lines.string(),
        {.layer = "screens",
         .text_field = "name",
         .rows = {{"MULTILINESTRING ((890040 6670000, 890040 6670080), (890050 6670000, 890050 6670080))", "a", {}},
                  {"LINESTRING (890060 6670000, 890060 6670080)", "a", {}}}});
    const std::string file = "screens.file='" + lines.string() + "'";
    for (const char* dimension : {"model.dimension=2", "model.dimension=3"}) {
        const fs::path out = folder / dimension;
        const Outcome run = run_quarry_a(out, {"--set", file, "--set", dimension});
        ASSERT_EQ(run.code, 0) << run.err;
        EXPECT_THAT(run.err, HasSubstr("2 features are called 'a': they count as one screen"));
        EXPECT_THAT(run.out, HasSubstr("screen         a: 100 % pass"));
        std::set<std::string> blocks;
        for (const PointRow& c : read_points(out / "results.gpkg", "screen_crossings")) {
            EXPECT_TRUE(blocks.insert(c.values.at("block")).second) << "twice";
            EXPECT_NEAR(c.at.x(), 890040.0, 0.01) << "the first that it meets";
        }
    }
    const Outcome twice = check_2d({"screens.chainages='A = 20, A = 40'"});
    EXPECT_EQ(twice.code, 3);
    EXPECT_THAT(twice.err, HasSubstr("two screens called 'A'"));
}

TEST(Plane, CheckShowsTheProfiles) {
    const Outcome check = check_2d({});
    ASSERT_EQ(check.code, 0) << check.err;
    EXPECT_THAT(check.out, HasSubstr("profile 1"));
    EXPECT_THAT(check.out, HasSubstr("screen ES1-A at s = "));
    EXPECT_THAT(check.out, HasSubstr("deposit zone 3A from s = "));
    EXPECT_THAT(check.out, HasSubstr("the first 200 start at heights"));
}

TEST(Plane, SaysWhatDoesNotSuit) {
    const Outcome chainage = check_2d({"screens.chainages='ES1 at 40'"});
    EXPECT_EQ(chainage.code, 3);
    EXPECT_THAT(chainage.err, HasSubstr("screens.chainages: \"ES1 at 40\" is no screen: write NAME = CHAINAGE"));
    const Outcome beyond = check_2d({"screens.chainages='far = 900'"});
    EXPECT_EQ(beyond.code, 0);
    EXPECT_THAT(beyond.err, HasSubstr("screen far stands on no profile"));
    const Outcome thrown = check_2d({"release.speed=2", "release.azimuth_deg=90"});
    EXPECT_THAT(thrown.err, HasSubstr("release.azimuth_deg does not matter in 2D"));
    const Outcome four = check_2d({"model.dimension=4"});
    EXPECT_EQ(four.code, 3);
    EXPECT_THAT(four.err, HasSubstr("model.dimension = 4 is not allowed"));
    const Outcome fine = check_2d({"output.resolution=1e-6"});
    EXPECT_EQ(fine.code, 3);
    EXPECT_THAT(fine.err, HasSubstr("result cells along the profiles, more than the 10 million that are allowed"));
}

// Blocks would end where their profile is cut off.
TEST(Plane, MergedProfilesAreAnError) {
    const TempDir folder;
    const fs::path guide = folder / "guide.gpkg";
    write_vector(guide.string(),
                 {.layer = "guide",
                  .rows = {{"LINESTRING (890016 6670045, 890070 6670040, 890150 6670040)", "a", {}},
                           {"LINESTRING (890016 6670046.5, 890070 6670040, 890150 6670040)", "b", {}}}});
    const std::vector<std::string> lines{"profile.mode=line", "profile.guide='" + guide.string() + "'"};
    EXPECT_EQ(check_2d(lines).code, 0);
    const Outcome merged = check_2d({lines[0], lines[1], "profile.converging=merge"});
    EXPECT_EQ(merged.code, 3);
    EXPECT_THAT(merged.err, HasSubstr("profile.converging = \"merge\" ends profile 2"));
}

// A profile that passes the release at a distance: nothing to release is an error, not an empty result.
TEST(Plane, ProfileBesideTheReleaseIsAnError) {
    const TempDir folder;
    const fs::path guide = folder / "guide.gpkg";
    write_vector(guide.string(),
                 {.layer = "guide", .rows = {{"LINESTRING (890020 6670070, 890100 6670070)", "a", {}}}});
    const Outcome check = check_2d({"profile.mode=line", "profile.guide='" + guide.string() + "'"});
    EXPECT_EQ(check.code, 3);
    EXPECT_THAT(check.err, HasSubstr("release.gpkg: no profile meets a feature of the release layer"));
}

TEST(Plane, ChainagesAreParsed) {
    using testing::ElementsAre;
    using testing::Pair;
    EXPECT_THAT(cli::parse_chainages(""), IsEmpty());
    EXPECT_THAT(cli::parse_chainages(" ES1-A = 39.5 ,upper road=48"),
                ElementsAre(Pair("ES1-A", 39.5), Pair("upper road", 48.0)));
    for (const char* text : {"39.5", "= 3", "a = ", "a = 3 m", "a = -1", "a = 1,,b = 2", "a = nan"})
        EXPECT_THROW(cli::parse_chainages(text), InputError) << text;
}

}  // namespace
}  // namespace scree::test
