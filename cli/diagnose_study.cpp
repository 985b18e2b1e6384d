// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_study.hpp"

#include "cli/calibration_journal.hpp"
#include "cli/diagnose_refits.hpp"
#include "cli/further_instruments.hpp"
#include "cli/nearest_models.hpp"
#include "scree/base/error.hpp"
#include "scree/inference/calibration_loss.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

namespace scree::cli {

namespace {

/// Steps of derivatives in shares of a parameter's range: about its uncertainty, within these [-].
constexpr double kLeastStep = 0.03, kMostStep = 0.15, kPlannedStep = 0.08;
/// Small differences between a few effects need so many times the simulations [-].
constexpr std::int64_t kGroupRepeats = 4;

/// Position in a range, 0 to 1, by ratios if it is searched so.
double to_unit(const CalibrationParameter& p, double value) {
    return p.logarithmic ? std::log(value / p.low) / std::log(p.high / p.low) : (value - p.low) / (p.high - p.low);
}
double from_unit(const CalibrationParameter& p, double u) {
    const double v = p.logarithmic ? p.low * std::pow(p.high / p.low, u) : p.low + u * (p.high - p.low);
    return std::clamp(v, p.low, p.high);
}

/// Where a strength is with 95 %, as all residuals of the test say; any that is allowed if they do not. A refit minimises one distance, which often tells
/// little of a strength: it has to stay here.
Interval strength_range(const AnsweredEffect& e) {
    const EffectFinding& f = e.finding;
    if (!(f.strength_deviation > 0.0) || std::isinf(f.strength_deviation)) return {0.0, e.variant.most};
    const double reach = kNinetyFive * f.strength_deviation;
    return {std::max(f.strength - reach, 0.0), std::min(f.strength + reach, e.variant.most)};
}

/// None where nobody knows which record is of which block.
std::vector<ObservedBlock> known_blocks(const ObservedSite& observed) {
    return observed.observations.matched ? observed.observations.blocks : std::vector<ObservedBlock>{};
}

/// How many strengths a refit has to find.
std::size_t strengths_of(const std::vector<AnsweredEffect>& effects) {
    return static_cast<std::size_t>(
        std::count_if(effects.begin(), effects.end(), [](const AnsweredEffect& e) { return e.has_strength(); }));
}

bool in_space(const std::vector<AnsweredEffect>& effects) {
    return strengths_of(effects) < effects.size();
}

/// That count in the overall gap.
std::ptrdiff_t observables_of(const CompareStudy& study) {
    return std::ranges::count_if(study.observables, &ObservableGap::counts, &ComparedObservable::gap);
}

/// What acts in a simulation beside the site's own effects.
struct Acting {
    std::vector<Effect> effects;
    double in_space = 0.0;  ///< share of the blocks [-]
};

class Runner {
public:
    Runner(const DiagnoseInput& input, DiagnoseStudy& study)
        : in_(input),
          study_(study),
          test_(input.site, input.model, input.observed, study.keys, input.threads),
          nearest_(GapFunction(input.observed.observations, input.observed.op)) {}

    void diagnose_test() {
        study_.baseline = calibrated("baseline", {}, {});
        if (study_.interrupted) return;
        study_.tested_levels = study_.baseline.point.levels;
        study_.before = compared(study_.baseline, {}, study_.campaign);
        if (study_.interrupted) return;
        study_.catalogue = make_candidates(test_.site_at(study_.baseline.point), in_.model, in_.observed, study_.keys,
                                           test_.no_space());
        study_.diagnosis = diagnose(problem(study_.baseline, study_.catalogue), measured(), study_.settings,
                                    simulation(study_.baseline, study_.catalogue), reporter());
        study_.interrupted = study_.diagnosis.interrupted;
        study_.verdict = study_.diagnosis.verdict;
        if (!study_.interrupted && !study_.diagnosis.answer.empty()) calibrate_again();
        if (study_.diagnosis.together) {
            if (!study_.interrupted) refit(study_.diagnosis.answer);
        } else {
            for (const EffectFinding& f : study_.diagnosis.answer)
                if (!study_.interrupted) refit({f});
        }
        if (!study_.interrupted) judge_refits(study_);
        if (!study_.interrupted && !study_.answer()) tell_without();
        hold_out();
        restart_at_screens();
        if (study_.interrupted || !in_.site.settings.diagnosis_further) return;
        if (study_.verdict == Verdict::Unknown) try_forces();
        if (study_.verdict == Verdict::Group) try_instruments_on_group();
    }

