// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/convex_block.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/error.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

MassProperties mass_properties(const ConvexHull& hull) {
    // Tetrahedra between the first vertex and every facet; second moments of a tetrahedron with one corner in the origin:
    // integral of x x^T = V/20 (sum a_i a_i^T + s s^T), s = sum a_i.
    const Vec3 apex = hull.vertices.front();
    double volume = 0.0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (const auto& f : hull.facets) {
        const Vec3 a = hull.vertices[static_cast<std::size_t>(f[0])] - apex;
        const Vec3 b = hull.vertices[static_cast<std::size_t>(f[1])] - apex;
        const Vec3 c = hull.vertices[static_cast<std::size_t>(f[2])] - apex;
        const double v = a.dot(b.cross(c)) / 6.0;
        const Vec3 s = a + b + c;
        volume += v;
        first += v / 4.0 * s;
        second += v / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
    }
    MassProperties result;
    result.volume = volume;
    const Vec3 centre = first / volume;
    result.centre = apex + centre;
    const Mat3 central = second - volume * centre * centre.transpose();
    result.inertia = central.trace() * Mat3::Identity() - central;
    return result;
}

namespace {

/// Makes room for `count` entries and the filling of the last group.
void resize_filled(Eigen::ArrayXd& array, Eigen::Index count) {
    array.resize((count + ConvexBlock::kLanes - 1) / ConvexBlock::kLanes * ConvexBlock::kLanes);
}
void fill(Eigen::ArrayXd& array, Eigen::Index count) {
    array.tail(array.size() - count).setConstant(array[count - 1]);
}

ConvexBlock block_from_hull(const ConvexHull& hull, double mass) {
    const MassProperties properties = mass_properties(hull);
    Eigen::SelfAdjointEigenSolver<Mat3> eigen(properties.inertia);
    Mat3 axes = eigen.eigenvectors();
    if (axes.determinant() < 0) axes.col(2) = -axes.col(2);

    ConvexBlock block;
    block.mass = mass;
    block.volume = properties.volume;
    block.inertia = mass / properties.volume * eigen.eigenvalues();
    block.facets = hull.facets;
    const auto vertices = static_cast<Eigen::Index>(hull.vertices.size());
    block.vertices = vertices;
    for (Eigen::ArrayXd* a : {&block.x, &block.y, &block.z}) resize_filled(*a, vertices);
    for (Eigen::Index i = 0; i < vertices; ++i) {
        const Vec3 b = axes.transpose() * (hull.vertices[static_cast<std::size_t>(i)] - properties.centre);
        block.x[i] = b.x();
        block.y[i] = b.y();
        block.z[i] = b.z();
        block.radius = std::max(block.radius, b.norm());
    }
    for (Eigen::ArrayXd* a : {&block.x, &block.y, &block.z}) fill(*a, vertices);
    const auto faces = static_cast<Eigen::Index>(hull.facets.size());
    for (Eigen::ArrayXd* a : {&block.nx, &block.ny, &block.nz, &block.offset}) resize_filled(*a, faces);
    for (Eigen::Index f = 0; f < faces; ++f) {
        const auto& corners = hull.facets[static_cast<std::size_t>(f)];
        const Vec3 a = block.vertex(corners[0]);
        const Vec3 n = (block.vertex(corners[1]) - a).cross(block.vertex(corners[2]) - a).normalized();
        block.nx[f] = n.x();
        block.ny[f] = n.y();
        block.nz[f] = n.z();
        block.offset[f] = n.dot(a);
    }
    for (Eigen::ArrayXd* a : {&block.nx, &block.ny, &block.nz, &block.offset}) fill(*a, faces);
    block.inner_radius = block.offset.minCoeff();
    return block;
}

/// Moves and stretches the points so that they fill the box exactly.
void fill_box(std::vector<Vec3>& points, const Vec3& size) {
    Vec3 low = points.front(), high = points.front();
    for (const Vec3& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const Vec3 extent = high - low;
    if (!(extent.minCoeff() > 0.0)) throw InputError("a block shape is flat: its points span no volume");
    for (Vec3& p : points) p = ((p - 0.5 * (low + high)).array() * size.array() / extent.array()).matrix();
}

Vec3 point_in_ball(RandomStream& random) {
    for (;;) {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
        if (x * x + y * y + z * z <= 1.0) return {x, y, z};
    }
}

/// Size of a uniform cloud in the ball whose hull has on average `vertices` vertices. For large clouds their number grows as the square root
/// of the cloud (Renyi & Sulanke 1963); the constants are fitted to means of 1000 hulls each (tests/unit/convex_block_test.cpp).
int cloud_size(int vertices) {
    const double v = vertices;
    return std::max(4, static_cast<int>(std::lround(0.0492 * v * v + 0.607 * v + 0.6)));
}

std::vector<Vec3> random_cloud(int vertices, RandomStream& random) {
    std::vector<Vec3> points;
    const int count = cloud_size(vertices);
    points.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) points.push_back(point_in_ball(random));
    return points;
}

std::vector<Vec3> box_corners() {
    std::vector<Vec3> points;
    for (double x : {-1.0, 1.0})
        for (double y : {-1.0, 1.0})
            for (double z : {-1.0, 1.0}) points.push_back({x, y, z});
    return points;
}

/// EAD 340059 (norm block of barrier tests): a cube with edges and corners cut so that a third of every edge remains, the hull of
/// the 24 points (+-1, +-1/3, +-1/3) and their permutations.
std::vector<Vec3> eota_points() {
    std::vector<Vec3> points;
    const double third = 1.0 / 3.0;
    for (int axis = 0; axis < 3; ++axis)
        for (double s : {-1.0, 1.0})
            for (double a : {-third, third})
                for (double b : {-third, third}) {
                    Vec3 p;
                    p[axis] = s;
                    p[(axis + 1) % 3] = a;
                    p[(axis + 2) % 3] = b;
                    points.push_back(p);
                }
    return points;
}

/// Evenly spread points on the sphere: a spiral of golden-angle steps.
std::vector<Vec3> sphere_points(int count) {
    std::vector<Vec3> points;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / count;
        const double r = std::sqrt(1.0 - z * z);
        points.push_back({r * std::cos(golden * i), r * std::sin(golden * i), z});
    }
    return points;
}

