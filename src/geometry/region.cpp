// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/region.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree {

namespace {

/// Share of its box below which a polygon is sampled without drawing from the box [-].
constexpr double kSliver = 1e-3;

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
    slivers_.resize(areas_.size());
    for (std::size_t p = 0; p < areas_.size(); ++p)
        if (areas_[p] < kSliver * (boxes_[p].max - boxes_[p].min).prod())
            slivers_[p] = trapezia_of(static_cast<int>(p));
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

/// A polygon by slabs between neighbouring vertices.
std::vector<Region::Trapezium> Region::trapezia_of(int polygon) const {
    std::vector<double> levels;
    for (const Edge& e : edges_)
        if (e.polygon == polygon) levels.push_back(e.a.y());
    std::sort(levels.begin(), levels.end());
    std::vector<Trapezium> all;
    for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
        const double low = levels[k], high = levels[k + 1];
        std::vector<std::array<double, 2>> sides;  // x at the lower and at the upper end
        for (const int i : bands_[static_cast<std::size_t>(band_of(0.5 * (low + high)))]) {
            const Edge& e = edges_[static_cast<std::size_t>(i)];
            const auto [bottom, top] = std::minmax(e.a.y(), e.b.y());
            if (e.polygon != polygon || !(bottom <= low && top >= high) || !(low < high)) continue;
            const Vec2 along = e.b - e.a;
            sides.push_back({e.a.x() + (low - e.a.y()) / along.y() * along.x(),
                             e.a.x() + (high - e.a.y()) / along.y() * along.x()});
        }
        std::sort(sides.begin(), sides.end(), [](const auto& a, const auto& b) { return a[0] + a[1] < b[0] + b[1]; });
        for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
            Trapezium t{low, high, sides[i], {}, 0.0};
            for (std::size_t end : {0u, 1u}) t.width[end] = std::max(sides[i + 1][end] - sides[i][end], 0.0);
            t.area_up_to = (all.empty() ? 0.0 : all.back().area_up_to) + 0.5 * (t.width[0] + t.width[1]) * (high - low);
            all.push_back(t);
        }
    }
    return all;
}

Vec2 Region::sample(const std::vector<Trapezium>& trapezia, RandomStream& random) {
    const double target = random.uniform() * trapezia.back().area_up_to;
    auto found = std::upper_bound(trapezia.begin(), trapezia.end(), target,
                                  [](double area, const Trapezium& t) { return area < t.area_up_to; });
    if (found == trapezia.end()) --found;
    const Trapezium& t = *found;
    const auto between = [](const std::array<double, 2>& ends, double u) { return (1.0 - u) * ends[0] + u * ends[1]; };
    double u = random.uniform();  // of the height, as dense as it is wide there
    while (random.uniform() * std::max(t.width[0], t.width[1]) > between(t.width, u)) u = random.uniform();
    return {between(t.left, u) + random.uniform() * between(t.width, u), t.low + u * (t.high - t.low)};
}

Vec2 Region::sample(RandomStream& random) const {
    SCREE_ASSERT(area_ > 0.0);
    // First a polygon by its share of the area, then rejection in that polygon's box, unless it fills hardly any of that.
    double target = random.uniform() * area_;
    std::size_t polygon = 0;
    while (polygon + 1 < areas_.size() && target >= areas_[polygon]) target -= areas_[polygon++];
    const Box2& box = boxes_[polygon];
    if (!slivers_[polygon].empty()) return sample(slivers_[polygon], random);
    for (;;) {
        const double x = random.uniform(box.min.x(), box.max.x());
        const double y = random.uniform(box.min.y(), box.max.y());
        const Vec2 p{x, y};
        if (inside_polygon(p, static_cast<int>(polygon))) return p;
    }
}

}  // namespace scree
