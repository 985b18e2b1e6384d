// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/contact_lengths.hpp"
#include "dynamics/contact_step.hpp"
#include "dynamics/effects/block_effects.hpp"
#include "dynamics/rest_watch.hpp"
#include "dynamics/rigid_motion.hpp"

#include "scree/base/assert.hpp"
#include "scree/dynamics/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace scree {

/// The motion of one block from release to its end, written once for both dimensions.
///
/// `Contacts` finds what touches. It offers
///     detect(position, rotation, reach, contacts)   all contacts with gap <= reach
///     free_time(state, spin bound, gravity, drag, gap)   how long nothing can touch in flight
///     over_terrain(position), buried(position), beyond_rim(), radius(), inner_radius()
///
/// Event mode, each turn of the loop:
///   no contact closed   fly: exact parabola and torque-free rotation up to the moment when a gap closes;
///   fast approach       impact: impulses at standing time, restitution applies;
///   else                one step in contact, cut short where another contact closes.
template <int Dim, class Contacts>
class Engine {
public:
    using Vec = typename Space<Dim>::Vec;
    using Spin = typename Space<Dim>::Spin;
    using State = BlockState<Dim>;

    Engine(const BodyInertia<Dim>& body, Contacts& contacts, std::span<const Soil> soils,
           const DynamicsSettings& settings, MotionSink<Dim>* sink, BlockEffects<Dim>* effects = nullptr)
        : body_(body),
          finder_(contacts),
          soils_(soils),
          settings_(settings),
          sink_(sink),
          effects_(effects),
          step_(body, soils, settings.solver) {
        gravity_ = acceleration_ = -settings.gravity * Vec::Unit(Dim - 1);
    }

    /// `time` [s] has gone by since the release: for the piece of a block that broke. Ends early, with no reason yet, where the block breaks.
    TrajectoryEnd<Dim> run(const State& release, double time = 0.0) {
        state_ = release;
        time_ = time;
        end_.energy_start = energy(state_);
        if (!finder_.over_terrain(state_.position)) {
            finish(StopReason::LeftTerrain);
        } else if (settings_.mode == SteppingMode::Event) {
            run_events();
        } else {
            run_moreau_jean();
        }
        end_.time = time_;
        end_.mass = body_.mass;
        end_.state = state_;
        end_.energy_end = energy(state_);
        return end_;
    }

private:
    // ---- event mode ----------------------------------------------------------------------------------------------------------

    void run_events() {
        finder_.detect(state_.position, rotation_of(state_), settings_.activation_gap, closed_);
        while (!finished_) {
            if (closed_.empty()) {
                fly();
            } else if (!impact()) {
                step_in_contact();
            }
            check();
        }
    }

    /// Free flight until a gap closes, the terrain ends or time is up: by steps in which nothing can touch, which shrink to nothing as a gap closes.
    void fly() {
        State now = state_, before = state_;
        double flown = 0.0, last = 0.0;
        MotionSegment<Dim> motion = begin_segment(false);
        motion.free_moment = body_.moment;
        const double arc = begin_arc();
        const double spin_bound = std::sqrt(2.0 * rotation_energy(body_, now.spin) / body_.moment.minCoeff());
        while (!finished_) {
            double gap = 0.0;
            double dt = finder_.free_time(now, spin_bound, settings_.gravity, drag_, gap);
            ++end_.counters.flight_evaluations;
            if (finder_.beyond_rim()) {
                finish(StopReason::LeftTerrain);
                break;
            }
            if (gap < -settings_.activation_gap && last > kShortestFlight) {  // something that was not in sight
                flown -= last;
                last = closing_time(before, now, last);
                now = flown_state(before, last);
                flown += last;
                gap = 0.0;
            }
            if (gap <= kTouch || dt <= kShortestFlight) {
                find_contacts(now);
                close_contacts(settings_.activation_gap);
                if (!closed_.empty()) break;
            }
            if (flown >= arc) break;  // the flight goes on, with another acceleration
            const double left = settings_.time_limit - time_ - flown;
            dt = std::min({std::max(dt, kShortestFlight), left, arc - flown});
            State next = flown_state(now, dt);
            if (!finder_.over_terrain(next.position)) {
                dt = rim_time(now, dt);
                next = flown_state(now, dt);
                finish(StopReason::LeftTerrain);
            }
            before = now;
            last = dt;
            now = next;
            flown += dt;
            motion.spin_most = std::max(motion.spin_most, now.spin.norm());
            if (dt >= left || time_ + flown >= settings_.time_limit)  // the sum may round to less
                finish(StopReason::TimeLimit);
        }
        state_ = now;
        end_motion(motion, flown, flown >= arc && closed_.empty());
    }

