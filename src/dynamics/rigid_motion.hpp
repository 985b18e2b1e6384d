// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/state.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

/// Mass and principal moments of inertia.
template <int Dim>
struct BodyInertia {
    double mass = 1.0;                                            ///< [kg]
    typename Space<Dim>::Spin moment = Space<Dim>::Spin::Ones();  ///< principal moments [kg m^2]
};

inline Mat3 rotation_matrix(const Quat& q) {
    return q.toRotationMatrix();
}
inline Mat2 rotation_matrix(double angle) {
    Mat2 r;
    r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    return r;
}

/// Cosine of an angle, and sine over the angle, from its square: the series are exact to rounding up to 0.2 rad.
struct CosineAndSine {
    double cosine, sine_over_angle;
};
inline CosineAndSine of_squared_angle(double square) {
    if (square < 0.04) {
        auto term = [&](double n, double rest) { return 1.0 - square * (1.0 / n) * rest; };
        return {term(2, term(12, term(30, term(56, term(90, 1.0))))),
                term(6, term(20, term(42, term(72, term(110, 1.0)))))};
    }
    const double angle = std::sqrt(square);
    return {std::cos(angle), std::sin(angle) / angle};
}

/// Rotation by the exponential map of a body-frame rotation vector [rad].
inline Quat turned(const Quat& q, const Vec3& angle) {
    const auto [c, over] = of_squared_angle(0.25 * angle.squaredNorm());  // of half the angle
    const double s = 0.5 * over;
    Quat result = q * Quat(c, s * angle.x(), s * angle.y(), s * angle.z());
    result.coeffs() *= 1.5 - 0.5 * result.squaredNorm();  // of a length that is one but for rounding
    return result;
}
inline double turned(double angle, const Space<2>::Spin& by) {
    return angle + by[0];
}

/// How a block with this orientation and rotation matrix turns by an angle: the matrix then, and the rotation from now to then in the local frame.
template <int Dim>
struct Turn {
    typename Space<Dim>::Rotation then, turn;
};
inline Turn<3> turn_by(const Quat& q, const Mat3& now, const Vec3& angle) {
    const Mat3 then = rotation_matrix(turned(q, angle));
    return {then, then * now.transpose()};
}
inline Turn<2> turn_by(double, const Mat2& now, const Space<2>::Spin& angle) {
    const auto [c, over] = of_squared_angle(angle[0] * angle[0]);
    const double s = over * angle[0];
    Mat2 turn;
    turn << c, -s, s, c;
    return {turn * now, turn};
}

inline bool same(const Quat& a, const Quat& b) {
    return a.coeffs() == b.coeffs();
}
inline bool same(double a, double b) {
    return a == b;
}

/// Gyroscopic torque I Omega x Omega, body frame [N m] (B&A eq. 5).
inline Vec3 gyroscopic_torque(const Vec3& moment, const Vec3& spin) {
    return moment.cwiseProduct(spin).cross(spin);
}

/// Rotational part of one linearised theta = 1/2 step: (I - h/2 dtau/dOmega)^-1 and the spin without contact impulses.
inline Mat3 spin_response(const Vec3& moment, const Vec3& spin, double h) {
    // the torque about the first axis is (I_2 - I_3) w_2 w_3, the others follow round
    const double k1 = 0.5 * h * (moment[1] - moment[2]), k2 = 0.5 * h * (moment[2] - moment[0]),
                 k3 = 0.5 * h * (moment[0] - moment[1]);
    const Vec3 row1(moment[0], -k1 * spin[2], -k1 * spin[1]), row2(-k2 * spin[2], moment[1], -k2 * spin[0]),
        row3(-k3 * spin[1], -k3 * spin[0], moment[2]);
    const Vec3 column = row2.cross(row3);
    const double share = 1.0 / row1.dot(column);
    Mat3 inverse;
    inverse << share * column, share * row3.cross(row1), share * row1.cross(row2);
    return inverse;
}
inline Eigen::Matrix<double, 1, 1> spin_response(const Space<2>::Spin& moment, const Space<2>::Spin&, double) {
    return moment.cwiseInverse();
}

inline Vec3 free_spin(const Vec3& moment, const Vec3& spin, const Mat3& response, double h) {
    return spin + h * (response * gyroscopic_torque(moment, spin));
}
inline Space<2>::Spin free_spin(const Space<2>::Spin&, const Space<2>::Spin& spin, const Eigen::Matrix<double, 1, 1>&,
                                double) {
    return spin;
}

/// Angle that a step of free rotation turns at most: beyond it the expansions below lose their accuracy [rad].
inline constexpr double kLargestTurn = 0.2;

/// Torque-free rotation over dt: Runge-Kutta 4 for Omega, fourth-order Magnus expansion for the orientation (Iserles & Norsett 1999), in
/// steps of at most `longest` [s], shorter where the body spins fast.
inline void rotate_freely(const Vec3& moment, double longest, double dt, Quat& orientation, Vec3& spin) {
    const Vec3 mobility = moment.cwiseInverse();
    auto rate = [&](const Vec3& w) -> Vec3 { return gyroscopic_torque(moment, w).cwiseProduct(mobility); };
    while (dt > 0.0) {
        const double steps = std::ceil(dt * std::max(1.0 / longest, spin.norm() / kLargestTurn) - 1e-9);
        const double h = steps > 1.0 ? dt / steps : dt;
        dt = steps > 1.0 ? dt - h : 0.0;
        const Vec3 k1 = rate(spin), k2 = rate(spin + 0.5 * h * k1), k3 = rate(spin + 0.5 * h * k2),
                   k4 = rate(spin + h * k3);
        const Vec3 next = spin + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        const Vec3 middle = 0.5 * (spin + next) + h / 8.0 * (k1 - rate(next));
        const Vec3 angle = h / 6.0 * (spin + 4.0 * middle + next) + h * h / 12.0 * middle.cross(next - spin);
        orientation = turned(orientation, angle);
        spin = next;
    }
}
inline void rotate_freely(const Space<2>::Spin&, double, double dt, double& orientation, Space<2>::Spin& spin) {
    orientation += spin[0] * dt;
}

template <int Dim>
double rotation_energy(const BodyInertia<Dim>& body, const typename Space<Dim>::Spin& spin) {
    return 0.5 * spin.dot(body.moment.cwiseProduct(spin));
}
template <int Dim>
double kinetic_energy(const BodyInertia<Dim>& body, const BlockState<Dim>& state) {
    return 0.5 * body.mass * state.velocity.squaredNorm() + rotation_energy<Dim>(body, state.spin);
}

}  // namespace scree
