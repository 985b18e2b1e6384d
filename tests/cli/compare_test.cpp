// SPDX-License-Identifier: GPL-3.0-or-later
// `scree compare` on quarry_a against measurements that scree made itself: with another seed, which must be as if nothing differed, and with another
// ground, which must show; and what it refuses.
#include "cli/program.hpp"
#include "cli/results.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <regex>
#include <set>

namespace scree::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::Gt;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Lt;
using testing::Not;
namespace fs = std::filesystem;

constexpr int kMeasured = 30;

/// A field test as a folder of results: quarry_a with another seed.
fs::path field_test(const TempDir& folder, const std::vector<std::string>& more = {}) {
    std::vector<std::string> options{"--set", "release.count=" + std::to_string(kMeasured), "--seed", "2"};
    options.insert(options.end(), more.begin(), more.end());
    EXPECT_EQ(run_quarry_a(folder / "field", options).code, 0);
    return folder / "field";
}

Outcome compare(const fs::path& observed, const fs::path& output, const std::vector<std::string>& more = {}) {
    std::vector<std::string> args{"compare",    (quarry_a() / "site.toml").string(),
                                  "--observed", observed.string(),
                                  "--output",   output.string(),
                                  "--set",      "observed.repeats=8",
                                  "--set",      "observed.draws=300"};
    args.insert(args.end(), more.begin(), more.end());
    return scree_program(args);
}

const fs::path& riddle() {
    static const fs::path folder = quarry_a().parent_path() / "quarry_riddle";
    return folder;
}

/// A table of the riddle as it was measured.
std::string riddle_table(const std::string& name) {
    return text_of(riddle() / "observed" / name);
}

/// A site of the riddle with tables that may be other ones.
Outcome compare_riddle(const fs::path& observed, const fs::path& output, const std::vector<std::string>& more = {},
                       const std::string& site = "site.toml") {
    std::vector<std::string> args{
        "compare", (riddle() / site).string(), "--observed", observed.string(),   "--output", output.string(),
        "--set",   "observed.repeats=5",       "--set",      "observed.draws=100"};
    args.insert(args.end(), more.begin(), more.end());
    return scree_program(args);
}

json report(const fs::path& folder) {
    return json::parse(text_of(folder / "compare.json"));
}

json observable(const json& report, const std::string& name) {
    for (const json& o : report.at("observables"))
        if (o.at("name") == name) return o;
    ADD_FAILURE() << "no observable " << name;
    return {};
}

bool within_chance(const json& gap) {
    return gap.at("gap") >= gap.at("chance_95")[0] && gap.at("gap") <= gap.at("chance_95")[1];
}

TEST(Compare, OfTheSameModelWithAnotherSeedIsAboutOne) {
    const TempDir folder;
    const fs::path out = folder / "out";
    const Outcome run = compare(field_test(folder), out);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("30 measured blocks, each simulated 8 times with its own mass and lengths"));
    EXPECT_THAT(run.out, HasSubstr("=> within chance"));

    const json j = report(out);
    EXPECT_EQ(j.at("design"), "known blocks");
    EXPECT_EQ(j.at("simulated").at("released"), 8 * kMeasured);
    const json& pooled = j.at("overall").at("pooled");  // nearer than chance contradicts nothing
    EXPECT_LE(pooled.at("gap").get<double>(), pooled.at("chance_95")[1].get<double>()) << j.at("overall");
    EXPECT_TRUE(within_chance(j.at("overall").at("per_block"))) << j.at("overall");
    EXPECT_THAT(pooled.at("gap").get<double>(), testing::AllOf(Gt(0.3), Lt(2.5)));
    EXPECT_THAT(j.at("overall").at("per_block").at("gap").get<double>(), testing::AllOf(Gt(0.8), Lt(1.25)));
    const json runout = observable(j, "runout");
    EXPECT_EQ(runout.at("measured_n"), kMeasured);
    EXPECT_THAT(runout.at("wasserstein").at("distance").get<double>(),
                Lt(2.0 * runout.at("wasserstein").at("chance_p95").get<double>()));
    EXPECT_EQ(j.at("pit").size() % kMeasured, 0U);

    // shares of all zones add up to one on both sides: the zones of the site leave nothing out
    double measured = 0.0, simulated = 0.0;
    for (const json& zone : j.at("deposit_zones")) {
        measured += zone.at("measured").at("share").get<double>();
        simulated += zone.at("simulated").at("share").get<double>();
    }
    EXPECT_NEAR(measured, 1.0, 1e-9);
    EXPECT_NEAR(simulated, 1.0, 0.03) << "a few blocks leave the terrain";
}

