// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/convex_polygon.hpp"

#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace scree {

namespace {

/// A corner nearer than this to the line through its neighbours, as a share of the polygon's extent, is rounding: dropped [-].
constexpr double kStraight = 1e-12;

double extent_of(const std::vector<Vec2>& points) {
    Box2 box;
    for (const Vec2& p : points) box.add(p);
    return (box.max - box.min).maxCoeff();
}

/// Adds the points one by one to a chain that turns left only.
template <class Iterator>
void add_chain(Iterator first, Iterator last, double tolerance, std::vector<Vec2>& chain) {
    const std::size_t start = chain.size();
    for (Iterator p = first; p != last; ++p) {
        while (chain.size() >= start + 2) {
            const Vec2 &a = chain[chain.size() - 2], &b = chain.back();
            if (cross(b - a, *p - a) > tolerance * (*p - a).norm()) break;
            chain.pop_back();
        }
        chain.push_back(*p);
    }
    chain.pop_back();  // the last point begins the other chain
}

/// Size of a uniform cloud in the disc whose hull has on average `corners` corners: the asymptotic 3.3832 n^(1/3) (Renyi & Sulanke 1963) with a
/// correction fitted to means of 3000 hulls each (tests/unit/convex_polygon_test.cpp).
int disc_cloud_size(int corners) {
    const double v = corners;
    return std::max(3, static_cast<int>(std::lround(std::pow(v / 3.3832, 3) + 0.55 * v + 1.0)));
}

std::vector<Vec2> disc_cloud(int corners, RandomStream& random) {
    std::vector<Vec2> points;
    const auto count = static_cast<std::size_t>(disc_cloud_size(corners));
    points.reserve(count);
    while (points.size() < count) {
        const double x = random.uniform(-1, 1), z = random.uniform(-1, 1);
        if (x * x + z * z <= 1.0) points.emplace_back(x, z);
    }
    return points;
}

std::vector<Vec2> outline_points(const ShapeSettings& settings, RandomStream& random) {
    switch (settings.shape) {
        case BlockShape::Hull:
            return disc_cloud(settings.polygon_points, random);
        case BlockShape::Sharp:
            return disc_cloud(kSharpPoints, random);
        case BlockShape::Round:
            return disc_cloud(kRoundPoints, random);
        case BlockShape::Box:
            return {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        case BlockShape::Eota: {
            const double third = 1.0 / 3.0;
            return {{1, -third}, {1, third},   {third, 1},   {-third, 1},
                    {-1, third}, {-1, -third}, {-third, -1}, {third, -1}};
        }
        case BlockShape::Ellipsoid: {
            std::vector<Vec2> points;
            for (int k = 0; k < settings.polygon_points; ++k) {
                const double angle = 2.0 * std::numbers::pi * k / settings.polygon_points;
                points.emplace_back(std::cos(angle), std::sin(angle));
            }
            return points;
        }
        case BlockShape::File: {
            std::vector<Vec2> points;
            for (const Vec3& p : settings.file_points) points.emplace_back(p.head<2>());
            return points;
        }
    }
    return {};
}

/// Moves and stretches the points so that they fill the rectangle exactly.
void fill_rectangle(std::vector<Vec2>& points, const Vec2& size) {
    Box2 box;
    for (const Vec2& p : points) box.add(p);
    const Vec2 extent = box.max - box.min;
    if (points.empty() || !(extent.minCoeff() > 0.0))
        throw InputError("a block shape is flat: its points span no area in the plane of the 2D model");
    for (Vec2& p : points) p = ((p - 0.5 * (box.min + box.max)).array() * size.array() / extent.array()).matrix();
}

ConvexPolygon polygon_from_outline(const std::vector<Vec2>& outline, double mass) {
    const AreaProperties properties = area_properties(outline);
    ConvexPolygon polygon;
    polygon.mass = mass;
    polygon.area = properties.area;
    polygon.inertia = mass / properties.area * properties.moment;
    const auto count = static_cast<Eigen::Index>(outline.size());
    for (Eigen::ArrayXd* a : {&polygon.x, &polygon.z, &polygon.nx, &polygon.nz, &polygon.offset}) a->resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Vec2 p = outline[static_cast<std::size_t>(i)] - properties.centre;
        polygon.x[i] = p.x();
        polygon.z[i] = p.y();
        polygon.radius = std::max(polygon.radius, p.norm());
    }
    for (Eigen::Index k = 0; k < count; ++k) {
        const Vec2 a = polygon.vertex(k), side = polygon.vertex((k + 1) % count) - a;
        const Vec2 n = Vec2(side.y(), -side.x()).normalized();
        polygon.nx[k] = n.x();
        polygon.nz[k] = n.y();
        polygon.offset[k] = n.dot(a);
    }
    polygon.inner_radius = polygon.offset.minCoeff();
    return polygon;
}

}  // namespace

