// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate_report.hpp"
#include "cli/commands.hpp"
#include "cli/compare_report.hpp"
#include "cli/diagnose_consequences.hpp"
#include "cli/diagnose_force.hpp"
#include "cli/diagnose_further.hpp"
#include "cli/diagnose_refits.hpp"
#include "cli/diagnose_report.hpp"
#include "cli/diagnose_words.hpp"
#include "cli/json.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

namespace {

Json finding_json(const DiagnoseStudy& study, const EffectFinding& f) {
    const DiagnosisVariant v = study.variant_of(f);
    Json json{{"effect", study.candidate_of(f).name},
              {"form", v.form()},
              {"label", v.label},
              {"measurement", study.candidate_of(f).measurement},
              {"z", f.z},
              {"visibility_at_reference", f.visibility},
              {"reference", {{"parameter", v.parameter}, {"unit", v.unit()}, {"value", v.value(1.0)}}}};
    if (!v.space) json["searched_up_to"] = v.value(v.most);
    if (std::isnan(f.smallest_seen)) {  // something is missing: not told
    } else if (std::isfinite(f.smallest_seen)) {
        const DiagnosisVariant seen = study.seen_variant_of(f);
        json["smallest_seen"] = {{"form", seen.form()},
                                 {"label", seen.label},
                                 {"parameter", seen.parameter},
                                 {"value", seen.value(f.smallest_seen)}};
    } else {
        json["smallest_seen"] = nullptr;
    }
    if (v.on) json["between_m"] = Json::array({v.on->from, v.on->to});
    if (f.finalist) {
        json["strength"] = f.strength;
        json["value"] = v.value(f.strength);
        json["left_over"] = f.misfit;
        json["left_over_p"] = f.p;
        json["weight"] = f.weight;
    }
    return json;
}

/// One row per effect; two that act together say so, and share what follows from both.
Json answer_json(const DiagnoseStudy& study, const AnswerFit& a, const AnsweredEffect& e) {
    const DiagnosisVariant& v = e.variant;
    const double low = v.value(e.interval.low), high = v.value(e.interval.high);
    Json json{{"effect", e.candidate->name},
              {"form", v.form()},
              {"label", v.label},
              {"parameter", v.parameter},
              {"unit", v.unit()},
              {"value", v.value(e.strength)},
              {"interval_95", ends_of({std::min(low, high), std::max(low, high)})},
              {"determined", e.is_determined()},
              {"together", a.effects.size() > 1},
              {"weight", a.weight()},
              {"gap_fitted", a.model.result.best_fit.gap()},
              {"gap_over_all", a.study.overall.gap},
              {"gap_over_all_chance_95", ends_of(a.study.overall.chance)}};
    if (v.on) {
        json["between_m"] = Json::array({v.on->from, v.on->to});
        json["middle_interval_95_m"] = ends_of(middle_interval(e));
        if (v.on_profile) json["between_m_of_profile"] = Json::array({v.on_profile->from, v.on_profile->to});
    }
    if (!study.baseline.result.folds.empty()) {
        json["held_out_loss"] = a.model.result.held_out.loss;
        json["held_out_floor"] = a.model.result.held_out.floor;
        json["held_out_gap"] = a.model.result.held_out.gap();
        json["held_out_was_seen"] = a.model.result.held_out_was_seen;
        if (const auto share = removable_gap_closed(study, a)) json["removable_gap_closed"] = *share;
        if (const auto gain = held_out_gain(study, a))
            json["held_out_gain"] = {{"mean", gain->mean}, {"standard_error", gain->error}};
        if (const auto gain = held_out_log_gain(study, a))
            json["held_out_log_gain"] = {{"mean", gain->mean}, {"standard_error", gain->error}};
        if (!a.model.result.places.empty()) json["places"] = Json::parse(places_json(a.model.result));
    }
    for (std::size_t k = 0; k < study.before.observables.size() && k < a.study.observables.size(); ++k) {
        const ObservableGap &before = study.before.observables[k].gap, &after = a.study.observables[k].gap;
        json["observables"].push_back({{"name", before.observable.name},
                                       {"gap_calibrated", before.pooled.gap},
                                       {"gap", after.pooled.gap},
                                       {"chance_95", ends_of(after.pooled.chance)}});
        if (k < study.held_out.size() && k < a.held_out.size()) {
            json["observables"].back()["held_out_gap_calibrated"] = study.held_out[k].gap;
            json["observables"].back()["held_out_gap"] = a.held_out[k].gap;
        }
    }
    for (std::size_t k = 0; k < a.model.point.values.size(); ++k)
        json["calibrated"][study.keys.problem.parameters[k].name] = a.model.point.values[k];
    return json;
}

/// What an answer changes at the screens, a row for each.
void add_at_screens(const DiagnoseStudy& study, Json& json) {
    for (std::size_t k = 0; k < study.answers.size(); ++k)
        for (const ScreenChange& c : changes_at_screens(study, k)) {
            Json row{{"screen", c.screen}, {"with", study.answers[k].name()}};
            for (const ChangedValue& v : values_of(c)) {
                row["calibrated"][v.name] = v.before;
                row["extended"][v.name] = v.after;
            }
            json["at_screens"].push_back(row);
        }
}

Json restarted_json(const DiagnoseStudy& study) {
    Json json = Json::array();
    for (const InnovationRow& r : innovation_rows(study))
        json.push_back({{"from", r.from},
                        {"to", r.to},
                        {"what", r.what},
                        {"blocks", r.blocks},
                        {"measured", r.measured},
                        {"simulated", r.simulated},
                        {"standard_errors", r.standardised},
                        {"beyond_chance", r.stands_out}});
    return json;
}

/// The global test and its residuals; of a plan their names only.
void add_test(const DiagnoseStudy& study, Json& json) {
    const Diagnosis& d = study.diagnosis;
    if (d.residuals.empty()) return;
    json["global_test"] = {
        {"level", study.settings.level}, {"z_limit", d.test.z_limit}, {"residual_limit", d.test.residual_limit}};
    if (!study.planning) {
        json["global_test"]["q"] = d.score.q;
        json["global_test"]["p"] = d.test.p;
        json["global_test"]["p_any"] = d.test.p_q;
        json["global_test"]["p_effect"] = d.test.p_z;
        json["weight_none"] = d.weight_none;
        json["weight_unnamed"] = d.weight_unnamed;
    }
    json["residuals"] = Json::array();
    for (std::size_t k = 0; k < d.residuals.size(); ++k) {
        Json row{{"name", residual_name(d.residuals[k], study.screens, study.zones)}};
        if (!study.planning) {
            row["standardised"] = d.score.standardised[static_cast<Eigen::Index>(k)];
            row["p"] = d.test.residual_p[static_cast<Eigen::Index>(k)];
        }
        json["residuals"].push_back(row);
    }
}

Json cosines_json(const Eigen::MatrixXd& cosines) {
    Json json = Json::array();
    for (Eigen::Index i = 0; i < cosines.rows(); ++i) {
        Json row = Json::array();
        for (Eigen::Index j = 0; j < cosines.cols(); ++j) row.push_back(cosines(i, j));
        json.push_back(row);
    }
    return json;
}

/// The model without an answer: its parameters as calibrated, as the test ended with them, and as they are told.
Json baseline_json(const DiagnoseStudy& study) {
    Json baseline;
    const std::vector<double>&calibrated = study.baseline.point.values, tested = study.tested_point().values;
    const bool told = !study.answer();
    for (std::size_t k = 0; k < calibrated.size(); ++k) {
        const std::string& key = study.keys.problem.parameters[k].name;
        baseline["calibrated"][key] = calibrated[k];
        baseline["tested"][key] = tested[k];
        if (told) baseline["told"][key] = study.told_point().values[k];
    }
    for (std::size_t k = 0; k < study.keys.problem.choices.size(); ++k) {
        const CalibrationChoice& c = study.keys.problem.choices[k];
        baseline["calibrated"][c.name] = c.levels[study.baseline.point.levels[k]];
        baseline["tested"][c.name] = c.levels[study.tested_levels[k]];
        if (told) baseline["told"][c.name] = c.levels[study.told_point().levels[k]];
    }
    baseline["gap_fitted"] = study.baseline.result.best_fit.gap();
    baseline["gap_over_all"] = study.before.overall.gap;
    baseline["gap_over_all_chance_95"] = ends_of(study.before.overall.chance);
    if (told) baseline["gap_over_all_told"] = study.told().overall.gap;
    if (told) baseline["distance_over_all_told"] = distance_over(study.told(), study.before);
    if (told) baseline["gap_over_all_told_chance_95"] = ends_of(study.told().overall.chance);
    if (!study.baseline.result.folds.empty()) {
        baseline["held_out_loss"] = study.baseline.result.held_out.loss;
        baseline["held_out_gap"] = study.baseline.result.held_out.gap();
        baseline["held_out_was_seen"] = study.baseline.result.held_out_was_seen;
        if (!study.baseline.result.places.empty()) baseline["places"] = Json::parse(places_json(study.baseline.result));
    }
    return baseline;
}

}  // namespace

