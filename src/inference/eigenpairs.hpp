// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace scree {

struct Eigenpairs {
    Eigen::VectorXd values;   ///< ascending [*]
    Eigen::MatrixXd vectors;  ///< of length one, as columns, in that order; their signs mean nothing
};

/// Of a symmetric matrix, of which the lower triangle is read. In a file of its own: Eigen's solver takes longer to compile than the rest of a file that uses it.
Eigenpairs eigenpairs(const Eigen::MatrixXd& symmetric);

}  // namespace scree
