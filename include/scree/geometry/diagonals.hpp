// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/grid.hpp"

#include <array>
#include <cstdint>
#include <utility>

namespace scree {

/// Alike: all squares from node (i+1, j) to (i, j+1), north-west to south-east. Ground that is rough at the size of its cells has a grain then that steers
/// blocks.
/// ByRelief: along the diagonal on which the ground, seen a node farther on both sides, bends less. So ridges and gullies keep their lines, whatever their
/// direction, and a terrain that is mirrored or turned by 90 degrees is the mirrored or turned surface. (Choosing diagonals by the heights around: Dyn,
/// Levin & Rippa 1990, IMA J. Numer. Anal. 10.) A square without the height of one node keeps the facet of the other three.
enum class DiagonalRule { Alike, ByRelief };

/// How each square of four nodes (the centres of a grid's cells) is parted into two facets.
class Diagonals {
public:
    Diagonals() = default;
    Diagonals(const Grid<double>& heights, DiagonalRule rule);

    /// The diagonal of square (i, j) goes from node (i, j) to (i+1, j+1); else, and outside of the grid, from (i+1, j) to (i, j+1).
    bool rises(int i, int j) const { return rises_.shape.contains(i, j) && rises_.at(i, j) != 0; }
    /// Nodes of the southern (half 0) or northern (1) facet, counter-clockwise, as steps (di, dj) from node (i, j).
    using Corners = std::array<std::pair<int, int>, 3>;
    const Corners& corners(int i, int j, int half) const {
        return kCorners[rises(i, j) ? 1 : 0][static_cast<std::size_t>(half)];
    }
    /// Which half lies in the west of the square.
    int western(int i, int j) const { return rises(i, j) ? 1 : 0; }
    /// Which half a place belongs to that is u, v in [0, 1] east and north of node (i, j) [cells].
    int half_at(int i, int j, double u, double v) const { return (rises(i, j) ? v > u : u + v > 1.0) ? 1 : 0; }

private:
    static constexpr std::array<std::array<Corners, 2>, 2> kCorners{
        {{{{{{0, 0}, {1, 0}, {0, 1}}}, {{{1, 0}, {1, 1}, {0, 1}}}}},
         {{{{{0, 0}, {1, 0}, {1, 1}}}, {{{0, 0}, {1, 1}, {0, 1}}}}}}};
    Grid<std::uint8_t> rises_;  ///< by square
};

}  // namespace scree
