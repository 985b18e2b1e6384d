// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/compare_figures.hpp"

#include "cli/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace scree::cli {

namespace {

using gis::Svg;
using gis::SvgPanel;
using gis::SvgText;

constexpr double kPanelWidth = 330.0, kPanelHeight = 250.0;                 // [pixel]
constexpr double kLeft = 72.0, kRight = 22.0, kTop = 74.0, kBottom = 52.0;  // room around a panel [pixel]

std::string capital(std::string text) {
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
    return text;
}

/// A place for a panel in a row of them.
SvgPanel panel_at(double column, const Box2& data) {
    const Vec2 corner(kLeft + column * (kLeft + kPanelWidth + kRight), kTop);
    return {{corner, corner + Vec2(kPanelWidth, kPanelHeight)}, data};
}
Svg picture(double columns) {
    return {columns * (kLeft + kPanelWidth + kRight), kTop + kPanelHeight + kBottom};
}

/// Corners of the step function that rises by a share at every value.
std::vector<Vec2> steps_of(const SvgPanel& panel, std::vector<double> values, bool falling) {
    std::sort(values.begin(), values.end());
    const double n = static_cast<double>(values.size());
    const auto height = [&](double k) { return falling ? 1.0 - k / n : k / n; };
    std::vector<Vec2> line{panel.at({panel.data.min.x(), height(0.0)})};
    for (std::size_t k = 0; k < values.size(); ++k) {
        line.push_back(panel.at({values[k], height(static_cast<double>(k))}));
        line.push_back(panel.at({values[k], height(static_cast<double>(k) + 1.0)}));
    }
    line.push_back(panel.at({panel.data.max.x(), height(n)}));
    return line;
}

/// Measured steps over the simulated line and its band; rising: shares at or below, falling: shares above.
void draw_distribution(Svg& svg, const SvgPanel& panel, const ComparedObservable& o, bool falling) {
    const auto turned = [&](double share) { return falling ? 1.0 - share : share; };
    std::vector<Vec2> upper, lower, line;
    for (std::size_t k = 0; k < o.band.x.size(); ++k) {
        upper.push_back(panel.at({o.band.x[k], turned(o.band.high[k])}));
        lower.push_back(panel.at({o.band.x[k], turned(o.band.low[k])}));
        line.push_back(panel.at({o.band.x[k], turned(o.band.share[k])}));
    }
    std::vector<Vec2> band = upper;
    band.insert(band.end(), lower.rbegin(), lower.rend());
    const std::array rings{band};
    svg.area(rings, fill(kSimulatedColour, 0.22));
    svg.line(line, stroke(kSimulatedColour, 2.0));
    svg.line(steps_of(panel, o.measured, falling), stroke(kMeasuredColour, 2.0));
}

void draw_distribution_legend(Svg& svg, const SvgPanel& panel, const ComparedObservable& o) {
    Vec2 at = panel.pixels.min + Vec2(0.0, -10.0);
    at.x() +=
        draw_legend(svg, at, LegendMark::Line, kMeasuredColour, "measured (" + std::to_string(o.measured.size()) + ")");
    at.x() += draw_legend(svg, at, LegendMark::Line, kSimulatedColour, "simulated");
    draw_legend(svg, at, LegendMark::Band, kSimulatedColour, "95 % band");
}

std::string gap_words(const ComparedObservable& o) {
    const Gap& g = o.gap.pooled;
    if (!std::isfinite(g.gap)) return o.gap.status;
    const auto number = [](double v) { return gis::axis_number(v, v < 10.0 ? 0.01 : v < 100.0 ? 0.1 : 1.0); };
    return "gap " + number(g.gap) + ", chance " + number(g.chance.low) + " to " + number(g.chance.high);
}

void draw_panel_title(Svg& svg, const SvgPanel& panel, const std::string& title) {
    svg.text(panel.pixels.min + Vec2(0.0, -50.0), title, words(13.5, "start", true));
}

void draw_distribution_panel(Svg& svg, const SvgPanel& panel, const ComparedObservable& o, const std::string& letter) {
    draw_x_axis(svg, panel, capital(o.gap.observable.name) + " [" + o.unit + "]");
    draw_y_axis(svg, panel, "Share of blocks at or below [-]");
    draw_distribution(svg, panel, o, false);
    draw_frame(svg, panel);
    draw_distribution_legend(svg, panel, o);
    draw_panel_title(svg, panel, letter + capital(o.gap.observable.name));
    svg.text(panel.pixels.min + Vec2(0.0, -31.0), gap_words(o), words(11.5, "start"));
}

Box2 distribution_range(const ComparedObservable& o) {
    const auto [low, high] = padded_range(o.band.x.front(), o.band.x.back());
    return {{low, 0.0}, {high, 1.0}};
}

void draw_zone_bars(Svg& svg, const SvgPanel& panel, const CompareStudy& study, const std::string& letter) {
    draw_y_axis(svg, panel, "Blocks at rest [%]");
    const double slot = (panel.data.max.x() - panel.data.min.x()) / static_cast<double>(study.zones.size());
    for (std::size_t z = 0; z < study.zones.size(); ++z) {
        const double middle = panel.data.min.x() + (static_cast<double>(z) + 0.5) * slot;
        const SharePair& pair = study.zones[z];
        for (const int side : {-1, 1}) {
            const ShareEstimate& share = side < 0 ? pair.measured : pair.simulated;
            const double x = middle + side * 0.19 * slot;
            const auto [low, high] = share.interval();
            const Vec2 foot = panel.at({x - 0.17 * slot, 0.0}),
                       head = panel.at({x + 0.17 * slot, 100.0 * share.share()});
            Box2 bar;
            bar.add(foot);
            bar.add(head);
            svg.box(bar, fill(side < 0 ? kMeasuredColour : kSimulatedColour, side < 0 ? 0.85 : 0.75));
            draw_interval(svg, panel.at({x, 100.0 * low}), panel.at({x, 100.0 * high}), kTextColour);
        }
        svg.text({panel.at({middle, 0.0}).x(), panel.pixels.max.y() + 17.0}, pair.name, words(11.5, "middle"));
    }
    draw_frame(svg, panel);
    svg.text({0.5 * (panel.pixels.min.x() + panel.pixels.max.x()), panel.pixels.max.y() + 35.0}, "Deposit zone",
             words(12.5, "middle"));
    Vec2 at = panel.pixels.min + Vec2(0.0, -10.0);
    at.x() += draw_legend(svg, at, LegendMark::Box, kMeasuredColour,
                          "measured (" + std::to_string(study.zones[0].measured.of) + ")");
    at.x() += draw_legend(svg, at, LegendMark::Box, kSimulatedColour, "simulated");
    svg.text(at, "| 95 % interval", words(11.5, "start"));
    draw_panel_title(svg, panel, letter + "Deposit zones");
}

Box2 zone_range(const CompareStudy& study) {
    double highest = 0.0;
    for (const SharePair& pair : study.zones)
        highest = std::max({highest, pair.measured.interval().second, pair.simulated.interval().second});
    return {{0.0, 0.0}, {1.0, std::min(100.0, 108.0 * highest)}};
}

/// The paper's row: bars of the zones, then the speeds at the screens; without them whatever one-dimensional there is.
Figure overview(const CompareStudy& study) {
    std::vector<const ComparedObservable*> panels;
    for (const char* kind : {"speed at ", "distance along", "height at ", "lateral"})
        for (const ComparedObservable& o : study.observables)
            if (panels.size() < 2 && !o.band.x.empty() && o.gap.observable.name.starts_with(kind)) panels.push_back(&o);
    const bool zones = !study.zones.empty();
    Svg svg = picture(static_cast<double>(panels.size()) + (zones ? 1.0 : 0.0));
    const auto letter = [&](std::size_t k) { return std::string(1, static_cast<char>('a' + k)) + "  "; };
    double column = 0.0;
    if (zones) {
        draw_zone_bars(svg, panel_at(0.0, zone_range(study)), study, letter(0));
        column = 1.0;
    }
    for (const ComparedObservable* o : panels) {
        draw_distribution_panel(svg, panel_at(column, distribution_range(*o)), *o,
                                letter(static_cast<std::size_t>(column)));
        column += 1.0;
    }
    if (column == 0.0) return {};
    return {
        "overview.svg", "Measurement and simulation",
        std::string(zones ? "Shares at rest in the deposit zones. " : "") +
            "Distribution functions: steps are the measured blocks, the line the simulated ones; band: 95 % of what as "
            "many blocks of the simulation would give, value by value. A known block that did not reach a screen "
            "counts there with speed 0.",
        svg.text()};
}

/// Every gap with its interval over what chance gives; the scale is that of ratios.
Figure gap_chart(const CompareStudy& study) {
    struct Row {
        std::string name;
        const Gap* gap;
        bool bold;
    };
    std::vector<Row> rows;
    for (const ComparedObservable& o : study.observables)
        if (std::isfinite(o.gap.pooled.gap) && o.gap.pooled.chance.high > 0.0)
            rows.push_back({o.gap.observable.name, &o.gap.pooled, false});
    if (std::isfinite(study.overall.gap)) rows.push_back({"all", &study.overall, true});
    for (const ComparedObservable& o : study.observables)
        if (o.gap.score) rows.push_back({o.gap.observable.name + ", per block", &*o.gap.score, false});
    if (study.overall_score) rows.push_back({"all, per block", &*study.overall_score, true});
    if (rows.empty()) return {};
    constexpr double kRow = 24.0, kNames = 230.0, kWidth = 520.0, kLowest = 0.1;
    double highest = 10.0;
    for (const Row& r : rows) highest = std::max({highest, r.gap->interval.high, r.gap->chance.high});
    const double decades_low = std::log10(kLowest), decades_high = std::log10(1.3 * highest);
    const double height = kRow * static_cast<double>(rows.size());
    Svg svg(kNames + kWidth + 40.0, 62.0 + height + 48.0);
    const SvgPanel panel{{{kNames, 62.0}, {kNames + kWidth, 62.0 + height}}, {{decades_low, 0.0}, {decades_high, 1.0}}};
    const auto x_of = [&](double gap) { return panel.at({std::log10(std::max(gap, kLowest)), 0.0}).x(); };
    for (int decade = -1; decade <= static_cast<int>(decades_high); ++decade) {
        for (int digit = 1; digit < 10; ++digit) {
            const double value = digit * std::pow(10.0, decade);
            if (std::log10(value) > decades_high) break;
            svg.segment({x_of(value), panel.pixels.min.y()}, {x_of(value), panel.pixels.max.y()},
                        stroke("#000000", digit == 1 ? 0.6 : 0.25, digit == 1 ? "" : "1 3"));
            if (digit == 1)
                svg.text({x_of(value), panel.pixels.max.y() + 16.0}, gis::axis_number(value, value),
                         words(11.5, "middle"));
        }
    }
    svg.segment({x_of(1.0), panel.pixels.min.y()}, {x_of(1.0), panel.pixels.max.y()}, stroke(kTextColour, 1.5));
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Gap& gap = *rows[k].gap;
        const double y = panel.pixels.min.y() + (static_cast<double>(k) + 0.5) * kRow;
        svg.box({{x_of(gap.chance.low), y - 6.0}, {x_of(gap.chance.high), y + 6.0}}, fill(kChanceColour));
        const char* colour = gap.beyond_chance() ? kSimulatedColour : kMeasuredColour;
        draw_interval(svg, {x_of(gap.interval.low), y}, {x_of(gap.interval.high), y}, colour);
        svg.circle({x_of(gap.gap), y}, 4.5, fill(colour));
        svg.text({kNames - 10.0, y + 4.0}, rows[k].name, words(11.5, "end", rows[k].bold));
    }
    draw_frame(svg, panel);
    svg.text({0.5 * (panel.pixels.min.x() + panel.pixels.max.x()), panel.pixels.max.y() + 36.0},
             "Gap [-], 1: as if the measured blocks were more of the simulated ones", words(12.5, "middle"));
    svg.text({10.0, 20.0}, "Gaps in units of chance", words(13.5, "start", true));
    Vec2 at(kNames, 46.0);
    at.x() += draw_legend(svg, at, LegendMark::Box, kChanceColour, "chance, 95 %");
    at.x() += draw_legend(svg, at, LegendMark::Dot, kMeasuredColour, "within chance");
    draw_legend(svg, at, LegendMark::Dot, kSimulatedColour, "beyond");
    return {"gaps.svg", "Gaps",
            "Dot and line: the gap and the 95 % interval in which repetitions of the test would put it. Grey: 95 % of "
            "the gaps that chance gives to so many "
            "blocks if nothing differs. Per block: energy score of every measured block against its own repeats; it "
            "grows more slowly.",
            svg.text()};
}

