// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_figures.hpp"

#include <array>
#include <iosfwd>
#include <string>
#include <vector>

namespace scree::cli {

/// The comparison for machines: every number that text and pictures show, NaN as null.
std::string compare_json(const CompareStudy& study, const SiteModel& model, const ObservedSite& observed,
                         const CampaignResult& campaign);

/// The report for people: one file without others, pictures inside.
std::string compare_html(const CompareStudy& study, const ObservedSite& observed, const CampaignResult& campaign,
                         const std::vector<Figure>& figures);

/// The same on one screen.
void print_comparison(std::ostream& out, const CompareStudy& study, const ObservedSite& observed,
                      const CampaignResult& campaign);

/// [low, high], as all reports for machines have it.
inline std::array<double, 2> ends_of(const Interval& interval) {
    return {interval.low, interval.high};
}

/// What the gaps say, in one sentence.
std::string verdict(const CompareStudy& study);

/// "12 blocks, each simulated 100 times ..." in one sentence.
std::string design_text(const CompareStudy& study, const ObservedSite& observed, const CampaignResult& campaign);

}  // namespace scree::cli
