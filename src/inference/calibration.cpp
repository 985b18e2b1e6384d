// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/calibration.hpp"

#include "inference/calibration_plan.hpp"
#include "inference/calibration_surroundings.hpp"
#include "inference/cma_es.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scree {

namespace {

constexpr double kFirstStep = 0.2;  // standard deviation of the first generation, in shares of the range [-]
constexpr double kFirstHalf = 0.2;  // half width of the first box around the best point [-]
constexpr double kApart = 0.25;     // starts of one level are so far apart if they can be, in shares of the range [-]
constexpr std::int64_t kRaceDraws = 1000;  // of the records, for how far a level is behind [-]
constexpr double kDescribes = 0.5;   // share of the variance of losses that a quadratic worth the name explains [-]
constexpr std::size_t kBestFew = 3;  // points that others are held against [-]
constexpr double kSurely = 3.0;      // standard errors by which a point is surely worse than they are [-]

/// Streams of random numbers for different uses.
enum Stream : std::uint64_t { kScreening, kHypercube, kRace, kJudgement, kFolds, kDraws, kBehind, kDesign, kMany = 64 };
constexpr std::uint64_t kSearchStreams = 1ULL << 20, kSurroundingStreams = 1ULL << 40;

struct Stopped {};

class Calibration {
public:
    Calibration(const CalibrationProblem& problem, const CalibrationSettings& settings, const LossFunction& function,
                CalibrationJournal& journal, const std::function<void(const CalibrationProgress&)>& progress)
        : problem_(problem),
          s_(settings),
          function_(function),
          journal_(journal),
          progress_(progress),
          plan_(problem, settings) {}

    CalibrationResult run() {
        result_.start = start_point();
        try {
            search();
            race();
            if (plan_.dimension > 0) look_around();
            judge();
        } catch (const Stopped&) {
            result_ = {};
            result_.start = start_point();
            result_.interrupted = true;
        }
        return std::move(result_);
    }

private:
    RandomStream stream(std::uint64_t number) const { return {s_.seed, number, RandomPurpose::Calibration}; }
    /// Of a simulation; 62 bits, so that it fits into whatever people write seeds in.
    std::uint64_t seed(std::uint64_t number) const { return stream(number).bits() >> 2; }

    CalibrationPoint start_point() const {
        CalibrationPoint point;
        for (const CalibrationParameter& p : problem_.parameters)
            point.values.push_back(std::isfinite(p.start) ? p.start : value_of(p, 0.5));
        for (const CalibrationChoice& c : problem_.choices) point.levels.push_back(c.start);
        return point;
    }
    CalibrationPoint point_at(const Eigen::VectorXd& u, const std::vector<std::size_t>& levels) const {
        CalibrationPoint point;
        point.levels = levels;
        for (std::size_t i = 0; i < plan_.dimension; ++i)
            point.values.push_back(value_of(problem_.parameters[i], reflected(u[static_cast<Eigen::Index>(i)])));
        return point;
    }
    Eigen::VectorXd unit_point(const CalibrationPoint& point) const {
        Eigen::VectorXd u(static_cast<Eigen::Index>(plan_.dimension));
        for (std::size_t i = 0; i < plan_.dimension; ++i)
            u[static_cast<Eigen::Index>(i)] = unit_of(problem_.parameters[i], point.values[i]);
        return u;
    }

