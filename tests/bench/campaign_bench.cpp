// SPDX-License-Identifier: GPL-3.0-or-later
// Whole campaigns on the sample site, what the size of the terrain costs, and memory.
#include "bench/scenes.hpp"

#include "gis/raster_writer.hpp"
#include "scree/base/random.hpp"
#include "scree/ensemble/campaign.hpp"
#include "support/block_set.hpp"
#include "support/paths.hpp"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <filesystem>

namespace scree::bench {

namespace {

constexpr std::int64_t kBlocks = 200;  ///< of a campaign [-]

/// Event mode at the default step.
CampaignInput campaign_input(Ground ground) {
    CampaignInput input = Scene::get(ground).site.campaign;
    input.release.count = kBlocks;
    return input;
}

/// What blocks cost in steps, beside their time.
void report_blocks(benchmark::State& state, std::int64_t blocks, const TrajectoryCounters& counters,
                   const WorkMeter& meter) {
    report(state, blocks, meter);
    const auto per_block = [&](std::int64_t count) { return static_cast<double>(count) / static_cast<double>(blocks); };
    state.counters["contact_steps"] = per_block(counters.contact_steps);
    state.counters["impacts"] = per_block(counters.impacts);
    state.counters["flight_looks"] = per_block(counters.flight_evaluations);
}

void run_campaigns(benchmark::State& state, const CampaignInput& input, WorkMeter::Time time) {
    TrajectoryCounters counters;
    const std::atomic<bool> stop{false};
    std::int64_t blocks = 0;
    WorkMeter meter(time);
    for (auto _ : state) {
        meter.measure([&] {
            const CampaignResult result = run_campaign(input, {}, stop);
            counters.merge(result.counters);
            blocks += result.released;
        });
    }
    report_blocks(state, blocks, counters, meter);
}

/// Mode and step from the arguments: moreau_jean, step in ms. Event mode runs at its default step and at the longest one whose statistics are the same.
void set_stepping(const benchmark::State& state, DynamicsSettings& dynamics) {
    dynamics.mode = state.range(1) != 0 ? SteppingMode::MoreauJean : SteppingMode::Event;
    dynamics.time_step = 1e-3 * static_cast<double>(state.range(2));
}
void add_stepping(benchmark::internal::Benchmark* b) {
    b->ArgNames({"rough", "moreau_jean", "step_ms"})
        ->ArgsProduct({{0, 1}, {0}, {8, 16}})
        ->ArgsProduct({{0, 1}, {1}, {1}})
        ->Unit(benchmark::kMillisecond);
}

/// One thread, CPU time. First argument: rough.
void campaign(benchmark::State& state) {
    CampaignInput input = campaign_input(state.range(0) != 0 ? Ground::Rough : Ground::Smooth);
    set_stepping(state, input.dynamics);
    run_campaigns(state, input, WorkMeter::Time::Cpu);
}
BENCHMARK(campaign)->Apply(add_stepping);

/// The engine alone, no hulls built and no maps recorded: the 30 blocks of 49 vertices of the reference path_a on its slope.
void path_a(benchmark::State& state) {
    constexpr std::int64_t kCopies = 7;
    const auto blocks = test::read_blocks(test::shared_data("reference/path_a_blocks"));
    const auto surface =
        test::read_node_grid(test::shared_data("reference/path_a.asc"), state.range(0) != 0 ? 0.05 : 0.0);
    Soil soil;
    soil.restitution = 0.0;
    soil.friction = 0.6;
    soil.rolling = 0.05;
    DynamicsSettings dynamics;
    set_stepping(state, dynamics);
    TrajectoryCounters counters;
    std::int64_t thrown = 0;
    WorkMeter meter(WorkMeter::Time::Cpu);
    for (auto _ : state) {
        meter.measure([&] {
            for (std::size_t b = 0; b < blocks.size(); ++b)
                for (std::int64_t copy = 0; copy < kCopies; ++copy, ++thrown)
                    counters.merge(
                        test::throw_block(test::copy_of(blocks[b], b, copy), *surface, {soil}, dynamics, {}).counters);
        });
    }
    report_blocks(state, thrown, counters, meter);
}
[[maybe_unused]] const auto* path_a_where_present = [] {
    auto* b =
        test::shared_data("reference/path_a_blocks").empty() ? nullptr : benchmark::RegisterBenchmark("path_a", path_a);
    if (b) add_stepping(b);
    return b;
}();

/// Campaigns in 2D, on the site's profile, as it is or with 5 cm of noise on every vertex.
CampaignInput plane_input(bool rough, bool moreau_jean) {
    static const cli::SiteModel site =
        cli::load_site(cli::read_site_file(SCREE_SOURCE_DIR "/sample_sites/quarry_a/site.toml", {"model.dimension=2"}));
    CampaignInput input = site.campaign;
    input.threads = 1;
    input.kept_trajectories = 0;
    input.release.count = 5 * kBlocks;
    input.dynamics.mode = moreau_jean ? SteppingMode::MoreauJean : SteppingMode::Event;
    if (moreau_jean) input.dynamics.time_step = 1e-3;
    RandomStream random(1, 1, RandomPurpose::Effect);
    if (rough)
        for (double& z : input.tracks.front().profile.z) z += random.uniform(-0.05, 0.05);
    return input;
}
void campaign_plane(benchmark::State& state) {
    run_campaigns(state, plane_input(state.range(0) != 0, state.range(1) != 0), WorkMeter::Time::Cpu);
}
BENCHMARK(campaign_plane)
    ->ArgNames({"rough", "moreau_jean"})
    ->Args({0, 0})
    ->Args({1, 0})
    ->Args({0, 1})
    ->Args({1, 1})
    ->Unit(benchmark::kMillisecond);

/// What more threads bring: real time, so leave the machine alone meanwhile. Argument: threads.
void campaign_threads(benchmark::State& state) {
    CampaignInput input = campaign_input(Ground::Rough);
    input.threads = static_cast<int>(state.range(0));
    run_campaigns(state, input, WorkMeter::Time::Real);
}
BENCHMARK(campaign_threads)->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// The same blocks on the same slope, alone and in the middle of a large terrain. Argument: cells on a side of it, 0 for the site's own 160 x 80.
void campaign_terrain(benchmark::State& state) {
    run_campaigns(state, campaign_input(state.range(0) != 0 ? Ground::Large : Ground::Smooth), WorkMeter::Time::Cpu);
}
BENCHMARK(campaign_terrain)->ArgName("cells")->Arg(0)->Arg(2000)->Unit(benchmark::kMillisecond);

/// Heap in use by this process [B].
double heap_bytes() {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
}

/// From heights in memory to a surface of 2000 x 2000 cells; what it keeps in memory.
void surface_build(benchmark::State& state) {
    const cli::SiteModel& site = Scene::get(Ground::Large).site;
    const Grid<double> heights = heights_of(Ground::Large, site);
    const auto cells = static_cast<std::int64_t>(heights.shape.size());
    std::int64_t built = 0;
    double bytes = 0.0;
    WorkMeter meter;
    for (auto _ : state) {
        const double before = heap_bytes();
        std::unique_ptr<Surface> surface;
        meter.measure(
            [&] { surface = make_grid_surface(heights, std::vector<SoilId>(grid_facet_count(heights.shape), 0)); });
        bytes = heap_bytes() - before;
        built += cells;
    }
    report(state, built, meter);
    state.counters["bytes_per_cell"] = bytes / static_cast<double>(cells);
}
BENCHMARK(surface_build)->Unit(benchmark::kMillisecond);

/// What a user waits for before the first block of a site of 2000 x 2000 cells: the DTM from its file, soil zones, the surface.
void terrain_read(benchmark::State& state) {
    namespace fs = std::filesystem;
    const cli::SiteModel& site = Scene::get(Ground::Large).site;
    const Grid<double> heights = heights_of(Ground::Large, site);
    gis::RasterLayer layer;
    layer.name = "dtm_m";
    layer.unit = "m";
    layer.values = Grid<float>(heights.shape);
    std::transform(heights.values.begin(), heights.values.end(), layer.values.values.begin(),
                   [](double z) { return static_cast<float>(z); });
    std::string name = (fs::temp_directory_path() / "scree_bench_XXXXXX").string();
    const fs::path folder = ::mkdtemp(name.data());
    gis::write_geotiff(folder / "dtm_m.tif", site.terrain.data.frame, layer);
    const cli::SiteFile file = cli::read_site_file(SCREE_SOURCE_DIR "/sample_sites/quarry_a/site.toml",
                                                   {std::string("terrain.dtm=").append(folder / "dtm_m.tif")});
    std::int64_t cells = 0;
    WorkMeter meter;
    for (auto _ : state) {
        meter.measure([&] {
            const cli::SiteTerrain terrain = cli::load_terrain(file);
            cells += static_cast<std::int64_t>(terrain.data.grid.shape.size());
        });
    }
    report(state, cells, meter);
    fs::remove_all(folder);
}
BENCHMARK(terrain_read)->Unit(benchmark::kMillisecond);

/// Watches the heap while a block is on its way.
class HeapWatch final : public MotionSink<3> {
public:
    explicit HeapWatch(double before) : before_(before) {}
    void segment(const MotionSegment<3>&) override { largest = std::max(largest, heap_bytes() - before_); }
    double largest = 0.0;  ///< above what was in use before [B]

private:
    double before_;
};

/// Memory of one block in flight: hull, terrain around it, room of the solver; on the heap, the largest of 100 blocks. The time means nothing.
void block_memory(benchmark::State& state) {
    const Scene& scene = Scene::get(Ground::Rough);
    double largest = 0.0, sum = 0.0;
    constexpr std::uint64_t kWatched = 100;
    for (auto _ : state) {
        for (std::uint64_t number = 0; number < kWatched; ++number) {
            const double before = heap_bytes();
            const ConvexBlock block = scene.block(number);
            HeapWatch watch(before);
            simulate_block(block, scene.release(block, number), *scene.surface, scene.site.campaign.soils, {}, &watch);
            largest = std::max(largest, watch.largest);
            sum += watch.largest / kWatched;
        }
    }
    state.counters["bytes_per_block"] = largest;
    state.counters["bytes_per_block_mean"] = sum;
}
BENCHMARK(block_memory)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace

}  // namespace scree::bench
