// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/grid.hpp"
#include "scree/geometry/types.hpp"

#include <string>
#include <vector>

namespace scree::gis {

/// The ground behind a drawing.

/// A shaded relief of the cells in the box as a PNG in a data URI, and what it covers. Light from the north-west, 45 degrees high (the convention of
/// maps), and darker where it is steeper; transparent where there is no height. Empty where the box holds no cells.
struct ReliefImage {
    std::string uri{};
    Box2 extent;  ///< [m]
};
ReliefImage shaded_relief(const Grid<double>& heights, const Box2& box);

/// A line of equal height.
struct Contour {
    double height = 0.0;       ///< in the grid's frame [m]
    std::vector<Vec2> points;  ///< [m]
};
/// Contours of the cells in the box at the heights base + k interval [m].
std::vector<Contour> contours(const Grid<double>& heights, const Box2& box, double interval, double base);

}  // namespace scree::gis
