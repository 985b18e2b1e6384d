// SPDX-License-Identifier: GPL-3.0-or-later
// Looking far from the model, with few simulations, for what is then followed: strong effects, and parameters and strengths from all over their ranges.
#include "inference/cma_es.hpp"
#include "inference/diagnoser.hpp"

#include "scree/base/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree {

namespace {

/// Strong effects are looked for at strengths that grow by this factor, until so many times as much is left as at the best one [-].
constexpr double kGrow = 2.5, kMuchMore = 2.0;
/// How many variants, of those whose fingerprints explain most, are looked at so; and of one effect at most; and how many of these are followed [-].
constexpr std::size_t kScanned = 32, kScannedOfOne = 8, kChosenOfOne = 2;
/// A search all over the ranges: share of the generations that every form has, then the better half, and so on; standard deviation of the first one, of the
/// ranges [-].
constexpr std::array kStages{0.15, 0.15, 0.3, 0.4};
constexpr double kWidely = 0.3;

int generations_in(double stage, int all) {
    return std::max(1, static_cast<int>(std::lround(stage * all)));
}

std::size_t simulations_in(int generations, Eigen::Index unknowns) {
    return static_cast<std::size_t>(generations * CmaEs::default_population(static_cast<std::size_t>(unknowns)));
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
    CmaEs search;
    Eigen::VectorXd best = Eigen::VectorXd::Constant(
        low.size(), 0.5);     ///< seen so far: after so few generations the mean lies between valleys
    double left = kInfinity;  ///< there [-]
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
            CmaEs(Eigen::VectorXd::Constant(size, 0.5), kWidely, 0,
                  RandomStream(settings_.seed, next_seed_++, RandomPurpose::Calibration))};
}

Eigen::VectorXd Diagnoser::unknowns_at(const WideSearch& w, const Eigen::VectorXd& u) const {
    Eigen::VectorXd at = w.low.array() + u.unaryExpr(&reflected).array() * (w.high - w.low).array();
    const Eigen::Index count = base_.parameters.size();
    if (at.size() > count) at[count] = std::exp(at[count]);
    return within(std::move(at), w.h.fingerprint);
}

bool Diagnoser::search(WideSearch& w, int generations) {
    const Eigen::LLT<Eigen::MatrixXd> factor(mean_covariance(row_covariance(*base_.space), base_.observed.together));
    for (int generation = 0; generation < generations; ++generation) {
        const std::vector<Eigen::VectorXd> candidates = w.search.ask();
        std::vector<double> losses;
        for (const Eigen::VectorXd& u : candidates) {
            const Eigen::VectorXd at = unknowns_at(w, u);
            const auto table =
                simulate("wide search", at.head(base_.parameters.size()), dose_of(w.h.fingerprint, at), 1);
            if (!table) return false;
            const ResidualMean mean = mean_residual(base_.space->of(*table));
            const Eigen::VectorXd left = base_.observed.mean - mean.mean;
            losses.push_back(simulates_enough(mean, table->rows()) ? left.dot(factor.solve(left)) : kInfinity);
            if (!(losses.back() < w.left)) continue;
            w.left = losses.back();
            w.best = u;
        }
        w.search.tell(losses);
    }
    return true;
}

Hypothesis Diagnoser::found_by(const WideSearch& w) const {
    const Eigen::VectorXd at = unknowns_at(w, w.best);
    const Eigen::Index count = base_.parameters.size();
    Hypothesis h = w.h;
    h.parameters = at.head(count);
    if (h.fingerprint == kNoEffect) return h;
    h.strength = at[count];
    h.on = dose_of(h.fingerprint, at).front().on;
    return h;
}

std::optional<Hypothesis> Diagnoser::search_without() {
    WideSearch w = search_for({});
    planned_ += simulations_in(settings_.generations, w.low.size());
    if (!search(w, settings_.generations)) return std::nullopt;
    return found_by(w);
}

/// Every form of the effects that were chosen; after some generations the better half of them goes on, and so to the end. Once each: it depends little on the base.
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
        ways.push_back(search_for(h));
    }
    std::size_t left = ways.size();
    for (const double stage : kStages) {
        const int generations = generations_in(stage, settings_.generations);
        planned_ += ways.empty() ? 0 : left * simulations_in(generations, ways.front().low.size());
        left = better_half(left);
    }
    for (const double stage : kStages) {
        for (WideSearch& w : ways)
            if (!search(w, generations_in(stage, settings_.generations))) return false;
        std::stable_sort(ways.begin(), ways.end(),
                         [](const WideSearch& a, const WideSearch& b) { return a.left < b.left; });
        ways.erase(ways.begin() + static_cast<std::ptrdiff_t>(better_half(ways.size())), ways.end());
    }
    for (const WideSearch& w : ways) found.push_back(found_by(w));
    return true;
}

}  // namespace scree
