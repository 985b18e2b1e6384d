// SPDX-License-Identifier: GPL-3.0-or-later
// Forces of effects, in flight and in contact, against closed forms of a ball (3D) and a disc (2D).
#include "dynamics/effects/block_effects.hpp"
#include "dynamics/effects/formulas.hpp"

#include "support/ball.hpp"
#include "support/motion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace scree::test {

namespace {

constexpr double g = kStandardGravity;
constexpr double kDegree = std::numbers::pi / 180.0;

template <class Dimension>
class EffectDrag : public testing::Test {
protected:
    static constexpr int kDimension = Dimension::value;
    Ball<kDimension> ball;

    /// Air drag with this deceleration over speed squared [1/m].
    Effect air(double quadratic) const {
        const double area = std::numbers::pi * ball.radius * ball.radius;
        return effect_with(EffectKind::AirDrag,
                           {{"air_density", 1.2}, {"drag_coefficient", 2.0 * quadratic * ball.mass / (1.2 * area)}});
    }
    /// Forest drag with this deceleration over speed [1/s].
    Effect forest(double linear, double height = 1e9) const {
        return effect_with(EffectKind::ForestDrag, {{"coefficient", linear * ball.mass}, {"height", height}});
    }
};

using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(EffectDrag, Dimensions);

}  // namespace

// A bounce has no duration: drag in contact takes nothing of the way along the ground.
TYPED_TEST(EffectDrag, ABounceIsNoContactThatLasts) {
    constexpr int kDim = TestFixture::kDimension;
    this->ball.soil = {"level", 0.8, 0.0, 0.0};
    this->ball.effects = {effect_with(EffectKind::GroundDrag, {{"coefficient", 2.4}})};
    auto release = this->ball.at(0.0, 1.0);
    release.velocity[0] = 10.0;
    MotionRecorder<kDim> motion;
    const auto end = this->ball.run(release, 2.0, &motion);
    EXPECT_GE(end.counters.impacts, 3);
    EXPECT_NEAR(end.state.velocity[0], 10.0, 1e-9);
    for (const auto& m : motion.segments()) EXPECT_FALSE(m.in_contact);
}

// ---- flight ------------------------------------------------------------------------------------------------------------------------

// From rest under quadratic drag k: v = w tanh(g t / w), z = w^2 / g ln cosh(g t / w), w = sqrt(g / k).
TYPED_TEST(EffectDrag, FallInAirIsTheClosedForm) {
    constexpr int kDim = TestFixture::kDimension;
    for (const double k : {1e-3, 0.05, 1.0}) {
        this->ball.effects = {this->air(k)};
        const double w = std::sqrt(g / k), time = 3.0;
        const auto end = this->ball.run(this->ball.at(0.0, 100.0), time);
        EXPECT_NEAR(-end.state.velocity[kDim - 1], w * std::tanh(g * time / w), 2e-5 * w);
        EXPECT_NEAR(100.5 - end.state.position[kDim - 1], w * w / g * std::log(std::cosh(g * time / w)), 1e-4);
        EXPECT_NEAR(end.state.position[0], 0.0, 1e-12);
    }
}

// Linear drag c: v = v0 e^-ct + g/c (1 - e^-ct), in both directions, for light and heavy damping.
TYPED_TEST(EffectDrag, FlightThroughForestIsTheClosedForm) {
    constexpr int kDim = TestFixture::kDimension;
    for (const double c : {0.05, 0.5, 5.0}) {
        this->ball.effects = {this->forest(c)};
        auto release = this->ball.at(0.0, 60.0);
        release.velocity = in_plane<kDim>(12.0, 6.0);
        const double time = 2.0, left = std::exp(-c * time), gone = (1.0 - left) / c;
        const auto end = this->ball.run(release, time);
        EXPECT_NEAR(end.state.velocity[0], 12.0 * left, 2e-4);  // the end lies within a piece of the flight
        EXPECT_NEAR(end.state.velocity[kDim - 1], 6.0 * left - g * gone, 2e-4);
        EXPECT_NEAR(end.state.position[0], 12.0 * gone, 1e-5);
        EXPECT_NEAR(end.state.position[kDim - 1] - 60.5, 6.0 * gone - g / c * (time - gone), 1e-5);
    }
}

