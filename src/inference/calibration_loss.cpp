// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/calibration_loss.hpp"

#include "inference/gap_statistic.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace scree {

namespace {

/// Score of an observation and what one more of the members would have on average.
struct Score {
    double score = 0.0;
    double floor = 0.0;
};

/// Columns together, or, for shares, one after the other.
std::vector<PointSample> columns_of(const PointSample& points, bool share) {
    if (!share) return {points};
    std::vector<PointSample> columns(points.dimension);
    for (std::size_t k = 0; k < points.values.size(); ++k)
        columns[k % points.dimension].values.push_back(points.values[k]);
    return columns;
}

/// Mean distance of different members.
double mean_distance(const PointSample& points) {
    if (points.dimension == 1) return mean_difference(points.values);
    double sum = 0.0;
    const auto n = static_cast<double>(points.size());
    for (std::size_t k = 0; k < points.size(); ++k)
        for (std::size_t l = 0; l < k; ++l) sum += point_distance(points[k], points[l]);
    return 2.0 * sum / (n * (n - 1.0));
}

/// Repeats that are all alike are believed to scatter by this share of the yardstick of what was measured, all the same [-].
constexpr double kLeastSpread = 0.05;
constexpr double kNoSpread = 1e-6;  // where all that was measured is alike, too [unit of the values]

/// Minus the logarithm of what members say of one more of them, column by column: of numbers Student's distribution, as if they were normal with unknown mean
/// and variance; of shares the share itself, half a member added on either side.
class LogForecast {
public:
    LogForecast(const PointSample& members, bool share, const std::vector<double>& least_spread)
        : share_(share), n_(static_cast<double>(members.size())) {
        for (std::size_t c = 0; c < members.dimension; ++c) {
            double sum = 0.0, squares = 0.0;
            for (std::size_t m = 0; m < members.size(); ++m) sum += members[m][c];
            const double mean = sum / n_;
            for (std::size_t m = 0; m < members.size(); ++m) squares += (members[m][c] - mean) * (members[m][c] - mean);
            const double deviation = std::max(std::sqrt(squares / (n_ - 1.0)), least_spread[c]);
            add_column(share ? (sum + 0.5) / (n_ + 1.0) : mean, deviation * std::sqrt(1.0 + 1.0 / n_));
        }
    }
    /// Where too few say anything: as wide as measured values are far from nothing, and with as little sureness as the fewest members have.
    explicit LogForecast(const std::vector<double>& far) : share_(false), n_(static_cast<double>(kLeastRepeats)) {
        for (const double f : far) add_column(0.0, f);
    }
    double loss(std::span<const double> observation) const {
        double loss = 0.0;
        for (std::size_t c = 0; c < observation.size(); ++c) {
            if (share_) {
                loss -= std::log(observation[c] > 0.5 ? mean_[c] : 1.0 - mean_[c]);
                continue;
            }
            const double z = (observation[c] - mean_[c]) / scale_[c];
            loss += at_mean_[c] + 0.5 * n_ * std::log1p(z * z / (n_ - 1.0));
        }
        return loss;
    }

private:
    void add_column(double mean, double scale) {
        const double freedom = n_ - 1.0;
        mean_.push_back(mean);
        scale_.push_back(scale);
        at_mean_.push_back(std::lgamma(0.5 * freedom) - std::lgamma(0.5 * (freedom + 1.0)) +
                           0.5 * std::log(freedom * std::numbers::pi) + std::log(scale));
    }

