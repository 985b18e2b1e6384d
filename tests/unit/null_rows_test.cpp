// SPDX-License-Identifier: GPL-3.0-or-later
// What chance would measure: simulated rows of the same blocks, of which as little is known.
#include "scree/inference/score_test.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace scree::test {
namespace {

constexpr Column kAlong{Quantity::Along, -1}, kSpin{Quantity::Spin, 0};

TEST(NullRows, AreOfTheSameBlocksAndHideWhatWasNotMeasured) {
    constexpr int kRepeats = 40;
    const std::vector<Residual> residuals{{ResidualKind::Level, kAlong, {}, kNaN, kNaN},
                                          {ResidualKind::Level, kSpin, {}, kNaN, kNaN},
                                          {ResidualKind::Together, kAlong, kSpin, kNaN, kNaN}};
    ResidualRows own(2 * kRepeats, 3);
    std::vector<std::int32_t> block;
    for (int k = 0; k < 2 * kRepeats; ++k) {
        block.push_back(k % 2);
        own.row(k).setConstant(k % 2 == 0 ? 1.0 : -1.0);
    }
    // of the first block the spin is known, of the second one it is not, and nobody knows who the third one was
    const ObservationTable measured{{kAlong, kSpin}, {{50.0, 60.0, 70.0}, {3.0, kNaN, 4.0}}, {0, 1, -1}};
    const NullRows null(own, block, residuals, measured);
    bool one = false, other = false;
    for (std::uint64_t draw = 0; draw < 50; ++draw) {
        const ResidualRows rows = null.draw(1, draw);
        ASSERT_EQ(rows.rows(), 3);
        for (int k = 0; k < 3; ++k) EXPECT_EQ(rows(0, k), 1.0);
        EXPECT_EQ(rows(1, 0), -1.0);
        EXPECT_TRUE(std::isnan(rows(1, 1)) && std::isnan(rows(1, 2)));
        (rows(2, 0) > 0.0 ? one : other) = true;
    }
    EXPECT_TRUE(one && other);
}

}  // namespace
}  // namespace scree::test
