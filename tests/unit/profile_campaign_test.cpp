// SPDX-License-Identifier: GPL-3.0-or-later
// Campaigns in 2D: where blocks start on profiles, and what is counted along them.
#include "scree/base/error.hpp"
#include "scree/ensemble/campaign.hpp"
#include "support/plane_scenes.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace scree::test {

namespace {

/// A straight profile in plan from `start` towards `direction`, falling by 0.7 a metre and level for its last 60 metres, in reaches of one metre.
Profile straight_profile(const Vec2& start, const Vec2& direction, int length) {
    std::vector<Vec3> points;
    for (int k = 0; k <= length; ++k) {
        const Vec2 p = start + k * direction.normalized();
        points.emplace_back(p.x(), p.y(), k <= length - 60 ? -0.7 * k : -0.7 * (length - 60));
    }
    return make_profile(points, std::vector<SoilId>(points.size() - 1, 0));
}

MultiPolygon square(double x0, double y0, double x1, double y1) {
    return {Polygon{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}}};
}
Polylines line(std::vector<Vec3> points) {
    return {Polyline{std::move(points), {}}};
}

/// Counts of (profile, feature) and the range of chainages of 4000 draws.
struct Draws {
    std::map<std::pair<std::size_t, std::int64_t>, int> count;
    double low = kInfinity, high = -kInfinity;
    explicit Draws(const ProfileRelease& release) {
        for (std::uint64_t k = 0; k < 4000; ++k) {
            const ProfileRelease::Place p = release.draw(7, k);
            ++count[{p.profile, p.feature}];
            low = std::min(low, p.s);
            high = std::max(high, p.s);
        }
    }
};

constexpr double kFarthest = 5.0;
constexpr double kCell = 1.0;

}  // namespace

TEST(ProfileRelease, PolygonOnTheStretchesInside) {
    const std::vector<Profile> profiles{straight_profile({0, 0}, {1, 0}, 160), straight_profile({0, 3}, {1, 0}, 160)};
    const ProfileRelease release(release_layer({square(10, -1, 20, 1)}), profiles, ReleasePattern::Random, kCell,
                                 kFarthest);
    const Draws draws(release);
    EXPECT_EQ(draws.count.size(), 1u);
    EXPECT_NEAR(draws.low, 10.0, 0.02);
    EXPECT_NEAR(draws.high, 20.0, 0.02);
    EXPECT_TRUE(release.used()[0]);
    EXPECT_FALSE(release.used()[1]);
}

// A polygon of twice the area sends twice the blocks, through however many profiles; these share them by their length inside.
TEST(ProfileRelease, FeaturesShareByAreaProfilesByLength) {
    const std::vector<Profile> profiles{straight_profile({0, 0}, {1, 0}, 160), straight_profile({0, 3}, {1, 0}, 160)};
    const ProfileRelease release(release_layer({square(10, -5, 20, 1), square(30, -5, 33, 35)}), profiles,
                                 ReleasePattern::Random, kCell, kFarthest);
    Draws draws(release);
    // areas 60 and 120; the second polygon holds 3 m of each profile; standard error 30
    EXPECT_NEAR((draws.count[{0, 11}]), 4000 / 3, 120);
    EXPECT_NEAR((draws.count[{0, 12}]), 4000 / 3, 120);
    EXPECT_NEAR((draws.count[{1, 12}]), 4000 / 3, 120);
}

