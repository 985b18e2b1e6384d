// SPDX-License-Identifier: GPL-3.0-or-later
// The gap as calibration and diagnosis call it: the same numbers as a full comparison, from nothing but the campaign and the seed, least at the truth.
#include "scree/inference/gap_function.hpp"

#include "scree/base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree {
namespace {

constexpr std::size_t kBlocks = 12, kRepeats = 25;

double normal(std::uint64_t number, std::uint64_t use) {
    return RandomStream(use, number, RandomPurpose::Effect).normal();
}

/// Where a block of the test runs, the heavier the farther: mean 30 m + 2 m per block, spread 4 m.
Vec2 stop_of(std::size_t block, std::uint64_t number, std::uint64_t use, double shift) {
    return {30.0 + 2.0 * static_cast<double>(block) + shift + 4.0 * normal(2 * number, use),
            3.0 * normal(2 * number + 1, use)};
}

Observations test_of(double error) {
    Observations o;
    o.matched = true;
    o.thrown = kBlocks;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        o.blocks.push_back({std::to_string(b), 100.0, {1, 1, 1}, {kNaN, kNaN}});
        ObservedStop stop;
        stop.block = static_cast<std::int32_t>(b);
        stop.position.head<2>() = stop_of(b, b, 1, 0.0);
        stop.error = error;
        o.stops.push_back(stop);
        if (b % 4 == 3) continue;  // every fourth did not get to the screen
        ObservedCrossing crossing;
        crossing.block = static_cast<std::int32_t>(b);
        crossing.value = {8.0 + 0.2 * static_cast<double>(b) + normal(b, 2), kNaN, kNaN, kNaN, kNaN};
        o.crossings.push_back(crossing);
    }
    return o;
}

ObservationOperator test_operator() {
    ObservationOperator op;
    op.screens = {"screen"};
    op.screen_of = {0};
    return op;
}

CampaignResult campaign_of(double shift) {
    CampaignResult campaign;
    for (std::size_t k = 0; k < kBlocks * kRepeats; ++k) {
        const std::size_t b = k % kBlocks;
        BlockResult block;
        block.done = true;
        block.reason = StopReason::AtRest;
        block.stop.head<2>() = stop_of(b, k, 3, shift);
        campaign.blocks.push_back(block);
        if (k % 3 == 2) continue;
        ScreenCrossing crossing;
        crossing.block = static_cast<std::int64_t>(k);
        crossing.measured_speed = std::max(0.0, 8.0 + 0.2 * static_cast<double>(b) + 0.3 * shift + normal(k, 4));
        campaign.crossings.push_back(crossing);
    }
    return campaign;
}

void expect_same(const Gap& a, const Gap& b, const std::string& name) {
    EXPECT_EQ(a.gap, b.gap) << name;
    if (std::isfinite(b.distance)) {
        EXPECT_EQ(a.distance, b.distance) << name;
        EXPECT_EQ(a.floor, b.floor) << name;
    }
}

void expect_same(const Discrepancy& a, const Discrepancy& b) {
    ASSERT_EQ(a.observables.size(), b.observables.size());
    for (std::size_t k = 0; k < a.observables.size(); ++k) {
        const std::string& name = a.observables[k].observable.name;
        expect_same(a.observables[k].pooled, b.observables[k].pooled, name);
        ASSERT_EQ(a.observables[k].score.has_value(), b.observables[k].score.has_value()) << name;
        if (a.observables[k].score) expect_same(*a.observables[k].score, *b.observables[k].score, name);
    }
    expect_same(a.overall, b.overall, "overall");
    ASSERT_EQ(a.overall_score.has_value(), b.overall_score.has_value());
    if (a.overall_score) expect_same(*a.overall_score, *b.overall_score, "overall score");
}

TEST(GapFunction, IsTheComparisonWithoutChance) {
    const Observations o = test_of(0.5);
    const ObservationOperator op = test_operator();
    const CampaignResult campaign = campaign_of(2.0);
    const ObservationTable measured = measured_table(o, op), simulated = simulated_table(campaign, o, op, 7);
    const std::vector<double> scales = column_scales(simulated);
    const Discrepancy full = compare_tables(measured, simulated, make_observables(o, op), scales, {50, 1, true});
    const Discrepancy gaps = GapFunction(o, op).with_scales(scales)(campaign, 7);
    expect_same(gaps, full);
    EXPECT_TRUE(std::isfinite(full.overall.chance.high));
    EXPECT_TRUE(std::isnan(gaps.overall.chance.high)) << "no samples of chance are drawn";
    EXPECT_FALSE(gaps.observables[1].wasserstein);
}

TEST(GapFunction, DependsOnCampaignAndSeedOnly) {
    const GapFunction gaps(test_of(0.5), test_operator());
    const CampaignResult a = campaign_of(0.0), b = campaign_of(5.0);
    const Discrepancy first = gaps(a, 7);
    const double other = gaps(b, 7).overall.gap;
    expect_same(gaps(a, 7), first);
    EXPECT_NE(other, first.overall.gap);
    EXPECT_NE(gaps(a, 8).overall.gap, first.overall.gap) << "other errors of the measurements";
}

