// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <span>
#include <string>
#include <vector>

namespace scree::gis {

/// Pictures as SVG text: readable in any browser, and the same bytes for the same drawing. Pixels count from the upper left corner.

struct SvgPen {
    std::string stroke = "none";  ///< "#rrggbb"
    double width = 1.0;           ///< [pixel]
    std::string fill = "none";    ///< "#rrggbb"
    double opacity = 1.0;         ///< of both [-]
    std::string dashes{};         ///< lengths of dash and gap, "4 3"; empty: none
};

struct SvgText {
    double size = 12.0;              ///< height of the letters [pixel]
    std::string anchor = "start";    ///< start, middle, end
    std::string colour = "#222222";  ///< "#rrggbb"
    bool bold = false;
    bool halo = false;  ///< white outline, to be read on a map
    double turn = 0.0;  ///< clockwise [degree]
};

class Svg {
public:
    Svg(double width, double height);

    void line(std::span<const Vec2> points, const SvgPen& pen);
    void segment(const Vec2& a, const Vec2& b, const SvgPen& pen);
    /// Rings of one area, holes by the even-odd rule.
    void area(std::span<const std::vector<Vec2>> rings, const SvgPen& pen);
    void box(const Box2& pixels, const SvgPen& pen);
    void circle(const Vec2& centre, double radius, const SvgPen& pen);
    void text(const Vec2& at, const std::string& words, const SvgText& style);
    /// A picture as a data URI, stretched over the box.
    void image(const Box2& pixels, const std::string& uri);
    /// White over everything outside the box: cuts what was drawn so far. Not every viewer knows clip paths.
    void mask_outside(const Box2& pixels);

    /// The whole file.
    std::string text() const;

private:
    std::string body_;
    double width_;   ///< [pixel]
    double height_;  ///< [pixel]
};

/// A rectangle of the picture that shows a rectangle of data, y upwards.
struct SvgPanel {
    Box2 pixels;  ///< [pixel]
    Box2 data;    ///< [unit of the axes]

    Vec2 at(const Vec2& p) const {
        const Vec2 share = (p - data.min).cwiseQuotient(data.max - data.min);
        return {pixels.min.x() + share.x() * (pixels.max.x() - pixels.min.x()),
                pixels.max.y() - share.y() * (pixels.max.y() - pixels.min.y())};
    }
    /// Pixels per unit along x.
    double scale() const { return (pixels.max.x() - pixels.min.x()) / (data.max.x() - data.min.x()); }
};

/// The round number, 1, 2 or 5 times a power of ten, that cuts `range` into at most `most` pieces.
double round_step(double range, int most);

/// The multiples of `step` from `low` to `high`.
std::vector<double> round_numbers(double low, double high, double step);

/// A number with as many decimals as a step of an axis needs, thousands apart.
std::string axis_number(double value, double step);

struct SvgAxes {
    std::string x_title{};  ///< with the unit
    std::string y_title{};
    Vec2 offset = Vec2::Zero();  ///< added to the data where they are written [unit of the axes]
    bool grid = true;            ///< faint lines at the ticks
    int most_x = 10;             ///< ticks at most [-]
    int most_y = 8;              ///< ticks at most [-]
};

/// Frame, ticks at round numbers, numbers and titles.
void draw_axes(Svg& svg, const SvgPanel& panel, const SvgAxes& axes);

}  // namespace scree::gis
