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
    GridSurface(Grid<double> heights, std::vector<SoilId> soil, DiagonalRule rule)
        : heights_(std::move(heights)), diagonals_(heights_, rule), soil_(std::move(soil)) {
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
        const std::int64_t f = facet_or_none(i, j, diagonals_.half_at(i, j, u.x() - i, u.y() - j));
        return f >= 0 ? f : facet_beside_hole(u);
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
        const Diagonals::Corners& steps = diagonals_.corners(i, j, static_cast<int>(f % 2));
        for (std::size_t k = 0; k < 3; ++k) corners[k] = node(i + steps[k].first, j + steps[k].second);
        soil = soil_[static_cast<std::size_t>(f)];
        return std::isfinite(corners[0].z() + corners[1].z() + corners[2].z());
    }
    std::int64_t facet_number(int i, int j) const {
        return 2 * (static_cast<std::int64_t>(j) * (heights_.shape.columns - 1) + i);
    }
    using Node = std::pair<int, int>;
    /// An edge from a to b, with the facets on its two sides (-1: none there) and their third nodes.
    struct Edge {
        Node a, b, left, right;
        std::int64_t left_facet, right_facet;
    };
    /// The three edges that belong to node (i, j): to the east, to the north, and the diagonal of the square north-east of it.
    std::array<Edge, 3> edges_of(int i, int j) const;
    /// Whether it may be convex, by heights alone.
    bool is_raised(const Edge& e) const;
    void gather_edges(int i, int j, TerrainPatch& patch) const;
    void gather_node(int i, int j, TerrainPatch& patch) const;
    void gather_rim(int i, int j, TerrainPatch& patch) const;
    void gather_rim_node(int i, int j, TerrainPatch& patch) const;
    /// Number of half 0 or 1 of a square, -1 if it is a hole or outside.
    std::int64_t facet_or_none(int i, int j, int half) const {
        if (i < 0 || j < 0 || i + 1 >= heights_.shape.columns || j + 1 >= heights_.shape.rows) return -1;
        double sum = 0.0;
        for (const auto& [di, dj] : diagonals_.corners(i, j, half)) sum += heights_.at(i + di, j + dj);
        return std::isfinite(sum) ? facet_number(i, j) + half : -1;
    }
    /// The facet that has a place on its outline, -1 if there is none: nodes and edges at a hole belong to the terrain. `u`: from node (0, 0) [cells].
    std::int64_t facet_beside_hole(const Vec2& u) const;
    /// The neighbours of a node that edges lead to, counter-clockwise from the east, and the facet counter-clockwise of each (-1 where there is none).
    struct Ring {
        std::array<Node, 8> to;
        std::array<std::int64_t, 8> facet;
        std::size_t count = 0;

        void add(int i, int j, std::int64_t f) {
            to[count] = {i, j};
            facet[count++] = f;
        }
    };
    Ring ring_of(int i, int j) const;

    Grid<double> heights_;
    Diagonals diagonals_;
    std::vector<SoilId> soil_;
};

std::int64_t GridSurface::facet_beside_hole(const Vec2& u) const {
    constexpr double kSlack = 1e-9;  // [cells]
    const auto low = [](double x) { return static_cast<int>(std::floor(x - kSlack)); };
    const auto high = [](double x) { return static_cast<int>(std::floor(x + kSlack)); };
    for (int j = low(u.y()); j <= high(u.y()); ++j)
        for (int i = low(u.x()); i <= high(u.x()); ++i)
            for (const int half : {0, 1}) {
                const std::int64_t f = facet_or_none(i, j, half);
                if (f < 0) continue;
                std::array<Vec2, 3> corner;
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto [di, dj] = diagonals_.corners(i, j, half)[k];
                    corner[k] = Vec2(i + di, j + dj) - u;
                }
                bool inside = true;
                for (std::size_t k = 0; k < 3; ++k) {
                    const Vec2 &a = corner[k], &b = corner[(k + 1) % 3];
                    inside = inside && a.x() * b.y() - a.y() * b.x() >= -kSlack;
                }
                if (inside) return f;
            }
    return -1;
}

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

