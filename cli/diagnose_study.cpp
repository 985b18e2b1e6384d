// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_study.hpp"

#include "cli/calibration_journal.hpp"
#include "scree/base/error.hpp"
#include "scree/inference/calibration_loss.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace scree::cli {

namespace {

/// Steps of derivatives in shares of a parameter's range: about its uncertainty, within these [-].
constexpr double kLeastStep = 0.03, kMostStep = 0.15, kPlannedStep = 0.08;

/// Position in a range, 0 to 1, by ratios if it is searched so.
double to_unit(const CalibrationParameter& p, double value) {
    return p.logarithmic ? std::log(value / p.low) / std::log(p.high / p.low) : (value - p.low) / (p.high - p.low);
}
double from_unit(const CalibrationParameter& p, double u) {
    const double v = p.logarithmic ? p.low * std::pow(p.high / p.low, u) : p.low + u * (p.high - p.low);
    return std::clamp(v, p.low, p.high);
}

class Runner {
public:
    Runner(const DiagnoseInput& input, DiagnoseStudy& study)
        : in_(input), study_(study), test_(input.site, input.model, input.observed, study.keys, input.threads) {}

    void diagnose_test() {
        study_.baseline = calibrated("baseline", nullptr, {});
        if (study_.interrupted) return;
        study_.before = compared(study_.baseline, nullptr, study_.campaign);
        if (study_.interrupted) return;
        study_.catalogue = make_candidates(test_.site_at(study_.baseline.point), in_.model, in_.observed);
        study_.diagnosis =
            diagnose(problem(study_.baseline), measured(), study_.settings, simulation(study_.baseline), reporter());
        study_.interrupted = study_.diagnosis.interrupted;
        study_.verdict = study_.diagnosis.verdict;
        for (const EffectFinding& f : study_.diagnosis.answer)
            if (!study_.interrupted) refit(f);
        if (!study_.interrupted) judge_held_out();
    }

    void plan_test() {
        CalibratedModel as_given;
        for (const CalibrationParameter& p : study_.keys.problem.parameters) as_given.point.values.push_back(p.start);
        for (const CalibrationChoice& c : study_.keys.problem.choices) as_given.point.levels.push_back(c.start);
        study_.baseline = as_given;
        study_.catalogue = make_candidates(test_.site_at(as_given.point), in_.model, in_.observed);
        study_.diagnosis =
            scree::plan_test(problem(as_given), measured(), study_.settings, simulation(as_given), reporter());
        study_.interrupted = study_.diagnosis.interrupted;
    }

private:
    ObservationTable measured() const { return measured_table(in_.observed.observations, in_.observed.op); }

    std::function<void(const DiagnosisProgress&)> reporter() const {
        return [this](const DiagnosisProgress& p) { in_.progress(p.stage, p.done, p.planned); };
    }

    DiagnosisProblem problem(const CalibratedModel& model) const {
        DiagnosisProblem p;
        const auto& parameters = study_.keys.problem.parameters;
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            p.calibrated.push_back(to_unit(parameters[k], model.point.values[k]));
            p.given.push_back(to_unit(parameters[k], parameters[k].start));
            p.low.push_back(0.0);
            p.high.push_back(1.0);
            double step = kPlannedStep;
            if (k < model.result.parameters.size()) {
                const Interval& i = model.result.parameters[k].interval;
                step = 0.25 * (to_unit(parameters[k], i.high) - to_unit(parameters[k], i.low));
            }
            p.step.push_back(std::isfinite(step) ? std::clamp(step, kLeastStep, kMostStep) : kPlannedStep);
        }
        p.effects = study_.catalogue.for_core();
        p.blocks = in_.observed.observations.matched ? in_.observed.observations.blocks : std::vector<ObservedBlock>{};
        return p;
    }

    std::vector<Effect> effects_of(const std::vector<EffectDose>& doses) const {
        std::vector<Effect> effects;
        for (const EffectDose& d : doses)
            effects.push_back(study_.catalogue.candidates[d.effect].variants[d.variant].at(d.strength));
        return effects;
    }

