// SPDX-License-Identifier: GPL-3.0-or-later
// scree diagnose before anything is measured, and what it refuses.
#include "cli/diagnose_program.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace scree::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

// A site for maps throws a thousand: said before hours are spent.
TEST(Diagnose, SaysThatAPlanOfManyBlocksTakesHours) {
    const TempDir folder;
    const auto plan_of = [&](const char* count) {  // ends before anything is simulated: there is nothing to resume
        const Outcome run = diagnose(folder / "plan", {"--plan", "--resume", "--set", count});
        EXPECT_NE(run.code, 0);
        EXPECT_THAT(run.err, HasSubstr("there is no diagnosis to go on with"));
        return run.err;
    };
    EXPECT_THAT(plan_of("release.count=1000"), HasSubstr("a field test of 1000 blocks, as release.count says"));
    EXPECT_THAT(plan_of("release.count=50"), testing::Not(HasSubstr("takes hours")));
}

TEST(Diagnose, PlansATestBeforeAnythingIsMeasured) {
    const TempDir folder;
    const fs::path few = folder / "few", more = folder / "more";
    ASSERT_EQ(diagnose(few, {"--plan", "--set", "release.count=8", "--set", "diagnosis.without=[\"roughness\"]"}).code,
              0);
    const Outcome run =
        diagnose(more, {"--plan", "--instruments", "stops,speed,height,spin,impacts", "--set", "release.count=14",
                        "--set", nothing_but({"speed_error", "height_datum", "roughness"})});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("what would be seen in 4 of 5 such tests"));
    const auto additions = [](const fs::path& out) {
        std::vector<std::string> tests;
        const json j = json::parse(text_of(out / "diagnosis.json"));
        for (const json& row : j.at("in_addition")) tests.push_back(row.at("test"));
        return tests;
    };
    double slowest = 0.0;
    const json plan = json::parse(text_of(few / "diagnosis.json"));
    for (const json& effect : plan.at("effects"))
        if (effect.at("effect") == "slow_missed") slowest = effect.at("searched_up_to");
    EXPECT_EQ(slowest, 8.0);
    EXPECT_THAT(text_of(few / "report.html"), HasSubstr("searched up to"));
    EXPECT_THAT(additions(few),
                testing::ElementsAre("as planned", "with heights at the screens", "with spins at the screens",
                                     "with heights and spins at the screens", "with films of the first 3 impacts",
                                     "with twice as many blocks"));
    EXPECT_THAT(additions(more), testing::ElementsAre("as planned", "with twice as many blocks"));
    std::vector<std::size_t> seen;
    for (const json& row : plan.at("in_addition")) seen.push_back(row.at("effects_seen_at_reference"));
    EXPECT_GE(seen.back(), seen.front()) << "twice as many blocks";
    EXPECT_GT(*std::max_element(seen.begin(), seen.end()), seen.front()) << "none of it shows anything more";
    const auto visibility = [](const fs::path& out, const char* effect) {
        const json j = json::parse(text_of(out / "diagnosis.json"));
        EXPECT_EQ(j.at("verdict"), "PLAN");
        for (const json& e : j.at("effects"))
            if (e.at("effect") == effect) return e.at("visibility_at_reference").get<double>();
        return -1.0;
    };
    EXPECT_GT(visibility(more, "speed_error"), 2.0);
    EXPECT_EQ(visibility(few, "height_datum"), -1.0) << "no heights, no datum";
    EXPECT_GE(visibility(more, "height_datum"), 0.0);
    EXPECT_EQ(visibility(few, "roughness"), -1.0) << "said to be absent";
    EXPECT_GE(visibility(more, "roughness"), 0.0);
    EXPECT_THAT(text_of(few / "diagnosis.json"), HasSubstr("roughness: said to be absent"));
}

TEST(Diagnose, FullTakesThreeTimesTheSimulations) {
    const TempDir folder;
    const auto simulated = [&](const char* name, const char* full) {
        std::vector<std::string> args{"--plan",
                                      "--set",
                                      "release.count=8",
                                      "--set",
                                      "diagnosis.further=false",
                                      "--set",
                                      "diagnosis.power_search=0",
                                      "--set",
                                      nothing_but({"ground_drag", "ids_shuffled"})};
        if (*full) args.emplace_back(full);
        EXPECT_EQ(diagnose(folder / name, args).code, 0);
        return json::parse(text_of(folder / name / "diagnosis.json")).at("simulated_blocks").get<double>();
    };
    const double usual = simulated("usual", ""), full = simulated("full", "--full");
    EXPECT_NEAR(full / usual, 3.0, 0.5);
}

