// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/compare_report.hpp"

#include "cli/html.hpp"
#include "cli/text.hpp"
#include "gis/words.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace scree::cli {

namespace {

constexpr std::size_t kNameWidth = 24, kSampleWidth = 23, kGapWidth = 22;

/// Median and spread of a sample: "40.7 (35.1 to 62.7)".
std::string sample_text(const SampleSummary& s) {
    if (s.quantiles.empty()) return "";
    return short_number(s.quantiles[3]) + " (" + short_number(s.quantiles.front()) + " to " +
           short_number(s.quantiles.back()) + ")";
}

std::string share_text(const ShareEstimate& share) {
    const auto [low, high] = share.interval();
    return short_number(100.0 * share.share()) + " % (" + short_number(100.0 * low) + " to " +
           short_number(100.0 * high) + ")";
}

std::string measured_text(const ComparedObservable& o) {
    return o.measured_share.of > 0 ? share_text(o.measured_share) : sample_text(o.measured_summary);
}
std::string simulated_text(const ComparedObservable& o) {
    return o.measured_share.of > 0 ? share_text(o.simulated_share) : sample_text(o.simulated_summary);
}

std::string unit_of(const ComparedObservable& o) {
    return o.unit == "-" ? "" : " [" + o.unit + "]";
}

void print_row(std::ostream& out, const ComparedObservable& o) {
    out << padded(o.gap.observable.name + unit_of(o), kNameWidth) << " " << std::setw(5) << o.gap.measured << "  "
        << padded(measured_text(o), kSampleWidth) << " " << padded(simulated_text(o), kSampleWidth) << " ";
    if (!o.gap.status.empty()) {
        out << o.gap.status << "\n";
        return;
    }
    out << padded(gap_number(o.gap.pooled.gap) + " (" + chance_text(o.gap.pooled) + ")", kGapWidth);
    if (o.gap.score) out << gap_number(o.gap.score->gap) << " (" << chance_text(*o.gap.score) << ")";
    out << "\n";
}

}  // namespace

std::string verdict(const CompareStudy& study) {
    if (!std::isfinite(study.overall.gap)) return "nothing can be compared";
    std::string beyond;
    for (const ComparedObservable& o : study.observables) {
        const bool pooled = o.gap.pooled.beyond_chance(), score = o.gap.score && o.gap.score->beyond_chance();
        if (!pooled && !score) continue;
        const bool too_wide = !pooled && o.gap.score->gap < o.gap.score->chance.low;
        beyond += (beyond.empty() ? "" : ", ") + o.gap.observable.name +
                  (too_wide ? " (single blocks scatter more than measured)" : "");
    }
    const bool overall = study.overall.beyond_chance() || (study.overall_score && study.overall_score->beyond_chance());
    if (overall) return "beyond chance" + (beyond.empty() ? std::string() : ": " + beyond);
    return beyond.empty() ? "within chance: these measurements cannot tell the simulation from the field test"
                          : "within chance as a whole; beyond it " + beyond + ", of " +
                                std::to_string(study.observables.size()) + " looked at";
}

std::string design_text(const CompareStudy& study, const ObservedSite& observed, const CampaignResult& campaign) {
    std::ostringstream text;
    text << gis::counted(study.blocks, "measured block");
    if (observed.observations.matched)
        text << ", each simulated " << study.repeats << " times with its own mass and lengths";
    else
        text << " as a pool, against " << campaign.released << " simulated blocks of the site's own population";
    text << " (seed " << study.seed << ")";
    return text.str();
}

