// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements and simulations as tables: what is in which cell, and that the operator does to the simulation what was done to the measurement.
#include "scree/inference/observation.hpp"

#include "scree/inference/discrepancy.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scree {
namespace {

double cell(const ObservationTable& table, const Column& column, std::size_t row) {
    const std::size_t k = table.find(column);
    return k < table.columns.size() ? table.values[k][row] : -999.0;
}

/// Eastwards from the origin, two screens, a zone from x = 30 on.
ObservationOperator test_operator() {
    ObservationOperator op;
    op.screens = {"upper", "lower"};
    op.screen_of = {0, 1};
    op.zones = {"flat"};
    op.zone_areas.emplace_back(0, Region({Polygon{{{30, -50}, {100, -50}, {100, 50}, {30, 50}}, {}}}));
    return op;
}

/// Two known blocks: the first passed the upper screen and rests at (40, 3), the second stopped at (10, -2) before it.
Observations test_observations() {
    Observations o;
    o.blocks = {{"a", 100.0, {1, 1, 1}, {kNaN, kNaN}}, {"b", 200.0, {1, 1, 1}, {kNaN, kNaN}}};
    o.stops = {{1, 0, {40, 3, kNaN}, 0.0, false, false}, {2, 1, {10, -2, kNaN}, 0.0, false, false}};
    ObservedCrossing crossing;
    crossing.block = 0;
    crossing.value = {7.5, 0.4, kNaN, kNaN, kNaN};
    o.crossings = {crossing};
    o.thrown = 2;
    o.matched = true;
    return o;
}

BlockResult at_rest(const Vec2& stop) {
    BlockResult b;
    b.done = true;
    b.reason = StopReason::AtRest;
    b.stop = {stop.x(), stop.y(), 0.0};
    return b;
}

ScreenCrossing crossing_of(std::int64_t block, std::int32_t screen, double time, double speed) {
    ScreenCrossing c;
    c.block = block;
    c.screen = screen;
    c.time = time;
    c.velocity = {speed, 0, 0};
    c.measured_speed = speed;
    c.height = 0.5;
    return c;
}

TEST(MeasuredTable, OfKnownBlocksHasOneRowEach) {
    const ObservationTable t = measured_table(test_observations(), test_operator());
    ASSERT_EQ(t.rows(), 2U);
    EXPECT_EQ(t.block, (std::vector<std::int32_t>{0, 1}));
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Along, -1}, 0), 40.0);
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Lateral, -1}, 0), 3.0);
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Runout, -1}, 0), std::hypot(40.0, 3.0));
    EXPECT_EQ(cell(t, {Quantity::InZone, 0}, 0), 1.0);
    EXPECT_EQ(cell(t, {Quantity::InZone, 0}, 1), 0.0);
    EXPECT_EQ(cell(t, {Quantity::Speed, 0}, 0), 7.5);
    EXPECT_EQ(cell(t, {Quantity::Passed, 0}, 0), 1.0);
    EXPECT_EQ(cell(t, {Quantity::Passed, 0}, 1), 0.0) << "known, and not seen at a screen that saw others";
    EXPECT_TRUE(std::isnan(cell(t, {Quantity::Speed, 0}, 1)));
    EXPECT_EQ(cell(t, {Quantity::Spin, 0}, 0), -999.0) << "nobody measured spin: there is no column";
    EXPECT_EQ(cell(t, {Quantity::Passed, 1}, 0), -999.0) << "nobody measured at the lower screen";
}

