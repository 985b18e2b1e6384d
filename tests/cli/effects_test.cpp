// SPDX-License-Identifier: GPL-3.0-or-later
// [[effect]] in the site file and the catalogue on the command line.
#include "scree/dynamics/effects.hpp"

#include "cli/program.hpp"
#include "cli/results.hpp"
#include "cli/site_file.hpp"
#include "cli/site_model.hpp"
#include "gis/input_files.hpp"
#include "scree/base/error.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace scree::test {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

Outcome check_with(const std::string& more) {
    const TempDir folder;
    return scree_program({"check", quarry_with(folder.path(), more)});
}

struct Mistake {
    const char* name;
    const char* text;
    const char* said;
};
void PrintTo(const Mistake& m, std::ostream* out) {
    *out << m.name;
}

const Mistake kMistakes[] = {
    {"NoKind", "[[effect]]\ncoefficient = 1.0\n", "an [[effect]] has no kind: scree effects lists the kinds"},
    {"UnknownKind", "[[effect]]\nkind = \"ground_drga\"\n",
     "there is no effect \"ground_drga\"; scree effects lists them"},
    {"UnknownKey", "[[effect]]\nkind = \"ground_drag\"\ncoeficient = 1.0\n",
     "effect ground_drag has no key coeficient; it knows coefficient and where it acts"},
    {"OutOfRange", "[[effect]]\nkind = \"ground_drag\"\ncoefficient = -1.0\n",
     "effect.coefficient = -1.0 is not allowed: give a number from 0 to 20"},
    {"NotANumber", "[[effect]]\nkind = \"ground_drag\"\ncoefficient = \"much\"\n", "is not allowed: give a number"},
    {"NotAList", "[effect]\nkind = \"ground_drag\"\n", "effect must be a list of tables: begin each with [[effect]]"},
    {"UnknownSoil", "[[effect]]\nkind = \"ground_drag\"\nsoil = \"moss\"\n",
     "effect ground_drag: soil \"moss\" is no [[soil]]; there are \"loose waste\", \"compact waste\""},
    {"NoLine", "[[effect]]\nkind = \"net\"\n", "effect net stands nowhere: give its line in a file"},
    {"ReachInSpace", "[[effect]]\nkind = \"ground_drag\"\nfrom = 3.0\nto = 9.0\n",
     "from and to are distances along a profile, for model.dimension = 2"},
    {"SoilOfAShape", "[[effect]]\nkind = \"block_shape\"\nsoil = \"loose waste\"\n",
     "effect block_shape cannot be limited to a soil"},
    {"FileOfAShape", "[[effect]]\nkind = \"block_shape\"\nfile = \"data/zones.gpkg\"\n",
     "effect block_shape acts everywhere"},
    {"WrongGeometry", "[[effect]]\nkind = \"net\"\nfile = \"data/zones.gpkg\"\n", "zones.gpkg"},
    {"NoSuchFile", "[[effect]]\nkind = \"soil_patch\"\nfile = \"data/nothing.gpkg\"\n", "nothing.gpkg"},
};

class EffectMistake : public testing::TestWithParam<Mistake> {};
INSTANTIATE_TEST_SUITE_P(Table, EffectMistake, testing::ValuesIn(kMistakes),
                         [](const auto& row) { return std::string(row.param.name); });

TEST_P(EffectMistake, IsRefusedInOneSentence) {
    const Outcome outcome = check_with(GetParam().text);
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr(GetParam().said));
    EXPECT_EQ(outcome.err.find("error: "), outcome.err.rfind("error: "));
}

