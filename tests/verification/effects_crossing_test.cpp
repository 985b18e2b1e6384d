// SPDX-License-Identifier: GPL-3.0-or-later
// Nets, trees, breaking blocks, berms: effects that act once. Energy balances and counts of a ball (3D) and a disc (2D).
#include "dynamics/effects/formulas.hpp"
#include "ensemble/motion_at.hpp"

#include "support/ball.hpp"
#include "support/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree::test {

namespace {

constexpr double g = kStandardGravity;

template <class Dimension>
class EffectCrossing : public testing::Test {
protected:
    static constexpr int kDimension = Dimension::value;
    Ball<kDimension> ball;

    /// Kinetic energy after a flight of 1.5 s at 10 m/s along x from 60 m up, with what gravity adds taken off.
    TrajectoryEnd<kDimension> fly() {
        auto release = ball.at(0.0, 60.0);
        release.velocity[0] = 10.0;
        return ball.run(release, 1.5);
    }
    double kinetic(const BlockState<kDimension>& s) const { return kinetic_energy(ball.body(), s); }
    /// Kinetic energy of the flight at x.
    double arriving(double x) const { return 500.0 * (100.0 + std::pow(g * x / 10.0, 2)); }
};

using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(EffectCrossing, Dimensions);

}  // namespace

// ---- nets --------------------------------------------------------------------------------------------------------------------------

// Behind the net the total energy is less by the capacity; the direction at the net does not change.
TYPED_TEST(EffectCrossing, NetTakesItsCapacityFromAFlight) {
    this->ball.effects = {across(effect_with(EffectKind::Net, {{"capacity", 20.0}, {"height", 100.0}}), 6.0)};
    const auto end = this->fly();
    ASSERT_GT(end.state.position[0], 7.0);
    EXPECT_NEAR((end.energy_start - end.energy_end) / 20e3, 1.0, 1e-6);
    const double factor = std::sqrt(1.0 - 20e3 / this->arriving(6.0));
    EXPECT_NEAR(end.state.velocity[0], 10.0 * factor, 1e-3);
    EXPECT_EQ(end.counters.crossings_struck, 1);
}

TYPED_TEST(EffectCrossing, NetHoldsWhatHasLessEnergy) {
    this->ball.effects = {across(effect_with(EffectKind::Net, {{"capacity", 200.0}, {"height", 100.0}}), 6.0)};
    const auto end = this->fly();
    EXPECT_EQ(end.reason, StopReason::AtRest);
    EXPECT_LT(end.state.position[0], 6.0) << "uphill of it";
    EXPECT_GT(end.state.position[0], 6.0 - 2e-3);
    EXPECT_NEAR(end.state.position[TypeParam::value - 1], 60.5 - 0.5 * g * 0.36, 2e-3);
    EXPECT_NEAR(end.time, 0.6, 2e-4);
    EXPECT_EQ(end.state.velocity.norm(), 0.0);
    EXPECT_EQ(end.state.spin.norm(), 0.0);
}

TYPED_TEST(EffectCrossing, NetIsPassedAbove) {
    const double height = 60.5 - 0.5 * g * 0.36;  // at x = 6
    for (const double top : {height - 0.05, height + 0.05}) {
        this->ball.effects = {across(effect_with(EffectKind::Net, {{"capacity", 20.0}, {"height", top}}), 6.0)};
        const auto end = this->fly();
        EXPECT_EQ(end.counters.crossings_struck, top > height ? 1 : 0);
    }
}

// In contact the net is met within the step that crosses it.
TYPED_TEST(EffectCrossing, NetStrikesARollingBall) {
    this->ball.soil = {"level", 0.0, 0.8, 0.0};
    this->ball.effects = {across(effect_with(EffectKind::Net, {{"capacity", 10.0}, {"height", 3.0}}), 4.0)};
    const auto end = this->ball.run(this->ball.sliding(0.0, 8.0, true), 1.0);
    const double start = 500.0 * (1.0 + this->ball.roundness()) * 64.0;
    EXPECT_NEAR(this->kinetic(end.state), start - 10e3, 1e-3 * start);
    EXPECT_EQ(end.counters.crossings_struck, 1);
}

