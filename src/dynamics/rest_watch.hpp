// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/rigid_motion.hpp"

#include "scree/dynamics/contact.hpp"

#include <algorithm>
#include <span>

namespace scree {

/// What of a block's motion tells that it rests, and for how long it has been so.
template <int Dim>
class RestWatch {
public:
    using Vec = typename Space<Dim>::Vec;
    using State = BlockState<Dim>;

    /// Takes the turning about the contact's normal, through the contact point, out of the motion.
    static void remove_turning(const Contact<Dim>& c, State& s) {
        if constexpr (Dim == 3) {
            const Mat3 rotation = rotation_matrix(s.orientation);
            const double about = c.normal.dot(rotation * s.spin);
            s.spin -= about * (rotation.transpose() * c.normal);
            s.velocity -= about * c.normal.cross(Vec3(-c.arm));
        }
    }

    /// Kinetic energy of at most `most` [J], with the turning about any one of the contacts taken out.
    static bool hardly_moves(const BodyInertia<Dim>& body, std::span<const Contact<Dim>> contacts, const State& state,
                             double most) {
        return std::any_of(contacts.begin(), contacts.end(), [&](const Contact<Dim>& c) {
            State s = state;
            remove_turning(c, s);
            return kinetic_energy(body, s) <= most;
        });
    }

    /// True if the centre of mass of a block of this radius [m] has stayed in place for long at this time [s], under this gravity [m/s^2]. Asked after every
    /// step in contact: who has flown since has not stayed, nor has who is fast enough to leave the place before he is seen again.
    bool in_place_for_long(const State& state, double radius, double gravity, double time) {
        const bool flown = time - asked_ > kFlown;
        asked_ = time;
        const double place = std::min(kPlaceShare * radius, kPlace);
        if (flown || state.velocity.squaredNorm() > 2.0 * gravity * place || (state.position - place_).norm() > place) {
            place_ = state.position;
            in_place_since_ = time;
            return false;
        }
        return time - in_place_since_ >= kPlaceTime;
    }

    /// True if the block has been still for the rest time [s], with the h [s] of this step.
    bool still_for_long(bool still, double h, double rest_time) {
        still_ = still ? still_ + h : 0.0;
        return still && still_ >= rest_time;
    }

private:
    static constexpr double kPlaceShare = 0.05;  ///< of the radius: a centre of mass that moves less stays in place [-]
    static constexpr double kPlace = 0.05;       ///< and at most so far: slower creep than 1 cm/s is rest [m]
    static constexpr double kFlown = 0.5;        ///< without contact for so long is a flight and not a tremble [s]
    static constexpr double kPlaceTime = 5.0;    ///< in place for so long is rest, whatever still turns [s]

    Vec place_ = Vec::Constant(kInfinity);  ///< where the centre of mass has stayed of late [m]
    double in_place_since_ = 0.0;           ///< [s]
    double asked_ = 0.0;                    ///< when that was last asked [s]
    double still_ = 0.0;                    ///< time in equilibrium [s]
};

}  // namespace scree