// Of an impact nobody knows that it did not happen: a film may have missed it. So there is no share that passes, and what a camera misses at a screen says nothing.
TEST(Impacts, AreScreensThatNobodyFailsToPass) {
    ObservationOperator op = test_operator();
    op.add_impacts(2);
    ASSERT_EQ(op.screens.size(), 6U);
    EXPECT_EQ(op.screens[2], "the start of impact 1");
    EXPECT_EQ(op.screens[5], "the end of impact 2");
    EXPECT_FALSE(op.is_impact(1));
    EXPECT_TRUE(op.is_impact(2));
    op.least_speed = 5.0;
    Observations o = test_observations();
    for (const std::int32_t screen : {2, 3}) {
        ObservedCrossing c;
        c.block = 1;
        c.screen = screen;
        c.value = {screen == 2 ? 9.0 : 4.0, kNaN, kNaN, kNaN, screen == 2 ? -7.0 : 1.0};
        o.crossings.push_back(c);
    }
    const ObservationTable measured = measured_table(o, op);
    EXPECT_EQ(cell(measured, {Quantity::Passed, 2}, 0), -999.0);
    EXPECT_TRUE(std::isnan(cell(measured, {Quantity::Speed, 2}, 0))) << "of this block no impact was filmed";
    EXPECT_EQ(cell(measured, {Quantity::Rise, 2}, 1), -7.0);
    EXPECT_EQ(cell(measured, {Quantity::Speed, 3}, 1), 4.0);
    EXPECT_EQ(cell(measured, {Quantity::Speed, 4}, 1), -999.0) << "nobody filmed a second one";

    CampaignResult campaign;
    campaign.blocks = {at_rest({40, 3}), at_rest({10, -2})};
    campaign.crossings = {crossing_of(0, 0, 1.0, 4.0)};
    FilmedImpact impact;
    impact.block = 1;
    impact.before.velocity = {6.0, 0.0, -8.0};
    impact.after.velocity = {4.5, 0.0, 0.0};
    campaign.impacts = {impact};
    impact.number = 5;  // nobody measured so many
    campaign.impacts.push_back(impact);
    const ObservationTable simulated = simulated_table(campaign, o, op, 1);
    EXPECT_EQ(simulated.columns, measured.columns);
    EXPECT_EQ(cell(simulated, {Quantity::Passed, 0}, 0), 0.0) << "too slow for the camera at the screen";
    EXPECT_EQ(cell(simulated, {Quantity::Speed, 3}, 1), 4.5) << "and not for the film of an impact";
    EXPECT_EQ(cell(simulated, {Quantity::Speed, 2}, 1), 10.0);
    EXPECT_EQ(cell(simulated, {Quantity::Rise, 2}, 1), -8.0);
    EXPECT_TRUE(std::isnan(cell(simulated, {Quantity::Rise, 2}, 0)));
}

TEST(MeasuredTable, OfAPoolHasOneRowPerRecord) {
    Observations o = test_observations();
    o.matched = false;
    const ObservationTable t = measured_table(o, test_operator());
    ASSERT_EQ(t.rows(), 3U);
    EXPECT_EQ(t.block, (std::vector<std::int32_t>{-1, -1, -1}));
    EXPECT_TRUE(std::isnan(cell(t, {Quantity::Speed, 0}, 0)));
    EXPECT_EQ(cell(t, {Quantity::Speed, 0}, 2), 7.5);
    EXPECT_TRUE(std::isnan(cell(t, {Quantity::Along, -1}, 2)));
}

TEST(SideBySide, APoolHasAsManyRowsAsBlocksWereThrown) {
    Observations o = test_observations();
    o.matched = false;
    o.thrown = 3;
    const ObservationTable t = side_by_side(measured_table(o, test_operator()), o.thrown);
    ASSERT_EQ(t.rows(), 3U);
    EXPECT_EQ(t.block, (std::vector<std::int32_t>{-1, -1, -1}));
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Along, -1}, 0), 40.0);
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Along, -1}, 1), 10.0);
    EXPECT_TRUE(std::isnan(cell(t, {Quantity::Along, -1}, 2))) << "thrown, not found";
    EXPECT_TRUE(std::isnan(cell(t, {Quantity::InZone, 0}, 2)));
    EXPECT_EQ(cell(t, {Quantity::Speed, 0}, 0), 7.5);
    EXPECT_EQ(cell(t, {Quantity::Passed, 0}, 0), 1.0);
    EXPECT_EQ(cell(t, {Quantity::Passed, 0}, 1), 0.0) << "one of three passed";
    EXPECT_EQ(cell(t, {Quantity::Passed, 0}, 2), 0.0);
}

TEST(SideBySide, WhoPassedIsUnknownIfNobodyKnowsHowManyWereThrown) {
    Observations o = test_observations();
    o.matched = false;
    const ObservationTable t = side_by_side(measured_table(o, test_operator()), 0);
    ASSERT_EQ(t.rows(), 2U);
    EXPECT_EQ(cell(t, {Quantity::Speed, 0}, 0), 7.5);
    for (const std::size_t row : {0U, 1U}) EXPECT_TRUE(std::isnan(cell(t, {Quantity::Passed, 0}, row)));
}

