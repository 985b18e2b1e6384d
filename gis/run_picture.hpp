// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/profile_picture.hpp"

#include <string>
#include <vector>

namespace scree::gis {

/// A quantity along a profile: one value for each cell, NaN where there is none.
struct DrawnCurve {
    std::string name{};            ///< in the key: "mean"
    std::string colour{};          ///< "#rrggbb"
    std::vector<double> values{};  ///< [unit of the panel]
    std::string dashes{};          ///< empty: a whole line
};

/// A diagram below the long profile.
struct DrawnPanel {
    std::string title{};  ///< of the vertical axis, with the unit
    std::vector<DrawnCurve> curves{};
    bool bars = false;  ///< the first curve as bars
    double top = 0.0;   ///< upper end of the axis; 0: a little more than the largest value [unit of the panel]
};

/// How blocks fared along one profile.
struct DrawnRun {
    std::string title{};
    std::string facts{};                     ///< one line below the title
    double cell = 1.0;                       ///< length of the cells, the first begins at chainage 0 [m]
    std::vector<std::vector<Vec2>> paths{};  ///< of centres of mass, (s, z) in the local frame [m]
    std::vector<Vec2> stops{};               ///< where they came to rest, (s, z) in the local frame [m]
    std::vector<DrawnPanel> panels{};
};

/// The long profile with the paths of blocks, and below it, on the same chainages, the panels, as SVG.
std::string run_picture(const ProfileScene& scene, std::size_t number, const DrawnRun& run);

}  // namespace scree::gis
