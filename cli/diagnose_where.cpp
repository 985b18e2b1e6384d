// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_where.hpp"

#include "cli/diagnose_words.hpp"
#include "cli/plot.hpp"
#include "scree/inference/distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree::cli {

namespace {

using gis::Svg;
using gis::SvgPanel;

constexpr double kLeft = 74.0, kWidth = 800.0, kTop = 80.0, kResiduals = 300.0, kGap = 34.0,
                 kTerrain = 110.0;  // [pixel]
constexpr double kFarthest = 0.99;  // share of the simulated stops that are in the picture [-]
constexpr int kHeights = 400;       // along the terrain

struct Mark {
    const char* name;
    const char* colour;
};
constexpr Mark kStops{"stops", kMeasuredColour}, kPassed{"share that passes", "#127a33"},
    kSpeed{"speed", kSimulatedColour}, kHeight{"passing height", "#5a2d91"}, kSpin{"spin", "#c0398a"};

/// Colour of a quantity; null: not in the picture.
const Mark* mark_of(Quantity quantity) {
    switch (quantity) {
        case Quantity::Passed:
            return &kPassed;
        case Quantity::Speed:
            return &kSpeed;
        case Quantity::Height:
            return &kHeight;
        case Quantity::Spin:
            return &kSpin;
        case Quantity::Along:
            return &kStops;
        default:
            return nullptr;
    }
}

/// Of the screens of the observations, along their axis; of several parts the first. NaN where a screen does not cut it.
std::vector<double> screen_places(const SiteModel& model, const ObservedSite& observed) {
    const std::vector<double> chainages = screen_chainages(model, observed.op.axis);
    std::vector<double> along(observed.op.screens.size(), kNaN);
    for (std::size_t k = 0; k < chainages.size(); ++k) {
        double& known = along[static_cast<std::size_t>(observed.op.screen_of[k])];
        if (std::isfinite(chainages[k]) && !(known <= chainages[k])) known = chainages[k];
    }
    return along;
}

/// What is left on a stretch of the path, or at a place on it (`from` equals `to`).
struct Item {
    const Mark* mark;
    LegendMark symbol;
    double from, to;  ///< [m]
    double z;         ///< standardised residual [-]
    bool between;     ///< on the way from one screen on
};

/// Ring: the spread; diamond: how the value goes with mass, shape or order.
LegendMark symbol_of(ResidualKind kind) {
    switch (kind) {
        case ResidualKind::Window:
        case ResidualKind::Innovation:
            return LegendMark::Line;
        case ResidualKind::Spread:
            return LegendMark::Ring;
        case ResidualKind::MassTrend:
        case ResidualKind::ShapeTrend:
        case ResidualKind::OrderTrend:
            return LegendMark::Diamond;
        case ResidualKind::Passed:
        case ResidualKind::Level:
        case ResidualKind::Together:
            break;
    }
    return LegendMark::Dot;
}

/// `stops`: where the measured stops have their middle, and what is said of all of them is drawn.
std::vector<Item> items_of(const DiagnoseStudy& study, const std::vector<double>& screens, double stops, double end) {
    const auto place = [&](const Column& c) {
        return c.place >= 0 ? screens[static_cast<std::size_t>(c.place)] : stops;
    };
    std::vector<Item> items;
    for (std::size_t k = 0; k < study.diagnosis.residuals.size(); ++k) {
        const Residual& r = study.diagnosis.residuals[k];
        const Mark* mark = mark_of(r.column.quantity);
        if (!mark || r.kind == ResidualKind::Together) continue;
        Item item{mark,
                  symbol_of(r.kind),
                  place(r.column),
                  place(r.column),
                  study.diagnosis.score.standardised[static_cast<Eigen::Index>(k)],
                  r.kind == ResidualKind::Innovation};
        if (r.kind == ResidualKind::Window) {
            item.from = std::max(r.from, 0.0);
            item.to = std::min(r.to, end);
        } else if (item.between) {
            item.from = place(r.other);
        }
        if (std::isfinite(item.from) && std::isfinite(item.to)) items.push_back(item);
    }
    return items;
}

/// Middle of the measured stops; NaN without any.
double middle_of_stops(const ObservedSite& observed) {
    std::vector<double> along;
    for (const ObservedStop& s : observed.observations.stops)
        if (std::isfinite(s.position.x())) along.push_back(observed.op.axis.place(s.position.head<2>()).along);
    std::sort(along.begin(), along.end());
    return along.empty() ? kNaN : sample_quantile(along, 0.5);
}

/// Chainage up to which simulated and measured blocks come, but for a few, and screens stand.
double end_of_path(const DiagnoseStudy& study, const ObservedSite& observed, const std::vector<double>& screens) {
    std::vector<double> along;
    for (const BlockResult& b : study.campaign.blocks)
        if (b.done) along.push_back(observed.op.axis.place(b.stop.head<2>()).along);
    std::sort(along.begin(), along.end());
    double end = along.empty() ? 1.0 : sample_quantile(along, kFarthest);
    for (const ObservedStop& s : observed.observations.stops)
        if (std::isfinite(s.position.x())) end = std::max(end, observed.op.axis.place(s.position.head<2>()).along);
    for (const double s : screens)
        if (std::isfinite(s)) end = std::max(end, s);
    return 1.03 * end;
}

void draw_item(Svg& svg, const SvgPanel& panel, const Item& item) {
    const Vec2 from = panel.at({item.from, item.z}), to = panel.at({item.to, item.z});
    if (item.symbol == LegendMark::Line)
        svg.segment(from, to, item.between ? stroke(item.mark->colour, 2.0, "6 3") : stroke(item.mark->colour, 4.0));
    else
        draw_mark(svg, from, item.symbol, item.mark->colour);
}

void draw_terrain(Svg& svg, const SvgPanel& panel, const std::vector<Vec2>& ground) {
    std::vector<Vec2> line;
    for (const Vec2& p : ground) line.push_back(panel.at(p));
    svg.line(line, stroke("#6b5b4b", 1.8));
}

}  // namespace

