// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/ensemble/release.hpp"

namespace scree {

/// Least distance between a released block and the ground [m].
inline constexpr double kReleaseGap = 1e-3;

/// The first of kDepartures turns in which a block needs no lift, or the one that needs least; raised by that.
template <int Dim, class Turn, class Lift>
BlockState<Dim> turned_free(BlockState<Dim> state, Turn turn, Lift lift_of, double& raised) {
    BlockState<Dim> best;
    raised = kInfinity;
    for (int draw = 0; draw < kDepartures && raised > 0.0; ++draw) {
        state.orientation = turn();
        const double lift = lift_of(state);
        if (!(lift < raised)) continue;
        raised = lift;
        best = state;
    }
    best.position[Dim - 1] += raised;
    return best;
}

}  // namespace scree
