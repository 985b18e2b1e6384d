// SPDX-License-Identifier: GPL-3.0-or-later
// scree diagnose on quarry_a in 2D: verdicts, and what is written of them.
#include "cli/diagnose_program.hpp"
#include "cli/results.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <sstream>

namespace scree::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
namespace fs = std::filesystem;

/// The same with every measured speed, or those of one screen, times a factor, as tables.
fs::path with_speeds(const fs::path& results, const fs::path& folder, double factor, const std::string& at = "") {
    fs::create_directories(folder);
    std::ostringstream crossings, stops;
    crossings << "screen,block_id,speed_ms\n";
    for (const PointRow& c : read_points(results / "results.gpkg", "screen_crossings"))
        crossings << c.values.at("screen") << ",B" << c.values.at("block") << ","
                  << (at.empty() || c.values.at("screen") == at ? factor : 1.0) * c.number("speed_ms") << "\n";
    put(folder / "screen_crossings.csv", crossings.str());
    stops.precision(12);
    stops << "block_id,mass_kg,l1_m,l2_m,l3_m,easting_m,northing_m\n";
    for (const PointRow& b : read_points(results / "results.gpkg", "stopping_points"))
        stops << "B" << b.values.at("block") << "," << b.number("mass_kg") << "," << b.number("l1_m") << ","
              << b.number("l2_m") << "," << b.number("l3_m") << "," << b.at.x() << "," << b.at.y() << "\n";
    put(folder / "stopping_points.csv", stops.str());
    return folder;
}

