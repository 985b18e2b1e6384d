// SPDX-License-Identifier: GPL-3.0-or-later
// What holds for every effect: no energy from nothing, nothing below the ground, the contact law itself where an effect is neutral, and the same
// numbers on any number of threads.
#include "scree/base/error.hpp"
#include "scree/ensemble/campaign.hpp"
#include "support/fuzz.hpp"
#include "support/motion.hpp"
#include "support/plane_fuzz.hpp"
#include "support/scenes.hpp"
#include "support/terrains.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <optional>
#include <set>

namespace scree::test {

namespace {

constexpr double g = kStandardGravity;
/// Rise of energy in a step that the solver's tolerance of 1e-4 explains, as height of fall [m].
constexpr double kAllowedRise = 1e-5;

ConvexBlock hull(std::uint64_t number) {
    RandomStream random(31, number, RandomPurpose::Shape);
    return make_block({}, {0.9, 0.7, 0.55}, 400.0, random);
}

BlockState<3> thrown(const ConvexBlock& block, const Surface& surface, std::uint64_t number) {
    RandomStream random(31, number, RandomPurpose::Orientation);
    BlockState<3> s;
    s.orientation = Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    const Vec2 plan(-30.0, random.uniform(-5.0, 5.0));
    s.position = {plan.x(), plan.y(), surface.height(plan) + 1.5};
    s.position.z() += clearing_lift(block, s, surface, 1e-3);
    s.velocity = {random.uniform(0.0, 6.0), random.uniform(-2.0, 2.0), random.uniform(-3.0, 3.0)};
    s.spin = {random.normal(), random.normal(), random.normal()};
    return s;
}

/// An effect at work on the slopes of these tests, at a strength that shows.
Effect strong(EffectKind kind) {
    Effect effect = make_effect(kind);
    if (kind == EffectKind::Net)
        effect.place.lines = {Points{{-10, -50, 0}, {-10, 50, 0}}, Points{{0, -50, 0}, {0, 50, 0}}};
    if (kind == EffectKind::Net) effect.set("capacity", 3.0);
    if (kind == EffectKind::SoilPatch) {
        effect.set("friction", 0.2);
        effect.set("restitution", 0.5);
        effect.place.limit_to({Polygon{{{-20, -20}, {0, -20}, {0, 20}, {-20, 20}}, {}}});
    }
    if (kind == EffectKind::ForestDrag)
        effect.place.limit_to({Polygon{{{-25, -20}, {-5, -20}, {10, 20}, {-25, 20}}, {}}});
    if (kind == EffectKind::ForestDrag) effect.set("height", 3.0);
    if (kind == EffectKind::Trees) effect.set("strength", 0.05);
    if (kind == EffectKind::Fragmentation) effect.set("speed", 3.0);
    if (kind == EffectKind::Fragmentation) effect.set("most", 3.0);
    if (kind == EffectKind::OwnLaw) {
        effect.set("a", 1.0);
        effect.own.contact_law = [](const scree_contact_state* s, scree_contact_law_values* law) {
            law->restitution += s->number[0];  // as if it would create energy
            law->friction *= 1.0 + s->number[0] * s->draw;
        };
        effect.own.ground_drag = [](const scree_contact_state* s, scree_ground_drag_values* drag) {
            drag->linear = -s->number[0];
        };
    }
    return effect;
}

std::vector<EffectKind> kinds_on_motion() {
    std::vector<EffectKind> kinds;
    for (const EffectInfo& info : effect_catalogue())
        if (acts_on_motion(info.kind)) kinds.push_back(info.kind);
    return kinds;
}

template <int Dim>
double energy_at_start(const MotionSegment<Dim>& s) {
    return 0.5 * s.mass * s.velocity_start.squaredNorm() + s.rotation_energy_start + s.mass * g * s.position[Dim - 1];
}
template <int Dim>
double energy_at_end(const MotionSegment<Dim>& s) {
    return 0.5 * s.mass * s.velocity_end.squaredNorm() + s.rotation_energy_end +
           s.mass * g * MotionRecorder<Dim>::end_position(s)[Dim - 1];
}

/// Largest rise of energy from the start of one stretch to the start of the next, and within stretches of flight, as height of fall.
template <int Dim>
double largest_rise(const std::vector<MotionSegment<Dim>>& segments, const TrajectoryEnd<Dim>& end) {
    double largest = -kInfinity;
    for (std::size_t k = 0; k < segments.size(); ++k) {
        const bool last = k + 1 == segments.size();
        const double before = energy_at_start(segments[k]),
                     after = last ? end.energy_end : energy_at_start(segments[k + 1]);
        // heights count from the lowest corner of the terrain: a lost piece takes its potential energy along
        const double mass = segments[k].mass, left = last ? end.mass : segments[k + 1].mass;
        const double gone = (mass - left) * g * (last ? end.state.position : segments[k + 1].position)[Dim - 1];
        largest = std::max(largest, (after + gone - before) / (mass * g));
        if (!segments[k].in_contact) largest = std::max(largest, (energy_at_end(segments[k]) - before) / (mass * g));
    }
    return largest;
}

class EveryEffect : public testing::TestWithParam<EffectKind> {
protected:
    std::unique_ptr<Surface> surface = grid_terrain(40.0, 1.0, rough_slope(34 * kDegree, 0.05));
    std::vector<Soil> soils{{"slope", 0.3, 0.6, 0.03}};

