// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace scree {

/// Distances between distributions that are known by samples. All are invariant to the order of the samples, and scale with the unit of the values.

/// Values in ascending order, each with a weight; the weights sum to one.
struct SortedSample {
    std::vector<double> values;   ///< ascending [*]
    std::vector<double> weights;  ///< not negative [-]
};
/// A sample of equal weights; `values` in any order, none NaN.
SortedSample sorted_sample(std::span<const double> values);

/// Squared energy distance: 2 E|X-Y| - E|X-X'| - E|Y-Y'| = 2 integral (F-G)^2 dx (Szekely & Rizzo 2013, J Stat Plan Inference 143:1249-1272, eqs 1
/// and 3). Wasserstein distance of order 1: integral |F-G| dx, the mean distance that the one has to be moved to become the other.
struct LineDistance {
    double energy = 0.0;       ///< squared energy distance, in the unit of the values [*]
    double wasserstein = 0.0;  ///< [*]
};
/// In O(n + m). Samples must not be empty. Both of the V-statistic kind: never negative, zero only for equal distributions.
LineDistance line_distance(const SortedSample& a, const SortedSample& b);

/// E|X-X'| over pairs of different members, the unbiased estimate of Gini's mean difference, in O(n log n); NaN below two members [*]
double mean_difference(std::span<const double> values);

/// Value at or below which a share q of a sorted sample lies, linear between the members (type 7 of Hyndman & Fan 1996, Am Stat 50:361-365).
double sample_quantile(std::span<const double> sorted, double q);

/// Points of any dimension, one after the other.
struct PointSample {
    std::size_t dimension = 1;
    std::vector<double> values;  ///< dimension x size, point after point [*]

    std::size_t size() const { return dimension == 0 ? 0 : values.size() / dimension; }
    std::span<const double> operator[](std::size_t k) const {
        return std::span<const double>(values).subspan(k * dimension, dimension);
    }
};
/// Euclidean.
double point_distance(std::span<const double> a, std::span<const double> b);

/// Energy score of an observation against the M members of a forecast, the lower the better, strictly proper:
///     S = mean_m |y - x_m| - 1 / (2 M (M-1)) sum over m != m' of |x_m - x_m'|
/// (Gneiting & Raftery 2007, JASA 102:359-378, eq 22; the second mean over different members makes it independent of M in expectation: Ferro
/// 2014, QJRMS 140:1917-1923). In one dimension it is the CRPS. If y is one more draw of the forecast, E S is half the members' mean difference.
/// Needs two members. O(M^2 dimension).
double energy_score(std::span<const double> observation, const PointSample& members);

/// Probability integral transform of an observation among members, u = (number below + U (1 + number equal)) / (M + 1) with U = `tie` uniform in [0, 1):
/// uniform in [0, 1) if the observation is one more draw (Czado, Gneiting & Held 2009, Biometrics 65:1254-1261, section 2). [-]
double pit_value(double observation, std::span<const double> members, double tie);

}  // namespace scree
