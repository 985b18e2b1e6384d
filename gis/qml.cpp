// SPDX-License-Identifier: GPL-3.0-or-later
// QGIS has no schema for its style files. What stands here is the part of what QGIS 3.22 writes that it needs to read the same
// look back; tests/gis/render_qgis.py opens every file in QGIS and checks that the look arrived.
#include "gis/qml.hpp"

#include "gis/xml.hpp"
#include "scree/base/error.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace scree::gis {

namespace {

/// Blocks of one colour in a legend.
struct LegendClass {
    double lower = 0;     ///< [unit of the field]
    double upper = 0;     ///< [unit of the field]
    std::string label{};  ///< with the unit
    std::string colour{};
    int alpha = 255;  ///< 0 transparent, 255 opaque [-]
};

std::string unit_suffix(const std::string& unit) {
    if (unit.empty() || unit == "-") return {};
    return unit == "°" ? unit : " " + unit;
}

/// "< 10 kJ", "10 – 30 kJ", "> 30 kJ".
std::string class_label(std::span<const double> limits, std::size_t index, const std::string& unit) {
    const std::string suffix = unit_suffix(unit);
    if (limits.empty()) return "all" + suffix;
    if (index == 0) return "< " + number_text(limits.front()) + suffix;
    if (index == limits.size()) return "> " + number_text(limits.back()) + suffix;
    return number_text(limits[index - 1]) + " – " + number_text(limits[index]) + suffix;
}

/// The classes that the limits cut; the outer ones reach as far as the values do.
std::vector<LegendClass> classes_between(std::span<const double> limits, const ValueRange& range, Ramp ramp,
                                         const std::string& unit) {
    std::vector<LegendClass> classes;
    for (std::size_t i = 0; i <= limits.size(); ++i) {
        LegendClass one;
        one.lower = i > 0 ? limits[i - 1] : std::min(0.0, range.empty() ? 0.0 : range.low);
        one.upper = i < limits.size() ? limits[i] : std::max(one.lower, range.empty() ? 0.0 : range.high);
        one.label = class_label(limits, i, unit);
        one.colour = ramp_colour(ramp, i, limits.size() + 1);
        classes.push_back(one);
    }
    return classes;
}

// --- symbols ---

/// "#rrggbb" as QGIS' "r,g,b,a".
std::string rgba(const std::string& colour, int alpha) {
    const auto part = [&](std::size_t at) { return std::to_string(std::stoi(colour.substr(at, 2), nullptr, 16)); };
    return part(1) + "," + part(3) + "," + part(5) + "," + std::to_string(alpha);
}

std::string option(std::string_view name, std::string_view value) {
    return "<Option type=\"QString\" name=\"" + std::string(name) + "\" value=\"" + xml_text(value) + "\"/>";
}

/// One symbol layer: its class and what a point, a line or an area of this colour is drawn with.
struct SymbolParts {
    std::string type{};
    std::string layer_class{};
    std::string options{};
    double alpha = 1.0;  ///< of the whole symbol [-]
};

SymbolParts marker_parts(const VectorStyle& style, const std::string& colour, const std::string& marker) {
    // markers made of strokes only take their colour from the outline
    const bool strokes = marker == "cross" || marker == "cross2" || marker == "line";
    return {"marker", "SimpleMarker",
            option("name", marker) + option("color", rgba(colour, 255)) + option("size", number_text(style.size_mm)) +
                option("size_unit", "MM") + option("outline_style", "solid") +
                option("outline_color", strokes ? rgba(colour, 255) : "30,30,30,160") +
                option("outline_width", strokes ? "0.5" : number_text(style.outline_mm)) +
                option("outline_width_unit", "MM"),
            style.opacity};
}

SymbolParts line_parts(const VectorStyle& style, const std::string& colour) {
    return {"line", "SimpleLine",
            option("line_color", rgba(colour, 255)) + option("line_width", number_text(style.size_mm)) +
                option("line_width_unit", "MM") + option("line_style", style.dashed ? "dash" : "solid") +
                option("capstyle", "round") + option("joinstyle", "round"),
            style.opacity};
}

SymbolParts fill_parts(const VectorStyle& style, const std::string& colour) {
    // only the fill is see-through: the outline of a zone must stay readable
    const bool outline_only = style.opacity == 0.0;
    return {"fill", "SimpleFill",
            option("color", rgba(colour, static_cast<int>(std::lround(255 * style.opacity)))) +
                option("style", outline_only ? "no" : "solid") +
                option("outline_color", style.colour_by.empty() || outline_only ? rgba(colour, 255) : "40,40,40,255") +
                option("outline_width", number_text(style.size_mm)) + option("outline_width_unit", "MM") +
                option("outline_style", style.dashed ? "dash" : "solid") + option("joinstyle", "miter"),
            1.0};
}

std::string symbol(GeometryKind kind, std::size_t name, const VectorStyle& style, const std::string& colour,
                   const std::string& marker) {
    const SymbolParts parts = kind == GeometryKind::Point        ? marker_parts(style, colour, marker)
                              : kind == GeometryKind::LineString ? line_parts(style, colour)
                                                                 : fill_parts(style, colour);
    return "<symbol type=\"" + parts.type + "\" name=\"" + std::to_string(name) + "\" alpha=\"" +
           number_text(parts.alpha) + "\" clip_to_extent=\"1\" force_rhr=\"0\">\n<layer class=\"" + parts.layer_class +
           "\" enabled=\"1\" locked=\"0\" pass=\"0\"><Option type=\"Map\">" + parts.options +
           "</Option></layer>\n</symbol>\n";
}

// --- vector renderers ---

std::string single_renderer(const VectorLayer& layer, const VectorStyle& style) {
    return "<renderer-v2 type=\"singleSymbol\" symbollevels=\"0\" enableorderby=\"0\" forceraster=\"0\">\n<symbols>\n" +
           symbol(layer.data.kind, 0, style, style.colour, style.marker) + "</symbols>\n</renderer-v2>\n";
}

std::string categorised_renderer(const VectorLayer& layer, const VectorStyle& style) {
    std::string categories;
    std::string symbols;
    for (std::size_t i = 0; i < style.categories.size(); ++i) {
        const Category& category = style.categories[i];
        categories += "<category value=\"" + xml_text(category.value) + "\" label=\"" + xml_text(category.label) +
                      "\" symbol=\"" + std::to_string(i) + "\" render=\"true\"/>\n";
        symbols += symbol(layer.data.kind, i, style, category.colour, category.marker);
    }
    return "<renderer-v2 type=\"categorizedSymbol\" attr=\"" + xml_text(style.colour_by) +
           "\" symbollevels=\"0\" enableorderby=\"0\" forceraster=\"0\">\n<categories>\n" + categories +
           "</categories>\n<symbols>\n" + symbols + "</symbols>\n</renderer-v2>\n";
}

std::string graduated_renderer(const VectorLayer& layer, const VectorStyle& style, const ValueRange& range) {
    const std::vector<double> limits = style.limits.empty() ? round_limits(range.low, range.high) : style.limits;
    const std::vector<LegendClass> classes = classes_between(limits, range, style.ramp, style.unit);
    std::string ranges;
    std::string symbols;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        ranges += "<range lower=\"" + number_text(classes[i].lower) + "\" upper=\"" + number_text(classes[i].upper) +
                  "\" label=\"" + xml_text(classes[i].label) + "\" symbol=\"" + std::to_string(i) +
                  "\" render=\"true\"/>\n";
        symbols += symbol(layer.data.kind, i, style, classes[i].colour, style.marker);
    }
    return "<renderer-v2 type=\"graduatedSymbol\" attr=\"" + xml_text(style.colour_by) +
           "\" graduatedMethod=\"GraduatedColor\" symbollevels=\"0\" enableorderby=\"0\" "
           "forceraster=\"0\">\n<ranges>\n" +
           ranges + "</ranges>\n<symbols>\n" + symbols + "</symbols>\n</renderer-v2>\n";
}

