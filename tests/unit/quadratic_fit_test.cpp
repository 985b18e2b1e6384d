// SPDX-License-Identifier: GPL-3.0-or-later
// Quadratics through losses: exact where losses are quadratic, honest about noise where they are not exact, least where algebra says.
#include "inference/quadratic_fit.hpp"

#include "inference/calibration_surroundings.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <cmath>

namespace scree {
namespace {

const UnitBox kBox{Eigen::Vector2d(0.4, 0.6), Eigen::Vector2d(0.2, 0.1)};

RandomStream random_stream(std::uint64_t number) {
    return {12, number, RandomPurpose::Calibration};
}

std::vector<Eigen::VectorXd> points_in(const UnitBox& box, std::size_t count, std::uint64_t number) {
    RandomStream random = random_stream(number);
    std::vector<Eigen::VectorXd> points = latin_hypercube(2, count, random);
    for (Eigen::VectorXd& u : points) u = box.centre + box.half.cwiseProduct(2.0 * u - Eigen::Vector2d::Ones());
    return points;
}

/// Record 0: 3 + (u - a)' A (u - a); record 1: 1 + 2 u_0.
double loss(const Eigen::VectorXd& u, int record) {
    const Eigen::Vector2d x = u - Eigen::Vector2d(0.45, 0.58);
    return record == 0 ? 3.0 + 2.0 * x[0] * x[0] + x[0] * x[1] + 3.0 * x[1] * x[1] : 1.0 + 2.0 * u[0];
}

Eigen::MatrixXd losses_at(const std::vector<Eigen::VectorXd>& points, double noise, RandomStream& random) {
    Eigen::MatrixXd losses(static_cast<Eigen::Index>(points.size()), 2);
    for (Eigen::Index k = 0; k < losses.rows(); ++k)
        for (int r = 0; r < 2; ++r)
            losses(k, r) = loss(points[static_cast<std::size_t>(k)], r) + noise * random.normal();
    return losses;
}

TEST(QuadraticFit, IsExactOnQuadraticsInsideAndOutsideItsBox) {
    std::vector<Eigen::VectorXd> points = points_in(kBox, 12, 1);
    points.push_back(Eigen::Vector2d(0.9, 0.1));
    RandomStream random = random_stream(2);
    const QuadraticFit fit(points, losses_at(points, 0.0, random), kBox);
    const Quadratic q = fit.quadratic(fit.coefficients_of(Eigen::Vector2d(1.0, 0.0)));
    const Eigen::VectorXd z = -q.curvature.inverse() * q.slope;
    const Eigen::VectorXd minimum = kBox.centre + kBox.half.cwiseProduct(z);
    EXPECT_NEAR(minimum[0], 0.45, 1e-9);
    EXPECT_NEAR(minimum[1], 0.58, 1e-9);
    EXPECT_NEAR(q.curvature(0, 0), 4.0 * 0.2 * 0.2, 1e-9);  // second derivative times half width squared
    EXPECT_NEAR(q.curvature(0, 1), 1.0 * 0.2 * 0.1, 1e-9);
    EXPECT_NEAR(fit.noise(Eigen::Vector2d(0.5, 0.5)), 0.0, 1e-9);
    EXPECT_NEAR(fit.explained(Eigen::Vector2d(0.5, 0.5)), 1.0, 1e-9);
    // linear in the records: the mean of both is the mean of their coefficients
    const Eigen::VectorXd mean = fit.coefficients_of(Eigen::Vector2d(0.25, 0.75));
    EXPECT_NEAR((mean - 0.25 * fit.coefficients_of(Eigen::Vector2d(1.0, 0.0)) -
                 0.75 * fit.coefficients_of(Eigen::Vector2d(0.0, 1.0)))
                    .norm(),
                0.0, 1e-12);
}

TEST(QuadraticFit, KnowsItsNoiseAndTheErrorOfItsCoefficients) {
    constexpr int kFits = 400;
    constexpr double kNoise = 0.3;
    const std::vector<Eigen::VectorXd> points = points_in(kBox, 20, 3);
    RandomStream random = random_stream(4);
    double variance = 0.0, seen = 0.0, drawn = 0.0;
    const Eigen::Vector2d first(1.0, 0.0);
    const QuadraticFit exact(points, losses_at(points, 0.0, random), kBox);
    for (int k = 0; k < kFits; ++k) {
        const QuadraticFit fit(points, losses_at(points, kNoise, random), kBox);
        variance += fit.noise(first) * fit.noise(first) / kFits;
        seen += (fit.coefficients_of(first) - exact.coefficients_of(first)).squaredNorm() / kFits;
        drawn += fit.coefficient_error(first, random).squaredNorm() / kFits;
    }
    // mean of 400 chi squares of 14 degrees of freedom: standard error 1.9 %; of sums of squares of six coefficients about 5 %
    EXPECT_NEAR(variance / (kNoise * kNoise), 1.0, 0.08);
    EXPECT_NEAR(seen / drawn, 1.0, 0.25);
}

TEST(QuadraticFit, LeastInBox) {
    Quadratic q{0.0, Eigen::Vector2d(-2.0, 1.0), Eigen::Matrix2d::Zero()};
    q.curvature << 4.0, 1.0, 1.0, 2.0;
    const Eigen::VectorXd low = Eigen::Vector2d(-1.0, -1.0), high = Eigen::Vector2d(1.0, 1.0);
    // gradient zero: 4 x + y = 2, x + 2 y = -1
    EXPECT_NEAR((least_in_box(q, low, high) - Eigen::Vector2d(5.0 / 7.0, -6.0 / 7.0)).norm(), 0.0, 1e-6);
    // on the side x = 0.5: 2 y = -1 - 0.5
    EXPECT_NEAR((least_in_box(q, low, Eigen::Vector2d(0.5, 1.0)) - Eigen::Vector2d(0.5, -0.75)).norm(), 0.0, 1e-9);
    // a saddle: least on the ends of its concave axis, the one that the slope points to
    q.curvature << -4.0, 0.0, 0.0, 2.0;
    EXPECT_NEAR((least_in_box(q, low, high) - Eigen::Vector2d(1.0, -0.5)).norm(), 0.0, 1e-9);
    // flat along the second axis: anywhere there is as good, the end that the slope asks for is taken
    q.curvature << 4.0, 0.0, 0.0, 0.0;
    EXPECT_NEAR((least_in_box(q, low, high) - Eigen::Vector2d(0.5, -1.0)).norm(), 0.0, 1e-9);
}

TEST(QuadraticFit, LatinHypercubeMeetsEverySliceOnce) {
    RandomStream random = random_stream(5);
    const std::vector<Eigen::VectorXd> points = latin_hypercube(3, 7, random);
    for (Eigen::Index i = 0; i < 3; ++i) {
        std::vector<int> met(7, 0);
        for (const Eigen::VectorXd& p : points) ++met[static_cast<std::size_t>(7.0 * p[i])];
        EXPECT_EQ(met, std::vector<int>(7, 1));
    }
}

TEST(QuadraticFit, BoxesStayInTheUnitCube) {
    const UnitBox box = box_around(Eigen::Vector2d(0.02, 0.99), Eigen::Vector2d(0.2, 0.3));
    EXPECT_NEAR((box.centre - Eigen::Vector2d(0.2, 0.7)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace scree
