// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/off_ground.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

namespace {

bool along(const Vec2& a, const Vec2& b, const Surface& surface, double spacing) {
    const auto parts = static_cast<int>(std::ceil((b - a).norm() / spacing));
    for (int k = 0; k <= parts; ++k)
        if (surface.facet_at(a + (b - a) * (static_cast<double>(k) / std::max(parts, 1))) >= 0) return true;
    return false;
}

bool in(const MultiPolygon& polygons, const Surface& surface, const GridShape& cells) {
    const Region region(polygons);
    const Box2 box = region.bounds();
    for (int j = std::max(0, cells.row_of(box.min.y())); j <= std::min(cells.rows - 1, cells.row_of(box.max.y())); ++j)
        for (int i = std::max(0, cells.column_of(box.min.x()));
             i <= std::min(cells.columns - 1, cells.column_of(box.max.x())); ++i)
            if (const Vec2 centre = cells.centre(i, j); surface.facet_at(centre) >= 0 && region.contains(centre))
                return true;
    for (const Polygon& polygon : polygons)  // smaller than a cell
        for (std::size_t k = 0; k < polygon.outer.size(); ++k)
            if (along(polygon.outer[k], polygon.outer[(k + 1) % polygon.outer.size()], surface, cells.cell))
                return true;
    return false;
}

/// True if there is ground somewhere below the geometry: below a point, along a line, in a polygon; looked at as densely as the cells of the terrain lie.
bool over_ground(const Geometry& geometry, const SiteTerrain& terrain) {
    const Surface& surface = *terrain.surface;
    const GridShape& cells = terrain.data.grid.shape;
    if (const auto* points = std::get_if<Points>(&geometry))
        return std::any_of(points->begin(), points->end(),
                           [&](const Vec3& p) { return surface.facet_at(p.head<2>()) >= 0; });
    if (const auto* lines = std::get_if<Polylines>(&geometry))
        return std::any_of(lines->begin(), lines->end(), [&](const Polyline& line) {
            for (std::size_t k = 1; k < line.points.size(); ++k)
                if (along(line.points[k - 1].head<2>(), line.points[k].head<2>(), surface, 0.5 * cells.cell))
                    return true;
            return false;
        });
    const auto* polygons = std::get_if<MultiPolygon>(&geometry);
    return polygons && in(*polygons, surface, cells);
}

}  // namespace

void find_off_ground(SiteModel& model) {
    const std::string where = " where the terrain has no ground (beside it, or in a hole of it): ";
    for (const Screen& screen : model.campaign.screens) {
        Polyline line;
        for (const Vec2& p : screen.line) line.points.emplace_back(p.x(), p.y(), kNaN);
        if (over_ground(Polylines{line}, model.terrain)) model.met_screens.insert(screen.name);
    }
    std::set<std::string> told;
    for (const Screen& screen : model.campaign.screens)
        if (!model.met_screens.contains(screen.name) && told.insert(screen.name).second)
            model.warnings.push_back("screen " + screen.name + " stands" + where + "no block can pass it");
    for (std::size_t z = 0; z < model.campaign.deposit_zones.size(); ++z) {
        const bool met = over_ground(model.deposit_zones->layer.features[z].geometry, model.terrain);
        model.met_zones.push_back(met);
        if (!met)
            model.warnings.push_back("deposit zone " + model.campaign.deposit_zones[z].name + " lies" + where +
                                     "no block can stop in it");
    }
    for (const Effect& effect : model.campaign.effects) {
        const EffectPlace& place = effect.place;
        if (!place.area && place.lines.empty() && place.points.empty()) continue;
        Polylines lines;
        for (const Points& line : place.lines) lines.push_back({line, {}});
        if ((place.area && over_ground(place.area->polygons, model.terrain)) || over_ground(lines, model.terrain) ||
            over_ground(place.points, model.terrain))
            continue;
        model.warnings.push_back(std::string("effect ") + effect_info(effect.kind).name + " is drawn" + where +
                                 "it does nothing here");
    }
}

}  // namespace scree::cli