    /// Whoever asks the same again gets it from disc.
    DiagnosisSimulation simulation(const CalibratedModel& model) const {
        return [this, levels = model.point.levels](const DiagnosisTask& task) -> std::optional<ObservationTable> {
            std::ostringstream words;
            words.precision(17);
            CalibrationPoint point{{}, levels};
            for (std::size_t k = 0; k < task.parameters.size(); ++k) {
                point.values.push_back(from_unit(study_.keys.problem.parameters[k], task.parameters[k]));
                words << point.values.back() << " ";
            }
            for (const std::size_t level : levels) words << level << " ";
            for (const EffectDose& d : task.effects) {
                const DiagnosisVariant& v = study_.catalogue.candidates[d.effect].variants[d.variant];
                words << effect_info(v.kind).name << " " << v.label << " " << v.value(d.strength) << " ";
            }
            words << task.seed << " " << task.repeats;
            if (auto kept = in_.store.find(words.str())) return kept;
            const std::vector<Effect> effects = effects_of(task.effects);
            const CampaignResult campaign = test_.run(test_.site_at(point), task.seed, task.repeats, effects);
            if (campaign.interrupted) return std::nullopt;
            ObservationTable table =
                simulated_table(campaign, in_.observed.observations, with_faults(in_.observed, effects).op, task.seed);
            in_.store.keep(words.str(), table);
            return table;
        };
    }

    static std::vector<Effect> dosed(const DiagnosisVariant* variant, double strength) {
        return variant ? std::vector<Effect>{variant->at(strength)} : std::vector<Effect>{};
    }
    static CalibrationPoint without_strength(CalibrationPoint point, const DiagnosisVariant* variant) {
        if (variant) point.values.pop_back();
        return point;
    }

    /// The same search for every model: ranges, budget and random numbers; an effect adds its strength to the parameters and begins where it was found.
    CalibratedModel calibrated(const std::string& name, const DiagnosisVariant* variant, const EffectFinding& found) {
        CalibrationProblem problem = study_.keys.problem;
        for (std::size_t k = 0; k < found.parameters.size(); ++k)
            problem.parameters[k].start = from_unit(problem.parameters[k], found.parameters[k]);
        if (variant) problem.parameters.push_back({"strength", 0.0, variant->most, found.strength, false});
        const CalibrationLoss loss(GapFunction(in_.observed.observations, in_.observed.op));
        problem.records = loss.records();
        std::error_code ignored;
        std::filesystem::create_directories(in_.store.folder(), ignored);
        const auto file = in_.store.file(name + ".jsonl");
        JournalFile journal(file, journal_subject(name), std::filesystem::exists(file, ignored));
        CalibrationJournal all = std::move(journal.journal);
        CalibratedModel model;
        model.result = calibrate(
            problem, study_.search,
            [&](const CalibrationTask& task) -> std::optional<SimulatedLoss> {
                const std::vector<Effect> effects = dosed(variant, variant ? task.point.values.back() : 0.0);
                const CampaignResult campaign =
                    test_.run(test_.site_at(without_strength(task.point, variant)), task.seed, task.repeats, effects);
                if (campaign.interrupted) return std::nullopt;
                if (!variant || effect_info(variant->kind).hook != EffectHook::Measurement)
                    return loss(campaign, task.seed);
                const CalibrationLoss faulty(
                    GapFunction(in_.observed.observations, with_faults(in_.observed, effects).op));
                return faulty(campaign, task.seed);
            },
            all,
            [&](const CalibrationProgress& p) {
                journal.write(all);
                in_.progress(variant ? "refit of " + name : "calibration", p.done, p.planned);
            });
        study_.interrupted = model.result.interrupted;
        if (study_.interrupted) return model;
        model.strength = variant ? model.result.best.values.back() : 0.0;
        model.point = without_strength(model.result.best, variant);
        model.evaluations = all.size();
        return model;
    }

