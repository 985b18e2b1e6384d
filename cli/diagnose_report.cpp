// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_report.hpp"

#include "cli/campaign_layers.hpp"
#include "cli/commands.hpp"
#include "cli/compare_report.hpp"
#include "cli/diagnose_consequences.hpp"
#include "cli/diagnose_force.hpp"
#include "cli/diagnose_further.hpp"
#include "cli/html.hpp"
#include "cli/settings.hpp"
#include "cli/text.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <ostream>
#include <sstream>

namespace scree::cli {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::size_t kMostSentences = 8;
constexpr double kInRange = 0.03;  // estimates nearer to an end of their range lie on its edge [-]

const char* unit_of(const DiagnosisVariant& v) {
    return effect_parameter(v.kind, v.parameter).unit;
}

std::string with_unit(double value, const std::string& unit) {
    return short_number(value) + (unit == "-" ? "" : " " + unit);
}

/// "ground_drag, linear, on loose waste".
std::string variant_name(const DiagnosisVariant& v) {
    const std::string name = effect_info(v.kind).name;
    return v.label.empty() ? name : name + ", " + v.label;
}

/// "coefficient 0.31 1/s (95 %: 0.2 to 0.45)".
std::string strength_text(const AnsweredEffect& e) {
    const DiagnosisVariant& v = e.variant;
    const double a = v.value(e.interval.low), b = v.value(e.interval.high);
    return v.parameter + " " + with_unit(v.value(e.strength), unit_of(v)) + " (95 %: " + short_number(std::min(a, b)) +
           " to " + short_number(std::max(a, b)) + ")";
}

std::vector<std::size_t> by_size(const Eigen::VectorXd& values) {
    std::vector<std::size_t> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::abs(values[static_cast<Eigen::Index>(a)]) > std::abs(values[static_cast<Eigen::Index>(b)]);
    });
    return order;
}

/// ": mean 9.8 measured, 12.4 simulated [m/s]" of a column that is an observable. Residuals count after the parameters have fitted the rest as well as they
/// can: where that turns the sign round, the calibrated model's own numbers would contradict the sentence.
std::string in_units(const DiagnoseStudy& study, const Column& column, bool more) {
    for (const ComparedObservable& o : study.before.observables) {
        if (o.gap.observable.columns.size() != 1 || o.gap.observable.columns.front() != column) continue;
        const bool share = o.measured_share.of > 0;
        if (!share && o.measured.empty()) continue;
        const double measured = share ? 100.0 * o.measured_share.share() : o.measured_summary.mean,
                     simulated = share ? 100.0 * o.simulated_share.share() : o.simulated_summary.mean;
        if ((measured > simulated) != more) return ", once the parameters fit the rest";
        return share ? ": " + short_number(measured) + " % measured, " + short_number(simulated) + " % simulated"
                     : ": mean " + short_number(measured) + " measured, " + short_number(simulated) + " simulated [" +
                           o.unit + "]";
    }
    return "";
}

std::string direction(const Residual& r, bool more) {
    switch (r.kind) {
        case ResidualKind::Passed:
            return more ? "is higher than simulated" : "is lower than simulated";
        case ResidualKind::Level:
        case ResidualKind::Innovation:
            return more ? "is larger than simulated" : "is smaller than simulated";
        case ResidualKind::Spread:
            return more ? "is wider than simulated" : "is narrower than simulated";
        case ResidualKind::MassTrend:
            return more ? "rises more with mass than simulated" : "falls more with mass than simulated";
        case ResidualKind::ShapeTrend:
            return more ? "rises more with elongation than simulated" : "falls more with elongation than simulated";
        case ResidualKind::OrderTrend:
            return more ? "rises in the course of the test" : "falls in the course of the test";
        case ResidualKind::Together:
            return more ? "go together more than simulated" : "go together less than simulated";
        case ResidualKind::Window:
            return more ? "are more than simulated" : "are fewer than simulated";
    }
    return "";
}

