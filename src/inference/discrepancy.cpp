// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/discrepancy.hpp"

#include "inference/gap_statistic.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace scree {

namespace {

constexpr double kCovered = 0.95;                      // of every interval [-]
constexpr double kNormalQuantile = 1.959963984540054;  // of kCovered, both sides [-]
constexpr double kLow = 0.5 * (1.0 - kCovered), kHigh = 1.0 - kLow;

/// Whether there is chance at all, beyond what is left of sums that cancel.
bool varies(double distance, double floor) {
    constexpr double kCancelled = 1e-9;
    return floor > kCancelled * distance && floor > 0.0;
}

/// Streams of random numbers for different uses; each observable takes kStreams of them.
enum Stream : std::uint64_t { kChance, kResampled, kJoint, kScore, kBand, kStreams };

RandomStream stream(const DiscrepancySettings& settings, std::size_t observable, Stream use) {
    return {settings.seed, observable * kStreams + use, RandomPurpose::Resampling};
}

double variance(const std::vector<double>& values) {
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    double sum = 0.0;
    for (const double v : values) sum += (v - mean) * (v - mean);
    return values.size() < 2 ? 0.0 : sum / static_cast<double>(values.size() - 1);
}

/// Two-sided quantile of Student's distribution for the mean of n values, first term of its expansion (Abramowitz & Stegun 26.7.5).
double student_quantile(std::size_t n) {
    const double z = kNormalQuantile;
    return n < 2 ? kInfinity : z + (z * z * z + z) / (4.0 * static_cast<double>(n - 1));
}

/// Quantile of chance: rank q (n+1), below which one more draw falls in a share q of the cases, exactly (type 6 of Hyndman & Fan 1996).
double chance_quantile(const std::vector<double>& sorted, double q) {
    const double last = static_cast<double>(sorted.size()) - 1.0;
    return sample_quantile(sorted, last > 0.0 ? (q * (last + 2.0) - 1.0) / last : 0.0);
}

/// Fills what draws tell: interval of chance, p, and the interval of the gap. `slope_variance` is that of the gap to first order in the measured
/// blocks (nothing if the distributions agree); chance adds its own. Gaps are squares of distances: on the scale of their roots they spread evenly.
void judge(Gap& gap, std::vector<double> drawn, double slope_variance) {
    if (drawn.empty()) return;
    const double deviation = std::sqrt(slope_variance + variance(drawn));
    std::sort(drawn.begin(), drawn.end());
    gap.chance = {chance_quantile(drawn, kLow), chance_quantile(drawn, kHigh)};
    const auto larger = drawn.end() - std::lower_bound(drawn.begin(), drawn.end(), gap.gap);
    const auto smaller = std::upper_bound(drawn.begin(), drawn.end(), gap.gap) - drawn.begin();
    const auto all = static_cast<double>(1 + drawn.size());
    gap.p = static_cast<double>(1 + larger) / all;
    if (gap.two_sided) gap.p = std::min(1.0, 2.0 * static_cast<double>(1 + std::min(larger, smaller)) / all);
    const double root = std::sqrt(std::max(gap.gap, 0.0));
    const double half = kNormalQuantile * deviation / (2.0 * std::max(root, 1.0));  // below 1 chance is all there is
    gap.interval = {std::pow(std::max(0.0, root - half), 2.0), std::pow(root + half, 2.0)};
}

/// The measured blocks resampled: how far from themselves, and how far from the simulation.
void resample_measured(WassersteinGap& gap, const ObservableSample& sample, const DiscrepancySettings& settings,
                       std::size_t observable) {
    RandomStream random = stream(settings, observable, kResampled);
    const SortedSample measured = sorted_sample(sample.measured.values),
                       simulated = sorted_sample(sample.simulated.values);
    std::vector<double> to_itself, to_simulated, again(sample.measured.size());
    for (std::int64_t d = 0; d < settings.draws; ++d) {
        for (double& value : again) value = sample.measured.values[random.below(sample.measured.size())];
        const SortedSample resampled = sorted_sample(again);
        to_itself.push_back(line_distance(resampled, measured).wasserstein);
        to_simulated.push_back(line_distance(resampled, simulated).wasserstein);
    }
    std::sort(to_itself.begin(), to_itself.end());
    std::sort(to_simulated.begin(), to_simulated.end());
    gap.floor_median = sample_quantile(to_itself, 0.5);
    gap.floor_high = sample_quantile(to_itself, kCovered);
    // blocks drawn again are farther away than the blocks were, by what chance adds once more
    const double too_far = sample_quantile(to_simulated, 0.5) - gap.distance;
    gap.interval = {std::max(sample_quantile(to_simulated, kLow) - too_far, 0.0),
                    sample_quantile(to_simulated, kHigh) - too_far};
}

/// One observable at a time, then all of them for the same blocks.
class Comparison {
public:
    Comparison(const ObservationTable& measured, const ObservationTable& simulated,
               std::span<const Observable> observables, std::span<const double> scales,
               const DiscrepancySettings& settings)
        : measured_(measured), simulated_(simulated), scales_(scales), settings_(settings) {
        SCREE_ASSERT(scales.empty() || scales.size() == simulated.columns.size());
        for (const Observable& observable : observables) add(observable);
    }

