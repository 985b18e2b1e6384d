// SPDX-License-Identifier: GPL-3.0-or-later
// How fast the engine is, on one core, on the sample site quarry_a: smooth as it is, and rough with independent noise on every node of the terrain.
// Times of different runs do not compare, processors are shared and change their clock: compare rows of one run.
#include "dynamics/contact_step.hpp"
#include "dynamics/hull_contacts.hpp"

#include "cli/site_model.hpp"
#include "scree/base/random.hpp"
#include "scree/ensemble/campaign.hpp"

#include <benchmark/benchmark.h>

#include <atomic>

namespace scree::bench {

namespace {

constexpr double kRoughness = 0.05;    ///< half width of the noise [m]
constexpr std::int64_t kBlocks = 200;  ///< of a campaign [-]

/// The sample site, with the surface that the benchmarks use.
struct Scene {
    cli::SiteModel site;
    std::unique_ptr<Surface> surface;

    explicit Scene(bool rough)
        : site(cli::load_site(cli::read_site_file(SCREE_SOURCE_DIR "/sample_sites/quarry_a/site.toml", {}))) {
        Grid<double> heights = site.terrain.data.grid;
        std::vector<SoilId> soils(grid_facet_count(heights.shape), 0);
        for (std::size_t f = 0; f < soils.size(); ++f) {
            std::array<Vec3, 3> corners;
            site.terrain.surface->facet(static_cast<std::int64_t>(f), corners, soils[f]);
        }
        RandomStream random(1, 1, RandomPurpose::Effect);
        for (double& z : heights.values) z += rough ? random.uniform(-kRoughness, kRoughness) : 0.0;
        surface = make_grid_surface(std::move(heights), std::move(soils));
        site.campaign.surface = surface.get();
        site.campaign.threads = 1;
        site.campaign.release.count = kBlocks;
        site.campaign.kept_trajectories = 0;
    }

    static const Scene& get(bool rough) {
        static const Scene smooth_scene(false), rough_scene(true);
        return rough ? rough_scene : smooth_scene;
    }
    ConvexBlock block(std::uint64_t number) const {
        return draw_block(site.campaign.population, site.campaign.seed, number).body;
    }
    BlockState<3> release(const ConvexBlock& block, std::uint64_t number) const {
        std::int64_t feature = 0;
        double raised = 0.0;
        return draw_release(site.campaign.release, *site.area, *surface, block, site.campaign.seed, number, feature,
                            raised);
    }
};

/// Arguments: rough, mode, threads. Blocks per second as items; what one block costs in steps beside it.
void campaign(benchmark::State& state) {
    CampaignInput input = Scene::get(state.range(0) != 0).site.campaign;
    input.dynamics.mode = state.range(1) == 0 ? SteppingMode::Event : SteppingMode::MoreauJean;
    if (input.dynamics.mode == SteppingMode::MoreauJean) input.dynamics.time_step = 1e-3;
    input.threads = static_cast<int>(state.range(2));
    TrajectoryCounters counters;
    const std::atomic<bool> stop{false};
    std::int64_t blocks = 0;
    for (auto _ : state) {
        const CampaignResult result = run_campaign(input, {}, stop);
        counters.merge(result.counters);
        blocks += result.released;
    }
    const auto per_block = [&](std::int64_t count) { return static_cast<double>(count) / static_cast<double>(blocks); };
    state.SetItemsProcessed(blocks);
    state.counters["contact_steps"] = per_block(counters.contact_steps);
    state.counters["impacts"] = per_block(counters.impacts);
    state.counters["flight_looks"] = per_block(counters.flight_evaluations);
}
BENCHMARK(campaign)
    ->ArgNames({"rough", "moreau_jean", "threads"})
    ->Args({0, 0, 1})
    ->Args({1, 0, 1})
    ->Args({0, 0, 2})
    ->Args({1, 0, 2})
    ->Args({1, 1, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// Drawing a block from the list and building its hull.
void hull(benchmark::State& state) {
    const Scene& scene = Scene::get(false);
    std::uint64_t number = 0;
    for (auto _ : state) benchmark::DoNotOptimize(scene.block(number++));
}
BENCHMARK(hull)->Unit(benchmark::kMicrosecond);

/// Looks along a flight over the slope: what one flight evaluation costs. Argument: rough.
void flight_look(benchmark::State& state) {
    const Scene& scene = Scene::get(state.range(0) != 0);
    const ConvexBlock block = scene.block(7);
    HullContacts finder(block, *scene.surface, false);
    const BlockState<3> release = scene.release(block, 7);
    double t = 0.0;
    for (auto _ : state) {
        t = t < 0.2 ? t + 1e-3 : 0.0;
        BlockState<3> s = release;
        s.position += Vec3(8.0 * t, 0.0, -4.0 + 0.5 * block.radius - 5.0 * t);
        s.velocity = {8.0, 0.0, -5.0};
        s.spin = {0.0, 10.0, 1.0};
        double gap = 0.0;
        benchmark::DoNotOptimize(finder.free_time(s, 12.0, 9.81, gap));
    }
}
BENCHMARK(flight_look)->ArgName("rough")->Arg(0)->Arg(1)->Unit(benchmark::kNanosecond);

/// One step in contact without detection: Delassus operator, solver, velocities. Argument: number of contacts.
void contact_step(benchmark::State& state) {
    const Scene& scene = Scene::get(false);
    const ConvexBlock block = scene.block(7);
    std::vector<Soil> soils = scene.site.campaign.soils;
    ContactStep<3> step({block.mass, block.inertia}, soils, {});
    std::vector<Contact<3>> contacts;
    for (int c = 0; c < state.range(0); ++c) {
        Contact<3> contact;
        contact.gap = 0.0;
        contact.normal = Vec3(0.5, 0.0, 1.0).normalized();
        contact.arm = block.vertex(c * 5 % block.vertex_count());
        contact.arm.z() = -block.inner_radius;
        contact.key.block = c;
        contacts.push_back(contact);
    }
    BlockState<3> start;
    start.velocity = {3.0, 0.2, -1.6};
    start.spin = {1.0, 6.0, 2.0};
    for (auto _ : state) {
        BlockState<3> s = start;
        step.set_contacts(contacts, Mat3::Identity());
        benchmark::DoNotOptimize(step.solve(4e-3, {0.0, 0.0, -9.81}, {}, s));
    }
}
BENCHMARK(contact_step)->ArgName("contacts")->DenseRange(1, 4)->Unit(benchmark::kNanosecond);

}  // namespace

}  // namespace scree::bench
