// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/random.hpp"
#include "scree/geometry/feature.hpp"

#include <array>
#include <vector>

namespace scree {

/// An area in plan view made of polygons with holes, indexed for fast point location (edges sorted into horizontal bands).
/// Where polygons of one region overlap, the even-odd rule does NOT apply: a point in any of them is inside.
class Region {
public:
    Region() = default;
    explicit Region(const MultiPolygon& polygons);

    /// Points on the boundary may fall on either side.
    bool contains(const Vec2& p) const;
    /// Sum of the polygons' areas [m^2].
    double area() const { return area_; }
    Box2 bounds() const { return bounds_; }
    /// Share in (0, 1] of the way from one point to another at which a boundary is met first, infinite if none is. Boundaries inside the region, where
    /// polygons overlap, count too.
    double first_border(const Vec2& from, const Vec2& to) const;
    /// A point drawn uniformly by area. The region must not be empty.
    Vec2 sample(RandomStream& random) const;

private:
    struct Edge {
        Vec2 a, b;    ///< end points [m]
        int polygon;  ///< index of the polygon [-]
    };
    /// A part of a polygon between two horizontal lines.
    struct Trapezium {
        double low, high;                   ///< y [m]
        std::array<double, 2> left, width;  ///< x of the left side, and the width, at both [m]
        double area_up_to;                  ///< of it and all before it [m^2]
    };
    std::vector<Edge> edges_;
    std::vector<std::vector<int>> bands_;          ///< per band the edges that reach into it
    std::vector<Box2> boxes_;                      ///< per polygon [m]
    std::vector<double> areas_;                    ///< per polygon [m^2]
    std::vector<std::vector<Trapezium>> slivers_;  ///< per polygon, of those that fill hardly any of their box
    Box2 bounds_;                                  ///< [m]
    double area_ = 0.0;                            ///< [m^2]
    double band_height_ = 1.0;                     ///< [m]

    int band_of(double y) const;
    bool inside_polygon(const Vec2& p, int polygon) const;
    std::vector<Trapezium> trapezia_of(int polygon) const;
    static Vec2 sample(const std::vector<Trapezium>& trapezia, RandomStream& random);
};

}  // namespace scree
