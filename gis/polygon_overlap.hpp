// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/feature.hpp"

namespace scree::gis {

struct Overlap {
    double area = 0.0;       ///< [m^2]
    double perimeter = 0.0;  ///< [m]
};

/// What two areas have in common (GEOS).
Overlap polygon_overlap(const MultiPolygon& a, const MultiPolygon& b);

}  // namespace scree::gis