    bool share_;
    double n_;
    std::vector<double> mean_, scale_, at_mean_;  ///< per column; the loss at the mean
};

/// Energy scores against members whose mean distance is known once for all observations.
class Forecast {
public:
    Forecast(PointSample members, bool share) : columns_(columns_of(members, share)) {
        for (const PointSample& column : columns_) floor_ += 0.5 * mean_distance(column);
    }
    Score score(std::span<const double> observation) const {
        double to_members = 0.0;
        std::size_t at = 0;
        for (const PointSample& column : columns_) {
            const auto own = observation.subspan(at, column.dimension);
            at += column.dimension;
            double sum = 0.0;
            for (std::size_t m = 0; m < column.size(); ++m) sum += point_distance(own, column[m]);
            to_members += sum / static_cast<double>(column.size());
        }
        return {to_members - floor_, floor_};
    }

private:
    std::vector<PointSample> columns_;
    double floor_ = 0.0;
};

void append(PointSample& sample, const std::vector<double>& point) {
    sample.values.insert(sample.values.end(), point.begin(), point.end());
}

/// Half the mean difference of measured values; of shares with half a block on either side, so that nothing weighs infinitely.
double yardstick(const PointSample& measured, bool share) {
    double sum = 0.0;
    for (const PointSample& column : columns_of(measured, share)) {
        const auto n = static_cast<double>(column.size());
        if (!share) {
            sum += 0.5 * mean_distance(column);
            continue;
        }
        double hits = 0.5;
        for (const double v : column.values) hits += v;
        const double p = hits / (n + 1.0);
        sum += p * (1.0 - p);
    }
    return sum;
}

/// A motion of known blocks at a screen, that counts as none where they have not passed it.
bool is_motion_or_none(const Observable& observable) {
    return observable.matched && !observable.share && observable.columns.front().place >= 0;
}

/// Stops and the zones that they are counted in are one place. Impacts that were filmed take no part.
std::string place_of(const Observable& observable, const ObservationOperator& op) {
    const Column& c = observable.columns.front();
    if (c.place < 0 || c.quantity == Quantity::InZone) return "stops";
    SCREE_ASSERT(!op.is_impact(c.place));
    return op.screens[static_cast<std::size_t>(c.place)];
}

}  // namespace

CalibrationLoss::CalibrationLoss(GapFunction function) : function_(std::move(function)) {
    records_ = function_.measured().rows();
    std::vector<double> yardsticks;
    for (const Observable& observable : function_.observables()) {
        if (!observable.overall) continue;
        Part part;
        part.observable = observable;
        const double length = observable.counts.empty() ? add_rows(part) : add_counts(part);
        if (part.measured.records.size() < 2 || !(length > 0.0)) continue;
        yardsticks.push_back(length);
        const std::string place = place_of(observable, function_.op());
        part.place = static_cast<std::size_t>(std::find(places_.begin(), places_.end(), place) - places_.begin());
        if (part.place == places_.size()) places_.push_back(place);
        parts_.push_back(std::move(part));
    }
    // so that the mean over all records is the mean over the observables of their mean scores in units of the yardstick
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        const double share = static_cast<double>(parts_[k].measured.records.size()) / static_cast<double>(records_);
        parts_[k].weight = 1.0 / (share * yardsticks[k] * static_cast<double>(parts_.size()));
    }
    find_likelihoods();
}

/// What the logarithmic score looks at: the parts, but of known blocks at a screen who passed, once, and how those moved that did: a distribution of numbers that
/// are 0 for all who did not pass is like no normal one, and would reward to deny what is rare.
void CalibrationLoss::find_likelihoods() {
    const auto add = [&](const Observable& observable, bool of_block, Values measured) {
        if (measured.points.empty()) return;
        Likelihood likelihood{observable, of_block, std::move(measured), {}, {}};
        for (std::size_t c = 0; c < observable.columns.size(); ++c) {
            std::vector<double> column;
            double squares = 0.0;
            for (const std::vector<double>& point : likelihood.measured.points) {
                column.push_back(point[c]);
                squares += point[c] * point[c];
            }
            const double spread = column.size() > 1 ? kLeastSpread * 0.5 * mean_difference(column) : 0.0;
            likelihood.least_spread.push_back(std::max(spread, kNoSpread));
            likelihood.far.push_back(
                std::max(std::sqrt(squares / static_cast<double>(column.size())), likelihood.least_spread.back()));
        }
        likelihoods_.push_back(std::move(likelihood));
    };
    std::set<std::int32_t> screens;  // of which it has been asked who passed
    for (const Part& part : parts_) {
        if (!is_motion_or_none(part.observable)) {
            add(part.observable, part.observable.matched, part.measured);
            continue;
        }
        const Column passed{Quantity::Passed, part.observable.columns.front().place};
        if (screens.insert(passed.place).second) {
            const Observable passing{"", "-", {passed}, true, true, false, {}};
            add(passing, true, measured_of(passing, true));
        }
        Observable moving = part.observable;
        moving.matched = false;  // nothing where a block did not pass
        add(moving, true, measured_of(moving, true));
    }
}

