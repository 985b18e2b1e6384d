// SPDX-License-Identifier: GPL-3.0-or-later
// Contact law of B&A eqs 13-20 as a system of nonsmooth equations (Alart & Curnier 1991, extended by the rolling part), solved by a
// semismooth Newton method with line search; Gauss-Seidel sweeps over the contacts (Jourdan, Alart & Jean 1998) with an exact solver for
// one contact take over where Newton stalls. All in scaled variables: impulses and velocities of one contact are of order one.
#include "scree/dynamics/contact_solver.hpp"

#include "scree/base/assert.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

template <int Dim>
void ContactProblem<Dim>::resize(int contacts) {
    count = contacts;
    delassus.resize(kLocal * contacts, kLocal * contacts);
    free_velocity.resize(kLocal * contacts);
    friction.resize(static_cast<std::size_t>(contacts));
    rolling.resize(static_cast<std::size_t>(contacts));
}

namespace {

using Eigen::Dynamic;

constexpr double kTiny = 1e-300;
/// Share of the diagonal added to W inside Newton: W has at most rank 6, more than one contact makes it singular. It changes the path
/// of the iteration, not the equation that is solved.
constexpr double kNewtonRegularisation = 1e-9;

/// The problem in scaled variables: W~ = S W S, q~ = S q, p = S p~, with one S for the translational and one for the rolling components.
/// N is the number of unknowns if known to the compiler, else Dynamic.
template <int Dim, int N>
struct Scaled {
    static constexpr int kTangent = Dim - 1;
    static constexpr int kLocal = kLocalSize<Dim>;
    using Vector = Eigen::Matrix<double, N, 1>;
    using Matrix = Eigen::Matrix<double, N, N>;
    using Tangent = Eigen::Matrix<double, kTangent, 1>;
    using Local = Eigen::Matrix<double, kLocal, 1>;
    using LocalMatrix = Eigen::Matrix<double, kLocal, kLocal>;

    Matrix W;
    Vector q;
    Vector scale;                     ///< S
    using PerContact = Eigen::Matrix<double, N == Dynamic ? Dynamic : N / kLocal, 1>;
    PerContact mu, mu_r;              ///< mu unchanged, mu_r scaled
    double norm_q = 0.0;

    explicit Scaled(const ContactProblem<Dim>& problem)
        : Scaled(Eigen::Map<const Matrix>(problem.delassus.data(), problem.delassus.rows(), problem.delassus.cols()),
                 Eigen::Map<const Vector>(problem.free_velocity.data(), problem.free_velocity.size()),
                 Eigen::Map<const PerContact>(problem.friction.data(), problem.count), Eigen::Map<const PerContact>(problem.rolling.data(), problem.count)) {}

    Scaled(const Matrix& delassus, const Vector& free_velocity, const PerContact& friction, const PerContact& rolling)
        : W(delassus), q(free_velocity), scale(free_velocity.size()), mu(friction), mu_r(rolling) {
        for (int c = 0; c < count(); ++c) {
            const Eigen::Index at = static_cast<Eigen::Index>(c) * kLocal;
            double linear = 0.0, angular = 0.0;
            for (int k = 0; k <= kTangent; ++k) linear += W(at + k, at + k);
            for (int k = kTangent + 1; k < kLocal; ++k) angular += W(at + k, at + k);
            const double s = 1.0 / std::sqrt(std::max(linear / Dim, kTiny));
            const double s_r = 1.0 / std::sqrt(std::max(angular / kTangent, kTiny));
            for (int k = 0; k < kLocal; ++k) scale[at + k] = k <= kTangent ? s : s_r;
            // |m| <= mu_r r  <=>  s_r |m~| <= mu_r s r~
            mu_r[c] *= s / s_r;
        }
        W = scale.asDiagonal() * W * scale.asDiagonal();
        q = scale.cwiseProduct(q);
        norm_q = q.norm();
    }

