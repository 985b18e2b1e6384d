// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace scree::cli {

/// What a 2D model is in three dimensions: on the same terrain, from the same release. Screens that stand at a chainage go straight across the profile there,
/// as far as the terrain goes.
struct SpaceModel {
    std::unique_ptr<ReleaseArea> area;
    CampaignInput campaign;  ///< screens in the order of the 2D model
    std::string none;        ///< why there is no such model; empty: there is
};

/// Keeps references to `plane`.
SpaceModel make_space_model(const SiteFile& site, const SiteModel& plane);

/// Which of so many blocks move in 3D: each with the probability `share`.
std::vector<bool> chosen_share(std::int64_t blocks, double share, std::uint64_t seed);

/// Stops, crossings and impacts of two campaigns that have thrown different ones of the same blocks; all else is that of `plane`.
CampaignResult merged(CampaignResult plane, const CampaignResult& space);

}  // namespace scree::cli
