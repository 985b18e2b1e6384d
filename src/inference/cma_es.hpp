// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/random.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace scree {

/// Evolution strategy with covariance matrix adaptation, (mu/mu_w, lambda), as in N. Hansen, The CMA evolution strategy: a tutorial, arXiv:1604.00772
/// (2016), table 1 and figure 6, with positive weights. It sees ranks only: losses may be noisy and of any scale, and it needs no derivatives.
/// Ask for candidates, tell what they lost, as often as wanted.
class CmaEs {
public:
    /// `population` 0: 4 + 3 ln(dimension).
    CmaEs(const Eigen::VectorXd& mean, double sigma, int population, RandomStream random);

    std::vector<Eigen::VectorXd> ask();
    /// Losses of the candidates that were asked for last, in their order; infinite ones rank last.
    void tell(std::span<const double> losses);

    /// Where the next candidates are drawn around: averages the noise of many losses, unlike the best candidate.
    const Eigen::VectorXd& mean() const { return mean_; }
    double sigma() const { return sigma_; }
    /// Covariance of the next candidates.
    Eigen::MatrixXd covariance() const { return sigma_ * sigma_ * covariance_; }

    static int default_population(std::size_t dimension);

private:
    void decompose();

    RandomStream random_;
    Eigen::VectorXd mean_;
    double sigma_ = 0.0;
    Eigen::VectorXd weights_;  ///< of the better half [-]
    double mu_eff_ = 0.0, c_sigma_ = 0.0, d_sigma_ = 0.0, c_c_ = 0.0, c_1_ = 0.0, c_mu_ = 0.0, chi_ = 0.0;
    Eigen::MatrixXd covariance_, axes_;  ///< axes_: eigenvectors as columns
    Eigen::VectorXd lengths_;            ///< square roots of the eigenvalues
    Eigen::VectorXd path_sigma_, path_c_;
    std::vector<Eigen::VectorXd> steps_;  ///< of the candidates, before scaling by sigma
    int population_ = 0, generation_ = 0;
};

/// Into [0, 1] by reflection at its ends: the search does not know them, and a minimum on an end is an inner one.
double reflected(double u);

}  // namespace scree