TEST(EffectKeys, ImpactsNeedTheEventMode) {
    const TempDir folder;
    const std::string site = quarry_with(folder.path(), "[[effect]]\nkind = \"roughness\"\n");
    EXPECT_EQ(scree_program({"check", site}).code, 0);
    const Outcome outcome = scree_program({"check", site, "--set", "model.mode=moreau_jean"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("effect roughness acts at the instant of an impact"));
}

TEST(EffectKeys, ReachTheSite) {
    const TempDir folder;
    const std::string site =
        quarry_with(folder.path(),
                    "[[effect]]\nkind = \"ground_drag\"\nsoil = \"loose waste\"\ncoefficient = 0.7\n"
                    "[[effect]]\nkind = \"soil_patch\"\nfile = \"data/deposit_zones.gpkg\"\n"
                    "friction = 0.3\n");
    const cli::SiteFile read =
        cli::read_site_file(site, {"effect.ground_drag.coefficient=0.9", "effect.1.rolling=0.2"});
    ASSERT_EQ(read.settings.effects.size(), 2U);
    EXPECT_EQ(read.settings.effects[0].effect.value("coefficient"), 0.9);
    EXPECT_EQ(read.settings.effects[0].soil, "loose waste");
    EXPECT_EQ(read.settings.effects[1].effect.value("friction"), 0.3);
    EXPECT_EQ(read.settings.effects[1].effect.value("rolling"), 0.2);
    EXPECT_TRUE(std::isnan(read.settings.effects[1].effect.value("restitution")));
    const Outcome checked = scree_program({"check", site});
    EXPECT_EQ(checked.code, 0) << checked.err;
    EXPECT_THAT(checked.out,
                HasSubstr("effects        ground_drag on loose waste: coefficient 0.7 1/s\n"
                          "               soil_patch at the features of data/deposit_zones.gpkg: friction 0.3\n"));
    const Outcome missing = scree_program({"check", site, "--set", "effect.net.height=3"});
    EXPECT_EQ(missing.code, 3);
    EXPECT_THAT(missing.err, HasSubstr("there is no [[effect]] called \"net\""));
}

TEST(EffectKeys, ChangeInMemoryAsInTheFileAndSeveralAtOnce) {
    const TempDir folder;
    const std::string site = quarry_with(folder.path(),
                                         "[[effect]]\nkind = \"ground_drag\"\ncoefficient = 0.7\n"
                                         "[[effect]]\nkind = \"ground_drag\"\ncoefficient = 0.1\n"
                                         "[[effect]]\nkind = \"air_drag\"\n");
    const std::vector<std::string> changes{"soil.*.rolling=0.3", "soil.loose waste|compact waste.friction=0.7",
                                           "soil.1.restitution=0.2", "effect.ground_drag.coefficient=0.4",
                                           "effect.1.coefficient=0.5"};
    for (const cli::SiteFile& read :
         {cli::read_site_file(site, changes), cli::with_changes(cli::read_site_file(site, {}), changes)}) {
        const cli::SiteSettings& s = read.settings;
        ASSERT_EQ(s.soils.size(), 2U);
        for (const Soil& soil : s.soils) EXPECT_EQ(std::pair(soil.rolling, soil.friction), std::pair(0.3, 0.7));
        EXPECT_EQ(s.soils[0].restitution, 0.0);
        EXPECT_EQ(s.soils[1].restitution, 0.2);
        EXPECT_EQ(s.effects[0].effect.value("coefficient"), 0.4);
        EXPECT_EQ(s.effects[1].effect.value("coefficient"), 0.5);
    }
    for (const char* wrong : {"effect.net.height=3", "effect.ground_drag.size=3", "soil.rock|ice.rolling=1"})
        EXPECT_THROW(cli::with_changes(cli::read_site_file(site, {}), {wrong}), InputError) << wrong;
}

// Soils that a map numbers: a number means a place in the list only where it is no name.
TEST(EntriesMeant, ANumberIsANameWhereThereIsOne) {
    using testing::ElementsAre;
    const std::vector<std::string> numbered{"1", "2", "10"}, named{"loose waste", "a|b", "rock"};
    EXPECT_THAT(cli::entries_meant("1", numbered), ElementsAre(0));
    EXPECT_THAT(cli::entries_meant("1|10", numbered), ElementsAre(0, 2));
    EXPECT_THAT(cli::entries_meant("0", numbered), ElementsAre(0)) << "the first, as no name";
    EXPECT_THAT(cli::entries_meant("*", numbered), ElementsAre(0, 1, 2));
    EXPECT_THAT(cli::entries_meant("1", named), ElementsAre(1));
    EXPECT_THAT(cli::entries_meant("rock|0", named), ElementsAre(0, 2));
    EXPECT_THAT(cli::entries_meant("a|b", named), ElementsAre(1));
    EXPECT_THAT(cli::entries_meant("moss", named), testing::IsEmpty());
}

// Every physical effect of the catalogue in one run; run.toml does the same run again.
TEST(EffectRun, EveryPhysicalEffectAndTheRunAgain) {
    const TempDir folder;
    std::string more;
    for (const EffectInfo& info : effect_catalogue()) {
        if (info.hook == EffectHook::Measurement) continue;
        more += std::string("[[effect]]\nkind = \"") + info.name + "\"\n";
        if (info.limits.lines) more += "file = \"data/screens.gpkg\"\n";
        if (info.kind == EffectKind::Berm) more += "width = 3.0\nheight = 0.5\n";
        if (info.kind == EffectKind::Net) more += "capacity = 2.0\n";
        if (info.kind == EffectKind::SoilPatch) more += "friction = 0.4\nfile = \"data/deposit_zones.gpkg\"\n";
        if (info.kind == EffectKind::Fragmentation) more += "speed = 3.0\n";
        if (info.kind == EffectKind::OwnLaw) more += "library = \"" SCREE_OWN_LAW "\"\na = 0.1\n";
    }
    const std::string site = quarry_with(folder.path(), more);
    const Outcome run = scree_program({"run", site, "--set", "release.count=12", "--threads", "1"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("crest"));  // the berm is narrow for cells of 1 m: said, not refused
    for (const char* command : {"terrain", "profile"}) {
        const fs::path out = folder / command;
        const Outcome shown = scree_program({command, site, "--output", out.string()});
        ASSERT_EQ(shown.code, 0) << shown.err;
        EXPECT_THAT(shown.err, HasSubstr("crest")) << command << ": the berm is part of this ground";
        EXPECT_THAT(text_of(out / "results.gpkg"), HasSubstr("sha256 screens.gpkg")) << command;
    }
    const Outcome again = scree_program(
        {"run", (folder / "out/run.toml").string(), "--output", (folder / "again").string(), "--threads", "2"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(text_of(folder / "out/results.gpkg"), text_of(folder / "again/results.gpkg"));
}

/// An entry that moves blocks on quarry_a. What is in the catalogue with a default strength of nothing gets one.
std::string acting(const EffectInfo& info, bool in_plane) {
    std::string entry = std::string("[[effect]]\nkind = \"") + info.name + "\"\n";
    if (info.limits.lines) entry += in_plane ? "from = 30.0\n" : "file = \"data/screens.gpkg\"\n";
    switch (info.kind) {
        case EffectKind::SoilPatch:
            entry += "friction = 0.9\nrolling = 0.5\n";
            entry += in_plane ? "from = 5.0\nto = 80.0\n" : "file = \"data/zones.gpkg\"\n";
            break;
        case EffectKind::Fragmentation:
            entry += "speed = 2.0\n";
            break;
        case EffectKind::OwnLaw:
            entry += "library = \"" SCREE_OWN_LAW "\"\na = 0.1\n";
            break;
        default:
            break;
    }
    return entry;
}

/// Where ten blocks stop. Nothing is written: that takes longest.
std::vector<Vec3> stops_with(const std::string& effect, bool in_plane) {
    const TempDir folder;
    const cli::SiteModel model = cli::load_site(cli::read_site_file(
        quarry_with(folder.path(), effect),
        {"release.count=10", "soil.*.restitution=0.3", in_plane ? "model.dimension=2" : "model.dimension=3"}));
    const std::atomic<bool> stop{false};
    std::vector<Vec3> stops;
    for (const BlockResult& block : run_campaign(model.campaign, {}, stop).blocks) {
        stops.push_back(in_plane ? Vec3(block.stop_s, 0.0, 0.0) : block.stop);
        EXPECT_TRUE(stops.back().allFinite());
    }
    return stops;
}

void expect_each_moves_blocks(bool in_plane) {
    const std::vector<Vec3> without = stops_with("", in_plane);
    ASSERT_EQ(without.size(), 10U);
    for (const EffectInfo& info : effect_catalogue()) {
        SCOPED_TRACE(info.name);
        if (info.hook == EffectHook::Measurement) continue;
        if (info.kind != EffectKind::BlockShape) {
            EXPECT_NE(stops_with(acting(info, in_plane), in_plane), without);
            continue;
        }
        for (const char* form : {"corners = 0.4\n", "corners = 2.0\n", "elongation = 1.5\n", "flatness = 1.5\n"})
            EXPECT_NE(stops_with(acting(info, in_plane) + form, in_plane), without) << form;
    }
}

TEST(EffectRun, EachMovesBlocksInSpace) {
    expect_each_moves_blocks(false);
}

TEST(EffectRun, EachMovesBlocksInThePlane) {
    expect_each_moves_blocks(true);
}

// A law in a library does what the effect of the catalogue does whose formula it has.
TEST(OwnLaw, IsAnEffectLikeOthers) {
    const TempDir folder;
    const auto stops = [&](const std::string& name, const std::string& effect) {
        const TempDir here;
        const Outcome run = scree_program({"run", quarry_with(here.path(), "[[effect]]\n" + effect), "--set",
                                           "release.count=10", "--output", (folder / name).string()});
        EXPECT_EQ(run.code, 0) << run.err;
        std::vector<double> runouts;
        for (const PointRow& row : read_points(folder / name / "results.gpkg", "stopping_points"))
            runouts.push_back(row.number("runout_m"));
        return runouts;
    };
    const std::string library = "library = \"" SCREE_OWN_LAW "\"\n";
    const auto drag = stops("drag", "kind = \"ground_drag\"\ncoefficient = 0.3\n");
    EXPECT_THAT(stops("own drag", "kind = \"own_law\"\na = 0.3\n" + library), testing::ContainerEq(drag));
    const auto rolling =
        stops("rolling", "kind = \"rolling_speed\"\nspeed = 5.0\nexponent = 1.0\nsoil = \"loose waste\"\n");
    EXPECT_THAT(stops("own rolling", "kind = \"own_law\"\nb = 5.0\nsoil = \"loose waste\"\n" + library),
                testing::ContainerEq(rolling));
    EXPECT_NE(drag, rolling);
    EXPECT_THAT(text_of(folder / "own drag" / "run.toml"), HasSubstr("library = "));
}

// Dust would bounce for ever: pieces of pieces end at 5 cm.
TEST(Fragmentation, EndsWithPiecesOfFiveCentimetres) {
    const TempDir folder;
    const std::string site =
        quarry_with(folder.path(), "[[effect]]\nkind = \"fragmentation\"\nspeed = 0.5\nshare = 0.1\nmost = 100\n");
    const Outcome run = scree_program({"run", site, "--set", "release.count=4", "--set", "model.dimension=2"});
    ASSERT_EQ(run.code, 0) << run.err;
    for (const PointRow& row : read_points(folder / "out/results.gpkg", "stopping_points"))
        EXPECT_GE(row.number("l1_m") * std::cbrt(row.number("mass_left_kg") / row.number("mass_kg")), 0.05);
}

// Mass, speed and energy of a row are those of one piece: a barrier is dimensioned with any two of them.
TEST(Fragmentation, AtAScreenTheMassIsThatOfThePiece) {
    const TempDir folder;
    const std::string site = quarry_with(folder.path(), "[[effect]]\nkind = \"fragmentation\"\n");
    const Outcome run = scree_program({"run", site, "--set", "release.count=10", "--set", "model.dimension=2"});
    ASSERT_EQ(run.code, 0) << run.err;
    std::set<double> masses;
    for (const PointRow& row : read_points(folder / "out/results.gpkg", "screen_crossings")) {
        const double translation = 0.5e-3 * row.number("mass_kg") * row.number("speed_ms") * row.number("speed_ms");
        EXPECT_GE(row.number("energy_kj"), (1.0 - 1e-9) * translation);
        EXPECT_LE(row.number("energy_kj"), 1.6 * translation);
        masses.insert(row.number("mass_kg"));
    }
    for (const PointRow& row : read_points(folder / "out/results.gpkg", "stopping_points"))
        masses.erase(row.number("mass_kg"));
    EXPECT_FALSE(masses.empty()) << "none had broken";
}

TEST(Effects, ANetStandsInOnePlace) {
    const TempDir folder;
    const std::string site =
        quarry_with(folder.path(), "[[effect]]\nkind = \"net\"\nfrom = 20.0\nfile = \"data/screens.gpkg\"\n");
    const Outcome outcome = scree_program({"check", site, "--set", "model.dimension=2"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("stands in two ways"));
}

/// A feature 35 m down the profile of quarry_a, a line across it from one distance to the other, or a point, as GeoJSON.
std::string drawn_on_the_way(const std::string& kind, double from, double to) {
    const cli::SiteModel model = cli::load_site(cli::read_site_file(quarry_a() / "site.toml", {"model.dimension=2"}));
    const Profile& profile = model.campaign.tracks.at(0).profile;
    const Vec2 at = profile.place_at(35.0), way = profile.direction_at(35.0), left(-way.y(), way.x());
    const auto on_map = [&](double offset) {
        const Vec2 p = at + offset * left;
        const auto map = model.terrain.data.frame.to_map({p.x(), p.y(), 0.0});
        std::ostringstream text;
        text.precision(12);
        text << "[" << map.easting << "," << map.northing << "]";
        return text.str();
    };
    const std::string points = kind == "Point" ? on_map(from) : "[" + on_map(from) + "," + on_map(to) + "]";
    return R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::2154"}},)"
           R"("features":[{"type":"Feature","properties":{},"geometry":{"type":")" +
           kind + R"(","coordinates":)" + points + "}}]}";
}

