// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/patch_builder.hpp"

#include "scree/base/error.hpp"
#include "scree/geometry/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace scree {

namespace {

class GridSurface final : public Surface {
public:
    GridSurface(Grid<double> heights, std::vector<SoilId> soil) : heights_(std::move(heights)), soil_(std::move(soil)) {
        if (heights_.shape.columns < 2 || heights_.shape.rows < 2)
            throw InputError("the terrain has " + std::to_string(heights_.shape.columns) + " x " +
                             std::to_string(heights_.shape.rows) +
                             " cells; a surface needs at least 2 x 2: take a larger DTM or a finer resolution");
        SCREE_ASSERT(soil_.size() == grid_facet_count(heights_.shape));
    }

    Box2 bounds() const override { return {node2(0, 0), node2(heights_.shape.columns - 1, heights_.shape.rows - 1)}; }

    std::int64_t facet_count() const override { return static_cast<std::int64_t>(soil_.size()); }

    bool facet(std::int64_t f, std::array<Vec3, 3>& corners, SoilId& soil) const override {
        const auto cell = static_cast<std::uint64_t>(f / 2),
                   columns = static_cast<std::uint64_t>(heights_.shape.columns - 1);
        return facet_of_cell(static_cast<int>(cell % columns), static_cast<int>(cell / columns), f, corners, soil);
    }

    std::int64_t facet_at(const Vec2& p) const override {
        if (!bounds().contains(p)) return -1;
        const Vec2 u = (p - node2(0, 0)) / heights_.shape.cell;
        const int i = std::min(static_cast<int>(u.x()), heights_.shape.columns - 2);
        const int j = std::min(static_cast<int>(u.y()), heights_.shape.rows - 2);
        const std::int64_t f = facet_number(i, j) + ((u.x() - i) + (u.y() - j) > 1.0 ? 1 : 0);
        return valid(f) ? f : -1;
    }

    void gather(const Box2& box, TerrainPatch& patch) const override;
    SupportingPlane supporting_plane(const Box2& box) const override { return plane_over(nodes_around(box)); }

private:
    /// Nodes [i0, i1] x [j0, j1] whose cells hold the box, cut at the rim.
    struct NodeRange {
        int i0, j0, i1, j1;
        bool whole;  ///< nothing was cut
    };
    NodeRange nodes_around(const Box2& box) const;
    SupportingPlane plane_over(const NodeRange& nodes) const;
    Vec2 node2(int i, int j) const { return heights_.shape.centre(i, j); }
    Vec3 node(int i, int j) const {
        const Vec2 p = node2(i, j);
        return {p.x(), p.y(), heights_.at(i, j)};
    }
    bool facet_of_cell(int i, int j, std::int64_t f, std::array<Vec3, 3>& corners, SoilId& soil) const {
        corners = f % 2 == 0 ? std::array{node(i, j), node(i + 1, j), node(i, j + 1)}
                             : std::array{node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)};
        soil = soil_[static_cast<std::size_t>(f)];
        return std::isfinite(corners[0].z() + corners[1].z() + corners[2].z());
    }
    std::int64_t facet_number(int i, int j) const {
        return 2 * (static_cast<std::int64_t>(j) * (heights_.shape.columns - 1) + i);
    }
    bool valid(std::int64_t f) const {
        std::array<Vec3, 3> corners;
        SoilId soil = 0;
        return facet(f, corners, soil);
    }
    void gather_edges(int i, int j, TerrainPatch& patch) const;
    void add_edge(std::pair<int, int> a, std::pair<int, int> b, std::pair<int, int> left, std::pair<int, int> right,
                  std::int64_t left_facet, std::int64_t right_facet, std::int64_t id, TerrainPatch& patch) const;
    void gather_node(int i, int j, TerrainPatch& patch) const;
    void gather_rim(int i, int j, TerrainPatch& patch) const;
    void gather_rim_node(int i, int j, TerrainPatch& patch) const;
    /// Number of half 0 or 1 of a cell, -1 if it is a hole or outside.
    std::int64_t facet_or_none(int i, int j, int half) const {
        if (i < 0 || j < 0 || i + 1 >= heights_.shape.columns || j + 1 >= heights_.shape.rows) return -1;
        const double third = half == 0 ? heights_.at(i, j) : heights_.at(i + 1, j + 1);
        return std::isfinite(third + heights_.at(i + 1, j) + heights_.at(i, j + 1)) ? facet_number(i, j) + half : -1;
    }
    /// The six neighbours of a node, counter-clockwise from the east.
    static constexpr std::array<std::pair<int, int>, 6> kRing{{{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}}};
    /// The facet counter-clockwise of each of them, -1 where there is none.
    std::array<std::int64_t, 6> facets_around(int i, int j) const {
        return {facet_or_none(i, j, 0),         facet_or_none(i - 1, j, 1), facet_or_none(i - 1, j, 0),
                facet_or_none(i - 1, j - 1, 1), facet_or_none(i, j - 1, 0), facet_or_none(i, j - 1, 1)};
    }

