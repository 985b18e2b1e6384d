// SPDX-License-Identifier: GPL-3.0-or-later
// Looking far from the model, with few simulations, for what is then followed: strong effects, and parameters and strengths from all over their ranges.
#include "inference/diagnoser.hpp"
#include "inference/emulated_search.hpp"

#include "scree/base/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree {

namespace {

/// Strong effects are looked for at strengths that grow by this factor; and how many times as much as at the best one is too much to go on [-].
constexpr double kGrow = 2.5, kMuchMore = 2.0;
/// How many variants, of those whose fingerprints explain most, are looked at so; and of one effect at most; and how many of these are followed [-].
constexpr std::size_t kScanned = 32, kScannedOfOne = 8, kChosenOfOne = 2;
/// Searches all over the ranges of one form, each of them with trials of its own; share of the trials that every one has, then those of the better half, and so on [-].
constexpr std::size_t kStarts = 2;
constexpr std::array kStages{0.2, 0.2, 0.25, 0.35};
/// Variance that the noise of a trial has at least: of the measured mean, which has as many rows [-].
constexpr double kLeastNoise = 0.25;

std::size_t trials_in(double stage, std::size_t all) {
    return static_cast<std::size_t>(std::lround(stage * static_cast<double>(all)));
}

}  // namespace

/// Q at the parameters of the base with an effect, parameters free to absorb; seen in the residual space of that very simulation.
std::optional<double> Diagnoser::left_at(double strength, std::size_t fingerprint) {
    EffectDose dose = variants_[fingerprint];
    dose.strength = strength;
    auto table = simulate("finalists", base_.parameters, {dose}, half_repeats());
    if (!table) return std::nullopt;
    const ResidualSpace space(std::move(*table), measured_, problem_.blocks, settings_.residuals,
                              base_.space->residuals());
    return ScoreTest(row_covariance(space), base_.slopes.directions, deviation_, {})(mean_residual(space.of(measured_)))
        .q;
}

/// Finalists by what they leave at the strength that leaves least: a strong effect may be far from what its fingerprint at the reference strength tells.
std::optional<std::vector<Hypothesis>> Diagnoser::strong_finalists() {
    planned_ += 4 * kScanned;
    const ScoreResult score = (*base_.test)(base_.observed);
    std::vector<std::size_t> order(variants_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return score.z[static_cast<Eigen::Index>(a)] > score.z[static_cast<Eigen::Index>(b)];
    });
    std::vector<std::size_t> scanned_of(problem_.effects.size(), 0), chosen_of = scanned_of;
    std::vector<Hypothesis> scanned;
    for (const std::size_t k : order) {
        const std::size_t effect = variants_[k].effect;
        if (!(score.z[static_cast<Eigen::Index>(k)] > 0.0) || scanned.size() == kScanned) break;
        if (!visible(k, score) || scanned_of[effect] == kScannedOfOne) continue;
        ++scanned_of[effect];
        Hypothesis best = unfollowed(k);
        best.from_given = true;
        const double most = most_of(k);
        for (double strength = std::min(1.0, most);; strength = std::min(kGrow * strength, most)) {
            const std::optional<double> q = left_at(strength, k);
            if (!q) return std::nullopt;
            if (*q < best.q) {
                best.strength = strength;
                best.q = *q;
            }
            if (*q > kMuchMore * best.q || strength >= most) break;
        }
        scanned.push_back(std::move(best));
    }
    std::stable_sort(scanned.begin(), scanned.end(),
                     [](const Hypothesis& a, const Hypothesis& b) { return a.q < b.q; });
    std::vector<Hypothesis> chosen;
    for (Hypothesis& h : scanned)
        if (chosen.size() < settings_.finalists && chosen_of[variants_[h.fingerprint].effect]++ < kChosenOfOne)
            chosen.push_back(std::move(h));
    return chosen;
}

/// Parameters, strength and place that leave little, from all over what is allowed, as few simulations in the residual space of the base tell: what is followed
/// from one place alone ends in its valley, and a calibration has made up for a strong effect in another one.
struct Diagnoser::WideSearch {
    Hypothesis h;
    Eigen::VectorXd low, high;  ///< of the parameters, the logarithm of the strength, and the place
    EmulatedSearch search;      ///< of the residuals in units of their noise
    std::size_t trials = 0, wanted = 0;
};

Diagnoser::WideSearch Diagnoser::search_for(Hypothesis h) {
    const Eigen::Index count = base_.parameters.size(), size = count_of(h.fingerprint);
    Eigen::VectorXd low(size), high(size);
    low.head(count) = Eigen::Map<const Eigen::VectorXd>(problem_.low.data(), count);
    high.head(count) = Eigen::Map<const Eigen::VectorXd>(problem_.high.data(), count);
    if (size > count) {
        high[count] = std::log(most_of(h.fingerprint));
        low[count] = high[count] + std::log(kLeastStrength);
    }
    if (size > count + 1) {
        const Stretch& path = path_of(h.fingerprint);
        low.tail(2) << path.from, std::log(kShortestShare * path.length());
        high.tail(2) << path.to, std::log(kLongestShare * path.length());
    }
    return {std::move(h), std::move(low), std::move(high),
            EmulatedSearch(size, kLeastNoise, RandomStream(settings_.seed, next_seed_++, RandomPurpose::Calibration))};
}