// Along x dv = -c dx whatever the block does meanwhile: behind a zone of width W the speed is v - c W. Borders are met within 1e-4 m.
TYPED_TEST(EffectDrag, ForestActsInsideItsZoneOnly) {
    constexpr int kDim = TestFixture::kDimension;
    const double c = 0.6;
    this->ball.effects = {between(this->forest(c), 4.0, 11.0)};
    auto release = this->ball.at(0.0, 60.0);
    release.velocity[0] = 12.0;
    MotionRecorder<kDim> motion;
    const auto end = this->ball.run(release, 2.0, &motion);
    ASSERT_GT(end.state.position[0], 12.0);
    EXPECT_NEAR(end.state.velocity[0], 12.0 - c * 7.0, 3e-4 * c);
    for (const auto& m : motion.segments())
        if (m.position[0] < 3.999) {
            EXPECT_NEAR(m.velocity_start[0], 12.0, 1e-12);
        }
}

// Falls into the canopy: free fall down to it, then the closed form of linear drag.
TYPED_TEST(EffectDrag, ForestActsBelowTheCanopyOnly) {
    constexpr int kDim = TestFixture::kDimension;
    const double c = 0.8, top = 20.0, start = 30.0;
    this->ball.effects = {this->forest(c, top)};
    auto release = this->ball.at(0.0, start - this->ball.radius);
    const double free = std::sqrt(2.0 * (start - top) / g), time = 1.0, left = std::exp(-c * time);
    const auto end = this->ball.run(release, free + time);
    EXPECT_NEAR(end.state.velocity[kDim - 1], -g * free * left - g / c * (1.0 - left), 1e-4);
}

// Thrown steeply up, where the velocity turns round: drag opposes the velocity in every piece of the motion.
TYPED_TEST(EffectDrag, FlightLosesEnergyInEveryPiece) {
    constexpr int kDim = TestFixture::kDimension;
    for (const double sideways : {0.0, 1e-3, 0.5}) {
        this->ball.effects = {this->forest(2.0), this->air(0.05)};
        auto release = this->ball.at(0.0, 5.0);
        release.velocity = in_plane<kDim>(sideways, 8.0);
        MotionRecorder<kDim> motion;
        this->ball.run(release, 1.2, &motion);
        ASSERT_GT(motion.segments().size(), 5U);
        for (const auto& m : motion.segments()) {
            const auto drag = (m.velocity_end - m.velocity_start) / m.duration + g * Space<kDim>::Vec::Unit(kDim - 1);
            EXPECT_LE(drag.dot(m.velocity_start), 1e-7);
            EXPECT_LE(drag.dot(m.velocity_end), 1e-7);
        }
    }
}

// The steps are of fourth order: halving them must not matter at the tolerance of the other tests, and coarse ones must show the order.
TYPED_TEST(EffectDrag, TwoParabolasAreOfFourthOrder) {
    constexpr int kDim = TestFixture::kDimension;
    using Vec = typename Space<kDim>::Vec;
    const Drag drag{0.3, 0.04};
    const Vec gravity = -g * Vec::Unit(kDim - 1);
    BlockState<kDim> start;
    start.velocity = in_plane<kDim>(9.0, 4.0);
    const auto fly = [&](int steps) {
        BlockState<kDim> s = start;
        for (int k = 0; k < steps; ++k) {
            const DragFlight<kDim> flight(drag, gravity, s, 1.0 / steps);
            EXPECT_NEAR(flight.duration(), 1.0 / steps, 1e-15);
            s.position = flight.position(s, flight.duration());
            s.velocity +=
                flight.first.duration * flight.first.acceleration + flight.second.duration * flight.second.acceleration;
        }
        return s;
    };
    const auto exact = fly(1024);
    const double coarse = (fly(8).position - exact.position).norm(), fine = (fly(16).position - exact.position).norm();
    EXPECT_GT(coarse / fine, 12.0);
    EXPECT_LT((fly(16).velocity - exact.velocity).norm(), 1e-5);
}

