// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/delaunay.hpp"
#include "gis/grid_lattice.hpp"
#include "gis/triangulate.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>
#include <utility>

namespace scree::gis {

namespace {

// An edge of the lattice: 3 * node + direction (0: to the east, 1: to the north, 2: the diagonal of the square to its north-east).
using EdgeKey = std::int64_t;

class Conformer {
public:
    Conformer(const Grid<double>& grid, DiagonalRule rule) : lattice_(grid, rule) {
        const auto nodes = static_cast<std::size_t>(lattice_.columns()) * static_cast<std::size_t>(lattice_.rows());
        node_vertex_.assign(nodes, -1);
    }

    void cut(const ConstraintLines& lines) {
        for (const auto& [a, b] : join_lines(lattice_, lines)) {
            for (const LinePiece& piece : cut_by_lattice(lattice_, a.uv(), b.uv())) {
                if (!lattice_.valid(piece.facet)) continue;
                pieces_[piece.facet].push_back(std::minmax(piece.from, piece.to));
                note_edge_point(piece.from);
                note_edge_point(piece.to);
            }
        }
    }

    Triangulation build() {
        for (std::int64_t f = 0; f < lattice_.facets(); ++f) {
            if (!lattice_.valid(f)) continue;
            if (is_cut(f))
                add_divided(f);
            else
                add_whole(f);
        }
        Triangulation result;
        mesh_.soil.assign(mesh_.facets.size(), 0);
        result.report.vertices = mesh_.vertices.size();
        result.report.facets = mesh_.facets.size();
        for (int j = 0; j < lattice_.rows(); ++j) {
            for (int i = 0; i < lattice_.columns(); ++i) {
                if (node_vertex_[node_index(i, j)] >= 0)
                    ++result.report.nodes;
                else if (!std::isnan(lattice_.node(i, j)))
                    ++result.report.lost_nodes;
            }
        }
        result.mesh = std::move(mesh_);
        return result;
    }

private:
    std::size_t node_index(std::int64_t i, std::int64_t j) const {
        return static_cast<std::size_t>(j * lattice_.columns() + i);
    }
    EdgeKey edge(std::int64_t i, std::int64_t j, int direction) const {
        return 3 * (j * lattice_.columns() + i) + direction;
    }

    // A point on an edge divides the facets on both sides of it.
    void note_edge_point(const SnappedPoint& p) {
        const std::int64_t i = p.u / kSnap, j = p.v / kSnap, fu = p.u % kSnap, fv = p.v % kSnap;
        if (fu == 0 && fv == 0) return;
        if (fv == 0)
            edge_points_[edge(i, j, 0)].push_back(p);
        else if (fu == 0)
            edge_points_[edge(i, j, 1)].push_back(p);
        else if (lattice_.diagonals().rises(static_cast<int>(i), static_cast<int>(j)) ? fu == fv : fu + fv == kSnap)
            edge_points_[edge(i, j, 2)].push_back(p);
    }

    std::array<EdgeKey, 3> edges_of(std::int64_t facet) const {
        const auto [i, j] = lattice_.square(facet);
        const int half = static_cast<int>(facet % 2);
        return {edge(i, j + half, 0), edge(half == lattice_.diagonals().western(i, j) ? i : i + 1, j, 1),
                edge(i, j, 2)};
    }
    std::array<SnappedPoint, 3> corners_of(std::int64_t facet) const {
        const auto square = lattice_.square(facet);
        std::array<SnappedPoint, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [di, dj] = lattice_.corners(facet)[k];
            corners[k] = {(square.i + di) * kSnap, (square.j + dj) * kSnap};
        }
        return corners;
    }

    bool is_cut(std::int64_t facet) const {
        if (pieces_.empty()) return false;
        const auto keys = edges_of(facet);
        return pieces_.count(facet) > 0 ||
               std::any_of(keys.begin(), keys.end(), [&](EdgeKey k) { return edge_points_.count(k) > 0; });
    }

    std::int32_t add_vertex(std::int64_t facet, const Vec2& uv) {
        const Vec2 p = lattice_.to_local(uv);
        mesh_.vertices.emplace_back(p.x(), p.y(), lattice_.height(facet, uv));
        return static_cast<std::int32_t>(mesh_.vertices.size() - 1);
    }
    std::int32_t vertex(std::int64_t facet, const SnappedPoint& p) {
        std::int32_t* index = nullptr;
        if (p.u % kSnap == 0 && p.v % kSnap == 0)
            index = &node_vertex_[node_index(p.u / kSnap, p.v / kSnap)];
        else
            index = &line_vertex_.try_emplace(p, -1).first->second;
        if (*index < 0) *index = add_vertex(facet, p.uv());
        return *index;
    }

    void add_whole(std::int64_t facet) {
        const auto c = corners_of(facet);
        mesh_.facets.push_back({vertex(facet, c[0]), vertex(facet, c[1]), vertex(facet, c[2])});
    }

    void add_divided(std::int64_t facet) {
        ConstrainedDelaunay plane;
        std::vector<std::int32_t> of_point;  // mesh vertex of each point of the triangulation
        const auto insert = [&](const SnappedPoint& p) {
            const std::int32_t point = plane.insert(p.uv());
            if (static_cast<std::size_t>(point) == of_point.size()) of_point.push_back(vertex(facet, p));
            return point;
        };
        for (const SnappedPoint& p : corners_of(facet)) insert(p);
        for (const EdgeKey key : edges_of(facet)) {
            if (const auto found = edge_points_.find(key); found != edge_points_.end()) {
                for (const SnappedPoint& p : found->second) insert(p);
            }
        }
        if (const auto found = pieces_.find(facet); found != pieces_.end()) {
            std::vector<std::pair<std::int32_t, std::int32_t>> segments;
            for (const auto& [from, to] : found->second) {
                const std::int32_t a = insert(from), b = insert(to);
                segments.emplace_back(a, b);
            }
            for (const auto& [a, b] : segments) plane.constrain(a, b);
        }
        plane.for_each_face([&](const ConstrainedDelaunay::Face& face) {
            std::array<std::int32_t, 3> indices{};
            for (std::size_t k = 0; k < 3; ++k) {
                // two lines may cross inside of the facet
                while (of_point.size() <= static_cast<std::size_t>(face[k]))
                    of_point.push_back(add_vertex(facet, plane.points()[of_point.size()]));
                indices[k] = of_point[static_cast<std::size_t>(face[k])];
            }
            mesh_.facets.push_back(indices);
        });
    }

    GridLattice lattice_;
    TriangleMesh mesh_;
    std::vector<std::int32_t> node_vertex_;             // -1: none yet
    std::map<SnappedPoint, std::int32_t> line_vertex_;  // of points on lines that are no nodes
    std::unordered_map<std::int64_t, std::vector<std::pair<SnappedPoint, SnappedPoint>>> pieces_;  // per facet
    std::unordered_map<EdgeKey, std::vector<SnappedPoint>> edge_points_;
};

}  // namespace

Triangulation conform_grid(const Grid<double>& grid, const ConstraintLines& lines, DiagonalRule rule) {
    Conformer conformer(grid, rule);
    conformer.cut(lines);
    return conformer.build();
}

}  // namespace scree::gis
