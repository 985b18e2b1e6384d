// SPDX-License-Identifier: GPL-3.0-or-later
// What each measured block loses: proper, in units of the test, on a par with the gaps of a comparison.
#include "scree/inference/calibration_loss.hpp"

#include "scree/base/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace scree {
namespace {

constexpr std::size_t kBlocks = 30;

double normal(std::uint64_t number, std::uint64_t use) {
    return RandomStream(use, number, RandomPurpose::Effect).normal();
}

/// Blocks stop at 30 m + 1 m per block + shift, with a spread of 4 m, and pass the screen at 8 m/s + shift / 10 m/s, every fourth not.
CampaignResult campaign_of(double shift, std::size_t repeats, std::uint64_t use = 3, double spread = 1.0) {
    CampaignResult campaign;
    for (std::size_t k = 0; k < kBlocks * repeats; ++k) {
        const auto b = static_cast<double>(k % kBlocks);
        BlockResult block;
        block.done = true;
        block.reason = StopReason::AtRest;
        block.stop = {30.0 + b + shift + spread * 4.0 * normal(2 * k, use), spread * 3.0 * normal(2 * k + 1, use), 0.0};
        campaign.blocks.push_back(block);
        if (k % kBlocks % 4 == 3) continue;
        ScreenCrossing crossing;
        crossing.block = static_cast<std::int64_t>(k);
        const double speed = 8.0 + 0.1 * shift + spread * normal(k, use + 100);
        crossing.velocity = {speed, 0.0, 0.0};
        crossing.measured_speed = speed;
        campaign.crossings.push_back(crossing);
    }
    campaign.released = static_cast<std::int64_t>(campaign.blocks.size());
    return campaign;
}

Observations test_of(bool matched) {
    const CampaignResult truth = campaign_of(0.0, 1, 1);
    Observations o;
    o.matched = matched;
    o.thrown = kBlocks;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        if (matched) o.blocks.push_back({std::to_string(b), 100.0, {1, 1, 1}, {kNaN, kNaN}});
        ObservedStop stop;
        stop.block = matched ? static_cast<std::int32_t>(b) : -1;
        stop.position = truth.blocks[b].stop;
        o.stops.push_back(stop);
    }
    for (const ScreenCrossing& c : truth.crossings) {
        ObservedCrossing crossing;
        crossing.block = matched ? static_cast<std::int32_t>(c.block) : -1;
        crossing.value = {c.measured_speed, kNaN, kNaN, kNaN, kNaN};
        o.crossings.push_back(crossing);
    }
    return o;
}