CalibrationLoss::Values CalibrationLoss::measured_of(const Observable& observable, bool of_block) const {
    const ObservationTable& measured = function_.measured();
    Values values;
    for (std::size_t row = 0; row < measured.rows(); ++row) {
        std::vector<double> point = point_of(measured, row, observable);
        if (point.empty() || (of_block && measured.block[row] < 0)) continue;
        values.records.push_back(row);
        values.points.push_back(std::move(point));
    }
    return values;
}

double CalibrationLoss::add_rows(Part& part) const {
    part.measured = measured_of(part.observable, part.observable.matched);
    PointSample points{part.observable.columns.size(), {}};
    for (const std::vector<double>& point : part.measured.points) append(points, point);
    return points.size() < 2 ? 0.0 : yardstick(points, part.observable.share);
}

double CalibrationLoss::add_counts(Part& part) {
    const std::vector<ObservedShare>& counts = part.observable.counts;
    std::int64_t thrown = 0;
    double length = 0.0;
    for (const ObservedShare& c : counts) {
        thrown = std::max(thrown, c.thrown);
        const double p = (static_cast<double>(c.count) + 0.5) / (static_cast<double>(c.thrown) + 1.0);
        length += p * (1.0 - p);
    }
    // blocks of no name: zone after zone as many as were counted, the rest elsewhere; zones exclude each other if their counts allow it
    std::int64_t first = 0;
    part.measured.points.assign(static_cast<std::size_t>(thrown), std::vector<double>(counts.size(), 0.0));
    for (std::size_t z = 0; z < counts.size(); ++z) {
        const double share =
            static_cast<double>(counts[z].count) / static_cast<double>(std::max<std::int64_t>(counts[z].thrown, 1));
        const auto hits = std::llround(share * static_cast<double>(thrown));
        for (std::int64_t k = 0; k < hits; ++k)
            part.measured.points[static_cast<std::size_t>((first + k) % thrown)][z] = 1.0;
        first += hits;
    }
    for (std::int64_t k = 0; k < thrown; ++k) part.measured.records.push_back(records_++);
    return length;
}

std::vector<CalibrationPath> CalibrationLoss::paths() const {
    const Observations& o = function_.observations();
    if (!o.matched) return {};
    std::vector<CalibrationPath> paths;
    for (const std::string& name : o.paths) paths.push_back({name, {}});
    const std::vector<std::int32_t>& block_of = function_.measured().block;
    for (std::size_t row = 0; row < block_of.size(); ++row) {
        if (block_of[row] < 0) continue;
        const std::int32_t path = o.blocks[static_cast<std::size_t>(block_of[row])].path;
        if (path >= 0) paths[static_cast<std::size_t>(path)].records.push_back(row);
    }
    std::erase_if(paths, [](const CalibrationPath& path) { return path.records.size() < kLeastOnPath; });
    return paths;
}

void CalibrationLoss::describe(CalibrationProblem& problem) const {
    problem.records = records();
    problem.places = places();
    problem.paths = paths();
}

std::vector<std::string> CalibrationLoss::observables() const {
    std::vector<std::string> names;
    for (const Part& part : parts_) names.push_back(part.observable.name);
    return names;
}