// Rolling 8 m/s fast a block goes 6 cm in a step: what lies behind the net has not seen it.
TYPED_TEST(EffectCrossing, NetHoldsARollingBallUphillOfIt) {
    this->ball.soil = {"level", 0.0, 0.8, 0.0};
    this->ball.effects = {across(effect_with(EffectKind::Net, {{"capacity", 200.0}, {"height", 3.0}}), 4.0)};
    struct Farthest final : MotionSink<TypeParam::value> {
        double at = -kInfinity;
        void segment(const MotionSegment<TypeParam::value>& m) override {
            at = std::max({at, m.position[0], position_at(m, 1.0)[0]});
        }
    } sink;
    const auto end = this->ball.run(this->ball.sliding(0.0, 8.0, true), 1.0, &sink);
    EXPECT_EQ(end.reason, StopReason::AtRest);
    EXPECT_LT(end.state.position[0], 4.0);
    EXPECT_GT(end.state.position[0], 4.0 - 2e-3);
    EXPECT_LT(sink.at, 4.0);
    EXPECT_NEAR(end.time, 0.5, 1e-3);
}

// Nearer to each other than a step is long: each takes its share, and the second holds what the first has let through.
TYPED_TEST(EffectCrossing, NetsOneBehindAnotherAreBothMet) {
    this->ball.soil = {"level", 0.0, 0.8, 0.0};
    Effect net = across(effect_with(EffectKind::Net, {{"capacity", 5.0}, {"height", 3.0}}), 4.0);
    if constexpr (TypeParam::value == 3) {
        net.place.lines.push_back(
            {{4.01, -100.0, 0.0}, {4.01, 0.0, 0.0}, {4.01, 100.0, 0.0}});  // its post in the way: once
    } else {
        net.place.stations.push_back(4.01);
    }
    this->ball.effects = {net};
    const auto end = this->ball.run(this->ball.sliding(0.0, 8.0, true), 1.0);
    const double start = 500.0 * (1.0 + this->ball.roundness()) * 64.0;
    EXPECT_NEAR(this->kinetic(end.state), start - 10e3, 1e-3 * start);
    EXPECT_EQ(end.counters.crossings_struck, 2);
    this->ball.effects[0].set("capacity", 0.7e-3 * start);
    const auto held = this->ball.run(this->ball.sliding(0.0, 8.0, true), 1.0);
    EXPECT_EQ(held.reason, StopReason::AtRest);
    EXPECT_GT(held.state.position[0], 4.0);
    EXPECT_LT(held.state.position[0], 4.01);
}

// ---- trees -------------------------------------------------------------------------------------------------------------------------

TEST(TreeFormula, NumbersOfTheSource) {
    EXPECT_NEAR(effect_formula::tree_capacity(0.4, 1.0) / 1000.0, 194.3, 0.5);
    EXPECT_NEAR(effect_formula::tree_share(0.0), 0.98, 1e-3);
    EXPECT_NEAR(effect_formula::tree_share(0.58), -0.046 + 1.026 / 2.0, 1e-12);
    EXPECT_EQ(effect_formula::tree_share(1.0), 0.0);
}

TYPED_TEST(EffectCrossing, TreeTakesEnergyByItsOffset) {
    const double diameter = 0.3, reach = 0.5 * (1.0 + diameter);
    for (const double offset : {0.0, 0.3, 0.6}) {
        Effect trees = effect_with(EffectKind::Trees, {{"diameter", diameter}, {"height", 100.0}, {"strength", 0.2}});
        trees.place.points = {{6.0, offset, kNaN}, {8.0, 5.0, kNaN}};  // the second one stands beside the way
        this->ball.effects = {trees};
        const auto end = this->fly();
        const double loss = effect_formula::tree_capacity(diameter, 0.2) * effect_formula::tree_share(offset / reach);
        EXPECT_NEAR(end.energy_start - end.energy_end, loss, 1e-6 * end.energy_start);
        EXPECT_EQ(end.counters.crossings_struck, 1);
    }
}

// Nearer to each other than a step is long.
TYPED_TEST(EffectCrossing, TreesSideBySideAreBothMet) {
    this->ball.mass = 1e9;
    this->ball.soil = {"level", 0.0, 0.8, 0.0};
    Effect trees = effect_with(EffectKind::Trees, {{"diameter", 0.3}, {"height", 100.0}});
    trees.place.points = {{6.0, 0.2, kNaN}, {6.003, 0.3, kNaN}, {6.03, 0.4, kNaN}};
    this->ball.effects = {trees};
    EXPECT_EQ(this->ball.run(this->ball.sliding(0.0, 10.0, true), 2.0).counters.crossings_struck, 3);
    auto release = this->ball.at(0.0, 17.0);
    release.velocity[0] = 14.0;
    EXPECT_EQ(this->ball.run(release, 1.5).counters.crossings_struck, 3);
}

