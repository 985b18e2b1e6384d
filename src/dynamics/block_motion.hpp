// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/contact_step.hpp"
#include "dynamics/effects/block_effects.hpp"
#include "dynamics/rest_watch.hpp"
#include "dynamics/rigid_motion.hpp"

#include "scree/dynamics/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace scree {

/// What both ways of stepping share: the block on its way, what touches it, its velocities over a step in contact, its rest, and the account of all that.
///
/// `Contacts` finds what touches. It offers
///     detect(position, rotation, reach, contacts)   all contacts with gap <= reach
///     free_time(state, spin bound, gravity, drag, gap)   how long nothing can touch in flight
///     over_terrain(position), buried(position), beyond_rim(), radius(), inner_radius()
template <int Dim, class Contacts>
class BlockMotion {
public:
    using Vec = typename Space<Dim>::Vec;
    using Spin = typename Space<Dim>::Spin;
    using State = BlockState<Dim>;

    BlockMotion(const BodyInertia<Dim>& body, Contacts& contacts, std::span<const Soil> soils,
                const DynamicsSettings& settings, MotionSink<Dim>* sink, BlockEffects<Dim>* effects)
        : body_(body),
          finder_(contacts),
          soils_(soils),
          settings_(settings),
          sink_(sink),
          effects_(effects),
          step_(body, soils, settings.solver) {
        gravity_ = -settings.gravity * Vec::Unit(Dim - 1);
    }

protected:
    // ---- beginning and end ----------------------------------------------------------------------------------------------------

    void begin(const State& release, double time) {
        state_ = release;
        time_ = time;
        end_.energy_start = energy(state_);
        if (!finder_.over_terrain(state_.position)) finish(StopReason::LeftTerrain);
    }

    TrajectoryEnd<Dim> end() {
        end_.time = time_;
        end_.mass = body_.mass;
        end_.state = state_;
        end_.energy_end = energy(state_);
        return end_;
    }

    void finish(StopReason reason) {
        if (finished_) return;
        finished_ = true;
        end_.reason = reason;
    }

    /// A state that is not finite, or a block that went through the ground, is a failure of ours: reported as such, never passed on.
    void check() {
        if (!is_finite(state_)) {
            finished_ = true;
            end_.reason = StopReason::Failed;
        }
        if (!closed_.empty() && finder_.buried(state_.position)) {
            finished_ = true;
            end_.reason = StopReason::Failed;
        }
        if (static_cast<double>(++turns_) > kMostTurns + settings_.time_limit / settings_.time_step)
            finish(StopReason::Failed);
    }

    static bool is_finite(const State& s) {
        return s.position.allFinite() && s.velocity.allFinite() && s.spin.allFinite();
    }

    // ---- steps in contact -----------------------------------------------------------------------------------------------------

    /// A step begins where the look at the end of the one before has been: sines and cosines are kept.
    const typename Space<Dim>::Rotation& rotation_of(const State& s) {
        if (!same(s.orientation, turned_to_)) {
            turned_to_ = s.orientation;
            rotation_ = rotation_matrix(s.orientation);
        }
        return rotation_;
    }

    double fastest_point(const State& s) const { return s.velocity.norm() + s.spin.norm() * finder_.radius(); }

    double energy(const State& s) const {
        return kinetic_energy(body_, s) + body_.mass * settings_.gravity * s.position[Dim - 1];
    }