std::string labelling(GeometryKind kind, const std::string& expression) {
    if (expression.empty()) return {};
    // 1 around a point, 2 along a line, 1 around the centroid but inside an area
    const std::string placement = kind == GeometryKind::LineString ? "2" : kind == GeometryKind::Polygon ? "1" : "0";
    return "<labeling type=\"simple\"><settings>\n<text-style fieldName=\"" + xml_text(expression) +
           "\" isExpression=\"1\" fontFamily=\"Sans Serif\" fontSize=\"10\" fontWeight=\"75\" fontSizeUnit=\"Point\" "
           "textColor=\"20,20,20,255\""
           " textOpacity=\"1\">\n<text-buffer bufferDraw=\"1\" bufferSize=\"0.8\" bufferSizeUnits=\"MM\""
           " bufferColor=\"255,255,255,255\" bufferOpacity=\"0.9\" bufferNoFill=\"1\" "
           "bufferJoinStyle=\"128\"/>\n</text-style>\n<text-format "
           "multilineAlign=\"1\"/>\n"
           "<placement placement=\"" +
           placement +
           "\"/>\n<rendering drawLabels=\"1\" obstacle=\"1\" obstacleType=\"1\"/>\n</settings></labeling>\n";
}

std::string aliases(const std::vector<Field>& fields) {
    std::string out = "<aliases>\n";
    for (std::size_t i = 0; i < fields.size(); ++i) {
        // index 0 is the feature id
        out += "<alias index=\"" + std::to_string(i + 1) + "\" field=\"" + xml_text(fields[i].name) + "\" name=\"" +
               xml_text(fields[i].alias) + "\"/>\n";
    }
    return out + "</aliases>\n";
}

