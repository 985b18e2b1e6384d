// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/two_samples.hpp"

#include "scree/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace scree::test {

namespace {

constexpr int kDraws = 4000;  ///< resamplings of a bootstrap interval [-]

std::vector<double> drawn_again(const std::vector<double>& values, RandomStream& random) {
    std::vector<double> again;
    for (std::size_t i = 0; i < values.size(); ++i) again.push_back(values[random.below(values.size())]);
    return again;
}

}  // namespace

double ks_distance(std::vector<double> a, std::vector<double> b) {
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    double largest = 0.0;
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        const double value = std::min(a[i], b[j]);
        while (i < a.size() && a[i] <= value) ++i;
        while (j < b.size() && b[j] <= value) ++j;
        largest = std::max(largest, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                                             static_cast<double>(j) / static_cast<double>(b.size())));
    }
    return largest;
}

double ks_probability(double distance, int n, int m) {
    // inside[j]: share of the paths to (i, j) that have stayed in the band, by the last step taken
    std::vector<double> inside(static_cast<std::size_t>(m) + 1);
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= m; ++j) {
            double& here = inside[static_cast<std::size_t>(j)];
            if (i == 0 && j == 0) {
                here = 1.0;
                continue;
            }
            const double from_left = i > 0 ? here * i / (i + j) : 0.0;
            const double from_below = j > 0 ? inside[static_cast<std::size_t>(j) - 1] * j / (i + j) : 0.0;
            const double apart = std::abs(static_cast<double>(i) / n - static_cast<double>(j) / m);
            here = apart < distance - 1e-12 ? from_left + from_below : 0.0;
        }
    }
    return 1.0 - inside.back();
}

double quantile(std::vector<double> values, double share) {
    if (values.empty()) throw std::invalid_argument("quantile of nothing");
    std::sort(values.begin(), values.end());
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

std::array<double, 2> bootstrap_median(const std::vector<double>& values, double share) {
    RandomStream random(1, 2, RandomPurpose::Resampling);
    std::vector<double> medians;
    for (int k = 0; k < kDraws; ++k) medians.push_back(median(drawn_again(values, random)));
    return {quantile(medians, 0.5 - 0.5 * share), quantile(medians, 0.5 + 0.5 * share)};
}

std::array<double, 2> bootstrap_median_difference(const std::vector<double>& a, const std::vector<double>& b,
                                                  double share) {
    RandomStream random(1, 1, RandomPurpose::Resampling);
    std::vector<double> differences;
    for (int k = 0; k < kDraws; ++k)
        differences.push_back(median(drawn_again(a, random)) - median(drawn_again(b, random)));
    return {quantile(differences, 0.5 - 0.5 * share), quantile(differences, 0.5 + 0.5 * share)};
}

}  // namespace scree::test
