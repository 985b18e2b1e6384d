// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/effects/block_effects.hpp"
#include "dynamics/rigid_motion.hpp"

#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/state.hpp"
#include "scree/dynamics/trajectory.hpp"

#include <cmath>
#include <span>
#include <vector>

namespace scree::test {

/// Contacts between a ball (a disc in 2D) and a plane through the origin, for the engine: what rolls without corners.
template <int Dim>
class BallOnPlane {
public:
    using Vec = typename Space<Dim>::Vec;
    using Rotation = typename Space<Dim>::Rotation;
    BallOnPlane(double radius, const Vec& normal) : radius_(radius), normal_(normal) {}

    void detect(const Vec& position, const Rotation&, double reach, std::vector<Contact<Dim>>& contacts) const {
        contacts.clear();
        Contact<Dim> c;
        c.gap = normal_.dot(position) - radius_;
        c.normal = normal_;
        c.arm = -radius_ * normal_;
        if (c.gap <= reach) contacts.push_back(c);
    }
    double free_time(const BlockState<Dim>& s, double, double gravity, const Vec& drag, double& gap) const {
        gap = normal_.dot(s.position) - radius_;
        const double rate = normal_.dot(s.velocity), fall = gravity * normal_[Dim - 1] - normal_.dot(drag);
        const double root = rate * rate + 2.0 * fall * gap;
        if (gap <= 0.0) return 0.0;
        const double closing = root >= 0.0 ? std::sqrt(root) - rate : 0.0;
        return closing > 0.0 ? 2.0 * gap / closing : kInfinity;
    }
    bool over_terrain(const Vec&) const { return true; }
    bool beyond_rim() const { return false; }
    bool buried(const Vec&) const { return false; }
    double radius() const { return radius_; }
    double inner_radius() const { return radius_; }

private:
    double radius_;
    Vec normal_;
};

/// A block, or any body whose contacts are those of a ball, from its release at `from` [s] until settings.time_limit.
template <int Dim>
TrajectoryEnd<Dim> run_on_plane(const BodyInertia<Dim>& body, const BallOnPlane<Dim>& contacts,
                                std::span<const Soil> soils, const DynamicsSettings& settings,
                                const BlockState<Dim>& release, MotionSink<Dim>* sink = nullptr,
                                BlockEffects<Dim>* effects = nullptr, double from = 0.0);

}  // namespace scree::test
