// SPDX-License-Identifier: GPL-3.0-or-later
// The 2D model against closed forms: bodies that slide, roll, bounce, tip and rest on a slope; energy; straight ground cut into pieces; random polygons
// on random ground.
#include "dynamics/plane_contacts.hpp"

#include "support/ball_on_plane.hpp"
#include "support/motion.hpp"
#include "support/plane_fuzz.hpp"
#include "support/plane_scenes.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scree::test {

namespace {

constexpr double g = kStandardGravity;
constexpr double kInside =
    1e-6;  ///< start inside the ground: moreau_jean then has its contacts from the first step [m]

std::string mode_name(const testing::TestParamInfo<SteppingMode>& p) {
    return kSteppingModeNames[static_cast<std::size_t>(p.param)];
}

}  // namespace

class Plane : public testing::TestWithParam<SteppingMode> {
protected:
    DynamicsSettings settings() const { return tight_settings(GetParam()); }
    /// A box a x b with its lower side on the slope, 10 m down from its top.
    TrajectoryEnd<2> box(double a, double b, double slope, const Soil& soil, double time,
                         const Vec2& velocity = Vec2::Zero()) const {
        const ConvexPolygon block = make_polygon_from_points(rectangle(a, b), 1000.0);
        const GroundLine ground = inclined_line(slope);
        BlockState<2> release = on_slope(slope, 10.0, 0.5 * b - kInside);
        release.velocity = velocity;
        return PolygonMechanics{block, ground, {soil}, settings()}.until(time, release);
    }
    /// A disc of radius 0.5 m and mass 1000 kg.
    TrajectoryEnd<2> disc(double slope, const Soil& soil, double time, const Vec2& velocity = Vec2::Zero()) const {
        DynamicsSettings limited = settings();
        limited.time_limit = time;
        limited.rest_time = kNeverRest;
        const std::vector<Soil> soils{soil};
        BlockState<2> release = on_slope(slope, 10.0, 0.5 - kInside);
        release.velocity = velocity;
        release.spin[0] = -velocity.norm() / 0.5;
        return run_on_plane<2>({1000.0, Space<2>::Spin(0.5 * 1000.0 * 0.25)}, {0.5, {std::sin(slope), std::cos(slope)}},
                               soils, limited, release);
    }
    static double along(double slope, const Vec2& v) { return v.x() * std::cos(slope) - v.y() * std::sin(slope); }
    static double upwards(double slope, const Vec2& v) { return v.x() * std::sin(slope) + v.y() * std::cos(slope); }
};

INSTANTIATE_TEST_SUITE_P(Modes, Plane, testing::Values(SteppingMode::Event, SteppingMode::MoreauJean), mode_name);

// a = g (sin - mu cos), no turn. The box is flat, so that it does not tip.
TEST_P(Plane, BoxSlidesDownTheSlope) {
    const double slope = 35 * kDegree, mu = 0.5, time = 1.5;
    const TrajectoryEnd<2> end = box(1.0, 0.4, slope, {"s", 0.0, mu, 0.04}, time - 0.25 * settings().time_step);
    const double a = g * (std::sin(slope) - mu * std::cos(slope));
    EXPECT_EQ(end.reason, StopReason::TimeLimit);
    EXPECT_NEAR((along(slope, end.state.position) - 10.0) / (0.5 * a * end.time * end.time), 1.0, 1e-6);
    EXPECT_NEAR(upwards(slope, end.state.position), 0.2, 1e-5);
    EXPECT_NEAR(end.state.spin[0], 0.0, 1e-6);
}

// Kinetic energy is spent by friction after v^2 / (2 g (mu cos - sin)).
TEST_P(Plane, BoxSlidesToRest) {
    const double slope = 15 * kDegree, mu = 0.5, v = 4.0;
    const TrajectoryEnd<2> end =
        box(1.0, 0.2, slope, {"s", 0.0, mu, 0.04}, 20.0, v * Vec2(std::cos(slope), -std::sin(slope)));
    const double way = v * v / (2.0 * g * (mu * std::cos(slope) - std::sin(slope)));
    EXPECT_EQ(end.reason, StopReason::AtRest);
    // the first step takes the overlap of the start into account and may begin half a step later
    EXPECT_NEAR((along(slope, end.state.position) - 10.0) / way, 1.0, 2e-3);
}

