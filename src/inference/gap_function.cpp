// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/gap_function.hpp"

#include "scree/base/assert.hpp"

#include <utility>

namespace scree {

GapFunction::GapFunction(Observations observations, ObservationOperator op)
    : observations_(std::move(observations)),
      op_(std::move(op)),
      measured_(measured_table(observations_, op_)),
      observables_(make_observables(observations_, op_)) {}

GapFunction GapFunction::with_rows(std::span<const char> rows) const {
    SCREE_ASSERT(rows.size() == measured_.rows());
    GapFunction some = *this;
    some.measured_.block.clear();
    for (auto& column : some.measured_.values) column.clear();
    for (std::size_t row = 0; row < rows.size(); ++row) {
        if (!rows[row]) continue;
        some.measured_.block.push_back(measured_.block[row]);
        for (std::size_t k = 0; k < measured_.values.size(); ++k)
            some.measured_.values[k].push_back(measured_.values[k][row]);
    }
    return some;
}

GapFunction GapFunction::with_scales(std::vector<double> scales) const {
    SCREE_ASSERT(scales.size() == measured_.columns.size());
    GapFunction scaled = *this;
    scaled.scales_ = std::move(scales);
    return scaled;
}

ObservationTable GapFunction::simulated(const CampaignResult& campaign, std::uint64_t seed) const {
    return simulated_table(campaign, observations_, op_, seed);
}

Discrepancy GapFunction::operator()(const ObservationTable& simulated) const {
    DiscrepancySettings gaps_only;
    gaps_only.draws = 0;
    gaps_only.wasserstein = false;
    return compare_tables(measured_, simulated, observables_, scales_, gaps_only);
}

}  // namespace scree
