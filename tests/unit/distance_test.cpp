// SPDX-License-Identifier: GPL-3.0-or-later
// Distances of small samples, by hand; and the axis along which runout is counted.
#include "scree/inference/distance.hpp"

#include "scree/inference/axis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scree {
namespace {

TEST(LineDistance, OfSmallSamples) {
    // {0, 1} and {2}: 2 E|X-Y| - E|X-X'| - E|Y-Y'| = 2 1.5 - 0.5 - 0
    const LineDistance d = line_distance(sorted_sample(std::vector{1.0, 0.0}), sorted_sample(std::vector{2.0}));
    EXPECT_DOUBLE_EQ(d.energy, 2.5);
    EXPECT_DOUBLE_EQ(d.wasserstein, 1.5);
    const LineDistance same =
        line_distance(sorted_sample(std::vector{3.0, 1.0}), sorted_sample(std::vector{1.0, 3.0, 3.0, 1.0}));
    EXPECT_DOUBLE_EQ(same.energy, 0.0);
    EXPECT_DOUBLE_EQ(same.wasserstein, 0.0);
}

TEST(LineDistance, TakesWeights) {
    // weights 3/4, 1/4 are the sample {0, 0, 0, 4}
    const SortedSample weighted{{0.0, 4.0}, {0.75, 0.25}};
    const SortedSample other = sorted_sample(std::vector{1.0, 5.0});
    const LineDistance a = line_distance(weighted, other),
                       b = line_distance(sorted_sample(std::vector{0.0, 4.0, 0.0, 0.0}), other);
    EXPECT_DOUBLE_EQ(a.energy, b.energy);
    EXPECT_DOUBLE_EQ(a.wasserstein, b.wasserstein);
}

TEST(MeanDifference, OfSmallSamples) {
    EXPECT_DOUBLE_EQ(mean_difference(std::vector{0.0, 3.0}), 3.0);
    EXPECT_DOUBLE_EQ(mean_difference(std::vector{5.0, 1.0, 2.0}), (4.0 + 3.0 + 1.0) / 3.0);
    EXPECT_DOUBLE_EQ(mean_difference(std::vector{1e6 + 2.0, 1e6, 1e6 + 4.0}), 8.0 / 3.0);
    EXPECT_TRUE(std::isnan(mean_difference(std::vector{1.0})));
}

TEST(SampleQuantile, IsLinearBetweenMembers) {
    const std::vector<double> sorted{0.0, 10.0, 20.0};
    EXPECT_EQ(sample_quantile(sorted, 0.0), 0.0);
    EXPECT_EQ(sample_quantile(sorted, 0.25), 5.0);
    EXPECT_EQ(sample_quantile(sorted, 0.5), 10.0);
    EXPECT_EQ(sample_quantile(sorted, 1.0), 20.0);
    EXPECT_EQ(sample_quantile(sorted, 1.5), 20.0);
}

TEST(EnergyScore, OfSmallForecasts) {
    // members 0 and 2, observation 3: mean distance 2, mean difference 2, so 2 - 1
    EXPECT_DOUBLE_EQ(energy_score(std::vector{3.0}, PointSample{1, {0.0, 2.0}}), 1.0);
    // in the plane: members (0,0), (3,4), observation (0,0): 2.5 - 2.5
    EXPECT_DOUBLE_EQ(energy_score(std::vector{0.0, 0.0}, PointSample{2, {0.0, 0.0, 3.0, 4.0}}), 0.0);
}

TEST(Pit, CountsBelowAndHalvesTies) {
    const std::vector<double> members{1.0, 2.0, 2.0, 5.0};
    EXPECT_DOUBLE_EQ(pit_value(3.0, members, 0.5), 3.5 / 5.0);
    EXPECT_DOUBLE_EQ(pit_value(2.0, members, 0.0), 1.0 / 5.0);
    EXPECT_DOUBLE_EQ(pit_value(2.0, members, 0.5), 2.5 / 5.0);
    EXPECT_LT(pit_value(9.0, members, 0.999), 1.0);
}

TEST(Axis, OfADirectionIsARotation) {
    const Axis east_south({10.0, 20.0}, std::numbers::pi * 0.75);  // azimuth 135 degrees
    const double r = std::numbers::sqrt2 / 2.0;
    const AxisPlace ahead = east_south.place({10.0 + 5.0 * r, 20.0 - 5.0 * r}),
                    behind = east_south.place({10.0 - r, 20.0 + r});
    EXPECT_NEAR(ahead.along, 5.0, 1e-12);
    EXPECT_NEAR(ahead.lateral, 0.0, 1e-12);
    EXPECT_NEAR(behind.along, -1.0, 1e-12);
    EXPECT_NEAR(east_south.place({11.0, 20.0}).lateral, r, 1e-12) << "the north-east is to the left of south-east";
    EXPECT_NEAR(east_south.place({10.0, 19.0}).lateral, -r, 1e-12);
}

TEST(Axis, OfALineBends) {
    const Axis bent(std::vector<Vec2>{{0, 0}, {10, 0}, {10, 0}, {10, 10}});
    EXPECT_DOUBLE_EQ(bent.place({4.0, -1.0}).along, 4.0);
    EXPECT_DOUBLE_EQ(bent.place({4.0, -1.0}).lateral, -1.0);
    EXPECT_DOUBLE_EQ(bent.place({9.0, 6.0}).along, 16.0);
    EXPECT_DOUBLE_EQ(bent.place({9.0, 6.0}).lateral, 1.0);
    EXPECT_DOUBLE_EQ(bent.place({12.0, 25.0}).along, 35.0) << "the last reach goes on";
    EXPECT_DOUBLE_EQ(bent.place({-3.0, 2.0}).along, -3.0) << "so does the first";
    EXPECT_EQ(bent.point(16.0), Vec2(10.0, 6.0));
    EXPECT_EQ(bent.point(-2.0), Vec2(-2.0, 0.0));
}

TEST(Axis, FindsWhereALineCrosses) {
    const Axis bent(std::vector<Vec2>{{0, 0}, {10, 0}, {10, 10}});
    EXPECT_DOUBLE_EQ(bent.crossing({{4, -1}, {4, 1}}), 4.0);
    EXPECT_DOUBLE_EQ(bent.crossing({{5, 6}, {15, 6}}), 16.0);
    EXPECT_DOUBLE_EQ(bent.crossing({{9, -20}, {9, 50}}), 9.0);
    EXPECT_DOUBLE_EQ(bent.crossing({{0, 20}, {20, 20}}), 30.0) << "behind the end";
    EXPECT_TRUE(std::isnan(bent.crossing({{4, 1}, {4, 2}})));
}

}  // namespace
}  // namespace scree
