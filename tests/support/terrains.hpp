// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/surface.hpp"

#include <functional>

namespace scree::test {

/// The facets of a surface as a mesh, vertices shared where they are the same point.
TriangleMesh mesh_of(const Surface& surface);

/// Every vertex of a mesh moved by a function of it; `mirrored` turns the facets round to keep them counter-clockwise.
TriangleMesh mapped(TriangleMesh mesh, const std::function<Vec3(const Vec3&)>& map, bool mirrored = false);

/// How a square of cells is cut into triangles.
enum class Cut { Grid, OtherDiagonal, Alternating, Random };

/// A mesh over [-half, half]^2 with heights from a function; `Random` moves the inner nodes by up to 0.3 cells and picks the diagonals at random.
TriangleMesh cut_mesh(double half, double cell, Cut cut, const std::function<double(double, double)>& height);

/// Heights of a rough slope: a plane with noise per node, the same for the same node.
std::function<double(double, double)> rough_slope(double slope, double noise);

}  // namespace scree::test
