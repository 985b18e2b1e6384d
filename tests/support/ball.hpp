// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/effects/pieces.hpp"

#include "scree/base/units.hpp"
#include "support/ball_on_plane.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace scree::test {

/// A unit vector of the plane of motion: along x, and up.
template <int Dim>
typename Space<Dim>::Vec in_plane(double x, double z) {
    typename Space<Dim>::Vec v = Space<Dim>::Vec::Zero();
    v[0] = x;
    v[Dim - 1] = z;
    return v;
}

/// A plane through the origin that falls along x, with one soil (number 0).
template <int Dim>
struct Slope final : EffectGround<Dim> {
    using Vec = typename Space<Dim>::Vec;
    double angle;
    explicit Slope(double slope) : angle(slope) {}
    Vec normal() const { return in_plane<Dim>(std::sin(angle), std::cos(angle)); }
    Vec down() const { return in_plane<Dim>(std::cos(angle), -std::sin(angle)); }
    double height(const Vec& p) const override { return -std::tan(angle) * p[0]; }
    int soil(const Vec&) const override { return 0; }
};

/// A ball on a slope under effects. Its edges are those of the box around it: L is the diameter.
template <int Dim>
struct Ball {
    using State = BlockState<Dim>;
    double radius = 0.5;
    double mass = 1000.0;
    Slope<Dim> slope{0.0};
    Soil soil{"slope", 0.0, 0.5, 0.0};
    DynamicsSettings settings;
    std::vector<Effect> effects;
    std::uint64_t block = 0;

    Ball() {
        settings.solver.tolerance = 1e-12;
        settings.rest_time = 1e6;
    }
    BodyInertia<Dim> body() const {
        return {mass, Space<Dim>::Spin::Constant((Dim == 3 ? 0.4 : 0.5) * mass * radius * radius)};
    }
    /// I / (m R^2)
    static double roundness() { return Dim == 3 ? 0.4 : 0.5; }

    /// Centre of mass at a height above the slope, at a way down from the origin.
    State at(double way, double height) const {
        State s;
        s.position = way * slope.down() + (radius + height) * slope.normal();
        return s;
    }
    /// Moving down the slope; rolling if `rolls`.
    State sliding(double way, double speed, bool rolls = false) const {
        State s = at(way, 0.0);
        s.velocity = speed * slope.down();
        if (rolls) s.spin[Dim == 3 ? 1 : 0] = (Dim == 3 ? 1.0 : -1.0) * speed / radius;
        return s;
    }
    TrajectoryEnd<Dim> run(const State& release, double time, MotionSink<Dim>* sink = nullptr) const {
        DynamicsSettings limited = settings;
        limited.time_limit = time;
        BlockEffects<Dim> at_work({effects, 7, block}, {mass, 2.0 * radius}, slope, settings.gravity);
        double size = radius;
        BodyInertia<Dim> piece = body();
        return follow_pieces<Dim>(at_work, release, [&](double factor, const State& start, double from) {
            size *= factor;
            piece.mass *= factor * factor * factor;
            piece.moment *= std::pow(factor, 5);
            return run_on_plane<Dim>(piece, {size, slope.normal()}, {&soil, 1}, limited, start, sink, &at_work, from);
        });
    }
};

/// One effect with values by name.
inline Effect effect_with(EffectKind kind, std::initializer_list<std::pair<const char*, double>> values) {
    Effect effect = make_effect(kind);
    for (const auto& [key, value] : values) effect.set(key, value);
    return effect;
}

/// The effect between two values of x only.
inline Effect between(Effect effect, double from, double to) {
    effect.place.limit_to({Polygon{{{from, -1e3}, {to, -1e3}, {to, 1e3}, {from, 1e3}}, {}}});
    effect.place.reaches = std::vector<Stretch>{{from, to}};
    return effect;
}

/// A line across the way at x.
inline Effect across(Effect effect, double x) {
    effect.place.lines = {Points{{x, -1e3, kNaN}, {x, 1e3, kNaN}}};
    effect.place.stations = {x};
    return effect;
}

}  // namespace scree::test
