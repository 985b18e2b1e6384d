// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/campaign.hpp"

#include "ensemble/path_recorder.hpp"

#include "scree/base/assert.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>
#include <thread>
#include <tuple>

namespace scree {

namespace {

/// What one thread collects. Merging is order-free: integer sums, maxima, and lists that are sorted by block afterwards.
struct Partial {
    CellMap cells;
    std::vector<ScreenCrossing> crossings;
    std::vector<KeptTrajectory> trajectories;
    std::vector<std::int64_t> deposits;
    TrajectoryCounters counters;
    std::vector<HardProblem> hard_problems;
};

void run_block(const CampaignInput& input, std::int64_t number, BlockResult& result, Partial& partial) {
    const auto key = static_cast<std::uint64_t>(number);
    const PopulationBlock block = draw_block(input.population, input.seed, key);
    const Vec2 fixed =
        block.row < 0 ? Vec2::Constant(kNaN) : input.population.list[static_cast<std::size_t>(block.row)].release;
    const BlockState<3> release = draw_release(input.release, *input.area, *input.surface, block.body, input.seed, key,
                                               result.feature, result.raised, fixed);
    result.row = block.row;
    result.mass = block.body.mass;
    result.size = block.body.size;
    result.release = release.position;

    PathRecorder recorder(input, number, block.body.mass, result);
    const TrajectoryEnd<3> end =
        simulate_block(block.body, release, *input.surface, input.soils, input.dynamics, &recorder);
    recorder.finish();
    result.reason = end.reason;
    result.stop = end.state.position;
    result.time = end.time;
    partial.counters.merge(end.counters);
    for (const ContactProblem<3>& problem : end.hard_problems) partial.hard_problems.push_back({number, problem});
    if (end.reason == StopReason::Failed) {  // its path is not to be trusted: it counts as failed and nowhere else
        result.done = true;
        return;
    }

    for (const auto& [cell, values] : recorder.cells()) partial.cells[cell].add_passage(values);
    if (end.reason == StopReason::AtRest) {
        const int column = input.result_cells.column_of(result.stop.x()),
                  row = input.result_cells.row_of(result.stop.y());
        if (input.result_cells.contains(column, row)) ++partial.cells[input.result_cells.index(column, row)].deposits;
        partial.deposits.resize(input.deposit_zones.size(), 0);
        for (std::size_t z = 0; z < input.deposit_zones.size(); ++z)
            if (input.deposit_zones[z].region.contains(result.stop.head<2>())) ++partial.deposits[z];
    }
    partial.crossings.insert(partial.crossings.end(), recorder.crossings().begin(), recorder.crossings().end());
    if (number < input.kept_trajectories) partial.trajectories.push_back(recorder.take_line());
    result.done = true;
}

void collect(const CampaignInput& input, tbb::enumerable_thread_specific<Partial>& partials, CampaignResult& result) {
    for (const DepositZone& zone : input.deposit_zones) result.deposits.push_back({zone.name, 0});
    for (Partial& partial : partials) {
        merge_cells(result.cells, partial.cells);
        result.crossings.insert(result.crossings.end(), partial.crossings.begin(), partial.crossings.end());
        std::move(partial.trajectories.begin(), partial.trajectories.end(), std::back_inserter(result.trajectories));
        for (std::size_t z = 0; z < partial.deposits.size(); ++z) result.deposits[z].count += partial.deposits[z];
        result.counters.merge(partial.counters);
        std::move(partial.hard_problems.begin(), partial.hard_problems.end(), std::back_inserter(result.hard_problems));
    }
    std::sort(result.crossings.begin(), result.crossings.end(), [](const ScreenCrossing& a, const ScreenCrossing& b) {
        return std::tie(a.block, a.screen) < std::tie(b.block, b.screen);
    });
    std::sort(result.trajectories.begin(), result.trajectories.end(),
              [](const auto& a, const auto& b) { return a.block < b.block; });
    std::stable_sort(result.hard_problems.begin(), result.hard_problems.end(),
                     [](const HardProblem& a, const HardProblem& b) { return a.block < b.block; });
    for (const BlockResult& b : result.blocks) {
        if (!b.done) continue;
        ++result.released;
        ++result.reasons[static_cast<std::size_t>(b.reason)];
    }
}

}  // namespace

CampaignResult run_campaign(const CampaignInput& input, const CampaignProgress& progress,
                            const std::atomic<bool>& stop) {
    SCREE_ASSERT(input.surface && input.area);
    CampaignResult result;
    result.blocks.resize(static_cast<std::size_t>(input.release.count));
    const int threads =
        input.threads > 0 ? input.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::enumerable_thread_specific<Partial> partials;
    std::atomic<std::int64_t> done{0};
    std::mutex progress_mutex;
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, input.release.count, 1),
                      [&](const tbb::blocked_range<std::int64_t>& range) {
                          Partial& partial = partials.local();
                          for (std::int64_t i = range.begin(); i < range.end(); ++i) {
                              if (stop.load(std::memory_order_relaxed)) return;
                              run_block(input, i, result.blocks[static_cast<std::size_t>(i)], partial);
                              ++done;
                              if (progress && progress_mutex.try_lock()) {
                                  const std::lock_guard<std::mutex> lock(progress_mutex, std::adopt_lock);
                                  progress(done.load());
                              }
                          }
                      });
    collect(input, partials, result);
    result.interrupted = result.released < input.release.count;
    return result;
}

}  // namespace scree
