// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate_report.hpp"

#include "cli/account.hpp"
#include "cli/commands.hpp"
#include "cli/compare_report.hpp"
#include "cli/html.hpp"
#include "cli/json.hpp"
#include "cli/settings.hpp"
#include "cli/text.hpp"
#include "gis/svg.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

namespace scree::cli {

namespace {
namespace fs = std::filesystem;

constexpr double kWorthTelling = 0.7;  // correlations and shares of a direction from here on [-]

struct Row {
    std::string key, before, after, interval, range, verdict;
};

/// Parameters, then choices, as text.
std::vector<Row> rows_of(const CalibrationReport& r) {
    std::vector<Row> rows;
    const CalibrationProblem& p = r.keys.problem;
    for (std::size_t i = 0; i < p.parameters.size(); ++i) {
        const ParameterEstimate& e = r.result.parameters[i];
        const std::string unit = r.keys.units[i] == "-" ? "" : " [" + r.keys.units[i] + "]";
        std::string verdict = kIdentificationNames[static_cast<std::size_t>(e.identified)];
        if (e.at_low) verdict += ", on its lower edge";
        if (e.at_high) verdict += ", on its upper edge";
        rows.push_back({p.parameters[i].name + unit, r.keys.given[i], value_text(r.keys.used(i, e.value), e.interval),
                        value_text(e.interval.low, e.interval) + " to " + value_text(e.interval.high, e.interval),
                        short_number(p.parameters[i].low) + " to " + short_number(p.parameters[i].high), verdict});
    }
    for (std::size_t i = 0; i < p.choices.size(); ++i) {
        std::string others;
        for (const CalibrationSearch& s : r.result.searches)
            if (s.end.levels[i] != r.result.best.levels[i] && s.behind.low <= 0.0 &&
                others.find(p.choices[i].levels[s.end.levels[i]]) == std::string::npos)
                others += (others.empty() ? "" : ", ") + p.choices[i].levels[s.end.levels[i]];
        std::string all;
        for (const std::string& level : p.choices[i].levels) all += (all.empty() ? "" : ", ") + level;
        rows.push_back({p.choices[i].name, p.choices[i].levels[r.result.start.levels[i]],
                        p.choices[i].levels[r.result.best.levels[i]], others.empty() ? "" : "or " + others, all,
                        others.empty() ? "identified" : "not told apart from the others named"});
    }
    return rows;
}

std::string gap_text(const Gap& gap) {
    return gap_number(gap.gap) + " (chance " + chance_text(gap) + ")";
}

std::string list_of(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

Json fit_json(const CalibrationFit& fit) {
    return {{"loss", fit.loss}, {"floor", fit.floor}, {"gap", fit.gap()}};
}
Json gap_json(const Gap& gap) {
    return {{"gap", gap.gap}, {"gap_95", ends_of(gap.interval)}, {"chance_95", ends_of(gap.chance)}, {"p", gap.p}};
}

Json point_json(const CalibrationReport& r, const CalibrationPoint& point) {
    Json json = Json::object();
    for (std::size_t i = 0; i < point.values.size(); ++i)
        json[r.keys.problem.parameters[i].name] = r.keys.used(i, point.values[i]);
    for (std::size_t i = 0; i < point.levels.size(); ++i)
        json[r.keys.problem.choices[i].name] = r.keys.problem.choices[i].levels[point.levels[i]];
    return json;
}

Json study_json(const CompareStudy& study) {
    Json json;
    json["overall"] = gap_json(study.overall);
    if (study.overall_score) json["overall_per_block"] = gap_json(*study.overall_score);
    json["observables"] = Json::object();
    for (const ComparedObservable& o : study.observables) {
        if (!o.gap.status.empty()) continue;
        Json one{{"pooled", gap_json(o.gap.pooled)}};
        if (o.gap.score) one["per_block"] = gap_json(*o.gap.score);
        if (o.gap.wasserstein) one["wasserstein"] = o.factor * o.gap.wasserstein->distance;
        json["observables"][o.gap.observable.name] = one;
    }
    return json;
}

/// "0.95 (0.77)": the score, and that of one more repeat.
std::string score_text(const CalibrationFit& fit) {
    return short_number(fit.loss) + " (" + short_number(fit.floor) + ")";
}

}  // namespace

std::string value_text(double value, const Interval& interval) {
    const double length = interval.high - interval.low;
    if (!(length > 0.0)) return short_number(value);
    return gis::axis_number(value, std::pow(10.0, std::floor(std::log10(length)) - 1.0));
}

std::string held_out_remark(const std::string& what) {
    return "every fold of " + what +
           " ends at the point that all blocks together chose, so that its blocks held out are none: their score is "
           "what was fitted, and favours it; more calibration.surroundings give folds points of their own";
}

std::vector<std::string> calibration_remarks(const CalibrationReport& r) {
    std::vector<std::string> remarks;
    const std::vector<CalibrationParameter>& p = r.keys.problem.parameters;
    if (many_lost(r.after_study))
        remarks.push_back("of the calibrated model " + lost_text(r.after_study) +
                          "; that is what was fitted: enlarge the terrain, lengthen the profile or raise "
                          "model.time_limit");
    std::string unknown;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const ParameterEstimate& e = r.result.parameters[i];
        if (e.at_low || e.at_high)
            remarks.push_back(p[i].name + " lies on the " + (e.at_low ? "lower" : "upper") +
                              " edge of its range: the best value may lie beyond, if the model allows it");
        if (e.identified == Identification::Not) unknown += (unknown.empty() ? "" : ", ") + p[i].name;
    }
    if (!unknown.empty())
        remarks.push_back("not identified: " + unknown +
                          ": the measurements say little more about these than their ranges did; keep the values that "
                          "you have reasons for");
    for (std::size_t i = 0; i < p.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (const double c = r.result.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
                std::abs(c) >= kWorthTelling)
                remarks.push_back(p[j].name + " and " + p[i].name + " trade off (correlation " + short_number(c) +
                                  "): their intervals do not hold independently of each other");
    std::size_t elsewhere = 0, own = 0;
    for (const CalibrationSearch& s : r.result.searches) {
        if (s.end.levels != r.result.best.levels) continue;
        ++own;
        elsewhere += !s.same_minimum;
    }
    if (elsewhere > 0 && !p.empty())
        remarks.push_back(std::to_string(elsewhere) + " of " + std::to_string(own) +
                          " searches ended elsewhere: they were cut short, or there are several minima; more "
                          "generations or starts tell");
    if (!r.result.surroundings.holds)
        remarks.push_back(
            "the losses around the best point are no quadratic: the estimates are those of the search, and their "
            "intervals rough; narrower "
            "ranges or more calibration.surroundings help");
    else if (!p.empty() && r.result.surroundings.explained < 0.5)
        remarks.push_back(
            "the quadratic around the best point explains " + short_number(100.0 * r.result.surroundings.explained) +
            " % of the losses there: mostly noise; more calibration.repeats or calibration.surroundings help");
    if (r.result.held_out_was_seen) remarks.push_back(held_out_remark("the calibration"));
    if (r.after_study.overall.gap > r.before_study.overall.gap)
        remarks.push_back(
            "as a whole the calibrated model is farther from the measurements (gap " +
            gap_number(r.after_study.overall.gap) + ") than the site was (" + gap_number(r.before_study.overall.gap) +
            "): the search was too short, or what it follows is chance; keep the values that you have reasons for");
    if (r.after_study.overall.beyond_chance())
        remarks.push_back(
            "the calibrated model is still beyond chance: something else than the free parameters is missing or wrong");
    return remarks;
}

void print_calibration(std::ostream& out, const CalibrationReport& r) {
    const std::vector<Row> rows = rows_of(r);
    std::size_t key = 16, value = 10, interval = 10, range = 10;
    for (const Row& row : rows) {
        key = std::max(key, row.key.size());
        value = std::max({value, row.before.size(), row.after.size()});
        interval = std::max(interval, row.interval.size());
        range = std::max(range, row.range.size());
    }
    out << r.before.settings.name << ": calibrated on " << r.blocks << " measured blocks (" << list_of(r.observables)
        << ")\n"
        << r.journal.size() << " simulations, " << r.thrown << " blocks thrown (seed " << r.settings.seed << ")\n\n"
        << padded("", key) << "  " << padded("before", value) << "  " << padded("calibrated", value) << "  "
        << padded("95 %", interval) << "  " << padded("range", range) << "\n";
    for (const Row& row : rows)
        out << padded(row.key, key) << "  " << padded(row.before, value) << "  " << padded(row.after, value) << "  "
            << padded(row.interval, interval) << "  " << padded(row.range, range) << "  " << row.verdict << "\n";
    out << "\n"
        << "gap, all observables       " << gap_text(r.before_study.overall) << " before, "
        << gap_text(r.after_study.overall) << " calibrated\n"
        << "score, minimised           " << score_text(r.result.start_fit) << " before, "
        << score_text(r.result.best_fit) << " calibrated";
    if (!r.result.folds.empty())
        out << ", " << score_text(r.result.held_out) << " held out (" << r.result.folds.size() << " folds)";
    out << "; in brackets what one more repeat would have\n";
    if (r.result.directions.size() > 1) {
        const CalibrationDirection& worst = r.result.directions.back();
        std::string words;
        for (std::size_t i = 0; i < worst.weights.size(); ++i)
            if (std::abs(worst.weights[i]) >= 0.2)
                words += (words.empty() ? "" : ", ") + short_number(worst.weights[i]) + " " +
                         r.keys.problem.parameters[i].name;
        out << "known least                " << words << ": +-" << short_number(100.0 * worst.deviation)
            << " % of the range\n";
    }
    for (const std::string& remark : calibration_remarks(r)) out << "=> " << remark << "\n";
}

std::string calibrated_toml(const CalibrationReport& r, const fs::path& to) {
    std::ostringstream text;
    text << "# Calibrated by scree calibrate (scree " << version() << ", seed " << r.settings.seed << ").\n#\n# "
         << padded("key", 40) << padded("before", 12) << padded("calibrated", 12) << padded("95 %", 22) << "range\n";
    for (const Row& row : rows_of(r))
        text << "# " << padded(row.key, 40) << padded(row.before, 12) << padded(row.after, 12)
             << padded(row.interval, 22) << row.range << "; " << row.verdict << "\n";
    text << "#\n# Measured blocks: " << r.blocks << "; minimised: " << list_of(r.observables) << "; "
         << r.journal.size() << " simulations.\n# Gap over all observables: " << gap_text(r.before_study.overall)
         << " before, " << gap_text(r.after_study.overall)
         << " calibrated.\n# Score, minimised (one more repeat would have): " << score_text(r.result.start_fit)
         << " before, " << score_text(r.result.best_fit) << " calibrated";
    if (!r.result.folds.empty()) text << ", " << score_text(r.result.held_out) << " held out";
    text << ".\n";
    for (const std::string& remark : calibration_remarks(r)) text << "# Note: " << remark << ".\n";
    for (const std::string& input : r.inputs) text << "# Input: " << input << "\n";
    text << "\n";
    SiteSettings settings = r.after.settings;
    settings.output_directory = "out";
    text << settings_from(r.after, settings, to);
    return text.str();
}

std::string seen_note(const CalibrationPlace& place) {
    return place.was_seen ? ", by the parameters of all" : "";
}

std::string places_json(const CalibrationResult& result) {
    Json json = Json::array();
    for (const CalibrationPlace& p : result.places)
        json.push_back({{p.is_path ? "path" : "place", p.name},
                        {"fit", fit_json(p.best)},
                        {"blocks_held_out", fit_json(p.held_out)},
                        {"left_out", fit_json(p.test)},
                        {"left_out_was_seen", p.was_seen}});
    return json_text(json, -1);
}

std::string calibrate_json(const CalibrationReport& r) {
    const CalibrationResult& result = r.result;
    Json json;
    json["program"] = "scree " + version();
    json["site"] = r.before.settings.name;
    json["seed"] = r.settings.seed;
    json["measured_blocks"] = r.blocks;
    json["minimised"] = r.observables;
    json["simulations"] = r.journal.size();
    json["blocks_thrown"] = r.thrown;
    json["before"] = point_json(r, result.start);
    json["calibrated"] = point_json(r, result.best);
    json["parameters"] = Json::array();
    for (std::size_t i = 0; i < result.parameters.size(); ++i) {
        const ParameterEstimate& e = result.parameters[i];
        const CalibrationParameter& p = r.keys.problem.parameters[i];
        json["parameters"].push_back({{"key", p.name},
                                      {"unit", r.keys.units[i]},
                                      {"given", r.keys.given[i]},
                                      {"before", result.start.values[i]},
                                      {"value", r.keys.used(i, e.value)},
                                      {"interval_95", ends_of(e.interval)},
                                      {"range", Json::array({p.low, p.high})},
                                      {"logarithmic", p.logarithmic},
                                      {"identified", kIdentificationNames[static_cast<std::size_t>(e.identified)]},
                                      {"on_lower_edge", e.at_low},
                                      {"on_upper_edge", e.at_high}});
    }
    json["correlation"] = Json::array();
    for (Eigen::Index i = 0; i < result.correlation.rows(); ++i) {
        Json row = Json::array();
        for (Eigen::Index j = 0; j < result.correlation.cols(); ++j) row.push_back(result.correlation(i, j));
        json["correlation"].push_back(row);
    }
    json["directions"] = Json::array();
    for (const CalibrationDirection& d : result.directions)
        json["directions"].push_back({{"weights", d.weights}, {"deviation_in_ranges", d.deviation}});
    json["searches"] = Json::array();
    for (const CalibrationSearch& s : result.searches)
        json["searches"].push_back({{"begin", point_json(r, s.begin)},
                                    {"end", point_json(r, s.end)},
                                    {"fit", fit_json(s.fit)},
                                    {"behind_best_95", ends_of(s.behind)},
                                    {"same_minimum", s.same_minimum}});
    if (!result.parameters.empty())
        json["surroundings"] = {{"points", result.surroundings.points},
                                {"noise", result.surroundings.noise},
                                {"explained", result.surroundings.explained},
                                {"quadratic_holds", result.surroundings.holds},
                                {"low", result.surroundings.low},
                                {"high", result.surroundings.high}};
    json["fit_before"] = fit_json(result.start_fit);
    json["fit_calibrated"] = fit_json(result.best_fit);
    if (!result.folds.empty()) {
        json["fit_held_out"] = fit_json(result.held_out);
        json["held_out_was_seen"] = result.held_out_was_seen;
        json["folds"] = Json::array();
        for (const CalibrationFold& f : result.folds)
            json["folds"].push_back({{"held_out", f.held_out},
                                     {"point", point_json(r, f.point)},
                                     {"training", fit_json(f.training)},
                                     {"test", fit_json(f.test)},
                                     {"before", fit_json(f.start_test)}});
    }
    if (!result.places.empty()) json["places"] = Json::parse(places_json(result));
    json["gaps_before"] = study_json(r.before_study);
    json["gaps_calibrated"] = study_json(r.after_study);
    json["remarks"] = calibration_remarks(r);
    json["inputs"] = r.inputs;
    json["plausible_values"] = result.draws;
    return json_text(json, 1) + "\n";
}

namespace {

std::string gaps_table(const CalibrationReport& r) {
    std::vector<std::vector<std::string>> rows;
    for (std::size_t k = 0; k < r.after_study.observables.size(); ++k) {
        const ComparedObservable &b = r.before_study.observables[k], &a = r.after_study.observables[k];
        rows.push_back({a.gap.observable.name, gap_number(b.gap.pooled.gap), gap_number(a.gap.pooled.gap),
                        chance_text(a.gap.pooled), b.gap.score ? gap_number(b.gap.score->gap) : "",
                        a.gap.score ? gap_number(a.gap.score->gap) : ""});
    }
    const CompareStudy &b = r.before_study, &a = r.after_study;
    rows.push_back({"all", gap_number(b.overall.gap), gap_number(a.overall.gap), chance_text(a.overall),
                    b.overall_score ? gap_number(b.overall_score->gap) : "",
                    a.overall_score ? gap_number(a.overall_score->gap) : ""});
    return html_table({"observable", "gap before", "calibrated", "chance", "per block before", "calibrated"}, rows);
}

constexpr const char* kHow =
    R"(<p><b>95 %</b>: where the estimate would lie in repetitions of the field test, from drawing its blocks again; it holds for the model as it is. <b>Identified</b>: the interval is shorter than
a third of the range; <b>not identified</b>: longer than seven tenths. <b>Score</b>: distance of the measured blocks from their own repeats, smaller is better; in brackets what one more repeat would have: a wide simulation has a large one;
<b>held out</b>: every block predicted with the parameters that the other folds gave. A held-out score well above the calibrated one means that chance was fitted.</p>
)";

}  // namespace

std::string calibrate_html(const CalibrationReport& r, const std::vector<Figure>& figures,
                           const std::vector<Figure>& compared) {
    std::ostringstream html;
    html << "<p>" << r.blocks << " measured blocks; minimised: " << escaped(list_of(r.observables)) << "; "
         << r.journal.size() << " simulations.</p>\n";
    const std::vector<std::string> remarks = calibration_remarks(r);
    if (!remarks.empty()) html << "<p class=\"verdict\">";
    for (std::size_t k = 0; k < remarks.size(); ++k) html << (k ? "<br>" : "") << escaped(remarks[k]);
    if (!remarks.empty()) html << "</p>\n";
    std::vector<std::vector<std::string>> rows;
    for (const Row& row : rows_of(r))
        rows.push_back({row.key, row.before, row.after, row.interval, row.range, row.verdict});
    html << html_table({"key", "before", "calibrated", "95 %", "range", ""}, rows);
    rows = {{"all blocks", score_text(r.result.start_fit), score_text(r.result.best_fit)}};
    for (std::size_t f = 0; f < r.result.folds.size(); ++f)
        rows.push_back({"fold " + std::to_string(f + 1) + ", " + std::to_string(r.result.folds[f].held_out.size()) +
                            (r.after_study.repeats > 0 ? " blocks held out" : " records held out"),
                        score_text(r.result.folds[f].start_test), score_text(r.result.folds[f].test)});
    if (!r.result.folds.empty())
        rows.push_back({"all folds", score_text(r.result.held_out_start), score_text(r.result.held_out)});
    html << html_table({"score, minimised", "before", "calibrated"}, rows);
    for (const bool paths : {false, true}) {
        rows.clear();
        for (const CalibrationPlace& p : r.result.places)
            if (p.is_path == paths)
                rows.push_back({p.name, score_text(p.best), score_text(p.held_out), score_text(p.test) + seen_note(p)});
        if (!rows.empty())
            html << html_table({paths ? "of blocks on path" : "of that, at", "calibrated", "blocks held out",
                                "the whole of it left out"},
                               rows);
    }
    html << kHow;
    for (const Figure& f : figures) html << "<h2>" << escaped(f.title) << "</h2>\n" << html_figure(f);
    html << "<h2>Measured and simulated, calibrated</h2>\n" << gaps_table(r);
    for (const Figure& f : compared) html << html_figure(f);
    html << "<h2>Inputs</h2>\n" << html_list(r.inputs);
    return html_page(r.before.settings.name + ": calibration", html.str());
}

}  // namespace scree::cli
