// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_words.hpp"

#include "cli/calibrate_report.hpp"
#include "cli/diagnose_extended.hpp"
#include "cli/diagnose_further.hpp"
#include "cli/diagnose_models.hpp"
#include "cli/diagnose_refits.hpp"
#include "cli/diagnose_units.hpp"
#include "cli/text.hpp"
#include "scree/inference/distance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace scree::cli {

namespace {

constexpr std::size_t kMostSentences = 8;
constexpr double kWorthSaying = 0.05;  // least weight of an effect that is said where none is an answer [-]
constexpr double kRatherChance = 0.5;  // weight of chance above which it is likelier than all that could be missing [-]
constexpr double kMoved = 0.05;        // a parameter that changes by less of its range has not moved [-]
constexpr double kInRange = 0.03;      // estimates nearer to an end of their range lie on its edge [-]

/// Less is the way blocks roll, not a third dimension [m].
constexpr double kWorthTelling = 0.5;

/// To a decimetre.
std::string metres_along(double chainage) {
    return short_number(std::round(10.0 * chainage) / 10.0);
}

std::string with_unit(double value, const std::string& unit) {
    return short_number(value) + (unit == "-" ? "" : " " + unit);
}

}  // namespace

std::string variant_name(const DiagnosisVariant& v) {
    const std::string name = v.form();
    return v.label.empty() ? name : name + ", " + v.label;
}

std::string reference_strength(const DiagnosisVariant& v) {
    return v.parameter + " " + with_unit(v.value(1.0), v.unit());
}

std::string most_searched(const DiagnosisVariant& v) {
    return v.space ? "" : v.parameter + " " + with_unit(v.value(v.most), v.unit());
}

std::string strength_text(const AnsweredEffect& e) {
    const DiagnosisVariant& v = e.variant;
    if (v.space) return "the blocks move in 3D";
    const double a = v.value(e.interval.low), b = v.value(e.interval.high);
    std::string text = v.parameter + " " + with_unit(v.value(e.strength), v.unit()) +
                       (e.is_determined() ? " (95 %: " : " (not determined, it may be anything that is searched: ") +
                       short_number(std::min(a, b)) + " to " + short_number(std::max(a, b)) + ")";
    if (v.on) {
        const Interval middle = middle_interval(e);
        text += ", its middle at " + metres_along(v.on->middle()) + " m (95 %: " + metres_along(middle.low) + " to " +
                metres_along(middle.high) + ")";
    }
    return text;
}

Interval middle_interval(const AnsweredEffect& e) {
    const double middle = e.variant.on->middle(),
                 reach =
                     kNinetyFive * (std::isfinite(e.finding.middle_deviation) ? e.finding.middle_deviation : kInfinity);
    const Stretch& path = *e.candidate->variants[e.finding.variant].path;
    return {std::max(middle - reach, path.from), std::min(middle + reach, path.to)};
}

std::string held_out_text(const CalibratedModel& m) {
    return m.result.folds.empty() ? "-" : gap_number(m.result.held_out.gap());
}

std::vector<std::string> held_out_sentences(const DiagnoseStudy& study, const AnswerFit& answer) {
    std::vector<std::string> sentences;
    if (const auto share = removable_gap_closed(study, answer))
        sentences.push_back(
            *share > 0.0 ? "closes " + short_number(100.0 * std::min(1.0, *share)) + " % of the removable held-out gap"
                         : "widens the removable held-out gap by " + short_number(-100.0 * *share) + " %");
    // losses and gaps may point to different sides: a model of which the blocks scatter less has a lower floor
    if (answer.model.result.held_out.loss < study.baseline.result.held_out.loss &&
        answer.model.result.held_out.gap() > study.baseline.result.held_out.gap())
        sentences.push_back(
            "loses less all the same where its held-out gap is larger: gaps are relative to what each "
            "model's own blocks scatter by, which is less with " +
            answer.name());
    const std::string record = study.before.repeats > 0 ? "a block" : "a record";
    if (const auto gain = held_out_log_gain(study, answer))
        sentences.push_back(record + " held out is " + std::string(gain->mean < 0.0 ? "less" : "more") +
                            " likely with " + answer.name() + ", the logarithm of its likelihood " +
                            (gain->mean < 0.0 ? "lower" : "higher") + " by " + short_number(std::abs(gain->mean)) +
                            " +- " + short_number(gain->error) + " (mean and standard error)");
    return sentences;
}

