// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/account.hpp"
#include "cli/campaign_layers.hpp"
#include "cli/commands.hpp"
#include "cli/compare_report.hpp"
#include "cli/progress.hpp"
#include "gis/dataset.hpp"
#include "gis/results_writer.hpp"

#include <ostream>

namespace scree::cli {

namespace {

namespace fs = std::filesystem;

gis::VectorLayer observed_stops(const ObservedSite& observed) {
    gis::VectorLayer layer;
    layer.title = "Measured stops";
    layer.description = "Where blocks were found";
    layer.data.name = "observed_stops";
    layer.data.kind = GeometryKind::Point;
    layer.coordinates = gis::Coordinates::XY;
    layer.data.fields = {{"block_id", FieldType::Text, "Block"},
                         {"mass_kg", FieldType::Real, "Mass [kg]"},
                         {"position_error_m", FieldType::Real, "Error of the position [m]"}};
    std::int64_t id = 0;
    for (const ObservedStop& s : observed.observations.stops) {
        if (!std::isfinite(s.position.x())) continue;
        Feature f;
        f.id = ++id;
        f.geometry = Points{s.position};
        const bool known = s.block >= 0;
        const auto block = static_cast<std::size_t>(std::max(s.block, 0));
        f.values = {known ? FieldValue(observed.observations.blocks[block].id) : FieldValue(),
                    known ? FieldValue(observed.observations.blocks[block].mass) : FieldValue(), s.error};
        layer.data.features.push_back(std::move(f));
    }
    return layer;
}

gis::ResultsPackage results_of(const SiteFile& site, const SiteModel& model, const ObservedSite& observed,
                               const CampaignResult& campaign, const CompareStudy& study, const fs::path& folder) {
    gis::ResultsPackage package;
    package.frame = model.terrain.data.frame;
    package.title = site.settings.name + ": comparison";
    if (!observed.observations.stops.empty()) package.vectors.push_back(observed_stops(observed));
    for (gis::VectorLayer& layer : campaign_vectors(model, campaign)) package.vectors.push_back(std::move(layer));
    for (gis::RasterLayer& layer : campaign_rasters(model, campaign))
        if (layer.group == "Counts") package.rasters.push_back(std::move(layer));
    package.provenance = provenance(site, model, campaign);
    for (const gis::InputFile& file : observed.files)
        package.provenance.push_back(
            {"sha256 of observations " + fs::path(file.path).filename().string(), file.sha256});
    const std::vector<Figure> figures = compare_figures(study, model, observed, campaign);
    for (const Figure& f : figures) package.files.push_back({"figures/" + f.file, f.svg});
    package.files.push_back({"report.html", compare_html(study, observed, campaign, figures)});
    package.files.push_back({"compare.json", compare_json(study, model, observed, campaign)});
    package.files.push_back(
        {"compare.toml", reproducing_toml(site, campaign, folder, "scree compare compare.toml --observed OBS")});
    return package;
}

}  // namespace

ExitCode run_compare(const Context& context) {
    const SiteFile site = context.read_site();
    fs::path folder = context.results_folder(site);
    if (context.output.empty()) folder += "_compare";
    require_free_results(context, site, folder);
    warn_of_partial_results(context, folder);
    SiteModel model = load_site(site);
    const ObservedSite observed = load_observed(site, model, context.observed);
    gis::require_inputs_elsewhere(folder, model.files);
    gis::require_inputs_elsewhere(folder, observed.files);
    print_warnings(context, model.warnings);
    if (print_findings(context, observed)) return ExitCode::BadInput;
    match_campaign(site, observed, model.campaign);
    model.campaign.threads = context.threads;

    const InterruptScope interrupt;
    Progress progress(context, "blocks", model.campaign.release.count);
    const CampaignResult campaign = run_campaign(
        model.campaign, [&](std::int64_t done) { progress.update(done); }, InterruptScope::flag());
    progress.finish(campaign.released);
    if (campaign.interrupted) {
        *context.err << "interrupted: " << campaign.released << " of " << model.campaign.release.count
                     << " blocks were thrown; half a comparison misleads, nothing is written\n";
        return ExitCode::Interrupted;
    }
    const CompareStudy study = make_study(site, model, observed, campaign);
    gis::write_results(folder, results_of(site, model, observed, campaign, study, folder), context.overwrite);
    if (context.quiet) return ExitCode::Done;
    print_comparison(*context.out, study, observed, campaign);
    *context.out << "report         " << (folder / "report.html").string() << "\n"
                 << "               beside it: compare.json, figures (SVG), results.qgs (both in QGIS), compare.toml "
                    "(reproduces it)\n";
    return ExitCode::Done;
}

}  // namespace scree::cli
