// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/hull_contacts.hpp"
#include "dynamics/rigid_motion.hpp"
#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/soil.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/surface.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <functional>
#include <memory>
#include <numbers>
#include <vector>

namespace scree::test {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Density of the reference bodies [kg/m^3].
inline constexpr double kRockDensity = 2500.0;

/// Grid surface over [-half, half]^2 with heights from a function of the plan position.
inline std::unique_ptr<Surface> grid_terrain(double half, double cell, const std::function<double(double, double)>& height) {
    GridShape shape;
    shape.columns = shape.rows = static_cast<int>(std::lround(2.0 * half / cell)) + 1;
    shape.cell = cell;
    shape.origin = Vec2::Constant(-half - 0.5 * cell);
    Grid<double> heights(shape);
    for (int j = 0; j < shape.rows; ++j)
        for (int i = 0; i < shape.columns; ++i) heights.at(i, j) = height(shape.centre(i, j).x(), shape.centre(i, j).y());
    std::vector<SoilId> soil(grid_facet_count(shape), 0);
    return make_grid_surface(std::move(heights), std::move(soil));
}

/// The plane z = -tan(slope) x of the reference solutions.
inline std::unique_ptr<Surface> inclined_plane(double slope, double half = 40.0, double cell = 1.0) {
    return grid_terrain(half, cell, [=](double x, double) { return -std::tan(slope) * x; });
}

/// Plane frame to local frame: x down the slope, z along its normal.
inline Quat plane_frame(double slope) { return Quat(Eigen::AngleAxisd(slope, Vec3::UnitY())); }

/// At rest in the plane frame at this height above the plane's origin.
inline BlockState<3> on_plane(double slope, double height) {
    BlockState<3> s;
    s.orientation = plane_frame(slope);
    s.position = s.orientation * Vec3(0.0, 0.0, height);
    return s;
}

inline std::vector<Vec3> box_points(const Vec3& size) {
    std::vector<Vec3> points;
    for (int k = 0; k < 8; ++k) points.push_back({(k & 1 ? 0.5 : -0.5) * size.x(), (k & 2 ? 0.5 : -0.5) * size.y(), (k & 4 ? 0.5 : -0.5) * size.z()});
    return points;
}

/// A block made from points, with the rotation from the axes of the points to its body frame, which the principal axes are free to choose.
struct FramedBlock {
    ConvexBlock block;
    Quat to_body = Quat::Identity();

    FramedBlock(const std::vector<Vec3>& points, double mass) : block(make_block_from_points(points, mass)) {
        const ConvexHull hull = convex_hull(points);  // the block keeps the order of its vertices
        Eigen::Matrix3Xd from(3, hull.vertices.size()), to(3, hull.vertices.size());
        for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
            from.col(static_cast<Eigen::Index>(i)) = hull.vertices[i];
            to.col(static_cast<Eigen::Index>(i)) = block.vertex(i);
        }
        const Mat3 rotation = Eigen::umeyama(from, to, false).topLeftCorner<3, 3>();
        to_body = Quat(rotation).normalized();
    }

    BodyInertia<3> inertia() const { return {block.mass, block.inertia}; }
    /// From a state whose orientation and spin refer to the axes of the points, and back.
    BlockState<3> to_block(BlockState<3> s) const {
        s.orientation = s.orientation * to_body.conjugate();
        s.spin = to_body * s.spin;
        return s;
    }
    BlockState<3> to_points(BlockState<3> s) const {
        s.orientation = s.orientation * to_body;
        s.spin = to_body.conjugate() * s.spin;
        return s;
    }
};

inline FramedBlock cube(double side = 1.0) { return {box_points(Vec3::Constant(side)), kRockDensity * side * side * side}; }

/// Contacts between a sphere and a plane through the origin, for the Engine.
class SphereOnPlane {
public:
    SphereOnPlane(double radius, const Vec3& normal) : radius_(radius), normal_(normal) {}

    void detect(const Vec3& position, const Mat3&, double reach, std::vector<Contact<3>>& contacts) const {
        contacts.clear();
        Contact<3> c;
        c.gap = normal_.dot(position) - radius_;
        c.normal = normal_;
        c.arm = -radius_ * normal_;
        if (c.gap <= reach) contacts.push_back(c);
    }
    double clearance(const Vec3& position, const Mat3&) const { return normal_.dot(position) - radius_; }
    double free_time(const BlockState<3>& s, double, double gravity, double& gap) const {
        gap = clearance(s.position, Mat3::Identity());
        const double rate = normal_.dot(s.velocity), fall = gravity * normal_.z();
        return gap > 0.0 ? 2.0 * gap / (std::sqrt(rate * rate + 2.0 * fall * gap) - rate) : 0.0;
    }
    bool over_terrain(const Vec3&) const { return true; }
    bool beyond_rim() const { return false; }
    double radius() const { return radius_; }
    double inner_radius() const { return radius_; }

private:
    double radius_;
    Vec3 normal_;
};

inline BodyInertia<3> sphere_inertia(double radius) {
    const double mass = kRockDensity * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    return {mass, Vec3::Constant(0.4 * mass * radius * radius)};
}

}  // namespace scree::test
