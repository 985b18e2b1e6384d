// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/cma_es.hpp"

#include "inference/eigenpairs.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace scree {

int CmaEs::default_population(std::size_t dimension) {
    return 4 + static_cast<int>(3.0 * std::log(static_cast<double>(dimension)));
}

CmaEs::CmaEs(const Eigen::VectorXd& mean, double sigma, int population, RandomStream random)
    : random_(random), mean_(mean), sigma_(sigma) {
    SCREE_ASSERT(mean.size() > 0 && sigma > 0.0);
    const auto dimension = mean.size();
    population_ = population > 0 ? population : default_population(static_cast<std::size_t>(dimension));
    SCREE_ASSERT(population_ >= 2);
    const int parents = population_ / 2;
    weights_.resize(parents);
    for (int i = 0; i < parents; ++i) weights_[i] = std::log(0.5 * (population_ + 1)) - std::log(i + 1.0);
    weights_ /= weights_.sum();
    mu_eff_ = 1.0 / weights_.squaredNorm();

    const auto n = static_cast<double>(dimension);
    c_sigma_ = (mu_eff_ + 2.0) / (n + mu_eff_ + 5.0);
    d_sigma_ = 1.0 + 2.0 * std::max(0.0, std::sqrt((mu_eff_ - 1.0) / (n + 1.0)) - 1.0) + c_sigma_;
    c_c_ = (4.0 + mu_eff_ / n) / (n + 4.0 + 2.0 * mu_eff_ / n);
    c_1_ = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff_);
    c_mu_ = std::min(1.0 - c_1_, 2.0 * (0.25 + mu_eff_ + 1.0 / mu_eff_ - 2.0) / ((n + 2.0) * (n + 2.0) + mu_eff_));
    chi_ = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));  // mean length of a standard normal vector

    covariance_ = Eigen::MatrixXd::Identity(dimension, dimension);
    path_sigma_ = path_c_ = Eigen::VectorXd::Zero(dimension);
    decompose();
}

void CmaEs::decompose() {
    Eigenpairs pairs = eigenpairs(covariance_);
    axes_ = std::move(pairs.vectors);
    lengths_ = pairs.values.cwiseMax(1e-20).cwiseSqrt();
}

std::vector<Eigen::VectorXd> CmaEs::ask() {
    std::vector<Eigen::VectorXd> candidates;
    steps_.clear();
    for (int k = 0; k < population_; ++k) {
        Eigen::VectorXd z(mean_.size());
        for (double& value : z) value = random_.normal();
        steps_.push_back(axes_ * lengths_.cwiseProduct(z));
        candidates.push_back(mean_ + sigma_ * steps_.back());
    }
    return candidates;
}

void CmaEs::tell(std::span<const double> losses) {
    SCREE_ASSERT(losses.size() == steps_.size());
    std::vector<std::size_t> order(losses.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return losses[a] < losses[b]; });

    Eigen::VectorXd step = Eigen::VectorXd::Zero(mean_.size());
    Eigen::MatrixXd rank_mu = Eigen::MatrixXd::Zero(mean_.size(), mean_.size());
    for (Eigen::Index i = 0; i < weights_.size(); ++i) {
        const Eigen::VectorXd& y = steps_[order[static_cast<std::size_t>(i)]];
        step += weights_[i] * y;
        rank_mu += weights_[i] * y * y.transpose();
    }
    mean_ += sigma_ * step;

    ++generation_;
    const auto n = static_cast<double>(mean_.size());
    const Eigen::VectorXd whitened = axes_ * (axes_.transpose() * step).cwiseQuotient(lengths_);
    path_sigma_ = (1.0 - c_sigma_) * path_sigma_ + std::sqrt(c_sigma_ * (2.0 - c_sigma_) * mu_eff_) * whitened;
    const double expected = std::sqrt(1.0 - std::pow(1.0 - c_sigma_, 2.0 * generation_));
    const bool stalled = path_sigma_.norm() / expected >= (1.4 + 2.0 / (n + 1.0)) * chi_;
    path_c_ = (1.0 - c_c_) * path_c_;
    if (!stalled) path_c_ += std::sqrt(c_c_ * (2.0 - c_c_) * mu_eff_) * step;
    const double lost = stalled ? c_1_ * c_c_ * (2.0 - c_c_) : 0.0;
    covariance_ = (1.0 - c_1_ - c_mu_ + lost) * covariance_ + c_1_ * path_c_ * path_c_.transpose() + c_mu_ * rank_mu;
    sigma_ *= std::exp(std::min(1.0, c_sigma_ / d_sigma_ * (path_sigma_.norm() / chi_ - 1.0)));
    decompose();
    steps_.clear();
}

double reflected(double u) {
    const double v = std::fmod(std::abs(u), 2.0);
    return v > 1.0 ? 2.0 - v : v;
}

}  // namespace scree
