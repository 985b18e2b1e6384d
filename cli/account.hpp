// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_model.hpp"
#include "gis/dataset.hpp"
#include "gis/layers.hpp"
#include "scree/ensemble/campaign.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace scree::cli {

/// Everything that says how a result came about, without paths of a machine or times: two runs of one site give the same bytes.
std::vector<gis::ProvenanceEntry> provenance(const SiteFile& site, const SiteModel& model,
                                             const CampaignResult& result);

/// How many blocks were thrown, and how they ended.
void add_counts(std::vector<gis::ProvenanceEntry>& account, const CampaignResult& result);

/// The hashes of what was read, and the settings, with files by their names.
void add_inputs(std::vector<gis::ProvenanceEntry>& account, const SiteFile& site,
                const std::vector<gis::InputFile>& files);

/// Settings of a site as a site file in `folder`, to which its paths lead.
std::string settings_from(const SiteFile& site, const SiteSettings& settings, const std::filesystem::path& folder);

/// A site file that reproduces a result from its folder; its first line says by which command.
std::string reproducing_toml(const SiteFile& site, const CampaignResult& result, const std::filesystem::path& folder,
                             const std::string& command);

}  // namespace scree::cli
