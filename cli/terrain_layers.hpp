// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"
#include "gis/layers.hpp"

#include <string>

namespace scree::cli {

/// Heights of the ground that blocks meet (grid or tin, with berms) at the centres of the cells of the terrain, local frame [m]; NaN where there is none.
Grid<double> model_heights(const SiteTerrain& terrain);
/// The same as a raster, drawn as a relief: the ground below other layers.
gis::RasterLayer heights_layer(const SiteTerrain& terrain);

/// A colour for each soil of the site by this field of a layer, the same in all layers.
gis::VectorStyle soil_style(const SiteTerrain& terrain, const std::string& field);

}  // namespace scree::cli
