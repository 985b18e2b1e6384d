// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/random.hpp"
#include "scree/geometry/types.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace scree {

/// Volume properties of a homogeneous body of density 1.
struct MassProperties {
    double volume = 0.0;          ///< [m^3]
    Vec3 centre = Vec3::Zero();   ///< centre of mass [m]
    Mat3 inertia = Mat3::Zero();  ///< tensor about the centre of mass, axes of the input [m^5]
};

/// A closed triangulated convex surface, triangles counter-clockwise from outside.
struct ConvexHull {
    std::vector<Vec3> vertices;                       ///< [m]
    std::vector<std::array<std::int32_t, 3>> facets;  ///< vertex indices [-]
};

/// Convex hull of the points; points inside or on a face are dropped. Throws InputError if the points span no volume.
ConvexHull convex_hull(const std::vector<Vec3>& points);

/// By the divergence theorem (Mirtich 1996, J. Graphics Tools 1(2)): sum over tetrahedra from the first vertex.
MassProperties mass_properties(const ConvexHull& hull);

/// A rigid convex body of given mass: its body frame has the origin in the centre of mass and the axes along the principal axes of
/// inertia. Coordinates are kept as separate arrays (SoA), the layout that detection wants, filled up to whole groups of kLanes by
/// repeating the last entry: least, largest and first of them stay the same.
struct ConvexBlock {
    static constexpr Eigen::Index kLanes = 8;

    Eigen::ArrayXd x, y, z;                           ///< vertices, body frame [m]
    Eigen::ArrayXd nx, ny, nz;                        ///< outward unit normals of the faces, body frame [-]
    Eigen::ArrayXd offset;                            ///< normal.p of each face [m]
    Eigen::Index vertices = 0;                        ///< number of vertices, without the filling [-]
    std::vector<std::array<std::int32_t, 3>> facets;  ///< vertices of each face, counter-clockwise from outside [-]
    double mass = 0.0;                                ///< [kg]
    double volume = 0.0;                              ///< of the hull [m^3]
    Vec3 inertia = Vec3::Zero();                      ///< principal moments about the centre of mass [kg m^2]
    Vec3 size = Vec3::Zero();   ///< edges of the box that the block was made to fit: L1 >= L2 >= L3 [m]
    double radius = 0.0;        ///< largest distance of a vertex from the centre of mass [m]
    double inner_radius = 0.0;  ///< smallest distance of a face from the centre of mass [m]

    Eigen::Index vertex_count() const { return vertices; }
    Eigen::Index face_count() const { return static_cast<Eigen::Index>(facets.size()); }
    Vec3 vertex(Eigen::Index i) const { return {x[i], y[i], z[i]}; }
    Vec3 normal(Eigen::Index f) const { return {nx[f], ny[f], nz[f]}; }
};

/// Shapes of blocks (key blocks.shape). All fill the box L1 x L2 x L3 exactly.
enum class BlockShape { Hull, Sharp, Round, Box, Eota, Ellipsoid, File };

/// Names as in the site file, in the order of the enumeration.
inline constexpr std::array<const char*, 7> kBlockShapeNames{"hull", "sharp",     "round", "box",
                                                             "eota", "ellipsoid", "file"};

struct ShapeSettings {
    BlockShape shape = BlockShape::Hull;
    int points = 50;          ///< mean number of vertices of `hull`; more makes rounder blocks that run farther [-]
    int polygon_points = 20;  ///< the same of the polygon in 2D (B&A section 3.2) [-]
    std::vector<Vec3> file_points;  ///< points of the shape `file`, any frame and scale; stretched to the box [m]
};

/// Vertices of `sharp` and `round` blocks [-] (B&A section 3.2, there for polygons).
inline constexpr int kSharpPoints = 10;
inline constexpr int kRoundPoints = 40;

/// A random or regular block that fits into the box `size` (L1, L2, L3) with the given mass [kg], which is the mass of the body
/// whatever its volume. The random shapes use `random`, the others ignore it. Throws InputError for impossible sizes.
///   hull, sharp, round: hull of points drawn uniformly in the ellipsoid of the box, stretched to fill the box (B&A section 3.2);
///                       the number of points is chosen so that the hull has on average `points` (or 10, 40) vertices;
///   box, eota: the box, and the box with cut edges and corners of EAD 340059 (a third of each edge remains);
///   ellipsoid: a polyhedron of `points` evenly spread vertices, stretched to the box.
ConvexBlock make_block(const ShapeSettings& settings, const Vec3& size, double mass, RandomStream& random);

/// The same block with all lengths times `factor` > 0, of the same density: a piece of the same form.
ConvexBlock scaled_block(const ConvexBlock& block, double factor);

/// A block from given points in any frame, with no stretching.
ConvexBlock make_block_from_points(const std::vector<Vec3>& points, double mass);

}  // namespace scree
