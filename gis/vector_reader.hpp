// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/feature.hpp"
#include "scree/geometry/local_frame.hpp"

#include <string>
#include <vector>

namespace scree::gis {

struct VectorSource {
    std::string file;
    std::string layer;                    ///< name of the layer; empty: the only one of the file
    std::vector<GeometryKind> kinds;      ///< allowed kinds; the features of a layer must all have the same one
    std::string purpose = "vector file";  ///< what messages call it: "release zones"
    bool may_reach_beyond = false;        ///< true: no warning for features beyond the extent, as is usual for soils
    bool geometry_optional =
        false;  ///< true: a table: features without a geometry are read, too, and there may be none
};

struct VectorReport {
    std::string file;       ///< as given
    std::string layer;      ///< the layer that was read
    std::string driver;     ///< GDAL's name of the format
    std::string crs_name;   ///< with its code where it has one; empty: unknown
    std::string operation;  ///< PROJ's name of the transformation into the map frame; empty: none was needed
    double accuracy = 0.0;  ///< of that transformation as PROJ states it; NaN: unknown [m]
    Box2 extent;            ///< of all features, local frame [m]
    std::vector<std::string> warnings;
};

struct VectorData {
    FeatureLayer layer;
    VectorReport report;
};

/// Reads a layer and transforms it into the local frame of a terrain that covers `extent`.
///
/// Rules. A layer without a CRS is taken to be in the terrain's, with a warning. Curves become chords of one degree. M is ignored;
/// Z is kept for points and lines as a height in the terrain's vertical datum (never transformed), and ignored for polygons. Rings
/// come out counter-clockwise outside and clockwise inside, without repeated points. A polygon that crosses itself is refused, not
/// repaired. Features without a geometry are left out with a warning. An edge is straight in the map frame between its transformed
/// ends. A layer that lies wholly outside of the extent is refused; features that do or that reach beyond it give a warning.
VectorData read_vector(const VectorSource& source, const LocalFrame& frame, const Box2& extent);

/// "easting 890.0 to 1050.0, northing ...", on the map.
std::string extent_text(const Box2& box, const LocalFrame& frame);

/// Names of all layers and tables of a file.
std::vector<std::string> layer_names(const std::string& file, const std::string& purpose);

/// Allowed values of a numeric field.
struct NumberRule {
    std::string field;
    double low = -kInfinity;    ///< smallest value allowed [unit of the field]
    double high = kInfinity;    ///< largest value allowed [unit of the field]
    bool low_included = true;   ///< false: values must be greater than low
    bool null_allowed = false;  ///< true: a missing value becomes NaN
};

/// Index of a field; throws InputError that lists the fields there are. Case counts.
std::size_t field_index(const VectorData& data, const std::string& field);
/// The numbers of a field, one per feature; throws InputError that names the features with values that are not allowed.
std::vector<double> number_field(const VectorData& data, const NumberRule& rule);
/// The texts of a field, one per feature; numbers become text; throws InputError that names the features without one.
std::vector<std::string> text_field(const VectorData& data, const std::string& field);

}  // namespace scree::gis
