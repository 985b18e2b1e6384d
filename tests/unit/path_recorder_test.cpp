// SPDX-License-Identifier: GPL-3.0-or-later
// What is recorded of a motion.
#include "ensemble/path_recorder.hpp"

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

}  // namespace
}  // namespace scree
