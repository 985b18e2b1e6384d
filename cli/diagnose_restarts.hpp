// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/field_test.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// From one screen to the next, or to the stop: what the blocks of the test do there, and what the model's do that begin with the state that was measured
/// at the first one. What goes wrong above does not come down with them.
struct ScreenInnovation {
    std::int32_t from = -1, to = -1;  ///< of ObservationOperator::screens; `to` -1: where they stop
    Quantity quantity = Quantity::Along;
    std::size_t blocks = 0;  ///< that both are known of [-]
    double measured = kNaN;  ///< mean over them [m], [m/s], [rad/s], [-]
    double simulated = kNaN;
    double error =
        kNaN;  ///< standard error of the difference, from the spread over the blocks; that of the parameters is not in it
    double standardised() const { return error > 0.0 ? (measured - simulated) / error : 0.0; }
};

/// With every measured block restarted kRestarts times at every screen that measured its speed. Its height and spin there are the measured ones where they were
/// measured, and all else is as in a crossing of `campaign`: its own simulated ones, or else those with the nearest speeds. What a
/// restart forgets (how a block is turned, and that it rolls or slides) is taken from simulated blocks that are restarted in the same way: `simulated` is
/// moved by the mean of what these did themselves less what they do restarted. Empty where nobody knows which record is of which block, or fewer than
/// kLeastRestarted blocks have one. Nothing: it was stopped.
inline constexpr std::int64_t kRestarts = 10;
inline constexpr std::size_t kLeastRestarted = 8;
std::optional<std::vector<ScreenInnovation>> screen_innovations(const FieldTest& test, const SiteFile& site,
                                                                const ObservedSite& observed,
                                                                const CampaignResult& campaign);

}  // namespace scree::cli
