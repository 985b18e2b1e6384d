// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace scree {

/// A part of a path, between two chainages.
struct Stretch {
    double from = 0.0;  ///< [m]
    double to = 0.0;    ///< [m]
    double middle() const { return 0.5 * (from + to); }
    double length() const { return to - from; }
    bool operator==(const Stretch&) const = default;
};

}  // namespace scree
