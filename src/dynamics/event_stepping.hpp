// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/block_motion.hpp"
#include "dynamics/contact_lengths.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace scree {

/// The default stepping, with events. Each turn of the loop:
///   no contact closed   fly: exact parabola and torque-free rotation up to the moment when a gap closes;
///   fast approach       impact: impulses at standing time, restitution applies;
///   else                one step in contact, cut short where another contact closes.
template <int Dim, class Contacts>
class EventStepping : BlockMotion<Dim, Contacts> {
    using Base = BlockMotion<Dim, Contacts>;

public:
    using Base::Base;
    using typename Base::Spin;
    using typename Base::State;
    using typename Base::Vec;

    /// `time` [s] has gone by since the release: for the piece of a block that broke. Ends early, with no reason yet, where the block breaks.
    TrajectoryEnd<Dim> run(const State& release, double time) {
        begin(release, time);
        if (!finished_) finder_.detect(state_.position, rotation_of(state_), settings_.activation_gap, closed_);
        while (!finished_) {
            if (closed_.empty()) {
                fly();
            } else if (!impact()) {
                step_in_contact();
            }
            check();
        }
        return end();
    }

private:
    using Base::begin, Base::end, Base::finish, Base::check, Base::is_finite, Base::rotation_of, Base::fastest_point,
        Base::energy, Base::change_laws, Base::driven, Base::pressed, Base::move, Base::count, Base::look_for_rest,
        Base::begin_segment, Base::end_motion, Base::body_, Base::finder_, Base::settings_, Base::effects_, Base::step_,
        Base::gravity_, Base::state_, Base::time_, Base::finished_, Base::closed_, Base::end_;

    // ---- flight ---------------------------------------------------------------------------------------------------------------

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

    // ---- impact ---------------------------------------------------------------------------------------------------------------

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

    // ---- step in contact ------------------------------------------------------------------------------------------------------

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

    /// Solves for the velocities over h and moves with the mean velocity (theta = 1/2).
    State moved(const State& before, double h) {
        State after = before;
        step_.look_ahead(before, h);
        count(driven(h, RestitutionRule{}, before, after));
        move(before, h, after);
        return after;
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
            if (c.motion == ContactMotion::PassesBlock) c.arm -= shift;  // corners of the block keep their place in it
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
    static constexpr int kImpactsInARow = 1000;  ///< impacts at one moment: beyond, something is wrong

    Vec acceleration_ = gravity_;  ///< of the centre of mass in flight: gravity and drag [m/s^2]
    Vec drag_ = Vec::Zero();       ///< the part of it that is not gravity [m/s^2]
    double last_impact_ = -1;      ///< when the block was struck last [s]
    int impacts_in_a_row_ = 0;
    std::vector<Contact<Dim>> previous_, found_, struck_;
    std::vector<double> approach_;  ///< of the contacts of an impact, towards the ground [m/s]
};

}  // namespace scree