TEST_P(Plane, BoxSticksBelowTheFrictionAngle) {
    const double slope = 20 * kDegree;
    const TrajectoryEnd<2> end = box(1.0, 0.6, slope, {"s", 0.0, 0.5, 0.04}, 5.0);
    EXPECT_EQ(end.reason, StopReason::AtRest);
    EXPECT_NEAR(along(slope, end.state.position), 10.0, 1e-8);
}

// A box a x b on its side b stands up to tan = (b + 2 mu_r) / a: the weight passes through the lower corner, and the rolling moment mu_r N helps.
TEST_P(Plane, BoxTipsBeyondTheRestAngle) {
    const double a = 1.0, b = 0.5, mu_r = 0.05;
    const double rest_angle = std::atan((b + 2.0 * mu_r) / a);
    EXPECT_EQ(box(b, a, rest_angle - 0.01, {"s", 0.0, 2.0, mu_r}, 3.0).reason, StopReason::AtRest);
    const TrajectoryEnd<2> over = box(b, a, rest_angle + 0.01, {"s", 0.0, 2.0, mu_r}, 3.0);
    EXPECT_LT(over.state.orientation, -rest_angle - 1.0);  // it fell over
}

// alpha0 = g (L/2 (sin - cos) - mu_r cos) / (2/3 L^2 + mu_r L/2), as the cube in 3D (README of the reference solutions).
TEST_P(Plane, SquareTipsOverItsLowerCorner) {
    const double slope = 50 * kDegree, mu_r = 0.04, L = 1.0;
    const double alpha0 = g * (0.5 * L * (std::sin(slope) - std::cos(slope)) - mu_r * std::cos(slope)) /
                          (2.0 / 3.0 * L * L + 0.5 * mu_r * L);
    const ConvexPolygon block = make_polygon_from_points(rectangle(L, L), 1000.0);
    const GroundLine ground = inclined_line(slope);
    DynamicsSettings fine = settings();
    fine.time_step = 1e-3;
    const TrajectoryEnd<2> end = PolygonMechanics{block, ground, {{"s", 0.0, 1.5, mu_r}}, fine}.until(
        0.004 - 0.25e-3, on_slope(slope, 10.0, 0.5 - kInside));
    EXPECT_NEAR(end.state.spin[0] / (-alpha0 * end.time), 1.0, 1e-4);  // downhill is from z to x: negative
}

// Rolling without slip: a = g (sin - mu_r / R cos) / (1 + k^2 / R^2), k^2 = R^2 / 2 for a disc.
TEST_P(Plane, DiscRollsAgainstTheRollingResistance) {
    const double slope = 20 * kDegree, mu_r = 0.04, R = 0.5, time = 2.0;
    const TrajectoryEnd<2> end = disc(slope, {"s", 0.0, 0.5, mu_r}, time - 0.25 * settings().time_step);
    const double a = g * (std::sin(slope) - mu_r / R * std::cos(slope)) / 1.5;
    EXPECT_NEAR((along(slope, end.state.position) - 10.0) / (0.5 * a * end.time * end.time), 1.0, 1e-8);
    EXPECT_NEAR(end.state.spin[0] / (-a * end.time / R), 1.0, 1e-8);
}

// R tan <= mu_r: it stays.
TEST_P(Plane, DiscHeldByTheRollingResistance) {
    const TrajectoryEnd<2> end = disc(10 * kDegree, {"s", 0.0, 0.5, 0.1}, 2.0);
    EXPECT_NEAR(along(10 * kDegree, end.state.position), 10.0, 1e-8);
}

// On the flat it rolls on for v / (g mu_r / (R (1 + k^2 / R^2))).
TEST_P(Plane, DiscRollsToRest) {
    const double mu_r = 0.04, v = 2.0, R = 0.5, time = v * 1.5 * R / (g * mu_r);
    const TrajectoryEnd<2> before = disc(0.0, {"s", 0.0, 0.5, mu_r}, time - 0.1, {v, 0.0});
    EXPECT_NEAR(before.state.velocity.x(), v - g * mu_r / (1.5 * R) * before.time, 1e-7);
    const TrajectoryEnd<2> after = disc(0.0, {"s", 0.0, 0.5, mu_r}, time + 0.1, {v, 0.0});
    EXPECT_NEAR(after.state.velocity.norm(), 0.0, 1e-9);
    EXPECT_NEAR(after.state.position.x() - 10.0, 0.5 * v * time, 2e-3 * v);  // moreau_jean stops within a step
}

