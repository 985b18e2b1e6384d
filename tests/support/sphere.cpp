// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/sphere.hpp"

#include "dynamics/engine.hpp"

namespace scree::test {

TrajectoryEnd<3> SphereMechanics::until(double time, const BlockState<3>& release, MotionSink<3>* sink) const {
    DynamicsSettings limited = settings;
    limited.time_limit = time;
    Engine<3, SphereOnPlane> engine(body, plane, soils, limited, sink);
    return engine.run(release);
}

}  // namespace scree::test
