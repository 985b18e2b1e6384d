// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

/// When gap + rate t - acceleration/2 t^2 reaches zero [s], infinite if never; gap positive.
inline double arrival(double gap, double rate, double acceleration) {
    const double root = rate * rate + 2.0 * acceleration * gap;
    if (root < 0.0) return kInfinity;
    const double fall = std::sqrt(root) - rate;
    return fall > 0.0 ? 2.0 * gap / fall : kInfinity;
}

/// A bound this near to the guess needs no better one [-].
inline constexpr double kCloseGuess = 0.95;

/// Lower bound of the same with an acceleration that is at most acceleration + jerk t, and at most `most`: what it can be up to a time counts as
/// constant up to that time, for two guesses of the time. No longer time is asked for than the horizon.
inline double arrival(double gap, double rate, double acceleration, double jerk, double most, double horizon) {
    const double fastest = std::clamp(acceleration + jerk * horizon, 0.0, std::max(most, 0.0));
    if (gap + (rate - 0.5 * fastest * horizon) * horizon > 0.0) return horizon;  // mostly, and without a root
    double guess = std::min(arrival(gap, rate, acceleration), horizon), time = 0.0;
    for (int k = 0; k < 2; ++k) {
        time = std::max(time, std::min(guess, arrival(gap, rate, std::min(acceleration + jerk * guess, most))));
        if (time > kCloseGuess * guess) break;
        guess = std::min(guess, arrival(gap, rate, acceleration + jerk * time));
    }
    return time;
}

}  // namespace scree
