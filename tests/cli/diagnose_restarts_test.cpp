// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks held against restarts of their own: what is beyond chance, and what is not.
#include "cli/diagnose_restarts.hpp"

#include "cli/program.hpp"
#include "cli/site_file.hpp"
#include "cli/site_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace scree::cli {
namespace {

double standardised(const RestartedBlocks& blocks) {
    return (blocks.measured() - blocks.simulated()) / std::sqrt(blocks.variance());
}

TEST(RestartedBlocks, NoneWhereAllPassedIsTheLargestDifference) {
    RestartedBlocks blocks(true);
    const std::array<double, 10> none{};
    for (int k = 0; k < 12; ++k) blocks.add(1.0, none);
    EXPECT_EQ(blocks.blocks(), 12U);
    EXPECT_EQ(blocks.measured(), 1.0);
    EXPECT_EQ(blocks.simulated(), 0.0);
    EXPECT_NEAR(standardised(blocks), 12.0, 1e-9) << "one block more or less is no news";
}

TEST(RestartedBlocks, TheErrorIsTheModelsOrThatOfTheBlocksIfTheyDifferMore) {
    const std::array<double, 2> restarts{-1.0, 1.0};  // a variance of 2, of their mean 1
    RestartedBlocks alike(false), scattered(false);
    for (int k = 0; k < 8; ++k) {
        alike.add(0.5, restarts);
        scattered.add(k % 2 == 0 ? 4.0 : -3.0, restarts);
    }
    EXPECT_NEAR(alike.variance(), 2.0 * 1.5 / 8.0, 1e-12);
    EXPECT_NEAR(scattered.measured(), 0.5, 1e-12);
    EXPECT_NEAR(scattered.variance(), 8.0 * 3.5 * 3.5 / 7.0 / 8.0, 1e-12);
}

// The limit of three looks, 1.7 % of the tests by a normal distribution: of a model that is right no more are told, however few blocks there are and whatever share
// of them passes.
TEST(RestartedBlocks, ARightModelIsLeftAlone) {
    constexpr int kTests = 4000, kRepeats = 10;
    constexpr double kLimit = 2.394, kShare = 0.0167;
    std::mt19937_64 random(7);
    const auto uniform = [&] { return std::generate_canonical<double, 53>(random); };
    const auto told = [&](int blocks, bool shares, auto value) {
        int beyond = 0;
        for (int t = 0; t < kTests; ++t) {
            RestartedBlocks all(shares);
            for (int k = 0; k < blocks; ++k) {
                std::array<double, kRepeats> restarts{};
                for (double& r : restarts) r = value();
                all.add(value(), restarts);
            }
            beyond += std::abs(standardised(all)) > kLimit;
        }
        return static_cast<double>(beyond) / kTests;
    };
    const double most = kShare + 4.0 * std::sqrt(kShare / kTests);
    for (const int blocks : {8, 12, 24, 40}) {
        for (const double share : {0.5, 0.8, 0.9, 0.95, 0.97})
            EXPECT_LT(told(blocks, true, [&] { return uniform() < share ? 1.0 : 0.0; }), most)
                << blocks << " " << share;
        // speeds, skewed
        EXPECT_LT(told(blocks, false, [&] { return -std::log(1.0 - uniform()); }), most + 0.01) << blocks;
    }
}

// A screen that stands for a barrier to come has measured nothing: it takes no part.
TEST(ScreenInnovations, GoFromOneScreenThatMeasuredToTheNext) {
    const auto riddle = test::quarry_a().parent_path() / "quarry_riddle";
    const auto ways = [&](const std::string& chainages) {
        const SiteFile site = read_site_file(riddle / "site.toml", {"screens.file=", "screens.chainages=" + chainages});
        const SiteModel model = load_site(site);
        const ObservedSite observed = load_observed(site, model, (riddle / "observed").string());
        const FreeKeys keys;
        const FieldTest test(site, model, observed, keys, 1);
        std::vector<std::string> names;
        const auto all = screen_innovations(test, site, observed, test.run(site, 1, 4));
        EXPECT_TRUE(all);
        for (const ScreenInnovation& i : all ? *all : std::vector<ScreenInnovation>{})
            names.push_back(observed.op.screens[static_cast<std::size_t>(i.from)] + " to " +
                            (i.to < 0 ? "the stop" : observed.op.screens[static_cast<std::size_t>(i.to)]));
        return names;
    };
    const std::vector<std::string> two = ways("ES1-A = 39.5, ES2-A = 48.5");
    EXPECT_GT(two.size(), 2U);
    EXPECT_EQ(ways("ES1-A = 39.5, between = 44, ES2-A = 48.5, below = 52"), two);
}

}  // namespace
}  // namespace scree::cli