    /// How long the acceleration of the flight from here is constant [s].
    double begin_arc() {
        if (!effects_) return kInfinity;
        const FlightArc<Dim> arc = effects_->flight_arc(state_);
        acceleration_ = arc.acceleration;
        drag_ = acceleration_ - gravity_;
        return arc.duration;
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

    /// A step begins where the look at the end of the one before has been: sines and cosines are kept.
    const typename Space<Dim>::Rotation& rotation_of(const State& s) {
        if (!same(s.orientation, turned_to_)) {
            turned_to_ = s.orientation;
            rotation_ = rotation_matrix(s.orientation);
        }
        return rotation_;
    }

    double fastest_point(const State& s) const { return s.velocity.norm() + s.spin.norm() * finder_.radius(); }

    State flown_state(const State& s, double dt) const {
        State next = s;
        next.position = s.position + dt * s.velocity + 0.5 * dt * dt * acceleration_;
        next.velocity = s.velocity + dt * acceleration_;
        rotate_freely(body_.moment, settings_.flight_step, dt, next.orientation, next.spin);
        return next;
    }

    /// found_ becomes all contacts up to the release gap.
    void find_contacts(const State& s) { finder_.detect(s.position, rotation_of(s), settings_.release_gap, found_); }

    /// When, between `before` and `after` (overlapping, dt later), the first gap closes. If the block overlaps already at the start, a short while later.
    double closing_time(const State& before, const State& after, double dt) {
        double low = 0.0, high = dt;
        double gap_low = wide_gap(before, dt), gap_high = wide_gap(after, dt);
        if (gap_low <= 0.0) return std::max(dt / 16.0, kShortestFlight);
        for (int k = 0; k < 40 && high - low > kShortestFlight; ++k) {
            // secant, every third time halving: the gap is continuous but for terrain that comes into reach
            const double t = k % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * gap_low / (gap_low - gap_high);
            const double gap = wide_gap(flown_state(before, t), dt);
            if (std::abs(gap) <= kTouch) return t;
            (gap > 0.0 ? low : high) = t;
            (gap > 0.0 ? gap_low : gap_high) = gap;
        }
        return high;
    }

    /// Smallest gap, looking as far as the block can move in dt.
    double wide_gap(const State& s, double dt) {
        double smallest = 1e-3 + 2.0 * dt * fastest_point(s);
        finder_.detect(s.position, rotation_of(s), smallest, found_);
        for (const auto& c : found_) smallest = std::min(smallest, c.gap);
        return smallest;
    }

    /// When the centre of mass leaves the terrain within the interval, by bisection.
    double rim_time(const State& s, double dt) {
        double low = 0.0, high = dt;
        for (int k = 0; k < 30; ++k) {
            const double mid = 0.5 * (low + high);
            (finder_.over_terrain(flown_state(s, mid).position) ? low : high) = mid;
        }
        return high;
    }

    /// found_ becomes closed_, with the gaps up to `gap` for new contacts and up to the release gap for those that were closed before.
    void close_contacts(double gap) {
        previous_.swap(closed_);
        closed_.clear();
        for (const auto& c : found_) {
            const bool was_closed = std::any_of(previous_.begin(), previous_.end(),
                                                [&](const Contact<Dim>& p) { return same_pair(p.key, c.key); });
            if (c.gap <= (was_closed ? settings_.release_gap : gap)) closed_.push_back(c);
        }
    }

    /// Impulses at standing time if a closed contact approaches fast. Newton's law with friction can create energy (Kane's paradox), and where contacts
    /// face each other, as in a narrow gully, it may have no solution: the restitution of the impact is then lowered to the largest share of e, within
    /// 1/64, with which neither happens.
    bool impact() {
        step_.set_contacts(closed_, rotation_of(state_));
        bool fast = false;
        for (std::size_t c = 0; c < closed_.size(); ++c)
            fast = fast || step_.normal_velocity(c, state_) < -settings_.impact_speed;
        if (!fast) return false;
        ++end_.counters.impacts;
        const State before = state_;
        if (effects_) prepare_impact();
        // what the solver may leave is not Kane's paradox: cap_energy takes it back
        const double most = kinetic_energy(body_, before) * (1.0 + kEnergyPerResidual * settings_.solver.tolerance);
        ContactSolverReport report;
        auto possible_with = [&](double share) {
            state_ = before;
            report = step_.solve(0.0, Vec::Zero(), {share, settings_.restitution_threshold}, state_);
            // whoever asks for more digits than doubles have must not lose the bounce
            const bool solved = report.status == SolverStatus::Converged || report.residual <= kSolved;
            return solved && kinetic_energy(body_, state_) <= most;
        };
        if (!possible_with(1.0)) {
            ++end_.counters.restitution_capped;
            double low = 0.0, high = 1.0;
            for (int k = 0; k < 6; ++k) {
                const double middle = 0.5 * (low + high);
                (possible_with(middle) ? low : high) = middle;
            }
            possible_with(low);
        }
        count(report);
        cap_energy(energy(before));
        if (++impacts_in_a_row_ > kImpactsInARow) finish(StopReason::Failed);
        if (effects_) {
            effects_->struck(state_, closed_, approach_);
            if (effects_->broken()) finished_ = true;  // whoever follows the block goes on with its largest piece
        }
        return true;
    }

    /// Effects at an impact: the normals, turned once in an instant, and the law that the contacts follow.
    void prepare_impact() {
        approach_.clear();
        for (std::size_t c = 0; c < closed_.size(); ++c)
            approach_.push_back(std::max(0.0, -step_.normal_velocity(c, state_)));
        if (time_ > last_impact_) {
            struck_ = closed_;
            if (effects_->tilt(state_, struck_)) step_.set_contacts(struck_, rotation_of(state_));
        }
        last_impact_ = time_;
        change_laws(state_);
    }

    /// e, mu, mu_r of the contacts at hand as effects change them.
    void change_laws(const State& s) {
        const auto contacts = step_.contacts();
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            const ContactLaw law =
                effects_->law(contacts[c], s, std::max(0.0, -step_.normal_velocity(c, s)), soils_[contacts[c].soil]);
            if (std::isfinite(law.restitution) && std::isfinite(law.friction) && std::isfinite(law.rolling))
                step_.set_law(c, law.restitution, law.friction, law.rolling);
            else
                finish(StopReason::Failed);  // a law of the user
        }
    }

