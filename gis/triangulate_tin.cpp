// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/delaunay.hpp"
#include "gis/grid_lattice.hpp"
#include "gis/triangulate.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace scree::gis {

namespace {

constexpr double kOnNode = 1e-9;  // [cells]
// Share of the tolerance that a line may take. A node may lie very near a line: what the line is off there becomes a wall between them.
constexpr double kLineShare = 0.1;  // [-]

struct Node {
    std::int32_t i = 0, j = 0;  // [-]
};

// Morton number: nodes that are near in the plane are near in this order, which makes insertion fast.
std::uint64_t morton(const Node& node) {
    const auto spread = [](std::uint64_t x) {
        x = (x | (x << 16)) & 0x0000FFFF0000FFFFULL;
        x = (x | (x << 8)) & 0x00FF00FF00FF00FFULL;
        x = (x | (x << 4)) & 0x0F0F0F0F0F0F0F0FULL;
        x = (x | (x << 2)) & 0x3333333333333333ULL;
        return (x | (x << 1)) & 0x5555555555555555ULL;
    };
    return spread(static_cast<std::uint64_t>(node.i)) | (spread(static_cast<std::uint64_t>(node.j)) << 1);
}

class TinBuilder {
public:
    TinBuilder(const Grid<double>& grid, double tolerance, DiagonalRule rule)
        : lattice_(grid, rule), tolerance_(tolerance) {}

    void add_rim();
    void add_lines(const ConstraintLines& lines);
    void refine();
    Triangulation finish();

private:
    // A place on a line with its height.
    struct LinePoint {
        SnappedPoint place;
        double height = 0;  // [m]
    };

    void constrain(const Vec2& a, const Vec2& b) {
        const std::int32_t from = plane_.insert(a), to = plane_.insert(b);
        plane_.constrain(from, to);
    }
    void add_chain(const std::vector<LinePoint>& chain);
    void read_new_points();
    bool on_surface(const ConstrainedDelaunay::Face& face) const;
    template <class Use>
    void for_each_node(const ConstrainedDelaunay::Face& face, const Use& use) const;
    bool facet_valid(std::int64_t i, std::int64_t j, int half) const {
        if (i < 0 || j < 0 || i >= lattice_.columns() - 1 || j >= lattice_.rows() - 1) return false;
        return lattice_.valid(2 * (j * (lattice_.columns() - 1) + i) + half);
    }

    GridLattice lattice_;
    double tolerance_;             // [m]
    ConstrainedDelaunay plane_;    // in lattice coordinates
    std::vector<double> heights_;  // of the points of plane_ [m]
};

// The edges of the lattice between a facet that is complete and one that is not, joined into straight runs.
void TinBuilder::add_rim() {
    const int columns = lattice_.columns(), rows = lattice_.rows();
    const auto runs = [&](int count, const auto& node_at, const auto& is_rim) {
        int first = -1;
        for (int k = 0; k <= count; ++k) {
            const bool rim = k < count && is_rim(k);
            if (rim && first < 0) first = k;
            if (!rim && first >= 0) {
                constrain(node_at(first), node_at(k));
                first = -1;
            }
        }
    };
    for (int j = 0; j < rows; ++j) {
        runs(
            columns - 1, [&](int k) { return Vec2(k, j); },
            [&](int k) { return facet_valid(k, j, 0) != facet_valid(k, j - 1, 1); });
    }
    for (int i = 0; i < columns; ++i) {
        runs(
            rows - 1, [&](int k) { return Vec2(i, k); },
            [&](int k) {
                return facet_valid(i, k, lattice_.diagonals().western(i, k)) !=
                       facet_valid(i - 1, k, 1 - lattice_.diagonals().western(i - 1, k));
            });
    }
    // diagonals from (s - k, k) to (s - k - 1, k + 1), through the squares (s - k - 1, k)
    for (int s = 1; s <= columns + rows - 3; ++s) {
        runs(
            rows - 1, [&](int k) { return Vec2(s - k, k); },
            [&](int k) {
                return !lattice_.diagonals().rises(s - k - 1, k) &&
                       facet_valid(s - k - 1, k, 0) != facet_valid(s - k - 1, k, 1);
            });
    }
    // and from (s + k, k) to (s + k + 1, k + 1)
    for (int s = 2 - rows; s <= columns - 2; ++s) {
        runs(
            rows - 1, [&](int k) { return Vec2(s + k, k); },
            [&](int k) {
                return lattice_.diagonals().rises(s + k, k) && facet_valid(s + k, k, 0) != facet_valid(s + k, k, 1);
            });
    }
}

void TinBuilder::add_lines(const ConstraintLines& lines) {
    for (const auto& [a, b] : join_lines(lattice_, lines)) {
        std::vector<LinePoint> chain;
        for (const LinePiece& piece : cut_by_lattice(lattice_, a.uv(), b.uv())) {
            const bool valid = lattice_.valid(piece.facet);
            if (!valid || (!chain.empty() && chain.back().place != piece.from)) {
                add_chain(chain);
                chain.clear();
            }
            if (!valid) continue;
            if (chain.empty()) chain.push_back({piece.from, lattice_.height(piece.facet, piece.from.uv())});
            chain.push_back({piece.to, lattice_.height(piece.facet, piece.to.uv())});
        }
        add_chain(chain);
    }
}

// A straight line through the surface: as few points as the tolerance allows (Douglas and Peucker 1973, vertical distance).
void TinBuilder::add_chain(const std::vector<LinePoint>& chain) {
    if (chain.size() < 2) return;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, chain.size() - 1}};
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        const Vec2 a = chain[first].place.uv(), b = chain[last].place.uv();
        double worst = kLineShare * tolerance_;
        std::size_t split = first;
        for (std::size_t k = first + 1; k < last; ++k) {
            const double t = (chain[k].place.uv() - a).dot(b - a) / (b - a).squaredNorm();
            const double error = std::abs(chain[k].height - (1 - t) * chain[first].height - t * chain[last].height);
            if (error > worst) worst = error, split = k;
        }
        if (split == first) {
            constrain(a, b);
        } else {
            open.emplace_back(split, last);
            open.emplace_back(first, split);
        }
    }
}

