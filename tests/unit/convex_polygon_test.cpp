// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/convex_polygon.hpp"

#include "scree/base/error.hpp"
#include "support/plane_scenes.hpp"
#include "support/rounding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scree::test {

namespace {

const Vec3 kRectangle(0.9, 0.7, 0.55);

ConvexPolygon polygon_of(BlockShape shape, std::uint64_t number, int points = 20) {
    RandomStream random(43, number, RandomPurpose::Shape);
    ShapeSettings settings;
    settings.shape = shape;
    settings.polygon_points = points;
    if (shape == BlockShape::File) settings.file_points = {{0, 0, 0}, {2, 0, 5}, {0, 3, 0}, {1, 1, 9}};
    return make_polygon(settings, kRectangle, 500.0, random);
}

}  // namespace

// A rectangle a x b: area a b, moment a b (a^2 + b^2) / 12, wherever it lies.
TEST(AreaProperties, Rectangle) {
    std::vector<Vec2> corners = rectangle(2.0, 3.0);
    for (Vec2& c : corners) c += Vec2(7.0, -4.0);
    const AreaProperties p = area_properties(corners);
    EXPECT_NEAR(p.area, 6.0, 6.0 * kRounding);
    EXPECT_NEAR((p.centre - Vec2(7.0, -4.0)).norm(), 0.0, 10.0 * kRounding);
    EXPECT_NEAR(p.moment, 6.0 * 13.0 / 12.0, 1e-11);
}

// A triangle's moment about its centroid is area (a^2 + b^2 + c^2) / 36, with its sides a, b, c.
TEST(AreaProperties, Triangle) {
    const std::vector<Vec2> t{{0.0, 0.0}, {3.0, 0.5}, {1.0, 2.0}};
    const double squares = (t[1] - t[0]).squaredNorm() + (t[2] - t[1]).squaredNorm() + (t[0] - t[2]).squaredNorm();
    const AreaProperties p = area_properties(t);
    EXPECT_NEAR(p.area, 2.75, kRounding);
    EXPECT_NEAR((p.centre - (t[0] + t[1] + t[2]) / 3.0).norm(), 0.0, kRounding);
    EXPECT_NEAR(p.moment, 2.75 * squares / 36.0, kRounding);
}

TEST(ConvexOutline, DropsPointsInsideAndOnSides) {
    const std::vector<Vec2> outline =
        convex_outline({{1, 1}, {0, 0}, {2, 0}, {1, 0}, {2, 2}, {0, 2}, {0.5, 1.5}, {0, 1}, {2, 2}, {1.0, 2.0}});
    ASSERT_EQ(outline.size(), 4u);
    EXPECT_NEAR(area_properties(outline).area, 4.0, kRounding);  // positive: counter-clockwise
}

TEST(ConvexOutline, RefusesWhatIsNoArea) {
    EXPECT_THROW(convex_outline({{0, 0}, {1, 1}, {2, 2}, {3, 3}}), InputError);
    EXPECT_THROW(convex_outline({{0, 0}, {1, 1}}), InputError);
    EXPECT_THROW(convex_outline({{0, 0}, {1, 1}, {kNaN, 0}}), InputError);
}