TEST(Diagnose, NamesAFaultOfTheMeasurementAndWritesAllOfIt) {
    const TempDir folder;
    const fs::path observed = with_speeds(quarry_field_test(folder / "field", 18), folder / "obs", 1.35),
                   out = folder / "out";
    const Outcome run =
        diagnose(out, {"--observed", observed.string(), "--set", "diagnosis.reference_repeats=30", "--set",
                       "diagnosis.repeats=12", "--set", "diagnosis.rounds=3", "--set", "diagnosis.wide_search=40",
                       "--set", nothing_but({"speed_error", "slow_missed", "screen_shift"})});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> DATA PROBLEM: speed_error"));
    EXPECT_THAT(run.out, HasSubstr("speed at ES1-A is larger than simulated"));
    EXPECT_THAT(run.out, HasSubstr("confirm with model.dimension = 3"));
    const json j = json::parse(text_of(out / "diagnosis.json"));
    EXPECT_EQ(j.at("verdict"), "DATA PROBLEM");
    ASSERT_EQ(j.at("answer").size(), 1U);
    const json& answer = j.at("answer")[0];
    EXPECT_EQ(answer.at("effect"), "speed_error");
    EXPECT_EQ(answer.at("label"), "too fast");
    EXPECT_NEAR(answer.at("value").get<double>(), 0.35, 0.1);
    EXPECT_LE(answer.at("interval_95")[0], answer.at("value")) << "the refit stays within";
    EXPECT_GE(answer.at("interval_95")[1], answer.at("value"));
    EXPECT_LT(answer.at("interval_95")[1].get<double>() - answer.at("interval_95")[0].get<double>(), 0.5);
    EXPECT_LT(answer.at("held_out_loss"), j.at("baseline").at("held_out_loss"));
    EXPECT_GT(answer.at("removable_gap_closed").get<double>(), 0.5);
    EXPECT_NEAR(answer.at("held_out_gap").get<double>(),
                answer.at("held_out_loss").get<double>() / answer.at("held_out_floor").get<double>(), 1e-9)
        << "1 is the noise floor";
    for (const char* name : {"held_out_gain", "held_out_log_gain"}) {
        EXPECT_GT(answer.at(name).at("mean").get<double>(), 0.0) << name;
        EXPECT_GT(answer.at(name).at("standard_error").get<double>(), 0.0) << name;
    }
    EXPECT_THAT(run.out, HasSubstr("a block held out is more likely with speed_error"));
    EXPECT_THAT(text_of(out / "report.html"), HasSubstr("1 is the noise floor"));
    bool told = false;
    for (const json& o : answer.at("observables")) {
        if (o.at("name") != "speed at ES1-A") continue;
        told = true;
        EXPECT_LT(o.at("gap").get<double>(), o.at("gap_calibrated").get<double>()) << "before and after";
        EXPECT_LT(o.at("held_out_gap").get<double>(), o.at("held_out_gap_calibrated").get<double>())
            << "of blocks held out, too";
        EXPECT_NE(o.at("held_out_gap"), o.at("gap")) << "simulated by the folds, not by the fit to all";
    }
    EXPECT_TRUE(told);
    EXPECT_LE(j.at("global_test").at("p").get<double>(), 0.05);
    for (const char* name : {"report.html", "site_extended.toml", "results.gpkg", "SHA256SUMS", "figures/where.svg",
                             "figures/where_along.svg", "figures/effects.svg", "figures/calibrated_overview.svg",
                             "figures/extended_overview.svg"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    const std::string leaves = text_of(out / "figures" / "effects.svg");
    EXPECT_LT(leaves.find(">speed_error<"), leaves.find(">calibrated model<")) << "first what explains most";
    EXPECT_NE(leaves.find(">calibrated model<"), std::string::npos);
    EXPECT_FALSE(j.contains("at_screens")) << "a fault of the measurement moves no block";
    EXPECT_FALSE(fs::exists(folder / "out.journal")) << "it has done its work";
    for (const auto& [name, bytes] : contents_of(out)) {
        if (name == "site_extended.toml") continue;  // it leads to the inputs
        EXPECT_EQ(bytes.find(folder.path().string()), std::string::npos) << name;
        if (!name.ends_with(".svg") && !name.ends_with(".html")) continue;
        EXPECT_THAT(without_pixels(bytes), Not(HasSubstr("nan"))) << name;
    }

    // what was found acts where the site is compared again
    EXPECT_THAT(text_of(out / "site_extended.toml"), HasSubstr("kind = 'speed_error'"));
    const Outcome compared =
        scree_program({"compare", (out / "site_extended.toml").string(), "--observed", observed.string(), "--output",
                       (folder / "compared").string(), "--set", "observed.repeats=8"});
    EXPECT_EQ(compared.code, 0) << compared.err;
    const json gaps = json::parse(text_of(folder / "compared" / "compare.json"));
    for (const json& o : gaps.at("observables")) {
        if (o.at("name") != "speed at ES1-A") continue;
        EXPECT_LT(o.at("pooled").at("gap").get<double>(), 4.0);
    }
}

TEST(Diagnose, GoesOnWhereItWasStoppedWhileEffectsWereFollowed) {
    const TempDir folder;
    const fs::path observed = with_speeds(quarry_field_test(folder / "field", 9), folder / "obs", 1.5);
    const fs::path out = folder / "out", again = folder / "again";
    std::vector<std::string> more{"--observed", observed.string(),
                                  "--set",      "diagnosis.further=false",
                                  "--set",      "diagnosis.wide_search=40",
                                  "--set",      "calibration.folds=0",
                                  "--set",      nothing_but({"speed_error"}),
                                  "--threads",  "1"};
    ASSERT_EQ(diagnose(out, more).code, 0);
    more.back() = "2";
    more.insert(more.end(), {"--progress=json", "--quiet"});
    EXPECT_THAT(interrupted(diagnosis(again, more), 5, "finalists"), HasSubstr("--resume"));
    EXPECT_FALSE(fs::exists(again));
    more.emplace_back("--resume");
    ASSERT_EQ(diagnose(again, more).code, 0);
    EXPECT_THAT(differing_files(out, again), IsEmpty());
}

// What is told where no answer stands: nothing that leaves more over all than what was calibrated, and the site that leaves as much.
void expect_the_nearest_is_told(const fs::path& out, const fs::path& observed) {
    const json baseline = json::parse(text_of(out / "diagnosis.json")).at("baseline");
    const double told = baseline.at("gap_over_all_told");
    EXPECT_LE(baseline.at("distance_over_all_told"), baseline.at("gap_over_all")) << "of which it is the distance";
    const fs::path again = out.string() + "_compared";
    const Outcome compared =
        scree_program({"compare", (out / "site_extended.toml").string(), "--observed", observed.string(), "--output",
                       again.string(), "--set", "observed.repeats=5"});
    ASSERT_EQ(compared.code, 0) << compared.err;
    EXPECT_NEAR(json::parse(text_of(again / "compare.json")).at("overall").at("pooled").at("gap"), told, 1e-9);
}

TEST(Diagnose, WithoutTheRightNameItIsUnknownAndNoForce) {
    const TempDir folder;
    const fs::path observed = with_speeds(quarry_field_test(folder / "field", 16), folder / "obs", 1.35),
                   out = folder / "out";
    const std::vector<std::string> more{"--observed", observed.string(), "--set",
                                        nothing_but({"slow_missed", "rolling_speed"})};
    const Outcome run = diagnose(out, more);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> UNKNOWN"));
    EXPECT_THAT(run.out, HasSubstr("no force along the motion explains it"));
    EXPECT_THAT(text_of(out / "site_extended.toml"), Not(HasSubstr("[[effect]]")));
    expect_the_nearest_is_told(out, observed);
}

// With several parameters free what is calibrated leaves more over all than what the residuals ask for, a step beyond what was tested.
TEST(Diagnose, WithoutAnAnswerTheLastStepOfTheParametersIsTaken) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"forest_drag\"\ncoefficient = 400.0\nheight = 1.0\n", 16, 2, 3);
    const fs::path out = folder / "out";
    const Outcome run =
        diagnose(out,
                 {"--observed", (folder / "field").string(), "--free", "soil.*.rolling=0.01:0.3:log", "--set",
                  "diagnosis.further=false", "--set", "diagnosis.wide_search=40", "--set", nothing_but({})},
                 "soil.*.restitution=0:0.5");
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> UNKNOWN"));
    const json baseline = json::parse(text_of(out / "diagnosis.json")).at("baseline");
    EXPECT_NE(baseline.at("told"), baseline.at("calibrated"));
    EXPECT_NE(baseline.at("told"), baseline.at("tested"));
    EXPECT_LT(baseline.at("distance_over_all_told"), baseline.at("gap_over_all"));
    EXPECT_THAT(run.out, HasSubstr("less is left over all with"));
    EXPECT_TRUE(fs::exists(out / "figures/told_overview.svg"));
    EXPECT_THAT(text_of(out / "report.html"), HasSubstr("Measured and simulated, parameters that are told"));
    expect_the_nearest_is_told(out, folder / "field");
}

