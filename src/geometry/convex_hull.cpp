// SPDX-License-Identifier: GPL-3.0-or-later
// The only file of the core that includes CGAL: it is built with CGAL's -frounding-math, nothing else is.
#include "geometry/plain_hull.hpp"

#include "scree/base/error.hpp"
#include "scree/geometry/convex_block.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace scree {

namespace {

/// CGAL's order of vertices and faces follows memory addresses. Rounding, and with it a chaotic trajectory, must not: vertices in order of their
/// coordinates, facets beginning with their lowest vertex and sorted.
void put_in_order(ConvexHull& hull) {
    std::vector<std::int32_t> order(hull.vertices.size());
    std::iota(order.begin(), order.end(), 0);
    auto coordinates = [&](std::int32_t v) {
        const Vec3& p = hull.vertices[static_cast<std::size_t>(v)];
        return std::tuple(p.x(), p.y(), p.z());
    };
    std::sort(order.begin(), order.end(),
              [&](std::int32_t a, std::int32_t b) { return coordinates(a) < coordinates(b); });
    std::vector<Vec3> vertices;
    std::vector<std::int32_t> place(order.size());
    for (const std::int32_t v : order) {
        place[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(vertices.size());
        vertices.push_back(hull.vertices[static_cast<std::size_t>(v)]);
    }
    hull.vertices = std::move(vertices);
    for (auto& f : hull.facets) {
        for (std::int32_t& v : f) v = place[static_cast<std::size_t>(v)];
        std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    }
    std::sort(hull.facets.begin(), hull.facets.end());
}

ConvexHull exact_hull(const std::vector<Vec3>& points) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
    std::vector<Kernel::Point_3> input;
    input.reserve(points.size());
    for (const Vec3& p : points) input.emplace_back(p.x(), p.y(), p.z());
    std::sort(input.begin(), input.end());  // how CGAL cuts a face of more than three corners depends on their order
    Mesh mesh;
    if (input.size() >= 4) CGAL::convex_hull_3(input.begin(), input.end(), mesh);
    if (mesh.number_of_faces() < 4 || mesh.number_of_vertices() < 4)
        throw InputError(
            "the " + std::to_string(points.size()) +
            " points of a block shape span no volume: at least 4 points that do not lie in one plane are needed");

    ConvexHull hull;
    std::vector<std::int32_t> number(mesh.number_of_vertices());
    for (const auto v : mesh.vertices()) {
        number[static_cast<std::size_t>(v.idx())] = static_cast<std::int32_t>(hull.vertices.size());
        hull.vertices.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
    }
    for (const auto f : mesh.faces()) {
        std::vector<std::int32_t> corners;
        for (const auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh))
            corners.push_back(number[static_cast<std::size_t>(v.idx())]);
        for (std::size_t k = 2; k < corners.size(); ++k)
            hull.facets.push_back({corners[0], corners[k - 1], corners[k]});
    }
    return hull;
}

}  // namespace

// Exact predicates cost ten times as much and are needed only where plain ones leave a doubt.
ConvexHull convex_hull(const std::vector<Vec3>& points) {
    if (!std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); }))
        throw InputError("a block shape has a point that is not finite: every coordinate must be a number");
    std::optional<ConvexHull> plain = plain_hull(points);
    ConvexHull hull = plain ? std::move(*plain) : exact_hull(points);
    put_in_order(hull);
    return hull;
}

}  // namespace scree
