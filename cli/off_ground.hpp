// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"

namespace scree::cli {

/// True if there is ground somewhere below the geometry: below a point, along a line, in a polygon. Local frame; looked at as densely as the cells of the terrain lie.
bool over_ground(const Geometry& geometry, const SiteTerrain& terrain);

/// Screens, deposit zones and effects of the model that stand where the terrain has none, in a hole of it for example: none of them meets a block, and a share
/// of 0 % there says nothing. Adds warnings, and says which screens and zones they are (3D; in 2D profiles tell).
void find_off_ground(SiteModel& model);

}  // namespace scree::cli
