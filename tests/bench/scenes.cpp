// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/scenes.hpp"

#include "scree/base/random.hpp"
#include "scree/ensemble/campaign.hpp"

#include <algorithm>
#include <utility>

namespace scree::bench {

namespace {

constexpr double kRoughness = 0.05;  ///< half width of the noise [m]
constexpr int kLargeSide = 2000;     ///< cells of the large ground, west to east and south to north [-]

/// Column or row of the large ground to that of the site: the site lies in its middle, beyond are copies of its rim.
int site_cell(int cell, int count) {
    return std::clamp(cell - (kLargeSide - count) / 2, 0, count - 1);
}

}  // namespace

Grid<double> heights_of(Ground ground, const cli::SiteModel& site) {
    Grid<double> heights = site.terrain.data.grid;
    if (ground == Ground::Rough) {
        RandomStream random(1, 1, RandomPurpose::Effect);
        for (double& z : heights.values) z += random.uniform(-kRoughness, kRoughness);
    }
    if (ground != Ground::Large) return heights;
    GridShape shape = heights.shape;
    shape.origin -= heights.shape.cell * Vec2((kLargeSide - shape.columns) / 2, (kLargeSide - shape.rows) / 2);
    shape.columns = shape.rows = kLargeSide;
    Grid<double> large(shape);
    for (int j = 0; j < kLargeSide; ++j)
        for (int i = 0; i < kLargeSide; ++i)
            large.at(i, j) = heights.at(site_cell(i, heights.shape.columns), site_cell(j, heights.shape.rows));
    return large;
}

Scene::Scene(Ground ground)
    : site(cli::load_site(cli::read_site_file(SCREE_SOURCE_DIR "/sample_sites/quarry_a/site.toml", {}))) {
    Grid<double> heights = heights_of(ground, site);
    const GridShape &shape = heights.shape, &old = site.terrain.data.grid.shape;
    std::vector<SoilId> soils(grid_facet_count(shape), 0);
    for (std::size_t f = 0; f < soils.size(); ++f) {
        const auto cell = static_cast<int>(f / 2);
        int i = cell % (shape.columns - 1), j = cell / (shape.columns - 1);
        if (ground == Ground::Large) {
            i = std::min(site_cell(i, old.columns), old.columns - 2);
            j = std::min(site_cell(j, old.rows), old.rows - 2);
        }
        std::array<Vec3, 3> corners;
        site.terrain.surface->facet(
            2 * (static_cast<std::int64_t>(j) * (old.columns - 1) + i) + static_cast<std::int64_t>(f % 2), corners,
            soils[f]);
    }
    surface = make_grid_surface(std::move(heights), std::move(soils));
    site.campaign.surface = surface.get();
    site.campaign.threads = 1;
    site.campaign.kept_trajectories = 0;
}

const Scene& Scene::get(Ground ground) {
    static const Scene smooth(Ground::Smooth), rough(Ground::Rough);
    if (ground != Ground::Large) return ground == Ground::Rough ? rough : smooth;
    static const Scene large(Ground::Large);  // only where it is asked for: it takes a second
    return large;
}

ConvexBlock Scene::block(std::uint64_t number) const {
    return draw_block(site.campaign.population, site.campaign.seed, number).body;
}

BlockState<3> Scene::release(const ConvexBlock& block, std::uint64_t number) const {
    std::int64_t feature = 0;
    double raised = 0.0;
    return draw_release(site.campaign.release, *site.area, *surface, block, site.campaign.seed, number, feature,
                        raised);
}

void report(benchmark::State& state, std::int64_t things, const WorkMeter& meter) {
    state.SetItemsProcessed(things);
    state.counters["per_1e9_additions"] = 1e9 * static_cast<double>(things) / meter.additions();
    state.counters["additions_per_s"] = meter.additions() / meter.seconds();
}

}  // namespace scree::bench
