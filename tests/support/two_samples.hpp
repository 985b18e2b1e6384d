// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <utility>
#include <vector>

namespace scree::test {

/// Largest distance of the two empirical distributions (two-sample Kolmogorov-Smirnov) [-].
double ks_distance(std::vector<double> a, std::vector<double> b);

/// Probability that two samples of n and m values of one continuous distribution are at least this far apart, exact: the share of all lattice paths
/// from (0, 0) to (n, m) that leave the band |i/n - j/m| < distance (Hodges 1958, Ark. Mat. 3) [-].
double ks_probability(double distance, int n, int m);

/// Value below which the given share of the sample lies, linear between its members.
double quantile(std::vector<double> values, double share);
inline double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

/// Interval that holds `share` of the medians when the sample is drawn again from itself.
std::array<double, 2> bootstrap_median(const std::vector<double>& values, double share);

/// Interval that holds `share` of the differences median(a) - median(b) when both samples are drawn again from themselves.
std::array<double, 2> bootstrap_median_difference(const std::vector<double>& a, const std::vector<double>& b,
                                                  double share);

}  // namespace scree::test
