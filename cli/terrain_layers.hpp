// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"
#include "gis/layers.hpp"

namespace scree::cli {

/// Heights of the model terrain, drawn as a relief: the ground below other layers.
gis::RasterLayer heights_layer(const SiteTerrain& terrain);

}  // namespace scree::cli