/// Where what was named acts, and above it where its middle is with 95 %. True if there is such a place.
static bool draw_places(Svg& svg, const SvgPanel& panel, const DiagnoseStudy& study, double end) {
    bool any = false;
    for (std::size_t a = 0; a < study.standing(); ++a)
        for (const AnsweredEffect& e : study.answers[a].effects) {
            if (!e.variant.on) continue;
            const auto at = [&](double along, double y) { return panel.at({std::clamp(along, 0.0, end), y}); };
            const Stretch& on = *e.variant.on;
            const Interval middle = middle_interval(e);
            const double top = panel.data.max.y();
            svg.box({at(on.from, top), at(on.to, panel.data.min.y())}, fill("#f3e3c8"));
            const Vec2 under(0.0, 18.0);
            svg.segment(at(middle.low, top) + under, at(middle.high, top) + under, stroke("#a8742a", 2.0));
            svg.text(at(on.middle(), top) + Vec2(0.0, 13.0), e.candidate->name, words(11.0, "middle"));
            any = true;
        }
    return any;
}

std::optional<Figure> where_along_path(const DiagnoseStudy& study, const SiteModel& model,
                                       const ObservedSite& observed) {
    if (study.planning || study.diagnosis.residuals.empty()) return std::nullopt;
    const std::vector<double> screens = screen_places(model, observed);
    const double end = end_of_path(study, observed, screens), limit = study.diagnosis.test.residual_limit;
    const std::vector<Item> items = items_of(study, screens, middle_of_stops(observed), end);
    double most = 1.15 * limit;
    for (const Item& i : items) most = std::max(most, 1.1 * std::abs(i.z));
    std::vector<Vec2> ground;
    const double base = model.terrain.data.frame.height;
    for (int k = 0; k <= kHeights; ++k) {
        const double along = end * k / kHeights;
        const Vec2 p = observed.op.axis.point(along);
        if (model.terrain.surface->facet_at(p) >= 0)
            ground.emplace_back(along, model.terrain.surface->height(p) + base);
    }
    if (items.empty() || ground.empty()) return std::nullopt;
    const auto [lowest, highest] =
        std::minmax_element(ground.begin(), ground.end(), [](auto& a, auto& b) { return a.y() < b.y(); });

    Svg svg(kLeft + kWidth + 24.0, kTop + kResiduals + kGap + kTerrain + 54.0);
    const double foot = kTop + kResiduals + kGap;
    const SvgPanel panel{{{kLeft, kTop}, {kLeft + kWidth, kTop + kResiduals}}, {{0.0, -most}, {end, most}}};
    const auto [low, high] = padded_range(lowest->y(), highest->y());
    const SvgPanel below{{{kLeft, foot}, {kLeft + kWidth, foot + kTerrain}}, {{0.0, low}, {end, high}}};
    svg.box({panel.at({0.0, std::min(limit, most)}), panel.at({end, std::max(-limit, -most)})}, fill("#ececec"));
    draw_y_axis(svg, panel, "Measured less simulated [standard deviations]");
    draw_y_axis(svg, below, "Height [m]", 4);
    draw_x_axis(svg, below, "Distance along the axis [m]", 12);
    for (std::size_t s = 0; s < screens.size(); ++s) {
        if (!std::isfinite(screens[s])) continue;
        for (const SvgPanel* p : {&panel, &below})
            svg.segment(p->at({screens[s], p->data.min.y()}), p->at({screens[s], p->data.max.y()}),
                        stroke("#8a7aa8", 1.1, "7 3"));
        svg.text(panel.at({screens[s], most}) + Vec2(0.0, -4.0), study.screens[s], words(11.0, "middle"));
    }
    svg.segment(panel.at({0.0, 0.0}), panel.at({end, 0.0}), stroke(kTextColour, 1.0));
    for (const Item& item : items) draw_item(svg, panel, item);
    draw_frame(svg, panel);
    const bool placed = draw_places(svg, below, study, end);
    draw_terrain(svg, below, ground);
    draw_frame(svg, below);
    Vec2 at(kLeft, 22.0);
    for (const Mark* mark : {&kStops, &kPassed, &kSpeed, &kHeight, &kSpin})
        if (std::any_of(items.begin(), items.end(), [&](const Item& i) { return i.mark == mark; }))
            at.x() +=
                draw_legend(svg, at, mark == &kStops ? LegendMark::Line : LegendMark::Dot, mark->colour, mark->name);
    at = {kLeft, 40.0};
    const auto shown = [&](LegendMark symbol) {
        return std::any_of(items.begin(), items.end(), [&](const Item& i) { return i.symbol == symbol; });
    };
    if (shown(LegendMark::Ring)) at.x() += draw_legend(svg, at, LegendMark::Ring, kTextColour, "its spread");
    if (shown(LegendMark::Diamond))
        at.x() += draw_legend(svg, at, LegendMark::Diamond, kTextColour, "its growth with mass, length or order");
    draw_legend(svg, at, LegendMark::Box, "#ececec", chance_words(study));
    return Figure{
        "where_along.svg", "Where along the path",
        "What is left after recalibration, where it was measured, above the terrain along the axis. Bars: "
        "stops in a stretch of the path, positive where more were measured. Dots: mean or share at a screen. Rings: "
        "spread, positive where the measured one is wider. Diamonds: positive where the value grows more with mass, "
        "with length, or from block to block, than simulated. Of the stops as a whole all of this is drawn at their "
        "middle. Dashed: the mean among blocks that left the screen before (left end) at like speeds, so that what "
        "lies between is to blame. What goes together in the same blocks is told in the sentences." +
            std::string(placed ? " Shaded on the terrain: where what was named acts; the line: its middle, with 95 %."
                               : ""),
        svg.text()};
}

}  // namespace scree::cli
