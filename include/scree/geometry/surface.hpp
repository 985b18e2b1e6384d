// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/diagonals.hpp"
#include "scree/geometry/triangle_mesh.hpp"
#include "scree/geometry/types.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace scree {

/// One terrain triangle as contact detection needs it. A point x is above the facet's plane by normal.x - offset.
struct PatchFacet {
    Vec3 normal;               ///< unit, upwards [-]
    double offset = 0.0;       ///< normal.p of the plane's points [m]
    Vec2 gradient;             ///< of the height [-]
    double base = 0.0;         ///< height over the origin [m]
    std::array<Vec3, 3> side;  ///< (a, b, c) per side: a x + b y + c is the plan distance into the facet [m]
    std::int32_t id = 0;       ///< number of the facet in the surface [-]
    SoilId soil = 0;

    double gap(const Vec3& p) const { return normal.dot(p) - offset; }
    double height(const Vec2& p) const { return base + gradient.dot(p); }
    /// Upward component of v relative to the plane: how fast a point with velocity v gains height over it.
    double rise(const Vec3& v) const { return v.z() - gradient.x() * v.x() - gradient.y() * v.y(); }
    /// Signed plan distance of p to the outline, positive inside [m].
    double inset(const Vec2& p) const {
        return std::min({side[0].x() * p.x() + side[0].y() * p.y() + side[0].z(),
                         side[1].x() * p.x() + side[1].y() * p.y() + side[1].z(),
                         side[2].x() * p.x() + side[2].y() * p.y() + side[2].z()});
    }
};

/// A convex terrain edge (a crest), which a block's edge can touch. So is a rim, where the terrain ends or has a hole: a wall falls straight down there.
struct PatchEdge {
    Vec3 a, b;                   ///< end points [m]
    std::array<Vec3, 2> beyond;  ///< the third corners of its two facets, or a point of the wall [m]
    std::array<SoilId, 2> soil{};
    std::int64_t id = 0;

    /// Of one of its two facets, unit, upwards.
    Vec3 normal(std::size_t side) const {
        return (side == 0 ? Vec3((b - a).cross(beyond[0] - a)) : Vec3((a - b).cross(beyond[1] - b))).normalized();
    }
};

/// A terrain node that stands out in at least one direction (a tip), which can poke into a block's face; every node on a rim is one.
struct PatchNode {
    Vec3 position;           ///< [m]
    std::int32_t first = 0;  ///< its spokes are patch.spokes[first, first + count), counter-clockwise
    std::int32_t count = 0;
    std::int64_t id = 0;
};

/// One of the edges that meet in a node.
struct PatchSpoke {
    Vec3 edge;        ///< from the node to its neighbour [m]
    SoilId soil = 0;  ///< of the facet between this edge and the next
};

/// A plane above the terrain over some area: normal.x <= offset for every point x of it.
struct SupportingPlane {
    Vec3 normal = Vec3::UnitZ();  ///< unit, upwards [-]
    double offset = -kInfinity;   ///< [m]; no terrain at all: minus infinity
    bool whole = false;           ///< true: there is terrain everywhere over the area, no hole and no rim

    double height(const Vec3& p) const { return normal.dot(p) - offset; }
};

/// The terrain near a block, copied out once and used for many steps while the block stays over `box`.
/// Facets are found through square bins, like the cells of the grid that they mostly come from.
struct TerrainPatch {
    Box2 box;                     ///< what the patch covers in plan view [m]
    SupportingPlane plane;        ///< of the whole patch
    double least_normal_z = 1.0;  ///< of all facets: cosine of the steepest slope [-]
    std::vector<PatchFacet> facets;
    std::vector<PatchEdge> edges;  ///< convex edges only
    std::vector<PatchNode> nodes;  ///< protruding nodes only
    std::vector<PatchSpoke> spokes;

    Vec2 bin_origin;        ///< south-west corner of bin (0, 0) [m]
    double bin_size = 1.0;  ///< [m]
    int bin_columns = 0;
    int bin_rows = 0;
    std::vector<std::int32_t> bin_start;  ///< facets of bin b are bin_facets[bin_start[b], bin_start[b + 1])
    std::vector<std::int32_t> bin_facets;

    void clear();
    void add_facet(const PatchFacet& facet);
    /// Facets whose bin holds the point; empty outside the patch.
    std::span<const std::int32_t> facets_near(const Vec2& p) const;
    std::span<const std::int32_t> facets_in_bin(int column, int row) const {
        const auto bin =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(bin_columns) + static_cast<std::size_t>(column);
        return std::span(bin_facets)
            .subspan(static_cast<std::size_t>(bin_start[bin]),
                     static_cast<std::size_t>(bin_start[bin + 1] - bin_start[bin]));
    }
    /// The facet under or over p, null over a hole or outside.
    const PatchFacet* facet_at(const Vec2& p) const;
};

/// A terrain: single-valued heights over a part of the plane, made of triangles each with one soil. Immutable, shared by all threads.
class Surface {
public:
    virtual ~Surface() = default;

    virtual Box2 bounds() const = 0;
    virtual std::int64_t facet_count() const = 0;
    /// Corners of facet f, counter-clockwise from above; false where the facet is a hole (no data).
    virtual bool facet(std::int64_t f, std::array<Vec3, 3>& corners, SoilId& soil) const = 0;
    /// Number of the facet over which p lies, -1 over holes and outside.
    virtual std::int64_t facet_at(const Vec2& p) const = 0;
    /// Copies out all facets, convex edges and protruding nodes that reach into the box.
    virtual void gather(const Box2& box, TerrainPatch& patch) const = 0;
    /// A plane above all facets that reach into the box, along their mean gradient.
    virtual SupportingPlane supporting_plane(const Box2& box) const = 0;

    /// Height at p [m], NaN over holes and outside.
    double height(const Vec2& p) const;
    /// Upward unit normal at p; p must lie on the surface.
    Vec3 normal(const Vec2& p) const;
};

/// A crest is an edge whose facets fall away from each other by more than this angle [rad]; below it a block's edge may sink in by
/// at most angle x cell, which is what makes it small.
inline constexpr double kCrestAngle = 1e-4;

/// Two facets a cell: the nodes are the CENTRES of the grid's cells, and square (i, j) of nodes is parted along one of its Diagonals.
/// Facet 2 (j (columns - 1) + i) is its southern half, the next one its northern half.
/// A facet with a NaN corner is a hole. `soil` has one entry per facet.
std::unique_ptr<Surface> make_grid_surface(Grid<double> heights, std::vector<SoilId> soil,
                                           DiagonalRule rule = DiagonalRule::Alike);

/// Any triangles. Throws InputError where facets fold over or have no area in plan view.
std::unique_ptr<Surface> make_mesh_surface(TriangleMesh mesh);

/// Number of facets of a grid surface over these cells.
inline std::size_t grid_facet_count(const GridShape& shape) {
    return shape.columns < 2 || shape.rows < 2
               ? 0
               : 2 * static_cast<std::size_t>(shape.columns - 1) * static_cast<std::size_t>(shape.rows - 1);
}

}  // namespace scree