    /// Runs a simulation, or takes it from the journal. What is returned holds until the next one.
    const SimulatedLoss& evaluate(CalibrationStage stage, CalibrationPoint point, std::uint64_t seed,
                                  std::int64_t repeats) {
        const CalibrationTask task{stage, std::move(point), seed, repeats};
        const bool known = done_ < journal_.size();
        if (known && !(journal_[done_].task == task))
            throw InputError(
                "the journal of the calibration belongs to another problem or other settings: its simulation " +
                std::to_string(done_ + 1) +
                " is not the one that comes next; restore the settings, or begin anew without it");
        if (!known) {
            std::optional<SimulatedLoss> result = function_(task);
            if (!result) throw Stopped{};
            SCREE_ASSERT(result->loss.size() == result->floor.size());
            SCREE_ASSERT(result->loss.empty() || result->loss.size() == problem_.records);
            SCREE_ASSERT(result->loss.empty() || result->loss_at.size() == problem_.places.size());
            SCREE_ASSERT(result->log_loss.empty() || result->log_loss.size() == problem_.records);
            journal_.push_back({task, std::move(*result)});
        }
        const SimulatedLoss& loss = journal_[done_++].result;
        const CalibrationFit fit = fit_of(loss, {});
        if (fit.loss < least_loss_) {
            least_loss_ = fit.loss;
            best_gap_ = fit.gap();
        }
        if (progress_) progress_({stage, done_, plan_.total(), fit.gap(), best_gap_});
        return loss;
    }

    /// Over the records with 1, or over all. Infinite where nothing can be said.
    static CalibrationFit fit_of(const SimulatedLoss& result, const std::vector<char>& records) {
        CalibrationFit fit{0.0, 0.0};
        double n = 0.0;
        for (std::size_t k = 0; k < result.loss.size(); ++k) {
            if (!records.empty() && !records[k]) continue;
            fit.loss += result.loss[k];
            fit.floor += result.floor[k];
            n += 1.0;
        }
        if (n == 0.0 || !std::isfinite(fit.loss)) return {kInfinity, kNaN};
        return {fit.loss / n, fit.floor / n};
    }

    // --- search ---

    void search() {
        for (std::size_t l = 0; l < plan_.levels.size(); ++l) {
            if (plan_.dimension == 0) {
                CalibrationSearch alone;
                alone.begin.levels = alone.end.levels = plan_.levels[l];
                result_.searches.push_back(alone);
                continue;
            }
            const std::vector<Eigen::VectorXd> starts = screen(plan_.levels[l]);
            for (std::size_t s = 0; s < starts.size(); ++s) {
                const std::uint64_t number = kSearchStreams * (1 + l * plan_.starts + s);
                result_.searches.push_back(descend(starts[s], plan_.levels[l], number));
            }
        }
    }

    /// The best points of a Latin hypercube that are not too close to each other; the uncalibrated model is the first candidate.
    std::vector<Eigen::VectorXd> screen(const std::vector<std::size_t>& levels) {
        RandomStream random = stream(kHypercube);
        std::vector<Eigen::VectorXd> points = latin_hypercube(plan_.dimension, plan_.screening, random);
        points.front() = unit_point(result_.start);
        std::vector<std::pair<double, std::size_t>> ranked;
        for (std::size_t k = 0; k < points.size(); ++k) {
            const SimulatedLoss& result =
                evaluate(CalibrationStage::Screening, point_at(points[k], levels), seed(kScreening), s_.search_repeats);
            ranked.emplace_back(fit_of(result, {}).loss, k);
        }
        std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        std::vector<Eigen::VectorXd> starts;
        for (const double apart : {kApart, 0.0})
            for (const auto& [loss, k] : ranked) {
                const auto close = [&](const Eigen::VectorXd& s) { return (s - points[k]).norm() <= apart; };
                if (starts.size() < plan_.starts && std::none_of(starts.begin(), starts.end(), close))
                    starts.push_back(points[k]);
            }
        return starts;
    }

    CalibrationSearch descend(const Eigen::VectorXd& from, const std::vector<std::size_t>& levels,
                              std::uint64_t number) {
        CmaEs strategy(from, kFirstStep, static_cast<int>(plan_.population), stream(number));
        double least = kInfinity;
        best_seen_.push_back(point_at(from, levels));
        for (std::size_t g = 0; g < plan_.generations; ++g) {
            std::vector<double> losses;
            for (const Eigen::VectorXd& u : strategy.ask()) {
                const CalibrationPoint point = point_at(u, levels);
                losses.push_back(
                    fit_of(evaluate(CalibrationStage::Search, point, seed(number + 1 + g), s_.search_repeats), {})
                        .loss);
                if (losses.back() >= least) continue;
                least = losses.back();
                best_seen_.back() = point;
            }
            strategy.tell(losses);
        }
        CalibrationSearch found;
        found.begin = point_at(from, levels);
        found.end = point_at(strategy.mean(), levels);
        return found;
    }

