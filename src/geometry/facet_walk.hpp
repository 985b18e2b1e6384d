// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/surface.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scree {

/// Walking over the facets of a surface, from edge to edge, without steps of its own: what lines on the terrain are made of.

/// Places nearer than this to an edge or a node are taken to be on it [m].
inline constexpr double kWalkSnap = 1e-6;

/// A facet with its corners, counter-clockwise from above.
struct WalkFacet {
    std::int64_t id = -1;
    SoilId soil = 0;
    std::array<Vec3, 3> corner{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  ///< [m]
};

/// A place on the surface that knows what it lies on. Nodes are recognised by their coordinates.
struct Spot {
    enum class On { Facet, Edge, Node };
    On on = On::Facet;
    Vec2 at = Vec2::Zero();      ///< [m]
    std::int64_t facet = -1;     ///< the facet that it lies in (On::Facet)
    Vec3 first = Vec3::Zero();   ///< the node; or one end of the edge, whichever facet it is seen from [m]
    Vec3 second = Vec3::Zero();  ///< the other end of the edge [m]
};

/// A spot at p in or on the outline of a facet: moved onto an edge or node nearer than kWalkSnap.
Spot spot_in(const WalkFacet& facet, const Vec2& p);
/// The spot at a place. False if there is no terrain.
bool find_spot(const Surface& surface, const Vec2& p, Spot& spot);
/// A node of the surface.
Spot spot_at_node(const Vec3& node);

/// How far a unit direction points from the spot into a facet that it lies on: positive inside, 0 along its edge.
double points_into(const WalkFacet& facet, const Spot& spot, const Vec2& direction);
/// Where a straight line from the spot through the facet comes out. The direction (unit) must point into the facet.
Spot leave_facet(const WalkFacet& facet, const Spot& spot, const Vec2& direction);
/// Height of the facet's plane at p [m].
double height_on(const WalkFacet& facet, const Vec2& p);

/// The other nodes of the edges that begin at the spot: both ends of its edge, or the neighbours of its node. `rim` says which of these
/// edges have a facet on one side only.
struct EdgesAt {
    std::vector<Vec3> node;  ///< [m]
    std::vector<bool> rim;
};
EdgesAt edges_at(const std::vector<WalkFacet>& around, const Spot& spot);

/// Finds the facets around spots.
class FacetWalk {
public:
    explicit FacetWalk(const Surface& surface) : surface_(surface) {}

    const Surface& surface() const { return surface_; }
    /// The facets that the spot lies in or on, by number: one, two, or the fan around a node; fewer at the rim. Valid until the next call.
    const std::vector<WalkFacet>& around(const Spot& spot);
    /// Straight on to the next edge or node. None where there is no terrain ahead.
    struct Step {
        Spot to;
        WalkFacet through;  ///< the facet, or one beside the edge that the step goes along
    };
    std::optional<Step> step(const Spot& spot, const Vec2& direction);
    /// Is the spot on the outer outline of the terrain? False inside, and on the outline of a hole: there the outline runs the other way
    /// round.
    bool on_outer_rim(const Spot& spot);
    /// Height of the terrain at a spot [m].
    double height(const Spot& spot);

private:
    /// An edge with a facet on its left, from corner `side` of that facet to the next one.
    struct Side {
        WalkFacet facet;
        std::size_t side = 0;
        const Vec3& from() const { return facet.corner[side]; }
        const Vec3& to() const { return facet.corner[(side + 1) % 3]; }
    };
    std::optional<Side> rim_side(const Spot& spot);
    Side next_on_rim(const Side& rim);

    const Surface& surface_;
    TerrainPatch patch_;
    std::vector<WalkFacet> around_;
};

}  // namespace scree
