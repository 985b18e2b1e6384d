// SPDX-License-Identifier: GPL-3.0-or-later
// Looking far from the model, with few simulations, for what is then followed: strong effects, and parameters and strengths from all over their ranges.
#include "inference/diagnoser_view.hpp"

#include "scree/base/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace scree {

namespace {

/// Strong effects are looked for at strengths that grow by this factor; and how many times as much as at the best one is too much to go on [-].
constexpr double kGrow = 2.5, kMuchMore = 2.0;
/// How many variants, of those whose fingerprints explain most, are looked at so; and of one effect at most; and how many of these are followed [-].
constexpr std::size_t kScanned = 32, kScannedOfOne = 8, kChosenOfOne = 2;
/// Searches all over the ranges of one form, each of them with trials of its own; share of the trials that every one has, then those of the better half, and so on [-].
constexpr std::size_t kStarts = 2;
constexpr std::array kStages{0.2, 0.2, 0.25, 0.35};
/// What the best trial must leave less for all to be seen from there, of Q [-].
constexpr double kWorthSeeing = 8.0;
/// What it may leave for that, per residual [-].
constexpr double kNearEnough = 3.0;

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
    const ResidualMean observed = mean_residual(space.of(measured_));
    if (!comparable(observed, base_.observed)) return kInfinity;
    return ScoreTest(row_covariance(space), base_.slopes.directions, deviation_, {})(observed).q;
}

