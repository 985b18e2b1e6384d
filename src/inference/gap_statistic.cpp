// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/gap_statistic.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scree {

namespace {

double number(std::size_t n) {
    return static_cast<double>(n);
}

double mean(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / number(values.size());
}

double variance(std::span<const double> values) {
    if (values.size() < 2) return 0.0;
    const double centre = mean(values);
    double sum = 0.0;
    for (const double v : values) sum += (v - centre) * (v - centre);
    return sum / number(values.size() - 1);
}

/// floor = a (1/n + 1/N).
double chance_floor(double spread, std::size_t n, std::size_t N) {
    return spread * (1.0 / number(n) + 1.0 / number(N));
}

/// Sum of the distances of each of these members to all of them.
std::vector<double> distance_sums(const PointSample& pool, std::span<const std::uint32_t> members) {
    std::vector<double> sums(members.size(), 0.0);
    if (pool.dimension > 1) {
        for (std::size_t k = 0; k < members.size(); ++k) {
            for (std::size_t l = 0; l < k; ++l) {
                const double d = point_distance(pool[members[k]], pool[members[l]]);
                sums[k] += d;
                sums[l] += d;
            }
        }
        return sums;
    }
    // in one dimension from sums over the values below, counted from the smallest so that no digits are lost
    std::vector<std::pair<double, std::size_t>> sorted;
    for (std::size_t k = 0; k < members.size(); ++k) sorted.emplace_back(pool.values[members[k]], k);
    std::sort(sorted.begin(), sorted.end());
    double total = 0.0, below = 0.0;
    for (const auto& [value, k] : sorted) total += value - sorted.front().first;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const double v = sorted[i].first - sorted.front().first;
        sums[sorted[i].second] = v * number(i) - below + (total - below) - v * number(sorted.size() - i);
        below += v;
    }
    return sums;
}

/// Distances between points. Sums over the pool are kept: a choice of members costs only the pairs among them.
class DistanceStatistic final : public GapStatistic {
public:
    explicit DistanceStatistic(const ObservableSample& sample) : GapStatistic(sample), pool_(sample.simulated) {
        pool_.values.insert(pool_.values.end(), sample.measured.values.begin(), sample.measured.values.end());
        std::vector<std::uint32_t> all(pool_.size());
        std::iota(all.begin(), all.end(), 0U);
        to_all_ = distance_sums(pool_, all);
        among_all_ = std::accumulate(to_all_.begin(), to_all_.end(), 0.0);
        if (strata_.size() > 1) sum_strata();
        if (pool_.dimension == 1) {
            order_ = std::move(all);
            std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
                return std::pair(pool_.values[a], a) < std::pair(pool_.values[b], b);
            });
        }
    }

    Value value(std::span<const std::uint32_t> members) const override {
        const std::vector<double> sums = distance_sums(pool_, members);
        const double own = std::accumulate(sums.begin(), sums.end(), 0.0);
        double to_all = 0.0;
        for (const std::uint32_t m : members) to_all += to_all_[m];
        // sums over the rest are those over all less those over the members
        const double n = number(members.size()), rest = number(pool_.size() - members.size());
        const double among_rest = among_all_ - 2.0 * to_all + own;
        const double distance = 2.0 * (to_all - own) / (n * rest) - own / (n * n) - among_rest / (rest * rest);
        const double spread = strata_.size() > 1 ? stratified_spread(members) : among_rest / (rest * (rest - 1.0));
        return {std::max(distance, 0.0), chance_floor(spread, members.size(), pool_.size() - members.size())};
    }

    double wasserstein(std::span<const std::uint32_t> members) const override {
        if (pool_.dimension > 1) return kNaN;
        std::vector<char> out(pool_.size(), 0);
        for (const std::uint32_t m : members) out[m] = 1;
        SortedSample drawn, rest;
        for (const std::uint32_t m : order_) (out[m] ? drawn : rest).values.push_back(pool_.values[m]);
        drawn.weights.assign(drawn.values.size(), 1.0 / number(drawn.values.size()));
        rest.weights.assign(rest.values.size(), 1.0 / number(rest.values.size()));
        return line_distance(drawn, rest).wasserstein;
    }

    double slope_variance() const override {
        // derivative of the distance by the mass at y: 2 (E|y-X| - E|y-Y|)
        const std::size_t n = measured_members_.size();
        if (n < 2) return 0.0;
        const std::vector<double> to_measured = distance_sums(pool_, measured_members_);
        std::vector<double> slope;
        for (std::size_t i = 0; i < n; ++i)
            slope.push_back(2.0 * ((to_all_[measured_members_[i]] - to_measured[i]) / number(simulated_) -
                                   to_measured[i] / number(n - 1)));
        return variance(slope) / number(n);
    }