/// The words of a residual without what `direction` says anyway.
std::string subject_of(const Residual& r, std::span<const std::string> screens) {
    Residual plain = r;
    if (r.kind == ResidualKind::MassTrend || r.kind == ResidualKind::ShapeTrend || r.kind == ResidualKind::OrderTrend)
        plain.kind = ResidualKind::Level;
    return residual_name(plain, screens);
}

/// "ground_drag, on loose waste (drag in contact)", of two effects both.
std::string described(const AnswerFit& answer) {
    std::string text;
    for (const AnsweredEffect& e : answer.effects)
        text += (text.empty() ? "" : " and ") + variant_name(e.variant) + " (" + e.candidate->title + ")";
    return text;
}

std::string held_out_text(const CalibratedModel& m) {
    return m.result.folds.empty() ? "-" : gap_number(m.result.held_out.gap());
}

std::string names_of(const std::vector<AnswerFit>& answers) {
    std::string text;
    for (std::size_t k = 0; k < answers.size(); ++k)
        text += (k == 0 ? "" : k + 1 == answers.size() ? " or " : ", ") + answers[k].name();
    return text;
}

std::string smallest_seen(const DiagnoseStudy& study, const EffectFinding& f) {
    const DiagnosisCandidate& c = study.candidate_of(f);
    if (!std::isfinite(f.smallest_seen)) return "not visible";
    const DiagnosisVariant& v = c.variants[f.seen_variant];
    return variant_name(v) + ": " + v.parameter + " " + with_unit(v.value(f.smallest_seen), unit_of(v));
}

/// Effects that look like this one after a recalibration.
std::string look_alikes(const DiagnoseStudy& study, const EffectFinding& f) {
    std::vector<std::string> names;
    for (const EffectFinding& other : study.diagnosis.findings)
        if (look_alike(study.diagnosis, f, other)) names.push_back(study.candidate_of(other).name);
    return listed(names);
}

/// What comes nearest without being an answer, and why it is none. Findings are ordered by weight.
std::string nearest(const DiagnoseStudy& study) {
    const std::vector<EffectFinding>& findings = study.diagnosis.findings;
    if (findings.empty() || !findings.front().finalist) return "";
    const EffectFinding& f = findings.front();
    const std::string name = "; " + variant_name(study.variant_of(f)) + " comes nearest, but ";
    if (f.p <= study.settings.rejected)
        return name + "only " + short_number(100.0 * f.p) + " % of its own simulations look as far off";
    return name + "has a weight of " + weight_text(f.weight) + " only";
}

}  // namespace

std::string verdict_sentence(const DiagnoseStudy& study) {
    const Diagnosis& d = study.diagnosis;
    if (study.planning) return "planned: what a test like this could see";
    switch (study.verdict) {
        case Verdict::None:
            return "NONE: the calibrated model could have produced these measurements (p = " + p_text(d.test.p) +
                   "); nothing is missing that they could show";
        case Verdict::Named:
            return "NAMED: " + described(study.answers.front());
        case Verdict::Group:
            return "GROUP: " + names_of(study.answers) + "; these measurements cannot tell them apart";
        case Verdict::Unknown:
            return "UNKNOWN: something is missing (p = " + p_text(d.test.p) + ") that has no name in the catalogue" +
                   (study.demoted.empty() ? nearest(study) : ": " + study.demoted);
        case Verdict::DataProblem:
            if (study.answers.empty()) return "DATA PROBLEM: the measurements cannot be used as they are";
            return "DATA PROBLEM: " + names_of(study.answers) +
                   (study.answers.size() == 1 && study.answers.front().effects.size() == 1
                        ? ", " + study.answers.front().effects.front().variant.label
                        : "") +
                   "; check how it was measured before anything else";
    }
    return "";
}

std::vector<std::string> where_sentences(const DiagnoseStudy& study) {
    std::vector<std::string> sentences;
    const Diagnosis& d = study.diagnosis;
    if (d.residuals.empty() || study.planning || d.verdict == Verdict::None) return sentences;
    for (const std::size_t k : by_size(d.score.standardised)) {
        const auto i = static_cast<Eigen::Index>(k);
        if (d.test.residual_p[i] > study.settings.level || sentences.size() == kMostSentences) break;
        const double s = d.score.standardised[i];
        const Residual& r = d.residuals[k];
        sentences.push_back(
            subject_of(r, study.screens) + " " + direction(r, s > 0.0) +
            (r.kind == ResidualKind::Level || r.kind == ResidualKind::Passed ? in_units(study, r.column, s > 0.0)
                                                                             : std::string()) +
            " (" + short_number(std::abs(s)) + " standard deviations, p = " + p_text(d.test.residual_p[i]) + ")");
    }
    return sentences;
}