// Heights of points that came since the last time: nodes, points of lines, and crossings of lines.
void TinBuilder::read_new_points() {
    const std::vector<Vec2>& points = plane_.points();
    while (heights_.size() < points.size()) {
        const Vec2& uv = points[heights_.size()];
        const Vec2 rounded(std::round(uv.x()), std::round(uv.y()));
        if (uv == rounded) {
            heights_.push_back(lattice_.node(static_cast<int>(uv.x()), static_cast<int>(uv.y())));
            continue;
        }
        // on the rim one of the neighbouring facets may be incomplete
        double height = kNaN;
        for (const double e : {0.0, 1e-6, -1e-6}) {
            for (const double d : {0.0, 1e-6, -1e-6}) {
                const std::int64_t facet = lattice_.facet_at(uv + Vec2(d, e));
                if (std::isnan(height) && lattice_.valid(facet)) height = lattice_.height(facet, uv);
            }
        }
        heights_.push_back(height);
    }
}

bool TinBuilder::on_surface(const ConstrainedDelaunay::Face& face) const {
    const std::vector<Vec2>& p = plane_.points();
    const Vec2 centroid = (p[static_cast<std::size_t>(face[0])] + p[static_cast<std::size_t>(face[1])] +
                           p[static_cast<std::size_t>(face[2])]) /
                          3;
    return lattice_.valid(lattice_.facet_at(centroid));
}

// Calls use(node, signed distance of its height above the face) for the nodes in the face and on its rim.
template <class Use>
void TinBuilder::for_each_node(const ConstrainedDelaunay::Face& face, const Use& use) const {
    std::array<Vec2, 3> p;
    std::array<double, 3> z{};
    for (std::size_t k = 0; k < 3; ++k) {
        p[k] = plane_.points()[static_cast<std::size_t>(face[k])];
        z[k] = heights_[static_cast<std::size_t>(face[k])];
    }
    const Vec2 a = p[1] - p[0], b = p[2] - p[0];
    const double twice_area = cross(a, b);
    const double slope_u = ((z[1] - z[0]) * b.y() - (z[2] - z[0]) * a.y()) / twice_area;
    const double slope_v = ((z[2] - z[0]) * a.x() - (z[1] - z[0]) * b.x()) / twice_area;

    const auto low = static_cast<std::int32_t>(std::ceil(std::min({p[0].y(), p[1].y(), p[2].y()})));
    const auto high = static_cast<std::int32_t>(std::floor(std::max({p[0].y(), p[1].y(), p[2].y()})));
    for (std::int32_t j = low; j <= high; ++j) {
        double from = kInfinity, to = -kInfinity;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2 &s = p[k], &e = p[(k + 1) % 3];
            if (std::min(s.y(), e.y()) > j || std::max(s.y(), e.y()) < j) continue;
            const double t = s.y() == e.y() ? 0 : (j - s.y()) / (e.y() - s.y());
            const double u = s.x() + t * (e.x() - s.x());
            from = std::min({from, u, s.y() == e.y() ? e.x() : u});
            to = std::max({to, u, s.y() == e.y() ? e.x() : u});
        }
        const auto last = static_cast<std::int32_t>(std::floor(to + kOnNode));
        for (auto i = static_cast<std::int32_t>(std::ceil(from - kOnNode)); i <= last; ++i) {
            use(Node{i, j}, lattice_.node(i, j) - (z[0] + slope_u * (i - p[0].x()) + slope_v * (j - p[0].y())));
        }
    }
}

