// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/hull_contacts.hpp"
#include "dynamics/rigid_motion.hpp"

#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/soil.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/feature.hpp"
#include "scree/geometry/surface.hpp"

#include <Eigen/Geometry>

#include <functional>
#include <memory>
#include <numbers>
#include <vector>

namespace scree::test {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Density of the reference bodies [kg/m^3].
inline constexpr double kRockDensity = 2500.0;

/// Grid surface over [-half, half]^2 with heights from a function of the plan position.
std::unique_ptr<Surface> grid_terrain(double half, double cell, const std::function<double(double, double)>& height);

/// The plane z = -tan(slope) x of the reference solutions.
inline std::unique_ptr<Surface> inclined_plane(double slope, double half = 40.0, double cell = 1.0) {
    return grid_terrain(half, cell, [=](double x, double) { return -std::tan(slope) * x; });
}

/// Plane frame to local frame: x down the slope, z along its normal.
inline Quat plane_frame(double slope) {
    return Quat(Eigen::AngleAxisd(slope, Vec3::UnitY()));
}

/// At rest in the plane frame at this height above the plane's origin.
inline BlockState<3> on_plane(double slope, double height) {
    BlockState<3> s;
    s.orientation = plane_frame(slope);
    s.position = s.orientation * Vec3(0.0, 0.0, height);
    return s;
}

inline std::vector<Vec3> box_points(const Vec3& size) {
    std::vector<Vec3> points;
    for (int k = 0; k < 8; ++k)
        points.push_back(
            {(k & 1 ? 0.5 : -0.5) * size.x(), (k & 2 ? 0.5 : -0.5) * size.y(), (k & 4 ? 0.5 : -0.5) * size.z()});
    return points;
}

/// A block made from points, with the rotation from the axes of the points to its body frame, which the principal axes are free to choose.
struct FramedBlock {
    ConvexBlock block;
    Quat to_body = Quat::Identity();

    FramedBlock(const std::vector<Vec3>& points, double mass);

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

inline FramedBlock cube(double side = 1.0) {
    return {box_points(Vec3::Constant(side)), kRockDensity * side * side * side};
}

/// Release features. Their numbers, from 11, are not their places in the layer.
inline FeatureLayer release_layer(std::vector<Geometry> geometries) {
    FeatureLayer layer;
    layer.name = "release";
    for (Geometry& g : geometries)
        layer.features.push_back({static_cast<std::int64_t>(layer.features.size()) + 11, std::move(g), {}});
    return layer;
}

}  // namespace scree::test
