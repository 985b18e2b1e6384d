// SPDX-License-Identifier: GPL-3.0-or-later
// A sphere on a plane: sticking, rolling, sliding, coming to rest, spinning about the normal. Reference solutions a1-a5 and a9, and closed forms.
#include "support/sphere.hpp"

#include "support/motion.hpp"
#include "support/paths.hpp"
#include "support/reference.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scree::test {

namespace {

constexpr double kRadius = 0.5;  ///< of the reference spheres [m]
constexpr double kReferenceTolerance =
    1e-8;  ///< what the reference solutions are good for (their README) [m, m/s, rad/s]
/// The quaternions of the references are not that good: in a2 1.3e-7 rad off the closed form of steady rolling, and not of unit length.
constexpr double kReferenceAngle = 1e-6;  ///< [rad]
/// Start inside the plane by this much, as the references do: moreau_jean then has a contact from its first step [m].
constexpr double kInside = 1e-6;
/// Constant accelerations are integrated exactly by theta = 1/2: what remains is the solver's tolerance.
constexpr double kClosedForm = 1e-7;  ///< [m, m/s, rad/s]
constexpr double g = kStandardGravity;

SphereMechanics sphere_run(BallOnPlane<3>& plane, double mu, double mu_r, const DynamicsSettings& settings) {
    return {sphere_inertia(kRadius), plane, {Soil{"plane", 0.0, mu, mu_r}}, settings};
}

Vec3 plane_normal(double slope) {
    return {std::sin(slope), 0.0, std::cos(slope)};
}

}  // namespace

class SphereReference : public testing::TestWithParam<const char*> {};

TEST_P(SphereReference, WholeTrajectory) {
    SCREE_SHARED_OR_SKIP(folder, "reference");
    const ReferenceCase reference(folder, GetParam());
    const auto rows = reference.path();
    BallOnPlane<3> plane(kRadius, plane_normal(reference.number("alpha_deg") * kDegree));
    const auto run = sphere_run(plane, reference.number("mu"), reference.number("mu_r"), reference_settings());
    const auto states = march(run, rows.front().state, rows[1].time, rows.size());
    StateDeviation deviation;
    for (std::size_t k = 0; k < rows.size(); ++k) deviation.add(states[k], rows[k].state);
    RecordProperty("deviation", testing::PrintToString(deviation));
    EXPECT_LT(deviation.angle, kReferenceAngle) << deviation;
    deviation.angle = 0.0;
    EXPECT_LT(deviation.largest(), kReferenceTolerance) << deviation;
}

INSTANTIATE_TEST_SUITE_P(Cases, SphereReference,
                         testing::Values("a1_sphere_stick_no_roll", "a2_sphere_roll_no_slip",
                                         "a3_sphere_slide_and_roll", "a4_sphere_slide_no_roll",
                                         "a5_sphere_roll_to_rest", "a9_sphere_drilling_spin"),
                         [](const auto& p) { return std::string(p.param); });

class Sphere : public testing::TestWithParam<SteppingMode> {
protected:
    /// Released at rest on the slope for one second: end position down the slope, velocity and spin about the slope's horizontal axis against
    /// constant accelerations.
    void expect_accelerations(double slope, double mu, double mu_r, double acceleration, double spin_acceleration) {
        BallOnPlane<3> plane(kRadius, plane_normal(slope));
        auto settings = tight_settings(GetParam());
        settings.rest_time = kNeverRest;
        const auto run = sphere_run(plane, mu, mu_r, settings);
        const double time = 1.0;
        const TrajectoryEnd<3> end = run.until(time - 0.25 * settings.time_step, on_plane(slope, kRadius - kInside));
        const Vec3 moved = plane_frame(slope).conjugate() * end.state.position - Vec3(0, 0, kRadius - kInside);
        const Vec3 velocity = plane_frame(slope).conjugate() * end.state.velocity;
        EXPECT_NEAR(end.time, time, 0.3 * settings.time_step);
        const double t = end.time;
        EXPECT_NEAR(moved.x(), 0.5 * acceleration * t * t, kClosedForm);
        EXPECT_NEAR(moved.tail<2>().norm(), 0.0, kClosedForm);
        EXPECT_NEAR(velocity.x(), acceleration * t, kClosedForm);
        EXPECT_NEAR((end.state.orientation * end.state.spin).y(), spin_acceleration * t, kClosedForm);
        const Quat turned = plane_frame(slope + 0.5 * spin_acceleration * t * t);
        EXPECT_NEAR((turned.conjugate() * end.state.orientation).vec().norm(), 0.0, kClosedForm);
    }
};

