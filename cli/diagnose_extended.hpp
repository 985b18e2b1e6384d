// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/diagnose_study.hpp"

namespace scree::cli {

/// Where an effect of an answer acts lies beside the results, in a layer of this name, if it acts in a place.
std::string zone_name(const DiagnoseStudy& study, std::size_t answer, std::size_t effect);
/// The site file with an answer: site_extended.toml for the best, site_extended_2.toml for the next member of a group.
std::string extended_name(std::size_t answer);
/// The layer of the screens of a 3D answer to a 2D model.
inline constexpr const char* kScreensInSpace = "screens_3d";
/// The site with the calibrated values and the effects of an answer, as it would be simulated; layers of its own are in `results`, an absolute path.
SiteFile extended_site(const DiagnoseStudy& study, std::size_t answer, const std::filesystem::path& results);

}  // namespace scree::cli
