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

}  // namespace
}  // namespace scree::test