std::array<GridSurface::Edge, 3> GridSurface::edges_of(int i, int j) const {
    const Node here{i, j}, east{i + 1, j}, north{i, j + 1}, beyond{i + 1, j + 1};
    const bool own = diagonals_.rises(i, j), south = diagonals_.rises(i, j - 1), west = diagonals_.rises(i - 1, j);
    const Edge diagonal = own ? Edge{here, beyond, north, east, facet_or_none(i, j, 1), facet_or_none(i, j, 0)}
                              : Edge{east, north, here, beyond, facet_or_none(i, j, 0), facet_or_none(i, j, 1)};
    return {Edge{here, east, own ? beyond : north, south ? Node{i, j - 1} : Node{i + 1, j - 1}, facet_or_none(i, j, 0),
                 facet_or_none(i, j - 1, 1)},
            Edge{here, north, west ? Node{i - 1, j} : Node{i - 1, j + 1}, own ? beyond : east,
                 facet_or_none(i - 1, j, west ? 0 : 1), facet_or_none(i, j, own ? 1 : 0)},
            diagonal};
}

// A third node lies beside one end of an edge along the grid, and the mean of both ends beside a diagonal: heights there tell whether the facets fall away.
bool GridSurface::is_raised(const Edge& e) const {
    const auto z = [&](const Node& n) { return heights_.at(n.first, n.second); };
    const bool diagonal = e.a.first != e.b.first && e.a.second != e.b.second;
    if (diagonal) return z(e.a) + z(e.b) > z(e.left) + z(e.right);
    const auto beside = [&](const Node& third) {
        return third.first == e.a.first || third.second == e.a.second ? z(e.a) : z(e.b);
    };
    return beside(e.left) + beside(e.right) > z(e.left) + z(e.right);
}

void GridSurface::gather_edges(int i, int j, TerrainPatch& patch) const {
    const std::int64_t id = 3 * static_cast<std::int64_t>(heights_.shape.index(i, j));
    const std::array<Edge, 3> edges = edges_of(i, j);
    for (std::size_t k = 0; k < 3; ++k) {
        const Edge& n = edges[k];
        if (n.left_facet < 0 || n.right_facet < 0 || !is_raised(n)) continue;
        PatchEdge e;
        e.a = node(n.a.first, n.a.second);
        e.b = node(n.b.first, n.b.second);
        e.beyond = {node(n.left.first, n.left.second), node(n.right.first, n.right.second)};
        if (!is_crest((e.b - e.a).cross(e.beyond[0] - e.a), e.a, e.beyond[1])) continue;
        e.soil = {soil_[static_cast<std::size_t>(n.left_facet)], soil_[static_cast<std::size_t>(n.right_facet)]};
        e.id = id + static_cast<std::int64_t>(k);
        patch.edges.push_back(e);
    }
}

GridSurface::Ring GridSurface::ring_of(int i, int j) const {
    Ring ring;
    // of the squares in the north-east and south-west the rising diagonal ends here, of the other two the falling one
    const bool ne = diagonals_.rises(i, j), nw = diagonals_.rises(i - 1, j), sw = diagonals_.rises(i - 1, j - 1),
               se = diagonals_.rises(i, j - 1);
    ring.add(i + 1, j, facet_or_none(i, j, 0));
    if (ne) ring.add(i + 1, j + 1, facet_or_none(i, j, 1));
    ring.add(i, j + 1, facet_or_none(i - 1, j, nw ? 0 : 1));
    if (!nw) ring.add(i - 1, j + 1, facet_or_none(i - 1, j, 0));
    ring.add(i - 1, j, facet_or_none(i - 1, j - 1, 1));
    if (sw) ring.add(i - 1, j - 1, facet_or_none(i - 1, j - 1, 0));
    ring.add(i, j - 1, facet_or_none(i, j - 1, se ? 1 : 0));
    if (!se) ring.add(i + 1, j - 1, facet_or_none(i, j - 1, 1));
    return ring;
}