ObservationOperator test_operator() {
    ObservationOperator op;
    op.screens = {"screen"};
    op.screen_of = {0};
    return op;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(CalibrationLoss, CountsWhatCountsInTheOverallGap) {
    const CalibrationLoss known(GapFunction(test_of(true), test_operator()));
    EXPECT_EQ(known.records(), kBlocks);
    EXPECT_THAT(known.observables(), ::testing::ElementsAre("stop position", "speed at screen"));
    const CalibrationLoss pool(GapFunction(test_of(false), test_operator()));
    // stops and crossings of unknown blocks are records of their own, and the share that passed is as many as were thrown
    EXPECT_EQ(pool.records(), kBlocks + test_of(false).crossings.size() + kBlocks);
    EXPECT_THAT(pool.observables(), ::testing::ElementsAre("stop position", "passing screen", "speed at screen"));
}

// Every path whose blocks are known is one, if it has enough of them.
TEST(CalibrationLoss, KnowsTheRecordsOfEachPath) {
    Observations o = test_of(true);
    o.paths = {"east", "west", "a few"};
    for (std::size_t k = 0; k < o.blocks.size(); ++k) o.blocks[k].path = k < 4 ? 2 : k < 10 ? 1 : k % 2 == 0 ? 0 : -1;
    const std::vector<CalibrationPath> paths = CalibrationLoss(GapFunction(o, test_operator())).paths();
    ASSERT_EQ(paths.size(), 2U);
    EXPECT_EQ(paths[0].name, "east");
    EXPECT_EQ(paths[0].records.size(), (kBlocks - 10) / 2);
    EXPECT_THAT(paths[1].records, ::testing::ElementsAre(4, 5, 6, 7, 8, 9));
    o.matched = false;  // a pool is thrown down all of them
    EXPECT_TRUE(CalibrationLoss(GapFunction(o, test_operator())).paths().empty());
}

TEST(CalibrationLoss, IsOneGapIfNothingDiffersAndLeastAtTheTruth) {
    for (const bool matched : {true, false}) {
        const CalibrationLoss loss(GapFunction(test_of(matched), test_operator()));
        const SimulatedLoss at_truth = loss(campaign_of(0.0, 20), 1);
        EXPECT_EQ(at_truth.loss.size(), loss.records());
        EXPECT_THAT(loss.places(), ::testing::ElementsAre("stops", "screen"));
        // of a pool who passed and how fast, both at the screen and as much each as where blocks stopped
        EXPECT_NEAR(mean(at_truth.floor_at[1]) / mean(at_truth.floor_at[0]), matched ? 0.5 : 2.0, 0.3);
        ASSERT_EQ(at_truth.loss_at.size(), 2U);
        for (std::size_t k = 0; k < loss.records(); ++k) {
            EXPECT_NEAR(at_truth.loss_at[0][k] + at_truth.loss_at[1][k], at_truth.loss[k], 1e-12);
            EXPECT_NEAR(at_truth.floor_at[0][k] + at_truth.floor_at[1][k], at_truth.floor[k], 1e-12);
        }
        EXPECT_NEAR(mean(at_truth.loss) / mean(at_truth.floor), 1.0, 0.25);
        for (const double shift : {-6.0, 6.0})
            EXPECT_GT(mean(loss(campaign_of(shift, 20), 1).loss), mean(at_truth.loss));
        // a model that scatters twice as much has the lower gap and the higher loss: that is why losses are minimised
        const SimulatedLoss wide = loss(campaign_of(0.0, 20, 3, 2.0), 1);
        EXPECT_GT(mean(wide.loss), mean(at_truth.loss));
        EXPECT_LT(mean(wide.loss) / mean(wide.floor), mean(at_truth.loss) / mean(at_truth.floor));
    }
}

// Calibration and comparison compute it in their own ways, for speed; it is the score of distance.hpp, block by block.
TEST(CalibrationLoss, IsTheEnergyScore) {
    constexpr std::size_t kRepeats = 20;
    const GapFunction gaps(test_of(true), test_operator());
    const CalibrationLoss loss(gaps);
    const CampaignResult campaign = campaign_of(2.0, kRepeats);
    const SimulatedLoss found = loss(campaign, 1);
    const std::vector<ObservedStop> stops = test_of(true).stops;
    std::vector<double> scores, floors;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        PointSample members{2, {}};
        for (std::size_t k = b; k < kBlocks * kRepeats; k += kBlocks)
            for (const int axis : {0, 1}) members.values.push_back(campaign.blocks[k].stop[axis]);
        scores.push_back(energy_score(std::vector{stops[b].position.x(), stops[b].position.y()}, members));
        double floor = 0.0;
        for (std::size_t m = 0; m < kRepeats; ++m)
            for (std::size_t n = 0; n < m; ++n) floor += point_distance(members[m], members[n]);
        floors.push_back(floor / (kRepeats * (kRepeats - 1.0)));
    }
    const double weight = found.loss_at[0][0] / scores[0];
    for (std::size_t b = 0; b < kBlocks; ++b) {
        EXPECT_NEAR(found.loss_at[0][b], weight * scores[b], 1e-9) << b;
        EXPECT_NEAR(found.floor_at[0][b], weight * floors[b], 1e-9) << b;
    }
    const Discrepancy compared = gaps(campaign, 1);
    const ObservableGap& stop = compared.observables.front();
    ASSERT_EQ(stop.observable.name, "stop position");
    ASSERT_TRUE(stop.score);
    EXPECT_NEAR(stop.score->distance, mean(scores), 1e-9);
    EXPECT_NEAR(stop.score->floor, mean(floors), 1e-9);
}

