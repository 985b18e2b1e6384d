// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_figures.hpp"
#include "cli/free_keys.hpp"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace scree::cli {

/// Everything that a calibration found; text, JSON, site file and pictures are made from it and from nothing else.
struct CalibrationReport {
    SiteFile before, after;  ///< the site as it was, and with the best point
    FreeKeys keys;
    CalibrationSettings settings;
    CalibrationResult result;
    CalibrationJournal journal;
    std::vector<std::string> observables;  ///< that were minimised
    std::vector<std::string> inputs;       ///< "stopping_points.csv sha256 ...", a line each
    std::size_t blocks = 0;                ///< measured [-]
    std::int64_t thrown = 0;               ///< blocks simulated in all [-]
    CompareStudy before_study, after_study;
};

std::vector<Figure> calibrate_figures(const CalibrationReport& report);
/// Of a place or path left out.
std::string seen_note(const CalibrationPlace& place);
/// How each place is fitted, and predicted where it, or blocks, were left out: a JSON array.
std::string places_json(const CalibrationResult& result);
std::string calibrate_json(const CalibrationReport& report);
std::string calibrate_html(const CalibrationReport& report, const std::vector<Figure>& figures,
                           const std::vector<Figure>& compared);
/// The site file with the best values, for the folder `to`; how they came about stands at its head.
std::string calibrated_toml(const CalibrationReport& report, const std::filesystem::path& to);
/// On one screen.
void print_calibration(std::ostream& out, const CalibrationReport& report);

/// What a user should not miss, a sentence each: estimates on edges, what is not identified, searches that ended elsewhere.
std::vector<std::string> calibration_remarks(const CalibrationReport& report);

/// Of a model of which held_out_was_seen.
std::string held_out_remark(const std::string& what);

/// A number with the digits that its interval leaves certain, and one more.
std::string value_text(double value, const Interval& interval);

}  // namespace scree::cli
