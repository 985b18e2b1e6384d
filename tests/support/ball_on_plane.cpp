// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/ball_on_plane.hpp"

#include "dynamics/engine.hpp"

namespace scree::test {

template <int Dim>
TrajectoryEnd<Dim> run_on_plane(const BodyInertia<Dim>& body, const BallOnPlane<Dim>& contacts,
                                std::span<const Soil> soils, const DynamicsSettings& settings,
                                const BlockState<Dim>& release, MotionSink<Dim>* sink, BlockEffects<Dim>* effects,
                                double from) {
    return run_block(body, contacts, soils, settings, sink, effects, release, from);
}

template TrajectoryEnd<2> run_on_plane<2>(const BodyInertia<2>&, const BallOnPlane<2>&, std::span<const Soil>,
                                          const DynamicsSettings&, const BlockState<2>&, MotionSink<2>*,
                                          BlockEffects<2>*, double);
template TrajectoryEnd<3> run_on_plane<3>(const BodyInertia<3>&, const BallOnPlane<3>&, std::span<const Soil>,
                                          const DynamicsSettings&, const BlockState<3>&, MotionSink<3>*,
                                          BlockEffects<3>*, double);

}  // namespace scree::test