    Grid<double> heights_;
    std::vector<SoilId> soil_;
};

GridSurface::NodeRange GridSurface::nodes_around(const Box2& box) const {
    const GridShape& shape = heights_.shape;
    const Vec2 first = node2(0, 0);
    const double i0 = std::floor((box.min.x() - first.x()) / shape.cell),
                 i1 = std::ceil((box.max.x() - first.x()) / shape.cell);
    const double j0 = std::floor((box.min.y() - first.y()) / shape.cell),
                 j1 = std::ceil((box.max.y() - first.y()) / shape.cell);
    const double columns = shape.columns - 1, rows = shape.rows - 1;
    return {static_cast<int>(std::clamp(i0, 0.0, columns)), static_cast<int>(std::clamp(j0, 0.0, rows)),
            static_cast<int>(std::clamp(i1, 0.0, columns)), static_cast<int>(std::clamp(j1, 0.0, rows)),
            i0 >= 0.0 && j0 >= 0.0 && i1 <= columns && j1 <= rows};
}

SupportingPlane GridSurface::plane_over(const NodeRange& nodes) const {
    const double cell = heights_.shape.cell;
    SupportingPlane plane;
    plane.whole = nodes.whole;
    double east = 0.0, north = 0.0;  // sums of height differences between neighbours
    int east_count = 0, north_count = 0;
    for (int j = nodes.j0; j <= nodes.j1; ++j) {
        for (int i = nodes.i0; i <= nodes.i1; ++i) {
            const double z = heights_.at(i, j);
            if (std::isnan(z)) {
                plane.whole = false;
                continue;
            }
            if (i < nodes.i1 && !std::isnan(heights_.at(i + 1, j))) {
                east += heights_.at(i + 1, j) - z;
                ++east_count;
            }
            if (j < nodes.j1 && !std::isnan(heights_.at(i, j + 1))) {
                north += heights_.at(i, j + 1) - z;
                ++north_count;
            }
        }
    }
    plane.normal = Vec3(east_count > 0 ? -east / (east_count * cell) : 0.0,
                        north_count > 0 ? -north / (north_count * cell) : 0.0, 1.0)
                       .normalized();
    for (int j = nodes.j0; j <= nodes.j1; ++j)
        for (int i = nodes.i0; i <= nodes.i1; ++i)
            if (!std::isnan(heights_.at(i, j))) plane.offset = std::max(plane.offset, plane.normal.dot(node(i, j)));
    return plane;
}

