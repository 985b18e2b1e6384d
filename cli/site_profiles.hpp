// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_terrain.hpp"
#include "scree/geometry/profile_trace.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace scree::cli {

/// The profiles of a site, as its section [profile] asks for them.
struct SiteProfiles {
    std::vector<ProfileTrace> traces;  ///< none is empty
    std::string source;                ///< file of the starting points or guiding lines, as the site file names it
    gis::VectorData features;          ///< these
    std::size_t left_out = 0;          ///< lines dropped because they run into others [-]
    std::vector<std::string> inputs;   ///< files read, as opened
    std::vector<std::string> warnings;
};

/// Traces them. Throws InputError where a line cannot begin, or where no profile comes about.
SiteProfiles trace_site_profiles(const SiteFile& site, const SiteTerrain& terrain);

}  // namespace scree::cli
