// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/observed_site.hpp"
#include "gis/observation_reader.hpp"

namespace scree::cli {

/// Records of a field test, resolved to the screens, zones and blocks of a site, with the axis that distances are counted along; `findings` has what the
/// records contradict by themselves. The order of rows says nothing. Throws InputError where observed.axis cannot be had.
ObservedSite resolve_observations(const SiteFile& site, const SiteModel& model, const gis::ObservationRecords& records);

}  // namespace scree::cli