// The block is some 59 m up where it meets the tree.
TYPED_TEST(EffectCrossing, TreesArePassedAbove) {
    for (const double height : {57.0, 61.0}) {
        Effect trees = effect_with(EffectKind::Trees, {{"diameter", 0.3}, {"height", height}, {"strength", 0.2}});
        trees.place.points = {{6.0, 0.0, kNaN}};
        this->ball.effects = {trees};
        EXPECT_EQ(this->fly().counters.crossings_struck, height > 60.0 ? 1 : 0);
    }
}

// A stand without points: hits along a way W are Poisson with mean density (L + DBH) W. Blocks so heavy that they hardly notice.
TYPED_TEST(EffectCrossing, TreesAreMetAtTheirDensity) {
    this->ball.mass = 1e9;
    this->ball.soil = {"level", 0.0, 0.8, 0.0};
    for (const double density : {700.0, 10000.0}) {
        this->ball.effects = {
            between(effect_with(EffectKind::Trees, {{"diameter", 0.4}, {"density", density}}), 2.0, 18.0)};
        const double mean = 1e-4 * density * 1.4 * 16.0;
        std::int64_t flying = 0, rolling = 0;
        const bool dense = density > 1000.0;  // several in a step
        const int count = dense ? 200 : 400;
        for (int k = 0; k < count; ++k) {
            this->ball.block = static_cast<std::uint64_t>(k);
            rolling +=
                this->ball.run(this->ball.sliding(0.0, dense ? 30.0 : 10.0, true), 2.0).counters.crossings_struck;
            auto release = this->ball.at(0.0, 17.0);
            release.velocity[0] = 14.0;
            flying += this->ball.run(release, 1.5).counters.crossings_struck;
        }
        EXPECT_NEAR(static_cast<double>(rolling) / count, mean, 4.0 * std::sqrt(mean / count) + 0.01 * mean);
        EXPECT_NEAR(static_cast<double>(flying) / count, mean, 4.0 * std::sqrt(mean / count) + 0.01 * mean);
    }
}

// Whoever asks what a net does compares with and without: up to what stands in the way a block moves as it would without it, to the last digit.
TYPED_TEST(EffectCrossing, NothingChangesBeforeAnObstacle) {
    this->ball.soil = {"level", 0.6, 0.5, 0.01};
    auto release = this->ball.at(-15.0, 3.0);
    release.velocity[0] = 6.0;
    const auto without = this->ball.run(release, 4.0);
    ASSERT_LT(without.state.position[0], 12.0);
    ASSERT_GT(without.counters.impacts, 3);
    Effect tree = effect_with(EffectKind::Trees, {{"diameter", 0.3}, {"height", 30.0}});
    tree.place.points = {{14.0, 0.1, kNaN}};
    this->ball.effects = {across(effect_with(EffectKind::Net, {{"capacity", 200.0}, {"height", 5.0}}), 15.0), tree,
                          between(effect_with(EffectKind::Trees, {{"density", 1000.0}}), 13.0, 18.0),
                          between(effect_with(EffectKind::ForestDrag, {{"coefficient", 500.0}}), 13.0, 18.0)};
    const auto end = this->ball.run(release, 4.0);
    EXPECT_EQ(end.state.position, without.state.position);
    EXPECT_EQ(end.state.velocity, without.state.velocity);
    EXPECT_EQ(end.state.spin, without.state.spin);
    EXPECT_EQ(end.counters.crossings_struck, 0);
    EXPECT_GT(this->ball.run(release, 12.0).counters.crossings_struck, 0) << "it comes there";
}

// A border belongs to one side only: who starts on it, on either side of a forest, is in the forest at once.
TYPED_TEST(EffectCrossing, FlightsThatBeginOnABorderAreBraked) {
    const auto speed_after = [&](double from, double velocity) {
        auto release = this->ball.at(from, 20.0);
        release.velocity[0] = velocity;
        return std::abs(this->ball.run(release, 1.0).state.velocity[0]);
    };
    this->ball.effects = {
        between(effect_with(EffectKind::ForestDrag, {{"coefficient", 500.0}, {"height", 50.0}}), 5.0, 15.0)};
    const double braked = speed_after(5.001, 8.0);
    ASSERT_LT(braked, 6.0);
    EXPECT_NEAR(speed_after(5.0, 8.0), braked, 0.01);
    EXPECT_NEAR(speed_after(15.0, -8.0), braked, 0.01);
    EXPECT_EQ(speed_after(5.0, -8.0), 8.0);
    EXPECT_EQ(speed_after(15.0, 8.0), 8.0);
}