/// Simulated values by block, -1: of all of them.
static std::map<std::int32_t, PointSample> members_of(const Observable& o, bool of_block,
                                                      const ObservationTable& simulated) {
    const std::vector<char> use =
        balanced_rows(simulated, o.columns.size() > 1 && !o.share ? kMostPoints : simulated.rows());
    std::map<std::int32_t, PointSample> members;
    for (std::size_t row = 0; row < simulated.rows(); ++row) {
        if (!use[row]) continue;
        const std::vector<double> point = point_of(simulated, row, o);
        if (point.empty()) continue;
        PointSample& own = members[of_block ? simulated.block[row] : -1];
        own.dimension = o.columns.size();
        append(own, point);
    }
    return members;
}

bool CalibrationLoss::add_scores(const Part& part, const ObservationTable& simulated, SimulatedLoss& loss) const {
    const Observable& o = part.observable;
    const std::map<std::int32_t, PointSample> members = members_of(o, o.matched, simulated);
    std::map<std::int32_t, Forecast> forecasts;
    for (std::size_t k = 0; k < part.measured.records.size(); ++k) {
        const std::int32_t block = o.matched ? function_.measured().block[part.measured.records[k]] : -1;
        auto forecast = forecasts.find(block);
        if (forecast == forecasts.end()) {
            const auto own = members.find(block);
            if (own == members.end() || own->second.size() < kLeastRepeats) return false;
            forecast = forecasts.try_emplace(block, own->second, o.share).first;
        }
        const Score score = forecast->second.score(part.measured.points[k]);
        const std::size_t record = part.measured.records[k];
        loss.loss[record] += part.weight * score.score;
        loss.floor[record] += part.weight * score.floor;
        loss.loss_at[part.place][record] += part.weight * score.score;
        loss.floor_at[part.place][record] += part.weight * score.floor;
    }
    return true;
}

void CalibrationLoss::add_log_scores(const Likelihood& likelihood, const ObservationTable& simulated,
                                     std::vector<double>& log_loss) const {
    const Observable& o = likelihood.observable;
    const std::map<std::int32_t, PointSample> members = members_of(o, likelihood.of_block, simulated);
    PointSample together{o.columns.size(), {}};
    for (const auto& [block, own] : members) append(together, own.values);
    const auto forecast_of = [&](std::int32_t block) {
        if (const auto own = members.find(block); own != members.end() && own->second.size() >= kLeastRepeats)
            return LogForecast(own->second, o.share, likelihood.least_spread);
        if (together.size() >= kLeastRepeats) return LogForecast(together, o.share, likelihood.least_spread);
        return LogForecast(likelihood.far);
    };
    std::map<std::int32_t, LogForecast> forecasts;
    for (std::size_t k = 0; k < likelihood.measured.records.size(); ++k) {
        const std::size_t record = likelihood.measured.records[k];
        const std::int32_t block = likelihood.of_block ? function_.measured().block[record] : -1;
        auto forecast = forecasts.find(block);
        if (forecast == forecasts.end()) forecast = forecasts.emplace(block, forecast_of(block)).first;
        log_loss[record] += forecast->second.loss(likelihood.measured.points[k]);
    }
}

SimulatedLoss CalibrationLoss::operator()(const CampaignResult& campaign, std::uint64_t seed) const {
    const ObservationTable simulated = function_.simulated(campaign, seed);
    const std::vector<double> none(records_, 0.0);
    const std::vector<std::vector<double>> none_at(places_.size(), none);
    SimulatedLoss loss{none, none, none_at, none_at, none};
    for (const Part& part : parts_)
        if (!add_scores(part, simulated, loss)) return {};
    for (const Likelihood& likelihood : likelihoods_) add_log_scores(likelihood, simulated, loss.log_loss);
    return loss;
}

}  // namespace scree
