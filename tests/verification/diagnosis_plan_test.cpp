// SPDX-License-Identifier: GPL-3.0-or-later
// Diagnosis on a slope of formulas before anything is measured: which strengths a test would see, whatever parameters make up for.
#include "slope_of_formulas.hpp"

#include "scree/inference/diagnosis.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scree {
namespace {

/// The smallest strength of an effect that is told to be seen. `power_search`: trials of the search for parameters that make up for it.
double told(const DiagnosisProblem& problem, const DiagnosisSimulation& thrown, std::uint64_t seed,
            std::size_t effect = 0, std::size_t power_search = 16) {
    DiagnosisSettings settings = brief(seed);
    settings.power_search = power_search;
    const Diagnosis plan = plan_test(problem, measured(problem.blocks, seed, {}), settings, thrown, {});
    for (const EffectFinding& f : plan.findings)
        if (f.effect == effect) return f.smallest_seen;
    return kNaN;
}

/// A parameter that acts by its square has no derivative at 0.
double squared(double parameter) {
    return 0.3 + parameter * parameter;
}

TEST(Diagnosis, PlanningSaysWhatWouldBeSeen) {
    const auto blocks = blocks_of_test();
    const DiagnosisProblem problem = problem_for(blocks, all_effects());
    const ObservationTable like = measured(blocks, 1, {});
    DiagnosisSettings settings = brief(1);
    settings.power_search = DiagnosisSettings{}.power_search;
    const Diagnosis plan = plan_test(
        problem, like, settings, [&](const DiagnosisTask& t) { return std::optional(throw_blocks(blocks, t)); }, {});
    EXPECT_EQ(plan.verdict, Verdict::None);
    for (const EffectFinding& f : plan.findings) {
        if (std::isfinite(f.smallest_seen)) {
            EXPECT_EQ(f.variant, f.seen_variant) << "shown in the form that is seen best";
            EXPECT_EQ(f.on, f.seen_on);
        }
        if (f.effect != kMassTrend) continue;
        EXPECT_GT(f.visibility, 1.2);
        // 80 % of the tests with that strength reject
        int rejected = 0;
        constexpr int kCases = 10;
        for (std::uint64_t k = 0; k < kCases; ++k)
            rejected +=
                diagnosis_of(blocks, problem, measured(blocks, 400 + k, {{kMassTrend, 0, f.smallest_seen}}), brief(k))
                    .verdict != Verdict::None;
        EXPECT_NEAR(rejected / static_cast<double>(kCases), 0.8, 0.3);  // two standard errors
    }
    EXPECT_NEAR(plan.cosines(0, 0), 1.0, 1e-9);
}

// At the end of its range such a parameter makes up for ten units of an effect that acts as it does, all the same.
TEST(Diagnosis, PlanningKnowsWhatParametersMakeUpForFarAway) {
    const auto blocks = blocks_of_test();
    constexpr std::size_t kLikeParameter = 0, kOther = 1;
    DiagnosisProblem problem =
        problem_for(blocks, {{"as the parameter", false, {{"", 60.0}}}, {"mass", false, {{"", 5.0}}}});
    problem.calibrated = {0.0, 0.4};
    problem.low = {-1.0, 0.0};
    const auto thrown = [&](const DiagnosisTask& t) {
        DiagnosisTask task = t;
        task.effects.clear();
        task.parameters[0] = squared(t.parameters[0]);
        for (const EffectDose& d : t.effects)
            if (d.effect == kLikeParameter)
                task.parameters[0] += 0.1 * d.strength;
            else
                task.effects.push_back({kMassTrend, 0, d.strength});
        return std::optional(throw_blocks(blocks, task));
    };
    const double by_derivatives = told(problem, thrown, 1, kLikeParameter, 0),
                 with_search = told(problem, thrown, 1, kLikeParameter);
    EXPECT_LT(by_derivatives, 8.0);
    // of 20 tests with a strength of 15, 18, 24 and 30 are rejected 4, 7, 15 and 20
    EXPECT_GT(with_search, 25.0 / 1.5);
    EXPECT_LT(with_search, 25.0 * 1.5) << "told within a factor of 1.5";
    // what no parameter makes up for is seen as early as before, within that factor
    EXPECT_NEAR(told(problem, thrown, 1, kOther) / told(problem, thrown, 1, kOther, 0), 1.0, 0.5);
}

// Single simulations do not find what two parameters make up for together: the search alone tells 5.4 of the first seed.
TEST(Diagnosis, PlanningLooksAroundWhatMakesUpForMost) {
    const auto blocks = blocks_of_test();
    DiagnosisProblem problem = problem_for(blocks, {{"as both parameters", false, {{"", 30.0}}}});
    problem.calibrated = {0.0, 0.0};
    problem.low = {-1.0, -1.0};
    const auto thrown = [&](const DiagnosisTask& t) {
        DiagnosisTask task = t;
        task.effects.clear();
        const double strength = t.effects.empty() ? 0.0 : t.effects.front().strength;
        task.parameters[0] = squared(t.parameters[0]) + 0.1 * strength;
        task.parameters[1] = 0.1 + squared(t.parameters[1]) + 0.1 * strength;
        return std::optional(throw_blocks(blocks, task));
    };
    for (const std::uint64_t seed : {1U, 2U, 3U})
        EXPECT_GT(told(problem, thrown, seed), 8.0) << "10 are made up for, seed " << seed;
}

// Far away the parameter that makes up for the effect does something else, too, which no effect of the catalogue does: the test does not look for it, and Q sees too little of it. A look for just
// what is left would promise 5.5 to 9.8.
TEST(Diagnosis, PlanningLooksForWhatTheCatalogueDoes) {
    const auto blocks = blocks_of_test();
    DiagnosisProblem problem = problem_for(blocks, {{"as the parameter", false, {{"", 30.0}}}});
    problem.calibrated = {0.0, 0.4};
    problem.low = {-1.0, 0.0};
    const auto thrown = [&](const DiagnosisTask& t) {
        DiagnosisTask task = t;
        task.effects.clear();
        if (std::abs(t.parameters[0]) > 0.5) task.effects.push_back({kMassTrend, 0, 2.0});
        task.parameters[0] = squared(t.parameters[0]);
        for (const EffectDose& d : t.effects) task.parameters[0] += 0.1 * d.strength;
        return std::optional(throw_blocks(blocks, task));
    };
    for (const std::uint64_t seed : {1U, 2U, 3U})
        EXPECT_GT(told(problem, thrown, seed), 10.0) << "which are made up for, seed " << seed;
}

}  // namespace
}  // namespace scree