std::vector<Vec2> convex_outline(std::vector<Vec2> points) {
    for (const Vec2& p : points)
        if (!p.allFinite())
            throw InputError("a block shape has a point that is not finite: every coordinate must be a number");
    std::sort(points.begin(), points.end(),
              [](const Vec2& a, const Vec2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::vector<Vec2> outline;
    if (points.size() >= 3) {
        const double tolerance = kStraight * extent_of(points);
        outline.reserve(points.size() + 1);
        add_chain(points.begin(), points.end(), tolerance, outline);
        add_chain(points.rbegin(), points.rend(), tolerance, outline);
    }
    if (outline.size() < 3)
        throw InputError(
            "the " + std::to_string(points.size()) +
            " points of a block shape span no area: at least 3 points that do not lie on one line are needed");
    return outline;
}

AreaProperties area_properties(const std::vector<Vec2>& outline) {
    // Triangles between the first corner and every side; integral of |x|^2 over a triangle with one corner in the origin and the others a, b:
    // |a x b| / 12 (a.a + a.b + b.b).
    const Vec2 apex = outline.front();
    AreaProperties result;
    Vec2 first = Vec2::Zero();
    double second = 0.0;
    for (std::size_t k = 1; k + 1 < outline.size(); ++k) {
        const Vec2 a = outline[k] - apex, b = outline[k + 1] - apex;
        const double area = 0.5 * cross(a, b);
        result.area += area;
        first += area / 3.0 * (a + b);
        second += area / 6.0 * (a.dot(a) + a.dot(b) + b.dot(b));
    }
    const Vec2 centre = first / result.area;
    result.centre = apex + centre;
    result.moment = second - result.area * centre.squaredNorm();
    return result;
}

ConvexPolygon scaled_polygon(const ConvexPolygon& block, double factor) {
    ConvexPolygon b = block;
    for (Eigen::ArrayXd* lengths : {&b.x, &b.z, &b.offset}) *lengths *= factor;
    b.mass *= factor * factor * factor;
    b.area *= factor * factor;
    b.inertia *= std::pow(factor, 5);
    b.size *= factor;
    b.radius *= factor;
    b.inner_radius *= factor;
    return b;
}

ConvexPolygon make_polygon_from_points(const std::vector<Vec2>& points, double mass) {
    ConvexPolygon polygon = polygon_from_outline(convex_outline(points), mass);
    const double l1 = polygon.x.maxCoeff() - polygon.x.minCoeff(), l2 = polygon.z.maxCoeff() - polygon.z.minCoeff();
    polygon.size = {l1, l2, l2};
    return polygon;
}

ConvexPolygon make_polygon(const ShapeSettings& settings, const Vec3& size, double mass, RandomStream& random) {
    if (!(size.minCoeff() > 0.0) || !size.allFinite() || !(mass > 0.0) || !std::isfinite(mass))
        throw InputError("a block of " + std::to_string(mass) + " kg and " + std::to_string(size.x()) + " x " +
                         std::to_string(size.y()) + " x " + std::to_string(size.z()) +
                         " m is impossible: mass and all three lengths must be positive");
    std::vector<Vec2> points = outline_points(settings, random);
    fill_rectangle(points, size.head<2>());
    ConvexPolygon polygon = polygon_from_outline(convex_outline(std::move(points)), mass);
    polygon.size = size;
    return polygon;
}

}  // namespace scree
