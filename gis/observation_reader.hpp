// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/local_frame.hpp"
#include "scree/geometry/types.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace scree::gis {

/// Measurements of a field test as files hold them; gis/README.md is the manual of their columns. NaN and empty texts: not given.

/// What a record says of the block it is about.
struct ObservedBody {
    std::string id;       ///< block_id, or the number of the block where there is a field `block` (results of Scree)
    double mass = kNaN;   ///< [kg]
    double l1 = kNaN;     ///< longest edge of the box around it [m]
    double l2 = kNaN;     ///< middle edge [m]
    double l3 = kNaN;     ///< shortest edge [m]
    double order = kNaN;  ///< place in the order of the test [-]
};

struct StopRecord {
    std::int64_t row = 0;  ///< line of the table, number of the feature [-]
    ObservedBody body;
    Vec3 position = Vec3::Constant(kNaN);  ///< local frame [m]
    double error = kNaN;                   ///< standard deviation of easting and northing [m]
    bool censored = false;
    bool broken = false;
};

struct CrossingRecord {
    std::int64_t row = 0;  ///< as above [-]
    ObservedBody body;
    std::string screen;
    Vec3 position = Vec3::Constant(kNaN);  ///< local frame [m]
    double speed = kNaN;                   ///< [m/s]
    double height = kNaN;                  ///< of the centre of mass above the ground [m]
    double spin = kNaN;                    ///< [rad/s]
    double energy = kNaN;                  ///< [kJ]
    double rise = kNaN;                    ///< vertical speed, upwards positive [m/s]
    double speed_error = kNaN;             ///< [m/s]
    double height_error = kNaN;            ///< [m]
    double spin_error = kNaN;              ///< [rad/s]
    double energy_error = kNaN;            ///< [kJ]
    double rise_error = kNaN;              ///< [m/s]
};

/// What a film gives at one end of an impact.
struct ImpactEnd {
    double speed = kNaN;  ///< [m/s]
    double rise = kNaN;   ///< vertical, upwards positive [m/s]
    double spin = kNaN;   ///< [rad/s]
};

struct ImpactRecord {
    std::int64_t row = 0;  ///< as above [-]
    ObservedBody body;
    std::int64_t impact = 0;  ///< 1: the first of its block [-]
    ImpactEnd before, after;
    double speed_error = kNaN;  ///< [m/s]
    double rise_error = kNaN;   ///< [m/s]
    double spin_error = kNaN;   ///< [rad/s]
};

struct ShareRecord {
    std::int64_t row = 0;  ///< as above [-]
    std::string zone;
    std::int64_t count = 0;   ///< blocks at rest [-]
    std::int64_t thrown = 0;  ///< of so many [-]
};

struct ReleaseRecord {
    std::int64_t row = 0;  ///< as above [-]
    ObservedBody body;
    Vec3 position = Vec3::Constant(kNaN);  ///< local frame [m]
};

struct ObservationRecords {
    std::vector<StopRecord> stops;
    std::vector<CrossingRecord> crossings;
    std::vector<ImpactRecord> impacts;
    std::vector<ShareRecord> shares;
    std::vector<ReleaseRecord> releases;
    std::vector<std::string> files;    ///< as opened
    std::string seed;                  ///< of the run whose results these are; empty: none of Scree's
    std::vector<std::string> screens;  ///< of that run: no block passed those that no crossing names
    std::vector<std::string>
        sources;  ///< a line for people per table or layer read: what, how many, CRS, transformation
    std::vector<std::string> warnings;
};

/// Names of the layers of a GeoPackage and, with .csv, of the tables of a folder.
inline constexpr const char* kStopsTable = "stopping_points";
inline constexpr const char* kCrossingsTable = "screen_crossings";
inline constexpr const char* kImpactsTable = "impacts";
inline constexpr const char* kSharesTable = "deposit_zones";
inline constexpr const char* kReleasesTable = "release_points";

/// Entries of the table `run` of results: this and the name of a screen, how many blocks passed it.
inline const std::string kPassedKey = "passed ";

/// Reads measurements from a GeoPackage (or any vector file with layers of these names), a folder of tables, one table, or a folder of results
/// of Scree, into the local frame of a terrain that covers `extent`. Positions are transformed with PROJ's most accurate operation, which
/// `sources` names; never silently. Throws InputError that names file, place, value and what is allowed.
ObservationRecords read_observations(const std::string& path, const LocalFrame& frame, const Box2& extent);

}  // namespace scree::gis