// Drag so strong that the block comes to its terminal speed in milliseconds: the path is g / c (t - (1 - e^-ct) / c) down and v0 / c sideways within
// kPathError for each halving of what is left of the speed.
TYPED_TEST(EffectDrag, StrongDragTakesFewSteps) {
    constexpr int kDim = TestFixture::kDimension;
    const double c = 4000.0, time = 5.0;
    this->ball.effects = {this->forest(c)};
    auto release = this->ball.at(0.0, 60.0);
    release.velocity = in_plane<kDim>(20.0, 10.0);
    MotionRecorder<kDim> motion;
    const auto end = this->ball.run(release, time, &motion);
    EXPECT_NEAR(end.state.velocity[kDim - 1], -g / c, 1e-9);
    EXPECT_NEAR(end.state.position[0], 20.0 / c, 0.01);
    EXPECT_NEAR(end.state.position[kDim - 1] - 60.5, 10.0 / c - g / c * time, 0.01);
    EXPECT_LT(motion.segments().size(), 500U);
    double before = kInfinity;
    for (const auto& m : motion.segments()) {
        const double energy = 0.5 * m.velocity_start.squaredNorm() + g * m.position[kDim - 1];
        EXPECT_LE(energy, before + 1e-12 * before);
        before = energy;
    }
}

// ---- contact -----------------------------------------------------------------------------------------------------------------------

// A ball without friction on a slope: v = g sin / c (1 - e^-ct), exact for linear drag.
TYPED_TEST(EffectDrag, GroundDragLimitsTheSpeed) {
    const double c = 0.5, a = 35 * kDegree;
    this->ball.slope.angle = a;
    this->ball.soil = {"slope", 0.0, 0.0, 0.0};
    // a forest holds what slides through it as it holds what flies
    for (const Effect& drag : {effect_with(EffectKind::GroundDrag, {{"coefficient", c}}), this->forest(c)}) {
        this->ball.effects = {drag};
        for (const double time : {1.0, 20.0}) {
            const auto end = this->ball.run(this->ball.sliding(0.0, 0.0), time);
            EXPECT_NEAR(end.state.velocity.norm(), g * std::sin(a) / c * (1.0 - std::exp(-c * time)), 1e-6);
        }
    }
}

// Rolling without slip the block's inertia counts too: v = g sin / c (1 - e^(-ct / (1 + i))). First order in h.
TYPED_TEST(EffectDrag, GroundDragSlowsRolling) {
    const double c = 0.5, a = 20 * kDegree, time = 2.0;
    this->ball.slope.angle = a;
    this->ball.soil = {"slope", 0.0, 0.9, 0.0};
    this->ball.effects = {effect_with(EffectKind::GroundDrag, {{"coefficient", c}})};
    const double expected = g * std::sin(a) / c * (1.0 - std::exp(-c * time / (1.0 + this->ball.roundness())));
    double errors[2];
    for (int n = 0; n < 2; ++n) {
        this->ball.settings.time_step = n == 0 ? 4e-3 : 2e-3;
        errors[n] = std::abs(this->ball.run(this->ball.sliding(0.0, 0.0), time).state.velocity.norm() - expected);
    }
    EXPECT_LT(errors[0], 0.01);
    EXPECT_LT(errors[1], 0.6 * errors[0]);
}

