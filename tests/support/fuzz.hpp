// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/trajectory.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/surface.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scree::test {

/// One random block over one random terrain, made from a number: rough planes, ridges, gullies, cliffs of 85 degrees, pure noise and holes with cells
/// from 0.2 m to 10 m, two soils scattered over the facets; hulls, boxes, plates 10:5:1 and needles 10:1:1 from 1 cm to 10 m, up to 60 m/s.
struct FuzzScene {
    std::string what;  ///< for messages
    std::unique_ptr<Surface> surface;
    std::vector<Soil> soils;
    ConvexBlock block;
    BlockState<3> release;
};
FuzzScene fuzz_scene(std::uint64_t number);

/// How the block of a scene fared.
template <int Dim>
struct FuzzOutcome {
    TrajectoryEnd<Dim> end;
    double deepest_centre = 0.0;    ///< how far the centre of mass was below the terrain, vertically [m]
    double rest_penetration = 0.0;  ///< deepest overlap where it came to rest [m]
    std::string fault;              ///< what must not be; empty if nothing
};
FuzzOutcome<3> fuzz_block(const FuzzScene& scene, const DynamicsSettings& settings,
                          std::span<const Effect> effects = {});

/// Settings of the fuzz: the defaults, with an end after 30 s.
DynamicsSettings fuzz_settings();

}  // namespace scree::test
