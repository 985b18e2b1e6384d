// SPDX-License-Identifier: GPL-3.0-or-later
// Where an effect acts that acts on a part of the path.
#include "inference/diagnoser.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace scree {

namespace {

constexpr std::size_t kParts = kStrips * kPartsOfStrip;
/// Places that become variants, of an effect's way to act, at most [-].
constexpr std::size_t kPlaces = 4;
/// How many are looked for again, and how much more they may leave than the best of all [-].
constexpr std::size_t kLookedForAgain = 2;
constexpr double kWorthAnotherLook = 30.0;
/// What leaves more than so large a share of its own simulations do may have left the right place out of sight of all others [-].
constexpr double kDoubtful = 0.2;
/// Stretches that have so much in common are one and the same then [-].
constexpr double kNearlySame = 0.5;

/// Every stretch of up to half a path that is made of its parts, with the sum of their fingerprints.
struct Stretches {
    std::vector<Stretch> places;
    std::vector<Fingerprint> fingerprints;
};
Stretches stretches_of(const Stretch& path, const std::vector<Fingerprint>& parts) {
    Stretches all;
    for (std::size_t from = 0; from < parts.size(); ++from) {
        Fingerprint sum{Eigen::VectorXd::Zero(parts[from].change.size()), 0.0, false};
        double noise = 0.0;
        for (std::size_t to = from + 1; to <= std::min(from + parts.size() / 2, parts.size()); ++to) {
            sum.change += parts[to - 1].change;
            noise += 1.0 / parts[to - 1].rows;
            sum.rows = 1.0 / noise;
            all.fingerprints.push_back(sum);
            all.places.push_back(part_of(path, from, to, parts.size()));
        }
    }
    return all;
}

bool same_place(const Stretch& a, const Stretch& b) {
    const auto within = [](double s, const Stretch& on) { return s > on.from && s < on.to; };
    return within(a.middle(), b) || within(b.middle(), a);
}

/// By the share, of what they cover together, that both cover.
bool nearly_same(const Stretch& a, const Stretch& b) {
    const double common = std::min(a.to, b.to) - std::max(a.from, b.from);
    return common > kNearlySame * (std::max(a.to, b.to) - std::min(a.from, b.from));
}

/// Those with the largest z, each in a place of its own.
std::vector<std::size_t> best_places(const std::vector<Stretch>& places, const Eigen::VectorXd& z) {
    std::vector<std::size_t> order(places.size()), best;
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return z[static_cast<Eigen::Index>(a)] > z[static_cast<Eigen::Index>(b)];
    });
    for (const std::size_t k : order) {
        if (best.size() == kPlaces || !(z[static_cast<Eigen::Index>(k)] > 0.0)) break;
        if (std::none_of(best.begin(), best.end(), [&](std::size_t b) { return same_place(places[k], places[b]); }))
            best.push_back(k);
    }
    return best;
}

/// Standard deviation of the middle, stretches in the same place weighed by how much they explain [m].
double spread_of(std::size_t place, const std::vector<Stretch>& places, const Eigen::VectorXd& z) {
    const double most = z[static_cast<Eigen::Index>(place)];
    double sum = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (!same_place(places[k], places[place])) continue;
        const double here = std::max(z[static_cast<Eigen::Index>(k)], 0.0),
                     off = places[k].middle() - places[place].middle(),
                     weight = std::exp(0.5 * (here * here - most * most));
        sum += weight;
        squares += weight * off * off;
    }
    return std::sqrt(squares / sum);
}

}  // namespace

Stretch part_of(const Stretch& path, std::size_t from, std::size_t to, std::size_t parts) {
    const double part = path.length() / static_cast<double>(parts);
    return {path.from + part * static_cast<double>(from), path.from + part * static_cast<double>(to)};
}

/// Of short parts of the path, at strengths at which they would be told.
std::optional<std::vector<Fingerprint>> Diagnoser::take_parts(std::size_t first_strip, const ScoreResult& score) {
    plan(kParts);
    std::vector<Fingerprint> parts;
    for (std::size_t k = 0; k < kParts; ++k) {
        const std::size_t strip = first_strip + k / kPartsOfStrip;
        const double seen = score.visibility[static_cast<Eigen::Index>(strip)] / static_cast<double>(kPartsOfStrip);
        EffectDose dose = variants_[strip];
        dose.strength = std::min(kModerate / std::max(seen, 1e-9), most_of(strip));
        dose.on = part_of(path_of(strip), k, k + 1, kParts);
        auto fingerprint = take_fingerprint(dose, settings_.repeats);
        if (!fingerprint) return std::nullopt;
        parts.push_back(std::move(*fingerprint));
    }
    return parts;
}

/// On one of its strips.
bool Diagnoser::visible_anywhere(std::size_t first_strip, const ScoreResult& score) const {
    for (std::size_t k = first_strip; k < first_strip + kStrips; ++k)
        if (visible(k, score)) return true;
    return false;
}

