// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"
#include "gis/results_writer.hpp"

#include <vector>

namespace scree::cli {

/// profile_1.svg and so on, of the first profiles on which blocks were thrown (profile.pictures): paths, stops, how many come how far, energy, height and
/// speed along the profile. Nothing in 3D.
std::vector<gis::TextFile> run_pictures(const SiteFile& site, const SiteModel& model, const CampaignResult& result);

}  // namespace scree::cli
