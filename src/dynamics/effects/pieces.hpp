// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/effects/block_effects.hpp"

#include "scree/dynamics/trajectory.hpp"

#include <iterator>

namespace scree {

/// Follows a block that may break, as its largest piece: `run(factor, state, time)` follows one piece to its end or to where it breaks; `factor` scales the
/// lengths of the piece before it, 1 for the whole block.
template <int Dim, class Run>
TrajectoryEnd<Dim> follow_pieces(BlockEffects<Dim>& effects, const BlockState<Dim>& release, const Run& run) {
    TrajectoryEnd<Dim> end = run(1.0, release, 0.0);
    if (effects.broken()) end.broke_at = end.state.position;
    while (effects.broken()) {
        const double factor = effects.take_piece();
        TrajectoryEnd<Dim> next = run(factor, end.state, end.time);
        next.energy_start = end.energy_start;
        next.broke_at = end.broke_at;
        next.counters.merge(end.counters);
        next.hard_problems.insert(next.hard_problems.begin(), std::make_move_iterator(end.hard_problems.begin()),
                                  std::make_move_iterator(end.hard_problems.end()));
        end = std::move(next);
    }
    end.counters.breaks = effects.breaks();
    end.counters.crossings_struck = effects.crossings_struck();
    return end;
}

}  // namespace scree
