// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/calibration_surroundings.hpp"

#include "inference/eigenpairs.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scree {

namespace {

constexpr double kBeyond = 0.25;  // how far beyond its box a quadratic is believed, in half widths [-]
constexpr double kSpreads = 4.0;  // half width of a closer box in standard deviations of the minimum [-]
constexpr double kLeastHalf = 0.04,
                 kMostHalf = 0.3;  // of a box; 0.5 would be the whole range, farther than quadratics hold [-]
constexpr double kLow = 0.025, kHigh = 0.975;  // ends of intervals [-]
constexpr int kLooks = 200;                    // from a minimum to the side of the box [-]
constexpr double kOnSide = 1e-6;               // from the side of a box [-]
constexpr std::size_t kEnoughBeyond = 4;       // simulated points that make a wall, per parameter [-]

/// Sides of the search for a minimum, in z.
void sides(const UnitBox& box, Eigen::VectorXd& low, Eigen::VectorXd& high) {
    const Eigen::VectorXd reach = (1.0 + kBeyond) * box.half;
    low = ((box.centre - reach).cwiseMax(0.0) - box.centre).cwiseQuotient(box.half);
    high = ((box.centre + reach).cwiseMin(1.0) - box.centre).cwiseQuotient(box.half);
}

/// The way of parameter i along which the others stay where a quadratic is least for it, in z; along the axis if that has no end.
Eigen::VectorXd followed(const Eigen::MatrixXd& curvature, Eigen::Index i) {
    const Eigen::Index n = curvature.rows();
    Eigen::VectorXd way = Eigen::VectorXd::Unit(n, i);
    std::vector<Eigen::Index> others;
    for (Eigen::Index k = 0; k < n; ++k)
        if (k != i) others.push_back(k);
    const Eigen::MatrixXd rest = curvature(others, others);
    const Eigen::LLT<Eigen::MatrixXd> solver(rest);
    if (others.empty() || solver.info() != Eigen::Success) return way;
    const Eigen::VectorXd following = -solver.solve(curvature(others, i));
    if (following.allFinite()) way(others) = following;
    return way;
}

Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& draws) {
    const Eigen::MatrixXd centred = draws.rowwise() - draws.colwise().mean();
    return centred.transpose() * centred / static_cast<double>(std::max<Eigen::Index>(draws.rows() - 1, 1));
}

}  // namespace

MinimumSpread spread_of_minimum(const QuadraticFit& fit, const UnitBox& box, std::size_t records, std::int64_t draws,
                                RandomStream random) {
    Eigen::VectorXd low, high;
    sides(box, low, high);
    const auto in_cube = [&](const Eigen::VectorXd& z) -> Eigen::VectorXd {
        return box.centre + box.half.cwiseProduct(z);
    };
    const auto n = static_cast<Eigen::Index>(records);
    Eigen::VectorXd weights = Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
    MinimumSpread spread;
    spread.low = in_cube(low);
    spread.high = in_cube(high);
    const Quadratic whole = fit.quadratic(fit.coefficients_of(weights));
    const Eigen::VectorXd least = least_in_box(whole, low, high);
    spread.best = in_cube(least);
    spread.draws.resize(draws, box.centre.size());
    spread.half = box.half;
    spread.slope.resize(draws, box.centre.size());
    spread.curvature.resize(draws, box.centre.size());
    std::vector<Eigen::VectorXd> ways;
    for (Eigen::Index i = 0; i < box.centre.size(); ++i) ways.push_back(followed(whole.curvature, i));
    for (Eigen::Index d = 0; d < draws; ++d) {
        weights.setZero();
        for (Eigen::Index k = 0; k < n; ++k)
            weights[static_cast<Eigen::Index>(random.below(records))] += 1.0 / static_cast<double>(n);
        // of the minimum the gradient is drawn, the curvature is that of all records: minima of quadratics of which both are drawn lie anywhere whenever the
        // noise happens to make them flat. That they may be flat is for the intervals
        const Quadratic drawn = fit.quadratic(fit.coefficients_of(weights) + fit.coefficient_error(weights, random));
        Quadratic q = whole;
        q.slope = drawn.slope + (drawn.curvature - whole.curvature) * least;
        for (std::size_t i = 0; i < ways.size(); ++i) {
            const auto column = static_cast<Eigen::Index>(i);
            spread.slope(d, column) = ways[i].dot(drawn.slope + drawn.curvature * least);
            spread.curvature(d, column) = ways[i].dot(drawn.curvature * ways[i]);
        }
        spread.draws.row(d) = in_cube(least_in_box(q, low, high)).transpose();
    }
    return spread;
}