// Quadratic drag k on the level without friction: v = v0 / (1 + k v0 t); on a slope it ends at sqrt(g sin / k).
TYPED_TEST(EffectDrag, QuadraticGroundDrag) {
    const double k = 0.1;
    this->ball.soil = {"slope", 0.0, 0.0, 0.0};
    // air holds what slides as it holds what flies
    for (const Effect& drag : {effect_with(EffectKind::GroundDragQuadratic, {{"coefficient", k}}), this->air(k)}) {
        this->ball.effects = {drag};
        this->ball.slope.angle = 0.0;
        double errors[2];
        for (int n = 0; n < 2; ++n) {
            this->ball.settings.time_step = n == 0 ? 4e-3 : 2e-3;
            const auto end = this->ball.run(this->ball.sliding(0.0, 10.0), 2.0);
            errors[n] = std::abs(end.state.velocity.norm() - 10.0 / (1.0 + k * 10.0 * 2.0));
        }
        EXPECT_LT(errors[0], 0.01);
        EXPECT_LT(errors[1], 0.6 * errors[0]);
        this->ball.slope.angle = 30 * kDegree;
        const auto end = this->ball.run(this->ball.sliding(0.0, 0.0), 20.0);
        EXPECT_NEAR(end.state.velocity.norm(), std::sqrt(g * 0.5 / k), 1e-6);
    }
}

TYPED_TEST(EffectDrag, ReducedScarDragIsQuadraticOverTheLength) {
    this->ball.radius = 0.8;
    this->ball.slope.angle = 30 * kDegree;
    this->ball.soil = {"slope", 0.0, 0.0, 0.0};
    this->ball.effects = {effect_with(EffectKind::ScarDragReduced, {{"coefficient", 0.2}})};
    const auto end = this->ball.run(this->ball.sliding(0.0, 0.0), 20.0);
    EXPECT_NEAR(end.state.velocity.norm(), std::sqrt(g * 0.5 * 1.6 / 0.2), 1e-6);
}

// A block creeps at the speed at which drag carries what friction leaves: it is slow, but it does not stop.
TYPED_TEST(EffectDrag, GroundDragSlowsWithoutStopping) {
    const double a = 32 * kDegree, mu = 0.5, c = 8.0;
    this->ball.settings.rest_time = 0.05;
    this->ball.slope.angle = a;
    this->ball.soil = {"slope", 0.0, mu, 10.0};
    this->ball.effects = {effect_with(EffectKind::GroundDrag, {{"coefficient", c}})};
    const auto end = this->ball.run(this->ball.sliding(0.0, 5.0), 10.0);
    EXPECT_EQ(end.reason, StopReason::TimeLimit);
    EXPECT_NEAR(end.state.velocity.norm(), g * (std::sin(a) - mu * std::cos(a)) / c, 2e-3);
}

// Corners of a fast block touch and leave again: drag must take what the time in contact gives, not what the step gives. Without restitution, where a
// touch ends by the turning of the block alone: angular blocks that fly from touch to touch, and nearly round ones, whose corners land softly and bear nothing
// once the block is faster than about sqrt(g R).
TEST(EffectDragOfPolygons, DoesNotDependOnTheStep) {
    struct Case {
        int corners;
        double slope, speed, drag, time;
        int count;
        double share;  ///< of what drag takes from the way, by which two steps may differ
    };
    // by drag in all of a step that ends a touch: 0.3 of the first case; of soft landings, too: more than the share of the second
    for (const Case& c :
         {Case{10, 36 * kDegree, 10.0, 4.0, 5.0, 400, 0.1}, Case{100, 35 * kDegree, 0.0, 2.0, 2.5, 100, 0.1}}) {
        const std::vector<Vec3> points{{0, 0, 0}, {400 * std::cos(c.slope), 0, -400 * std::sin(c.slope)}};
        const std::vector<SoilId> soil{0};
        const GroundLine ground(make_profile(points, soil));
        const std::vector<Soil> soils{{"slope", 0.0, 0.6, 0.05}};
        /// Mean and standard error of the way.
        const auto way = [&](double step, std::span<const Effect> effects) {
            double sum = 0.0, squares = 0.0;
            for (std::uint64_t number = 0; number < static_cast<std::uint64_t>(c.count); ++number) {
                RandomStream random(3, number, RandomPurpose::Shape);
                ShapeSettings shape;
                shape.polygon_points = c.corners;
                const Vec3 size = c.corners < 50 ? Vec3(1.0, 0.8, 0.7) : Vec3(0.8, 0.8, 0.8);
                if (c.corners >= 50) shape.shape = BlockShape::Ellipsoid;
                const ConvexPolygon block = make_polygon(shape, size, 1000.0, random);
                BlockState<2> s;
                s.orientation = random.uniform(0.0, 6.0);
                s.position = {5.0, ground.height(5.0) + 1.0};
                s.velocity = {c.speed, 0.0};
                DynamicsSettings settings;
                settings.time_step = step;
                settings.time_limit = c.time;
                const double end =
                    simulate_block(block, s, ground, soils, settings, nullptr, {effects, 1, number}).state.position.x();
                sum += end / c.count;
                squares += end * end / c.count;
            }
            return std::pair(sum, std::sqrt((squares - sum * sum) / c.count));
        };
        const std::vector<Effect> drag{effect_with(EffectKind::GroundDrag, {{"coefficient", c.drag}})};
        const auto [free, free_error] = way(8e-3, {});
        const double coarse = way(8e-3, drag).first;
        const auto [fine, fine_error] = way(1e-3, drag);
        EXPECT_LT(fine, free - 4.0 * std::hypot(free_error, fine_error));
        EXPECT_NEAR(coarse, fine, c.share * (free - fine)) << c.corners << " corners: without drag " << free;
    }
}

