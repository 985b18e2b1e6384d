// SPDX-License-Identifier: GPL-3.0-or-later
// Is the model rejected, and what must a change be like for that.
#include "scree/base/random.hpp"
#include "scree/inference/score_test.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace scree::test {
namespace {

// Of changes that Q alone is to see, those whose power is told as 0.84 beyond the limit are rejected in four of five tests.
TEST(GlobalTest, WhatQSeesIsToldAsAZOfAsMuchPower) {
    constexpr int kResiduals = 12, kSimulated = 4000, kBlocks = 50, kTests = 2000;
    std::vector<Residual> residuals;
    ObservationTable measured;
    for (int k = 0; k < kResiduals; ++k) {
        const Column c{Quantity::Speed, k};
        residuals.push_back({ResidualKind::Level, c, {}, kNaN, kNaN});
        measured.columns.push_back(c);
        measured.values.emplace_back(kBlocks, 1.0);
    }
    measured.block.assign(kBlocks, 0);
    RandomStream random(1, 0, RandomPurpose::Observation);
    ResidualRows own(kSimulated, kResiduals);
    for (int row = 0; row < kSimulated; ++row) {
        const double common = random.normal();
        for (int k = 0; k < kResiduals; ++k) own(row, k) = random.normal() + 0.5 * common;
    }
    own.rowwise() -= own.colwise().mean();
    const std::vector<std::int32_t> block(kSimulated, 0);
    const NullRows null(own, block, residuals, measured);
    const Eigen::VectorXd change = Eigen::VectorXd::Unit(kResiduals, 1) - Eigen::VectorXd::Unit(kResiduals, 2);
    const ScoreTest test(row_covariance(own, Eigen::VectorXd::Zero(kResiduals)), Eigen::VectorXd::Unit(kResiduals, 3),
                         Eigen::VectorXd::Constant(1, 10.0), {{change}});
    const ResidualMean any = mean_residual(null.draw(1, 0));
    const GlobalTest global = global_test(test, test(any), null, 1999, 0.05, 7);
    EXPECT_NEAR(global.q_mean, kResiduals - 1, 0.5);
    EXPECT_NEAR(global.q_deviation, std::sqrt(2.0 * (kResiduals - 1)), 0.5);

    double visibility = 0.0;
    while (z_of_as_much_power(global, visibility) < global.z_limit + 0.8416) visibility += 0.01;
    EXPECT_GT(visibility, 3.0);
    const double of_one = test(any).visibility[0];
    int rejected = 0;
    for (std::uint64_t draw = 0; draw < kTests; ++draw) {
        ResidualMean r = mean_residual(null.draw(2, draw));
        r.mean += change * (visibility / of_one);
        rejected += test(r).q > global.q_limit ? 1 : 0;
    }
    EXPECT_NEAR(rejected / static_cast<double>(kTests), 0.8, 0.03);
}

}  // namespace
}  // namespace scree::test
