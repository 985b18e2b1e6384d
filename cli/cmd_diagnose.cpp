// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/account.hpp"
#include "cli/campaign_layers.hpp"
#include "cli/commands.hpp"
#include "cli/diagnose_consequences.hpp"
#include "cli/diagnose_extended.hpp"
#include "cli/diagnose_models.hpp"
#include "cli/diagnose_report.hpp"
#include "cli/diagnose_where.hpp"
#include "cli/progress.hpp"
#include "cli/setting_rows.hpp"
#include "cli/settings.hpp"
#include "cli/text.hpp"
#include "gis/results_writer.hpp"
#include "scree/base/error.hpp"
#include "scree/inference/residual_space.hpp"

#include <cmath>
#include <memory>
#include <ostream>

namespace scree::cli {

namespace {

namespace fs = std::filesystem;

/// Restitution, friction and rolling resistance of every soil, where the site does not say what is free.
std::vector<std::string> usual_free_keys(const SiteFile& site) {
    std::vector<std::string> keys;
    const auto range = [](double value, double low, double high) {
        return number_text(std::min(low, value)) + ":" + number_text(std::max(high, value));
    };
    for (const Soil& soil : site.settings.soils) {
        keys.push_back("soil." + soil.name + ".restitution=" + range(soil.restitution, 0.0, 0.4));
        keys.push_back("soil." + soil.name + ".friction=" + range(soil.friction, 0.3, 0.9));
        keys.push_back("soil." + soil.name + ".rolling=" + range(soil.rolling, 0.002, 0.15) +
                       (soil.rolling > 0.0 ? ":log" : ""));
    }
    return keys;
}

std::string subject_of(const DiagnoseStudy& study, const std::vector<std::string>& free, const Context& context) {
    SiteSettings portable = study.site.settings;
    portable.output_directory.clear();
    portable.calibration.free.clear();
    std::string text = "scree " + version_number() + (context.full ? " full\n" : "\n");
    if (context.plan) text += "instruments " + context.instruments + "\n";
    for (const std::string& key : free) text += key + "\n";
    for (const std::string& line : study.inputs) text += line + "\n";
    return text +
           settings_as_toml(portable, [](const std::string& path) { return fs::path(path).filename().string(); });
}

/// One line of progress per stage.
class StageProgress {
public:
    explicit StageProgress(const Context& context) : context_(context) {}
    void operator()(const std::string& stage, std::size_t done, std::size_t planned) {
        if (stage == stage_) {
            progress_->expect(static_cast<std::int64_t>(planned));
        } else {
            finish();
            stage_ = stage;
            progress_ = std::make_unique<Progress>(context_, stage, static_cast<std::int64_t>(planned));
            progress_->skip(static_cast<std::int64_t>(done));
        }
        last_ = static_cast<std::int64_t>(done);
        progress_->update(last_);
    }
    void finish() {
        if (progress_) progress_->finish(last_);
        progress_.reset();
    }

private:
    const Context& context_;
    std::string stage_;
    std::unique_ptr<Progress> progress_;
    std::int64_t last_ = 0;
};

gis::VectorLayer zone_layer(const DiagnosisVariant& variant, const std::string& name) {
    gis::VectorLayer layer;
    layer.data.name = name;
    layer.data.kind = GeometryKind::Polygon;
    layer.coordinates = gis::Coordinates::XY;
    layer.data.fields.push_back({"effect", FieldType::Text, "Effect"});
    Feature feature;
    feature.geometry = variant.place.area->polygons;
    feature.values.push_back(std::string(variant.form()));
    layer.data.features.push_back(std::move(feature));
    layer.title = std::string("Where ") + variant.form() + " acts";
    layer.group = "Inputs";
    return layer;
}

gis::VectorLayer screens_in_space(const SiteFile& site, const SiteModel& plane) {
    gis::VectorLayer layer;
    layer.data.name = kScreensInSpace;
    layer.data.kind = GeometryKind::LineString;
    layer.coordinates = gis::Coordinates::XY;
    layer.data.fields.push_back({"name", FieldType::Text, "Name"});
    layer.title = "Screens of the 3D model";
    layer.group = "Inputs";
    for (const Screen& screen : make_space_model(site, plane).campaign.screens) {
        if (screen.line.empty()) continue;  // on no profile
        Polyline line;
        for (const Vec2& p : screen.line) line.points.emplace_back(p.x(), p.y(), 0.0);
        Feature feature;
        feature.geometry = Polylines{line};
        feature.values.push_back(screen.name);
        layer.data.features.push_back(std::move(feature));
    }
    return layer;
}

/// Where it fails, what explains it, what that changes.
std::vector<Figure> figures_of(const DiagnoseStudy& study, const SiteModel& model, const ObservedSite& observed) {
    std::vector<Figure> figures;
    if (auto along = where_along_path(study, model, observed)) figures.push_back(std::move(*along));
    for (Figure& f : diagnose_figures(study)) figures.push_back(std::move(f));
    for (Figure& f : consequence_figures(study, model, observed)) figures.push_back(std::move(f));
    return figures;
}

/// Of a campaign in 3D.
gis::RasterLayer reach_raster(const SiteModel& model, const CampaignResult& campaign, const std::string& of) {
    const GridShape& cells = model.in_plane() ? model.terrain.data.grid.shape : model.campaign.result_cells;
    gis::RasterLayer layer = reach_probability_raster(cells, campaign);
    layer.name += "_" + of;
    layer.title += ", " + of;
    return layer;
}

/// Whose stops, paths and crossings are shown: those of site_extended.toml, but for a third dimension, which has no profile.
struct ShownModel {
    std::string name;
    const CampaignResult& campaign;
};
ShownModel shown_model(const DiagnoseStudy& study) {
    const AnswerFit* answer = study.answer();
    if (answer && !answer->in_space()) return {"with " + answer->name(), answer->campaign};
    if (!answer && study.moved) return {"parameters that are told", study.moved->campaign};
    return {"calibrated model", study.campaign};
}

gis::ResultsPackage results_of(const DiagnoseStudy& study, const SiteModel& model, const ObservedSite& observed,
                               const fs::path& folder) {
    gis::ResultsPackage package;
    package.frame = model.terrain.data.frame;
    package.title = study.site.settings.name + ": diagnosis";
    const AnswerFit* answer = study.answer();
    const bool judged = study.judged();
    const bool in_space = answer && answer->in_space();
    package.provenance = {{"program", "scree " + version()}, {"site", study.site.settings.name}};
    if (judged) {
        const ShownModel shown = shown_model(study);
        package.title += ", " + shown.name;
        package.provenance.push_back({"model", shown.name});
        add_counts(package.provenance, shown.campaign);
        package.vectors = campaign_vectors(model, shown.campaign);
    }
    if (in_space && !model.campaign.screens.empty()) package.vectors.push_back(screens_in_space(study.site, model));
    for (std::size_t a = 0; a < study.standing(); ++a)
        for (std::size_t k = 0; k < study.answers[a].effects.size(); ++k) {
            const DiagnosisVariant& variant = study.answers[a].effects[k].variant;
            if (variant.place.area) package.vectors.push_back(zone_layer(variant, zone_name(study, a, k)));
        }
    if (package.vectors.empty()) package.vectors.push_back(input_layer(model.release, "release", "Release", "Inputs"));
    for (const std::string& line : study.inputs) package.provenance.push_back({"input", line});
    const std::vector<Figure> figures = figures_of(study, model, observed);
    // topmost first
    if (const AnswerFit* on_blocks = answer_on_blocks(study); on_blocks && (in_space || !model.in_plane()))
        package.rasters.push_back(reach_raster(model, on_blocks->campaign, "extended"));
    if (judged && !model.in_plane()) {
        if (study.moved) package.rasters.push_back(reach_raster(model, study.moved->campaign, "told"));
        package.rasters.push_back(reach_raster(model, study.campaign, "calibrated"));
    }
    std::vector<ModelFigures> of_models;
    const auto add = [&](const std::string& of, const CompareStudy& compared, const CampaignResult& campaign,
                         const char* prefix) {
        of_models.push_back({of, {}});
        for (Figure& f : compare_figures(compared, model, observed, campaign))
            if (f.file == "overview.svg" || f.file == "gaps.svg" || f.file == "map.svg") {
                f.file = prefix + f.file;
                of_models.back().figures.push_back(std::move(f));
            }
    };
    if (judged) add("calibrated model", study.before, study.campaign, "calibrated_");
    if (study.moved) add("parameters that are told", study.moved->study, study.moved->campaign, "told_");
    if (!study.answers.empty()) {
        const AnswerFit& best = study.answers.front();
        add("with " + best.name(), best.study, best.campaign, "extended_");
    }
    for (const Figure& f : figures) package.files.push_back({"figures/" + f.file, f.svg});
    for (const ModelFigures& m : of_models)
        for (const Figure& f : m.figures) package.files.push_back({"figures/" + f.file, f.svg});
    package.files.push_back({"diagnosis.json", diagnose_json(study)});
    package.files.push_back({"report.html", diagnose_html(study, figures, of_models)});
    for (std::size_t k = 0; k < study.site_files(); ++k)
        package.files.push_back({extended_name(k), extended_toml(study, k, folder)});
    return package;
}

/// Before hours of calibration: residuals need so many rows.
void require_enough_blocks(const Context& context, const ObservedSite& observed) {
    const Observations& o = observed.observations;
    const std::size_t blocks = side_by_side(o, observed.op).rows(), least = ResidualSpace::kLeastRows;
    if (blocks >= least || observed.has_errors()) return;  // errors are a verdict of their own
    throw InputError((context.plan ? "A test of " : context.observed + ": a test of ") + std::to_string(blocks) +
                     " blocks is too small for a diagnosis, which needs at least " + std::to_string(least) +
                     (context.plan ? ": give more with --set release.count=50"
                                   : ": scree compare says how far the model is from so few, scree diagnose --plan "
                                     "what a larger test would show"));
}

/// A site for maps throws more blocks than anybody measures.
void warn_of_large_plan(const Context& context, const ObservedSite& observed) {
    constexpr std::size_t kLargeTest = 200;  // blocks
    const std::size_t blocks = side_by_side(observed.observations, observed.op).rows();
    if (context.plan && blocks > kLargeTest)
        print_warnings(context, {"this plans a field test of " + std::to_string(blocks) +
                                 " blocks, as release.count says, and takes hours: --set release.count=50 plans one of "
                                 "50 in minutes"});
}

/// Every name is held against a model that was calibrated.
void require_something_to_fit(const Context& context, const ObservedSite& observed) {
    const std::vector<Observable> all = make_observables(observed.observations, observed.op);
    if (std::any_of(all.begin(), all.end(), [](const Observable& o) { return o.overall; }) || observed.has_errors())
        return;
    throw InputError((context.plan ? std::string("--instruments") : context.observed) +
                     ": films of impacts alone are nothing that a model could be calibrated by: a diagnosis needs "
                     "stops, crossings of screens or shares as well");
}

/// The smallest p that so many samples can show is one of them and the measurements themselves.
void require_enough_draws(const SiteFile& site, const DiagnosisSettings& settings) {
    const auto least = static_cast<std::int64_t>(std::ceil(1.0 / settings.level - 1e-9)) - 1;
    if (settings.draws >= least) return;
    throw InputError(site.file.string() + ": diagnosis.draws = " + std::to_string(settings.draws) +
                     " samples of chance can reject nothing at diagnosis.level = " + short_number(settings.level) +
                     ": give at least " + std::to_string(least));
}

}  // namespace

ExitCode run_diagnose(const Context& context) {
    if (context.observed.empty() && !context.plan)
        throw InputError("give the measurements with --observed, or --plan to learn what a test could show");
    if (!context.observed.empty() && context.plan)
        throw InputError(
            "--plan asks what a test could show before anything is measured: leave --observed out, or --plan");
    DiagnoseStudy study;
    study.site = context.read_site();
    const SiteFile& site = study.site;
    fs::path folder = context.results_folder(site);
    if (context.output.empty()) folder += context.plan ? "_plan" : "_diagnose";
    require_free_results(context, site, folder);
    std::vector<std::string> free = context.free.empty() ? site.settings.calibration.free : context.free;
    if (free.empty()) free = usual_free_keys(site);
    study.keys = read_free_keys(site, free);
    if (study.keys.problem.parameters.empty())
        throw InputError("a diagnosis asks what no parameter can make up for, and choices alone (" + listed(free) +
                         ") are none: free a number as well, as in --free soil.NAME.rolling=0.002:0.15:log");
    check_absent_effects(site.settings);
    const DiagnoseBudget budget = diagnose_budget(site.settings, study.keys.problem.parameters.size(), context.full);
    study.settings = budget.test;
    study.search = budget.search;
    require_enough_draws(site, study.settings);

    const SiteModel model = load_site(site);
    print_warnings(context, model.warnings);
    const InterruptScope interrupt;
    const ObservedSite observed =
        context.plan ? planned_test(site, model, context.instruments) : load_observed(site, model, context.observed);
    gis::require_inputs_elsewhere(folder, model.files);
    gis::require_inputs_elsewhere(folder, observed.files);
    print_warnings(context, observed.warnings);
    std::vector<std::string> suspicious;  // told at the end, too, but a user may want to mend them before it begins
    for (const Finding& f : observed.findings)
        if (f.severity == Severity::Warning) suspicious.push_back(context.observed + ": " + f.sentence);
    print_warnings(context, suspicious);
    require_enough_blocks(context, observed);
    require_something_to_fit(context, observed);
    warn_of_large_plan(context, observed);
    study.inputs = input_lines(model, observed);
    study.distances = observed.axis_text;
    fs::path journal = folder;
    journal += ".journal";
    if (context.resume && !fs::exists(journal))
        throw InputError("there is no diagnosis to go on with: " + journal.string() +
                         " does not exist; leave --resume out, or give the --output of the one that was stopped");
    if (fs::exists(journal) && !fs::is_directory(journal))
        throw InputError(journal.string() +
                         " is a file, but what a diagnosis simulates is kept in a folder of that name; move it, or "
                         "choose another --output");
    SimulationStore store(journal, subject_of(study, free, context));
    if (fs::exists(journal) && !context.resume) {
        if (!context.overwrite)
            throw InputError(
                journal.string() +
                " is what an unfinished diagnosis left: go on with --resume, or begin anew with --overwrite");
        store.remove();
    }
    StageProgress progress(context);
    const DiagnoseInput input{site,
                              model,
                              observed,
                              context.threads,
                              store,
                              [&](const std::string& stage, std::size_t done, std::size_t planned) {
                                  progress(stage, done, planned); }};
    context.plan ? plan_study(input, study) : run_study(input, study);
    progress.finish();
    if (study.interrupted) {
        if (fs::exists(journal))
            *context.err << "interrupted: what was simulated is kept in " << journal.string()
                         << ", and --resume goes on from there\n";
        else
            *context.err << "interrupted before a simulation was done: there is nothing to go on with\n";
        return ExitCode::Interrupted;
    }
    gis::write_results(folder, results_of(study, model, observed, folder), context.overwrite);
    store.remove();
    if (context.quiet) return ExitCode::Done;
    print_diagnosis(*context.out, study);
    for (std::size_t k = 0; k < study.site_files(); ++k)
        *context.out << "site file      " << (folder / extended_name(k)).string() << "\n";
    *context.out << "report         " << (folder / "report.html").string() << " (beside it diagnosis.json, figures)\n";
    return ExitCode::Done;
}

}  // namespace scree::cli
