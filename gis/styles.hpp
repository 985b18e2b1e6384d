// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/feature.hpp"

#include <string>
#include <vector>

namespace scree::gis {

/// What a raster shows. It fixes classes and colours, so that the maps of two runs can be laid side by side.
enum class RasterTheme {
    Terrain,      ///< heights of the ground: grey hillshade
    Energy,       ///< [kJ]: classes that refine the Swiss limits of 30 and 300 kJ
    Height,       ///< passing height above ground [m]
    Speed,        ///< [m/s]
    Spin,         ///< [rad/s]
    Count,        ///< whole numbers, 1-2-5 or decades up to the largest; 0 is transparent
    Probability,  ///< 0 to 1, logarithmic classes; 0 is transparent
    Slope,        ///< [degree]
    Generic       ///< equal classes between the smallest and the largest value
};

/// Colour ramps that people with colour-blindness can read, light for small values and dark for large ones.
enum class Ramp { Viridis, Inferno, Plasma, Mako };

/// One value of a field and how it is drawn.
struct Category {
    std::string value{};            ///< as stored; empty: every value that no other category names, and NULL
    std::string label{};            ///< as read in the legend
    std::string colour{};           ///< "#rrggbb"
    std::string marker = "circle";  ///< for points: QGIS' names, such as circle, square, triangle, diamond, cross2
};

/// How a vector layer is drawn: one colour, or classes of a numeric field, or categories of a field. Every member has an
/// initialiser, so that designated ones may leave any out.
struct VectorStyle {
    std::string name = "Default";        ///< as QGIS lists it
    std::string colour = "#31688e";      ///< where nothing else decides, "#rrggbb"
    std::string colour_by{};             ///< field that decides the colour; empty: one colour for all
    std::vector<Category> categories{};  ///< draw by these values of the field; empty: by classes of a number
    std::vector<double> limits{};   ///< inner class limits in the field's unit, ascending; empty: from the data [*]
    Ramp ramp = Ramp::Viridis;      ///< colours of the classes
    std::string unit{};             ///< unit behind the classes' limits in the legend
    std::string marker = "circle";  ///< for points
    double size_mm = 2.0;           ///< diameter of points, width of lines and outlines on the map [mm]
    double outline_mm = 0.1;        ///< width of the outline of points on the map [mm]
    double opacity = 1.0;           ///< of the fill of polygons (0: only the outline), of points and lines [-]
    bool dashed = false;            ///< lines and outlines
    std::string label{};            ///< QGIS expression written beside each feature; empty: none
};

/// The house style of the layers that results are made of, chosen by the layer's name and the fields it has; the first one is the default.
/// Layers of other names get one colour, areas an outline.
std::vector<VectorStyle> house_styles(const FeatureLayer& layer);

/// Colour of place `index` among `count` classes, light to dark, "#rrggbb".
std::string ramp_colour(Ramp ramp, std::size_t index, std::size_t count);

/// Colour of a category that has no colour of its own (a soil) by its number: Okabe & Ito's, the order of which is changed so that the first
/// ones stand out from grey relief; they repeat, "#rrggbb".
std::string category_colour(std::size_t number);

/// Round limits that cut [low, high] into about `classes` classes: 1-2-5 or decades where the values span more than a
/// factor of 20, equal steps otherwise. Ascending and strictly inside.
std::vector<double> round_limits(double low, double high, std::size_t classes = 7);

}  // namespace scree::gis
