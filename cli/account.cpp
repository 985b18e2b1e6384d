// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/account.hpp"

#include "cli/commands.hpp"
#include "cli/settings.hpp"
#include "cli/text.hpp"
#include "gis/dataset.hpp"
#include "gis/observation_reader.hpp"

#include <sstream>

namespace scree::cli {

namespace fs = std::filesystem;

namespace {

/// A warning without the folders of this machine: input files by their names.
std::string without_folders(std::string warning, const SiteFile& site, const std::vector<gis::InputFile>& files) {
    auto shorten = [&](const std::string& path) {
        const std::string name = fs::path(path).filename().string();
        for (auto at = warning.find(path); at != std::string::npos && path != name;
             at = warning.find(path, at + name.size()))
            warning.replace(at, path.size(), name);
    };
    for (const gis::InputFile& file : files) shorten(file.path);
    shorten(site.file.string());
    return warning;
}

/// How many blocks passed each screen, also where none did.
void add_passages(std::vector<gis::ProvenanceEntry>& account, const SiteModel& model, const CampaignResult& result) {
    const std::vector<Screen>& screens = model.campaign.screens;
    std::vector<std::int64_t> passed(screens.size());
    for (const ScreenCrossing& c : result.crossings) ++passed[static_cast<std::size_t>(c.screen)];
    for (std::size_t k = 0; k < screens.size(); ++k)
        if (screens[k].part_of < 0) account.push_back({gis::kPassedKey + screens[k].name, std::to_string(passed[k])});
}

}  // namespace

void add_inputs(std::vector<gis::ProvenanceEntry>& account, const SiteFile& site,
                const std::vector<gis::InputFile>& files) {
    for (const gis::InputFile& file : files)
        account.push_back({"sha256 " + fs::path(file.path).filename().string(), file.sha256});
    SiteSettings portable = site.settings;
    portable.output_directory.clear();
    account.push_back({"settings", settings_as_toml(portable, [](const std::string& path) {
                           return fs::path(path).filename().string();
                       })});
}

void add_counts(std::vector<gis::ProvenanceEntry>& account, const CampaignResult& result) {
    account.push_back({"released", std::to_string(result.released)});
    for (std::size_t k = 0; k < kStopReasonNames.size(); ++k)
        account.push_back({std::string("ended_") + kStopReasonNames[k], std::to_string(result.reasons[k])});
}

std::vector<gis::ProvenanceEntry> provenance(const SiteFile& site, const SiteModel& model,
                                             const CampaignResult& result) {
    std::vector<gis::ProvenanceEntry> p;
    p.push_back({"program", "scree " + version()});
    p.push_back({"libraries", gis::library_versions()});
    p.push_back({"site", site.settings.name});
    p.push_back({"seed", std::to_string(site.settings.seed)});
    p.push_back({"dimension", model.in_plane() ? "2" : "3"});
    add_counts(p, result);
    p.push_back({"interrupted", result.interrupted ? "true: " + std::to_string(result.released) + " of " +
                                                         std::to_string(site.settings.releases.count) + " blocks"
                                                   : "false"});
    add_passages(p, model, result);
    const TrajectoryCounters& c = result.counters;
    p.push_back({"contact_problems", std::to_string(c.contact_problems)});
    p.push_back({"contact_problems_above_tolerance", std::to_string(c.unconverged_problems)});
    p.push_back({"impacts", std::to_string(c.impacts)});
    p.push_back({"impacts_with_lowered_restitution", std::to_string(c.restitution_capped)});
    p.push_back({"rested_while_turning", std::to_string(c.rested_turning)});
    p.push_back({"steps_with_energy_taken_back", std::to_string(c.energy_capped)});
    p.push_back({"largest_rise_taken_back_m", short_number(c.largest_rise_taken_back)});
    p.push_back({"largest_energy_rise_m", short_number(c.largest_energy_rise)});
    p.push_back({"penetration_p999_m", short_number(c.penetration_quantile(0.999))});
    p.push_back({"largest_penetration_m", short_number(c.largest_penetration)});
    if (!model.campaign.effects.empty()) {
        p.push_back({"trees_and_nets_struck", std::to_string(c.crossings_struck)});
        p.push_back({"breaks_of_blocks", std::to_string(c.breaks)});
    }
    p.push_back({"quantile_error", short_number(kQuantileError) + " relative"});
    add_inputs(p, site, model.files);
    for (std::size_t k = 0; k < model.warnings.size(); ++k)
        p.push_back({"warning_" + std::to_string(k + 1), without_folders(model.warnings[k], site, model.files)});
    return p;
}

std::string settings_from(const SiteFile& site, const SiteSettings& settings, const fs::path& folder) {
    return settings_as_toml(settings, [&](const std::string& path) {
        const std::optional<GdalName> name = site.gdal_name(path);
        if (path == settings.output_directory || (name && name->path.empty())) return path;
        const fs::path file = fs::absolute(site.beside(name ? name->path : path));
        std::error_code error;
        // neither may be there yet; and a link is itself, with what stands beside it (.prj, .tfw), not what it leads to
        const fs::path relative = (fs::weakly_canonical(file.parent_path(), error) / file.filename())
                                      .lexically_relative(fs::weakly_canonical(fs::absolute(folder), error));
        const std::string found = error || relative.empty() ? file.string() : relative.string();
        return name ? name->with(found) : found;
    });
}

std::string reproducing_toml(const SiteFile& site, const CampaignResult& result, const fs::path& folder,
                             const std::string& command) {
    SiteSettings settings = site.settings;
    settings.output_directory = "rerun";
    std::ostringstream text;
    text << "# Reproduces these results: " << command << "\n# scree " << version() << "; " << result.released
         << " blocks:";
    for (std::size_t k = 0; k < kStopReasonNames.size(); ++k)
        text << (k ? ", " : " ") << result.reasons[k] << " " << kStopReasonNames[k];
    text << (result.interrupted ? "\n# INTERRUPTED: not all blocks were thrown" : "") << "\n";
    text << settings_from(site, settings, folder);
    return text.str();
}

}  // namespace scree::cli
