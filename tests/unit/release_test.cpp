// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/release.hpp"

#include "scree/dynamics/trajectory.hpp"
#include "scree/ensemble/profile_release.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

namespace scree::test {
namespace {

// Of a large polygon 25 of 70 000 m2 lie on the terrain: 200 trials hit that in one case of fourteen, and blocks may start there all the same.
TEST(ReleaseArea, StartsWhereLittleOfItLiesOnTheTerrain) {
    const auto surface = grid_terrain(40.0, 1.0, [](double, double) { return 0.0; });
    const ReleaseArea area(release_layer({MultiPolygon{Polygon{{{35, 35}, {300, 35}, {300, 300}, {35, 300}}, {}}}}),
                           *surface, ReleasePattern::Random, {80, 80, 1.0, {-40.0, -40.0}});
    for (std::uint64_t block = 0; block < 5; ++block) {
        std::int64_t feature = 0;
        EXPECT_GE(surface->facet_at(area.draw(1, block, feature)), 0);
    }
}

// Polygons share blocks by area, lines by length, points equally: 100 and 300 m2; 5 and 15 m; 1 and 1. And anywhere in them.
TEST(ReleaseArea, SharesBlocksByAreaLengthAndNumber) {
    const auto surface = grid_terrain(40.0, 1.0, [](double, double) { return 0.0; });
    const auto box = [](double west, double south, double east, double north) {
        return MultiPolygon{Polygon{{{west, south}, {east, south}, {east, north}, {west, north}}, {}}};
    };
    const auto line = [](const Vec3& a, const Vec3& b, const Vec3& c) { return Polylines{Polyline{{a, b, c}, {}}}; };
    struct Layout {
        Geometry first, second;
        double share;  ///< of the first [-]
        Vec2 middle;   ///< of the second [m]
    };
    const std::vector<Layout> layouts{{box(-30, -30, -20, -20), box(0, 0, 30, 10), 0.25, {15.0, 5.0}},
                                      {line({-30, -30, 0}, {-28, -30, 0}, {-28, -27, 0}),
                                       line({0, 0, 0}, {10, 0, 0}, {10, 5, 0}),
                                       0.25,
                                       {(10 * 5.0 + 5 * 10.0) / 15.0, 5 * 2.5 / 15.0}},
                                      {Points{{-30, -30, 0}}, Points{{7, 8, 0}}, 0.5, {7.0, 8.0}}};
    for (const Layout& layout : layouts) {
        const ReleaseArea area(release_layer({layout.first, layout.second}), *surface, ReleasePattern::Random,
                               {80, 80, 1.0, {-40.0, -40.0}});
        constexpr int kDraws = 4000;
        int first = 0;
        Vec2 sum = Vec2::Zero();
        for (std::uint64_t block = 0; block < kDraws; ++block) {
            std::int64_t feature = 0;
            const Vec2 p = area.draw(1, block, feature);
            EXPECT_EQ(feature, p.x() < -10.0 ? 11 : 12);
            feature == 11 ? void(++first) : void(sum += p);
        }
        EXPECT_NEAR(first, layout.share * kDraws, 4.0 * std::sqrt(0.25 * kDraws));
        EXPECT_LT((sum / (kDraws - first) - layout.middle).norm(), 0.8);  // standard error at most 0.17
    }
}

// One after the other over the cells whose centres lie in the polygon.
TEST(ReleaseArea, CellsOneAfterTheOther) {
    const auto surface = grid_terrain(20.0, 1.0, [](double, double) { return 0.0; });
    const ReleaseArea area(release_layer({MultiPolygon{Polygon{{{2.2, 4.3}, {5.4, 4.3}, {5.4, 6.0}, {2.2, 6.0}}, {}}}}),
                           *surface, ReleasePattern::Cells, {40, 40, 1.0, {-20.0, -20.0}});
    ASSERT_EQ(area.cell_count(), 6U);
    std::int64_t feature = 0;
    EXPECT_EQ(area.draw(1, 0, feature), Vec2(2.5, 4.5));
    EXPECT_EQ(feature, 11);
    EXPECT_EQ(area.draw(1, 2, feature), Vec2(4.5, 4.5));
    EXPECT_EQ(area.draw(9, 3, feature), Vec2(2.5, 5.5));
}

// Rows of a block list that are taken in turn meet all cells, however their numbers divide each other; and every run of blocks fills all cells.
TEST(ReleaseArea, RowsInTurnMeetAllCells) {
    for (const auto& [rows, cells] : {std::pair<std::uint64_t, std::uint64_t>{50, 25}, {4, 2}, {16, 50}, {7, 7}}) {
        std::vector<std::set<std::uint64_t>> of_row(rows);
        std::set<std::uint64_t> of_run;
        for (std::uint64_t block = 0; block < 40 * rows * cells; ++block) {
            const std::uint64_t cell = start_cell(1, block, cells);
            EXPECT_EQ(cell, start_cell(1, block, cells));
            of_row[block % rows].insert(cell);
            of_run.insert(cell);
            if (block % cells != cells - 1) continue;
            EXPECT_EQ(of_run.size(), cells);
            of_run.clear();
        }
        for (const auto& met : of_row) EXPECT_EQ(met.size(), cells) << rows << " rows, " << cells << " cells";
    }
}

// The height is that above the ground there, azimuths count clockwise from north, and no orientation or axis of the spin is preferred.
TEST(Release, StartsAsItIsTold) {
    const auto surface = grid_terrain(20.0, 1.0, [](double x, double) { return -0.5 * x; });
    const ReleaseArea area(release_layer({Points{{4.0, 3.0, 0.0}}}), *surface, ReleasePattern::Random,
                           {40, 40, 1.0, {-20.0, -20.0}});
    const ConvexBlock block = make_block_from_points(box_points({1.0, 0.8, 0.6}), 1200.0);
    ReleaseSettings settings;
    settings.height = 8.0;
    settings.height_spread = 2.0;
    settings.speed = 5.0;
    settings.azimuth = 90.0 * kDegree;
    settings.spin = 4.0;
    constexpr int kDraws = 4000;
    double low = kInfinity, high = -kInfinity;
    Mat3 turned = Mat3::Zero();  // means of the squares, of what is 1/3 for all if none is preferred
    Vec3 axes = Vec3::Zero(), axis = Vec3::Zero();
    for (std::uint64_t k = 0; k < kDraws; ++k) {
        std::int64_t feature = 0;
        double raised = -1.0;
        const BlockState<3> s = draw_release(settings, area, *surface, block, 1, k, feature, raised);
        EXPECT_EQ(raised, 0.0);
        EXPECT_EQ(feature, 11);
        EXPECT_EQ(Vec2(s.position.head<2>()), Vec2(4.0, 3.0));
        EXPECT_LT((s.velocity - Vec3(5.0, 0.0, 0.0)).norm(), 1e-12);
        EXPECT_NEAR(s.spin.norm(), 4.0, 1e-12);
        low = std::min(low, s.position.z() + 2.0);
        high = std::max(high, s.position.z() + 2.0);
        turned += Mat3(s.orientation.toRotationMatrix().array().square()) / kDraws;
        axes += Vec3(s.spin.array().square()) / (16.0 * kDraws);
        axis += s.spin / (4.0 * kDraws);
    }
    EXPECT_TRUE(low >= 6.0 && low < 6.02 && high <= 10.0 && high > 9.98) << low << " " << high;
    // standard deviation of the square of a coordinate of a random direction: sqrt(4/45)
    const double far = 4.5 * std::sqrt(4.0 / 45.0 / kDraws);
    EXPECT_LT((turned - Mat3::Constant(1.0 / 3.0)).cwiseAbs().maxCoeff(), far);
    EXPECT_LT((axes - Vec3::Constant(1.0 / 3.0)).cwiseAbs().maxCoeff(), far);
    EXPECT_LT(axis.cwiseAbs().maxCoeff(), 4.5 / std::sqrt(3.0 * kDraws));
    settings.azimuth = 200.0 * kDegree;
    settings.elevation = -30.0 * kDegree;
    std::int64_t feature = 0;
    double raised = 0.0;
    const Vec3 v = draw_release(settings, area, *surface, block, 1, 0, feature, raised).velocity;
    EXPECT_NEAR(v.z(), -2.5, 1e-12);
    EXPECT_NEAR(v.x(), 5.0 * std::cos(30.0 * kDegree) * -0.342020143, 1e-8) << "to the south, a little west";
    EXPECT_NEAR(v.y(), 5.0 * std::cos(30.0 * kDegree) * -0.939692621, 1e-8);
}

// A metre from the edge of the ground, and between two edges, the slope is that of the ground there is.
TEST(ReleaseMotion, PushesNearAnEdge) {
    const auto surface = grid_terrain(20.0, 1.0, [](double x, double) { return -0.5 * x; });
    Effect push = make_effect(EffectKind::ReleaseMotion);
    push.set("speed", 3.0);
    for (const double x : {0.0, 19.0, -19.0, 19.9}) {
        BlockState<3> state;
        state.position = {x, 19.0, 30.0};
        push_release(std::vector<Effect>{push}, *surface, state);
        EXPECT_LT((state.velocity - 3.0 * Vec3(1.0, 0.0, -0.5).normalized()).norm(), 1e-9) << x;
    }
    const std::vector<Vec3> points{{0, 0, 10}, {1.5, 0, 9.25}};
    const Profile profile = make_profile(points, std::vector<SoilId>{0});
    BlockState<2> state;
    state.position = {1.0, 12.0};
    push_release(std::vector<Effect>{push}, profile, state);
    EXPECT_LT((state.velocity - 3.0 * Vec2(1.0, -0.5).normalized()).norm(), 1e-9);
}

// On the map and on a profile: there, that fast, turning as it rolls forward, and free of the ground.
TEST(Departure, PutsABlockOnItsWay) {
    const auto surface = grid_terrain(20.0, 1.0, [](double, double) { return 5.0; });
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k) corners.emplace_back((k & 1) - 0.5, ((k >> 1) & 1) - 0.5, (k >> 2) - 0.5);
    const ConvexBlock block = make_block_from_points(corners, 2000.0);
    double raised = -1.0;
    const BlockState<3> s = draw_departure({{1.2, 2.1, 9.0}, {3.0, 4.0, -2.0}, 6.0}, *surface, block, 1, 0, raised);
    EXPECT_EQ(raised, 0.0);
    EXPECT_EQ(s.position, Vec3(1.2, 2.1, 9.0));
    EXPECT_EQ(s.velocity, Vec3(3.0, 4.0, -2.0));
    const Vec3 spin = s.orientation * s.spin;
    EXPECT_LT((spin - 6.0 * Vec3(-0.8, 0.6, 0.0)).norm(), 1e-12);
    EXPECT_GT(spin.cross(Vec3::UnitZ()).dot(s.velocity), 0.0) << "rolling forward: v = spin x up";
    for (std::uint64_t k = 0; k < 20; ++k) {  // most orientations leave it free there, not all
        const BlockState<3> low =
            draw_departure({{1.2, 2.1, 5.8}, {3.0, 4.0, -2.0}, 6.0}, *surface, block, 1, k, raised);
        EXPECT_EQ(raised, 0.0);
        EXPECT_EQ(low.position.z(), 5.8);
        EXPECT_EQ(clearing_lift(block, low, *surface, 0.0), 0.0);
    }
    const BlockState<3> in = draw_departure({{1.2, 2.1, 5.1}, {3.0, 4.0, -2.0}, 6.0}, *surface, block, 1, 0, raised);
    EXPECT_GE(raised, 0.4 - 1e-9) << "half an edge of it would lie in the ground";
    EXPECT_NEAR(in.position.z(), 5.1 + raised, 1e-12);

    const std::vector<Vec3> points{{0, 0, 5}, {30, 0, 5}};
    const std::vector<SoilId> soil{0};
    const Profile profile = make_profile(points, soil);
    const GroundLine ground(profile);
    const ConvexPolygon square = make_polygon_from_points({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}, 2000.0);
    const BlockState<2> p =
        draw_departure({{7.0, 1.0, 9.0}, {3.0, 4.0, -2.0}, 6.0, 0, 12.5}, ground, square, 1, 0, raised);
    EXPECT_EQ(raised, 0.0);
    EXPECT_EQ(p.position, Vec2(12.5, 9.0));
    EXPECT_EQ(p.velocity, Vec2(5.0, -2.0));
    EXPECT_EQ(p.spin[0], -6.0) << "angles count from x to z";
}

}  // namespace
}  // namespace scree::test
