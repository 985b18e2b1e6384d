// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/trajectory.hpp"
#include "scree/ensemble/cell_statistics.hpp"
#include "scree/ensemble/population.hpp"
#include "scree/ensemble/profile_release.hpp"
#include "scree/ensemble/release.hpp"
#include "scree/geometry/feature.hpp"
#include "scree/geometry/profile.hpp"
#include "scree/geometry/region.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace scree {

/// A line or the outline of an area where passing blocks are measured.
struct Screen {
    std::string name;
    std::vector<Vec2> line;  ///< plan view; closed outlines repeat their first point [m]
    std::int32_t part_of =
        -1;  ///< index of the screen before it that this is another line of, which counts instead; -1: of none
};

/// The first time that a block crosses a screen, at the exact crossing of the path of its centre of mass.
struct ScreenCrossing {
    std::int64_t block = 0;
    std::int32_t screen = 0;       ///< index into the screens
    double time = 0.0;             ///< since release [s]
    Vec3 position = Vec3::Zero();  ///< of the centre of mass [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    double spin = 0.0;             ///< [rad/s]
    double mass = 0.0;             ///< of the block, or of what is left of it [kg]
    double energy = 0.0;           ///< kinetic, translation and rotation [J]
    double height = 0.0;           ///< of the centre of mass above the terrain, vertically [m]
    double measured_speed =
        0.0;          ///< as a film measures it over CampaignInput::screen_span; that at the screen if it is 0 [m/s]
    double s = kNaN;  ///< 2D: chainage along the block's profile [m]
};

/// An impact as a film of the path shows it: all that happens between two flights of 0.1 s and more (ImpactWatch).
struct FilmedImpact {
    std::int64_t block = 0;
    std::int32_t number = 0;  ///< of the block's, from 0
    struct End {
        double time = 0.0;             ///< since release [s]
        double mass = 0.0;             ///< of the block, or of what is left of it [kg]
        Vec3 position = Vec3::Zero();  ///< of the centre of mass [m]
        Vec3 velocity = Vec3::Zero();  ///< [m/s]
        double spin = 0.0;             ///< [rad/s]
        double s = kNaN;               ///< 2D: chainage along the block's profile [m]
    };
    End before, after;  ///< where the flight before ends, and where the flight after begins
};

/// An area whose deposits are counted.
struct DepositZone {
    std::string name;
    Region region;
};

/// A kept trajectory: centre of mass with time.
struct KeptTrajectory {
    std::int64_t block = 0;
    std::vector<Vec3> points;       ///< [m]
    std::vector<double> times;      ///< since release [s]
    std::vector<double> speeds;     ///< [m/s]
    std::vector<double> chainages;  ///< 2D [m]
};

/// A contact problem that was left above the solver's tolerance.
struct HardProblem {
    std::int64_t block = 0;
    std::variant<ContactProblem<3>, ContactProblem<2>> problem;
};

/// How one block fared.
struct BlockResult {
    bool done = false;  ///< false if the campaign was stopped before its turn
    StopReason reason = StopReason::Failed;
    std::int64_t row = -1;                 ///< row of the block list, -1 if none [-]
    std::int64_t feature = kNoFeature;     ///< release feature; none of a block that was let go at a known place [-]
    double mass = 0.0;                     ///< [kg]
    double mass_left = 0.0;                ///< at the end: less if the block broke [kg]
    Vec3 size = Vec3::Zero();              ///< L1, L2, L3 [m]
    Vec3 release = Vec3::Zero();           ///< centre of mass at the start [m]
    double raised = 0.0;                   ///< how far the block was lifted to start free of the ground [m]
    Vec3 stop = Vec3::Zero();              ///< centre of mass at the end [m]
    Vec3 broke_at = Vec3::Constant(kNaN);  ///< centre of mass where the block first broke; NaN if it did not [m]
    double time = 0.0;                     ///< [s]
    double path_length = 0.0;              ///< length of the path in space [m]
    double largest_speed = 0.0;            ///< [m/s]
    double largest_energy = 0.0;           ///< kinetic [J]
    std::int32_t profile = -1;             ///< 2D: index of the profile on which it moved
    double release_s = kNaN;               ///< 2D: chainage at the start [m]
    double stop_s = kNaN;                  ///< 2D: chainage at the end [m]
};

