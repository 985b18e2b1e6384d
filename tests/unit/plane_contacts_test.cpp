// SPDX-License-Identifier: GPL-3.0-or-later
#include "dynamics/plane_contacts.hpp"

#include "dynamics/rigid_motion.hpp"

#include "scree/base/random.hpp"
#include "scree/dynamics/trajectory.hpp"
#include "support/plane_scenes.hpp"
#include "support/rounding.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree::test {

namespace {

/// A rhombus with its lowest corner at (0, -0.3).
ConvexPolygon diamond() {
    return make_polygon_from_points({{0.5, 0.0}, {0.0, 0.3}, {-0.5, 0.0}, {0.0, -0.3}}, 100.0);
}
ConvexPolygon box() {
    return make_polygon_from_points(rectangle(0.6, 0.4), 100.0);
}

std::vector<Contact<2>> contacts_of(const ConvexPolygon& block, const GroundLine& ground, const Vec2& position,
                                    double angle, double reach) {
    PlaneContacts finder(block, ground, false);
    std::vector<Contact<2>> contacts;
    finder.detect(position, rotation_matrix(angle), reach, contacts);
    return contacts;
}

GroundLine ridge() {
    return ground_of({{0.0, -2.0}, {4.0, 0.0}, {8.0, -2.0}});
}
GroundLine valley() {
    return ground_of({{0.0, 2.0}, {4.0, 0.0}, {8.0, 2.0}});
}

/// Distance between the outline of the polygon and the ground, zero if they cross: between all pairs of straight pieces.
double distance(const ConvexPolygon& block, const GroundLine& ground, const Vec2& position, double angle) {
    const Mat2 rotation = rotation_matrix(angle);
    auto from_piece = [](const Vec2& p, const Vec2& a, const Vec2& b) {
        const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        return (p - a - t * (b - a)).norm();
    };
    auto side = [](const Vec2& a, const Vec2& b, const Vec2& p) {
        return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x();
    };
    double least = kInfinity;
    for (Eigen::Index i = 0; i < block.vertex_count(); ++i) {
        const Vec2 a = position + rotation * block.vertex(i),
                   b = position + rotation * block.vertex((i + 1) % block.vertex_count());
        for (std::size_t k = 0; k < ground.reach_count(); ++k) {
            const Vec2 c = ground.corner(k), d(ground.reach(k).to, ground.reach(k).height(ground.reach(k).to));
            if (side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0) return 0.0;
            least =
                std::min({least, from_piece(a, c, d), from_piece(b, c, d), from_piece(c, a, b), from_piece(d, a, b)});
        }
    }
    return least;
}

}  // namespace

TEST(PlaneContacts, CornerOverAReach) {
    const double slope = 30 * kDegree;
    const GroundLine ground = inclined_line(slope);
    const ConvexPolygon block = diamond();
    const Vec2 position = Vec2(10.3, -std::tan(slope) * 10.3 + 0.5), normal(std::sin(slope), std::cos(slope));
    const auto contacts = contacts_of(block, ground, position, 0.0, 0.18);
    ASSERT_EQ(contacts.size(), 1u);
    const Contact<2>& c = contacts.front();
    EXPECT_EQ(c.key.pair, FeaturePair::VertexOnFacet);
    EXPECT_EQ(c.key.terrain, 10);
    EXPECT_NEAR((c.arm - Vec2(0.0, -0.3)).norm(), 0.0, kRounding);
    EXPECT_NEAR((c.normal - normal).norm(), 0.0, kRounding);
    EXPECT_NEAR(c.gap, 0.2 * std::cos(slope), kRounding);
    EXPECT_TRUE(contacts_of(block, ground, position, 0.0, 0.9 * c.gap).empty());
}

TEST(PlaneContacts, CornerInAValleyTouchesBothSides) {
    const auto contacts = contacts_of(diamond(), valley(), {4.0, 0.3}, 0.0, 1e-3);
    ASSERT_EQ(contacts.size(), 2u);
    EXPECT_NEAR(contacts[0].normal.x() + contacts[1].normal.x(), 0.0, kRounding);
    EXPECT_GT(std::abs(contacts[0].normal.x()), 0.4);
    EXPECT_EQ(contacts_of(diamond(), valley(), {4.3, 0.3 + 0.15}, 0.0, 1e-3).size(),
              1u);  // beside it only the near side
}

TEST(PlaneContacts, SeamsOfAStraightLineMakeNoSecondContact) {
    RandomStream random(3, 3, RandomPurpose::Effect);
    std::vector<Vec2> corners;
    for (double s = 0.0; s < 20.0; s += std::exp(random.uniform(std::log(1e-6), 0.0)))
        corners.emplace_back(s, 1.0 - 0.4 * s);
    const GroundLine ground = ground_of(corners);
    const ConvexPolygon block = diamond();
    for (std::size_t k = 0; k < ground.reach_count(); ++k) {
        EXPECT_FALSE(ground.is_crest(k));
        const Vec2 corner = ground.corner(k);
        if (corner.x() < 1.0 || corner.x() > 18.0) continue;
        EXPECT_EQ(contacts_of(block, ground, corner + Vec2(0.0, 0.3), 0.0, 1e-3).size(), 1u) << corner.transpose();
    }
}

