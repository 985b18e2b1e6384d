// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/emulator.hpp"

#include "inference/eigenpairs.hpp"

#include "scree/base/assert.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace scree {

namespace {

/// Variance of the plane, over that of the process: at the middle of the cube, and of its slopes, so that every coordinate adds as much at the sides [-].
constexpr double kPlane = 100.0, kPlaneSlope = 4.0 * kPlane;
/// Noise over variance that is looked at: least, factor and number [-].
constexpr double kLeastRatio = 1e-4, kRatioFactor = 3.1622776601683795;
constexpr int kRatios = 15;
/// Lengths that are looked at, and the factor between them [-].
constexpr double kLeastLength = 0.1, kMostLength = 3.2, kLengthFactor = 2.0;

double matern(double r) {
    const double x = std::sqrt(5.0) * r;
    return (1.0 + x + x * x / 3.0) * std::exp(-x);
}

/// Of the plane at one place, per place and point.
Eigen::MatrixXd of_plane(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (kPlane + kPlaneSlope * ((a.array() - 0.5).matrix() * (b.array() - 0.5).matrix().transpose()).array())
        .matrix();
}

Eigen::MatrixXd distances(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::VectorXd& lengths) {
    const Eigen::MatrixXd A = a * lengths.cwiseInverse().asDiagonal(), B = b * lengths.cwiseInverse().asDiagonal();
    Eigen::MatrixXd squared = -2.0 * A * B.transpose();
    squared.colwise() += A.rowwise().squaredNorm();
    squared.rowwise() += B.rowwise().squaredNorm().transpose();
    return squared.cwiseMax(0.0).cwiseSqrt();
}

Eigen::MatrixXd correlations(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::VectorXd& lengths) {
    return distances(a, b, lengths).unaryExpr(&matern) + of_plane(a, b);
}

}  // namespace

Emulator::Emulator(Eigen::MatrixXd points, const Eigen::MatrixXd& values, const Eigen::VectorXd& lengths,
                   double least_noise)
    : points_(std::move(points)), lengths_(lengths), middle_(values.colwise().mean()) {
    const Eigen::Index count = points_.rows(), functions = values.cols();
    SCREE_ASSERT(count > 0 && values.rows() == count && lengths.size() == points_.cols() && least_noise > 0.0);
    Eigenpairs pairs = eigenpairs(correlations(points_, points_, lengths_));
    axes_ = std::move(pairs.vectors);
    const Eigen::ArrayXd along = pairs.values.array().max(0.0);
    const Eigen::MatrixXd turned = axes_.transpose() * (values.rowwise() - middle_);
    shrink_.resize(count, functions);
    variance_.resize(functions);
    noise_.resize(functions);
    for (Eigen::Index f = 0; f < functions; ++f) {
        const Eigen::ArrayXd squares = turned.col(f).array().square();
        double most = -std::numeric_limits<double>::infinity(), ratio = kLeastRatio;
        for (int k = 0; k < kRatios; ++k, ratio *= kRatioFactor) {
            const double sum = (squares / (along + ratio)).sum(), number = static_cast<double>(count),
                         variance = std::max(sum / number, least_noise / ratio),
                         likely = -0.5 * (number * std::log(variance) + (along + ratio).log().sum() + sum / variance);
            if (!(likely > most)) continue;
            most = likely;
            variance_[f] = variance;
            noise_[f] = ratio * variance;
            shrink_.col(f) = (along + ratio).inverse();
        }
        log_likelihood_ += most;
    }
    alpha_ = axes_ * shrink_.cwiseProduct(turned);
}

Emulator::Prediction Emulator::at(const Eigen::MatrixXd& places) const {
    const Eigen::MatrixXd with = correlations(places, points_, lengths_);
    Prediction p;
    p.mean = (with * alpha_).rowwise() + middle_;
    const Eigen::VectorXd alone =
        (1.0 + kPlane + kPlaneSlope * (places.array() - 0.5).square().rowwise().sum()).matrix();
    p.variance = -((with * axes_).cwiseAbs2() * shrink_);
    p.variance.colwise() += alone;
    p.variance = p.variance.cwiseMax(0.0) * variance_.asDiagonal();
    return p;
}

Eigen::MatrixXd Emulator::slopes(const Eigen::VectorXd& place) const {
    const Eigen::VectorXd r = distances(place.transpose(), points_, lengths_).transpose();
    const Eigen::VectorXd fall =
        r.unaryExpr([](double d) { return -5.0 / 3.0 * (1.0 + std::sqrt(5.0) * d) * std::exp(-std::sqrt(5.0) * d); });
    Eigen::MatrixXd of_each = kPlaneSlope * (points_.array() - 0.5).matrix();  // points x coordinates
    of_each += fall.asDiagonal() * ((-points_).rowwise() + place.transpose()) *
               lengths_.cwiseAbs2().cwiseInverse().asDiagonal();
    return alpha_.transpose() * of_each;
}

Eigen::VectorXd Emulator::likely_lengths(const Eigen::MatrixXd& points, const Eigen::MatrixXd& values,
                                         Eigen::VectorXd lengths, double least_noise) {
    double most = Emulator(points, values, lengths, least_noise).log_likelihood();
    const auto improves = [&](Eigen::Index k, double factor) {
        Eigen::VectorXd other = lengths;
        other[k] *= factor;
        if (other[k] < kLeastLength || other[k] > kMostLength) return false;
        const double likely = Emulator(points, values, other, least_noise).log_likelihood();
        if (!(likely > most)) return false;
        most = likely;
        lengths = std::move(other);
        return true;
    };
    for (Eigen::Index k = 0; k < lengths.size(); ++k) {
        const double before = lengths[k];
        while (improves(k, kLengthFactor)) {
        }
        if (lengths[k] != before) continue;
        while (improves(k, 1.0 / kLengthFactor)) {
        }
    }
    return lengths;
}

}  // namespace scree
