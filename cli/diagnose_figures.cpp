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

/// Horizontal bars around zero with the limits of chance.
Figure bar_chart(const std::vector<Bar>& bars, double low_limit, double high_limit, const std::string& title,
                 const std::string& axis, const std::string& strong, const std::string& chance) {
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
    svg.box(
        {{std::max(names, x(both ? low_limit : least)), kTop}, {x(std::min(high_limit, 1.05 * most)), kTop + height}},
        fill("#ececec"));
    draw_x_axis(svg, panel, axis, 8, true);
    for (std::size_t k = 0; k < bars.size(); ++k) {
        const double y = kTop + kRow * static_cast<double>(k);
        const Bar& b = bars[k];
        svg.text({names - 8.0, y + 15.0}, b.name, words(12.0, "end", b.strong));
        svg.box({{std::min(x(0.0), x(b.value)), y + 4.0}, {std::max(x(0.0), x(b.value)), y + kRow - 4.0}},
                fill(b.strong ? kSimulatedColour : "#8c8c8c"));
        if (!b.note.empty()) svg.text({names + kBars + 8.0, y + 15.0}, b.note, words(11.0, "start"));
    }
    svg.segment({x(0.0), kTop}, {x(0.0), kTop + height}, stroke(kTextColour, 1.0));
    svg.text({10.0, 20.0}, title, words(13.5, "start", true));
    Vec2 at(names, 40.0);
    at.x() += draw_legend(svg, at, LegendMark::Box, kSimulatedColour, strong);
    draw_legend(svg, at, LegendMark::Box, "#ececec", chance);
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

Figure effects_figure(const DiagnoseStudy& study) {
    const Diagnosis& d = study.diagnosis;
    std::vector<Bar> bars;
    for (const EffectFinding& f : d.findings) {
        if (study.planning)
            bars.push_back({study.candidate_of(f).name, f.visibility, f.smallest_seen <= 1.0,
                            reference_strength(study.variant_of(f))});
        else
            bars.push_back({study.candidate_of(f).name, f.z, f.z > d.test.z_limit && f.beyond_chance,
                            f.finalist ? "weight " + weight_text(f.weight) : ""});
    }
    if (study.planning)  // else finalists first, by weight
        std::stable_sort(bars.begin(), bars.end(), [](const Bar& a, const Bar& b) { return a.value > b.value; });
    Figure f =
        bar_chart(bars, kNaN, d.test.z_limit, study.planning ? "What could be seen" : "What explains it",
                  study.planning ? "z to expect at the reference strength, before parameters far away make up for it"
                                 : "z of the effect",
                  study.planning ? "seen in 4 of 5 tests" : "beyond chance", chance_words(study));
    f.file = "effects.svg";
    f.title = study.planning ? "What could be seen" : "What explains it";
    f.caption =
        study.planning
            ? "How many standard deviations an effect at its reference strength (behind the bar) would move the "
              "measurements, with all taken out that a recalibration nearby would absorb. Seen: also where a search "
              "all over the ranges has looked for parameters that make up for it."
            : "Bars: how well each effect, at its best place and form, explains what the calibrated model "
              "leaves, in standard deviations; beyond chance if it is so in a place looked at from the start, "
              "as places picked by a closer look are better by chance, too. First the finalists by their weight, "
              "which is that of simulations at the strength and parameters that fit best: those may lie far "
              "from the calibrated model, where the bar cannot show it.";
    return f;
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
