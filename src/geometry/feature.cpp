// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/feature.hpp"

#include "scree/geometry/region.hpp"

#include <algorithm>

namespace scree {

namespace {

double to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 way = b - a;
    const double share = way.squaredNorm() > 0.0 ? std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
    return (p - a - share * way).norm();
}

double to_ring(const Vec2& p, const Ring& ring) {
    double least = kInfinity;
    for (std::size_t k = 0; k < ring.size(); ++k)
        least = std::min(least, to_segment(p, ring[k], ring[(k + 1) % ring.size()]));
    return least;
}

}  // namespace

double plan_distance(const Vec2& p, const Geometry& geometry) {
    double least = kInfinity;
    if (const auto* polygons = std::get_if<MultiPolygon>(&geometry)) {
        if (Region(*polygons).contains(p)) return 0.0;
        for (const Polygon& polygon : *polygons) {
            least = std::min(least, to_ring(p, polygon.outer));
            for (const Ring& hole : polygon.holes) least = std::min(least, to_ring(p, hole));
        }
    } else if (const auto* lines = std::get_if<Polylines>(&geometry)) {
        for (const Polyline& line : *lines)
            for (std::size_t k = 1; k < line.points.size(); ++k)
                least = std::min(least, to_segment(p, line.points[k - 1].head<2>(), line.points[k].head<2>()));
    } else if (const auto* points = std::get_if<Points>(&geometry)) {
        for (const Vec3& q : *points) least = std::min(least, (p - q.head<2>()).norm());
    }
    return least;
}

}  // namespace scree
