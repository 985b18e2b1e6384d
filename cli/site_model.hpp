// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_file.hpp"
#include "gis/terrain.hpp"
#include "gis/vector_reader.hpp"
#include "scree/ensemble/campaign.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scree::cli {

/// The terrain of a site, ready for the mechanics.
struct SiteTerrain {
    gis::Terrain data;  ///< grid, frame and the reports of how they came about
    std::unique_ptr<Surface> surface;
    std::string surface_report;  ///< facets and errors, in words
};

SiteTerrain load_terrain(const SiteFile& site);

/// Everything else that a campaign needs, read and checked against the terrain.
struct SiteModel {
    SiteTerrain terrain;
    CampaignInput campaign;  ///< points into this object: move it as a whole only
    std::unique_ptr<ReleaseArea> area;
    gis::VectorData release;
    std::optional<gis::VectorData> screens;
    std::optional<gis::VectorData> deposit_zones;
    std::vector<std::string> inputs;    ///< files read, as opened
    std::vector<std::string> warnings;  ///< of everything, in order of reading
};

SiteModel load_site(const SiteFile& site);

/// Reads a layer of the site in the terrain's frame.
gis::VectorData read_site_layer(const SiteFile& site, const VectorInput& input, const char* purpose,
                                std::vector<GeometryKind> kinds, const SiteTerrain& terrain);

/// Lines, or outlines of polygons, with the names in the field.
std::vector<Screen> make_screens(const gis::VectorData& data, const std::string& field);

/// The points of a block shape from text (x y z per line), OBJ or STL.
std::vector<Vec3> read_shape_points(const std::filesystem::path& file);

}  // namespace scree::cli
