// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ensemble/motion_at.hpp"

#include "scree/ensemble/campaign.hpp"

#include <deque>
#include <vector>

namespace scree {

/// Speed at a screen as films give it: where the block flies freely from half the span before the screen to half the span behind it, the parabola
/// gives the speed at the screen itself; else it is the mean speed between the two positions (B&A section 2). Lengths count along the path; a path
/// that begins or ends within the span is taken from its start or to its end.
template <int Dim>
class SpanSpeed {
public:
    using Vec = typename Space<Dim>::Vec;

    /// `span` [m]; 0: speeds are those at the screen.
    explicit SpanSpeed(double span) : half_(0.5 * span) {}

    /// Takes a segment of the motion; `fresh` are the crossings inside it, as indices into `crossings`, with their share of the segment.
    struct Fresh {
        std::size_t crossing = 0;
        double share = 0.0;  ///< of the segment's duration [-]
    };
    void segment(const MotionSegment<Dim>& m, const std::vector<Fresh>& fresh, std::vector<ScreenCrossing>& crossings);
    /// The trajectory has ended.
    void finish(std::vector<ScreenCrossing>& crossings);

private:
    struct Piece {
        MotionSegment<Dim> motion;
        double start = 0.0;   ///< path length before it [m]
        double length = 0.0;  ///< [m]
    };
    struct Pending {
        std::size_t crossing = 0;
        double until = 0.0;          ///< path length at which the span ends [m]
        Vec position = Vec::Zero();  ///< where it began [m]
        double time = 0.0;           ///< when [s]
        bool free = false;           ///< no contact since
    };
    void begin(const Fresh& fresh, const std::vector<ScreenCrossing>& crossings);

    double half_;               ///< [m]
    double last_touch_ = 0.0;   ///< path length at the last contact [m]
    std::deque<Piece> pieces_;  ///< those that reach into the last half span, and the newest
    std::vector<Pending> pending_;
};

}  // namespace scree