std::vector<std::vector<std::string>> parameter_rows(const DiagnoseStudy& study) {
    std::vector<std::string> head{"parameter", "as given", "calibrated"};
    const CalibrationPoint given = study.given_point();
    std::vector<const CalibrationPoint*> points{&given, &study.baseline.point};
    if (study.moved) {
        head.emplace_back("told");
        points.push_back(&study.moved->point);
    }
    for (const AnswerFit& a : study.answers) {
        head.push_back("with " + a.name());
        points.push_back(&a.model.point);
    }
    std::vector<std::vector<std::string>> rows{head};
    const CalibrationProblem& problem = study.keys.problem;
    for (std::size_t k = 0; k < problem.parameters.size(); ++k) {
        rows.push_back({problem.parameters[k].name});
        for (const CalibrationPoint* p : points)
            rows.back().push_back(p == &given && std::isnan(problem.parameters[k].start) ? "-"
                                                                                         : short_number(p->values[k]));
    }
    for (std::size_t k = 0; k < problem.choices.size(); ++k) {
        rows.push_back({problem.choices[k].name});
        for (const CalibrationPoint* p : points) rows.back().push_back(problem.choices[k].levels[p->levels[k]]);
    }
    return rows;
}

std::string smallest_seen(const DiagnoseStudy& study, const EffectFinding& f) {
    if (!std::isfinite(f.smallest_seen)) return "not visible";
    const DiagnosisVariant v = study.seen_variant_of(f);
    return variant_name(v) + ": " + v.parameter + " " + with_unit(v.value(f.smallest_seen), v.unit());
}

std::string look_alikes(const DiagnoseStudy& study, const EffectFinding& f) {
    std::vector<std::string> names;
    for (const EffectFinding& other : study.diagnosis.findings)
        if (look_alike(study.diagnosis, f, other)) names.push_back(study.candidate_of(other).name);
    return listed(names);
}

namespace {

std::vector<std::size_t> by_size(const Eigen::VectorXd& values) {
    std::vector<std::size_t> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::abs(values[static_cast<Eigen::Index>(a)]) > std::abs(values[static_cast<Eigen::Index>(b)]);
    });
    return order;
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
std::string subject_of(const DiagnoseStudy& study, const Residual& r) {
    Residual plain = r;
    if (r.kind == ResidualKind::MassTrend || r.kind == ResidualKind::ShapeTrend || r.kind == ResidualKind::OrderTrend)
        plain.kind = ResidualKind::Level;
    return residual_name(plain, study.screens, study.zones);
}

/// "ground_drag, on loose waste (drag in contact)", of two effects both; of a family the words of the form that is named.
std::string described(const AnswerFit& answer) {
    std::string text;
    for (const AnsweredEffect& e : answer.effects) {
        const bool in_catalogue = !e.variant.space && !e.variant.probe;
        text += (text.empty() ? "" : " and ") + variant_name(e.variant) + " (" +
                (in_catalogue ? effect_info(e.variant.kind).title : e.candidate->title) + ")";
    }
    return text;
}

/// ", too fast", of a single effect that has ways to act.
std::string label_of_one(const std::vector<AnswerFit>& answers) {
    if (answers.size() != 1 || answers.front().effects.size() != 1) return "";
    const std::string& label = answers.front().effects.front().variant.label;
    return label.empty() ? "" : ", " + label;
}

std::string answer_names(const std::vector<AnswerFit>& answers) {
    std::string text;
    for (std::size_t k = 0; k < answers.size(); ++k)
        text += (k == 0 ? "" : k + 1 == answers.size() ? " or " : ", ") + answers[k].name();
    return text;
}

