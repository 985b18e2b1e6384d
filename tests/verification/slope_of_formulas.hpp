// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A slope of formulas in place of an engine: what is hidden is known, chance can be repeated as often as wanted, and a thousand blocks cost nothing.

#include "scree/base/random.hpp"
#include "scree/inference/diagnosis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace scree {

inline constexpr std::size_t kBlocks = 50;
enum Hidden : std::size_t { kSpeedCap, kMassTrend, kDepositAt50, kSpeedBias, kHeldBack, kEffects };

inline RandomStream stream(std::uint64_t seed, std::uint64_t number) {
    return {seed, number, RandomPurpose::Effect};
}

inline std::vector<ObservedBlock> blocks_of_test() {
    std::vector<ObservedBlock> blocks(kBlocks);
    for (std::size_t i = 0; i < kBlocks; ++i) {
        RandomStream random = stream(5, i);
        const double size = random.uniform(0.5, 1.3);
        blocks[i].id = std::to_string(i);
        blocks[i].size = size * Vec3(random.uniform(1.0, 1.3), 1.0, random.uniform(0.7, 1.0));
        blocks[i].mass = 1500.0 * blocks[i].size.prod();
    }
    return blocks;
}

/// Two parameters slow blocks down: the first one above the first screen, the second one below it. Strengths of one and the same effect add up.
inline ObservationTable throw_blocks(const std::vector<ObservedBlock>& blocks, const DiagnosisTask& task) {
    ObservationTable t;
    t.columns = {{Quantity::Along, -1},
                 {Quantity::Passed, 0},
                 {Quantity::Speed, 0},
                 {Quantity::Passed, 1},
                 {Quantity::Speed, 1}};
    t.values.resize(t.columns.size());
    std::array<double, kEffects> dose{};
    Stretch held_on;
    for (const EffectDose& d : task.effects) {
        dose[d.effect] += d.strength;
        if (d.effect == kHeldBack) held_on = *d.on;
    }
    const auto held_until = [&](double place) { return std::clamp(place - held_on.from, 0.0, held_on.length()); };
    for (std::int64_t k = 0; k < task.repeats; ++k) {
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            RandomStream random = stream(task.seed, static_cast<std::uint64_t>(k) * 1000 + i);
            double first = 10.0 - 2.0 * task.parameters[0] + 1.5 * random.normal();
            if (first > 10.0) first -= std::min(0.4 * dose[kSpeedCap], 1.0) * (first - 10.0);
            double stop = 50.0 - 3.0 * task.parameters[0] - 8.0 * task.parameters[1] + 1.6 * (first - 10.0) +
                          5.0 * random.normal();
            stop += 1.5 * dose[kMassTrend] * (std::log(blocks[i].mass) - 6.9);
            stop -= 0.2 * dose[kHeldBack] * held_until(stop);
            const bool caught = random.uniform() < 0.2 * dose[kDepositAt50];
            if (caught && stop > 50.0 && stop < 58.0) stop = 50.0 + random.uniform();
            double second = 12.0 - 3.0 * task.parameters[1] + 0.5 * (first - 10.0) + random.normal();
            first -= 0.1 * dose[kHeldBack] * held_until(38.0);
            second -= 0.1 * dose[kHeldBack] * held_until(44.0);
            const double bias = 1.0 + 0.05 * dose[kSpeedBias];
            first = bias * first + 0.5 * random.normal();
            second = bias * second + 0.5 * random.normal();
            const bool passed_first = stop > 38.0, passed_second = stop > 44.0;
            t.block.push_back(static_cast<std::int32_t>(i));
            t.values[0].push_back(stop);
            t.values[1].push_back(passed_first ? 1.0 : 0.0);
            t.values[2].push_back(passed_first ? first : kNaN);
            t.values[3].push_back(passed_second ? 1.0 : 0.0);
            t.values[4].push_back(passed_second ? second : kNaN);
        }
    }
    return t;
}

inline DiagnosisProblem problem_for(const std::vector<ObservedBlock>& blocks, std::vector<CandidateEffect> effects) {
    DiagnosisProblem p;
    p.calibrated = {0.3, 0.4};
    p.low = {0.0, 0.0};
    p.high = {1.0, 1.0};
    p.step = {0.15, 0.15};
    p.effects = std::move(effects);
    p.blocks = blocks;
    return p;
}

inline std::vector<CandidateEffect> all_effects() {
    return {{"speed cap", false, {{"", 2.5}}},
            {"mass trend", false, {{"", 5.0}}},
            {"deposit at 50 m", false, {{"", 5.0}}},
            {"speed bias", true, {{"", 4.0}}}};
}

inline DiagnosisSettings quick(std::uint64_t seed) {
    DiagnosisSettings s;
    s.seed = 1000 * seed + 7;
    s.reference_repeats = 60;
    s.repeats = 30;
    s.draws = 199;
    s.power_search = 0;
    return s;
}

/// Wide searches end early: for tests of what lies near.
inline DiagnosisSettings brief(std::uint64_t seed) {
    DiagnosisSettings s = quick(seed);
    s.wide_search = 40;
    return s;
}

/// What is measured has parameters near the calibrated ones, as after a calibration.
inline ObservationTable measured(const std::vector<ObservedBlock>& blocks, std::uint64_t number,
                                 std::vector<EffectDose> hidden) {
    RandomStream random = stream(99, number);
    const double first = 0.3 + 0.05 * random.normal(), second = 0.4 + 0.05 * random.normal();
    return throw_blocks(blocks, {{first, second}, std::move(hidden), 50'000'000 + number, 1});
}

inline Diagnosis diagnosis_of(const std::vector<ObservedBlock>& blocks, const DiagnosisProblem& problem,
                              const ObservationTable& table, const DiagnosisSettings& settings) {
    return diagnose(problem, table, settings,
                    [&](const DiagnosisTask& t) { return std::optional(throw_blocks(blocks, t)); }, {});
}

}  // namespace scree
