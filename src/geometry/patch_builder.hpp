// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/surface.hpp"

#include <cmath>

namespace scree {

/// A facet for the patch from its corners, counter-clockwise from above.
inline PatchFacet make_patch_facet(const std::array<Vec3, 3>& c, SoilId soil, std::int64_t id) {
    PatchFacet f;
    f.normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    f.offset = f.normal.dot(c[0]);
    f.gradient = -f.normal.head<2>() * (1.0 / f.normal.z());
    f.base = c[0].z() - f.gradient.dot(c[0].head<2>());
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& a = c[k];
        const Vec3& b = c[(k + 1) % 3];
        const double dx = b.x() - a.x(), dy = b.y() - a.y();
        f.side[k] = Vec3(-dy, dx, dy * a.x() - dx * a.y()) * (1.0 / std::sqrt(dx * dx + dy * dy));
    }
    f.id = static_cast<std::int32_t>(id);
    f.soil = soil;
    return f;
}

/// True if the far corner of the other facet lies below the first facet's plane by more than the crest angle. The normal need not be unit.
inline bool is_crest(const Vec3& normal, const Vec3& on_edge, const Vec3& beyond) {
    const Vec3 d = beyond - on_edge;
    const double height = normal.dot(d);
    return height < 0.0 && height * height > kCrestAngle * kCrestAngle * d.squaredNorm() * normal.squaredNorm();
}

/// A rim from a to b with its one facet on the left: to the right the terrain falls straight down.
inline PatchEdge rim_edge(const Vec3& a, const Vec3& b, const Vec3& third, SoilId soil, std::int64_t id) {
    return {a, b, {third, Vec3(b - Vec3::UnitZ())}, {soil, soil}, id};
}

}  // namespace scree