// Slower at the second screen alone: blocks that start with what was measured at the first show it there.
TEST(Diagnose, RestartsAtAScreenShowWhatLiesBelowIt) {
    const TempDir folder;
    const fs::path observed = with_speeds(quarry_field_test(folder / "field", 24), folder / "obs", 0.7, "ES2-A"),
                   out = folder / "out";
    const Outcome run =
        diagnose(out, {"--observed", observed.string(), "--set", "diagnosis.further=false", "--set", nothing_but({})});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("from ES1-A to ES2-A: speed [m/s]"));
    EXPECT_THAT(text_of(out / "report.html"), HasSubstr("From screen to screen"));
    const json row = json::parse(text_of(out / "diagnosis.json")).at("restarted").at(1);
    EXPECT_EQ(row.at("what"), "speed [m/s]");
    EXPECT_TRUE(row.at("beyond_chance"));
    EXPECT_LT(row.at("measured").get<double>(), 0.85 * row.at("simulated").get<double>());
}

// Too fast from the release on: below the screens the ground does what the model does.
TEST(Diagnose, RestartsLeaveBehindWhatIsWrongAbove) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"release_motion\"\nspeed = 18.0\n", 24);
    const fs::path out = folder / "out";
    const Outcome run = diagnose(
        out, {"--observed", (folder / "field").string(), "--set", "diagnosis.further=false", "--set", nothing_but({})},
        "soil.compact waste.rolling=0.0499:0.0501");
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> UNKNOWN"));
    const json diagnosis = json::parse(text_of(out / "diagnosis.json"));
    EXPECT_EQ(diagnosis.at("restarted").size(), 5U) << "with heights and spins";
    for (const json& row : diagnosis.at("restarted")) EXPECT_FALSE(row.at("beyond_chance")) << row;
}

