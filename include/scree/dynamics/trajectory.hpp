// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/units.hpp"
#include "scree/dynamics/contact_solver.hpp"
#include "scree/dynamics/effects.hpp"
#include "scree/dynamics/soil.hpp"
#include "scree/dynamics/state.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/convex_polygon.hpp"
#include "scree/geometry/ground_line.hpp"
#include "scree/geometry/surface.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace scree {

/// How time is stepped. Both share contact law, solver and detection.
enum class SteppingMode {
    Event,       ///< steps end where a contact closes, impacts take no time; converged statistics at 8e-3 s
    MoreauJean,  ///< fixed steps, gap forecast by half a step (B&A section 3.1.1); for comparison with the paper, at 1e-3 s
};
inline constexpr std::array<const char*, 2> kSteppingModeNames{"event", "moreau_jean"};

/// Settings of the mechanics of one trajectory.
struct DynamicsSettings {
    SteppingMode mode = SteppingMode::Event;
    double time_step =
        8e-3;  ///< longest step in contact (every step in moreau_jean); longer is faster and less accurate [s]
    double time_limit = 120.0;  ///< a block still moving then ends as time_limit; too short cuts trajectories off [s]
    double gravity = kStandardGravity;  ///< downward acceleration [m/s^2]
    double activation_gap =
        1e-4;  ///< a contact closes at this gap; larger merges contacts that should act one after the other [m]
    double release_gap = 1e-3;  ///< a closed contact opens beyond this gap; smaller lets sliding blocks chatter [m]
    double impact_speed = 0.1;  ///< approach faster than this is an impact that takes no time (event mode) [m/s]
    double restitution_threshold =
        0.1;  ///< slower normal approach does not bounce (event mode); smaller makes endless small bounces [m/s]
    double flight_step = 1e-2;   ///< longest step of the rotation in flight; the path itself is exact [s]
    double rest_head = 1e-6;     ///< kinetic energy per weight below which a block in static equilibrium may stop [m]
    double rest_time = 0.05;     ///< how long it must stay so [s]
    bool vertices_only = false;  ///< leave out terrain tips and crests (only to compare with codes that lack them)
    ContactSolverSettings solver;
    int kept_problems = 0;  ///< how many of the contact problems above the solver's tolerance a trajectory keeps [-]

    bool operator==(const DynamicsSettings&) const = default;
};

/// Why a trajectory ended. Every block has exactly one reason.
enum class StopReason : std::uint8_t { AtRest, LeftTerrain, TimeLimit, Failed };
inline constexpr std::array<const char*, 4> kStopReasonNames{"at_rest", "left_terrain", "time_limit", "failed"};

/// A stretch of motion with constant acceleration of the centre of mass: x(t) = position + velocity_start t + (velocity_end - velocity_start) t^2 /
/// (2 duration). Exact in flight; in contact it is the scheme's own interpolation. Impacts take no time and lie between two stretches.
template <int Dim>
struct MotionSegment {
    using Vec = typename Space<Dim>::Vec;
    double start = 0.0;                ///< time since release [s]
    double duration = 0.0;             ///< [s]
    double mass = 0.0;                 ///< of the block, or of what is left of it [kg]
    Vec position = Vec::Zero();        ///< of the centre of mass at the start [m]
    Vec velocity_start = Vec::Zero();  ///< [m/s]
    Vec velocity_end = Vec::Zero();    ///< [m/s]
    double spin_start = 0.0;           ///< magnitude of the angular velocity [rad/s]
    double spin_end = 0.0;             ///< [rad/s]
    double spin_most = 0.0;  ///< largest on the way: a block that turns freely may be faster in between [rad/s]
    typename Space<Dim>::Spin turning =
        Space<Dim>::Spin::Zero();  ///< angular velocity at the start, in the axes of the block [rad/s]
    /// Principal moments where the block turns freely all the way, else zero: then its spin changes evenly [kg m^2].
    typename Space<Dim>::Spin free_moment = Space<Dim>::Spin::Zero();
    double rotation_energy_start = 0.0;  ///< [J]
    double rotation_energy_end = 0.0;    ///< [J]
    bool in_contact = false;
    bool struck =
        false;  ///< an impulse lies somewhere in it (moreau_jean): the block never had the velocities between both ends
};