// A box that falls flat rebounds to e^2 of the height.
TEST_P(Plane, BouncesWithTheRestitution) {
    const double e = 0.6, height = 2.0;
    const ConvexPolygon block = make_polygon_from_points(rectangle(1.0, 1.0), 1000.0);
    const GroundLine ground = ground_of({{0.0, 0.0}, {20.0, 0.0}});
    BlockState<2> release;
    release.position = {10.3, 0.5 + height};
    MotionRecorder<2> motion;
    const double fall = std::sqrt(2.0 * height / g), apex = fall * (1.0 + e);
    PolygonMechanics{block, ground, {{"s", e, 0.5, 0.0}}, settings()}.until(apex + 0.5 * e * fall, release, &motion);
    double highest = 0.0;
    for (double t = 1.1 * fall; t < apex + 0.4 * e * fall; t += 1e-3)
        highest = std::max(highest, motion.position(t).y() - 0.5);
    // moreau_jean places the impact within a step: v h of the height
    const double step_error = GetParam() == SteppingMode::MoreauJean ? 1e-3 * std::sqrt(2.0 * g * height) : 1e-3;
    EXPECT_NEAR(highest, e * e * height, 2.0 * step_error);
}

// An oblique impact of a corner straight below the centre (e = 0): sticking needs a tangential impulse of at most mu r_N, else the block slides on with
// u_T - mu (1 + R^2 / k^2) |u_N|.
TEST(PlaneImpact, CornerSticksOrSlides) {
    const ConvexPolygon block = make_polygon_from_points(regular_polygon(4, 0.5), 1000.0);
    const GroundLine ground = ground_of({{0.0, 0.0}, {20.0, 0.0}});
    const double k2 = block.inertia / block.mass, lever = 1.0 + 0.25 / k2, start = 3.0, gap = 1e-3;
    const double fall = std::sqrt(start * start + 2.0 * g * gap);
    for (const double mu : {0.1, 0.3, 2.0}) {
        BlockState<2> release;
        release.position = {10.0, 0.5 + gap};
        release.velocity = {2.0, -start};
        const DynamicsSettings settings = tight_settings(SteppingMode::Event);
        const double landing = (fall - start) / g;
        const TrajectoryEnd<2> end =
            PolygonMechanics{block, ground, {{"s", 0.0, mu, 0.0}}, settings}.until(landing + 1e-7, release);
        const double slip = std::max(0.0, 2.0 - mu * lever * fall), push = (slip - 2.0) / lever;  // change of velocity
        EXPECT_NEAR(end.state.velocity.x(), 2.0 + push, 1e-4) << mu;
        EXPECT_NEAR(end.state.spin[0], 0.5 * push / k2, 1e-3) << mu;  // the arm points down: turning from x to z
    }
}

// The same line in other pieces is the same ground: from corners of one metre to a hundred a metre, some a micrometre apart.
TEST_P(Plane, PiecesOfAStraightLineMakeNoDifference) {
    const double slope = 30 * kDegree;
    RandomStream random(9, 9, RandomPurpose::Shape);
    const ConvexPolygon block = make_polygon({}, {0.9, 0.7, 0.5}, 500.0, random);
    std::vector<Vec2> many;
    for (double s = 0.0; s < 80.0; s += std::exp(random.uniform(std::log(1e-6), std::log(0.1))))
        many.emplace_back(s, -std::tan(slope) * s);
    BlockState<2> release = on_slope(slope, 2.0, 1.5);
    release.spin[0] = -2.0;
    const std::vector<Soil> soils{{"s", 0.3, 0.5, 0.02}};
    DynamicsSettings tight = settings();
    tight.activation_gap = 1e-6;
    const GroundLine whole = inclined_line(slope, 80.0, 80.0), metres = inclined_line(slope, 80.0, 1.0),
                     pieces = ground_of(many);
    const double time = 1.5;
    const auto a = PolygonMechanics{block, whole, soils, tight}.until(time, release);
    EXPECT_GT(along(slope, a.state.position), 5.0);
    for (const GroundLine* ground : {&metres, &pieces}) {
        const auto b = PolygonMechanics{block, *ground, soils, tight}.until(time, release);
        EXPECT_NEAR((a.state.position - b.state.position).norm(), 0.0, 1e-5);
        EXPECT_NEAR(a.state.orientation, b.state.orientation, 1e-5);
    }
}

