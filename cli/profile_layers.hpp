// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_profiles.hpp"
#include "gis/layers.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// Facts about a profile that layer, summary and picture share.
struct ProfileFacts {
    double fall = 0.0;                ///< from the starting point to the lowest point beyond it [m]
    double lowest_s = 0.0;            ///< chainage of that point [m]
    double straight = 0.0;            ///< length led straight on, beyond the starting point [m]
    std::vector<double> soil_length;  ///< of each soil [m]
};
ProfileFacts facts_of(const ProfileTrace& trace, std::size_t soils);

/// "120.3 m long, falls 45.1 m to s = 101.0 m, ends on gentle ground (flat)"
std::string profile_words(const ProfileTrace& trace, const ProfileFacts& facts);

/// The layers `profiles` (one line each) and `profile_reaches` (one line for each stretch of one soil and course).
std::vector<gis::VectorLayer> profile_layers(const SiteProfiles& profiles, const SiteTerrain& terrain);

/// All vertices of all profiles: profile, s, position, height, soil and course of the reach that begins there.
std::string profiles_csv(const SiteProfiles& profiles, const SiteTerrain& terrain);

}  // namespace scree::cli