// Proper as well, and sharper: a model that scatters half or twice as much as it should loses surely more on the same blocks.
TEST(CalibrationLoss, TheLogarithmicScoreSeesAWrongScatter) {
    for (const bool matched : {true, false}) {
        const CalibrationLoss loss(GapFunction(test_of(matched), test_operator()));
        const std::vector<double> at_truth = loss(campaign_of(0.0, 40), 1).log_loss;
        ASSERT_EQ(at_truth.size(), loss.records());
        EXPECT_GT(mean(loss(campaign_of(6.0, 40), 1).log_loss), mean(at_truth));
        for (const double spread : {0.5, 2.0})
            EXPECT_GT(mean(loss(campaign_of(0.0, 40, 3, spread), 1).log_loss), mean(at_truth) + 0.1) << spread;
        for (const double l : loss(campaign_of(0.0, 40, 3, 0.0), 1).log_loss)
            EXPECT_TRUE(std::isfinite(l)) << "repeats that are all alike";
    }
}

// One more of normal numbers has Student's distribution.
TEST(CalibrationLoss, TheLogarithmicScoreIsThatOfOneMoreMember) {
    Observations o;
    o.matched = true;
    CampaignResult campaign;
    const std::vector<double> stops{3.0, 7.0}, simulated{1.0, 4.0, 4.0};  // mean 3, variance 3
    for (std::size_t b = 0; b < stops.size(); ++b) {
        o.blocks.push_back({std::to_string(b), 100.0, {1, 1, 1}, {kNaN, kNaN}});
        ObservedStop stop;
        stop.block = static_cast<std::int32_t>(b);
        stop.position = {stops[b], 0.0, 0.0};
        o.stops.push_back(stop);
    }
    for (const double x : simulated)
        for (std::size_t b = 0; b < stops.size(); ++b) {
            BlockResult block;
            block.done = true;
            block.reason = StopReason::AtRest;
            block.stop = {x, 0.0, 0.0};
            campaign.blocks.push_back(block);
        }
    campaign.released = static_cast<std::int64_t>(campaign.blocks.size());
    ObservationOperator op;
    op.lateral = false;
    const std::vector<double> log_loss = CalibrationLoss(GapFunction(o, op))(campaign, 1).log_loss;
    ASSERT_EQ(log_loss.size(), 2U);
    // t with 2 degrees of freedom has the density 1 / (2 sqrt 2 (1 + z^2 / 2)^1.5); the scale is sqrt(3 (1 + 1/3)) = 2
    EXPECT_NEAR(log_loss[0], std::log(2.0 * std::sqrt(2.0) * 2.0), 1e-12);
    EXPECT_NEAR(log_loss[1] - log_loss[0], 1.5 * std::log(1.0 + 0.5 * 4.0), 1e-12);
}

// Of shares half a member is added on either side: what none of the simulated blocks did is not impossible.
TEST(CalibrationLoss, TheLogarithmicScoreOfAShareIsNeverInfinite) {
    Observations o;
    o.thrown = 2;
    o.shares.push_back({1, 0, 1, 2});  // one of two blocks in the zone
    ObservationOperator op;
    op.zones = {"zone"};
    op.zone_areas.emplace_back(0, Region({Polygon{{{0, -1}, {10, -1}, {10, 1}, {0, 1}}, {}}}));
    const auto log_loss = [&](double stop_of_first) {
        CampaignResult campaign;
        for (const double x : {stop_of_first, 20.0, 20.0, 20.0}) {
            BlockResult block;
            block.done = true;
            block.reason = StopReason::AtRest;
            block.stop = {x, 0.0, 0.0};
            campaign.blocks.push_back(block);
        }
        campaign.released = 4;
        std::vector<double> losses = CalibrationLoss(GapFunction(o, op))(campaign, 1).log_loss;
        std::sort(losses.begin(), losses.end());
        return losses;
    };
    EXPECT_THAT(log_loss(5.0), ::testing::Pointwise(::testing::DoubleNear(1e-12), {-std::log(0.7), -std::log(0.3)}));
    EXPECT_THAT(log_loss(20.0), ::testing::Pointwise(::testing::DoubleNear(1e-12), {-std::log(0.9), -std::log(0.1)}));
}