// Its blocks are those of the simulation, move for move.
TEST(Compare, SaysHowManySimulatedBlocksAreLost) {
    const TempDir folder;
    const fs::path observed = field_test(folder, {"--set", "model.dimension=2"});
    const Outcome run =
        compare(observed, folder / "out", {"--set", "model.dimension=2", "--set", "profile.longest=60"});
    ASSERT_EQ(run.code, 0) << run.err;
    for (const std::string& text : {run.out, text_of(folder / "out" / "report.html")})
        EXPECT_THAT(text, HasSubstr("of the simulated blocks left the terrain or ran out of time"));
}

// The numbers of release_zones begin at 1.
TEST(Compare, BlocksThatWereLetGoAtKnownPlacesAreOfNoReleaseArea) {
    const TempDir folder;
    const fs::path observed = field_test(folder);
    ASSERT_EQ(compare(observed, folder / "out").code, 0);
    const std::vector<PointRow> stops = read_points(folder / "out" / "results.gpkg", "stopping_points");
    ASSERT_FALSE(stops.empty());
    for (const PointRow& stop : stops) EXPECT_EQ(stop.values.at("release_feature"), "");
}

// Of a screen in several parts the first on the way counts, whatever their order in the file.
TEST(Compare, AScreenIsPassedWhereItsFirstPartStands) {
    const TempDir folder;
    const auto line = [](int x) {
        const std::string east = std::to_string(890000 + x);
        return R"({"type":"Feature","properties":{"name":"same"},"geometry":{"type":"LineString","coordinates":[[)" +
               east + ",6670000],[" + east + ",6670080]]}}";
    };
    put(folder / "screens.geojson",
        R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::2154"}},)"
        R"("features":[)" +
            line(78) + "," + line(45) + "]}");
    const std::string screens = "screens.file=" + (folder / "screens.geojson").string();
    const fs::path observed = field_test(folder, {"--set", screens, "--set", "model.dimension=2"});
    const Outcome run = compare(observed, folder / "out", {"--set", screens, "--set", "model.dimension=2"});
    ASSERT_EQ(run.code, 0) << run.err;
    const json same = report(folder / "out").at("stopped_beyond_screens").at(0);
    EXPECT_THAT(run.out, HasSubstr("farther along than same"));
    EXPECT_EQ(same.at("measured").at("count"), kMeasured) << same;
}

TEST(Compare, WarnsOfResultsOfTheSameSeed) {
    const TempDir folder;
    const fs::path observed = field_test(folder);  // of seed 2
    for (const std::string seed : {"1", "2"}) {
        const Outcome run =
            compare(observed, folder / seed,
                    {"--set", "observed.repeats=5", "--set", "observed.draws=100", "--set", "model.seed=" + seed});
        ASSERT_EQ(run.code, 0) << run.err;
        const std::string findings = report(folder / seed).at("findings").dump();
        EXPECT_EQ(findings.find("same_seed") != std::string::npos, seed == "2") << findings;
    }
}