    Discrepancy result() {
        let_passing_stand_in();
        add_overall();
        add_overall_score();
        return std::move(result_);
    }

private:
    struct Part {
        std::unique_ptr<GapStatistic> statistic;    ///< null: no gap
        std::vector<std::int32_t> member_of_row;    ///< of the simulated table
        std::vector<std::int32_t> member_of_block;  ///< of measurements of known blocks, -1: none
    };

    void add(const Observable& observable) {
        const std::size_t index = parts_.size();
        ObservableSample sample = observable_sample(measured_, simulated_, observable);
        ObservableGap gap;
        gap.observable = observable;
        gap.measured = sample.measured.size();
        gap.simulated = sample.simulated.size();
        for (const ObservedShare& c : observable.counts)
            gap.measured = std::max(gap.measured, static_cast<std::size_t>(c.thrown));
        Part part;
        if (gap.measured == 0)
            gap.status =
                observable.matched ? "no known block has both measured and simulated values" : "nothing was measured";
        else if (gap.simulated < kLeastRepeats)
            gap.status = std::to_string(gap.simulated)
                             .append(" simulated blocks have it: throw more, if the model lets any get there");
        else
            part.statistic = make_gap_statistic(observable, sample);
        if (part.statistic) fill(gap, *part.statistic, index);
        if (gap.wasserstein && settings_.draws > 0) resample_measured(*gap.wasserstein, sample, settings_, index);
        if (part.statistic && observable.matched && !observable.share)
            gap.score = score_of(observable.columns, {}, index);
        part.member_of_row = std::move(sample.member_of_row);
        for (std::size_t k = 0; observable.matched && k < sample.block_of_stratum.size(); ++k) {
            const auto block = static_cast<std::size_t>(sample.block_of_stratum[k]);
            part.member_of_block.resize(std::max(part.member_of_block.size(), block + 1), -1);
            part.member_of_block[block] = static_cast<std::int32_t>(sample.simulated.size() + k);
        }
        parts_.push_back(std::move(part));
        result_.observables.push_back(std::move(gap));
    }

    void fill(ObservableGap& gap, const GapStatistic& statistic, std::size_t index) const {
        const GapStatistic::Value measured = statistic.measured();
        gap.pooled.distance = measured.distance;
        gap.pooled.floor = measured.floor;
        gap.pooled.gap = measured.gap();
        if (!varies(measured.distance, measured.floor)) {
            gap.status = "the simulated values are all alike: no chance to compare with";
            gap.pooled = {};
            return;
        }
        if (settings_.wasserstein && gap.observable.columns.size() == 1 && !gap.observable.share)
            gap.wasserstein.emplace().distance = statistic.wasserstein(statistic.measured_members());
        std::vector<double> drawn, wasserstein;
        RandomStream random = stream(settings_, index, kChance);
        for (std::int64_t d = 0; d < settings_.draws; ++d) {
            const std::vector<std::uint32_t> members = statistic.draw_members(random);
            drawn.push_back(statistic.value(members).gap());
            if (gap.wasserstein) wasserstein.push_back(statistic.wasserstein(members));
        }
        judge(gap.pooled, std::move(drawn), slope_variance(gap, statistic));
        if (wasserstein.empty()) return;
        std::sort(wasserstein.begin(), wasserstein.end());
        gap.wasserstein->chance_median = sample_quantile(wasserstein, 0.5);
        gap.wasserstein->chance_high = chance_quantile(wasserstein, kCovered);
    }

    /// Variance of a gap to first order; the simulated blocks add to it in proportion to their number.
    static double slope_variance(const ObservableGap& gap, const GapStatistic& statistic) {
        const double of_simulated = static_cast<double>(gap.measured) / static_cast<double>(gap.simulated);
        return statistic.slope_variance() * (1.0 + of_simulated) / (gap.pooled.floor * gap.pooled.floor);
    }

