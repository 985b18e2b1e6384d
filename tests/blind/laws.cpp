// SPDX-License-Identifier: GPL-3.0-or-later
// The generator's own formulas, taken by the truth runs through scree/own_law.h. None of them is a formula of Scree's catalogue; number[0] chooses,
// number[1] is the strength (0: no effect), number[2] and [3] are the ends of a reach [m] where one is meant.
#include "scree/own_law.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

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
    kFadingDrag,            // drag that is strongest at 2 m/s and fades with speed
    kFrictionOfMass,        // mu falls with mass: loads crush the asperities, and large faces are smoother
    kShearing,      // mu falls with the normal speed of impact: loaded hard, the soil shears off beneath the block
    kGrazing,       // e is larger the more an impact grazes, as in back-analyses of impact angles
    kStones,        // e is large on half of all metres, by chance, and small on the others: stones lie in the soil
    kGentleGround,  // mu_r grows where the ground is gentle: debris and soil gather there
    kCoarsening,    // mu_r grows downslope all the way: talus coarsens from the crest to the foot
    kBulldozing,    // drag of what slides: it pushes a wedge of soil; what rolls rides over it
    kHollows        // mu_r is large on three of twenty reaches of 2 m: hollows between boulders catch what rolls
};

double speed_of(const scree_contact_state* s) {
    return std::sqrt(s->velocity[0] * s->velocity[0] + s->velocity[1] * s->velocity[1] +
                     s->velocity[2] * s->velocity[2]);
}

/// Chance of the ground, the same for all blocks: even in [0, 1) for each cell of this width [m].
double chance_of_place(const scree_contact_state* s, double width) {
    auto x = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(s->position[0] / width)));
    x += 0x9e3779b97f4a7c15u;  // splitmix64
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-53;
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
        case kFrictionOfMass:
            law->friction *= std::pow(std::max(s->mass, 100.0) / 100.0, -a);
            break;
        case kShearing:
            law->friction /= 1.0 + a * s->approach / 2.0;
            break;
        case kGrazing: {
            const double sine = std::min(1.0, s->approach / std::max(v, 1e-6));  // of the angle to the ground
            law->restitution = std::min(std::max(0.9, law->restitution), law->restitution * (1.0 + a * (1.0 - sine)));
            break;
        }
        case kStones:
            if (chance_of_place(s, 1.0) < 0.5)
                law->restitution += a * (0.9 - law->restitution);
            else
                law->restitution *= 1.0 - a;
            break;
        case kGentleGround:  // no change at 35 degrees and above
            law->rolling *= 1.0 + a * std::max(0.0, s->normal[2] - 0.819) / (1.0 - 0.819);
            break;
        case kCoarsening:
            law->rolling *= std::exp(a * (s->position[0] / 50.0 - 1.0));
            break;
        case kHollows:
            if (chance_of_place(s, 2.0) < 0.15) law->rolling += 0.1 * a;
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
        case kBulldozing:
            drag->linear = a * std::max(0.0, 1.0 - 0.5 * s->length * s->spin / std::max(v, 1e-6));
            break;
        default:
            break;
    }
}