TEST(Compare, OfAnotherGroundIsClearlyAboveOne) {
    const TempDir folder;
    const Outcome run = compare(field_test(folder, {"--set", "soil.compact waste.rolling=0.2"}), folder / "out");
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> beyond chance"));
    const json j = report(folder / "out");
    EXPECT_THAT(observable(j, "runout").at("pooled").at("gap").get<double>(), Gt(5.0));
    EXPECT_FALSE(within_chance(observable(j, "runout").at("pooled")));
    EXPECT_THAT(observable(j, "runout").at("pooled").at("p").get<double>(), Lt(0.01));
    EXPECT_FALSE(within_chance(j.at("overall").at("pooled")));
    EXPECT_TRUE(within_chance(observable(j, "speed at ES1-A").at("pooled"))) << "the slope above is as it was";
}

TEST(Compare, WritesReportPicturesAndLayersThatNameNoFolder) {
    const TempDir folder;
    const fs::path out = folder / "out", observed = field_test(folder);
    ASSERT_EQ(
        compare(observed, out, {"--set", "observed.repeats=5", "--set", "observed.draws=100", "--threads", "1"}).code,
        0);
    for (const char* name :
         {"report.html", "compare.json", "compare.toml", "results.gpkg", "results.qgs", "SHA256SUMS",
          "figures/overview.svg", "figures/gaps.svg", "figures/map.svg", "figures/passing.svg", "figures/pit.svg",
          "figures/deposit_zones.svg", "figures/speed_at_ES1-A.svg", "rasters/deposits.tif"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    EXPECT_EQ(read_points(out / "results.gpkg", "observed_stops").size(), static_cast<std::size_t>(kMeasured));
    for (const auto& [name, bytes] : contents_of(out)) {
        if (name == "compare.toml") continue;  // it leads to the inputs
        EXPECT_EQ(bytes.find(folder.path().string()), std::string::npos) << name;
        EXPECT_EQ(bytes.find(quarry_a().string()), std::string::npos) << name;
        if (!name.ends_with(".svg")) continue;
        EXPECT_THAT(bytes, HasSubstr("[")) << name << ": every axis has a unit";
        EXPECT_THAT(without_pixels(bytes), Not(HasSubstr("nan"))) << name;
    }
    EXPECT_THAT(without_pixels(text_of(out / "report.html")), Not(HasSubstr("nan")));

    // byte for byte on any number of threads, and from compare.toml
    fs::rename(out, folder / "first");
    ASSERT_EQ(
        compare(observed, out, {"--set", "observed.repeats=5", "--set", "observed.draws=100", "--threads", "3"}).code,
        0);
    EXPECT_THAT(differing_files(folder / "first", out), IsEmpty());
    const Outcome again = scree_program({"compare", (out / "compare.toml").string(), "--observed", observed.string(),
                                         "--output", (folder / "again").string()});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_THAT(differing_files(out, folder / "again", {"compare.toml", "SHA256SUMS"}), IsEmpty());
}

TEST(Compare, TakesTablesWithoutIdsAsAPool) {
    const TempDir folder;
    std::string stops = "easting_m,northing_m,crs,position_error_m\n", film = "screen,speed_ms,speed_error_ms\n",
                shares = "name,count,released\n1A,0,20\n4A,18,20\n";
    for (int k = 0; k < 20; ++k) {
        stops += std::to_string(890'080 + k) + "," + std::to_string(6'670'030 + k) + ",EPSG:2154,0.1\n";
        film += "ES1-A," + std::to_string(13.0 + 0.15 * k) + ",0.7\n";
    }
    fs::create_directories(folder / "obs");
    put(folder / "obs" / "stopping_points.csv", stops);
    put(folder / "obs" / "screen_crossings.csv", film);
    put(folder / "obs" / "deposit_zones.csv", shares);
    const Outcome run = compare(folder / "obs", folder / "out", {"--set", "release.count=150"});
    ASSERT_EQ(run.code, 0) << run.err;
    const json j = report(folder / "out");
    EXPECT_EQ(j.at("design"), "pool");
    EXPECT_EQ(j.at("simulated").at("released"), 150);
    EXPECT_FALSE(j.at("overall").contains("per_block"));
    EXPECT_TRUE(j.at("pit").empty());
    EXPECT_EQ(observable(j, "passing ES1-A").at("measured").at("of"), 20);
    EXPECT_EQ(observable(j, "speed at ES1-A").at("measured_n"), 20);
    ASSERT_EQ(j.at("findings").size(), 1U);
    EXPECT_EQ(j.at("findings")[0].at("check"), "shares_unused") << "stops say where they are";

    // one table alone
    ASSERT_EQ(compare(folder / "obs" / "deposit_zones.csv", folder / "zones", {"--set", "release.count=150"}).code, 0);
    const json zones = report(folder / "zones");
    ASSERT_EQ(zones.at("observables").size(), 1U);
    EXPECT_EQ(zones.at("deposit_zones").size(), 2U);
    EXPECT_EQ(zones.at("deposit_zones")[1].at("measured").at("count"), 18);
}

TEST(Compare, StopsAtMeasurementsThatCannotBe) {
    const TempDir folder;
    put(folder / "stops.csv",
        "block_id,easting_m,northing_m,crs\nA01,890080,6670040,EPSG:2154\nA02,890000.1,6670040,EPSG:2154\nA01,890081,"
        "6670040,EPSG:2154\nQ9,890081,6670040,EPSG:2154\n");
    const Outcome run = compare(folder / "stops.csv", folder / "out");
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("stops.csv: 1 stop lies off the DTM or over a hole in it (A02)"));
    EXPECT_THAT(run.err, HasSubstr("stops.csv: 1 block_id has more than one stop (A01)"));
    EXPECT_THAT(run.err, HasSubstr("stops.csv: 1 of 3 measured blocks (Q9) have no mass_kg"));
    EXPECT_THAT(run.out, IsEmpty());
    EXPECT_EQ(contents_of(folder.path()).size(), 1U) << "nothing is written";

    put(folder / "film.csv", "screen,speed_ms\nES9,3\n");
    const Outcome screen = compare(folder / "film.csv", folder / "out");
    EXPECT_EQ(screen.code, 3);
    EXPECT_THAT(screen.err, HasSubstr("screens that the site does not have (ES9); it has ES1-A, ES2-A"));
    put(folder / "twice.csv", "name,count,released\n3A,5,50\n3A,5,50\n4A,40,50\n");
    EXPECT_THAT(compare(folder / "twice.csv", folder / "out").err, HasSubstr("more than one row for 3A: add them up"));
    put(folder / "zone.csv", "name,count,released\n9Z,3,50\n");
    EXPECT_THAT(compare(folder / "zone.csv", folder / "out").err,
                HasSubstr("deposit zones that the site does not have (9Z); it has 1A, 2A, 3A, 4A"));
}

// Columns of other names are warned of; with nothing else there is nothing to simulate for.
TEST(Compare, StopsWhereNothingWasMeasured) {
    const TempDir folder;
    put(folder / "stopping_points.csv", "x,y\n890080,6670040\n");
    const Outcome run = compare(folder / "stopping_points.csv", folder / "out");
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("nothing in it can be compared: stopping points need easting_m"));
    EXPECT_EQ(contents_of(folder.path()).size(), 1U);
}

// What stands where a table is looked for is not passed over in silence.
TEST(Compare, ATableThatIsNoFileIsRefused) {
    const TempDir folder;
    for (const bool link : {true, false}) {
        fs::create_directories(folder / "observed");
        fs::copy_file(quarry_a() / "observed" / "screen_crossings.csv", folder / "observed" / "screen_crossings.csv",
                      fs::copy_options::overwrite_existing);
        const fs::path stops = folder / "observed" / "stopping_points.csv";
        if (link)
            fs::create_symlink("nowhere.csv", stops);
        else
            fs::create_directory(stops);
        const Outcome run = compare(folder / "observed", folder / "out", {"--set", "release.count=10", "--quiet"});
        EXPECT_EQ(run.code, 3);
        EXPECT_THAT(run.err, HasSubstr("'stopping_points.csv', which is a folder or a link that leads nowhere"));
        fs::remove(stops);
    }
}

// Results of Scree may be the measurements: --overwrite must not replace them.
TEST(Compare, DoesNotOverwriteWhatItReads) {
    const TempDir folder;
    const std::vector<std::string> quick{"--set", "release.count=10", "--quiet"};
    ASSERT_EQ(run_quarry_a(folder / "field", {"--set", "release.count=10", "--seed", "2"}).code, 0);
    const auto before = contents_of(folder / "field");
    const Outcome run =
        compare(folder / "field", folder / "field", {"--set", "release.count=10", "--quiet", "--overwrite"});
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("is an input, and lies in"));
    EXPECT_EQ(contents_of(folder / "field"), before);
}