Figure distribution_figure(const ComparedObservable& o) {
    Svg svg = picture(1.0);
    draw_distribution_panel(svg, panel_at(0.0, distribution_range(o)), o, "");
    return {o.slug + ".svg", capital(o.gap.observable.name), "", svg.text()};
}

/// Share of the blocks that ran farther than a distance along the axis, with the screens on the way.
Figure passing_figure(const CompareStudy& study) {
    for (const ComparedObservable& o : study.observables) {
        if (o.gap.observable.name != "distance along" || o.band.x.empty()) continue;
        Svg svg(kLeft + 620.0 + kRight, kTop + kPanelHeight + kBottom);
        Box2 range = distribution_range(o);
        range.min.x() = std::min(range.min.x(), 0.0);  // all of the way counts
        const SvgPanel panel{{{kLeft, kTop}, {kLeft + 620.0, kTop + kPanelHeight}}, range};
        draw_x_axis(svg, panel, "Distance along [m]", 12);
        draw_y_axis(svg, panel, "Share of blocks that ran farther [-]");
        for (const SharePair& screen : study.beyond_screens) {
            if (screen.chainage < panel.data.min.x() || screen.chainage > panel.data.max.x()) continue;
            const double x = panel.at({screen.chainage, 0.0}).x();
            svg.segment({x, panel.pixels.min.y()}, {x, panel.pixels.max.y()}, stroke("#555555", 1.2, "6 3"));
            SvgText label = words(11.0, "start");
            label.turn = -90.0;
            label.halo = true;
            svg.text({x - 4.0, panel.pixels.max.y() - 6.0}, screen.name, label);
        }
        draw_distribution(svg, panel, o, true);
        draw_frame(svg, panel);
        draw_distribution_legend(svg, panel, o);
        draw_panel_title(svg, panel, "Passing shares, from where the blocks stopped");
        return {
            "passing.svg", "Passing shares",
            "Share of the blocks that stopped beyond a distance along the axis. Dashed: where screens cross the axis.",
            svg.text()};
    }
    return {};
}