Eigen::VectorXd minimum_for(const QuadraticFit& fit, const UnitBox& box, const std::vector<char>& records) {
    Eigen::VectorXd low, high, weights(static_cast<Eigen::Index>(records.size()));
    sides(box, low, high);
    for (std::size_t k = 0; k < records.size(); ++k) weights[static_cast<Eigen::Index>(k)] = records[k] ? 1.0 : 0.0;
    weights /= weights.sum();
    const Eigen::VectorXd z = least_in_box(fit.quadratic(fit.coefficients_of(weights)), low, high);
    return box.centre + box.half.cwiseProduct(z);
}

UnitBox box_around(const Eigen::VectorXd& u, const Eigen::VectorXd& half) {
    return {u.cwiseMax(half).cwiseMin(Eigen::VectorXd::Ones(u.size()) - half), half};
}

UnitBox closer_box(const MinimumSpread& spread, const UnitBox& box) {
    Eigen::VectorXd half(spread.best.size());
    for (Eigen::Index i = 0; i < half.size(); ++i) {  // from quantiles: a few draws on the sides must not widen it
        const auto values = spread.draws.col(i);
        std::vector<double> sorted(values.begin(), values.end());
        std::sort(sorted.begin(), sorted.end());
        const double deviation = 0.5 * (sample_quantile(sorted, 0.84) - sample_quantile(sorted, 0.16));
        half[i] = std::clamp(kSpreads * deviation, kLeastHalf, kMostHalf);
    }
    const Eigen::VectorXd inside = spread.best.cwiseMax(box.centre - box.half).cwiseMin(box.centre + box.half);
    return box_around(inside, half);
}

std::vector<Eigen::VectorXd> latin_hypercube(std::size_t dimension, std::size_t count, RandomStream& random) {
    std::vector<Eigen::VectorXd> points(count, Eigen::VectorXd(static_cast<Eigen::Index>(dimension)));
    std::vector<std::size_t> slice(count);
    for (std::size_t i = 0; i < dimension; ++i) {
        std::iota(slice.begin(), slice.end(), std::size_t{0});
        for (std::size_t k = count; k > 1; --k) std::swap(slice[k - 1], slice[random.below(k)]);
        for (std::size_t k = 0; k < count; ++k)
            points[k][static_cast<Eigen::Index>(i)] =
                (static_cast<double>(slice[k]) + random.uniform()) / static_cast<double>(count);
    }
    return points;
}

double value_of(const CalibrationParameter& p, double u) {
    if (u <= 0.0) return p.low;
    if (u >= 1.0) return p.high;
    return p.logarithmic ? p.low * std::pow(p.high / p.low, u) : p.low + u * (p.high - p.low);
}

double unit_of(const CalibrationParameter& p, double value) {
    const double u =
        p.logarithmic ? std::log(value / p.low) / std::log(p.high / p.low) : (value - p.low) / (p.high - p.low);
    return std::clamp(u, 0.0, 1.0);
}

namespace {

/// Where, from the best point on downwards, all of many simulated points are surely worse: the first of them; else 0.
double wall_below(double best, Eigen::Index i, const std::vector<TriedPoint>& tried) {
    double lowest = best, wall = 0.0;
    for (const TriedPoint& t : tried)
        if (!t.worse) lowest = std::min(lowest, t.u[i]);
    std::size_t beyond = 0;
    for (const TriedPoint& t : tried) {
        if (t.u[i] >= lowest) continue;
        wall = std::max(wall, t.u[i]);
        ++beyond;
    }
    return !tried.empty() && beyond >= kEnoughBeyond * static_cast<std::size_t>(tried.front().u.size()) ? wall : 0.0;
}

/// How far up from the minimum, in z, the slope of the loss may still be zero or fall: up to where it rises in all but kLow of the draws; infinite if it does
/// not up to `farthest`.
double reach_up(const Eigen::VectorXd& slope, const Eigen::VectorXd& curvature, double farthest) {
    std::vector<double> slopes(static_cast<std::size_t>(slope.size()));
    for (int k = 0; k <= kLooks; ++k) {
        const double z = farthest * k / kLooks;
        for (std::size_t d = 0; d < slopes.size(); ++d) {
            const auto draw = static_cast<Eigen::Index>(d);
            slopes[d] = slope[draw] + z * curvature[draw];
        }
        std::sort(slopes.begin(), slopes.end());
        if (sample_quantile(slopes, kLow) > 0.0) return z;
    }
    return kInfinity;
}

}  // namespace

