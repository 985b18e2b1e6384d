// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/surface.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

void TerrainPatch::clear() {
    facets.clear();
    edges.clear();
    nodes.clear();
    spokes.clear();
    bin_start.clear();
    bin_facets.clear();
    bin_columns = bin_rows = 0;
    least_normal_z = 1.0;
}

void TerrainPatch::add_facet(const PatchFacet& facet) {
    facets.push_back(facet);
    least_normal_z = std::min(least_normal_z, facet.normal.z());
}

std::span<const std::int32_t> TerrainPatch::facets_near(const Vec2& p) const {
    const double column = (p.x() - bin_origin.x()) / bin_size, row = (p.y() - bin_origin.y()) / bin_size;
    if (!(column >= 0.0 && row >= 0.0 && column < bin_columns && row < bin_rows)) return {};
    return facets_in_bin(static_cast<int>(column), static_cast<int>(row));
}

const PatchFacet* TerrainPatch::facet_at(const Vec2& p) const {
    const PatchFacet* best = nullptr;
    double best_inset = -1e-9;  // a point on a side belongs to either facet: take the one it is deeper in
    for (const std::int32_t f : facets_near(p)) {
        const PatchFacet& candidate = facets[static_cast<std::size_t>(f)];
        const double inset = candidate.inset(p);
        if (inset <= best_inset) continue;
        best_inset = inset;
        best = &candidate;
        if (inset > 1e-9) break;
    }
    return best;
}

double Surface::height(const Vec2& p) const {
    const std::int64_t f = facet_at(p);
    std::array<Vec3, 3> c;
    SoilId soil = 0;
    if (f < 0 || !facet(f, c, soil)) return kNaN;
    const Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]);
    return c[0].z() - (n.x() * (p.x() - c[0].x()) + n.y() * (p.y() - c[0].y())) / n.z();
}

Vec3 Surface::normal(const Vec2& p) const {
    const std::int64_t f = facet_at(p);
    std::array<Vec3, 3> c;
    SoilId soil = 0;
    SCREE_ASSERT(f >= 0);
    const bool valid = facet(f, c, soil);
    SCREE_ASSERT(valid);
    static_cast<void>(valid);
    return (c[1] - c[0]).cross(c[2] - c[0]).normalized();
}

}  // namespace scree