    TrajectoryEnd<3> run(const std::vector<Effect>& effects, std::uint64_t number, SteppingMode mode,
                         MotionSink<3>* sink = nullptr) {
        DynamicsSettings settings;
        settings.mode = mode;
        settings.time_limit = 8.0;
        if (mode == SteppingMode::MoreauJean) settings.time_step = 1e-3;
        const ConvexBlock block = hull(number);
        return simulate_block(block, thrown(block, *surface, number), *surface, soils, settings, sink,
                              {effects, 5, number});
    }
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEffect, testing::ValuesIn(kinds_on_motion()),
                         [](const auto& kind) { return std::string(effect_info(kind.param).name); });

bool same(const TrajectoryEnd<3>& a, const TrajectoryEnd<3>& b) {
    return a.reason == b.reason && a.time == b.time && a.state.position == b.state.position &&
           a.state.velocity == b.state.velocity && a.state.spin == b.state.spin &&
           a.state.orientation.coeffs() == b.state.orientation.coeffs() &&
           a.counters.contact_problems == b.counters.contact_problems;
}

}  // namespace

TEST_P(EveryEffect, CreatesNoEnergy) {
    for (std::uint64_t number = 0; number < 6; ++number) {
        MotionRecorder<3> motion;
        const TrajectoryEnd<3> end = run({strong(GetParam())}, number, SteppingMode::Event, &motion);
        ASSERT_NE(end.reason, StopReason::Failed) << number;
        EXPECT_LT(largest_rise(motion.segments(), end), kAllowedRise) << number;
    }
}

TEST_P(EveryEffect, ChangesTheMotion) {
    // where blocks bounce they hardly lie on the ground long enough for drag there
    if (effect_info(GetParam()).hook == EffectHook::ContactForce) soils[0].restitution = 0.0;
    int changed = 0;
    for (std::uint64_t number = 0; number < 3; ++number)
        changed += !same(run({strong(GetParam())}, number, SteppingMode::Event), run({}, number, SteppingMode::Event));
    EXPECT_GT(changed, 0);
}

/// The same effect at a strength at which it does nothing, if it has one.
std::optional<Effect> neutral(const Effect& effect) {
    const EffectInfo& info = effect_info(effect.kind);
    Effect weak = effect;
    if (effect.kind == EffectKind::SoilPatch || effect.kind == EffectKind::OwnLaw) {  // by their standard values
        weak.values = make_effect(effect.kind).values;
        return weak;
    }
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
        if (std::isnan(info.parameters[k].neutral)) continue;
        weak.values[k] = info.parameters[k].neutral;
        return weak;
    }
    return std::nullopt;
}

// At the neutral value of its strength an effect leaves every bit of the motion as it is. Forces in flight cut it into pieces, which rounds differently:
// the first second of flight tells.
TEST_P(EveryEffect, IsTheContactLawWhereNeutral) {
    const EffectInfo& info = effect_info(GetParam());
    const std::optional<Effect> weak = neutral(strong(GetParam()));
    ASSERT_TRUE(weak) << "no parameter of " << info.name << " has a neutral value";
    const Effect& effect = *weak;
    EXPECT_NO_THROW(check_effect(effect, true));
    if (info.hook == EffectHook::Force || info.hook == EffectHook::Crossing) {
        const ConvexBlock block = hull(1);
        const auto valley = grid_terrain(40.0, 1.0, [](double, double) { return -200.0; });
        const BlockState<3> start = thrown(block, *surface, 1);
        DynamicsSettings settings;
        settings.time_limit = 2.0;
        const auto with = simulate_block(block, start, *valley, soils, settings, nullptr, {{&effect, 1}, 5, 1}),
                   without = simulate_block(block, start, *valley, soils, settings);
        EXPECT_LT((with.state.position - without.state.position).norm(), 1e-12 * 200.0);
        EXPECT_LT((with.state.velocity - without.state.velocity).norm(), 1e-12);
        return;
    }
    for (std::uint64_t number = 0; number < 3; ++number) {
        EXPECT_TRUE(same(run({effect}, number, SteppingMode::Event), run({}, number, SteppingMode::Event)));
        if (!info.limits.needs_impact) {
            EXPECT_TRUE(
                same(run({effect}, number, SteppingMode::MoreauJean), run({}, number, SteppingMode::MoreauJean)));
        }
    }
}

