// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/quadratic_fit.hpp"

#include "scree/base/assert.hpp"
#include "scree/inference/distance.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

namespace {

constexpr int kSweeps = 200;       // of a coordinate descent at most [-]
constexpr double kSettled = 1e-9;  // movement in a sweep below which it has arrived [-]

/// 1, z_i, then z_i z_j for i <= j.
Eigen::RowVectorXd features(const Eigen::VectorXd& z) {
    const Eigen::Index d = z.size();
    Eigen::RowVectorXd f(static_cast<Eigen::Index>(QuadraticFit::coefficients(static_cast<std::size_t>(d))));
    Eigen::Index k = 0;
    f[k++] = 1.0;
    for (Eigen::Index i = 0; i < d; ++i) f[k++] = z[i];
    for (Eigen::Index i = 0; i < d; ++i)
        for (Eigen::Index j = i; j < d; ++j) f[k++] = z[i] * z[j];
    return f;
}

/// Less than 1 where the mean loss exceeds the least by more than kWall times what the median does. The least is a quantile: single points are lucky.
Eigen::VectorXd trust_in_valley(const Eigen::MatrixXd& losses) {
    constexpr double kFloor = 0.1, kWall = 3.0;  // a quadratic in a box rarely exceeds that [-]
    const Eigen::VectorXd mean = losses.rowwise().mean();
    std::vector<double> sorted(mean.begin(), mean.end());
    std::sort(sorted.begin(), sorted.end());
    const double least = sample_quantile(sorted, kFloor), width = kWall * (sample_quantile(sorted, 0.5) - least);
    Eigen::VectorXd trust = Eigen::VectorXd::Ones(mean.size());
    for (Eigen::Index k = 0; k < mean.size() && width > 0.0; ++k)
        trust[k] = 1.0 / std::max(1.0, (mean[k] - least) / width);
    return trust;
}

double value_at(const Quadratic& q, const Eigen::VectorXd& z) {
    return q.constant + q.slope.dot(z) + 0.5 * z.dot(q.curvature * z);
}

/// Each coordinate to where the quadratic is least along it, in turn, until nothing moves: exact for one, convergent for all.
Eigen::VectorXd descend(const Quadratic& q, const Eigen::VectorXd& low, const Eigen::VectorXd& high,
                        Eigen::VectorXd z) {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        double moved = 0.0;
        for (Eigen::Index i = 0; i < z.size(); ++i) {
            const double curvature = q.curvature(i, i);
            const double rest = q.slope[i] + q.curvature.row(i).dot(z) - curvature * z[i];
            double best = std::clamp(-rest / std::max(curvature, std::numeric_limits<double>::min()), low[i], high[i]);
            if (curvature <= 0.0) {  // concave along it: at an end
                const auto along = [&](double x) { return rest * x + 0.5 * curvature * x * x; };
                best = along(low[i]) <= along(high[i]) ? low[i] : high[i];
            }
            moved = std::max(moved, std::abs(best - z[i]));
            z[i] = best;
        }
        if (moved < kSettled) break;
    }
    return z;
}

}  // namespace

QuadraticFit::QuadraticFit(const std::vector<Eigen::VectorXd>& points, const Eigen::MatrixXd& losses,
                           const UnitBox& box)
    : dimension_(box.centre.size()), losses_(losses) {
    const auto rows = static_cast<Eigen::Index>(points.size());
    const auto columns = static_cast<Eigen::Index>(coefficients(static_cast<std::size_t>(dimension_)));
    SCREE_ASSERT(rows > columns && losses.rows() == rows);
    Eigen::MatrixXd design(rows, columns);
    trust_ = trust_in_valley(losses);
    for (Eigen::Index k = 0; k < rows; ++k) {
        const Eigen::VectorXd z = (points[static_cast<std::size_t>(k)] - box.centre).cwiseQuotient(box.half);
        trust_[k] /= std::max(1.0, z.cwiseAbs().maxCoeff());
        design.row(k) = trust_[k] * features(z);
    }
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(design);
    inverse_ = solver.pseudoInverse();
    const Eigen::MatrixXd trusted = trust_.asDiagonal() * losses;
    per_record_ = inverse_ * trusted;
    residual_ = trusted - design * per_record_;
    // noise of variance 1 at every point leaves residuals of variance (I-H) T^2 (I-H) on its diagonal
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(rows, rows) - design * inverse_;
    const Eigen::VectorXd variance = left.cwiseAbs2() * trust_.cwiseAbs2();
    shrunk_ = variance.cwiseMax(1e-12).cwiseSqrt().cwiseQuotient(trust_);
    freedom_ = variance.sum();
}

double QuadraticFit::noise(const Eigen::VectorXd& weights) const {
    return (residual_ * weights).norm() / std::sqrt(freedom_);
}

double QuadraticFit::explained(const Eigen::VectorXd& weights) const {
    const Eigen::VectorXd mean = losses_ * weights, share = trust_.cwiseAbs2() / trust_.squaredNorm();
    const double total = trust_.cwiseProduct((mean.array() - share.dot(mean)).matrix()).squaredNorm();
    return total > 0.0 ? 1.0 - (residual_ * weights).squaredNorm() / total : 0.0;
}

Eigen::VectorXd QuadraticFit::coefficient_error(const Eigen::VectorXd& weights, RandomStream& random) const {
    Eigen::VectorXd error = (residual_ * weights).cwiseQuotient(shrunk_);
    for (double& value : error) value *= random.normal();
    return inverse_ * error;
}

Quadratic QuadraticFit::quadratic(const Eigen::VectorXd& coefficients) const {
    Quadratic q;
    q.constant = coefficients[0];
    q.slope = coefficients.segment(1, dimension_);
    q.curvature = Eigen::MatrixXd::Zero(dimension_, dimension_);
    Eigen::Index k = 1 + dimension_;
    for (Eigen::Index i = 0; i < dimension_; ++i)
        for (Eigen::Index j = i; j < dimension_; ++j, ++k) {
            q.curvature(i, j) += coefficients[k];
            q.curvature(j, i) += coefficients[k];
        }
    return q;
}

Eigen::VectorXd least_in_box(const Quadratic& q, const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
    const Eigen::VectorXd middle = 0.5 * (low + high);
    std::vector<Eigen::VectorXd> starts{middle};
    for (Eigen::Index i = 0; i < middle.size(); ++i)
        for (const double end : {low[i], high[i]}) {
            starts.push_back(middle);
            starts.back()[i] = end;
        }
    Eigen::VectorXd best = middle;
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::VectorXd& start : starts) {
        const Eigen::VectorXd z = descend(q, low, high, start);
        const double value = value_at(q, z);
        if (value < least) {
            least = value;
            best = z;
        }
    }
    return best;
}

}  // namespace scree
