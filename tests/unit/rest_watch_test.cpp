// SPDX-License-Identifier: GPL-3.0-or-later
#include "dynamics/rest_watch.hpp"

#include <gtest/gtest.h>

namespace scree::test {
namespace {

constexpr double kRadius = 0.5, kGravity = 9.81, kStep = 0.01;

// A top stays in place and rests after five seconds; who bounces high in one place has been away.
TEST(RestWatch, WhoHasFlownHasNotStayed) {
    RestWatch<3> top, bouncing;
    BlockState<3> place;
    place.position = {1.0, 2.0, 3.0};
    bool rests = false;
    for (double time = 0.0; time < 5.5; time += kStep)
        rests = rests || top.in_place_for_long(place, kRadius, kGravity, time);
    EXPECT_TRUE(rests);
    for (double time = 0.0; time < 60.0; time += 5.4)
        for (const double step : {0.0, kStep})
            EXPECT_FALSE(bouncing.in_place_for_long(place, kRadius, kGravity, time + step)) << time;
}

// Bounces of a quarter of a metre take less than half a second, and are seen at the ground only.
TEST(RestWatch, WhoBouncesInPlaceHasNotStayed) {
    RestWatch<3> bouncing;
    BlockState<3> leaving;
    leaving.velocity = {0.0, 0.0, 2.2};
    for (double time = 0.0; time < 20.0; time += 0.45)
        EXPECT_FALSE(bouncing.in_place_for_long(leaving, kRadius, kGravity, time)) << time;
}

// A boulder that creeps by 2 cm/s moves less than a twentieth of its radius in five seconds, and yet it moves.
TEST(RestWatch, LargeBlocksThatCreepDoNotRest) {
    constexpr double kBoulder = 4.0;
    const auto rests = [](double speed) {
        RestWatch<3> watch;
        BlockState<3> s;
        for (double time = 0.0; time < 20.0; time += kStep) {
            s.position.x() = speed * time;
            if (watch.in_place_for_long(s, kBoulder, kGravity, time)) return true;
        }
        return false;
    };
    EXPECT_FALSE(rests(0.02));
    EXPECT_TRUE(rests(0.005));
}

}  // namespace
}  // namespace scree::test