TEST(Compare, LeavesResultsAloneUnlessTold) {
    const TempDir folder;
    put(folder / "zones.csv", "name,count,released\n4A,18,20\n");
    const std::vector<std::string> quick{"--set", "release.count=10", "--quiet"};
    ASSERT_EQ(compare(folder / "zones.csv", folder / "out", quick).code, 0);
    const auto before = contents_of(folder / "out");
    const Outcome refused = compare(folder / "zones.csv", folder / "out", quick);
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
    EXPECT_EQ(contents_of(folder / "out"), before);
    const Outcome again =
        compare(folder / "zones.csv", folder / "out", {"--set", "release.count=12", "--quiet", "--overwrite"});
    EXPECT_EQ(again.code, 0);
    EXPECT_THAT(again.out, IsEmpty());
    EXPECT_EQ(report(folder / "out").at("simulated").at("released"), 12);
}

TEST(Compare, AxisMayBeADirectionOrALine) {
    const TempDir folder;
    put(folder / "stops.csv", "easting_m,northing_m,crs\n890080,6670040,EPSG:2154\n890090,6670050,EPSG:2154\n");
    const std::vector<std::string> quick{"--set", "release.count=10",       "--set", "observed.axis=azimuth",
                                         "--set", "observed.azimuth_deg=90"};
    const Outcome run = compare(folder / "stops.csv", folder / "east", quick);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("distance along azimuth 90 degrees from the centre of the release area"));
    const json east = report(folder / "east");
    const double from = east.at("axis").at("origin")[0].get<double>();
    EXPECT_NEAR(observable(east, "distance along").at("measured").at("mean").get<double>(), 890'085.0 - from, 1e-6);
    const std::vector<std::string> along_line{"--set", "release.count=10", "--set", "observed.axis=line"};
    const Outcome none = compare(folder / "stops.csv", folder / "none", along_line);
    EXPECT_EQ(none.code, 3);
    EXPECT_THAT(none.err, HasSubstr("needs observed.line_file"));

    // 20 m east, then 20 m north and on
    const auto line_to = [&](const std::string& name, const std::string& points) {
        put(folder / name, R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:)"
                           R"(EPSG::2154"}},"features":[{"type":"Feature","properties":{},"geometry":{"type":)"
                           R"("LineString","coordinates":[)" +
                               points + "]}}]}");
        std::vector<std::string> options = along_line;
        for (const std::string& set :
             {"observed.line_file=" + (folder / name).string(), std::string("observed.lateral=false")}) {
            options.push_back("--set");
            options.push_back(set);
        }
        return compare(folder / "stops.csv", folder / (name + "_out"), options);
    };
    const Outcome bent = line_to("bent.geojson", "[890020,6670030],[890040,6670030],[890040,6670050]");
    ASSERT_EQ(bent.code, 0) << bent.err;
    const json along = report(folder / "bent.geojson_out");
    EXPECT_NEAR(observable(along, "distance along").at("measured").at("mean").get<double>(), 35.0, 1e-6)
        << "(890080, 6670040) is nearest to 30 m, (890090, 6670050) to 40 m of the line";
    for (const json& o : along.at("observables"))
        EXPECT_THAT(o.at("name").get<std::string>(), testing::AllOf(Not("lateral"), Not("stop position")));
    EXPECT_TRUE(observable(along, "distance along").at("counts_in_overall").get<bool>());
    const Outcome point = line_to("point.geojson", "[890020,6670030],[890020,6670030]");
    EXPECT_EQ(point.code, 3);
    EXPECT_EQ(contents_of(folder.path()).count("point.geojson_out"), 0U);
    const Outcome two = line_to("two.geojson",
                                "[890020,6670030],[890040,6670030]]}},{\"type\":\"Feature\",\"properties\":{},"
                                "\"geometry\":{\"type\":\"LineString\",\"coordinates\":["
                                "[890040,6670030],[890040,6670050]");
    EXPECT_EQ(two.code, 3);
    EXPECT_THAT(two.err, HasSubstr("has 2 lines, but an axis is one"));
}

