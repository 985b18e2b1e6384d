// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements as the library is told of them, and the test that a simulation repeats.
#include "cli/observed_site.hpp"

#include "cli/account.hpp"
#include "cli/commands.hpp"
#include "cli/field_test.hpp"
#include "cli/program.hpp"
#include "cli/results.hpp"
#include "cli/site_file.hpp"
#include "cli/site_model.hpp"
#include "gis/sha256.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

namespace scree::cli {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

fs::path riddle() {
    return test::quarry_a().parent_path() / "quarry_riddle";
}

std::string crossings_of_riddle() {
    return test::text_of(riddle() / "observed" / "screen_crossings.csv");
}

// Without numbers of blocks, stops and how many were thrown, the screen that saw most says how large the test was.
TEST(ObservedSite, APoolOfCrossingsIsThrownAsOftenAsItTells) {
    const test::TempDir folder;
    test::put(folder / "screen_crossings.csv",
              std::regex_replace(crossings_of_riddle(), std::regex("(screen|ES[12]-A),[^,]*,"), "$1,"));
    const SiteFile site = read_site_file(riddle() / "site.toml", {});
    const SiteModel model = load_site(site);
    const ObservedSite observed = load_observed(site, model, folder.path().string());
    ASSERT_FALSE(observed.observations.matched);
    ASSERT_EQ(observed.observations.thrown, 0);
    const auto& crossings = observed.observations.crossings;
    const auto at = [&](std::int32_t screen) {
        return std::count_if(crossings.begin(), crossings.end(),
                             [&](const ObservedCrossing& c) { return c.screen == screen; });
    };
    EXPECT_EQ(blocks_of(observed), std::max(at(0), at(1)));
    const FreeKeys keys = read_free_keys(site, {"soil.loose waste.rolling=0.02:0.08"});
    const CampaignResult twice = FieldTest(site, model, observed, keys, 1).run(site, 1, 2);
    EXPECT_EQ(std::ssize(twice.blocks), 2 * blocks_of(observed));
}

// A file may be edited while a simulation runs: the account has what was read.
TEST(ObservedSite, FilesAreHashedWhenTheyAreRead) {
    const test::TempDir folder;
    const fs::path table = folder / "screen_crossings.csv";
    test::put(table, crossings_of_riddle());
    const std::string read = gis::sha256_of_file(table);
    const SiteFile site = read_site_file(riddle() / "site.toml", {});
    const SiteModel model = load_site(site);
    const ObservedSite observed = load_observed(site, model, folder.path().string());
    test::put(table, "edited");
    const std::vector<std::string> lines = input_lines(model, observed);
    ASSERT_GT(lines.size(), 2u);
    EXPECT_EQ(lines.front(), "screen_crossings.csv (measured), sha256 " + read);
    for (const gis::InputFile& file : model.files) EXPECT_EQ(file.sha256, gis::sha256_of_file(file.path));
}

// Innovations go from screen to screen: the order is that of the path, whatever that of the layer.
TEST(ObservedSite, ScreensComeInTheOrderOfThePath) {
    const auto observed_with = [](const std::string& chainages) {
        const SiteFile site =
            read_site_file(riddle() / "site.toml", {"screens.file=", "screens.chainages=" + chainages});
        return load_observed(site, load_site(site), (riddle() / "observed").string());
    };
    const ObservedSite down = observed_with("ES1-A = 39.5, ES2-A = 48.5"),
                       up = observed_with("ES2-A = 48.5, ES1-A = 39.5");
    EXPECT_THAT(down.op.screens, ElementsAre("ES1-A", "ES2-A"));
    EXPECT_THAT(down.op.screen_of, ElementsAre(0, 1));
    EXPECT_THAT(up.op.screens, ElementsAre("ES1-A", "ES2-A"));
    EXPECT_THAT(up.op.screen_of, ElementsAre(1, 0));
    ASSERT_EQ(up.observations.crossings.size(), down.observations.crossings.size());
    for (std::size_t k = 0; k < up.observations.crossings.size(); ++k)
        EXPECT_EQ(up.observations.crossings[k].screen, down.observations.crossings[k].screen);
}

// What pushes or spins a block at its start may make it faster than a fall: no fault of the measurements.
TEST(ObservedSite, SpeedsThatTheReleaseGivesAreNoFault) {
    const test::TempDir folder;
    const std::string site = test::quarry_with(folder.path(), "[[effect]]\nkind = \"release_motion\"\nspeed = 12.0\n");
    const std::vector<std::string> changes{"model.dimension=2", "screens.file=", "screens.chainages=below = 20"};
    std::vector<std::string> args{"run", site, "--output", (folder / "field").string(), "--set", "release.count=10"};
    for (const std::string& change : changes) args.insert(args.end(), {"--set", change});
    ASSERT_EQ(test::scree_program(args).code, 0);
    const SiteFile read = read_site_file(site, changes);
    const ObservedSite observed = load_observed(read, load_site(read), (folder / "field").string());
    EXPECT_FALSE(observed.observations.crossings.empty());
    EXPECT_FALSE(observed.has_errors());
}

// A block whose start was measured starts there each time that it is simulated: in 2D at its foot on the profile, if that is near.
TEST(ObservedSite, BlocksStartWhereTheyWereLetGo) {
    const test::TempDir folder;
    const std::string file = (test::quarry_a() / "site.toml").string();
    const auto field_test = [&](const std::string& name, const std::string& dimension) {
        const fs::path field = folder / name;
        std::vector<std::string> args{"run", file, "--output", field.string()};
        for (const std::string& set :
             {std::string("release.count=6"), std::string("model.seed=5"), "model.dimension=" + dimension})
            args.insert(args.end(), {"--set", set});
        EXPECT_EQ(test::scree_program(args).code, 0);
        return field.string();
    };
    const auto simulated = [&](const std::string& field, std::vector<std::string> changes, ObservedSite& observed) {
        const SiteFile site = read_site_file(file, changes);
        const SiteModel model = load_site(site);
        observed = load_observed(site, model, field);
        const FreeKeys keys = read_free_keys(site, {"soil.loose waste.rolling=0.02:0.08"});
        return FieldTest(site, model, observed, keys, 1).run(site, 77, 2).blocks;
    };
    const std::string space = field_test("space", "3"), plane = field_test("plane", "2");
    const auto release_of = [](const std::string& field, std::int64_t k) {
        return test::read_points(fs::path(field) / "results.gpkg", "release_points")[static_cast<std::size_t>(k)].at;
    };

    ObservedSite observed;
    const auto in_space = simulated(space, {"model.dimension=3"}, observed);
    ASSERT_EQ(in_space.size(), 12u);
    const Vec2 shift = release_of(space, 0).head<2>() - in_space[0].release.head<2>();  // map and local frame
    for (std::int64_t k = 0; k < 12; ++k)
        EXPECT_LT((release_of(space, k % 6).head<2>() - in_space[static_cast<std::size_t>(k)].release.head<2>() - shift)
                      .norm(),
                  1e-6);
    EXPECT_NE(in_space[0].stop, in_space[6].stop) << "it is turned another way";

    const auto in_plane = simulated(plane, {"model.dimension=2"}, observed);
    ASSERT_EQ(in_plane.size(), 12u);
    for (std::int64_t k = 0; k < 12; ++k)
        EXPECT_LT((release_of(plane, k % 6).head<2>() - in_plane[static_cast<std::size_t>(k)].release.head<2>() - shift)
                      .norm(),
                  1e-6);
    const auto anywhere = simulated(plane, {"model.dimension=2", "observed.release_positions=false"}, observed);
    EXPECT_NE(anywhere[0].release_s, anywhere[6].release_s);

    // Of those of the release area some are nearer to the profile than half a metre.
    const auto some = simulated(space, {"model.dimension=2", "profile.release_distance=0.5"}, observed);
    std::size_t near = 0;
    for (const ObservedBlock& b : observed.observations.blocks) near += b.profile >= 0;
    EXPECT_LT(near, 6u);
    const auto warned = std::count_if(observed.findings.begin(), observed.findings.end(), [](const Finding& f) {
        return std::string(f.check) == "release_beside_profile" && f.severity == Severity::Warning;
    });
    EXPECT_EQ(warned, 1);
    for (std::size_t k = 0; k < 6; ++k)
        if (observed.observations.blocks[k].profile >= 0) {
            EXPECT_EQ(some[k].release_s, observed.observations.blocks[k].s);
        }
}

// Where blocks were let go is judged like what else was measured: whose it is, how far from the release layer, and that blocks end below it.
TEST(ObservedSite, ReleasePointsAreJudged) {
    const test::TempDir folder;
    const SiteFile site = read_site_file(test::quarry_with(folder.path(), ""), {"model.dimension=3"});
    const SiteModel model = load_site(site);
    const test::Outcome run = test::run_quarry_a(folder / "field", {"--set", "release.count=6", "--seed", "5"});
    ASSERT_EQ(run.code, 0) << run.err;
    const auto stops = test::read_points(folder / "field" / "results.gpkg", "stopping_points"),
               releases = test::read_points(folder / "field" / "results.gpkg", "release_points");
    const auto row = [](const std::string& id, const auto& point) {
        return id + "," + std::to_string(point.at.x()) + "," + std::to_string(point.at.y()) + "\n";
    };
    const auto found = [&](const std::string& of_stops, const std::string& of_releases) {
        fs::create_directories(folder / "obs");
        test::put(folder / "obs" / "stopping_points.csv", "block_id,easting_m,northing_m\n" + of_stops);
        test::put(folder / "obs" / "release_points.csv", "block_id,easting_m,northing_m\n" + of_releases);
        std::vector<std::string> checks;
        for (const Finding& f : load_observed(site, model, (folder / "obs").string()).findings)
            if (std::regex_search(f.check, std::regex("release|start")))
                checks.push_back((f.severity == Severity::Error ? "error " : "warning ") + std::string(f.check));
        return checks;
    };
    const std::string both_stops = row("A", stops[0]) + row("B", stops[1]);
    EXPECT_THAT(found(both_stops, row("A", releases[0]) + row("B", releases[1])), ElementsAre());
    EXPECT_THAT(found(both_stops, row("A", releases[0]) + row("A", releases[1])), ElementsAre("error release_twice"));
    EXPECT_THAT(found(both_stops, row("A", releases[0]) + row("C", releases[1])),
                ElementsAre("warning release_unmeasured"));
    const auto lowest = *std::max_element(stops.begin(), stops.end(),  // the slope falls to the east
                                          [](const auto& a, const auto& b) { return a.at.x() < b.at.x(); });
    EXPECT_THAT(found(row("A", lowest), row("A", lowest)), ElementsAre("warning release_far"));
    EXPECT_THAT(found(row("A", releases[0]), row("A", lowest)),
                ElementsAre("warning release_far", "warning stop_above_start"));
}

// Blocks go down the path that begins where they were let go: a feature of the release layer, or in 2D a profile.
TEST(ObservedSite, PathsBeginWhereBlocksWereLetGo) {
    const test::TempDir folder;
    const std::string file = test::quarry_with(folder.path(), "");
    test::put_two_releases(folder / "two.geojson");
    for (const std::string dimension : {"2", "3"}) {
        const std::vector<std::string> changes{"release.file=two.geojson", "model.dimension=" + dimension};
        const std::string field = (folder / ("field" + dimension)).string();
        std::vector<std::string> args{"run", file, "--output", field, "--set", "release.count=16", "--seed", "5"};
        for (const std::string& change : changes) args.insert(args.end(), {"--set", change});
        const test::Outcome run = test::scree_program(args);
        ASSERT_EQ(run.code, 0) << run.err;
        const SiteFile site = read_site_file(file, changes);
        const ObservedSite observed = load_observed(site, load_site(site), field);
        const Observations& o = observed.observations;
        if (dimension == "2")
            EXPECT_THAT(o.paths, ElementsAre("profile 1", "profile 2"));
        else
            EXPECT_THAT(o.paths, ElementsAre("release feature 0", "release feature 1"));
        std::size_t of[2] = {0, 0};
        for (const ObservedBlock& b : o.blocks) {
            ASSERT_GE(b.path, 0);
            ++of[b.path];
            EXPECT_EQ(b.path == o.blocks[0].path, std::abs(b.release.y() - o.blocks[0].release.y()) < 8.0);
        }
        EXPECT_GE(of[0], 4u);
        EXPECT_GE(of[1], 4u);
        const auto plain = load_observed(read_site_file(file, {"model.dimension=" + dimension}),
                                         load_site(read_site_file(file, {"model.dimension=" + dimension})), field);
        EXPECT_LE(plain.observations.paths.size(), 1u) << "the site itself has one";
    }
}

// GDAL's names hold paths, which are the site's like any other: from whatever folder it is read, and in run.toml.
TEST(SiteFile, PathsInNamesOfGdalAreRelativeToTheSite) {
    const test::TempDir folder;
    fs::create_directories(folder / "site/data");
    test::put(folder / "site/data/s.gpkg", "here");
    SiteFile site;
    site.folder = folder / "site";
    const std::string data = (site.folder / "data").string();
    EXPECT_EQ(site.resolve("/vsizip/data/d.zip/dtm.tif"), "/vsizip/" + data + "/d.zip/dtm.tif");
    EXPECT_EQ(site.resolve("/vsizip/{data/d.zip}/dtm.tif"), "/vsizip/{" + data + "/d.zip}/dtm.tif");
    EXPECT_EQ(site.resolve("/vsizip//elsewhere/d.zip/dtm.tif"), "/vsizip//elsewhere/d.zip/dtm.tif");
    EXPECT_EQ(site.resolve("GPKG:data/s.gpkg:dtm"), "GPKG:" + data + "/s.gpkg:dtm");
    EXPECT_EQ(site.resolve("NETCDF:\"data/s.gpkg\":dtm"), "NETCDF:\"" + data + "/s.gpkg\":dtm");
    EXPECT_EQ(site.resolve("GTIFF_DIR:2:data/s.gpkg"), "GTIFF_DIR:2:" + data + "/s.gpkg");
    EXPECT_EQ(site.resolve("PG:dbname=rocks"), "PG:dbname=rocks");
    EXPECT_EQ(site.resolve("/vsicurl/https://example.org/a.tif"), "/vsicurl/https://example.org/a.tif");

    SiteSettings settings;
    settings.dtm = "GPKG:data/s.gpkg:dtm";
    settings.release.file = "/vsizip/data/d.zip/r.gpkg";
    const std::string text = settings_from(site, settings, folder / "results/out");
    EXPECT_THAT(text, testing::HasSubstr("'GPKG:../../site/data/s.gpkg:dtm'"));
    EXPECT_THAT(text, testing::HasSubstr("'/vsizip/../../site/data/d.zip/r.gpkg'"));
}

// What stands beside a link (.prj, .tfw) belongs to it, and not to the file that it leads to.
TEST(SiteFile, LinksStayLinksInWhatReproducesARun) {
    const test::TempDir folder;
    fs::create_directories(folder / "site");
    fs::create_directories(folder / "store");
    test::put(folder / "store/dem.asc", "far");
    fs::create_symlink("../store/dem.asc", folder / "site/dtm.asc");
    SiteFile site;
    site.folder = folder / "site";
    SiteSettings settings;
    settings.dtm = "dtm.asc";
    EXPECT_THAT(settings_from(site, settings, folder / "site/out"), testing::HasSubstr("'../dtm.asc'"));
}

// Blocks that come from inside a ring cross its inner outline first.
TEST(Screens, OutlinesOfPolygonsHaveTheirHoles) {
    gis::VectorData data;
    data.layer.fields = {Field{"name", FieldType::Text, ""}};
    Feature ring;
    ring.geometry = MultiPolygon{Polygon{{{0, 0}, {9, 0}, {9, 9}, {0, 9}}, {{{3, 3}, {6, 3}, {6, 6}, {3, 6}}}}};
    ring.values = {std::string("ring")};
    data.layer.features = {ring};
    const std::vector<Screen> screens = make_screens(data, "name");
    ASSERT_EQ(screens.size(), 2u);
    EXPECT_EQ(screens[1].part_of, 0);
    EXPECT_EQ(screens[1].line.size(), 5u);
    EXPECT_EQ(screens[1].line.front(), Vec2(3, 3));
    EXPECT_EQ(screens[1].line.back(), screens[1].line.front());
}

// What stands beside the results has their name and more, with a slash at its end as without.
TEST(ResultsFolderName, EndsWithoutASlash) {
    SiteFile site;
    site.folder = "site";
    Context context;
    context.output = "diag/";
    EXPECT_EQ(context.results_folder(site), fs::path("diag"));
    context.output.clear();
    site.settings.output_directory = "out/";
    EXPECT_EQ(context.results_folder(site), fs::path("site/out"));
}

}  // namespace
}  // namespace scree::cli