void TinBuilder::refine() {
    for (;;) {
        read_new_points();
        std::vector<Node> worst_nodes;
        plane_.for_each_new_face([&](const ConstrainedDelaunay::Face& face) {
            read_new_points();
            if (!on_surface(face)) return;
            double worst = tolerance_;
            Node found{-1, -1};
            for_each_node(face, [&](const Node& node, double error) {
                if (std::abs(error) > worst) worst = std::abs(error), found = node;
            });
            if (found.i >= 0) worst_nodes.push_back(found);
        });
        if (worst_nodes.empty()) return;
        std::sort(worst_nodes.begin(), worst_nodes.end(),
                  [](const Node& a, const Node& b) { return morton(a) < morton(b); });
        for (const Node& node : worst_nodes) plane_.insert({node.i, node.j});
    }
}

Triangulation TinBuilder::finish() {
    Triangulation result;
    TriangulationReport& report = result.report;
    std::vector<std::int32_t> vertex(plane_.points().size(), -1);
    std::vector<bool> met(static_cast<std::size_t>(lattice_.columns()) * static_cast<std::size_t>(lattice_.rows()),
                          false);
    double sum = 0;
    plane_.for_each_face([&](const ConstrainedDelaunay::Face& face) {
        if (!on_surface(face)) return;
        std::array<std::int32_t, 3> indices{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto point = static_cast<std::size_t>(face[k]);
            if (vertex[point] < 0) {
                vertex[point] = static_cast<std::int32_t>(result.mesh.vertices.size());
                const Vec2 p = lattice_.to_local(plane_.points()[point]);
                result.mesh.vertices.emplace_back(p.x(), p.y(), heights_[point]);
            }
            indices[k] = vertex[point];
        }
        result.mesh.facets.push_back(indices);
        for_each_node(face, [&](const Node& node, double error) {
            const std::size_t index = static_cast<std::size_t>(node.j) * static_cast<std::size_t>(lattice_.columns()) +
                                      static_cast<std::size_t>(node.i);
            report.max_error = std::max(report.max_error, std::abs(error));
            if (met[index]) return;
            met[index] = true;
            ++report.nodes;
            sum += error * error;
        });
    });
    for (std::size_t index = 0; index < met.size(); ++index) {
        const auto columns = static_cast<std::size_t>(lattice_.columns());
        const double z = lattice_.node(static_cast<int>(index % columns), static_cast<int>(index / columns));
        if (!met[index] && !std::isnan(z)) ++report.lost_nodes;
    }
    report.rms_error = report.nodes > 0 ? std::sqrt(sum / static_cast<double>(report.nodes)) : 0.0;
    report.tolerance = tolerance_;
    report.vertices = result.mesh.vertices.size();
    report.facets = result.mesh.facets.size();
    result.mesh.soil.assign(report.facets, 0);
    return result;
}

}  // namespace

Triangulation triangulate_tin(const Grid<double>& grid, const ConstraintLines& lines, double tolerance,
                              DiagonalRule rule) {
    if (!(tolerance > 0) || !std::isfinite(tolerance)) {
        throw InputError(words("The vertical tolerance of the triangulation is ", tolerance,
                               " m, but it must be greater than 0; use the grid surface to keep "
                               "every node."));
    }
    TinBuilder builder(grid, tolerance, rule);
    builder.add_rim();
    builder.add_lines(lines);
    builder.refine();
    return builder.finish();
}

}  // namespace scree::gis