std::string diagnose_json(const DiagnoseStudy& study) {
    const Diagnosis& d = study.diagnosis;
    Json json;
    json["program"] = "scree " + version();
    json["site"] = study.site.settings.name;
    json["seed"] = study.settings.seed;
    json["measured_blocks"] = study.blocks;
    json["verdict"] = study.planning ? "PLAN" : kVerdictNames[static_cast<std::size_t>(study.verdict)];
    json["sentence"] = verdict_sentence(study);
    json["answer"] = Json::array();
    for (const AnswerFit& a : study.answers)
        for (const AnsweredEffect& e : a.effects) json["answer"].push_back(answer_json(study, a, e));
    add_at_screens(study, json);
    json["audit"] = Json::array();
    for (const Finding& f : study.audit)
        json["audit"].push_back({{"check", f.check},
                                 {"severity", f.severity == Severity::Error ? "error" : "warning"},
                                 {"sentence", f.sentence}});
    json["where"] = where_sentences(study);
    json["restarted"] = restarted_json(study);
    if (const std::vector<std::string> force = force_sentences(study); !force.empty()) {
        json["force"]["sentences"] = force;
        Eigen::Index at = 0;
        for (const EffectDose& w : study.by_force.looked_at)
            json["force"]["ways"].push_back({{"phase", study.forces.candidates[w.effect].name},
                                             {"way", study.forces.variant(w.effect, w.variant, w.on).label},
                                             {"z", study.by_force.score.z[at++]}});
    }
    if (const std::vector<std::string> apart = telling_apart_sentences(study); !apart.empty())
        json["would_tell_apart"] = apart;
    for (const FurtherRow& r : further_rows(study))
        json["in_addition"].push_back(
            {{"test", r.name}, {"effects_seen_at_reference", r.seen}, {"pairs_alike", r.alike}, {"also_seen", r.also}});
    json["remarks"] = diagnose_remarks(study);
    json["distances"] = study.distances;
    add_test(study, json);
    json["effects"] = Json::array();
    for (const EffectFinding& f : d.findings) json["effects"].push_back(finding_json(study, f));
    json["cosines"] = cosines_json(d.cosines);
    json["order_of_cosines"] = Json::array();
    for (const DiagnosisCandidate& c : study.catalogue.candidates) json["order_of_cosines"].push_back(c.name);
    json["not_searched"] = study.catalogue.left_out;
    if (!study.planning && !study.baseline.result.parameters.empty()) json["baseline"] = baseline_json(study);
    json["simulated_blocks"] = d.simulated_blocks;
    json["inputs"] = study.inputs;
    return json_text(json, 1) + "\n";
}

}  // namespace scree::cli
