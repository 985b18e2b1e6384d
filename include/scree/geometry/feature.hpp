// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace scree {

/// Plain vector features in the local frame: what is read from and written to GIS files.

using Ring = std::vector<Vec2>;  ///< closed without repeating the first point; local frame [m]

struct Polygon {
    Ring outer;               ///< counter-clockwise [m]
    std::vector<Ring> holes;  ///< clockwise [m]
};

struct Polyline {
    std::vector<Vec3> points;     ///< local frame [m]; z is NaN where the source has none
    std::vector<double> measure;  ///< M of each point, empty where there is none; time along trajectories [s]
};

using Points = std::vector<Vec3>;  ///< local frame [m]; z is NaN where the source has none
using Polylines = std::vector<Polyline>;
using MultiPolygon = std::vector<Polygon>;
using Geometry = std::variant<std::monostate, Points, Polylines, MultiPolygon>;

/// Distance in plan view: 0 in a polygon (but not in its holes), infinite from a geometry that holds nothing [m].
double plan_distance(const Vec2& p, const Geometry& geometry);

/// monostate is NULL.
using FieldValue = std::variant<std::monostate, std::int64_t, double, std::string>;

enum class FieldType { Integer, Real, Text };

struct Field {
    std::string name;  ///< snake_case with a unit suffix (energy_kj, height_m)
    FieldType type = FieldType::Real;
    std::string alias;  ///< what people read, with the unit: "Kinetic energy [kJ]"
};

/// Stands for the number of a feature where there is none.
inline constexpr std::int64_t kNoFeature = -1;

struct Feature {
    std::int64_t id = 0;  ///< feature id in the source, or its number in the output
    Geometry geometry;
    std::vector<FieldValue> values;  ///< one per field of the layer
};

enum class GeometryKind { None, Point, LineString, Polygon };

struct FeatureLayer {
    std::string name;
    GeometryKind kind = GeometryKind::None;
    std::vector<Field> fields;
    std::vector<Feature> features;
};

}  // namespace scree
