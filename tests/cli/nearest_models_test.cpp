// SPDX-License-Identifier: GPL-3.0-or-later
// Which of the models that a diagnosis simulates on its way are simulated again.
#include "cli/nearest_models.hpp"

#include "scree/base/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scree::cli {
namespace {

using testing::ElementsAre;

constexpr std::size_t kMeasured = 200;

double drawn(std::uint64_t number, std::uint64_t use) {
    return RandomStream(use, number, RandomPurpose::Effect).normal();
}

/// 200 blocks that stop at 50 m with a standard deviation of 5 m, every one with 10 m/s at a screen.
GapFunction measured() {
    Observations o;
    o.matched = true;
    o.thrown = kMeasured;
    for (std::size_t b = 0; b < kMeasured; ++b) {
        o.blocks.push_back({std::to_string(b), 100.0, {1, 1, 1}, {kNaN, kNaN}});
        ObservedStop stop;
        stop.block = static_cast<std::int32_t>(b);
        stop.position.head<2>() = Vec2(50.0 + 5.0 * drawn(b, 1), 0.0);
        o.stops.push_back(stop);
        ObservedCrossing crossing;
        crossing.block = stop.block;
        crossing.value = {10.0 + drawn(b, 2), kNaN, kNaN, kNaN, kNaN};
        o.crossings.push_back(crossing);
    }
    ObservationOperator op;
    op.screens = {"screen"};
    op.screen_of = {0};
    return {std::move(o), std::move(op)};
}

ObservationTable simulated(const GapFunction& gaps, double shift, std::size_t repeats, bool passes = true) {
    CampaignResult campaign;
    for (std::size_t k = 0; k < kMeasured * repeats; ++k) {
        BlockResult block;
        block.done = true;
        block.reason = StopReason::AtRest;
        block.stop.head<2>() = Vec2(50.0 + shift + 5.0 * drawn(k, 3), 0.0);
        campaign.blocks.push_back(block);
        if (!passes) continue;
        ScreenCrossing crossing;
        crossing.block = static_cast<std::int64_t>(k);
        crossing.measured_speed = 10.0 + drawn(k, 4);
        campaign.crossings.push_back(crossing);
    }
    return gaps.simulated(campaign, 1);
}

CalibrationPoint point(double value) {
    return {{value}, {}};
}

TEST(NearestModels, KeepsTheNearestFirst) {
    const GapFunction gaps = measured();
    NearestModels nearest(gaps);
    for (const double shift : {12.0, 3.0, 20.0, 9.0, 6.0, 16.0})
        nearest.look_at(point(shift), simulated(gaps, shift, 4));
    EXPECT_THAT(nearest.points(), ElementsAre(point(3.0), point(6.0), point(9.0), point(12.0)));
    nearest.look_at(point(3.0), simulated(gaps, 3.0, 4));
    EXPECT_THAT(nearest.points(), ElementsAre(point(3.0), point(6.0), point(9.0), point(12.0))) << "once";
}

// From few rows chance may be as far off, and the gap is smaller.
TEST(NearestModels, FewSimulationsAreNotNearer) {
    const GapFunction gaps = measured();
    const ObservationTable few = simulated(gaps, 6.5, 3), many = simulated(gaps, 6.0, 20);
    ASSERT_LT(gaps(few).overall.gap, gaps(many).overall.gap);
    NearestModels nearest(gaps);
    nearest.look_at(point(6.5), few);
    nearest.look_at(point(6.0), many);
    EXPECT_THAT(nearest.points(), ElementsAre(point(6.0), point(6.5)));
}

TEST(NearestModels, WhatSaysNothingOfAScreenIsNotNearer) {
    const GapFunction gaps = measured();
    NearestModels nearest(gaps);
    nearest.look_at(point(0.0), simulated(gaps, 0.0, 4, false));
    nearest.look_at(point(30.0), simulated(gaps, 30.0, 4));
    EXPECT_THAT(nearest.points(), ElementsAre(point(30.0), point(0.0)));
}

}  // namespace
}  // namespace scree::cli