TEST(ConvexPolygon, FillsItsBoxAndStandsOnItsCentreOfMass) {
    for (const BlockShape shape : {BlockShape::Hull, BlockShape::Sharp, BlockShape::Round, BlockShape::Box,
                                   BlockShape::Eota, BlockShape::Ellipsoid, BlockShape::File}) {
        const ConvexPolygon p = polygon_of(shape, 3);
        SCOPED_TRACE(kBlockShapeNames[static_cast<std::size_t>(shape)]);
        EXPECT_NEAR(p.x.maxCoeff() - p.x.minCoeff(), kRectangle.x(), kRounding);
        EXPECT_NEAR(p.z.maxCoeff() - p.z.minCoeff(), kRectangle.y(), kRounding);
        std::vector<Vec2> corners;
        for (Eigen::Index i = 0; i < p.vertex_count(); ++i) {
            corners.push_back(p.vertex(i));
            const Vec2 next = p.vertex((i + 1) % p.vertex_count());
            EXPECT_NEAR(p.normal(i).dot(p.vertex(i)), p.offset[i], kRounding);
            EXPECT_NEAR(p.normal(i).dot(next), p.offset[i], kRounding);
            for (Eigen::Index j = 0; j < p.vertex_count(); ++j)
                EXPECT_LE(p.normal(i).dot(p.vertex(j)), p.offset[i] + kRounding);
        }
        const AreaProperties properties = area_properties(corners);
        EXPECT_NEAR(properties.centre.norm(), 0.0, kRounding);
        EXPECT_NEAR(p.inertia / p.mass, properties.moment / properties.area, kRounding);
        EXPECT_EQ(p.size, kRectangle);
        EXPECT_EQ(p.mass, 500.0);
    }
}

// The prism of a polygon with the same mass: its moment about the axis across is that of the polygon.
TEST(ConvexPolygon, HasTheMomentOfAPrism) {
    const ConvexPolygon box = polygon_of(BlockShape::Box, 1);
    EXPECT_NEAR(box.inertia, 500.0 / 12.0 * (kRectangle.x() * kRectangle.x() + kRectangle.y() * kRectangle.y()), 1e-10);
    EXPECT_EQ(polygon_of(BlockShape::Eota, 1).vertex_count(), 8);
    const double disc =
        polygon_of(BlockShape::Ellipsoid, 1, 100).inertia;  // of an ellipse: m (a^2 + b^2) / 4 of the half axes
    EXPECT_NEAR(disc / (500.0 / 16.0 * (kRectangle.x() * kRectangle.x() + kRectangle.y() * kRectangle.y())), 1.0, 2e-3);
}

// 400 polygons each; their numbers of corners scatter by less than 2, the mean by less than 0.1: four of these are allowed.
TEST(ConvexPolygon, HasTheAskedNumberOfCornersInTheMean) {
    const auto mean = [](BlockShape shape, int points) {
        double sum = 0.0;
        for (std::uint64_t k = 0; k < 400; ++k) sum += static_cast<double>(polygon_of(shape, k, points).vertex_count());
        return sum / 400.0;
    };
    EXPECT_NEAR(mean(BlockShape::Hull, 6), 6.0, 0.4);
    EXPECT_NEAR(mean(BlockShape::Hull, 20), 20.0, 0.4);
    EXPECT_NEAR(mean(BlockShape::Sharp, 20), 10.0, 0.4);
    EXPECT_NEAR(mean(BlockShape::Round, 20), 40.0, 0.6);
}

TEST(ConvexPolygon, SameStreamSamePolygonOthersDiffer) {
    const ConvexPolygon a = polygon_of(BlockShape::Hull, 5), b = polygon_of(BlockShape::Hull, 5),
                        c = polygon_of(BlockShape::Hull, 6);
    ASSERT_EQ(a.vertex_count(), b.vertex_count());
    EXPECT_TRUE((a.x == b.x).all() && (a.z == b.z).all());
    EXPECT_FALSE(a.vertex_count() == c.vertex_count() && (a.x == c.x).all());
}

TEST(ConvexPolygon, RefusesImpossibleSizes) {
    RandomStream random(1, 1, RandomPurpose::Shape);
    EXPECT_THROW(make_polygon({}, {1.0, 0.0, 1.0}, 100.0, random), InputError);
    EXPECT_THROW(make_polygon({}, {1.0, 1.0, 1.0}, -1.0, random), InputError);
    ShapeSettings file;
    file.shape = BlockShape::File;
    file.file_points = {{0, 0, 0}, {1, 1, 0}, {2, 2, 1}};
    EXPECT_THROW(make_polygon(file, {1.0, 1.0, 1.0}, 1.0, random), InputError);
}

}  // namespace scree::test
