// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/fuzz.hpp"

#include <gtest/gtest.h>

namespace scree::test {
namespace {

/// Scenes that failed once: 45 a needle that spins so fast that the steps of its free rotation blew up; 765 a start across a crest; 865 to 1950 small
/// blocks whose steps in contact were longer than they are, or longer when shortened; 92600 a corner that was through a crest within a step; 93044 a
/// needle that stuck through a ridge where it was let go, with all its corners in the open; 119006, 189509, 193553 and 201954 plates that sank over
/// the rim of a hole or of the terrain; 178629 and 234812 corners that slipped over a crest and hooked under it; 2273148 and 2475644 thin corners
/// that the upright corner of a cliff got through between two looks; 3046357 to 3898987 blocks that leaned on a wall and were taken to be through
/// its crest.
constexpr std::uint64_t kOnceFailed[] = {45,     219,     765,     778,     865,     944,     1083,   1668,
                                         1950,   92600,   93044,   119006,  178629,  189509,  193553, 201954,
                                         234812, 2273148, 2475644, 3046357, 3574593, 3710704, 3898987};

TEST(Fuzz, TheFirstScenes) {
    for (std::uint64_t number = 0; number < 300; ++number) {
        const FuzzScene scene = fuzz_scene(number);
        EXPECT_EQ(fuzz_block(scene, fuzz_settings()).fault, "") << scene.what;
    }
}

TEST(Fuzz, ScenesThatOnceFailed) {
    for (const std::uint64_t number : kOnceFailed) {
        const FuzzScene scene = fuzz_scene(number);
        EXPECT_EQ(fuzz_block(scene, fuzz_settings()).fault, "") << scene.what;
    }
}

}  // namespace
}  // namespace scree::test
