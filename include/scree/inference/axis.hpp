// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <vector>

namespace scree {

/// Where a point lies along the slope and beside it, in plan view.
struct AxisPlace {
    double along = 0.0;    ///< chainage: distance along the axis from its first point, negative behind it [m]
    double lateral = 0.0;  ///< distance from the axis, positive to the left as one looks along it [m]
};

/// The line along which runout is counted: a main direction, a guiding line or a profile. Its first and last reach go on for ever, so that
/// every point has a chainage. A point belongs to the reach that it is nearest to; inside a bend that makes chainages jump, so draw axes smooth.
class Axis {
public:
    /// Eastwards from the origin.
    Axis() : Axis(std::vector<Vec2>{Vec2::Zero(), Vec2::UnitX()}) {}
    /// From `origin` in the direction `azimuth`, clockwise from north [rad].
    Axis(const Vec2& origin, double azimuth);
    /// Along a line of at least two different points [m].
    explicit Axis(std::vector<Vec2> line);

    AxisPlace place(const Vec2& p) const;
    /// Point of the axis at a chainage.
    Vec2 point(double along) const;
    /// Smallest chainage at which a line crosses the axis; NaN if it does not [m].
    double crossing(const std::vector<Vec2>& line) const;
    const std::vector<Vec2>& line() const { return line_; }

private:
    std::vector<Vec2> line_;      ///< [m]
    std::vector<double> starts_;  ///< chainage of each point [m]
};

}  // namespace scree
