// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_report.hpp"

#include "cli/account.hpp"
#include "cli/calibrate_report.hpp"
#include "cli/commands.hpp"
#include "cli/compare_report.hpp"
#include "cli/diagnose_consequences.hpp"
#include "cli/diagnose_extended.hpp"
#include "cli/diagnose_force.hpp"
#include "cli/diagnose_further.hpp"
#include "cli/diagnose_refits.hpp"
#include "cli/diagnose_words.hpp"
#include "cli/html.hpp"
#include "cli/settings.hpp"
#include "cli/text.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

namespace scree::cli {

namespace fs = std::filesystem;

void print_power(std::ostream& out, const DiagnoseStudy& study) {
    out << "what would be seen in 4 of 5 such tests, at the level of " << short_number(100.0 * study.settings.level)
        << " %, after recalibration, in the form and place where it is seen most easily:\n";
    for (const EffectFinding& f : study.diagnosis.findings) {
        const std::string alike = look_alikes(study, f);
        out << "  " << padded(study.candidate_of(f).name, 24) << (std::isfinite(f.smallest_seen) ? " from " : " ")
            << smallest_seen(study, f)
            << (study.planning ? "; its reference is " + reference_strength(study.variant_of(f)) : "")
            << (alike.empty() ? "" : "; looks like " + alike) << "\n";
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

void print_answers(std::ostream& out, const DiagnoseStudy& study) {
    constexpr std::size_t kFitted = 24, kHeldOut = 11, kOverAll = 29;
    const auto over_all = [](const CompareStudy& compared) {
        return padded(gap_number(compared.overall.gap) + " (" + chance_text(compared.overall) + ")", kOverAll);
    };
    out << "\n"
        << padded("", 34) << padded("gap of what is fitted", kFitted) << padded("held out", kHeldOut)
        << padded("gap over all (95 % of chance)", kOverAll) << "  weight\n";
    out << padded("calibrated model", 34) << padded(gap_number(study.baseline.result.best_fit.gap()), kFitted)
        << padded(held_out_text(study.baseline), kHeldOut) << over_all(study.before) << "  "
        << (study.diagnosis.together ? "" : weight_text(study.diagnosis.weight_none)) << "\n";
    for (const AnswerFit& a : study.answers)
        out << padded("with " + a.name(), 34) << padded(gap_number(a.model.result.best_fit.gap()), kFitted)
            << padded(held_out_text(a.model), kHeldOut) << over_all(a.study) << "  " << weight_text(a.weight()) << "\n";
    if (!study.diagnosis.together)  // a pair is weighed beside each of its effects, not beside these
        out << padded("something without a name", 34) << std::string(kFitted + kHeldOut + kOverAll + 2, ' ')
            << weight_text(study.diagnosis.weight_unnamed) << "\n";
    for (const AnswerFit& a : study.answers) {
        for (const AnsweredEffect& e : a.effects)
            out << "  " << variant_name(e.variant) << ": " << strength_text(e) << "\n";
        for (const std::string& s : held_out_sentences(study, a)) out << "  " << s << "\n";
    }
    for (std::size_t k = 0; k < study.answers.size(); ++k) {
        const std::vector<ScreenChange> changes = changes_at_screens(study, k);
        if (changes.empty()) continue;
        const std::string what = study.standing() > 1 ? study.answers[k].name() : "it";
        out << "\n"
            << "what " << what << " changes, with 95 % values\n"
            << padded("", 34) << padded("passed by [%]", 18) << padded("speed [m/s]", 18) << padded("energy [kJ]", 18)
            << "height [m]\n";
        for (const ScreenChange& c : changes) {
            out << padded("  at " + c.screen, 34);
            for (const ChangedValue& v : values_of(c))
                out << padded(short_number(v.before) + " -> " + short_number(v.after), 18);
            out << "\n";
        }
    }
}

/// Columns as wide as what is in them, the first one as everywhere.
void print_parameters(std::ostream& out, const DiagnoseStudy& study) {
    const auto rows = parameter_rows(study);
    out << "\n";
    for (const std::vector<std::string>& row : rows) {
        std::string line;
        for (std::size_t k = 0; k < row.size(); ++k) {
            std::size_t width = k == 0 ? 32 : 0;
            for (const std::vector<std::string>& other : rows) width = std::max(width, other[k].size());
            line += k + 1 == row.size() ? row[k] : padded(row[k], width + 2);
        }
        out << line << "\n";
    }
}

}  // namespace

void print_diagnosis(std::ostream& out, const DiagnoseStudy& study) {
    out << study.site.settings.name << ": " << study.blocks << (study.planning ? " blocks\n" : " measured blocks\n");
    for (const Finding& f : study.audit) out << "  " << f.sentence << "\n";
    if (!study.planning) out << "=> " << verdict_sentence(study) << "\n";
    const std::vector<std::string> where = where_sentences(study);
    if (!where.empty())
        out << "\nwhere the calibrated model fails (chance of any such finding below "
            << short_number(100.0 * study.settings.level) << " %" << tested_elsewhere(study) << "):\n";
    for (const std::string& s : where) out << "  " << s << "\n";
    const std::vector<std::string> onward = innovation_sentences(study);
    if (!onward.empty())
        out << "\nwhat lies between screens (blocks restarted with the state measured at the first):\n";
    for (const std::string& s : onward) out << "  " << s << "\n";
    const std::vector<std::string> force = force_sentences(study);
    if (!force.empty()) out << "\nwhat has no name, as a force (fingerprints, after recalibration):\n";
    for (const std::string& s : force) out << "  " << s << "\n";
    if (!study.answers.empty()) print_answers(out, study);
    if (study.judged()) print_parameters(out, study);
    const std::vector<std::string> apart = telling_apart_sentences(study);
    if (!apart.empty()) out << "\nwhat would tell them apart, if one of them is at work:\n";
    for (const std::string& s : apart) out << "  " << s << "\n";
    if (study.verdict == Verdict::None && !study.diagnosis.findings.empty()) {
        out << "\n";
        print_power(out, study);
    }
    for (const std::string& remark : diagnose_remarks(study)) out << "=> " << remark << "\n";
}

std::string extended_toml(const DiagnoseStudy& study, std::size_t answer, const fs::path& to) {
    std::ostringstream text;
    text << "# By scree diagnose (scree " << version() << ", seed " << study.settings.seed << ").\n# "
         << verdict_sentence(study) << ".\n";
    const bool answered = answer < study.standing();
    if (study.standing() > 1) text << "# This file has " << study.answers[answer].name() << ".\n";
    for (const std::string& remark : diagnose_remarks(study)) text << "# Note: " << remark << ".\n";
    for (const std::string& input : study.inputs) text << "# Input: " << input << "\n";
    text << "\n";
    const SiteFile site = answered ? extended_site(study, answer, fs::absolute(to) / "results.gpkg")
                                   : with_changes(study.site, study.keys.changes(study.told_point()));
    SiteSettings settings = site.settings;
    settings.output_directory = "out";
    text << settings_from(study.site, settings, to);
    return text.str();
}

namespace {

/// What the rest of the test says of every place, and of blocks that it was not told of; of the calibrated model beside an extended one, if there is one.
std::string places_html(const DiagnoseStudy& study, const AnswerFit* a) {
    const std::vector<CalibrationPlace>& before = study.baseline.result.places;
    if (before.empty() || (a && before.size() != a->model.result.places.size())) return "";
    std::vector<std::string> head{"at"};
    for (const char* what : {"all blocks, calibrated", "held out, calibrated", "left out, calibrated"}) {
        head.emplace_back(what);
        if (a) head.emplace_back("extended");
    }
    std::vector<std::vector<std::string>> rows;
    for (std::size_t k = 0; k < before.size(); ++k) {
        rows.push_back({(before[k].is_path ? "path " : "") + before[k].name});
        for (const auto fit : {&CalibrationPlace::best, &CalibrationPlace::held_out, &CalibrationPlace::test}) {
            const auto add = [&](const CalibrationPlace& place) {
                rows.back().push_back(gap_number((place.*fit).gap()) +
                                      (fit == &CalibrationPlace::test ? seen_note(place) : ""));
            };
            add(before[k]);
            if (a) add(a->model.result.places[k]);
        }
    }
    return "<p>Gap of what is fitted, by where it was measured, and by path where blocks went down several: of all "
           "blocks, of blocks held out, and of the whole place or path left out of the calibration.</p>\n" +
           html_table(head, rows);
}

std::string gaps_html(const DiagnoseStudy& study, const AnswerFit& a) {
    std::vector<std::vector<std::string>> rows;
    for (std::size_t k = 0; k < study.before.observables.size() && k < a.study.observables.size(); ++k) {
        const ComparedObservable &b = study.before.observables[k], &w = a.study.observables[k];
        const bool told = k < study.held_out.size() && k < a.held_out.size();
        rows.push_back({b.gap.observable.name, gap_number(b.gap.pooled.gap), gap_number(w.gap.pooled.gap),
                        told ? gap_number(study.held_out[k].gap) : "", told ? gap_number(a.held_out[k].gap) : "",
                        chance_text(w.gap.pooled)});
    }
    rows.push_back({"all", gap_number(study.before.overall.gap), gap_number(a.study.overall.gap), "", "",
                    chance_text(a.study.overall)});
    if (!study.baseline.result.folds.empty())
        rows.push_back({"what was fitted", gap_number(study.baseline.result.best_fit.gap()),
                        gap_number(a.model.result.best_fit.gap()), held_out_text(study.baseline),
                        held_out_text(a.model), ""});
    const std::vector<std::string> held_out = held_out_sentences(study, a);
    return "<p>A gap of 1 is the noise floor: as far apart as a test drawn from the simulation is by chance.</p>\n" +
           html_table({"gap", "calibrated", "with " + a.name(), "of blocks held out, calibrated", "with " + a.name(),
                       "95 % of chance, with " + a.name()},
                      rows) +
           (held_out.empty() ? "" : "<p>Of what is fitted:</p>\n" + html_list(held_out)) + places_html(study, &a);
}

/// Parameters, and where no answer says more what the calibrated model leaves.
std::string parameters_html(const DiagnoseStudy& study) {
    if (!study.judged()) return "";
    std::vector<std::vector<std::string>> rows = parameter_rows(study);
    const std::vector<std::string> head = rows.front();
    rows.erase(rows.begin());
    std::string html = "<h2>Parameters</h2>\n" + html_table(head, rows);
    if (study.answers.empty() && !study.baseline.result.folds.empty())
        html += "<p>Of what is fitted the calibrated model has a gap of " +
                gap_number(study.baseline.result.best_fit.gap()) + ", of " + held_out_text(study.baseline) +
                " on blocks held out.</p>\n" + places_html(study, nullptr);
    return html;
}

/// What the parameters leave that are told where no answer stands.
std::string moved_html(const DiagnoseStudy& study) {
    if (!study.moved) return "";
    std::vector<std::vector<std::string>> gaps;
    const CompareStudy &before = study.before, &moved = study.moved->study;
    for (std::size_t k = 0; k < before.observables.size(); ++k)
        gaps.push_back({before.observables[k].gap.observable.name, gap_number(before.observables[k].gap.pooled.gap),
                        gap_number(moved.observables[k].gap.pooled.gap), chance_text(moved.observables[k].gap.pooled)});
    gaps.push_back({"all", gap_number(before.overall.gap), gap_number(moved.overall.gap), chance_text(moved.overall)});
    return "<h2>Without an effect</h2>\n<p>Other parameters than the calibrated ones leave less of all that was "
           "measured, and site_extended.toml has them.</p>\n" +
           html_table({"gap", "calibrated", "told", "95 % of chance, told"}, gaps);
}

std::string innovations_html(const DiagnoseStudy& study) {
    std::vector<std::vector<std::string>> rows;
    for (const InnovationRow& r : innovation_rows(study))
        rows.push_back({r.from, r.to, r.what, std::to_string(r.blocks), short_number(r.measured),
                        short_number(r.simulated), short_number(r.standardised), r.stands_out ? "yes" : ""});
    if (rows.empty()) return "";
    const std::string model = study.moved ? "The model with the parameters that are told" : "The calibrated model";
    return "<h2>From screen to screen</h2>\n<p>" + model +
           ", restarted at a screen with what was measured there of speed, height and spin, and what it does up to the "
           "next one: what goes wrong above is left behind, but for where along the screen blocks cross it, which is "
           "as simulated. What a restart forgets (how a block is turned, whether it rolls) is told by simulated blocks "
           "restarted alike, and taken off. Means over the blocks that both are known of; standard errors of their "
           "difference, without those of the parameters. The verdict does not ask for it.</p>\n" +
           html_table({"from", "to", "what", "blocks", "measured", "simulated", "difference [standard errors]",
                       "beyond chance for all looks here"},
                      rows);
}

std::string consequences_html(const DiagnoseStudy& study, std::size_t answer) {
    std::vector<std::vector<std::string>> rows;
    for (const ScreenChange& c : changes_at_screens(study, answer)) {
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
    const bool power = study.planning || study.diagnosis.verdict == Verdict::None;
    std::vector<std::string> head{"effect", "form and place", "reference", "z to expect there", "searched up to"};
    if (!study.planning) head.emplace_back("z");
    if (power)
        head.emplace_back("seen in 4 of 5 tests from");
    else
        head.insert(head.end(), {"weight", "p of what it leaves"});
    head.emplace_back("looks like");
    std::vector<std::vector<std::string>> rows;
    for (const EffectFinding& f : study.diagnosis.findings) {
        const DiagnosisVariant v = study.variant_of(f);
        rows.push_back({study.candidate_of(f).name, variant_name(v), reference_strength(v), short_number(f.visibility),
                        most_searched(v)});
        std::vector<std::string>& row = rows.back();
        if (!study.planning) row.push_back(short_number(f.z));
        if (power)
            row.push_back(smallest_seen(study, f));
        else
            row.insert(row.end(), {f.finalist ? weight_text(f.weight) : "", f.finalist ? p_text(f.p) : ""});
        row.push_back(look_alikes(study, f));
    }
    return html_table(head, rows);
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
finalists, the calibrated model and something without a name, from simulations at the strength and parameters that fit best. <b>Seen from</b>: after a search for parameters that make up
for the effect, in the form and place named beside it, where it is seen most easily; elsewhere it takes more. <b>p of what it leaves</b>: how often the effect's own simulations look as far off as the
measurements. <b>Removable gap</b>: what the held-out blocks lose beyond one more repeat of the simulation. Blocks held out are predicted by refits to the others, which begin from a search, a strength and a place
that all blocks had their part in: the honest check is a second test.</p>
)";

}  // namespace

std::string diagnose_html(const DiagnoseStudy& study, const std::vector<Figure>& figures,
                          const std::vector<ModelFigures>& of_models) {
    std::ostringstream html;
    html << "<p class=\"verdict\">" << escaped(verdict_sentence(study)) << "</p>\n<p>" << study.blocks
         << (study.planning ? " blocks planned" : " measured blocks") << "; " << study.diagnosis.simulated_blocks
         << " blocks simulated for the verdict, beside the calibrations.</p>\n";
    std::vector<std::string> audit;
    for (const Finding& f : study.audit) audit.push_back(f.sentence);
    if (!audit.empty()) html << "<h2>What the measurements themselves say</h2>\n" << html_list(audit);
    const std::vector<std::string> remarks = diagnose_remarks(study), where = where_sentences(study);
    if (!remarks.empty()) html << html_list(remarks);
    if (!where.empty())
        html << "<h2>Where the calibrated model fails</h2>\n<p>Beyond chance at "
             << short_number(100.0 * study.settings.level) << " %, for all looks together"
             << escaped(tested_elsewhere(study)) << ".</p>\n"
             << html_list(where);
    html << innovations_html(study);
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
    for (std::size_t k = 0; k < study.answers.size(); ++k) {
        const AnswerFit& a = study.answers[k];
        html << "<h2>With " << escaped(a.name()) << "</h2>\n";
        for (const AnsweredEffect& e : a.effects)
            html << "<p>" << escaped(variant_name(e.variant) + ": " + strength_text(e)) << ".</p>\n";
        html << gaps_html(study, a) << consequences_html(study, k);
    }
    html << moved_html(study) << parameters_html(study);
    if (!study.diagnosis.findings.empty())
        html << "<h2>All effects that were searched</h2>\n" << effects_html(study) << kHow;
    for (const ModelFigures& m : of_models) {
        html << "<h2>Measured and simulated, " << escaped(m.model) << "</h2>\n";
        for (const Figure& f : m.figures) html << html_figure(f);
    }
    if (!study.catalogue.left_out.empty()) html << "<h2>Not searched</h2>\n" << html_list(study.catalogue.left_out);
    html << "<h2>Inputs</h2>\n" << html_list(study.inputs);
    return html_page(study.site.settings.name + (study.planning ? ": plan of a test" : ": diagnosis"), html.str());
}

}  // namespace scree::cli