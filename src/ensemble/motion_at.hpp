// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/trajectory.hpp"

namespace scree {

/// Motion at the share s in [0, 1] of a segment.
template <int Dim>
typename Space<Dim>::Vec position_at(const MotionSegment<Dim>& m, double s) {
    return m.position + s * m.duration * (m.velocity_start + 0.5 * s * (m.velocity_end - m.velocity_start));
}
template <int Dim>
typename Space<Dim>::Vec velocity_at(const MotionSegment<Dim>& m, double s) {
    return m.velocity_start + s * (m.velocity_end - m.velocity_start);
}

}  // namespace scree