std::vector<std::string> diagnose_remarks(const DiagnoseStudy& study) {
    std::vector<std::string> remarks;
    const auto& parameters = study.keys.problem.parameters;
    for (std::size_t i = 0; i < study.baseline.result.parameters.size() && !study.planning; ++i) {
        const ParameterEstimate& e = study.baseline.result.parameters[i];
        if (e.at_low || e.at_high)
            remarks.push_back(parameters[i].name +
                              " of the calibrated model lies on the edge of its range: a missing "
                              "effect often drives it there");
    }
    for (const AnswerFit& a : study.answers) {
        if (study.verdict == Verdict::Unknown) break;
        for (const AnsweredEffect& e : a.effects)
            if (e.strength > (1.0 - kInRange) * e.variant.most)
                remarks.push_back("the strength of " + e.candidate->name + " lies at the end of what was searched");
        if (!study.baseline.result.folds.empty() &&
            !(a.model.result.held_out.loss < study.baseline.result.held_out.loss))
            remarks.push_back("the prediction of blocks held out does not improve with " + a.name());
        if (a.study.overall.beyond_chance())
            remarks.push_back("with " + a.name() + " the model is still beyond chance as a whole");
    }
    if (study.verdict == Verdict::Group)
        for (const AnswerFit& a : study.answers)
            for (const AnsweredEffect& e : a.effects)
                remarks.push_back(e.candidate->name + " would show in " + effect_info(e.variant.kind).seen_in);
    if (study.in_plane && (study.verdict == Verdict::Named || study.verdict == Verdict::Group))
        remarks.push_back(
            "the model is 2D: what blocks do sideways can look like an effect; confirm with model.dimension = 3");
    if (study.verdict == Verdict::Named)
        remarks.push_back("the name is the best of " + std::to_string(study.catalogue.candidates.size()) +
                          " that were searched; it holds for this slope and these blocks, and its strength for ground "
                          "like this");
    return remarks;
}

void print_power(std::ostream& out, const DiagnoseStudy& study) {
    out << "what would be seen in 4 of 5 such tests, at the level of " << short_number(100.0 * study.settings.level)
        << " %, after recalibration:\n";
    for (const EffectFinding& f : study.diagnosis.findings) {
        const std::string alike = look_alikes(study, f);
        out << "  " << padded(study.candidate_of(f).name, 24) << (std::isfinite(f.smallest_seen) ? " from " : " ")
            << smallest_seen(study, f) << (alike.empty() ? "" : "; looks like " + alike) << "\n";
    }
    const std::vector<FurtherRow> rows = further_rows(study);
    if (rows.empty()) return;
    std::size_t width = 28;
    for (const FurtherRow& r : rows) width = std::max(width, r.name.size() + 2);
    const std::string of = " of " + std::to_string(study.diagnosis.findings.size());
    out << "\n" << padded("what to measure in addition", width + 2) << "seen at reference   pairs that look alike\n";
    for (const FurtherRow& r : rows)
        out << "  " << padded(r.name, width) << padded(std::to_string(r.seen) + of, 20) << r.alike
            << (r.also.empty() ? "" : "   also seen: " + listed(r.also)) << "\n";
}