private:
    void sum_strata() {
        to_stratum_.assign(pool_.size(), 0.0);
        for (const auto& members : strata_) {
            const std::vector<double> sums = distance_sums(pool_, members);
            for (std::size_t k = 0; k < members.size(); ++k) to_stratum_[members[k]] = sums[k];
            among_stratum_.push_back(std::accumulate(sums.begin(), sums.end(), 0.0));
        }
    }
    /// Mean difference within strata, each without its member.
    double stratified_spread(std::span<const std::uint32_t> members) const {
        SCREE_ASSERT(members.size() == strata_.size());
        double sum = 0.0;
        for (std::size_t s = 0; s < strata_.size(); ++s) {
            const double rest = number(strata_[s].size() - 1);
            sum += (among_stratum_[s] - 2.0 * to_stratum_[members[s]]) / (rest * (rest - 1.0));
        }
        return sum / number(strata_.size());
    }

    PointSample pool_;
    std::vector<std::uint32_t> order_;   ///< of the pool, in one dimension
    std::vector<double> to_all_;         ///< per member, sum of its distances to the pool
    double among_all_ = 0.0;             ///< sum of that
    std::vector<double> to_stratum_;     ///< per member, sum of its distances to its stratum
    std::vector<double> among_stratum_;  ///< per stratum, sum of that
};

/// Columns of 0 and 1; measured as rows, or known as counts. Counts are no members of the pool: chance then draws from the simulation.
class ShareStatistic final : public GapStatistic {
public:
    ShareStatistic(const ObservableSample& sample, const Observable& observable)
        : GapStatistic(sample), pool_(sample.simulated), counts_(observable.counts) {
        pool_.values.insert(pool_.values.end(), sample.measured.values.begin(), sample.measured.values.end());
        hits_.assign(strata_.size(), std::vector<double>(pool_.dimension, 0.0));
        for (std::size_t s = 0; s < strata_.size(); ++s)
            for (const std::uint32_t m : strata_[s])
                for (std::size_t z = 0; z < pool_.dimension; ++z) hits_[s][z] += pool_[m][z];
        for (const ObservedShare& c : counts_)
            drawn_ = std::max(drawn_, std::min(static_cast<std::size_t>(c.thrown), simulated_ / 2));
    }

    Value value(std::span<const std::uint32_t> members) const override {
        Value value{0.0, 0.0};
        const double n = number(members.size()), rest = number(pool_.size() - members.size());
        for (std::size_t z = 0; z < pool_.dimension; ++z) {
            const double d = hits(members, z) / n - (total_hits(z) - hits(members, z)) / rest;
            value.distance += 2.0 * d * d;
            value.floor += chance_floor(spread(members, z), members.size(), pool_.size() - members.size());
        }
        return value;
    }

    Value measured() const override {
        if (counts_.empty()) return GapStatistic::measured();
        Value value{0.0, 0.0};
        for (std::size_t z = 0; z < counts_.size(); ++z) {
            const double d = excess(z);
            value.distance += 2.0 * d * d;
            value.floor += chance_floor(spread({}, z), static_cast<std::size_t>(counts_[z].thrown), simulated_);
        }
        return value;
    }

    double slope_variance() const override {
        if (!counts_.empty()) {  // each column for itself
            double sum = 0.0;
            for (std::size_t z = 0; z < counts_.size(); ++z) {
                const double p = share_of(counts_[z]), slope = 4.0 * excess(z);
                sum += slope * slope * p * (1.0 - p) / static_cast<double>(counts_[z].thrown);
            }
            return sum;
        }
        const double n = number(measured_members_.size());
        std::vector<double> slope(measured_members_.size(), 0.0);
        for (std::size_t z = 0; z < pool_.dimension; ++z) {
            const double measured_hits = hits(measured_members_, z);
            const double difference = measured_hits / n - (total_hits(z) - measured_hits) / number(simulated_);
            for (std::size_t i = 0; i < slope.size(); ++i)
                slope[i] += 4.0 * difference * pool_[measured_members_[i]][z];
        }
        return variance(slope) / n;
    }

private:
    static double share_of(const ObservedShare& c) {
        return static_cast<double>(c.count) / static_cast<double>(c.thrown);
    }
    double total_hits(std::size_t z) const {
        double sum = 0.0;
        for (const auto& of_stratum : hits_) sum += of_stratum[z];
        return sum;
    }
    double hits(std::span<const std::uint32_t> members, std::size_t z) const {
        double sum = 0.0;
        for (const std::uint32_t m : members) sum += pool_[m][z];
        return sum;
    }
    double excess(std::size_t z) const { return share_of(counts_[z]) - total_hits(z) / number(simulated_); }

