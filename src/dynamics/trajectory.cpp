// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/dynamics/trajectory.hpp"

#include "dynamics/effects/pieces.hpp"
#include "dynamics/engine.hpp"
#include "dynamics/hull_contacts.hpp"
#include "dynamics/plane_contacts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace scree {

namespace {

/// Exponent and first bit of the mantissa of a double: a number for every half of an octave.
constexpr std::int64_t half_octave(double d) {
    return static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(d) >> 51);
}
constexpr double end_of_half_octave(std::int64_t k) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(k + 1) << 51);
}
constexpr double kLeastPenetration = 0x1p-20;  ///< where the bins begin [m]

/// Step of the search for a free place, as a share of the block's thickness: a crest does not fit between two places [-].
constexpr double kClearingStep = 0.5;
/// Farther up no block is looked for a free place [m].
constexpr double kHighestLift = 1e4;
/// The lift is found to a tenth of the gap, and to this at least [m].
constexpr double kLeastLift = 1e-9;

class SurfaceGround final : public EffectGround<3> {
public:
    explicit SurfaceGround(const Surface& surface) : surface_(surface) {}
    double height(const Vec3& position) const override { return surface_.height(position.head<2>()); }
    int soil(const Vec3& position) const override {
        std::array<Vec3, 3> corners;
        SoilId soil = 0;
        const std::int64_t facet = surface_.facet_at(position.head<2>());
        return facet >= 0 && surface_.facet(facet, corners, soil) ? soil : -1;
    }

private:
    const Surface& surface_;
};

class LineGround final : public EffectGround<2> {
public:
    explicit LineGround(const GroundLine& line) : line_(line) {}
    double height(const Vec2& position) const override { return line_.height(position.x()); }
    int soil(const Vec2& position) const override {
        return line_.contains(position.x()) ? line_.reach(line_.reach_at(position.x())).soil : -1;
    }

private:
    const GroundLine& line_;
};

bool any_on_motion(const EffectInput& input) {
    return std::any_of(input.effects.begin(), input.effects.end(),
                       [](const Effect& e) { return acts_on_motion(e.kind); });
}

}  // namespace

void TrajectoryCounters::add_penetration(double depth) {
    largest_penetration = std::max(largest_penetration, depth);
    const std::int64_t bin = half_octave(std::max(depth, 0.0)) - half_octave(kLeastPenetration);
    ++penetration[static_cast<std::size_t>(std::clamp<std::int64_t>(bin, 0, std::ssize(penetration) - 1))];
}

void TrajectoryCounters::merge(const TrajectoryCounters& o) {
    contact_steps += o.contact_steps;
    shortened_steps += o.shortened_steps;
    impacts += o.impacts;
    flight_evaluations += o.flight_evaluations;
    contact_problems += o.contact_problems;
    unconverged_problems += o.unconverged_problems;
    restitution_capped += o.restitution_capped;
    rested_turning += o.rested_turning;
    energy_capped += o.energy_capped;
    largest_rise_taken_back = std::max(largest_rise_taken_back, o.largest_rise_taken_back);
    largest_energy_rise = std::max(largest_energy_rise, o.largest_energy_rise);
    largest_penetration = std::max(largest_penetration, o.largest_penetration);
    crossings_struck += o.crossings_struck;
    breaks += o.breaks;
    for (std::size_t k = 0; k < penetration.size(); ++k) penetration[k] += o.penetration[k];
}

double TrajectoryCounters::penetration_quantile(double share) const {
    std::int64_t total = 0;
    for (const std::int64_t n : penetration) total += n;
    std::int64_t sum = 0;
    for (std::size_t k = 0; k < penetration.size(); ++k) {
        sum += penetration[k];
        if (static_cast<double>(sum) >= share * static_cast<double>(total))
            return end_of_half_octave(half_octave(kLeastPenetration) + static_cast<std::int64_t>(k));
    }
    return 0.0;
}

namespace {

TrajectoryEnd<3> simulate_piece(const ConvexBlock& block, const BlockState<3>& start, double time,
                                const Surface& surface, std::span<const Soil> soils, const DynamicsSettings& settings,
                                MotionSink<3>* sink, BlockEffects<3>* effects) {
    const BodyInertia<3> body{block.mass, block.inertia};
    HullContacts contacts(block, surface, settings.vertices_only, settings.mode == SteppingMode::MoreauJean);
    return run_block(body, contacts, soils, settings, sink, effects, start, time);
}

TrajectoryEnd<2> simulate_piece(const ConvexPolygon& block, const BlockState<2>& start, double time,
                                const GroundLine& ground, std::span<const Soil> soils, const DynamicsSettings& settings,
                                MotionSink<2>* sink, BlockEffects<2>* effects) {
    const BodyInertia<2> body{block.mass, Space<2>::Spin(block.inertia)};
    PlaneContacts contacts(block, ground, settings.vertices_only, settings.mode == SteppingMode::MoreauJean);
    return run_block(body, contacts, soils, settings, sink, effects, start, time);
}

ConvexBlock scaled(const ConvexBlock& block, double factor) {
    return scaled_block(block, factor);
}
ConvexPolygon scaled(const ConvexPolygon& block, double factor) {
    return scaled_polygon(block, factor);
}

/// The whole block or, where it breaks, piece after piece.
template <int Dim, class Block, class Terrain, class Ground>
TrajectoryEnd<Dim> simulate_pieces(const Block& block, const BlockState<Dim>& release, const Terrain& terrain,
                                   const Ground& ground, std::span<const Soil> soils, const DynamicsSettings& settings,
                                   MotionSink<Dim>* sink, const EffectInput& effects) {
    BlockEffects<Dim> at_work(effects, effect_body(block), ground, settings.gravity);
    Block piece = block;
    return follow_pieces<Dim>(at_work, release, [&](double factor, const BlockState<Dim>& start, double time) {
        if (factor < 1.0) piece = scaled(piece, factor);
        return simulate_piece(piece, start, time, terrain, soils, settings, sink, &at_work);
    });
}

}  // namespace

