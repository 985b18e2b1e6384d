// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_profiles.hpp"
#include "gis/profile_picture.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// Terrain and profiles for pictures, without what lies along them. Points into both.
gis::ProfileScene profile_scene(const std::string& title, const SiteTerrain& terrain, const SiteProfiles& profiles);

/// The polygons of a layer with the names in the field; an empty field gives none.
std::vector<gis::DrawnArea> drawn_areas(const gis::VectorData& data, const std::string& field);

}  // namespace scree::cli
