// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"
#include "gis/observation_reader.hpp"
#include "scree/inference/observation_audit.hpp"

#include <vector>

namespace scree::cli {

/// Where the blocks of `observations` were let go, as the records of release points say, and by that the path that each went down: a profile, or in 3D a
/// feature of the release layer. `findings` gets what is wrong with the points.
void place_releases(const SiteFile& site, const SiteModel& model, const std::vector<gis::ReleaseRecord>& records,
                    Observations& observations, std::vector<Finding>& findings);

}  // namespace scree::cli
