// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/profile.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace scree {

namespace {

/// Is p on the left of the line from a to b, or on it?
bool on_left(const Vec2& a, const Vec2& b, const Vec2& p) {
    return cross(b - a, p - a) >= 0.0;
}

/// Is p inside the polygon's rings by the even-odd rule?
bool inside_rings(const Polygon& polygon, const Vec2& p) {
    bool inside = false;
    auto count = [&](const Ring& ring) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
            if ((a.y() > p.y()) == (b.y() > p.y())) continue;
            if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
        }
    };
    count(polygon.outer);
    for (const Ring& hole : polygon.holes) count(hole);
    return inside;
}

}  // namespace

std::size_t Profile::reach_at(double chainage) const {
    SCREE_ASSERT(!empty());
    const auto above = std::upper_bound(s.begin(), s.end(), chainage);
    const auto vertex = static_cast<std::size_t>(above - s.begin());
    return std::clamp<std::size_t>(vertex, 1, reach_count()) - 1;
}

double Profile::height_at(double chainage) const {
    if (!contains(chainage)) return kNaN;
    const std::size_t k = reach_at(chainage);
    return z[k] + (chainage - s[k]) / (s[k + 1] - s[k]) * (z[k + 1] - z[k]);
}

Vec2 Profile::place_at(double chainage) const {
    const std::size_t k = reach_at(chainage);
    return place[k] + (chainage - s[k]) / (s[k + 1] - s[k]) * (place[k + 1] - place[k]);
}

Vec2 Profile::direction_at(double chainage) const {
    const std::size_t k = reach_at(chainage);
    return (place[k + 1] - place[k]).normalized();
}

double Profile::slope_at(double chainage) const {
    const std::size_t k = reach_at(chainage);
    return (z[k + 1] - z[k]) / (s[k + 1] - s[k]);
}

double Profile::highest_between(double from, double to) const {
    if (empty() || to < 0.0 || from > s.back() || from > to) return -kInfinity;
    from = std::max(from, 0.0);
    to = std::min(to, s.back());
    double highest = std::max(height_at(from), height_at(to));
    for (std::size_t k = reach_at(from) + 1; k < s.size() && s[k] < to; ++k) highest = std::max(highest, z[k]);
    return highest;
}

std::vector<double> Profile::crossings(std::span<const Vec2> line) const {
    std::vector<double> found;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Vec2 &a = line[i], &b = line[i + 1];
        Box2 box;
        box.add(a);
        box.add(b);
        for (std::size_t k = 0; k < reach_count(); ++k) {
            const Vec2 &p = place[k], &q = place[k + 1];
            Box2 reach;
            reach.add(p);
            reach.add(q);
            if (!reach.overlaps(box)) continue;
            if (on_left(a, b, p) == on_left(a, b, q) || on_left(p, q, a) == on_left(p, q, b)) continue;
            const double at_p = cross(b - a, p - a), at_q = cross(b - a, q - a);
            found.push_back(s[k] + at_p / (at_p - at_q) * (s[k + 1] - s[k]));
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

std::vector<double> Profile::touches(std::span<const Vec2> line) const {
    std::vector<double> found;
    const auto meets = [](const Vec2& p, const Vec2& from, const Vec2& to) -> std::optional<double> {
        const Vec2 along = to - from;
        const double u = std::clamp((p - from).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
        if ((p - from - u * along).norm() > kShortestReach) return std::nullopt;
        return u;
    };
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        Box2 box;
        box.add(line[i]);
        box.add(line[i + 1]);
        for (std::size_t k = 0; k < reach_count(); ++k) {
            Box2 reach;
            reach.add(place[k]);
            reach.add(place[k + 1]);
            if (!reach.overlaps(box.grown(kShortestReach))) continue;
            for (const std::size_t end : {i, i + 1})
                if (const auto u = meets(line[end], place[k], place[k + 1]))
                    found.push_back(s[k] + *u * (s[k + 1] - s[k]));
            for (const std::size_t end : {k, k + 1})
                if (meets(place[end], line[i], line[i + 1])) found.push_back(s[end]);
        }
    }
    return found;
}

std::vector<Stretch> Profile::inside(const MultiPolygon& area) const {
    std::vector<double> cuts{0.0, length()};
    auto cut = [&](const Ring& ring) {
        Ring closed = ring;
        if (!ring.empty()) closed.push_back(ring.front());
        const std::vector<double> found = crossings(closed), met = touches(closed);
        cuts.insert(cuts.end(), found.begin(), found.end());
        for (const double at : met) {
            const auto next = std::lower_bound(found.begin(), found.end(), at - kShortestReach);
            if (next == found.end() || *next > at + kShortestReach) cuts.push_back(at);
        }
    };
    for (const Polygon& polygon : area) {
        cut(polygon.outer);
        for (const Ring& hole : polygon.holes) cut(hole);
    }
    std::sort(cuts.begin(), cuts.end());
    // between two neighbouring cuts the profile is inside as a whole, or not at all
    std::vector<Stretch> stretches;
    for (std::size_t k = 0; !empty() && k + 1 < cuts.size(); ++k) {
        if (cuts[k + 1] - cuts[k] < kShortestReach) continue;
        const Vec2 middle = place_at(0.5 * (cuts[k] + cuts[k + 1]));
        if (std::none_of(area.begin(), area.end(), [&](const Polygon& p) { return inside_rings(p, middle); })) continue;
        if (!stretches.empty() && cuts[k] - stretches.back().to < kShortestReach)
            stretches.back().to = cuts[k + 1];
        else
            stretches.push_back({cuts[k], cuts[k + 1]});
    }
    return stretches;
}

Profile::Nearest Profile::nearest(const Vec2& p) const {
    SCREE_ASSERT(!empty());
    Nearest best;
    double least = kInfinity;
    for (std::size_t k = 0; k < reach_count(); ++k) {
        const Vec2 along = place[k + 1] - place[k];
        const double u = std::clamp((p - place[k]).dot(along) / along.squaredNorm(), 0.0, 1.0);
        const double distance = (p - place[k] - u * along).norm();
        if (distance >= least) continue;
        least = distance;
        best.s = s[k] + u * (s[k + 1] - s[k]);
        best.offset = on_left(place[k], place[k + 1], p) ? distance : -distance;
    }
    return best;
}

Profile make_profile(std::span<const Vec3> points, std::span<const SoilId> soil) {
    if (points.size() > 1 && soil.size() + 1 != points.size())
        throw InputError("a profile of " + std::to_string(points.size()) + " points needs " +
                         std::to_string(points.size() - 1) + " soils, one per reach; there are " +
                         std::to_string(soil.size()));
    Profile profile;
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (!points[k].allFinite())
            throw InputError("point " + std::to_string(k + 1) +
                             " of a profile has a coordinate that is not a number: give x, y and z of every point");
        double chainage = 0.0;
        if (!profile.s.empty()) {
            const double reach = (points[k].head<2>() - profile.place.back()).norm();
            if (reach < kShortestReach) continue;
            chainage = profile.s.back() + reach;
            profile.soil.push_back(soil[k - 1]);
        }
        profile.s.push_back(chainage);
        profile.z.push_back(points[k].z());
        profile.place.emplace_back(points[k].head<2>());
    }
    if (profile.s.size() < 2) return {};
    return profile;
}

}  // namespace scree
