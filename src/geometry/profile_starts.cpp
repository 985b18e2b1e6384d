// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/base/error.hpp"
#include "scree/geometry/profile_trace.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace scree {

namespace {

Vec2 centroid(const Ring& ring) {
    double area = 0.0;
    Vec2 sum = Vec2::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2 a = ring[i] - ring[0], b = ring[(i + 1) % ring.size()] - ring[0];
        const double twice = cross(a, b);
        area += twice;
        sum += twice * (a + b);
    }
    if (area == 0.0) return ring[0];
    return ring[0] + sum / (3.0 * area);
}

/// The centroid, or the middle of the longest piece of the east-west line through it that lies inside.
Vec2 inner_point(const Polygon& polygon) {
    const Vec2 centre = centroid(polygon.outer);
    if (Region({polygon}).contains(centre)) return centre;
    std::vector<double> cuts;
    auto cut = [&](const Ring& ring) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
            if ((a.y() > centre.y()) == (b.y() > centre.y())) continue;
            cuts.push_back(a.x() + (centre.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
        }
    };
    cut(polygon.outer);
    for (const Ring& hole : polygon.holes) cut(hole);
    std::sort(cuts.begin(), cuts.end());
    Vec2 best = centre;
    double widest = 0.0;
    for (std::size_t k = 0; k + 1 < cuts.size(); k += 2) {
        if (cuts[k + 1] - cuts[k] <= widest) continue;
        widest = cuts[k + 1] - cuts[k];
        best.x() = 0.5 * (cuts[k] + cuts[k + 1]);
    }
    return best;
}

/// Before they are made: far more than anybody could want.
void require_few(double count, double spacing) {
    constexpr double kMost = 1e6;
    if (!(count <= kMost))
        throw InputError("profile.spacing = " + std::to_string(spacing) +
                         " m gives more than a million starting points; choose a larger one");
}

std::vector<Vec2> points_in(const Polygon& polygon, double spacing) {
    if (spacing <= 0.0) return {inner_point(polygon)};
    std::vector<Vec2> points;
    const Region region({polygon});
    const Box2 box = region.bounds();
    // a lattice through the middle of the polygon's box, so that small polygons have their point in the middle
    const Vec2 middle = 0.5 * (box.min + box.max);
    require_few((box.max.x() - box.min.x()) / spacing * ((box.max.y() - box.min.y()) / spacing), spacing);
    const auto reach = [&](double extent) { return static_cast<int>(std::floor(0.5 * extent / spacing)); };
    const int columns = reach(box.max.x() - box.min.x()), rows = reach(box.max.y() - box.min.y());
    for (int j = rows; j >= -rows; --j) {
        for (int i = -columns; i <= columns; ++i) {
            const Vec2 p = middle + spacing * Vec2(i, j);
            if (region.contains(p)) points.push_back(p);
        }
    }
    if (points.empty()) points.push_back(inner_point(polygon));
    return points;
}

std::vector<Vec2> points_along(const Polyline& polyline, double spacing) {
    std::vector<Vec3> flat;
    for (const Vec3& p : polyline.points) flat.emplace_back(p.x(), p.y(), 0.0);
    const Profile line = make_profile(flat, std::vector<SoilId>(flat.empty() ? 0 : flat.size() - 1, 0));
    if (line.empty()) return {};
    if (spacing > 0.0) require_few(line.length() / spacing, spacing);
    const int count = spacing > 0.0 ? std::max(1, static_cast<int>(std::floor(line.length() / spacing))) : 1;
    std::vector<Vec2> points;
    const double first = 0.5 * (line.length() - (count - 1) * spacing);  // as far from one end as from the other
    for (int k = 0; k < count; ++k) points.push_back(line.place_at(first + k * spacing));
    return points;
}

}  // namespace

std::vector<ProfileStart> profile_starts(const FeatureLayer& layer, double spacing) {
    std::vector<ProfileStart> starts;
    auto add = [&](const std::vector<Vec2>& points, std::size_t feature) {
        for (const Vec2& p : points) starts.push_back({p, feature});
    };
    for (std::size_t f = 0; f < layer.features.size(); ++f) {
        const Geometry& geometry = layer.features[f].geometry;
        if (const auto* points = std::get_if<Points>(&geometry)) {
            for (const Vec3& p : *points) starts.push_back({p.head<2>(), f});
        } else if (const auto* lines = std::get_if<Polylines>(&geometry)) {
            for (const Polyline& line : *lines) add(points_along(line, spacing), f);
        } else if (const auto* polygons = std::get_if<MultiPolygon>(&geometry)) {
            for (const Polygon& polygon : *polygons) add(points_in(polygon, spacing), f);
        }
    }
    return starts;
}

}  // namespace scree