/// "coefficient 200 kg/s": of an effect that is no answer, as it was followed; nothing of the third dimension.
std::string as_followed(const DiagnosisVariant& v, const EffectFinding& f) {
    if (v.space) return "";
    return v.parameter + " " + with_unit(v.value(f.strength), v.unit());
}

/// Effects that could have produced the measurements, none of them by far the likeliest; empty if what comes nearest could not, and nothing else is worth a word.
std::string rivals(const DiagnoseStudy& study) {
    const Diagnosis& d = study.diagnosis;
    if (d.findings.empty() || !d.findings.front().finalist) return "";
    std::string text;
    std::size_t count = 0;
    for (const EffectFinding& f : d.findings) {  // by weight
        if (!f.finalist || f.p <= study.settings.rejected || f.weight < kWorthSaying ||
            ++count > study.settings.largest_group)
            continue;
        const DiagnosisVariant v = study.variant_of(f);
        const std::string how = as_followed(v, f);
        text += variant_name(v) + " (" + how + (how.empty() ? "" : ", ") + "weight " + weight_text(f.weight) + "), ";
    }
    if (count == 0 && d.findings.front().p <= study.settings.rejected) return "";
    return text + "something without a name (" + weight_text(d.weight_unnamed) + "), or chance (" +
           weight_text(d.weight_none) + ")";
}

/// What comes nearest, where it cannot be it.
std::string nearest(const DiagnoseStudy& study) {
    const std::vector<EffectFinding>& findings = study.diagnosis.findings;
    if (findings.empty() || !findings.front().finalist || findings.front().p > study.settings.rejected) return "";
    const EffectFinding& f = findings.front();
    const DiagnosisVariant v = study.variant_of(f);
    const std::string how = as_followed(v, f);
    return "; " + variant_name(v) + (how.empty() ? "" : " (" + how + ")") + " comes nearest, but only " +
           short_number(100.0 * f.p) + " % of its own simulations look as far off";
}

std::string unknown_sentence(const DiagnoseStudy& study) {
    const Diagnosis& d = study.diagnosis;
    const std::string missing = std::string("UNKNOWN: something ") + (d.weight_none > kRatherChance ? "may be" : "is") +
                                " missing (p = " + p_text(d.test.p) + ")";
    if (!study.demoted.empty()) return missing + ", but it gets no name: " + study.demoted;
    if (const std::string some = rivals(study); !some.empty())
        return missing + ", and these measurements do not say what: " + some + nearest(study);
    return missing + " that has no name in the catalogue" + nearest(study);
}

/// "soil.slope.restitution = 0.02 and not 0.31, ...": what is not as calibrated, visibly; empty if nothing is.
std::string moved_parameters(const DiagnoseStudy& study, const CalibrationPoint& told) {
    const CalibrationPoint& calibrated = study.baseline.point;
    const CalibrationProblem& problem = study.keys.problem;
    std::string text;
    const auto add = [&](const std::string& name, const std::string& now, const std::string& before) {
        text += (text.empty() ? "" : ", ") + name + " = " + now + " and not " + before;
    };
    for (std::size_t k = 0; k < problem.parameters.size(); ++k) {
        const CalibrationParameter& p = problem.parameters[k];
        if (std::abs(to_unit(p, told.values[k]) - to_unit(p, calibrated.values[k])) >= kMoved)
            add(p.name, short_number(told.values[k]), short_number(calibrated.values[k]));
    }
    for (std::size_t k = 0; k < problem.choices.size(); ++k) {
        const CalibrationChoice& c = problem.choices[k];
        if (told.levels[k] != calibrated.levels[k])
            add(c.name, c.levels[told.levels[k]], c.levels[calibrated.levels[k]]);
    }
    return text;
}

