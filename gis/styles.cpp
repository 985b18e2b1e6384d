// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/styles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace scree::gis {

namespace {

using Colour = std::array<double, 3>;  // red, green, blue, 0 to 255

// Anchors of matplotlib's viridis, inferno and plasma (Smith & van der Walt 2015, CC0) and seaborn's mako, dark to light.
constexpr std::array<Colour, 9> kViridis = {{{68, 1, 84},
                                             {71, 45, 123},
                                             {59, 82, 139},
                                             {44, 114, 142},
                                             {33, 145, 140},
                                             {40, 174, 128},
                                             {94, 201, 98},
                                             {173, 220, 48},
                                             {253, 231, 37}}};
constexpr std::array<Colour, 8> kInferno = {{{33, 12, 74},
                                             {87, 16, 110},
                                             {138, 34, 106},
                                             {188, 55, 84},
                                             {228, 90, 49},
                                             {249, 142, 9},
                                             {249, 203, 53},
                                             {252, 255, 164}}};
constexpr std::array<Colour, 9> kPlasma = {{{13, 8, 135},
                                            {76, 2, 161},
                                            {126, 3, 168},
                                            {169, 35, 149},
                                            {204, 71, 120},
                                            {229, 107, 93},
                                            {248, 149, 64},
                                            {253, 197, 39},
                                            {240, 249, 33}}};
constexpr std::array<Colour, 7> kMako = {
    {{46, 30, 60}, {65, 61, 123}, {55, 101, 158}, {52, 143, 167}, {64, 183, 173}, {138, 217, 177}, {222, 245, 229}}};

std::span<const Colour> anchors(Ramp ramp) {
    switch (ramp) {
        case Ramp::Inferno:
            return kInferno;
        case Ramp::Plasma:
            return kPlasma;
        case Ramp::Mako:
            return kMako;
        case Ramp::Viridis:
            break;
    }
    return kViridis;
}

bool has_field(const FeatureLayer& layer, const std::string& name) {
    return std::ranges::any_of(layer.fields, [&](const Field& field) { return field.name == name; });
}

/// The limits a < v that round_limits may choose between low and high: digits times powers of ten.
std::vector<double> decimal_series(double low, double high, std::span<const double> digits) {
    std::vector<double> limits;
    for (int power = static_cast<int>(std::floor(std::log10(low))); std::pow(10.0, power) < high; ++power) {
        for (const double digit : digits) {
            // 3 * 10^-2 as a quotient: exact decimal text in the legend
            const double limit = power < 0 ? digit / std::pow(10.0, -power) : digit * std::pow(10.0, power);
            if (limit > low && limit < high) limits.push_back(limit);
        }
    }
    return limits;
}

std::vector<VectorStyle> stopping_point_styles(const FeatureLayer& layer) {
    std::vector<VectorStyle> styles;
    if (has_field(layer, "mass_kg")) {
        styles.push_back({.name = "By mass", .colour_by = "mass_kg", .unit = "kg", .size_mm = 2.0, .opacity = 0.9});
    }
    if (has_field(layer, "stop_reason")) {
        // Okabe & Ito's colours, and a form of its own for each reason: the legend survives a black and white print
        styles.push_back({.name = "By reason of stopping",
                          .colour_by = "stop_reason",
                          .categories = {{"at_rest", "at rest", "#0072b2", "circle"},
                                         {"left_terrain", "left the terrain", "#e69f00", "triangle"},
                                         {"time_limit", "time limit reached", "#cc79a7", "square"},
                                         {"failed", "failed", "#d55e00", "cross2"},
                                         {"", "other", "#7f7f7f", "diamond"}},
                          .opacity = 0.9});
    }
    if (styles.empty()) styles.push_back({.colour = "#0072b2", .opacity = 0.9});
    return styles;
}

std::vector<VectorStyle> line_styles(const FeatureLayer& layer) {
    std::vector<VectorStyle> styles;
    styles.push_back({.name = "Plain", .colour = "#3b528b", .size_mm = 0.2, .opacity = 0.6});
    for (const char* speed : {"speed_max_ms", "max_speed_ms"}) {
        if (!has_field(layer, speed)) continue;
        styles.insert(styles.begin(), {.name = "By largest speed",
                                       .colour_by = speed,
                                       .limits = {5, 10, 15, 20, 25, 30},
                                       .ramp = Ramp::Plasma,
                                       .unit = "m/s",
                                       .size_mm = 0.25,
                                       .opacity = 0.8});
        break;
    }
    return styles;
}

std::vector<VectorStyle> deposit_zone_styles(const FeatureLayer& layer) {
    // a fill would change the colours of the rasters below, and what they say
    VectorStyle style{.colour = "#21918c", .size_mm = 0.8, .opacity = 0.0};
    if (has_field(layer, "percent")) {
        style.name = "By share of the deposits";
        style.colour_by = "percent";
        style.limits = {1, 5, 10, 20, 40, 60, 80};
        style.unit = "%";
        style.label = "round(\"percent\", 1) || ' %'";
        for (const char* name : {"name", "zone"}) {
            if (!has_field(layer, name)) continue;
            style.label = "coalesce(\"" + std::string(name) + "\" || '\\n', '') || " + style.label;
            break;
        }
    }
    return {style};
}

std::vector<VectorStyle> facet_styles(const FeatureLayer& layer) {
    std::vector<VectorStyle> styles;
    if (has_field(layer, "slope_deg")) {
        styles.push_back({.name = "By slope",
                          .colour_by = "slope_deg",
                          .limits = {10, 20, 30, 40, 50, 60, 70},
                          .ramp = Ramp::Inferno,
                          .unit = "°",
                          .size_mm = 0.05,
                          .opacity = 0.6});
    }
    if (styles.empty()) styles.push_back({.colour = "#8c8c8c", .size_mm = 0.05, .opacity = 0.2});
    return styles;
}

}  // namespace