    /// Energy score of columns; without scales, of values as they are.
    std::optional<Gap> score_of(std::span<const Column> columns, std::span<const double> scales,
                                std::size_t index) const {
        const std::vector<double> ones(columns.size(), 1.0);
        const ScoreStatistic statistic(score_input(measured_, simulated_, columns, scales.empty() ? ones : scales));
        if (statistic.blocks() == 0) return std::nullopt;
        Gap gap;
        gap.two_sided = true;
        gap.distance = statistic.mean_score();
        gap.floor = statistic.floor();
        if (!varies(gap.distance, gap.floor)) return std::nullopt;
        gap.gap = gap.distance / gap.floor;
        std::vector<double> drawn;
        RandomStream random = stream(settings_, index, kScore);
        for (std::int64_t d = 0; d < settings_.draws; ++d) drawn.push_back(statistic.draw(random));
        const double error = statistic.standard_error() / gap.floor;
        judge(gap, std::move(drawn), error * error);
        if (settings_.draws >
            0) {  // scores of different blocks are independent and skew: their own spread, on a scale of ratios
            const double factor = std::exp(student_quantile(statistic.blocks()) * error / gap.gap);
            gap.interval = {gap.gap / factor, gap.gap * factor};
        }
        return gap;
    }

    /// What a test could have measured: of each known block one of its rows or (-1 - block) its measurement, or any rows, each once, at most half of them: gaps
    /// in units of their floor hardly depend on the number, but those of nearly all rows against the few others do.
    static std::vector<std::int64_t> draw_test(const std::vector<std::vector<std::int64_t>>& rows, std::size_t pooled,
                                               RandomStream& random) {
        std::vector<std::int64_t> drawn;
        if (rows.size() > 1) {
            for (std::size_t b = 0; b < rows.size(); ++b) {
                if (rows[b].empty()) continue;
                const std::size_t choice = random.below(rows[b].size() + 1);
                drawn.push_back(choice < rows[b].size() ? rows[b][choice] : -1 - static_cast<std::int64_t>(b));
            }
            return drawn;
        }
        std::vector<std::int64_t> left = rows.front();
        for (std::size_t k = 0; k < std::min(pooled, left.size() / 2); ++k) {
            std::swap(left[k], left[k + random.below(left.size() - k)]);
            drawn.push_back(left[k]);
        }
        return drawn;
    }

    /// Mean gap of such a test over the observables that count; those that it holds nothing of are left out.
    double mean_gap(const std::vector<std::int64_t>& test) const {
        double sum = 0.0, count = 0.0;
        for (std::size_t k = 0; k < parts_.size(); ++k) {
            if (!counts(k)) continue;
            const Part& part = parts_[k];
            std::vector<std::uint32_t> members;
            for (const std::int64_t row : test) {
                const auto block = static_cast<std::size_t>(-1 - row);
                const std::int32_t member = row >= 0 ? part.member_of_row[static_cast<std::size_t>(row)]
                                            : block < part.member_of_block.size() ? part.member_of_block[block]
                                                                                  : -1;
                if (member >= 0) members.push_back(static_cast<std::uint32_t>(member));
            }
            if (members.empty() || members.size() + kLeastRepeats > result_.observables[k].simulated) continue;
            sum += part.statistic->value(members).gap();
            count += 1.0;
        }
        return count > 0.0 ? sum / count : kNaN;
    }

    /// Of known blocks a motion at a screen says who passed it, too; but not where all simulated blocks are alike there.
    void let_passing_stand_in() {
        for (ObservableGap& passing : result_.observables) {
            const Column& at = passing.observable.columns.front();
            if (passing.observable.overall || !passing.observable.share || at.quantity != Quantity::Passed) continue;
            passing.stands_in =
                std::none_of(result_.observables.begin(), result_.observables.end(), [&](const ObservableGap& motion) {
                    const Column& there = motion.observable.columns.front();
                    return motion.observable.matched && !motion.observable.share && there.place == at.place &&
                           motion.counts();
                });
        }
    }

    bool counts(std::size_t k) const { return result_.observables[k].counts(); }

    void add_overall() {
        Gap& overall = result_.overall;
        double sum = 0.0, variance_sum = 0.0, count = 0.0;
        std::size_t pooled = 0;
        for (std::size_t k = 0; k < parts_.size(); ++k) {
            if (!counts(k)) continue;
            const ObservableGap& gap = result_.observables[k];
            sum += gap.pooled.gap;
            count += 1.0;
            // correlations between observables are not known where blocks are not: as if they were fully correlated, which is safe
            variance_sum += std::sqrt(slope_variance(gap, *parts_[k].statistic));
            pooled = std::max(pooled, gap.measured);
        }
        if (count == 0.0) return;
        overall.gap = sum / count;
        std::vector<std::vector<std::int64_t>> rows(1);
        const std::vector<char> use = balanced_rows(simulated_, kMostPoints);
        for (std::size_t row = 0; row < simulated_.rows(); ++row) {
            if (!use[row]) continue;
            const auto block = static_cast<std::size_t>(std::max(simulated_.block[row], 0));
            rows.resize(std::max(rows.size(), block + 1));
            rows[block].push_back(static_cast<std::int64_t>(row));
        }
        std::vector<double> drawn;
        RandomStream random = stream(settings_, parts_.size(), kJoint);
        for (std::int64_t d = 0; d < settings_.draws; ++d) {
            const double gap = mean_gap(draw_test(rows, pooled, random));
            if (std::isfinite(gap)) drawn.push_back(gap);
        }
        judge(overall, std::move(drawn), variance_sum * variance_sum / (count * count));
    }