TEST(Effects, RefusesASecondEndAndTwoKindsOfTrees) {
    const auto checked = [](const std::string& effect) {
        const TempDir folder;
        return scree_program(
            {"check", quarry_with(folder.path(), "[[effect]]\n" + effect), "--set", "model.dimension=2"});
    };
    const Outcome net = checked("kind = \"net\"\nfrom = 20.0\nto = 30.0\n");
    EXPECT_EQ(net.code, 3);
    EXPECT_THAT(net.err, HasSubstr("stands at one chainage, from: remove to"));
    const TempDir folder;
    put(folder / "trees.geojson", drawn_on_the_way("Point", 0.0, 0.0));
    const Outcome trees = scree_program(
        {"check",
         quarry_with(folder.path(), "[[effect]]\nkind = \"trees\"\nfile = \"trees.geojson\"\nfrom = 60.0\nto = 70.0\n"),
         "--set", "model.dimension=2"});
    EXPECT_EQ(trees.code, 3);
    EXPECT_THAT(trees.err, HasSubstr("single trees (points) and a stand"));
}

// An inventory of trees has their diameters: a user would take them for read.
TEST(Effects, FieldsCalledLikeANumberAreToldAsUnread) {
    const TempDir folder;
    std::string trees = drawn_on_the_way("Point", 0.0, 0.0);
    const std::string none = R"("properties":{},"geometry")";
    trees.replace(trees.find(none), none.size(), R"("properties":{"Diameter_m":0.9,"kind":"beech"},"geometry")");
    put(folder / "trees.geojson", trees);
    const Outcome checked = scree_program(
        {"check", quarry_with(folder.path(), "[[effect]]\nkind = \"trees\"\nfile = \"trees.geojson\"\n")});
    EXPECT_EQ(checked.code, 0);
    EXPECT_THAT(checked.err, HasSubstr("the field Diameter_m of trees.geojson is not read: diameter is 0.3 m for all"));
    EXPECT_THAT(checked.err, Not(HasSubstr("field kind")));
}

