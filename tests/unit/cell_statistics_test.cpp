// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/cell_statistics.hpp"

#include <gtest/gtest.h>

namespace scree::test {
namespace {

// Half a million passages of a block of 1000 m3 at 40 m/s through one cell: the sum is beyond 64 bits.
TEST(CellStatistics, SumsOfLargeEnergiesDoNotOverflow) {
    constexpr double kEnergy = 2.1e9;
    constexpr int kPassages = 500'000;
    QuantityStatistics half;
    for (int k = 0; k < kPassages; ++k) half.add(kEnergy);
    QuantityStatistics all = half;
    all.merge(half);
    EXPECT_NEAR(1e-4 * static_cast<double>(all.sum) / (2.0 * kPassages), kEnergy, 1.0);
}

// The bins know a value to 1 % only; a map on which the 95 % quantile exceeds the maximum would be wrong on its face.
TEST(CellStatistics, NoQuantileExceedsTheLargestValue) {
    for (double value = 0.5; value < 50.0; value *= 1.003) {
        QuantityStatistics one;
        one.add(value);
        EXPECT_LE(one.quantile(0.99), value);
        EXPECT_GE(one.quantile(0.5), (1.0 - kQuantileError) * value);
    }
}

// 1 to 1000, half of them in either part: a share q of them is at or below 1000 q.
TEST(CellStatistics, QuantilesAndMeansOfPartsThatAreMerged) {
    CellStatistics parts[2];
    for (int k = 1; k <= 1000; ++k)
        parts[k % 7 < 3 ? 0 : 1].add_passage({1.0 * k, 2.0 * k, 3.0 * k, k % 2 == 0 ? 5.0 : 0.0});
    ++parts[0].deposits;
    parts[1].deposits += 2;
    CellMap all{{4, parts[0]}}, more{{4, parts[1]}, {9, parts[1]}};
    merge_cells(all, more);
    EXPECT_EQ(all.at(9).passages, parts[1].passages);
    const CellStatistics& cell = all.at(4);
    EXPECT_EQ(cell.passages, 1000);
    EXPECT_EQ(cell.deposits, 3);
    for (const double q : {0.001, 0.01, 0.5, 0.9, 0.95, 0.98, 0.99, 1.0})
        for (std::size_t k = 0; k < 3; ++k) {
            const double exact = 1000.0 * q * static_cast<double>(k + 1);
            EXPECT_NEAR(cell.quantities[k].quantile(q), exact, kQuantileError * exact) << q;
        }
    EXPECT_EQ(cell.quantities[3].quantile(0.5), 0.0);
    EXPECT_NEAR(cell.quantities[3].quantile(0.501), 5.0, 0.05);
    EXPECT_EQ(cell.quantities[2].largest, 3000.0);
    EXPECT_NEAR(1e-4 * static_cast<double>(cell.quantities[1].sum) / 1000.0, 1001.0, 1e-6);
}

// Wilson 1927: the ends solve (p - k / n)^2 = z^2 p (1 - p) / n.
TEST(Wilson, EndsSolveItsEquation) {
    for (const auto& [k, n] : {std::pair<int, int>{8, 10}, {1, 50}, {25, 50}, {999, 1000}}) {
        const auto [low, high] = wilson_interval(k, n);
        const double share = static_cast<double>(k) / n, z = 1.959963984540054;
        for (const double p : {low, high})
            EXPECT_NEAR((p - share) * (p - share), z * z * p * (1.0 - p) / n, 1e-12) << k << " of " << n;
        EXPECT_TRUE(low < share && share < high);
    }
    EXPECT_EQ(wilson_interval(0, 20).first, 0.0);
    EXPECT_EQ(wilson_interval(20, 20).second, 1.0);
    EXPECT_NEAR(wilson_interval(0, 20).second, 3.8415 / 23.8415, 1e-4);
    EXPECT_EQ(wilson_interval(0, 0), std::make_pair(0.0, 1.0));
}

}  // namespace
}  // namespace scree::test
