// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/terrains.hpp"

#include "scree/base/random.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace scree::test {

TriangleMesh mesh_of(const Surface& surface) {
    TriangleMesh mesh;
    std::map<std::array<double, 2>, std::int32_t> known;
    for (std::int64_t f = 0; f < surface.facet_count(); ++f) {
        std::array<Vec3, 3> corners;
        SoilId soil = 0;
        if (!surface.facet(f, corners, soil)) continue;
        std::array<std::int32_t, 3> facet{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [entry, added] =
                known.try_emplace({corners[k].x(), corners[k].y()}, static_cast<std::int32_t>(mesh.vertices.size()));
            if (added) mesh.vertices.push_back(corners[k]);
            facet[k] = entry->second;
        }
        mesh.facets.push_back(facet);
        mesh.soil.push_back(soil);
    }
    return mesh;
}

TriangleMesh mapped(TriangleMesh mesh, const std::function<Vec3(const Vec3&)>& map, bool mirrored) {
    for (Vec3& v : mesh.vertices) v = map(v);
    if (mirrored)
        for (auto& f : mesh.facets) std::swap(f[1], f[2]);
    return mesh;
}

TriangleMesh cut_mesh(double half, double cell, Cut cut, const std::function<double(double, double)>& height) {
    const int n = static_cast<int>(std::lround(2.0 * half / cell));
    RandomStream random(5, 1, RandomPurpose::Effect);
    TriangleMesh mesh;
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
            Vec2 p(-half + i * cell, -half + j * cell);
            if (cut == Cut::Random && i > 0 && j > 0 && i < n && j < n) {
                const double dx = random.uniform(-0.3, 0.3), dy = random.uniform(-0.3, 0.3);
                p += cell * Vec2(dx, dy);
            }
            mesh.vertices.emplace_back(p.x(), p.y(), height(p.x(), p.y()));
        }
    }
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const std::int32_t sw = j * (n + 1) + i, se = sw + 1, nw = sw + n + 1, ne = nw + 1;
            const bool other = cut == Cut::OtherDiagonal || (cut == Cut::Alternating && (i + j) % 2 == 1) ||
                               (cut == Cut::Random && random.below(2) == 1);
            if (other) {
                mesh.facets.push_back({sw, se, ne});
                mesh.facets.push_back({sw, ne, nw});
            } else {
                mesh.facets.push_back({sw, se, nw});
                mesh.facets.push_back({se, ne, nw});
            }
        }
    }
    mesh.soil.assign(mesh.facets.size(), 0);
    return mesh;
}

std::function<double(double, double)> rough_slope(double slope, double noise) {
    return [=](double x, double y) {
        const auto key =
            static_cast<std::uint64_t>(std::llround(1000.0 * x) * 7919 + std::llround(1000.0 * y) * 104729);
        RandomStream random(11, key, RandomPurpose::Effect);
        return -std::tan(slope) * x + random.uniform(-noise, noise);
    };
}

}  // namespace scree::test