namespace {

/// One value at a screen before and after.
struct ChangedValue {
    const char* name;  ///< in JSON
    double before, after;
};
std::array<ChangedValue, 4> values_of(const ScreenChange& c) {
    return {{{"passed_percent", 100.0 * c.before.passed, 100.0 * c.after.passed},
             {"speed_p95_ms", c.before.speed, c.after.speed},
             {"energy_p95_kj", c.before.energy / kJoulePerKj, c.after.energy / kJoulePerKj},
             {"height_p95_m", c.before.height, c.after.height}}};
}

void print_answers(std::ostream& out, const DiagnoseStudy& study) {
    out << "\n" << padded("", 34) << "gap of what is fitted   held out   gap over all   weight\n";
    out << padded("calibrated model", 34) << padded(gap_number(study.baseline.result.best_fit.gap()), 24)
        << padded(held_out_text(study.baseline), 11) << padded(gap_number(study.before.overall.gap), 15)
        << weight_text(study.diagnosis.weight_none) << "\n";
    for (const AnswerFit& a : study.answers)
        out << padded("with " + a.name(), 34) << padded(gap_number(a.model.result.best_fit.gap()), 24)
            << padded(held_out_text(a.model), 11) << padded(gap_number(a.study.overall.gap), 15)
            << weight_text(a.weight()) << "\n";
    for (const AnswerFit& a : study.answers) {
        for (const AnsweredEffect& e : a.effects)
            out << "  " << variant_name(e.variant) << ": " << strength_text(e) << "\n";
        if (const auto share = removable_gap_closed(study, a))
            out << "  closes " << short_number(100.0 * std::min(1.0, *share)) << " % of the removable held-out gap\n";
    }
    const std::vector<ScreenChange> changes = changes_at_screens(study);
    if (changes.empty()) return;
    out << "\n"
        << padded("what it changes, with 95 % values", 34) << padded("passed by [%]", 18) << padded("speed [m/s]", 18)
        << padded("energy [kJ]", 18) << "height [m]\n";
    for (const ScreenChange& c : changes) {
        out << padded("  at " + c.screen, 34);
        for (const ChangedValue& v : values_of(c))
            out << padded(short_number(v.before) + " -> " + short_number(v.after), 18);
        out << "\n";
    }
}

}  // namespace

void print_diagnosis(std::ostream& out, const DiagnoseStudy& study) {
    out << study.site.settings.name << ": " << study.blocks << (study.planning ? " blocks\n" : " measured blocks\n");
    for (const Finding& f : study.audit) out << "  " << f.sentence << "\n";
    if (!study.planning) out << "=> " << verdict_sentence(study) << "\n";
    const std::vector<std::string> where = where_sentences(study);
    if (!where.empty()) out << "\nwhere the calibrated model fails (chance of any such finding below 5 %):\n";
    for (const std::string& s : where) out << "  " << s << "\n";
    const std::vector<std::string> force = force_sentences(study);
    if (!force.empty()) out << "\nwhat has no name, as a force (fingerprints, after recalibration):\n";
    for (const std::string& s : force) out << "  " << s << "\n";
    if (!study.answers.empty()) print_answers(out, study);
    const std::vector<std::string> apart = telling_apart_sentences(study);
    if (!apart.empty()) out << "\nwhat would tell them apart, if one of them is at work:\n";
    for (const std::string& s : apart) out << "  " << s << "\n";
    if (study.verdict == Verdict::None && !study.diagnosis.findings.empty()) {
        out << "\n";
        print_power(out, study);
    }
    for (const std::string& remark : diagnose_remarks(study)) out << "=> " << remark << "\n";
}

