// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_models.hpp"

#include "cli/calibration_journal.hpp"
#include "cli/diagnose_refits.hpp"
#include "scree/inference/calibration_loss.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

namespace scree::cli {

namespace {

constexpr std::int64_t kFull = 3;

/// How many strengths a refit has to find.
std::size_t strengths_of(const std::vector<AnsweredEffect>& effects) {
    return static_cast<std::size_t>(
        std::count_if(effects.begin(), effects.end(), [](const AnsweredEffect& e) { return e.has_strength(); }));
}

CalibrationPoint without_strengths(CalibrationPoint point, std::size_t count) {
    point.values.resize(point.values.size() - count);
    return point;
}

void take_best(CalibratedModel& model, std::size_t strengths) {
    const std::vector<double>& best = model.result.best.values;
    model.strengths.assign(best.end() - static_cast<std::ptrdiff_t>(strengths), best.end());
    model.point = without_strengths(model.result.best, strengths);
}

/// Those of the blocks of these records.
void add_rows(const ObservationTable& table, const std::vector<std::size_t>& records, const ObservationTable& measured,
              ObservationTable& all) {
    if (all.columns.empty()) {
        all.columns = table.columns;
        all.values.resize(table.columns.size());
    }
    std::set<std::int32_t> chosen;
    for (const std::size_t record : records)
        if (record < measured.rows()) chosen.insert(measured.block[record]);  // others are counts
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if (!chosen.contains(table.block[row])) continue;
        all.block.push_back(table.block[row]);
        for (std::size_t k = 0; k < table.columns.size(); ++k) all.values[k].push_back(table.values[k][row]);
    }
}

/// What a search said of the parameters that it ended with holds for no others.
void forget_estimates(CalibrationResult& result, const std::vector<CalibrationParameter>& parameters,
                      const std::vector<AnsweredEffect>& effects) {
    std::vector<Interval> ranges;
    for (const CalibrationParameter& p : parameters) ranges.push_back({p.low, p.high});
    for (const AnsweredEffect& e : effects)
        if (e.has_strength()) ranges.push_back(strength_range(e));
    for (std::size_t k = 0; k < result.parameters.size() && k < ranges.size(); ++k) {
        const double value = result.best.values[k];
        result.parameters[k] = {value, ranges[k], Identification::Not, value <= ranges[k].low, value >= ranges[k].high};
    }
}

}  // namespace

DiagnoseBudget diagnose_budget(const SiteSettings& site, std::size_t free_parameters, bool full) {
    DiagnoseBudget budget{site.diagnosis, site.calibration.search};
    budget.test.seed = budget.search.seed = static_cast<std::uint64_t>(site.seed);
    if (full) {
        budget.test.reference_repeats *= kFull;
        budget.test.repeats *= kFull;
        budget.search.starts *= 2;
        budget.search.generations *= 2;
        budget.search.repeats *= kFull;
        budget.search.final_repeats *= kFull;
    }
    budget.search = with_budget_of(budget.search, free_parameters + 1);  // of one effect; the model without has no less
    return budget;
}

double to_unit(const CalibrationParameter& p, double value) {
    return p.logarithmic ? std::log(value / p.low) / std::log(p.high / p.low) : (value - p.low) / (p.high - p.low);
}
double from_unit(const CalibrationParameter& p, double u) {
    const double v = p.logarithmic ? p.low * std::pow(p.high / p.low, u) : p.low + u * (p.high - p.low);
    return std::clamp(v, p.low, p.high);
}

CalibratedModel at_start_of(const CalibrationResult& refit, CalibratedModel model) {
    model.result.best = refit.start;
    model.result.best_fit = refit.start_fit;
    for (std::size_t k = 0; k < model.result.places.size(); ++k) model.result.places[k].best = refit.places[k].start;
    model.as_followed = true;
    take_best(model, model.strengths.size());
    return model;
}

bool in_space(const std::vector<AnsweredEffect>& effects) {
    return strengths_of(effects) < effects.size();
}

Interval strength_range(const AnsweredEffect& e) {
    const EffectFinding& f = e.finding;
    if (!(f.strength_deviation > 0.0) || std::isinf(f.strength_deviation)) return {0.0, e.variant.most};
    const double reach = kNinetyFive * f.strength_deviation;
    return {std::max(f.strength - reach, 0.0), std::min(f.strength + reach, e.variant.most)};
}

std::vector<Effect> DiagnosedModels::dosed(const std::vector<AnsweredEffect>& effects,
                                           const CalibrationPoint& point) const {
    std::vector<Effect> all;
    const std::size_t strengths = strengths_of(effects);
    if (strengths == 0) return all;
    const SiteFile site = test_.site_at(without_strengths(point, strengths));
    std::size_t next = point.values.size() - strengths;
    for (const AnsweredEffect& e : effects)
        if (e.has_strength()) all.push_back(e.variant.on_ground(site.settings.soils).at(point.values[next++]));
    return all;
}