TEST(MeasuredTable, AWatchedScreenWithoutRecordsIsOneThatNobodyPassed) {
    ObservationOperator op = test_operator();
    EXPECT_EQ(measured_table(test_observations(), op).find({Quantity::Passed, 1}),
              measured_table(test_observations(), op).columns.size())
        << "nothing is known of the lower screen";
    op.watched = {0, 1};
    const ObservationTable t = measured_table(test_observations(), op);
    EXPECT_EQ(cell(t, {Quantity::Passed, 0}, 0), 1.0);
    EXPECT_EQ(cell(t, {Quantity::Passed, 0}, 1), 0.0);
    EXPECT_EQ(cell(t, {Quantity::Passed, 1}, 0), 0.0);
    EXPECT_EQ(cell(t, {Quantity::Passed, 1}, 1), 0.0);

    Observations pool = test_observations();
    pool.matched = false;
    pool.thrown = 3;
    const ObservationTable rows = side_by_side(pool, op);
    ASSERT_EQ(rows.rows(), 3U);
    for (const std::size_t row : {0U, 1U, 2U}) EXPECT_EQ(cell(rows, {Quantity::Passed, 1}, row), 0.0);
    pool.thrown = 0;
    EXPECT_TRUE(std::isnan(cell(side_by_side(pool, op), {Quantity::Passed, 1}, 0))) << "of how many?";
}

TEST(Observables, AWatchedScreenWithoutRecordsTellsOfPassing) {
    ObservationOperator op = test_operator();
    const auto of_lower = [&](const Observations& o) {
        std::vector<Observable> found;
        for (Observable& one : make_observables(o, op))
            if (one.name.find("lower") != std::string::npos) found.push_back(std::move(one));
        return found;
    };
    EXPECT_TRUE(of_lower(test_observations()).empty());
    op.watched = {1};
    const std::vector<Observable> known = of_lower(test_observations());
    ASSERT_EQ(known.size(), 1U);
    EXPECT_EQ(known[0].name, "passing lower");
    EXPECT_TRUE(known[0].matched && known[0].overall && known[0].counts.empty());

    Observations pool = test_observations();
    pool.matched = false;
    const std::vector<Observable> counted = of_lower(pool);
    ASSERT_EQ(counted.size(), 1U);
    ASSERT_EQ(counted[0].counts.size(), 1U);
    EXPECT_EQ(counted[0].counts[0].count, 0);
    EXPECT_EQ(counted[0].counts[0].thrown, 2);
    pool.thrown = 0;
    EXPECT_TRUE(of_lower(pool).empty());
}

TEST(SideBySide, SharesOfZonesAreToldToTheFirstRows) {
    Observations o = test_observations();
    o.stops.clear();
    o.shares = {{1, 0, 2, 5}};
    const ObservationTable t = side_by_side(o, test_operator());
    ASSERT_EQ(t.rows(), 5U) << "two of the five blocks are known";
    EXPECT_EQ(t.block, (std::vector<std::int32_t>{0, 1, -1, -1, -1}));
    double sum = 0.0;
    for (std::size_t row = 0; row < 5; ++row) sum += cell(t, {Quantity::InZone, 0}, row);
    EXPECT_EQ(sum, 2.0);
    EXPECT_TRUE(std::isnan(cell(t, {Quantity::Passed, 0}, 2)));
    o.crossings.clear();
    o.blocks.clear();
    o.matched = false;
    EXPECT_EQ(side_by_side(o, test_operator()).rows(), 5U) << "nothing but shares";
}

TEST(SideBySide, RowsOfKnownBlocksStayAsTheyAre) {
    const ObservationTable measured = measured_table(test_observations(), test_operator()),
                           t = side_by_side(measured, 2);
    ASSERT_EQ(t.rows(), measured.rows());
    EXPECT_EQ(t.block, measured.block);
    for (std::size_t k = 0; k < t.values.size(); ++k)
        for (std::size_t row = 0; row < t.rows(); ++row)
            if (std::isfinite(measured.values[k][row])) {
                EXPECT_EQ(t.values[k][row], measured.values[k][row]);
            } else {
                EXPECT_TRUE(std::isnan(t.values[k][row]));
            }
}