namespace {

Json finding_json(const DiagnoseStudy& study, const EffectFinding& f) {
    const DiagnosisVariant& v = study.variant_of(f);
    Json json{{"effect", study.candidate_of(f).name},
              {"form", effect_info(v.kind).name},
              {"label", v.label},
              {"measurement", study.candidate_of(f).measurement},
              {"z", f.z},
              {"visibility_at_reference", f.visibility},
              {"reference", {{"parameter", v.parameter}, {"unit", unit_of(v)}, {"value", v.reference}}}};
    if (std::isfinite(f.smallest_seen)) {
        const DiagnosisVariant& seen = study.candidate_of(f).variants[f.seen_variant];
        json["smallest_seen"] = {{"form", effect_info(seen.kind).name},
                                 {"label", seen.label},
                                 {"parameter", seen.parameter},
                                 {"value", seen.value(f.smallest_seen)}};
    } else {
        json["smallest_seen"] = nullptr;
    }
    if (!std::isnan(v.from)) json["between_m"] = Json::array({v.from, v.to});
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
              {"form", effect_info(v.kind).name},
              {"label", v.label},
              {"parameter", v.parameter},
              {"unit", unit_of(v)},
              {"value", v.value(e.strength)},
              {"interval_95", ends_of({std::min(low, high), std::max(low, high)})},
              {"together", a.effects.size() > 1},
              {"weight", a.weight()},
              {"gap_fitted", a.model.result.best_fit.gap()},
              {"gap_over_all", a.study.overall.gap}};
    if (!std::isnan(v.from)) json["between_m"] = Json::array({v.from, v.to});
    if (!study.baseline.result.folds.empty()) {
        json["held_out_loss"] = a.model.result.held_out.loss;
        json["held_out_gap"] = a.model.result.held_out.gap();
        if (const auto share = removable_gap_closed(study, a)) json["removable_gap_closed"] = *share;
    }
    for (std::size_t k = 0; k < a.model.point.values.size(); ++k)
        json["calibrated"][study.keys.problem.parameters[k].name] = a.model.point.values[k];
    return json;
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
    for (const ScreenChange& c : changes_at_screens(study)) {
        Json row{{"screen", c.screen}};
        for (const ChangedValue& v : values_of(c)) {
            row["calibrated"][v.name] = v.before;
            row["extended"][v.name] = v.after;
        }
        json["at_screens"].push_back(row);
    }
    json["audit"] = Json::array();
    for (const Finding& f : study.audit)
        json["audit"].push_back({{"check", f.check},
                                 {"severity", f.severity == Severity::Error ? "error" : "warning"},
                                 {"sentence", f.sentence}});
    json["where"] = where_sentences(study);
    if (const std::vector<std::string> force = force_sentences(study); !force.empty()) {
        json["force"]["sentences"] = force;
        Eigen::Index at = 0;
        for (const DiagnosisCandidate& c : study.forces.candidates)
            for (const DiagnosisVariant& v : c.variants)
                json["force"]["ways"].push_back(
                    {{"phase", c.name}, {"way", v.label}, {"z", study.by_force.score.z[at++]}});
    }
    if (const std::vector<std::string> apart = telling_apart_sentences(study); !apart.empty())
        json["would_tell_apart"] = apart;
    for (const FurtherRow& r : further_rows(study))
        json["in_addition"].push_back(
            {{"test", r.name}, {"effects_seen_at_reference", r.seen}, {"pairs_alike", r.alike}, {"also_seen", r.also}});
    json["remarks"] = diagnose_remarks(study);
    if (!d.residuals.empty()) {
        json["global_test"] = {
            {"level", study.settings.level}, {"z_limit", d.test.z_limit}, {"residual_limit", d.test.residual_limit}};
        if (!study.planning) {
            json["global_test"]["p"] = d.test.p;
            json["global_test"]["p_any"] = d.test.p_q;
            json["global_test"]["p_effect"] = d.test.p_z;
            json["weight_none"] = d.weight_none;
        }
        json["residuals"] = Json::array();
        for (std::size_t k = 0; k < d.residuals.size(); ++k) {
            Json row{{"name", residual_name(d.residuals[k], study.screens)}};
            if (!study.planning) {
                row["standardised"] = d.score.standardised[static_cast<Eigen::Index>(k)];
                row["p"] = d.test.residual_p[static_cast<Eigen::Index>(k)];
            }
            json["residuals"].push_back(row);
        }
    }
    json["effects"] = Json::array();
    for (const EffectFinding& f : d.findings) json["effects"].push_back(finding_json(study, f));
    json["cosines"] = Json::array();
    for (Eigen::Index i = 0; i < d.cosines.rows(); ++i) {
        Json row = Json::array();
        for (Eigen::Index j = 0; j < d.cosines.cols(); ++j) row.push_back(d.cosines(i, j));
        json["cosines"].push_back(row);
    }
    json["order_of_cosines"] = Json::array();
    for (const DiagnosisCandidate& c : study.catalogue.candidates) json["order_of_cosines"].push_back(c.name);
    json["not_searched"] = study.catalogue.left_out;
    if (!study.planning && !study.baseline.result.parameters.empty()) {
        Json baseline;
        for (std::size_t k = 0; k < study.baseline.point.values.size(); ++k)
            baseline["calibrated"][study.keys.problem.parameters[k].name] = study.baseline.point.values[k];
        baseline["gap_fitted"] = study.baseline.result.best_fit.gap();
        baseline["gap_over_all"] = study.before.overall.gap;
        if (!study.baseline.result.folds.empty()) {
            baseline["held_out_loss"] = study.baseline.result.held_out.loss;
            baseline["held_out_gap"] = study.baseline.result.held_out.gap();
        }
        json["baseline"] = baseline;
    }
    json["simulated_blocks"] = d.simulated_blocks;
    json["inputs"] = study.inputs;
    return json.dump(1) + "\n";
}