    /// Answers are calibrated from where the diagnosis followed them to. So is the model without them, which stays where it was if that leaves more.
    void calibrate_again() {
        const CalibratedModel again = calibrated("baseline_again", {}, study_.diagnosis.parameters);
        if (study_.interrupted) return;
        if (again.result.best_fit.loss < study_.baseline.result.best_fit.loss) {
            study_.baseline = again;
            study_.before = compared(study_.baseline, {}, study_.campaign);
        }
        if (!study_.interrupted) stay_as_followed(again.result, {}, study_.baseline, study_.before, study_.campaign);
    }

    /// Q of a test is what is left after a linear step of the parameters, so that a model whose Q is small may still be a step away from what it could be.
    /// And what leaves least in the residual space may leave more over all than what the diagnosis has seen on its way there.
    void tell_without() {
        if (!tell_nearest({study_.tested_point(), study_.asked_point()}) || !study_.told().overall.beyond_chance())
            return;
        tell_nearest(nearest_.points());
    }

    bool tell_nearest(const std::vector<CalibrationPoint>& points) {
        for (const CalibrationPoint& point : points) {
            MovedModel moved{point, {}, {}};
            moved.study = compared(model_at(point), {}, moved.campaign);
            if (study_.interrupted) return false;
            if (observables_of(moved.study) >= observables_of(study_.told()) &&
                moved.study.overall.gap < study_.told().overall.gap)
                study_.moved = std::move(moved);
        }
        return true;
    }

    void restart_at_screens() {
        if (study_.interrupted) return;
        auto innovations =
            screen_innovations(test_, test_.site_at(study_.baseline.point), in_.observed, study_.campaign);
        study_.interrupted = !innovations;
        if (innovations) study_.innovations = std::move(*innovations);
    }

    /// Every observable of blocks that the fold which predicts them was not fitted to: with the answers, and without.
    void hold_out() {
        if (!study_.interrupted && !study_.answers.empty()) study_.held_out = held_out_gaps(study_.baseline, {});
        for (AnswerFit& a : study_.answers)
            if (!study_.interrupted) a.held_out = held_out_gaps(a.model, a.effects);
    }

    /// What has no name: when, where and for which blocks it acts, as forces tell whose fingerprints are held against what the model leaves.
    void try_forces() {
        const CalibratedModel model = tested_model();
        study_.forces = make_forces(test_.site_at(model.point), in_.model, in_.observed, study_.keys);
        study_.by_force = scree::plan_test(problem(model, study_.forces), measured(), study_.settings,
                                           simulation(model, study_.forces), reporter());
        study_.interrupted = study_.by_force.interrupted;
    }

    /// What would tell the members of a group apart.
    void try_instruments_on_group() {
        DiagnosisCatalogue members;
        for (const AnswerFit& a : study_.answers) {
            members.candidates.push_back(*a.effects.front().candidate);
            members.candidates.back().variants = {a.effects.front().variant};
        }
        std::vector<FurtherInstrument> instruments{{"the same instruments", {}}};
        for (FurtherInstrument& i : further_instruments(in_.observed)) instruments.push_back(std::move(i));
        DiagnosisSettings settings = study_.settings;
        settings.repeats *= kGroupRepeats;
        try_instruments(tested_model(), members, instruments, settings);
    }

    void try_instruments(const CalibratedModel& model, const DiagnosisCatalogue& catalogue,
                         const std::vector<FurtherInstrument>& instruments, const DiagnosisSettings& settings) {
        if (instruments.empty()) return;
        ObservedSite filmed = in_.observed;
        for (const FurtherInstrument& i : instruments) filmed.op.add_impacts(i.impacts);
        const FieldTest test(in_.site, in_.model, filmed, study_.keys, in_.threads);
        const CampaignResult once = test.run(test.site_at(model.point), study_.settings.seed, 1);
        study_.interrupted = once.interrupted;
        if (study_.interrupted) return;
        const ObservedSite all = with_instruments(filmed, instruments, once, in_.site.settings.observed);
        const ObservationTable would_be = side_by_side(all.observations, all.op);
        const DiagnosisSimulation simulated = simulation(model, catalogue, test, all, "with all instruments ");
        for (const FurtherInstrument& instrument : instruments) {
            Diagnosis plan = scree::plan_test(
                problem(model, catalogue), with_one_instrument(would_be, in_.observed, instrument), settings,
                [&](const DiagnosisTask& task) -> std::optional<ObservationTable> {
                    auto table = simulated(task);
                    if (table) table = with_one_instrument(*table, in_.observed, instrument);
                    return table;
                },
                [&](const DiagnosisProgress& p) { in_.progress("with " + instrument.name, p.done, p.planned); });
            study_.interrupted = plan.interrupted;
            if (study_.interrupted) return;
            study_.further.push_back({instrument.name, std::move(plan)});
        }
    }