    int count() const { return static_cast<int>(mu.size()); }
};

/// Residual F of the nonsmooth equations and, if wanted, its generalised Jacobian. Per contact with sigma = r_N - u_N:
///   F_N = u_N if sigma > 0 else r_N;   F_T = r_T - proj_{|y| <= mu max(sigma, 0)} (y), y = r_T - u_T;   F_R alike with mu_r.
template <int Dim, int N>
double residual(const Scaled<Dim, N>& s, const typename Scaled<Dim, N>::Vector& p, typename Scaled<Dim, N>::Vector& F,
                typename Scaled<Dim, N>::Matrix* jacobian) {
    using S = Scaled<Dim, N>;
    const typename S::Vector u = s.W.lazyProduct(p) + s.q;
    if (jacobian) jacobian->setZero(p.size(), p.size());
    for (int c = 0; c < s.count(); ++c) {
        const Eigen::Index n = static_cast<Eigen::Index>(c) * S::kLocal;
        const double sigma = p[n] - u[n];
        if (sigma > 0.0) {
            F[n] = u[n];
            if (jacobian) jacobian->row(n) = s.W.row(n);
        } else {
            F[n] = p[n];
            if (jacobian) (*jacobian)(n, n) = 1.0;
        }
        for (int part = 0; part < 2; ++part) {
            const Eigen::Index at = n + 1 + part * S::kTangent;
            const double limit = (part == 0 ? s.mu : s.mu_r)[c];
            const double threshold = limit * std::max(sigma, 0.0);
            const typename S::Tangent y = p.template segment<S::kTangent>(at) - u.template segment<S::kTangent>(at);
            const double length = y.norm();
            if (length <= threshold) {  // sticks (or does not roll)
                F.template segment<S::kTangent>(at) = u.template segment<S::kTangent>(at);
                if (jacobian) jacobian->template middleRows<S::kTangent>(at) = s.W.template middleRows<S::kTangent>(at);
                continue;
            }
            const typename S::Tangent direction = y / length;
            F.template segment<S::kTangent>(at) = p.template segment<S::kTangent>(at) - threshold * direction;
            if (!jacobian) continue;
            // d(threshold direction) = limit direction dsigma + threshold/length (I - direction direction^T) dy
            const Eigen::Matrix<double, S::kTangent, S::kTangent> turn =
                threshold / length *
                (Eigen::Matrix<double, S::kTangent, S::kTangent>::Identity() - direction * direction.transpose());
            jacobian->template middleRows<S::kTangent>(at) = turn * s.W.template middleRows<S::kTangent>(at);
            jacobian->template block<S::kTangent, S::kTangent>(at, at) +=
                Eigen::Matrix<double, S::kTangent, S::kTangent>::Identity() - turn;
            if (sigma > 0.0) {
                jacobian->template middleRows<S::kTangent>(at) += limit * direction * s.W.row(n);
                jacobian->template block<S::kTangent, 1>(at, n) -= limit * direction;
            }
        }
    }
    return F.norm();
}

/// x with A x = b by elimination with row pivoting; A and b are used up. Written out for sizes known to the compiler, where it beats the general
/// factorisation by far.
template <int N>
Eigen::Matrix<double, N, 1> solve_linear(Eigen::Matrix<double, N, N>& A, Eigen::Matrix<double, N, 1> b) {
    if constexpr (N == Dynamic) {
        return A.partialPivLu().solve(b);
    } else {
        Eigen::Matrix<double, N, N, Eigen::RowMajor> rows = A;
        for (int k = 0; k < N; ++k) {
            int pivot = k;
            for (int i = k + 1; i < N; ++i)
                if (std::abs(rows(i, k)) > std::abs(rows(pivot, k))) pivot = i;
            if (pivot != k) {
                rows.row(k).swap(rows.row(pivot));
                std::swap(b[k], b[pivot]);
            }
            const double inverse = 1.0 / rows(k, k);
            for (int i = k + 1; i < N; ++i) {
                const double factor = rows(i, k) * inverse;
                if (factor == 0.0) continue;
                for (int j = k + 1; j < N; ++j) rows(i, j) -= factor * rows(k, j);
                b[i] -= factor * b[k];
            }
        }
        for (int k = N - 1; k >= 0; --k) {
            for (int j = k + 1; j < N; ++j) b[k] -= rows(k, j) * b[j];
            b[k] /= rows(k, k);
        }
        return b;
    }
}

/// Newton with backtracking. Returns the relative residual; p is the best point met.
template <int Dim, int N>
double newton(const Scaled<Dim, N>& s, double tolerance, int iterations, typename Scaled<Dim, N>::Vector& p, int& used) {
    using S = Scaled<Dim, N>;
    typename S::Vector F(p.size()), trial(p.size()), trial_F(p.size());
    typename S::Matrix J(p.size(), p.size());
    double norm = residual<Dim, N>(s, p, F, &J);
    typename S::Vector best = p;
    double best_norm = norm;
    int stalled = 0;
    for (int k = 0; k < iterations && norm > tolerance * s.norm_q; ++k, ++used) {
        J.diagonal().array() += kNewtonRegularisation;
        const typename S::Vector step = solve_linear<N>(J, -F);
        if (!step.allFinite()) break;
        double length = 1.0;
        double trial_norm = 0.0;
        for (int cut = 0; cut < 8; ++cut, length *= 0.5) {
            trial = p + length * step;
            trial_norm = residual<Dim, N>(s, trial, trial_F, nullptr);
            if (trial_norm < (1.0 - 1e-4 * length) * norm) break;
        }
        // a full step now and then, even uphill, leaves the kinks where the line search would stop for ever
        if (trial_norm >= norm) {
            if (++stalled > 3) break;
            trial = p + step;
        }
        p = trial;
        norm = residual<Dim, N>(s, p, F, &J);
        if (norm < best_norm) {
            best_norm = norm;
            best = p;
        }
    }
    p = best;
    return best_norm / std::max(s.norm_q, kTiny);
}

/// min 1/2 a |x|^2-like problem on a disc: minimises 1/2 x.A x + b.x over |x| <= radius, A symmetric positive definite (1x1 or 2x2).
template <int T>
Eigen::Matrix<double, T, 1> minimise_on_disc(const Eigen::Matrix<double, T, T>& A, const Eigen::Matrix<double, T, 1>& b, double radius) {
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

/// One contact, whatever Newton says: for a given r_N friction and rolling are a convex problem on two discs, and the normal velocity that
/// results is continuous in r_N, negative at zero and positive for large r_N: a root is bracketed and bisected.
template <int Dim>
Eigen::Matrix<double, kLocalSize<Dim>, 1> solve_one_by_bisection(const Eigen::Matrix<double, kLocalSize<Dim>, kLocalSize<Dim>>& W,
                                                                 const Eigen::Matrix<double, kLocalSize<Dim>, 1>& q, double mu,
                                                                 double mu_r) {
    constexpr int T = Dim - 1;
    using Local = Eigen::Matrix<double, kLocalSize<Dim>, 1>;
    using Tangent = Eigen::Matrix<double, T, 1>;
    using Block = Eigen::Matrix<double, T, T>;
    Local p = Local::Zero();
    const Block A = W.template block<T, T>(1, 1), B = W.template block<T, T>(1 + T, 1 + T), C = W.template block<T, T>(1, 1 + T);
    auto normal_velocity = [&](double r) {
        p[0] = r;
        const Tangent a = q.template segment<T>(1) + W.template block<T, 1>(1, 0) * r;
        const Tangent b = q.template segment<T>(1 + T) + W.template block<T, 1>(1 + T, 0) * r;
        Tangent x = p.template segment<T>(1), m = p.template segment<T>(1 + T);
        for (int k = 0; k < 500; ++k) {
            const Tangent x_new = minimise_on_disc<T>(A, a + C * m, mu * r);
            const Tangent m_new = minimise_on_disc<T>(B, b + C.transpose() * x_new, mu_r * r);
            const double change = (x_new - x).norm() + (m_new - m).norm();
            x = x_new;
            m = m_new;
            if (change <= 1e-15 * (1.0 + x.norm() + m.norm())) break;
        }
        p.template segment<T>(1) = x;
        p.template segment<T>(1 + T) = m;
        return W.row(0).dot(p) + q[0];
    };
    if (q[0] >= 0.0) return p;
    double low = 0.0, high = std::max(-q[0] / W(0, 0), kTiny);
    for (int k = 0; k < 200 && normal_velocity(high) < 0.0; ++k) {
        low = high;
        high *= 2.0;
    }
    for (int k = 0; k < 100 && high - low > 1e-16 * high; ++k) {
        const double mid = 0.5 * (low + high);
        (normal_velocity(mid) < 0.0 ? low : high) = mid;
    }
    normal_velocity(high);
    return p;
}

/// One contact in scaled variables: take-off, sticking without rolling, else Newton, else bisection.
template <int Dim>
Eigen::Matrix<double, kLocalSize<Dim>, 1> solve_one(const Scaled<Dim, kLocalSize<Dim>>& s, double tolerance,
                                                    const Eigen::Matrix<double, kLocalSize<Dim>, 1>& guess, int& newton_used, double& achieved) {
    constexpr int T = Dim - 1;
    using Local = Eigen::Matrix<double, kLocalSize<Dim>, 1>;
    achieved = 0.0;
    if (s.q[0] >= 0.0) return Local::Zero();
    if (guess[0] > 0.0) {
        Local p = guess;
        achieved = newton<Dim, kLocalSize<Dim>>(s, tolerance, 4, p, newton_used);  // mostly one iteration away
        if (achieved <= tolerance) return p;
    }
    const Local stick = s.W.llt().solve(-s.q);
    achieved = 0.0;
    if (stick[0] > 0.0 && stick.template segment<T>(1).norm() <= s.mu[0] * stick[0] &&
        stick.template segment<T>(1 + T).norm() <= s.mu_r[0] * stick[0])
        return stick;
    // slide against the sticking impulse: the right side of every kink in most cases
    Local p = stick.allFinite() ? stick : Local(Local::Zero());
    p[0] = std::max(p[0], -s.q[0] / s.W(0, 0));
    achieved = newton<Dim, kLocalSize<Dim>>(s, tolerance, 30, p, newton_used);
    if (achieved <= tolerance) return p;
    const Local robust = solve_one_by_bisection<Dim>(s.W, s.q, s.mu[0], s.mu_r[0]);
    Local F;
    const double robust_residual = residual<Dim, kLocalSize<Dim>>(s, robust, F, nullptr) / std::max(s.norm_q, kTiny);
    if (robust_residual < achieved) {
        achieved = robust_residual;
        return robust;
    }
    return p;
}

/// Moves every contact's impulse into its cone: what Newton leaves is outside by the size of the residual.
template <int Dim, int N>
void clip_to_cone(const Scaled<Dim, N>& s, typename Scaled<Dim, N>::Vector& p) {
    using S = Scaled<Dim, N>;
    for (int c = 0; c < s.count(); ++c) {
        const Eigen::Index n = static_cast<Eigen::Index>(c) * S::kLocal;
        p[n] = std::max(p[n], 0.0);
        for (int part = 0; part < 2; ++part) {
            const Eigen::Index at = n + 1 + part * S::kTangent;
            const double limit = (part == 0 ? s.mu : s.mu_r)[c] * p[n];
            const double length = p.template segment<S::kTangent>(at).norm();
            if (length > limit) p.template segment<S::kTangent>(at) *= limit / std::max(length, kTiny);
        }
    }
}

/// Solves contact c exactly with the impulses of the others held.
template <int Dim, int N>
void relax_contact(const Scaled<Dim, N>& s, int c, typename Scaled<Dim, N>::Vector& p) {
    constexpr int L = kLocalSize<Dim>;
    const Eigen::Index n = static_cast<Eigen::Index>(c) * L;
    using One = Scaled<Dim, L>;
    const typename One::Matrix block = s.W.template block<L, L>(n, n);
    const typename One::Vector held = s.q.template segment<L>(n) + s.W.template middleRows<L>(n) * p - block * p.template segment<L>(n);
    const One local(block, held, typename One::PerContact(s.mu[c]), typename One::PerContact(s.mu_r[c]));
    int used = 0;
    double achieved = 0.0;
    const Eigen::Matrix<double, L, 1> guess = p.segment(n, L).cwiseQuotient(local.scale);
    p.segment(n, L) = local.scale.cwiseProduct(solve_one<Dim>(local, 1e-12, guess, used, achieved));
}

/// One Gauss-Seidel sweep over the contacts.
template <int Dim, int N>
void sweep(const Scaled<Dim, N>& s, typename Scaled<Dim, N>::Vector& p) {
    for (int c = 0; c < s.count(); ++c) relax_contact<Dim, N>(s, c, p);
}

/// A cold start: every contact by itself carries its share. Unlike a sweep it favours no contact: where several impulses solve the problem, as for a
/// box that slides on four corners, the one found keeps the symmetry of the problem.
template <int Dim, int N>
void start_together(const Scaled<Dim, N>& s, typename Scaled<Dim, N>::Vector& p) {
    using Vector = typename Scaled<Dim, N>::Vector;
    const Vector nothing = Vector::Zero(s.q.size());
    p = nothing;
    for (int c = 0; c < s.count(); ++c) {
        Vector alone = nothing;
        relax_contact<Dim, N>(s, c, alone);
        p += alone / s.count();
    }
}

template <int Dim, int N>
double relative_residual(const Scaled<Dim, N>& s, const typename Scaled<Dim, N>::Vector& p) {
    typename Scaled<Dim, N>::Vector F(p.size());
    return residual<Dim, N>(s, p, F, nullptr) / std::max(s.norm_q, kTiny);
}

/// Continuation in compliance: contacts made soft by a share of their own diagonal are nearly independent, Newton then finds the solution
/// from anywhere; the compliance is lowered to nothing while Newton follows.
template <int Dim, int N>
typename Scaled<Dim, N>::Vector follow_compliance(const Scaled<Dim, N>& s, double compliance, const ContactSolverSettings& settings, int& newton_used) {
    Scaled<Dim, N> soft = s;
    typename Scaled<Dim, N>::Vector p = Scaled<Dim, N>::Vector::Zero(s.q.size());
    soft.W.diagonal() = s.W.diagonal() * (1.0 + compliance);
    start_together<Dim, N>(soft, p);
    for (; compliance > 1e-7; compliance *= 0.4) {
        soft.W.diagonal() = s.W.diagonal() * (1.0 + compliance);
        newton<Dim, N>(soft, 1e-6, settings.newton_iterations, p, newton_used);
    }
    newton<Dim, N>(s, settings.tolerance, settings.newton_iterations, p, newton_used);
    return p;
}

template <int Dim>
ContactSolverReport solve_single(const ContactProblem<Dim>& problem, const ContactSolverSettings& settings, Eigen::VectorXd& impulse) {
    using S = Scaled<Dim, kLocalSize<Dim>>;
    ContactSolverReport report;
    const S s(problem);
    const typename S::Vector guess = impulse.cwiseQuotient(s.scale);
    typename S::Vector p = solve_one<Dim>(s, settings.tolerance, guess, report.newton_iterations, report.residual);
    clip_to_cone<Dim, kLocalSize<Dim>>(s, p);
    impulse = s.scale.cwiseProduct(p);
    report.status = report.residual <= settings.tolerance ? SolverStatus::Converged : SolverStatus::NotConverged;
    return report;
}

template <int Dim, int N>
ContactSolverReport solve_several(const ContactProblem<Dim>& problem, const ContactSolverSettings& settings, Eigen::VectorXd& impulse) {
    using S = Scaled<Dim, N>;
    ContactSolverReport report;
    const S s(problem);
    typename S::Vector p = impulse.cwiseQuotient(s.scale);
    if (p.squaredNorm() == 0.0) {
        start_together<Dim, N>(s, p);  // sorts out most of the contact states
        ++report.sweeps;
    }
    report.residual = newton<Dim, N>(s, settings.tolerance, settings.newton_iterations, p, report.newton_iterations);
    typename S::Vector best = p;
    auto keep_if_better = [&](const typename S::Vector& candidate, double achieved) {
        if (!(achieved < report.residual)) return;
        report.residual = achieved;
        best = candidate;
    };
    for (const double first_compliance : {1.0, 30.0, 0.03}) {
        if (report.residual <= settings.tolerance) break;
        p = follow_compliance<Dim, N>(s, first_compliance, settings, report.newton_iterations);
        keep_if_better(p, relative_residual<Dim, N>(s, p));
    }
    // one contact carries all: the right start where two nearly coincide
    for (int c = 0; c < problem.count && report.residual > settings.tolerance; ++c) {
        p.setZero();
        relax_contact<Dim, N>(s, c, p);
        const double achieved = newton<Dim, N>(s, settings.tolerance, settings.newton_iterations, p, report.newton_iterations);
        keep_if_better(p, achieved);
    }
    // Newton again after 1, 2, 4, ... sweeps from where the sweeps are
    for (int next = 1; report.residual > settings.tolerance && report.sweeps < settings.sweeps; next *= 2) {
        p = best;
        clip_to_cone<Dim, N>(s, p);
        for (int k = 0; k < next && report.sweeps < settings.sweeps; ++k, ++report.sweeps) sweep<Dim, N>(s, p);
        keep_if_better(p, relative_residual<Dim, N>(s, p));
        const double achieved = newton<Dim, N>(s, settings.tolerance, settings.newton_iterations, p, report.newton_iterations);
        keep_if_better(p, achieved);
    }
    p = best;
    clip_to_cone<Dim, N>(s, p);
    impulse = s.scale.cwiseProduct(p);
    report.status = report.residual <= settings.tolerance ? SolverStatus::Converged : SolverStatus::NotConverged;
    return report;
}

}  // namespace

template <int Dim>
ContactSolverReport solve_contacts(const ContactProblem<Dim>& problem, const ContactSolverSettings& settings, Eigen::VectorXd& impulse) {
    SCREE_ASSERT(impulse.size() == problem.free_velocity.size());
    if (problem.count == 0) return {SolverStatus::Converged, 0, 0, 0.0};
    constexpr int L = kLocalSize<Dim>;
    switch (problem.count) {  // sizes known to the compiler for the cases that matter
        case 1: return solve_single<Dim>(problem, settings, impulse);
        case 2: return solve_several<Dim, 2 * L>(problem, settings, impulse);
        case 3: return solve_several<Dim, 3 * L>(problem, settings, impulse);
        case 4: return solve_several<Dim, 4 * L>(problem, settings, impulse);
        default: return solve_several<Dim, Dynamic>(problem, settings, impulse);
    }
}

template <int Dim>
Eigen::Matrix<double, kLocalSize<Dim>, 1> project_on_cone(const Eigen::Matrix<double, kLocalSize<Dim>, 1>& p, double mu, double mu_r) {
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
            const double dn = candidate - p[0], dt = std::max(t - mu * candidate, 0.0), dm = std::max(m - mu_r * candidate, 0.0);
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

template <int Dim>
double natural_map_residual(const ContactProblem<Dim>& problem, const Eigen::VectorXd& impulse) {
    constexpr int T = Dim - 1;
    constexpr int L = kLocalSize<Dim>;
    using Local = Eigen::Matrix<double, L, 1>;
    const Scaled<Dim, Dynamic> s(problem);
    const Eigen::VectorXd p = impulse.cwiseQuotient(s.scale);
    const Eigen::VectorXd u = s.W * p + s.q;
    double sum = 0.0;
    for (int c = 0; c < problem.count; ++c) {
        const double mu = s.mu[c], mu_r = s.mu_r[c];
        const Local pc = p.segment(c * L, L);
        Local y = pc - u.segment(c * L, L);
        y[0] -= mu * u.template segment<T>(c * L + 1).norm() + mu_r * u.template segment<T>(c * L + 1 + T).norm();
        sum += (pc - project_on_cone<Dim>(y, mu, mu_r)).squaredNorm();
    }
    return std::sqrt(sum) / std::max(s.norm_q, kTiny);
}

template struct ContactProblem<2>;
template struct ContactProblem<3>;
template ContactSolverReport solve_contacts<2>(const ContactProblem<2>&, const ContactSolverSettings&, Eigen::VectorXd&);
template ContactSolverReport solve_contacts<3>(const ContactProblem<3>&, const ContactSolverSettings&, Eigen::VectorXd&);
template Eigen::Matrix<double, 3, 1> project_on_cone<2>(const Eigen::Matrix<double, 3, 1>&, double, double);
template Eigen::Matrix<double, 5, 1> project_on_cone<3>(const Eigen::Matrix<double, 5, 1>&, double, double);
template double natural_map_residual<2>(const ContactProblem<2>&, const Eigen::VectorXd&);
template double natural_map_residual<3>(const ContactProblem<3>&, const Eigen::VectorXd&);

}  // namespace scree
