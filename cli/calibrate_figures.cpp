// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibrate_report.hpp"
#include "cli/plot.hpp"
#include "cli/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree::cli {

namespace {

using gis::Svg;
using gis::SvgPanel;
using gis::SvgText;

constexpr const char* kBeforeColour = "#777777";
constexpr std::array<const char*, 5> kStageColours{"#999999", "#56b4e9", "#cc79a7", "#009e73", "#d55e00"};
constexpr std::size_t kMostDots = 400;  // plausible points in a panel [-]
constexpr std::size_t kMostPairs = 6;   // parameters in the picture of pairs [-]

/// Position in a range that may be searched by ratios.
double unit(const CalibrationParameter& p, double value) {
    return p.logarithmic ? std::log(value / p.low) / std::log(p.high / p.low) : (value - p.low) / (p.high - p.low);
}

/// Every parameter on its range: where it was, where it is, 95 %.
Figure parameter_figure(const CalibrationReport& r) {
    constexpr double kRow = 52.0, kWidth = 520.0, kTop = 58.0;
    const auto& parameters = r.keys.problem.parameters;
    double names = 120.0;
    for (const CalibrationParameter& p : parameters) names = std::max(names, 24.0 + text_width(p.name, 12.0));
    Svg svg(names + kWidth + 60.0, kTop + kRow * static_cast<double>(parameters.size()) + 8.0);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const CalibrationParameter& p = parameters[i];
        const ParameterEstimate& e = r.result.parameters[i];
        const double y = kTop + kRow * static_cast<double>(i) + 14.0;
        const auto x = [&](double value) { return names + kWidth * unit(p, value); };
        svg.text({names - 12.0, y + 4.0}, p.name, words(12.0, "end"));
        svg.box({{names, y - 5.0}, {names + kWidth, y + 5.0}}, fill("#e4e4e4"));
        svg.box({{x(e.interval.low), y - 5.0}, {x(e.interval.high), y + 5.0}}, fill(kMeasuredColour, 0.45));
        svg.segment({x(r.result.start.values[i]), y - 10.0}, {x(r.result.start.values[i]), y + 10.0},
                    stroke(kBeforeColour, 2.5));
        svg.circle({x(e.value), y}, 6.0, fill(kMeasuredColour));
        svg.text({names, y + 21.0}, short_number(p.low), words(10.5, "middle"));
        svg.text({names + kWidth, y + 21.0}, short_number(p.high), words(10.5, "middle"));
        SvgText bold = words(11.5, "middle", true);
        bold.halo = true;
        const std::string unit_text = r.keys.units[i] == "-" ? "" : " " + r.keys.units[i];
        svg.text({x(e.value), y - 10.0}, value_text(e.value, e.interval) + unit_text, bold);
    }
    svg.text({10.0, 20.0}, "Estimates on their ranges", words(13.5, "start", true));
    Vec2 at(names, 40.0);
    at.x() += draw_legend(svg, at, LegendMark::Dot, kMeasuredColour, "calibrated");
    at.x() += draw_legend(svg, at, LegendMark::Band, kMeasuredColour, "95 %");
    at.x() += draw_legend(svg, at, LegendMark::Line, kBeforeColour, "before");
    draw_legend(svg, at, LegendMark::Box, "#e4e4e4", "range");
    return {"parameters.svg", "Estimates",
            "Grey bars are the ranges that were searched. The shorter a blue bar on its range, the more the "
            "measurements say.",
            svg.text()};
}

