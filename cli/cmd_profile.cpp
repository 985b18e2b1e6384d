// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/account.hpp"
#include "cli/campaign_layers.hpp"
#include "cli/commands.hpp"
#include "cli/profile_layers.hpp"
#include "cli/profile_scene.hpp"
#include "cli/settings.hpp"
#include "cli/site_model.hpp"
#include "cli/site_profiles.hpp"
#include "cli/terrain_layers.hpp"
#include "gis/dataset.hpp"
#include "gis/profile_picture.hpp"
#include "gis/results_writer.hpp"
#include "gis/words.hpp"

#include <algorithm>
#include <ostream>

namespace scree::cli {

namespace {

namespace fs = std::filesystem;
using gis::fixed;

constexpr std::size_t kMostPrinted = 20;  // profiles told one by one [-]

/// What lies along the profiles: layers of the site that are drawn with them.
struct Surroundings {
    std::vector<Screen> screens;
    std::optional<gis::VectorData> screen_features, release, deposit_zones;
};

Surroundings read_surroundings(const SiteFile& site, const SiteTerrain& terrain, SiteProfiles& profiles) {
    const SiteSettings& s = site.settings;
    Surroundings around;
    const auto read = [&](const VectorInput& input, const char* purpose, const std::vector<GeometryKind>& kinds) {
        gis::VectorData data = read_site_layer(site, input, purpose, kinds, terrain);
        profiles.warnings.insert(profiles.warnings.end(), data.report.warnings.begin(), data.report.warnings.end());
        profiles.inputs.push_back(site.resolve(input.file).string());
        return data;
    };
    if (!s.screens.file.empty()) {
        around.screen_features = read(s.screens, "screens", {GeometryKind::LineString, GeometryKind::Polygon});
        around.screens = make_screens(*around.screen_features, s.screens.field);
    }
    if (!s.deposit_zones.file.empty())
        around.deposit_zones = read(s.deposit_zones, "deposit zones", {GeometryKind::Polygon});
    around.release = read(s.release, "release", {GeometryKind::Polygon, GeometryKind::LineString, GeometryKind::Point});
    return around;
}

gis::ProfileScene scene_of(const SiteFile& site, const SiteTerrain& terrain, const SiteProfiles& profiles,
                           const Surroundings& around) {
    gis::ProfileScene scene = profile_scene(site.settings.name, terrain, profiles);
    for (const Screen& screen : around.screens) scene.screens.push_back({screen.name, screen.line});
    if (around.deposit_zones)
        scene.deposit_zones = drawn_areas(*around.deposit_zones, site.settings.deposit_zones.field);
    if (around.release) scene.releases = drawn_areas(*around.release, "");
    return scene;
}

void print_profile(std::ostream& out, const SiteTerrain& terrain, const ProfileTrace& trace, std::size_t number,
                   const std::vector<Screen>& screens) {
    const std::vector<std::string>& soils = terrain.data.soils.soils;
    const ProfileFacts facts = facts_of(trace, soils.size());
    std::string head = "profile " + std::to_string(number + 1);
    head.resize(std::max<std::size_t>(head.size() + 1, 15), ' ');
    out << head << profile_words(trace, facts) << "\n               ";
    std::string list;
    for (std::size_t k = 0; k < soils.size(); ++k)
        if (facts.soil_length[k] > 0.0)
            list += (list.empty() ? "" : ", ") + soils[k] + " " + fixed(facts.soil_length[k], 1) + " m";
    out << list;
    if (facts.straight > 0.0) out << "; " << fixed(facts.straight, 1) << " m led straight on";
    if (trace.joins >= 0)
        out << "; runs into profile " << trace.joins + 1 << " at s = " << fixed(trace.joins_at, 1) << " m";
    out << "\n";
    for (const Screen& screen : screens)
        for (const double s : trace.profile.crossings(screen.line))
            out << "               screen " << screen.name << " at s = " << fixed(s, 1) << " m\n";
}

void print_summary(std::ostream& out, const SiteFile& site, const SiteTerrain& terrain, const SiteProfiles& profiles,
                   const std::vector<Screen>& screens, const fs::path& folder) {
    out << "profiles       " << profiles.traces.size() << " ("
        << kProfileModeNames[static_cast<std::size_t>(site.settings.profile_mode)] << "), from " << profiles.source
        << ", on " << terrain.surface_report << "\n";
    if (profiles.left_out > 0)
        out << "               " << profiles.left_out << " more ran into these and were left out\n";
    for (std::size_t k = 0; k < std::min(profiles.traces.size(), kMostPrinted); ++k)
        print_profile(out, terrain, profiles.traces[k], k, screens);
    if (profiles.traces.size() > kMostPrinted)
        out << "               ... " << profiles.traces.size() - kMostPrinted << " more are in the layer profiles\n";
    out << "results        " << (folder / "results.qgs").string() << " (open it in QGIS)\n"
        << "               beside it: results.gpkg (layers profiles, profile_reaches), profiles.csv, profile*.svg "
           "(pictures)\n";
}

std::vector<gis::ProvenanceEntry> provenance(const SiteFile& site, const SiteTerrain& terrain,
                                             const SiteProfiles& profiles, const std::vector<gis::InputFile>& files) {
    std::vector<gis::ProvenanceEntry> p = {{"program", "scree " + version()},
                                           {"site", site.settings.name},
                                           {"surface", terrain.surface_report},
                                           {"profiles", std::to_string(profiles.traces.size())},
                                           {"profiles_left_out", std::to_string(profiles.left_out)}};
    add_inputs(p, site, files);
    return p;
}

/// What has been read, in that order.
std::vector<gis::InputFile> files_read(const SiteFile& site, const SiteTerrain& terrain, const SiteProfiles& profiles) {
    std::vector<std::string> inputs = terrain_inputs(site, terrain);
    inputs.insert(inputs.end(), profiles.inputs.begin(), profiles.inputs.end());
    return gis::input_files(inputs);
}

}  // namespace

ExitCode run_profile(const Context& context) {
    const SiteFile site = context.read_site();
    fs::path folder = context.results_folder(site);
    if (context.output.empty()) folder += "_profile";
    require_free_results(context, site, folder);
    warn_of_partial_results(context, folder);
    const SiteTerrain terrain = load_terrain(site);
    SiteProfiles profiles = trace_site_profiles(site, terrain);
    const Surroundings around = read_surroundings(site, terrain, profiles);
    const std::vector<gis::InputFile> files = files_read(site, terrain, profiles);
    gis::require_inputs_elsewhere(folder, files);
    std::vector<std::string> warnings = terrain.data.warnings();
    warnings.insert(warnings.end(), terrain.effect_warnings.begin(), terrain.effect_warnings.end());
    warnings.insert(warnings.end(), profiles.warnings.begin(), profiles.warnings.end());
    print_warnings(context, warnings);

    gis::ResultsPackage package;
    package.frame = terrain.data.frame;
    package.title = site.settings.name + ": profiles";
    package.vectors = profile_layers(profiles, terrain);
    if (around.screen_features)
        package.vectors.push_back(input_layer(*around.screen_features, "screens", "Screens", ""));
    if (site.settings.profile_mode == ProfileMode::Steepest)
        package.vectors.push_back(input_layer(profiles.features, "profile_starts", "Where profiles start", ""));
    else
        package.vectors.push_back(input_layer(profiles.features, "profile_guides", "Guiding lines", ""));
    package.rasters = {heights_layer(terrain)};
    package.provenance = provenance(site, terrain, profiles, files);
    package.files.push_back({"profiles.csv", profiles_csv(profiles, terrain)});
    const gis::ProfileScene scene = scene_of(site, terrain, profiles, around);
    package.files.push_back({"profiles.svg", gis::profiles_plan(scene)});
    const auto pictures = static_cast<std::size_t>(site.settings.profile_pictures);
    for (std::size_t k = 0; k < std::min(pictures, scene.profiles.size()); ++k)
        package.files.push_back({"profile_" + std::to_string(k + 1) + ".svg", gis::profile_picture(scene, k)});
    gis::write_results(folder, package, context.overwrite);
    if (!context.quiet) print_summary(*context.out, site, terrain, profiles, around.screens, folder);
    return ExitCode::Done;
}

}  // namespace scree::cli