/// Where nothing is missing from a model whose parameters are neither the calibrated ones nor told: what they are.
std::string none_elsewhere(const DiagnoseStudy& study) {
    if (!study.judged() || study.verdict != Verdict::None) return "";
    return moved_parameters(study, study.tested_point());
}

}  // namespace

std::string verdict_sentence(const DiagnoseStudy& study) {
    const Diagnosis& d = study.diagnosis;
    if (study.planning) return "planned: what a test like this could see";
    switch (study.verdict) {
        case Verdict::None:
            return std::string("NONE: the ") +
                   (none_elsewhere(study).empty() ? "calibrated model"
                                                  : "model, with other parameters than the calibrated ones,") +
                   " could have produced these measurements (p = " + p_text(d.test.p) +
                   "); nothing is missing that they could show";
        case Verdict::Named:
            return "NAMED: " + described(study.answers.front());
        case Verdict::Group:
            return "GROUP: " + answer_names(study.answers) + "; these measurements cannot tell them apart";
        case Verdict::Unknown:
            return unknown_sentence(study);
        case Verdict::DataProblem:
            if (study.answers.empty()) return "DATA PROBLEM: the measurements cannot be used as they are";
            return "DATA PROBLEM: " + answer_names(study.answers) + label_of_one(study.answers) +
                   (study.several() ? "; these measurements cannot tell them apart" : "") +
                   "; check how it was measured before anything else";
    }
    return "";
}

std::string chance_words(const DiagnoseStudy& study) {
    return short_number(100.0 * (1.0 - study.settings.level)) + " % of chance, for all together";
}

std::string tested_elsewhere(const DiagnoseStudy& study) {
    const std::string tested = moved_parameters(study, study.tested_point());
    return tested.empty() ? ""
                          : "; standard deviations and p are those of the model that was tested, with " + tested +
                                ", and what is simulated is that of the calibrated one";
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
        sentences.push_back(subject_of(study, r) + " " + direction(r, s > 0.0) + in_units(study, r, s > 0.0) + " (" +
                            short_number(std::abs(s)) + " standard deviations, p = " + p_text(d.test.residual_p[i]) +
                            ")");
    }
    return sentences;
}

/// Sites count from and to along the profile, and what is measured may be counted along another line.
static std::string distances_text(const DiagnoseStudy& study, const DiagnosisVariant& v) {
    std::string text = "distances count " + study.distances;
    const auto same = [](double a, double b) { return metres_along(a) == metres_along(b); };
    if (v.on_profile && !(same(v.on->from, v.on_profile->from) && same(v.on->to, v.on_profile->to)))
        text += "; from " + metres_along(v.on_profile->from) + " to " + metres_along(v.on_profile->to) +
                " m along the profile, from its head";
    return text;
}

/// Where else an effect may be expected. A place is one; a law holds as far as it was seen.
static std::string transfer(const DiagnoseStudy& study, const CampaignResult& campaign, const AnsweredEffect& e) {
    if (e.candidate->measurement)
        return e.candidate->name + " is a matter of this test: it says nothing of other slopes";
    if (e.variant.space)
        return "what is missing is the third dimension: go on with site_extended.toml, which is 3D, and diagnose it, "
               "too";
    if (e.variant.on)
        return e.candidate->name + " belongs to that place (" + distances_text(study, e.variant) +
               "): elsewhere look for its cause on the ground, and keep it out of the model where there is none";
    double lightest = kInfinity, heaviest = 0.0;
    std::vector<double> speeds;
    for (const BlockResult& b : campaign.blocks) {
        lightest = std::min(lightest, b.mass);
        heaviest = std::max(heaviest, b.mass);
        speeds.push_back(b.largest_speed);
    }
    if (speeds.empty()) return e.candidate->name + " holds for this slope and these blocks";
    std::sort(speeds.begin(), speeds.end());
    const double fastest = e.variant.soil.empty() ? sample_quantile(speeds, 0.95) : e.fastest;
    return variant_name(e.variant) + " as a law was seen with blocks of " + short_number(lightest) + " to " +
           short_number(heaviest) + " kg" +
           (std::isfinite(fastest) ? ", 95 % of them slower than " + short_number(fastest) + " m/s" : "") +
           (e.variant.soil.empty() ? "" : " on " + e.variant.soil) +
           ": it may be carried to ground like this; beyond these masses and speeds it is a guess";
}

