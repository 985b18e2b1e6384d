// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/random.hpp"
#include "scree/geometry/grid.hpp"
#include "scree/geometry/profile.hpp"
#include "scree/geometry/region.hpp"
#include "scree/geometry/triangle_mesh.hpp"
#include "scree/own_law.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scree {

/// Everything beyond the contact law of Bourrier & Acary (2022) is an effect: named, documented, off unless asked for. The catalogue lists them all; an
/// Effect is one of them with its parameters and the place where it acts.

/// In the order in which they came: random streams hang on the number of a kind.
enum class EffectKind : std::uint8_t {
    RestitutionPfeifferBowen,
    RestitutionHalfSpeed,
    RestitutionMass,
    SlipFriction,
    RollingSpeed,
    RollingSize,
    LowFriction,
    Roughness,
    SoilPatch,
    GroundDrag,
    GroundDragQuadratic,
    ScarDrag,
    ScarDragReduced,
    AirDrag,
    ForestDrag,
    Trees,
    Net,
    Berm,
    Fragmentation,
    OwnLaw,
    ReleaseMotion,
    BlockShape,
    SpeedError,
    ScreenShift,
    SlowMissed,
    BrokenBlock,
    IdsShuffled,
    HeightDatum,
    FrictionSpeed,
    SoilScatter,
    FrictionBlockSpeed
};
inline constexpr std::size_t kEffectKinds = 31;

/// Where an effect takes hold.
enum class EffectHook : std::uint8_t {
    ContactLaw,    ///< e, mu, mu_r of a contact as a function of the state
    Impact,        ///< the instant of an impact
    ContactForce,  ///< a force on the centre of mass while the ground bears the block
    Force,         ///< a force on the centre of mass, in flight and in contact
    Crossing,      ///< energy taken at once where the path crosses something
    Terrain,       ///< the heights of the terrain
    Release,       ///< how the block starts
    Block,         ///< what falls
    Measurement    ///< what is measured of it: acts on simulated observations, never on the motion
};
inline constexpr std::array<const char*, 9> kEffectHookNames{
    "contact law", "impact", "force in contact", "force", "crossing", "terrain", "release", "block", "measurement"};

/// What may say where an effect acts. Without any of it the effect acts everywhere.
struct EffectLimits {
    bool soil = false;          ///< contacts with one soil (forces in flight: the soil under the centre of mass)
    bool zone = false;          ///< polygons; along a profile, reaches of it
    bool lines = false;         ///< lines, which it needs; along a profile, stations
    bool points = false;        ///< points instead of polygons
    bool needs_impact = false;  ///< acts at impacts, which moreau_jean does not have as events of their own
    bool screen = false;        ///< what one screen measures
};

/// One number of an effect.
struct EffectParameter {
    const char* key;
    const char* unit;     ///< "m/s", "-"
    double standard;      ///< value if none is given; NaN: that of the soil [unit]
    double low;           ///< smallest value allowed [unit]
    double high;          ///< largest value allowed [unit]
    double neutral;       ///< value, or limit, at which the effect vanishes; NaN: it has none [unit]
    const char* meaning;  ///< with the consequence of changing it
    const char* source;   ///< of the value or its range
};

inline constexpr std::size_t kMostEffectParameters = 4;

/// A row of the catalogue.
struct EffectInfo {
    EffectKind kind;
    const char* name;   ///< as in the site file
    const char* title;  ///< a few words
    EffectHook hook;
    EffectLimits limits;
    const char* formula;  ///< in plain text
    const char* source;   ///< of the formula
    const char* seen_in;  ///< which measurements can show it
    const char* note;     ///< what to know before using it; may be empty
    std::span<const EffectParameter> parameters;
};

/// All effects, by where they take hold.
std::span<const EffectInfo> effect_catalogue();
const EffectInfo& effect_info(EffectKind kind);
/// A number of the effect; an unknown key is a programmer's mistake.
const EffectParameter& effect_parameter(EffectKind kind, std::string_view key);
/// The kind with this name, none if there is no such effect.
std::optional<EffectKind> effect_kind(std::string_view name);