std::vector<ParameterEstimate> estimates_of(const MinimumSpread& spread,
                                            const std::vector<CalibrationParameter>& parameters,
                                            const std::vector<TriedPoint>& tried) {
    std::vector<TriedPoint> upside_down = tried;
    for (TriedPoint& t : upside_down) t.u = Eigen::VectorXd::Ones(t.u.size()) - t.u;
    std::vector<ParameterEstimate> estimates;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const auto column = static_cast<Eigen::Index>(i);
        const double u = spread.best[column], half = spread.half[column];
        const Eigen::VectorXd slope = spread.slope.col(column), curvature = spread.curvature.col(column);
        const auto values = spread.draws.col(column);
        std::vector<double> sorted(values.begin(), values.end());
        std::sort(sorted.begin(), sorted.end());
        double low = sample_quantile(sorted, kLow), high = sample_quantile(sorted, kHigh);
        // a minimum on the side of the box that was looked into may lie anywhere beyond it, and so may one that nothing holds back up to there
        if (low < spread.low[column] + kOnSide) low = 0.0;
        if (high > spread.high[column] - kOnSide) high = 1.0;
        low = std::clamp(u - half * reach_up(-slope, curvature, (u - spread.low[column]) / half), 0.0, low);
        high = std::clamp(u + half * reach_up(slope, curvature, (spread.high[column] - u) / half), high, 1.0);
        low = std::max(low, wall_below(u, column, tried));
        high = std::min(high, 1.0 - wall_below(1.0 - u, column, upside_down));
        estimates.push_back(estimate_of(parameters[i], u, low, high));
    }
    return estimates;
}

/// Moves those above 0 up until kHigh of all lie below `end`; what lies on `side` may be anywhere from there to the end.
static void fill_up_to(double end, double side, std::vector<double>& draws) {
    std::vector<double*> on_side;
    for (double& u : draws)
        if (u > side - kOnSide) on_side.push_back(&u);
    for (std::size_t k = 0; end > side && k < on_side.size(); ++k)
        *on_side[k] = side + (end - side) * (static_cast<double>(k) + 0.5) / static_cast<double>(on_side.size());
    std::vector<double> sorted = draws;
    std::sort(sorted.begin(), sorted.end());
    const double known = sample_quantile(sorted, kHigh);
    if (!(known > 0.0 && end > known)) return;
    for (double& u : draws)
        if (u > 0.0) u = std::min(end / known * u, std::max(u, end));
}

void widen(MinimumSpread& spread, const std::vector<CalibrationParameter>& parameters,
           const std::vector<ParameterEstimate>& estimates) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const auto column = static_cast<Eigen::Index>(i);
        const double best = spread.best[column];
        const Interval& known = estimates[i].interval;
        std::vector<double> up;
        for (const double u : spread.draws.col(column)) up.push_back(u - best);
        fill_up_to(unit_of(parameters[i], known.high) - best, spread.high[column] - best, up);
        for (double& u : up) u = -u;
        fill_up_to(best - unit_of(parameters[i], known.low), best - spread.low[column], up);
        for (Eigen::Index d = 0; d < spread.draws.rows(); ++d)
            spread.draws(d, column) = best - up[static_cast<std::size_t>(d)];
    }
}

ParameterEstimate estimate_of(const CalibrationParameter& parameter, double u, double low, double high) {
    low = std::min(low, u);
    high = std::max(high, u);
    ParameterEstimate e;
    e.value = value_of(parameter, u);
    e.interval = {value_of(parameter, low), value_of(parameter, high)};
    e.identified = high - low < kWellIdentified  ? Identification::Well
                   : high - low < kNotIdentified ? Identification::Weakly
                                                 : Identification::Not;
    e.at_low = u < kAtEdge;
    e.at_high = u > 1.0 - kAtEdge;
    return e;
}

Eigen::MatrixXd correlation_of(const MinimumSpread& spread) {
    Eigen::MatrixXd c = covariance_of(spread.draws);
    const Eigen::VectorXd deviation = c.diagonal().cwiseMax(0.0).cwiseSqrt();
    for (Eigen::Index i = 0; i < c.rows(); ++i)
        for (Eigen::Index j = 0; j < c.cols(); ++j) {
            const double scale = deviation[i] * deviation[j];
            c(i, j) = i == j ? 1.0 : (scale > 0.0 ? c(i, j) / scale : 0.0);
        }
    return c;
}

std::vector<CalibrationDirection> directions_of(const MinimumSpread& spread) {
    const auto [values, vectors] = eigenpairs(covariance_of(spread.draws));
    std::vector<CalibrationDirection> directions;
    for (Eigen::Index k = 0; k < spread.draws.cols(); ++k) {
        const Eigen::VectorXd axis = vectors.col(k);
        Eigen::Index largest = 0;
        axis.cwiseAbs().maxCoeff(&largest);
        const double sign = axis[largest] < 0.0 ? -1.0 : 1.0;  // eigenvectors have none of their own
        CalibrationDirection direction;
        for (const double w : axis) direction.weights.push_back(sign * w);
        direction.deviation = std::sqrt(std::max(values[k], 0.0));
        directions.push_back(std::move(direction));
    }
    return directions;
}

}  // namespace scree