TEST(ProfileRelease, PointsAndLinesNearAProfile) {
    const std::vector<Profile> profiles{straight_profile({0, 0}, {1, 0}, 160), straight_profile({0, 8}, {1, 0}, 160)};
    // across the first profile; along the second, 2 m beside it; a point near the first; a point far from both
    const ProfileRelease release(release_layer({line({{12.5, -2, 0}, {12.5, 2, 0}}), line({{20, 10, 0}, {30, 10, 0}}),
                                                Points{{5, 1, 0}}, Points{{5, -9, 0}}}),
                                 profiles, ReleasePattern::Random, kCell, kFarthest);
    for (std::uint64_t k = 0; k < 500; ++k) {
        const ProfileRelease::Place p = release.draw(7, k);
        if (p.feature == 11) {
            EXPECT_EQ(p.profile, 0u);
            EXPECT_NEAR(p.s, 12.5, 1e-9);
        } else if (p.feature == 12) {
            EXPECT_EQ(p.profile, 1u);
            EXPECT_TRUE(p.s >= 20.0 && p.s <= 30.0);
        } else {
            EXPECT_EQ(p.feature, 13);
            EXPECT_NEAR(p.s, 5.0, 1e-9);
        }
    }
    EXPECT_EQ(release.left_out(), std::vector<std::int64_t>{14});
    const auto foot = ProfileRelease::foot({7.5, 6.0}, profiles, kFarthest);
    ASSERT_TRUE(foot);
    EXPECT_EQ(foot->profile, 1u);
    EXPECT_NEAR(foot->s, 7.5, 1e-9);
    EXPECT_EQ(foot->feature, -1);
    EXPECT_FALSE(ProfileRelease::foot({5, -9}, profiles, kFarthest));
}

TEST(ProfileRelease, CellsOneAfterTheOther) {
    const std::vector<Profile> profiles{straight_profile({0, 0}, {1, 0}, 160)};
    const ProfileRelease release(release_layer({square(10.2, -1, 13.4, 1)}), profiles, ReleasePattern::Cells, kCell,
                                 kFarthest);
    ASSERT_EQ(release.cell_count(), 3u);
    EXPECT_NEAR(release.draw(1, 0).s, 10.5, 1e-9);
    EXPECT_NEAR(release.draw(1, 1).s, 11.5, 1e-9);
    EXPECT_NEAR(release.draw(1, 2).s, 12.5, 1e-9);
    const std::set<double> later{release.draw(1, 3).s, release.draw(1, 4).s, release.draw(1, 5).s};
    EXPECT_EQ(later.size(), 3U);
}

TEST(ProfileRelease, NothingToReleaseIsAnError) {
    const std::vector<Profile> profiles{straight_profile({0, 0}, {1, 0}, 160)};
    EXPECT_THROW(
        ProfileRelease(release_layer({square(10, 5, 20, 6)}), profiles, ReleasePattern::Random, kCell, kFarthest),
        InputError);
    EXPECT_THROW(ProfileRelease(release_layer({Points{{5, 1, 0}}}), profiles, ReleasePattern::Cells, kCell, kFarthest),
                 InputError);
}

class ProfileCampaign : public testing::Test {
protected:
    ProfileCampaign()
        : profiles_{straight_profile({0, 0}, {1, 0}, 100), straight_profile({0, 5}, {3, 4}, 90)},
          release_(release_layer({square(5, -1, 8, 1), Points{{3, 9, 0}}}), profiles_, ReleasePattern::Random, kCell,
                   kFarthest) {
        for (const Profile& p : profiles_) input_.tracks.push_back({p, {}});
        input_.profile_release = &release_;
        input_.soils = {{"slope", 0.2, 0.5, 0.05}};
        input_.population.distribution.volume = 0.2;
        input_.population.filling = mean_filling({});
        input_.release.count = 200;
        input_.release.height = 1.0;
        input_.screens = {{"both", {}}, {"first", {}}};
        input_.tracks[0].marks = {{0, 30.0}, {1, 20.0}};
        input_.tracks[1].marks = {{0, 25.0}};
        input_.deposit_zones.push_back({"lower", Region(square(35, -3, 110, 3))});
        input_.kept_trajectories = 5;
    }
    CampaignResult run() const {
        const std::atomic<bool> stop{false};
        return run_campaign(input_, {}, stop);
    }
    std::vector<Profile> profiles_;
    ProfileRelease release_;
    CampaignInput input_;
};

