// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_file.hpp"
#include "gis/terrain.hpp"
#include "gis/vector_reader.hpp"
#include "scree/geometry/surface.hpp"

#include <memory>
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

/// Reads a layer of the site in the terrain's frame.
gis::VectorData read_site_layer(const SiteFile& site, const VectorInput& input, const char* purpose,
                                std::vector<GeometryKind> kinds, const SiteTerrain& terrain);

}  // namespace scree::cli
