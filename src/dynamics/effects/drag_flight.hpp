// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/state.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

/// Deceleration (linear + quadratic |v|) v.
struct Drag {
    double linear = 0.0;     ///< [1/s]
    double quadratic = 0.0;  ///< [1/m]
    bool none() const { return linear == 0.0 && quadratic == 0.0; }
    double rate(double speed) const { return linear + quadratic * speed; }
    Drag& operator+=(const Drag& o) {
        linear += o.linear;
        quadratic += o.quadratic;
        return *this;
    }
};

/// A stretch of flight with constant acceleration.
template <int Dim>
struct FlightArc {
    typename Space<Dim>::Vec acceleration;
    double duration = kInfinity;  ///< [s]
};

/// Flight under gravity and drag as two parabolas of equal duration, which everything downstream can follow exactly: detection bounds, recorder, energy.
/// Their accelerations are such that position and velocity at the end are those of a Runge-Kutta 4 step; in the middle the position is that of the
/// true path to third order, too, and the velocity off by jerk T^2 / 24. Where drag is so strong that this would take steps below kBrief (pebbles in a
/// forest), one parabola takes the velocity to that of the closed form for a constant rate. Drag never feeds energy: on each parabola its part of the
/// acceleration opposes the velocity, or is left out.
template <int Dim>
class DragFlight {
public:
    using Vec = typename Space<Dim>::Vec;
    using State = BlockState<Dim>;
    FlightArc<Dim> first, second;  ///< the second may have no duration

    DragFlight(const Drag& drag, const Vec& gravity, const State& s, double time) {
        second.duration = 0.0;
        if (drag.none())
            first = {gravity, time};
        else if (drag.rate(s.velocity.norm()) * time > kStrong)
            damp(drag.rate(s.velocity.norm()), gravity, s.velocity, time);
        else
            step(drag, gravity, s.velocity, time);
    }

    double duration() const { return first.duration + second.duration; }
    Vec position(const State& s, double t) const {
        const double t1 = std::min(t, first.duration), t2 = t - t1;
        const Vec there = s.position + t1 * s.velocity + 0.5 * t1 * t1 * first.acceleration;
        if (t2 <= 0.0) return there;
        return there + t2 * (s.velocity + t1 * first.acceleration) + 0.5 * t2 * t2 * second.acceleration;
    }

    /// How long both parabolas may be together: the velocity in the middle within kSpeedError, and turning by little while it is slow. Under strong drag:
    /// so long that the path is off by kPathError at most.
    static double longest(const Drag& drag, const Vec& gravity, const Vec& velocity) {
        const double g = gravity.norm(), speed = velocity.norm(), fastest = (1.0 + kTurn) * speed;
        const double rate = std::max(drag.rate(fastest), 1e-9), jerk = 2.0 * rate * (g + rate * fastest);
        const double time = std::min(
            {kLongest, std::sqrt(24.0 * kSpeedError / jerk), kRateTime / rate, std::max(kTurn * speed / g, kBrief)});
        if (time >= kBrief) return time;
        const double to_lose = (velocity - gravity / drag.rate(speed)).norm();
        return std::max(time, std::min(kLongest, 2.0 * kPathError / to_lose));
    }

    static constexpr double kLongest = 0.1;       ///< [s]
    static constexpr double kUndisturbed = 10.0;  ///< where nothing acts nor is near: longer than flights are [s]
    static constexpr double kBrief = 1e-3;        ///< [s]
    static constexpr double kSpeedError = 1e-3;   ///< [m/s]
    static constexpr double kPathError = 1e-3;    ///< [m]
    static constexpr double kRateTime = 0.2;      ///< drag rate times duration at most [-]
    static constexpr double kStrong = 0.5;        ///< beyond this rate times duration drag is strong [-]
    static constexpr double kTurn = 0.2;          ///< change of velocity by gravity over the speed [-]

private:
    void step(const Drag& drag, const Vec& gravity, const Vec& v, double time) {
        const auto pull = [&](const Vec& u) -> Vec { return gravity - drag.rate(u.norm()) * u; };
        const Vec k1 = pull(v), k2 = pull(v + 0.5 * time * k1), k3 = pull(v + 0.5 * time * k2),
                  k4 = pull(v + time * k3);
        const Vec mean = (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;  // of the acceleration
        const Vec bend = (k1 + k2 + k3) / 3.0;                   // x = x0 + v t + bend t^2 / 2
        const Vec a1 = 2.0 * bend - mean, a2 = 2.0 * mean - a1;
        const Vec middle = v + 0.5 * time * a1, end = middle + 0.5 * time * a2;
        const auto opposes = [&](const Vec& a, const Vec& from, const Vec& to) {
            return (a - gravity).dot(from) <= 0.0 && (a - gravity).dot(to) <= 0.0;
        };
        if (opposes(a1, v, middle) && opposes(a2, middle, end)) {
            first = {a1, 0.5 * time};
            second = {a2, 0.5 * time};
            return;
        }
        // where the velocity turns round, at the top of a steep throw: one short parabola
        const double brief = std::min(time, kBrief);
        first = {k1, brief};
        if (!opposes(k1, v, v + brief * k1)) first.acceleration = gravity;
    }

    /// The work of drag on a parabola is that of its part of the acceleration along the mean velocity.
    void damp(double rate, const Vec& gravity, const Vec& v, double time) {
        for (int k = 0; k < kHalvings; ++k, time *= 0.5) {
            const Vec lost = -std::expm1(-rate * time) * (v - gravity / rate);
            first = {-lost / time, time};
            if ((first.acceleration - gravity).dot(v - 0.5 * lost) <= 0.0) return;
        }
        first = {gravity, time};
    }
    static constexpr int kHalvings = 8;
};

}  // namespace scree
