// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bench/core_clock.hpp"

#include "cli/site_model.hpp"
#include "scree/dynamics/state.hpp"
#include "scree/geometry/convex_block.hpp"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <memory>

namespace scree::bench {

/// Which ground a scene runs on.
enum class Ground {
    Smooth,  ///< quarry_a as it is: 160 x 80 cells of 1 m
    Rough,   ///< the same with 5 cm of independent noise on every node
    Large,   ///< the same in the middle of 2000 x 2000 cells, its rim drawn out level
};

/// The sample site quarry_a on one of the grounds. Blocks and releases are the same on all.
struct Scene {
    cli::SiteModel site;
    std::unique_ptr<Surface> surface;

    explicit Scene(Ground ground);
    static const Scene& get(Ground ground);

    ConvexBlock block(std::uint64_t number) const;
    BlockState<3> release(const ConvexBlock& block, std::uint64_t number) const;
};

/// Heights and soils of a ground, ready for make_grid_surface.
Grid<double> heights_of(Ground ground, const cli::SiteModel& site);

/// Speed in things per second and, because machines change their clock, in things per 1e9 dependent additions (core_clock.hpp).
void report(benchmark::State& state, std::int64_t things, const WorkMeter& meter);

}  // namespace scree::bench
