// SPDX-License-Identifier: GPL-3.0-or-later
// How sure a diagnosis is of what it has followed: weights, and the verdict that comes of them.
#include "inference/diagnoser.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

/// Draws of what finalists may leave [-].
constexpr int kWeightDraws = 2000;

}  // namespace

void best_first(std::vector<EffectFinding>& findings) {
    std::stable_sort(findings.begin(), findings.end(), [](const EffectFinding& a, const EffectFinding& b) {
        return a.weight != b.weight ? a.weight > b.weight : a.z > b.z;
    });
}

void leave_out_rejected(Diagnosis& d, double rejected) {
    const auto is_out = [&](const EffectFinding& f) { return f.finalist && f.p <= rejected; };
    const auto heaviest = std::max_element(
        d.findings.begin(), d.findings.end(),
        [](const EffectFinding& a, const EffectFinding& b) { return a.finalist * a.weight < b.finalist * b.weight; });
    if (heaviest == d.findings.end() || !heaviest->finalist || is_out(*heaviest)) return;
    double left = d.weight_none + d.weight_unnamed;
    for (const EffectFinding& f : d.findings)
        if (f.finalist && !is_out(f)) left += f.weight;
    d.weight_none /= left;
    d.weight_unnamed /= left;
    for (EffectFinding& f : d.findings)
        if (f.finalist) f.weight = is_out(f) ? 0.0 : f.weight / left;
}

std::vector<double> mean_weights(const std::vector<double>& log_weights, const std::vector<double>& deviations,
                                 std::uint64_t seed) {
    SCREE_ASSERT(deviations.size() == log_weights.size());
    std::vector<double> mean(log_weights.size(), 0.0), drawn(log_weights.size());
    RandomStream random(seed, 0, RandomPurpose::Resampling);
    for (int draw = 0; draw < kWeightDraws; ++draw) {
        for (std::size_t k = 0; k < drawn.size(); ++k)
            drawn[k] = log_weights[k] + (deviations[k] > 0.0 ? deviations[k] * random.normal() : 0.0);
        const double most = *std::max_element(drawn.begin(), drawn.end());
        double sum = 0.0;
        for (const double w : drawn) sum += std::exp(w - most);
        for (std::size_t k = 0; k < drawn.size(); ++k) mean[k] += std::exp(drawn[k] - most) / (sum * kWeightDraws);
    }
    return mean;
}

double log_volume(const Eigen::MatrixXd& information, Eigen::Index last) {
    const Eigen::MatrixXd covariance = information.inverse().bottomRightCorner(last, last);
    return 0.5 * (static_cast<double>(last) * std::log(2.0 * std::numbers::pi) +
                  covariance.ldlt().vectorD().array().max(1e-300).log().sum());
}

/// Of a finalist, but for what all have in common: likelihood, times the price of strength and place (Laplace's approximation with priors that are flat over the
/// logarithm of the strength, so that no law pays for where the search for it ends, or over the share of the blocks, over the path, and the logarithm of the
/// length; instruments that err by more than the reference strength are believed less and less) and of the choice among effects and variants.
double Diagnoser::log_weight(const Hypothesis& h) const {
    const EffectDose& v = variants_[h.fingerprint];
    const CandidateEffect& effect = problem_.effects[v.effect];
    const auto share = [](double deviation, double range) {
        return std::log(std::min(1.0, std::sqrt(2.0 * std::numbers::pi) * deviation / range));
    };
    const double strengths = effect.share ? effect.variants[v.variant].most : -std::log(kLeastStrength) * h.strength;
    double price = share(h.strength_deviation, strengths);
    if (effect.measurement) {  // the integral of a normal likelihood over half a normal distribution
        const double variance = 1.0 + h.strength_deviation * h.strength_deviation;
        price = std::log(std::min(1.0, 2.0 * h.strength_deviation / std::sqrt(variance))) -
                0.5 * h.strength * h.strength / variance;
    }
    if (h.on)  // together: a strong effect on a short stretch is much like a weak one on a long one
        price = std::min(0.0, h.log_room - std::log(strengths * path_of(h.fingerprint).length() *
                                                    std::log(kLongestShare / kShortestShare)));
    return -0.5 * h.q + price +
           std::log((1.0 - settings_.prior_none) * (1.0 - settings_.prior_unnamed) /
                    static_cast<double>(problem_.effects.size() * effect.variants.size()));
}

/// Of the way in which it acts, and in a place the nearest one that overlaps with it: a search may have ended far from where it began. Nothing if there is none.
std::optional<std::size_t> Diagnoser::nearest_fingerprint(const Hypothesis& h, const ScoreResult& score) const {
    if (!h.on) return h.fingerprint;
    std::optional<std::size_t> nearest;
    const auto far = [&](std::size_t k) { return std::abs(variants_[k].on->middle() - h.on->middle()); };
    for (std::size_t k = 0; k < static_cast<std::size_t>(score.z.size()); ++k) {
        const EffectDose& v = variants_[k];
        if (!v.on || !same_way(unfollowed(k), h)) continue;
        if (v.on->to <= h.on->from || v.on->from >= h.on->to) continue;
        if (!nearest || far(k) < far(*nearest)) nearest = k;
    }
    return nearest;
}

