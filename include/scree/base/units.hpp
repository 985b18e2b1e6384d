// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>

/// Units and frames, the whole convention.
///
/// SI and radians everywhere inside; files carry degrees with the suffix _deg and energies with _kj.
/// Map frame:     easting, northing, height in the DTM's projected CRS [m].
/// Local frame:   the same axes minus a rounded origin near the site (LocalFrame); the core sees no other.
/// Body frame:    origin in the centre of mass, axes along the principal axes of inertia.
/// Contact frame: (N, T1, T2) orthonormal, N pointing from the terrain into the block.
namespace scree {

/// Standard gravity [m/s^2] (CGPM 1901).
inline constexpr double kStandardGravity = 9.80665;

/// Energy in files from that inside [J/kJ].
inline constexpr double kJoulePerKj = 1000.0;

inline constexpr double radians_from_degrees(double degrees) {
    return degrees * std::numbers::pi / 180.0;
}
inline constexpr double degrees_from_radians(double radians) {
    return radians * 180.0 / std::numbers::pi;
}

}  // namespace scree
