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

// Crossings alone, and nobody knows how many blocks were thrown: most of these have no record where few pass.
TEST(NullRows, OfCrossingsAloneAsManyAreThrownAsLeaveSoManyRecords) {
    constexpr Column kFirst{Quantity::Speed, 0}, kSecond{Quantity::Speed, 1};
    constexpr int kSimulated = 2000, kDraws = 100;
    const std::vector<Residual> residuals{{ResidualKind::Level, kFirst, {}, kNaN, kNaN},
                                          {ResidualKind::Level, kSecond, {}, kNaN, kNaN}};
    ResidualRows own = ResidualRows::Constant(kSimulated, 2, kNaN);
    own.col(0).head(kSimulated / 5).setConstant(1.0);    // a fifth passes the first screen,
    own.col(1).head(kSimulated / 20).setConstant(-1.0);  // a quarter of these the second
    const std::vector<std::int32_t> block(kSimulated, -1);
    ObservationTable measured{{kFirst, kSecond}, {{}, {}}, std::vector<std::int32_t>(40, -1)};
    for (int k = 0; k < 40; ++k) {
        measured.values[0].push_back(5.0);
        measured.values[1].push_back(k < 10 ? 4.0 : kNaN);  // records of other blocks, side by side
    }
    const NullRows null(own, block, residuals, measured);
    double first = 0.0, second = 0.0;
    for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
        const ResidualRows rows = null.draw(1, draw);
        ASSERT_EQ(rows.rows(), 200);
        first += static_cast<double>(rows.col(0).array().isFinite().count()) / kDraws;
        second += static_cast<double>(rows.col(1).array().isFinite().count()) / kDraws;
    }
    EXPECT_NEAR(first, 40.0, 3.0);
    EXPECT_NEAR(second, 10.0, 1.5);

    measured.columns.push_back({Quantity::Passed, 0});
    measured.values.emplace_back(40, 1.0);
    EXPECT_EQ(NullRows(own, block, residuals, measured).draw(1, 0).rows(), 40) << "so many were thrown";
}

}  // namespace
}  // namespace scree::test
