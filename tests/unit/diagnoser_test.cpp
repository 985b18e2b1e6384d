// SPDX-License-Identifier: GPL-3.0-or-later
// How sure a diagnosis may be of what its surveys say.
#include "inference/diagnoser.hpp"

#include "scree/base/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scree {
namespace {

TEST(MeanWeights, AreSharesWhereNothingScatters) {
    const std::vector<double> w = mean_weights({-1000.0, -1001.0, -1003.0}, {0.0, 0.0, 0.0}, 1);
    const double sum = 1.0 + std::exp(-1.0) + std::exp(-3.0);
    EXPECT_NEAR(w[0], 1.0 / sum, 1e-12);
    EXPECT_NEAR(w[1], std::exp(-1.0) / sum, 1e-12);
    EXPECT_NEAR(w[2], std::exp(-3.0) / sum, 1e-12);
}

// Two that scatter: the difference is normal, and the mean of the logistic function of it an integral.
TEST(MeanWeights, OfTwoThatScatterNeitherIsSure) {
    constexpr double kAhead = 4.0, kDeviation = 1.5, kStep = 0.01;
    double expected = 0.0;
    for (double n = -8.0; n <= 8.0; n += kStep)
        expected += kStep * std::exp(-0.5 * n * n) / std::sqrt(2.0 * std::numbers::pi) /
                    (1.0 + std::exp(-(kAhead + std::numbers::sqrt2 * kDeviation * n)));
    const std::vector<double> w = mean_weights({0.0, -kAhead}, {kDeviation, kDeviation}, 1);
    EXPECT_NEAR(w[0], expected, 0.015) << "four standard errors of the draws";
    EXPECT_NEAR(w[0] + w[1], 1.0, 1e-12);
    EXPECT_LT(w[0], mean_weights({0.0, -kAhead}, {0.0, 0.0}, 1)[0] - 0.02);
}

/// Finalists with these weights and p; the rest of the weight is chance's and of what has no name, half and half.
Diagnosis weighed(const std::vector<std::pair<double, double>>& finalists) {
    Diagnosis d;
    d.weight_none = d.weight_unnamed = 0.5;
    for (const auto& [weight, p] : finalists) {
        EffectFinding& f = d.findings.emplace_back();
        f.finalist = true;
        f.weight = weight;
        f.p = p;
        d.weight_none -= 0.5 * weight;
        d.weight_unnamed -= 0.5 * weight;
    }
    return d;
}

TEST(RejectedFinalists, LeaveTheirWeightToWhatCouldBeIt) {
    Diagnosis d = weighed({{0.8, 0.3}, {0.1, 0.01}, {0.06, 0.4}});
    leave_out_rejected(d, 0.05);
    EXPECT_NEAR(d.findings[0].weight, 0.8 / 0.9, 1e-12);
    EXPECT_EQ(d.findings[1].weight, 0.0);
    EXPECT_NEAR(d.findings[2].weight, 0.06 / 0.9, 1e-12);
    EXPECT_NEAR(d.weight_none, 0.02 / 0.9, 1e-12);
    EXPECT_NEAR(d.weight_unnamed, 0.02 / 0.9, 1e-12);
}

// One time in twenty the right one is rejected: what fits far less well gets no name by that.
TEST(RejectedFinalists, KeepItWhereTheyAreHeaviest) {
    Diagnosis d = weighed({{0.09, 0.3}, {0.9, 0.04}});
    leave_out_rejected(d, 0.05);
    EXPECT_NEAR(d.findings[0].weight, 0.09, 1e-12);
    EXPECT_NEAR(d.findings[1].weight, 0.9, 1e-12);
    Diagnosis none;
    leave_out_rejected(none, 0.05);
    EXPECT_TRUE(none.findings.empty());
}

// Surveys of a plane with noise, repeated: what they say of a place scatters as variance_at() has it.
TEST(Slopes, KnowTheScatterOfWhatTheySayOfAPlace) {
    constexpr int kSurveys = 4000;
    constexpr double kRowsOver = 0.25;
    const Eigen::MatrixXd signs = design_of(3);
    Eigen::MatrixXd moved = signs;
    moved.col(1) = moved.col(1).cwiseMin(0.2);  // the end of a range
    const Eigen::Vector3d by(1.0, -0.7, 0.3);
    RandomStream random(7, 0, RandomPurpose::Observation);
    double sum = 0.0, squares = 0.0, told = 0.0;
    for (int k = 0; k < kSurveys; ++k) {
        const Eigen::MatrixXd means = (moved * Eigen::Vector3d(2.0, -1.0, 0.5)).unaryExpr([&](double v) {
            return 5.0 + v + std::sqrt(kRowsOver) * random.normal();
        });
        const Slopes s = slopes_of(moved, means, kRowsOver);
        const double says = s.at_place[0] + s.directions.row(0).dot(by);
        sum += says;
        squares += says * says;
        told = s.variance_at(by);
    }
    const double mean = sum / kSurveys, variance = squares / kSurveys - mean * mean;
    EXPECT_NEAR(mean, 5.0 + 2.0 + 0.7 + 0.15, 4.0 * std::sqrt(told / kSurveys));
    EXPECT_NEAR(variance, told, 4.0 * told * std::sqrt(2.0 / kSurveys));
}

}  // namespace
}  // namespace scree
