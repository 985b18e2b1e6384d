// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/svg.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// Colours that stay apart for people who see few of them (after Okabe & Ito) and in grey.
inline constexpr const char* kMeasuredColour = "#0b4f8a";
inline constexpr const char* kSimulatedColour = "#d55e00";
inline constexpr const char* kChanceColour = "#b9b9b9";
inline constexpr const char* kTextColour = "#222222";

/// Pens and letters of the reports' pictures.
gis::SvgPen fill(const std::string& colour, double opacity = 1.0);
gis::SvgPen stroke(const std::string& colour, double width, const std::string& dashes = "");
gis::SvgText words(double size, const char* anchor, bool bold = false);

/// Ticks, numbers and a title on one side of a panel; lines across it if `grid`.
void draw_x_axis(gis::Svg& svg, const gis::SvgPanel& panel, const std::string& title, int most = 8, bool grid = true);
void draw_y_axis(gis::Svg& svg, const gis::SvgPanel& panel, const std::string& title, int most = 8, bool grid = true);
/// The same for values that are not drawn in proportion: with the two ends of the axis alone.
void draw_x_ends(gis::Svg& svg, const gis::SvgPanel& panel, const std::string& title, const std::string& low,
                 const std::string& high);
void draw_y_ends(gis::Svg& svg, const gis::SvgPanel& panel, const std::string& title, const std::string& low,
                 const std::string& high);
void draw_frame(gis::Svg& svg, const gis::SvgPanel& panel);

/// A point with its interval, upright or level.
void draw_interval(gis::Svg& svg, const Vec2& low, const Vec2& high, const std::string& colour);

enum class LegendMark { Line, Band, Box, Dot, Ring, Diamond };
void draw_mark(gis::Svg& svg, const Vec2& centre, LegendMark mark, const std::string& colour);

/// One line of a legend: a mark and a text. Returns the width it took [pixel].
double draw_legend(gis::Svg& svg, const Vec2& at, LegendMark mark, const std::string& colour, const std::string& text);

/// Width of a text as most fonts set it [pixel].
double text_width(const std::string& text, double size);

/// A range with a little room on both sides; round zero if it is near.
std::pair<double, double> padded_range(double low, double high);

}  // namespace scree::cli
