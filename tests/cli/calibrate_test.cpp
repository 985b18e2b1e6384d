// SPDX-License-Identifier: GPL-3.0-or-later
// `scree calibrate` and `scree sweep` on quarry_a in 2D, against field tests that scree made itself with another ground: what they find, what they write,
// how a calibration goes on, and what is refused. Budgets are small: that they find it at the stated rate is for verification/calibration_test.cpp.
#include "cli/calibration_journal.hpp"
#include "cli/free_keys.hpp"
#include "cli/program.hpp"
#include "cli/results.hpp"
#include "cli/site_file.hpp"
#include "scree/base/error.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <set>

namespace scree::test {
namespace {

using nlohmann::json;
using testing::Gt;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Lt;
using testing::Not;
namespace fs = std::filesystem;

constexpr int kMeasured = 30;
constexpr double kRolling = 0.15;  // of compact waste in the field test; the site has 0.05 [m]

/// A field test as a folder of results: quarry_a in 2D with another seed and another ground.
fs::path field_test(const TempDir& folder) {
    EXPECT_EQ(run_quarry_a(folder / "field",
                           {"--set", "release.count=" + std::to_string(kMeasured), "--seed", "2", "--set",
                            "model.dimension=2", "--set", "soil.compact waste.rolling=" + std::to_string(kRolling)})
                  .code,
              0);
    return folder / "field";
}

Outcome in_plane(const std::string& command, const fs::path& observed, const fs::path& output,
                 const std::vector<std::string>& more) {
    std::vector<std::string> args{command,      (quarry_a() / "site.toml").string(),
                                  "--observed", observed.string(),
                                  "--output",   output.string(),
                                  "--set",      "model.dimension=2"};
    args.insert(args.end(), more.begin(), more.end());
    return scree_program(args);
}

Outcome calibrate(const fs::path& observed, const fs::path& output, const std::vector<std::string>& more = {}) {
    std::vector<std::string> args{"--free", "soil.compact waste.rolling=0.01:1:log"};
    for (const char* set : {"starts=1", "screening=6", "generations=2", "search_repeats=4", "surroundings=16",
                            "repeats=5", "final_repeats=8", "folds=2", "draws=300"}) {
        args.push_back("--set");
        args.push_back(std::string("calibration.") + set);
    }
    args.insert(args.end(), {"--set", "observed.draws=200"});
    args.insert(args.end(), more.begin(), more.end());
    return in_plane("calibrate", observed, output, args);
}

// A site whose blocks are drawn, and a field test that knows its own: their ids come from the test.
TEST(Calibrate, KnowsTheMeasuredBlocksOfASiteWithoutAList) {
    const TempDir folder;
    const Outcome run = calibrate(field_test(folder), folder / "out", {"--set", "blocks.list="});
    ASSERT_EQ(run.code, 0) << run.err;
    const auto stops = read_points(folder / "out" / "results.gpkg", "stopping_points");
    std::set<std::string> ids;
    for (const PointRow& stop : stops) ids.insert(stop.values.at("block_id"));
    EXPECT_EQ(ids.size(), static_cast<std::size_t>(kMeasured));
    EXPECT_FALSE(ids.contains(""));
}

// Where blocks went down several paths each is left out once, beside the places.
TEST(Calibrate, PredictsEveryPathFromTheOthers) {
    const TempDir folder;
    put_two_releases(folder / "two.geojson");
    const std::string release = "release.file=" + (folder / "two.geojson").string();
    ASSERT_EQ(run_quarry_a(folder / "field",
                           {"--set", "release.count=30", "--seed", "2", "--set", "model.dimension=2", "--set", release})
                  .code,
              0);
    const Outcome run = calibrate(folder / "field", folder / "out", {"--set", release});
    ASSERT_EQ(run.code, 0) << run.err;
    std::map<std::string, json> left;
    const json report = json::parse(text_of(folder / "out" / "calibrate.json"));
    for (const json& place : report.at("places"))
        if (place.contains("path")) left[place.at("path")] = place.at("left_out");
    ASSERT_EQ(left.count("profile 1") + left.count("profile 2"), 2U);
    for (const char* path : {"profile 1", "profile 2"}) EXPECT_GT(left[path].at("gap").get<double>(), 0.3) << path;
}

TEST(Calibrate, FindsTheGroundOfTheFieldTestAndWritesASiteFileThatHasIt) {
    const TempDir folder;
    const fs::path observed = field_test(folder), out = folder / "out";
    const Outcome run = calibrate(observed, out, {"--threads", "1"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("calibrated on 30 measured blocks"));
    EXPECT_THAT(run.out, HasSubstr("held out (2 folds)"));

    const json j = json::parse(text_of(out / "calibrate.json"));
    const json& rolling = j.at("parameters").at(0);
    EXPECT_EQ(rolling.at("key"), "soil.compact waste.rolling");
    EXPECT_EQ(rolling.at("before"), 0.05);
    // one test of thirty blocks, whose interval may miss by a little; how often it may is for the tests of the search
    EXPECT_LE(rolling.at("interval_95")[0], 1.3 * kRolling);
    EXPECT_GE(rolling.at("interval_95")[1], kRolling / 1.3);
    EXPECT_EQ(rolling.at("identified"), "identified");
    EXPECT_GT(j.at("gaps_before").at("overall").at("gap").get<double>(), 2.0);
    EXPECT_LT(j.at("gaps_calibrated").at("overall").at("gap"), j.at("gaps_before").at("overall").at("gap"));
    EXPECT_LT(j.at("fit_held_out").at("loss"), j.at("fit_before").at("loss"));
    EXPECT_EQ(j.at("folds").size(), 2U);
    EXPECT_EQ(j.at("plausible_values").size(), 300U);

    for (const char* name : {"report.html", "calibrated.toml", "journal.jsonl", "results.gpkg", "SHA256SUMS",
                             "figures/parameters.svg", "figures/course.svg", "figures/overview.svg"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    EXPECT_FALSE(fs::exists(folder / "out.journal.jsonl")) << "it has done its work";
    for (const auto& [name, bytes] : contents_of(out)) {
        if (name == "calibrated.toml") continue;  // it leads to the inputs
        EXPECT_EQ(bytes.find(folder.path().string()), std::string::npos) << name;
        EXPECT_EQ(bytes.find(quarry_a().string()), std::string::npos) << name;
        if (!name.ends_with(".svg") && !name.ends_with(".html")) continue;
        EXPECT_THAT(without_pixels(bytes), Not(HasSubstr("nan"))) << name;
    }

    // the site file stands on its own, says where it comes from, and keeps the rest of the site
    const std::string site = text_of(out / "calibrated.toml");
    EXPECT_THAT(site, HasSubstr("# Calibrated by scree calibrate"));
    EXPECT_THAT(site, HasSubstr("(measured), sha256"));
    EXPECT_EQ(scree_program({"check", (out / "calibrated.toml").string()}).code, 0);
    const Outcome compared =
        scree_program({"compare", (out / "calibrated.toml").string(), "--observed", observed.string(), "--output",
                       (folder / "compared").string(), "--set", "observed.repeats=8", "--set", "observed.draws=200"});
    ASSERT_EQ(compared.code, 0) << compared.err;
    EXPECT_THAT(compared.out, HasSubstr("=> within chance"));

    // byte for byte on any number of threads, and from half a journal
    const fs::path again = folder / "again";
    ASSERT_EQ(calibrate(observed, again, {"--threads", "3"}).code, 0);
    EXPECT_THAT(differing_files(out, again), IsEmpty());
    const std::string journal = text_of(out / "journal.jsonl");
    put(folder / "half.journal.jsonl", journal.substr(0, journal.size() / 2));
    const Outcome resumed = calibrate(observed, folder / "half", {"--resume"});
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_THAT(differing_files(out, folder / "half"), IsEmpty());
}

TEST(Calibrate, TellsChoicesApartAndTakesFreeKeysFromTheSiteFile) {
    const TempDir folder;
    EXPECT_EQ(run_quarry_a(folder / "field", {"--set", "release.count=" + std::to_string(kMeasured), "--seed", "2",
                                              "--set", "model.dimension=2", "--set", "blocks.shape=box"})
                  .code,
              0);
    const Outcome run =
        in_plane("calibrate", folder / "field", folder / "out",
                 {"--set", R"(calibration.free=["blocks.shape=hull,box"])", "--set", "calibration.repeats=8", "--set",
                  "calibration.final_repeats=8", "--set", "observed.draws=100"});
    ASSERT_EQ(run.code, 0) << run.err;
    const json j = json::parse(text_of(folder / "out" / "calibrate.json"));
    EXPECT_EQ(j.at("calibrated").at("blocks.shape"), "box");
    EXPECT_EQ(j.at("before").at("blocks.shape"), "hull");
    EXPECT_THAT(j.at("searches")[1].at("behind_best_95")[0].get<double>(), Gt(0.0));
    EXPECT_THAT(text_of(folder / "out" / "calibrated.toml"), HasSubstr("shape = 'box'"));
}

TEST(Calibrate, FreesEffectsAndSeveralSoilsAtOnce) {
    const TempDir folder;
    const fs::path observed = field_test(folder);
    const std::string site = quarry_with(folder.path(), "[[effect]]\nkind = \"ground_drag\"\ncoefficient = 0.9\n");
    std::vector<std::string> args{"calibrate",  site,
                                  "--observed", observed.string(),
                                  "--output",   (folder / "out").string(),
                                  "--set",      "model.dimension=2",
                                  "--free",     "soil.*.restitution=0:0.4",
                                  "--free",     "effect.ground_drag.coefficient=0:1"};
    for (const char* set : {"starts=1", "screening=6", "generations=4", "search_repeats=3", "surroundings=12",
                            "repeats=3", "final_repeats=5", "folds=0", "draws=100"})
        args.insert(args.end(), {"--set", std::string("calibration.") + set});
    const Outcome run = scree_program(args);
    ASSERT_EQ(run.code, 0) << run.err;
    const json j = json::parse(text_of(folder / "out" / "calibrate.json"));
    const double drag = j.at("calibrated").at("effect.ground_drag.coefficient").get<double>(),
                 restitution = j.at("calibrated").at("soil.*.restitution").get<double>();
    EXPECT_LT(drag, 0.9) << "the field test has none";
    const cli::SiteFile calibrated = cli::read_site_file(folder / "out" / "calibrated.toml", {});
    EXPECT_EQ(calibrated.settings.effects.at(0).effect.value("coefficient"), drag);
    for (const Soil& soil : calibrated.settings.soils) EXPECT_EQ(soil.restitution, restitution);
}

TEST(Calibrate, RefusesWhatCannotBeCalibrated) {
    const TempDir folder;
    put(folder / "zones.csv", "name,count,released\n3A,5,30\n4A,25,30\n");
    const auto refused = [&](const std::string& free) {
        const Outcome run = in_plane("calibrate", folder / "zones.csv", folder / "out", {"--free", free});
        EXPECT_EQ(run.code, 3) << free;
        EXPECT_THAT(run.out, IsEmpty());
        EXPECT_EQ(contents_of(folder.path()).size(), 1U) << "nothing is written";
        return run.err;
    };
    EXPECT_THAT(refused("soil.sand.rolling=0.01:0.1"), HasSubstr("names no key of this site"));
    EXPECT_THAT(refused("soil.sand.rolling=0.01:0.1"),
                HasSubstr("write soil.NAME.key, where NAME is one of compact waste, loose waste"));
    EXPECT_THAT(refused("effect.net.height=1:3"), HasSubstr("this site has no [[effect]]"));
    EXPECT_THAT(refused("soil.loose waste.rolling=0.05"), HasSubstr("needs a range"));
    EXPECT_THAT(refused("soil.loose waste.rolling=0.1:0.01"), HasSubstr("empty range"));
    EXPECT_THAT(refused("soil.loose waste.rolling=0.05:0.1"),
                HasSubstr("does not contain the value of the site, 0.04"));
    EXPECT_THAT(refused("soil.loose waste.restitution=0:1:log"), HasSubstr("must begin above 0"));
    EXPECT_THAT(refused("soil.loose waste.restitution=0:2"), HasSubstr("from 0 to 1"));
    EXPECT_THAT(refused("soil.sand|loose.rolling=0.01:0.1"), HasSubstr("names no key of this site"));
    EXPECT_THAT(refused("terrain.resolution=0.5:2"), HasSubstr("cannot be calibrated"));
    EXPECT_THAT(refused("model.seed=1:20"), HasSubstr("cannot be calibrated"));
    EXPECT_THAT(refused("release.pattern=random,cells"), HasSubstr("cannot be calibrated"));
    EXPECT_THAT(refused("effect.speed_error.bias=0:0.2"), HasSubstr("effects on measurements cannot be calibrated"));
    EXPECT_THAT(refused("blocks.shape=hull"), HasSubstr("at least two choices"));
    EXPECT_THAT(refused("blocks.shape=hull,cube"), HasSubstr("cube"));
    EXPECT_THAT(refused("blocks.shape=box,eota"), HasSubstr("does not contain the choice of the site"));
    const Outcome overlapping = in_plane("calibrate", folder / "zones.csv", folder / "out",
                                         {"--free", "blocks.volume_min=0.05:5", "--free", "blocks.volume_max=2:20"});
    EXPECT_EQ(overlapping.code, 3);
    EXPECT_THAT(overlapping.err, HasSubstr("the ranges of the free parameters overlap"));
    // the median of a log-normal law lies between the ends, and the law itself may be free
    for (const std::vector<std::string>& law :
         {std::vector<std::string>{"--set", "blocks.volume_law=log_normal"},
          {"--set", "blocks.volume_law=constant", "--free", "blocks.volume_law=constant,log_normal"}}) {
        std::vector<std::string> free{"--set",  "blocks.volume=0.25",    "--set",  "blocks.volume_min=0.1",
                                      "--free", "blocks.volume=0.2:0.5", "--free", "blocks.volume_min=0.05:0.3"};
        free.insert(free.end(), law.begin(), law.end());
        const Outcome median = in_plane("calibrate", folder / "zones.csv", folder / "out", free);
        EXPECT_EQ(median.code, 3);
        EXPECT_THAT(median.err, HasSubstr("volume_min = 0.3 is larger than blocks.volume, the median, = 0.2"));
    }
    const Outcome twice =
        in_plane("calibrate", folder / "zones.csv", folder / "out",
                 {"--free", "soil.loose waste.rolling=0.01:0.1", "--free", "soil.*.rolling=0.01:0.1"});
    EXPECT_EQ(twice.code, 3);
    EXPECT_THAT(twice.err, HasSubstr("frees what soil.loose waste.rolling frees a second time"));
    const Outcome nothing =
        in_plane("calibrate", folder / "zones.csv", folder / "out", {"--set", "calibration.free=[]"});
    EXPECT_EQ(nothing.code, 3);
    EXPECT_THAT(nothing.err, HasSubstr("nothing is free"));
}

TEST(Calibrate, GoesOnOnlyWithItsOwnJournal) {
    const TempDir folder;
    put(folder / "zones.csv", "name,count,released\n3A,5,30\n4A,25,30\n");
    const Outcome none = calibrate(folder / "zones.csv", folder / "out", {"--resume"});
    EXPECT_EQ(none.code, 3);
    EXPECT_THAT(none.err, HasSubstr("there is no calibration to go on with"));
    put(folder / "out.journal.jsonl", "{\"calibration\":\"another\"}\n");
    const Outcome left = calibrate(folder / "zones.csv", folder / "out");
    EXPECT_EQ(left.code, 3);
    EXPECT_THAT(left.err, HasSubstr("--resume"));
    const Outcome other = calibrate(folder / "zones.csv", folder / "out", {"--resume"});
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, HasSubstr("belongs to a calibration of something else"));
    EXPECT_EQ(text_of(folder / "out.journal.jsonl"), "{\"calibration\":\"another\"}\n") << "left as it was";
}

TEST(Sweep, TellsApartWhatMattersFromWhatDoesNot) {
    const TempDir folder;
    const fs::path observed = field_test(folder), out = folder / "out";
    const Outcome run = in_plane("sweep", observed, out,
                                 {"--sets", "12", "--set", "soil.compact waste.rolling=0.05,0.15", "--set",
                                  "model.time_limit=100,200", "--set", "release.count=10,90"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("12 sets per value"));
    const json j = json::parse(text_of(out / "sweep.json"));
    ASSERT_EQ(j.at("values").size(), 6U);
    const auto value = [&](std::size_t k) { return j.at("values")[k]; };
    EXPECT_THAT(value(0).at("told_apart").get<double>(), Lt(0.35)) << "the value that the site has";
    EXPECT_THAT(value(1).at("told_apart").get<double>(), Gt(0.8));
    EXPECT_THAT(value(1).at("gap_to_site").at("mean").get<double>(), Gt(2.0));
    EXPECT_THAT(value(1).at("gap_to_test").get<double>(), Lt(value(0).at("gap_to_test").get<double>()));
    EXPECT_THAT(value(2).at("told_apart").get<double>(), Lt(0.35));
    EXPECT_EQ(value(2).at("measures"), value(3).at("measures")) << "no block moves for so long";
    // scatter falls with the root of the number of blocks: a factor of 3 from 10 to 90, known from 12 sets within a factor of 1.8 or so
    const auto scatter = [&](std::size_t k) {
        return value(k).at("measures").at("distance along, mean").at("deviation").get<double>();
    };
    EXPECT_EQ(value(4).at("blocks_per_set"), 10);
    EXPECT_EQ(value(5).at("blocks_per_set"), 90);
    EXPECT_THAT(scatter(4) / scatter(5), testing::AllOf(Gt(1.6), Lt(5.5)));
    for (const char* name : {"report.html", "sweep.csv", "figures/sweep.svg", "results.gpkg"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    const std::string picture = text_of(out / "figures" / "sweep.svg");
    EXPECT_THAT(picture, Not(HasSubstr("nan")));
    EXPECT_THAT(std::stod(picture.substr(picture.find(" width=\"") + 8)), Lt(1320.0)) << "wider, a page shrinks it";
}

// Keys that act on what is measured change what a simulation is compared as, like any other.
TEST(Sweep, KeysOfTheMeasurementAct) {
    const TempDir folder;
    const fs::path observed = field_test(folder);
    const Outcome run =
        in_plane("sweep", observed, folder / "out", {"--sets", "6", "--set", "observed.speed_error=0,5"});
    ASSERT_EQ(run.code, 0) << run.err;
    const json j = json::parse(text_of(folder / "out" / "sweep.json"));
    EXPECT_NE(j.at("values")[0].at("gap_to_test"), j.at("values")[1].at("gap_to_test"));
}

// One value for soils that have different ones: the model before the calibration is the site as it is, and not the site with the first of them.
TEST(Calibrate, AJointKeyBeginsAtTheSiteAsItIs) {
    const cli::SiteFile site = cli::read_site_file(
        quarry_a() / "site.toml", {"soil.loose waste.rolling=0.01", "soil.compact waste.rolling=0.16"});
    const cli::FreeKeys keys = cli::read_free_keys(site, {"soil.*.rolling=0.005:0.2:log", "soil.*.friction=0.3:0.9"});
    CalibrationPoint point{{keys.problem.parameters[0].start, keys.problem.parameters[1].start}, {}};
    EXPECT_NEAR(point.values[0], 0.04, 1e-12);
    EXPECT_NEAR(point.values[1], 0.55, 1e-12);
    EXPECT_THAT(keys.changes(point), IsEmpty());
    point.values[0] = 0.05;
    EXPECT_EQ(keys.changes(point), std::vector<std::string>{"soil.*.rolling=0.05"});
    const auto outside = [&] { cli::read_free_keys(site, {"soil.*.rolling=0.005:0.1:log"}); };
    EXPECT_THAT(outside, testing::ThrowsMessage<InputError>(HasSubstr("does not contain the value of the site, 0.16")));
}

// Every set has each known block once: so it is in the sets that chance is told by, or blocks of very different size hide what a key does.
TEST(Sweep, KnowsTheChanceOfBlocksThatAreVeryDifferent) {
    const TempDir folder;
    std::string list = "block_id,mass_kg,L1_m,L2_m,L3_m\n";
    for (int k = 0; k < 20; ++k)
        list += "B" + std::to_string(k) + (k % 2 ? ",30,0.3,0.27,0.25\n" : ",5000,1.6,1.4,1.3\n");
    put(folder / "blocks.csv", list);
    const std::string blocks = "blocks.list=" + (folder / "blocks.csv").string();
    ASSERT_EQ(
        run_quarry_a(folder / "field", {"--set", "release.count=20", "--set", "model.dimension=2", "--set", blocks})
            .code,
        0);
    const Outcome run = in_plane("sweep", folder / "field", folder / "out",
                                 {"--sets", "100", "--set", blocks, "--set", "model.time_limit=100,200"});
    ASSERT_EQ(run.code, 0) << run.err;
    const json j = json::parse(text_of(folder / "out" / "sweep.json"));
    EXPECT_THAT(j.at("values")[0].at("told_apart").get<double>(), testing::AllOf(Gt(0.0), Lt(0.16)));
    EXPECT_THAT(j.at("values")[0].at("told_apart"), j.at("values")[1].at("told_apart"));
}

// Results may go where no folder is yet, and the journal stands beside them.
TEST(Calibrate, TheJournalMakesItsFolder) {
    const TempDir folder;
    const cli::JournalFile journal(folder / "new" / "out.journal.jsonl", "subject", false);
    EXPECT_TRUE(fs::exists(folder / "new" / "out.journal.jsonl"));
}

// A journal is hours of work: what cannot be written anew stays as it was.
TEST(Calibrate, AJournalThatCannotBeRewrittenStays) {
    const TempDir folder;
    const fs::path file = folder / "out.journal.jsonl";
    fs::create_directory(folder / "out.journal.jsonl.part");
    put(file, "subject\n");
    EXPECT_THROW(cli::JournalFile(file, "subject", true), ComputeError);
    EXPECT_EQ(text_of(file), "subject\n");
    fs::remove(folder / "out.journal.jsonl.part");
    put(file, "");  // killed before its first line
    EXPECT_TRUE(cli::JournalFile(file, "subject", true).journal.empty());
    EXPECT_EQ(text_of(file), "subject\n");
    EXPECT_EQ(contents_of(folder.path()).size(), 1U) << "no draft is left";
}

// Two calibrations that go to one folder: the second must not write into the journal of the first; nor into what is no journal.
TEST(Calibrate, AJournalBelongsToOne) {
    const TempDir folder;
    const fs::path file = folder / "out.journal.jsonl";
    {
        const cli::JournalFile first(file, "{\"calibration\":1}", false);
        EXPECT_THROW(cli::JournalFile(file, "{\"calibration\":2}", false), InputError);
        EXPECT_THROW(cli::JournalFile(file, "{\"calibration\":1}", true), InputError);
    }
    EXPECT_EQ(text_of(file), "{\"calibration\":1}\n");
    EXPECT_TRUE(cli::JournalFile::is_one(file));
    EXPECT_NO_THROW(cli::JournalFile(file, "{\"calibration\":1}", true));
    put(file, "my notes\n");
    EXPECT_FALSE(cli::JournalFile::is_one(file));
    const Outcome run = in_plane("calibrate", quarry_a() / "observed", folder / "out",
                                 {"--overwrite", "--free", "soil.compact waste.rolling=0.01:0.2"});
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("is not what a calibration left"));
    EXPECT_EQ(text_of(file), "my notes\n");
}

TEST(Sweep, RefusesBeforeAnythingIsComputed) {
    const TempDir folder;
    put(folder / "zones.csv", "name,count,released\n3A,5,30\n4A,25,30\n");
    const auto refused = [&](const std::string& set) {
        const Outcome run = in_plane("sweep", folder / "zones.csv", folder / "out", {"--set", set});
        EXPECT_EQ(run.code, 3) << set;
        EXPECT_EQ(contents_of(folder.path()).size(), 1U);
        return run.err;
    };
    EXPECT_THAT(refused("release.height=2"), HasSubstr("no key has several values"));
    EXPECT_THAT(refused("release.height=2,,3"), HasSubstr("empty value"));
    EXPECT_THAT(refused("release.height=2,high"), HasSubstr("release.height"));
    EXPECT_THAT(refused("soil.loose waste.restitution=0,0.5,2"), HasSubstr("from 0 to 1"));
    EXPECT_THAT(refused("screens.chainages=,more = 30"), HasSubstr("empty value"));
    EXPECT_THAT(refused("screens.chainages=here = 20,there = 30"), HasSubstr("gives other screens"));
}

}  // namespace
}  // namespace scree::test