/// Takes the motion as it is computed, in order of time.
template <int Dim>
class MotionSink {
public:
    virtual ~MotionSink() = default;
    virtual void segment(const MotionSegment<Dim>& motion) = 0;
};

/// What happened on the way, for the account that every result carries.
struct TrajectoryCounters {
    std::int64_t contact_steps = 0;
    std::int64_t shortened_steps = 0;  ///< contact steps cut short: at a closing contact, or because energy rose
    std::int64_t impacts = 0;
    std::int64_t flight_evaluations = 0;
    std::int64_t contact_problems = 0;      ///< solved by the contact solver
    std::int64_t unconverged_problems = 0;  ///< of them above the solver's tolerance
    std::int64_t restitution_capped =
        0;  ///< impacts whose restitution was lowered because it would have created energy (Kane's paradox)
    std::int64_t rested_turning = 0;       ///< 1 if the block came to rest in place while it still turned, like a top
    std::int64_t energy_capped = 0;        ///< steps whose rise of energy was taken back
    double largest_rise_taken_back = 0.0;  ///< the largest of these rises, as height of fall [m]
    double largest_energy_rise =
        0.0;  ///< largest rise of energy that a step or impact was left with, as height of fall [m]
    double largest_penetration = 0.0;   ///< [m]
    std::int64_t crossings_struck = 0;  ///< trees and nets that were struck; what grazes a tree takes no energy
    std::int64_t breaks = 0;            ///< how often a block broke
    /// Steps in contact by deepest penetration, two bins per octave (ends 2^n and 1.5 2^n): from 2^-20 m, bin 0 with all below, to 16 m.
    std::array<std::int64_t, 48> penetration{};

    void add_penetration(double depth);
    void merge(const TrajectoryCounters& other);
    /// Upper edge of the bin in which the given share of all steps lies [m].
    double penetration_quantile(double share) const;
};

template <int Dim>
struct TrajectoryEnd {
    StopReason reason = StopReason::Failed;
    double time = 0.0;      ///< since release [s]
    double mass = 0.0;      ///< of what arrived: less than at the start if the block broke [kg]
    BlockState<Dim> state;  ///< at the end
    /// Where the block first broke, the place of its last impact as a whole; NaN if it did not [m].
    typename Space<Dim>::Vec broke_at = Space<Dim>::Vec::Constant(kNaN);
    double energy_start = kNaN;  ///< kinetic plus potential, height 0 of the local frame [J]
    double energy_end = kNaN;    ///< [J]
    TrajectoryCounters counters;
    std::vector<ContactProblem<Dim>> hard_problems;  ///< the first that were left above the tolerance
};

/// Throws one block and follows it until it rests, leaves the terrain, runs out of time or the computation fails.
/// Deterministic: the same input gives the same numbers. `soils` is indexed by the surface's SoilId. Effects on motion act, others are left alone;
/// they must have passed check_effect.
TrajectoryEnd<3> simulate_block(const ConvexBlock& block, const BlockState<3>& release, const Surface& surface,
                                std::span<const Soil> soils, const DynamicsSettings& settings,
                                MotionSink<3>* sink = nullptr, const EffectInput& effects = {});

/// What effects know of a block: its edges, or those of the box along its axes where it was made from points.
EffectBody effect_body(const ConvexBlock& block);
EffectBody effect_body(const ConvexPolygon& block);

/// The same in the plane (s, z) of a profile. The block ends as LeftTerrain where it passes an end of the profile.
TrajectoryEnd<2> simulate_block(const ConvexPolygon& block, const BlockState<2>& release, const GroundLine& ground,
                                std::span<const Soil> soils, const DynamicsSettings& settings,
                                MotionSink<2>* sink = nullptr, const EffectInput& effects = {});

/// Smallest upward shift [m] after which no part of the block is closer to the terrain than `gap` [m]; 0 if it is free already.
double clearing_lift(const ConvexBlock& block, const BlockState<3>& state, const Surface& surface, double gap);
double clearing_lift(const ConvexPolygon& block, const BlockState<2>& state, const GroundLine& ground, double gap);

}  // namespace scree