TEST(SimulatedTable, SeesWhatTheTestWouldHaveSeen) {
    CampaignResult campaign;
    campaign.blocks = {at_rest({50, 1}), at_rest({12, 0}), at_rest({35, -4}), at_rest({36, 0})};
    campaign.blocks[1].reason = StopReason::Failed;
    campaign.blocks[3].reason = StopReason::LeftTerrain;
    campaign.crossings = {crossing_of(0, 0, 2.0, 6.0), crossing_of(2, 0, 3.0, 0.3), crossing_of(2, 1, 4.0, 5.0)};
    ObservationOperator op = test_operator();
    op.least_speed = 0.5;
    op.runout_limit = 45.0;
    const ObservationTable t = simulated_table(campaign, test_observations(), op, 1);
    ASSERT_EQ(t.rows(), 3U) << "the failed block is no observation";
    EXPECT_EQ(t.block, (std::vector<std::int32_t>{0, 0, 1})) << "block k of the campaign is block k mod 2 of the test";
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Along, -1}, 0), 45.0) << "the survey ended there";
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Lateral, -1}, 0), 1.0);
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Runout, -1}, 0), std::hypot(45.0, 1.0));
    EXPECT_EQ(cell(t, {Quantity::Speed, 0}, 0), 6.0);
    EXPECT_EQ(cell(t, {Quantity::Passed, 0}, 1), 0.0) << "too slow for the camera";
    EXPECT_TRUE(std::isnan(cell(t, {Quantity::Speed, 0}, 1)));
    EXPECT_EQ(cell(t, {Quantity::InZone, 0}, 1), 1.0);
    EXPECT_EQ(cell(t, {Quantity::InZone, 0}, 2), 0.0) << "it left the terrain: at rest in no zone";
    EXPECT_DOUBLE_EQ(cell(t, {Quantity::Along, -1}, 2), 36.0) << "and counts where it was last seen";
}

TEST(SimulatedTable, MeasuresWrongAsEffectsSay) {
    CampaignResult campaign;
    campaign.blocks = {at_rest({50, 1}), at_rest({12, 0})};
    campaign.crossings = {crossing_of(0, 0, 2.0, 6.0), crossing_of(1, 0, 3.0, 1.5)};
    const auto seen = [&](EffectKind kind, const char* key, double value) {
        Effect effect = make_effect(kind);
        if (kind == EffectKind::SpeedError) effect.set("bias", 0.0);
        effect.set(key, value);
        ObservationOperator op = test_operator();
        op.effects = {effect};
        return simulated_table(campaign, test_observations(), op, 1);
    };
    const Column speed{Quantity::Speed, 0}, height{Quantity::Height, 0};
    EXPECT_DOUBLE_EQ(cell(seen(EffectKind::SpeedError, "bias", 0.2), speed, 0), 7.2);
    EXPECT_DOUBLE_EQ(cell(seen(EffectKind::HeightDatum, "offset", 0.3), height, 0), 0.8);
    const ObservationTable slow = seen(EffectKind::SlowMissed, "least_speed", 2.0);
    EXPECT_EQ(cell(slow, speed, 0), 6.0);
    EXPECT_EQ(cell(slow, {Quantity::Passed, 0}, 1), 0.0);
    EXPECT_EQ(cell(seen(EffectKind::GroundDrag, "coefficient", 1.0), speed, 0), 6.0) << "no effect of measurements";
}

