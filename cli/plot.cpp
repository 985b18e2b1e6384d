// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plot.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace scree::cli {

namespace {

constexpr double kTick = 5.0;         // [pixel]
constexpr double kNumberSize = 11.5;  // [pixel]
constexpr double kTitleSize = 12.5;   // [pixel]
constexpr double kBeside = 16.0;      // that a title may be longer than its axis [pixel]
constexpr double kMark = 20.0;        // of a legend [pixel]

const gis::SvgPen kGrid{.stroke = "#000000", .width = 0.5, .fill = "none", .opacity = 0.12, .dashes = ""};
const gis::SvgPen kAxis{.stroke = "#444444", .width = 1.0, .fill = "none", .opacity = 1.0, .dashes = ""};

struct Tick {
    double at;  ///< across or down [pixel]
    std::string number;
};

std::vector<Tick> round_ticks(double low, double high, int most, const std::function<double(double)>& pixel) {
    std::vector<Tick> ticks;
    const double step = gis::round_step(high - low, most);
    for (const double number : gis::round_numbers(low, high, step))
        ticks.push_back({pixel(number), gis::axis_number(number, step)});
    return ticks;
}

/// Smaller letters where the title would run into what stands beside it.
gis::SvgText title_words(const std::string& title, double length) {
    return words(kTitleSize * std::min(1.0, (length + kBeside) / text_width(title, kTitleSize)), "middle");
}

void draw_below(gis::Svg& svg, const Box2& p, const std::string& title, const std::vector<Tick>& ticks, bool grid) {
    for (const auto& [x, number] : ticks) {
        if (grid) svg.segment({x, p.min.y()}, {x, p.max.y()}, kGrid);
        svg.segment({x, p.max.y()}, {x, p.max.y() + kTick}, kAxis);
        svg.text({x, p.max.y() + kTick + 12.0}, number, words(kNumberSize, "middle"));
    }
    svg.text({0.5 * (p.min.x() + p.max.x()), p.max.y() + 35.0}, title, title_words(title, p.max.x() - p.min.x()));
}

void draw_left(gis::Svg& svg, const Box2& p, const std::string& title, const std::vector<Tick>& ticks, bool grid) {
    double widest = 0.0;
    for (const auto& [y, number] : ticks) {
        if (grid) svg.segment({p.min.x(), y}, {p.max.x(), y}, kGrid);
        svg.segment({p.min.x() - kTick, y}, {p.min.x(), y}, kAxis);
        svg.text({p.min.x() - kTick - 3.0, y + 4.0}, number, words(kNumberSize, "end"));
        widest = std::max(widest, text_width(number, kNumberSize));
    }
    gis::SvgText upright = title_words(title, p.max.y() - p.min.y());
    upright.turn = -90.0;
    svg.text({p.min.x() - kTick - widest - 14.0, 0.5 * (p.min.y() + p.max.y())}, title, upright);
}

}  // namespace

gis::SvgPen fill(const std::string& colour, double opacity) {
    gis::SvgPen pen;
    pen.fill = colour;
    pen.opacity = opacity;
    return pen;
}

gis::SvgPen stroke(const std::string& colour, double width, const std::string& dashes) {
    gis::SvgPen pen;
    pen.stroke = colour;
    pen.width = width;
    pen.dashes = dashes;
    return pen;
}

gis::SvgText words(double size, const char* anchor, bool bold) {
    gis::SvgText text;
    text.size = size;
    text.anchor = anchor;
    text.bold = bold;
    return text;
}

void draw_x_axis(gis::Svg& svg, const gis::SvgPanel& panel, const std::string& title, int most, bool grid) {
    const Box2& data = panel.data;
    draw_below(svg, panel.pixels, title,
               round_ticks(data.min.x(), data.max.x(), most,
                           [&](double value) {
                               return panel.at({value, data.min.y()}).x();
                           }),
               grid);
}

void draw_y_axis(gis::Svg& svg, const gis::SvgPanel& panel, const std::string& title, int most, bool grid) {
    const Box2& data = panel.data;
    draw_left(svg, panel.pixels, title,
              round_ticks(data.min.y(), data.max.y(), most,
                          [&](double value) {
                              return panel.at({data.min.x(), value}).y();
                          }),
              grid);
}

void draw_x_ends(gis::Svg& svg, const gis::SvgPanel& panel, const std::string& title, const std::string& low,
                 const std::string& high) {
    const Box2& p = panel.pixels;
    draw_below(svg, p, title, {{p.min.x(), low}, {p.max.x(), high}}, false);
}

void draw_y_ends(gis::Svg& svg, const gis::SvgPanel& panel, const std::string& title, const std::string& low,
                 const std::string& high) {
    const Box2& p = panel.pixels;
    draw_left(svg, p, title, {{p.max.y(), low}, {p.min.y(), high}}, false);
}

void draw_frame(gis::Svg& svg, const gis::SvgPanel& panel) {
    svg.box(panel.pixels, kAxis);
}

void draw_interval(gis::Svg& svg, const Vec2& low, const Vec2& high, const std::string& colour) {
    constexpr double kCap = 4.0;  // [pixel]
    const gis::SvgPen pen = stroke(colour, 1.5);
    const Vec2 cap = low.x() == high.x() ? Vec2(kCap, 0.0) : Vec2(0.0, kCap);
    svg.segment(low, high, pen);
    svg.segment(low - cap, low + cap, pen);
    svg.segment(high - cap, high + cap, pen);
}

void draw_mark(gis::Svg& svg, const Vec2& centre, LegendMark mark, const std::string& colour) {
    const Vec2 half(0.5 * kMark, 5.0);
    const Box2 box{centre - half, centre + half};
    if (mark == LegendMark::Line)
        svg.segment({box.min.x(), centre.y()}, {box.max.x(), centre.y()}, stroke(colour, 2.0));
    if (mark == LegendMark::Band) svg.box(box, fill(colour, 0.25));
    if (mark == LegendMark::Box) svg.box(box, fill(colour));
    if (mark == LegendMark::Dot) svg.circle(centre, 4.5, fill(colour));
    if (mark == LegendMark::Ring) svg.circle(centre, 4.5, stroke(colour, 2.0));
    if (mark == LegendMark::Diamond) {
        constexpr double kCorner = 5.5;  // [pixel]
        const Vec2 side(kCorner, 0.0), up(0.0, kCorner);
        const std::vector<std::vector<Vec2>> rings{{centre + side, centre + up, centre - side, centre - up}};
        svg.area(rings, fill(colour));
    }
}

double draw_legend(gis::Svg& svg, const Vec2& at, LegendMark mark, const std::string& colour, const std::string& text) {
    draw_mark(svg, at + Vec2(0.5 * kMark, -4.0), mark, colour);
    svg.text(at + Vec2(kMark + 6.0, 0.0), text, words(kNumberSize, "start"));
    return kMark + 6.0 + text_width(text, kNumberSize) + 18.0;
}

double text_width(const std::string& text, double size) {
    constexpr double kMeanLetter = 0.58;  // of the height, in the sans-serif faces that browsers take [-]
    return kMeanLetter * size * static_cast<double>(text.size());
}

std::pair<double, double> padded_range(double low, double high) {
    const double span = high > low ? high - low : std::max(1.0, std::abs(low));
    if (low >= 0.0 && low < 0.35 * span) return {0.0, high + 0.04 * span};
    return {low - 0.04 * span, high + 0.04 * span};
}

}  // namespace scree::cli