// A dam stands on the grid, on few large facets and across a profile, whose way it must not end: what passes it goes on.
TEST(Effects, ABermStandsOnEveryGround) {
    const TempDir folder;
    put(folder / "dam.geojson", drawn_on_the_way("LineString", -15.0, 15.0));
    const std::string site =
        quarry_with(folder.path(), "[[effect]]\nkind = \"berm\"\nfile = \"dam.geojson\"\nheight = 3.0\nwidth = 8.0\n");
    using cli::SiteModel;
    const auto loaded = [](const std::string& file, const std::vector<std::string>& changes) {
        return cli::load_site(cli::read_site_file(file, changes));
    };
    const std::string bare_site = (quarry_a() / "site.toml").string();
    const SiteModel plane = loaded(bare_site, {"model.dimension=2"}), dam = loaded(site, {"model.dimension=2"});
    const Profile &bare = plane.campaign.tracks.at(0).profile, &raised = dam.campaign.tracks.at(0).profile;
    EXPECT_NEAR(raised.length(), bare.length(), 1e-6);
    double highest = 0.0;
    for (double s = 1.0; s < bare.length(); s += 0.25) {
        const double up = raised.height_at(s) - bare.height_at(s);
        highest = std::max(highest, up);
        EXPECT_GE(up, -1e-6);
        EXPECT_LT(up, std::abs(s - 35.0) > 10.0 ? 1e-6 : 3.1) << s;
    }
    EXPECT_GT(highest, 2.0) << "the nodes of a grid of 1 m see most of it";
    for (const auto& trace : dam.profiles->traces) EXPECT_EQ(trace.course.size(), trace.profile.reach_count());

    const SiteModel tin = loaded(site, {"terrain.surface=tin"}), grid = loaded(site, {}), none = loaded(bare_site, {});
    for (double s = 25.0; s < 45.0; s += 0.25) {
        const Vec2 p = bare.place_at(s);
        EXPECT_NEAR(tin.terrain.surface->height(p), grid.terrain.surface->height(p), 0.35) << s;
    }
    const Vec2 crest = bare.place_at(35.0);
    EXPECT_GT(tin.terrain.surface->height(crest) - none.terrain.surface->height(crest), 2.0);
}

