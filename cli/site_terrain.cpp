// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/site_terrain.hpp"

#include <sstream>
#include <utility>

namespace scree::cli {

namespace {

gis::SoilZoneSettings zone_settings(const SiteSettings& s) {
    gis::SoilZoneSettings zones;
    zones.field = s.zones.field;
    zones.priority_field = s.priority_field;
    for (std::size_t k = 0; k < s.soils.size(); ++k) {
        zones.soils.push_back(s.soils[k].name);
        if (s.soils[k].name == s.default_soil) zones.default_soil = static_cast<SoilId>(k);
    }
    return zones;
}

/// Takes the facets, or their soils, out of the terrain.
std::unique_ptr<Surface> surface_of(gis::Terrain& terrain, DiagonalRule diagonals) {
    return terrain.mesh ? make_mesh_surface(std::move(*terrain.mesh))
                        : make_grid_surface(terrain.grid, std::move(terrain.grid_soil), diagonals);
}

}  // namespace

SiteTerrain load_terrain(const SiteFile& site) {
    const SiteSettings& s = site.settings;
    gis::TerrainSource source;
    source.dtm = site.resolve(s.dtm).string();
    source.resolution = s.resolution;
    source.surface = s.surface == SurfaceKind::Grid ? gis::Surface::Grid : gis::Surface::Tin;
    source.tolerance = s.tolerance;
    source.diagonals = s.diagonals;
    source.conforming = s.conforming;
    if (!s.zones.file.empty()) source.zones_file = site.resolve(s.zones.file).string();
    source.zones_layer = s.zones.layer;
    source.zones = zone_settings(s);
    if (!s.breaklines.file.empty()) source.breaklines_file = site.resolve(s.breaklines.file).string();
    source.breaklines_layer = s.breaklines.layer;

    SiteTerrain terrain;
    terrain.data = gis::read_grid(source);
    load_effects(site, terrain);
    const bool drawn = std::any_of(terrain.effects.begin(), terrain.effects.end(), [](const Effect& e) {
        return e.kind == EffectKind::Berm && !e.place.lines.empty();
    });
    if (drawn && s.dimension == 2) {
        gis::Terrain bare = terrain.data;
        add_facets(source, bare);
        terrain.without_berms = surface_of(bare, s.diagonals);
    }
    raise_berms(terrain.effects, terrain.data.grid);
    add_facets(source, terrain.data);
    std::ostringstream words;
    const bool mesh = terrain.data.mesh.has_value();
    terrain.surface = surface_of(terrain.data, s.diagonals);
    if (mesh) {
        words << terrain.surface->facet_count() << " facets of a triangulated mesh";
        if (terrain.data.triangulation)
            words << "; heights differ from the grid by " << terrain.data.triangulation->rms_error << " m (rms), "
                  << terrain.data.triangulation->max_error << " m (largest)";
    } else {
        words << "two facets a cell, none over holes";
    }
    terrain.surface_report = words.str();
    return terrain;
}

std::vector<std::string> terrain_inputs(const SiteFile& site, const SiteTerrain& terrain) {
    const SiteSettings& s = site.settings;
    std::vector<std::string> inputs;
    for (const std::string& path : {s.dtm, s.zones.file, s.breaklines.file})
        if (!path.empty()) inputs.push_back(site.resolve(path).string());
    inputs.insert(inputs.end(), terrain.effect_inputs.begin(), terrain.effect_inputs.end());
    return inputs;
}

gis::VectorData read_site_layer(const SiteFile& site, const VectorInput& input, const char* purpose,
                                std::vector<GeometryKind> kinds, const SiteTerrain& terrain) {
    gis::VectorSource source;
    source.file = site.resolve(input.file).string();
    source.layer = input.layer;
    source.kinds = std::move(kinds);
    source.purpose = purpose;
    return gis::read_vector(source, terrain.data.frame, terrain.data.grid.shape.bounds());
}

}  // namespace scree::cli
