// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/trajectory.hpp"

#include <cstdint>

namespace scree {

/// The impacts of one block as a film of its path shows them: an impact is all that happens between two flights of at least kLeastFlight, whatever
/// bounces and slides are shorter. Pairs of states before and after say more of the contact law than what a screen sees.
template <int Dim>
class ImpactWatch {
public:
    static constexpr double kLeastFlight = 0.1;  ///< [s]

    /// Of the first `most` impacts.
    explicit ImpactWatch(std::int32_t most) : most_(most) {}

    /// Takes the next segment of the motion. Calls report(impact, before, after) once an impact, counted from 0, has ended: with the segment at whose end
    /// it began and with the one that begins where it has ended.
    template <class Report>
    void segment(const MotionSegment<Dim>& m, const Report& report) {
        if (count_ == most_) return;
        const bool goes_on = flying_ && !m.in_contact && continues(m);
        if (flying_ && !goes_on) {
            flying_ = false;
            if (flown_ >= kLeastFlight && !struck_) {
                before_ = last_;
                struck_ = true;
            }
        }
        if (m.in_contact) return;
        if (!flying_) {
            flying_ = true;
            flown_ = 0.0;
            first_ = m;
        }
        flown_ += m.duration;
        last_ = m;
        if (struck_ && flown_ >= kLeastFlight) {
            report(count_++, before_, first_);
            struck_ = false;
        }
    }

private:
    /// A flight that is cut into arcs goes on with the velocity that it had; an impact changes it.
    bool continues(const MotionSegment<Dim>& m) const {
        constexpr double kRounding = 1e-9;  // share of the speed, and of 1 m/s
        return (m.velocity_start - last_.velocity_end).norm() <= kRounding * (1.0 + m.velocity_start.norm());
    }

    std::int32_t most_;
    std::int32_t count_ = 0;  ///< impacts that have ended
    bool flying_ = false;
    bool struck_ = false;              ///< an impact has begun and no flight of the least length has followed
    double flown_ = 0.0;               ///< of the flight at hand [s]
    MotionSegment<Dim> first_, last_;  ///< of the flight at hand
    MotionSegment<Dim> before_;        ///< the last one before the impact at hand
};

}  // namespace scree