// What the site leaves open is planned for in the middle of its range.
TEST(Diagnose, PlansWithAKeyThatTheSiteDoesNotHave) {
    const TempDir folder;
    quarry_field_test_with(folder, "kind = \"soil_patch\"\nrolling = 0.1\nfrom = 20.0\nto = 30.0\n", 8);
    std::vector<std::string> args =
        diagnosis(folder / "out",
                  {"--plan", "--set", "release.count=8", "--set", "diagnosis.further=false", "--set",
                   "diagnosis.power_search=0", "--set", nothing_but({"speed_error"})},
                  "effect.soil_patch.friction=0.3:0.9");
    args[1] = (folder / "site.toml").string();
    const Outcome run = scree_program(args);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(json::parse(text_of(folder / "out" / "diagnosis.json")).at("verdict"), "PLAN");
}

TEST(Diagnose, RefusesInOneSentence) {
    const TempDir folder;
    const Outcome nothing = diagnose(folder / "out", {});
    EXPECT_EQ(nothing.code, 3);
    EXPECT_THAT(nothing.err, HasSubstr("--observed, or --plan"));
    const Outcome instrument = diagnose(folder / "out", {"--plan", "--instruments", "stops,smell"});
    EXPECT_EQ(instrument.code, 3);
    EXPECT_THAT(instrument.err, HasSubstr("knows no \"smell\""));
    const Outcome films = diagnose(folder / "out", {"--plan", "--instruments", "impacts", "--set", "screens.file="});
    EXPECT_EQ(films.code, 3);
    EXPECT_THAT(films.err, HasSubstr("films of impacts alone"));
    const Outcome no_plan = diagnose(folder / "out", {"--observed", "somewhere", "--instruments", "stops"});
    EXPECT_EQ(no_plan.code, 2);
    EXPECT_THAT(no_plan.err, HasSubstr("--instruments requires --plan"));
    const Outcome both = diagnose(folder / "out", {"--plan", "--observed", "somewhere"});
    EXPECT_EQ(both.code, 3);
    EXPECT_THAT(both.err, HasSubstr("leave --observed out, or --plan"));
    const Outcome nothing_left = diagnose(folder / "out", {"--plan", "--resume"});
    EXPECT_EQ(nothing_left.code, 3);
    EXPECT_THAT(nothing_left.err, HasSubstr("there is no diagnosis to go on with"));
    const Outcome absent =
        diagnose(folder / "out", {"--plan", "--set", "release.count=8", "--set", "diagnosis.without=[\"snow\"]"});
    EXPECT_EQ(absent.code, 3);
    EXPECT_THAT(absent.err, HasSubstr("diagnosis.without: \"snow\" is no effect that is searched for; there are"));
    EXPECT_FALSE(fs::exists(folder / "out.journal")) << "before anything is simulated";
    const Outcome level = diagnose(folder / "out", {"--plan", "--set", "diagnosis.level=0.004"});
    EXPECT_EQ(level.code, 3);
    EXPECT_THAT(level.err, HasSubstr("diagnosis.draws = 199 samples of chance can reject nothing at diagnosis.level = "
                                     "0.004: give at least 249"));
    const auto plan = [&](const std::vector<std::string>& more) {
        std::vector<std::string> args{"diagnose", (quarry_a() / "site.toml").string(), "--plan", "--output",
                                      (folder / "out").string()};
        args.insert(args.end(), more.begin(), more.end());
        return scree_program(args);
    };
    const Outcome choices = plan({"--free", "blocks.shape=hull,box"});
    EXPECT_EQ(choices.code, 3);
    EXPECT_THAT(choices.err, HasSubstr("choices alone (blocks.shape=hull,box) are none: free a number as well"));
    const Outcome digits = plan({"--set", "release.count=7", "--set", "calibration.free=[]", "--set",
                                 "soil.compact waste.restitution=0.412345678912"});
    EXPECT_THAT(digits.err, HasSubstr("A test of 7 blocks")) << "a value of many digits is in the range made for it";
    const Outcome few = diagnose(folder / "out", {"--plan", "--set", "release.count=7"});
    EXPECT_EQ(few.code, 3);
    EXPECT_THAT(few.err, HasSubstr("A test of 7 blocks is too small for a diagnosis, which needs at least 8"));
    fs::create_directories(folder / "obs");
    put(folder / "obs" / "stopping_points.csv",
        "block_id,mass_kg,l1_m,l2_m,l3_m,easting_m,northing_m\nA,900,0.8,0.7,0.6,890080,6670040\nB,900,0.8,0.7,0.6,"
        "890085,6670040\n");
    const Outcome two = diagnose(folder / "out", {"--observed", (folder / "obs").string()});
    EXPECT_EQ(two.code, 3);
    EXPECT_THAT(two.err, HasSubstr("obs: a test of 2 blocks is too small for a diagnosis"));
    fs::create_directories(folder / "out.journal");
    put(folder / "out.journal" / "x.table", "");
    const Outcome left = diagnose(folder / "out", {"--plan", "--set", "release.count=8"});
    EXPECT_EQ(left.code, 3);
    EXPECT_THAT(left.err, HasSubstr("--resume"));
}

}  // namespace
}  // namespace scree::test