/// Posterior weights of the finalists, of chance, which is the model without effects, raced like them, and of something without a name: that may have moved the mean residual anywhere, by an unknown
/// multiple of its noise, and its likelihood is the largest over that multiple.
void Diagnoser::weigh(Diagnosis& d, std::vector<Hypothesis>& followed) const {
    std::erase_if(followed, [](const Hypothesis& h) { return !std::isfinite(h.q); });
    std::stable_sort(followed.begin(), followed.end(),
                     [&](const Hypothesis& a, const Hypothesis& b) { return log_weight(a) > log_weight(b); });
    const auto effect_of = [&](const Hypothesis& h) { return variants_[h.fingerprint].effect; };
    for (std::size_t k = 1; k < followed.size();) {  // of an effect that was followed twice the better one
        const auto here = followed.begin() + static_cast<std::ptrdiff_t>(k);
        const auto better =
            std::find_if(followed.begin(), here, [&](const Hypothesis& h) { return effect_of(h) == effect_of(*here); });
        if (better == here) {
            ++k;
            continue;
        }
        const std::size_t form = variants_[here->fingerprint].variant;
        better->other_forms.merge(here->other_forms);
        if (form != variants_[better->fingerprint].variant && here->p > settings_.rejected) {
            double& weight = better->other_forms.try_emplace(form, -kInfinity).first->second;
            weight = std::max(weight, log_weight(*here));
        }
        if (better->on && same_way(*better, *here)) {  // perhaps it acts in the other place
            const double ratio = std::exp(log_weight(*here) - log_weight(*better));
            better->middle_deviation =
                std::hypot(better->middle_deviation,
                           std::sqrt(ratio / (1.0 + ratio)) * (here->on->middle() - better->on->middle()));
        }
        followed.erase(here);
    }
    const double left = std::isfinite(without_.q) ? without_.q : d.score.q;
    const double log_none = -0.5 * left + std::log(settings_.prior_none);
    const double free =
        std::max(static_cast<double>(d.score.standardised.size()) - static_cast<double>(deviation_.size()), 1.0);
    const double log_unnamed = -0.5 * std::min(left, free * (1.0 + std::log(std::max(left / free, 1.0)))) +
                               std::log((1.0 - settings_.prior_none) * settings_.prior_unnamed);
    std::vector<double> log_weights{log_none, log_unnamed}, deviations{0.5 * without_.q_deviation, 0.0};
    for (const Hypothesis& h : followed) {
        double weight = log_weight(h);
        for (const auto& [form, other] : h.other_forms)
            if (form != variants_[h.fingerprint].variant)
                weight = std::max(weight, other) + std::log1p(std::exp(-std::abs(weight - other)));
        log_weights.push_back(weight);
        deviations.push_back(0.5 * h.q_deviation);
    }
    const std::vector<double> weights = mean_weights(log_weights, deviations, settings_.seed);
    d.weight_none = weights[0];
    d.weight_unnamed = weights[1];
    for (std::size_t k = 0; k < followed.size(); ++k) {
        const EffectDose& v = variants_[followed[k].fingerprint];
        EffectFinding& f = *std::find_if(d.findings.begin(), d.findings.end(),
                                         [&](const EffectFinding& x) { return x.effect == v.effect; });
        f.finalist = true;
        f.variant = v.variant;
        f.on = followed[k].on;
        f.middle_deviation = followed[k].middle_deviation;
        const auto near =
            static_cast<Eigen::Index>(nearest_fingerprint(followed[k], d.score).value_or(followed[k].fingerprint));
        f.z = d.score.z[near];
        f.visibility = d.score.visibility[near];
        f.strength = followed[k].strength;
        f.strength_deviation = followed[k].strength_deviation;
        f.parameter_deviation = followed[k].parameter_deviation;
        f.parameters.assign(followed[k].parameters.data(),
                            followed[k].parameters.data() + followed[k].parameters.size());
        f.misfit = followed[k].q;
        f.p = followed[k].p;
        f.weight = weights[k + 2];
    }
}

/// The name, the group or neither.
void Diagnoser::conclude(Diagnosis& d, std::vector<Hypothesis>& followed) const {
    weigh(d, followed);
    leave_out_rejected(d, settings_.rejected);
    best_first(d.findings);
    d.verdict = Verdict::Unknown;
    d.answer.clear();
    std::vector<EffectFinding> answer;
    double reached = 0.0;
    for (const EffectFinding& f : d.findings) {
        if (!f.finalist || reached >= settings_.group) break;
        if (f.p <= settings_.rejected) continue;  // no explanation, whatever its weight
        answer.push_back(f);
        reached += f.weight;
    }
    if (answer.empty() || reached < settings_.group || answer.size() > settings_.largest_group) return;
    if (answer.front().weight >= settings_.named) answer.resize(1);
    const bool of_data = std::all_of(answer.begin(), answer.end(),
                                     [&](const EffectFinding& f) { return problem_.effects[f.effect].measurement; });
    d.verdict = of_data ? Verdict::DataProblem : answer.size() == 1 ? Verdict::Named : Verdict::Group;
    d.answer = std::move(answer);
}

}  // namespace scree
