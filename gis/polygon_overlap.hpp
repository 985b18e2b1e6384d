// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/feature.hpp"

namespace scree::gis {

struct Overlap {
    double area = 0.0;     ///< [m^2]
    bool is_wide = false;  ///< somewhere it is wider than asked for
};

/// What two areas have in common (GEOS), and whether a strip of the `width` [m] finds room in it.
Overlap polygon_overlap(const MultiPolygon& a, const MultiPolygon& b, double width);

}  // namespace scree::gis
