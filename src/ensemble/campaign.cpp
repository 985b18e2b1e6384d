// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/campaign.hpp"

#include "ensemble/path_recorder.hpp"

#include "scree/base/assert.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <tuple>

namespace scree {

namespace {

/// What one thread collects. Merging is order-free: integer sums, maxima, and lists that are sorted by block afterwards.
struct Partial {
    std::vector<CellMap> cells;  ///< one for the map, or one per profile
    std::vector<ScreenCrossing> crossings;
    std::vector<FilmedImpact> impacts;
    std::vector<KeptTrajectory> trajectories;
    std::vector<std::int64_t> deposits;
    TrajectoryCounters counters;
    std::vector<HardProblem> hard_problems;
};

/// What is the same for all blocks, made once.
struct Prepared {
    BlockPopulation population;                ///< as effects change it
    std::vector<GroundLine> grounds;           ///< of the tracks
    std::vector<std::vector<Effect>> effects;  ///< along each of them

    explicit Prepared(const CampaignInput& input) : population(reshaped(input.population, input.effects)) {
        for (const Effect& effect : input.effects) check_effect(effect, input.dynamics.mode == SteppingMode::Event);
        for (const ProfileTrack& track : input.tracks) {
            grounds.emplace_back(track.profile);
            effects.push_back(effects_along(input.effects, track.profile));
        }
    }
};

/// What the end of a block adds, whatever it moved in. `cells` is where its cells count, `stop_cell` the one in which it ended, if any.
template <int Dim>
void settle(const CampaignInput& input, std::int64_t number, const TrajectoryEnd<Dim>& end, PathRecorder<Dim>& recorder,
            std::size_t map, std::optional<std::size_t> stop_cell, BlockResult& result, Partial& partial) {
    recorder.finish();
    result.reason = end.reason;
    result.time = end.time;
    result.mass_left = end.mass;
    result.done = true;
    partial.counters.merge(end.counters);
    for (const ContactProblem<Dim>& problem : end.hard_problems) partial.hard_problems.push_back({number, problem});
    if (end.reason == StopReason::Failed)
        return;  // its path is not to be trusted: it counts as failed and nowhere else

    if (partial.cells.size() <= map) partial.cells.resize(map + 1);
    CellMap& cells = partial.cells[map];
    for (const auto& [cell, values] : recorder.cells()) cells[cell].add_passage(values);
    if (end.reason == StopReason::AtRest) {
        if (stop_cell) ++cells[*stop_cell].deposits;
        partial.deposits.resize(input.deposit_zones.size(), 0);
        for (std::size_t z = 0; z < input.deposit_zones.size(); ++z)
            if (input.deposit_zones[z].region.contains(result.stop.head<2>())) ++partial.deposits[z];
    }
    partial.crossings.insert(partial.crossings.end(), recorder.crossings().begin(), recorder.crossings().end());
    partial.impacts.insert(partial.impacts.end(), recorder.impacts().begin(), recorder.impacts().end());
    if (number < input.kept_trajectories) partial.trajectories.push_back(recorder.take_line());
}

const Departure* departure_of(const CampaignInput& input, std::int64_t number) {
    return input.departures.empty() ? nullptr : &input.departures[static_cast<std::size_t>(number)];
}

void run_block_in_space(const CampaignInput& input, const Prepared& prepared, std::int64_t number, BlockResult& result,
                        Partial& partial) {
    const auto key = static_cast<std::uint64_t>(number);
    const PopulationBlock block = draw_block(prepared.population, input.seed, key);
    const Vec2 fixed =
        block.row < 0 ? Vec2::Constant(kNaN) : input.population.list[static_cast<std::size_t>(block.row)].release;
    BlockState<3> release;
    if (const Departure* from = departure_of(input, number)) {
        release = draw_departure(*from, *input.surface, block.body, input.seed, key, result.raised);
    } else {
        release = draw_release(input.release, *input.area, *input.surface, block.body, input.seed, key, result.feature,
                               result.raised, fixed);
        push_release(input.effects, *input.surface, release);
    }
    result.row = block.row;
    result.mass = block.body.mass;
    result.size = block.body.size;
    result.release = release.position;

    MapRecorder recorder(input, number, result);
    const TrajectoryEnd<3> end = simulate_block(block.body, release, *input.surface, input.soils, input.dynamics,
                                                &recorder, {input.effects, input.seed, key});
    result.stop = end.state.position;
    result.broke_at = end.broke_at;
    const GridShape& grid = input.result_cells;
    const int column = grid.column_of(result.stop.x()), row = grid.row_of(result.stop.y());
    const auto cell = grid.contains(column, row) ? std::optional(grid.index(column, row)) : std::nullopt;
    settle(input, number, end, recorder, 0, cell, result, partial);
}

/// Where a block starts: seen on its way, let go at a known place, or anywhere in the release area.
ProfileRelease::Place place_of(const CampaignInput& input, std::int64_t number, std::int64_t row) {
    if (const Departure* from = departure_of(input, number))
        return {static_cast<std::size_t>(from->profile), from->s, kNoFeature};
    if (row >= 0) {
        const BlockRow& known = input.population.list[static_cast<std::size_t>(row)];
        if (known.profile >= 0) return {static_cast<std::size_t>(known.profile), known.s, kNoFeature};
    }
    return input.profile_release->draw(input.seed, static_cast<std::uint64_t>(number));
}

void run_block_on_profile(const CampaignInput& input, const Prepared& prepared, std::int64_t number,
                          BlockResult& result, Partial& partial) {
    const auto key = static_cast<std::uint64_t>(number);
    const PopulationPolygon block = draw_polygon(prepared.population, input.seed, key);
    const Departure* from = departure_of(input, number);
    const ProfileRelease::Place place = place_of(input, number, block.row);
    const ProfileTrack& track = input.tracks[place.profile];
    const GroundLine& ground = prepared.grounds[place.profile];
    const std::vector<Effect>& effects = prepared.effects[place.profile];
    BlockState<2> release;
    if (from) {
        release = draw_departure(*from, ground, block.body, input.seed, key, result.raised);
    } else {
        release = draw_release(input.release, place.s, ground, block.body, input.seed, key, result.raised);
        push_release(effects, track.profile, release);
    }
    auto on_map = [&](const Vec2& p) -> Vec3 {
        const Vec2 plan = track.profile.place_at(p.x());
        return {plan.x(), plan.y(), p.y()};
    };
    result.row = block.row;
    result.mass = block.body.mass;
    result.size = block.body.size;
    result.feature = place.feature;
    result.profile = static_cast<std::int32_t>(place.profile);
    result.release_s = place.s;
    result.release = on_map(release.position);

    ProfileRecorder recorder(input, track, ground, number, result);
    const TrajectoryEnd<2> end =
        simulate_block(block.body, release, ground, input.soils, input.dynamics, &recorder, {effects, input.seed, key});
    result.stop = on_map(end.state.position);
    if (std::isfinite(end.broke_at.x())) result.broke_at = on_map(end.broke_at);
    result.stop_s = end.state.position.x();
    const auto cell = static_cast<std::size_t>(std::max(0.0, result.stop_s / input.cell_along));
    settle(input, number, end, recorder, place.profile,
           std::optional(std::min(cell, cells_along(track.profile, input.cell_along) - 1)), result, partial);
}

bool is_thrown(const CampaignInput& input, std::int64_t number) {
    return input.thrown.empty() || input.thrown[static_cast<std::size_t>(number)];
}

std::int64_t number_thrown(const CampaignInput& input) {
    return input.thrown.empty() ? input.release.count : std::count(input.thrown.begin(), input.thrown.end(), true);
}

void collect(const CampaignInput& input, tbb::enumerable_thread_specific<Partial>& partials, CampaignResult& result) {
    for (const DepositZone& zone : input.deposit_zones) result.deposits.push_back({zone.name, 0});
    result.cells_along.resize(input.tracks.size());
    for (Partial& partial : partials) {
        for (std::size_t k = 0; k < partial.cells.size(); ++k)
            merge_cells(input.tracks.empty() ? result.cells : result.cells_along[k], partial.cells[k]);
        result.crossings.insert(result.crossings.end(), partial.crossings.begin(), partial.crossings.end());
        result.impacts.insert(result.impacts.end(), partial.impacts.begin(), partial.impacts.end());
        std::move(partial.trajectories.begin(), partial.trajectories.end(), std::back_inserter(result.trajectories));
        for (std::size_t z = 0; z < partial.deposits.size(); ++z) result.deposits[z].count += partial.deposits[z];
        result.counters.merge(partial.counters);
        std::move(partial.hard_problems.begin(), partial.hard_problems.end(), std::back_inserter(result.hard_problems));
    }
    std::sort(result.crossings.begin(), result.crossings.end(), [](const ScreenCrossing& a, const ScreenCrossing& b) {
        return std::tie(a.block, a.screen) < std::tie(b.block, b.screen);
    });
    std::sort(result.impacts.begin(), result.impacts.end(), [](const FilmedImpact& a, const FilmedImpact& b) {
        return std::tie(a.block, a.number) < std::tie(b.block, b.number);
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
    const bool in_plane = !input.tracks.empty();
    SCREE_ASSERT(in_plane ? input.profile_release != nullptr : input.surface && input.area);
    SCREE_ASSERT(input.departures.empty() || std::ssize(input.departures) == input.release.count);
    SCREE_ASSERT(input.thrown.empty() || std::ssize(input.thrown) == input.release.count);
    const Prepared prepared(input);
    CampaignResult result;
    result.blocks.resize(static_cast<std::size_t>(input.release.count));
    for (const auto& listed : input.population.list) result.block_ids.push_back(listed.id);
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
                              if (!is_thrown(input, i)) continue;
                              BlockResult& block = result.blocks[static_cast<std::size_t>(i)];
                              if (in_plane)
                                  run_block_on_profile(input, prepared, i, block, partial);
                              else
                                  run_block_in_space(input, prepared, i, block, partial);
                              ++done;
                              if (progress && progress_mutex.try_lock()) {
                                  const std::lock_guard<std::mutex> lock(progress_mutex, std::adopt_lock);
                                  progress(done.load());
                              }
                          }
                      });
    collect(input, partials, result);
    result.interrupted = result.released < number_thrown(input);
    return result;
}

}  // namespace scree