TEST(Diagnose, AForceSaysWhatAnEffectWithoutANameDoes) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"rolling_speed\"\nspeed = 2.0\n", 20, 2, 7);
    const fs::path out = folder / "out";
    const std::vector<std::string> more{"--observed", (folder / "field").string(), "--set", nothing_but({})};
    const Outcome run = diagnose(out, more);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> UNKNOWN"));
    EXPECT_THAT(run.out, HasSubstr("held back more than in the model while they touch the ground"));
    expect_the_nearest_is_told(out, folder / "field");
    EXPECT_THAT(run.out, Not(HasSubstr("no force along the motion explains it")));

    // the verdict alone, and less to wait for
    std::vector<std::string> less = more;
    less.insert(less.end(), {"--set", "diagnosis.further=false"});
    ASSERT_EQ(diagnose(folder / "less", less).code, 0);
    const json whole = json::parse(text_of(out / "diagnosis.json"));
    const json verdict = json::parse(text_of(folder / "less" / "diagnosis.json"));
    EXPECT_EQ(verdict.at("sentence"), whole.at("sentence"));
    EXPECT_TRUE(whole.contains("force"));
    EXPECT_FALSE(verdict.contains("force"));
}

TEST(Diagnose, FindsNothingInATestOfTheModelItself) {
    const TempDir folder;
    const fs::path observed = with_speeds(quarry_field_test(folder / "field", 12), folder / "obs", 1.0),
                   out = folder / "out";
    const std::string few = nothing_but({"forest_drag", "rolling_size", "speed_error"});
    const Outcome run = diagnose(out, {"--observed", observed.string(), "--set", few, "--threads", "1"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> NONE"));
    EXPECT_THAT(run.out, HasSubstr("what would be seen in 4 of 5 such tests"));
    EXPECT_THAT(run.out, testing::ContainsRegex("parameter +as given +calibrated"));
    for (const json& effect : json::parse(text_of(out / "diagnosis.json")).at("effects"))
        EXPECT_TRUE(effect.contains("smallest_seen")) << effect;
    EXPECT_THAT(text_of(out / "site_extended.toml"), Not(HasSubstr("[[effect]]")));
    EXPECT_THAT(text_of(out / "figures" / "where_along.svg"), HasSubstr(">240</text>")) << "heights of the map";
    const json restarted = json::parse(text_of(out / "diagnosis.json")).at("restarted");
    ASSERT_EQ(restarted.size(), 3U) << "who passes the second screen, how fast, and where they stop";
    for (const json& row : restarted) EXPECT_FALSE(row.at("beyond_chance")) << row;

    // byte for byte on any number of threads, and from where it was stopped
    const fs::path again = folder / "again", journal = folder / "again.journal";
    std::vector<std::string> more{"--observed", observed.string(), "--set",  few, "--threads",
                                  "3",          "--progress=json", "--quiet"};
    EXPECT_THAT(interrupted(diagnosis(again, more), 2), HasSubstr("--resume"));
    EXPECT_FALSE(fs::exists(again));
    const auto kept = contents_of(journal);
    EXPECT_GT(kept.size(), 0U);
    EXPECT_EQ(diagnose(again, more).code, 3) << "neither lost nor taken for another's";
    more.emplace_back("--resume");
    const Outcome resumed = diagnose(again, more);
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_THAT(differing_files(out, again), IsEmpty());
    EXPECT_FALSE(fs::exists(journal));
}

TEST(Diagnose, WhatAProfileLeavesOutHasAName) {
    const TempDir folder;
    const fs::path out = folder / "out", field = quarry_field_test(folder / "field", 14, 3);
    const Outcome run =
        diagnose(out, {"--observed", field.string(), "--set", "diagnosis.reference_repeats=30", "--set",
                       "diagnosis.repeats=12", "--set", "diagnosis.rounds=2", "--set", "calibration.folds=0", "--set",
                       nothing_but({"third_dimension", "ground_drag", "speed_error"})});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> NAMED: third_dimension"));
    EXPECT_THAT(run.out, HasSubstr("the blocks move in 3D"));
    EXPECT_THAT(run.out, Not(HasSubstr("confirm with model.dimension = 3"))) << "that is the answer";
    const json answer = json::parse(text_of(out / "diagnosis.json")).at("answer").at(0);
    EXPECT_EQ(answer.at("effect"), "third_dimension");
    EXPECT_EQ(answer.at("value"), 1.0) << "of the blocks";

    const RasterFacts reach = raster_facts(out / "rasters" / "reach_probability_extended.tif");
    EXPECT_TRUE(reach.finite);
    EXPECT_GT(reach.sum, 1.0);

    const fs::path extended = out / "site_extended.toml";
    EXPECT_THAT(text_of(extended), HasSubstr("dimension = 3"));
    const Outcome check = scree_program({"check", extended.string()});
    EXPECT_EQ(check.code, 0) << check.err;
    const Outcome again =
        scree_program({"run", extended.string(), "--output", (folder / "again").string(), "--set", "release.count=20"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_FALSE(read_points(folder / "again" / "results.gpkg", "screen_crossings").empty())
        << "the screens stand in space";
}

// Stops alone do not say whether blocks are slowed by their speed or in a place.
TEST(Diagnose, AGroupIsToldWithWhatWouldTellItsMembersApart) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"rolling_speed\"\nspeed = 3.0\n", 16, 2, 5);
    const fs::path out = folder / "out",
                   stops = with_speeds(folder / "field", folder / "obs", 1.0) / "stopping_points.csv";
    const Outcome run = diagnose(out,
                                 {"--observed", stops.string(), "--set", "diagnosis.wide_search=20", "--set",
                                  "calibration.folds=0", "--set", nothing_but({"rolling_speed", "soil_patch"})},
                                 kFreeRestitution);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> GROUP: "));
    EXPECT_THAT(run.out, HasSubstr("cannot tell them apart"));
    const json j = json::parse(text_of(out / "diagnosis.json"));
    EXPECT_EQ(j.at("verdict"), "GROUP");
    ASSERT_EQ(j.at("answer").size(), 2U);
    EXPECT_FALSE(j.at("would_tell_apart").empty());
    const std::string name[] = {"site_extended.toml", "site_extended_2.toml"};
    for (std::size_t k = 0; k < 2; ++k) {
        const std::string kind = j.at("answer")[k].at("effect");
        EXPECT_THAT(text_of(out / name[k]), HasSubstr("kind = '" + kind + "'"));
        const Outcome check = scree_program({"check", (out / name[k]).string()});
        EXPECT_EQ(check.code, 0) << check.err;
    }
}

/// The same tables with each block's number, mass and edges given to the next one.
fs::path with_rows_mixed(const fs::path& tables, const fs::path& folder) {
    fs::create_directories(folder);
    fs::copy_file(tables / "screen_crossings.csv", folder / "screen_crossings.csv");
    std::istringstream rows(text_of(tables / "stopping_points.csv"));
    std::vector<std::string> body, place;
    std::string line, mixed;
    std::getline(rows, mixed);
    mixed += "\n";
    while (std::getline(rows, line)) {
        const std::size_t end = line.rfind(',', line.rfind(',') - 1);  // before the two coordinates
        body.push_back(line.substr(0, end));
        place.push_back(line.substr(end));
    }
    for (std::size_t k = 0; k < body.size(); ++k) mixed += body[k] + place[(k + body.size() / 2) % place.size()] + "\n";
    put(folder / "stopping_points.csv", mixed);
    return folder;
}

// Where nobody knows any more which block is which, no law of the mass is named, and without the right name in the catalogue its kin does not get it.
TEST(Diagnose, AnEffectOfTheMassIsNamedOfItsOwnBlocksOnly) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"rolling_size\"\nexponent = -1.4\n", 24, 2, 4);
    const fs::path tables = with_speeds(folder / "field", folder / "obs", 1.0);
    const auto diagnosed = [&](const fs::path& observed, const std::string& name,
                               const std::vector<std::string>& catalogue) {
        const Outcome run = diagnose(folder / name,
                                     {"--observed", observed.string(), "--set", "diagnosis.wide_search=20", "--set",
                                      "diagnosis.further=false", "--set", nothing_but(catalogue)},
                                     kFreeRestitution);
        EXPECT_EQ(run.code, 0) << run.err;
        return json::parse(text_of(folder / name / "diagnosis.json"));
    };
    const json right = diagnosed(tables, "right", {"rolling_size", "rolling_speed"});
    EXPECT_THAT(right.at("sentence").get<std::string>(), HasSubstr("rolling_size")) << "named, or nearest";
    ASSERT_FALSE(right.at("answer").empty());
    EXPECT_EQ(right.at("answer").at(0).at("effect"), "rolling_size");
    EXPECT_GT(right.at("answer").at(0).at("weight").get<double>(), 0.9);
    const json without = diagnosed(tables, "without", {"rolling_speed", "slow_missed"});
    EXPECT_EQ(without.at("verdict"), "UNKNOWN") << without.at("sentence");
    const json mixed = diagnosed(with_rows_mixed(tables, folder / "mixed_obs"), "mixed",
                                 {"rolling_size", "rolling_speed", "ids_shuffled"});
    EXPECT_NE(mixed.at("verdict"), "NONE");
    if (mixed.at("verdict") != "UNKNOWN") {
        for (const json& a : mixed.at("answer")) EXPECT_NE(a.at("effect"), "rolling_size") << mixed.at("sentence");
    }
}