TEST(SimulatedTable, RecordsAShareOfTheBrokenBlocksWhereTheyBroke) {
    CampaignResult campaign;
    for (int k = 0; k < 2000; ++k) campaign.blocks.push_back(at_rest({40, 0}));
    for (int k = 0; k < 1000; ++k) campaign.blocks[static_cast<std::size_t>(k)].broke_at = Vec3(15, 0, 5);
    const auto recorded_there = [&](double share) {
        Effect effect = make_effect(EffectKind::BrokenBlock);
        effect.set("last_impact", share);
        ObservationOperator op = test_operator();
        op.effects = {effect};
        const ObservationTable t = simulated_table(campaign, test_observations(), op, 1);
        int there = 0;
        for (std::size_t row = 0; row < t.rows(); ++row) {
            const double along = cell(t, {Quantity::Along, -1}, row);
            EXPECT_TRUE(row < 1000 || along == 40.0) << "it did not break";
            there += along == 15.0;
        }
        return there;
    };
    EXPECT_EQ(recorded_there(0.0), 0);
    EXPECT_EQ(recorded_there(1.0), 1000);

    // found where it broke, it lies there, whatever its largest piece did
    Effect effect = make_effect(EffectKind::BrokenBlock);
    effect.set("last_impact", 1.0);
    ObservationOperator op = test_operator();
    op.effects = {effect};
    campaign.blocks[0].broke_at = Vec3(35, 0, 5);
    campaign.blocks[0].reason = StopReason::LeftTerrain;
    EXPECT_EQ(cell(simulated_table(campaign, test_observations(), op, 1), {Quantity::InZone, 0}, 0), 1.0);
    EXPECT_NEAR(recorded_there(0.3), 300, 4.0 * std::sqrt(1000 * 0.3 * 0.7));
}

// The numbers drawn for a fault are its own: all others of the same blocks stay as they were.
TEST(SimulatedTable, AFaultMovesNoOtherNumbers) {
    CampaignResult campaign;
    for (int k = 0; k < 20; ++k) {
        campaign.blocks.push_back(at_rest({40, 0}));
        campaign.crossings.push_back(crossing_of(k, 0, 2.0, 20.0));
        campaign.crossings.push_back(crossing_of(k, 1, 3.0, 20.0));
    }
    Observations observations = test_observations();
    for (ObservedCrossing& c : observations.crossings) c.error.fill(0.1);
    observations.crossings.push_back(observations.crossings.front());
    observations.crossings.back().screen = 1;
    ObservationOperator op = test_operator();
    const ObservationTable plain = simulated_table(campaign, observations, op, 7);
    Effect noise = make_effect(EffectKind::SpeedError);
    noise.set("bias", 0.0);
    noise.set("noise", 0.0);
    op.effects = {noise};
    EXPECT_EQ(plain.values, simulated_table(campaign, observations, op, 7).values);
    op.effects[0].set("noise", 2.0);
    const ObservationTable noisy = simulated_table(campaign, observations, op, 7);
    for (std::size_t row = 0; row < noisy.rows(); ++row) {
        EXPECT_NE(cell(noisy, {Quantity::Speed, 0}, row), cell(plain, {Quantity::Speed, 0}, row));
        EXPECT_EQ(cell(noisy, {Quantity::Height, 1}, row), cell(plain, {Quantity::Height, 1}, row));
    }
}

TEST(SimulatedTable, SpreadsSpeedsByTheNoiseAndMixesNumbers) {
    CampaignResult campaign;
    for (int k = 0; k < 4000; ++k) {
        campaign.blocks.push_back(at_rest({40, 0}));
        campaign.crossings.push_back(crossing_of(k, 0, 2.0, 20.0));
    }
    Effect noise = make_effect(EffectKind::SpeedError), mixed = make_effect(EffectKind::IdsShuffled);
    noise.set("bias", 0.0);
    noise.set("noise", 2.0);
    ObservationOperator op = test_operator();
    op.effects = {noise, mixed};
    const ObservationTable t = simulated_table(campaign, test_observations(), op, 7);
    double sum = 0.0, squares = 0.0;
    int other = 0;
    for (std::size_t row = 0; row < t.rows(); ++row) {
        const double v = cell(t, {Quantity::Speed, 0}, row);
        sum += v;
        squares += v * v;
        other += t.block[row] != static_cast<std::int32_t>(row % 2);
    }
    const double n = static_cast<double>(t.rows()), mean = sum / n;
    EXPECT_NEAR(mean, 20.0, 4.0 * 2.0 / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(squares / n - mean * mean), 2.0, 4.0 * 2.0 / std::sqrt(2.0 * n));
    EXPECT_NEAR(other / n, 0.5, 4.0 * 0.5 / std::sqrt(0.5 * n)) << "of two numbers an even permutation swaps half";

    op.effects[1].set("share", 0.3);
    const ObservationTable some = simulated_table(campaign, test_observations(), op, 7);
    std::int64_t swapped = 0;
    for (std::size_t row = 0; row < some.rows(); ++row)
        swapped += some.block[row] != static_cast<std::int32_t>(row % 2);
    // both of two numbers must be among the mixed ones, and then half of the permutations swap them
    EXPECT_NEAR(static_cast<double>(swapped) / n, 0.5 * 0.09, 4.0 * std::sqrt(0.045 / (0.5 * n)));
}

