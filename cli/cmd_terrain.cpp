// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/account.hpp"
#include "cli/campaign_layers.hpp"
#include "cli/commands.hpp"
#include "cli/settings.hpp"
#include "cli/site_model.hpp"
#include "cli/terrain_layers.hpp"
#include "gis/results_writer.hpp"
#include "gis/vector_reader.hpp"
#include "scree/base/units.hpp"

#include <cmath>
#include <limits>
#include <ostream>

namespace scree::cli {

namespace {

constexpr double kSoilOpacity = 0.4;  ///< of areas by soil: the relief shows through [-]

double slope_deg(const Vec3& normal) {
    return degrees_from_radians(std::acos(std::min(1.0, normal.z())));
}

/// Facets one by one: there may be millions.
gis::VectorLayer facets_layer(const SiteTerrain& terrain) {
    gis::VectorLayer layer;
    layer.title = "Facets";
    layer.description = "Triangles of the model terrain with their soil";
    layer.coordinates = gis::Coordinates::XY;
    layer.visible = false;
    layer.data.name = "facets";
    layer.data.kind = GeometryKind::Polygon;
    layer.data.fields = {{"facet", FieldType::Integer, "Facet number"},
                         {"soil", FieldType::Text, "Soil"},
                         {"slope_deg", FieldType::Real, "Slope [deg]"}};
    layer.styles = gis::house_styles(layer.data);
    gis::VectorStyle by_soil = soil_style(terrain, "soil");
    by_soil.size_mm = 0.05;
    by_soil.opacity = kSoilOpacity;
    layer.styles.push_back(by_soil);
    layer.next = [&terrain, f = std::int64_t{0}](Feature& feature) mutable {
        std::array<Vec3, 3> c;
        SoilId soil = 0;
        while (f < terrain.surface->facet_count() && !terrain.surface->facet(f, c, soil)) ++f;
        if (f >= terrain.surface->facet_count()) return false;
        feature.id = f + 1;
        feature.geometry = MultiPolygon{Polygon{{c[0].head<2>(), c[1].head<2>(), c[2].head<2>()}, {}}};
        feature.values = {f, terrain.data.soils.soils[soil], slope_deg((c[1] - c[0]).cross(c[2] - c[0]).normalized())};
        ++f;
        return true;
    };
    return layer;
}

gis::VectorLayer zones_layer(const SiteFile& site, const SiteTerrain& terrain) {
    const VectorInput& input = site.settings.zones;
    const gis::VectorData zones = read_site_layer(site, input, "soil zones", {GeometryKind::Polygon}, terrain);
    gis::VectorLayer layer = input_layer(zones, "soil_zones", "Soil zones", "");
    gis::VectorStyle by_soil = soil_style(terrain, layer.data.fields[gis::field_index(zones, input.field)].name);
    by_soil.size_mm = 0.3;
    by_soil.opacity = kSoilOpacity;
    layer.styles = {by_soil};
    return layer;
}

/// Mean slope of the four facets around a node is what a map shows: from the normal of the surface around the centre of the cell.
gis::RasterLayer slope_layer(const SiteTerrain& terrain) {
    const Grid<double> g = model_heights(terrain);
    gis::RasterLayer layer;
    layer.name = "slope_deg";
    layer.title = "Slope";
    layer.unit = "deg";
    layer.quantity_definition = "slope of the model terrain at the centre of the cell, by central differences";
    layer.theme = gis::RasterTheme::Slope;
    layer.values = Grid<float>(g.shape, std::numeric_limits<float>::quiet_NaN());
    for (int j = 1; j + 1 < g.shape.rows; ++j) {
        for (int i = 1; i + 1 < g.shape.columns; ++i) {
            const double dx = (g.at(i + 1, j) - g.at(i - 1, j)) / (2.0 * g.shape.cell),
                         dy = (g.at(i, j + 1) - g.at(i, j - 1)) / (2.0 * g.shape.cell);
            layer.values.at(i, j) = static_cast<float>(degrees_from_radians(std::atan(std::hypot(dx, dy))));
        }
    }
    return layer;
}

}  // namespace

ExitCode run_terrain(const Context& context) {
    const SiteFile site = context.read_site();
    std::filesystem::path folder = context.results_folder(site);
    if (context.output.empty()) folder += "_terrain";
    require_free_results(context, site, folder);
    warn_of_partial_results(context, folder);
    const SiteTerrain terrain = load_terrain(site);
    const std::vector<gis::InputFile> inputs = gis::input_files(terrain_inputs(site, terrain));
    gis::require_inputs_elsewhere(folder, inputs);
    print_warnings(context, terrain.data.warnings());
    print_warnings(context, terrain.effect_warnings);  // a berm raises this ground

    gis::ResultsPackage package;
    package.frame = terrain.data.frame;
    package.title = site.settings.name + ": terrain";
    package.vectors.push_back(facets_layer(terrain));
    if (!site.settings.zones.file.empty()) package.vectors.push_back(zones_layer(site, terrain));
    package.rasters = {slope_layer(terrain), heights_layer(terrain)};
    package.provenance = {
        {"program", "scree " + version()}, {"site", site.settings.name}, {"surface", terrain.surface_report}};
    add_inputs(package.provenance, site, inputs);
    gis::write_results(folder, package, context.overwrite);
    if (!context.quiet)
        *context.out << terrain.surface_report << "\nterrain        " << (folder / "results.gpkg").string() << "\n";
    return ExitCode::Done;
}

}  // namespace scree::cli
