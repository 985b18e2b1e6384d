// SPDX-License-Identifier: GPL-3.0-or-later
// Where an effect acts that acts on a part of the path.
#include "inference/diagnoser.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

constexpr std::size_t kParts = kStrips * kPartsOfStrip;

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

/// The one with the largest z above `least` of those that do not touch `taken`; places.size() if there is none.
std::size_t best_place(const std::vector<Stretch>& places, const Eigen::VectorXd& z, double least,
                       const std::optional<Stretch>& taken) {
    std::size_t best = places.size();
    for (std::size_t k = 0; k < places.size(); ++k) {
        const double here = z[static_cast<Eigen::Index>(k)];
        const bool touches = taken && places[k].from < taken->to && taken->from < places[k].to;
        if (touches || !(here > least)) continue;
        best = k;
        least = here;
    }
    return best;
}

/// Standard deviation of the middle about a place, stretches weighed by how much they explain [m].
double spread_about(double middle, const std::vector<Stretch>& places, const Eigen::VectorXd& z) {
    const double most = z.maxCoeff();
    double sum = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        const double here = std::max(z[static_cast<Eigen::Index>(k)], 0.0), off = places[k].middle() - middle,
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
        // one that explains more than a strip does, and another one beside it
        double least = std::max(d.score.z.segment(static_cast<Eigen::Index>(first), kStrips).maxCoeff(), 0.0);
        std::optional<Stretch> taken;
        for (std::size_t k = 0; k < kPlaces; ++k, least = 0.0) {
            const std::size_t best = best_place(stretches.places, z, least, taken);
            if (best == stretches.places.size()) break;
            taken = stretches.places[best];
            variants_.push_back({strip.effect, strip.variant, 1.0, taken});
            place_spread_.push_back(spread_about(taken->middle(), stretches.places, z));
            all.push_back(stretches.fingerprints[best]);
        }
        first += kStrips - 1;
    }
    base_.test.emplace(covariance, base_.slopes.directions, deviation_, std::move(all));
    find(d);
    return true;
}

}  // namespace scree