TEST(Compare, CountsAlongTheProfileIn2dAndOnDemandIn3d) {
    const TempDir folder;
    ASSERT_EQ(run_quarry_a(folder / "field", {"--set", "model.dimension=2"}).code, 0);
    double mean = 0.0;
    const auto stops = read_points(folder / "field" / "results.gpkg", "stopping_points");
    for (const PointRow& stop : stops) mean += stop.number("s_m") / static_cast<double>(stops.size());
    for (const std::vector<std::string>& options :
         {std::vector<std::string>{"--set", "model.dimension=2"}, {"--set", "observed.axis=profile"}}) {
        const fs::path out = folder / ("out" + std::to_string(contents_of(folder.path()).size()));
        std::vector<std::string> args{"--set", "release.count=10", "--set", "observed.repeats=5"};
        args.insert(args.end(), options.begin(), options.end());
        const Outcome run = compare(folder / "field", out, args);
        ASSERT_EQ(run.code, 0) << run.err;
        EXPECT_THAT(run.out, HasSubstr("distance along the profile, from its head"));
        EXPECT_THAT(run.err, Not(HasSubstr("not read")));  // the fields of a run in 2D are Scree's own
        EXPECT_NEAR(observable(report(out), "distance along").at("measured").at("mean").get<double>(), mean, 1e-3);
    }
    const Outcome several =
        compare(folder / "field", folder / "several", {"--set", "observed.axis=profile", "--set", "profile.spacing=1"});
    EXPECT_EQ(several.code, 3);
    EXPECT_THAT(several.err, HasSubstr("needs one profile"));
}