TEST_F(ProfileCampaign, CountsClose) {
    const CampaignResult r = run();
    EXPECT_EQ(r.released, 200);
    EXPECT_EQ(r.reasons[0] + r.reasons[1] + r.reasons[2] + r.reasons[3], 200);
    EXPECT_GT(r.reasons[static_cast<std::size_t>(StopReason::AtRest)], 100);
    std::int64_t deposits = 0, in_zone = 0;
    for (const CellMap& cells : r.cells_along)
        for (const auto& [cell, statistics] : cells) deposits += statistics.deposits;
    EXPECT_EQ(deposits, r.reasons[static_cast<std::size_t>(StopReason::AtRest)]);
    for (const BlockResult& b : r.blocks) {
        const Profile& p = profiles_[static_cast<std::size_t>(b.profile)];
        EXPECT_NEAR((p.place_at(b.stop_s) - b.stop.head<2>()).norm(), 0.0, 1e-12);
        EXPECT_NEAR((p.place_at(b.release_s) - b.release.head<2>()).norm(), 0.0, 1e-12);
        in_zone += b.reason == StopReason::AtRest && b.profile == 0 && b.stop_s > 35.0;
    }
    EXPECT_EQ(r.deposits[0].count, in_zone);
    EXPECT_GT(in_zone, 0);
    EXPECT_EQ(r.trajectories.size(), 5u);
    for (const KeptTrajectory& t : r.trajectories) {
        const BlockResult& b = r.blocks[static_cast<std::size_t>(t.block)];
        EXPECT_NEAR((t.points.back() - b.stop).norm(), 0.0, 1e-9) << "a path ends where the block stopped";
        EXPECT_NEAR(t.chainages.back(), b.stop_s, 1e-9);
    }
}

// Who crosses the screen crosses the cell below it; a block that ends beyond a screen has crossed it.
TEST_F(ProfileCampaign, CrossingsAgreeWithPassagesAndStops) {
    const CampaignResult r = run();
    std::map<std::int32_t, std::int64_t> crossings;
    std::int64_t beyond = 0;
    for (const ScreenCrossing& c : r.crossings) {
        const auto profile = r.blocks[static_cast<std::size_t>(c.block)].profile;
        // in contact the path within a step counts as straight in time: off by hundredths of a millimetre
        EXPECT_NEAR(c.s, c.screen == 1 ? 20.0 : profile == 0 ? 30.0 : 25.0, 5e-5);
        EXPECT_GE(c.height, 0.0);
        EXPECT_GT(c.energy, 0.0);
        crossings[c.screen] += profile == 0 ? 1 : 0;
    }
    for (const BlockResult& b : r.blocks) beyond += b.profile == 0 && b.stop_s > 30.0;
    EXPECT_GE(crossings[0], beyond);
    EXPECT_EQ(r.cells_along[0].at(30).passages, crossings[0]);
    EXPECT_EQ(r.cells_along[0].at(20).passages, crossings[1]);
}

TEST_F(ProfileCampaign, DoesNotDependOnThreadsOrCount) {
    input_.threads = 1;
    const CampaignResult one = run();
    input_.threads = 5;
    input_.release.count = 150;
    const CampaignResult five = run();
    for (std::size_t k = 0; k < five.blocks.size(); ++k) {
        EXPECT_EQ(one.blocks[k].stop, five.blocks[k].stop);
        EXPECT_EQ(one.blocks[k].largest_energy, five.blocks[k].largest_energy);
        EXPECT_EQ(one.blocks[k].profile, five.blocks[k].profile);
    }
    input_.release.count = 200;
    const CampaignResult again = run();
    ASSERT_EQ(one.crossings.size(), again.crossings.size());
    for (std::size_t k = 0; k < one.crossings.size(); ++k) {
        EXPECT_EQ(one.crossings[k].block, again.crossings[k].block);
        EXPECT_EQ(one.crossings[k].energy, again.crossings[k].energy);
    }
    for (std::size_t p = 0; p < 2; ++p) {
        ASSERT_EQ(one.cells_along[p].size(), again.cells_along[p].size());
        for (const auto& [cell, statistics] : one.cells_along[p]) {
            const CellStatistics& other = again.cells_along[p].at(cell);
            EXPECT_EQ(statistics.passages, other.passages);
            for (std::size_t q = 0; q < kCellQuantities; ++q) {
                EXPECT_EQ(statistics.quantities[q].sum, other.quantities[q].sum);
                EXPECT_EQ(statistics.quantities[q].histogram.quantile(0.95),
                          other.quantities[q].histogram.quantile(0.95));
            }
        }
    }
}