// --- rasters ---

/// Fixed limits of the themes [unit of the theme]. Energy: 30 and 300 kJ part low, medium and high intensity (Swiss guideline on
/// rockfall hazard, BAFU 2016), halves of decades between them. The others follow what barriers are dimensioned by.
std::vector<double> theme_limits(RasterTheme theme, const ValueRange& range) {
    switch (theme) {
        case RasterTheme::Energy:
            return {1, 3, 10, 30, 100, 300, 1000, 3000, 10000};
        case RasterTheme::Height:
            return {0.5, 1, 1.5, 2, 3, 4, 5, 7, 10, 15};
        case RasterTheme::Speed:
            return {2.5, 5, 7.5, 10, 15, 20, 25, 30, 40};
        case RasterTheme::Spin:
            return {1, 2, 5, 10, 15, 20, 30, 50};
        case RasterTheme::Probability:
            return {0.0001, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3};
        case RasterTheme::Slope:
            return {10, 20, 30, 35, 40, 45, 50, 60, 70};
        case RasterTheme::Count:
        case RasterTheme::Generic:
        case RasterTheme::Terrain:
            break;
    }
    return range.empty() ? std::vector<double>{} : round_limits(range.low, range.high);
}

Ramp theme_ramp(RasterTheme theme) {
    switch (theme) {
        case RasterTheme::Energy:
        case RasterTheme::Slope:
            return Ramp::Inferno;
        case RasterTheme::Height:
            return Ramp::Mako;
        case RasterTheme::Speed:
        case RasterTheme::Spin:
            return Ramp::Plasma;
        default:
            return Ramp::Viridis;
    }
}

/// Classes of whole numbers by their largest member: 1, 2, 3 – 5, 6 – 10, ...
std::vector<LegendClass> count_classes(const ValueRange& range, const std::string& unit) {
    const double most = range.empty() ? 1.0 : std::max(1.0, range.high);
    std::vector<double> uppers;
    const bool decades = most > 500;  // the eight classes 1, 2, 5, ..., 200, 500 fill a legend
    for (double decade = 1; uppers.empty() || uppers.back() < most; decade *= 10) {
        for (const double digit : {1.0, 2.0, 5.0}) {
            if ((decades && digit == 2.0) || (!uppers.empty() && uppers.back() >= most)) continue;
            if (decades && digit == 5.0 && most > 1e5) continue;
            uppers.push_back(digit * decade);
        }
    }
    const std::string suffix = unit_suffix(unit);
    std::vector<LegendClass> classes = {{.upper = 0, .label = "0" + suffix, .colour = "#ffffff", .alpha = 0}};
    for (std::size_t i = 0; i < uppers.size(); ++i) {
        const double lowest = classes.back().upper + 1;
        const std::string number =
            lowest == uppers[i] ? number_text(lowest) : number_text(lowest) + " – " + number_text(uppers[i]);
        classes.push_back(
            {.upper = uppers[i], .label = number + suffix, .colour = ramp_colour(Ramp::Viridis, i, uppers.size())});
    }
    return classes;
}

std::vector<LegendClass> raster_classes(const RasterLayer& layer, const ValueRange& range) {
    if (layer.theme == RasterTheme::Count) return count_classes(range, layer.unit);
    const std::vector<double> limits = theme_limits(layer.theme, range);
    std::vector<LegendClass> classes = classes_between(limits, range, theme_ramp(layer.theme), layer.unit);
    if (layer.theme == RasterTheme::Energy) {
        for (std::size_t i = 0; i < classes.size(); ++i) {
            const double upper = i < limits.size() ? limits[i] : kInfinity;
            classes[i].label += upper <= 30 ? " (low)" : upper <= 300 ? " (medium)" : " (high)";
        }
    }
    if (layer.theme == RasterTheme::Probability) {
        classes.insert(classes.begin(), {.upper = 0, .label = "0", .colour = "#ffffff", .alpha = 0});
    }
    return classes;
}