    /// One step with the closed contacts, not beyond the moment when another contact closes.
    void step_in_contact() {
        impacts_in_a_row_ = 0;
        const State before = state_;
        const double energy_before = energy(before);
        double h = std::min({settings_.time_step, std::max(settings_.time_limit - time_, 1e-9),
                             kMoveInContact * finder_.inner_radius() / std::max(fastest_point(before), 1e-9)});
        if (effects_) change_laws(before);  // of the contacts that the look for an impact has set
        State after = moved(before, h);
        // a crest that leaves the side of a fast block within the step: the look ahead holds a contact that is no more, which shows as energy from nowhere
        while (energy(after) - energy_before > kMuchRise * body_.mass * settings_.gravity && h > kShortestShortened) {
            ++end_.counters.shortened_steps;
            h = std::max(0.5 * h, kShortestShortened);
            after = moved(before, h);
        }
        if (!is_finite(after)) return finish(StopReason::Failed);  // before anything looks for contacts there
        const double closes = first_overlap(before, after, h);
        if (closes <= h) {
            ++end_.counters.shortened_steps;
            h = shortened(before, after, h, closes);
            after = moved(before, h);
            new_overlap(after);
        }
        ++end_.counters.contact_steps;
        MotionSegment<Dim> motion = begin_segment(pressed());
        state_ = after;
        close_contacts(settings_.activation_gap);
        double depth = 0.0;
        for (const auto& c : closed_) depth = std::max(depth, -c.gap);
        end_.counters.add_penetration(depth);
        if (depth > kPenetrationSlop) {
            push_out(energy_before);
            motion.in_contact = true;
        }
        cap_energy(energy_before);
        end_motion(motion, h, false);
        if (!finder_.over_terrain(state_.position) || finder_.beyond_rim()) finish(StopReason::LeftTerrain);
        if (time_ >= settings_.time_limit) finish(StopReason::TimeLimit);
        if (!finished_) look_for_rest(h);
    }

