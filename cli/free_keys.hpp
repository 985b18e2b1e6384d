// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_file.hpp"
#include "scree/inference/calibration.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace scree::cli {

/// Keys of a site file that a calibration may change.
struct FreeKeys {
    CalibrationProblem problem;      ///< without the records; names are keys, "soil.loose waste.rolling"
    std::vector<std::string> units;  ///< one per parameter, "m"
    std::vector<bool> whole;         ///< parameters that are whole numbers
    std::vector<std::string>
        given;  ///< what the site has for each parameter: "0.1, 0.2" where a key means several entries
    /// Parameters that mean several entries of which the site has different values. Where such a one starts, in the middle of them, the site is as it was given.
    std::vector<bool> uneven;

    /// A point as `--set` changes.
    std::vector<std::string> changes(const CalibrationPoint& point) const;
    /// A value of parameter `i` as it goes into a site file.
    std::string text(std::size_t i, double value) const;
    bool is_whole(std::size_t i) const { return i < whole.size() && whole[i]; }
    /// What a search says of parameter `i`, as it is used.
    double used(std::size_t i, double value) const { return is_whole(i) ? std::round(value) : value; }
};

/// Reads ranges and choices such as "soil.loose waste.rolling=0.01:0.1", "release.height=1:6", "blocks.points=10:80:log", "blocks.shape=hull,box". The
/// values of the site are where the uncalibrated model stands. Throws InputError that names the entry and says what is allowed.
FreeKeys read_free_keys(const SiteFile& site, const std::vector<std::string>& entries);

/// "KEY=VALUE" of a site as it stands, in the words of a site file; empty if there is no such key.
std::string value_of_key(const SiteFile& site, const std::string& key);

}  // namespace scree::cli
