// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <string>

namespace scree {

/// A position in the map frame: a type of its own, so that 1e6 m never slips into the core.
struct MapPoint {
    double easting = 0.0;   ///< easting in the DTM's CRS [m]
    double northing = 0.0;  ///< northing in the DTM's CRS [m]
    double height = 0.0;    ///< height in the DTM's vertical datum [m]
};

/// The map frame shifted by a rounded origin near the site. The axes are those of the map.
struct LocalFrame {
    double easting = 0.0;   ///< easting of the local origin [m]
    double northing = 0.0;  ///< northing of the local origin [m]
    double height = 0.0;    ///< height of the local origin [m]
    std::string crs;        ///< horizontal projected CRS of the map frame as WKT2; empty: unknown

    Vec3 to_local(const MapPoint& p) const { return {p.easting - easting, p.northing - northing, p.height - height}; }
    MapPoint to_map(const Vec3& p) const { return {p.x() + easting, p.y() + northing, p.z() + height}; }
};

}  // namespace scree
