// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_report.hpp"
#include "cli/diagnose_words.hpp"
#include "cli/plot.hpp"
#include "cli/text.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scree::cli {

namespace {

using gis::Svg;
using gis::SvgPanel;

constexpr double kRow = 21.0, kBars = 420.0, kTop = 62.0, kBottom = 54.0;  // [pixel]
constexpr std::size_t kMostRows = 28;

struct Bar {
    std::string name;
    double value = 0.0;
    bool strong = false;
    std::string note{};  ///< behind the bar
};

constexpr const char* kWeakColour = "#8c8c8c";
constexpr const char* kChanceColour = "#ececec";

/// Horizontal bars around zero. With the limits of chance, of which the lower may be missing: `other` names what lies within them; without, the bars that
/// are not strong.
Figure bar_chart(const std::vector<Bar>& bars, double low_limit, double high_limit, const std::string& title,
                 const std::string& axis, const std::string& strong, const std::string& other) {
    double names = 60.0, most = 1.0, notes = 20.0;
    for (const Bar& b : bars) {
        names = std::max(names, 20.0 + text_width(b.name, 12.0));
        most = std::max(most, std::abs(b.value));
        notes = std::max(notes, 30.0 + text_width(b.note, 11.0));
    }
    const bool both = std::isfinite(low_limit);
    if (std::isfinite(high_limit)) most = std::max(most, 1.1 * high_limit);
    const double height = kRow * static_cast<double>(bars.size());
    const double least =
        both ? -1.05 * most : std::min(0.0, 1.05 * std::min_element(bars.begin(), bars.end(), [](auto& a, auto& b) {
                                                       return a.value < b.value;
                                                   })->value);
    Svg svg(names + kBars + notes, kTop + height + kBottom);
    const SvgPanel panel{{{names, kTop}, {names + kBars, kTop + height}}, {{least, 0.0}, {1.05 * most, 1.0}}};
    const auto x = [&](double v) { return panel.at({v, 0.0}).x(); };
    const bool limited = std::isfinite(high_limit);
    if (limited)
        svg.box({{std::max(names, x(both ? low_limit : least)), kTop}, {x(high_limit), kTop + height}},
                fill(kChanceColour));
    draw_x_axis(svg, panel, axis, 8, true);
    for (std::size_t k = 0; k < bars.size(); ++k) {
        const double y = kTop + kRow * static_cast<double>(k);
        const Bar& b = bars[k];
        svg.text({names - 8.0, y + 15.0}, b.name, words(12.0, "end", b.strong));
        svg.box({{std::min(x(0.0), x(b.value)), y + 4.0}, {std::max(x(0.0), x(b.value)), y + kRow - 4.0}},
                fill(b.strong ? kSimulatedColour : kWeakColour));
        if (!b.note.empty()) svg.text({names + kBars + 8.0, y + 15.0}, b.note, words(11.0, "start"));
    }
    svg.segment({x(0.0), kTop}, {x(0.0), kTop + height}, stroke(kTextColour, 1.0));
    svg.text({10.0, 20.0}, title, words(13.5, "start", true));
    Vec2 at(names, 40.0);
    at.x() += draw_legend(svg, at, LegendMark::Box, kSimulatedColour, strong);
    draw_legend(svg, at, LegendMark::Box, limited ? kChanceColour : kWeakColour, other);
    return {"", "", "", svg.text()};
}

Figure where_figure(const DiagnoseStudy& study) {
    const Diagnosis& d = study.diagnosis;
    std::vector<std::size_t> order(d.residuals.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto size = [&](std::size_t k) { return std::abs(d.score.standardised[static_cast<Eigen::Index>(k)]); };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    order.resize(std::min(order.size(), kMostRows));
    std::vector<Bar> bars;
    for (const std::size_t k : order)
        bars.push_back({residual_name(d.residuals[k], study.screens, study.zones),
                        d.score.standardised[static_cast<Eigen::Index>(k)],
                        d.test.residual_p[static_cast<Eigen::Index>(k)] <= study.settings.level, ""});
    Figure f = bar_chart(bars, -d.test.residual_limit, d.test.residual_limit, "What the calibrated model leaves",
                         "measured less simulated [standard deviations]", "beyond chance", chance_words(study));
    f.file = "where.svg";
    f.title = "Residuals of the calibrated model";
    f.caption =
        "Each bar is one look at the measured blocks, zero if they were blocks of the simulation, with all taken "
        "out that other values of the calibrated parameters would absorb. Largest first.";
    return f;
}

Figure named(Figure f, const std::string& title, const std::string& caption) {
    f.file = "effects.svg";
    f.title = title;
    f.caption = caption;
    return f;
}

/// Before a test: how well each effect would be seen.
Figure plan_figure(const DiagnoseStudy& study) {
    const std::string title = "What could be seen";
    std::vector<Bar> bars;
    for (const EffectFinding& f : study.diagnosis.findings)
        bars.push_back({study.candidate_of(f).name, f.visibility, f.smallest_seen <= 1.0,
                        reference_strength(study.variant_of(f))});
    std::stable_sort(bars.begin(), bars.end(), [](const Bar& a, const Bar& b) { return a.value > b.value; });
    return named(bar_chart(bars, kNaN, study.diagnosis.test.z_limit, title,
                           "z to expect at the reference strength, before parameters far away make up for it",
                           "seen in 4 of 5 tests", chance_words(study)),
                 title,
                 "How many standard deviations an effect at its reference strength (behind the bar) would move the "
                 "measurements, with all taken out that a recalibration nearby would absorb. Seen: also where a search "
                 "all over the ranges has looked for parameters that make up for it.");
}

/// Where nothing is missing beyond chance: how well each effect explains what is left all the same.
Figure fingerprints_figure(const DiagnoseStudy& study) {
    const std::string title = "What would explain it";
    const Diagnosis& d = study.diagnosis;
    std::vector<Bar> bars;
    for (const EffectFinding& f : d.findings)
        bars.push_back({study.candidate_of(f).name, f.z, f.z > d.test.z_limit && f.beyond_chance, ""});
    return named(
        bar_chart(bars, kNaN, d.test.z_limit, title, "z of the effect", "beyond chance", chance_words(study)), title,
        "How well each effect, at its best place and form, explains what the calibrated model leaves, in standard "
        "deviations; beyond chance if it is so in a place looked at from the start, as places picked by a closer look "
        "are better by chance, too.");
}

/// What was followed to the strength, place and parameters that leave least, by weight.
Figure left_over_figure(const DiagnoseStudy& study) {
    const std::string title = "What each effect leaves";
    const Diagnosis& d = study.diagnosis;
    std::vector<EffectFinding> followed;
    std::string not_followed;
    for (const EffectFinding& f : d.findings) {
        if (f.finalist)
            followed.push_back(f);
        else
            not_followed += (not_followed.empty() ? "" : ", ") + study.candidate_of(f).name;
    }
    std::stable_sort(followed.begin(), followed.end(), [](const EffectFinding& a, const EffectFinding& b) {
        return a.weight > b.weight || (a.weight == b.weight && a.misfit < b.misfit);
    });
    const auto note = [](double p, double weight) { return "p = " + p_text(p) + ", weight " + weight_text(weight); };
    std::vector<Bar> bars;
    for (const EffectFinding& f : followed) {
        const std::string& name = study.candidate_of(f).name;
        if (std::isfinite(f.misfit))
            bars.push_back({name, f.misfit, f.p >= study.settings.rejected, note(f.p, f.weight)});
        else
            bars.push_back({name, 0.0, false, "cannot produce what was measured"});
    }
    bars.push_back({"calibrated model", d.score.q, false, note(d.test.p, d.weight_none)});
    return named(
        bar_chart(bars, kNaN, kNaN, title, "what is left between measured and simulated (Q)",
                  "as little as chance leaves", "more than chance leaves"),
        title,
        "What is left with each effect at the strength, place and parameters of the soils that leave least, and with "
        "none (last): smaller is better. p: share of tests of that very model in which as much is left; below " +
            short_number(study.settings.rejected) +
            " an effect is no answer. First those that explain most, by weight." +
            (not_followed.empty() ? "" : " Not followed, since they explain too little: " + not_followed + "."));
}

Figure effects_figure(const DiagnoseStudy& study) {
    const std::vector<EffectFinding>& findings = study.diagnosis.findings;
    if (study.planning) return plan_figure(study);
    return std::any_of(findings.begin(), findings.end(), [](const EffectFinding& f) { return f.finalist; })
               ? left_over_figure(study)
               : fingerprints_figure(study);
}

}  // namespace

std::vector<Figure> diagnose_figures(const DiagnoseStudy& study) {
    std::vector<Figure> figures;
    if (study.diagnosis.residuals.empty()) return figures;
    if (!study.planning) figures.push_back(where_figure(study));
    if (!study.diagnosis.findings.empty()) figures.push_back(effects_figure(study));
    return figures;
}

}  // namespace scree::cli
