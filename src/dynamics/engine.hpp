// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/event_stepping.hpp"
#include "dynamics/moreau_jean_stepping.hpp"

namespace scree {

/// The motion of one block from release to its end, written once for both dimensions. `time` [s] has gone by since the release: for the piece of a block
/// that broke. Ends early, with no reason yet, where the block breaks.
template <int Dim, class Contacts>
TrajectoryEnd<Dim> run_block(const BodyInertia<Dim>& body, Contacts& contacts, std::span<const Soil> soils,
                             const DynamicsSettings& settings, MotionSink<Dim>* sink, BlockEffects<Dim>* effects,
                             const BlockState<Dim>& release, double time) {
    if (settings.mode == SteppingMode::Event)
        return EventStepping<Dim, Contacts>(body, contacts, soils, settings, sink, effects).run(release, time);
    return MoreauJeanStepping<Dim, Contacts>(body, contacts, soils, settings, sink, effects).run(release, time);
}

}  // namespace scree
