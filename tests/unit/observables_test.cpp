// SPDX-License-Identifier: GPL-3.0-or-later
// From tables to the values of an observable, where not every repeat of a block has one: a film of an impact, say.
#include "inference/gap_statistic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scree {
namespace {

using testing::ElementsAre;

constexpr Column kStart{Quantity::Speed, 0}, kEnd{Quantity::Speed, 1};

/// Blocks with the speeds at the start and at the end of an impact.
struct Row {
    std::int32_t block;
    double start, end;
};
ObservationTable table(const std::vector<Row>& rows) {
    ObservationTable t{{kStart, kEnd}, {{}, {}}, {}};
    for (const Row& r : rows) {
        t.block.push_back(r.block);
        t.values[0].push_back(r.start);
        t.values[1].push_back(r.end);
    }
    return t;
}

/// Four repeats of two blocks; of the second one two have had the impact.
const ObservationTable kSimulated =
    table({{0, 4, 1}, {1, kNaN, kNaN}, {0, 5, 2}, {1, 9, 6}, {0, 6, 3}, {1, kNaN, kNaN}, {0, 7, kNaN}, {1, 8, 7}});
const ObservationTable kMeasured = table({{0, 5.5, 2.5}, {1, 8.5, 6.5}});

TEST(ObservableSample, LeavesOutBlocksOfWhichFewRepeatsHaveIt) {
    const Observable speed{"speed", "m/s", {kStart}, false, true, false, {}};
    const ObservableSample sample = observable_sample(kMeasured, kSimulated, speed);
    ASSERT_EQ(sample.strata.size(), 1U);
    EXPECT_THAT(sample.block_of_stratum, ElementsAre(0));
    EXPECT_THAT(sample.measured.values, ElementsAre(5.5));
    EXPECT_THAT(sample.simulated.values, ElementsAre(4, 5, 6, 7));
    EXPECT_THAT(sample.member_of_row, ElementsAre(0, -1, 1, -1, 2, -1, 3, -1));
}

TEST(ScoreInput, TakesRepeatsThatHaveAllThatWasMeasured) {
    const std::vector<Column> columns{kStart, kEnd};
    const std::vector<double> scales{1.0, 2.0};
    const ScoreInput input = score_input(kMeasured, kSimulated, columns, scales);
    ASSERT_EQ(input.blocks.size(), 1U) << "two repeats are too few";
    EXPECT_THAT(input.blocks[0].observation, ElementsAre(5.5, 1.25));
    EXPECT_THAT(input.blocks[0].repeats.values, ElementsAre(4, 0.5, 5, 1, 6, 1.5));
}

}  // namespace
}  // namespace scree