// No step ends with more energy than it began with, but for 1e-6 m of head; and the whole is spent.
TEST(PlaneEnergy, NeverGrows) {
    std::int64_t steps = 0;
    for (std::uint64_t number = 1000; number < 1200; ++number) {
        const PlaneFuzzScene scene = plane_fuzz_scene(number);
        DynamicsSettings settings;
        settings.time_limit = 30.0;
        const TrajectoryEnd<2> end = plane_fuzz_block(scene, settings).end;
        EXPECT_LE(end.counters.largest_energy_rise, 1.01e-6) << scene.what;
        EXPECT_LE(end.energy_end, end.energy_start * (1.0 + 1e-12) + 1e-6 * scene.block.mass * g) << scene.what;
        steps += end.counters.contact_steps;
    }
    EXPECT_GT(steps, 10000);
}

// The sum of two times may round to just less than the limit: a block that flies then must not fly for ever.
TEST(PlaneFlight, EndsAtAnyTimeLimit) {
    const ConvexPolygon block = make_polygon_from_points(regular_polygon(20, 0.5), 1000.0);
    const GroundLine ground = inclined_line(5 * kDegree);
    for (int k = 0; k < 400; ++k) {
        const double limit = 0.95 + 0.001 * k;  // after a fall of 1 m and a bounce it flies until 1.2 s
        const TrajectoryEnd<2> end =
            PolygonMechanics{block, ground, {{"s", 0.9, 0.5, 0.04}}, {}}.until(limit, on_slope(5 * kDegree, 10.0, 1.5));
        EXPECT_EQ(end.reason, StopReason::TimeLimit);
        EXPECT_NEAR(end.time, limit, 0.01);
    }
}

TEST(PlaneFuzz, RandomPolygonsOnRandomGround) {
    DynamicsSettings settings;
    settings.time_limit = 30.0;
    for (std::uint64_t number = 0; number < 1500; ++number) {
        const PlaneFuzzScene scene = plane_fuzz_scene(number);
        EXPECT_EQ(plane_fuzz_block(scene, settings).fault, "") << scene.what;
    }
}

// Small plates flew through crests that they passed by nearer than 5 mm, which is more than they are thick.
TEST(PlaneFuzz, SmallBlocksWaitForCrestsThatTheyPassBy) {
    DynamicsSettings settings;
    settings.time_limit = 30.0;
    for (const std::uint64_t number : {1539, 15215, 24193, 26219, 33695, 34688}) {
        const PlaneFuzzScene scene = plane_fuzz_scene(number);
        EXPECT_EQ(plane_fuzz_block(scene, settings).fault, "") << scene.what;
    }
}

// Corners that slipped over a crest and hooked under it; where a crest was hardly cut, a corner far off was taken for the one that should be raised.
TEST(PlaneFuzz, CornersDoNotHookUnderCrests) {
    DynamicsSettings settings;
    settings.time_limit = 30.0;
    for (const std::uint64_t number :
         {60279, 160735, 189698, 196275, 305058, 312740, 1002304, 1004994, 1006656, 1007670, 1014176}) {
        const PlaneFuzzScene scene = plane_fuzz_scene(number);
        EXPECT_EQ(plane_fuzz_block(scene, settings).fault, "") << scene.what;
    }
}

// Fast elastic blocks that do not rub on rough ground: within a step of 8 ms a crest leaves their side, and to hold it there would make energy of metres of fall.
TEST(PlaneEnergy, NoStepHoldsACrestThatHasLeftTheBlock) {
    RandomStream random(5, 0, RandomPurpose::Shape);
    std::vector<Vec2> corners;
    for (int k = 0; k <= 120; ++k) corners.emplace_back(k, -0.7 * k + random.uniform(-0.3, 0.3));
    const GroundLine ground = ground_of(corners);
    double rise = 0.0;
    std::int64_t steps = 0, failed = 0;
    for (int number = 0; number < 300; ++number) {
        ShapeSettings hull;
        const ConvexPolygon block = make_polygon(hull, Vec3(1.0, 0.8, 0.6) * random.uniform(0.4, 1.6), 800.0, random);
        BlockState<2> release;
        release.position = {3.0, 2.0 + random.uniform(0.0, 3.0)};
        release.velocity = {random.uniform(0.0, 8.0), 0.0};
        const TrajectoryEnd<2> end =
            PolygonMechanics{block, ground, {Soil{"slope", 1.0, 0.0, 0.0}}, DynamicsSettings{}}.until(20.0, release);
        rise = std::max(rise, end.counters.largest_rise_taken_back);
        steps += end.counters.contact_steps;
        failed += end.reason == StopReason::Failed;
    }
    EXPECT_LT(rise, 0.02);
    EXPECT_GT(steps, 300);
    EXPECT_EQ(failed, 0);
}

}  // namespace scree::test