void GridSurface::gather(const Box2& box, TerrainPatch& patch) const {
    patch.clear();
    patch.box = box;
    const NodeRange nodes = nodes_around(box);
    patch.plane = plane_over(nodes);
    patch.bin_origin = node2(nodes.i0, nodes.j0);
    patch.bin_size = heights_.shape.cell;
    patch.bin_columns = nodes.i1 - nodes.i0;
    patch.bin_rows = nodes.j1 - nodes.j0;
    patch.bin_start.push_back(0);
    for (int j = nodes.j0; j < nodes.j1; ++j) {
        for (int i = nodes.i0; i < nodes.i1; ++i) {
            for (std::int64_t f = facet_number(i, j); f < facet_number(i, j) + 2; ++f) {
                std::array<Vec3, 3> corners;
                SoilId soil = 0;
                if (!facet_of_cell(i, j, f, corners, soil)) continue;
                patch.bin_facets.push_back(static_cast<std::int32_t>(patch.facets.size()));
                patch.add_facet(make_patch_facet(corners, soil, f));
            }
            patch.bin_start.push_back(static_cast<std::int32_t>(patch.bin_facets.size()));
        }
    }
    for (int j = nodes.j0; j <= nodes.j1; ++j) {
        for (int i = nodes.i0; i <= nodes.i1; ++i) {
            gather_edges(i, j, patch);
            gather_node(i, j, patch);
            if (!patch.plane.whole) gather_rim(i, j, patch);
        }
    }
}

// The three edges that start at node (i, j): east, north, and the diagonal from (i, j+1) to (i+1, j). Each is a diagonal of a parallelogram of nodes: it
// is convex only if its ends lie above the other two.
void GridSurface::gather_edges(int i, int j, TerrainPatch& patch) const {
    const GridShape& shape = heights_.shape;
    const std::int64_t id = 3 * static_cast<std::int64_t>(shape.index(i, j));
    const double* z = &heights_.at(i, j);
    const std::ptrdiff_t up = shape.columns;
    const bool east = i + 1 < shape.columns, north = j + 1 < shape.rows;
    if (east && north && j > 0 && z[0] + z[1] > z[up] + z[1 - up])
        add_edge({i, j}, {i + 1, j}, {i, j + 1}, {i + 1, j - 1}, facet_number(i, j), facet_number(i, j - 1) + 1, id,
                 patch);
    if (east && north && i > 0 && z[0] + z[up] > z[up - 1] + z[1])
        add_edge({i, j}, {i, j + 1}, {i - 1, j + 1}, {i + 1, j}, facet_number(i - 1, j) + 1, facet_number(i, j), id + 1,
                 patch);
    if (east && north && z[1] + z[up] > z[0] + z[up + 1])
        add_edge({i + 1, j}, {i, j + 1}, {i, j}, {i + 1, j + 1}, facet_number(i, j), facet_number(i, j) + 1, id + 2,
                 patch);
}

void GridSurface::add_edge(std::pair<int, int> a, std::pair<int, int> b, std::pair<int, int> left,
                           std::pair<int, int> right, std::int64_t left_facet, std::int64_t right_facet,
                           std::int64_t id, TerrainPatch& patch) const {
    PatchEdge e;
    e.a = node(a.first, a.second);
    e.b = node(b.first, b.second);
    e.beyond = {node(left.first, left.second), node(right.first, right.second)};
    if (!is_crest((e.b - e.a).cross(e.beyond[0] - e.a), e.a, e.beyond[1])) return;
    e.soil = {soil_[static_cast<std::size_t>(left_facet)], soil_[static_cast<std::size_t>(right_facet)]};
    e.id = id;
    patch.edges.push_back(e);
}