    void add_overall_score() {
        if (scales_.empty()) return;
        std::vector<Column> columns;
        std::vector<double> scales;
        for (const ObservableGap& gap : result_.observables) {
            if (!gap.observable.matched || !gap.observable.overall || !gap.status.empty()) continue;
            for (const Column& column : gap.observable.columns) {
                columns.push_back(column);
                scales.push_back(scales_[simulated_.find(column)]);
            }
        }
        if (!columns.empty()) result_.overall_score = score_of(columns, scales, parts_.size());
    }

    const ObservationTable& measured_;
    const ObservationTable& simulated_;
    std::span<const double> scales_;
    const DiscrepancySettings& settings_;
    std::vector<Part> parts_;
    Discrepancy result_;
};

}  // namespace

Discrepancy compare_tables(const ObservationTable& measured, const ObservationTable& simulated,
                           std::span<const Observable> observables, std::span<const double> scales,
                           const DiscrepancySettings& settings) {
    return Comparison(measured, simulated, observables, scales, settings).result();
}

double distance_over(std::span<const ObservableGap> model, std::span<const ObservableGap> reference) {
    double sum = 0.0, count = 0.0;
    for (const ObservableGap& gap : model) {
        if (!gap.counts()) continue;
        const auto known = std::find_if(reference.begin(), reference.end(), [&](const ObservableGap& r) {
            return r.observable.name == gap.observable.name && std::isfinite(r.pooled.gap);
        });
        sum += gap.pooled.distance / (known == reference.end() ? gap.pooled.floor : known->pooled.floor);
        count += 1.0;
    }
    return count > 0.0 ? sum / count : kNaN;
}

namespace {

/// As many simulated values as were measured: one of each stratum, or any of a single one.
std::vector<double> drawn_from_simulation(const ObservableSample& sample, RandomStream& random) {
    std::vector<double> values;
    const bool single = sample.strata.size() == 1;
    for (std::size_t k = 0; k < sample.measured.size(); ++k) {
        const std::vector<std::uint32_t>& members = sample.strata[single ? 0 : k];
        values.push_back(sample.simulated.values[members[random.below(members.size())]]);
    }
    return values;
}

}  // namespace

DistributionBand distribution_band(const ObservableSample& sample, std::size_t points,
                                   const DiscrepancySettings& settings) {
    DistributionBand band;
    const SortedSample simulated = sorted_sample(sample.simulated.values),
                       measured = sorted_sample(sample.measured.values);
    const double low =
        std::min(simulated.values.front(), measured.values.empty() ? kInfinity : measured.values.front());
    const double high =
        std::max(simulated.values.back(), measured.values.empty() ? -kInfinity : measured.values.back());
    for (std::size_t k = 0; k < points; ++k)
        band.x.push_back(low + (high - low) * static_cast<double>(k) / static_cast<double>(points - 1));
    const auto shares = [&](const std::vector<double>& sorted) {
        std::vector<double> share;
        for (const double x : band.x)
            share.push_back(static_cast<double>(std::upper_bound(sorted.begin(), sorted.end(), x) - sorted.begin()) /
                            static_cast<double>(sorted.size()));
        return share;
    };
    band.share = shares(simulated.values);

    RandomStream random = stream(settings, 0, kBand);
    std::vector<std::vector<double>> drawn(points);
    for (std::int64_t d = 0; d < settings.draws; ++d) {
        std::vector<double> values = drawn_from_simulation(sample, random);
        std::sort(values.begin(), values.end());
        const std::vector<double> share = shares(values);
        for (std::size_t k = 0; k < points; ++k) drawn[k].push_back(share[k]);
    }
    for (std::vector<double>& at : drawn) {
        std::sort(at.begin(), at.end());
        band.low.push_back(at.empty() ? kNaN : sample_quantile(at, kLow));
        band.high.push_back(at.empty() ? kNaN : sample_quantile(at, kHigh));
    }
    return band;
}

}  // namespace scree
