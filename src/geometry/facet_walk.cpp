// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/facet_walk.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

bool same_node(const Vec3& a, const Vec3& b) {
    return a.x() == b.x() && a.y() == b.y();
}

bool in_order(const Vec3& a, const Vec3& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
}

/// Place of a node among the corners of a facet, 3 if it is none of them.
std::size_t corner_of(const WalkFacet& facet, const Vec3& node) {
    std::size_t k = 0;
    while (k < 3 && !same_node(facet.corner[k], node)) ++k;
    return k;
}

/// The side of a facet, from corner k to corner k + 1, that is the edge of the spot; 3 if none.
std::size_t side_of(const WalkFacet& facet, const Spot& spot) {
    const std::size_t a = corner_of(facet, spot.first), b = corner_of(facet, spot.second);
    if (a == 3 || b == 3) return 3;
    return (a + 1) % 3 == b ? a : b;
}

Vec2 side_vector(const WalkFacet& facet, std::size_t side) {
    return (facet.corner[(side + 1) % 3] - facet.corner[side]).head<2>();
}

/// A spot on a side of the facet, moved onto a node that is near.
Spot spot_on_side(const WalkFacet& facet, std::size_t side, const Vec2& p) {
    Vec3 a = facet.corner[side], b = facet.corner[(side + 1) % 3];
    if (!in_order(a, b)) std::swap(a, b);
    const Vec2 along = (b - a).head<2>();
    const double length = along.norm();
    const double x = (p - a.head<2>()).dot(along) / length;
    if (x < kWalkSnap) return spot_at_node(a);
    if (x > length - kWalkSnap) return spot_at_node(b);
    Spot spot;
    spot.on = Spot::On::Edge;
    spot.first = a;
    spot.second = b;
    spot.at = a.head<2>() + x / length * along;
    return spot;
}

}  // namespace

Spot spot_at_node(const Vec3& node) {
    Spot spot;
    spot.on = Spot::On::Node;
    spot.first = spot.second = node;
    spot.at = node.head<2>();
    return spot;
}

Spot spot_in(const WalkFacet& facet, const Vec2& p) {
    std::size_t nearest = 0;
    double least = kInfinity;
    for (std::size_t side = 0; side < 3; ++side) {
        const Vec2 along = side_vector(facet, side).normalized();
        const double inset = cross(along, p - facet.corner[side].head<2>());
        if (inset < least) {
            least = inset;
            nearest = side;
        }
    }
    if (least < kWalkSnap) return spot_on_side(facet, nearest, p);
    Spot spot;
    spot.at = p;
    spot.facet = facet.id;
    return spot;
}

bool find_spot(const Surface& surface, const Vec2& p, Spot& spot) {
    WalkFacet facet;
    facet.id = surface.facet_at(p);
    if (facet.id < 0 || !surface.facet(facet.id, facet.corner, facet.soil)) return false;
    spot = spot_in(facet, p);
    return true;
}

double points_into(const WalkFacet& facet, const Spot& spot, const Vec2& direction) {
    if (spot.on == Spot::On::Facet) return 1.0;
    if (spot.on == Spot::On::Edge) {
        const std::size_t side = side_of(facet, spot);
        SCREE_ASSERT(side < 3);
        return cross(side_vector(facet, side).normalized(), direction);
    }
    const std::size_t k = corner_of(facet, spot.first);
    SCREE_ASSERT(k < 3);
    const Vec2 right = side_vector(facet, k).normalized(), left = -side_vector(facet, (k + 2) % 3).normalized();
    return std::min(cross(right, direction), cross(direction, left));
}

Spot leave_facet(const WalkFacet& facet, const Spot& spot, const Vec2& direction) {
    const std::size_t own = spot.on == Spot::On::Edge ? side_of(facet, spot) : 3;
    const std::size_t node = spot.on == Spot::On::Node ? corner_of(facet, spot.first) : 3;
    std::size_t exit = 3;
    double nearest = kInfinity;
    for (std::size_t side = 0; side < 3; ++side) {
        if (side == own || (node < 3 && (side == node || (side + 1) % 3 == node))) continue;
        const Vec2 along = side_vector(facet, side).normalized();
        const double approach = -cross(along, direction);  // speed towards the side from within
        if (approach <= 0.0) continue;
        const double distance = std::max(0.0, cross(along, spot.at - facet.corner[side].head<2>())) / approach;
        if (distance < nearest) {
            nearest = distance;
            exit = side;
        }
    }
    SCREE_ASSERT(exit < 3);
    return spot_on_side(facet, exit, spot.at + nearest * direction);
}

double height_on(const WalkFacet& facet, const Vec2& p) {
    const Vec3 n = (facet.corner[1] - facet.corner[0]).cross(facet.corner[2] - facet.corner[0]);
    const Vec2 d = p - facet.corner[0].head<2>();
    return facet.corner[0].z() - (n.x() * d.x() + n.y() * d.y()) / n.z();
}

