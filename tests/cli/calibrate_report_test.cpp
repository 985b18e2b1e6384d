// SPDX-License-Identifier: GPL-3.0-or-later
// What the page of a calibration says of blocks, places and paths that were held out.
#include "cli/calibrate_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace scree::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

CalibrationReport one_fold_and_two_places() {
    CalibrationReport report;
    report.result.surroundings.holds = true;
    report.result.folds.emplace_back().held_out = {0, 2, 5};
    report.result.places.push_back({.name = "ES1"});
    report.result.places.push_back({.name = "P2", .is_path = true, .was_seen = true});
    return report;
}

TEST(CalibrateReport, OfPoolsRecordsAreHeldOut) {
    CalibrationReport report = one_fold_and_two_places();
    EXPECT_THAT(calibrate_html(report, {}, {}), HasSubstr("3 records held out"));
    report.after_study.repeats = 10;
    EXPECT_THAT(calibrate_html(report, {}, {}), HasSubstr("3 blocks held out"));
}

// Where the search without a place ends at the parameters of all records, the place had its part in finding them.
TEST(CalibrateReport, APlaceThatWasSeenIsMarked) {
    CalibrationReport report = one_fold_and_two_places();
    const std::string page = calibrate_html(report, {}, {});
    const std::size_t places = page.find("of that, at"), paths = page.find("of blocks on path");
    ASSERT_LT(places, paths);
    ASSERT_NE(paths, std::string::npos);
    EXPECT_THAT(page.substr(places, paths - places), Not(HasSubstr(", by the parameters of all")));
    EXPECT_THAT(page.substr(paths), HasSubstr(", by the parameters of all"));
    const auto json = nlohmann::json::parse(places_json(report.result));
    EXPECT_EQ(json[0]["place"], "ES1");
    EXPECT_EQ(json[0]["left_out_was_seen"], false);
    EXPECT_EQ(json[1]["path"], "P2");
    EXPECT_EQ(json[1]["left_out_was_seen"], true);
}

TEST(CalibrateReport, BlocksWhoseEndNobodyKnowsAreTold) {
    CalibrationReport report = one_fold_and_two_places();
    EXPECT_THAT(calibrate_html(report, {}, {}), Not(HasSubstr("left the terrain")));
    report.after_study.released = 400;
    report.after_study.lost = 330;
    report.after_study.failed = 2;
    EXPECT_THAT(calibrate_html(report, {}, {}), HasSubstr("82.5 % of the simulated blocks left the terrain"));
    EXPECT_THAT(calibrate_json(report), HasSubstr("0.5 % of the simulated blocks came to nothing"));
}

// The name of a file need not be UTF-8; hours of simulations are not lost over it.
TEST(CalibrateReport, WritesInputsOfAnyName) {
    CalibrationReport report = one_fold_and_two_places();
    report.inputs = {"stops_\xe9.csv (measured)"};
    EXPECT_THAT(calibrate_json(report), HasSubstr("stops_\xef\xbf\xbd.csv (measured)"));
}

}  // namespace
}  // namespace scree::cli
