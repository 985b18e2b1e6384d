// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/diagnose_study.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// Of what has no name: whether it holds blocks back, in which phase, and how that grows with speed and mass and where; empty unless forces were tried.
std::vector<std::string> force_sentences(const DiagnoseStudy& study);

}  // namespace scree::cli