    /// The ends of all searches against each other, with the same random numbers. A search that has not come to its end in so few generations has its mean
    /// between valleys: the best point that it has seen and the one it began at compete with it.
    void race() {
        const auto n = static_cast<Eigen::Index>(problem_.records);
        std::vector<Eigen::VectorXd> losses;
        const auto run = [&](CalibrationSearch& s) {
            Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
            s.fit = {0.0, 0.0};
            for (std::size_t k = 0; k < kRaceSeeds; ++k) {
                const SimulatedLoss& result =
                    evaluate(CalibrationStage::Race, s.end, seed(kRace + kMany * (1 + k)), s_.repeats);
                const CalibrationFit fit = fit_of(result, {});
                s.fit.loss += fit.loss / kRaceSeeds;
                s.fit.floor += fit.floor / kRaceSeeds;
                if (!result.loss.empty()) sum += Eigen::Map<const Eigen::VectorXd>(result.loss.data(), n) / kRaceSeeds;
            }
            return sum;
        };
        for (std::size_t k = 0; k < result_.searches.size(); ++k) {
            CalibrationSearch& s = result_.searches[k];
            losses.push_back(run(s));
            if (plan_.dimension == 0) continue;
            for (const CalibrationPoint& point : {best_seen_[k], CalibrationPoint(s.begin)}) {
                CalibrationSearch other = s;
                other.end = point;
                const Eigen::VectorXd of_other = run(other);
                if (!(other.fit.loss < s.fit.loss)) continue;
                s = std::move(other);
                losses.back() = of_other;
            }
        }
        std::vector<std::size_t> order(result_.searches.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return result_.searches[a].fit.loss < result_.searches[b].fit.loss;
        });
        if (!std::isfinite(result_.searches[order.front()].fit.loss))
            throw InputError(
                "no simulation of the calibration could be held against the measurements: look at the first one with "
                "scree compare");
        std::vector<CalibrationSearch> sorted;
        for (const std::size_t k : order) {
            sorted.push_back(result_.searches[k]);
            if (k != order.front() && std::isfinite(sorted.back().fit.loss))
                sorted.back().behind = interval_of_mean(losses[k] - losses[order.front()]);
        }
        result_.searches = std::move(sorted);
        result_.best = result_.searches.front().end;
    }

    Interval interval_of_mean(const Eigen::VectorXd& differences) const {
        RandomStream random = stream(kBehind);
        std::vector<double> means;
        for (std::int64_t d = 0; d < kRaceDraws; ++d) {
            double sum = 0.0;
            for (std::size_t k = 0; k < problem_.records; ++k)
                sum += differences[static_cast<Eigen::Index>(random.below(problem_.records))];
            means.push_back(sum / static_cast<double>(problem_.records));
        }
        std::sort(means.begin(), means.end());
        return {sample_quantile(means, 0.025), sample_quantile(means, 0.975)};
    }

    // --- surroundings of the best point ---

    struct Looked {
        std::vector<Eigen::VectorXd> points;
        std::vector<std::size_t> evaluations;  ///< in the journal
        void drop(std::size_t first) {
            points.erase(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(first));
            evaluations.erase(evaluations.begin(), evaluations.begin() + static_cast<std::ptrdiff_t>(first));
        }
    };

    /// What screening and search found out about the best level.
    Looked seen_in_search() const {
        Looked seen;
        for (std::size_t k = 0; k < done_; ++k) {
            const CalibrationEvaluation& e = journal_[k];
            if (e.task.stage > CalibrationStage::Search || e.task.point.levels != result_.best.levels ||
                !std::isfinite(fit_of(e.result, {}).loss))
                continue;
            seen.points.push_back(unit_point(e.task.point));
            seen.evaluations.push_back(k);
        }
        return seen;
    }

