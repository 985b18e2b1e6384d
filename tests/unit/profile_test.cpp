// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/profile.hpp"

#include "scree/base/error.hpp"
#include "support/rounding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree::test {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

/// 5 m to the north-east (3, 4) falling by 2 m, then 10 m to the east falling by 1 m, then 5 m to the south, level.
Profile bent() {
    const std::vector<Vec3> points{{10, 20, 100}, {13, 24, 98}, {23, 24, 97}, {23, 19, 97}};
    const std::vector<SoilId> soil{3, 1, 2};
    return make_profile(points, soil);
}

TEST(Profile, ChainageIsTheHorizontalDistance) {
    const Profile p = bent();
    EXPECT_THAT(p.s, ElementsAre(0.0, 5.0, 15.0, 20.0));
    EXPECT_THAT(p.z, ElementsAre(100.0, 98.0, 97.0, 97.0));
    EXPECT_THAT(p.soil, ElementsAre(3, 1, 2));
    EXPECT_EQ(p.length(), 20.0);
    EXPECT_EQ(p.reach_count(), 3U);
    EXPECT_FALSE(p.empty());
}

TEST(Profile, ValuesAtAChainage) {
    const Profile p = bent();
    EXPECT_NEAR(p.height_at(2.5), 99.0, kRounding);
    EXPECT_NEAR(p.height_at(7.0), 97.8, kRounding);
    EXPECT_EQ(p.soil_at(4.999), 3);
    EXPECT_EQ(p.soil_at(5.0), 1) << "at a vertex the reach that begins there";
    EXPECT_EQ(p.soil_at(20.0), 2) << "at the end the last one";
    EXPECT_NEAR((p.place_at(2.5) - Vec2(11.5, 22)).norm(), 0.0, kRounding);
    EXPECT_NEAR((p.direction_at(2.5) - Vec2(0.6, 0.8)).norm(), 0.0, kRounding);
    EXPECT_NEAR((p.direction_at(17) - Vec2(0, -1)).norm(), 0.0, kRounding);
    EXPECT_NEAR(p.slope_at(1.0), -0.4, kRounding);
    EXPECT_EQ(p.highest_between(2.5, 12.0), p.height_at(2.5));
    EXPECT_EQ(p.highest_between(12.0, 30.0), p.height_at(12.0));
    EXPECT_EQ(p.highest_between(21.0, 30.0), -kInfinity);
}

TEST(Profile, BeyondTheEndsThereIsNoGroundButAPlaceOnTheMap) {
    const Profile p = bent();
    EXPECT_TRUE(std::isnan(p.height_at(-0.1)));
    EXPECT_TRUE(std::isnan(p.height_at(20.1)));
    EXPECT_FALSE(p.contains(-0.1));
    EXPECT_TRUE(p.contains(20.0));
    EXPECT_NEAR((p.place_at(-5.0) - Vec2(7, 16)).norm(), 0.0, kRounding);
    EXPECT_NEAR((p.place_at(22.0) - Vec2(23, 17)).norm(), 0.0, kRounding);
}

TEST(Profile, ScreensCutIt) {
    const Profile p = bent();
    const std::vector<Vec2> across{{15, 0}, {15, 30}};
    EXPECT_THAT(p.crossings(across), ElementsAre(DoubleNear(7.0, kRounding)));
    const std::vector<Vec2> three_times{{12, 19}, {12, 30}, {30, 20}};
    EXPECT_THAT(p.crossings(three_times), ElementsAre(DoubleNear(10.0 / 3.0, kRounding), DoubleNear(14.8, kRounding),
                                                      DoubleNear(15.0 + 1.0 / 9.0, kRounding)));
    const std::vector<Vec2> beside{{0, 0}, {30, 0}};
    EXPECT_TRUE(p.crossings(beside).empty());
    const std::vector<Vec2> short_of_it{{15, 0}, {15, 23}};
    EXPECT_TRUE(p.crossings(short_of_it).empty());
}

TEST(Profile, AScreenWithACornerOnItCutsOnceOrNotAtAll) {
    const Profile p = bent();
    const std::vector<Vec2> through{{18, 20}, {18, 24}, {18, 30}};
    EXPECT_THAT(p.crossings(through), ElementsAre(DoubleNear(10.0, kRounding)));
    const std::vector<Vec2> touching{{17, 30}, {18, 24}, {19, 30}};
    EXPECT_TRUE(p.crossings(touching).empty());
    const std::vector<Vec2> at_a_vertex{{13, 10}, {13, 40}};
    EXPECT_THAT(p.crossings(at_a_vertex), ElementsAre(DoubleNear(5.0, kRounding)));
}