std::string extended_toml(const DiagnoseStudy& study, const fs::path& to) {
    std::ostringstream text;
    text << "# By scree diagnose (scree " << version() << ", seed " << study.settings.seed << ").\n# "
         << verdict_sentence(study) << ".\n";
    for (const std::string& remark : diagnose_remarks(study)) text << "# Note: " << remark << ".\n";
    for (const std::string& input : study.inputs) text << "# Input: " << input << "\n";
    text << "\n";
    const bool with = !study.answers.empty() && study.verdict != Verdict::Unknown;
    const SiteFile site = with ? extended_site(study, study.answers.front())
                               : with_changes(study.site, study.keys.changes(study.baseline.point));
    SiteSettings settings = site.settings;
    settings.output_directory = "out";
    text << settings_as_toml(settings, [&](const std::string& path) {
        if (path == settings.output_directory || path == "results.gpkg") return path;
        std::error_code error;
        const fs::path relative = fs::relative(study.site.resolve(path), to, error);
        return error || relative.empty() ? fs::absolute(study.site.resolve(path)).string() : relative.string();
    });
    return text.str();
}

namespace {

std::string gaps_html(const DiagnoseStudy& study, const AnswerFit& a) {
    std::vector<std::vector<std::string>> rows;
    for (std::size_t k = 0; k < study.before.observables.size() && k < a.study.observables.size(); ++k) {
        const ComparedObservable &b = study.before.observables[k], &w = a.study.observables[k];
        rows.push_back({b.gap.observable.name, gap_number(b.gap.pooled.gap), gap_number(w.gap.pooled.gap),
                        chance_text(b.gap.pooled)});
    }
    rows.push_back({"all", gap_number(study.before.overall.gap), gap_number(a.study.overall.gap),
                    chance_text(study.before.overall)});
    if (!study.baseline.result.folds.empty())
        rows.push_back({"held out, what was fitted", held_out_text(study.baseline), held_out_text(a.model), ""});
    return html_table({"gap", "calibrated", "with " + a.name(), "chance"}, rows);
}

std::string consequences_html(const DiagnoseStudy& study) {
    std::vector<std::vector<std::string>> rows;
    for (const ScreenChange& c : changes_at_screens(study)) {
        rows.push_back({c.screen});
        for (const ChangedValue& v : values_of(c))
            rows.back().insert(rows.back().end(), {short_number(v.before), short_number(v.after)});
    }
    if (rows.empty()) return "";
    return "<p>What it changes for the measured blocks at the screens: share that passes, and the 95 % values of those "
           "that do.</p>\n" +
           html_table({"screen", "passed [%], calibrated", "extended", "speed [m/s]", "extended", "energy [kJ]",
                       "extended", "height [m]", "extended"},
                      rows);
}

std::string effects_html(const DiagnoseStudy& study) {
    std::vector<std::vector<std::string>> rows;
    for (const EffectFinding& f : study.diagnosis.findings)
        rows.push_back({study.candidate_of(f).name, variant_name(study.variant_of(f)),
                        study.planning ? "" : short_number(f.z), short_number(f.visibility), smallest_seen(study, f),
                        f.finalist ? weight_text(f.weight) : "", f.finalist ? p_text(f.p) : "", look_alikes(study, f)});
    return html_table({"effect", "form and place", "z", "z to expect at its reference", "seen in 4 of 5 tests from",
                       "weight", "p of what it leaves", "looks like"},
                      rows);
}

std::string further_html(const DiagnoseStudy& study) {
    std::vector<std::vector<std::string>> rows;
    for (const FurtherRow& r : further_rows(study))
        rows.push_back({r.name, std::to_string(r.seen) + " of " + std::to_string(study.diagnosis.findings.size()),
                        std::to_string(r.alike), listed(r.also)});
    if (rows.empty()) return "";
    return "<h2>What to measure in addition</h2>\n" +
           html_table({"test", "effects seen in 4 of 5 tests at their reference strength", "pairs that look alike",
                       "also seen"},
                      rows);
}

constexpr const char* kHow =
    R"(<p><b>z</b>: how well an effect explains what the calibrated model leaves, in standard deviations, with everything taken out that a recalibration absorbs. <b>Weight</b>: of the
finalists and the calibrated model, from simulations at the strength and parameters that fit best. <b>p of what it leaves</b>: how often the effect's own simulations look as far off as the
measurements. <b>Removable gap</b>: what the held-out blocks lose beyond one more repeat of the simulation.</p>
)";

}  // namespace

