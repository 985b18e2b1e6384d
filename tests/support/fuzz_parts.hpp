// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/rigid_motion.hpp"

#include "scree/base/random.hpp"
#include "support/fuzz.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace scree::test {

/// What the fuzz has in common in both dimensions.

/// A block that is deeper in the ground than this share of its thickness has gone through it [-].
inline constexpr double kTunnelShare = 0.5;
/// Overlaps of less are never a fault, whatever the block's size [m].
inline constexpr double kSmallOverlap = 2e-3;
/// Rise of energy that a step may be left with, as height of fall [m].
inline constexpr double kEnergyRise = 1.01e-6;

inline double between_logs(RandomStream& random, double low, double high) {
    return std::exp(random.uniform(std::log(low), std::log(high)));
}

inline std::vector<Soil> two_soils(RandomStream& random, double inner_radius) {
    static constexpr std::array<double, 3> restitution{0.0, 0.3, 0.6};
    std::vector<Soil> soils;
    for (int k = 0; k < 2; ++k)
        soils.push_back(
            {"soil", restitution[random.below(3)], random.uniform(0.2, 0.9), random.uniform(0.0, 0.1) * inner_radius});
    return soils;
}

/// Watches the centre of mass.
template <int Dim, class Ground>
class DepthWatch final : public MotionSink<Dim> {
public:
    explicit DepthWatch(const Ground& ground) : ground_(ground) {}
    void segment(const MotionSegment<Dim>& motion) override {
        const double ground = height_under(motion.position);
        if (std::isfinite(ground)) deepest_ = std::max(deepest_, ground - motion.position[Dim - 1]);
    }
    double deepest() const { return deepest_; }

private:
    double height_under(const Vec3& p) const { return ground_.height(p.head<2>()); }
    double height_under(const Vec2& p) const { return ground_.height(p.x()); }

    const Ground& ground_;
    double deepest_ = 0.0;
};

/// Deepest overlap of a block where it is.
template <int Dim, class Contacts>
double overlap(Contacts finder, const BlockState<Dim>& s) {
    std::vector<Contact<Dim>> contacts;
    finder.detect(s.position, rotation_matrix(s.orientation), 0.0, contacts);
    double deepest = std::max(0.0, finder.cut());
    for (const auto& c : contacts) deepest = std::max(deepest, -c.gap);
    return deepest;
}

template <int Dim>
std::string fault_of(const FuzzOutcome<Dim>& outcome, double inner_radius) {
    const TrajectoryEnd<Dim>& end = outcome.end;
    const double too_deep = std::max(kTunnelShare * inner_radius, kSmallOverlap);
    std::ostringstream fault;
    if (end.reason == StopReason::Failed) fault << "failed; ";
    if (outcome.deepest_centre > 0.0) fault << "centre " << outcome.deepest_centre << " m below the terrain; ";
    if (end.counters.largest_penetration > too_deep)
        fault << "penetration " << end.counters.largest_penetration << " m of " << inner_radius << " m; ";
    if (outcome.rest_penetration > too_deep) fault << "rests " << outcome.rest_penetration << " m deep; ";
    if (end.counters.largest_energy_rise > kEnergyRise)
        fault << "energy rises by " << end.counters.largest_energy_rise << " m; ";
    return fault.str();
}

/// Throws a block. `scaled(block, factor)`: the piece that is left of it.
template <int Dim, class Contacts, class Block, class Ground, class Scaled>
FuzzOutcome<Dim> thrown(const Block& block, const BlockState<Dim>& release, const Ground& ground,
                        std::span<const Soil> soils, const DynamicsSettings& settings, std::span<const Effect> effects,
                        Scaled scaled) {
    FuzzOutcome<Dim> outcome;
    DepthWatch<Dim, Ground> watch(ground);
    outcome.end = simulate_block(block, release, ground, soils, settings, &watch, {effects, 77, 0});
    outcome.deepest_centre = watch.deepest();
    if (outcome.end.reason == StopReason::AtRest) {
        const double mass = outcome.end.mass;
        const Block left = mass < block.mass ? scaled(block, std::cbrt(mass / block.mass)) : block;
        outcome.rest_penetration = overlap<Dim>(Contacts(left, ground, settings.vertices_only), outcome.end.state);
    }
    outcome.fault = fault_of(outcome, block.inner_radius);
    return outcome;
}

}  // namespace scree::test