void print_comparison(std::ostream& out, const CompareStudy& study, const ObservedSite& observed,
                      const CampaignResult& campaign) {
    out << study.title << ": " << design_text(study, observed, campaign) << "\n";
    if (const std::string lost = lost_text(study); !lost.empty()) out << lost << "\n";
    out << "distance " << observed.axis_text << "\n\n"
        << padded("", kNameWidth + 8) << padded("median (5 to 95 %)", 2 * kSampleWidth + 2) << "gap (95 % of chance)\n"
        << padded("", kNameWidth) << " " << std::setw(5) << "n"
        << "  " << padded("measured", kSampleWidth) << " " << padded("simulated", kSampleWidth) << " "
        << padded("pooled", kGapWidth) << (observed.observations.matched ? "per block" : "") << "\n";
    for (const ComparedObservable& o : study.observables) print_row(out, o);
    out << padded("all", kNameWidth) << padded("", 2 * kSampleWidth + 10)
        << padded(gap_number(study.overall.gap) + " (" + chance_text(study.overall) + ")", kGapWidth);
    if (study.overall_score)
        out << gap_number(study.overall_score->gap) << " (" << chance_text(*study.overall_score) << ")";
    out << "\n\n";
    for (const SharePair& z : study.zones)
        out << padded("at rest in " + z.name, kNameWidth + 8) << padded(share_text(z.measured), kSampleWidth) << " "
            << share_text(z.simulated) << "\n";
    for (const SharePair& s : study.beyond_screens)
        out << padded("farther along than " + s.name, kNameWidth + 8) << padded(share_text(s.measured), kSampleWidth)
            << " " << share_text(s.simulated) << "\n";
    for (const ComparedObservable& o : study.observables) {
        if (o.gap.observable.name != "runout" || !o.gap.wasserstein) continue;
        const WassersteinGap& w = *o.gap.wasserstein;
        out << "runout differs by " << short_number(w.distance) << " m in the mean (Wasserstein, "
            << short_number(w.interval.low) << " to " << short_number(w.interval.high) << "); chance "
            << short_number(w.chance_median) << " m, 95 % below " << short_number(w.chance_high) << " m\n";
    }
    out << "=> " << verdict(study) << "\n";
}

// --- HTML ---

