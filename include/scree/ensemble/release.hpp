// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/effects.hpp"
#include "scree/dynamics/state.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/feature.hpp"
#include "scree/geometry/region.hpp"
#include "scree/geometry/surface.hpp"

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

namespace scree {

/// How blocks are shared out over the release features.
enum class ReleasePattern {
    Random,  ///< polygons in proportion to their area, lines to their length, points equally; position random within
    Cells,   ///< block after block over the cells of the model terrain whose centre lies in a polygon
};
inline constexpr std::array<const char*, 2> kReleasePatternNames{"random", "cells"};

/// Number of the cell in which a block starts with ReleasePattern::Cells: each run of `count` blocks fills all of them, the first in their order, later ones from a random
/// cell on, so that rows of a block list that are taken in turn do not come back to the same cells for ever.
std::uint64_t start_cell(std::uint64_t seed, std::uint64_t block, std::uint64_t count);

struct ReleaseSettings {
    std::int64_t count = 1000;   ///< blocks to throw [-]
    double height = 1.0;         ///< of the centre of mass above the surface, vertically [m]
    double height_spread = 0.0;  ///< half width of a uniform spread of the height [m]
    double speed = 0.0;          ///< initial speed [m/s]
    double azimuth = 0.0;        ///< its direction in plan view, clockwise from north [rad]
    double elevation = 0.0;      ///< its angle above the horizontal [rad]
    double spin = 0.0;           ///< initial spin about a random axis [rad/s]
    ReleasePattern pattern = ReleasePattern::Random;
};

/// Where blocks start, in the local frame. Overlapping features each get their own share: the overlap is used twice.
class ReleaseArea {
public:
    /// Throws InputError if the features hold no usable geometry over the terrain. `cells` are the terrain's cells for ReleasePattern::Cells.
    ReleaseArea(const FeatureLayer& layer, const Surface& surface, ReleasePattern pattern, const GridShape& cells);

    /// Plan position of block `block` and the number of the feature it belongs to; always over the terrain.
    Vec2 draw(std::uint64_t seed, std::uint64_t block, std::int64_t& feature) const;

    /// Share of random trial points that fall on the terrain; below 1 some features lie partly outside [-].
    double inside_share() const { return inside_share_; }
    /// Number of start cells for ReleasePattern::Cells [-].
    std::size_t cell_count() const { return cells_.size(); }

private:
    struct Source {
        std::int64_t feature = 0;
        double weight = 0.0;  ///< area, length or 1, only relative within one kind [m^2, m, -]
        std::variant<Region, Polyline, Vec2> place;
    };
    Vec2 draw_from(const Source& source, RandomStream& random) const;
    /// Centres of cells that lie in the region and on the terrain.
    std::vector<Vec2> starts_in(const Region& region, const GridShape& cells) const;
    void find_cells(const GridShape& cells);

    const Surface& surface_;
    ReleasePattern pattern_;
    std::vector<Source> sources_;
    double total_weight_ = 0.0;  ///< [same as weight]
    double inside_share_ = 1.0;  ///< [-]
    std::vector<std::pair<Vec2, std::int64_t>> cells_;
};

/// Start of a block: position, random orientation (uniform over all rotations), velocity and spin. A block that would touch the ground is raised until
/// it is free; `raised` tells by how much [m]. `fixed` is its plan position if that is known (`feature` is then left alone), NaN to draw one.
BlockState<3> draw_release(const ReleaseSettings& settings, const ReleaseArea& area, const Surface& surface,
                           const ConvexBlock& block, std::uint64_t seed, std::uint64_t number, std::int64_t& feature,
                           double& raised, const Vec2& fixed = Vec2::Constant(kNaN));

/// A block on its way, in place of a release: where a screen saw it, for example.
struct Departure {
    Vec3 position =
        Vec3::Zero();  ///< of the centre of mass; in 2D its chainage says where that is, and of this only z counts [m]
    Vec3 velocity = Vec3::Zero();  ///< in 2D forward along the profile, at the same angle [m/s]
    double spin = 0.0;             ///< about the horizontal across the velocity: positive as it rolls forward [rad/s]
    std::int32_t profile = -1;     ///< 2D: index of the profile
    double s = kNaN;               ///< 2D: chainage along it [m]
};

/// A block there, in a random orientation in which it is free of the ground, as one that was seen there was. Where kDepartures draws find none it is raised in the
/// one that needs least; `raised` tells by how much [m].
inline constexpr int kDepartures = 40;
BlockState<3> draw_departure(const Departure& from, const Surface& surface, const ConvexBlock& block,
                             std::uint64_t seed, std::uint64_t number, double& raised);

/// What effects of the kind release_motion add to the start: speed along the steepest fall of the ground under the block, spin about the horizontal
/// across it. Where the ground is level or ends nothing is added.
void push_release(std::span<const Effect> effects, const Surface& surface, BlockState<3>& state);
void push_release(std::span<const Effect> effects, const Profile& profile, BlockState<2>& state);

}  // namespace scree
