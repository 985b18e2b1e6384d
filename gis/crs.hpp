// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <string>
#include <vector>

class OGRSpatialReference;

namespace scree::gis {

/// A coordinate reference system of the map, horizontal part only.
struct HorizontalCrs {
    std::string wkt;   ///< WKT2:2019; empty: unknown
    std::string name;  ///< what people call it, with its code where it has one; empty: unknown
};

/// The horizontal part of a CRS; unknown where there is none, or where a GeoPackage says "undefined".
HorizontalCrs horizontal_part(const OGRSpatialReference* crs);

/// The CRS that people name by "EPSG:2154" or WKT. Throws InputError; `place` begins the message.
HorizontalCrs named_crs(const std::string& text, const std::string& place);

/// Whether two CRSs (as WKT) put a position at the same easting and northing.
bool same_map(const std::string& a, const std::string& b);
/// Whether positions in this CRS (as WKT) are longitude and latitude.
bool in_degrees(const std::string& wkt);

/// Checks that the CRS of a terrain model is a map in metres at `centre` (in that CRS [its unit]): projected, unit metre in plan
/// and height, and true to scale. Throws InputError; small errors of scale become warnings. `place` begins the messages.
HorizontalCrs metric_crs_or_throw(const OGRSpatialReference* crs, const Vec2& centre, const std::string& place,
                                  std::vector<std::string>& warnings);

}  // namespace scree::gis
