// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/diagonals.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// How much the ground bends at both ends of b-c together, of four nodes in a row; of three, where an outer one has no height, at one end; of two nobody
/// knows: infinity [m].
double bend(double a, double b, double c, double d) {
    const double before = std::isnan(a) ? 0.0 : a - b, after = std::isnan(d) ? 0.0 : d - c, within = c - b;
    if (std::isnan(a) && std::isnan(d)) return kInfinity;
    if (std::isnan(a)) return std::abs(after - within);
    if (std::isnan(d)) return std::abs(before + within);
    return std::abs(before + after);
}

}  // namespace

Diagonals::Diagonals(const Grid<double>& heights, DiagonalRule rule)
    : rises_({std::max(heights.shape.columns - 1, 0), std::max(heights.shape.rows - 1, 0), heights.shape.cell,
              heights.shape.centre(0, 0)}) {
    if (rule == DiagonalRule::Alike) return;
    const auto z = [&](int i, int j) { return heights.shape.contains(i, j) ? heights.at(i, j) : kNaN; };
    for (int j = 0; j < rises_.shape.rows; ++j)
        for (int i = 0; i < rises_.shape.columns; ++i) {
            const double sw = z(i, j), se = z(i + 1, j), nw = z(i, j + 1), ne = z(i + 1, j + 1);
            bool rise = bend(z(i - 1, j - 1), sw, ne, z(i + 2, j + 2)) < bend(z(i - 1, j + 2), nw, se, z(i + 2, j - 1));
            if (std::isnan(se) || std::isnan(nw)) rise = true;
            if (std::isnan(sw) || std::isnan(ne)) rise = false;
            rises_.at(i, j) = rise;
        }
}

}  // namespace scree