constexpr std::ptrdiff_t kLeastInHistogram = 10;  // blocks of which a histogram says something [-]

/// Histograms of the PIT values: level if the simulated spread is right, sloping if it is biased, a bowl if it is too narrow.
Figure pit_figure(const CompareStudy& study, const ObservedSite& observed) {
    std::vector<Column> columns;
    for (const BlockPit& p : study.pits) {
        const auto of_column = [&](const BlockPit& other) { return other.column == p.column; };
        if (std::find(columns.begin(), columns.end(), p.column) == columns.end() &&
            std::count_if(study.pits.begin(), study.pits.end(), of_column) >= kLeastInHistogram)
            columns.push_back(p.column);
    }
    if (columns.empty()) return {};
    constexpr std::size_t kBins = 10, kInRow = 3;
    constexpr double kWidth = 250.0, kHeight = 120.0;
    const std::size_t in_row = std::min(kInRow, columns.size());
    const auto rows = static_cast<double>((columns.size() + kInRow - 1) / kInRow);
    Svg svg(static_cast<double>(in_row) * (kWidth + 76.0) + 10.0, rows * (kHeight + 82.0) + 8.0);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        std::array<double, kBins> count{};
        double n = 0.0;
        for (const BlockPit& p : study.pits) {
            if (p.column != columns[c]) continue;
            count[std::min(kBins - 1, static_cast<std::size_t>(p.u * kBins))] += 1.0;
            n += 1.0;
        }
        // 95 % of a bin's count if all are alike: binomial, by its normal approximation
        const double expected = n / kBins, half = 1.96 * std::sqrt(expected * (1.0 - 1.0 / kBins));
        const double top = 1.15 * std::max(expected + half, *std::max_element(count.begin(), count.end()));
        const Vec2 corner(58.0 + static_cast<double>(c % kInRow) * (kWidth + 76.0),
                          30.0 + static_cast<double>(c / kInRow) * (kHeight + 82.0));
        const SvgPanel panel{{corner, corner + Vec2(kWidth, kHeight)}, {{0.0, 0.0}, {1.0, top}}};
        svg.box({panel.at({0.0, expected + half}), panel.at({1.0, std::max(0.0, expected - half)})},
                fill(kChanceColour, 0.55));
        for (std::size_t b = 0; b < kBins; ++b) {
            const double left = static_cast<double>(b) / kBins, right = static_cast<double>(b + 1) / kBins;
            svg.box({panel.at({left + 0.008, count[b]}), panel.at({right - 0.008, 0.0})}, fill(kMeasuredColour, 0.75));
        }
        draw_x_axis(svg, panel, "PIT [-]", 5, false);
        draw_y_axis(svg, panel, "Blocks", 4, false);
        draw_frame(svg, panel);
        svg.text(corner + Vec2(0.0, -9.0), capital(column_name(observed.op, columns[c])), words(12.5, "start", true));
    }
    return {"pit.svg", "Where the measured blocks lie among their own repeats",
            "PIT value of a block: the share of its repeats below its measured value. If nothing differs every tenth "
            "holds as many blocks, within the grey band "
            "(95 %). A slope to the right: the simulation is too small; a bowl: its spread is too small; a hump: too "
            "large.",
            svg.text()};
}

}  // namespace

std::vector<Figure> compare_figures(const CompareStudy& study, const SiteModel& model, const ObservedSite& observed,
                                    const CampaignResult& campaign) {
    std::vector<Figure> figures;
    const auto add = [&](Figure figure) {
        if (!figure.svg.empty()) figures.push_back(std::move(figure));
    };
    add(overview(study));
    add(gap_chart(study));
    add(compare_map(study, model, observed, campaign));
    add(passing_figure(study));
    if (!study.zones.empty()) {
        Svg svg = picture(1.0);
        draw_zone_bars(svg, panel_at(0.0, zone_range(study)), study, "");
        add({"deposit_zones.svg", "Deposit zones", "", svg.text()});
    }
    for (const ComparedObservable& o : study.observables)
        if (!o.band.x.empty()) add(distribution_figure(o));
    add(pit_figure(study, observed));
    return figures;
}

}  // namespace scree::cli