TEST(PlaneContacts, CrestPokesIntoASide) {
    for (const double gap : {0.05, -0.03}) {
        const Vec2 position(4.1, 0.2 + gap);
        const auto contacts = contacts_of(box(), ridge(), position, 0.0, 0.06);
        ASSERT_EQ(contacts.size(), 1u);
        EXPECT_EQ(contacts[0].key.pair, FeaturePair::NodeInFace);
        EXPECT_NEAR(contacts[0].gap, gap, kRounding);
        EXPECT_NEAR((contacts[0].normal - Vec2::UnitY()).norm(), 0.0, kRounding);
        EXPECT_NEAR((contacts[0].arm + position - Vec2(4.0, 0.0)).norm(), 0.0, kRounding);
    }
}

// A side that leans more than the ground beside the crest touches with its corner, not with the crest.
TEST(PlaneContacts, NormalOfACrestLiesBetweenThoseOfItsReaches) {
    const double steepest = std::atan(0.5);
    for (const double share : {-1.3, -0.9, 0.0, 0.9, 1.3}) {
        const double angle = share * steepest;
        const Vec2 normal(-std::sin(angle), std::cos(angle));
        const auto contacts = contacts_of(box(), ridge(), Vec2(4.0, 0.0) + 0.2 * normal, angle, 1e-3);
        const bool crest = std::any_of(contacts.begin(), contacts.end(),
                                       [](const auto& c) { return c.key.pair == FeaturePair::NodeInFace; });
        EXPECT_EQ(crest, std::abs(share) < 1.0) << share;
    }
}

// A needle through the block: neither its tip nor a corner of the block is inside the other. The shortest way out is sideways.
TEST(PlaneContacts, SeesANeedleThroughTheBlock) {
    const GroundLine ground = ground_of({{0.0, 0.0}, {4.0, 0.0}, {4.05, 3.0}, {4.1, 0.0}, {8.0, 0.0}});
    const ConvexPolygon block = box();
    const auto contacts = contacts_of(block, ground, {4.04, 1.0}, 0.0, 1e-3);
    ASSERT_EQ(contacts.size(), 1u);
    const Vec2 normal = Vec2(-3.0, 0.05).normalized(),
               corner(4.34, 0.8);  // its lower right corner must come out on the left
    EXPECT_NEAR((contacts[0].normal - normal).norm(), 0.0, kRounding);
    EXPECT_NEAR(contacts[0].gap, normal.dot(corner - Vec2(4.05, 3.0)), kRounding);
    EXPECT_NEAR((contacts[0].arm - (corner - Vec2(4.04, 1.0))).norm(), 0.0, kRounding);
    BlockState<2> inside;
    inside.position = {4.04, 1.0};
    EXPECT_NEAR(PlaneContacts(block, ground, false).sunk(inside.position, Mat2::Identity()), 3.0 - 0.8, kRounding);
    EXPECT_NEAR(clearing_lift(block, inside, ground, 1e-3), 3.0 - 0.8 + 1e-3, 2e-4);
}

// A corner that hardly entered the face of a cliff a hair wide, deep under its top, touches the face.
TEST(PlaneContacts, CornerInAVerticalWallTouchesTheWall) {
    const GroundLine ground = ground_of({{0.0, 0.0}, {4.0, 0.0}, {4.0 + 1e-4, 5.0}, {8.0, 5.0}});
    const auto contacts = contacts_of(diamond(), ground, {4.0 - 0.5 + 3e-4, 2.0}, 0.0, 1e-3);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_NEAR(contacts[0].normal.x(), -1.0, 1e-6);
    EXPECT_NEAR(contacts[0].gap, -3e-4, 1e-4);
}

// A crest 0.15 m in the lower side; found to a tenth of the gap, or to a nanometre.
TEST(PlaneContacts, ABlockIsLiftedUntilItIsFree) {
    const ConvexPolygon block = box();
    const GroundLine ground = ridge();
    BlockState<2> state;
    state.position = {4.0, 0.05};
    EXPECT_NEAR(clearing_lift(block, state, ground, 0.0), 0.15, 1e-8);
    const double lift = clearing_lift(block, state, ground, 0.02);
    EXPECT_GE(lift, 0.17 - kRounding);
    EXPECT_LE(lift, 0.172);
    state.position.y() = 0.25;
    EXPECT_EQ(clearing_lift(block, state, ground, 0.02), 0.0);
}