std::string hillshade_renderer() {
    return "<rasterrenderer type=\"hillshade\" band=\"1\" azimuth=\"315\" angle=\"45\" zfactor=\"1\" "
           "multidirection=\"1\""
           " opacity=\"0.6\" alphaBand=\"-1\" nodataColor=\"\"/>\n";
}

std::string classes_renderer(const RasterLayer& layer) {
    ValueRange range;
    for (const float value : layer.values.values) {
        if (std::isfinite(value)) range.add(static_cast<double>(value));
    }
    std::string items;
    const std::vector<LegendClass> classes = raster_classes(layer, range);
    for (std::size_t i = 0; i < classes.size(); ++i) {
        // of discrete classes QGIS knows the upper limit; the last one is open
        const std::string upper = i + 1 < classes.size() ? number_text(classes[i].upper) : "inf";
        items += "<item value=\"" + upper + "\" label=\"" + xml_text(classes[i].label) + "\" color=\"" +
                 classes[i].colour + "\" alpha=\"" + std::to_string(classes[i].alpha) + "\"/>\n";
    }
    const std::string low = number_text(range.empty() ? 0 : range.low);
    const std::string high = number_text(range.empty() ? 1 : range.high);
    return "<rasterrenderer type=\"singlebandpseudocolor\" band=\"1\" opacity=\"0.85\" alphaBand=\"-1\" "
           "nodataColor=\"\""
           " classificationMin=\"" +
           low + "\" classificationMax=\"" + high +
           "\">\n<rastershader>\n<colorrampshader colorRampType=\"DISCRETE\" classificationMode=\"1\" clip=\"0\" "
           "minimumValue=\"" +
           low + "\" maximumValue=\"" + high + "\">\n" + items +
           "</colorrampshader>\n</rastershader>\n</rasterrenderer>\n";
}

}  // namespace

QgisStyle vector_qgis_style(const VectorLayer& layer, const VectorStyle& style, const ValueRange& range) {
    QgisStyle out;
    if (layer.data.kind == GeometryKind::None) {
        out.elements = aliases(layer.data.fields);
        return out;
    }
    out.attributes = style.label.empty() ? " labelsEnabled=\"0\"" : " labelsEnabled=\"1\"";
    out.elements = style.colour_by.empty()    ? single_renderer(layer, style)
                   : style.categories.empty() ? graduated_renderer(layer, style, range)
                                              : categorised_renderer(layer, style);
    out.elements += labelling(layer.data.kind, style.label) + aliases(layer.data.fields);
    return out;
}

QgisStyle raster_qgis_style(const RasterLayer& layer) {
    QgisStyle out;
    // a hillshade of repeated cells shows stripes; all other maps show the cells as they were computed
    const bool smooth = layer.theme == RasterTheme::Terrain;
    const std::string in = smooth ? "cubic" : "nearestNeighbour";
    const std::string away = smooth ? "bilinear" : "nearestNeighbour";
    out.elements =
        "<pipe>\n<provider><resampling enabled=\"" + std::string(smooth ? "true" : "false") +
        "\" maxOversampling=\"2\" zoomedInResamplingMethod=\"" + in + "\" zoomedOutResamplingMethod=\"" + away +
        "\"/></provider>\n" + (smooth ? hillshade_renderer() : classes_renderer(layer)) +
        "<brightnesscontrast brightness=\"0\" contrast=\"0\" gamma=\"1\"/>\n<huesaturation saturation=\"0\"/>\n"
        "<rasterresampler maxOversampling=\"2\"/>\n<resamplingStage>" +
        (smooth ? "provider" : "resamplingFilter") + "</resamplingStage>\n</pipe>\n<blendMode>0</blendMode>\n";
    return out;
}

std::string qml_document(const QgisStyle& style) {
    return "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n<qgis version=\"3.22.0\""
           " styleCategories=\"AllStyleCategories\"" +
           style.attributes + ">\n" + style.elements + "</qgis>\n";
}

}  // namespace scree::gis