CalibratedModel DiagnosedModels::calibrated(const std::string& name, const std::vector<AnsweredEffect>& effects,
                                            const std::vector<double>& begin) {
    CalibrationProblem problem = study_.keys.problem;
    for (std::size_t k = 0; k < begin.size(); ++k)
        problem.parameters[k].start = from_unit(problem.parameters[k], begin[k]);
    for (std::size_t k = 0; !begin.empty() && k < study_.tested_levels.size(); ++k)
        problem.choices[k].start = study_.tested_levels[k];
    std::string stage = effects.empty() ? "calibration" : "refit of";
    for (const AnsweredEffect& e : effects)
        stage.append(&e == &effects.front() ? " " : " and ").append(e.candidate->name);
    const double space = in_space(effects) ? 1.0 : 0.0;
    const std::size_t strengths = strengths_of(effects);
    for (const AnsweredEffect& e : effects) {
        if (!e.has_strength()) continue;
        const Interval range = strength_range(e);
        problem.parameters.push_back(
            {"strength of " + e.candidate->name, range.low, range.high, e.finding.strength, false});
    }
    const CalibrationLoss loss(GapFunction(in_.observed.observations, in_.observed.op));
    loss.describe(problem);
    std::error_code ignored;
    const auto file = in_.store.file(name + ".jsonl");
    JournalFile journal(file, journal_subject(name), std::filesystem::exists(file, ignored));
    CalibrationJournal all = std::move(journal.journal);
    const bool faulty = std::any_of(effects.begin(), effects.end(), [](const AnsweredEffect& e) {
        return e.has_strength() && effect_info(e.variant.kind).hook == EffectHook::Measurement;
    });
    CalibratedModel model;
    model.result = calibrate(
        problem, study_.search,
        [&](const CalibrationTask& task) -> std::optional<SimulatedLoss> {
            const std::vector<Effect> acting = dosed(effects, task.point);
            const CampaignResult campaign = test_.run(test_.site_at(without_strengths(task.point, strengths)),
                                                      task.seed, task.repeats, acting, false, space);
            if (campaign.interrupted) return std::nullopt;
            if (!faulty) return loss(campaign, task.seed);
            const CalibrationLoss of_faulty(
                GapFunction(in_.observed.observations, with_faults(in_.observed, acting).op));
            return of_faulty(campaign, task.seed);
        },
        all,
        [&](const CalibrationProgress& p) {
            journal.write(all);
            in_.progress(stage, p.done, p.planned);
        });
    study_.interrupted = model.result.interrupted;
    if (study_.interrupted) return model;
    take_best(model, strengths);
    model.evaluations = all.size();
    return model;
}

CompareStudy DiagnosedModels::compared(const CalibratedModel& model, const std::vector<AnsweredEffect>& effects,
                                       CampaignResult& campaign) {
    const std::vector<Effect> acting = dosed(effects, model.result.best);
    const SiteFile site = test_.site_at(model.point);
    campaign = test_.run(site, static_cast<std::uint64_t>(site.settings.seed), study_.search.final_repeats, acting,
                         true, in_space(effects) ? 1.0 : 0.0);
    study_.interrupted = campaign.interrupted;
    if (campaign.interrupted) return {};
    CompareStudy compared = make_study(site, in_.model, with_faults(in_.observed, acting), campaign);
    compared.repeats = in_.observed.observations.matched ? study_.search.final_repeats : 0;
    return compared;
}

void DiagnosedModels::stay_as_followed(const CalibrationResult& refit, const std::vector<AnsweredEffect>& effects,
                                       CalibratedModel& model, CompareStudy& compared_model, CampaignResult& campaign) {
    if (!is_far_beyond(compared_model)) return;
    CalibratedModel followed = at_start_of(refit, model);
    CampaignResult of_followed;
    CompareStudy study = compared(followed, effects, of_followed);
    if (study_.interrupted || !leaves_less(study, compared_model, compared_model)) return;
    forget_estimates(followed.result, study_.keys.problem.parameters, effects);
    model = std::move(followed);
    compared_model = std::move(study);
    campaign = std::move(of_followed);
}

std::vector<Gap> DiagnosedModels::held_out_gaps(const CalibratedModel& model,
                                                const std::vector<AnsweredEffect>& effects) {
    const std::vector<CalibrationFold>& folds = model.result.folds;
    if (folds.empty() || !in_.observed.observations.matched) return {};
    const auto seed = static_cast<std::uint64_t>(in_.site.settings.seed);
    const GapFunction gaps(in_.observed.observations, in_.observed.op);
    ObservationTable all;
    for (std::size_t f = 0; f < folds.size(); ++f) {
        const std::vector<Effect> acting = dosed(effects, folds[f].point);
        const CampaignResult campaign =
            test_.run(test_.site_at(without_strengths(folds[f].point, strengths_of(effects))), seed,
                      study_.search.final_repeats, acting, false, in_space(effects) ? 1.0 : 0.0);
        study_.interrupted = campaign.interrupted;
        if (campaign.interrupted) return {};
        const ObservationTable table =
            simulated_table(campaign, in_.observed.observations, with_faults(in_.observed, acting).op, seed);
        add_rows(table, folds[f].held_out, gaps.measured(), all);
        in_.progress("blocks held out", f + 1, folds.size());
    }
    std::vector<Gap> of_each;
    const DiscrepancySettings settings{in_.site.settings.observed.draws, seed, true};
    for (const ObservableGap& gap :
         compare_tables(gaps.measured(), all, gaps.observables(), column_scales(all), settings).observables)
        of_each.push_back(gap.pooled);
    return of_each;
}

/// A journal begins with a line of JSON that says what it belongs to.
std::string DiagnosedModels::journal_subject(const std::string& name) const {
    std::string quoted;
    for (const char c : in_.store.subject() + " " + name) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += c == '\n' ? ' ' : c;
    }
    return "{\"diagnosis\":\"" + quoted + "\"}";
}

}  // namespace scree::cli
