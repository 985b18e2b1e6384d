// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/rigid_motion.hpp"

#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/trajectory.hpp"
#include "support/scenes.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace scree::test {

/// Contacts between a sphere and a plane through the origin, for the Engine.
class SphereOnPlane {
public:
    SphereOnPlane(double radius, const Vec3& normal) : radius_(radius), normal_(normal) {}

    void detect(const Vec3& position, const Mat3&, double reach, std::vector<Contact<3>>& contacts) const {
        contacts.clear();
        Contact<3> c;
        c.gap = normal_.dot(position) - radius_;
        c.normal = normal_;
        c.arm = -radius_ * normal_;
        if (c.gap <= reach) contacts.push_back(c);
    }
    double free_time(const BlockState<3>& s, double, double gravity, const Vec3& drag, double& gap) const {
        gap = normal_.dot(s.position) - radius_;
        const double rate = normal_.dot(s.velocity), fall = gravity * normal_.z() - normal_.dot(drag);
        const double root = rate * rate + 2.0 * fall * gap;
        if (gap <= 0.0) return 0.0;
        const double closing = root >= 0.0 ? std::sqrt(root) - rate : 0.0;
        return closing > 0.0 ? 2.0 * gap / closing : kInfinity;
    }
    bool over_terrain(const Vec3&) const { return true; }
    bool beyond_rim() const { return false; }
    bool buried(const Vec3&) const { return false; }
    double radius() const { return radius_; }
    double inner_radius() const { return radius_; }

private:
    double radius_;
    Vec3 normal_;
};

/// A sphere's mechanics in one place, to be run with varying settings. Any body whose contacts are those of a sphere.
struct SphereMechanics {
    BodyInertia<3> body;
    SphereOnPlane& plane;
    std::vector<Soil> soils;
    DynamicsSettings settings;

    TrajectoryEnd<3> until(double time, const BlockState<3>& release, MotionSink<3>* sink = nullptr) const;
};

inline BodyInertia<3> sphere_inertia(double radius) {
    const double mass = kRockDensity * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    return {mass, Vec3::Constant(0.4 * mass * radius * radius)};
}

}  // namespace scree::test
