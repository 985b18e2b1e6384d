// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace scree {

/// A terrain of triangles, single-valued in height: every point in plan view lies in one facet, or in none (a hole).
struct TriangleMesh {
    std::vector<Vec3> vertices;                       ///< local frame [m]
    std::vector<std::array<std::int32_t, 3>> facets;  ///< vertex indices, counter-clockwise seen from above [-]
    std::vector<SoilId> soil;                         ///< soil of each facet [-]
};

}  // namespace scree
