// SPDX-License-Identifier: GPL-3.0-or-later
// Emulators of functions that are known, and the search that they serve.
#include "inference/emulated_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace scree {
namespace {

using Function = std::function<double(const Eigen::VectorXd&)>;

RandomStream random_stream(std::uint64_t number) {
    return {23, number, RandomPurpose::Calibration};
}

Eigen::MatrixXd random_points(Eigen::Index count, Eigen::Index dimension, RandomStream& random) {
    return Eigen::MatrixXd::NullaryExpr(count, dimension, [&] { return random.uniform(); });
}

Eigen::MatrixXd values_of(const std::vector<Function>& functions, const Eigen::MatrixXd& points) {
    Eigen::MatrixXd values(points.rows(), std::ssize(functions));
    for (Eigen::Index k = 0; k < points.rows(); ++k)
        for (std::size_t f = 0; f < functions.size(); ++f)
            values(k, static_cast<Eigen::Index>(f)) = functions[f](points.row(k));
    return values;
}

const Function kPlane = [](const Eigen::VectorXd& u) { return 3.0 + 40.0 * u[0] - 7.0 * u[1]; };
const Function kWave = [](const Eigen::VectorXd& u) { return 10.0 * std::sin(3.0 * u[0]) * std::cos(2.0 * u[1]); };

TEST(Emulator, KnowsSmoothFunctionsFromFewPoints) {
    RandomStream random = random_stream(0);
    const Eigen::MatrixXd points = random_points(40, 2, random), others = random_points(200, 2, random);
    const Emulator emulator(points, values_of({kPlane, kWave}, points), Eigen::Vector2d(0.8, 0.8), 1e-8);
    const Eigen::MatrixXd wrong = emulator.at(others).mean - values_of({kPlane, kWave}, others);
    EXPECT_LT(wrong.col(0).cwiseAbs().maxCoeff(), 1e-2);
    EXPECT_LT(std::sqrt(wrong.col(1).squaredNorm() / 200.0), 0.3);
}

TEST(Emulator, ContinuesAPlaneBeyondItsPoints) {
    RandomStream random = random_stream(1);
    Eigen::MatrixXd points = random_points(40, 2, random);
    points *= 0.3;
    const Emulator emulator(points, values_of({kPlane}, points), Eigen::Vector2d(0.4, 0.4), 1e-6);
    EXPECT_NEAR(emulator.at(Eigen::RowVector2d(0.9, 0.9)).mean(0, 0), kPlane(Eigen::Vector2d(0.9, 0.9)), 2.0);
}

TEST(Emulator, SaysHowSureItIs) {
    RandomStream random = random_stream(2);
    std::vector<Function> functions;  // drawn anew, so that coverage is one of many
    for (int k = 0; k < 40; ++k) {
        const double a = 3.0 * random.normal(), b = 3.0 * random.normal(), c = 2.0 * random.normal();
        functions.emplace_back([=](const Eigen::VectorXd& u) {
            return 4.0 * std::sin(a * u[0] + c) + 4.0 * std::cos(b * u[1] + a * u[2]);
        });
    }
    const Eigen::MatrixXd points = random_points(60, 3, random), others = random_points(100, 3, random);
    Eigen::MatrixXd noisy = values_of(functions, points);
    for (Eigen::Index k = 0; k < noisy.size(); ++k) noisy.data()[k] += random.normal();
    const Eigen::VectorXd lengths = Emulator::likely_lengths(points, noisy, Eigen::Vector3d::Constant(0.8), 0.01);
    const Emulator emulator(points, noisy, lengths, 0.01);
    const Emulator::Prediction p = emulator.at(others);
    const Eigen::MatrixXd z = (p.mean - values_of(functions, others)).cwiseQuotient(p.variance.cwiseSqrt());
    const double within = static_cast<double>((z.array().abs() < 2.0).count()) / static_cast<double>(z.size());
    EXPECT_GT(within, 0.90);
    EXPECT_LT(within, 0.99);
    EXPECT_NEAR(emulator.noise().mean(), 1.0, 0.25);
}

TEST(Emulator, SlopesAreThoseOfItsMeans) {
    RandomStream random = random_stream(3);
    const Eigen::MatrixXd points = random_points(30, 3, random);
    const Function bent = [](const Eigen::VectorXd& u) { return std::exp(u[0]) * u[1] + 5.0 * u[2] * u[2]; };
    const Emulator emulator(points, values_of({kPlane, bent}, points), Eigen::Vector3d(0.4, 0.8, 1.6), 1e-4);
    const Eigen::Vector3d place(0.3, 0.6, 0.45);
    const Eigen::MatrixXd slopes = emulator.slopes(place);
    for (Eigen::Index k = 0; k < 3; ++k) {
        constexpr double kStep = 1e-5;
        const Eigen::Vector3d by = kStep * Eigen::Vector3d::Unit(k);
        const Eigen::RowVectorXd change =
            (emulator.at((place + by).transpose()).mean.row(0) - emulator.at((place - by).transpose()).mean.row(0)) /
            (2.0 * kStep);
        EXPECT_NEAR(slopes(0, k), change[0], 1e-3 + 1e-4 * std::abs(change[0]));
        EXPECT_NEAR(slopes(1, k), change[1], 1e-3 + 1e-4 * std::abs(change[1]));
    }
}

TEST(Emulator, FindsWhichCoordinatesBend) {
    RandomStream random = random_stream(4);
    const Eigen::MatrixXd points = random_points(60, 2, random);
    const Function wiggly = [](const Eigen::VectorXd& u) { return 5.0 * std::sin(9.0 * u[0]) + u[1]; };
    const Eigen::VectorXd lengths =
        Emulator::likely_lengths(points, values_of({wiggly}, points), Eigen::Vector2d(0.8, 0.8), 1e-4);
    EXPECT_LT(lengths[0], 0.8);
    EXPECT_GT(lengths[1], 0.8);
}

/// Twelve residuals of six unknowns with noise: a narrow curved valley with the sum 0 in it, and a broad one with the sum 40.
Eigen::VectorXd without_noise(const Eigen::VectorXd& u) {
    Eigen::VectorXd r(12);
    const double narrow = (u.array() - 0.75).matrix().norm(), broad = (u.array() - 0.25).matrix().norm();
    for (Eigen::Index k = 0; k < 6; ++k) {
        const double along = u[k] + 0.3 * u[(k + 1) % 6] * u[(k + 1) % 6];
        r[k] = 12.0 * (along - (0.75 + 0.3 * 0.75 * 0.75)) * std::min(1.0, 2.0 * broad);
        r[k + 6] = std::sqrt(40.0 / 6.0) * std::min(1.0, 2.0 * narrow);
    }
    return r;
}

Eigen::VectorXd noisy(const Eigen::VectorXd& u, RandomStream& random) {
    return without_noise(u).unaryExpr([&](double r) { return r + random.normal(); });
}

EmulatedSearch searched(std::size_t trials, std::uint64_t number,
                        const std::function<Eigen::VectorXd(const Eigen::VectorXd&, RandomStream&)>& residuals) {
    EmulatedSearch search(6, 1.0, random_stream(number));
    RandomStream noise = random_stream(1000 + number);
    for (std::size_t done = 0; done < trials;) {
        std::vector<Eigen::VectorXd> told;
        for (const Eigen::VectorXd& u : search.ask()) told.push_back(residuals(u, noise));
        search.tell(told);
        done += told.size();
    }
    return search;
}

TEST(EmulatedSearch, FindsTheNarrowValleyThroughNoise) {
    int found = 0;
    for (std::uint64_t number = 0; number < 5; ++number) {
        const EmulatedSearch search = searched(160, number, noisy);
        const double left = without_noise(search.best()).squaredNorm();
        if (left < 12.0) ++found;  // what the noise of a single trial adds
        EXPECT_NEAR(search.left(), left, 12.0 + 0.5 * left) << number;
    }
    EXPECT_GE(found, 4);
}

TEST(EmulatedSearch, LeavesPlacesAloneThatSayNothing) {
    std::size_t there = 0, all = 0;
    searched(160, 7, [&](const Eigen::VectorXd& u, RandomStream& random) {
        if (++all > EmulatedSearch::kSpread && u[0] < 0.5) ++there;
        return u[0] < 0.5 ? Eigen::VectorXd() : noisy(u, random);
    });
    EXPECT_LT(there, (all - EmulatedSearch::kSpread) / 10);
}

/// Seen from far away all that is near looks alike.
TEST(EmulatedSearch, WhatIsToldAgainTakesThePlaceOfWhatWasTold) {
    const auto from_far = [](const Eigen::VectorXd& r) {
        return Eigen::VectorXd(r.unaryExpr([](double x) { return 4.0 * std::tanh(0.05 * x + 1.0); }));
    };
    int closer = 0;
    for (std::uint64_t number = 10; number < 15; ++number) {
        EmulatedSearch far_off(6, 1.0, random_stream(number));
        RandomStream noise = random_stream(1000 + number);
        std::vector<Eigen::VectorXd> near_by;
        const auto trials = [&](std::size_t count, const auto& seen) {
            for (std::size_t done = 0; done < count;) {
                std::vector<Eigen::VectorXd> told;
                for (const Eigen::VectorXd& u : far_off.ask()) {
                    near_by.push_back(noisy(u, noise));
                    told.push_back(seen(near_by.back()));
                }
                far_off.tell(told);
                done += told.size();
            }
        };
        trials(80, from_far);
        const double before = without_noise(far_off.best()).squaredNorm();
        far_off.tell_again(near_by);
        EXPECT_LE(without_noise(far_off.best()).squaredNorm(), before) << number;
        trials(80, [](const Eigen::VectorXd& r) { return r; });
        const double left = without_noise(far_off.best()).squaredNorm();
        EXPECT_NEAR(far_off.left(), left, 12.0 + 0.5 * left) << number;
        if (left < 12.0) ++closer;
    }
    EXPECT_GE(closer, 4);
}

TEST(EmulatedSearch, WhereNothingSaysAnythingItKnowsNothing) {
    const EmulatedSearch search =
        searched(64, 8, [](const Eigen::VectorXd&, RandomStream&) { return Eigen::VectorXd(); });
    EXPECT_EQ(search.left(), std::numeric_limits<double>::infinity());
    EXPECT_EQ(search.slopes().rows(), 0);
}

TEST(EmulatedSearch, TheSameSeedAsksForTheSame) {
    const EmulatedSearch a = searched(80, 9, noisy), b = searched(80, 9, noisy);
    EXPECT_EQ(a.best(), b.best());
    EXPECT_EQ(a.left(), b.left());
}

}  // namespace
}  // namespace scree