// ---- breaking ----------------------------------------------------------------------------------------------------------------------

TYPED_TEST(EffectCrossing, FastImpactsBreakTheBlock) {
    constexpr int kDim = TestFixture::kDimension;
    this->ball.soil = {"level", 0.5, 0.0, 0.0};
    this->ball.effects = {effect_with(EffectKind::Fragmentation, {{"speed", 6.0}, {"share", 0.4}, {"most", 2.0}})};
    auto release = this->ball.at(0.0, 4.0);  // 8.86 m/s
    release.velocity[0] = 3.0;
    MotionRecorder<kDim> motion;
    const double fall = std::sqrt(2.0 * 4.0 / g);
    const auto end = this->ball.run(release, fall + 0.05, &motion);
    EXPECT_EQ(end.counters.breaks, 1);
    EXPECT_NEAR(end.mass, 400.0, 1e-9);
    EXPECT_EQ(motion.segments().front().mass, 1000.0);
    EXPECT_NEAR(motion.segments().back().mass, 400.0, 1e-9);
    EXPECT_NEAR(motion.segments()[1].velocity_start[kDim - 1], 0.5 * std::sqrt(2.0 * g * 4.0), 1e-3);
    EXPECT_NEAR(motion.segments()[1].velocity_start[0], 3.0, 1e-9);
    EXPECT_NEAR(motion.segments()[1].start, motion.segments()[0].duration, 1e-12);
    EXPECT_NEAR(end.broke_at[0], 3.0 * fall, 1e-3);
    EXPECT_NEAR(end.broke_at[kDim - 1], release.position[kDim - 1] - 4.0, 1e-3);
    // energy: what is left is at most the share of what there was
    EXPECT_LT(end.energy_end, 0.4 * end.energy_start);

    this->ball.effects[0].set("share", 1.0);  // breaks nothing off
    const auto whole = this->ball.run(release, fall + 0.05);
    EXPECT_EQ(whole.counters.breaks, 0);
    EXPECT_TRUE(std::isnan(whole.broke_at[0]));
    this->ball.effects[0].set("share", 0.4);

    const auto slow = this->ball.run(this->ball.at(0.0, 1.5), 3.0);  // 5.4 m/s
    EXPECT_EQ(slow.counters.breaks, 0);
    EXPECT_EQ(slow.mass, 1000.0);
    EXPECT_TRUE(std::isnan(slow.broke_at[0]));
    // bounces at 15 and 7.5 m/s break it twice, a third one at less than 6 does not
    const auto twice = this->ball.run(this->ball.at(0.0, 11.5), 8.0);
    EXPECT_EQ(twice.counters.breaks, 2);
    EXPECT_NEAR(twice.mass, 160.0, 1e-9);
    EXPECT_NEAR(twice.broke_at[kDim - 1], end.broke_at[kDim - 1], 2e-3);
}

// ---- berms -------------------------------------------------------------------------------------------------------------------------

TEST(Berm, RaisesAGridByItsSection) {
    Grid<double> heights(GridShape{21, 11, 1.0, {0.0, 0.0}}, 100.0);
    heights.at(3, 3) = kNaN;
    Effect berm = effect_with(EffectKind::Berm, {{"height", 2.0}, {"width", 8.0}});
    berm.place.lines = {Points{{10.5, -5.0, kNaN}, {10.5, 20.0, kNaN}}};
    raise_berms(std::vector<Effect>{berm}, heights);
    for (int i = 0; i < 21; ++i)
        EXPECT_NEAR(heights.at(i, 5), 100.0 + 2.0 * std::max(0.0, 1.0 - std::abs(i - 10) / 4.0), 1e-12);
    EXPECT_TRUE(std::isnan(heights.at(3, 3)));
    // beyond the end of the line the section turns round
    berm.place.lines = {Points{{10.5, -5.0, kNaN}, {10.5, 5.5, kNaN}}};
    Grid<double> end(GridShape{21, 11, 1.0, {0.0, 0.0}}, 0.0);
    raise_berms(std::vector<Effect>{berm}, end);
    EXPECT_NEAR(end.at(10, 7), 1.0, 1e-12);
    EXPECT_NEAR(end.at(13, 8), 0.0 + 2.0 * std::max(0.0, 1.0 - std::hypot(3.0, 3.0) / 4.0), 1e-12);
}

