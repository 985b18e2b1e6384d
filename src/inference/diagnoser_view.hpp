// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "inference/diagnoser.hpp"
#include "inference/emulated_search.hpp"

#include <utility>

namespace scree {

/// What the trials of a search are compared with: measurements, or an effect, in the residual space of one simulation.
struct Diagnoser::View {
    View(ResidualSpace of, const ObservationTable& measured)
        : space(std::move(of)),
          observed(mean_residual(space.of(measured))),
          noise(mean_covariance(row_covariance(space), observed.together)),
          left(in_noise(observed.mean).squaredNorm()) {}
    Eigen::VectorXd in_noise(const Eigen::VectorXd& mean) const { return noise.matrixL().solve(mean); }

    /// Variance that the noise of a trial has at least: of the measured mean, which has as many rows [-].
    static constexpr double kLeastNoise = 0.25;

    ResidualSpace space;
    ResidualMean observed;
    Eigen::LLT<Eigen::MatrixXd> noise;  ///< of the measured mean
    double left;                        ///< by the simulation behind it [-]
};

}  // namespace scree
