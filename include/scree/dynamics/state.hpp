// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

namespace scree {

/// What differs between the plane and space. Everything else of the mechanics is written once for both.
template <int Dim>
struct Space;

template <>
struct Space<3> {
    using Vec = Vec3;
    using Spin = Vec3;         ///< angular velocity or moment, body frame
    using Orientation = Quat;  ///< body to local frame
    using Rotation = Mat3;
    static Orientation identity() { return Quat::Identity(); }
};

/// (x, z) with the angle counted from x to z.
template <>
struct Space<2> {
    using Vec = Vec2;
    using Spin = Eigen::Matrix<double, 1, 1>;
    using Orientation = double;  ///< angle [rad]
    using Rotation = Mat2;
    static Orientation identity() { return 0.0; }
};

/// Motion of a rigid block.
template <int Dim>
struct BlockState {
    typename Space<Dim>::Vec position = Space<Dim>::Vec::Zero();            ///< centre of mass, local frame [m]
    typename Space<Dim>::Orientation orientation = Space<Dim>::identity();  ///< body to local frame [-; rad in 2D]
    typename Space<Dim>::Vec velocity = Space<Dim>::Vec::Zero();  ///< of the centre of mass, local frame [m/s]
    typename Space<Dim>::Spin spin = Space<Dim>::Spin::Zero();    ///< angular velocity, BODY frame [rad/s]
};

}  // namespace scree