// Blocks are told by their ids, and of a pool nobody knows them: tables sorted in another way say the same. Errors differ from row to row in the riddle, and what was
// not recorded is simulated with the error of any row.
TEST(Compare, DoesNotCareForTheOrderOfRows) {
    const TempDir folder;
    for (const bool pooled : {false, true}) {
        json reports[2];
        for (const bool turned : {false, true}) {
            const std::string name = std::string(pooled ? "pooled" : "known") + (turned ? "_turned" : "");
            const fs::path tables = folder / name, out = folder / (name + "_out");
            fs::create_directories(tables);
            for (const char* table : {"stopping_points.csv", "screen_crossings.csv"}) {
                std::istringstream rows(riddle_table(table));
                std::string header, row, sorted;
                std::getline(rows, header);
                if (pooled) header = std::regex_replace(header, std::regex("block_id"), "nobody");
                while (std::getline(rows, row)) turned ? sorted.insert(0, row + "\n") : sorted.append(row + "\n");
                put(tables / table, header + "\n" + sorted);
            }
            const Outcome run = compare_riddle(tables, out);
            ASSERT_EQ(run.code, 0) << run.err;
            reports[turned] = report(out);
            reports[turned].erase("inputs");
        }
        EXPECT_EQ(reports[0].dump(), reports[1].dump()) << (pooled ? "pooled" : "known");
    }
}

