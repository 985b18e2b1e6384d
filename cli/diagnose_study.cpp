// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_study.hpp"

#include "cli/diagnose_consequences.hpp"
#include "cli/diagnose_models.hpp"
#include "cli/diagnose_refits.hpp"
#include "cli/further_instruments.hpp"
#include "cli/nearest_models.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace scree::cli {

namespace {

/// Steps of derivatives in shares of a parameter's range: about its uncertainty, within these [-].
constexpr double kLeastStep = 0.03, kMostStep = 0.15, kPlannedStep = 0.08;
/// Small differences between a few effects need so many times the simulations [-].
constexpr std::int64_t kGroupRepeats = 4;
/// A plan is asked for this many times the blocks, too [-].
constexpr double kMoreBlocks = 2.0;

/// None where nobody knows which record is of which block.
std::vector<ObservedBlock> known_blocks(const ObservedSite& observed) {
    return observed.observations.matched ? observed.observations.blocks : std::vector<ObservedBlock>{};
}

/// That count in the overall gap.
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
          models_(input, study, test_),
          nearest_(GapFunction(input.observed.observations, input.observed.op)) {}

    void diagnose_test() {
        study_.baseline = models_.calibrated("baseline", {}, {});
        if (study_.interrupted) return;
        study_.tested_levels = study_.baseline.point.levels;
        study_.before = models_.compared(study_.baseline, {}, study_.campaign);
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
        if (study_.several()) try_instruments_on_group();
    }

    /// Answers are calibrated from where the diagnosis followed them to. So is the model without them, which stays where it was if that leaves more.
    void calibrate_again() {
        const CalibratedModel again = models_.calibrated("baseline_again", {}, study_.diagnosis.parameters);
        if (study_.interrupted) return;
        if (again.result.best_fit.loss < study_.baseline.result.best_fit.loss) {
            study_.baseline = again;
            study_.before = models_.compared(study_.baseline, {}, study_.campaign);
        }
        if (!study_.interrupted)
            models_.stay_as_followed(again.result, {}, study_.baseline, study_.before, study_.campaign);
    }

    /// Q of a test is what is left after a linear step of the parameters, so that a model whose Q is small may still be a step away from what it could be.
    /// And what leaves least in the residual space may leave more over all than what the diagnosis has seen on its way there.
    void tell_without() {
        if (!study_.before.overall.beyond_chance()) return;  // what differs there is chance
        if (!tell_nearest({study_.tested_point(), study_.asked_point()}) || !study_.told().overall.beyond_chance())
            return;
        tell_nearest(nearest_.points());
    }

    bool tell_nearest(const std::vector<CalibrationPoint>& points) {
        for (const CalibrationPoint& point : points) {
            MovedModel moved{point, {}, {}};
            moved.study = models_.compared(model_at(point), {}, moved.campaign);
            if (study_.interrupted) return false;
            if (leaves_less(moved.study, study_.told(), study_.before)) study_.moved = std::move(moved);
        }
        return true;
    }

    void restart_at_screens() {
        if (study_.interrupted) return;
        auto innovations = screen_innovations(test_, test_.site_at(study_.told_point()), in_.observed,
                                              study_.moved ? study_.moved->campaign : study_.campaign);
        study_.interrupted = !innovations;
        if (innovations) study_.innovations = std::move(*innovations);
    }

    /// Every observable of blocks that the fold which predicts them was not fitted to: with the answers, and without.
    void hold_out() {
        if (!study_.interrupted && !study_.answers.empty())
            study_.held_out = models_.held_out_gaps(study_.baseline, {});
        for (AnswerFit& a : study_.answers)
            if (!study_.interrupted) a.held_out = models_.held_out_gaps(a.model, a.effects);
    }

