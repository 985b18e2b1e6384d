// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "support/ball_on_plane.hpp"
#include "support/scenes.hpp"

#include <numbers>
#include <vector>

namespace scree::test {

/// A sphere's mechanics in one place, to be run with varying settings. Any body whose contacts are those of a sphere.
struct SphereMechanics {
    BodyInertia<3> body;
    BallOnPlane<3>& plane;
    std::vector<Soil> soils;
    DynamicsSettings settings;

    TrajectoryEnd<3> until(double time, const BlockState<3>& release, MotionSink<3>* sink = nullptr) const {
        DynamicsSettings limited = settings;
        limited.time_limit = time;
        return run_on_plane<3>(body, plane, soils, limited, release, sink);
    }
};

inline BodyInertia<3> sphere_inertia(double radius) {
    const double mass = kRockDensity * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    return {mass, Vec3::Constant(0.4 * mass * radius * radius)};
}

}  // namespace scree::test