EdgesAt edges_at(const std::vector<WalkFacet>& around, const Spot& spot) {
    EdgesAt edges;
    if (spot.on == Spot::On::Edge) {
        edges.node = {spot.first, spot.second};
        edges.rim.assign(2, around.size() < 2);
    } else if (spot.on == Spot::On::Node) {
        for (const WalkFacet& facet : around) {
            const std::size_t k = corner_of(facet, spot.first);
            for (const Vec3& other : {facet.corner[(k + 1) % 3], facet.corner[(k + 2) % 3]}) {
                const auto known = std::find_if(edges.node.begin(), edges.node.end(),
                                                [&](const Vec3& n) { return same_node(n, other); });
                if (known == edges.node.end()) {
                    edges.node.push_back(other);
                    edges.rim.push_back(true);
                } else {
                    edges.rim[static_cast<std::size_t>(known - edges.node.begin())] = false;
                }
            }
        }
    }
    return edges;
}

const std::vector<WalkFacet>& FacetWalk::around(const Spot& spot) {
    around_.clear();
    WalkFacet facet;
    if (spot.on == Spot::On::Facet) {
        facet.id = spot.facet;
        if (surface_.facet(facet.id, facet.corner, facet.soil)) around_.push_back(facet);
        return around_;
    }
    surface_.gather(Box2{spot.at, spot.at}.grown(kWalkSnap), patch_);
    for (const PatchFacet& near : patch_.facets) {
        facet.id = near.id;
        if (!surface_.facet(facet.id, facet.corner, facet.soil)) continue;
        const bool touches = spot.on == Spot::On::Edge ? side_of(facet, spot) < 3 : corner_of(facet, spot.first) < 3;
        if (touches) around_.push_back(facet);
    }
    std::sort(around_.begin(), around_.end(), [](const WalkFacet& a, const WalkFacet& b) { return a.id < b.id; });
    return around_;
}

std::optional<FacetWalk::Step> FacetWalk::step(const Spot& spot, const Vec2& direction) {
    constexpr double kAlong = 1e-12;  // [-] a direction that points into no facet by more goes along an edge
    const WalkFacet* facet = nullptr;
    double inward = -kAlong;
    for (const WalkFacet& candidate : around(spot)) {
        const double in = points_into(candidate, spot, direction);
        if (in <= inward) continue;
        inward = in;
        facet = &candidate;
    }
    if (!facet) return std::nullopt;
    if (inward > kAlong) return Step{leave_facet(*facet, spot, direction), *facet};
    Step along{spot, *facet};
    double best = -kInfinity;
    for (const Vec3& node : edges_at(around_, spot).node) {
        const double ahead = (node.head<2>() - spot.at).normalized().dot(direction);
        if (ahead <= best) continue;
        best = ahead;
        along.to = spot_at_node(node);
    }
    return along;
}

std::optional<FacetWalk::Side> FacetWalk::rim_side(const Spot& spot) {
    const std::vector<WalkFacet>& facets = around(spot);
    for (const WalkFacet& facet : facets) {
        for (std::size_t side = 0; side < 3; ++side) {
            const Vec3 &a = facet.corner[side], &b = facet.corner[(side + 1) % 3];
            const bool at_spot = spot.on == Spot::On::Edge ? side_of(facet, spot) == side
                                                           : same_node(spot.first, a) || same_node(spot.first, b);
            if (!at_spot || spot.on == Spot::On::Facet) continue;
            const auto shared = std::count_if(facets.begin(), facets.end(), [&](const WalkFacet& other) {
                return corner_of(other, a) < 3 && corner_of(other, b) < 3;
            });
            if (shared == 1) return Side{facet, side};
        }
    }
    return std::nullopt;
}

/// The edge of the outline after this one: turning around its end, from facet to facet, until there is no further one.
FacetWalk::Side FacetWalk::next_on_rim(const Side& rim) {
    const std::vector<WalkFacet>& fan = around(spot_at_node(rim.to()));
    Side next{rim.facet, (rim.side + 1) % 3};
    for (std::size_t turned = 0; turned < fan.size(); ++turned) {
        const auto beyond = std::find_if(fan.begin(), fan.end(), [&](const WalkFacet& f) {
            return f.id != next.facet.id && corner_of(f, next.from()) < 3 && corner_of(f, next.to()) < 3;
        });
        if (beyond == fan.end()) break;
        next = Side{*beyond, corner_of(*beyond, rim.to())};
    }
    return next;
}

bool FacetWalk::on_outer_rim(const Spot& spot) {
    const std::optional<Side> first = rim_side(spot);
    if (!first) return false;
    const Vec2 origin = first->from().head<2>();
    double twice_area = 0.0;
    Side at = *first;
    do {
        twice_area += cross(at.from().head<2>() - origin, at.to().head<2>() - origin);
        at = next_on_rim(at);
    } while (!same_node(at.from(), first->from()) || !same_node(at.to(), first->to()));
    return twice_area > 0.0;
}

double FacetWalk::height(const Spot& spot) {
    if (spot.on == Spot::On::Node) return spot.first.z();
    if (spot.on == Spot::On::Facet) return height_on(around(spot).front(), spot.at);
    const Vec3 along = spot.second - spot.first;
    const double share = (spot.at - spot.first.head<2>()).norm() / along.head<2>().norm();
    return spot.first.z() + share * along.z();
}

}  // namespace scree