    /// What has no name: when, where and for which blocks it acts, as forces tell whose fingerprints are held against what the model leaves.
    void try_forces() {
        const CalibratedModel model = tested_model();
        study_.forces = make_forces(test_.site_at(model.point), in_.model, in_.observed, study_.keys);
        DiagnosisSettings settings = study_.settings;
        settings.power_search = 0;  // nobody asks from which strength on a force without a name is seen
        study_.by_force = scree::plan_test(problem(model, study_.forces), measured(), settings,
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
        DiagnosisSettings settings = study_.settings;
        settings.repeats *= kGroupRepeats;
        settings.power_search = 0;
        try_instruments(tested_model(), members, settings);
    }

    /// The test as it was measured comes first: what more instruments see is held against what these see in the same way.
    void try_instruments(const CalibratedModel& model, const DiagnosisCatalogue& catalogue,
                         const DiagnosisSettings& settings) {
        std::vector<FurtherInstrument> instruments{{"the same instruments", {}}};
        for (FurtherInstrument& i : further_instruments(in_.observed)) instruments.push_back(std::move(i));
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
        as_given.point = study_.given_point();
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
        DiagnosisSettings settings = study_.settings;
        settings.power_up_to = 1.0;  // what is told of them is whether they see the reference
        try_instruments(as_given, best, settings);
        if (study_.interrupted) return;
        settings.power_up_to = std::sqrt(kMoreBlocks);  // strengths that they see, over those that more blocks see
        const std::string name = "twice as many blocks";
        Diagnosis plan =
            scree::plan_test(problem(as_given, best), measured(), settings, simulation(as_given, best),
                             [&](const DiagnosisProgress& p) { in_.progress("with " + name, p.done, p.planned); });
        study_.interrupted = plan.interrupted;
        if (!study_.interrupted) study_.further.push_back({name, std::move(plan), kMoreBlocks});
    }

private:
    ObservationTable measured() const { return side_by_side(in_.observed.observations, in_.observed.op); }

    std::function<void(const DiagnosisProgress&)> reporter() const {
        return [this](const DiagnosisProgress& p) { in_.progress(p.stage, p.done, p.planned); };
    }

    DiagnosisProblem problem(const CalibratedModel& model, const DiagnosisCatalogue& catalogue) const {
        DiagnosisProblem p;
        const auto& parameters = study_.keys.problem.parameters;
        const CalibrationPoint given = study_.given_point();
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            p.calibrated.push_back(to_unit(parameters[k], model.point.values[k]));
            p.given.push_back(to_unit(parameters[k], given.values[k]));
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

    /// What an answer changes for whoever builds at a screen is asked where that stands, and not where it is said to have stood in the test.
    bool throw_on_the_ground(AnswerFit& fit, const SiteFile& site) {
        std::vector<Effect> acting = models_.dosed(fit.effects, fit.model.result.best);
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
            const CalibratedModel alone = models_.calibrated(
                "alone_" + one.front().candidate->name + "_" + std::to_string(f.variant), one, f.parameters);
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
        fit.model = models_.calibrated(name, fit.effects, findings.front().parameters);
        if (!study_.interrupted && findings.size() > 1) hold_against_one(findings, fit);
        if (study_.interrupted) return;
        fit.study = models_.compared(fit.model, fit.effects, fit.campaign);
        if (!study_.interrupted)
            models_.stay_as_followed(fit.model.result, fit.effects, fit.model, fit.study, fit.campaign);
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
            if (!e.variant.soil.empty()) e.fastest = fastest_on(in_.model, fit.campaign, e.variant.soil);
        }
        study_.answers.push_back(std::move(fit));
    }

    const DiagnoseInput& in_;
    DiagnoseStudy& study_;
    FieldTest test_;
    DiagnosedModels models_;
    NearestModels nearest_;  ///< those tested without effects
};

}  // namespace

std::string AnswerFit::name() const {
    std::string text;
    for (const AnsweredEffect& e : effects)  // a family by the form that was found, which is what a site file has
        text += (text.empty() ? "" : " and ") + (e.candidate->variants.empty() ? e.candidate->name : e.variant.form());
    return text;
}

bool AnswerFit::in_space() const {
    return cli::in_space(effects);
}

CalibrationPoint DiagnoseStudy::given_point() const {
    CalibrationPoint point;
    for (const CalibrationParameter& p : keys.problem.parameters)
        point.values.push_back(std::isfinite(p.start) ? p.start : from_unit(p, 0.5));
    for (const CalibrationChoice& c : keys.problem.choices) point.levels.push_back(c.start);
    return point;
}

CalibrationPoint DiagnoseStudy::tested_point() const {
    CalibrationPoint point{baseline.point.values, tested_levels};
    for (std::size_t k = 0; k < diagnosis.parameters.size(); ++k)
        point.values[k] = from_unit(keys.problem.parameters[k], diagnosis.parameters[k]);
    return point;
}

/// What a strength stands for is a share of what the ground has there, if it stands for something of the ground.
static DiagnosisVariant on_ground_at(const DiagnoseStudy& study, const CalibrationPoint& point,
                                     const DiagnosisVariant& v) {
    return std::isnan(v.start) ? v : v.on_ground(with_changes(study.site, study.keys.changes(point)).settings.soils);
}

DiagnosisVariant DiagnoseStudy::variant_of(const EffectFinding& f) const {
    CalibrationPoint point = tested_point();
    for (std::size_t k = 0; f.finalist && k < f.parameters.size(); ++k)
        point.values[k] = from_unit(keys.problem.parameters[k], f.parameters[k]);
    return on_ground_at(*this, point, catalogue.variant(f.effect, f.variant, f.on));
}

DiagnosisVariant DiagnoseStudy::seen_variant_of(const EffectFinding& f) const {
    return on_ground_at(*this, tested_point(), catalogue.variant(f.effect, f.seen_variant, f.seen_on));
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