TEST(Diagnose, WhatActsInAPlaceIsALayerOfItsOwn) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"soil_patch\"\nfrom = 20.0\nto = 32.0\nrolling = 0.5\n", 40, 2, 6);
    const fs::path out = folder / "out";
    const Outcome run = diagnose(out, {"--observed", (folder / "field").string(), "--set", "diagnosis.rounds=2",
                                       "--set", "diagnosis.repeats=12", "--set", "calibration.folds=0", "--set",
                                       "observed.axis=measured", "--set", nothing_but({"soil_patch", "speed_error"})});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> NAMED: soil_patch, that holds blocks back"));
    EXPECT_THAT(run.out, HasSubstr("soil_patch belongs to that place (distances count along azimuth"));
    EXPECT_THAT(run.out, HasSubstr(" m along the profile, from its head)"));
    const json answer = json::parse(text_of(out / "diagnosis.json")).at("answer").at(0),
               &by_profile = answer.at("between_m_of_profile"), &by_axis = answer.at("between_m");
    const double from = by_profile.at(0), to = by_profile.at(1);
    EXPECT_GT(from - by_axis.at(0).get<double>(), 1.0) << "the axis begins in the middle of the release";
    EXPECT_NEAR(to - from, by_axis.at(1).get<double>() - by_axis.at(0).get<double>(), 0.5);
    EXPECT_NEAR(0.5 * (from + to), 26.0, 6.0) << "few blocks touch the ground where it begins";
    EXPECT_NEAR(to, 32.0, 3.0);

    EXPECT_THAT(text_of(out / "figures" / "where_along.svg"), HasSubstr(">soil_patch</text>")) << "where it is";
    EXPECT_THAT(text_of(out / "report.html"), HasSubstr("Parameters</h2>"));
    EXPECT_THAT(run.out, testing::ContainsRegex("parameter +as given +calibrated +with soil_patch"));
    EXPECT_THAT(text_of(out / "results.qgs"), HasSubstr("diagnosis, with soil_patch")) << "whose stops it shows";
    for (const json& effect : json::parse(text_of(out / "diagnosis.json")).at("effects"))
        EXPECT_FALSE(effect.contains("smallest_seen")) << "something is missing: nobody asks";

    // the layer and the site that reads it, moved to wherever they are needed
    const fs::path extended = out / "site_extended.toml";
    EXPECT_THAT(text_of(extended), HasSubstr("kind = 'soil_patch'"));
    const Outcome check = scree_program({"check", extended.string()});
    ASSERT_EQ(check.code, 0) << check.err;
    const auto mean_stop = [&](const fs::path& site, const std::string& name) {
        const Outcome again = scree_program({"run", site.string(), "--output", (folder / name).string(), "--set",
                                             "model.dimension=2", "--set", "release.count=200"});
        EXPECT_EQ(again.code, 0) << again.err;
        double mean = 0.0;
        for (const PointRow& stop : read_points(folder / name / "results.gpkg", "stopping_points"))
            mean += stop.number("s_m") / 200.0;
        return mean;
    };
    const double without_it = mean_stop(quarry_a() / "site.toml", "without"),
                 truth = mean_stop(folder / "site.toml", "truth"), found = mean_stop(extended, "found");
    EXPECT_LT(truth, without_it - 5.0);
    EXPECT_NEAR(found, truth, 0.5 * (without_it - truth)) << "it acts there";
}

