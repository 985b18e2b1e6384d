// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/effects.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/convex_polygon.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace scree {

/// One measured block: a row of the block list.
struct BlockRow {
    std::string id;
    double mass = 0.0;                    ///< [kg]
    Vec3 size = Vec3::Zero();             ///< L1 >= L2 >= L3, edges of the smallest box around it [m]
    Vec2 release = Vec2::Constant(kNaN);  ///< where it is let go, plan view; NaN: anywhere in the release area [m]
    std::int32_t profile = -1;  ///< in 2D: the profile on which it is let go; -1: anywhere in the release area
    double s = kNaN;            ///< in 2D: chainage along that profile [m]
};

/// How volumes are spread when there is no block list.
enum class VolumeLaw { Constant, Uniform, LogUniform, LogNormal, PowerLaw };
inline constexpr std::array<const char*, 5> kVolumeLawNames{"constant", "uniform", "log_uniform", "log_normal",
                                                            "power_law"};

/// Blocks drawn from distributions. The volume is that of the block itself, not of its box.
struct BlockDistribution {
    VolumeLaw law = VolumeLaw::Constant;
    double volume = 1.0;  ///< constant: the volume; log_normal: the median [m^3]
    double volume_min =
        0.1;  ///< uniform, log_uniform, power_law: smallest; log_normal: smaller ones are drawn again [m^3]
    double volume_max = 10.0;                  ///< likewise largest [m^3]
    double sigma = 0.5;                        ///< log_normal: standard deviation of ln(volume) [-]
    double exponent = 1.0;                     ///< power_law: N(volume > v) ~ v^-exponent, cut at both ends [-]
    double density = 2600.0;                   ///< of the rock [kg/m^3]
    double density_spread = 0.0;               ///< half width of a uniform spread around it [kg/m^3]
    std::array<double, 2> ratio_21{0.8, 0.8};  ///< L2 / L1, uniform between the two [-]
    std::array<double, 2> ratio_32{0.8, 0.8};  ///< L3 / L2, uniform between the two [-]
};

/// Where the blocks of a campaign come from.
struct BlockPopulation {
    std::vector<BlockRow> list;      ///< if not empty, blocks are rows of it
    bool in_turn = false;            ///< block i is row i mod n; else each block draws a row at random
    BlockDistribution distribution;  ///< used if the list is empty
    ShapeSettings shape;
    double filling =
        0.5;  ///< 2D without a list: share of its box that a block fills, from mean_filling(); smaller makes larger polygons [-]
};

/// The population as effects of the kind block_shape make it: other corners, other ratios of the edges at the same volume. Throws InputError where the shape
/// has no free number of corners.
BlockPopulation reshaped(const BlockPopulation& population, std::span<const Effect> effects);

/// A block of the campaign with the row that it came from.
struct PopulationBlock {
    ConvexBlock body;
    std::int64_t row = -1;  ///< row of the list, -1 if drawn from the distributions [-]
};

/// Block number `block` of the campaign: depends on the population, the seed and the number only.
PopulationBlock draw_block(const BlockPopulation& population, std::uint64_t seed, std::uint64_t block);

/// The same in 2D: the polygon with the mass and the L1, L2 of the whole block.
struct PopulationPolygon {
    ConvexPolygon body;
    std::int64_t row = -1;  ///< row of the list, -1 if drawn from the distributions [-]
};
PopulationPolygon draw_polygon(const BlockPopulation& population, std::uint64_t seed, std::uint64_t block);

/// Share of its box L1 x L2 x L3 that a 3D body of this shape fills, the mean of some: with it a volume gives the same L1, L2, L3 in 2D as, in the
/// mean, in 3D [-].
double mean_filling(const ShapeSettings& shape);

}  // namespace scree
