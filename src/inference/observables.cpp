// SPDX-License-Identifier: GPL-3.0-or-later
// What is compared with what: from tables to the values of one observable.
#include "inference/gap_statistic.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

constexpr std::array<const char*, kKinematics> kKinematicNames{"speed", "height", "spin", "energy", "rise"};
constexpr std::array<const char*, kKinematics> kKinematicUnits{"m/s", "m", "rad/s", "J", "m/s"};
/// Standard errors by which the share that did not pass may be wrong where some that passed have no value [-].
constexpr double kNegligible = 0.25;

bool is_kinematic(const Column& c) {
    return c.quantity >= Quantity::Speed && c.quantity <= Quantity::Rise;
}

/// Value of a cell; where a known block has not passed the screen, its motion there is none.
double cell(const ObservationTable& table, std::size_t row, const Column& column, bool matched) {
    const std::size_t k = table.find(column);
    if (k == table.columns.size()) return kNaN;
    const double value = table.values[k][row];
    if (!matched || !is_kinematic(column) || std::isfinite(value)) return value;
    const std::size_t passed = table.find({Quantity::Passed, column.place});
    return passed < table.columns.size() && table.values[passed][row] == 0.0 ? 0.0 : kNaN;
}

/// Whether blocks that did not pass can count as motion 0 beside those that did and were measured: values that are missing are all of blocks that passed, so that too many others would be left.
bool zeros_count(std::int64_t blocks, std::int64_t passed, std::int64_t measured) {
    const auto all = static_cast<double>(blocks), missed = static_cast<double>(blocks - passed);
    const double share = missed / all, left = missed / std::max(missed + static_cast<double>(measured), 1.0);
    return left - share <= kNegligible * std::sqrt(share * (1.0 - share) / all);
}

void add_stops(std::vector<Observable>& list, const Observations& observations, const ObservationOperator& op) {
    const auto located = std::find_if(observations.stops.begin(), observations.stops.end(),
                                      [](const ObservedStop& s) { return std::isfinite(s.position.x()); });
    if (located == observations.stops.end()) return;
    const bool matched = observations.matched && located->block >= 0;
    if (op.lateral)
        list.push_back({"stop position", "m", {{Quantity::Along}, {Quantity::Lateral}}, false, matched, true, {}});
    list.push_back({"runout", "m", {{Quantity::Runout}}, false, matched, false, {}});
    list.push_back({"distance along", "m", {{Quantity::Along}}, false, matched, !op.lateral, {}});
    if (op.lateral) list.push_back({"lateral", "m", {{Quantity::Lateral}}, false, matched, false, {}});
    if (op.zones.empty()) return;
    Observable zones{"deposit zones", "-", {}, true, matched, false, {}};
    for (std::size_t z = 0; z < op.zones.size(); ++z)
        zones.columns.push_back({Quantity::InZone, static_cast<std::int32_t>(z)});
    list.push_back(zones);
}

void add_shares(std::vector<Observable>& list, const Observations& observations) {
    const bool stops =
        std::any_of(list.begin(), list.end(), [](const Observable& o) { return o.name == "deposit zones"; });
    if (stops || observations.shares.empty()) return;
    Observable zones{"deposit zones", "-", {}, true, false, list.empty(), {}};
    for (const ObservedShare& share : observations.shares) {
        zones.counts.push_back(share);
        zones.counts.back().zone = static_cast<std::int32_t>(zones.columns.size());
        zones.columns.push_back({Quantity::InZone, share.zone});
    }
    list.push_back(zones);
}

void add_screen(std::vector<Observable>& list, const Observations& observations, const std::string& name,
                std::int32_t screen, bool impact, bool watched) {
    std::int64_t passed = 0;
    bool matched = observations.matched;
    std::array<std::int64_t, kKinematics> measured{};
    for (const ObservedCrossing& c : observations.crossings) {
        if (c.screen != screen) continue;
        ++passed;
        matched = matched && c.block >= 0;
        for (std::size_t k = 0; k < kKinematics; ++k) measured[k] += std::isfinite(c.value[k]);
    }
    if (passed == 0 && !watched) return;
    std::array<bool, kKinematics> of_blocks{};  // else of those that passed
    for (std::size_t k = 0; k < kKinematics; ++k)
        of_blocks[k] =
            matched && measured[k] > 0 && (impact || zeros_count(std::ssize(observations.blocks), passed, measured[k]));
    const bool told = std::find(of_blocks.begin(), of_blocks.end(), true) != of_blocks.end();
    Observable passing{"passing " + name, "-", {{Quantity::Passed, screen}}, true, matched, !told, {}};
    if (!matched) passing.counts.push_back({0, 0, passed, observations.thrown});
    if (!impact && (matched || observations.thrown > 0)) list.push_back(passing);
    for (std::size_t k = 0; k < kKinematics; ++k) {
        if (measured[k] == 0) continue;
        const bool twice = quantity_of(k) == Quantity::Energy && measured[0] > 0;  // the speed says it already
        list.push_back({std::string(kKinematicNames[k]) + " at " + name,
                        kKinematicUnits[k],
                        {{quantity_of(k), screen}},
                        false,
                        of_blocks[k],
                        !twice && !impact,  // of which not every block has one
                        {}});
    }
}

}  // namespace