TEST(Diagnose, TwoEffectsAreBothNamed) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"rolling_size\"\nexponent = -1.5\n", 24);
    const fs::path out = folder / "out", observed = with_speeds(folder / "field", folder / "obs", 1.3);
    const Outcome run = diagnose(out,
                                 {"--observed", observed.string(), "--set", "diagnosis.wide_search=20", "--set",
                                  nothing_but({"rolling_size", "speed_error"})},
                                 kFreeRestitution);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> NAMED"));
    const json j = json::parse(text_of(out / "diagnosis.json"));
    ASSERT_EQ(j.at("answer").size(), 2U);
    for (const json& answer : j.at("answer")) {
        EXPECT_TRUE(answer.at("together").get<bool>());
        EXPECT_THAT(run.out, HasSubstr(answer.at("effect").get<std::string>()));
        EXPECT_LT(answer.at("held_out_loss"), j.at("baseline").at("held_out_loss"));
        if (answer.at("effect") == "speed_error") {
            EXPECT_NEAR(answer.at("value").get<double>(), 0.3, 0.15);
        } else {
            EXPECT_EQ(answer.at("effect"), "rolling_size");
        }
    }
    // both act where the site is run and compared again
    const std::string extended = text_of(out / "site_extended.toml");
    EXPECT_THAT(extended, HasSubstr("kind = 'speed_error'"));
    EXPECT_THAT(extended, HasSubstr("kind = 'rolling_size"));
    const Outcome compared =
        scree_program({"compare", (out / "site_extended.toml").string(), "--observed", observed.string(), "--output",
                       (folder / "compared").string(), "--set", "model.dimension=2", "--set", "observed.repeats=8"});
    EXPECT_EQ(compared.code, 0) << compared.err;
}

