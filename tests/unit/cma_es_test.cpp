// SPDX-License-Identifier: GPL-3.0-or-later
// The evolution strategy on functions with known minima, and what its derivation promises: it sees ranks only, and no axes.
#include "inference/cma_es.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace scree {
namespace {

using Loss = std::function<double(const Eigen::VectorXd&)>;

RandomStream random_stream(std::uint64_t number) {
    return {11, number, RandomPurpose::Calibration};
}

CmaEs minimise(const Loss& loss, const Eigen::VectorXd& start, int generations, std::uint64_t number) {
    CmaEs strategy(start, 0.3, 0, random_stream(number));
    for (int g = 0; g < generations; ++g) {
        std::vector<double> losses;
        for (const Eigen::VectorXd& x : strategy.ask()) losses.push_back(loss(x));
        strategy.tell(losses);
    }
    return strategy;
}

/// sum a_i x_i^2 with a from 1 to 1e4, in axes that are turned.
double ellipsoid(const Eigen::VectorXd& x) {
    Eigen::MatrixXd m(4, 4);
    m << 1, 2, 3, 4, 0, 1, -1, 2, 5, 1, 0, -2, 1, 1, 1, -1;
    const Eigen::MatrixXd turn = Eigen::HouseholderQR<Eigen::MatrixXd>(m).householderQ();
    const Eigen::VectorXd y = turn * (x.array() - 0.3).matrix();
    double sum = 0.0;
    for (Eigen::Index i = 0; i < 4; ++i) sum += std::pow(1e4, static_cast<double>(i) / 3.0) * y[i] * y[i];
    return sum;
}

TEST(CmaEs, FindsTheMinimumOfATurnedEllipsoidOfConditionTenThousand) {
    const CmaEs end = minimise(ellipsoid, Eigen::VectorXd::Constant(4, 0.9), 250, 1);
    // Hansen's tutorial, figure 4: about 1e3 evaluations per five decades in dimension 4 once the shape is learned
    EXPECT_LT((end.mean().array() - 0.3).abs().maxCoeff(), 1e-6);
    // it has learned the shape: variances in inverse proportion to the curvatures, which span four decades
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> shape(end.covariance());
    const double span = std::log10(shape.eigenvalues().maxCoeff() / shape.eigenvalues().minCoeff());
    EXPECT_NEAR(span, 4.0, 1.0);
}

TEST(CmaEs, FollowsABentValley) {
    const Loss rosenbrock = [](const Eigen::VectorXd& x) {
        return 100.0 * std::pow(x[1] - x[0] * x[0], 2.0) + std::pow(1.0 - x[0], 2.0);
    };
    const CmaEs end = minimise(rosenbrock, Eigen::Vector2d(-1.0, 0.5), 200, 2);
    EXPECT_NEAR(end.mean()[0], 1.0, 1e-5);
    EXPECT_NEAR(end.mean()[1], 1.0, 1e-5);
}

TEST(CmaEs, SeesRanksOnly) {
    const Eigen::VectorXd start = Eigen::VectorXd::Constant(4, 0.9);
    const CmaEs plain = minimise(ellipsoid, start, 30, 3);
    const CmaEs warped =
        minimise([](const Eigen::VectorXd& x) { return std::log(1e-3 + ellipsoid(x)) - 5.0; }, start, 30, 3);
    EXPECT_EQ(plain.mean(), warped.mean());
    EXPECT_EQ(plain.sigma(), warped.sigma());
}

TEST(CmaEs, AveragesNoise) {
    // losses of the sphere with noise as large as the loss at distance 1: single candidates mislead, the mean does not
    RandomStream noise = random_stream(99);
    const Loss noisy = [&](const Eigen::VectorXd& x) { return x.squaredNorm() + noise.normal(); };
    double error = 0.0;
    constexpr int kRuns = 20;
    for (int k = 0; k < kRuns; ++k)
        error +=
            minimise(noisy, Eigen::VectorXd::Constant(3, 3.0), 40, 10 + static_cast<std::uint64_t>(k)).mean().norm() /
            kRuns;
    EXPECT_LT(error, 1.0);  // from a distance of 5.2
}

TEST(CmaEs, InfiniteLossesRankLast) {
    const Loss half = [](const Eigen::VectorXd& x) {
        return x[0] > 0.5 ? std::numeric_limits<double>::infinity() : x.squaredNorm();
    };
    EXPECT_LT(minimise(half, Eigen::Vector2d(0.45, 0.9), 60, 4).mean().norm(), 1e-2);
}

TEST(CmaEs, ReflectsAtTheEndsOfTheRange) {
    EXPECT_DOUBLE_EQ(reflected(0.3), 0.3);
    EXPECT_DOUBLE_EQ(reflected(-0.2), 0.2);
    EXPECT_DOUBLE_EQ(reflected(1.2), 0.8);
    EXPECT_NEAR(reflected(2.1), 0.1, 1e-12);
    EXPECT_NEAR(reflected(-3.4), 0.6, 1e-12);
}

}  // namespace
}  // namespace scree
