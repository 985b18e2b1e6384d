// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/diagonals.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <utility>
#include <vector>

namespace scree::gis {

/// The surface of a grid in lattice coordinates: node (i, j), the centre of cell (i, j), lies at u = i, v = j. Each square of four nodes
/// has two facets, parted by one of its Diagonals; they are numbered as in assign_soils().
class GridLattice {
public:
    explicit GridLattice(const Grid<double>& grid, DiagonalRule rule = DiagonalRule::Alike)
        : grid_(grid), diagonals_(grid, rule) {}

    int columns() const { return grid_.shape.columns; }
    int rows() const { return grid_.shape.rows; }
    double node(int i, int j) const { return grid_.at(i, j); }
    Vec2 to_lattice(const Vec2& p) const { return (p - grid_.shape.centre(0, 0)) / grid_.shape.cell; }
    Vec2 to_local(const Vec2& uv) const { return grid_.shape.centre(0, 0) + grid_.shape.cell * uv; }

    std::int64_t facets() const { return 2 * std::int64_t{columns() - 1} * (rows() - 1); }
    /// The facet at a place inside of the lattice.
    std::int64_t facet_at(const Vec2& uv) const {
        const int i = std::clamp(static_cast<int>(uv.x()), 0, columns() - 2),
                  j = std::clamp(static_cast<int>(uv.y()), 0, rows() - 2);
        return 2 * (std::int64_t{j} * (columns() - 1) + i) + diagonals_.half_at(i, j, uv.x() - i, uv.y() - j);
    }
    const Diagonals& diagonals() const { return diagonals_; }
    /// Whether all three nodes of a facet have a height.
    bool valid(std::int64_t facet) const {
        const auto [i, j] = square(facet);
        double sum = 0;
        for (const auto& [di, dj] : corners(facet)) sum += node(i + di, j + dj);
        return !std::isnan(sum);
    }
    const Diagonals::Corners& corners(std::int64_t facet) const {
        const auto [i, j] = square(facet);
        return diagonals_.corners(i, j, static_cast<int>(facet % 2));
    }
    struct Square {
        int i, j;  ///< south-west node [-]
    };
    Square square(std::int64_t facet) const {
        return {static_cast<int>(facet / 2 % (columns() - 1)), static_cast<int>(facet / 2 / (columns() - 1))};
    }
    /// Height of the plane of a facet at a place [m].
    double height(std::int64_t facet, const Vec2& uv) const {
        const auto [i, j] = square(facet);
        const double fu = uv.x() - i, fv = uv.y() - j, sw = node(i, j), ne = node(i + 1, j + 1);
        if (diagonals_.rises(i, j))
            return facet % 2 == 0 ? sw + fu * (node(i + 1, j) - sw) + fv * (ne - node(i + 1, j))
                                  : sw + fv * (node(i, j + 1) - sw) + fu * (ne - node(i, j + 1));
        if (facet % 2 == 0) return sw + fu * (node(i + 1, j) - sw) + fv * (node(i, j + 1) - sw);
        return ne + (1 - fu) * (node(i, j + 1) - ne) + (1 - fv) * (node(i + 1, j) - ne);
    }

private:
    const Grid<double>& grid_;
    Diagonals diagonals_;
};

/// Lines are put on positions that are multiples of 1/kSnap of a cell, so that points on edges of the lattice lie exactly on them in
/// floating point and no facet becomes thinner than that. A boundary moves by at most half of this.
inline constexpr std::int64_t kSnap = 256;

struct SnappedPoint {
    std::int64_t u = 0, v = 0;  ///< in 1/kSnap of a cell [-]
    auto operator<=>(const SnappedPoint&) const = default;
    Vec2 uv() const { return Vec2(static_cast<double>(u), static_cast<double>(v)) / static_cast<double>(kSnap); }
};

/// Segments between two of these, none twice, the lesser point first.
using SnappedSegments = std::vector<std::pair<SnappedPoint, SnappedPoint>>;

/// Prepares lines (local frame [m]) for a mesh: boundaries that neighbours drew twice, with other vertices or not quite in the same
/// place, become one. A vertex within 1/16 of a cell of a node of the lattice or of an earlier vertex moves there; a segment that
/// passes a vertex within that distance is led through it.
SnappedSegments join_lines(const GridLattice& lattice, const std::vector<std::vector<Vec2>>& lines);

/// A part of a line in one facet.
struct LinePiece {
    SnappedPoint from, to;
    std::int64_t facet = 0;  ///< [-]
};

/// The parts of the segment from a to b (lattice coordinates) in the facets of the lattice, in order; those outside of the lattice and
/// those shorter than the snapping are left out.
std::vector<LinePiece> cut_by_lattice(const GridLattice& lattice, const Vec2& a, const Vec2& b);

}  // namespace scree::gis
