// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/diagnose_study.hpp"

namespace scree::cli {

/// What a residual stands for, in the units of the measurements: ": mean 9.8 m/s measured, 12.4 m/s simulated"; of trends what a doubling of the mass or of L1/L3, or
/// ten blocks more, change; of two values that go together their correlation. `more`: the residual is positive. Residuals count after the parameters have fitted the rest as well as they
/// can: where that turns the sign round, or raises what is within one standard error, the calibrated model's own numbers would contradict the sentence, and
/// it says ", once the parameters fit the rest". Empty where nothing of the kind was measured.
std::string in_units(const DiagnoseStudy& study, const Residual& residual, bool more);

}  // namespace scree::cli
