// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/observed_site.hpp"
#include "cli/site_settings.hpp"

#include <span>
#include <string>
#include <vector>

namespace scree::cli {

/// One more kind of value, or several, that a field test could measure at its screens; or films of the first impacts of each block.
struct FurtherInstrument {
    std::string name;  ///< "heights at the screens"
    std::vector<Kinematic> kinematics;
    std::size_t impacts = 0;
};
/// Impacts of a block that a plan takes to be filmed [-].
inline constexpr std::size_t kPlannedImpacts = 3;

/// Speeds, heights and spins of which the test has none, each for itself and all together, where the site has screens; and impacts.
std::vector<FurtherInstrument> further_instruments(const ObservedSite& observed);

/// The test as if all of them had been measured, with the errors of [observed], wherever a block was seen; and, at screens that saw nothing, of the blocks
/// that pass in `once`, a campaign of the test in which every block was thrown once. `observed` has the impacts of all instruments added, and `once` has
/// kept them. Values are those of `once`: of the same block, else the middle one there (1 where none passes).
ObservedSite with_instruments(const ObservedSite& observed, std::span<const FurtherInstrument> instruments,
                              const CampaignResult& once, const ObservedSettings& errors);

/// The columns of a table of such a test that are there without instruments other than this one.
ObservationTable with_one_instrument(const ObservationTable& table, const ObservedSite& observed,
                                     const FurtherInstrument& instrument);

}  // namespace scree::cli