// Crossings without ids are nobody's: they are neither left out nor taken for those of the blocks that the stops know.
TEST(Compare, IdsInOneTableOnlyMakeAPool) {
    const TempDir folder;
    const fs::path tables = folder / "observed";
    fs::create_directories(tables);
    put(tables / "stopping_points.csv", riddle_table("stopping_points.csv"));
    const std::string nameless =
        std::regex_replace(riddle_table("screen_crossings.csv"), std::regex("(ES[12]-A),[^,]*,"), "$1,");
    put(tables / "screen_crossings.csv", std::regex_replace(nameless, std::regex("screen,block_id,"), "screen,"));
    const fs::path out = folder / "out";
    const Outcome run = compare_riddle(tables, out);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("50 measured blocks as a pool"));
    EXPECT_THAT(report(out).at("findings").dump(), HasSubstr("ids_in_some_tables"));
    const json speed = observable(report(out), "speed at ES1-A");
    EXPECT_FALSE(speed.at("known_blocks").get<bool>());
    EXPECT_TRUE(speed.at("pooled").at("gap").is_number()) << "the crossings are not lost";
}

TEST(Compare, RefusesATableThatKnowsSomeOfItsBlocks) {
    const TempDir folder;
    const fs::path tables = folder / "observed";
    fs::create_directories(tables);
    put(tables / "stopping_points.csv", riddle_table("stopping_points.csv"));
    put(tables / "screen_crossings.csv",
        std::regex_replace(riddle_table("screen_crossings.csv"), std::regex("A01,"), ","));
    const Outcome run = compare_riddle(tables, folder / "out");
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("some crossings of ES1-A"));
    EXPECT_THAT(run.err, Not(HasSubstr("some measurements have a block_id"))) << "said once";
}

TEST(Compare, AScreenThatIsSaidToBeMisplacedMustBeThere) {
    const TempDir folder;
    put(folder / "site.toml",
        text_of(quarry_a() / "site.toml") + "\n[[effect]]\nkind = \"screen_shift\"\nscreen = \"ES9\"\n");
    fs::copy(quarry_a() / "data", folder / "data");
    const Outcome run = scree_program({"check", (folder / "site.toml").string()});
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("effect screen_shift: there is no screen \"ES9\"; there are ES1-A, ES2-A"));
}

// Of blocks that passed no screen a table of crossings says nothing: that all of those in it have passed one is no finding.
TEST(Compare, OfCrossingsAloneNobodyKnowsWhoDidNotPass) {
    const TempDir folder;
    const fs::path tables = folder / "observed";
    fs::create_directories(tables);
    put(tables / "screen_crossings.csv", riddle_table("screen_crossings.csv"));
    const auto compared = [&](const std::string& name, const std::vector<std::string>& more) {
        const Outcome run = compare_riddle(tables, folder / name, more);
        EXPECT_EQ(run.code, 0) << run.err;
        return report(folder / name).dump();
    };
    const std::string alone = compared("alone", {});
    EXPECT_THAT(alone, HasSubstr("only_who_passed"));
    EXPECT_THAT(alone, HasSubstr("speed at ES1-A"));
    EXPECT_THAT(alone, Not(HasSubstr("passing ES1-A")));

    std::set<std::string> ids;
    std::istringstream rows(riddle_table("screen_crossings.csv"));
    std::string row;
    for (std::getline(rows, row); std::getline(rows, row);) {
        const std::size_t from = row.find(',') + 1;
        ids.insert(row.substr(from, row.find(',', from) - from));
    }
    put(tables / "impacts.csv", "block_id,impact,speed_before_ms,speed_after_ms\nA01,1,8.0,7.0\n");
    EXPECT_THAT(compared("filmed", {}), HasSubstr("only_who_passed")) << "nor does a film of one of them";
    fs::remove(tables / "impacts.csv");
    const std::string all = compared("all", {"--set", "observed.thrown=" + std::to_string(ids.size())});
    EXPECT_THAT(all, Not(HasSubstr("only_who_passed")));
    EXPECT_THAT(all, HasSubstr("passing ES2-A"));

    std::string thrown = "block_id\n";
    for (const std::string& id : ids) thrown += id + "\n";
    put(tables / "stopping_points.csv", thrown);
    EXPECT_THAT(compared("listed", {}), HasSubstr("passing ES2-A")) << "without positions";
    EXPECT_THAT(compared("more", {"--set", "observed.thrown=" + std::to_string(ids.size() + 10)}),
                HasSubstr("thrown_differs"));
}

