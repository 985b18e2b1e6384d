// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/nearest_models.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

/// Of a model that differs the gap less 1 grows with n m / (n + m), of n measured and m simulated rows: simulations of different size are compared without it.
void NearestModels::look_at(const CalibrationPoint& point, const ObservationTable& table) {
    if (std::any_of(seen_.begin(), seen_.end(), [&](const Seen& s) { return s.point == point; })) return;
    const Discrepancy d = gaps_(table);
    const double rows = static_cast<double>(table.rows()), measured = static_cast<double>(gaps_.measured().rows());
    Seen seen{std::ranges::count_if(d.observables, &ObservableGap::counts),
              (d.overall.gap - 1.0) * (1.0 + measured / rows), point};
    if (!std::isfinite(seen.excess)) return;
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