TEST(Profile, ZonesAreStretches) {
    const Profile p = bent();
    const Ring square{{14, 20}, {20, 20}, {20, 30}, {14, 30}}, hole{{16, 23}, {16, 25}, {17, 25}, {17, 23}};
    const auto stretches = p.inside({Polygon{square, {hole}}});
    ASSERT_EQ(stretches.size(), 2U);
    EXPECT_NEAR(stretches[0].from, 6.0, kRounding);
    EXPECT_NEAR(stretches[0].to, 8.0, kRounding);
    EXPECT_NEAR(stretches[1].from, 9.0, kRounding);
    EXPECT_NEAR(stretches[1].to, 12.0, kRounding);
    const auto all = p.inside({Polygon{{{0, 0}, {50, 0}, {50, 50}, {0, 50}}, {}}});
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].from, 0.0);
    EXPECT_EQ(all[0].to, 20.0);
    EXPECT_TRUE(p.inside({Polygon{{{40, 0}, {50, 0}, {50, 50}}, {}}}).empty());
}

// Along a border that two zones share every metre is in one of them, and a zone that is only touched keeps what lies in it.
TEST(Profile, ZonesWhoseBorderItFollows) {
    const std::vector<Vec3> points{{0, 5, 9}, {10, 5, 8}, {15, 0, 7}, {25, 0, 6}, {30, 5, 5}, {40, 5, 4}};
    const Profile p = make_profile(points, std::vector<SoilId>(5, 1));
    const Polygon north{{{-5, 0}, {50, 0}, {50, 20}, {-5, 20}}, {}},
        south{{{-5, -20}, {50, -20}, {50, 0}, {-5, 0}}, {}};
    const auto in_north = p.inside({north}), in_south = p.inside({south});
    double length = 0.0;
    for (const auto& stretches : {in_north, in_south})
        for (const Stretch& s : stretches) length += s.length();
    EXPECT_NEAR(length, p.length(), 1e-9);
    const double leg = std::sqrt(50.0);
    EXPECT_GE(std::count_if(in_north.begin(), in_north.end(), [&](const Stretch& s) { return s.from == 0.0; }), 1);
    EXPECT_NEAR(in_north.back().to, p.length(), 1e-9);
    EXPECT_LE(in_south.empty() ? 0.0 : in_south.front().length(), 10.0 + 1e-9);
    EXPECT_GE(length - (in_south.empty() ? 0.0 : in_south.front().length()), 20.0 + 2 * leg - 1e-9);
    // a wedge that is touched by its tip alone
    const auto touched = p.inside({Polygon{{{20, 0}, {30, -20}, {10, -20}}, {}}});
    EXPECT_TRUE(touched.empty());
}

TEST(Profile, NearestPointHasASide) {
    const Profile p = bent();
    EXPECT_NEAR(p.nearest({15, 26}).s, 7.0, kRounding);
    EXPECT_NEAR(p.nearest({15, 26}).offset, 2.0, kRounding) << "left of a line to the east is north";
    EXPECT_NEAR(p.nearest({15, 23}).offset, -1.0, kRounding);
    EXPECT_EQ(p.nearest({23, 0}).s, 20.0) << "beyond the end: the end";
    EXPECT_NEAR(std::abs(p.nearest({23, 0}).offset), 19.0, kRounding);
}

TEST(Profile, PointsInOnePlaceMakeNoReach) {
    const std::vector<Vec3> points{{0, 0, 5}, {0, 0, 5}, {3, 4, 1}, {3, 4, 0}};
    const std::vector<SoilId> soil{7, 8, 9};
    const Profile p = make_profile(points, soil);
    EXPECT_THAT(p.s, ElementsAre(0.0, 5.0));
    EXPECT_THAT(p.soil, ElementsAre(8));
    EXPECT_TRUE(make_profile(std::span(points).first(2), std::span(soil).first(1)).empty());
    EXPECT_TRUE(make_profile({}, {}).empty());
}

TEST(Profile, RefusesWhatDoesNotFit) {
    const std::vector<Vec3> points{{0, 0, 5}, {1, 0, kNaN}};
    const std::vector<SoilId> soil{7, 8};
    try {
        make_profile(points, soil);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_THAT(e.what(), HasSubstr("2 points needs 1 soils"));
    }
    try {
        make_profile(points, std::span(soil).first(1));
        FAIL();
    } catch (const InputError& e) {
        EXPECT_THAT(e.what(), HasSubstr("point 2"));
    }
}

}  // namespace
}  // namespace scree::test