    CalibratedModel model_at(const CalibrationPoint& point) const {
        CalibratedModel model = study_.baseline;
        model.point = model.result.best = point;
        return model;
    }
    CalibratedModel tested_model() const { return model_at(study_.tested_point()); }

    void plan_test() {
        CalibratedModel as_given;
        for (const CalibrationParameter& p : study_.keys.problem.parameters) as_given.point.values.push_back(p.start);
        for (const CalibrationChoice& c : study_.keys.problem.choices) as_given.point.levels.push_back(c.start);
        study_.baseline = as_given;
        study_.tested_levels = as_given.point.levels;
        study_.catalogue =
            make_candidates(test_.site_at(as_given.point), in_.model, in_.observed, study_.keys, test_.no_space());
        study_.diagnosis = scree::plan_test(problem(as_given, study_.catalogue), measured(), study_.settings,
                                            simulation(as_given, study_.catalogue), reporter());
        study_.interrupted = study_.diagnosis.interrupted;
        if (study_.interrupted) return;
        DiagnosisCatalogue best;  // of every effect the variant that is seen first
        for (const DiagnosisCandidate& c : study_.catalogue.candidates) best.candidates.push_back(c);
        for (const EffectFinding& f : study_.diagnosis.findings)
            best.candidates[f.effect].variants = {std::isfinite(f.smallest_seen)
                                                      ? study_.catalogue.variant(f.effect, f.seen_variant, f.seen_on)
                                                      : study_.variant_of(f)};
        try_instruments(as_given, best, further_instruments(in_.observed), study_.settings);
    }

private:
    ObservationTable measured() const { return side_by_side(in_.observed.observations, in_.observed.op); }

    std::function<void(const DiagnosisProgress&)> reporter() const {
        return [this](const DiagnosisProgress& p) { in_.progress(p.stage, p.done, p.planned); };
    }

    DiagnosisProblem problem(const CalibratedModel& model, const DiagnosisCatalogue& catalogue) const {
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
        p.effects = catalogue.for_core();
        p.blocks = known_blocks(in_.observed);
        return p;
    }

    static Acting acting_of(const std::vector<EffectDose>& doses, const DiagnosisCatalogue& catalogue,
                            const SiteFile& site) {
        Acting acting;
        for (const EffectDose& d : doses) {
            const DiagnosisVariant variant = catalogue.variant(d.effect, d.variant, d.on);
            if (variant.space)
                acting.in_space = variant.value(d.strength);
            else
                acting.effects.push_back(variant.on_ground(site.settings.soils).at(d.strength));
        }
        return acting;
    }

    DiagnosisSimulation simulation(const CalibratedModel& model, const DiagnosisCatalogue& catalogue) {
        return simulation(model, catalogue, test_, in_.observed, "");
    }
    /// As `observed` would have measured it, which `how` says in words. Whoever asks the same again gets it from disc.
    DiagnosisSimulation simulation(const CalibratedModel& model, const DiagnosisCatalogue& catalogue,
                                   const FieldTest& test, const ObservedSite& observed, const std::string& how) {
        return [this, &catalogue, &test, &observed, how,
                levels = model.point.levels](const DiagnosisTask& task) -> std::optional<ObservationTable> {
            std::ostringstream words;
            words.precision(17);
            words << how;
            CalibrationPoint point{{}, levels};
            for (std::size_t k = 0; k < task.parameters.size(); ++k) {
                point.values.push_back(from_unit(study_.keys.problem.parameters[k], task.parameters[k]));
                words << point.values.back() << " ";
            }
            for (const std::size_t level : levels) words << level << " ";
            for (const EffectDose& d : task.effects) {
                const DiagnosisVariant& v = catalogue.candidates[d.effect].variants[d.variant];
                words << v.form() << " " << v.label << " " << v.parameter << " " << v.reference << " "
                      << (v.probe ? "probe " : "") << d.strength << " ";
                if (d.on) words << d.on->from << " " << d.on->to << " ";
            }
            words << task.seed << " " << task.repeats;
            const auto seen = [&](const ObservationTable& table) {
                if (task.effects.empty() && how.empty()) nearest_.look_at(point, table);
            };
            if (auto kept = in_.store.find(words.str())) {
                seen(*kept);
                return kept;
            }
            const SiteFile site = test_.site_at(point);
            const Acting acting = acting_of(task.effects, catalogue, site);
            const CampaignResult campaign =
                test.run(site, task.seed, task.repeats, acting.effects, false, acting.in_space);
            if (campaign.interrupted) return std::nullopt;
            ObservationTable table =
                simulated_table(campaign, observed.observations, with_faults(observed, acting.effects).op, task.seed);
            in_.store.keep(words.str(), table);
            seen(table);
            return table;
        };
    }

