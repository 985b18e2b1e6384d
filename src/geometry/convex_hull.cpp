// SPDX-License-Identifier: GPL-3.0-or-later
// The only file of the core that includes CGAL: it is built with CGAL's -frounding-math, nothing else is.
#include "scree/base/error.hpp"
#include "scree/geometry/convex_block.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <cmath>

namespace scree {

ConvexHull convex_hull(const std::vector<Vec3>& points) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
    std::vector<Kernel::Point_3> input;
    input.reserve(points.size());
    for (const Vec3& p : points) {
        if (!p.allFinite()) throw InputError("a block shape has a point that is not finite: every coordinate must be a number");
        input.emplace_back(p.x(), p.y(), p.z());
    }
    Mesh mesh;
    if (input.size() >= 4) CGAL::convex_hull_3(input.begin(), input.end(), mesh);
    if (mesh.number_of_faces() < 4 || mesh.number_of_vertices() < 4)
        throw InputError("the " + std::to_string(points.size()) + " points of a block shape span no volume: at least 4 points that do not lie in one plane are needed");

    ConvexHull hull;
    std::vector<std::int32_t> number(mesh.number_of_vertices());
    for (const auto v : mesh.vertices()) {
        number[static_cast<std::size_t>(v.idx())] = static_cast<std::int32_t>(hull.vertices.size());
        hull.vertices.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
    }
    for (const auto f : mesh.faces()) {
        std::vector<std::int32_t> corners;
        for (const auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh)) corners.push_back(number[static_cast<std::size_t>(v.idx())]);
        for (std::size_t k = 2; k < corners.size(); ++k) hull.facets.push_back({corners[0], corners[k - 1], corners[k]});
    }
    return hull;
}

}  // namespace scree
