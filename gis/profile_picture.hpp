// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/feature.hpp"
#include "scree/geometry/grid.hpp"
#include "scree/geometry/local_frame.hpp"
#include "scree/geometry/profile.hpp"

#include <string>
#include <utility>
#include <vector>

namespace scree::gis {

/// A profile as it is drawn.
struct DrawnProfile {
    std::string name{};                                   ///< "1"
    std::string facts{};                                  ///< one line below the title: length, drop, why it ends
    const Profile* profile = nullptr;                     ///< not empty
    std::vector<bool> straight{};                         ///< per reach: led straight on over gentle ground
    double start = 0.0;                                   ///< chainage of the starting point [m]
    std::vector<std::pair<double, std::string>> marks{};  ///< screens given by their chainage [m]
};

/// A line on the map with a name: a screen.
struct DrawnLine {
    std::string name{};
    std::vector<Vec2> points{};  ///< [m]
};

/// An area on the map with a name: a deposit zone.
struct DrawnArea {
    std::string name{};
    MultiPolygon polygons{};
};

/// What surrounds the profiles in their pictures.
struct ProfileScene {
    std::string title{};
    LocalFrame frame{};
    const Grid<double>* heights = nullptr;  ///< of the terrain, local frame [m]
    std::vector<std::string> soils{};       ///< names, by SoilId
    std::vector<DrawnProfile> profiles{};
    std::vector<DrawnLine> screens{};
    std::vector<DrawnArea> deposit_zones{};
    std::vector<DrawnArea> releases{};
};

/// The plan of all profiles over a shaded relief with contours, as SVG.
std::string profiles_plan(const ProfileScene& scene);

/// One profile, as SVG: in plan, coloured by its soils, and below it the long profile with soils, screens and zones along it.
std::string profile_picture(const ProfileScene& scene, std::size_t number);

}  // namespace scree::gis
