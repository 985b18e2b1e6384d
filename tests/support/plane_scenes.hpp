// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/trajectory.hpp"
#include "scree/geometry/convex_polygon.hpp"
#include "scree/geometry/ground_line.hpp"
#include "scree/geometry/profile.hpp"

#include <functional>
#include <span>
#include <vector>

namespace scree::test {

/// A profile towards the east from corners (s, z) and the soil of each reach (all 0 if none are given).
Profile profile_of(std::span<const Vec2> corners, std::span<const SoilId> soil = {});
inline GroundLine ground_of(const std::vector<Vec2>& corners) {
    return GroundLine(profile_of(corners));
}

/// The line of a slope from (0, 0) downwards, cut into pieces of this length.
GroundLine inclined_line(double slope, double length = 80.0, double piece = 1.0);

/// Corners of a rectangle about the origin.
inline std::vector<Vec2> rectangle(double length, double height) {
    return {{-0.5 * length, -0.5 * height},
            {0.5 * length, -0.5 * height},
            {0.5 * length, 0.5 * height},
            {-0.5 * length, 0.5 * height}};
}

/// Corners of a regular polygon of this circumradius, one of them straight below the centre.
std::vector<Vec2> regular_polygon(int corners, double radius);

/// At rest on the slope of inclined_line: a side or corner of the block at a distance `height` below its centre, `along` metres down the slope.
BlockState<2> on_slope(double slope, double along, double height);

/// A polygon on a line in one place, to be run with varying settings.
struct PolygonMechanics {
    const ConvexPolygon& block;
    const GroundLine& ground;
    std::vector<Soil> soils;
    DynamicsSettings settings;

    TrajectoryEnd<2> until(double time, const BlockState<2>& release, MotionSink<2>* sink = nullptr) const {
        DynamicsSettings limited = settings;
        limited.time_limit = time;
        return simulate_block(block, release, ground, soils, limited, sink);
    }
};

}  // namespace scree::test