TEST(Diagnose, InSpaceItHasMapsOfBeforeAndAfter) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"rolling_size\"\nexponent = -1.4\n", 10, 3, 3);
    const fs::path out = folder / "out";
    const Outcome run =
        diagnose(out,
                 {"--observed", (folder / "field").string(), "--set", "model.dimension=3", "--set",
                  "diagnosis.reference_repeats=24", "--set", "diagnosis.wide_search=40", "--set", "calibration.folds=0",
                  "--set", "release.count=100", "--set", nothing_but({"rolling_size"})},
                 kFreeRestitution);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> NAMED: rolling_size"));
    EXPECT_THAT(run.out, Not(HasSubstr("confirm with model.dimension = 3")));
    EXPECT_THAT(run.out, HasSubstr("what it changes, with 95 % values"));
    const json screens = json::parse(text_of(out / "diagnosis.json")).at("at_screens");
    ASSERT_FALSE(screens.empty());
    for (const json& s : screens)
        for (const char* model : {"calibrated", "extended"})
            for (const auto& [name, value] : s.at(model).items())
                EXPECT_GT(value.get<double>(), 0.0) << name << " " << s;
    for (const char* name :
         {"figures/calibrated_map.svg", "figures/extended_map.svg", "rasters/reach_probability_calibrated.qml",
          "rasters/reach_probability_extended.qml", "results.gpkg", "results.qgs"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    const RasterFacts before = raster_facts(out / "rasters" / "reach_probability_calibrated.tif"),
                      after = raster_facts(out / "rasters" / "reach_probability_extended.tif");
    for (const RasterFacts& reach : {before, after}) {
        EXPECT_TRUE(reach.finite);
        EXPECT_GE(reach.low, 0.0);
        EXPECT_LE(reach.high, 1.0);
        EXPECT_GT(reach.sum, 1.0);
    }
    EXPECT_NE(before.sum, after.sum);
}

// No name is found, and the layers are those of the parameters that are told.
TEST(Diagnose, InSpaceWhatIsToldHasAMap) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"forest_drag\"\ncoefficient = 400.0\nheight = 1.0\n", 8, 3);
    const fs::path out = folder / "out";
    const Outcome run = diagnose(out,
                                 {"--observed", (folder / "field").string(), "--free", "soil.*.rolling=0.01:0.3:log",
                                  "--set", "model.dimension=3", "--set", "diagnosis.reference_repeats=12", "--set",
                                  "diagnosis.further=false", "--set", nothing_but({})},
                                 kFreeRestitution);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> UNKNOWN"));
    const json baseline = json::parse(text_of(out / "diagnosis.json")).at("baseline");
    EXPECT_NE(baseline.at("told"), baseline.at("calibrated"));
    EXPECT_TRUE(fs::exists(out / "figures/told_map.svg"));
    const RasterFacts told = raster_facts(out / "rasters" / "reach_probability_told.tif"),
                      calibrated = raster_facts(out / "rasters" / "reach_probability_calibrated.tif");
    EXPECT_TRUE(told.finite);
    EXPECT_LE(told.high, 1.0);
    EXPECT_NE(told.sum, calibrated.sum);
    expect_the_nearest_is_told(out, folder / "field");
}

TEST(Diagnose, StopsAtMeasurementsThatCannotBe) {
    const TempDir folder;
    fs::create_directories(folder / "obs");
    put(folder / "obs" / "stopping_points.csv",
        "block_id,mass_kg,l1_m,l2_m,l3_m,easting_m,northing_m\nA,50,0.8,0.7,0.6,890080,6670040\nA,500,0.8,0.7,0.6,"
        "890085,6670040\n");
    const Outcome run = diagnose(folder / "out", {"--observed", (folder / "obs").string()});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("=> DATA PROBLEM: the measurements cannot be used as they are"));
    EXPECT_EQ(json::parse(text_of(folder / "out" / "diagnosis.json")).at("verdict"), "DATA PROBLEM");
}

}  // namespace
}  // namespace scree::test
