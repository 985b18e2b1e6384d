// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"
#include "gis/layers.hpp"
#include "scree/ensemble/campaign.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// The results of a campaign as layers (DESIGN: results.gpkg), ready to be written.
std::vector<gis::VectorLayer> campaign_vectors(const SiteModel& model, const CampaignResult& result);
std::vector<gis::RasterLayer> campaign_rasters(const SiteModel& model, const CampaignResult& result);

/// A feature layer of the input as a layer of the output: same geometry and fields.
gis::VectorLayer input_layer(const gis::VectorData& data, const std::string& name, const std::string& title,
                             const std::string& group);

}  // namespace scree::cli
