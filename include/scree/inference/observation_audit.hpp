// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/local_frame.hpp"
#include "scree/geometry/surface.hpp"
#include "scree/inference/observation.hpp"

#include <span>
#include <string>
#include <vector>

namespace scree {

/// What is wrong or doubtful in measurements: an error makes a comparison meaningless and stops it, a warning goes into the report.
enum class Severity { Warning, Error };
struct Finding {
    Severity severity = Severity::Warning;
    std::string check;     ///< which one, for machines: "stops_off_terrain"
    std::string sentence;  ///< what, where, the value, what is possible, what to do
};

/// What the measurements are held against.
struct AuditSite {
    const Surface* surface = nullptr;
    std::span<const Screen> screens;   ///< as in the campaign
    std::span<const BlockRow> blocks;  ///< block list of the site, may be empty
    double highest_start =
        kInfinity;  ///< centre of mass of the highest block that the site can release; infinite: not known [m]
    double start_speed = 0.0;           ///< [m/s]
    double gravity = kStandardGravity;  ///< [m/s^2]
    LocalFrame frame;                   ///< of surface and measurements: sentences tell map coordinates
};

/// Distance of a crossing from its screen above which it is reported [m], beside three times its stated error.
inline constexpr double kFarFromScreen = 5.0;
/// Mass over the volume of the box L1 L2 L3: rock of 3000 kg/m^3 that fills nine tenths of it [kg/m^3].
inline constexpr double kHeaviestBox = 2700.0;
/// Below: porous rock that fills a third of its box; farther off, units must be wrong [kg/m^3].
inline constexpr double kLightestBox = 600.0;
inline constexpr double kImpossibleBox[2] = {50.0, 10000.0};
/// Fewer measured blocks than this tell next to nothing [-].
inline constexpr std::size_t kFewBlocks = 10;

/// Looks for what cannot be: stops off the terrain or over a hole in it or above where blocks begin, a datum offset between the heights of the stops and the terrain, passages faster
/// than the fall from the highest start allows (v^2 <= v0^2 + 2 g drop), densities, one block measured twice, blocks that the block list does not
/// know or knows otherwise, crossings far from their screen, blocks that stopped above a screen that they crossed or were not seen at one that they
/// came past, shares above one; and for what makes the comparison weaker: no stated errors, stated errors
/// larger than all scatter, few blocks, broken blocks, stops that are only last sightings.
std::vector<Finding> audit_observations(const Observations& observations, const ObservationOperator& op,
                                        const AuditSite& site);

}  // namespace scree