TEST(Effects, APatchWithoutAValueIsSaidToDoNothing) {
    EXPECT_THAT(check_with("[[effect]]\nkind = \"soil_patch\"\n").err, HasSubstr("soil_patch changes nothing"));
    EXPECT_THAT(check_with("[[effect]]\nkind = \"soil_patch\"\nfriction = 0.4\n").err,
                Not(HasSubstr("changes nothing")));
}

TEST(OwnLaw, RefusesWhatIsNone) {
    EXPECT_THAT(check_with("[[effect]]\nkind = \"own_law\"\n").err, HasSubstr("effect own_law needs library"));
    EXPECT_THAT(check_with("[[effect]]\nkind = \"own_law\"\nlibrary = \"nowhere.so\"\n").err,
                HasSubstr("cannot load the library"));
    EXPECT_THAT(check_with("[[effect]]\nkind = \"own_law\"\nlibrary = \"data/dtm.tif\"\n").err,
                HasSubstr("cannot load the library"));
    EXPECT_THAT(check_with("[[effect]]\nkind = \"own_law\"\nlibrary = \"libm.so.6\"\n").err,
                HasSubstr("cannot load the library"))
        << "it is looked for beside the site file only";
    EXPECT_THAT(check_with("[[effect]]\nkind = \"air_drag\"\nlibrary = \"" SCREE_OWN_LAW "\"\n").err,
                HasSubstr("takes no library"));
}

