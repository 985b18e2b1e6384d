// SPDX-License-Identifier: GPL-3.0-or-later
// The catalogue itself, what check_effect refuses, and the effects that act before a block moves.
#include "scree/base/error.hpp"
#include "scree/dynamics/effects.hpp"
#include "scree/dynamics/trajectory.hpp"
#include "scree/ensemble/population.hpp"
#include "scree/ensemble/release.hpp"
#include "support/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <string>

namespace scree::test {

namespace {

using testing::HasSubstr;

std::string refusal(const Effect& effect, bool event_mode = true) {
    try {
        check_effect(effect, event_mode);
    } catch (const InputError& e) {
        return e.what();
    }
    return {};
}

Effect push(double speed, double spin) {
    Effect effect = make_effect(EffectKind::ReleaseMotion);
    effect.set("speed", speed);
    effect.set("spin", spin);
    return effect;
}

}  // namespace

TEST(EffectCatalogue, EveryRowIsComplete) {
    std::set<std::string> names;
    ASSERT_EQ(effect_catalogue().size(), kEffectKinds);
    for (std::size_t k = 0; k < kEffectKinds; ++k) {
        const EffectInfo& info = effect_catalogue()[k];
        SCOPED_TRACE(info.name);
        EXPECT_EQ(&effect_info(info.kind), &info);
        EXPECT_TRUE(names.insert(info.name).second);
        EXPECT_EQ(effect_kind(info.name), info.kind);
        for (const char* text : {info.title, info.formula, info.source, info.seen_in})
            EXPECT_GT(std::string(text).size(), 2U);
        EXPECT_FALSE(info.parameters.empty());
        EXPECT_LE(info.parameters.size(), kMostEffectParameters);
        std::set<std::string> keys{"kind", "soil", "file", "layer", "from", "to"};
        for (const EffectParameter& p : info.parameters) {
            EXPECT_TRUE(keys.insert(p.key).second) << p.key;
            EXPECT_LT(p.low, p.high) << p.key;
            if (!std::isnan(p.standard)) {
                EXPECT_TRUE(p.standard >= p.low && p.standard <= p.high) << p.key;
            }
            for (const char* text : {p.unit, p.meaning, p.source}) EXPECT_FALSE(std::string(text).empty()) << p.key;
        }
        Effect effect = make_effect(info.kind);
        if (info.limits.lines) effect.place.stations = {1.0};
        EXPECT_EQ(refusal(effect), "");
    }
    EXPECT_EQ(effect_kind("gravity"), std::nullopt);
}

TEST(EffectCheck, RefusesWhatCannotBe) {
    Effect effect = make_effect(EffectKind::GroundDrag);
    effect.set("coefficient", -1.0);
    EXPECT_THAT(refusal(effect),
                HasSubstr("effect ground_drag: coefficient = -1 is not allowed: give a number from 0 to 20"));
    effect.set("coefficient", kNaN);
    EXPECT_THAT(refusal(effect), HasSubstr("coefficient = nan"));
    Effect net = make_effect(EffectKind::Net);
    net.place.soil = 1;
    EXPECT_THAT(refusal(net), HasSubstr("effect net cannot be limited to a soil"));
    Effect shape = make_effect(EffectKind::BlockShape);
    shape.place.limit_to({Polygon{{{0, 0}, {1, 0}, {1, 1}}, {}}});
    EXPECT_THAT(refusal(shape), HasSubstr("polygons"));
    EXPECT_THAT(refusal(make_effect(EffectKind::Roughness), false), HasSubstr("moreau_jean"));
    EXPECT_EQ(refusal(make_effect(EffectKind::Roughness)), "");
}

TEST(EffectPlace, BordersAndLinesOnTheWay) {
    EffectPlace place;
    EXPECT_TRUE(place.covers(3, Vec2(1, 1)));
    EXPECT_EQ(place.first_border(Vec2(0, 0), Vec2(9, 9)), kInfinity);
    place.limit_to({Polygon{{{2, 0}, {6, 0}, {6, 4}, {2, 4}}, {}}, Polygon{{{8, 0}, {9, 0}, {9, 4}, {8, 4}}, {}}});
    EXPECT_FALSE(place.covers(0, Vec2(1, 1)));
    EXPECT_TRUE(place.covers(0, Vec2(3, 1)));
    EXPECT_DOUBLE_EQ(place.first_border(Vec2(0, 1), Vec2(10, 1)), 0.2);
    EXPECT_DOUBLE_EQ(place.first_border(Vec2(3, 1), Vec2(10, 1)), 3.0 / 7.0);
    EXPECT_EQ(place.first_border(Vec2(3, 1), Vec2(5, 3)), kInfinity);
    EXPECT_EQ(place.first_border(Vec2(6, 1), Vec2(7, 1)), kInfinity);   // leaves from the border itself
    EXPECT_DOUBLE_EQ(place.first_border(Vec2(1, 5), Vec2(3, 3)), 0.5);  // through a corner
    place.lines = {Points{{0, 2, kNaN}, {5, 2, kNaN}, {5, 9, kNaN}}};
    EXPECT_DOUBLE_EQ(place.next_line(Vec2(1, 0), Vec2(1, 4), 0.0), 0.5);
    EXPECT_DOUBLE_EQ(place.next_line(Vec2(6, 5), Vec2(4, 5), 0.0), 0.5);
    EXPECT_EQ(place.next_line(Vec2(1, 2), Vec2(1, 4), 0.0), kInfinity);
    EXPECT_DOUBLE_EQ(place.next_line(Vec2(2, 0), Vec2(6, 4), 0.0), 0.5);
    EXPECT_DOUBLE_EQ(place.next_line(Vec2(2, 0), Vec2(6, 4), 0.5), 0.75);
    EXPECT_EQ(place.next_line(Vec2(2, 0), Vec2(6, 4), 0.75), kInfinity);

    using Chainage = Eigen::Matrix<double, 1, 1>;
    place.reaches = std::vector<Stretch>{{2.0, 4.0}, {7.0, 8.0}};
    EXPECT_TRUE(place.covers(0, Chainage(3.0)));
    EXPECT_FALSE(place.covers(0, Chainage(5.0)));
    EXPECT_DOUBLE_EQ(place.first_border(Chainage(8.5), Chainage(3.5)), 0.1);
    place.stations = {5.0};
    EXPECT_DOUBLE_EQ(place.next_line(Chainage(4.0), Chainage(6.0), 0.0), 0.5);
    EXPECT_EQ(place.next_line(Chainage(5.0), Chainage(6.0), 0.0), kInfinity);
}

// ---- before the motion -------------------------------------------------------------------------------------------------------------

TEST(ReleaseMotion, PushesDownTheSteepestSlope) {
    const auto surface = grid_terrain(20.0, 1.0, [](double x, double y) { return -0.6 * x - 0.8 * y; });  // 45 degrees
    BlockState<3> s;
    s.orientation = Quat(0.3, -0.2, 0.8, 0.1).normalized();
    s.position = {1.2, 2.1, 30.0};
    const Quat turned = s.orientation;
    push_release(std::vector<Effect>{push(3.0, 2.0)}, *surface, s);
    EXPECT_LT((s.velocity - 3.0 * Vec3(0.6, 0.8, -1.0) / std::sqrt(2.0)).norm(), 1e-12);
    EXPECT_LT((turned * s.spin - 2.0 * Vec3(-0.8, 0.6, 0.0)).norm(), 1e-12);  // rolling downhill: v = spin x up
    EXPECT_GT((turned * s.spin).cross(Vec3::UnitZ()).dot(s.velocity), 0.0);

    const auto level = grid_terrain(20.0, 1.0, [](double, double) { return 5.0; });
    BlockState<3> still;
    push_release(std::vector<Effect>{push(3.0, 2.0)}, *level, still);
    EXPECT_EQ(still.velocity.norm(), 0.0);
}

TEST(ReleaseMotion, PushesDownAProfile) {
    const std::vector<Vec3> points{{0, 0, 30}, {30, 0, 0}};
    const std::vector<SoilId> soil{0};
    const Profile profile = make_profile(points, soil);
    BlockState<2> s;
    s.position = {10.0, 40.0};
    push_release(std::vector<Effect>{push(3.0, 2.0)}, profile, s);
    EXPECT_LT((s.velocity - 3.0 * Vec2(1.0, -1.0) / std::sqrt(2.0)).norm(), 1e-12);
    EXPECT_DOUBLE_EQ(s.spin[0], -2.0);
}

TEST(BlockShapeEffect, KeepsTheVolumeAndTheRatios) {
    BlockPopulation population;
    population.list = {{"a", 1000.0, {1.2, 1.0, 0.8}}};
    population.shape.points = 40;
    population.shape.polygon_points = 16;
    Effect effect = make_effect(EffectKind::BlockShape);
    effect.set("elongation", 1.3);
    effect.set("flatness", 1.5);
    effect.set("corners", 0.5);
    const BlockPopulation changed = reshaped(population, std::vector<Effect>{effect});
    const Vec3 size = changed.list[0].size;
    EXPECT_NEAR(size.prod(), 1.2 * 0.8, 1e-12);
    EXPECT_NEAR(size.x() / size.y(), 1.2 * 1.3, 1e-12);
    EXPECT_NEAR(size.y() / size.z(), 1.0 / 0.8 * 1.5, 1e-12);
    EXPECT_EQ(changed.list[0].mass, 1000.0);
    EXPECT_EQ(changed.shape.points, 20);
    EXPECT_EQ(changed.shape.polygon_points, 8) << "of the polygon in 2D, too";
    EXPECT_NEAR(changed.distribution.ratio_21[0], 0.8 / 1.3, 1e-12);
    EXPECT_NEAR(changed.distribution.ratio_32[1], 0.8 / 1.5, 1e-12);
    population.shape.shape = BlockShape::Sharp;
    EXPECT_EQ(reshaped(population, std::vector<Effect>{effect}).shape.points, kSharpPoints / 2);
    EXPECT_EQ(reshaped(population, std::vector<Effect>{effect}).shape.polygon_points, kSharpPoints / 2);
    population.shape.shape = BlockShape::Box;
    EXPECT_THROW(reshaped(population, std::vector<Effect>{effect}), InputError);
}

// Volumes that are drawn again until they lie between ends that are near each other, or one and the same.
TEST(BlockPopulation, LogNormalVolumesLieBetweenNarrowEnds) {
    BlockPopulation population;
    BlockDistribution& d = population.distribution;
    d.law = VolumeLaw::LogNormal;
    d.density = 2600.0;
    for (const double width : {0.0, 1e-12, 1e-3, 0.2}) {
        d.volume_min = 1.0;
        d.volume = 1.0 + 0.5 * width;
        d.volume_max = 1.0 + width;
        double low = kInfinity, high = 0.0;
        for (std::uint64_t k = 0; k < 200; ++k) {
            const double volume = draw_block(population, 3, k).body.mass / d.density;
            low = std::min(low, volume);
            high = std::max(high, volume);
        }
        EXPECT_GE(low, d.volume_min * (1.0 - 1e-12)) << width;
        EXPECT_LE(high, d.volume_max * (1.0 + 1e-12)) << width;
        if (width > 1e-6) {
            EXPECT_GT(high - low, 0.9 * width) << "everywhere between them";
        }
    }
}

// A shape and a push of nothing change no bit of a block and of its start.
TEST(BlockShapeEffect, DoesNothingWhereNeutral) {
    BlockPopulation population;
    population.list = {{"a", 1000.0, {1.2, 1.0, 0.8}}};
    const std::vector<Effect> neutral{make_effect(EffectKind::BlockShape)};
    EXPECT_EQ(draw_polygon(reshaped(population, neutral), 3, 0).body.x.matrix(),
              draw_polygon(population, 3, 0).body.x.matrix());
    EXPECT_EQ(draw_block(reshaped(population, neutral), 3, 0).body.volume, draw_block(population, 3, 0).body.volume);
}

TEST(ReleaseMotion, DoesNothingWhereNeutral) {
    const auto surface = grid_terrain(20.0, 1.0, [](double x, double) { return -0.6 * x; });
    BlockState<3> s;
    s.velocity = {1.0, 2.0, 3.0};
    const Vec3 before = s.velocity;
    push_release(std::vector<Effect>{push(0.0, 0.0)}, *surface, s);
    EXPECT_EQ(s.velocity, before);
    EXPECT_EQ(s.spin, BlockState<3>().spin);
}

TEST(EffectStream, DiffersByKindNumberAndBlock) {
    std::set<std::uint64_t> first;
    for (const EffectKind kind : {EffectKind::RestitutionPfeifferBowen, EffectKind::Trees, EffectKind::IdsShuffled})
        for (const std::uint64_t number : {0, 1})
            for (const std::uint64_t block : {0, 1, 1'000'000'000}) {
                EXPECT_EQ(effect_stream(5, kind, number, block).bits(), effect_stream(5, kind, number, block).bits());
                first.insert(effect_stream(5, kind, number, block).bits());
            }
    EXPECT_EQ(first.size(), 18U);
}

TEST(ScaledBlock, IsTheSameBlockSmaller) {
    RandomStream random(1, 2, RandomPurpose::Shape);
    const ConvexBlock block = make_block({}, {0.9, 0.7, 0.55}, 400.0, random), half = scaled_block(block, 0.5);
    EXPECT_NEAR(half.mass, 50.0, 1e-12);
    EXPECT_NEAR(half.volume, block.volume / 8.0, 1e-12);
    EXPECT_LT((half.inertia - block.inertia / 32.0).norm(), 1e-12);
    EXPECT_LT((half.vertex(3) - 0.5 * block.vertex(3)).norm(), 1e-15);
    EXPECT_DOUBLE_EQ(effect_body(half).length, 0.5 * (0.9 + 0.7 + 0.55) / 3.0);
}

}  // namespace scree::test
