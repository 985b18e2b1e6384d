// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_figures.hpp"
#include "cli/sweep_study.hpp"

#include <iosfwd>
#include <string>

namespace scree::cli {

Figure sweep_figure(const SweepStudy& study);
std::string sweep_json(const SweepStudy& study);
/// The table for spreadsheets.
std::string sweep_csv(const SweepStudy& study);
std::string sweep_html(const SweepStudy& study, const Figure& figure);
/// On one screen.
void print_sweep(std::ostream& out, const SweepStudy& study);

}  // namespace scree::cli
