// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_file.hpp"
#include "gis/terrain.hpp"
#include "gis/vector_reader.hpp"
#include "scree/dynamics/effects.hpp"
#include "scree/geometry/surface.hpp"

#include <memory>
#include <string>
#include <vector>

namespace scree::cli {

/// The terrain of a site, ready for the mechanics.
struct SiteTerrain {
    gis::Terrain data;  ///< grid, frame and the reports of how they came about
    std::unique_ptr<Surface> surface;
    std::unique_ptr<Surface> without_berms;  ///< 2D, if berms are drawn on the map: the ground that profiles are led on
    std::string surface_report;              ///< facets and errors, in words
    std::vector<Effect> effects;             ///< of the site; berms are in the surface
    std::vector<std::string> effect_inputs, effect_warnings;  ///< files read for them, what they gave cause to
};

SiteTerrain load_terrain(const SiteFile& site);
/// The files that it was made of.
std::vector<std::string> terrain_inputs(const SiteFile& site, const SiteTerrain& terrain);

/// The [[effect]]s of a site with their places, checked. Fills effects, effect_inputs, effect_warnings; berms are not raised yet.
void load_effects(const SiteFile& site, SiteTerrain& terrain);
/// One effect in words: "ground_drag on loose waste: coefficient 0.3 1/s".
std::string effect_text(const EffectSettings& effect);

/// Reads a layer of the site in the terrain's frame.
gis::VectorData read_site_layer(const SiteFile& site, const VectorInput& input, const char* purpose,
                                std::vector<GeometryKind> kinds, const SiteTerrain& terrain);

}  // namespace scree::cli
