// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/diagonals.hpp"
#include "scree/geometry/triangle_mesh.hpp"

#include <string>
#include <vector>

namespace scree::gis {

/// Lines that facets must not cross: boundaries of soil zones and breaklines. Open; a ring repeats its first point at the end [m].
using ConstraintLines = std::vector<std::vector<Vec2>>;

/// Lines nearer than this to each other or to a node of the grid are joined [cells].
inline constexpr double kJoinDistance = 1.0 / 16;

struct TriangulationReport {
    std::size_t nodes = 0;       ///< nodes of the grid with a height that lie on the surface [-]
    std::size_t vertices = 0;    ///< of the mesh [-]
    std::size_t facets = 0;      ///< of the mesh [-]
    double tolerance = 0.0;      ///< largest vertical distance asked for [m]
    double max_error = 0.0;      ///< largest vertical distance of a node to the mesh [m]
    double rms_error = 0.0;      ///< root mean square of these distances [m]
    std::size_t lost_nodes = 0;  ///< nodes with a height in no complete facet, beside holes [-]
    std::vector<std::string> warnings;
};

struct Triangulation {
    TriangleMesh mesh;  ///< soils are all 0: assign_soils() fills them
    TriangulationReport report;
};

/// The surface of the grid (nodes: cell centres; two facets a square, see assign_soils) with its facets divided along the lines. The
/// surface stays the same to rounding; facets without a line stay as they are. Squares beside holes keep the facets that are complete.
/// Lines nearer than 1/16 of a cell to each other or to a node are joined; then they lie within 1/256 of a cell of where they were.
Triangulation conform_grid(const Grid<double>& grid, const ConstraintLines& lines,
                           DiagonalRule rule = DiagonalRule::Alike);

/// A triangulation with few facets that passes every node of the grid within `tolerance` > 0 [m] (greedy insertion: Garland and
/// Heckbert 1995, here the worst node of each triangle at a time, until none is left). The lines become edges, with heights of the
/// grid surface, within a tenth of the tolerance along the line. The mesh covers the same area as the grid surface: its rim follows holes.
Triangulation triangulate_tin(const Grid<double>& grid, const ConstraintLines& lines, double tolerance,
                              DiagonalRule rule = DiagonalRule::Alike);

}  // namespace scree::gis
