// SPDX-License-Identifier: GPL-3.0-or-later
// Where an effect acts that acts on a part of the path.
#include "inference/diagnoser.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scree {

namespace {

constexpr std::size_t kParts = kStrips * kPartsOfStrip;
/// Places that become variants, of an effect's way to act, at most [-].
constexpr std::size_t kPlaces = 4;

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
    planned_ += kParts;
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

/// Fingerprints of short parts, one beside the other, add up to those of every stretch that is made of them. The stretches that explain most become
/// variants. They were chosen by what is measured and have no part in the test.
bool Diagnoser::look_closer(Diagnosis& d) {
    const Eigen::MatrixXd covariance = row_covariance(*base_.space);
    std::vector<Fingerprint> all = base_.test->fingerprints();
    for (std::size_t first = 0; first < planned_variants_; ++first) {
        if (!variants_[first].on) continue;
        const EffectDose strip = variants_[first];
        const auto parts = take_parts(first, d.score);
        if (!parts) return false;
        const Stretches stretches = stretches_of(path_of(first), *parts);
        const Eigen::VectorXd z =
            ScoreTest(covariance, base_.slopes.directions, deviation_, stretches.fingerprints)(base_.observed).z;
        for (const std::size_t k : best_places(stretches.places, z)) {
            variants_.push_back({strip.effect, strip.variant, 1.0, stretches.places[k]});
            place_spread_.push_back(spread_of(k, stretches.places, z));
            all.push_back(stretches.fingerprints[k]);
        }
        first += kStrips - 1;
    }
    base_.test.emplace(covariance, base_.slopes.directions, deviation_, std::move(all));
    find(d);
    return true;
}

}  // namespace scree