/// Plausible values of every pair.
Figure pair_figure(const CalibrationReport& r) {
    const auto& parameters = r.keys.problem.parameters;
    const std::size_t n = std::min(parameters.size(), kMostPairs);
    if (n < 2) return {};
    constexpr double kSide = 190.0, kLeft = 78.0, kTop = 44.0, kGap = 30.0, kBottom = 56.0;
    Svg svg(kLeft + static_cast<double>(n - 1) * (kSide + kGap) + 60.0,
            kTop + static_cast<double>(n - 1) * (kSide + kGap) + kBottom);
    for (std::size_t row = 1; row < n; ++row)
        for (std::size_t column = 0; column < row; ++column) {
            const CalibrationParameter &px = parameters[column], &py = parameters[row];
            const Vec2 corner(kLeft + static_cast<double>(column) * (kSide + kGap),
                              kTop + static_cast<double>(row - 1) * (kSide + kGap));
            const SvgPanel panel{{corner, corner + Vec2(kSide, kSide)}, {{px.low, py.low}, {px.high, py.high}}};
            // ranges that are searched by ratios are drawn so; their axes then carry their ends alone
            const auto at = [&](double x, double y) -> Vec2 {
                return corner + Vec2(kSide * unit(px, x), kSide * (1.0 - unit(py, y)));
            };
            if (row + 1 == n) {
                if (px.logarithmic)
                    draw_x_ends(svg, panel, px.name, short_number(px.low), short_number(px.high));
                else
                    draw_x_axis(svg, panel, px.name, 4, false);
            }
            if (column == 0) {
                if (py.logarithmic)
                    draw_y_ends(svg, panel, py.name, short_number(py.low), short_number(py.high));
                else
                    draw_y_axis(svg, panel, py.name, 4, false);
            }
            const std::size_t step = std::max<std::size_t>(1, r.result.draws.size() / kMostDots);
            for (std::size_t k = 0; k < r.result.draws.size(); k += step)
                svg.circle(at(r.result.draws[k][column], r.result.draws[k][row]), 1.8, fill(kMeasuredColour, 0.35));
            const auto& s = r.result.start.values;
            const Vec2 start = at(s[column], s[row]),
                       best = at(r.result.best.values[column], r.result.best.values[row]);
            svg.segment(start - Vec2(6.0, 0.0), start + Vec2(6.0, 0.0), stroke(kBeforeColour, 2.5));
            svg.segment(start - Vec2(0.0, 6.0), start + Vec2(0.0, 6.0), stroke(kBeforeColour, 2.5));
            svg.circle(best, 5.0, fill(kSimulatedColour));
            draw_frame(svg, panel);
            const double c = r.result.correlation(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
            SvgText label = words(11.0, "end");
            label.halo = true;
            svg.text(corner + Vec2(kSide - 6.0, 14.0), "r = " + gis::axis_number(c, 0.01), label);
        }
    svg.text({10.0, 20.0}, "Plausible values, two at a time", words(13.5, "start", true));
    Vec2 at(10.0, 36.0);
    at.x() += draw_legend(svg, at, LegendMark::Dot, kMeasuredColour, "plausible");
    at.x() += draw_legend(svg, at, LegendMark::Dot, kSimulatedColour, "calibrated");
    draw_legend(svg, at, LegendMark::Line, kBeforeColour, "before (cross)");
    return {"pairs.svg", "What the measurements tell apart",
            "Each dot is the best point for the measured blocks drawn again with replacement; r: correlation. A "
            "slanting band means that one parameter can make up for the other.",
            svg.text()};
}

/// The gap of every simulation in its order.
Figure course_figure(const CalibrationReport& r) {
    constexpr double kLeft = 72.0, kTop = 62.0, kWidth = 700.0, kHeight = 240.0;
    std::vector<std::pair<CalibrationStage, double>> gaps;
    double lowest = kInfinity, highest = 0.0;
    for (const CalibrationEvaluation& e : r.journal) {
        double loss = 0.0, floor = 0.0;
        for (std::size_t k = 0; k < e.result.loss.size(); ++k) {
            loss += e.result.loss[k];
            floor += e.result.floor[k];
        }
        const double gap = floor > 0.0 ? loss / floor : kNaN;
        gaps.emplace_back(e.task.stage, gap);
        if (!std::isfinite(gap)) continue;
        lowest = std::min(lowest, gap);
        highest = std::max(highest, gap);
    }
    if (!(highest > 0.0)) return {};
    std::vector<double> sorted;
    for (const auto& [stage, gap] : gaps)
        if (std::isfinite(gap)) sorted.push_back(gap);
    std::sort(sorted.begin(), sorted.end());
    const double top =
        std::min(highest, 2.0 * sample_quantile(sorted, 0.9));  // wild ones of the screening are drawn at the top
    const auto [low, high] = padded_range(std::min(lowest, 1.0), top);
    Svg svg(kLeft + kWidth + 24.0, kTop + kHeight + 52.0);
    const SvgPanel panel{{{kLeft, kTop}, {kLeft + kWidth, kTop + kHeight}},
                         {{0.0, low}, {static_cast<double>(gaps.size()) + 1.0, high}}};
    draw_x_axis(svg, panel, "Simulation", 10, false);
    draw_y_axis(svg, panel, "Gap of what is minimised [-]");
    svg.segment(panel.at({0.0, 1.0}), panel.at({panel.data.max.x(), 1.0}), stroke(kTextColour, 1.2, "5 3"));
    for (std::size_t k = 0; k < gaps.size(); ++k)
        if (std::isfinite(gaps[k].second))
            svg.circle(panel.at({static_cast<double>(k) + 1.0, std::min(gaps[k].second, high)}), 3.0,
                       fill(kStageColours[static_cast<std::size_t>(gaps[k].first)], 0.85));
    draw_frame(svg, panel);
    svg.text({10.0, 20.0}, "Course of the calibration", words(13.5, "start", true));
    Vec2 at(kLeft, 46.0);
    for (std::size_t s = 0; s < kStageColours.size(); ++s)
        at.x() += draw_legend(svg, at, LegendMark::Dot, kStageColours[s], kCalibrationStageNames[s]);
    return {"course.svg", "Course",
            "Gap of every simulation, in order. Dashed: 1, where measured blocks might be more blocks of the "
            "simulation. Surroundings are spread on purpose, to see how fast the gap grows.",
            svg.text()};
}

}  // namespace

std::vector<Figure> calibrate_figures(const CalibrationReport& report) {
    std::vector<Figure> figures;
    const auto add = [&](Figure figure) {
        if (!figure.svg.empty()) figures.push_back(std::move(figure));
    };
    if (!report.result.parameters.empty()) add(parameter_figure(report));
    add(pair_figure(report));
    add(course_figure(report));
    return figures;
}

}  // namespace scree::cli