std::vector<InnovationRow> innovation_rows(const DiagnoseStudy& study) {
    std::vector<InnovationRow> rows;
    for (const ScreenInnovation& i : study.innovations) {
        const bool share = i.quantity == Quantity::Passed;
        const char* what = share                            ? "passing it [%]"
                           : i.quantity == Quantity::Speed  ? "speed [m/s]"
                           : i.quantity == Quantity::Height ? "height [m]"
                           : i.quantity == Quantity::Spin   ? "spin [rad/s]"
                                                            : "distance along [m]";
        const double factor = share ? 100.0 : 1.0, z = i.standardised();
        const double p = std::erfc(std::abs(z) / std::numbers::sqrt2);
        rows.push_back({study.screens[static_cast<std::size_t>(i.from)],
                        i.to < 0 ? "the stop" : study.screens[static_cast<std::size_t>(i.to)], what, i.blocks,
                        factor * i.measured, factor * i.simulated, z,
                        p * static_cast<double>(study.innovations.size()) <= study.settings.level});
    }
    return rows;
}

std::vector<std::string> innovation_sentences(const DiagnoseStudy& study) {
    std::vector<std::string> sentences;
    for (const InnovationRow& r : innovation_rows(study))
        if (r.stands_out && study.verdict != Verdict::None)
            sentences.push_back("from " + r.from + " to " + r.to + ": " + r.what + " " + short_number(r.measured) +
                                " measured, " + short_number(r.simulated) + " simulated (" + std::to_string(r.blocks) +
                                " blocks, " + short_number(std::abs(r.standardised)) + " standard errors)");
    return sentences;
}

static std::string as_followed_remark(const std::string& model) {
    return model +
           " stays where the diagnosis followed it to: the calibration, which minimises a part of what is compared, "
           "left "
           "it for what is worse as a whole; blocks held out were predicted by calibrations";
}

/// What a 2D model leaves out; empty where that is the answer.
static std::string sideways_remark(const DiagnoseStudy& study) {
    for (const AnswerFit& a : study.answers)
        if (study.answer() && a.in_space()) return "";
    std::string known, beside;
    for (const EffectFinding& f : study.diagnosis.findings) {
        if (!study.variant_of(f).space) continue;
        if (!f.finalist) continue;  // not asked
        known = "third_dimension has weight " + weight_text(f.weight);
        if (&f == &study.diagnosis.findings.front())
            beside = ", which also looks for what acts beside the third dimension";
    }
    if (study.beside > kWorthTelling)
        known += (known.empty() ? "" : "; ") +
                 ("the stops scatter across the axis with a standard deviation of " + short_number(study.beside)) +
                 " m";
    if (study.verdict == Verdict::None)
        return study.beside > kWorthTelling
                   ? "the model is 2D and says nothing of what blocks do sideways: model.dimension = 3 does (" + known +
                         ")"
                   : "";
    return "the model is 2D: what blocks do sideways can look like an effect; confirm with model.dimension = 3" +
           beside + (known.empty() ? "" : " (" + known + ")");
}

