// SPDX-License-Identifier: GPL-3.0-or-later
// `scree run` and `scree terrain` on quarry_a with few blocks: what is written, and that it is the same whenever it should be.
#include "cli/program.hpp"
#include "cli/results.hpp"
#include "cli/site_file.hpp"
#include "cli/site_model.hpp"
#include "cli/terrain_layers.hpp"
#include "gis/input_files.hpp"
#include "scree/base/error.hpp"
#include "scree/dynamics/contact_problem_file.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

namespace scree::test {
namespace {

using testing::Gt;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
namespace fs = std::filesystem;

constexpr int kBlocks = 20;
constexpr double kLargestBlock = 1.5;     // [m] L1 of the block list is at most 1.44
constexpr double kModelAgainstDtm = 1.2;  // [m] the model of 1 m departs from the DTM by up to 1.11 m, on the rock cuts
const std::set<std::string> kPathsDiffer{"run.toml",
                                         "SHA256SUMS"};  // run.toml leads from the folder of results to the inputs

TEST(Run, WritesEveryLayerWithItsFields) {
    const TempDir folder;
    const fs::path out = folder / "out";
    const Outcome run = run_quarry_a(out);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("20 blocks thrown"));
    EXPECT_THAT(run.out, HasSubstr("1A: 0 % (95 % interval 0 to "));
    for (const char* name : {"results.gpkg", "results.qgs", "run.toml", "SHA256SUMS", "rasters/reach_probability.tif",
                             "rasters/reach_probability.qml"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    for (const char* quantity : {"energy_kj", "height_m", "speed_ms", "spin_rads"})
        for (const char* statistic : {"mean", "p50", "p90", "p95", "p98", "p99", "max"}) {
            const fs::path file = out / "rasters" / (std::string(quantity) + "_" + statistic + ".tif");
            EXPECT_TRUE(raster_facts(file).finite) << file;
            EXPECT_TRUE(fs::exists(fs::path(file).replace_extension(".qml"))) << file;
        }
    const fs::path gpkg = out / "results.gpkg";
    EXPECT_THAT(fields_of(gpkg, "stopping_points"),
                IsSupersetOf({"block", "block_id", "stop_reason", "mass_kg", "l1_m", "runout_m", "drop_m", "path_m",
                              "time_s", "speed_max_ms", "energy_max_kj"}));
    EXPECT_THAT(fields_of(gpkg, "trajectories"), IsSupersetOf({"block", "stop_reason", "speed_max_ms"}));
    EXPECT_THAT(fields_of(gpkg, "release_points"), IsSupersetOf({"block", "mass_kg", "raised_m"}));
    EXPECT_THAT(fields_of(gpkg, "screen_crossings"),
                IsSupersetOf({"screen", "block", "speed_ms", "height_m", "spin_rads", "energy_kj", "time_s"}));
    EXPECT_THAT(fields_of(gpkg, "deposit_zones"),
                IsSupersetOf({"name", "count", "released", "percent", "percent_low", "percent_high"}));
    EXPECT_THAT(fields_of(gpkg, "release_zones"), testing::Contains("release_feature"));
    for (const char* layer : {"stopping_points", "trajectories", "release_points", "screen_crossings", "deposit_zones",
                              "screens", "release_zones"})
        EXPECT_EQ(crs_code_of(gpkg, layer), "2154") << layer;
}

// A release area has the number that its blocks carry, whatever fields the input has.
TEST(Run, ReleaseZonesHaveTheNumbersOfTheirBlocks) {
    const TempDir folder;
    const fs::path file = folder / "releases.geojson", out = folder / "out";
    put_two_releases(file);
    std::string text = text_of(file);
    const std::string none = "\"properties\":{}";
    text.replace(text.find(none), none.size(), "\"properties\":{\"release_feature\":7}");
    put(file, text);
    ASSERT_EQ(run_quarry_a(out, {"--set", "release.file=" + file.string(), "--set", "model.dimension=2"}).code, 0);
    std::set<std::string> zones, blocks;
    for (const PointRow& zone : read_points(out / "results.gpkg", "release_zones"))
        zones.insert(zone.values.at("release_feature"));
    for (const PointRow& block : read_points(out / "results.gpkg", "release_points"))
        blocks.insert(block.values.at("release_feature"));
    EXPECT_EQ(zones.size(), 2U);
    EXPECT_EQ(zones, blocks);
}

TEST(Check, NamesTheColumnsOfBlocksThatAreNotRead) {
    const TempDir folder;
    put(folder / "blocks.csv", "block_id,mass_kg,L1_m,L2_m,L3_m,colour\nA,508,0.96,0.65,0.61,grey\n");
    const Outcome run = scree_program(
        {"check", (quarry_a() / "site.toml").string(), "--set", "blocks.list=" + (folder / "blocks.csv").string()});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("columns that are not read: colour;"));
}

/// Cells where quarry_a has its own.
RasterSpec terrain_of_quarry_a() {
    RasterSpec dtm;
    dtm.columns = 160;
    dtm.rows = 80;
    dtm.geotransform = {890000.0, 1.0, 0.0, 6670080.0, 0.0, -1.0};
    return dtm;
}

// A wrong unit shows in what falls and in how steep the ground is.
TEST(Check, SaysWhatFallsAndHowSteepTheGroundIs) {
    const auto check = [](std::vector<std::string> more) {
        more.insert(more.begin(), {"check", (quarry_a() / "site.toml").string()});
        return scree_program(more);
    };
    const Outcome drawn = check({"--set", "blocks.list=", "--set", "blocks.volume=2", "--set", "model.seed=3"});
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_THAT(drawn.out, HasSubstr("volume law constant: 2 m3, 5200 kg, L1 "));
    EXPECT_THAT(drawn.out, testing::ContainsRegex("slopes of [0-9]+, [0-9]+ and [0-9]+ degrees"));
    EXPECT_THAT(drawn.out, HasSubstr("site.toml --set blocks.list= --set blocks.volume=2 --set model.seed=3"))
        << "what runs next is what was checked";
    const Outcome long_arm = check({"--set", "soil.loose waste.rolling=2"});
    ASSERT_EQ(long_arm.code, 0) << long_arm.err;
    EXPECT_THAT(long_arm.err, HasSubstr("soil.loose waste.rolling = 2 m is more than half the length"));
    EXPECT_THAT(long_arm.out, HasSubstr("--set 'soil.loose waste.rolling=2'"));
    EXPECT_THAT(check({"--set", "soil.loose waste.rolling=0.2"}).err, testing::Not(HasSubstr("half the length")));

    const TempDir folder;
    RasterSpec dtm = terrain_of_quarry_a();
    for (const auto& [factor, words] : {std::pair<double, const char*>{6.0, "half of the terrain is steeper than"},
                                        {0.002, "95 % of the terrain are gentler than"}}) {
        dtm.value = [factor = factor](int c, int) { return 200.0 - factor * 0.5 * c; };
        write_raster((folder / "dtm.tif").string(), dtm);
        EXPECT_THAT(check({"--set", "terrain.dtm=" + (folder / "dtm.tif").string()}).err, HasSubstr(words));
    }
}

// 0 % pass where there is no ground says nothing: the model says that it has none there.
TEST(Run, TellsWhatStandsWhereThereIsNoGround) {
    const TempDir folder;
    RasterSpec dtm = terrain_of_quarry_a();
    dtm.nodata = -9999.0;
    dtm.value = [](int c, int) { return c < 120 ? 200.0 - 0.6 * c : -9999.0; };
    write_raster((folder / "dtm.tif").string(), dtm);
    VectorSpec screens;
    screens.text_field = "name";
    screens.rows = {{"LINESTRING(890060 6670000,890060 6670080)", "near", 1.0},
                    {"LINESTRING(890150 6670010,890150 6670070)", "hole", 1.0}};
    write_vector((folder / "screens.gpkg").string(), screens);
    VectorSpec zones;
    zones.text_field = "name";
    zones.rows = {
        {"POLYGON((890070 6670000,890119 6670000,890119 6670080,890070 6670080,890070 6670000))", "low", 1.0},
        {"POLYGON((890130 6670000,890155 6670000,890155 6670080,890130 6670080,890130 6670000))", "off", 1.0},
        {"POLYGON((890080.1 6670040.1,890080.2 6670040.1,890080.2 6670040.2,890080.1 6670040.1))", "tiny", 1.0}};
    write_vector((folder / "zones.gpkg").string(), zones);
    const std::string site = quarry_with(
        folder.path(), "\n[[effect]]\nkind = \"net\"\nfile = \"net.gpkg\"\ncapacity = 500.0\nheight = 5.0\n");
    VectorSpec net;
    net.text_field = "name";
    net.rows = {{"LINESTRING(890140 6670010,890140 6670070)", "net", 1.0}};
    write_vector((folder / "net.gpkg").string(), net);
    const Outcome run = scree_program(
        {"run", site, "--set", "release.count=3", "--set", "terrain.dtm=" + (folder / "dtm.tif").string(), "--set",
         "screens.file=" + (folder / "screens.gpkg").string(), "--set",
         "deposit_zones.file=" + (folder / "zones.gpkg").string(), "--output", (folder / "out").string()});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("screen hole stands where the terrain has no ground"));
    EXPECT_THAT(run.err, HasSubstr("deposit zone off lies where the terrain has no ground"));
    EXPECT_THAT(run.err, HasSubstr("effect net is drawn where the terrain has no ground"));
    EXPECT_THAT(run.err, testing::Not(testing::ContainsRegex("(near|low|tiny) (stands|lies) where")));
    EXPECT_THAT(run.out, HasSubstr("hole: stands where no block can pass"));
    EXPECT_THAT(run.out, HasSubstr("off: lies where no block can stop"));
    EXPECT_THAT(run.out, testing::ContainsRegex("near: [0-9]+ % pass"));
}

TEST(Run, KeepsTheFirstImpacts) {
    const TempDir folder;
    for (const char* dimension : {"2", "3"}) {
        const fs::path out = folder / dimension;
        const Outcome run = run_quarry_a(out, {"--set", "release.count=20", "--set", "output.impacts=2", "--set",
                                               std::string("model.dimension=") + dimension});
        ASSERT_EQ(run.code, 0) << run.err;
        const Outcome without = run_quarry_a(folder / (std::string(dimension) + "_without"),
                                             {"--set", std::string("model.dimension=") + dimension});
        const auto counts = [](const std::string& text) {
            return text.substr(text.find("screen "), text.find("results ") - text.find("screen "));
        };
        EXPECT_EQ(counts(run.out), counts(without.out)) << "impacts are no crossings of a screen";
        const auto impacts = read_points(out / "results.gpkg", "impacts");
        ASSERT_GT(impacts.size(), 20U);
        ASSERT_LE(impacts.size(), 40U);
        for (const PointRow& i : impacts) {
            EXPECT_LT(i.number("rise_before_ms"), 0.0);
            EXPECT_LE(std::abs(i.number("rise_after_ms")), i.number("speed_after_ms"));
            EXPECT_GE(i.number("impact"), 1.0);
            EXPECT_LE(i.number("impact"), 2.0);
        }
    }
    // results can stand in for measurements
    const Outcome compared =
        scree_program({"compare", (quarry_a() / "site.toml").string(), "--observed", (folder / "3").string(), "--set",
                       "observed.repeats=5", "--output", (folder / "compared").string()});
    EXPECT_EQ(compared.code, 0) << compared.err;
    EXPECT_THAT(compared.out, HasSubstr("speed at the end of impact 1"));
    EXPECT_THAT(compared.out + compared.err, testing::Not(HasSubstr("fields that are not read")));
}

TEST(Run, CountsClose) {
    const TempDir folder;
    const fs::path out = folder / "out";
    ASSERT_EQ(run_quarry_a(out).code, 0);
    const auto stops = read_points(out / "results.gpkg", "stopping_points");
    ASSERT_EQ(stops.size(), kBlocks);
    std::map<std::string, int> reasons;
    std::set<std::string> numbers;
    for (const PointRow& stop : stops) {
        ++reasons[stop.values.at("stop_reason")];
        numbers.insert(stop.values.at("block"));
    }
    EXPECT_EQ(numbers.size(), kBlocks) << "every block once";
    EXPECT_EQ(reasons["at_rest"] + reasons["left_terrain"] + reasons["time_limit"] + reasons["failed"], kBlocks);
    EXPECT_EQ(raster_facts(out / "rasters" / "deposits.tif").sum, reasons["at_rest"]);
    EXPECT_LE(raster_facts(out / "rasters" / "passages.tif").high, kBlocks);
    EXPECT_LE(raster_facts(out / "rasters" / "reach_probability.tif").high, 1.0);
    EXPECT_EQ(read_points(out / "results.gpkg", "release_points").size(), kBlocks);
}

/// The rasters of a run, read when they are asked for.
double cell_at(const fs::path& out, const std::string& raster, const Vec3& at) {
    return raster_at(out / "rasters" / (raster + ".tif"), at.x(), at.y());
}

// Where a block crosses a screen the maps know at least its energy, speed and height, in their units, and no more than the largest of its way.
TEST(Run, MapsKnowWhatCrossesAScreen) {
    const TempDir folder;
    const fs::path out = folder / "out";
    ASSERT_EQ(run_quarry_a(out, {"--set", "release.count=1"}).code, 0);
    const PointRow stop = read_points(out / "results.gpkg", "stopping_points").at(0);
    const auto crossings = read_points(out / "results.gpkg", "screen_crossings");
    ASSERT_FALSE(crossings.empty());
    for (const PointRow& c : crossings) {
        for (const char* quantity : {"energy_kj", "speed_ms", "height_m", "spin_rads"}) {
            const double here = c.number(quantity), largest = cell_at(out, std::string(quantity) + "_max", c.at);
            EXPECT_GE(largest, 0.9999 * here) << quantity;
            EXPECT_LE(largest, 1.5 * here + 1.0) << quantity << ": a cell is 1 m wide";
            EXPECT_NEAR(cell_at(out, std::string(quantity) + "_mean", c.at), largest, 1e-3) << "of one block";
            EXPECT_NEAR(cell_at(out, std::string(quantity) + "_p50", c.at), largest, 0.0101 * largest);
        }
        EXPECT_LE(cell_at(out, "energy_kj_max", c.at), stop.number("energy_max_kj") * 1.00001);
        EXPECT_LE(cell_at(out, "speed_ms_max", c.at), stop.number("speed_max_ms") * 1.00001);
        EXPECT_EQ(cell_at(out, "passages", c.at), 1.0);
        EXPECT_EQ(cell_at(out, "reach_probability", c.at), 1.0);
    }
    EXPECT_EQ(cell_at(out, "deposits", stop.at), 1.0);
}

// Where two blocks pass, the lower one is the 50 % quantile, the other all quantiles above, and the mean lies in the middle.
TEST(Run, MapsOfQuantilesAreWhatTheySay) {
    const TempDir folder;
    const fs::path out = folder / "out";
    ASSERT_EQ(run_quarry_a(out).code, 0);
    const auto cells = [&](const std::string& name) { return raster_cells(out / "rasters" / (name + ".tif")); };
    const std::vector<double> passages = cells("passages"), p50 = cells("speed_ms_p50"), mean = cells("speed_ms_mean"),
                              most = cells("speed_ms_max");
    int apart = 0;
    for (const char* percent : {"p90", "p95", "p98", "p99"}) {
        const std::vector<double> upper = cells(std::string("speed_ms_") + percent);
        for (std::size_t k = 0; k < passages.size(); ++k) {
            if (passages[k] != 2.0) continue;
            apart += most[k] > 1.05 * p50[k];
            EXPECT_NEAR(mean[k], 0.5 * (p50[k] + most[k]), 0.0051 * p50[k] + 1e-3);
            EXPECT_NEAR(upper[k], most[k], 0.0101 * most[k]) << percent;
        }
    }
    EXPECT_GT(apart, 100) << "or the test says nothing";
    for (std::size_t k = 0; k < mean.size(); ++k)
        if (passages[k] > 0.0) {
            EXPECT_LE(mean[k], most[k]);
        }
}

TEST(Run, BlocksStopOnTheTerrain) {
    const TempDir folder;
    const fs::path out = folder / "out";
    ASSERT_EQ(run_quarry_a(out).code, 0);
    for (const PointRow& stop : read_points(out / "results.gpkg", "stopping_points")) {
        EXPECT_GE(stop.at.x(), 890'000);
        EXPECT_LE(stop.at.x(), 890'160);
        EXPECT_GE(stop.at.y(), 6'670'000);
        EXPECT_LE(stop.at.y(), 6'670'080);
        if (stop.values.at("stop_reason") != "at_rest") continue;
        const double above = stop.at.z() - raster_at(quarry_a() / "data" / "dtm.tif", stop.at.x(), stop.at.y());
        EXPECT_GT(above, -kModelAgainstDtm) << "block " << stop.values.at("block");
        EXPECT_LT(above, kLargestBlock + kModelAgainstDtm) << "block " << stop.values.at("block");
        EXPECT_GT(stop.number("drop_m"), 0.0);
    }
}

TEST(Run, ThreadsAndRepetitionDoNotChangeAByte) {
    const TempDir folder;
    // in one place after the other, so that run.toml is the same, too
    const fs::path out = folder / "out";
    ASSERT_EQ(run_quarry_a(out, {"--threads", "1"}).code, 0);
    fs::rename(out, folder / "first");
    for (const char* threads : {"1", "2", "3"}) {
        ASSERT_EQ(run_quarry_a(out, {"--threads", threads}).code, 0);
        EXPECT_THAT(differing_files(folder / "first", out), IsEmpty()) << threads << " threads";
        fs::remove_all(out);
    }
}

TEST(Run, RunTomlReproducesTheLayers) {
    const TempDir folder;
    ASSERT_EQ(run_quarry_a(folder / "first", {"--set", "soil.loose waste.rolling=0.06", "--seed", "7"}).code, 0);
    const Outcome again =
        scree_program({"run", (folder / "first" / "run.toml").string(), "--output", (folder / "again").string()});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_THAT(differing_files(folder / "first", folder / "again", kPathsDiffer), IsEmpty());
    // without --output it writes into a folder of its own
    ASSERT_EQ(scree_program({"run", (folder / "first" / "run.toml").string()}).code, 0);
    EXPECT_THAT(differing_files(folder / "again", folder / "first" / "rerun", kPathsDiffer), IsEmpty());
}

TEST(Run, BlocksDoNotDependOnHowManyAreThrown) {
    const TempDir folder;
    ASSERT_EQ(run_quarry_a(folder / "twenty").code, 0);
    ASSERT_EQ(run_quarry_a(folder / "five", {"--set", "release.count=5"}).code, 0);
    const auto twenty = read_points(folder / "twenty" / "results.gpkg", "stopping_points"),
               five = read_points(folder / "five" / "results.gpkg", "stopping_points");
    ASSERT_EQ(five.size(), 5U);
    std::map<std::string, Vec3> at;
    for (const PointRow& stop : twenty) at[stop.values.at("block")] = stop.at;
    for (const PointRow& stop : five) EXPECT_EQ(stop.at, at.at(stop.values.at("block")));
}

TEST(Run, KeepsContactProblemsAboveTheTolerance) {
    const TempDir folder;
    auto kept = [&](const std::string& name, const std::string& most) {
        const fs::path out = folder / name;
        const Outcome run = run_quarry_a(out, {"--set", "release.count=2", "--set", "model.solver_tolerance=1e-17",
                                               "--set", "output.contact_problems=" + most});
        EXPECT_EQ(run.code, 0) << run.err;
        std::vector<fs::path> files;
        for (const auto& entry : fs::directory_iterator(out))
            if (entry.path().filename().string().starts_with("contact_problem_")) files.push_back(entry.path());
        return files;
    };
    EXPECT_THAT(kept("none", "0"), IsEmpty());
    const auto files = kept("three", "3");  // beyond rounding
    ASSERT_THAT(files, testing::SizeIs(3));
    for (const fs::path& file : files) {
        std::ifstream in(file);
        EXPECT_GT(read_contact_problem<3>(in, file.string()).count, 0);
    }
}

TEST(Run, RefusesMoreResultCellsThanMemoryHolds) {
    const TempDir folder;
    const Outcome run = run_quarry_a(folder / "out", {"--set", "output.resolution=0.002"});
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("output.resolution = 0.002 m gives "));
    EXPECT_THAT(run.err, HasSubstr("more than the 100 million that are allowed"));
    EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Run, SeedChangesTheBlocks) {
    const TempDir folder;
    ASSERT_EQ(run_quarry_a(folder / "one", {"--set", "release.count=3"}).code, 0);
    ASSERT_EQ(run_quarry_a(folder / "two", {"--set", "release.count=3", "--seed", "2"}).code, 0);
    EXPECT_NE(read_points(folder / "one" / "results.gpkg", "stopping_points")[0].at,
              read_points(folder / "two" / "results.gpkg", "stopping_points")[0].at);
}

TEST(Run, LeavesResultsAloneUnlessTold) {
    const TempDir folder;
    const fs::path out = folder / "out";
    ASSERT_EQ(run_quarry_a(out, {"--set", "release.count=2"}).code, 0);
    put(out / "notes.txt", "mine");
    const auto before = contents_of(out);
    const Outcome refused = run_quarry_a(out, {"--set", "release.count=3"});
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
    EXPECT_THAT(refused.out, IsEmpty());
    EXPECT_EQ(contents_of(out), before);

    EXPECT_EQ(run_quarry_a(out, {"--set", "release.count=3", "--overwrite"}).code, 0);
    EXPECT_EQ(read_points(out / "results.gpkg", "stopping_points").size(), 3U);
    EXPECT_EQ(text_of(out / "notes.txt"), "mine");

    // nor is a site file in them replaced that the run itself reads
    const auto now = contents_of(out);
    const Outcome own = scree_program({"run", (out / "run.toml").string(), "--output", out.string(), "--overwrite"});
    EXPECT_EQ(own.code, 3);
    EXPECT_THAT(own.err, HasSubstr("run.toml: is an input, and lies in"));
    EXPECT_EQ(contents_of(out), now);

    fs::create_directories(folder / "photos");
    put(folder / "photos" / "slope.jpg", "a picture");
    const Outcome foreign = run_quarry_a(folder / "photos", {"--overwrite"});
    EXPECT_EQ(foreign.code, 3);
    EXPECT_EQ(contents_of(folder / "photos").size(), 1U);
}

// What a line break hides, sizes that only memory would refuse, names that would take the parser too deep.
TEST(Run, RefusesWhatWouldBeTakenAmiss) {
    const TempDir folder;
    const auto check = [](const std::vector<std::string>& more) {
        std::vector<std::string> args{"check", (quarry_a() / "site.toml").string()};
        args.insert(args.end(), more.begin(), more.end());
        const Outcome run = scree_program(args);
        EXPECT_EQ(run.code, 3);
        return run.err;
    };
    EXPECT_THAT(check({"--set", "release.count=5\nmodel.seed=3"}), HasSubstr("a value is one line"));
    EXPECT_THAT(check({"--set", "model.dimension=2", "--set", "profile.spacing=0.001"}),
                HasSubstr("more than a million starting points"));
    EXPECT_THAT(check({"--set", "release.count=1e3"}), HasSubstr("a whole number from 1 to 1000000000"));
    std::string name = "a";
    for (int k = 0; k < 50000; ++k) name += ".a";
    put(folder / "deep.toml", "[terrain]\n" + name + " = 1\n");
    const Outcome deep = scree_program({"check", (folder / "deep.toml").string()});
    EXPECT_EQ(deep.code, 3);
    EXPECT_THAT(deep.err, HasSubstr("deep.toml:2: a name of more than a hundred parts"));
}

// A scan saved where the comma is the decimal point.
TEST(ShapeFile, ReadsDecimalCommasAndRefusesWhatIsNoPoint) {
    const TempDir folder;
    put(folder / "shape.txt", "0;0;0\n1,5;0;0\n0;1,25;0\n0;0;-0,75\n");
    const std::vector<Vec3> points = cli::read_shape_points(folder / "shape.txt");
    ASSERT_EQ(points.size(), 4U);
    EXPECT_EQ(points[1], Vec3(1.5, 0, 0));
    EXPECT_EQ(points[3], Vec3(0, 0, -0.75));
    put(folder / "points.txt", "0,0,0\n1.5,0,0\n0,1.25,0\n0,0,-0.75\n");
    EXPECT_EQ(cli::read_shape_points(folder / "points.txt"), points);
    put(folder / "unclear.txt", "0 0 0\n1,5 0,0 0,0\n0 1,25 0\n0 0 -0,75\n");
    EXPECT_THROW(cli::read_shape_points(folder / "unclear.txt"), InputError) << "six numbers are no point";
    put(folder / "SCAN.OBJ", "v 0 0 0\nv 1.5 0 0\nv 0 1.25 0\nv 0 0 -0.75\nvn 0 0 1\n");
    EXPECT_EQ(cli::read_shape_points(folder / "SCAN.OBJ"), points);
    put(folder / "flat.txt", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
    try {
        cli::read_shape_points(folder / "flat.txt");
        FAIL() << "flat";
    } catch (const InputError& e) {
        EXPECT_THAT(e.what(), HasSubstr("flat.txt: the 4 points of a block shape span no volume"));
    }
}

// A colon belongs to names of GDAL where something is read; what is written is a path.
TEST(Run, AFolderWithAColonLiesBesideTheSite) {
    const cli::SiteFile site = cli::read_site_file(quarry_a() / "site.toml", {"output.directory=run 12:30"});
    EXPECT_EQ(site.beside(site.settings.output_directory), quarry_a() / "run 12:30");
}

TEST(Run, NamesWhatAKilledRunLeftBehind) {
    const TempDir folder;
    fs::create_directories(folder / "out.partial-1234567");
    const Outcome run = run_quarry_a(folder / "out", {"--set", "release.count=2"});
    EXPECT_EQ(run.code, 0);
    EXPECT_THAT(run.err, HasSubstr("out.partial-1234567"));
    EXPECT_TRUE(fs::exists(folder / "out.partial-1234567")) << "it may belong to a run on another machine";
}

TEST(Run, ProgressAsJsonIsOneObjectALine) {
    const TempDir folder;
    const Outcome run = run_quarry_a(folder / "out", {"--progress=json", "--quiet"});
    ASSERT_EQ(run.code, 0);
    EXPECT_THAT(run.out, IsEmpty());
    std::istringstream lines(run.err);
    int objects = 0;
    std::string last;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("warning: ")) continue;
        EXPECT_TRUE(is_json_object(line, {"event", "what", "done", "total", "rate_per_s", "seconds_left"})) << line;
        ++objects;
        last = line;
    }
    EXPECT_THAT(objects, Gt(0));
    EXPECT_THAT(last, HasSubstr("\"done\": 20, \"total\": 20"));
}

TEST(Run, QuietPrintsNothingButWarnings) {
    const TempDir folder;
    // without zones there is nothing to warn about
    const Outcome run = run_quarry_a(folder / "out", {"--quiet", "--set", "zones.file=", "--set", "release.count=2"});
    EXPECT_EQ(run.code, 0);
    EXPECT_THAT(run.out, IsEmpty());
    EXPECT_THAT(run.err, IsEmpty());
}

TEST(Run, ResultsNameNoFolderOfTheMachine) {
    const TempDir folder;
    const fs::path out = folder / "out";
    ASSERT_EQ(run_quarry_a(out, {"--set", "release.count=2"}).code, 0);
    for (const auto& [name, bytes] : contents_of(out)) {
        if (name == "run.toml") continue;  // it leads to the inputs
        EXPECT_EQ(bytes.find(quarry_a().string()), std::string::npos) << name;
        EXPECT_EQ(bytes.find(folder.path().string()), std::string::npos) << name;
    }
}

// Newton's law of restitution with friction can make energy out of nothing; the scheme of the paper is kept as it is, and says so.
TEST(Run, TheSchemeOfThePaperWarnsWhereItGainsEnergy) {
    const TempDir folder;
    const auto thrown = [&](const char* mode) {
        return run_quarry_a(folder / mode,
                            {"--set", "release.count=20", "--set", "model.mode=" + std::string(mode), "--set",
                             "model.time_step=1e-3", "--set", "soil.loose waste.restitution=1", "--set",
                             "soil.compact waste.restitution=1", "--set", "model.time_limit=5"});
    };
    const Outcome scheme = thrown("moreau_jean"), event = thrown("event");
    ASSERT_EQ(scheme.code, 0) << scheme.err;
    EXPECT_THAT(scheme.err, HasSubstr("in a step of moreau_jean the energy of a block rose by"));
    EXPECT_THAT(event.err, testing::Not(HasSubstr("moreau_jean")));
}

TEST(Terrain, WritesTheModelGround) {
    const TempDir folder;
    const fs::path out = folder / "ground";
    const Outcome made = scree_program({"terrain", (quarry_a() / "site.toml").string(), "--output", out.string()});
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(fields_of(out / "results.gpkg", "facets"), IsSupersetOf({"facet", "soil", "slope_deg"}));
    const RasterFacts heights = raster_facts(out / "rasters" / "model_height_m.tif");
    EXPECT_NEAR(heights.low, 219.0, 1.0);
    EXPECT_NEAR(heights.high, 269.3, 1.0);
    EXPECT_LE(raster_facts(out / "rasters" / "slope_deg.tif").high, 90.0);
    const std::string project = text_of(out / "results.qgs");  // soils are told apart
    for (const char* part : {"attr=\"soil\"", "category value=\"loose waste\"", "category value=\"compact waste\""})
        EXPECT_THAT(project, HasSubstr(part));
    // of a tin they are those of its few facets, which blocks see, and not of the grid that it was made of
    const Outcome few =
        scree_program({"terrain", (quarry_a() / "site.toml").string(), "--output", (folder / "tin").string(), "--set",
                       "terrain.surface=tin", "--set", "terrain.tolerance=3"});
    ASSERT_EQ(few.code, 0) << few.err;
    const cli::SiteModel tin =
        cli::load_site(cli::read_site_file(quarry_a() / "site.toml", {"terrain.surface=tin", "terrain.tolerance=3"}));
    const Grid<double> heights_of_tin = cli::model_heights(tin.terrain);
    double most = 0.0;
    for (std::size_t k = 0; k < heights_of_tin.values.size(); ++k)
        most = std::max(most, std::abs(heights_of_tin.values[k] - tin.terrain.data.grid.values[k]));
    EXPECT_GT(most, 1.0);
    EXPECT_LT(most, 3.0 + 1e-6);
    EXPECT_NE(text_of(folder / "tin" / "rasters" / "model_height_m.tif"),
              text_of(out / "rasters" / "model_height_m.tif"));
    EXPECT_NE(text_of(folder / "tin" / "rasters" / "slope_deg.tif"), text_of(out / "rasters" / "slope_deg.tif"));
    EXPECT_EQ(scree_program({"terrain", (quarry_a() / "site.toml").string(), "--output", out.string()}).code, 3);
    EXPECT_EQ(scree_program(
                  {"terrain", (quarry_a() / "site.toml").string(), "--output", out.string(), "--overwrite", "--quiet"})
                  .code,
              0);
}

}  // namespace
}  // namespace scree::test