std::string diagnose_html(const DiagnoseStudy& study, const std::vector<Figure>& figures,
                          const std::vector<Figure>& before, const std::vector<Figure>& after) {
    std::ostringstream html;
    html << "<p class=\"verdict\">" << escaped(verdict_sentence(study)) << "</p>\n<p>" << study.blocks
         << (study.planning ? " blocks planned" : " measured blocks") << "; " << study.diagnosis.simulated_blocks
         << " blocks simulated beside the calibrations.</p>\n";
    std::vector<std::string> audit;
    for (const Finding& f : study.audit) audit.push_back(f.sentence);
    if (!audit.empty()) html << "<h2>What the measurements themselves say</h2>\n" << html_list(audit);
    const std::vector<std::string> remarks = diagnose_remarks(study), where = where_sentences(study);
    if (!remarks.empty()) html << html_list(remarks);
    if (!where.empty())
        html << "<h2>Where the calibrated model fails</h2>\n<p>Beyond chance at 5 %, for all looks together.</p>\n"
             << html_list(where);
    if (const std::vector<std::string> force = force_sentences(study); !force.empty())
        html << "<h2>What has no name, as a force</h2>\n<p>z of the fingerprints of forces along the motion that are "
                "no effect "
                "of the catalogue, after recalibration. Ways that the measurements do not tell apart are joined by "
                "\"or\".</p>\n"
             << html_list(force);
    if (const std::vector<std::string> apart = telling_apart_sentences(study); !apart.empty())
        html << "<h2>What would tell them apart</h2>\n<p>If one of them is at work, with the strength found.</p>\n"
             << html_list(apart);
    if (study.planning) html << further_html(study);
    for (const Figure& f : figures) html << "<h2>" << escaped(f.title) << "</h2>\n" << html_figure(f);
    for (const AnswerFit& a : study.answers) {
        html << "<h2>With " << escaped(a.name()) << "</h2>\n";
        for (const AnsweredEffect& e : a.effects)
            html << "<p>" << escaped(variant_name(e.variant) + ": " + strength_text(e)) << ".</p>\n";
        html << gaps_html(study, a);
        if (&a == &study.answers.front()) html << consequences_html(study);
    }
    if (!study.diagnosis.findings.empty())
        html << "<h2>All effects that were searched</h2>\n" << effects_html(study) << kHow;
    if (!before.empty()) html << "<h2>Measured and simulated, calibrated model</h2>\n";
    for (const Figure& f : before) html << html_figure(f);
    if (!after.empty())
        html << "<h2>Measured and simulated, with " << escaped(study.answers.front().name()) << "</h2>\n";
    for (const Figure& f : after) html << html_figure(f);
    html << "<h2>Not searched</h2>\n"
         << html_list(study.catalogue.left_out) << "<h2>Inputs</h2>\n"
         << html_list(study.inputs);
    return html_page(study.site.settings.name + (study.planning ? ": plan of a test" : ": diagnosis"), html.str());
}

}  // namespace scree::cli
