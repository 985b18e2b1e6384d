// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_study.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// A picture of the report.
struct Figure {
    std::string file;  ///< "map.svg"
    std::string title;
    std::string caption;  ///< what is drawn and how to read it
    std::string svg;
};

/// All pictures of a comparison, in the order of the report: the paper's row of bars and distribution functions (Bourrier & Acary 2022, figures 6 to 16),
/// gaps, map, distributions one by one, passing shares, PIT values.
std::vector<Figure> compare_figures(const CompareStudy& study, const SiteModel& model, const ObservedSite& observed,
                                    const CampaignResult& campaign);

/// The map among them.
Figure compare_map(const CompareStudy& study, const SiteModel& model, const ObservedSite& observed,
                   const CampaignResult& campaign);

/// Reach probability of a 3D campaign that recorded passages.
Figure reach_map(const std::string& title, const SiteModel& model, const ObservedSite& observed,
                 const CampaignResult& campaign);

}  // namespace scree::cli
