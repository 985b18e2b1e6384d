// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace scree {

/// x with |x| <= radius and A x + b = -lambda x, where lambda >= 0 is zero inside: the minimum of 1/2 x.A x + b.x over the disc where A is symmetric. A is positive
/// definite (1x1 or 2x2).
template <int T>
Eigen::Matrix<double, T, 1> minimise_on_disc(const Eigen::Matrix<double, T, T>& A, const Eigen::Matrix<double, T, 1>& b,
                                             double radius) {
    using Vector = Eigen::Matrix<double, T, 1>;
    using Matrix = Eigen::Matrix<double, T, T>;
    const Vector inside = A.inverse() * -b;
    if (inside.norm() <= radius) return inside;
    if (radius <= 0.0) return Vector::Zero();
    // (A + lambda I) x = -b with |x| = radius: Newton on 1/|x| - 1/radius, monotone from lambda = 0 (More & Sorensen 1983)
    double lambda = 0.0;
    Vector x = inside;
    for (int k = 0; k < 60; ++k) {
        const double norm = x.norm();
        if (std::abs(norm - radius) <= 1e-15 * radius) break;
        const Matrix shifted = A + lambda * Matrix::Identity();
        const Vector dx = -(shifted.inverse() * x);
        lambda += (norm - radius) / radius * norm * norm / -(x.dot(dx));
        lambda = std::max(lambda, 0.0);
        x = (A + lambda * Matrix::Identity()).inverse() * -b;
    }
    return x * (radius / x.norm());
}

}  // namespace scree
