// SPDX-License-Identifier: GPL-3.0-or-later
// Does calibration recover parameters that are known, and do its intervals hold them as often as they say?
//
// A slope that needs no engine: block i of size m_i in [0.5, 1.5) passes a screen with v = 10 (1 - p1) + 2 m + a and runs out to
// x = 30 (1.2 - p1) (0.5 + p2) + 3 m + 5 (0.5 + p2) (0.6 a + 0.8 b), with a, b standard normal. Truth p1 = 0.5, p2 = 0.4; forty blocks, each thrown
// once; loss: energy scores of v and x, in units of about their spread, against ten repeats of the block. Each seed is another field test. Intervals are
// stated as 95 %; with forty blocks and a quadratic for a loss that is not quite one, nine in ten is what is asked for, less the chance of
// kTests seeds (a rate of 0.93 gives fewer than 0.85 of 60 in 1 % of the cases).
#include "scree/inference/calibration.hpp"

#include "scree/base/random.hpp"
#include "scree/inference/distance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace scree {
namespace {

constexpr std::size_t kBlocks = 40;
constexpr std::uint64_t kTests = 60;
constexpr double kLeastRate = 0.85;
constexpr std::array<double, 2> kTruth{0.5, 0.4};

std::array<double, 2> throw_block(double p1, double p2, std::size_t block, RandomStream& random) {
    const double m = 0.5 + static_cast<double>(block) / kBlocks, a = random.normal(), b = random.normal();
    return {10.0 * (1.0 - p1) + 2.0 * m + a,
            30.0 * (1.2 - p1) * (0.5 + p2) + 3.0 * m + 5.0 * (0.5 + p2) * (0.6 * a + 0.8 * b)};
}

/// One field test and the losses of simulations against it. `tilt`: how much faster the model makes the largest block than the smallest, wrongly and
/// whatever the parameters are.
class Slope {
public:
    explicit Slope(std::uint64_t test, double tilt = 0.0) : tilt_(tilt) {
        for (std::size_t k = 0; k < kBlocks; ++k) {
            RandomStream random(test, k, RandomPurpose::Observation);
            measured_.push_back(throw_block(kTruth[0], kTruth[1], k, random));
        }
    }
    std::optional<SimulatedLoss> operator()(const CalibrationTask& task) const {
        SimulatedLoss result;
        for (std::size_t k = 0; k < kBlocks; ++k) {
            RandomStream random(task.seed, k, RandomPurpose::Shape);
            std::array<PointSample, 2> repeats;
            for (std::int64_t r = 0; r < task.repeats; ++r) {
                const auto thrown = throw_block(task.point.values[0], task.point.values[1], k, random);
                repeats[0].values.push_back(thrown[0] + tilt_ * (static_cast<double>(k) / kBlocks - 0.5));
                repeats[1].values.push_back(thrown[1]);
            }
            const auto score = [&](std::size_t c) {
                return energy_score(std::span<const double>(&measured_[k][c], 1), repeats[c]);
            };
            result.loss.push_back(score(0) + score(1) / 5.0);
            result.floor.push_back(0.5 *
                                   (mean_difference(repeats[0].values) + mean_difference(repeats[1].values) / 5.0));
        }
        return result;
    }

private:
    double tilt_;
    std::vector<std::array<double, 2>> measured_;
};

CalibrationProblem slope_problem() {
    CalibrationProblem problem;
    problem.parameters = {{"p1", 0.2, 1.0, 0.9, false}, {"p2", 0.0, 1.0, 0.9, false}};
    problem.records = kBlocks;
    return problem;
}

CalibrationSettings settings_of(std::uint64_t seed) {
    CalibrationSettings settings;
    settings.seed = seed;
    settings.generations = 6;
    settings.draws = 400;
    return settings;
}

TEST(CalibrationRecovers, KnownParametersWithinItsIntervalsAtTheStatedRate) {
    const CalibrationProblem problem = slope_problem();
    std::array<double, 2> held{}, squares{};
    double gap = 0.0, held_out = 0.0, start = 0.0;
    for (std::uint64_t test = 0; test < kTests; ++test) {
        CalibrationJournal journal;
        const CalibrationResult r = calibrate(problem, settings_of(1000 + test), Slope(test), journal, nullptr);
        for (std::size_t i = 0; i < 2; ++i) {
            const ParameterEstimate& e = r.parameters[i];
            held[i] += (e.interval.low <= kTruth[i] && kTruth[i] <= e.interval.high) / static_cast<double>(kTests);
            squares[i] += (e.value - kTruth[i]) * (e.value - kTruth[i]) / static_cast<double>(kTests);
        }
        gap += r.best_fit.gap() / static_cast<double>(kTests);
        held_out += r.held_out.gap() / static_cast<double>(kTests);
        start += r.start_fit.gap() / static_cast<double>(kTests);
    }
    RecordProperty("rate_p1", std::to_string(held[0]));
    RecordProperty("rate_p2", std::to_string(held[1]));
    EXPECT_GE(held[0], kLeastRate);
    EXPECT_GE(held[1], kLeastRate);
    // errors of a few hundredths of the ranges: the search does not get lost
    EXPECT_LT(std::sqrt(squares[0]), 0.04);
    EXPECT_LT(std::sqrt(squares[1]), 0.08);
    // before: far off. After: as near as chance allows, a little nearer than the truth itself, as it has been fitted; held out a little farther
    EXPECT_GT(start, 2.0);
    EXPECT_NEAR(gap, 1.0, 0.04);
    EXPECT_GT(held_out, gap);
    EXPECT_NEAR(held_out, 1.02, 0.05);
}

TEST(CalibrationRecovers, SaysThatAParameterWithoutInfluenceIsNotIdentified) {
    CalibrationProblem problem = slope_problem();
    problem.parameters.push_back({"p3", 0.0, 1.0, kNaN, false});
    int not_identified = 0;
    constexpr int kRuns = 10;
    for (std::uint64_t test = 0; test < kRuns; ++test) {
        CalibrationJournal journal;
        const CalibrationResult r = calibrate(problem, settings_of(2000 + test), Slope(test), journal, nullptr);
        not_identified += r.parameters[2].identified == Identification::Not;
        EXPECT_NE(r.parameters[2].identified, Identification::Well) << test;
        EXPECT_GT(r.directions.back().deviation, 0.15) << test;  // even over the range it would be 0.29
        EXPECT_EQ(r.parameters[0].identified, Identification::Well) << test;
        EXPECT_GT(std::abs(r.directions.back().weights[2]), std::sqrt(0.5)) << test;  // known worst
    }
    EXPECT_GE(not_identified, 9);
}

TEST(CalibrationRecovers, CorrelationHasTheSignOfTheTradeOff) {
    // runout falls with p1 and grows with p2: what one takes the other gives back
    double correlation = 0.0;
    constexpr int kRuns = 10;
    for (std::uint64_t test = 0; test < kRuns; ++test) {
        CalibrationJournal journal;
        correlation +=
            calibrate(slope_problem(), settings_of(3000 + test), Slope(test), journal, nullptr).correlation(0, 1) /
            kRuns;
    }
    EXPECT_GT(correlation, 0.15);
}

TEST(CalibrationRecovers, LeavesAGapThatNoParameterCloses) {
    // speeds of small blocks too low by 3 m/s, of large ones too high: no p1 is right for both
    CalibrationJournal right, wrong;
    const CalibrationResult a = calibrate(slope_problem(), settings_of(4000), Slope(7), right, nullptr);
    const CalibrationResult b = calibrate(slope_problem(), settings_of(4000), Slope(7, 6.0), wrong, nullptr);
    EXPECT_GT(b.held_out.gap(), a.held_out.gap() + 0.3);
}

}  // namespace
}  // namespace scree