TEST(ShiftScreens, MovesThemAlongTheAxisAndTheProfiles) {
    CampaignInput campaign;
    campaign.screens = {{"upper", {{10, -5}, {10, 5}}}, {"by its chainage", {}}};
    ProfileTrack track;
    track.profile = make_profile(std::vector<Vec3>{{0, 0, 10}, {20, 0, 0}}, std::vector<SoilId>{0});
    track.marks = {{0, 10.0}, {0, 19.0}, {1, 5.0}};
    campaign.tracks.push_back(track);
    Effect shift = make_effect(EffectKind::ScreenShift);
    shift.set("shift", 3.0);
    shift_screens(std::vector<Effect>{shift}, Axis(), campaign);
    EXPECT_EQ(campaign.screens[0].line, (std::vector<Vec2>{{13, -5}, {13, 5}}));
    ASSERT_EQ(campaign.tracks[0].marks.size(), 2U) << "the other one would stand beyond the end";
    EXPECT_EQ(campaign.tracks[0].marks[0].s, 13.0);
    EXPECT_EQ(campaign.tracks[0].marks[1].s, 8.0);

    shift.set("shift", -2.0);
    shift.place.screen = "by its chainage";
    shift_screens(std::vector<Effect>{shift}, Axis(), campaign);
    EXPECT_EQ(campaign.screens[0].line, (std::vector<Vec2>{{13, -5}, {13, 5}})) << "only the one that is named";
    EXPECT_EQ(campaign.tracks[0].marks[0].s, 13.0);
    EXPECT_EQ(campaign.tracks[0].marks[1].s, 6.0);
}

TEST(ObservationTables, KeepOnlyTheWayAlongForAModelOfOneProfile) {
    // an axis with a bend: the first stop of the test lies at (40, 3), on it at (40, 0)
    Observations o = test_observations();
    ObservationOperator op = test_operator();
    op.axis = Axis({{0, 0}, {50, 0}, {50, 50}});
    op.lateral = false;
    CampaignResult campaign;
    campaign.blocks = {at_rest({50, 20}), at_rest({12, 0})};
    const ObservationTable measured = measured_table(o, op), simulated = simulated_table(campaign, o, op, 1);
    EXPECT_EQ(cell(measured, {Quantity::Lateral, -1}, 0), -999.0) << "no such column";
    EXPECT_DOUBLE_EQ(cell(measured, {Quantity::Along, -1}, 0), 40.0);
    EXPECT_DOUBLE_EQ(cell(measured, {Quantity::Runout, -1}, 0), 40.0) << "moved onto the axis first";
    EXPECT_DOUBLE_EQ(cell(simulated, {Quantity::Along, -1}, 0), 70.0);
    EXPECT_DOUBLE_EQ(cell(simulated, {Quantity::Runout, -1}, 0), std::hypot(50.0, 20.0));
    EXPECT_EQ(cell(simulated, {Quantity::InZone, 0}, 0), 1.0) << "zones are areas of the map all the same";
}

TEST(SimulatedTable, TakesTheFirstPartOfAScreenThatABlockMeets) {
    CampaignResult campaign;
    campaign.blocks = {at_rest({50, 0}), at_rest({50, 0})};
    campaign.crossings = {crossing_of(0, 0, 5.0, 6.0), crossing_of(0, 1, 2.0, 9.0)};
    ObservationOperator op = test_operator();
    op.screens = {"both"};
    op.screen_of = {0, 0};
    const ObservationTable t = simulated_table(campaign, test_observations(), op, 1);
    EXPECT_EQ(cell(t, {Quantity::Speed, 0}, 0), 9.0);
}

