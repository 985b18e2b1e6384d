// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/residual_space.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace scree::test