// A node can poke into a face only if at least three crests meet in it: its cone of normals then has an inside.
void GridSurface::gather_node(int i, int j, TerrainPatch& patch) const {
    const GridShape& shape = heights_.shape;
    if (i == 0 || j == 0 || i + 1 == shape.columns || j + 1 == shape.rows) return;
    const double* z = &heights_.at(i, j);
    const std::ptrdiff_t up = shape.columns;
    const std::array<double, 6> around{z[1], z[up], z[up - 1], z[-1], z[-up], z[1 - up]};
    int crests = 0;
    for (std::size_t k = 0; k < 6; ++k) crests += z[0] + around[k] > around[(k + 1) % 6] + around[(k + 5) % 6] ? 1 : 0;
    if (crests < 3 || !std::isfinite(z[0] + std::accumulate(around.begin(), around.end(), 0.0))) return;
    const std::array<std::int64_t, 6> facets = facets_around(i, j);
    const Vec3 centre = node(i, j);
    std::array<Vec3, 6> spoke;
    for (std::size_t k = 0; k < 6; ++k) spoke[k] = node(i + kRing[k].first, j + kRing[k].second) - centre;
    crests = 0;
    for (std::size_t k = 0; k < 6; ++k)
        crests += is_crest(spoke[k].cross(spoke[(k + 1) % 6]), Vec3::Zero(), spoke[(k + 2) % 6]) ? 1 : 0;
    if (crests < 3) return;
    PatchNode n;
    n.position = centre;
    n.first = static_cast<std::int32_t>(patch.spokes.size());
    n.count = 6;
    n.id = static_cast<std::int64_t>(shape.index(i, j));
    for (std::size_t k = 0; k < 6; ++k) patch.spokes.push_back({spoke[k], soil_[static_cast<std::size_t>(facets[k])]});
    patch.nodes.push_back(n);
}

// Where the terrain ends, outside or at a hole, it falls away like a wall: edges there are crests, nodes are tips.
void GridSurface::gather_rim(int i, int j, TerrainPatch& patch) const {
    const std::int64_t id = 3 * static_cast<std::int64_t>(heights_.shape.index(i, j));
    const std::int64_t east = facet_or_none(i, j, 0), diagonal = facet_or_none(i, j, 1),
                       west = facet_or_none(i - 1, j, 1), south = facet_or_none(i, j - 1, 1);
    auto add = [&](std::pair<int, int> a, std::pair<int, int> b, std::pair<int, int> left, std::pair<int, int> right,
                   std::int64_t left_facet, std::int64_t right_facet, std::int64_t number) {
        if ((left_facet < 0) == (right_facet < 0)) return;
        const bool is_left = left_facet >= 0;
        const auto& third = is_left ? left : right;
        patch.edges.push_back(rim_edge(is_left ? node(a.first, a.second) : node(b.first, b.second),
                                       is_left ? node(b.first, b.second) : node(a.first, a.second),
                                       node(third.first, third.second),
                                       soil_[static_cast<std::size_t>(is_left ? left_facet : right_facet)], number));
    };
    add({i, j}, {i + 1, j}, {i, j + 1}, {i + 1, j - 1}, east, south, id);
    add({i, j}, {i, j + 1}, {i - 1, j + 1}, {i + 1, j}, west, east, id + 1);
    add({i + 1, j}, {i, j + 1}, {i, j}, {i + 1, j + 1}, east, diagonal, id + 2);
    gather_rim_node(i, j, patch);
}

void GridSurface::gather_rim_node(int i, int j, TerrainPatch& patch) const {
    const std::array<std::int64_t, 6> facets = facets_around(i, j);
    const auto missing = std::count(facets.begin(), facets.end(), -1);
    if (missing == 0 || missing == 6) return;
    PatchNode n;
    n.position = node(i, j);
    n.first = static_cast<std::int32_t>(patch.spokes.size());
    n.id = static_cast<std::int64_t>(heights_.shape.index(i, j));
    for (std::size_t k = 0; k < 6; ++k) {
        const std::int64_t after = facets[k], before = facets[(k + 5) % 6];
        if (after < 0 && before < 0) continue;
        const SoilId soil = soil_[static_cast<std::size_t>(after >= 0 ? after : before)];
        patch.spokes.push_back({node(i + kRing[k].first, j + kRing[k].second) - n.position, soil});
        if (after < 0) patch.spokes.push_back({-Vec3::UnitZ(), soil});
    }
    n.count = static_cast<std::int32_t>(patch.spokes.size()) - n.first;
    patch.nodes.push_back(n);
}

}  // namespace

std::unique_ptr<Surface> make_grid_surface(Grid<double> heights, std::vector<SoilId> soil) {
    return std::make_unique<GridSurface>(std::move(heights), std::move(soil));
}

}  // namespace scree
