// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_figures.hpp"
#include "cli/diagnose_study.hpp"

#include <optional>

namespace scree::cli {

/// Along the path: how far measured stops, passages and what screens saw are from the calibrated model, above the terrain there. Nothing for a plan, or where
/// nothing was tested.
std::optional<Figure> where_along_path(const DiagnoseStudy& study, const SiteModel& model,
                                       const ObservedSite& observed);

}  // namespace scree::cli