Eigen::VectorXd Diagnoser::unknowns_at(const WideSearch& w, const Eigen::VectorXd& u) const {
    Eigen::VectorXd at = w.low.array() + u.array() * (w.high - w.low).array();
    const Eigen::Index count = base_.parameters.size();
    if (at.size() > count) at[count] = std::exp(at[count]);
    return within(std::move(at), w.h.fingerprint);
}

/// So many more trials, in whole groups.
bool Diagnoser::search(WideSearch& w, std::size_t trials) {
    const Eigen::LLT<Eigen::MatrixXd> factor(mean_covariance(row_covariance(*base_.space), base_.observed.together));
    for (w.wanted += trials; w.trials < w.wanted;) {
        std::vector<Eigen::VectorXd> told;
        for (const Eigen::VectorXd& u : w.search.ask()) {
            const Eigen::VectorXd at = unknowns_at(w, u);
            const auto table =
                simulate("wide search", at.head(base_.parameters.size()), dose_of(w.h.fingerprint, at), 1);
            if (!table) return false;
            const ResidualMean mean = mean_residual(base_.space->of(*table));
            told.push_back(simulates_enough(mean, table->rows())
                               ? Eigen::VectorXd(factor.matrixL().solve(base_.observed.mean - mean.mean))
                               : Eigen::VectorXd());
        }
        w.search.tell(told);
        w.trials += told.size();
    }
    return true;
}

/// As the closer look has it for the nearest place in which this way to act explains most; 0 if it has found none.
double Diagnoser::spread_near(const Hypothesis& h) const {
    double nearest = kInfinity, spread = 0.0;
    for (std::size_t k = planned_variants_; k < variants_.size(); ++k) {
        const double far = std::abs(variants_[k].on->middle() - h.on->middle());
        if (!same_way(unfollowed(k), h) || !(far < nearest)) continue;
        nearest = far;
        spread = place_spread_[k - planned_variants_];
    }
    return spread;
}

/// With the steps that its derivatives ask for.
Hypothesis Diagnoser::found_by(const WideSearch& w) const {
    const Eigen::VectorXd at = unknowns_at(w, w.search.best());
    const Eigen::Index count = base_.parameters.size();
    Hypothesis h = w.h;
    h.parameters = at.head(count);
    if (h.fingerprint != kNoEffect) {
        h.strength = at[count];
        h.on = dose_of(h.fingerprint, at).front().on;
        if (h.on) h.place_spread = spread_near(h);
    }
    const Eigen::MatrixXd slopes = w.search.slopes();
    if (slopes.rows() == 0) return h;
    Eigen::VectorXd step = kTellingStep / slopes.colwise().norm().transpose().array().max(1e-12);
    step.array() *= (w.high - w.low).array();
    if (step.size() > count) step[count] *= h.strength;  // of its logarithm, before
    h.step = limited(std::move(step), at, h.fingerprint);
    return h;
}

std::optional<Hypothesis> Diagnoser::search_without() {
    planned_ += kStarts * settings_.wide_search;
    std::vector<WideSearch> ways;
    for (std::size_t k = 0; k < kStarts; ++k) {
        ways.push_back(search_for({}));
        if (!search(ways.back(), settings_.wide_search)) return std::nullopt;
    }
    return found_by(*std::min_element(ways.begin(), ways.end(), [](const WideSearch& a, const WideSearch& b) {
        return a.search.left() < b.search.left();
    }));
}

/// Every form of the effects that were chosen; after some trials the better half of the searches goes on, and so to the end. Once each: it depends little on the base.
bool Diagnoser::search_widely(const std::vector<Hypothesis>& chosen, std::vector<Hypothesis>& found) {
    const ScoreResult score = (*base_.test)(base_.observed);
    const auto better_half = [&](std::size_t of) { return std::min(std::max((of + 1) / 2, settings_.finalists), of); };
    std::vector<WideSearch> ways;
    for (std::size_t k = 0; k < variants_.size(); ++k) {
        const Hypothesis h = unfollowed(k);
        const auto of_effect = [&](const Hypothesis& c) {
            return variants_[c.fingerprint].effect == variants_[k].effect;
        };
        if (!visible(k, score) || std::none_of(chosen.begin(), chosen.end(), of_effect) ||
            std::any_of(searched_widely_.begin(), searched_widely_.end(),
                        [&](const Hypothesis& known) { return same_way(known, h); }))
            continue;
        searched_widely_.push_back(h);
        for (std::size_t start = 0; start < kStarts; ++start) ways.push_back(search_for(h));
    }
    std::size_t left = ways.size();
    for (const double stage : kStages) {
        planned_ += left * trials_in(stage, settings_.wide_search);
        left = better_half(left);
    }
    for (const double stage : kStages) {
        for (WideSearch& w : ways)
            if (!search(w, trials_in(stage, settings_.wide_search))) return false;
        std::stable_sort(ways.begin(), ways.end(),
                         [](const WideSearch& a, const WideSearch& b) { return a.search.left() < b.search.left(); });
        ways.erase(ways.begin() + static_cast<std::ptrdiff_t>(better_half(ways.size())), ways.end());
    }
    for (const WideSearch& w : ways)  // of every form the better search
        if (w.search.left() <= kMuchMore * ways.front().search.left() + kFarBehind &&
            std::none_of(found.begin(), found.end(), [&](const Hypothesis& better) { return same_way(better, w.h); }))
            found.push_back(found_by(w));
    return true;
}

}  // namespace scree