TEST(PlaneContacts, NothingBeyondTheEnds) {
    const GroundLine ground = ground_of({{0.0, 0.0}, {4.0, 0.0}});
    const ConvexPolygon block = diamond();
    PlaneContacts finder(block, ground, false);
    std::vector<Contact<2>> contacts;
    finder.detect({4.1, 0.25}, Mat2::Identity(), 1e-3, contacts);
    EXPECT_TRUE(contacts.empty());
    EXPECT_TRUE(finder.beyond_rim());
    EXPECT_FALSE(finder.over_terrain({4.1, 0.25}));
    EXPECT_TRUE(finder.over_terrain({3.9, 0.25}));
    finder.detect({4.1, 0.35}, Mat2::Identity(), 1e-3, contacts);
    EXPECT_FALSE(finder.beyond_rim());
}

// Random polygons over random ground: the smallest gap is the distance, where they do not overlap. A gap is measured along the normal of a reach: where the
// nearest thing is the end of a reach, corner against corner, the distance is larger.
TEST(PlaneContacts, SmallestGapIsTheDistance) {
    RandomStream random(5, 5, RandomPurpose::Effect);
    int compared = 0;
    for (int k = 0; k < 400; ++k) {
        std::vector<Vec2> corners;
        for (double s = 0.0; s < 20.0; s += random.uniform(0.05, 1.0))
            corners.emplace_back(s, random.uniform(-0.3, 0.3));
        const GroundLine ground = ground_of(corners);
        ShapeSettings shape;
        const ConvexPolygon block = make_polygon(shape, {1.0, 0.6, 0.5}, 100.0, random);
        const double angle = random.uniform(0.0, 6.28);
        Vec2 position(10.0, 3.0);
        BlockState<2> state;
        state.position = {position.x(), 0.0};
        state.orientation = angle;
        position.y() = clearing_lift(block, state, ground, 1e-3);
        const auto contacts = contacts_of(block, ground, position, angle, 5e-3);
        double gap = kInfinity;
        for (const auto& c : contacts) gap = std::min(gap, c.gap);
        const double true_distance = distance(block, ground, position, angle);
        EXPECT_LE(gap, true_distance + 1e-9);
        EXPECT_GT(true_distance, 0.0);
        compared += std::abs(gap - true_distance) < 1e-9;
    }
    EXPECT_GT(compared, 360);
}

// Nothing touches before the time that free_time gives: flown on in tiny steps, the distance stays positive.
TEST(PlaneContacts, NothingTouchesInTheFreeTime) {
    RandomStream random(6, 6, RandomPurpose::Effect);
    for (int k = 0; k < 300; ++k) {
        std::vector<Vec2> corners;
        for (double s = 0.0; s < 40.0; s += random.uniform(0.05, 1.0))
            corners.emplace_back(s, random.uniform(-0.5, 0.5));
        const GroundLine ground = ground_of(corners);
        const ConvexPolygon block = make_polygon({}, {1.0, random.uniform(0.2, 1.0), 0.5}, 100.0, random);
        PlaneContacts finder(block, ground, false, true);  // waits for every crest
        BlockState<2> s;
        s.position = {20.0, 0.0};
        s.orientation = random.uniform(0.0, 6.28);
        s.position.y() = clearing_lift(block, s, ground, 1e-3) + random.uniform(0.0, 1.0) * random.uniform();
        s.velocity = {random.uniform(-15.0, 15.0), random.uniform(-15.0, 5.0)};
        s.spin[0] = random.uniform(-20.0, 20.0);
        double gap = 0.0;
        for (int looks = 0; looks < 200; ++looks) {
            // every third block under drag, as long as it is constant in the engine
            const double rate = k % 3 == 0 ? random.uniform(0.1, 8.0) : 0.0;
            const Vec2 drag = -rate * s.velocity;
            const double time =
                std::min(finder.free_time(s, std::abs(s.spin[0]), 9.8, drag, gap), rate > 0.0 ? 0.2 / rate : kInfinity);
            if (gap < 1e-5 || time < 1e-6 || !finder.over_terrain(s.position)) break;
            const BlockState<2> start = s;
            for (const double share : {0.25, 0.5, 0.75, 1.0}) {
                const double t = share * time;
                s.position = start.position + t * start.velocity - Vec2(0.0, 4.9 * t * t) + 0.5 * t * t * drag;
                s.velocity = start.velocity - Vec2(0.0, 9.8 * t) + t * drag;
                s.orientation = start.orientation + t * start.spin[0];
                if (ground.contains(s.position.x() - 1.5) && ground.contains(s.position.x() + 1.5)) {
                    // the bounds are sharp: a touch within rounding is none
                    EXPECT_TRUE(distance(block, ground, s.position, s.orientation) > 0.0 ||
                                finder.sunk(s.position, rotation_matrix(s.orientation)) < kRounding)
                        << "scene " << k << ", look " << looks;
                }
            }
        }
    }
}

}  // namespace scree::test