    CompareStudy compared(const CalibratedModel& model, const DiagnosisVariant* variant, CampaignResult& campaign) {
        const std::vector<Effect> effects = dosed(variant, model.strength);
        const SiteFile site = test_.site_at(model.point);
        campaign =
            test_.run(site, static_cast<std::uint64_t>(site.settings.seed), study_.search.final_repeats, effects);
        study_.interrupted = campaign.interrupted;
        if (campaign.interrupted) return {};
        CompareStudy compared = make_study(site, in_.model, with_faults(in_.observed, effects), campaign);
        compared.repeats = in_.observed.observations.matched ? study_.search.final_repeats : 0;
        return compared;
    }

    void refit(const EffectFinding& f) {
        AnswerFit fit;
        fit.candidate = &study_.candidate_of(f);
        fit.variant = &study_.variant_of(f);
        fit.finding = f;
        fit.model = calibrated(fit.candidate->name + "_" + std::to_string(f.variant), fit.variant, f);
        if (study_.interrupted) return;
        fit.study = compared(fit.model, fit.variant, fit.campaign);
        study_.answers.push_back(std::move(fit));
    }

    /// A name that predicts blocks that it was not fitted to no better than the model without it is none.
    void judge_held_out() {
        if (study_.answers.empty() || study_.baseline.result.folds.empty()) return;
        const double without = study_.baseline.result.held_out.loss;
        const auto better = [&](const AnswerFit& a) { return a.model.result.held_out.loss < without; };
        if (std::any_of(study_.answers.begin(), study_.answers.end(), better)) {
            std::stable_partition(study_.answers.begin(), study_.answers.end(), better);
            return;
        }
        study_.demoted = "the blocks held out are predicted no better with " + study_.answers.front().candidate->name +
                         " than without it";
        study_.verdict = Verdict::Unknown;
    }

    std::string journal_subject(const std::string& name) const;

    const DiagnoseInput& in_;
    DiagnoseStudy& study_;
    FieldTest test_;
};

/// A journal begins with a line of JSON that says what it belongs to.
std::string Runner::journal_subject(const std::string& name) const {
    std::string quoted;
    for (const char c : in_.store.subject() + " " + name) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += c == '\n' ? ' ' : c;
    }
    return "{\"diagnosis\":\"" + quoted + "\"}";
}

/// Those with ids, else as many as were thrown.
std::size_t measured_blocks(const Observations& o) {
    return o.matched ? o.blocks.size() : static_cast<std::size_t>(std::max<std::int64_t>(o.thrown, 0));
}

}  // namespace

void run_study(const DiagnoseInput& input, DiagnoseStudy& study) {
    study.audit = input.observed.findings;
    study.blocks = measured_blocks(input.observed.observations);
    study.screens = input.observed.op.screens;
    study.in_plane = input.model.in_plane();
    if (input.observed.has_errors()) {
        study.verdict = Verdict::DataProblem;
        return;
    }
    Runner(input, study).diagnose_test();
}

void plan_study(const DiagnoseInput& input, DiagnoseStudy& study) {
    study.planning = true;
    study.blocks = measured_blocks(input.observed.observations);
    study.screens = input.observed.op.screens;
    study.in_plane = input.model.in_plane();
    Runner(input, study).plan_test();
}

SiteFile extended_site(const DiagnoseStudy& study, const AnswerFit& answer) {
    SiteFile site = with_changes(study.site, study.keys.changes(answer.model.point));
    EffectSettings entry;
    entry.effect = answer.variant->at(answer.model.strength);
    entry.soil = answer.variant->soil;
    if (!std::isnan(answer.variant->from)) {
        entry.place.file = "results.gpkg";
        entry.place.layer = "effect_zone";
    }
    site.settings.effects.push_back(std::move(entry));
    return site;
}

}  // namespace scree::cli
