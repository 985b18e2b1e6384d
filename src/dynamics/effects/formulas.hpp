// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

/// The formulas of the catalogue, one function each, SI units. Sources stand in the catalogue.
namespace scree::effect_formula {

/// e(v_n) of Pfeiffer & Bowen 1989 [-]; normal speed v [m/s].
inline double pfeiffer_bowen(double restitution, double v, double half_speed) {
    const double ratio = v / half_speed;
    return restitution / (1.0 + ratio * ratio);
}

/// e(v_n) = e h / (v + h) [-].
inline double half_speed(double restitution, double v, double h) {
    return restitution / (1.0 + v / h);
}

/// e(m), at most 1 [-]; mass [kg].
inline double restitution_of_mass(double restitution, double mass, double reference, double exponent) {
    return std::min(1.0, restitution * std::pow(mass / reference, exponent));
}

/// Leine et al. 2014, eq. 46 [-]; s: way in contact [m], growth [1/m].
inline double slip_friction(double friction, double s, double ratio, double growth) {
    return friction * (1.0 + (ratio - 1.0) * 2.0 / std::numbers::pi * std::atan(growth * s));
}

/// Lucas et al. 2014 [-]; u: sliding speed, or that of the block [m/s].
inline double friction_of_speed(double friction, double u, double limit, double speed) {
    return friction * (limit + (1.0 - limit) / (1.0 + u / speed));
}

/// mu_r (1 + (v / v0)^q) [m]; speed [m/s].
inline double rolling_of_speed(double rolling, double v, double v0, double exponent) {
    return rolling * (1.0 + std::pow(v / v0, exponent));
}

/// mu_r (L / L0)^p [m]; length [m].
inline double rolling_of_size(double rolling, double length, double reference, double exponent) {
    return rolling * std::pow(length / reference, exponent);
}

/// Depth of a scar, Lu et al. 2019 [m]; mass [kg], modulus [Pa], normal speed [m/s]. Their formula takes kN/m^2.
inline double scar_depth(double mass, double modulus, double v) {
    return 0.1 * std::cbrt(mass) * std::pow(modulus / 1000.0, -0.4) * std::pow(v, 0.8);
}

/// What a sphere that is sunk in by `depth` shows in front: the circle's segment [m^2]; radius [m].
inline double scar_area(double radius, double depth) {
    const double d = std::clamp(depth, 0.0, 2.0 * radius);
    return radius * radius * std::acos(1.0 - d / radius) - (radius - d) * std::sqrt(d * (2.0 * radius - d));
}

/// Energy that the trunk of a tree takes at most, Dorren & Berger 2006 [J]; diameter at breast height [m].
inline double tree_capacity(double diameter, double strength) {
    return strength * 38.7 * std::pow(100.0 * diameter, 2.31);
}

/// Share of it that an impact at the relative offset x from the trunk's axis takes, Dorren & Berger 2006 [-].
inline double tree_share(double x) {
    return std::clamp(-0.046 + (0.98 + 0.046) / (1.0 + std::pow(10.0, -8.007 * (0.58 - x))), 0.0, 1.0);
}

}  // namespace scree::effect_formula
