// SPDX-License-Identifier: GPL-3.0-or-later
// The generator's own formulas, taken by the truth runs through scree/own_law.h. None of them is a formula of Scree's catalogue; number[0] chooses,
// number[1] is the strength (0: no effect), number[2] and [3] are the ends of a reach [m] where one is meant.
#include "scree/own_law.h"

#include <algorithm>
#include <cmath>

namespace {

enum Law {
    // the same family as an effect of the catalogue, another formula
    kDragPower = 1,        // drag that grows as v^1.5
    kDragSize = 2,         // quadratic drag as of a plough: more for light blocks
    kBounceExponential,    // e falls exponentially with the speed of impact
    kBounceMomentum,       // e falls with the momentum of impact
    kRollingSaturates,     // mu_r grows with speed up to a limit
    kRollingLinearInSize,  // mu_r grows linearly with size
    kShrubs,               // linear drag per mass on a reach
    kSoftBorderPatch,      // mu_r rises smoothly to the middle of a reach
    // the catalogue has these families since test-Q; sealed truths of before know them by these numbers
    kFrictionWeakens = 21,  // mu falls with speed
    kBlocksDiffer,          // every block has a rolling resistance of its own
    // outside the catalogue
    kBounceGrows,           // e grows with the speed of impact
    kRollingWeakensBySpin,  // mu_r falls with spin
    kStripes,               // mu in stripes of 8 m
    kFadingDrag             // drag that is strongest at 2 m/s and fades with speed
};

double speed_of(const scree_contact_state* s) {
    return std::sqrt(s->velocity[0] * s->velocity[0] + s->velocity[1] * s->velocity[1] +
                     s->velocity[2] * s->velocity[2]);
}

}  // namespace

extern "C" void scree_contact_law(const scree_contact_state* s, scree_contact_law_values* law) {
    const double a = s->number[1], v = speed_of(s);
    switch (static_cast<int>(s->number[0])) {
        case kBounceExponential:
            law->restitution *= std::exp(-a * s->approach / 10.0);
            break;
        case kBounceMomentum:
            law->restitution /= 1.0 + a * s->mass * s->approach / 1e4;
            break;
        case kRollingSaturates:
            law->rolling *= 1.0 + a * v / (1.0 + v / 8.0);
            break;
        case kRollingLinearInSize:
            law->rolling *= std::max(0.05, 1.0 + a * (s->length / 0.8 - 1.0));
            break;
        case kSoftBorderPatch: {
            const double x = (s->position[0] - s->number[2]) / (s->number[3] - s->number[2]);
            if (x > 0.0 && x < 1.0) law->rolling *= 1.0 + a * std::pow(std::sin(3.14159265358979 * x), 2);
            break;
        }
        case kFrictionWeakens:
            law->friction /= 1.0 + a * v / 5.0;
            break;
        case kBlocksDiffer:
            law->rolling *= std::exp(a * (2.0 * s->draw - 1.0));
            break;
        case kBounceGrows:
            law->restitution = std::min(0.9, law->restitution + a * s->approach / 20.0);
            break;
        case kRollingWeakensBySpin:
            law->rolling /= 1.0 + a * s->spin / 10.0;
            break;
        case kStripes:
            law->friction *= std::max(0.1, 1.0 + a * std::sin(6.28318530717959 * s->position[0] / 8.0));
            break;
        default:
            break;
    }
}

extern "C" void scree_ground_drag(const scree_contact_state* s, scree_ground_drag_values* drag) {
    const double a = s->number[1], v = speed_of(s);
    switch (static_cast<int>(s->number[0])) {
        case kDragPower:
            drag->linear = 0.1 * a * std::sqrt(v);
            break;
        case kDragSize:
            drag->quadratic = 0.02 * a * std::pow(s->mass / 1000.0, -1.0 / 3.0);
            break;
        case kShrubs:
            if (s->position[0] > s->number[2] && s->position[0] < s->number[3]) drag->linear = 300.0 * a / s->mass;
            break;
        case kFadingDrag:
            drag->linear = a / (1.0 + v * v / 4.0);
            break;
        default:
            break;
    }
}
