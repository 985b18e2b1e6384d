// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace scree {

/// Several noisy functions on the unit cube as Gaussian processes, which tell their values and how sure these are where nothing was tried (Sacks, Welch,
/// Mitchell & Wynn 1989, Stat Sci 4:409-435; Rasmussen & Williams 2006, Gaussian processes for machine learning, chapters 2 and 4).
///
/// Each function is a plane plus a process with a Matern 5/2 covariance plus noise. Lengths, one per coordinate, are shared by all functions; variance and
/// noise are each function's own, those that make its values most likely, so that all share one eigendecomposition of the correlations. The plane is part of
/// the process, with a variance so large that the points decide (ibid., section 2.7).
class Emulator {
public:
    /// `points`: one per row, in [0, 1]; `values`: one row per point, one column per function; `lengths`: one per coordinate [-]. `least_noise`: variance that the noise of
    /// every function has at least, in its squared unit; > 0.
    Emulator(Eigen::MatrixXd points, const Eigen::MatrixXd& values, const Eigen::VectorXd& lengths, double least_noise);

    /// One row per place, one column per function; without the noise.
    struct Prediction {
        Eigen::MatrixXd mean, variance;
    };
    Prediction at(const Eigen::MatrixXd& places) const;
    /// Derivatives of the means there, one row per function, one column per coordinate.
    Eigen::MatrixXd slopes(const Eigen::VectorXd& place) const;
    /// Of the noise, per function.
    const Eigen::VectorXd& noise() const { return noise_; }
    /// Of all values, with the best variance and noise of each function, up to a constant.
    double log_likelihood() const { return log_likelihood_; }

    /// Lengths that make the values more likely than those to begin with: one coordinate after the other, by factors.
    static Eigen::VectorXd likely_lengths(const Eigen::MatrixXd& points, const Eigen::MatrixXd& values,
                                          Eigen::VectorXd lengths, double least_noise);

private:
    Eigen::MatrixXd points_;
    Eigen::VectorXd lengths_;
    Eigen::RowVectorXd middle_;  ///< of the values
    Eigen::MatrixXd axes_;       ///< eigenvectors of the correlations of the points, as columns
    Eigen::MatrixXd shrink_;     ///< points x functions: 1 / (eigenvalue + noise / variance)
    Eigen::MatrixXd alpha_;      ///< points x functions: mean = correlations with the points times this
    Eigen::VectorXd variance_, noise_;
    double log_likelihood_ = 0.0;
};

}  // namespace scree
