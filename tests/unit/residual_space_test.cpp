// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/residual_space.hpp"

#include "scree/base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace scree::test {
namespace {

constexpr Column kUpper{Quantity::InZone, 0}, kLower{Quantity::InZone, 1}, kAlong{Quantity::Along, -1};

/// A pool of blocks of which the first are in the upper zone, the next in the lower one, and the rest in none.
ObservationTable pool(std::size_t upper, std::size_t lower, std::size_t rows) {
    ObservationTable t{{kUpper, kLower}, {std::vector<double>(rows), std::vector<double>(rows)}, {}};
    t.block.assign(rows, -1);
    for (std::size_t k = 0; k < upper + lower; ++k) t.values[k < upper ? 0 : 1][k] = 1.0;
    return t;
}

// Counts of a survey without coordinates are shares in units of half a block.
TEST(ResidualSpace, SharesOfZonesStandForStopsThatNobodyMeasured) {
    const ObservationTable measured = pool(20, 16, 40);
    const ResidualSpace space(pool(300, 400, 1000), measured, {}, {});
    ASSERT_EQ(space.residuals().size(), 2U);
    const std::vector<std::string> zones{"1A", "2A"};
    EXPECT_EQ(residual_name(space.residuals()[0], {}, zones), "share that stops in 1A");
    const ResidualRows rows = space.of(measured);
    EXPECT_NEAR(rows.col(0).mean(), (20.0 / 40.0 - 0.3) / 0.5, 1e-12);
    EXPECT_NEAR(rows.col(1).mean(), 0.0, 1e-12);
}

TEST(ResidualSpace, ZonesAddNothingToStopsThatWereMeasured) {
    const auto with_stops = [](ObservationTable t) {
        t.columns.push_back(kAlong);
        t.values.emplace_back();
        for (std::size_t k = 0; k < t.rows(); ++k) t.values.back().push_back(static_cast<double>(k % 40));
        return t;
    };
    const ResidualSpace space(with_stops(pool(300, 400, 1000)), with_stops(pool(20, 16, 40)), {}, {});
    ASSERT_FALSE(space.residuals().empty());
    for (const Residual& r : space.residuals()) EXPECT_EQ(r.column, kAlong);
}

// A radar may tell energies alone; beside speeds they say nothing new.
TEST(ResidualSpace, EnergiesCountWhereNoSpeedsWereMeasured) {
    const auto table = [](std::size_t rows, bool speeds) {
        ObservationTable t{{{Quantity::Passed, 0}, {Quantity::Energy, 0}}, {{}, {}}, {}};
        t.block.assign(rows, -1);
        t.values[0].assign(rows, 1.0);
        for (std::size_t k = 0; k < rows; ++k) t.values[1].push_back(static_cast<double>(k % 37));
        if (speeds) {
            t.columns.push_back({Quantity::Speed, 0});
            t.values.push_back(t.values[1]);
        }
        return t;
    };
    const auto of_energy = [&](bool speeds) {
        const ResidualSpace space(table(1000, speeds), table(40, speeds), {}, {});
        return std::count_if(space.residuals().begin(), space.residuals().end(), [](const Residual& r) {
            return r.column == Column{Quantity::Energy, 0};
        });
    };
    EXPECT_EQ(of_energy(false), 2) << "level and spread";
    EXPECT_EQ(of_energy(true), 0);
}

// Who is fast at the first screen is fast at the second: that the first level says already. The innovation asks what happened on the way in between.
TEST(ResidualSpace, AnInnovationIsNewsSinceTheScreenBefore) {
    constexpr std::size_t kBlocks = 160;
    const std::vector<ObservedBlock> blocks = [] {
        std::vector<ObservedBlock> list(kBlocks);
        for (ObservedBlock& b : list) {
            b.mass = 1000.0;
            b.size = {1.0, 1.0, 1.0};
        }
        return list;
    }();
    const Column first{Quantity::Speed, 0}, second{Quantity::Speed, 1};
    const auto thrown = [&](double faster_at_first, double slowed, std::uint64_t seed, std::size_t repeats) {
        ObservationTable t{{{Quantity::Passed, 0}, first, {Quantity::Passed, 1}, second}, {{}, {}, {}, {}}, {}};
        RandomStream random(seed, 1, RandomPurpose::Effect);
        for (std::size_t k = 0; k < repeats * kBlocks; ++k) {
            const double v = 10.0 + faster_at_first + 2.0 * random.normal();
            t.block.push_back(static_cast<std::int32_t>(k % kBlocks));
            for (const std::size_t passed : {0, 2}) t.values[passed].push_back(1.0);
            t.values[1].push_back(v);
            t.values[3].push_back(v - slowed + 0.5 * random.normal());
        }
        return t;
    };
    const ObservationTable nothing = thrown(0.0, 0.0, 3, 1), faster = thrown(1.5, 0.0, 3, 1),
                           slowed = thrown(0.0, 0.7, 3, 1);
    const ResidualSpace space(thrown(0.0, 0.0, 1, 50), nothing, blocks, {});
    const auto mean_of = [&](const ObservationTable& t, ResidualKind kind, const Column& column) {
        for (std::size_t k = 0; k < space.residuals().size(); ++k) {
            if (space.residuals()[k].kind != kind || !(space.residuals()[k].column == column)) continue;
            double sum = 0.0, count = 0.0;
            const ResidualRows rows = space.of(t);
            for (const double v : rows.col(static_cast<Eigen::Index>(k)))
                if (std::isfinite(v)) {  // faster than any that was simulated: an innovation says nothing
                    sum += v;
                    count += 1.0;
                }
            return sum / count;
        }
        ADD_FAILURE() << "no such residual";
        return kNaN;
    };
    const double chance =
        3.0 / std::sqrt(static_cast<double>(kBlocks));  // standard errors of a mean of numbers of variance 1
    for (const ResidualKind kind : {ResidualKind::Level, ResidualKind::Innovation})
        EXPECT_LT(std::abs(mean_of(nothing, kind, second)), chance);
    EXPECT_GT(mean_of(faster, ResidualKind::Level, second), chance);
    EXPECT_LT(std::abs(mean_of(faster, ResidualKind::Innovation, second)), chance) << "no news";
    EXPECT_LT(mean_of(slowed, ResidualKind::Innovation, second), -2.0 * chance);
    EXPECT_GT(mean_of(slowed, ResidualKind::Level, second), -2.0 * chance) << "among all speeds little";
}

// A model that lets hardly any block pass has a few passing repeats of each, and many of all together.
TEST(ResidualSpace, BlocksThatHardlyEverPassAreComparedWithAllThatPassed) {
    constexpr std::size_t kBlocks = 400;
    std::vector<ObservedBlock> blocks(kBlocks);
    for (std::size_t k = 0; k < kBlocks; ++k) {
        blocks[k].mass = 500.0 + 5.0 * static_cast<double>(k);
        blocks[k].size = {1.0, 1.0, 1.0};
    }
    const Column speed{Quantity::Speed, 0};
    const auto thrown = [&](double share, double faster, std::uint64_t seed, std::size_t repeats) {
        ObservationTable t{{{Quantity::Passed, 0}, speed}, {{}, {}}, {}};
        RandomStream random(seed, 1, RandomPurpose::Effect);
        for (std::size_t k = 0; k < repeats * kBlocks; ++k) {
            const bool passed = random.uniform() < share;
            t.block.push_back(static_cast<std::int32_t>(k % kBlocks));
            t.values[0].push_back(passed ? 1.0 : 0.0);
            t.values[1].push_back(passed ? 10.0 + faster + random.normal() : kNaN);
        }
        return t;
    };
    const ObservationTable measured = thrown(0.3, 1.0, 2, 1);
    const ResidualSpace space(thrown(0.04, 0.0, 1, 50), measured, blocks, {});
    const auto level = std::find_if(space.residuals().begin(), space.residuals().end(), [&](const Residual& r) {
        return r.kind == ResidualKind::Level && r.column == speed;
    });
    ASSERT_NE(level, space.residuals().end()) << "no speeds in the diagnosis";
    const auto column = static_cast<Eigen::Index>(level - space.residuals().begin());
    const auto mean_of = [&](const ResidualRows& rows, std::ptrdiff_t& count) {
        const auto values = rows.col(column).array();
        count = values.isFinite().count();
        return values.isFinite().select(values, 0.0).sum() / static_cast<double>(count);
    };
    std::ptrdiff_t count = 0;
    EXPECT_NEAR(mean_of(space.of_reference(), count), 0.0, 1e-12);
    EXPECT_EQ(count, std::count(space.reference().values[0].begin(), space.reference().values[0].end(), 1.0));
    const double fast = mean_of(space.of(measured), count);
    EXPECT_EQ(count, std::count(measured.values[0].begin(), measured.values[0].end(), 1.0));
    EXPECT_GT(fast, 0.7) << "sqrt(12) (0.76 - 1/2) = 0.90 is expected of speeds one standard deviation higher";
    const double like = mean_of(space.of(thrown(0.04, 0.0, 3, 20)), count);
    EXPECT_LT(std::abs(like), 3.0 / std::sqrt(static_cast<double>(count))) << "nothing where the model is right";
    const ResidualSpace too_few(thrown(0.004, 0.0, 1, 50), measured, blocks, {});
    for (const Residual& r : too_few.residuals()) EXPECT_EQ(r.kind, ResidualKind::Passed);
}

// All blocks meet an impact with nearly the same speed: a camera that errs more than it says is seen there.
TEST(ResidualSpace, AnImpactShowsTheSpreadOfItsSpeeds) {
    const Column start{Quantity::Speed, 0}, end{Quantity::Speed, 1};  // no share that passes: of an impact
    const auto filmed = [&](std::size_t blocks, double deviation, std::uint64_t seed) {
        ObservationTable t{{start, end}, {{}, {}}, std::vector<std::int32_t>(blocks, -1)};
        RandomStream random(seed, 1, RandomPurpose::Effect);
        for (std::size_t k = 0; k < blocks; ++k) {
            t.values[0].push_back(6.0 + deviation * random.normal());
            t.values[1].push_back(4.0 + random.normal());
        }
        return t;
    };
    const ObservationTable noisy = filmed(400, 0.5, 2);
    const ResidualSpace space(filmed(2000, 0.25, 1), noisy, {}, {});
    const ResidualRows rows = space.of(noisy);
    const auto spread_of = [&](const Column& column) {
        for (std::size_t k = 0; k < space.residuals().size(); ++k)
            if (space.residuals()[k].kind == ResidualKind::Spread && space.residuals()[k].column == column)
                return rows.col(static_cast<Eigen::Index>(k)).mean();
        ADD_FAILURE() << "no such residual";
        return kNaN;
    };
    const double chance = 3.0 * std::sqrt(1.0 / 400.0 + 1.0 / 2000.0);
    EXPECT_GT(spread_of(start), 2.0 * chance);
    EXPECT_LT(std::abs(spread_of(end)), chance);
}

}  // namespace
}  // namespace scree::test