/// Finalists by what they leave at the strength that leaves least: a strong effect may be far from what its fingerprint at the reference strength tells.
std::optional<std::vector<Hypothesis>> Diagnoser::strong_finalists() {
    plan(4 * kScanned);
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

/// Parameters, strength and place that leave little, from all over what is allowed: what is followed from one place alone ends in its valley, and a calibration has made up for a strong
/// effect in another one.
struct Diagnoser::WideSearch {
    Hypothesis h;
    /// Of the parameters, the square root of the strength (weak ones are found from nearby), and the place.
    Eigen::VectorXd low, high;
    EmulatedSearch search;                 ///< of the residuals in units of their noise
    std::vector<ObservationTable> tables;  ///< of its trials
};

Diagnoser::WideSearch Diagnoser::search_for(Hypothesis h) {
    const Eigen::Index count = base_.parameters.size(), size = count_of(h.fingerprint);
    Eigen::VectorXd low(size), high(size);
    low.head(count) = Eigen::Map<const Eigen::VectorXd>(problem_.low.data(), count);
    high.head(count) = Eigen::Map<const Eigen::VectorXd>(problem_.high.data(), count);
    if (size > count) {
        high[count] = std::sqrt(most_of(h.fingerprint));
        low[count] = high[count] * std::sqrt(kLeastStrength);
    }
    if (size > count + 1) {
        const Stretch& path = path_of(h.fingerprint);
        low.tail(2) << path.from, std::log(kShortestShare * path.length());
        high.tail(2) << path.to, std::log(kLongestShare * path.length());
    }
    return {
        std::move(h),
        std::move(low),
        std::move(high),
        EmulatedSearch(size, View::kLeastNoise, RandomStream(settings_.seed, next_seed_++, RandomPurpose::Diagnosis)),
        {}};
}

Eigen::VectorXd Diagnoser::unknowns_at(const WideSearch& w, const Eigen::VectorXd& u) const {
    Eigen::VectorXd at = w.low.array() + u.array() * (w.high - w.low).array();
    const Eigen::Index count = base_.parameters.size();
    if (at.size() > count) at[count] *= at[count];
    return within(std::move(at), w.h.fingerprint);
}

/// Of the simulated rows, in units of its noise; empty where they say too little.
Eigen::VectorXd Diagnoser::residuals_of(const ObservationTable& table, const View& view) const {
    const ResidualMean mean = mean_residual(view.space.of(table));
    if (!simulates_enough(mean, table.rows(), view.observed)) return {};
    return view.in_noise(view.observed.mean - mean.mean);
}

/// Until there are so many trials, in whole groups.
bool Diagnoser::search(WideSearch& w, std::size_t trials, const View& view) {
    while (w.tables.size() < trials) {
        std::vector<Eigen::VectorXd> told;
        for (const Eigen::VectorXd& u : w.search.ask()) {
            const Eigen::VectorXd at = unknowns_at(w, u);
            auto table = simulate("wide search", at.head(base_.parameters.size()), dose_of(w.h.fingerprint, at), 1);
            if (!table) return false;
            told.push_back(residuals_of(*table, view));
            w.tables.push_back(std::move(*table));
        }
        w.search.tell(told);
    }
    return true;
}

/// Near the measurements more can be seen: what is far from them sees all that is near them alike, and wrongly. A model is simulated as that without effects was; if it leaves little, all trials are seen from there.
bool Diagnoser::look_from(const Eigen::VectorXd& at, std::size_t fingerprint, std::vector<WideSearch>& ways,
                          View& view) {
    auto table = simulate("wide search", at.head(base_.parameters.size()), dose_of(fingerprint, at),
                          settings_.reference_repeats);
    if (!table) return false;
    View from(
        ResidualSpace(std::move(*table), measured_, problem_.blocks, settings_.residuals, base_.space->residuals()),
        measured_);
    if (!comparable(from.observed, base_.observed) || !(from.left < view.left - kWorthSeeing) ||
        from.left > kNearEnough * static_cast<double>(from.observed.mean.size()))
        return true;
    view = std::move(from);
    for (WideSearch& w : ways) {
        if (w.tables.empty()) continue;
        std::vector<Eigen::VectorXd> told;
        for (const ObservationTable& t : w.tables) told.push_back(residuals_of(t, view));
        w.search.tell_again(told);
    }
    return true;
}

bool Diagnoser::look_from_best(std::vector<WideSearch>& ways, View& view) {
    const WideSearch& best = *std::min_element(ways.begin(), ways.end(), [](const WideSearch& a, const WideSearch& b) {
        return a.search.left() < b.search.left();
    });
    return look_from(unknowns_at(best, best.search.best()), best.h.fingerprint, ways, view);
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
    if (step.size() > count) step[count] *= 2.0 * std::sqrt(h.strength);  // of its square root, before
    h.step = limited(std::move(step), at, h.fingerprint);
    return h;
}

/// Seen from what is known to leave little, if there is such. The better part of the searches, as many as are asked for, goes on from stage to stage, and so to the end; after the first stage, when little is known, the best of every effect, too. The best
/// come first.
bool Diagnoser::search_in_stages(std::vector<WideSearch>& ways, const std::function<std::size_t(std::size_t)>& going_on,
                                 const Hypothesis* seen_from) {
    std::size_t left = ways.size();
    for (const double stage : kStages) {
        plan(1 + left * trials_in(stage, settings_.wide_search));
        left = going_on(left);
    }
    if (ways.empty()) return true;
    View view(*base_.space, measured_);
    if (seen_from && !look_from(unknowns_of(*seen_from), seen_from->fingerprint, ways, view)) return false;
    double share = 0.0;
    for (const double stage : kStages) {
        share += stage;
        for (WideSearch& w : ways)
            if (!search(w, trials_in(share, settings_.wide_search), view)) return false;
        if (!look_from_best(ways, view)) return false;
        std::stable_sort(ways.begin(), ways.end(),
                         [](const WideSearch& a, const WideSearch& b) { return a.search.left() < b.search.left(); });
        std::vector<WideSearch> kept;
        const std::size_t count = going_on(ways.size());
        for (WideSearch& w : ways)
            if (kept.size() < count ||
                (share == kStages.front() && std::none_of(kept.begin(), kept.end(), [&](const WideSearch& better) {
                     return variants_[better.h.fingerprint].effect == variants_[w.h.fingerprint].effect;
                 })))
                kept.push_back(std::move(w));
        ways = std::move(kept);
    }
    return true;
}

bool Diagnoser::search_without(std::vector<Hypothesis>& found) {
    if (settings_.wide_search == 0) return true;
    std::vector<WideSearch> ways;
    for (std::size_t k = 0; k < kStarts; ++k) ways.push_back(search_for({}));
    const auto all = [](std::size_t of) { return of; };
    if (!search_in_stages(ways, all, nullptr)) return false;
    found.push_back(found_by(ways.front()));
    return true;
}

/// Every form of the effects that were chosen; the better half goes on. Once each: it depends little on the base.
bool Diagnoser::search_widely(const std::vector<Hypothesis>& chosen, const Hypothesis* seen_from,
                              std::vector<Hypothesis>& found) {
    if (settings_.wide_search == 0) return true;
    const ScoreResult score = (*base_.test)(base_.observed);
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
    const auto better_half = [&](std::size_t of) { return std::min(std::max((of + 1) / 2, settings_.finalists), of); };
    if (!search_in_stages(ways, better_half, seen_from)) return false;
    for (const WideSearch& w : ways)  // of every form the better search
        if (w.search.left() <= kMuchMore * ways.front().search.left() + kFarBehind &&
            std::none_of(found.begin(), found.end(), [&](const Hypothesis& better) { return same_way(better, w.h); }))
            found.push_back(found_by(w));
    return true;
}

}  // namespace scree