// Of blocks that are left out nothing is known; the others move as they do in company.
TEST_F(ProfileCampaign, ThrowsTheOnesThatAreAskedFor) {
    const CampaignResult all = run();
    for (int k = 0; k < 200; ++k) input_.thrown.push_back(k % 3 == 0);
    const CampaignResult third = run();
    input_.thrown.flip();
    const CampaignResult rest = run();
    EXPECT_EQ(third.released, 67);
    EXPECT_EQ(rest.released, 133);
    EXPECT_FALSE(third.interrupted);
    EXPECT_EQ(third.crossings.size() + rest.crossings.size(), all.crossings.size());
    for (std::size_t k = 0; k < all.blocks.size(); ++k) {
        EXPECT_NE(third.blocks[k].done, rest.blocks[k].done);
        EXPECT_EQ((k % 3 == 0 ? third : rest).blocks[k].stop, all.blocks[k].stop);
    }
}

// A block thrown level from 5 m over the slope flies over it: heights and speeds of every cell are those of the parabola.
TEST_F(ProfileCampaign, CellsHoldTheTrueLargestValues) {
    input_.release = {};
    input_.release.count = 1;
    input_.release.height = 5.0;
    input_.release.speed = 6.0;
    input_.population.shape.shape = BlockShape::Box;
    const ProfileRelease point(release_layer({Points{{5.25, 0, 0}}}), profiles_, ReleasePattern::Random, kCell,
                               kFarthest);
    input_.profile_release = &point;
    const CampaignResult r = run();
    auto height = [](double s) {
        return 5.0 + 0.7 * (s - 5.25) - 0.5 * kStandardGravity * std::pow((s - 5.25) / 6.0, 2);
    };
    auto speed = [](double s) { return std::hypot(6.0, kStandardGravity * (s - 5.25) / 6.0); };
    const double apex = 5.25 + 0.7 * 36.0 / kStandardGravity;
    for (const std::size_t cell : {5u, 6u, 7u, 8u, 9u}) {
        const CellStatistics& c = r.cells_along[0].at(cell);
        const double low = std::max(5.25, static_cast<double>(cell)), high = static_cast<double>(cell) + 1.0;
        const double largest = apex > low && apex < high ? height(apex) : std::max(height(low), height(high));
        EXPECT_EQ(c.passages, 1);
        EXPECT_NEAR(c.quantities[static_cast<std::size_t>(CellQuantity::PassingHeight)].largest, largest, 1e-9);
        EXPECT_NEAR(c.quantities[static_cast<std::size_t>(CellQuantity::Speed)].largest, speed(high), 1e-9);
    }
}

// The polygon of a drawn volume has the L1, L2 of the block that fills its box as blocks of that shape do in the mean.
TEST(DrawPolygon, SizesAreThoseOfTheMeanBlock) {
    BlockPopulation population;
    population.shape.shape = BlockShape::Box;
    population.filling = mean_filling(population.shape);
    EXPECT_NEAR(population.filling, 1.0, 1e-12);
    population.distribution.volume = 0.8 * 0.64 * 8.0;  // ratios 0.8: L1 = 2 m
    const PopulationPolygon p = draw_polygon(population, 1, 1);
    EXPECT_NEAR(p.body.size.x(), 2.0, 1e-12);
    EXPECT_NEAR(p.body.size.y(), 1.6, 1e-12);
    EXPECT_NEAR(p.body.mass, 2600.0 * 0.8 * 0.64 * 8.0, 1e-9);
    EXPECT_NEAR(p.body.area, 3.2, 1e-12);
    population.list = {{"a", 700.0, {1.0, 0.9, 0.5}}};
    EXPECT_EQ(draw_polygon(population, 1, 1).body.size, Vec3(1.0, 0.9, 0.5));
    EXPECT_EQ(draw_polygon(population, 1, 1).body.mass, 700.0);
    const double hull = mean_filling({});
    EXPECT_TRUE(hull > 0.3 && hull < 0.6) << hull;
}

}  // namespace scree::test
