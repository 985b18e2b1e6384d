// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/ensemble/campaign.hpp"
#include "scree/inference/axis.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace scree {

/// Measurements of a field test, in the local frame. NaN stands for "not measured" throughout. `row` is where a record came from (line of a table,
/// number of a feature), for messages. `block` is an index into Observations::blocks, -1 where it is not known which block was measured.

/// A block that was thrown: one throw, not one stone (a stone thrown twice is two).
struct ObservedBlock {
    std::string id;
    double mass = kNaN;                   ///< [kg]
    Vec3 size = Vec3::Constant(kNaN);     ///< L1, L2, L3 [m]
    Vec2 release = Vec2::Constant(kNaN);  ///< where it was let go, plan view [m]
    std::int32_t profile = -1;            ///< in 2D: the profile on which it was let go; -1: unknown
    double s = kNaN;                      ///< in 2D: chainage along that profile [m]
    std::int32_t path = -1;               ///< down which it went, of Observations::paths; -1: unknown
    double order = kNaN;                  ///< place in the order of the test; unknown unless somebody wrote it down [-]
    bool has_body() const { return mass > 0.0 && (size.array() > 0.0).all(); }
};

/// Where a block was found.
struct ObservedStop {
    std::int64_t row = 0;
    std::int32_t block = -1;
    Vec3 position = Vec3::Constant(kNaN);  ///< z may be NaN: it is compared with nothing [m]
    double error = 0.0;                    ///< standard deviation of easting and of northing [m]
    bool censored = false;                 ///< it was last seen here and ran at least so far
    bool broken = false;                   ///< it broke on the way: the largest piece, or the last impact before
};

/// What a screen saw, or what was measured at the start or the end of an impact. Rise: vertical speed, upwards positive.
enum class Kinematic { Speed, Height, Spin, Energy, Rise };
inline constexpr std::size_t kKinematics = 5;
/// One value per Kinematic: [m/s], [m] of the centre of mass above the ground, [rad/s], [J], [m/s].
using KinematicValues = std::array<double, kKinematics>;

struct ObservedCrossing {
    std::int64_t row = 0;
    std::int32_t block = -1;
    std::int32_t screen = 0;                              ///< index into ObservationOperator::screens [-]
    Vec3 position = Vec3::Constant(kNaN);                 ///< [m]
    KinematicValues value{kNaN, kNaN, kNaN, kNaN, kNaN};  ///< all NaN: it passed, nothing else was measured [*]
    KinematicValues error{};                              ///< standard deviations [*]
};

/// What would be recorded of a crossing, or of one end of an impact, without any error.
KinematicValues kinematics_of(const ScreenCrossing& crossing);
KinematicValues kinematics_of(const FilmedImpact::End& end);

/// How many blocks stopped in a deposit zone, counted without coordinates.
struct ObservedShare {
    std::int64_t row = 0;
    std::int32_t zone = 0;    ///< index into ObservationOperator::zones [-]
    std::int64_t count = 0;   ///< blocks at rest in the zone [-]
    std::int64_t thrown = 0;  ///< of so many thrown [-]
};

struct Observations {
    std::vector<ObservedBlock> blocks;
    std::vector<std::string> paths;  ///< names, each once
    std::vector<ObservedStop> stops;
    std::vector<ObservedCrossing> crossings;
    std::vector<ObservedShare> shares;
    std::int64_t thrown =
        0;  ///< blocks thrown in the test; 0: not known, so that shares of passing blocks are not compared [-]
    /// True: every block is known, and block k of the campaign is block k mod blocks.size() of the test, with its mass and size.
    /// False: measurements and simulation are two pools of blocks.
    bool matched = false;
};

/// Where and how the test measured: what a simulated block passes through before it is compared (with the errors of the observations).
struct ObservationOperator {
    Axis axis;
    /// False: stops are compared by their distance along the axis alone, all of them moved onto it first. For models that know no way beside
    /// their profile, which is the axis then.
    bool lateral = true;
    Vec2 origin = Vec2::Zero();  ///< centre of the release, from which `runout` is counted [m]
    std::vector<std::string>
        screens;  ///< names, each once; then two for every impact: "the start of impact 1", "the end of impact 1"
    std::size_t impacts = 0;              ///< of a block, that were measured [-]
    std::vector<std::int32_t> screen_of;  ///< screen (above) of each CampaignInput::screens [-]
    /// Screens (above) that would have recorded every block that passed: without any record nobody did, where of others nothing is known then [-].
    std::vector<std::int32_t> watched;
    std::vector<std::string> zones;                           ///< names, each once
    std::vector<std::pair<std::int32_t, Region>> zone_areas;  ///< zone (above) and an area of it
    /// Measurement effects (effects.hpp): how this test may have measured wrong. Others are left alone.
    std::vector<Effect> effects;
    double least_speed = 0.0;         ///< slower passages were not seen by the camera: they count as not passed [m/s]
    double runout_limit = kInfinity;  ///< stops beyond this chainage were recorded there, where the survey ended [m]

