// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/account.hpp"
#include "cli/calibrate_report.hpp"
#include "cli/calibration_journal.hpp"
#include "cli/campaign_layers.hpp"
#include "cli/commands.hpp"
#include "cli/field_test.hpp"
#include "cli/json.hpp"
#include "cli/progress.hpp"
#include "cli/settings.hpp"
#include "cli/text.hpp"
#include "gis/dataset.hpp"
#include "gis/results_writer.hpp"
#include "scree/inference/calibration_loss.hpp"

#include <algorithm>
#include <ostream>

namespace scree::cli {

namespace {

namespace fs = std::filesystem;

/// Everything that the simulations depend on, on one line: what a journal belongs to.
std::string subject_of(const SiteFile& site, const SiteModel& model, const ObservedSite& observed, const FreeKeys& keys,
                       const std::vector<std::string>& free) {
    Json json;
    json["calibration"] = site.settings.name;
    json["program"] = "scree " + version_number();
    json["free"] = free;
    SiteSettings portable = site.settings;
    portable.output_directory.clear();
    portable.calibration.free.clear();
    json["settings"] =
        settings_as_toml(portable, [](const std::string& path) { return fs::path(path).filename().string(); });
    for (const gis::InputFile& file : model.files) json["inputs"].push_back(file.sha256);
    for (const gis::InputFile& file : observed.files) json["observations"].push_back(file.sha256);
    json["parameters"] = keys.problem.parameters.size();
    return json_text(json, -1);
}

/// The journal beside the folder of results: it must outlive an interruption.
fs::path journal_path(const fs::path& folder) {
    fs::path path = folder;
    path += ".journal.jsonl";
    return path;
}

void require_no_journal(const Context& context, const fs::path& journal) {
    if (context.resume || !fs::exists(journal)) return;
    if (context.overwrite) {
        if (!JournalFile::is_one(journal))
            throw InputError(journal.string() +
                             " is not what a calibration left, and is left alone; move it, or choose another --output");
        return;
    }
    throw InputError(journal.string() +
                     " is what an unfinished calibration left: go on with --resume, or begin anew with --overwrite");
}

gis::ResultsPackage results_of(const CalibrationReport& report, const SiteModel& model, const ObservedSite& observed,
                               const CampaignResult& calibrated, const fs::path& folder, const std::string& journal) {
    gis::ResultsPackage package;
    package.frame = model.terrain.data.frame;
    package.title = report.before.settings.name + ": calibrated";
    for (gis::VectorLayer& layer : campaign_vectors(model, calibrated)) package.vectors.push_back(std::move(layer));
    package.provenance = {{"program", "scree " + version()},
                          {"site", report.before.settings.name},
                          {"seed", std::to_string(report.settings.seed)}};
    add_counts(package.provenance, calibrated);
    for (const std::string& line : report.inputs) package.provenance.push_back({"input", line});
    const std::vector<Figure> figures = calibrate_figures(report);
    std::vector<Figure> compared;
    for (Figure& f : compare_figures(report.after_study, model, observed, calibrated))
        if (f.file == "overview.svg" || f.file == "gaps.svg" || f.file == "map.svg") compared.push_back(std::move(f));
    for (const std::vector<Figure>* list : {&figures, &std::as_const(compared)})
        for (const Figure& f : *list) package.files.push_back({"figures/" + f.file, f.svg});
    package.files.push_back({"calibrated.toml", calibrated_toml(report, folder)});
    package.files.push_back({"calibrate.json", calibrate_json(report)});
    package.files.push_back({"report.html", calibrate_html(report, figures, compared)});
    package.files.push_back({"journal.jsonl", journal});
    return package;
}

}  // namespace

ExitCode run_calibrate(const Context& context) {
    const SiteFile site = context.read_site();
    fs::path folder = context.results_folder(site);
    if (context.output.empty()) folder += "_calibrate";
    require_free_results(context, site, folder);
    require_no_journal(context, journal_path(folder));
    CalibrationReport report;
    report.before = report.after = site;
    const std::vector<std::string>& free = context.free.empty() ? site.settings.calibration.free : context.free;
    report.keys = read_free_keys(site, free);

    const SiteModel model = load_site(site);
    const ObservedSite observed = load_observed(site, model, context.observed);
    gis::require_inputs_elsewhere(folder, model.files);
    gis::require_inputs_elsewhere(folder, observed.files);
    print_warnings(context, model.warnings);
    if (print_findings(context, observed)) return ExitCode::BadInput;
    const CalibrationLoss loss(GapFunction(observed.observations, observed.op));
    if (loss.observables().empty())
        throw InputError(
            "the measurements hold nothing that a simulation could be fitted to: stops, crossings of screens or shares "
            "of at least two blocks");
    loss.describe(report.keys.problem);
    report.observables = loss.observables();
    report.settings = site.settings.calibration.search;
    report.settings.seed = static_cast<std::uint64_t>(site.settings.seed);
    report.inputs = input_lines(model, observed);

    JournalFile journal(journal_path(folder), subject_of(site, model, observed, report.keys, free), context.resume);
    report.journal = std::move(journal.journal);
    const auto resumed = static_cast<std::int64_t>(report.journal.size());
    const FieldTest test(site, model, observed, report.keys, context.threads);
    const InterruptScope interrupt;
    const std::size_t planned = planned_evaluations(report.keys.problem, report.settings);
    Progress progress(context, "simulations", static_cast<std::int64_t>(planned));
    progress.skip(resumed);
    report.result = calibrate(
        report.keys.problem, report.settings,
        [&](const CalibrationTask& task) -> std::optional<SimulatedLoss> {
            const CampaignResult campaign = test.run(test.site_at(task.point), task.seed, task.repeats);
            if (campaign.interrupted) return std::nullopt;
            return loss(campaign, task.seed);
        },
        report.journal,
        [&](const CalibrationProgress& p) {
            journal.write(report.journal);
            progress.note(std::string(kCalibrationStageNames[static_cast<std::size_t>(p.stage)]) + ", gap " +
                          gap_number(p.gap) + ", best so far " + gap_number(p.best_gap));
            progress.update(static_cast<std::int64_t>(p.done));
        });
    progress.finish(static_cast<std::int64_t>(report.journal.size()));
    const auto stopped = [&] {
        *context.err << "interrupted after " << report.journal.size() << " of " << planned
                     << " simulations: they are kept in " << journal.file().string()
                     << ", and --resume goes on from there\n";
        return ExitCode::Interrupted;
    };
    if (report.result.interrupted) return stopped();

    report.after = test.site_at(report.result.best);
    const auto study = [&](const SiteFile& of, CampaignResult& campaign) {
        campaign = test.run(of, static_cast<std::uint64_t>(of.settings.seed), report.settings.final_repeats);
        return campaign.interrupted ? CompareStudy{} : make_study(of, model, observed, campaign);
    };
    CampaignResult before, after;
    report.before_study = study(site, before);
    report.after_study = study(report.after, after);
    if (before.interrupted || after.interrupted) return stopped();
    report.before_study.repeats = report.after_study.repeats =
        observed.observations.matched ? report.settings.final_repeats : 0;
    report.blocks = report.after_study.blocks;
    for (const CalibrationEvaluation& e : report.journal) report.thrown += e.task.repeats * blocks_of(observed);

    gis::write_results(folder, results_of(report, model, observed, after, folder, journal.text()), context.overwrite);
    journal.remove();
    if (context.quiet) return ExitCode::Done;
    print_calibration(*context.out, report);
    *context.out << "site file      " << (folder / "calibrated.toml").string() << "\n"
                 << "report         " << (folder / "report.html").string()
                 << " (beside it calibrate.json, figures, all simulations in journal.jsonl)\n";
    return ExitCode::Done;
}

}  // namespace scree::cli
