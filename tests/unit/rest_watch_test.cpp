// SPDX-License-Identifier: GPL-3.0-or-later
#include "dynamics/rest_watch.hpp"

#include <gtest/gtest.h>

namespace scree::test {
namespace {

constexpr double kRadius = 0.5, kStep = 0.01;

// A top stays in place and rests after five seconds; who bounces high in one place has been away.
TEST(RestWatch, WhoHasFlownHasNotStayed) {
    RestWatch<3> top, bouncing;
    const Vec3 place(1.0, 2.0, 3.0);
    bool rests = false;
    for (double time = 0.0; time < 5.5; time += kStep) rests = rests || top.in_place_for_long(place, kRadius, time);
    EXPECT_TRUE(rests);
    for (double time = 0.0; time < 60.0; time += 5.4)
        for (const double step : {0.0, kStep})
            EXPECT_FALSE(bouncing.in_place_for_long(place, kRadius, time + step)) << time;
}

}  // namespace
}  // namespace scree::test
