// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_figures.hpp"
#include "cli/diagnose_study.hpp"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace scree::cli {

/// Measured and simulated, of one of the models of a diagnosis.
struct ModelFigures {
    std::string model;  ///< "calibrated model", "with ground_drag"
    std::vector<Figure> figures;
};

std::vector<Figure> diagnose_figures(const DiagnoseStudy& study);
std::string diagnose_json(const DiagnoseStudy& study);
std::string diagnose_html(const DiagnoseStudy& study, const std::vector<Figure>& figures,
                          const std::vector<ModelFigures>& of_models);
/// The site with calibrated values and, if that answer stands, its effects; for the folder `to`.
std::string extended_toml(const DiagnoseStudy& study, std::size_t answer, const std::filesystem::path& to);
/// Which strength of each effect such a test would see, and what looks like it.
void print_power(std::ostream& out, const DiagnoseStudy& study);
/// On one screen.
void print_diagnosis(std::ostream& out, const DiagnoseStudy& study);

}  // namespace scree::cli
