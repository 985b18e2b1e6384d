// SPDX-License-Identifier: GPL-3.0-or-later
// Every fault that the audit promises to find, planted alone into good measurements; and that the good ones pass.
#include "scree/inference/observation_audit.hpp"

#include "scree/base/random.hpp"
#include "support/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>

namespace scree::test {
namespace {

using testing::HasSubstr;

/// Twelve good blocks on a plane that falls eastwards by one in two, with a hole around (30, 30); starts at x = -30, 2 m above the ground.
struct GoodTest {
    std::unique_ptr<Surface> surface = grid_terrain(
        40.0, 1.0, [](double x, double y) { return std::hypot(x - 30.0, y - 30.0) < 3.0 ? kNaN : -0.5 * x; });
    std::vector<Screen> screens{{"gate", {{0, -40}, {0, 40}}}};
    std::vector<BlockRow> list;
    Observations o;
    ObservationOperator op;
    AuditSite site;

    GoodTest() {
        for (int k = 0; k < 12; ++k) {
            const std::string id = "B" + std::to_string(k);
            const double x = 10.0 + k;
            list.push_back({id, 1000.0, {1.0, 0.9, 0.8}, Vec2::Constant(kNaN)});
            o.blocks.push_back({id, 1000.0, {1.0, 0.9, 0.8}, Vec2::Constant(kNaN)});
            o.stops.push_back({k + 2, k, {x, 0.0, -0.5 * x + 0.4}, 0.1, false, false});
            ObservedCrossing c;
            c.row = k + 2;
            c.block = k;
            c.position = {0.0, 1.0 * k, kNaN};
            c.value = {9.0 + 2 * k % 3, 0.5 + 0.1 * (k % 4 - 1.5), kNaN, kNaN, kNaN};
            c.error = {0.7, 0.1, 0.0, 0.0, 0.0};
            o.crossings.push_back(c);
        }
        o.matched = true;
        o.thrown = 12;
        op.screens = {"gate"};
        op.screen_of = {0};
        op.zones = {"flat"};
        site.surface = surface.get();
        site.screens = screens;
        site.blocks = list;
        site.highest_start = 17.0;  // 17 m of fall to the gate: at most 18.26 m/s
    }
    std::vector<Finding> findings() const { return audit_observations(o, op, site); }
};

TEST(ObservationAudit, FindsNothingInGoodMeasurements) {
    GoodTest test;
    test.o.crossings[5].value[4] = -12.0;  // within its error
    test.o.crossings[5].error[4] = 0.7;
    for (ObservedCrossing& c : test.o.crossings)
        c.value[3] = 600.0 * c.value[0] * c.value[0], c.error[3] = 1e3;  // 50 kJ and what turns
    for (const Finding& f : test.findings()) ADD_FAILURE() << f.sentence;
}

struct Plant {
    const char* name;
    std::function<void(GoodTest&)> spoil;
    const char* check;
    Severity severity;
    const char* says;
};
void PrintTo(const Plant& p, std::ostream* out) {
    *out << p.name;
}

const Plant kPlants[] = {
    {"StopBesideTheTerrain",
     [](GoodTest& t) {
         t.o.stops[3].position = {100, 0, kNaN};
     },
     "stops_off_terrain", Severity::Error, "(B3)"},
    {"StopOverAHole",
     [](GoodTest& t) {
         t.o.stops[4].position = {30, 30, kNaN};
     },
     "stops_off_terrain", Severity::Error, "1 stop lies off"},
    {"StopsWithEastAndNorthExchanged",
     [](GoodTest& t) {
         t.site.frame.easting = 200.0;
         t.site.frame.northing = 600.0;
         for (auto& s : t.o.stops) {
             MapPoint map = t.site.frame.to_map(s.position);
             std::swap(map.easting, map.northing);
             s.position = t.site.frame.to_local(map);
         }
     },
     "stops_off_terrain", Severity::Error, "exchanged they would lie on it: exchange the columns"},
    {"StopAboveAllStarts",
     [](GoodTest& t) {
         t.o.stops[2].position = {-36, 0, kNaN};
         t.o.crossings.erase(t.o.crossings.begin() + 2);
     },
     "stop_above_start", Severity::Warning,
     "1 block stopped higher than where it was let go or the site lets any go (B2)"},
    {"StopAboveItsRelease",
     [](GoodTest& t) {
         t.o.blocks[2].release = {38, 0};
     },
     "stop_above_start", Severity::Warning, "(B2)"},
    {"HeightsOfAnotherDatum",
     [](GoodTest& t) {
         for (auto& s : t.o.stops) s.position.z() += 2.8;
     },
     "height_datum", Severity::Warning, "3.20 m above"},
    {"HeightsBelowTheGround",
     [](GoodTest& t) {
         for (auto& s : t.o.stops) s.position.z() -= 1.5;
     },
     "height_datum", Severity::Warning, "-1.10 m above"},
    {"HeightsScattered",
     [](GoodTest& t) {
         for (std::size_t k = 0; k < 12; ++k) t.o.stops[k].position.z() += k % 2 ? 2.0 : -2.0;
     },
     "height_scatter", Severity::Warning, "scatter by"},
    {"SpeedAboveTheFall", [](GoodTest& t) { t.o.crossings[5].value[0] = 25.0; }, "speed_above_fall", Severity::Error,
     "25.0 m/s at gate, where a fall from the highest start at 17.0 m gives 18.3 m/s"},
    {"SpeedAboveTheFallWithinItsError", [](GoodTest& t) { t.o.crossings[5].value[0] = 19.0; }, "speed_near_fall",
     Severity::Warning, "within the stated error (B5)"},
    {"RiseAboveTheSpeed",
     [](GoodTest& t) {
         t.o.crossings[5].value[4] = -18.0;
         t.o.crossings[5].error[4] = 0.7;
     },
     "rise_above_speed", Severity::Error,
     "1 vertical speed is far above the speed there (B5): the worst is -18.00 m/s at"},
    {"RiseAboveTheSpeedByALittle",
     [](GoodTest& t) {
         t.o.crossings[5].value[4] = -13.0;
         t.o.crossings[5].error[4] = 0.7;
     },
     "rise_above_speed", Severity::Warning, "by more than three stated errors (B5)"},
    {"GramsForKilograms",
     [](GoodTest& t) {
         t.o.blocks[1].mass = 1e6;
         t.list[1].mass = 1e6;
     },
     "density", Severity::Error, "no rock has"},
    {"EnergiesInAnotherUnit",
     [](GoodTest& t) {
         for (ObservedCrossing& c : t.o.crossings) c.value[3] = 600e3 * c.value[0] * c.value[0], c.error[3] = 1e6;
     },
     "energies", Severity::Warning, "1200.00 times m v^2 / 2 in the median of 12 passages"},
    {"EnergiesOfPieces",
     [](GoodTest& t) {
         for (ObservedCrossing& c : t.o.crossings) c.value[3] = 200.0 * c.value[0] * c.value[0], c.error[3] = 1e3;
     },
     "energies", Severity::Warning, "0.40 times"},
    {"TooHeavyForItsBox", [](GoodTest& t) { t.o.blocks[1].mass = t.list[1].mass = 3000.0; }, "density",
     Severity::Warning, "B1 4167"},
    {"TooLightForItsBox", [](GoodTest& t) { t.o.blocks[1].mass = t.list[1].mass = 200.0; }, "density",
     Severity::Warning, "too light"},
    {"BlockStoppedTwice", [](GoodTest& t) { t.o.stops[2].block = 1; }, "duplicate_id", Severity::Error,
     "1 block_id has more than one stop (B1)"},
    {"BlockCrossedTwice",
     [](GoodTest& t) {
         t.o.crossings[2].block = 1;
         t.o.stops[2].position = {4.0, 0.0, -1.6};
     },
     "duplicate_id", Severity::Error, "B1 at gate"},
    {"IdNotInTheList", [](GoodTest& t) { t.o.blocks[7].id = "X9"; }, "id_not_in_list", Severity::Warning, "(X9)"},
    {"MassOtherThanInTheList", [](GoodTest& t) { t.o.blocks[7].mass = 900.0; }, "mass_differs", Severity::Warning,
     "B7 900 for 1000 kg"},
    {"CrossingFarFromItsScreen", [](GoodTest& t) { t.o.crossings[1].position.x() = 12.0; }, "far_from_screen",
     Severity::Warning, "the farthest by 12.0 m"},
    {"StopAboveItsScreen",
     [](GoodTest& t) {
         t.o.stops[6].position = {-6.0, 0, kNaN};
     },
     "stop_above_screen", Severity::Warning, "1 block crossed gate and stopped more than 5 m above it (B6)"},
    {"StopBelowAScreenThatSawNothingOfIt", [](GoodTest& t) { t.o.crossings.erase(t.o.crossings.begin() + 8); },
     "not_seen_at_screen", Severity::Warning, "1 block came past gate without a record there (B8)"},
    {"StopsBelowAWatchedScreenWithoutRecords",
     [](GoodTest& t) {
         t.o.crossings.clear();
         t.op.watched = {0};
     },
     "not_seen_at_screen", Severity::Warning, "came past gate without a record there"},
    {"SeenBelowAndNotAbove",
     [](GoodTest& t) {
         t.screens.push_back({"lower gate", {{8, -40}, {8, 40}}});
         t.site.screens = t.screens;
         t.op.screens = {"gate", "lower gate"};
         t.op.screen_of = {0, 1};
         t.o.stops.clear();
         for (int k = 0; k < 12; ++k) {
             t.o.crossings.push_back(t.o.crossings[static_cast<std::size_t>(k)]);
             t.o.crossings.back().screen = 1;
             t.o.crossings.back().position.x() = 8.0;
         }
         t.o.crossings.erase(t.o.crossings.begin() + 8);
     },
     "not_seen_at_screen", Severity::Warning, "1 block came past gate without a record there (B8)"},
    {"MoreStopsThanBlocks", [](GoodTest& t) { t.o.thrown = 5; }, "thrown", Severity::Error,
     "12 blocks stopped, but only 5 were thrown"},
    {"ShareAboveOne",
     [](GoodTest& t) {
         t.o.shares = {{1, 0, 60, 50}};
     },
     "share", Severity::Error, "flat holds 60 of 50"},
    {"NoPositionError",
     [](GoodTest& t) {
         for (auto& s : t.o.stops) s.error = 0.0;
     },
     "no_error_stated", Severity::Warning, "position_error_m"},
    {"NoSpeedError",
     [](GoodTest& t) {
         for (auto& c : t.o.crossings) c.error[0] = 0.0;
     },
     "no_error_stated", Severity::Warning, "speed_error_ms"},
    {"SpeedErrorBeyondScatter",
     [](GoodTest& t) {
         for (auto& c : t.o.crossings) c.error[0] = 20.0;
     },
     "error_beyond_scatter", Severity::Warning, "of speeds at gate (speed_error_ms):"},
    {"PositionErrorBeyondScatter",
     [](GoodTest& t) {
         for (auto& s : t.o.stops) s.error = 30.0;
     },
     "error_beyond_scatter", Severity::Warning, "of stops (position_error_m):"},
    {"LastSighting", [](GoodTest& t) { t.o.stops[0].censored = true; }, "censored", Severity::Warning, "(B0)"},
    {"BrokenBlock", [](GoodTest& t) { t.o.stops[0].broken = true; }, "broken", Severity::Warning, "1 block broke"},
    {"FewBlocks",
     [](GoodTest& t) {
         t.o.blocks.resize(4);
         t.o.stops.resize(4);
         t.o.crossings.resize(4);
         t.o.thrown = 4;
     },
     "few_blocks", Severity::Warning, "only 4"},
};

class AuditFinds : public testing::TestWithParam<Plant> {};

TEST_P(AuditFinds, ThisAndNothingElse) {
    GoodTest test;
    GetParam().spoil(test);
    const std::vector<Finding> findings = test.findings();
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].check, GetParam().check);
    EXPECT_EQ(findings[0].severity, GetParam().severity);
    EXPECT_THAT(findings[0].sentence, HasSubstr(GetParam().says));
    EXPECT_EQ(findings[0].sentence.find('\n'), std::string::npos);
}
INSTANTIATE_TEST_SUITE_P(Plants, AuditFinds, testing::ValuesIn(kPlants),
                         [](const auto& row) { return std::string(row.param.name); });

