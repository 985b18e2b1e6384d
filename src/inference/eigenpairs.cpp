// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/eigenpairs.hpp"

#include <Eigen/Eigenvalues>

namespace scree {

Eigenpairs eigenpairs(const Eigen::MatrixXd& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace scree