std::vector<double> point_of(const ObservationTable& table, std::size_t row, const Observable& observable) {
    std::vector<double> point;
    for (const Column& column : observable.columns) {
        point.push_back(cell(table, row, column, observable.matched));
        if (!std::isfinite(point.back())) return {};
    }
    return point;
}

std::vector<Observable> make_observables(const Observations& observations, const ObservationOperator& op) {
    std::vector<Observable> list;
    add_stops(list, observations, op);
    add_shares(list, observations);
    for (std::size_t s = 0; s < op.screens.size(); ++s) {
        const auto screen = static_cast<std::int32_t>(s);
        add_screen(list, observations, op.screens[s], screen, op.is_impact(screen), op.is_watched(screen));
    }
    return list;
}

std::vector<char> balanced_rows(const ObservationTable& simulated, std::size_t most) {
    const std::int32_t last =
        simulated.rows() > 0 ? *std::max_element(simulated.block.begin(), simulated.block.end()) : -1;
    std::vector<std::size_t> count(static_cast<std::size_t>(last + 1), 0);
    for (const std::int32_t b : simulated.block)
        if (b >= 0) ++count[static_cast<std::size_t>(b)];
    std::size_t repeats = most;
    std::size_t blocks = 0;
    for (const std::size_t c : count) {
        if (c < kLeastRepeats) continue;
        repeats = std::min(repeats, c);
        ++blocks;
    }
    if (blocks > 0) repeats = std::min(repeats, std::max(kLeastRepeats, most / blocks));
    std::vector<char> use(simulated.rows(), 0);
    std::vector<std::size_t> taken(count.size(), 0);
    std::size_t pooled = 0;
    for (std::size_t row = 0; row < simulated.rows(); ++row) {
        const std::int32_t b = simulated.block[row];
        if (b < 0)
            use[row] = pooled++ < most;
        else if (count[static_cast<std::size_t>(b)] >= kLeastRepeats)
            use[row] = taken[static_cast<std::size_t>(b)]++ < repeats;
    }
    return use;
}

ObservableSample observable_sample(const ObservationTable& measured, const ObservationTable& simulated,
                                   const Observable& observable) {
    ObservableSample sample;
    const std::size_t dimension = observable.columns.size();
    sample.measured.dimension = sample.simulated.dimension = dimension;
    sample.member_of_row.assign(simulated.rows(), -1);

    // what was measured, per block where blocks are known
    std::vector<std::vector<double>> of_block(1);
    for (std::size_t row = 0; row < measured.rows() && observable.counts.empty(); ++row) {
        const std::vector<double> point = point_of(measured, row, observable);
        const std::int32_t block = measured.block[row];
        if (point.empty() || (observable.matched && block < 0)) continue;
        if (!observable.matched) {
            sample.measured.values.insert(sample.measured.values.end(), point.begin(), point.end());
            continue;
        }
        of_block.resize(std::max(of_block.size(), static_cast<std::size_t>(block) + 1));
        of_block[static_cast<std::size_t>(block)] = point;
    }

    const std::vector<char> use =
        balanced_rows(simulated, dimension > 1 && !observable.share ? kMostPoints : simulated.rows());
    const auto block_of = [&](std::size_t row) {
        return observable.matched ? static_cast<std::size_t>(simulated.block[row]) : 0;
    };
    std::vector<std::vector<double>> points(simulated.rows());
    std::vector<std::size_t> count(of_block.size(), 0);  // an impact, say, that not every repeat has
    for (std::size_t row = 0; row < simulated.rows(); ++row) {
        const std::size_t block = block_of(row);
        if (!use[row] || block >= count.size() || (observable.matched && of_block[block].empty())) continue;
        points[row] = point_of(simulated, row, observable);
        if (!points[row].empty()) ++count[block];
    }
    std::vector<std::vector<std::uint32_t>> members(of_block.size());
    for (std::size_t row = 0; row < simulated.rows(); ++row) {
        if (points[row].empty() || (observable.matched && count[block_of(row)] < kLeastRepeats)) continue;
        const auto number = static_cast<std::uint32_t>(sample.simulated.size());
        sample.member_of_row[row] = static_cast<std::int32_t>(number);
        members[block_of(row)].push_back(number);
        sample.simulated.values.insert(sample.simulated.values.end(), points[row].begin(), points[row].end());
    }
    for (std::size_t b = 0; b < members.size(); ++b) {
        if (members[b].empty()) continue;
        sample.strata.push_back(std::move(members[b]));
        sample.block_of_stratum.push_back(observable.matched ? static_cast<std::int32_t>(b) : -1);
        sample.measured.values.insert(sample.measured.values.end(), of_block[b].begin(), of_block[b].end());
    }
    return sample;
}

