// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/feature.hpp"
#include "scree/geometry/stretch.hpp"
#include "scree/geometry/types.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace scree {

/// A section of the terrain along a line in plan: the ground of the 2D model.
///
/// The vertical plane (s, z) is unrolled along the line: s, the chainage, is the HORIZONTAL distance along the line from its upper
/// end, z the height in the local frame. A reach is the straight piece between two vertices; it has one soil. Where the line is
/// traced or cut on a surface, every reach lies in one facet, so that the polyline is the surface's own section.
struct Profile {
    std::vector<double> s;    ///< chainage of each vertex, ascending from 0 [m]
    std::vector<double> z;    ///< height of each vertex, local frame [m]
    std::vector<Vec2> place;  ///< position of each vertex in plan, local frame [m]
    std::vector<SoilId>
        soil;  ///< of each reach: soil[k] lies between the vertices k and k + 1; one less than there are vertices

    bool empty() const { return s.size() < 2; }
    std::size_t vertex_count() const { return s.size(); }
    std::size_t reach_count() const { return soil.size(); }
    double length() const { return empty() ? 0.0 : s.back(); }
    bool contains(double chainage) const { return !empty() && chainage >= 0.0 && chainage <= s.back(); }
    /// Corner of the polyline in the plane of the motion: (s, z) [m].
    Vec2 vertex(std::size_t k) const { return {s[k], z[k]}; }

    // --- at a chainage ---
    // Before and beyond the ends there is no ground: height_at() is NaN there; places go straight on along the first or last reach,
    // so that a block that left the profile still has a place on the map. A profile must not be empty.

    /// The reach at a chainage; at a vertex the one that begins there. The first or last one before and beyond the ends.
    std::size_t reach_at(double chainage) const;
    double height_at(double chainage) const;  ///< [m]
    SoilId soil_at(double chainage) const { return soil[reach_at(chainage)]; }
    Vec2 place_at(double chainage) const;      ///< position in plan [m]
    Vec2 direction_at(double chainage) const;  ///< unit vector in plan, towards larger chainages [-]
    double slope_at(double chainage) const;    ///< dz/ds of the reach, negative downhill [-]
    double highest_between(double from,
                           double to) const;  ///< largest height over [from, to]; -infinity if no ground is there [m]

    // --- from the map ---

    /// Chainages at which a line in plan (a screen) crosses the profile, ascending. What lies exactly on a line counts as on its left, on
    /// both sides of the question: a corner of the screen on the profile, or a vertex of the profile on the screen, is one crossing or none.
    std::vector<double> crossings(std::span<const Vec2> line) const;
    /// Chainages at which vertices of either lie on the other, in no order: where it touches a line, and begins and ends to follow it [m].
    std::vector<double> touches(std::span<const Vec2> line) const;

    /// The stretches that lie in an area in plan (release area, deposit zone), ascending.
    std::vector<Stretch> inside(const MultiPolygon& area) const;

    struct Nearest {
        double s = 0.0;       ///< chainage of the nearest point of the profile [m]
        double offset = 0.0;  ///< horizontal distance from it, positive on the left looking along the profile [m]
    };
    /// Where a place (a measured stop) lies along the profile.
    Nearest nearest(const Vec2& p) const;
};

/// A profile through points on the ground, chainages from their places. Points that lie less than kShortestReach from the one before
/// are left out, with the reach that leads to them. `soil` has one entry per reach, one less than there are points; otherwise, and for coordinates
/// that are not finite, throws InputError. Fewer than two different points give an empty profile.
Profile make_profile(std::span<const Vec3> points, std::span<const SoilId> soil);

/// Reaches are not shorter than this: below it a reach is noise of the coordinates [m].
inline constexpr double kShortestReach = 1e-6;

}  // namespace scree