TEST(SimulatedTable, AddsTheStatedErrorsAndNothingElse) {
    // errors of 2 m, 0.7 m/s and, of heights of 0.5 m, 1 m on 4000 blocks: means and deviations within 5 standard errors
    constexpr std::size_t n = 4000;
    CampaignResult campaign;
    for (std::size_t k = 0; k < n; ++k) {
        campaign.blocks.push_back(at_rest({60, 0}));
        campaign.crossings.push_back(crossing_of(static_cast<std::int64_t>(k), 0, 1.0, 10.0));
    }
    for (const bool matched : {true, false}) {
        Observations o = test_observations();
        o.matched = matched;
        for (ObservedStop& s : o.stops) s.error = 2.0;
        o.crossings[0].error = {0.7, 1.0, 0.0, 0.0, 0.0};
        const ObservationTable t = simulated_table(campaign, o, test_operator(), 3);
        const auto deviation = [&](const Column& column, double centre) {
            double sum = 0.0, squares = 0.0;
            for (std::size_t k = 0; k < n; ++k) sum += cell(t, column, k) - centre;
            for (std::size_t k = 0; k < n; ++k) squares += std::pow(cell(t, column, k) - centre, 2.0);
            EXPECT_NEAR(sum / n, 0.0, 5.0 * std::sqrt(squares / n / n));
            return std::sqrt(squares / n);
        };
        EXPECT_NEAR(deviation({Quantity::Along, -1}, 60.0), 2.0, 5.0 * 2.0 / std::sqrt(2.0 * n));
        EXPECT_NEAR(deviation({Quantity::Lateral, -1}, 0.0), 2.0, 5.0 * 2.0 / std::sqrt(2.0 * n));
        EXPECT_NEAR(deviation({Quantity::Speed, 0}, 10.0), 0.7, 5.0 * 0.7 / std::sqrt(2.0 * n));
        EXPECT_NEAR(deviation({Quantity::Height, 0}, 0.5), 1.0, 5.0 / std::sqrt(2.0 * n)) << "below the ground, too";
        o.crossings[0].value[1] = kNaN;
        o.crossings[0].error = {};
        const ObservationTable exact = simulated_table(campaign, o, test_operator(), 3);
        for (std::size_t k = 0; k < n; ++k) EXPECT_EQ(cell(exact, {Quantity::Speed, 0}, k), 10.0) << "no error stated";
    }
}

TEST(SimulatedTable, MixesDifferentErrorsOfAPool) {
    // half of the stops known to 4 m, half exactly: the variance is that of the mixture, 8 m^2
    constexpr std::size_t n = 6000;
    CampaignResult campaign;
    for (std::size_t k = 0; k < n; ++k) campaign.blocks.push_back(at_rest({60, 0}));
    Observations o = test_observations();
    o.matched = false;
    o.stops[0].error = 4.0;
    const ObservationTable t = simulated_table(campaign, o, test_operator(), 3);
    double squares = 0.0;
    std::size_t exact = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const double d = cell(t, {Quantity::Along, -1}, k) - 60.0;
        squares += d * d;
        exact += d == 0.0;
    }
    EXPECT_NEAR(squares / n, 8.0, 0.8);
    EXPECT_NEAR(static_cast<double>(exact) / n, 0.5, 0.04);
}

TEST(SimulatedTable, ErrorsOfABlockDependOnNothingElse) {
    CampaignResult few, many;
    for (int k = 0; k < 10; ++k) many.blocks.push_back(at_rest({60.0 + k, 0}));
    few.blocks.assign(many.blocks.begin(), many.blocks.begin() + 4);
    Observations o = test_observations();
    o.stops[0].error = o.stops[1].error = 1.0;
    const ObservationTable a = simulated_table(few, o, test_operator(), 3),
                           b = simulated_table(many, o, test_operator(), 3);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(cell(a, {Quantity::Along, -1}, k), cell(b, {Quantity::Along, -1}, k));
    EXPECT_NE(cell(a, {Quantity::Along, -1}, 0),
              cell(simulated_table(few, o, test_operator(), 4), {Quantity::Along, -1}, 0));
}