ScoreInput score_input(const ObservationTable& measured, const ObservationTable& simulated,
                       std::span<const Column> columns, std::span<const double> scales) {
    SCREE_ASSERT(columns.size() == scales.size());
    const std::vector<char> use = balanced_rows(simulated, simulated.rows());
    std::vector<std::vector<std::size_t>> rows;  // of every block
    for (std::size_t row = 0; row < simulated.rows(); ++row) {
        if (!use[row] || simulated.block[row] < 0) continue;
        const auto block = static_cast<std::size_t>(simulated.block[row]);
        rows.resize(std::max(rows.size(), block + 1));
        rows[block].push_back(row);
    }
    ScoreInput input;
    for (std::size_t row = 0; row < measured.rows(); ++row) {
        const std::int32_t b = measured.block[row];
        if (b < 0 || static_cast<std::size_t>(b) >= rows.size() || rows[static_cast<std::size_t>(b)].empty()) continue;
        ScoreInput::Block block;
        std::vector<std::size_t> kept;  // columns that were measured on this block
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const double value = cell(measured, row, columns[c], true);
            if (!std::isfinite(value)) continue;
            kept.push_back(c);
            block.observation.push_back(value / scales[c]);
        }
        if (kept.empty()) continue;
        block.repeats.dimension = kept.size();
        for (const std::size_t r : rows[static_cast<std::size_t>(b)]) {
            std::vector<double> repeat;
            for (const std::size_t c : kept) repeat.push_back(cell(simulated, r, columns[c], true) / scales[c]);
            if (std::all_of(repeat.begin(), repeat.end(), [](double v) { return std::isfinite(v); }))
                block.repeats.values.insert(block.repeats.values.end(), repeat.begin(), repeat.end());
        }
        if (block.repeats.size() >= kLeastRepeats) input.blocks.push_back(std::move(block));
    }
    return input;
}

std::vector<BlockPit> pit_values(const ObservationTable& measured, const ObservationTable& simulated,
                                 std::span<const Observable> observables, std::uint64_t seed) {
    std::vector<BlockPit> pits;
    std::uint64_t stream = 0;
    for (const Observable& observable : observables) {
        if (!observable.matched || observable.share) continue;
        for (const Column& column : observable.columns) {
            Observable single = observable;
            single.columns = {column};
            const bool done =
                std::any_of(pits.begin(), pits.end(), [&](const BlockPit& p) { return p.column == column; });
            if (done) continue;
            const ObservableSample sample = observable_sample(measured, simulated, single);
            RandomStream random(seed, stream++, RandomPurpose::Resampling);
            for (std::size_t s = 0; s < sample.strata.size(); ++s) {
                std::vector<double> repeats;
                for (const std::uint32_t m : sample.strata[s]) repeats.push_back(sample.simulated.values[m]);
                pits.push_back({sample.block_of_stratum[s], column,
                                pit_value(sample.measured.values[s], repeats, random.uniform())});
            }
        }
    }
    return pits;
}

std::vector<double> column_scales(const ObservationTable& simulated) {
    std::vector<double> scales;
    for (const Column& column : simulated.columns) {
        double n = 0.0, mean = 0.0, squares = 0.0;  // Welford's running mean and sum of squares
        for (std::size_t row = 0; row < simulated.rows(); ++row) {
            const double value = cell(simulated, row, column, true);
            if (!std::isfinite(value)) continue;
            n += 1.0;
            const double step = value - mean;
            mean += step / n;
            squares += step * (value - mean);
        }
        scales.push_back(n > 1.0 && squares > 0.0 ? std::sqrt(squares / (n - 1.0)) : 1.0);
    }
    return scales;
}

}  // namespace scree
