// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"
#include "scree/inference/observation_audit.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// A field test as a site sees it: records resolved to the site's screens, zones and blocks, and judged.
struct ObservedSite {
    Observations observations;
    ObservationOperator op;
    std::vector<Finding> findings;      ///< errors first
    std::string axis_text;              ///< where distance along is counted from and to, for people
    std::vector<std::string> sources;   ///< what was read, a line each
    std::vector<std::string> inputs;    ///< files read, as opened
    std::vector<gis::InputFile> files;  ///< on disc behind them, as they were when read
    std::vector<std::string> warnings;  ///< of the readers

    bool has_errors() const { return !findings.empty() && findings.front().severity == Severity::Error; }
};

/// Reads and judges the measurements at `path`. Throws InputError where they cannot be read; what they say is judged in `findings`.
ObservedSite load_observed(const SiteFile& site, const SiteModel& model, const std::string& path);

/// A test that has not been made: release.count blocks of the site, of which `instruments` (of "stops,speed,height,spin,impacts") would be measured, with the
/// errors of [observed]. The values come from one simulation. Throws InputError for an unknown instrument.
ObservedSite planned_test(const SiteFile& site, const SiteModel& model, const std::string& instruments);

/// Chainage at which each screen of the site stands on an axis [m], NaN where the two do not meet.
std::vector<double> screen_chainages(const SiteModel& model, const Axis& axis);

/// Blocks of the test: those with ids, else as many as were thrown, or as the table that tells of most.
std::int64_t blocks_of(const ObservedSite& observed);

/// Turns a campaign of the site into one of the field test: known blocks in turn, each as often as the settings say, and speeds as films give them.
void match_campaign(const SiteFile& site, const ObservedSite& observed, CampaignInput& campaign);

}  // namespace scree::cli
