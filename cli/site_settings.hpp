// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/effects.hpp"
#include "scree/dynamics/trajectory.hpp"
#include "scree/ensemble/population.hpp"
#include "scree/ensemble/release.hpp"
#include "scree/geometry/profile_trace.hpp"
#include "scree/inference/calibration.hpp"
#include "scree/inference/diagnosis.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace scree::cli {

enum class SurfaceKind { Grid, Tin };
inline constexpr std::array<const char*, 2> kSurfaceKindNames{"grid", "tin"};

inline constexpr std::array<const char*, 2> kDiagonalRuleNames{"alike", "by_relief"};

enum class BlockOrder { Random, InTurn };
inline constexpr std::array<const char*, 2> kBlockOrderNames{"random", "in_turn"};

enum class ProfileMode { Steepest, Guided, Line };
inline constexpr std::array<const char*, 3> kProfileModeNames{"steepest", "guided", "line"};

/// A vector file with the layer and field that matter. An empty file means: not given.
struct VectorInput {
    std::string file;   ///< relative to the site file, or absolute
    std::string layer;  ///< empty: the only layer of the file
    std::string field;  ///< text field that matters
};

/// One [[effect]]: the effect with its parameters, its place as the file says it.
struct EffectSettings {
    Effect effect;
    std::string soil;     ///< name of a [[soil]]; empty: all
    VectorInput place;    ///< polygons, lines or points; empty: everywhere
    std::string library;  ///< of own_law
};

enum class AxisChoice { Automatic, Profile, Measured, Azimuth, Line };
inline constexpr std::array<const char*, 5> kAxisChoiceNames{"auto", "profile", "measured", "azimuth", "line"};

enum class BrokenBlocks { Keep, LeaveOut };
inline constexpr std::array<const char*, 2> kBrokenBlocksNames{"keep", "leave_out"};

/// How a field test measured, and how it is compared with.
struct ObservedSettings {
    bool matched = true;
    std::int64_t repeats = 100;        ///< [-]
    std::int64_t draws = 1000;         ///< [-]
    std::int64_t thrown = 0;           ///< 0: as many as were measured [-]
    std::vector<std::string> watched;  ///< screens
    bool release_positions = true;
    double position_error = 0.0;   ///< [m]
    double speed_error = 0.0;      ///< [m/s]
    double height_error = 0.0;     ///< [m]
    double spin_error = 0.0;       ///< [rad/s]
    double energy_error_kj = 0.0;  ///< [kJ]
    double averaging = 0.0;        ///< [m]
    double least_speed = 0.0;      ///< [m/s]
    double runout_limit = 0.0;     ///< 0: none [m]
    BrokenBlocks broken = BrokenBlocks::Keep;
    bool lateral = true;
    AxisChoice axis = AxisChoice::Automatic;
    double azimuth_deg = 0.0;  ///< clockwise from north [deg]
    VectorInput line;          ///< guiding line
};

/// What is calibrated and how; 0 leaves numbers to CalibrationSettings.
struct CalibrateSettings {
    std::vector<std::string> free;  ///< "soil.NAME.friction=0.3:0.9", "blocks.shape=hull,box"
    CalibrationSettings search;     ///< without the seed
};

/// A site as its file describes it. Defaults here are the defaults of the keys; the table in settings.cpp says what each is.
struct SiteSettings {
    std::string name = "Scree";

    std::string dtm;
    double resolution = 0.0;  ///< 0: that of the DTM [m]
    SurfaceKind surface = SurfaceKind::Grid;
    DiagonalRule diagonals = DiagonalRule::Alike;
    double tolerance = 0.1;   ///< of the tin [m]
    bool conforming = false;  ///< facets end at soil boundaries
    VectorInput breaklines;

    std::vector<Soil> soils;
    VectorInput zones{{}, {}, "soil"};
    std::string default_soil;    ///< empty: the first soil
    std::string priority_field;  ///< empty: overlapping zones are an error

    std::string block_list;
    BlockOrder block_order = BlockOrder::Random;
    BlockShape shape = BlockShape::Hull;
    int points = 50;          ///< [-]
    int polygon_points = 20;  ///< [-]
    std::string shape_file;
    BlockDistribution distribution;

    VectorInput release;
    ReleaseSettings releases;    ///< without the angles
    double azimuth_deg = 0.0;    ///< of the initial speed, clockwise from north [deg]
    double elevation_deg = 0.0;  ///< of the initial speed above the horizontal [deg]

    std::int64_t dimension = 3;  ///< [-]
    DynamicsSettings dynamics;
    std::int64_t seed = 1;  ///< [-]

    ProfileMode profile_mode = ProfileMode::Steepest;
    VectorInput profile_start;               ///< empty: the release
    VectorInput profile_guide;               ///< of the modes guided and line
    double profile_spacing = 0.0;            ///< 0: one per feature [m]
    ProfileSettings profile;                 ///< without the angle
    double profile_gentle_slope_deg = 15.0;  ///< [deg]
    Converging profile_converging = Converging::Keep;
    double profile_merge_distance = 1.0;    ///< [m]
    double profile_release_distance = 5.0;  ///< [m]
    std::int64_t profile_pictures = 12;     ///< [-]

    VectorInput screens{{}, {}, "name"};
    std::string screen_chainages;  ///< "NAME = CHAINAGE, ..."; of 2D [m]
    VectorInput deposit_zones{{}, {}, "name"};

    std::vector<EffectSettings> effects;
    ObservedSettings observed;
    CalibrateSettings calibration;
    DiagnosisSettings diagnosis;                 ///< without its seed
    std::vector<std::string> diagnosis_without;  ///< effects that are known to be absent
    bool diagnosis_further = true;               ///< after UNKNOWN and GROUP

    std::string output_directory = "out";
    std::int64_t trajectories = 100;     ///< [-]
    std::int64_t impacts = 0;            ///< of every block [-]
    std::int64_t contact_problems = 10;  ///< [-]
    double result_resolution = 0.0;      ///< 0: that of the model [m]
};

}  // namespace scree::cli