/// Known blocks that all stop at 30 m; of each the speed at which it passes the screen, 0 where it does not.
Observations stopped_of(const std::vector<double>& speeds) {
    Observations o;
    o.matched = true;
    for (std::size_t b = 0; b < speeds.size(); ++b) {
        const auto block = static_cast<std::int32_t>(b);
        o.blocks.push_back({std::to_string(b), 100.0, {1, 1, 1}, {kNaN, kNaN}});
        ObservedStop stop;
        stop.block = block;
        stop.position = {30.0, 0.0, 0.0};
        o.stops.push_back(stop);
        if (!(speeds[b] > 0.0)) continue;
        ObservedCrossing crossing;
        crossing.block = block;
        crossing.value = {speeds[b], 0.5, kNaN, kNaN, kNaN};
        o.crossings.push_back(crossing);
    }
    return o;
}

/// Repeat after repeat the speed of each block, 0 where it does not pass.
CampaignResult passing_of(const std::vector<std::vector<double>>& repeats) {
    CampaignResult campaign;
    for (const std::vector<double>& speeds : repeats)
        for (const double speed : speeds) {
            BlockResult block;
            block.done = true;
            block.reason = StopReason::AtRest;
            block.stop = {30.0, 0.0, 0.0};
            if (speed > 0.0) {
                ScreenCrossing crossing;
                crossing.block = static_cast<std::int64_t>(campaign.blocks.size());
                crossing.velocity = {speed, 0.0, 0.0};
                crossing.measured_speed = speed;
                crossing.height = 0.5;
                campaign.crossings.push_back(crossing);
            }
            campaign.blocks.push_back(block);
        }
    campaign.released = static_cast<std::int64_t>(campaign.blocks.size());
    return campaign;
}

