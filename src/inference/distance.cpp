// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/distance.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

SortedSample sorted_sample(std::span<const double> values) {
    SortedSample sample;
    sample.values.assign(values.begin(), values.end());
    std::sort(sample.values.begin(), sample.values.end());
    sample.weights.assign(values.size(), 1.0 / static_cast<double>(values.size()));
    return sample;
}

LineDistance line_distance(const SortedSample& a, const SortedSample& b) {
    SCREE_ASSERT(!a.values.empty() && !b.values.empty());
    LineDistance distance;
    std::size_t i = 0, j = 0;
    double f = 0.0, g = 0.0;  // the two distribution functions at x
    double x = std::min(a.values.front(), b.values.front());
    while (i < a.values.size() || j < b.values.size()) {
        const bool from_a = j == b.values.size() || (i < a.values.size() && a.values[i] <= b.values[j]);
        const double next = from_a ? a.values[i] : b.values[j];
        const double difference = f - g;
        distance.energy += 2.0 * difference * difference * (next - x);
        distance.wasserstein += std::abs(difference) * (next - x);
        if (from_a)
            f += a.weights[i++];
        else
            g += b.weights[j++];
        x = next;
    }
    return distance;
}

double mean_difference(std::span<const double> values) {
    if (values.size() < 2) return std::numeric_limits<double>::quiet_NaN();
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const double count = static_cast<double>(sorted.size());
    // sum over pairs of x_(k) - x_(l), k > l: the k-th smallest counts k times with a plus and n-1-k times with a minus
    double sum = 0.0;
    for (std::size_t k = 0; k < sorted.size(); ++k)
        sum += (2.0 * static_cast<double>(k) + 1.0 - count) * (sorted[k] - sorted.front());
    return 2.0 * sum / (count * (count - 1.0));
}

double sample_quantile(std::span<const double> sorted, double q) {
    SCREE_ASSERT(!sorted.empty());
    const double at = std::clamp(q, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const auto above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double point_distance(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(sum);
}

double energy_score(std::span<const double> observation, const PointSample& members) {
    const std::size_t count = members.size();
    SCREE_ASSERT(count >= 2 && observation.size() == members.dimension);
    double to_members = 0.0, among_members = 0.0;
    for (std::size_t m = 0; m < count; ++m) {
        to_members += point_distance(observation, members[m]);
        for (std::size_t k = 0; k < m; ++k) among_members += point_distance(members[m], members[k]);
    }
    const double n = static_cast<double>(count);
    return to_members / n - among_members / (n * (n - 1.0));
}

double pit_value(double observation, std::span<const double> members, double tie) {
    const auto below = std::count_if(members.begin(), members.end(), [&](double x) { return x < observation; });
    const auto equal = std::count(members.begin(), members.end(), observation);
    return (static_cast<double>(below) + tie * static_cast<double>(1 + equal)) /
           (static_cast<double>(members.size()) + 1.0);
}

}  // namespace scree
