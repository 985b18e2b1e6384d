// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/dynamics/contact_solver.hpp"

#include <algorithm>
#include <limits>

namespace scree {

template <int Dim>
Eigen::Matrix<double, kLocalSize<Dim>, 1> project_on_cone(const Eigen::Matrix<double, kLocalSize<Dim>, 1>& p, double mu,
                                                          double mu_r) {
    constexpr int T = Dim - 1;
    // min over x >= 0 of (x - p_N)^2 + (|p_T| - mu x)+^2 + (|p_R| - mu_r x)+^2: its derivative is increasing and piecewise linear
    const double t = p.template segment<T>(1).norm(), m = p.template segment<T>(1 + T).norm();
    using Local = Eigen::Matrix<double, kLocalSize<Dim>, 1>;
    if (p[0] + mu * t + mu_r * m <= 0.0) return Local::Zero();
    // each branch's minimum is a candidate, the true objective decides: no branch test that rounding could make fail
    double x = 0.0, least = std::numeric_limits<double>::infinity();
    for (const bool slides : {true, false}) {
        for (const bool rolls : {true, false}) {
            const double candidate = std::max(0.0, (p[0] + (slides ? mu * t : 0.0) + (rolls ? mu_r * m : 0.0)) /
                                                       (1.0 + (slides ? mu * mu : 0.0) + (rolls ? mu_r * mu_r : 0.0)));
            const double dn = candidate - p[0], dt = std::max(t - mu * candidate, 0.0),
                         dm = std::max(m - mu_r * candidate, 0.0);
            const double objective = dn * dn + dt * dt + dm * dm;
            if (objective < least) {
                least = objective;
                x = candidate;
            }
        }
    }
    Local result = p;
    result[0] = x;
    if (t > mu * x) result.template segment<T>(1) *= mu * x / t;
    if (m > mu_r * x) result.template segment<T>(1 + T) *= mu_r * x / m;
    return result;
}

template Eigen::Matrix<double, 3, 1> project_on_cone<2>(const Eigen::Matrix<double, 3, 1>&, double, double);
template Eigen::Matrix<double, 5, 1> project_on_cone<3>(const Eigen::Matrix<double, 5, 1>&, double, double);

}  // namespace scree
