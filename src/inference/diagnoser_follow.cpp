// SPDX-License-Identifier: GPL-3.0-or-later
// Following an effect, or none, to the parameters and strength that leave least.
#include "inference/diagnoser.hpp"

#include "scree/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scree {

namespace {

/// Least strength that is followed, as a share of the largest [-].
constexpr double kLeastStrength = 0.01;
/// Change of the misfit, minus twice a log-likelihood, that is noise [-].
constexpr double kSettled = 1.0;
/// Change of the mean residual, squared and over its covariance, beside which the noise of two simulations is small [-].
constexpr double kWorthLearning = 4.0;
/// Share of a fingerprint's length that is taken for noise, at most [-].
constexpr double kMostNoise = 0.5;
/// Samples of a simulation that its goodness of fit is judged by [-].
constexpr std::int64_t kFitDraws = 299;

/// Strong effects are looked for at strengths that grow by this factor [-], as long as less is left.
constexpr double kGrow = 2.5;
/// How many variants, of those whose fingerprints explain most, are looked at so; and of one effect at most [-].
constexpr std::size_t kScanned = 16, kScannedOfOne = 3;

}  // namespace

/// Simulates p.at and sees what is measured in the residual space of that.
bool Diagnoser::look(Point& p, std::size_t fingerprint, std::int64_t repeats) {
    const Eigen::Index count = base_.parameters.size();
    std::vector<EffectDose> doses;
    if (fingerprint != kNoEffect)
        doses.push_back({variants_[fingerprint].effect, variants_[fingerprint].variant, p.at[count]});
    auto table = simulate("finalists", p.at.head(count), std::move(doses), repeats);
    if (!table) return false;
    const ResidualSpace space(std::move(*table), measured_, problem_.blocks, settings_.residuals,
                              base_.space->residuals());
    p.rows = space.of_reference();
    p.covariance = row_covariance(p.rows);
    p.observed = mean_residual(space.of(measured_));
    return true;
}

/// Finalists by what they leave at the strength that leaves least: a strong effect may be far from what its fingerprint at the reference strength tells.
std::optional<std::vector<Hypothesis>> Diagnoser::strong_finalists() {
    planned_ += 2 * kScanned;
    const ScoreResult score = (*base_.test)(base_.observed);
    std::vector<std::size_t> order(variants_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return score.z[static_cast<Eigen::Index>(a)] > score.z[static_cast<Eigen::Index>(b)];
    });
    std::vector<std::size_t> scanned_of(problem_.effects.size(), 0);
    std::vector<Hypothesis> best(problem_.effects.size());
    std::size_t scanned = 0;
    for (const std::size_t k : order) {
        const EffectDose& v = variants_[k];
        if (!(score.z[static_cast<Eigen::Index>(k)] > 0.0) || scanned == kScanned) break;
        if (!base_.test->fingerprints()[k].judged || scanned_of[v.effect] == kScannedOfOne) continue;
        ++scanned_of[v.effect];
        ++scanned;
        const double most = problem_.effects[v.effect].variants[v.variant].most;
        double last = kInfinity;
        for (double strength = std::min(1.0, most);; strength = std::min(kGrow * strength, most)) {
            Point p;
            p.at.resize(base_.parameters.size() + 1);
            p.at << base_.parameters, strength;
            if (!look(p, k, settings_.repeats)) return std::nullopt;
            const double q = ScoreTest(p.covariance, base_.jacobian, deviation_, {})(p.observed).q;
            if (q < best[v.effect].q) {
                best[v.effect].fingerprint = k;
                best[v.effect].parameters = base_.parameters;
                best[v.effect].strength = strength;
                best[v.effect].q = q;
                best[v.effect].from_given = true;
            }
            if (q >= last || strength >= most) break;
            last = q;
        }
    }
    std::vector<Hypothesis> chosen;
    for (Hypothesis& h : best)
        if (h.fingerprint != kNoEffect) chosen.push_back(std::move(h));
    std::stable_sort(chosen.begin(), chosen.end(), [](const Hypothesis& a, const Hypothesis& b) { return a.q < b.q; });
    chosen.resize(std::min(chosen.size(), settings_.finalists));
    return chosen;
}

