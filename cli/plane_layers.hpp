// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/campaign_layers.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// The stretches of all profiles that lie in an area, one part each.
Polylines stretches_in(const SiteModel& model, const MultiPolygon& area);

/// Blocks that were thrown on a profile, to their end.
double blocks_thrown_on(const CampaignResult& result, std::size_t track);

/// The layer `profile_curves`: one line for each cell along each profile, with passages, deposits, and energy, height, speed and spin of the blocks that
/// crossed it.
gis::VectorLayer curves_layer(const SiteModel& model, const CampaignResult& result);

/// The same as a table.
std::string curves_csv(const SiteModel& model, const CampaignResult& result);

/// Stops, crossings and shares per profile in words, for the summary.
std::vector<std::string> profile_summaries(const SiteModel& model, const CampaignResult& result);

}  // namespace scree::cli