/// A profile on which blocks move in 2D.
struct ProfileTrack {
    Profile profile;
    /// Where a screen stands on it.
    struct Mark {
        std::int32_t screen = 0;  ///< index into the screens
        double s = 0.0;           ///< chainage [m]
    };
    std::vector<Mark> marks;  ///< a screen may stand at several chainages: the first that a block passes counts
};

/// Cells of a length along a profile, counted from its upper end; the last may be shorter.
inline std::size_t cells_along(const Profile& profile, double cell) {
    return static_cast<std::size_t>(std::max(1.0, std::ceil(profile.length() / cell - 1e-9)));
}

/// Everything that a campaign needs. With `tracks` it runs in 2D on these profiles: positions of its results are then those on the map, of the places
/// along the profiles. What is pointed to outlives the campaign.
struct CampaignInput {
    const Surface* surface = nullptr;  ///< 3D
    std::vector<Soil> soils;           ///< indexed by SoilId
    /// All that is switched on, as on the map. Those of the terrain are in it already, those of measurements are for whoever compares.
    std::vector<Effect> effects;
    DynamicsSettings dynamics;
    BlockPopulation population;
    ReleaseSettings release;
    std::vector<bool> thrown;           ///< which of the release.count blocks are; empty: all
    std::vector<Departure> departures;  ///< of every block, in place of its release; empty: they are released
    const ReleaseArea* area = nullptr;  ///< 3D
    std::uint64_t seed = 1;
    GridShape result_cells;                           ///< 3D: where passages are counted
    std::vector<ProfileTrack> tracks;                 ///< 2D: the profiles; empty: 3D
    const ProfileRelease* profile_release = nullptr;  ///< 2D
    double cell_along = 1.0;                          ///< 2D: length of the cells along a profile [m]
    bool passages = true;  ///< follow what passes every cell; without, stops and crossings are all that is kept
    std::vector<Screen> screens;
    double screen_span =
        0.0;  ///< length around a screen over which ScreenCrossing::measured_speed is a mean; 0: none [m]
    std::int32_t impacts = 0;  ///< first ones of every block that are kept [-]
    std::vector<DepositZone> deposit_zones;
    std::int64_t kept_trajectories = 0;  ///< how many of the first blocks to keep as lines [-]
    int threads = 0;                     ///< 0: all cores [-]
};

struct DepositCount {
    std::string name;
    std::int64_t count = 0;  ///< blocks at rest in the zone [-]
};

struct CampaignResult {
    std::vector<BlockResult> blocks;           ///< one per block number
    std::vector<std::string> block_ids;        ///< of the population's list, by row
    std::vector<ScreenCrossing> crossings;     ///< by block, then screen
    std::vector<FilmedImpact> impacts;         ///< by block, then number
    std::vector<KeptTrajectory> trajectories;  ///< by block
    CellMap cells;                             ///< 3D
    std::vector<CellMap> cells_along;          ///< 2D: of each profile, by number of the cell along it
    std::vector<DepositCount> deposits;        ///< one per deposit zone
    std::array<std::int64_t, 4> reasons{};     ///< blocks by StopReason
    std::int64_t released = 0;                 ///< blocks thrown: the sum of the reasons, always
    TrajectoryCounters counters;
    std::vector<HardProblem> hard_problems;  ///< by block, at most dynamics.kept_problems of each piece of its path
    bool interrupted = false;
};

/// Blocks done so far; called from one thread at a time, now and then.
using CampaignProgress = std::function<void(std::int64_t done)>;

/// Throws all blocks on all cores. The result depends on the input only: not on the number of threads nor on their timing. When `stop` becomes true the
/// blocks in flight are finished, the rest stays undone.
CampaignResult run_campaign(const CampaignInput& input, const CampaignProgress& progress,
                            const std::atomic<bool>& stop);

}  // namespace scree