    /// e, mu, mu_r of the contacts at hand as effects change them.
    void change_laws(const State& s) {
        const auto contacts = step_.contacts();
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            const ContactSpeed speed{std::max(0.0, -step_.normal_velocity(c, s)), step_.sliding_speed(c, s)};
            const ContactLaw law = effects_->law(contacts[c], s, speed, soils_[contacts[c].soil]);
            if (std::isfinite(law.restitution) && std::isfinite(law.friction) && std::isfinite(law.rolling))
                step_.set_law(c, law.restitution, law.friction, law.rolling);
            else
                finish(StopReason::Failed);  // a law of the user
        }
    }

    /// Velocities at the end of a step with the closed contacts.
    ContactSolverReport driven(double h, const RestitutionRule& rule, const State& before, State& after) {
        Drag in_contact = effects_ ? effects_->drag_in_contact(closed_, before) : Drag{};
        if (!in_contact.none() && !bears(h, before)) in_contact = {};
        after = before;
        const Vec along = effects_ ? effects_->drive(h, in_contact, after) : gravity_;
        return step_.solve(h, along, rule, after);
    }

    /// Whether a contact bears over a step, without drag in contact, once what approaches has been stopped at standing time: a touch that is over at once, because the turning of
    /// the block lifts the corner off again, would take a share by drag that is the step's, not the law's.
    bool bears(double h, const State& before) {
        const double least = kBearsShare * settings_.gravity * h;  // [m/s]
        State s = before;
        bool approaches = false;
        for (std::size_t c = 0; c < closed_.size(); ++c)
            approaches = approaches || step_.normal_velocity(c, s) < -least;
        if (approaches) step_.stop_approach(s);
        const Vec along = effects_->drive(h, {}, s);
        step_.solve(h, along, RestitutionRule{}, s);
        return pressed(least * body_.mass);
    }

    /// A contact has acted in the step that was solved last. If none has, the block flew although contacts were closed: after a bounce, or as a corner
    /// leaves the ground by the turning of the block.
    bool pressed(double impulse = 0.0) const {
        for (std::size_t c = 0; c < closed_.size(); ++c)
            if (step_.normal_impulse(c) > impulse) return true;
        return false;
    }

    /// Pose after a step of length h with the mean of the velocities at both ends.
    static void move(const State& before, double h, State& after) {
        after.position = before.position + 0.5 * h * (before.velocity + after.velocity);
        after.orientation = turned(before.orientation, Spin(0.5 * h * (before.spin + after.spin)));
    }

    void count(const ContactSolverReport& report) {
        ++end_.counters.contact_problems;
        if (report.status != SolverStatus::NotConverged) return;
        ++end_.counters.unconverged_problems;
        if (static_cast<int>(end_.hard_problems.size()) < settings_.kept_problems)
            end_.hard_problems.push_back(step_.problem());
    }

    // ---- rest -----------------------------------------------------------------------------------------------------------------

    /// A block rests when it hardly moves and when, from rest, its weight would not move it; and this for the rest time. Turning about the normal of the
    /// contact that carries most of the weight is no motion in either sense: the law does not resist it, and it is held fast where equilibrium is asked for.
    /// (Left free it swings the block about that contact, which then holds on ground that is too steep for its friction.)
    ///
    /// A top that stands on one vertex precesses and nothing in the law slows it: a block whose centre of mass has stayed in place for long rests too.
    void look_for_rest(double h) {
        if (rest_.in_place_for_long(state_, finder_.radius(), settings_.gravity, time_)) {
            ++end_.counters.rested_turning;
            finish(StopReason::AtRest);
        }
        const double most = settings_.rest_head * body_.mass * settings_.gravity;
        const bool still = rest_.hardly_moves(body_, closed_, state_, most) && in_equilibrium();
        if (rest_.still_for_long(still, h, settings_.rest_time)) finish(StopReason::AtRest);
    }

    bool in_equilibrium() {
        State s = state_;
        s.velocity.setZero();
        s.spin.setZero();
        step_.set_contacts(closed_, rotation_of(state_));
        if (effects_) change_laws(s);
        count(step_.solve(settings_.time_step, gravity_, RestitutionRule{}, s));
        std::size_t main = 0;
        for (std::size_t c = 1; c < closed_.size(); ++c)
            if (step_.normal_impulse(c) > step_.normal_impulse(main)) main = c;
        const double most = kEquilibriumShare * settings_.gravity * settings_.time_step;
        if (Dim == 2 || fastest_point(s) <= most) return fastest_point(s) <= most;
        s.velocity.setZero();
        s.spin.setZero();
        step_.hold_turning(closed_[main].normal);
        count(step_.solve(settings_.time_step, gravity_, RestitutionRule{}, s));
        return fastest_point(s) <= most;
    }

    // ---- the path, piece by piece ---------------------------------------------------------------------------------------------

    MotionSegment<Dim> begin_segment(bool in_contact) const {
        MotionSegment<Dim> m;
        m.start = time_;
        m.mass = body_.mass;
        m.position = state_.position;
        m.velocity_start = state_.velocity;
        m.spin_start = m.spin_most = state_.spin.norm();
        m.turning = state_.spin;
        m.rotation_energy_start = rotation_energy(body_, state_.spin);
        m.in_contact = in_contact;
        return m;
    }

    /// The motion ends where the block is now; on its way effects may have something that it meets. What that takes from it is taken at the end, which is just behind.
    /// A net that holds the block does so on its uphill side: the motion ends there, and nothing beyond the line has seen it.
    /// `goes_on`: the flight continues as it was foreseen.
    void end_motion(MotionSegment<Dim>& motion, double duration, bool goes_on) {
        if (effects_ && !goes_on) effects_->forget_flight();
        if (!effects_ || duration <= 0.0) return end_segment(motion, duration);
        State behind = state_;
        effects_->moved(motion.position, duration, motion.in_contact, kinetic_energy(body_, state_), behind);
        if (effects_->held()) {
            const auto way = (state_.position - motion.position).template head<Dim - 1>().norm();
            const double back = way > 0.0 ? std::min(1.0, (effects_->beyond_net() + kBeforeNet) / way) * duration : 0.0;
            const Vec acceleration = (state_.velocity - motion.velocity_start) / duration;
            state_.position += back * (0.5 * back * acceleration - state_.velocity);
            state_.velocity -= back * acceleration;
            duration -= back;
        }
        end_segment(motion, duration);
        state_.velocity = behind.velocity;
        state_.spin = behind.spin;
        if (effects_->held()) finish(StopReason::AtRest);
    }

    void end_segment(MotionSegment<Dim>& m, double duration) {
        time_ += duration;
        if (!sink_ || duration <= 0.0) return;
        m.duration = duration;
        m.velocity_end = state_.velocity;
        m.spin_end = state_.spin.norm();
        m.spin_most = std::max(m.spin_most, m.spin_end);
        m.rotation_energy_end = rotation_energy(body_, state_.spin);
        sink_->segment(m);
    }

    static constexpr double kBearsShare =
        1e-3;  ///< share of the weight that a contact carries at least if it bears: less is the solver's tolerance [-]
    static constexpr double kEquilibriumShare =
        1e-3;  ///< acceleration from rest, as a share of gravity, that counts as none [-]
    static constexpr double kBeforeNet = 1e-3;  ///< a block that a net holds ends so far uphill of its line [m]
    static constexpr double kMostTurns = 5e7;   ///< beyond steps of full length: more, and something is wrong [-]

    BodyInertia<Dim> body_;
    Contacts& finder_;
    std::span<const Soil> soils_;
    DynamicsSettings settings_;
    MotionSink<Dim>* sink_;
    BlockEffects<Dim>* effects_;  ///< null: none
    ContactStep<Dim> step_;
    Vec gravity_;
    State state_;
    typename Space<Dim>::Orientation turned_to_ = Space<Dim>::identity();  ///< of rotation_
    typename Space<Dim>::Rotation rotation_ = Space<Dim>::Rotation::Identity();
    double time_ = 0.0;
    RestWatch<Dim> rest_;
    std::int64_t turns_ = 0;
    bool finished_ = false;
    std::vector<Contact<Dim>> closed_;
    TrajectoryEnd<Dim> end_;
};

}  // namespace scree