// Along rows of nodes the crest stands as asked, between them it is cut down.
TEST(Berm, IsLowerBetweenTheNodes) {
    const GridShape shape{41, 41, 1.0, {0.0, 0.0}};
    Effect berm = effect_with(EffectKind::Berm, {{"height", 2.0}, {"width", 8.0}});
    const auto crest = [&](const Vec2& from, const Vec2& to) {
        berm.place.lines = {Points{{from.x(), from.y(), kNaN}, {to.x(), to.y(), kNaN}}};
        return crest_of(berm, shape);
    };
    EXPECT_NEAR(crest({10.5, 5.5}, {10.5, 30.5}).lowest, 2.0, 1e-12);
    EXPECT_NEAR(crest({11.0, 5.5}, {11.0, 30.5}).lowest, 2.0 * (1.0 - 2.0 * 0.5 / 8.0), 1e-12);
    // from south-west to north-east the line crosses the diagonals, whose ends are cells / sqrt(2) away
    const BermCrest across = crest({5.5, 5.5}, {30.5, 30.5});
    EXPECT_NEAR(across.lowest, 2.0 * (1.0 - 2.0 * std::sqrt(0.5) / 8.0), 0.01);
    EXPECT_NEAR(across.mean, 0.5 * (2.0 + across.lowest), 0.01);
    EXPECT_TRUE(std::isnan(crest({-20.0, 5.0}, {-20.0, 30.0}).mean)) << "off the terrain";
    // as a surface has it
    Grid<double> ground(shape, 100.0);
    berm.place.lines = {Points{{4.2, 7.1, kNaN}, {33.9, 21.3, kNaN}}};
    raise_berms(std::vector<Effect>{berm}, ground);
    const auto surface = make_grid_surface(ground, std::vector<SoilId>(2 * 40 * 40, 0));
    double lowest = kInfinity;
    for (int k = 0; k <= 1000; ++k)
        lowest = std::min(lowest, surface->height(Vec2(4.2, 7.1) + k / 1000.0 * Vec2(29.7, 14.2)) - 100.0);
    EXPECT_NEAR(crest_of(berm, shape).lowest, lowest, 0.01);
}

TEST(Berm, GivesAProfileCrestAndFeet) {
    const std::vector<Vec3> points{{0, 0, 50}, {30, 0, 35}, {60, 0, 35}};
    const std::vector<SoilId> soil{0, 1};
    const Profile profile = make_profile(points, soil);
    Effect berm = effect_with(EffectKind::Berm, {{"height", 3.0}, {"width", 10.0}});
    berm.place.stations = {32.0};
    const Profile raised = raise_berms(std::vector<Effect>{berm}, profile);
    EXPECT_EQ(raised.vertex_count(), 6U);
    for (double s = 0.5; s < 60.0; s += 0.25) {
        const double section = 3.0 * std::max(0.0, 1.0 - std::abs(s - 32.0) / 5.0);
        EXPECT_NEAR(raised.height_at(s), profile.height_at(s) + section, 1e-12);
        EXPECT_EQ(raised.soil_at(s), profile.soil_at(s));
    }
}

// ---- along a profile ---------------------------------------------------------------------------------------------------------------

TEST(EffectsAlongAProfile, MapBecomesChainage) {
    const std::vector<Vec3> points{{0, 0, 50}, {0, 40, 30}};
    const std::vector<SoilId> soil{0};
    const Profile profile = make_profile(points, soil);
    Effect drag = make_effect(EffectKind::ForestDrag);
    drag.place.limit_to({Polygon{{{-5, 10}, {5, 10}, {5, 25}, {-5, 25}}, {}}});
    Effect net = make_effect(EffectKind::Net);
    net.place.lines = {Points{{-5, 30, 0}, {5, 30, 0}}};
    Effect trees = make_effect(EffectKind::Trees);
    trees.place.points = {{2.0, 35.0, 0.0}, {-1.0, 12.0, 0.0}};
    trees.place.sort_points();
    const std::vector<Effect> along = effects_along(std::vector<Effect>{drag, net, trees}, profile);
    ASSERT_TRUE(along[0].place.reaches);
    ASSERT_EQ(along[0].place.reaches->size(), 1U);
    EXPECT_NEAR(along[0].place.reaches->front().from, 10.0, 1e-12);
    EXPECT_NEAR(along[0].place.reaches->front().to, 25.0, 1e-12);
    EXPECT_EQ(along[1].place.stations, std::vector<double>{30.0});
    EXPECT_NEAR(along[2].place.points[0].x(), 12.0, 1e-12);
    EXPECT_NEAR(along[2].place.points[0].y(), 1.0, 1e-12);  // on the left of the way north
    EXPECT_NEAR(along[2].place.points[1].y(), -2.0, 1e-12);
}

}  // namespace scree::test
