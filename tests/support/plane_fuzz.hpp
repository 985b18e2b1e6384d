// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/trajectory.hpp"
#include "scree/geometry/convex_polygon.hpp"
#include "scree/geometry/ground_line.hpp"
#include "support/fuzz.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace scree::test {

/// One random polygon over one random polyline, made from a number: rough slopes, benches with cliffs of 85 to 89.9 degrees, gullies, spikes, pure noise, and
/// reaches from a thousandth of the block to twenty times its size (spikes no narrower than the block: a step in contact may pass a needle); hulls, boxes, plates 10:1, triangles and ellipses from 1 cm to 10 m, up to 60 m/s.
struct PlaneFuzzScene {
    std::string what;  ///< for messages
    GroundLine ground;
    std::vector<Soil> soils;
    ConvexPolygon block;
    BlockState<2> release;
};
PlaneFuzzScene plane_fuzz_scene(std::uint64_t number);
FuzzOutcome<2> plane_fuzz_block(const PlaneFuzzScene& scene, const DynamicsSettings& settings,
                                std::span<const Effect> effects = {});

}  // namespace scree::test
