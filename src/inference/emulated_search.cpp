// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/emulated_search.hpp"

#include "inference/calibration_surroundings.hpp"
#include "inference/cma_es.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

namespace {

/// How many trials, those that leave least, an emulator is made of: the walls around say little of the valley, and the effort grows with the cube; and how
/// many of them lengths are looked for with.
constexpr std::size_t kOfEmulator = 120, kOfLengths = 80;
constexpr double kFirstLength = 0.8;
/// Fewest of them [-].
constexpr std::size_t kLeast = 8;
/// Places that are looked at: anywhere, and near those of the best trials; and how near, least and most [-].
constexpr std::size_t kPlacesAnywhere = 300, kBestTrials = 10, kPlacesNearEach = 30;
constexpr double kNear = 0.02, kFar = 0.3;
/// Standard deviations of the sum that are hoped for, from 0 in such steps, one for each trial of a group; and how many of these, the most hopeful, may be anywhere.
constexpr double kHope = 0.5;
constexpr std::size_t kAnywhere = 2;
/// Rounds in which each of these is looked at more closely, with so many places near it, each round so much nearer.
constexpr int kRounds = 3;
constexpr std::size_t kPlacesOfRound = 12;
constexpr double kNearer = 0.5;
/// How far the others are from the best one, at first, at least and at most, in each coordinate [-]; factors after a group that has, or has not, found so much less.
constexpr double kReach = 0.25, kLeastReach = 0.06, kMostReach = 0.4, kWider = 1.3, kNarrower = 0.8, kNews = 3.0;

Eigen::MatrixXd rows_of(const std::vector<Eigen::VectorXd>& all) {
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(all.size()), all.empty() ? 0 : all.front().size());
    for (std::size_t k = 0; k < all.size(); ++k) rows.row(static_cast<Eigen::Index>(k)) = all[k];
    return rows;
}

}  // namespace

EmulatedSearch::EmulatedSearch(Eigen::Index dimension, double least_noise, RandomStream random)
    : dimension_(dimension),
      least_noise_(least_noise),
      random_(random),
      lengths_(Eigen::VectorXd::Constant(dimension, kFirstLength)),
      reach_(kReach),
      best_(Eigen::VectorXd::Constant(dimension, 0.5)),
      left_(std::numeric_limits<double>::infinity()) {
    SCREE_ASSERT(dimension > 0);
}

std::vector<Eigen::VectorXd> EmulatedSearch::ask() {
    if (trials_.empty()) return asked_ = latin_hypercube(static_cast<std::size_t>(dimension_), kSpread, random_);
    if (!emulator_) return asked_ = latin_hypercube(static_cast<std::size_t>(dimension_), kGroup, random_);
    // what each trial of the group hopes for: its place and what it promises
    std::vector<Eigen::VectorXd> at(kGroup, best_);
    std::vector<double> promise(kGroup, std::numeric_limits<double>::infinity());
    const auto look = [&](const Eigen::MatrixXd& places) {
        const Expected e = expected(places);
        std::vector<char> taken(static_cast<std::size_t>(places.rows()), 0);
        for (std::size_t h = 0; h < kGroup; ++h) {
            const Eigen::VectorXd promised = e.sum - kHope * static_cast<double>(h) * e.deviation;
            Eigen::Index least = -1;
            for (Eigen::Index k = 0; k < places.rows(); ++k)
                if (!taken[static_cast<std::size_t>(k)] && promised[k] < (least < 0 ? promise[h] : promised[least]) &&
                    (h + kAnywhere >= kGroup || within_reach(places.row(k))))
                    least = k;
            if (least < 0) continue;
            taken[static_cast<std::size_t>(least)] = 1;
            at[h] = places.row(least);
            promise[h] = promised[least];
        }
    };
    std::vector<Eigen::VectorXd> places =
        latin_hypercube(static_cast<std::size_t>(dimension_), kPlacesAnywhere, random_);
    for (std::size_t k = 0; k < std::min(kBestTrials, telling_.size()); ++k)
        for (std::size_t j = 0; j < kPlacesNearEach; ++j)
            places.push_back(near(trials_[telling_[k]], kNear * std::pow(kFar / kNear, random_.uniform())));
    double far = kNearer * kNearer * reach_;
    for (int round = 0; round <= kRounds; ++round, far *= kNearer) {
        std::erase_if(places, [&](const Eigen::VectorXd& u) { return says_nothing(u); });
        if (!places.empty()) look(rows_of(places));
        places.clear();
        for (const Eigen::VectorXd& u : at)
            for (std::size_t k = 0; k < kPlacesOfRound; ++k) places.push_back(near(u, far));
    }
    return asked_ = std::move(at);
}