    void look_around() {
        const Eigen::VectorXd half = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(plan_.dimension), kFirstHalf);
        UnitBox box = box_around(unit_point(result_.best), half);
        looked_ = seen_in_search();
        std::size_t own = 0;
        for (std::size_t round = 0; round < kSurroundingRounds; ++round) {
            const std::size_t first = round * plan_.surroundings / kSurroundingRounds,
                              last = (round + 1) * plan_.surroundings / kSurroundingRounds;
            const std::size_t before = looked_.points.size();
            look_into(box, last - first, first);
            if (round == 0)
                own =
                    before;  // what the search saw helps to choose the box; its noise is not independent from point to point
            else
                looked_.drop(own);
            fit_ = fit_of_looked(box, [](const SimulatedLoss& all) { return all.loss; });
            spread_ = spread_of_minimum(*fit_, box, problem_.records, s_.draws, stream(kDraws));
            box_ = box;
            if (round + 1 < kSurroundingRounds) box = closer_box(spread_, box);
        }
        result_.best.values = point_at(spread_.best, {}).values;
        describe();
    }

    void look_into(const UnitBox& box, std::size_t count, std::size_t first) {
        RandomStream random = stream(kDesign + kMany * (1 + first));
        std::size_t number = first;
        for (const Eigen::VectorXd& u : latin_hypercube(plan_.dimension, count, random)) {
            const Eigen::VectorXd point = box.centre + box.half.cwiseProduct(2.0 * u - Eigen::VectorXd::Ones(u.size()));
            const SimulatedLoss& result = evaluate(CalibrationStage::Surroundings, point_at(point, result_.best.levels),
                                                   seed(kSurroundingStreams + number++), s_.repeats);
            if (!std::isfinite(fit_of(result, {}).loss)) continue;
            looked_.points.push_back(point);
            looked_.evaluations.push_back(done_ - 1);
        }
    }

    template <class Losses>
    QuadraticFit fit_of_looked(const UnitBox& box, const Losses& losses_of) const {
        if (looked_.points.size() < QuadraticFit::coefficients(plan_.dimension) + 2)
            throw InputError(
                "too few simulations around the best point could be held against the measurements: narrow the ranges "
                "of the free parameters");
        Eigen::MatrixXd losses(static_cast<Eigen::Index>(looked_.points.size()),
                               static_cast<Eigen::Index>(problem_.records));
        for (std::size_t k = 0; k < looked_.points.size(); ++k) {
            const std::vector<double> of_point = losses_of(journal_[looked_.evaluations[k]].result);
            losses.row(static_cast<Eigen::Index>(k)) =
                Eigen::Map<const Eigen::RowVectorXd>(of_point.data(), static_cast<Eigen::Index>(problem_.records));
        }
        return {looked_.points, losses, box};
    }

    void describe() {
        const std::vector<CalibrationParameter>& p = problem_.parameters;
        const auto n = static_cast<Eigen::Index>(problem_.records);
        const Eigen::VectorXd even = Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
        result_.parameters = estimates_of(spread_, p, tried());
        widen(spread_, p, result_.parameters);
        result_.correlation = correlation_of(spread_);
        result_.directions = directions_of(spread_);
        result_.surroundings = {fit_->points(), fit_->noise(even), fit_->explained(even), true, {}, {}};
        for (std::size_t i = 0; i < p.size(); ++i) {
            const auto k = static_cast<Eigen::Index>(i);
            result_.surroundings.low.push_back(value_of(p[i], box_.centre[k] - box_.half[k]));
            result_.surroundings.high.push_back(value_of(p[i], box_.centre[k] + box_.half[k]));
        }
        for (Eigen::Index d = 0; d < spread_.draws.rows(); ++d)
            result_.draws.push_back(point_at(spread_.draws.row(d).transpose(), {}).values);
        for (CalibrationSearch& s : result_.searches) {
            s.same_minimum = s.end.levels == result_.best.levels;
            for (std::size_t i = 0; i < p.size() && s.same_minimum; ++i) {
                const Interval& within = result_.parameters[i].interval;
                const double slack = 0.5 * (within.high - within.low);
                s.same_minimum = s.end.values[i] >= within.low - slack && s.end.values[i] <= within.high + slack;
            }
        }
    }

    /// What was simulated of the best level. Surely worse: its records lose more than those of the best few together, by kSurely standard errors.
    std::vector<TriedPoint> tried() const {
        std::vector<std::pair<double, std::size_t>> ranked;
        for (std::size_t k = 0; k < done_; ++k) {
            const CalibrationEvaluation& e = journal_[k];
            const double loss = fit_of(e.result, {}).loss;
            if (e.task.stage <= CalibrationStage::Surroundings && e.task.point.levels == result_.best.levels &&
                std::isfinite(loss))
                ranked.emplace_back(loss, k);
        }
        std::sort(ranked.begin(), ranked.end());
        const auto n = static_cast<Eigen::Index>(problem_.records);
        const auto losses = [&](std::size_t k) {
            return Eigen::Map<const Eigen::ArrayXd>(journal_[k].result.loss.data(), n);
        };
        const std::size_t few = std::min(kBestFew, ranked.size());
        Eigen::ArrayXd best = Eigen::ArrayXd::Zero(n);
        for (std::size_t k = 0; k < few; ++k) best += losses(ranked[k].second) / static_cast<double>(few);
        std::vector<TriedPoint> points;
        for (const auto& [loss, k] : ranked) {
            const Eigen::ArrayXd behind = losses(k) - best;
            const double mean = behind.mean(),
                         error = std::sqrt((behind - mean).square().sum() / static_cast<double>(n * (n - 1)));
            points.push_back({unit_point(journal_[k].task.point), mean > kSurely * error});
        }
        return points;
    }

    // --- judgement ---

    /// Something that was simulated stands where the quadratic led to something that is surely worse, or worse at all if it describes little.
    void keep_the_better(SimulatedLoss& best, const CalibrationPoint& point, const SimulatedLoss& searched) {
        const CalibrationFit fit = fit_of(searched, {});
        if (!std::isfinite(fit.loss)) return;
        if (std::isfinite(result_.best_fit.loss)) {
            const auto n = static_cast<Eigen::Index>(problem_.records);
            const Eigen::Map<const Eigen::VectorXd> a(best.loss.data(), n), b(searched.loss.data(), n);
            const bool describes = result_.surroundings.explained >= kDescribes;
            if (describes ? interval_of_mean(a - b).low <= 0.0 : fit.loss >= result_.best_fit.loss) return;
        }
        result_.surroundings.holds = false;
        best = searched;
        result_.best = point;
        result_.best_fit = fit;
        for (std::size_t i = 0; i < plan_.dimension; ++i) {
            const CalibrationParameter& p = problem_.parameters[i];
            const Interval& known = result_.parameters[i].interval;
            result_.parameters[i] =
                estimate_of(p, unit_of(p, point.values[i]), unit_of(p, known.low), unit_of(p, known.high));
            result_.parameters[i].value = point.values[i];  // to the last digit
        }
    }

    /// What was simulated and has the least loss.
    template <class Loss>
    std::vector<CalibrationPoint> best_simulated(const Loss& loss_of) const {
        std::vector<CalibrationPoint> points;
        std::vector<std::pair<double, std::size_t>> ranked;
        for (std::size_t k = 0; k < done_; ++k)
            if (journal_[k].task.stage <= CalibrationStage::Surroundings &&
                journal_[k].task.point.levels == result_.best.levels)
                ranked.emplace_back(loss_of(journal_[k].result), k);
        std::sort(ranked.begin(), ranked.end());
        for (const auto& [loss, k] : ranked) {
            const CalibrationPoint& point = journal_[k].task.point;
            if (points.size() == kSeen || !std::isfinite(loss)) break;
            if (std::find(points.begin(), points.end(), point) == points.end()) points.push_back(point);
        }
        return points;
    }

    /// Of what is known of a place, or of all others.
    static SimulatedLoss at_place(const SimulatedLoss& all, std::size_t place) {
        return all.loss.empty() ? SimulatedLoss{} : SimulatedLoss{all.loss_at[place], all.floor_at[place]};
    }
    static SimulatedLoss elsewhere(const SimulatedLoss& all, std::size_t place) {
        SimulatedLoss rest{all.loss, all.floor};
        for (std::size_t k = 0; k < rest.loss.size(); ++k) {
            rest.loss[k] -= all.loss_at[place][k];
            rest.floor[k] -= all.floor_at[place][k];
        }
        return rest;
    }

    const SimulatedLoss& judged(const CalibrationPoint& point) {
        return evaluate(CalibrationStage::Judgement, point, seed(kJudgement), s_.final_repeats);
    }

    void judge() {
        const SimulatedLoss start = judged(result_.start);
        SimulatedLoss best = judged(result_.best);
        result_.start_fit = fit_of(start, {});
        result_.best_fit = fit_of(best, {});
        if (plan_.dimension > 0) {
            std::vector<CalibrationPoint> rivals =
                best_simulated([](const SimulatedLoss& all) { return fit_of(all, {}).loss; });
            rivals.push_back(result_.searches.front().end);
            for (const CalibrationPoint& rival : rivals) keep_the_better(best, rival, judged(rival));
        }
        for (std::size_t p = 0; p < plan_.places; ++p)
            result_.places.push_back({.name = problem_.places[p],
                                      .start = fit_of(at_place(start, p), {}),
                                      .best = fit_of(at_place(best, p), {}),
                                      .held_out = {0.0, 0.0}});
        if (plan_.folds > 0) hold_blocks_out(start);
        for (std::size_t p = 0; p < plan_.places; ++p) leave_out(p);
        for (std::size_t p = 0; p < plan_.paths; ++p) leave_out(problem_.paths[p], start, best);
        for (CalibrationPlace& place : result_.places) place.was_seen = place.point == result_.best;
        result_.held_out_was_seen =
            !result_.folds.empty() && std::all_of(result_.folds.begin(), result_.folds.end(),
                                                  [&](const CalibrationFold& f) { return f.point == result_.best; });
    }

    /// The best of what a calibration that knows less may end at, by what it knows: where its quadratic leads, and what was simulated, for around an answer
    /// at the edge of what the model can do a quadratic leads astray. The points are simulated anew; `take` gets each that is better than those before.
    template <class Known, class Take>
    void calibrate_by(const QuadraticFit& fit, const std::vector<char>& records, const Known& known, const Take& take) {
        std::vector<CalibrationPoint> points =
            best_simulated([&](const SimulatedLoss& all) { return known(all).loss; });
        points.insert(points.begin(), point_at(minimum_for(fit, box_, records), result_.best.levels));
        double least = kInfinity;
        bool first = true;
        for (const CalibrationPoint& point : points) {
            const SimulatedLoss& result = judged(point);
            const bool silent = result.loss.empty() && &point != &points.back();  // its simulation says nothing
            const CalibrationFit training = known(result);
            if (silent || (!first && !(training.loss < least))) continue;
            first = false;
            least = training.loss;
            take(point, training, result);
        }
    }

    void hold_blocks_out(const SimulatedLoss& start) {
        std::vector<std::size_t> shuffled(problem_.records);
        std::iota(shuffled.begin(), shuffled.end(), std::size_t{0});
        RandomStream random = stream(kFolds);
        for (std::size_t k = shuffled.size(); k > 1; --k) std::swap(shuffled[k - 1], shuffled[random.below(k)]);
        result_.held_out = result_.held_out_start = {0.0, 0.0};
        result_.held_out_losses.assign(problem_.records, kNaN);
        result_.held_out_log_losses.assign(problem_.records, kNaN);
        std::vector<double> floors(problem_.records, kNaN);
        for (std::size_t f = 0; f < plan_.folds; ++f) {
            CalibrationFold fold;
            std::vector<char> training(problem_.records, 1), test(problem_.records, 0);
            for (std::size_t k = f; k < shuffled.size(); k += plan_.folds) {
                fold.held_out.push_back(shuffled[k]);
                training[shuffled[k]] = 0;
                test[shuffled[k]] = 1;
            }
            std::sort(fold.held_out.begin(), fold.held_out.end());
            std::vector<CalibrationFit> at_places(plan_.places);
            calibrate_by(
                *fit_, training, [&](const SimulatedLoss& all) { return fit_of(all, training); },
                [&](const CalibrationPoint& point, const CalibrationFit& known, const SimulatedLoss& result) {
                    fold.point = point;
                    fold.training = known;
                    fold.test = fit_of(result, test);
                    for (const std::size_t k : fold.held_out) {
                        result_.held_out_losses[k] = result.loss.empty() ? kNaN : result.loss[k];
                        floors[k] = result.loss.empty() ? kNaN : result.floor[k];
                        result_.held_out_log_losses[k] = result.log_loss.empty() ? kNaN : result.log_loss[k];
                    }
                    for (std::size_t p = 0; p < at_places.size(); ++p) at_places[p] = fit_of(at_place(result, p), test);
                });
            fold.start_test = fit_of(start, test);
            const double share = static_cast<double>(fold.held_out.size()) / static_cast<double>(problem_.records);
            const auto add = [&](CalibrationFit& sum, const CalibrationFit& fit) {
                sum.loss += share * fit.loss;
                sum.floor += share * fit.floor;
            };
            add(result_.held_out, fold.test);
            add(result_.held_out_start, fold.start_test);
            for (std::size_t p = 0; p < at_places.size(); ++p) add(result_.places[p].held_out, at_places[p]);
            result_.folds.push_back(std::move(fold));
        }
        held_out_ = {result_.held_out_losses, std::move(floors)};
    }

    void leave_out(std::size_t place) {
        CalibrationPlace& left = result_.places[place];
        const QuadraticFit fit =
            fit_of_looked(box_, [&](const SimulatedLoss& all) { return elsewhere(all, place).loss; });
        calibrate_by(
            fit, std::vector<char>(problem_.records, 1),
            [&](const SimulatedLoss& all) { return fit_of(elsewhere(all, place), {}); },
            [&](const CalibrationPoint& point, const CalibrationFit& known, const SimulatedLoss& result) {
                left.point = point;
                left.training = known;
                left.test = fit_of(at_place(result, place), {});
            });
    }

    void leave_out(const CalibrationPath& path, const SimulatedLoss& of_start, const SimulatedLoss& of_best) {
        std::vector<char> others(problem_.records, 1), own(problem_.records, 0);
        for (const std::size_t k : path.records) {
            others[k] = 0;
            own[k] = 1;
        }
        CalibrationPlace left;
        left.name = path.name;
        left.is_path = true;
        left.start = fit_of(of_start, own);
        left.best = fit_of(of_best, own);
        left.held_out = fit_of(held_out_, own);
        calibrate_by(
            *fit_, others, [&](const SimulatedLoss& all) { return fit_of(all, others); },
            [&](const CalibrationPoint& point, const CalibrationFit& known, const SimulatedLoss& result) {
                left.point = point;
                left.training = known;
                left.test = fit_of(result, own);
            });
        result_.places.push_back(std::move(left));
    }

    const CalibrationProblem& problem_;
    const CalibrationSettings& s_;
    const LossFunction& function_;
    CalibrationJournal& journal_;
    const std::function<void(const CalibrationProgress&)>& progress_;
    CalibrationPlan plan_;
    CalibrationResult result_;
    std::vector<CalibrationPoint> best_seen_;  ///< by each search
    std::size_t done_ = 0;
    double least_loss_ = kInfinity, best_gap_ = kNaN;
    SimulatedLoss held_out_;  ///< of every record, by the fold that left it out
    Looked looked_;           ///< what the quadratics rest on
    std::optional<QuadraticFit> fit_;
    MinimumSpread spread_;
    UnitBox box_;
};

}  // namespace

CalibrationResult calibrate(const CalibrationProblem& problem, const CalibrationSettings& settings,
                            const LossFunction& function, CalibrationJournal& journal,
                            const std::function<void(const CalibrationProgress&)>& progress) {
    check_problem(problem);
    return Calibration(problem, settings, function, journal, progress).run();
}

}  // namespace scree