namespace {

std::string gap_cells(const Gap& gap) {
    const char* beyond = gap.beyond_chance() ? " class=\"beyond\"" : "";
    return "<td" + std::string(beyond) + ">" + gap_number(gap.gap) + "</td><td>" + gap_number(gap.interval.low) +
           " to " + gap_number(gap.interval.high) + "</td><td>" + chance_text(gap) + "</td><td>" + p_text(gap.p) +
           "</td>";
}

std::string observables_table(const CompareStudy& study, bool matched) {
    std::ostringstream html;
    const std::string heads = "<th>gap</th><th>95 %</th><th>chance</th><th>p</th>";
    html << "<table><tr><th rowspan=\"2\">observable</th><th rowspan=\"2\">n</th><th colspan=\"2\">median (5 to 95 "
            "%)</th><th colspan=\"4\">pooled gap</th>"
         << (matched ? "<th colspan=\"4\">gap per block</th>" : "") << "</tr><tr><th>measured</th><th>simulated</th>"
         << heads << (matched ? heads : "") << "</tr>\n";
    for (const ComparedObservable& o : study.observables) {
        html << "<tr><td>" << escaped(o.gap.observable.name + unit_of(o)) << "</td><td>" << o.gap.measured
             << "</td><td>" << measured_text(o) << "</td><td>" << simulated_text(o) << "</td>";
        if (!o.gap.status.empty())
            html << "<td colspan=\"8\">" << escaped(o.gap.status) << "</td>";
        else
            html << gap_cells(o.gap.pooled) << (o.gap.score ? gap_cells(*o.gap.score) : "");
        html << "</tr>\n";
    }
    html << "<tr class=\"all\"><td>all</td><td></td><td></td><td></td>" << gap_cells(study.overall)
         << (study.overall_score ? gap_cells(*study.overall_score) : "") << "</tr></table>\n";
    return html.str();
}

std::string shares_table(const std::vector<SharePair>& pairs, const char* head, bool chainage) {
    if (pairs.empty()) return {};
    std::ostringstream html;
    html << "<table><tr><th>" << head << "</th><th>measured (95 %)</th><th>simulated (95 %)</th></tr>\n";
    for (const SharePair& p : pairs) {
        html << "<tr><td>" << escaped(p.name);
        if (chainage) html << (p.name.empty() ? "" : ", ") << short_number(p.chainage) << " m";
        html << "</td><td>" << share_text(p.measured) << "</td><td>" << share_text(p.simulated) << "</td></tr>\n";
    }
    html << "</table>\n";
    return html.str();
}

std::string distances_table(const CompareStudy& study) {
    std::ostringstream html;
    html << "<table><tr><th>mean distance of the distributions (Wasserstein)</th><th>measured to simulated (95 "
            "%)</th><th>chance, median / 95 %</th>"
            "<th>measured to a resample of itself, median / 95 %</th></tr>\n";
    bool any = false;
    for (const ComparedObservable& o : study.observables) {
        if (!o.gap.wasserstein) continue;
        any = true;
        const WassersteinGap& w = *o.gap.wasserstein;
        const auto number = [&](double v) { return short_number(o.factor * v); };
        html << "<tr><td>" << escaped(o.gap.observable.name + unit_of(o)) << "</td><td>" << number(w.distance) << " ("
             << number(w.interval.low) << " to " << number(w.interval.high) << ")</td><td>" << number(w.chance_median)
             << " / " << number(w.chance_high) << "</td><td>" << number(w.floor_median) << " / " << number(w.floor_high)
             << "</td></tr>\n";
    }
    html << "</table>\n";
    return any ? html.str() : std::string();
}

std::string findings_list(const ObservedSite& observed) {
    if (observed.findings.empty()) return "<p>Nothing was found wrong with the measurements.</p>\n";
    std::string html = "<ul>\n";
    for (const Finding& f : observed.findings)
        html += std::string(f.severity == Severity::Error ? "<li class=\"error\">" : "<li>") + escaped(f.sentence) +
                "</li>\n";
    return html + "</ul>\n";
}

constexpr const char* kDefinitions =
    R"(<p><b>Gap.</b> The energy distance between measured and simulated values, divided by what it would be on average if the measured blocks were more blocks of the simulation: 1 if nothing
differs. <b>95 %</b>: where repetitions of the test would put it. <b>Chance</b>: 95 % of the gaps that so many blocks give if nothing differs, by exchanging measured and simulated blocks; <b>p</b> is
the share of these that are at least as far out. A gap grows with the number of blocks: it says how sure the difference is, not how large. How large it is say the medians and the Wasserstein distance, in metres.
<b>Per block</b>: the energy score of every measured block against its own repeats, divided by the score of one more repeat; it sees which block went where, but grows slowly, and a simulated spread that is too wide lowers it: below chance counts as a difference, too.
<b>Runout</b>: horizontal distance of the stop from the centre of the release area. <b>Distance along</b>, <b>lateral</b>: along the axis and beside it, positive to the left.
Simulated values carry the errors, the averaging and the limits of the measurements. Intervals of shares are Wilson's.</p>
)";

}  // namespace

std::string compare_html(const CompareStudy& study, const ObservedSite& observed, const CampaignResult& campaign,
                         const std::vector<Figure>& figures) {
    std::ostringstream html;
    html << "<p class=\"verdict\">" << escaped(verdict(study)) << "</p>\n<p>"
         << escaped(design_text(study, observed, campaign)) << ". Distance " << escaped(observed.axis_text)
         << ".</p>\n";
    if (const std::string lost = lost_text(study); !lost.empty()) html << "<p>" << escaped(lost) << ".</p>\n";
    for (const Figure& f : figures) {
        if (!f.caption.empty()) {
            html << "<h2>" << escaped(f.title) << "</h2>\n";
            html << html_figure(f);
        }
    }
    html << "<h2>Distributions</h2>\n<div class=\"small\">\n";
    for (const Figure& f : figures)
        if (f.caption.empty()) html << html_figure(f);
    html << "</div>\n<h2>Numbers</h2>\n"
         << observables_table(study, observed.observations.matched) << kDefinitions << distances_table(study)
         << shares_table(study.zones, "at rest in deposit zone", false)
         << shares_table(study.beyond_screens, "stopped farther along than where the axis first crosses the screen",
                         true)
         << shares_table(study.beyond, "stopped beyond distance along", true) << "<h2>Measurements</h2>\n"
         << html_list(observed.sources) << findings_list(observed);
    return html_page(study.title + ": measured and simulated", html.str());
}

}  // namespace scree::cli