/// Where an effect acts.
struct EffectPlace {
    struct Area {
        MultiPolygon polygons;  ///< local frame [m]
        Region region;
    };
    int soil = -1;                     ///< SoilId, -1: all
    std::string screen;                ///< name, of all its parts; empty: all screens
    std::shared_ptr<const Area> area;  ///< in plan view; none: everywhere
    std::vector<Points> lines;         ///< of a net or berm in plan view; z is not used [m]
    Points points;                     ///< of trees in plan view, by x; along a profile (chainage, offset, -) [m]
    std::optional<std::vector<Stretch>> reaches;  ///< along a profile; none: everywhere
    std::vector<double> stations;                 ///< of a net or berm along a profile: chainages [m]

    void limit_to(MultiPolygon polygons);
    void sort_points();  ///< by x: after points were added
    /// True if the effect acts at this place of the plan and soil; `plan` is (x, y), in the plane of a profile (chainage).
    bool covers(int soil_there, const Vec2& plan) const;
    bool covers(int soil_there, const Eigen::Matrix<double, 1, 1>& plan) const;
    /// Share in (0, 1] of the way from one place to another at which the border of the zone is crossed first, infinite if it is not.
    double first_border(const Vec2& from, const Vec2& to) const;
    double first_border(const Eigen::Matrix<double, 1, 1>& from, const Eigen::Matrix<double, 1, 1>& to) const;
    /// The same for the first line of a net that is crossed beyond the share `after`.
    double next_line(const Vec2& from, const Vec2& to, double after) const;
    double next_line(const Eigen::Matrix<double, 1, 1>& from, const Eigen::Matrix<double, 1, 1>& to,
                     double after) const;
};

/// The functions of the effect `own_law`, see scree/own_law.h; what is absent does nothing.
struct OwnLaw {
    decltype(&scree_contact_law) contact_law = nullptr;
    decltype(&scree_ground_drag) ground_drag = nullptr;
    std::shared_ptr<void> library;  ///< that holds them
};

/// One effect, switched on.
struct Effect {
    EffectKind kind = EffectKind::GroundDrag;
    std::array<double, kMostEffectParameters> values{};  ///< in the order of the catalogue's parameters [*]
    EffectPlace place;
    OwnLaw own;

    /// By the parameter's name; an unknown name is a programmer's mistake.
    double value(std::string_view key) const;
    void set(std::string_view key, double value);
};

/// An effect with the catalogue's standard values that acts everywhere.
Effect make_effect(EffectKind kind);

/// The stream that an effect draws from, the `number`-th of its kind: another for each block (for effects of measurements, for each repeat of the
/// test), numbered below 2^40.
RandomStream effect_stream(std::uint64_t seed, EffectKind kind, std::uint64_t number, std::uint64_t block);

/// True for effects that the motion of a block feels (not those of terrain, block, release and measurement).
bool acts_on_motion(EffectKind kind);

/// Throws InputError where an effect cannot be: a value outside its range, a place that it does not know, impacts in a mode
/// without them. `event_mode`: impacts are events of their own.
void check_effect(const Effect& effect, bool event_mode);

/// The same effects along a profile: polygons become reaches (of those given by chainage what lies in them), the lines of nets the stations where they cross it, points get chainage and
/// offset. Berms drawn on the map are in the surface that the profile was cut from; their lines are dropped.
std::vector<Effect> effects_along(std::span<const Effect> effects, const Profile& profile);

/// Berms onto the terrain: height + H max(0, 1 - 2 d / W) at the distance d from their lines; several add up. Of a grid the nodes are
/// raised, so that a berm much narrower than the cells is lost; a profile gets vertices at foot and crest.
void raise_berms(std::span<const Effect> effects, Grid<double>& heights);
/// How high a berm drawn on the map stands above the ground along its line, facets spanning the raised nodes of such a grid (all cells parted from
/// north-west to south-east). NaN where its line passes no cell.
struct BermCrest {
    double lowest = kNaN, mean = kNaN;  ///< [m]
};
BermCrest crest_of(const Effect& berm, const GridShape& shape);
Profile raise_berms(std::span<const Effect> effects, const Profile& profile);

/// What an effect needs to know of a block.
struct EffectBody {
    double mass = 0.0;    ///< [kg]
    double length = 0.0;  ///< L, mean of its three edges L1, L2, L3 [m]
};

/// Effects on the motion of one block: random numbers are those of (seed, block) and of each effect.
struct EffectInput {
    std::span<const Effect> effects;
    std::uint64_t seed = 1;
    std::uint64_t block = 0;
};

}  // namespace scree
