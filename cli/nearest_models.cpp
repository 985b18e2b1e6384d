// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/nearest_models.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

/// Most values that one column has: blocks, or where nobody knows them records of one kind.
static double most_values(const ObservationTable& table) {
    std::ptrdiff_t most = 0;
    for (const std::vector<double>& column : table.values)
        most = std::max(most, std::count_if(column.begin(), column.end(), [](double v) { return std::isfinite(v); }));
    return static_cast<double>(most);
}

/// Of a model that differs the distance less 1 grows with n m / (n + m), of n measured and m simulated values: simulations of different size are compared without it.
void NearestModels::look_at(const CalibrationPoint& point, const ObservationTable& table) {
    const auto known = std::find_if(seen_.begin(), seen_.end(), [&](const Seen& s) { return s.point == point; });
    if (known != seen_.end() && known->rows >= table.rows()) return;
    const Discrepancy d = gaps_(table);
    if (yardstick_.empty()) yardstick_ = d.observables;
    Seen seen{
        std::ranges::count_if(d.observables, &ObservableGap::counts),
        (distance_over(d.observables, yardstick_) - 1.0) * (1.0 + most_values(gaps_.measured()) / most_values(table)),
        table.rows(), point};
    if (!std::isfinite(seen.excess)) return;
    if (known != seen_.end()) seen_.erase(known);
    const auto at = std::upper_bound(seen_.begin(), seen_.end(), seen,
                                     [](const Seen& a, const Seen& b) { return a.nearer_than(b); });
    seen_.insert(at, std::move(seen));
    if (seen_.size() > kKept) seen_.pop_back();
}

std::vector<CalibrationPoint> NearestModels::points() const {
    std::vector<CalibrationPoint> points;
    for (const Seen& s : seen_) points.push_back(s.point);
    return points;
}

}  // namespace scree::cli
