// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/block_motion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace scree {

/// The scheme of the paper (B&A section 3.1.1): fixed steps, contacts whose gap is forecast to close within half a step.
template <int Dim, class Contacts>
class MoreauJeanStepping : BlockMotion<Dim, Contacts> {
    using Base = BlockMotion<Dim, Contacts>;

public:
    using Base::Base;
    using typename Base::Spin;
    using typename Base::State;
    using typename Base::Vec;

    /// `time` [s] has gone by since the release: for the piece of a block that broke.
    TrajectoryEnd<Dim> run(const State& release, double time) {
        begin(release, time);
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
            if (!is_finite(after)) {
                finish(StopReason::Failed);
                break;
            }
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
        return end();
    }

private:
    using Base::begin, Base::end, Base::finish, Base::check, Base::is_finite, Base::rotation_of, Base::fastest_point,
        Base::energy, Base::change_laws, Base::driven, Base::pressed, Base::move, Base::count, Base::look_for_rest,
        Base::begin_segment, Base::end_motion, Base::end_segment, Base::body_, Base::finder_, Base::settings_,
        Base::effects_, Base::step_, Base::gravity_, Base::state_, Base::time_, Base::finished_, Base::closed_,
        Base::end_;

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
            free_until_ = time_ + finder_.free_time(s, spin_bound, settings_.gravity, Vec::Zero(), gap);
            if (free_for(2.0 * h)) return false;
        }
        closed_.clear();
        const double reach = h * fastest_point(s);
        finder_.detect(s.position, rotation_of(s), reach, near_);
        if (near_.empty()) return false;
        step_.set_contacts(near_, rotation_of(s));
        auto closes = [&](std::size_t c) { return near_[c].gap + 0.5 * h * step_.normal_velocity(c, s) <= 0.0; };
        std::size_t first = 0;
        while (first < near_.size() && !closes(first)) ++first;
        if (first == near_.size()) return false;
        predicted_ = predicted(s, h);
        // what closes is at most half a reach away, and comes no farther off than a reach meanwhile
        finder_.detect(predicted_.position, rotation_of(predicted_), 1.5 * reach + settings_.activation_gap, found_);
        for (std::size_t c = first; c < near_.size(); ++c) {
            if (!closes(c)) continue;
            // a vertex in a valley touches two facets: the same one first
            const auto& key = near_[c].key;
            auto same = std::find_if(found_.begin(), found_.end(), [&](const Contact<Dim>& f) { return f.key == key; });
            if (same == found_.end())
                same = std::find_if(found_.begin(), found_.end(),
                                    [&](const Contact<Dim>& f) { return same_pair(f.key, key); });
            closed_.push_back(same != found_.end() ? *same : near_[c]);
        }
        return true;
    }

    State predicted_;                 ///< at the end of the step, by its first velocities
    double free_until_ = -kInfinity;  ///< no contact closes before [s]
    std::vector<Contact<Dim>> near_, found_;
};

}  // namespace scree