    /// A contact has acted in the step that was solved last. If none has, the block flew although contacts were closed: after a bounce, or as a corner
    /// leaves the ground by the turning of the block.
    bool pressed(double impulse = 0.0) const {
        for (std::size_t c = 0; c < closed_.size(); ++c)
            if (step_.normal_impulse(c) > impulse) return true;
        return false;
    }

    /// Solves for the velocities over h and moves with the mean velocity (theta = 1/2).
    State moved(const State& before, double h) {
        State after = before;
        step_.look_ahead(before, h);
        count(driven(h, RestitutionRule{}, before, after));
        move(before, h, after);
        return after;
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

    /// Pose after a step of length h with the mean of the velocities at both ends.
    static void move(const State& before, double h, State& after) {
        after.position = before.position + 0.5 * h * (before.velocity + after.velocity);
        after.orientation = turned(before.orientation, Spin(0.5 * h * (before.spin + after.spin)));
    }

    /// Deepest overlap of contacts that were not closed during the step; found_ holds all contacts of the pose.
    double new_overlap(const State& s) {
        find_contacts(s);
        double deepest = 0.0;
        for (const auto& c : found_) {
            if (-c.gap > deepest && !was_held(c)) deepest = -c.gap;
        }
        return deepest;
    }

    /// Held: closed in this step at the same place, and either with the same normal or hardly deeper than before. A vertex that has slid onto a facet
    /// that rises is a new contact; one that changes over to the next facet, or an edge to the next crest at a node, with the overlap it had, is not.
    bool was_held(const Contact<Dim>& c) const {
        const double near = kSamePlace * finder_.radius();
        return std::any_of(closed_.begin(), closed_.end(), [&](const Contact<Dim>& p) {
            const bool same_normal = p.normal.dot(c.normal) > 1.0 - kSameNormal;
            if (same_pair(p.key, c.key)) return same_normal || c.gap >= p.gap - settings_.activation_gap;
            return (p.arm - c.arm).squaredNorm() <= near * near && c.gap >= p.gap - settings_.activation_gap;
        });
    }

    /// When a new contact is first seen to overlap on the way to `after`, infinite if none. The end alone is looked at, unless the block moves far: a
    /// thin corner could be through a crest by then. found_ holds all contacts of the last pose looked at.
    double first_overlap(const State& before, const State& after, double h) {
        const double unseen = kMoveUnseen * finder_.inner_radius() / std::max(fastest_point(before), 1e-9);
        const int looks = std::max(1, static_cast<int>(std::ceil(h / unseen)));
        for (int k = 1; k <= looks; ++k) {
            const double t = k == looks ? h : h * k / looks;  // not by rounding beyond the step: it would not be cut
            if (new_overlap(k == looks ? after : on_the_way(before, after, h, t)) > settings_.activation_gap) return t;
        }
        return kInfinity;
    }

    /// Pose at time t of a step of length h.
    State on_the_way(const State& before, const State& after, double h, double t) const {
        State s = before;
        s.position = before.position + t / h * (after.position - before.position);
        s.orientation = turned(before.orientation, Spin(0.5 * t * (before.spin + after.spin)));
        return s;
    }

    /// Length of the step until the first new contact closes, on the path of the full step, given a time at which it overlaps; not below a sixteenth of
    /// the step or 0.25 ms, whichever is less: what approaches at 3 m/s goes in by less than a millimetre.
    double shortened(const State& before, const State& after, double h, double closes) {
        const double shortest = std::min(h / 16.0, kShortestShortened);
        double low = 0.0, high = closes;
        for (int k = 0; k < 12 && high - low > shortest; ++k) {
            const double t = 0.5 * (low + high);
            const double overlap = new_overlap(on_the_way(before, after, h, t));
            if (overlap > 0.0 && overlap <= settings_.activation_gap) return std::max(t, shortest);
            (overlap > 0.0 ? high : low) = t;
        }
        return std::max(high, shortest);
    }

    /// Translates the block out of the ground along the contact normals, no farther than kinetic energy can pay for: cap_energy takes it back.
    void push_out(double energy_before) {
        const Vec start = state_.position;
        Vec shift = Vec::Zero();
        for (int sweep = 0; sweep < 4; ++sweep) {
            for (const auto& c : closed_) shift += std::max(0.0, -c.gap - c.normal.dot(shift)) * c.normal;
        }
        const double lift = shift[Dim - 1];
        const double budget =
            (energy_before - energy(state_) + kinetic_energy(body_, state_)) / (body_.mass * settings_.gravity);
        if (lift > budget) shift *= std::max(budget, 0.0) / lift;
        state_.position = start + shift;
        for (auto& c : closed_) {
            c.gap += c.normal.dot(shift);
            c.arm -= shift;
        }
    }

    /// No step may end with more energy than it began with, but for the tolerance of the solver: a larger rise is taken from the velocities.
    void cap_energy(double energy_before) {
        const double weight = body_.mass * settings_.gravity;
        double rise = energy(state_) - energy_before;
        if (rise > kAllowedRise * weight) {
            ++end_.counters.energy_capped;
            end_.counters.largest_rise_taken_back = std::max(end_.counters.largest_rise_taken_back, rise / weight);
            const double kinetic = kinetic_energy(body_, state_);
            const double factor = kinetic > rise ? std::sqrt((kinetic - rise) / kinetic) : 0.0;
            state_.velocity *= factor;
            state_.spin *= factor;
            if (kinetic < rise) state_.position[Dim - 1] -= (rise - kinetic) / weight;  // micrometres
            rise = energy(state_) - energy_before;
        }
        end_.counters.largest_energy_rise = std::max(end_.counters.largest_energy_rise, rise / weight);
    }

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

    // ---- Moreau-Jean mode (B&A section 3.1.1) ---------------------------------------------------------------------------------

    void run_moreau_jean() {
        const double h = settings_.time_step;
        while (!finished_) {
            const bool in_contact = forecast_contacts(state_, h);
            if (!in_contact && free_for(2.0 * h)) {
                fly_in_steps(h);
                check();
                continue;
            }
            const State before = state_;
            const double energy_before = energy(before);
            MotionSegment<Dim> motion = begin_segment(false);
            step_.set_contacts(closed_, rotation_of(predicted_));
            if (effects_) change_laws(before);
            State after = before;
            const ContactSolverReport report = driven(h, RestitutionRule{1.0, 0.0}, before, after);
            if (in_contact) count(report);
            motion.in_contact = motion.struck = in_contact && pressed();
            move(before, h, after);
            if (!is_finite(after)) return finish(StopReason::Failed);
            state_ = after;
            if (!closed_.empty()) {
                ++end_.counters.contact_steps;
                double depth = 0.0;
                for (const auto& c : closed_) depth = std::max(depth, -c.gap);
                end_.counters.add_penetration(depth);
            }
            const double rise = (energy(state_) - energy_before) / (body_.mass * settings_.gravity);
            end_.counters.largest_energy_rise = std::max(end_.counters.largest_energy_rise, rise);
            end_motion(motion, h, false);
            if (!finder_.over_terrain(state_.position) || finder_.beyond_rim()) finish(StopReason::LeftTerrain);
            if (time_ >= settings_.time_limit) finish(StopReason::TimeLimit);
            if (!finished_ && !closed_.empty()) look_for_rest(h);
            check();
        }
    }

    /// True if surely nothing closes for so long.
    bool free_for(double duration) const { return time_ + duration <= free_until_; }

    /// Steps of the scheme as long as surely nothing closes. Their mean velocities make a parabola: one segment.
    void fly_in_steps(double h) {
        MotionSegment<Dim> motion = begin_segment(false);
        motion.free_moment = body_.moment;
        do {
            const State before = state_;
            const double energy_before = energy(before);
            state_.velocity += h * gravity_;
            state_.spin = free_spin(body_.moment, before.spin, spin_response(body_.moment, before.spin, h), h);
            move(before, h, state_);
            time_ += h;
            const double rise = (energy(state_) - energy_before) / (body_.mass * settings_.gravity);
            end_.counters.largest_energy_rise = std::max(end_.counters.largest_energy_rise, rise);
            motion.spin_most = std::max(motion.spin_most, state_.spin.norm());
            if (!finder_.over_terrain(state_.position) || finder_.beyond_rim()) finish(StopReason::LeftTerrain);
            if (time_ >= settings_.time_limit) finish(StopReason::TimeLimit);
        } while (!finished_ && free_for(2.0 * h));
        step_.forget();
        const double flown = time_ - motion.start;
        time_ = motion.start;
        end_segment(motion, flown);
    }

    State predicted(const State& s, double h) const {
        State p = s;
        p.position += h * s.velocity;
        p.orientation = turned(s.orientation, Spin(h * s.spin));
        return p;
    }

    /// closed_ becomes the contacts whose gap, forecast by half a step with the velocity at the start, is not positive; with the geometry of the
    /// predicted pose, where the scheme takes its operators.
    bool forecast_contacts(const State& s, double h) {
        // in flight a gap forecast by half a step closes less than a step early; drag and crossings change flights as they go
        if (closed_.empty() && !effects_) {
            if (free_for(2.0 * h)) return false;
            const double spin_bound = std::sqrt(2.0 * rotation_energy(body_, s.spin) / body_.moment.minCoeff());
            double gap = 0.0;
            free_until_ = time_ + finder_.free_time(s, spin_bound, settings_.gravity, drag_, gap);
            if (free_for(2.0 * h)) return false;
        }
        closed_.clear();
        const double reach = h * fastest_point(s);
        finder_.detect(s.position, rotation_of(s), reach, previous_);
        if (previous_.empty()) return false;
        step_.set_contacts(previous_, rotation_of(s));
        auto closes = [&](std::size_t c) { return previous_[c].gap + 0.5 * h * step_.normal_velocity(c, s) <= 0.0; };
        std::size_t first = 0;
        while (first < previous_.size() && !closes(first)) ++first;
        if (first == previous_.size()) return false;
        predicted_ = predicted(s, h);
        // what closes is at most half a reach away, and comes no farther off than a reach meanwhile
        finder_.detect(predicted_.position, rotation_of(predicted_), 1.5 * reach + settings_.activation_gap, found_);
        for (std::size_t c = first; c < previous_.size(); ++c) {
            if (!closes(c)) continue;
            // a vertex in a valley touches two facets: the same one first
            const auto& key = previous_[c].key;
            auto same = std::find_if(found_.begin(), found_.end(), [&](const Contact<Dim>& f) { return f.key == key; });
            if (same == found_.end())
                same = std::find_if(found_.begin(), found_.end(),
                                    [&](const Contact<Dim>& f) { return same_pair(f.key, key); });
            closed_.push_back(same != found_.end() ? *same : previous_[c]);
        }
        return true;
    }

    // ---- bookkeeping ----------------------------------------------------------------------------------------------------------

    double energy(const State& s) const {
        return kinetic_energy(body_, s) + body_.mass * settings_.gravity * s.position[Dim - 1];
    }

    void count(const ContactSolverReport& report) {
        ++end_.counters.contact_problems;
        if (report.status != SolverStatus::NotConverged) return;
        ++end_.counters.unconverged_problems;
        if (static_cast<int>(end_.hard_problems.size()) < settings_.kept_problems)
            end_.hard_problems.push_back(step_.problem());
    }

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

    void finish(StopReason reason) {
        if (finished_) return;
        finished_ = true;
        end_.reason = reason;
    }

    static bool is_finite(const State& s) {
        return s.position.allFinite() && s.velocity.allFinite() && s.spin.allFinite();
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
        if (++turns_ > kMostTurns) finish(StopReason::Failed);
    }

    static constexpr double kTouch = 1e-5;                ///< gap at which a flight has landed [m]
    static constexpr double kShortestFlight = 1e-7;       ///< resolution of closing times [s]
    static constexpr double kShortestShortened = 2.5e-4;  ///< steps are not cut shorter than this [s]
    static constexpr double kSolved =
        1e-10;  ///< residual of an impact that is solved, whatever the tolerance asks for [-]
    static constexpr double kEnergyPerResidual =
        4.0;  ///< relative rise of energy in an impact per residual of the solver: velocities err by (1 + e) of it [-]
    static constexpr double kAllowedRise =
        1e-6;  ///< height of fall by which the solver's tolerance may raise the energy of a step [m]
    static constexpr double kMuchRise =
        1e-2;  ///< height of fall by which a step may raise the energy before it is taken again, half as long [m]
    static constexpr double kMoveInContact =
        1.0;  ///< share of half the block's thickness that its points move at most in a step with contact [-]
    static constexpr double kMoveUnseen =
        0.2;  ///< share of half the thickness that they move between two looks in it [-]
    static constexpr double kSameNormal = 1e-6;  ///< 1 - cosine below which two facets hold a vertex alike [-]
    static constexpr double kSamePlace = 0.02;   ///< of the radius: contacts closer than this are at one place [-]
    static constexpr double kBearsShare =
        1e-3;  ///< share of the weight that a contact carries at least if it bears: less is the solver's tolerance [-]
    static constexpr double kEquilibriumShare =
        1e-3;  ///< acceleration from rest, as a share of gravity, that counts as none [-]
    static constexpr double kBeforeNet = 1e-3;   ///< a block that a net holds ends so far uphill of its line [m]
    static constexpr int kImpactsInARow = 1000;  ///< impacts at one moment: beyond, something is wrong
    static constexpr std::int64_t kMostTurns = 50'000'000;

    BodyInertia<Dim> body_;
    Contacts& finder_;
    std::span<const Soil> soils_;
    DynamicsSettings settings_;
    MotionSink<Dim>* sink_;
    BlockEffects<Dim>* effects_;  ///< null: none
    ContactStep<Dim> step_;
    Vec gravity_;
    Vec acceleration_;         ///< of the centre of mass in flight: gravity and drag [m/s^2]
    Vec drag_ = Vec::Zero();   ///< the part of it that is not gravity [m/s^2]
    double last_impact_ = -1;  ///< when the block was struck last [s]
    State state_;
    typename Space<Dim>::Orientation turned_to_ = Space<Dim>::identity();  ///< of rotation_
    typename Space<Dim>::Rotation rotation_ = Space<Dim>::Rotation::Identity();
    double time_ = 0.0;
    RestWatch<Dim> rest_;
    State predicted_;                 ///< at the end of the step, by its first velocities; moreau_jean only
    double free_until_ = -kInfinity;  ///< no contact closes before; moreau_jean only [s]
    int impacts_in_a_row_ = 0;
    std::int64_t turns_ = 0;
    bool finished_ = false;
    std::vector<Contact<Dim>> closed_, previous_, found_, struck_;
    std::vector<double> approach_;  ///< of the contacts of an impact, towards the ground [m/s]
    TrajectoryEnd<Dim> end_;
};

}  // namespace scree
