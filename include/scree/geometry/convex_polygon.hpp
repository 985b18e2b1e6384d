// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/random.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/types.hpp"

#include <vector>

namespace scree {

/// Area properties of a homogeneous polygon of density 1.
struct AreaProperties {
    double area = 0.0;           ///< [m^2]
    Vec2 centre = Vec2::Zero();  ///< centre of mass [m]
    double moment = 0.0;         ///< polar second moment about the centre of mass [m^4]
};

/// Corners of the convex hull of the points, counter-clockwise, from the lowest x (Andrew 1979); points inside or on a side are dropped.
/// Throws InputError if a point is not finite or the points span no area.
std::vector<Vec2> convex_outline(std::vector<Vec2> points);

/// By Green's theorem, of a polygon given counter-clockwise.
AreaProperties area_properties(const std::vector<Vec2>& outline);

/// The rigid convex body of the 2D model: a section in the plane of motion (s, z) with the mass of a whole block. It stands for a prism across
/// the plane, of whatever depth gives it that mass: the moment about the axis across is mass x (radius of gyration of the polygon)^2.
/// Body frame: origin in the centre of mass, axes along those of the L1 x L2 box. Coordinates are kept as separate arrays.
struct ConvexPolygon {
    Eigen::ArrayXd x, z;    ///< corners, counter-clockwise, body frame [m]
    Eigen::ArrayXd nx, nz;  ///< outward unit normal of each side, from corner k to k + 1, body frame [-]
    Eigen::ArrayXd offset;  ///< normal.p of each side [m]
    double mass = 0.0;      ///< [kg]
    double area = 0.0;      ///< [m^2]
    double inertia = 0.0;   ///< moment about the centre of mass [kg m^2]
    Vec3 size = Vec3::
        Zero();  ///< L1, L2 of the box that the polygon was made to fit, and the block's L3, which the plane does not see [m]
    double radius = 0.0;        ///< largest distance of a corner from the centre of mass [m]
    double inner_radius = 0.0;  ///< smallest distance of a side from the centre of mass [m]

    Eigen::Index vertex_count() const { return x.size(); }
    Vec2 vertex(Eigen::Index i) const { return {x[i], z[i]}; }
    Vec2 normal(Eigen::Index k) const { return {nx[k], nz[k]}; }
};

/// A random or regular polygon that fills the box L1 x L2 of `size`, with the given mass [kg] (B&A section 3.2: "we arbitrarily choose
/// the dimensions L1 and L2"). The random shapes use `random`, the others ignore it. Throws InputError for impossible sizes.
///   hull, sharp, round: hull of points drawn uniformly in the ellipse of the box, stretched to fill the box; the number of points is chosen
///                       so that the hull has on average `polygon_points` (or 10, 40) corners;
///   box, eota: the rectangle, and the rectangle with cut corners (EAD 340059: a third of each side remains);
///   ellipsoid: a polygon of `polygon_points` corners at equal angles, stretched to the box;
///   file: the outline of the file's points seen along their third axis, stretched to the box.
ConvexPolygon make_polygon(const ShapeSettings& settings, const Vec3& size, double mass, RandomStream& random);

/// The same polygon with all lengths times `factor` > 0, of a piece of the same form and density: mass times factor cubed.
ConvexPolygon scaled_polygon(const ConvexPolygon& block, double factor);

/// A polygon from given points in any frame, with no stretching; `size` is that of their box, L3 that of L2.
ConvexPolygon make_polygon_from_points(const std::vector<Vec2>& points, double mass);

}  // namespace scree