std::vector<std::string> diagnose_remarks(const DiagnoseStudy& study) {
    std::vector<std::string> remarks;
    if (many_lost(study.before)) remarks.push_back("of the calibrated model " + lost_text(study.before));
    const auto& parameters = study.keys.problem.parameters;
    for (std::size_t i = 0; i < study.baseline.result.parameters.size() && !study.planning; ++i) {
        const ParameterEstimate& e = study.baseline.result.parameters[i];
        if (e.at_low || e.at_high)
            remarks.push_back(parameters[i].name +
                              " of the calibrated model lies on the edge of its range: a missing "
                              "effect often drives it there");
    }
    if (study.moved) {
        const std::string moved = moved_parameters(study, study.told_point());
        remarks.push_back("less is left over all with " +
                          (moved.empty() ? "parameters that are nearly the calibrated ones" : moved) +
                          ": site_extended.toml and results.gpkg have that (mean distance " +
                          gap_number(distance_over(study.told(), study.before)) + ", of the calibrated model " +
                          gap_number(distance_over(study.before, study.before)) +
                          ", in units of what chance gives for the calibrated model)");
    }
    if (const std::string tested = none_elsewhere(study); !tested.empty())
        remarks.push_back("p is that of the model with " + tested +
                          (study.moved ? std::string()
                                       : "; the calibrated values leave less over all, and site_extended.toml and "
                                         "results.gpkg have those"));
    if (study.judged() && study.verdict == Verdict::None && study.told().overall.beyond_chance())
        remarks.push_back(
            "no residual that was tested stands out, and yet the model is beyond chance as a whole (gap "
            "over all " +
            gap_number(study.told().overall.gap) + "): look at the observables in the report before you trust it");
    if (study.judged() && study.verdict == Verdict::Unknown && study.told().overall.beyond_chance())
        remarks.push_back("the model without what is missing is beyond chance as a whole (gap over all " +
                          gap_number(study.told().overall.gap) +
                          "): what it says of screens and reach is off by what is missing");
    if (study.judged() && study.baseline.result.held_out_was_seen)
        remarks.push_back(held_out_remark("the calibrated model"));
    if (study.baseline.as_followed) remarks.push_back(as_followed_remark("the calibrated model"));
    for (const AnswerFit& a : study.answers) {
        if (a.model.as_followed) remarks.push_back(as_followed_remark("the model with " + a.name()));
        if (study.verdict == Verdict::Unknown) continue;
        if (a.model.result.held_out_was_seen) remarks.push_back(held_out_remark("the model with " + a.name()));
        for (const AnsweredEffect& e : a.effects)
            if (!e.variant.space && e.strength > (1.0 - kInRange) * e.variant.most)
                remarks.push_back("the strength of " + e.candidate->name + " lies at the end of what was searched");
        if (!study.baseline.result.folds.empty() &&
            !(a.model.result.held_out.loss < study.baseline.result.held_out.loss))
            remarks.push_back("the prediction of blocks held out does not improve with " + a.name());
        for (std::size_t k = 0; k < a.model.result.places.size() && k < study.baseline.result.places.size(); ++k) {
            const CalibrationPlace &with = a.model.result.places[k], &without = study.baseline.result.places[k];
            if (!(with.test.loss < without.test.loss))
                remarks.push_back("the rest of the test predicts " + with.name + " no better with " + a.name());
        }
        if (a.study.overall.beyond_chance())
            remarks.push_back("with " + a.name() + " the model is still beyond chance as a whole");
    }
    for (std::size_t k = 1; k < study.standing(); ++k)
        remarks.push_back(extended_name(k) + " is the site with " + study.answers[k].name() +
                          "; site_extended.toml, layers and maps have " + study.answers.front().name() +
                          ": build on neither before they are told apart");
    if (study.several())
        for (const AnswerFit& a : study.answers)
            for (const AnsweredEffect& e : a.effects)
                remarks.push_back(e.candidate->name + " would show in " + e.variant.seen_in());
    if (study.in_plane && !study.planning && !study.diagnosis.findings.empty()) {
        const std::string sideways = sideways_remark(study);
        if (!sideways.empty()) remarks.push_back(sideways);
    }
    if (study.verdict == Verdict::Named)
        remarks.push_back("the name is the best of " + std::to_string(study.catalogue.candidates.size()) +
                          " that were searched");
    if (study.verdict == Verdict::Named || study.verdict == Verdict::Group)
        for (const AnswerFit& a : study.answers)
            for (const AnsweredEffect& e : a.effects) remarks.push_back(transfer(study, a.campaign, e));
    return remarks;
}

}  // namespace scree::cli