std::string ramp_colour(Ramp ramp, std::size_t index, std::size_t count) {
    const std::span<const Colour> colours = anchors(ramp);
    // from the light end to the dark one; a single class takes the middle
    const double along = count < 2 ? 0.5 : 1.0 - static_cast<double>(index) / static_cast<double>(count - 1);
    const double place = along * static_cast<double>(colours.size() - 1);
    const std::size_t below = std::min(static_cast<std::size_t>(place), colours.size() - 2);
    const double part = place - static_cast<double>(below);
    static constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text = "#";
    for (std::size_t i = 0; i < 3; ++i) {
        const auto value =
            static_cast<unsigned>(std::lround((1 - part) * colours[below][i] + part * colours[below + 1][i]));
        text += {kDigits[value / 16], kDigits[value % 16]};
    }
    return text;
}

std::vector<double> round_limits(double low, double high, std::size_t classes) {
    if (!(low < high) || !std::isfinite(low) || !std::isfinite(high)) return {};
    // a zero beside large values is the end of a logarithmic range, not a reason to leave it
    if (low >= 0 && high >= 20 * low && high > 0) {
        const double from = std::max(low, high * 1e-4);
        static constexpr std::array<double, 3> kFine = {1, 2, 5};
        static constexpr std::array<double, 1> kCoarse = {1};
        std::vector<double> limits = decimal_series(from, high, kFine);
        if (limits.size() > classes + 2) limits = decimal_series(from, high, kCoarse);
        return limits;
    }
    constexpr double kAlike = 1e-9;  // of the values: no round number tells them apart
    if (high - low <= kAlike * std::max(std::abs(low), std::abs(high))) return {};
    const double rough = (high - low) / static_cast<double>(classes);
    const double unit = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10 * unit;
    for (const double digit : {1.0, 2.0, 5.0}) {
        if (digit * unit >= rough) {
            step = digit * unit;
            break;
        }
    }
    std::vector<double> limits;
    for (double i = std::floor(low / step); i * step < high; i += 1) {
        // steps below one as a quotient, so that 0.3 does not read 0.30000000000000004
        const double limit = step < 1 ? i / std::round(1 / step) : i * step;
        if (limit > low && limit < high) limits.push_back(limit);
    }
    return limits;
}

std::string category_colour(std::size_t number) {
    constexpr std::array<const char*, 8> kColours{"#e69f00", "#0072b2", "#009e73", "#d55e00",
                                                  "#56b4e9", "#cc79a7", "#f0e442", "#555555"};
    return kColours[number % kColours.size()];
}

std::vector<VectorStyle> house_styles(const FeatureLayer& layer) {
    const std::string& name = layer.name;
    if (name == "stopping_points") return stopping_point_styles(layer);
    if (name == "trajectories") return line_styles(layer);
    if (name == "deposit_zones") return deposit_zone_styles(layer);
    if (name == "facets") return facet_styles(layer);
    if (name == "observed_stops")
        return {{.colour = "#ffffff", .marker = "diamond", .size_mm = 3.0, .outline_mm = 0.5}};
    if (name == "screens" || name == "screens_3d") return {{.colour = "#d55e00", .size_mm = 0.8}};
    if (name == "screen_crossings") return {{.colour = "#d55e00", .marker = "diamond", .size_mm = 1.4, .opacity = 0.7}};
    if (name == "impacts") return {{.colour = "#882255", .marker = "cross", .size_mm = 1.2, .opacity = 0.7}};
    if (name == "release_points") return {{.colour = "#cc3311", .marker = "triangle", .size_mm = 1.4, .opacity = 0.8}};
    if (name == "release_zones") return {{.colour = "#cc3311", .size_mm = 0.4, .opacity = 0.0, .dashed = true}};
    if (name == "profiles") return {{.colour = "#000000", .size_mm = 0.5, .dashed = true}};
    if (name.starts_with("effect_zone")) return {{.colour = "#882255", .size_mm = 0.6, .opacity = 0.0, .dashed = true}};
    // what is below an area must stay readable
    if (layer.kind == GeometryKind::Polygon) return {{.size_mm = 0.4, .opacity = 0.0}};
    if (layer.kind == GeometryKind::LineString) return {{.size_mm = 0.5}};
    return {VectorStyle{}};
}

}  // namespace scree::gis
