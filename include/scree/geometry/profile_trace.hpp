// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/units.hpp"
#include "scree/geometry/feature.hpp"
#include "scree/geometry/profile.hpp"
#include "scree/geometry/region.hpp"
#include "scree/geometry/surface.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace scree {

/// How steepest-slope profiles are led over the terrain.
///
/// 1. Direction surface. A raw steepest line follows every bump. Directions are therefore those of a surface of the same facets
///    whose nodes have averaged heights: at each node the value of a plane fitted to the terrain within `smoothing`. On it the
///    steepest line is exact: straight within a facet, into the next facet across an edge, down along a valley edge where both
///    facets drain to it. The profile's own heights are always those of the terrain, at every edge of a facet that it crosses.
/// 2. Gentle ground: where the steepest line falls by less than `gentle_slope` (tracks, platforms, flats, pits, and valley floors), and
///    where it comes to a stop. The line goes straight on in the direction of the slope above, that is of its last `memory`
///    metres (Bourrier & Acary 2022, path B: "the profile crosses the track following the steepest slope direction of the above slope"),
///    until it finds ground that is steep, falls away onwards, and lies lower than where the crossing began.
/// 3. Where that crossing would climb by more than `highest_rise`, the line follows the steepest line of the gentle ground
///    instead, and leaves pits of it by their lowest way, if that leads to steep ground within `longest_crossing`: the bend of a gully
///    with a gentle floor.
/// 4. If neither does, the profile ends on the straight one: `Flat` after `longest_crossing`, or `Pit` where the ground climbs; behind
///    a pit the line is led up the counter-slope for `run_up` more, which a block may need. It ends before, at the rim of
///    the terrain or at a hole in it (NoData).
/// Every leg starts lower, on the direction surface, than the one before: a line never closes.
/// 5. Head. Blocks need ground behind the places where they start: the line is led up the slope while it is steep and inside a release area,
///    then straight on until it has left the area, and so on where another one (or the other side of a hole) begins within `head`; then for `head` more.
///
/// A guided line follows the steepest line of the direction surface plus the potential d^2 / (2 guide_width), where d [m] is the distance
/// from the guide, and goes along the guide where the ground is gentle, whatever it climbs; beyond the guide's end it is free.
struct ProfileSettings {
    double smoothing =
        5.0;  ///< radius of the average; 0 takes the facets as they are; larger cuts corners of gullies [m]
    double gentle_slope =
        radians_from_degrees(15.0);  ///< below it ground is crossed straight on; larger ignores more of it [rad]
    double memory = 20.0;  ///< length of the slope above whose direction is kept; shorter follows its last bend [m]
    double longest_crossing = 100.0;  ///< on gentle ground, without steep ground found: then the profile ends [m]
    double highest_rise =
        1.0;  ///< largest climb on a crossing, on the direction surface: pits deeper than this end the profile [m]
    double run_up = 20.0;     ///< ground behind a pit in which a profile ends [m]
    double head = 5.0;        ///< ground behind the starting point and the release areas [m]
    double longest = 5000.0;  ///< from the starting point [m]
    double guide_width =
        10.0;  ///< at this distance a guide pulls as a slope of 45 degrees; larger leaves more freedom [m]
};

/// Why a profile ends.
enum class ProfileEnd { Pit, Flat, Rim, NoData, LengthLimit, LineEnd, Merged };
inline constexpr std::array<const char*, 7> kProfileEndNames{"pit",          "flat",     "rim",   "no_data",
                                                             "length_limit", "line_end", "merged"};

/// How a reach was led.
enum class Course : std::uint8_t { Steepest, Straight, Given };
inline constexpr std::array<const char*, 3> kCourseNames{"steepest", "straight", "given"};

/// A profile and how it came about.
struct ProfileTrace {
    Profile profile;             ///< empty if the ground is level at the starting point: there is no direction to go
    std::vector<Course> course;  ///< of each reach
    ProfileEnd end = ProfileEnd::Flat;
    double start = 0.0;      ///< chainage of the starting point [m]
    int joins = -1;          ///< number of the earlier profile that this one runs into, -1: none [-]
    double joins_at = kNaN;  ///< from this chainage on it stays within the distance of find_junctions() [m]
};

/// Traces profiles on one terrain, which must outlive it. Heights of the direction surface are computed where lines come by, once.
class ProfileTracer {
public:
    ProfileTracer(const Surface& surface, const ProfileSettings& settings);
    ~ProfileTracer();
    ProfileTracer(const ProfileTracer&) = delete;
    ProfileTracer& operator=(const ProfileTracer&) = delete;

    /// Steepest line from a point of the terrain. `releases`: areas in which blocks start, which the head must leave; may be null.
    ProfileTrace steepest(const Vec2& start, const Region* releases = nullptr);
    /// Steepest line along a guide, from the guide's first point, which must lie on the terrain; the head as above.
    ProfileTrace guided(std::span<const Vec2> guide, const Region* releases = nullptr);
    /// The terrain's section along a line, whose first point must lie on the terrain. Ends where the line leaves the terrain.
    ProfileTrace along(std::span<const Vec2> line);

private:
    class Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// A point to trace from.
struct ProfileStart {
    Vec2 at = Vec2::Zero();   ///< [m]
    std::size_t feature = 0;  ///< index of the feature in the layer [-]
};

/// Starting points in the features of a layer. `spacing` 0: one per feature (points: each; lines: the middle; polygons: the
/// centroid, or a point inside where the centroid is not). Otherwise points every `spacing` [m]: along lines, and in polygons on a square
/// lattice (at least one each).
std::vector<ProfileStart> profile_starts(const FeatureLayer& layer, double spacing);

/// What to do with lines that run into earlier ones.
enum class Converging { Keep, Merge, Drop };
inline constexpr std::array<const char*, 3> kConvergingNames{"keep", "merge", "drop"};

/// Finds profiles that run into earlier ones: from `joins_at` to its end each point of it is within `distance` [m] of earlier profiles.
///   Keep:  the profiles stay whole (a 2D model needs the ground down to its end);
///   Merge: the later one ends at the junction, with the reason Merged, so that together they make a tree (left out where nothing is its own);
///   Drop:  the later one is left out if more than half of its length is shared. Returns how many were left out.
std::size_t find_junctions(std::vector<ProfileTrace>& traces, double distance, Converging converging);

}  // namespace scree