TEST(Observables, AreWhatWasMeasured) {
    Observations o = test_observations();
    const auto names = [&] {
        std::string text;
        for (const Observable& observable : make_observables(o, test_operator()))
            text += observable.name + (observable.overall ? "*" : "") + (observable.matched ? "" : "~") + "; ";
        return text;
    };
    EXPECT_EQ(names(),
              "stop position*; runout; distance along; lateral; deposit zones; passing upper; speed at upper*; height "
              "at upper*; ");
    o.matched = false;
    EXPECT_EQ(names(),
              "stop position*~; runout~; distance along~; lateral~; deposit zones~; passing upper*~; speed at upper*~; "
              "height at upper*~; ");
    o.thrown = 0;
    EXPECT_EQ(
        names(),
        "stop position*~; runout~; distance along~; lateral~; deposit zones~; speed at upper*~; height at upper*~; ");
    o.stops.clear();
    o.crossings.clear();
    o.shares = {{1, 0, 20, 50}};
    EXPECT_EQ(names(), "deposit zones*~; ");
}

// Whoever lacks a value has passed: with zeros for those that did not, too many of these would be left.
TEST(Observables, WhereManyThatPassedWereNotMeasuredAreOfThoseThatPassed) {
    const auto names = [](std::int32_t blocks, std::int32_t passed, std::int32_t missing) {
        Observations o = test_observations();
        o.stops.clear();
        o.blocks.resize(static_cast<std::size_t>(blocks));
        o.crossings.assign(static_cast<std::size_t>(passed), {});
        for (std::int32_t k = 0; k < passed; ++k) {
            o.crossings[static_cast<std::size_t>(k)].block = k;
            if (k >= missing) o.crossings[static_cast<std::size_t>(k)].value[0] = 5.0;
        }
        std::string text;
        for (const Observable& observable : make_observables(o, test_operator()))
            text += observable.name + (observable.overall ? "*" : "") + (observable.matched ? "" : "~") + "; ";
        return text;
    };
    EXPECT_EQ(names(50, 40, 0), "passing upper; speed at upper*; ");
    EXPECT_EQ(names(50, 40, 3), "passing upper; speed at upper*; ") << "three more or less are no news of fifty";
    EXPECT_EQ(names(50, 40, 4), "passing upper*; speed at upper*~; ");
    EXPECT_EQ(names(50, 40, 20), "passing upper*; speed at upper*~; ");
    EXPECT_EQ(names(5000, 4000, 100), "passing upper*; speed at upper*~; ");
    EXPECT_EQ(names(50, 50, 20), "passing upper; speed at upper*; ") << "nobody has no motion";
}

TEST(ObservedBlock, IsKnownByAllItsLengths) {
    for (std::size_t k = 0; k < 3; ++k) {
        ObservedBlock block{"a", 100.0, {1.2, 0.9, 0.6}, {kNaN, kNaN}};
        EXPECT_TRUE(block.has_body());
        block.size[static_cast<Eigen::Index>(k)] = kNaN;
        EXPECT_FALSE(block.has_body()) << k;
    }
}

TEST(Observables, OfAModelOfOneProfileHaveNothingBeside) {
    ObservationOperator op = test_operator();
    op.lateral = false;
    std::string names;
    for (const Observable& observable : make_observables(test_observations(), op))
        names += observable.name + (observable.overall ? "*" : "") + "; ";
    EXPECT_EQ(names, "runout; distance along*; deposit zones; passing upper; speed at upper*; height at upper*; ");
}

TEST(Observables, OfAKnownBlockThatDidNotPassIsNoMotion) {
    // block b never reaches the screen: speed 0 counts as measured; of a pool it would be missing
    const Observations o = test_observations();
    const ObservationOperator op = test_operator();
    CampaignResult campaign;
    for (int k = 0; k < 8; ++k) {
        campaign.blocks.push_back(at_rest({40, 0}));
        if (k % 2 == 0) campaign.crossings.push_back(crossing_of(k, 0, 1.0, 7.0 + k));
    }
    const ObservationTable measured = measured_table(o, op), simulated = simulated_table(campaign, o, op, 1);
    for (const Observable& observable : make_observables(o, op)) {
        if (observable.name != "speed at upper") continue;
        const ObservableSample sample = observable_sample(measured, simulated, observable);
        EXPECT_EQ(sample.measured.values, (std::vector<double>{7.5, 0.0}));
        ASSERT_EQ(sample.strata.size(), 2U);
        EXPECT_EQ(sample.simulated.size(), 8U);
        for (const std::uint32_t m : sample.strata[1]) EXPECT_EQ(sample.simulated.values[m], 0.0);
    }
}

}  // namespace
}  // namespace scree