// The same in 2D, with places by chainage and from the map.
TEST(EffectRun, InThePlaneToo) {
    const TempDir folder;
    const std::string site =
        quarry_with(folder.path(),
                    "[[effect]]\nkind = \"ground_drag\"\nfrom = 5.0\nto = 40.0\ncoefficient = 1.0\n"
                    "[[effect]]\nkind = \"forest_drag\"\nfile = \"data/deposit_zones.gpkg\"\n"
                    "[[effect]]\nkind = \"net\"\nfrom = 60.0\ncapacity = 1e4\nheight = 30.0\n"
                    "[[effect]]\nkind = \"berm\"\nfrom = 50.0\n"
                    "[[effect]]\nkind = \"trees\"\n[[effect]]\nkind = \"roughness\"\n"
                    "[[effect]]\nkind = \"fragmentation\"\nspeed = 3.0\n"
                    "[[effect]]\nkind = \"release_motion\"\n[[effect]]\nkind = \"block_shape\"\n");
    const std::vector<std::string> plane{"--set", "model.dimension=2", "--set", "release.count=60"};
    std::vector<std::string> args{"run", site, "--threads", "1"};
    args.insert(args.end(), plane.begin(), plane.end());
    const Outcome run = scree_program(args);
    ASSERT_EQ(run.code, 0) << run.err;
    const Outcome again = scree_program(
        {"run", (folder / "out/run.toml").string(), "--output", (folder / "again").string(), "--threads", "2"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(text_of(folder / "out/results.gpkg"), text_of(folder / "again/results.gpkg"));
    EXPECT_THAT(run.out, HasSubstr("60 blocks thrown"));
    const Outcome free = scree_program({"run", site, "--set", "model.dimension=2", "--set", "release.count=60", "--set",
                                        "effect.net.capacity=0", "--output", (folder / "free").string()});
    EXPECT_NE(run.out, free.out);
}

TEST(EffectRun, SaysWhereNoProfilePasses) {
    const auto checked = [](const std::string& place) {
        const TempDir folder;
        return scree_program({"check", quarry_with(folder.path(), "[[effect]]\nkind = \"ground_drag\"\n" + place),
                              "--set", "model.dimension=2"});
    };
    const Outcome reversed = checked("from = 50\nto = 5\n");
    EXPECT_EQ(reversed.code, 3);
    EXPECT_THAT(reversed.err, HasSubstr("effect ground_drag: from = 50 m lies beyond to = 5 m"));
    const Outcome beyond = checked("from = 5000\nto = 6000\n");
    EXPECT_EQ(beyond.code, 0);
    EXPECT_THAT(beyond.err, HasSubstr("effect ground_drag acts beyond the end of every profile"));
    const Outcome there = checked("from = 5\nto = 40\n");
    EXPECT_EQ(there.code, 0);
    EXPECT_THAT(there.err, Not(HasSubstr("it does nothing here")));
    EXPECT_THAT(there.out, HasSubstr("from 5 to 40 m along the profile"));
}

TEST(EffectRun, MeasurementEffectsLeaveTheRunAlone) {
    std::string all;
    for (const EffectInfo& info : effect_catalogue())
        if (info.hook == EffectHook::Measurement) all += std::string("[[effect]]\nkind = \"") + info.name + "\"\n";
    EXPECT_EQ(stops_with(all, false), stops_with("", false)) << "no block feels them";
    const TempDir folder;
    const std::string site = quarry_with(folder.path(), "[[effect]]\nkind = \"speed_error\"\n");
    const Outcome run = scree_program({"run", site, "--set", "release.count=2"});
    EXPECT_EQ(run.code, 0);
    EXPECT_THAT(run.err, HasSubstr("effect speed_error acts on simulated measurements only"));
}

TEST(EffectCatalogueCommand, FitsOnOneScreen) {
    const Outcome outcome = scree_program({"effects"});
    EXPECT_EQ(outcome.code, 0);
    std::istringstream lines(outcome.out);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 120U) << line;
    EXPECT_LE(count, 40U);
    for (const EffectInfo& info : effect_catalogue()) EXPECT_THAT(outcome.out, HasSubstr(info.name));
}

// What is printed of a kind ends with an entry that the reader takes.
TEST(EffectCatalogueCommand, DetailsEndWithAnEntryToCopy) {
    for (const EffectInfo& info : effect_catalogue()) {
        const Outcome outcome = scree_program({"effects", info.name});
        EXPECT_EQ(outcome.code, 0);
        EXPECT_THAT(outcome.out, HasSubstr("formula"));
        EXPECT_THAT(outcome.out, HasSubstr("source"));
        const TempDir folder;
        const std::string site = quarry_with(folder.path(), outcome.out.substr(outcome.out.find("[[effect]]")));
        EXPECT_NO_THROW(cli::read_site_file(site, {})) << info.name;
    }
    EXPECT_THAT(scree_program({"effects", "soil_patch"}).out,
                HasSubstr("# rolling = ...    of the soil where it is not given"));
    const Outcome unknown = scree_program({"effects", "gravity"});
    EXPECT_EQ(unknown.code, 3);
    EXPECT_THAT(unknown.err, HasSubstr("there is no effect gravity; scree effects lists them"));
}

}  // namespace
}  // namespace scree::test