    /// 2 q (1-q) within the strata without the members, at least that of half a block of all.
    double spread(std::span<const std::uint32_t> members, std::size_t z) const {
        double sum = 0.0;
        for (std::size_t s = 0; s < strata_.size(); ++s) {
            const auto of_stratum = strata_.size() > 1 && !members.empty() ? members.subspan(s, 1) : members;
            const double n = number(strata_[s].size() - of_stratum.size()), q = (hits_[s][z] - hits(of_stratum, z)) / n;
            sum += 2.0 * q * (1.0 - q) * n / (n - 1.0);
        }
        const double half = 0.5 / number(pool_.size() - members.size() + 1);
        return std::max(sum / number(strata_.size()), 2.0 * half * (1.0 - half));
    }

    PointSample pool_;
    std::vector<ObservedShare> counts_;
    std::vector<std::vector<double>> hits_;  ///< per stratum and column [-]
};

}  // namespace

GapStatistic::GapStatistic(const ObservableSample& sample)
    : strata_(sample.strata), simulated_(sample.simulated.size()), drawn_(sample.measured.size()) {
    for (std::size_t k = 0; k < sample.measured.size(); ++k) {
        const auto member = static_cast<std::uint32_t>(simulated_ + k);
        measured_members_.push_back(member);
        strata_[strata_.size() > 1 ? k : 0].push_back(member);
    }
}

std::vector<std::uint32_t> GapStatistic::draw_members(RandomStream& random) const {
    std::vector<std::uint32_t> drawn;
    if (strata_.size() > 1) {
        for (const auto& members : strata_) drawn.push_back(members[random.below(members.size())]);
        return drawn;
    }
    // the first places of a shuffle (Fisher & Yates)
    std::vector<std::uint32_t> left = strata_.front();
    for (std::size_t k = 0; k < drawn_; ++k) {
        std::swap(left[k], left[k + random.below(left.size() - k)]);
        drawn.push_back(left[k]);
    }
    return drawn;
}

std::unique_ptr<GapStatistic> make_gap_statistic(const Observable& observable, const ObservableSample& sample) {
    if (observable.share) return std::make_unique<ShareStatistic>(sample, observable);
    return std::make_unique<DistanceStatistic>(sample);
}

// --- scores ---

ScoreStatistic::ScoreStatistic(const ScoreInput& input) {
    for (const ScoreInput::Block& block : input.blocks) {
        PointSample pool{block.repeats.dimension, block.observation};
        pool.values.insert(pool.values.end(), block.repeats.values.begin(), block.repeats.values.end());
        SCREE_ASSERT(pool.size() > kLeastRepeats);
        std::vector<std::uint32_t> all(pool.size());
        std::iota(all.begin(), all.end(), 0U);
        const std::vector<double> sums = distance_sums(pool, all);
        const double among = std::accumulate(sums.begin(), sums.end(), 0.0), M = number(pool.size() - 1);
        std::vector<double> score, floor;
        for (const double to_others : sums) {
            floor.push_back((among - 2.0 * to_others) / (2.0 * M * (M - 1.0)));
            score.push_back(to_others / M - floor.back());
        }
        score_.push_back(std::move(score));
        floor_.push_back(std::move(floor));
    }
}

double ScoreStatistic::mean_score() const {
    double sum = 0.0;
    for (const auto& of_block : score_) sum += of_block.front();
    return sum / number(score_.size());
}

double ScoreStatistic::floor() const {
    double sum = 0.0;
    for (const auto& of_block : floor_) sum += of_block.front();
    return sum / number(floor_.size());
}

double ScoreStatistic::standard_error() const {
    std::vector<double> excess;
    for (std::size_t i = 0; i < score_.size(); ++i) excess.push_back(score_[i].front() - floor_[i].front());
    // what is expected of a block is itself known from its M repeats only
    const double M = number(score_.front().size() - 1);
    return std::sqrt(variance(excess) / number(excess.size()) * (M + 1.0) / (M - 1.0));
}

double ScoreStatistic::draw(RandomStream& random) const {
    double score = 0.0, floor = 0.0;
    for (std::size_t i = 0; i < score_.size(); ++i) {
        const std::size_t m = random.below(score_[i].size());
        score += score_[i][m];
        floor += floor_[i][m];
    }
    return score / floor;
}

}  // namespace scree
