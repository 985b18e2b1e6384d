// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/convex_block.hpp"

#include "scree/base/error.hpp"
#include "support/rounding.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree::test {

namespace {

const Vec3 kSize(0.9, 0.7, 0.55);

ConvexBlock shaped(BlockShape shape, std::uint64_t number, int points = 50) {
    RandomStream random(41, number, RandomPurpose::Shape);
    ShapeSettings settings;
    settings.shape = shape;
    settings.points = points;
    if (shape == BlockShape::File) settings.file_points = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 1}, {1, 1, 1}};
    return make_block(settings, kSize, 500.0, random);
}

bool inside(const ConvexBlock& block, const Vec3& p) {
    for (Eigen::Index f = 0; f < block.face_count(); ++f)
        if (block.normal(f).dot(p) > block.offset[f]) return false;
    return true;
}

}  // namespace

TEST(MassProperties, Box) {
    const Vec3 size(2.0, 3.0, 5.0), shift(7.0, -2.0, 1.0);
    std::vector<Vec3> points = box_points(size);
    for (Vec3& p : points) p += shift;
    const MassProperties m = mass_properties(convex_hull(points));
    EXPECT_NEAR(m.volume, 30.0, 30.0 * kRounding);
    EXPECT_NEAR((m.centre - shift).norm(), 0.0, 10.0 * kRounding);
    const Mat3 expected = (30.0 / 12.0 * Vec3(9.0 + 25.0, 4.0 + 25.0, 4.0 + 9.0)).asDiagonal();
    EXPECT_NEAR((m.inertia - expected).norm(), 0.0, 1e-10);
}

// Corner tetrahedron 0 <= x + y + z <= 1: volume 1/6, centre 1/4, integral of x^2 = 1/60, of x y = 1/120.
TEST(MassProperties, Tetrahedron) {
    const MassProperties m = mass_properties(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_NEAR(m.volume, 1.0 / 6.0, kRounding);
    EXPECT_NEAR((m.centre - Vec3::Constant(0.25)).norm(), 0.0, kRounding);
    const double square = 1.0 / 60.0 - 1.0 / 96.0, product = 1.0 / 120.0 - 1.0 / 96.0;
    Mat3 expected = Mat3::Constant(-product);
    expected.diagonal().setConstant(2.0 * square);
    EXPECT_NEAR((m.inertia - expected).norm(), 0.0, kRounding);
}

// 2e5 points, a third of them inside: a standard error of 0.3 % of the volume; three of them allowed.
TEST(MassProperties, AgreeWithMonteCarlo) {
    const ConvexBlock block = shaped(BlockShape::Hull, 1);
    RandomStream random(42, 1, RandomPurpose::Shape);
    const int count = 200'000;
    const double half = block.radius;
    int hits = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (int k = 0; k < count; ++k) {
        const double x = random.uniform(-half, half), y = random.uniform(-half, half), z = random.uniform(-half, half);
        const Vec3 p(x, y, z);
        if (!inside(block, p)) continue;
        ++hits;
        first += p;
        second += p * p.transpose();
    }
    const double cube = std::pow(2.0 * half, 3);
    EXPECT_NEAR(hits * cube / count / block.volume, 1.0, 0.01);
    EXPECT_NEAR((first / hits).norm() / half, 0.0, 0.01);  // the centre of mass is the origin
    const Mat3 inertia = block.mass / hits * (second.trace() * Mat3::Identity() - second);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(inertia(i, i) / block.inertia[i], 1.0, 0.01);
        for (int j = 0; j < i; ++j) EXPECT_NEAR(inertia(i, j) / block.inertia.maxCoeff(), 0.0, 0.01);
    }
}

TEST(ConvexBlock, EveryShapeFillsItsBox) {
    for (std::size_t shape = 0; shape < kBlockShapeNames.size(); ++shape) {
        RandomStream random(41, 5, RandomPurpose::Shape);
        ShapeSettings settings;
        settings.shape = static_cast<BlockShape>(shape);
        settings.file_points = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 1}, {1, 1, 1}};
        const ConvexBlock block = make_block(settings, kSize, 500.0, random);
        EXPECT_EQ(block.mass, 500.0) << kBlockShapeNames[shape];
        EXPECT_EQ(block.size, kSize);
        EXPECT_GT(block.volume, 0.2 * kSize.prod()) << kBlockShapeNames[shape];
        EXPECT_LE(block.volume, kSize.prod() * (1.0 + kRounding)) << kBlockShapeNames[shape];
        // its diagonal reach cannot exceed that of the box, nor its thickness the shortest edge
        EXPECT_LE(block.inner_radius, 0.5 * kSize.minCoeff() * (1.0 + 1e-9)) << kBlockShapeNames[shape];
        EXPECT_GE(block.radius, 0.5 * kSize.maxCoeff() * (1.0 - 1e-9)) << kBlockShapeNames[shape];
    }
    const ConvexBlock box = shaped(BlockShape::Box, 1);
    EXPECT_EQ(box.vertex_count(), 8);
    EXPECT_NEAR(box.volume, kSize.prod(), kRounding);
    EXPECT_NEAR(box.radius, 0.5 * kSize.norm(), kRounding);
    const ConvexBlock eota = shaped(BlockShape::Eota, 1);
    EXPECT_EQ(eota.vertex_count(), 24);
}