// A node can poke into a face only if at least three crests meet in it: its cone of normals then has an inside.
void GridSurface::gather_node(int i, int j, TerrainPatch& patch) const {
    const GridShape& shape = heights_.shape;
    if (i == 0 || j == 0 || i + 1 == shape.columns || j + 1 == shape.rows) return;
    const Ring ring = ring_of(i, j);
    if (std::find(ring.facet.begin(), ring.facet.begin() + ring.count, -1) != ring.facet.begin() + ring.count) return;
    const Vec3 centre = node(i, j);
    std::array<Vec3, 8> spoke;
    for (std::size_t k = 0; k < ring.count; ++k) spoke[k] = node(ring.to[k].first, ring.to[k].second) - centre;
    const auto at = [&](std::size_t k) -> const Vec3& { return spoke[k % ring.count]; };
    int crests = 0;
    for (std::size_t k = 0; k < ring.count; ++k)
        crests += is_crest(at(k).cross(at(k + 1)), Vec3::Zero(), at(k + 2)) ? 1 : 0;
    if (crests < 3) return;
    PatchNode n;
    n.position = centre;
    n.first = static_cast<std::int32_t>(patch.spokes.size());
    n.count = static_cast<std::int32_t>(ring.count);
    n.id = static_cast<std::int64_t>(shape.index(i, j));
    for (std::size_t k = 0; k < ring.count; ++k)
        patch.spokes.push_back({spoke[k], soil_[static_cast<std::size_t>(ring.facet[k])]});
    patch.nodes.push_back(n);
}

// Where the terrain ends, outside or at a hole, it falls away like a wall: edges there are crests, nodes are tips.
void GridSurface::gather_rim(int i, int j, TerrainPatch& patch) const {
    const std::int64_t id = 3 * static_cast<std::int64_t>(heights_.shape.index(i, j));
    const std::array<Edge, 3> edges = edges_of(i, j);
    for (std::size_t k = 0; k < 3; ++k) {
        const Edge& n = edges[k];
        if ((n.left_facet < 0) == (n.right_facet < 0)) continue;
        const bool is_left = n.left_facet >= 0;
        const auto at = [&](const Node& p) { return node(p.first, p.second); };
        patch.edges.push_back(rim_edge(at(is_left ? n.a : n.b), at(is_left ? n.b : n.a), at(is_left ? n.left : n.right),
                                       soil_[static_cast<std::size_t>(is_left ? n.left_facet : n.right_facet)],
                                       id + static_cast<std::int64_t>(k)));
    }
    gather_rim_node(i, j, patch);
}

void GridSurface::gather_rim_node(int i, int j, TerrainPatch& patch) const {
    const Ring ring = ring_of(i, j);
    const auto missing = static_cast<std::size_t>(
        std::count(ring.facet.begin(), ring.facet.begin() + static_cast<std::ptrdiff_t>(ring.count), -1));
    if (missing == 0 || missing == ring.count) return;
    PatchNode n;
    n.position = node(i, j);
    n.first = static_cast<std::int32_t>(patch.spokes.size());
    n.id = static_cast<std::int64_t>(heights_.shape.index(i, j));
    for (std::size_t k = 0; k < ring.count; ++k) {
        const std::int64_t after = ring.facet[k], before = ring.facet[(k + ring.count - 1) % ring.count];
        if (after < 0 && before < 0) continue;
        const SoilId soil = soil_[static_cast<std::size_t>(after >= 0 ? after : before)];
        patch.spokes.push_back({node(ring.to[k].first, ring.to[k].second) - n.position, soil});
        if (after < 0) patch.spokes.push_back({-Vec3::UnitZ(), soil});
    }
    n.count = static_cast<std::int32_t>(patch.spokes.size()) - n.first;
    patch.nodes.push_back(n);
}

}  // namespace

std::unique_ptr<Surface> make_grid_surface(Grid<double> heights, std::vector<SoilId> soil, DiagonalRule rule) {
    return std::make_unique<GridSurface>(std::move(heights), std::move(soil), rule);
}

}  // namespace scree