void EmulatedSearch::tell(const std::vector<Eigen::VectorXd>& residuals) {
    SCREE_ASSERT(residuals.size() == asked_.size());
    for (std::size_t k = 0; k < residuals.size(); ++k) {
        trials_.push_back(asked_[k]);
        residuals_.push_back(residuals[k]);
    }
    asked_.clear();
    learn();
}

void EmulatedSearch::tell_again(const std::vector<Eigen::VectorXd>& residuals) {
    SCREE_ASSERT(residuals.size() == trials_.size() && asked_.empty());
    residuals_ = residuals;
    emulator_.reset();
    next_lengths_ = std::min(next_lengths_, kSpread);
    left_ = std::numeric_limits<double>::infinity();
    learn();
}

void EmulatedSearch::tell_of_another(const std::vector<Eigen::VectorXd>& residuals) {
    reach_ = kReach;
    tell_again(residuals);
}

void EmulatedSearch::learn() {
    telling_.clear();
    for (std::size_t k = 0; k < trials_.size(); ++k)
        if (residuals_[k].size() > 0) telling_.push_back(k);
    std::stable_sort(telling_.begin(), telling_.end(), [&](std::size_t a, std::size_t b) {
        return residuals_[a].squaredNorm() < residuals_[b].squaredNorm();
    });
    if (telling_.size() >= kLeast)
        emulate();
    else if (!telling_.empty()) {
        best_ = trials_[telling_.front()];
        left_ = residuals_[telling_.front()].squaredNorm();
    }
}

void EmulatedSearch::emulate() {
    const std::size_t count = std::min(telling_.size(), kOfEmulator);
    std::vector<Eigen::VectorXd> least_trials, least_residuals;
    for (std::size_t k = 0; k < count; ++k) {
        least_trials.push_back(trials_[telling_[k]]);
        least_residuals.push_back(residuals_[telling_[k]]);
    }
    const Eigen::MatrixXd points = rows_of(least_trials), values = rows_of(least_residuals);
    if (telling_.size() >= next_lengths_) {
        next_lengths_ = 2 * telling_.size();
        const auto of_lengths = static_cast<Eigen::Index>(std::min(count, kOfLengths));
        lengths_ =
            Emulator::likely_lengths(points.topRows(of_lengths), values.topRows(of_lengths), lengths_, least_noise_);
    }
    emulator_.emplace(points, values, lengths_, least_noise_);
    const bool first = std::isinf(left_);
    const double before = expected(best_.transpose()).sum[0];
    Eigen::Index least = 0;
    left_ = expected(points).sum.minCoeff(&least);
    best_ = points.row(least);
    if (!first) reach_ = std::clamp(reach_ * (left_ < before - kNews ? kWider : kNarrower), kLeastReach, kMostReach);
}

/// Of normal residuals: sum of mean^2 + variance, whose own variance is the sum of 2 variance^2 + 4 mean^2 variance.
EmulatedSearch::Expected EmulatedSearch::expected(const Eigen::MatrixXd& places) const {
    const Emulator::Prediction p = emulator_->at(places);
    const auto squares = p.mean.array().square();
    return {(squares + p.variance.array()).rowwise().sum().matrix(),
            (2.0 * p.variance.array().square() + 4.0 * squares * p.variance.array()).rowwise().sum().sqrt().matrix()};
}

Eigen::VectorXd EmulatedSearch::near(const Eigen::VectorXd& u, double far) {
    return u.unaryExpr([&](double x) { return reflected(x + far * random_.normal()); });
}

bool EmulatedSearch::within_reach(const Eigen::VectorXd& u) const {
    return (u - best_).cwiseAbs().maxCoeff() <= reach_;
}

/// As its nearest trial did.
bool EmulatedSearch::says_nothing(const Eigen::VectorXd& u) const {
    if (telling_.size() == trials_.size()) return false;
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < trials_.size(); ++k) {
        const double distance = ((trials_[k] - u).array() / lengths_.array()).matrix().squaredNorm();
        if (!(distance < least)) continue;
        least = distance;
        nearest = k;
    }
    return residuals_[nearest].size() == 0;
}

Eigen::MatrixXd EmulatedSearch::slopes() const {
    return emulator_ ? emulator_->slopes(best_) : Eigen::MatrixXd(0, dimension_);
}

}  // namespace scree