TEST(ConvexBlock, FilePointsAreStretchedToTheBox) {
    ShapeSettings settings;
    settings.shape = BlockShape::File;
    settings.file_points = box_points({1.0, 1.0, 1.0});
    RandomStream random(41, 1, RandomPurpose::Shape);
    const ConvexBlock block = make_block(settings, kSize, 500.0, random);
    Vec3 extent = Vec3::Zero();
    for (Eigen::Index i = 0; i < block.vertex_count(); ++i) extent = extent.cwiseMax(2.0 * block.vertex(i).cwiseAbs());
    std::sort(extent.begin(), extent.end(),
              std::greater<>());  // the axes of a box are its principal axes, in any order
    EXPECT_NEAR((extent - kSize).norm(), 0.0, 1e-9);
}

// Mean over 400 hulls, measured 19.8, 50.3 and 80.2: 4 % allows for the fit of the cloud's size.
TEST(ConvexBlock, MeanNumberOfVertices) {
    for (const int points : {20, 50, 80}) {
        double sum = 0.0;
        for (std::uint64_t k = 0; k < 400; ++k)
            sum += static_cast<double>(shaped(BlockShape::Hull, k, points).vertex_count());
        RecordProperty("mean_" + std::to_string(points), testing::PrintToString(sum / 400.0));
        EXPECT_NEAR(sum / 400.0 / points, 1.0, 0.04) << points;
    }
}

TEST(ConvexBlock, BodyFrameIsPrincipalAndFacesPointOutwards) {
    for (const BlockShape shape : {BlockShape::Hull, BlockShape::Sharp, BlockShape::File}) {
        for (std::uint64_t number = 0; number < 5; ++number) {
            const ConvexBlock block = shaped(shape, number);
            std::vector<Vec3> points;
            for (Eigen::Index i = 0; i < block.vertex_count(); ++i) points.push_back(block.vertex(i));
            const MassProperties m = mass_properties(convex_hull(points));
            EXPECT_NEAR(m.centre.norm(), 0.0, kRounding);
            const Mat3 inertia = block.mass / m.volume * m.inertia;
            EXPECT_NEAR((inertia - Mat3(block.inertia.asDiagonal())).norm() / block.inertia.norm(), 0.0, 1e-10);
            for (Eigen::Index f = 0; f < block.face_count(); ++f) {
                EXPECT_GT(block.offset[f], 0.0);
                double highest = -1.0;
                for (const Vec3& p : points) highest = std::max(highest, block.normal(f).dot(p) - block.offset[f]);
                EXPECT_NEAR(highest, 0.0, 1e-10);
            }
        }
    }
}

// A rotation, not a reflection: the body is the points turned.
TEST(ConvexBlock, PrincipalFrameIsRightHanded) {
    for (std::uint64_t number = 0; number < 10; ++number) {
        const ConvexBlock some = shaped(BlockShape::Sharp, number);
        std::vector<Vec3> points;
        for (Eigen::Index i = 0; i < some.vertex_count(); ++i) points.push_back(some.vertex(i));
        const FramedBlock framed(points, 1.0);
        double worst = 0.0;
        const ConvexHull hull = convex_hull(points);
        for (std::size_t i = 0; i < hull.vertices.size(); ++i)
            worst = std::max(worst, (framed.to_body * hull.vertices[i] - framed.block.vertex(i)).norm());
        EXPECT_LT(worst, 1e-9);
    }
}

TEST(ConvexHull, DoesNotDependOnTheOrderOfThePoints) {
    RandomStream random(43, 1, RandomPurpose::Shape);
    std::vector<Vec3> points =
        box_points(kSize);  // coplanar quadrilaterals: the cut of each must not depend on the order either
    for (int k = 0; k < 40; ++k) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        points.emplace_back(x, y, z);
    }
    for (const auto& set : {points, box_points(kSize)}) {
        const ConvexHull expected = convex_hull(set);
        std::vector<Vec3> shuffled = set;
        for (int round = 0; round < 10; ++round) {
            for (std::size_t k = shuffled.size() - 1; k > 0; --k) std::swap(shuffled[k], shuffled[random.below(k + 1)]);
            const ConvexHull hull = convex_hull(shuffled);
            EXPECT_EQ(hull.vertices, expected.vertices);
            EXPECT_EQ(hull.facets, expected.facets);
        }
    }
}

TEST(ConvexHull, RefusesWhatHasNoVolume) {
    EXPECT_THROW(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), InputError);
    EXPECT_THROW(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), InputError);
    EXPECT_THROW(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, kNaN}}), InputError);
}

}  // namespace scree::test
