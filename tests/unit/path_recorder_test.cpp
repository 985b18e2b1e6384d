// SPDX-License-Identifier: GPL-3.0-or-later
// What is recorded of a motion.
#include "ensemble/path_recorder.hpp"

#include "support/scenes.hpp"

#include <gtest/gtest.h>

namespace scree {
namespace {

// Friction turns translation into rotation, and back: at no time does the block have the most of both.
TEST(PathRecorder, TheLargestEnergyIsOfBothMotionsAtOneTime) {
    CampaignInput input;
    input.passages = false;
    MotionSegment<3> m;
    m.duration = 0.1;
    m.mass = 1000.0;
    m.velocity_start = {10.0, 0.0, 0.0};
    m.velocity_end = {8.0, 0.0, 0.0};
    m.rotation_energy_start = 0.0;
    m.rotation_energy_end = 15e3;
    BlockResult braked, spun;
    MapRecorder first(input, 0, braked), second(input, 1, spun);
    first.segment(m);
    EXPECT_DOUBLE_EQ(braked.largest_energy, 50e3);
    m.rotation_energy_end = 25e3;
    second.segment(m);
    EXPECT_DOUBLE_EQ(spun.largest_energy, 32e3 + 25e3);
}

// A block that turns about its middle axis tumbles: at a screen it has the spin of that time, far from the mean of both ends.
TEST(PathRecorder, SpinAtAScreenIsThatOfTheTime) {
    const Vec3 moment(60.0, 100.0, 130.0);
    CampaignInput input;
    input.passages = false;
    const auto ground = test::inclined_plane(0.0, 20.0);
    input.surface = ground.get();
    input.screens = {{"S", {{1.0, -5.0}, {1.0, 5.0}}, -1}};
    MotionSegment<3> m;
    m.duration = 4.0;
    m.mass = 1000.0;
    m.velocity_start = m.velocity_end = {0.5, 0.0, 0.0};  // there after 2 s
    m.turning = {0.5, 6.0, 0.0};
    m.free_moment = moment;
    m.spin_start = m.turning.norm();
    Vec3 spin = m.turning, later = m.turning;
    const auto rate = [&](const Vec3& w) {
        return Vec3((moment[1] - moment[2]) * w[1] * w[2] / moment[0],
                    (moment[2] - moment[0]) * w[2] * w[0] / moment[1],
                    (moment[0] - moment[1]) * w[0] * w[1] / moment[2]);
    };
    constexpr double kStep = 1e-4;
    for (int k = 0; k < 40000; ++k) {
        const Vec3 half = later + 0.5 * kStep * rate(later);
        later += kStep * rate(half);
        if (k < 20000) spin = later;
    }
    m.spin_end = later.norm();
    BlockResult result;
    MapRecorder recorder(input, 0, result);
    recorder.segment(m);
    const auto crossings = recorder.crossings();
    ASSERT_EQ(crossings.size(), 1u);
    EXPECT_NEAR(crossings[0].spin, spin.norm(), 1e-4);
    EXPECT_GT(std::abs(spin.norm() - 0.5 * (m.spin_start + m.spin_end)), 0.05) << "or the test says nothing";
}

// In the fixed steps of moreau_jean an impulse lies somewhere in a step: at a screen the block moves as before it or as after it.
TEST(PathRecorder, NoCrossingIsBetweenBeforeAndAfterAnImpulse) {
    CampaignInput input;
    input.passages = false;
    const auto ground = test::inclined_plane(0.0, 20.0);
    input.surface = ground.get();
    input.screens = {{"early", {{0.2, -5.0}, {0.2, 5.0}}, -1}, {"late", {{0.8, -5.0}, {0.8, 5.0}}, -1}};
    MotionSegment<3> m;
    m.duration = 0.1;
    m.mass = 1000.0;
    m.position = {0.0, 0.0, 1.0};
    m.velocity_start = {10.0, 0.0, -5.0};
    m.velocity_end = {10.0, 0.0, 3.0};
    m.spin_start = 1.0;
    m.spin_end = m.spin_most = 2.0;
    m.rotation_energy_end = 1e3;
    m.in_contact = m.struck = true;
    BlockResult result;
    MapRecorder recorder(input, 0, result);
    recorder.segment(m);
    const auto crossings = recorder.crossings();
    ASSERT_EQ(crossings.size(), 2u);
    EXPECT_EQ(crossings[0].velocity, m.velocity_start);
    EXPECT_EQ(crossings[0].energy, 62.5e3);
    EXPECT_EQ(crossings[0].spin, 1.0);
    EXPECT_EQ(crossings[1].velocity, m.velocity_end);
    EXPECT_EQ(crossings[1].energy, 54.5e3 + 1e3);
    EXPECT_EQ(crossings[1].spin, 2.0);
}

}  // namespace
}  // namespace scree