TEST_P(EveryEffect, WorksInTheSchemeOfThePaper) {
    const Effect effect = strong(GetParam());
    if (effect_info(GetParam()).limits.needs_impact) {
        EXPECT_THROW(check_effect(effect, false), InputError);
        return;
    }
    soils[0].restitution = 0.0;  // that scheme may gain energy with e > 0 by itself
    MotionRecorder<3> motion;
    const TrajectoryEnd<3> end = run({effect}, 2, SteppingMode::MoreauJean, &motion);
    ASSERT_NE(end.reason, StopReason::Failed);
    if (GetParam() != EffectKind::SoilPatch) {
        EXPECT_LT(largest_rise(motion.segments(), end), kAllowedRise);
    }
}

// All at once, on random terrain of every kind: nothing fails, gains energy or gets below the ground.
TEST(AllEffects, OnRandomTerrain) {
    std::vector<Effect> effects;
    for (const EffectKind kind : kinds_on_motion()) effects.push_back(strong(kind));
    for (std::uint64_t number = 0; number < 120; ++number) {
        const FuzzScene scene = fuzz_scene(number);
        EXPECT_EQ(fuzz_block(scene, fuzz_settings(), effects).fault, "") << scene.what;
    }
}

// Drag in flight, on random terrain: its pieces must not fly through anything.
TEST(AllEffects, FlightsWithDragDoNotTunnel) {
    Effect forest = make_effect(EffectKind::ForestDrag), air = make_effect(EffectKind::AirDrag);
    forest.set("height", 100.0);
    air.set("drag_coefficient", 3.0);
    for (std::uint64_t number = 0; number < 200; ++number) {
        const FuzzScene scene = fuzz_scene(number);
        forest.set("coefficient", scene.block.mass * (number % 3 == 0 ? 8.0 : 0.5));
        EXPECT_EQ(fuzz_block(scene, fuzz_settings(), std::vector<Effect>{forest, air}).fault, "") << scene.what;
    }
}

/// The effects of these tests along a straight profile east through the origin, moved to where the scenes of the plane are.
std::vector<Effect> in_plane(std::vector<Effect> effects) {
    const std::vector<Vec3> points{{-20, 0, 0}, {1000, 0, 0}};
    const std::vector<SoilId> soil{0};
    return effects_along(effects, make_profile(points, soil));
}

TEST(AllEffects, OnRandomProfiles) {
    std::vector<Effect> effects;
    for (const EffectKind kind : kinds_on_motion()) effects.push_back(strong(kind));
    effects = in_plane(effects);
    std::int64_t struck = 0, breaks = 0;
    for (std::uint64_t number = 0; number < 300; ++number) {
        const PlaneFuzzScene scene = plane_fuzz_scene(number);
        const FuzzOutcome<2> outcome = plane_fuzz_block(scene, fuzz_settings(), effects);
        EXPECT_EQ(outcome.fault, "") << scene.what;
        struck += outcome.end.counters.crossings_struck;
        breaks += outcome.end.counters.breaks;
    }
    EXPECT_GT(struck, 0);
    EXPECT_GT(breaks, 0);
}

TEST_P(EveryEffect, CreatesNoEnergyInThePlaneAndChangesTheMotion) {
    const std::vector<Effect> effects = in_plane({strong(GetParam())});
    int changed = 0;
    for (std::uint64_t number = 0; number < 60; ++number) {
        const PlaneFuzzScene scene = plane_fuzz_scene(number);
        const FuzzOutcome<2> with = plane_fuzz_block(scene, fuzz_settings(), effects),
                             without = plane_fuzz_block(scene, fuzz_settings(), {});
        EXPECT_EQ(with.fault, "") << scene.what;
        changed += with.end.state.position != without.end.state.position;
        MotionRecorder<2> motion;
        const TrajectoryEnd<2> end = simulate_block(scene.block, scene.release, scene.ground, scene.soils,
                                                    fuzz_settings(), &motion, {effects, 77, 0});
        EXPECT_LT(largest_rise(motion.segments(), end), kAllowedRise) << scene.what;
    }
    EXPECT_GT(changed, 0);
}