    /// The effects at the strengths that are the last parameters of a point.
    std::vector<Effect> dosed(const std::vector<AnsweredEffect>& effects, const CalibrationPoint& point) const {
        std::vector<Effect> all;
        const std::size_t strengths = strengths_of(effects);
        if (strengths == 0) return all;
        const SiteFile site = test_.site_at(without_strengths(point, strengths));
        std::size_t next = point.values.size() - strengths;
        for (const AnsweredEffect& e : effects)
            if (e.has_strength()) all.push_back(e.variant.on_ground(site.settings.soils).at(point.values[next++]));
        return all;
    }
    static CalibrationPoint without_strengths(CalibrationPoint point, std::size_t count) {
        point.values.resize(point.values.size() - count);
        return point;
    }

    /// The same search for every model: ranges, budget and random numbers; effects add their strengths to the parameters. Begins at these parameters, in the
    /// unit cube, or where the site has them.
    CalibratedModel calibrated(const std::string& name, const std::vector<AnsweredEffect>& effects,
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
        problem.records = loss.records();
        problem.places = loss.places();
        std::error_code ignored;
        std::filesystem::create_directories(in_.store.folder(), ignored);
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

    static void take_best(CalibratedModel& model, std::size_t strengths) {
        const std::vector<double>& best = model.result.best.values;
        model.strengths.assign(best.end() - static_cast<std::ptrdiff_t>(strengths), best.end());
        model.point = without_strengths(model.result.best, strengths);
    }

    CompareStudy compared(const CalibratedModel& model, const std::vector<AnsweredEffect>& effects,
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

    /// Gaps of the observables, in their order, each block simulated at the parameters of the fold that left it out. Empty without folds, or where nobody knows
    /// which record is of which block.
    std::vector<Gap> held_out_gaps(const CalibratedModel& model, const std::vector<AnsweredEffect>& effects) {
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

    /// Those of the blocks of these records.
    static void add_rows(const ObservationTable& table, const std::vector<std::size_t>& records,
                         const ObservationTable& measured, ObservationTable& all) {
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

    /// A refit minimises a part of what is compared, and may end far from the rest. Where it began, at what was followed, all measurements had their part. One
    /// rule for the model with and without effects. Blocks held out were predicted by refits either way.
    void stay_as_followed(const CalibrationResult& refit, const std::vector<AnsweredEffect>& effects,
                          CalibratedModel& model, CompareStudy& compared_model, CampaignResult& campaign) {
        if (!is_far_beyond(compared_model)) return;
        CalibratedModel followed = model;
        followed.result.best = refit.start;
        followed.result.best_fit = refit.start_fit;
        followed.as_followed = true;
        take_best(followed, followed.strengths.size());
        CampaignResult of_followed;
        CompareStudy study = compared(followed, effects, of_followed);
        if (study_.interrupted || !(study.overall.gap < compared_model.overall.gap)) return;
        model = std::move(followed);
        compared_model = std::move(study);
        campaign = std::move(of_followed);
    }

    /// What an answer changes for whoever builds at a screen is asked where that stands, and not where it is said to have stood in the test.
    bool throw_on_the_ground(AnswerFit& fit, const SiteFile& site) {
        std::vector<Effect> acting = dosed(fit.effects, fit.model.result.best);
        if (std::erase_if(acting, [](const Effect& e) { return e.kind == EffectKind::ScreenShift; }) == 0) return true;
        fit.campaign = test_.run(site, static_cast<std::uint64_t>(site.settings.seed), study_.search.final_repeats,
                                 acting, true, in_space(fit.effects) ? 1.0 : 0.0);
        study_.interrupted = fit.campaign.interrupted;
        return !study_.interrupted;
    }

    AnsweredEffect answered(const EffectFinding& f) const {
        const DiagnosisVariant& v = study_.variant_of(f);
        return {&study_.candidate_of(f), v, f, v.most, {v.most, v.most}};
    }

    /// Two effects are held against each of them alone, with any strength: the other may have been named for nothing.
    void hold_against_one(const std::vector<EffectFinding>& findings, AnswerFit& fit) {
        for (EffectFinding f : findings) {
            f.strength_deviation = kNaN;
            const std::vector<AnsweredEffect> one{answered(f)};
            const CalibratedModel alone =
                calibrated("alone_" + one.front().candidate->name + "_" + std::to_string(f.variant), one, f.parameters);
            if (study_.interrupted) return;
            if (!alone.result.folds.empty()) fit.loss_of_one = std::min(fit.loss_of_one, alone.result.held_out.loss);
        }
    }

    void refit(const std::vector<EffectFinding>& findings) {
        AnswerFit fit;
        std::string name;
        for (const EffectFinding& f : findings) {
            fit.effects.push_back(answered(f));
            name +=
                (name.empty() ? "" : "_and_") + fit.effects.back().candidate->name + "_" + std::to_string(f.variant);
        }
        fit.model = calibrated(name, fit.effects, findings.front().parameters);
        if (!study_.interrupted && findings.size() > 1) hold_against_one(findings, fit);
        if (study_.interrupted) return;
        fit.study = compared(fit.model, fit.effects, fit.campaign);
        if (!study_.interrupted) stay_as_followed(fit.model.result, fit.effects, fit.model, fit.study, fit.campaign);
        if (study_.interrupted) return;
        const std::size_t first = fit.model.result.parameters.size() - fit.model.strengths.size();
        const SiteFile site = test_.site_at(fit.model.point);
        if (!throw_on_the_ground(fit, site)) return;
        std::size_t next = 0;
        for (AnsweredEffect& e : fit.effects) {
            if (!e.has_strength()) continue;
            e.variant = e.variant.on_ground(site.settings.soils);
            e.strength = fit.model.strengths[next];
            e.interval = std::isfinite(e.finding.strength_deviation)
                             ? strength_range(e)
                             : fit.model.result.parameters[first + next].interval;
            ++next;
        }
        study_.answers.push_back(std::move(fit));
    }

    std::string journal_subject(const std::string& name) const;

    const DiagnoseInput& in_;
    DiagnoseStudy& study_;
    FieldTest test_;
    NearestModels nearest_;  ///< those tested without effects
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

}  // namespace

std::string AnswerFit::name() const {
    std::string text;
    for (const AnsweredEffect& e : effects) text += (text.empty() ? "" : " and ") + e.candidate->name;
    return text;
}

bool AnswerFit::in_space() const {
    return cli::in_space(effects);
}

CalibrationPoint DiagnoseStudy::tested_point() const {
    CalibrationPoint point{baseline.point.values, tested_levels};
    for (std::size_t k = 0; k < diagnosis.parameters.size(); ++k)
        point.values[k] = from_unit(keys.problem.parameters[k], diagnosis.parameters[k]);
    return point;
}

CalibrationPoint DiagnoseStudy::asked_point() const {
    CalibrationPoint point = tested_point();
    for (std::size_t k = 0; k < diagnosis.parameters.size(); ++k)
        point.values[k] = from_unit(keys.problem.parameters[k],
                                    diagnosis.parameters[k] + diagnosis.score.shift[static_cast<Eigen::Index>(k)]);
    return point;
}

/// Standard deviation of the measured stops to the sides of the axis [m].
static double spread_beside(const ObservedSite& observed) {
    std::vector<double> beside;
    for (const ObservedStop& s : observed.observations.stops)
        if (std::isfinite(s.position.x())) beside.push_back(observed.op.axis.place(s.position.head<2>()).lateral);
    const Eigen::Map<const Eigen::ArrayXd> all(beside.data(), std::ssize(beside));
    return beside.size() < 2 ? kNaN : std::sqrt((all - all.mean()).square().mean());
}

static void set_test(const DiagnoseInput& input, DiagnoseStudy& study) {
    study.blocks = static_cast<std::size_t>(blocks_of(input.observed));
    study.known_blocks = known_blocks(input.observed);
    study.screens = input.observed.op.screens;
    study.zones = input.observed.op.zones;
    study.impacts = input.observed.op.impacts;
    study.screen_of = input.observed.op.screen_of;
    study.in_plane = input.model.in_plane();
    study.beside = spread_beside(input.observed);
}

void run_study(const DiagnoseInput& input, DiagnoseStudy& study) {
    study.audit = input.observed.findings;
    set_test(input, study);
    if (input.observed.has_errors()) {
        study.verdict = Verdict::DataProblem;
        return;
    }
    Runner(input, study).diagnose_test();
}

void plan_study(const DiagnoseInput& input, DiagnoseStudy& study) {
    study.planning = true;
    set_test(input, study);
    Runner(input, study).plan_test();
}

}  // namespace scree::cli
