// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"
#include "gis/layers.hpp"
#include "scree/base/units.hpp"
#include "scree/ensemble/campaign.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace scree::cli {

/// A quantity of the cells with its name, unit and factor from SI.
struct QuantityInfo {
    CellQuantity quantity;
    const char* name;
    const char* title;
    const char* unit;
    const char* definition;
    double factor;  ///< from SI to the unit [*]
    gis::RasterTheme theme;
};
inline constexpr QuantityInfo kQuantities[] = {
    {CellQuantity::KineticEnergy, "energy_kj", "Kinetic energy", "kJ", "kinetic energy, translation and rotation",
     1.0 / kJoulePerKj, gis::RasterTheme::Energy},
    {CellQuantity::PassingHeight, "height_m", "Passing height", "m",
     "height of the centre of mass above the terrain, vertically", 1.0, gis::RasterTheme::Height},
    {CellQuantity::Speed, "speed_ms", "Speed", "m/s", "speed of the centre of mass", 1.0, gis::RasterTheme::Speed},
    {CellQuantity::Spin, "spin_rads", "Spin", "rad/s", "angular speed", 1.0, gis::RasterTheme::Spin},
};
/// Quantiles that are written [%].
inline constexpr int kPercents[] = {50, 90, 95, 98, 99};

/// Mean of a quantity over so many passages; the sum is rounded, the largest value is not.
inline double mean_of(const QuantityStatistics& s, std::int64_t passages) {
    return std::min(1e-4 * static_cast<double>(s.sum) / static_cast<double>(passages), s.largest);
}

/// The results of a campaign as the layers of results.gpkg and the rasters, ready to be written.
std::vector<gis::VectorLayer> campaign_vectors(const SiteModel& model, const CampaignResult& result);
std::vector<gis::RasterLayer> campaign_rasters(const SiteModel& model, const CampaignResult& result);
/// The one among them that hazard maps begin with; 3D.
gis::RasterLayer reach_probability_raster(const GridShape& cells, const CampaignResult& result);

/// A feature layer of the input as a layer of the output: same geometry and fields.
gis::VectorLayer input_layer(const gis::VectorData& data, const std::string& name, const std::string& title,
                             const std::string& group);

}  // namespace scree::cli
