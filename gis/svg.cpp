// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/svg.hpp"

#include "gis/words.hpp"
#include "gis/xml.hpp"

#include <algorithm>
#include <cmath>

namespace scree::gis {

namespace {

/// Hundredths of a pixel are enough, and make the file half as long.
std::string pixel(double value) {
    const double rounded = std::round(100.0 * value) / 100.0;
    return number_text(rounded == 0.0 ? 0.0 : rounded);
}

std::string pen_attributes(const SvgPen& pen) {
    std::string out = " fill=\"" + pen.fill + "\" stroke=\"" + pen.stroke + "\"";
    if (pen.stroke != "none") out += " stroke-width=\"" + pixel(pen.width) + "\" stroke-linejoin=\"round\"";
    if (!pen.dashes.empty()) out += " stroke-dasharray=\"" + pen.dashes + "\"";
    if (pen.opacity < 1.0) out += " opacity=\"" + pixel(pen.opacity) + "\"";
    return out;
}

std::string coordinates(std::span<const Vec2> points) {
    std::string out;
    for (const Vec2& p : points) out += (out.empty() ? "" : " ") + pixel(p.x()) + "," + pixel(p.y());
    return out;
}

std::string box_attributes(const Box2& b) {
    return "x=\"" + pixel(b.min.x()) + "\" y=\"" + pixel(b.min.y()) + "\" width=\"" + pixel(b.max.x() - b.min.x()) +
           "\" height=\"" + pixel(b.max.y() - b.min.y()) + "\"";
}

}  // namespace

Svg::Svg(double width, double height) : width_(width), height_(height) {
    box({Vec2::Zero(), {width, height}}, {.fill = "#ffffff"});
}

void Svg::line(std::span<const Vec2> points, const SvgPen& pen) {
    if (points.size() < 2) return;
    body_ += "<polyline points=\"" + coordinates(points) + "\"" + pen_attributes(pen) + "/>\n";
}

void Svg::segment(const Vec2& a, const Vec2& b, const SvgPen& pen) {
    const std::array<Vec2, 2> ends{a, b};
    line(ends, pen);
}

void Svg::area(std::span<const std::vector<Vec2>> rings, const SvgPen& pen) {
    std::string path;
    for (const std::vector<Vec2>& ring : rings) {
        if (ring.size() < 3) continue;
        path += (path.empty() ? "M" : " M") + coordinates(ring) + "Z";
    }
    if (!path.empty()) body_ += "<path fill-rule=\"evenodd\" d=\"" + path + "\"" + pen_attributes(pen) + "/>\n";
}

void Svg::box(const Box2& pixels, const SvgPen& pen) {
    body_ += "<rect " + box_attributes(pixels) + pen_attributes(pen) + "/>\n";
}

void Svg::circle(const Vec2& centre, double radius, const SvgPen& pen) {
    body_ += "<circle cx=\"" + pixel(centre.x()) + "\" cy=\"" + pixel(centre.y()) + "\" r=\"" + pixel(radius) + "\"" +
             pen_attributes(pen) + "/>\n";
}

void Svg::text(const Vec2& at, const std::string& words, const SvgText& style) {
    body_ += "<text x=\"" + pixel(at.x()) + "\" y=\"" + pixel(at.y()) + "\" font-size=\"" + pixel(style.size) +
             "\" text-anchor=\"" + style.anchor + "\" fill=\"" + style.colour + "\"";
    if (style.bold) body_ += " font-weight=\"bold\"";
    if (style.turn != 0.0)
        body_ += " transform=\"rotate(" + pixel(style.turn) + " " + pixel(at.x()) + " " + pixel(at.y()) + ")\"";
    const std::string rest = ">" + xml_text(words) + "</text>\n";
    if (style.halo) {
        // drawn twice: not every viewer knows paint-order
        const std::size_t begin = body_.rfind("<text ");
        const std::string head = body_.substr(begin);
        body_ += " stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\"" + rest + head;
    }
    body_ += rest;
}

void Svg::image(const Box2& pixels, const std::string& uri) {
    // the older name of the attribute is the one that every viewer knows
    body_ += "<image " + box_attributes(pixels) + " preserveAspectRatio=\"none\" xlink:href=\"" + uri + "\"/>\n";
}

void Svg::mask_outside(const Box2& pixels) {
    const SvgPen white{.fill = "#ffffff"};
    const Vec2 end(width_ + 1.0, height_ + 1.0);  // renderers round the size of a picture up
    box({Vec2::Zero(), {end.x(), pixels.min.y()}}, white);
    box({{0.0, pixels.max.y()}, end}, white);
    box({{0.0, pixels.min.y()}, {pixels.min.x(), pixels.max.y()}}, white);
    box({{pixels.max.x(), pixels.min.y()}, {end.x(), pixels.max.y()}}, white);
}

std::string Svg::text() const {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
           "xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"" +
           pixel(width_) + "\" height=\"" + pixel(height_) + "\" viewBox=\"0 0 " + pixel(width_) + " " +
           pixel(height_) + "\" font-family=\"Arial, Helvetica, 'Liberation Sans', 'DejaVu Sans', sans-serif\">\n" +
           body_ + "</svg>\n";
}

double round_step(double range, int most) {
    const double rough = range / std::max(1, most);
    if (!(rough > 0.0)) return 1.0;
    const double power = std::pow(10.0, std::floor(std::log10(rough) + 1e-9));
    for (const double digit : {1.0, 2.0, 5.0})
        if (digit * power >= rough * (1.0 - 1e-9)) return digit * power;
    return 10.0 * power;
}

std::string axis_number(double value, double step) {
    const int decimals = step >= 1.0 ? 0 : static_cast<int>(std::ceil(-std::log10(step) - 1e-9));
    std::string text = fixed(std::abs(value) < 1e-9 * step ? 0.0 : value, decimals);
    const std::size_t whole = std::min(text.find('.'), text.size());
    const std::size_t first = text.starts_with('-') ? 1 : 0;
    if (whole - first < 5) return text;
    for (std::size_t at = whole; at > first + 3;) text.insert(at -= 3, " ");
    return text;
}

/// More than any axis has [-].
static constexpr double kMostTicks = 1000.0;

std::vector<double> round_numbers(double low, double high, double step) {
    std::vector<double> numbers;
    const double first = std::ceil(low / step - 1e-9), count = std::floor((high - low) / step + 1e-9) + 1.0;
    for (int k = 0; k <= std::min(count, kMostTicks); ++k)
        if (const double number = (first + k) * step; number <= high + 1e-9 * step) numbers.push_back(number);
    return numbers;
}

void draw_axes(Svg& svg, const SvgPanel& panel, const SvgAxes& axes) {
    const SvgPen grid{.stroke = "#000000", .width = 0.5, .opacity = 0.12}, tick{.stroke = "#444444"};
    const Box2& p = panel.pixels;
    const double tick_length = 5.0;
    for (const int axis : {0, 1}) {
        const double low = panel.data.min[axis] + axes.offset[axis], high = panel.data.max[axis] + axes.offset[axis];
        const double step = round_step(high - low, axis == 0 ? axes.most_x : axes.most_y);
        for (const double number : round_numbers(low, high, step)) {
            Vec2 at = panel.data.min;
            at[axis] = number - axes.offset[axis];
            const Vec2 foot = panel.at(at);
            const std::string text = axis_number(number, step);
            if (axis == 0) {
                if (axes.grid) svg.segment({foot.x(), p.min.y()}, {foot.x(), p.max.y()}, grid);
                svg.segment({foot.x(), p.max.y()}, {foot.x(), p.max.y() + tick_length}, tick);
                svg.text({foot.x(), p.max.y() + tick_length + 13.0}, text, {.anchor = "middle"});
            } else {
                if (axes.grid) svg.segment({p.min.x(), foot.y()}, {p.max.x(), foot.y()}, grid);
                svg.segment({p.min.x() - tick_length, foot.y()}, {p.min.x(), foot.y()}, tick);
                svg.text({p.min.x() - tick_length - 3.0, foot.y() + 4.0}, text, {.anchor = "end"});
            }
        }
    }
    svg.box(p, {.stroke = "#444444"});
    svg.text({0.5 * (p.min.x() + p.max.x()), p.max.y() + 36.0}, axes.x_title, {.size = 13.0, .anchor = "middle"});
    svg.text({p.min.x() - 82.0, 0.5 * (p.min.y() + p.max.y())}, axes.y_title,
             {.size = 13.0, .anchor = "middle", .turn = -90.0});
}

}  // namespace scree::gis