std::vector<Vec3> shape_points(const ShapeSettings& settings, RandomStream& random) {
    switch (settings.shape) {
        case BlockShape::Hull:
            return random_cloud(settings.points, random);
        case BlockShape::Sharp:
            return random_cloud(kSharpPoints, random);
        case BlockShape::Round:
            return random_cloud(kRoundPoints, random);
        case BlockShape::Box:
            return box_corners();
        case BlockShape::Eota:
            return eota_points();
        case BlockShape::Ellipsoid:
            return sphere_points(settings.points);
        case BlockShape::File:
            return settings.file_points;
    }
    return {};
}

}  // namespace

ConvexBlock scaled_block(const ConvexBlock& block, double factor) {
    ConvexBlock b = block;
    const double volume = factor * factor * factor;
    for (Eigen::ArrayXd* lengths : {&b.x, &b.y, &b.z, &b.offset}) *lengths *= factor;
    b.mass *= volume;
    b.volume *= volume;
    b.inertia *= volume * factor * factor;
    b.size *= factor;
    b.radius *= factor;
    b.inner_radius *= factor;
    return b;
}

ConvexBlock make_block_from_points(const std::vector<Vec3>& points, double mass) {
    return block_from_hull(convex_hull(points), mass);
}

ConvexBlock make_block(const ShapeSettings& settings, const Vec3& size, double mass, RandomStream& random) {
    if (!(size.minCoeff() > 0.0) || !size.allFinite() || !(mass > 0.0) || !std::isfinite(mass))
        throw InputError("a block of " + std::to_string(mass) + " kg and " + std::to_string(size.x()) + " x " +
                         std::to_string(size.y()) + " x " + std::to_string(size.z()) +
                         " m is impossible: mass and all three lengths must be positive");
    std::vector<Vec3> points = shape_points(settings, random);
    if (points.size() < 4)
        throw InputError("a block shape has " + std::to_string(points.size()) + " points: at least 4 are needed");
    fill_box(points, size);
    ConvexBlock block = block_from_hull(convex_hull(points), mass);
    block.size = size;
    return block;
}

}  // namespace scree