TEST_P(EveryEffect, IsTheContactLawWhereNeutralInThePlane) {
    const EffectHook hook = effect_info(GetParam()).hook;
    const std::vector<Effect> effects = in_plane({neutral(strong(GetParam())).value()});
    if (hook == EffectHook::Force || hook == EffectHook::Crossing) {
        const std::vector<Vec3> points{{-20, 0, -200}, {1000, 0, -200}};
        const std::vector<SoilId> soil{0};
        const GroundLine valley(make_profile(points, soil));
        const PlaneFuzzScene scene = plane_fuzz_scene(0);
        BlockState<2> start = scene.release;
        start.position = {5.0, 0.0};
        start.velocity = {6.0, 2.0};
        DynamicsSettings settings;
        settings.time_limit = 2.0;
        const auto with = simulate_block(scene.block, start, valley, soils, settings, nullptr, {effects, 5, 1}),
                   without = simulate_block(scene.block, start, valley, soils, settings);
        EXPECT_LT((with.state.position - without.state.position).norm(), 1e-12 * 200.0);
        EXPECT_LT((with.state.velocity - without.state.velocity).norm(), 1e-12);
        return;
    }
    for (std::uint64_t number = 0; number < 30; ++number) {
        const PlaneFuzzScene scene = plane_fuzz_scene(number);
        const FuzzOutcome<2> with = plane_fuzz_block(scene, fuzz_settings(), effects),
                             without = plane_fuzz_block(scene, fuzz_settings(), {});
        EXPECT_EQ(with.end.state.position, without.end.state.position) << scene.what;
        EXPECT_EQ(with.end.state.spin, without.end.state.spin) << scene.what;
        EXPECT_EQ(with.end.time, without.end.time) << scene.what;
    }
}

TEST(AllEffects, FlightsWithDragDoNotTunnelInThePlane) {
    Effect forest = make_effect(EffectKind::ForestDrag), air = make_effect(EffectKind::AirDrag);
    forest.set("height", 100.0);
    air.set("drag_coefficient", 3.0);
    for (std::uint64_t number = 0; number < 400; ++number) {
        const PlaneFuzzScene scene = plane_fuzz_scene(number);
        forest.set("coefficient", scene.block.mass * (number % 3 == 0 ? 8.0 : 0.5));
        EXPECT_EQ(plane_fuzz_block(scene, fuzz_settings(), std::vector<Effect>{forest, air}).fault, "") << scene.what;
    }
}

TEST(AllEffects, DoNotDependOnThreads) {
    const auto surface = grid_terrain(40.0, 1.0, rough_slope(34 * kDegree, 0.05));
    FeatureLayer layer;
    layer.name = "release";
    layer.features.push_back({1, MultiPolygon{Polygon{{{-35, -4}, {-30, -4}, {-30, 4}, {-35, 4}}, {}}}, {}});
    const ReleaseArea area(layer, *surface, ReleasePattern::Random, {});
    CampaignInput input;
    input.surface = surface.get();
    input.area = &area;
    input.soils = {{"slope", 0.3, 0.6, 0.03}};
    input.population.list = {{"a", 400.0, {0.9, 0.7, 0.55}}};
    input.release.count = 60;
    input.result_cells = {80, 80, 1.0, {-40.0, -40.0}};
    for (const EffectKind kind : kinds_on_motion()) input.effects.push_back(strong(kind));
    input.effects.push_back(make_effect(EffectKind::ReleaseMotion));
    const std::atomic<bool> stop{false};
    std::vector<CampaignResult> results;
    for (const int threads : {1, 4}) {
        input.threads = threads;
        results.push_back(run_campaign(input, {}, stop));
    }
    for (std::size_t k = 0; k < results[0].blocks.size(); ++k) {
        EXPECT_EQ(results[0].blocks[k].stop, results[1].blocks[k].stop);
        EXPECT_EQ(results[0].blocks[k].mass_left, results[1].blocks[k].mass_left);
    }
    EXPECT_EQ(results[0].counters.crossings_struck, results[1].counters.crossings_struck);
    EXPECT_GT(results[0].counters.crossings_struck, 0);
    EXPECT_GT(results[0].counters.breaks, 0);
    std::set<double> masses;
    for (const auto& b : results[0].blocks) masses.insert(b.mass_left);
    EXPECT_GT(masses.size(), 1U);
}

}  // namespace scree::test
