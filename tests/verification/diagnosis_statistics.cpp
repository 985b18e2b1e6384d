// SPDX-License-Identifier: GPL-3.0-or-later
// How often a diagnosis on the slope of formulas is right, in more tests than the default ones have time for: the figures in src/README.md. They assert nothing and run
// with --gtest_also_run_disabled_tests.
#include "slope_of_formulas.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <string>

namespace scree {
namespace {

TEST(Diagnosis, DISABLED_StatisticsOfNames) {
    const auto blocks = blocks_of_test();
    const DiagnosisProblem problem = problem_for(blocks, all_effects());
    const auto count = [&](const std::string& name, std::uint64_t first, std::uint64_t tests, std::size_t hidden,
                           double strength) {
        int rejected = 0, best = 0, named = 0, wrong = 0, grouped = 0, covered = 0;
        for (std::uint64_t k = first; k < first + tests; ++k) {
            std::vector<EffectDose> doses;
            if (hidden < kEffects) doses.push_back({hidden, 0, strength});
            const Diagnosis d = diagnosis_of(blocks, problem, measured(blocks, k, doses), quick(k));
            if (d.verdict == Verdict::None) continue;
            ++rejected;
            const EffectFinding& f = d.findings.front();
            best += f.effect == hidden;
            grouped += d.verdict == Verdict::Group;
            if (d.verdict != Verdict::Named && d.verdict != Verdict::DataProblem) continue;
            const bool right = d.answer.size() == 1 && d.answer.front().effect == hidden;
            ++(right ? named : wrong);
            covered += right && std::abs(f.strength - strength) < 1.96 * f.strength_deviation;
        }
        std::cout << name << ", strength " << strength << ": " << tests << " tests, " << rejected << " rejected, best "
                  << best << ", named " << named << " (strength within its 95 %: " << covered << "), group " << grouped
                  << ", wrong " << wrong << std::endl;
    };
    count("nothing hidden", 10000, 400, kEffects, 0.0);
    for (const std::size_t hidden : {kSpeedCap, kMassTrend, kDepositAt50, kSpeedBias})
        for (const double share : {0.4, 0.7}) {
            const std::string& name = problem.effects[hidden].name;
            count(name, 20000 + 1000 * hidden, 60, hidden, share * problem.effects[hidden].variants.front().most);
        }
}

// How often the right effect is no explanation by its own simulations (p of at most 0.05), with true parameters inside their ranges and at the ends of these.
TEST(Diagnosis, DISABLED_StatisticsOfFits) {
    const auto blocks = blocks_of_test();
    for (const bool at_ends : {false, true}) {
        DiagnosisProblem problem = problem_for(blocks, all_effects());
        const std::vector<double> truth = at_ends ? std::vector<double>{0.0, 1.0} : problem.calibrated;
        problem.calibrated = truth;
        int finalists = 0, rejected = 0, named = 0;
        double mean = 0.0;
        for (std::uint64_t k = 0; k < 100; ++k) {
            const ObservationTable table = throw_blocks(blocks, {truth, {{kMassTrend, 0, 3.5}}, 60'000'000 + k, 1});
            const Diagnosis d = diagnosis_of(blocks, problem, table, brief(k));
            for (const EffectFinding& f : d.findings) {
                if (f.effect != kMassTrend || !f.finalist) continue;
                ++finalists;
                rejected += f.p <= 0.05;
                mean += f.p;
            }
            named += d.answer.size() == 1 && d.answer.front().effect == kMassTrend;
        }
        std::cout << (at_ends ? "at the ends" : "inside") << ": " << finalists << " finalists of 100 tests, "
                  << rejected << " rejected, mean p " << mean / finalists << ", named " << named << std::endl;
    }
}

TEST(Diagnosis, DISABLED_StatisticsOfPlaces) {
    const auto blocks = blocks_of_test();
    std::vector<CandidateEffect> effects = all_effects();
    effects.push_back({"held back", false, {{"", 12.0, Stretch{0.0, 90.0}}}});
    const DiagnosisProblem problem = problem_for(blocks, effects);
    const auto count = [&](std::uint64_t first, std::uint64_t tests, const Stretch& hidden, double held) {
        int rejected = 0, best = 0, right = 0, wrong = 0, near = 0, covered = 0;
        double deviation = 0.0, chance = 0.0;
        for (std::uint64_t k = first; k < first + tests; ++k) {
            std::vector<EffectDose> doses;
            if (held > 0.0) doses.push_back({kHeldBack, 0, std::min(held / hidden.length(), 12.0), hidden});
            const Diagnosis d = diagnosis_of(blocks, problem, measured(blocks, k, doses), quick(k));
            if (d.verdict == Verdict::None) continue;
            ++rejected;
            chance += d.weight_none;
            const EffectFinding& f = d.findings.front();
            const bool one = d.verdict == Verdict::Named || d.verdict == Verdict::DataProblem;
            wrong += one && (held == 0.0 || f.effect != kHeldBack);
            if (f.effect != kHeldBack || !f.finalist || held == 0.0) continue;
            ++best;
            right += d.verdict == Verdict::Named;
            const double error = std::abs(f.on->middle() - hidden.middle());
            near += error < 3.0;
            covered += error < 1.96 * f.middle_deviation;
            deviation += f.middle_deviation;
        }
        std::cout << "held by " << held << " from " << hidden.from << " to " << hidden.to << " m: " << tests
                  << " tests, " << rejected << " rejected (chance weighs " << chance / std::max(rejected, 1)
                  << "), best " << best << ", named " << right << ", wrong " << wrong
                  << ", of the best ones middle within 3 m " << near << ", within its 95 % " << covered
                  << ", mean deviation " << deviation / std::max(best, 1) << " m" << std::endl;
    };
    for (const double held : {28.0, 16.0})
        for (const Stretch hidden : {Stretch{24.0, 28.0}, Stretch{31.0, 36.0}, Stretch{39.5, 43.5}, Stretch{45.0, 48.0},
                                     Stretch{33.0, 43.0}, Stretch{20.0, 40.0}})
            count(5000, 30, hidden, held);
    count(30000, 300, {}, 0.0);  // nothing hidden
}

TEST(Diagnosis, DISABLED_StatisticsOfPairs) {
    const auto blocks = blocks_of_test();
    const DiagnosisProblem problem = problem_for(blocks, all_effects());
    int rejected = 0, both = 0, one = 0, wrong = 0;
    for (std::uint64_t k = 0; k < 40; ++k) {
        const ObservationTable table = measured(blocks, 6000 + k, {{kMassTrend, 0, 4.0}, {kSpeedBias, 0, 3.0}});
        const Diagnosis d = diagnosis_of(blocks, problem, table, quick(k));
        rejected += d.verdict != Verdict::None;
        both += d.together;
        one += d.answer.size() == 1;
        for (const EffectFinding& f : d.answer) wrong += f.effect != kMassTrend && f.effect != kSpeedBias;
    }
    std::cout << "pairs: 40 tests, " << rejected << " rejected, both named " << both << ", one of them " << one
              << ", wrong " << wrong << std::endl;
}

}  // namespace
}  // namespace scree