TEST(GapFunction, IsLeastAtTheTruth) {
    // measured and simulated blocks follow one law at shift 0. The score is the loss for known blocks; the pooled gap agrees
    const GapFunction bare(test_of(0.0), test_operator());
    const GapFunction gaps = bare.with_scales(column_scales(bare.simulated(campaign_of(0.0), 1)));
    double best_pooled = kInfinity, best_score = kInfinity, at_pooled = kNaN, at_score = kNaN;
    for (double shift = -12.0; shift <= 12.0; shift += 1.0) {
        const Discrepancy d = gaps(campaign_of(shift), 1);
        if (d.overall.gap < best_pooled) best_pooled = d.overall.gap, at_pooled = shift;
        if (d.overall_score->distance < best_score) best_score = d.overall_score->distance, at_score = shift;
    }
    // 12 stops with a spread of 4 m tell the shift to 1.2 m: three such errors
    EXPECT_NEAR(at_pooled, 0.0, 3.6);
    EXPECT_NEAR(at_score, 0.0, 3.6);
    EXPECT_GT(gaps(campaign_of(12.0), 1).overall.gap, 5.0 * best_pooled);
    EXPECT_GT(gaps(campaign_of(-12.0), 1).overall_score->distance, 1.2 * best_score)
        << "grows with distance, not with its square";
}

// Where no simulated block gets to a screen speeds there are all alike and have no gap: that measured blocks got there counts all the same.
TEST(GapFunction, AScreenThatNobodyReachesCounts) {
    const GapFunction gaps(test_of(0.0), test_operator());
    CampaignResult nobody = campaign_of(0.0);
    nobody.crossings.clear();
    const auto passing = [](const Discrepancy& d) {
        return *std::ranges::find(d.observables, "passing screen",
                                  [](const ObservableGap& g) { return g.observable.name; });
    };
    const Discrepancy reached = gaps(campaign_of(0.0), 1), missed = gaps(nobody, 1);
    EXPECT_FALSE(passing(reached).counts()) << "speeds say it there";
    EXPECT_TRUE(passing(missed).counts());
    EXPECT_EQ(std::ranges::count_if(missed.observables, &ObservableGap::counts),
              std::ranges::count_if(reached.observables, &ObservableGap::counts));
    EXPECT_GT(missed.overall.gap, 5.0 * reached.overall.gap);
}

// A model 6 m off lowers its gap by scattering three times as much; by distances in floors of the narrow one it does not.
TEST(GapFunction, ScatterDoesNotBringAModelNearer) {
    const GapFunction gaps(test_of(0.0), test_operator());
    CampaignResult narrow = campaign_of(6.0), wide = narrow;
    for (std::size_t k = 0; k < wide.blocks.size(); ++k) {
        const Vec2 centre(36.0 + 2.0 * static_cast<double>(k % kBlocks), 0.0);
        wide.blocks[k].stop.head<2>() = centre + 3.0 * (wide.blocks[k].stop.head<2>() - centre);
    }
    const Discrepancy of_narrow = gaps(narrow, 1), of_wide = gaps(wide, 1), of_truth = gaps(campaign_of(0.0), 1);
    EXPECT_LT(of_wide.overall.gap, of_narrow.overall.gap) << "or the test says nothing";
    const auto distance = [&](const Discrepancy& d) { return distance_over(d.observables, of_narrow.observables); };
    EXPECT_GT(distance(of_wide), distance(of_narrow));
    EXPECT_LT(distance(of_truth), distance(of_narrow));
    EXPECT_NEAR(distance(of_narrow), of_narrow.overall.gap, 1e-12);
}

TEST(GapFunction, OfSomeRowsIsThatOfATestOfTheseBlocks) {
    const Observations all = test_of(0.0);
    const ObservationOperator op = test_operator();
    const CampaignResult campaign = campaign_of(2.0);
    // the first five blocks as a test of their own, with the repeats of these blocks as its campaign
    constexpr std::size_t kSome = 5;
    Observations some = all;
    some.blocks.resize(kSome);
    std::erase_if(some.stops, [](const ObservedStop& s) { return s.block >= static_cast<std::int32_t>(kSome); });
    std::erase_if(some.crossings,
                  [](const ObservedCrossing& c) { return c.block >= static_cast<std::int32_t>(kSome); });
    CampaignResult of_some;
    auto next = campaign.crossings.begin();
    for (std::size_t k = 0; k < campaign.blocks.size(); ++k) {
        const bool crosses = next != campaign.crossings.end() && next->block == static_cast<std::int64_t>(k);
        if (k % kBlocks < kSome) {
            if (crosses) {
                of_some.crossings.push_back(*next);
                of_some.crossings.back().block = static_cast<std::int64_t>(of_some.blocks.size());
            }
            of_some.blocks.push_back(campaign.blocks[k]);
        }
        if (crosses) ++next;
    }
    std::vector<char> rows(kBlocks, 0);
    std::fill_n(rows.begin(), kSome, 1);
    const Discrepancy fold = GapFunction(all, op).with_rows(rows)(campaign, 1),
                      alone = GapFunction(some, op)(of_some, 1);
    expect_same(fold, alone);
    EXPECT_EQ(fold.observables[0].measured, kSome);
    EXPECT_EQ(fold.observables[0].simulated, kSome * kRepeats);
}

TEST(GapFunction, HasAnOverallScoreOnAFixedScaleOnly) {
    const GapFunction gaps(test_of(0.0), test_operator());
    const CampaignResult campaign = campaign_of(2.0);
    EXPECT_FALSE(gaps(campaign, 1).overall_score);
    std::vector<double> scales = column_scales(gaps.simulated(campaign, 1));
    const Gap one = *gaps.with_scales(scales)(campaign, 1).overall_score;
    for (double& s : scales) s *= 2.0;
    const Gap two = *gaps.with_scales(scales)(campaign, 1).overall_score;
    EXPECT_NEAR(two.distance, 0.5 * one.distance, 1e-12);
    EXPECT_NEAR(two.gap, one.gap, 1e-12);
}

}  // namespace
}  // namespace scree
