// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <vector>

namespace scree {

/// Number of local unknowns of a contact: normal, tangential (Dim - 1) and rolling (Dim - 1) components (B&A eq. 10).
template <int Dim>
inline constexpr int kLocalSize = 1 + 2 * (Dim - 1);

/// Coulomb friction with rolling resistance for all contacts of one block in one step (B&A eqs 13-20):
///
///     u = W p + q,   0 <= u_N  perp  r_N >= 0,
///     |r_T| <= mu r_N, sliding opposes r_T;   |m_R| <= mu_r r_N, rolling opposes m_R,
///
/// with p = (r_N, r_T, m_R) per contact and the restitution already in q (u_N here is u_N+ + e u_N-). Written once for Dim 2 and 3.
template <int Dim>
struct ContactProblem {
    static constexpr int kLocal = kLocalSize<Dim>;

    int count = 0;  ///< number of contacts [-]
    Eigen::MatrixXd
        delassus;  ///< W = G^T M^-1 G, kLocal count square, positive semidefinite; not symmetric where M has gyroscopic terms or a step looks ahead [1/kg, 1/(kg m), 1/(kg m^2)]
    Eigen::VectorXd free_velocity;  ///< q, contact by contact [m/s, rad/s]
    std::vector<double> friction;   ///< mu of each contact [-]
    std::vector<double> rolling;    ///< mu_r of each contact [m]

    void resize(int contacts);
};

struct ContactSolverSettings {
    double tolerance =
        1e-4;  ///< largest residual relative to the speed with which the contacts approach; smaller costs iterations [-]
    int newton_iterations = 30;  ///< semismooth Newton iterations before the sweeps take over [-]
    int sweeps = 400;            ///< Gauss-Seidel sweeps of the fallback, Newton is tried again in between [-]
    bool operator==(const ContactSolverSettings&) const = default;
};

enum class SolverStatus { NotRun, Converged, NotConverged };

struct ContactSolverReport {
    SolverStatus status = SolverStatus::NotRun;
    int newton_iterations = 0;  ///< [-]
    int sweeps = 0;             ///< [-]
    double residual = 0.0;      ///< at exit, of the nonsmooth equations, relative to the speed of approach [-]
};

/// Solves for the impulses p [N s, N m s]; `impulse` holds a first guess on entry (zero if none) and must have the right size.
/// Never throws: non-convergence is a status, the best impulse found is returned and lies in the cone.
template <int Dim>
ContactSolverReport solve_contacts(const ContactProblem<Dim>& problem, const ContactSolverSettings& settings,
                                   Eigen::VectorXd& impulse);

/// Relative natural-map residual of given impulses: p = proj(p - u~) contact by contact on the cone K_r with De Saxce's term
/// mu |u_T| + mu_r |omega_R| added to u_N (Acary & Bourrier 2021), in variables scaled so that a contact's W is of order one.
template <int Dim>
double natural_map_residual(const ContactProblem<Dim>& problem, const Eigen::VectorXd& impulse);

/// Euclidean projection on K_r = {|r_T| <= mu r_N, |m_R| <= mu_r r_N}, by the exact minimum of a piecewise quadratic.
template <int Dim>
Eigen::Matrix<double, kLocalSize<Dim>, 1> project_on_cone(const Eigen::Matrix<double, kLocalSize<Dim>, 1>& p, double mu,
                                                          double mu_r);

}  // namespace scree
