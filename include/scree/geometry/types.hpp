// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <limits>

namespace scree {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;
/// Unit quaternion, body to local frame.
using Quat = Eigen::Quaterniond;

/// Index of a soil in the site's table of soils.
using SoilId = std::uint8_t;
inline constexpr int kMaxSoils = 250;

/// Twice the area of the triangle 0, a, b: positive if b is on the left of a.
inline double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Axis-parallel rectangle in plan view, local frame [m].
struct Box2 {
    Vec2 min{kInfinity, kInfinity};    ///< lower left corner [m]
    Vec2 max{-kInfinity, -kInfinity};  ///< upper right corner [m]

    bool empty() const { return !(min.x() <= max.x() && min.y() <= max.y()); }
    bool contains(const Vec2& p) const {
        return p.x() >= min.x() && p.x() <= max.x() && p.y() >= min.y() && p.y() <= max.y();
    }
    bool overlaps(const Box2& other) const {
        return min.x() <= other.max.x() && other.min.x() <= max.x() && min.y() <= other.max.y() &&
               other.min.y() <= max.y();
    }
    void add(const Vec2& p) {
        min = min.cwiseMin(p);
        max = max.cwiseMax(p);
    }
    void add(const Box2& other) {
        min = min.cwiseMin(other.min);
        max = max.cwiseMax(other.max);
    }
    Box2 grown(double margin) const { return {min - Vec2::Constant(margin), max + Vec2::Constant(margin)}; }
};

}  // namespace scree