// ---- scars -------------------------------------------------------------------------------------------------------------------------

TEST(ScarFormula, NumbersOfTheSource) {
    // 780 kg at 10 m/s on 15 MPa: 0.12 m (Lu et al. 2019 measure 0.13 to 0.21 m)
    EXPECT_NEAR(effect_formula::scar_depth(780.0, 15e6, 10.0), 0.124, 0.001);
    EXPECT_NEAR(effect_formula::scar_area(0.5, 0.5), std::numbers::pi * 0.125, 1e-12);
    EXPECT_NEAR(effect_formula::scar_area(0.5, 1.0), std::numbers::pi * 0.25, 1e-12);
    EXPECT_EQ(effect_formula::scar_area(0.5, 0.0), 0.0);
}

// Lands obliquely without friction: the first step in contact decelerates by (C / 2) rho A v^2 / m; after one diameter of way nothing is left.
TYPED_TEST(EffectDrag, ScarDragActsUntilTheScarIsLeftBehind) {
    constexpr int kDim = TestFixture::kDimension;
    const double resistance = 2.5, density = 1700.0, v = 6.0, drop = 2.0;
    this->ball.soil = {"level", 0.0, 0.0, 0.0};
    this->ball.effects = {
        effect_with(EffectKind::ScarDrag, {{"resistance", resistance}, {"density", density}, {"modulus", 15.0}})};
    auto release = this->ball.at(0.0, drop);
    release.velocity[0] = v;
    this->ball.settings.time_step = 4e-3;  // the scar is short: its end is met within a step
    MotionRecorder<kDim> motion;
    this->ball.run(release, 2.0, &motion);
    const auto& all = motion.segments();
    const auto first = std::find_if(all.begin(), all.end(), [](const auto& m) { return m.in_contact; });
    ASSERT_NE(first, all.end());
    const double speed = -all.front().velocity_end[kDim - 1];
    const double depth = effect_formula::scar_depth(this->ball.mass, 15e6, speed);
    const double k = 0.5 * resistance * density * effect_formula::scar_area(this->ball.radius, depth) / this->ball.mass;
    EXPECT_NEAR(first->velocity_end[0], v * std::exp(-k * v * first->duration), 1e-9);
    // dv/dx = -k(x) v with k falling to 0 over the diameter: v = v0 exp(-integral)
    double integral = 0.0;
    const int parts = 20000;
    for (int n = 0; n < parts; ++n)
        integral += 0.5 * resistance * density / this->ball.mass / parts *
                    effect_formula::scar_area(this->ball.radius, depth * (1.0 - (n + 0.5) / parts));
    EXPECT_NEAR(all.back().velocity_end[0], v * std::exp(-integral), 0.01);
    EXPECT_LT(all.back().velocity_end[0], 0.98 * v);
}

