// SPDX-License-Identifier: GPL-3.0-or-later
// What free strengths and places cost.
#include "inference/diagnoser.hpp"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scree {
namespace {

// The best parameter for each pair, and the pairs summed up.
TEST(Weights, TheRoomOfUnknownsThatMakeUpForEachOtherIsTheIntegralOverThem) {
    Eigen::Matrix3d information;
    information << 2.0, 0.6, 0.4,  // a parameter, which takes up some of both
        0.6, 30.0, 27.0,           // strength and length, of which the product is known
        0.4, 27.0, 26.0;
    constexpr double kFar = 6.0, kStep = 0.02;
    double sum = 0.0;
    for (double x = -kFar; x < kFar; x += kStep)
        for (double y = -kFar; y < kFar; y += kStep) {
            const double parameter = -(0.6 * x + 0.4 * y) / 2.0;
            const Eigen::Vector3d at(parameter, x, y);
            sum += std::exp(-0.5 * at.dot(information * at)) * kStep * kStep;
        }
    EXPECT_NEAR(log_volume(information, 2), std::log(sum), 1e-3);
    const Eigen::Matrix3d covariance = information.inverse();
    const double each = std::log(2.0 * std::numbers::pi * std::sqrt(covariance(1, 1) * covariance(2, 2)));
    EXPECT_LT(log_volume(information, 2), each - 1.0) << "not that of both alone";
}

}  // namespace
}  // namespace scree
