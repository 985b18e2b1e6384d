// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/region.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scree {

namespace {

Ring rectangle(double x0, double y0, double x1, double y1) {
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

}  // namespace

TEST(Region, PolygonWithHole) {
    const Region region({Polygon{rectangle(0, 0, 4, 2), {rectangle(1, 0.5, 2, 1.5)}}});
    EXPECT_DOUBLE_EQ(region.area(), 7.0);
    EXPECT_TRUE(region.contains({0.5, 1.0}));
    EXPECT_FALSE(region.contains({1.5, 1.0}));
    EXPECT_TRUE(region.contains({3.0, 1.0}));
    EXPECT_FALSE(region.contains({5.0, 1.0}));
}

TEST(Region, OverlappingPolygonsAreAUnionForContains) {
    const Region region({Polygon{rectangle(0, 0, 2, 2), {}}, Polygon{rectangle(1, 1, 3, 3), {}}});
    EXPECT_TRUE(region.contains({1.5, 1.5}));
    EXPECT_TRUE(region.contains({0.5, 0.5}));
    EXPECT_FALSE(region.contains({0.5, 2.5}));
}

TEST(Region, SamplesUniformlyByArea) {
    // a square with a hole of a quarter of its area, and a detached triangle
    const Region region(
        {Polygon{rectangle(0, 0, 2, 2), {rectangle(0.5, 0.5, 1.5, 1.5)}}, Polygon{{{10, 0}, {12, 0}, {10, 1}}, {}}});
    RandomStream random(11, 0, RandomPurpose::ReleasePosition);
    const int n = 40000;
    int triangle = 0, left = 0;
    for (int i = 0; i < n; ++i) {
        const Vec2 p = region.sample(random);
        ASSERT_TRUE(region.contains(p));
        triangle += p.x() > 5;
        left += p.x() < 1;
    }
    EXPECT_NEAR(triangle / double(n), 1.0 / 4.0, 5 * std::sqrt(0.25 * 0.75 / n));
    EXPECT_NEAR(left / double(n), 1.5 / 4.0, 5 * std::sqrt(0.375 * 0.625 / n));
}

// A needle fills hardly any of its box, and an overlay leaves such: a wedge of 100 m, 1 mm wide at its thick end, with a cut in it.
TEST(Region, SamplesSlivers) {
    const Vec2 along = Vec2(3.0, 4.0) / 5.0, across(-along.y(), along.x());
    const Region region({Polygon{{Vec2(0, 0), 60.0 * along, 60.0 * along + 1e-3 * across, 1e-3 * across}, {}},
                         Polygon{{70.0 * along, 100.0 * along, 100.0 * along + 2e-3 * across}, {}}});
    EXPECT_NEAR(region.area(), 0.09, 1e-9);
    RandomStream random(11, 0, RandomPurpose::ReleasePosition);
    const int n = 20000;
    int wedge = 0, thick = 0, first = 0;
    for (int i = 0; i < n; ++i) {
        const Vec2 p = region.sample(random);
        const double s = p.dot(along), aside = p.dot(across);
        ASSERT_GE(aside, -1e-9);
        ASSERT_LE(aside, 2e-3 + 1e-9);
        ASSERT_TRUE((s > -1e-6 && s < 60.0 + 1e-6) || (s > 70.0 - 1e-6 && s < 100.0 + 1e-6));
        wedge += s > 65.0;
        thick += s > 85.0;
        first += s < 20.0;
    }
    const auto near = [&](int count, double share) {
        EXPECT_NEAR(count / double(n), share, 4 * std::sqrt(share * (1 - share) / n));
    };
    near(wedge, 1.0 / 3.0);
    near(thick, 0.75 / 3.0);
    near(first, 2.0 / 9.0);
}

TEST(Region, ManyVerticesAreLocatedExactly) {
    Ring star;
    const int n = 20000;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        const double radius = i % 2 ? 9.0 : 10.0;
        star.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    const Region region({Polygon{star, {}}});
    EXPECT_TRUE(region.contains({8.9, 0.0}));
    EXPECT_FALSE(region.contains({10.1, 0.0}));
    RandomStream random(5, 0, RandomPurpose::ReleasePosition);
    for (int i = 0; i < 10000; ++i) ASSERT_LE(region.sample(random).norm(), 10.0);
}

}  // namespace scree
