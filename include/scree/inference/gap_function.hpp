// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/discrepancy.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scree {

/// The gap as a function of a campaign: one field test, prepared once, against simulation after simulation, in memory. What calibration minimises and
/// diagnosis takes apart. Depends on the campaign, the seed and nothing else: no state changes between calls, which may come from several threads.
///
/// Cost: no samples of chance are drawn. With n known blocks, M repeats and d columns O(n M^2 d) for the scores, O(n M log n M) for distances of one
/// column and O((n M)^2) for the stop position, whose number of points kMostPoints limits.
class GapFunction {
public:
    GapFunction(Observations observations, ObservationOperator op);

    /// The same for some of the measured rows only, those with 1: a fold of a cross-validation. Simulated blocks that are repeats of others then count
    /// nowhere. Shares that are known as counts have no rows and stay whole.
    GapFunction with_rows(std::span<const char> rows) const;
    /// The same with these divisors of the columns in the overall score (column_scales of a simulation that stays the yardstick for all others).
    /// Without them there is no overall score, because a model that sets its own scale could win by spreading [unit of the column].
    GapFunction with_scales(std::vector<double> scales) const;

    const Observations& observations() const { return observations_; }
    const ObservationTable& measured() const { return measured_; }
    const std::vector<Observable>& observables() const { return observables_; }
    const ObservationOperator& op() const { return op_; }
    /// The campaign as the test would have seen it. `seed` draws the errors of the measurements: the same ones for the same seed, whatever the campaign
    /// is, so that two models differ by what they say and not by luck.
    ObservationTable simulated(const CampaignResult& campaign, std::uint64_t seed) const;

    /// Gaps, distances and floors; intervals, p and Wasserstein distances stay NaN or empty.
    Discrepancy operator()(const ObservationTable& simulated) const;
    Discrepancy operator()(const CampaignResult& campaign, std::uint64_t seed) const {
        return (*this)(simulated(campaign, seed));
    }

private:
    Observations observations_;
    ObservationOperator op_;
    ObservationTable measured_;
    std::vector<Observable> observables_;
    std::vector<double> scales_;  ///< empty: none [unit of the column]
};

}  // namespace scree