/// Fingerprints of short parts, one beside the other, add up to those of every stretch that is made of them. The stretches that explain most become
/// variants. They were chosen by what is measured and have no part in the test.
bool Diagnoser::look_closer(Diagnosis& d) {
    const Eigen::MatrixXd covariance = row_covariance(*base_.space);
    std::vector<Fingerprint> all = base_.test->fingerprints();
    for (std::size_t first = 0; first < planned_variants_; ++first) {
        if (!variants_[first].on) continue;
        const std::size_t strips = std::exchange(first, first + kStrips - 1);
        if (!visible_anywhere(strips, d.score)) continue;
        const EffectDose strip = variants_[strips];
        const auto parts = take_parts(strips, d.score);
        if (!parts) return false;
        const Stretches stretches = stretches_of(path_of(strips), *parts);
        const Eigen::VectorXd z =
            ScoreTest(covariance, base_.slopes.directions, deviation_, stretches.fingerprints)(base_.observed).z;
        for (const std::size_t k : best_places(stretches.places, z)) {
            variants_.push_back({strip.effect, strip.variant, 1.0, stretches.places[k]});
            place_spread_.push_back(spread_of(k, stretches.places, z));
            all.push_back(stretches.fingerprints[k]);
        }
    }
    base_.test.emplace(covariance, base_.slopes.directions, deviation_, std::move(all));
    find(d);
    return true;
}

/// The place in which a way to act explains most, seen from the parameters where a pursuit has ended, without its effect: a calibration makes up for a strong
/// one, and fingerprints that are taken there may point to the wrong place.
bool Diagnoser::find_place_from(const Pursuit& p, std::size_t fingerprint, std::optional<Hypothesis>& found) {
    const ScoreResult score = (*base_.test)(base_.observed);
    const EffectDose& effect = variants_[fingerprint];
    const auto strip = std::find_if(variants_.begin(), variants_.end(), [&](const EffectDose& v) {
        return v.effect == effect.effect && v.variant == effect.variant;
    });
    Base before = std::exchange(base_, {});
    base_.parameters = p.best.parameters;
    base_.slopes.directions = p.of_best.slopes.directions.leftCols(base_.parameters.size());
    if (!build_space(before.space->residuals())) return false;
    const auto parts = take_parts(static_cast<std::size_t>(strip - variants_.begin()), score);
    if (!parts) return false;
    const Stretches stretches = stretches_of(path_of(fingerprint), *parts);
    const ScoreResult seen = ScoreTest(row_covariance(*base_.space), base_.slopes.directions, deviation_,
                                       stretches.fingerprints)(base_.observed);
    base_ = std::move(before);
    const std::vector<std::size_t> best = best_places(stretches.places, seen.z);
    if (best.empty()) return true;
    const auto at = static_cast<Eigen::Index>(best.front());
    found = unfollowed(fingerprint);
    found->parameters = p.best.parameters;
    found->on = stretches.places[best.front()];
    found->strength = std::min(seen.z[at] / std::max(seen.visibility[at], 1e-9), most_of(fingerprint));
    found->place_spread = spread_of(best.front(), stretches.places, seen.z);
    return true;
}

/// Follows a way to act from the place that is found for it there, if it was not followed in that place.
bool Diagnoser::pursue_place_from(std::size_t p, std::size_t fingerprint, std::vector<Pursuit>& pursuits,
                                  double& least) {
    std::optional<Hypothesis> found;
    if (!find_place_from(pursuits[p], fingerprint, found)) return false;
    if (!found || std::any_of(pursuits.begin(), pursuits.end(), [&](const Pursuit& other) {
            return same_way(other.best, *found) && nearly_same(*other.best.on, *found->on);
        }))
        return true;
    std::vector<Pursuit> again{begin(std::move(*found))};
    if (!advance(again.front()) || !pursue(again, least)) return false;
    pursuits.push_back(std::move(again.front()));
    return true;
}

/// The best ones of effects that act in a place once more from where another look finds them, if that is somewhere else; and if the best of all is doubtful,
/// from there what else acts in a place.
bool Diagnoser::look_again(std::vector<Pursuit>& pursuits, double least) {
    std::stable_sort(pursuits.begin(), pursuits.end(),
                     [](const Pursuit& a, const Pursuit& b) { return a.best.q < b.best.q; });
    const std::size_t known = pursuits.size();
    std::size_t looks = 0;
    for (std::size_t k = 0; k < known && looks < kLookedForAgain; ++k) {
        const Pursuit& p = pursuits[k];
        const auto first = pursuits.begin(), here = first + static_cast<std::ptrdiff_t>(k);
        if (!p.best.on || p.best.q > least + kWorthAnotherLook ||
            std::any_of(first, here, [&](const Pursuit& better) { return same_way(better.best, p.best); }))
            continue;
        ++looks;
        if (!pursue_place_from(k, p.best.fingerprint, pursuits, least)) return false;
    }
    if (pursuits.empty()) return true;
    const auto best = static_cast<std::size_t>(
        std::min_element(pursuits.begin(), pursuits.end(),
                         [](const Pursuit& a, const Pursuit& b) { return a.best.q < b.best.q; }) -
        pursuits.begin());
    if (arrived(pursuits[best]).p > kDoubtful) return true;
    const ScoreResult score = (*base_.test)(base_.observed);
    for (std::size_t first = 0; first < planned_variants_; ++first) {
        if (!variants_[first].on) continue;
        const std::size_t strip = std::exchange(first, first + kStrips - 1);
        const bool own = pursuits[best].best.on && same_way(unfollowed(strip), pursuits[best].best);
        if (!own && visible_anywhere(strip, score) && !pursue_place_from(best, strip, pursuits, least)) return false;
    }
    return true;
}

}  // namespace scree
