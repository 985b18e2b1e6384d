// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/assert.hpp"
#include "scree/geometry/types.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace scree {

/// Where the cells of a raster lie: square cells, column 0 in the west, row 0 in the SOUTH (rasters on disc have it in the north).
struct GridShape {
    int columns = 0;             ///< number of cells west to east [-]
    int rows = 0;                ///< number of cells south to north [-]
    double cell = 1.0;           ///< edge length of a cell [m]
    Vec2 origin = Vec2::Zero();  ///< south-west corner of cell (0, 0), local frame [m]

    std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
    bool contains(int column, int row) const { return column >= 0 && row >= 0 && column < columns && row < rows; }
    std::size_t index(int column, int row) const {
        SCREE_ASSERT(contains(column, row));
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    }
    Vec2 centre(int column, int row) const {
        return {origin.x() + (column + 0.5) * cell, origin.y() + (row + 0.5) * cell};
    }
    int column_of(double x) const { return static_cast<int>(std::floor((x - origin.x()) / cell)); }
    int row_of(double y) const { return static_cast<int>(std::floor((y - origin.y()) / cell)); }
    Box2 bounds() const { return {origin, {origin.x() + columns * cell, origin.y() + rows * cell}}; }
    bool operator==(const GridShape& o) const {
        return columns == o.columns && rows == o.rows && cell == o.cell && origin == o.origin;
    }
};

/// A raster of values, one per cell, valid for the cell's centre (a height) or for its area (a count). NaN means no value.
template <class T>
struct Grid {
    GridShape shape;
    std::vector<T> values;  ///< row by row from the south-west corner; the unit is that of what is stored [*]

    Grid() = default;
    explicit Grid(const GridShape& s, T fill = T{}) : shape(s), values(s.size(), fill) {}

    T& at(int column, int row) { return values[shape.index(column, row)]; }
    const T& at(int column, int row) const { return values[shape.index(column, row)]; }
};

}  // namespace scree
