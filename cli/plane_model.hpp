// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"

#include <string>
#include <utility>
#include <vector>

namespace scree::cli {

/// What a site's 2D model has beyond the 3D one: traces the profiles and sets what lies along them, releases, screens, cells. The model's terrain, release
/// layer, screens and deposit zones must have been read. Throws InputError where no block could start or a profile is cut short.
void add_profiles(const SiteFile& site, SiteModel& model);

/// Names and chainages [m] of the key screens.chainages. Throws InputError, which says how it is to be written.
std::vector<std::pair<std::string, double>> parse_chainages(const std::string& text);

}  // namespace scree::cli