// A screen without rows tells nothing, unless it was watched: then nobody passed it.
TEST(Compare, NobodyPassedAWatchedScreenWithoutRows) {
    const TempDir folder;
    const fs::path tables = folder / "observed";
    fs::create_directories(tables);
    put(tables / "stopping_points.csv", riddle_table("stopping_points.csv"));
    std::istringstream rows(riddle_table("screen_crossings.csv"));
    std::string upper;
    for (std::string row; std::getline(rows, row);)
        if (row.find("ES2-A") == std::string::npos) upper += row + "\n";
    put(tables / "screen_crossings.csv", upper);
    const std::vector<std::string> few{"--set", "observed.repeats=10", "--set", "observed.draws=300"};
    const auto with = [&](const std::string& watched) {
        std::vector<std::string> sets = few;
        sets.insert(sets.end(), {"--set", "observed.watched=[\"" + watched + "\"]"});
        return sets;
    };
    ASSERT_EQ(compare_riddle(tables, folder / "plain", few).code, 0);
    EXPECT_THAT(report(folder / "plain").dump(), Not(HasSubstr("passing ES2-A")));
    ASSERT_EQ(compare_riddle(tables, folder / "watched", with("ES2-A")).code, 0);
    bool found = false;
    const auto compared = report(folder / "watched");
    for (const auto& observable : compared.at("observables")) {
        if (observable.at("name") != "passing ES2-A") continue;
        found = true;
        EXPECT_EQ(observable.at("measured").at("share"), 0.0);
    }
    EXPECT_TRUE(found);
    const Outcome unknown = compare_riddle(tables, folder / "unknown", with("ES9"));
    EXPECT_NE(unknown.code, 0);
    EXPECT_THAT(unknown.err + unknown.out,
                HasSubstr("the observations name screens (observed.watched) that the site does not have (ES9)"));
}

// Results of a run know of every screen of it who passed.
TEST(Compare, NobodyPassedAScreenOfARunWithoutCrossingsThere) {
    const TempDir folder;
    const fs::path observed =
        field_test(folder, {"--set", "soil.loose waste.rolling=2", "--set", "soil.compact waste.rolling=2", "--set",
                            "soil.compact waste.friction=1.5"});
    ASSERT_EQ(compare(observed, folder / "out").code, 0);
    std::map<std::string, double> shares;
    const auto compared = report(folder / "out");
    for (const auto& observable : compared.at("observables"))
        if (const std::string name = observable.at("name"); name.starts_with("passing "))
            shares[name] = observable.at("measured").at("share");
    EXPECT_GT(shares.at("passing ES1-A"), 0.0);
    EXPECT_EQ(shares.at("passing ES2-A"), 0.0);
}

// The site as it is cannot be what was measured; with the calibrated soils and the drag that scree diagnose named it can.
TEST(Compare, ToldTheRiddleFromItsSolution) {
    const TempDir folder;
    const auto gap = [&](const std::string& site) {
        const fs::path out = folder / site;
        const Outcome run =
            compare_riddle(riddle() / "observed", out, {"--set", "observed.repeats=10", "--set", "observed.draws=300"},
                           site + ".toml");
        EXPECT_EQ(run.code, 0) << run.err;
        return report(out).at("overall").at("pooled").at("gap").get<double>();
    };
    EXPECT_GT(gap("site"), 50.0);
    EXPECT_LT(gap("site_extended"), 5.0);
}

}  // namespace
}  // namespace scree::test