/// Gauss-Newton on parameters and strength, with a simulation at every point. Each point has the residual space of its own simulation: far from the
/// calibrated model, whose probabilities have run into 0 and 1, that still tells by how much. Derivatives are those at the calibrated model and learn
/// from the way (Broyden 1965); steps that lead to worse are halved. The last simulation has as many repeats as the reference and judges: what is left of the measured
/// residual there, parameters and strength free.
bool Diagnoser::follow(Hypothesis& h) {
    const bool any = h.fingerprint != kNoEffect;
    const EffectDose variant = any ? variants_[h.fingerprint] : EffectDose{};
    const double most = any ? problem_.effects[variant.effect].variants[variant.variant].most : 0.0;
    const Eigen::Index count = base_.parameters.size(), size = count + (any ? 1 : 0);  // the strength is the last
    Eigen::MatrixXd directions(base_.observed.mean.size(), size);
    directions.leftCols(count) = base_.jacobian;
    Eigen::VectorXd prior = Eigen::VectorXd::Zero(size), scale = Eigen::VectorXd::Ones(size),
                    start = Eigen::VectorXd::Zero(size);
    prior.head(count) = scale.head(count) = deviation_.array().square().inverse();
    start.head(count) = base_.parameters;
    if (any) directions.col(count) = base_.test->fingerprints()[h.fingerprint].change;
    const auto judge = [&](Point& p) {
        const Eigen::VectorXd moved = p.at - start;
        p.misfit = p.observed.mean.dot(p.factor().solve(p.observed.mean)) + moved.dot(prior.cwiseProduct(moved));
    };
    const auto look_at = [&](Point& p, std::int64_t repeats) {
        if (!look(p, h.fingerprint, repeats)) return false;
        judge(p);
        return true;
    };
    struct Step {
        Eigen::VectorXd to;
        double strength_deviation = kNaN, gain = 0.0;
    };
    const auto step_from = [&](const Point& p, double share) {
        const Eigen::MatrixXd WD = p.factor().solve(directions);
        Eigen::MatrixXd information = directions.transpose() * WD;
        information.diagonal() += prior;
        const Eigen::MatrixXd with_noise = information;
        if (any) {  // the fingerprint's own noise is no information: it would make every step too short
            const double rows = p.observed.together.diagonal().maxCoeff(),
                         of = base_.test->fingerprints()[h.fingerprint].rows;
            information(count, count) -= std::min(static_cast<double>(directions.rows() - count) * rows / of,
                                                  kMostNoise * information(count, count));
        }
        const Eigen::VectorXd pull = WD.transpose() * p.observed.mean, moved = p.at - start;
        Step step;
        step.to = p.at + share * information.ldlt().solve(pull - prior.cwiseProduct(moved));
        step.to.head(count) = within_ranges(step.to.head(count));
        if (any) {
            step.to[count] = std::clamp(step.to[count], kLeastStrength * most, most);
            step.strength_deviation = std::sqrt(information.inverse()(count, count));
        }
        const Eigen::VectorXd free = information.ldlt().solve(pull);
        step.gain = 2.0 * pull.dot(free) - free.dot(with_noise * free);
        return step;
    };

    Point now{start, base_.space->of_reference(), row_covariance(base_.space->of_reference()), base_.observed,
              kInfinity};
    judge(now);
    if (any && h.strength > 0.0) {
        const ResidualMean without = now.observed;
        now.at[count] = h.strength;
        if (!look_at(now, settings_.repeats)) return false;
        directions.col(count) = (without.mean - now.observed.mean) / h.strength;
    }
    double share = 1.0;
    for (int round = 0; round < settings_.rounds; ++round) {
        const Step step = step_from(now, share);
        if (round > 0 && step.gain < kSettled) break;
        Point next;
        next.at = step.to;
        if (!look_at(next, settings_.repeats)) return false;
        const Eigen::VectorXd way = next.at - now.at, foreseen = directions * way, weighed = scale.cwiseProduct(way);
        if (foreseen.dot(now.factor().solve(foreseen)) > kWorthLearning)
            directions += (now.observed.mean - next.observed.mean - foreseen) * weighed.transpose() / way.dot(weighed);
        const double better = now.misfit - next.misfit;
        if (better > 0.0) now = std::move(next);
        share = better > 0.0 ? std::min(1.0, 2.0 * share) : 0.5 * share;
        if (better >= 0.0 && better < kSettled) break;
    }
    if (any && now.at[count] == 0.0) now.at[count] = kLeastStrength * most;
    if (!look_at(now, settings_.reference_repeats)) return false;
    const Step last = step_from(now, 1.0);
    h.q = now.observed.mean.dot(now.factor().solve(now.observed.mean)) - last.gain;
    h.parameters = last.to.head(count);
    h.strength = any ? last.to[count] : 0.0;
    h.strength_deviation = last.strength_deviation;
    h.p = goodness_of_fit(now.rows, now.covariance, directions, now.observed);
    return true;
}

/// How often as many rows of the simulation itself leave as much, with parameters and strength free for them, too.
double Diagnoser::goodness_of_fit(const ResidualRows& rows, const Eigen::MatrixXd& covariance,
                                  const Eigen::MatrixXd& directions, const ResidualMean& observed) const {
    std::vector<Fingerprint> effect;
    for (Eigen::Index k = deviation_.size(); k < directions.cols(); ++k)
        effect.push_back({directions.col(k), kInfinity});
    const ScoreTest own(covariance, directions.leftCols(deviation_.size()), deviation_, std::move(effect));
    auto misfit = [&](const ResidualMean& r) {
        const ScoreResult s = own(r);
        return s.q - s.z.squaredNorm();
    };
    const double measured = misfit(observed);
    std::int64_t at_least = 0;
    for (std::int64_t k = 0; k < kFitDraws; ++k) {
        RandomStream random(settings_.seed, static_cast<std::uint64_t>(k), RandomPurpose::Resampling);
        ResidualRows drawn(static_cast<Eigen::Index>(measured_.rows()), rows.cols());
        for (Eigen::Index i = 0; i < drawn.rows(); ++i)
            drawn.row(i) = rows.row(static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(rows.rows()))));
        if (misfit(mean_residual(drawn)) >= measured) ++at_least;
    }
    return static_cast<double>(at_least + 1) / static_cast<double>(kFitDraws + 1);
}

}  // namespace scree
