// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "inference/emulator.hpp"

#include "scree/base/random.hpp"

#include <optional>
#include <vector>

namespace scree {

/// Looks for where the squares of several noisy functions on the unit cube have the least sum, with few trials: what is wanted of a simulation that takes
/// seconds, whose residuals are to vanish. Each residual has an emulator; their sum of squares, which has valleys and walls, has not. Trials are first spread
/// over the cube (Latin hypercube: McKay, Beckman & Conover 1979, Technometrics 21:239-245), then made in groups where the sum may be least: where it is
/// expected to be, and where it could be by so many of its standard deviations (after Cox & John 1992, A statistical method for global optimization, IEEE
/// SMC 1241-1246). Most of a group are made near the best one, the nearer the longer nothing better is found (trust region: Eriksson et al. 2019, Scalable global optimization via
/// local Bayesian optimization, NeurIPS 32): of many unknowns the corners are where most could be hoped for. Ask for trials, tell their residuals, as often as wanted.
class EmulatedSearch {
public:
    /// `least_noise`: variance that the noise of every residual has at least; > 0.
    EmulatedSearch(Eigen::Index dimension, double least_noise, RandomStream random);

    /// The first trials, and those of each group after them.
    static constexpr std::size_t kSpread = 40, kGroup = 8;
    std::vector<Eigen::VectorXd> ask();
    /// Residuals of the trials that were asked for last, in their order; empty where a trial says nothing: places like that are left alone.
    void tell(const std::vector<Eigen::VectorXd>& residuals);
    /// Other residuals of all trials so far: they are compared with something else now.
    void tell_again(const std::vector<Eigen::VectorXd>& residuals);
    /// The same where that is something else altogether, and the best place may be anywhere again.
    void tell_of_another(const std::vector<Eigen::VectorXd>& residuals);

    /// The trial for which the least sum is expected, and what is expected there; infinite, and the middle of the cube, as long as none says anything.
    const Eigen::VectorXd& best() const { return best_; }
    double left() const { return left_; }
    /// Derivatives of the residuals there, one row per residual, one column per coordinate; as long as nothing is known, no rows.
    Eigen::MatrixXd slopes() const;

private:
    struct Expected {
        Eigen::VectorXd sum, deviation;  ///< of the sum of squares, per place
    };
    Expected expected(const Eigen::MatrixXd& places) const;
    void learn();
    void emulate();
    Eigen::VectorXd near(const Eigen::VectorXd& u, double far);
    bool within_reach(const Eigen::VectorXd& u) const;
    bool says_nothing(const Eigen::VectorXd& u) const;

    Eigen::Index dimension_;
    double least_noise_;
    RandomStream random_;
    std::vector<Eigen::VectorXd> asked_;
    std::vector<Eigen::VectorXd> trials_, residuals_;  ///< all of them
    std::vector<std::size_t> telling_;                 ///< of these, by their sum of squares, least first
    Eigen::VectorXd lengths_;
    std::size_t next_lengths_ = kSpread;  ///< telling trials at which lengths are looked for again
    std::optional<Emulator> emulator_;
    double reach_;  ///< of the best one
    Eigen::VectorXd best_;
    double left_;
};

}  // namespace scree
