// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/terrain.hpp"

#include <algorithm>
#include <utility>

namespace scree::gis {

namespace {

void add_ring(const Ring& ring, ConstraintLines& lines) {
    lines.push_back(ring);
    lines.back().push_back(ring.front());
}

void add_lines(const FeatureLayer& layer, ConstraintLines& lines) {
    for (const Feature& feature : layer.features) {
        if (const auto* polylines = std::get_if<Polylines>(&feature.geometry)) {
            for (const Polyline& polyline : *polylines) {
                lines.emplace_back();
                for (const Vec3& p : polyline.points) lines.back().push_back(p.head<2>());
            }
        } else if (const auto* polygons = std::get_if<MultiPolygon>(&feature.geometry)) {
            for (const Polygon& polygon : *polygons) {
                add_ring(polygon.outer, lines);
                for (const Ring& hole : polygon.holes) add_ring(hole, lines);
            }
        }
    }
}

}  // namespace

std::vector<std::string> Terrain::warnings() const {
    std::vector<std::string> all;
    const auto add = [&](const std::vector<std::string>& some) { all.insert(all.end(), some.begin(), some.end()); };
    add(dtm.warnings);
    add(resampling.warnings);
    if (zones) add(zones->warnings);
    if (breaklines) add(breaklines->warnings);
    if (triangulation) add(triangulation->warnings);
    add(soils.warnings);
    return all;
}

Terrain read_grid(const TerrainSource& source) {
    Terrain terrain;
    Dtm dtm = read_dtm(source.dtm, source.limits);
    ResampledDtm model = resample(dtm, source.resolution == 0 ? std::max(dtm.dx, dtm.dy) : source.resolution);
    terrain.frame = std::move(dtm.frame);
    terrain.dtm = std::move(dtm.report);
    terrain.grid = std::move(model.grid);
    terrain.resampling = std::move(model.report);
    return terrain;
}

void add_facets(const TerrainSource& source, Terrain& terrain) {
    const Box2 extent = terrain.grid.shape.bounds();

    SoilZones zones(source.zones);
    ConstraintLines lines;
    if (!source.zones_file.empty()) {
        VectorData data = read_vector({.file = source.zones_file,
                                       .layer = source.zones_layer,
                                       .kinds = {GeometryKind::Polygon},
                                       .purpose = "soil zones",
                                       .may_reach_beyond = true},
                                      terrain.frame, extent);
        zones = SoilZones(data, source.zones);
        if (source.conforming) {
            for (const Ring& ring : zones.boundaries()) add_ring(ring, lines);
        }
        terrain.zones = std::move(data.report);
    }
    if (!source.breaklines_file.empty()) {
        VectorData data = read_vector({.file = source.breaklines_file,
                                       .layer = source.breaklines_layer,
                                       .kinds = {GeometryKind::LineString, GeometryKind::Polygon},
                                       .purpose = "breaklines",
                                       .may_reach_beyond = true},
                                      terrain.frame, extent);
        add_lines(data.layer, lines);
        terrain.breaklines = std::move(data.report);
    }

    if (source.surface == Surface::Grid && lines.empty()) {
        FacetSoils soils = assign_soils(zones, terrain.grid, source.diagonals);
        terrain.grid_soil = std::move(soils.soil);
        terrain.soils = std::move(soils.report);
        return;
    }
    Triangulation triangulation = source.surface == Surface::Tin
                                      ? triangulate_tin(terrain.grid, lines, source.tolerance, source.diagonals)
                                      : conform_grid(terrain.grid, lines, source.diagonals);
    // facets follow boundaries to within the distance at which lines are joined, and rounding
    const double touch = source.conforming ? 1.1 * kJoinDistance * terrain.grid.shape.cell : 1e-6;
    FacetSoils soils = assign_soils(zones, triangulation.mesh, touch);
    triangulation.mesh.soil = std::move(soils.soil);
    terrain.mesh = std::move(triangulation.mesh);
    terrain.triangulation = std::move(triangulation.report);
    terrain.soils = std::move(soils.report);
}

}  // namespace scree::gis