    /// Whether a number of `screens` is none, but the start or end of an impact. Who has no such record may have had the impact all the same.
    bool is_impact(std::int32_t screen) const {
        return static_cast<std::size_t>(screen) + 2 * impacts >= screens.size();
    }
    std::int32_t start_of_impact(std::int64_t number) const {
        return static_cast<std::int32_t>(screens.size() - 2 * impacts) + 2 * static_cast<std::int32_t>(number);
    }
    bool is_watched(std::int32_t screen) const {
        return std::find(watched.begin(), watched.end(), screen) != watched.end();
    }
    /// Adds impacts behind the screens of a site, all of which are known by then.
    void add_impacts(std::size_t count);
};

/// What is compared, one column each. Passed and InZone are 0 or 1.
enum class Quantity { Along, Lateral, Runout, Passed, Speed, Height, Spin, Energy, Rise, InZone };
struct Column {
    Quantity quantity = Quantity::Along;
    std::int32_t place = -1;  ///< screen or zone, -1 for stops [-]
    bool operator==(const Column&) const = default;
};
/// Quantity of a kinematic value.
inline Quantity quantity_of(std::size_t kinematic) {
    return static_cast<Quantity>(static_cast<std::size_t>(Quantity::Speed) + kinematic);
}

/// Measured or simulated blocks as rows, NaN where there is nothing: not measured, or the block did not pass the screen.
struct ObservationTable {
    std::vector<Column> columns;
    std::vector<std::vector<double>> values;  ///< per column, one value per row; [m], [m/s], [rad/s], [J], [-]
    std::vector<std::int32_t> block;          ///< per row: block of the test, -1 if unknown [-]

    std::size_t rows() const { return block.size(); }
    /// Index of a column, or columns.size() if it is not there.
    std::size_t find(const Column& column) const;
};

/// The columns that the observations hold something of, then all zones if there are stops to sort into them.
std::vector<Column> observed_columns(const Observations& observations, const ObservationOperator& op);

/// Measurements as rows: first one per block of the test if they are matched, then one per record of an unknown block. Of blocks that
/// are known, one without a record at a screen that recorded known blocks, or that was watched, has not passed it. Shares stay outside
/// (ObservedShare).
ObservationTable measured_table(const Observations& observations, const ObservationOperator& op);

/// A pool as rows that stand for blocks: nobody knows which records are of one block, so stops and what each screen saw are put side by side, in as many
/// rows as blocks were thrown; a row without a record of a screen has not passed it (unless nobody knows how many were thrown, 0: nothing then says who
/// passed), nor has any a screen of which the table has the passing and no record at all. Right for means, shares and the counts behind them; what one row says of two records means nothing. Rows of known blocks stay as they are, but
/// that shares of zones that nothing else is known of are told to the first rows, one block each: nobody knows which blocks were counted.
ObservationTable side_by_side(const ObservationTable& measured, std::int64_t thrown,
                              std::span<const ObservedShare> shares = {});
inline ObservationTable side_by_side(const Observations& observations, const ObservationOperator& op) {
    return side_by_side(measured_table(observations, op), observations.thrown, observations.shares);
}

/// The same view of a campaign: one row per block that did not fail, in order. Stops of blocks that left the terrain or ran out of time
/// count where they were last seen. Adds the errors of the measurements, drawn with Philox streams of (seed, block): those of the same block
/// if matched, else of a measurement drawn at random. Depends on nothing else.
ObservationTable simulated_table(const CampaignResult& campaign, const Observations& observations,
                                 const ObservationOperator& op, std::uint64_t seed);

/// First crossing of each of so many screens by one block, null where it has none. `screen_of` each screen of the campaign, -1: none of them; the parts of a
/// screen count as one.
std::vector<const ScreenCrossing*> first_crossings(std::span<const ScreenCrossing> of_block,
                                                   std::span<const std::int32_t> screen_of, std::size_t screens);
/// The same of all blocks, by screen: those that are there, in the order of the crossings, which lists block by block.
std::vector<std::vector<const ScreenCrossing*>> first_crossings_of_all(std::span<const ScreenCrossing> crossings,
                                                                       std::span<const std::int32_t> screen_of,
                                                                       std::size_t screens);

/// Moves the screens of a campaign to where measurement effects of the kind screen_shift say that they stood: along the axis, in 2D along the profiles.
void shift_screens(std::span<const Effect> effects, const Axis& axis, CampaignInput& campaign);

}  // namespace scree