INSTANTIATE_TEST_SUITE_P(Modes, Sphere, testing::Values(SteppingMode::Event, SteppingMode::MoreauJean),
                         [](const auto& p) {
                             return std::string(kSteppingModeNames[static_cast<std::size_t>(p.param)]);
                         });

TEST_P(Sphere, SticksBelowTheRollingAngle) {
    expect_accelerations(10 * kDegree, 0.5, 0.1, 0.0, 0.0);
}

TEST_P(Sphere, RollsExactlyAboveTheRollingAngle) {
    const double mu_r = 0.04;
    const double threshold = std::atan(mu_r / kRadius);
    expect_accelerations(0.99 * threshold, 0.5, mu_r, 0.0, 0.0);
    const double slope = 1.01 * threshold;
    const double a = g * (std::sin(slope) - mu_r / kRadius * std::cos(slope)) / 1.4;
    expect_accelerations(slope, 0.5, mu_r, a, a / kRadius);
}

TEST_P(Sphere, RollsWithoutSlip) {
    const double slope = 20 * kDegree, mu_r = 0.04;
    const double a = g * (std::sin(slope) - mu_r / kRadius * std::cos(slope)) / 1.4;
    expect_accelerations(slope, 0.5, mu_r, a, a / kRadius);
}

TEST_P(Sphere, SlidesAndRolls) {
    const double slope = 40 * kDegree, mu = 0.2, mu_r = 0.04;
    const double spin = (mu * kRadius - mu_r) * g * std::cos(slope) / (0.4 * kRadius * kRadius);
    expect_accelerations(slope, mu, mu_r, g * (std::sin(slope) - mu * std::cos(slope)), spin);
}

TEST_P(Sphere, SlidesWithoutRolling) {
    const double slope = 40 * kDegree, mu = 0.1;
    expect_accelerations(slope, mu, 0.2, g * (std::sin(slope) - mu * std::cos(slope)), 0.0);
}

// Deceleration g mu_r / (1.4 R) from 2 m/s: rest after 3.569 s and 3.569 m.
TEST_P(Sphere, RollsToRest) {
    BallOnPlane<3> plane(kRadius, Vec3::UnitZ());
    const DynamicsSettings settings = tight_settings(GetParam());
    const auto run = sphere_run(plane, 0.5, 0.04, settings);
    BlockState<3> release = on_plane(0.0, kRadius - kInside);
    release.velocity = {2.0, 0.0, 0.0};
    release.spin = {0.0, 4.0, 0.0};
    MotionRecorder<3> motion;
    const TrajectoryEnd<3> end = run.until(20.0, release, &motion);
    ASSERT_EQ(end.reason, StopReason::AtRest);
    const double stop = 2.0 / (g * 0.04 / (1.4 * kRadius));
    EXPECT_LT(end.state.velocity.norm(), 1e-9);
    const auto& all = motion.segments();
    const auto still = std::find_if(all.begin(), all.end(), [](const auto& s) { return s.velocity_end.norm() < 1e-9; });
    ASSERT_NE(still, all.end());
    EXPECT_NEAR(still->start + still->duration, stop, settings.time_step);  // the law stops it within the step
    EXPECT_NEAR(end.time, stop + settings.rest_time,
                2.0 * settings.time_step + 0.01);  // rest may begin 1e-6 m of head before the stop: 7 ms
    EXPECT_NEAR(end.state.position.x(), stop,
                2.0 * settings.time_step * settings.time_step);  // half of the last step's speed times its length
}

// No moment about N in the law: the spin stays for ever, and it counts as rest.
TEST_P(Sphere, SpinAboutTheNormalIsNotResistedAndIsRest) {
    for (const double slope : {0.0, 4 * kDegree}) {
        BallOnPlane<3> plane(kRadius, plane_normal(slope));
        DynamicsSettings settings = tight_settings(GetParam());
        BlockState<3> release = on_plane(slope, kRadius - kInside);
        release.spin = {0.0, 0.0, 3.0};
        const TrajectoryEnd<3> rested = sphere_run(plane, 0.5, 0.04, settings).until(10.0, release);
        EXPECT_EQ(rested.reason, StopReason::AtRest);
        EXPECT_LT(rested.time, 0.1);
        settings.rest_time = kNeverRest;
        const TrajectoryEnd<3> later = sphere_run(plane, 0.5, 0.04, settings).until(2.0, release);
        EXPECT_EQ(later.reason, StopReason::TimeLimit);
        EXPECT_NEAR((later.state.spin - Vec3(0, 0, 3)).norm(), 0.0, kClosedForm);
        EXPECT_NEAR((later.state.position - release.position).norm(), 0.0, kClosedForm);
    }
}

}  // namespace scree::test