// Who passes is a share, told once whatever was measured there; how fast, a matter of those that pass.
TEST(CalibrationLoss, TheLogarithmicScoreTellsPassingFromMotion) {
    const CalibrationLoss loss(GapFunction(stopped_of({7.0, 0.0, 3.0}), test_operator()));
    ASSERT_THAT(loss.observables(), ::testing::ElementsAre("speed at screen", "height at screen")) << "stops are alike";
    const auto student = [](double n, double scale, double z) {
        return std::log(scale) + std::lgamma(0.5 * (n - 1.0)) - std::lgamma(0.5 * n) +
               0.5 * std::log((n - 1.0) * std::numbers::pi) + 0.5 * n * std::log1p(z * z / (n - 1.0));
    };
    const auto alike = [&](double n) { return student(n, 1e-6 * std::sqrt(1.0 + 1.0 / n), 0.0); };  // the heights
    // of the first three of four pass, with mean 3 and variance 3; of the others too few for numbers of their own: those of all, 1, 4, 4 and 4
    const std::vector<double> some =
        loss(passing_of({{1.0, 0.0, 0.0}, {4.0, 0.0, 4.0}, {4.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}), 1).log_loss;
    ASSERT_EQ(some.size(), 3U);
    EXPECT_NEAR(some[0], -std::log(3.5 / 5.0) + student(3.0, 2.0, 4.0 / 2.0) + alike(3.0), 1e-9);
    EXPECT_NEAR(some[1], -std::log(4.5 / 5.0), 1e-12);
    const double scale = 1.5 * std::sqrt(1.25);  // mean 3.25, variance 2.25
    EXPECT_NEAR(some[2], -std::log(1.5 / 5.0) + student(4.0, scale, -0.25 / scale) + alike(4.0), 1e-9);
    // of numbers that nobody simulates nothing is known but how large they are: the root of (49 + 9) / 2
    const std::vector<double> nobody = loss(passing_of({4, {0.0, 0.0, 0.0}}), 1).log_loss;
    EXPECT_NEAR(nobody[0],
                -std::log(0.1) + student(3.0, std::sqrt(29.0), 7.0 / std::sqrt(29.0)) + student(3.0, 0.5, 1.0), 1e-9);
    EXPECT_NEAR(nobody[1], -std::log(0.9), 1e-12);
}

// One block in twenty passes. Who denies it is right nineteen times, and loses all the same.
TEST(CalibrationLoss, TheLogarithmicScoreDoesNotRewardToDenyWhatIsRare) {
    constexpr std::size_t kMany = 20;
    std::vector<double> speeds(kMany, 0.0);
    speeds.front() = 12.0;
    const CalibrationLoss loss(GapFunction(stopped_of(speeds), test_operator()));
    const auto mean_with = [&](std::size_t passing) {  // so many of twenty repeats of every block
        std::vector<std::vector<double>> repeats(kMany, std::vector<double>(kMany, 0.0));
        for (std::size_t r = 0; r < passing; ++r)
            for (std::size_t b = 0; b < kMany; ++b) repeats[r][b] = 12.0 + 1.5 * normal(kMany * r + b, 7);
        return mean(loss(passing_of(repeats), 1).log_loss);
    };
    const double truth = mean_with(1);
    for (const std::size_t passing : {0U, 3U, 10U, 20U}) EXPECT_GT(mean_with(passing), truth + 0.02) << passing;
}

TEST(CalibrationLoss, OfAPoolDiffersFromItsEnergyDistanceByAConstant) {
    Observations stops = test_of(false);
    stops.crossings.clear();
    ObservationOperator op = test_operator();
    op.lateral = false;  // one observable: distance along
    const GapFunction gaps(stops, op);
    const CalibrationLoss loss(gaps);
    ASSERT_THAT(loss.observables(), ::testing::ElementsAre("distance along"));
    // the same campaign shifted: its members differ among themselves as before, so that the distance D = 2 E|x-y| - ... and the score E|x-y| - ... change by
    // 2 : 1, the latter in units of half the mean difference of what was measured
    std::vector<double> x;
    for (const ObservedStop& s : stops.stops) x.push_back(s.position.x());
    const double yardstick = 0.5 * mean_difference(x);
    const CampaignResult here = campaign_of(0.0, 5), there = campaign_of(4.0, 5);
    const auto distance = [&](const CampaignResult& c) {
        for (const ObservableGap& g : gaps(c, 1).observables)
            if (g.observable.name == "distance along") return g.pooled.distance;
        return kNaN;
    };
    const double by_distance = distance(there) - distance(here);
    EXPECT_GT(by_distance, 0.0);
    EXPECT_NEAR(mean(loss(there, 1).loss) - mean(loss(here, 1).loss), 0.5 * by_distance / yardstick, 1e-9);
}

TEST(CalibrationLoss, OfCountsFollowsTheShares) {
    Observations counts;
    counts.thrown = 40;
    counts.shares = {{1, 0, 10, 40}, {2, 1, 30, 40}};
    ObservationOperator op;
    op.zones = {"upper", "lower"};
    const std::vector<Vec2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const auto area = [](double x0, double x1) {
        Polygon polygon;
        polygon.outer = {{x0, -1}, {x1, -1}, {x1, 1}, {x0, 1}};
        return Region(MultiPolygon{polygon});
    };
    op.zone_areas.emplace_back(0, area(0.0, 10.0));
    op.zone_areas.emplace_back(1, area(10.0, 20.0));
    const CalibrationLoss loss(GapFunction(counts, op));
    EXPECT_EQ(loss.records(), 40U);
    const auto with_share = [](double upper) {
        CampaignResult campaign;
        for (int k = 0; k < 200; ++k) {
            BlockResult block;
            block.done = true;
            block.reason = StopReason::AtRest;
            block.stop = {k < 200.0 * upper ? 5.0 : 15.0, 0.0, 0.0};
            campaign.blocks.push_back(block);
        }
        return campaign;
    };
    // Brier scores: with p measured and q simulated, p (1-q)^2 + (1-p) q^2 - q (1-q) / 199 for both zones, over 2 p' (1-p') with p' = 10.5 / 41
    const double p = 0.25, yardstick = 2.0 * (10.5 / 41.0) * (30.5 / 41.0);
    for (const double q : {0.1, 0.25, 0.6}) {
        const double brier = p * (1.0 - q) * (1.0 - q) + (1.0 - p) * q * q - q * (1.0 - q) / 199.0;
        EXPECT_NEAR(mean(loss(with_share(q), 1).loss), 2.0 * brier / yardstick, 1e-9) << q;
    }
}

TEST(CalibrationLoss, SaysNothingWhereABlockHasTooFewRepeats) {
    const CalibrationLoss loss(GapFunction(test_of(true), test_operator()));
    EXPECT_TRUE(loss(campaign_of(0.0, 2), 1).loss.empty());
}

}  // namespace
}  // namespace scree