EffectBody effect_body(const ConvexBlock& block) {
    const Vec3 box(block.x.maxCoeff() - block.x.minCoeff(), block.y.maxCoeff() - block.y.minCoeff(),
                   block.z.maxCoeff() - block.z.minCoeff());
    return {block.mass, block.size.minCoeff() > 0.0 ? block.size.mean() : box.mean()};
}

EffectBody effect_body(const ConvexPolygon& block) {
    return {block.mass, block.size.mean()};
}

TrajectoryEnd<3> simulate_block(const ConvexBlock& block, const BlockState<3>& release, const Surface& surface,
                                std::span<const Soil> soils, const DynamicsSettings& settings, MotionSink<3>* sink,
                                const EffectInput& effects) {
    if (!any_on_motion(effects)) return simulate_piece(block, release, 0.0, surface, soils, settings, sink, nullptr);
    return simulate_pieces<3>(block, release, surface, SurfaceGround(surface), soils, settings, sink, effects);
}

TrajectoryEnd<2> simulate_block(const ConvexPolygon& block, const BlockState<2>& release, const GroundLine& ground,
                                std::span<const Soil> soils, const DynamicsSettings& settings, MotionSink<2>* sink,
                                const EffectInput& effects) {
    if (!any_on_motion(effects)) return simulate_piece(block, release, 0.0, ground, soils, settings, sink, nullptr);
    return simulate_pieces<2>(block, release, ground, LineGround(ground), soils, settings, sink, effects);
}

namespace {

/// True if nothing touches within the gap after a lift.
template <int Dim, class Contacts>
bool is_free(Contacts& finder, const BlockState<Dim>& state, double lift, double gap,
             std::vector<Contact<Dim>>& contacts) {
    finder.detect(state.position + lift * Space<Dim>::Vec::Unit(Dim - 1), rotation_matrix(state.orientation), gap,
                  contacts);
    return contacts.empty() && finder.cut() <= 0.0;
}

/// The smallest lift that frees the block, between one that does not and one that does.
template <int Dim, class Contacts>
double least_lift(Contacts& finder, const BlockState<Dim>& state, double low, double high, double gap) {
    std::vector<Contact<Dim>> contacts;
    while (high - low > std::max(0.1 * gap, kLeastLift)) {
        const double middle = 0.5 * (low + high);
        (is_free<Dim>(finder, state, middle, gap, contacts) ? high : low) = middle;
    }
    return high;
}

}  // namespace

// From above, not from below: a long block can stick through a ridge so that no corner of it is in the ground and no crest in it, which looks free.
double clearing_lift(const ConvexBlock& block, const BlockState<3>& state, const Surface& surface, double gap) {
    HullContacts finder(block, surface, false);
    const Mat3 rotation = rotation_matrix(state.orientation);
    std::vector<Contact<3>> contacts;
    const double step = kClearingStep * block.inner_radius;
    double high = 0.0;
    while (finder.clearance(state.position + high * Vec3::UnitZ(), rotation) < gap && high < kHighestLift)
        high = std::max(2.0 * high, step);
    double low = high;
    do {
        if (low <= 0.0) return 0.0;
        high = low;
        low = std::max(high - step, 0.0);
    } while (is_free<3>(finder, state, low, gap, contacts));
    return least_lift<3>(finder, state, low, high, gap);
}

double clearing_lift(const ConvexPolygon& block, const BlockState<2>& state, const GroundLine& ground, double gap) {
    PlaneContacts finder(block, ground, false);
    std::vector<Contact<2>> contacts;
    const double least = std::max(0.0, finder.sunk(state.position, rotation_matrix(state.orientation)));
    if (is_free<2>(finder, state, least, gap, contacts)) return least;
    double low = least, high = least + std::max(gap, 0.1 * block.radius);
    while (!is_free<2>(finder, state, high, gap, contacts) && high < kHighestLift) {
        low = high;
        high += high - least;
    }
    return least_lift<2>(finder, state, low, high, gap);
}

}  // namespace scree
