// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/effects/pieces.hpp"
#include "dynamics/engine.hpp"

#include "scree/base/units.hpp"

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

/// Contacts between a ball (a disc in 2D) and a slope, for the Engine.
template <int Dim>
class BallContacts {
public:
    using Vec = typename Space<Dim>::Vec;
    using Rotation = typename Space<Dim>::Rotation;
    BallContacts(double radius, const Slope<Dim>& slope) : radius_(radius), normal_(slope.normal()) {}

    void detect(const Vec& position, const Rotation&, double reach, std::vector<Contact<Dim>>& contacts) const {
        contacts.clear();
        Contact<Dim> c;
        c.gap = normal_.dot(position) - radius_;
        c.normal = normal_;
        c.arm = -radius_ * normal_;
        if (c.gap <= reach) contacts.push_back(c);
    }
    double free_time(const BlockState<Dim>& s, double, double gravity, const Vec& drag, double& gap) const {
        gap = normal_.dot(s.position) - radius_;
        const double rate = normal_.dot(s.velocity), fall = gravity * normal_[Dim - 1] - normal_.dot(drag);
        const double root = rate * rate + 2.0 * fall * gap;
        if (gap <= 0.0) return 0.0;
        const double closing = root >= 0.0 ? std::sqrt(root) - rate : 0.0;
        return closing > 0.0 ? 2.0 * gap / closing : kInfinity;
    }
    bool over_terrain(const Vec&) const { return true; }
    bool beyond_rim() const { return false; }
    bool buried(const Vec&) const { return false; }
    double radius() const { return radius_; }
    double inner_radius() const { return radius_; }

private:
    double radius_;
    Vec normal_;
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
            BallContacts<Dim> contacts(size, slope);
            Engine<Dim, BallContacts<Dim>> engine(piece, contacts, {&soil, 1}, limited, sink, &at_work);
            return engine.run(start, from);
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