// The scar of a block that breaks is no deeper than half its largest piece.
TYPED_TEST(EffectDrag, AScarIsNoDeeperThanThePiece) {
    constexpr int kDim = TestFixture::kDimension;
    this->ball.soil = {"level", 0.0, 0.0, 0.0};
    this->ball.effects = {
        effect_with(EffectKind::ScarDrag, {{"resistance", 2.5}, {"density", 1700.0}, {"modulus", 1e-2}}),
        effect_with(EffectKind::Fragmentation, {{"speed", 6.0}, {"share", 0.125}, {"most", 1.0}})};
    auto release = this->ball.at(0.0, 2.0);
    release.velocity[0] = 6.0;
    MotionRecorder<kDim> motion;
    this->ball.run(release, 2.0, &motion);
    const auto& all = motion.segments();
    const auto first = std::find_if(all.begin(), all.end(), [](const auto& m) { return m.in_contact; });
    ASSERT_NE(first, all.end());
    EXPECT_NEAR(first->mass, 0.125 * this->ball.mass, 1e-9);
    const double radius = 0.5 * this->ball.radius,
                 k = 0.5 * 2.5 * 1700.0 * effect_formula::scar_area(radius, radius) / first->mass;
    EXPECT_NEAR(first->velocity_end[0], first->velocity_start[0] * std::exp(-k * 6.0 * first->duration), 1e-9);
}

// Touches on the way out of a scar do not begin it anew: n of them would leave (1 - 1/n)^n of its depth after one diameter.
TYPED_TEST(EffectDrag, AShallowImpactLeavesADeepScarAsItIs) {
    constexpr int kDim = TestFixture::kDimension;
    const std::vector<Effect> effects{effect_with(EffectKind::ScarDrag, {{"resistance", 2.5}, {"density", 1700.0}})};
    BlockEffects<kDim> at_work({effects, 1, 0}, {1000.0, 1.0}, this->ball.slope, g);
    std::vector<Contact<kDim>> contacts(1);
    BlockState<kDim> s;
    const auto drag = [&] { return at_work.drag_in_contact(contacts, s).quadratic; };
    const auto move = [&](double way) {
        const auto from = s.position;
        s.position[0] += way;
        at_work.moved(from, 0.1, true, 1e4, s);
    };
    const auto strike = [&](double speed) { at_work.struck(s, contacts, std::array{speed}); };
    strike(8.0);
    const double at_first = drag();
    EXPECT_GT(at_first, 0.0);
    for (int k = 1; k <= 10; ++k) {
        move(0.1);
        const double before = drag();
        strike(0.01);
        if (k < 9) {
            EXPECT_EQ(drag(), before) << k;
        }
    }
    EXPECT_LT(drag(), 1e-2 * at_first) << "but for the scar of 1 cm/s";
    move(-0.5);
    strike(8.0);
    EXPECT_DOUBLE_EQ(drag(), at_first) << "a deeper one counts";
}

// In the scheme of the paper forces act step by step; h = 1e-3 leaves its first-order error.
TYPED_TEST(EffectDrag, MoreauJeanHasTheSameForces) {
    constexpr int kDim = TestFixture::kDimension;
    this->ball.settings.mode = SteppingMode::MoreauJean;
    this->ball.settings.time_step = 1e-3;
    this->ball.effects = {this->forest(0.5)};
    auto release = this->ball.at(0.0, 60.0);
    release.velocity = in_plane<kDim>(12.0, 6.0);
    const double c = 0.5, time = 2.0, left = std::exp(-c * time);
    const auto end = this->ball.run(release, time - 5e-4);
    EXPECT_NEAR(end.time, time, 1e-9);
    EXPECT_NEAR(end.state.velocity[0], 12.0 * left, 1e-6);
    EXPECT_NEAR(end.state.velocity[kDim - 1], 6.0 * left - g / c * (1.0 - left), 1e-6);
    EXPECT_NEAR(end.state.position[0], 12.0 * (1.0 - left) / c, 1e-4);
}

}  // namespace scree::test
