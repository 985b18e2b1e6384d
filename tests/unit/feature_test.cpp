// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/feature.hpp"

#include <gtest/gtest.h>

namespace scree {
namespace {

TEST(PlanDistance, OfAPolygonIsToItsNearestSideAndZeroInside) {
    const Ring outer{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, hole{{4, 4}, {4, 6}, {6, 6}, {6, 4}};
    const Geometry square = MultiPolygon{Polygon{outer, {hole}}};
    EXPECT_EQ(plan_distance({2, 3}, square), 0.0);
    EXPECT_DOUBLE_EQ(plan_distance({12, 3}, square), 2.0);
    EXPECT_DOUBLE_EQ(plan_distance({13, 14}, square), 5.0);
    EXPECT_DOUBLE_EQ(plan_distance({-1, 5}, square), 1.0);  // the side that closes it
    EXPECT_DOUBLE_EQ(plan_distance({5.2, 5}, square), 0.8);
}

TEST(PlanDistance, OfLinesAndPointsKnowsNoHeight) {
    const Geometry line = Polylines{Polyline{{{0, 0, 100}, {4, 0, 50}, {4, 3, kNaN}}, {}}};
    EXPECT_DOUBLE_EQ(plan_distance({2, -2}, line), 2.0);
    EXPECT_DOUBLE_EQ(plan_distance({4, 5}, line), 2.0);
    EXPECT_DOUBLE_EQ(plan_distance({0, 3}, line), 3.0);  // it is not closed
    EXPECT_DOUBLE_EQ(plan_distance({3, 4}, Points{{9, 9, 0}, {0, 0, 7}}), 5.0);
    EXPECT_EQ(plan_distance({3, 4}, Geometry{}), kInfinity);
}

}  // namespace
}  // namespace scree
