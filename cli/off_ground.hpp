// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"

namespace scree::cli {

/// Screens, deposit zones and effects of the model that stand where the terrain has none, in a hole of it for example: none of them meets a block, and a share
/// of 0 % there says nothing. Adds warnings, and says which screens and zones they are (3D; in 2D profiles tell).
void find_off_ground(SiteModel& model);

}  // namespace scree::cli