// Values that scatter by their errors and nothing else: one test in a thousand lies closer together.
TEST(ObservationAudit, BelievesErrorsThatAreAllTheScatter) {
    constexpr std::uint64_t kTests = 4000;
    std::uint64_t doubted = 0;
    GoodTest test;
    for (std::uint64_t k = 0; k < kTests; ++k) {
        RandomStream random(k, 0, RandomPurpose::Effect);
        for (ObservedCrossing& c : test.o.crossings) c.value[0] = 10.0 + c.error[0] * random.normal();
        for (const Finding& f : test.findings()) doubted += f.check == "error_beyond_scatter";
    }
    EXPECT_GE(doubted, 1U);
    EXPECT_LE(doubted, 11U);  // 4 +- 2
}

TEST(ObservationAudit, NamesOffendersWithoutIdsByTheirRowAndKeepsListsShort) {
    GoodTest test;
    test.o.matched = false;
    for (ObservedStop& s : test.o.stops) {
        s.block = -1;
        s.position = {90, 0, kNaN};
    }
    ASSERT_FALSE(test.findings().empty());
    EXPECT_THAT(test.findings()[0].sentence,
                HasSubstr("12 stops lie off the DTM or over a hole in it (row 2, row 3, row 4, row 5 and 8 more)"));
}

TEST(ObservationAudit, AListThatKnowsNoneOfTheIdsIsAnotherPopulation) {
    GoodTest test;
    for (std::size_t k = 0; k < 12; ++k) test.o.blocks[k].id = std::to_string(k);
    EXPECT_TRUE(test.findings().empty());
}

TEST(ObservationAudit, WithoutACoordinateTheLowestGroundOfTheScreenLimitsTheSpeed) {
    // the screen lies along the slope: its lower end at x = 30 is 32 m below the start, 25.05 m/s
    GoodTest test;
    test.screens[0].line = {{0, 0}, {30, 0}};
    test.site.screens = test.screens;
    for (ObservedCrossing& c : test.o.crossings) c.position = Vec3::Constant(kNaN);
    test.o.crossings[0].value[0] = 24.9;
    EXPECT_TRUE(test.findings().empty());
    test.o.crossings[0].value[0] = 28.0;
    ASSERT_EQ(test.findings().size(), 1U);
    EXPECT_THAT(test.findings()[0].sentence, HasSubstr("gives 25.1 m/s"));
}

}  // namespace
}  // namespace scree::test
