// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/region.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

double signed_area(const Ring& ring) {
    double twice = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2& a = ring[i];
        const Vec2& b = ring[(i + 1) % ring.size()];
        twice += (a.x() - ring[0].x()) * (b.y() - ring[0].y()) - (b.x() - ring[0].x()) * (a.y() - ring[0].y());
    }
    return 0.5 * twice;
}

}  // namespace

Region::Region(const MultiPolygon& polygons) {
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        Box2 box;
        double area = 0.0;
        auto add_ring = [&](const Ring& ring) {
            for (std::size_t i = 0; i < ring.size(); ++i) {
                edges_.push_back({ring[i], ring[(i + 1) % ring.size()], static_cast<int>(p)});
                box.add(ring[i]);
            }
        };
        add_ring(polygons[p].outer);
        area += std::abs(signed_area(polygons[p].outer));
        for (const Ring& hole : polygons[p].holes) {
            add_ring(hole);
            area -= std::abs(signed_area(hole));
        }
        boxes_.push_back(box);
        areas_.push_back(std::max(area, 0.0));
        bounds_.add(box);
        area_ += areas_.back();
    }
    if (edges_.empty()) return;

    // About one edge end a band: point location costs a handful of edges whatever the number of vertices.
    const auto bands = std::clamp<std::size_t>(edges_.size(), 1, 1u << 16);
    band_height_ = std::max((bounds_.max.y() - bounds_.min.y()) / static_cast<double>(bands), 1e-9);
    bands_.resize(bands);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const auto [low, high] = std::minmax(edges_[e].a.y(), edges_[e].b.y());
        for (int band = band_of(low); band <= band_of(high); ++band)
            bands_[static_cast<std::size_t>(band)].push_back(static_cast<int>(e));
    }
}

int Region::band_of(double y) const {
    const double band = std::floor((y - bounds_.min.y()) / band_height_);
    return static_cast<int>(std::clamp(band, 0.0, static_cast<double>(bands_.size()) - 1.0));
}

bool Region::inside_polygon(const Vec2& p, int polygon) const {
    bool inside = false;
    for (const int e : bands_[static_cast<std::size_t>(band_of(p.y()))]) {
        const Edge& edge = edges_[static_cast<std::size_t>(e)];
        if (edge.polygon != polygon || (edge.a.y() > p.y()) == (edge.b.y() > p.y())) continue;
        const double x = edge.a.x() + (p.y() - edge.a.y()) / (edge.b.y() - edge.a.y()) * (edge.b.x() - edge.a.x());
        if (p.x() < x) inside = !inside;
    }
    return inside;
}

bool Region::contains(const Vec2& p) const {
    if (edges_.empty() || !bounds_.contains(p)) return false;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
        if (boxes_[i].contains(p) && inside_polygon(p, static_cast<int>(i))) return true;
    }
    return false;
}

double Region::first_border(const Vec2& from, const Vec2& to) const {
    Box2 box;
    box.add(from);
    box.add(to);
    if (edges_.empty() || !bounds_.overlaps(box)) return kInfinity;
    double first = kInfinity;
    const Vec2 way = to - from;
    for (int band = band_of(box.min.y()); band <= band_of(box.max.y()); ++band) {
        for (const int e : bands_[static_cast<std::size_t>(band)]) {
            const Edge& edge = edges_[static_cast<std::size_t>(e)];
            const Vec2 side = edge.b - edge.a, w = edge.a - from;
            const double determinant = cross(way, side);
            if (determinant == 0.0) continue;  // along the edge: its neighbours are met
            const double s = cross(w, side) / determinant, r = cross(w, way) / determinant;
            if (s > 0.0 && s <= 1.0 && r >= 0.0 && r <= 1.0) first = std::min(first, s);
        }
    }
    return first;
}

Vec2 Region::sample(RandomStream& random) const {
    SCREE_ASSERT(area_ > 0.0);
    // First a polygon by its share of the area, then rejection in that polygon's box.
    double target = random.uniform() * area_;
    std::size_t polygon = 0;
    while (polygon + 1 < areas_.size() && target >= areas_[polygon]) target -= areas_[polygon++];
    const Box2& box = boxes_[polygon];
    for (;;) {
        const double x = random.uniform(box.min.x(), box.max.x());
        const double y = random.uniform(box.min.y(), box.max.y());
        const Vec2 p{x, y};
        if (inside_polygon(p, static_cast<int>(polygon))) return p;
    }
}

}  // namespace scree
