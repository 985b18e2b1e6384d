// SPDX-License-Identifier: GPL-3.0-or-later
// Contact law of B&A eqs 13-20 as a system of nonsmooth equations (Alart & Curnier 1991, extended by the rolling part), solved by a
// semismooth Newton method with line search; Gauss-Seidel sweeps over the contacts (Jourdan, Alart & Jean 1998) with an exact solver for
// one contact take over where Newton stalls. All in scaled variables: impulses and velocities of one contact are of order one.
// Plain loops over sizes known to the compiler: expressions of this size would cost more to compile than to run.
#include "scree/dynamics/contact_solver.hpp"

#include "dynamics/disc_problem.hpp"
#include "dynamics/plane_problem.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

namespace scree {

template <int Dim>
void ContactProblem<Dim>::resize(int contacts) {
    if (contacts == count) return;
    count = contacts;
    delassus.resize(kLocal * contacts, kLocal * contacts);
    free_velocity.resize(kLocal * contacts);
    friction.resize(static_cast<std::size_t>(contacts));
    rolling.resize(static_cast<std::size_t>(contacts));
}

namespace {

constexpr double kTiny = 1e-300;
/// Smallest approach that a residual is relative to, as a share of the free velocity [-].
constexpr double kLeastMeasure = 1e-6;
/// Added to the diagonal inside Newton, as a share of the relative residual and within these limits (W is of order one): W has at most rank 6, more
/// than one contact makes it singular. Far from the solution it keeps steps short where contacts bear against each other, near it Newton stays
/// quadratic. It changes the path of the iteration, not the equation that is solved.
constexpr double kRegularisationShare = 0.1, kLeastRegularisation = 1e-8, kMostRegularisation = 1e-3;

/// Sizes and storage for C contacts; C = 0 where the compiler does not know how many.
template <int Dim, int C>
struct Sizes {
    static constexpr std::size_t T = Dim - 1, L = kLocalSize<Dim>, N = C * L;
    using Vector = std::conditional_t<(C > 0), std::array<double, N>, std::vector<double>>;
    using Matrix = std::conditional_t<(C > 0), std::array<double, N * N>, std::vector<double>>;
    using PerContact = std::conditional_t<(C > 0), std::array<double, C>, std::vector<double>>;
    using Local = std::array<double, L>;

    std::size_t given_count;
    explicit Sizes(std::size_t contacts) : given_count(contacts) {}
    std::size_t count() const { return C > 0 ? C : given_count; }
    std::size_t size() const { return count() * L; }
    template <class Numbers>
    static Numbers zeros(std::size_t n) {
        if constexpr (C > 0)
            return Numbers{};
        else
            return Numbers(n, 0.0);
    }
    Vector vector() const { return zeros<Vector>(size()); }
    Matrix matrix() const { return zeros<Matrix>(size() * size()); }
};

template <class Vector>
double norm(const Vector& x) {
    double sum = 0.0;
    for (const double v : x) sum += v * v;
    return std::sqrt(sum);
}

template <std::size_t T>
double length(const double* x) {
    if constexpr (T == 1)
        return std::abs(x[0]);
    else
        return std::sqrt(x[0] * x[0] + x[1] * x[1]);
}

/// The problem in scaled variables: W~ = S W S, q~ = S q, p = S p~, with one S for the translational and one for the rolling components.
template <int Dim, int C>
struct Scaled : Sizes<Dim, C> {
    using Size = Sizes<Dim, C>;
    using Size::count, Size::size, Size::L, Size::T;
    using typename Size::PerContact, typename Size::Vector, typename Size::Matrix;

    Matrix W = Size::matrix();                                    ///< column by column
    Vector q = Size::vector(), scale = Size::vector();            ///< scale: S
    PerContact mu = Size::template zeros<PerContact>(count());    ///< unchanged
    PerContact mu_r = Size::template zeros<PerContact>(count());  ///< scaled
    double norm_q = 0.0;
    /// What a residual is relative to: the speed of approach that the impulses have to stop, and not that along the ground. What a short step of friction
    /// takes from a fast block is a small part of its speed, and would not be seen. Not so small that rounding would count.
    double measure = 0.0;

    /// From a matrix whose columns begin `stride` numbers apart.
    Scaled(std::size_t contacts, const double* delassus, std::size_t stride, const double* free_velocity,
           const double* friction, const double* rolling)
        : Size(contacts) {
        for (std::size_t c = 0; c < count(); ++c) {
            double linear = 0.0, angular = 0.0;
            for (std::size_t k = 0; k < L; ++k) (k <= T ? linear : angular) += delassus[(c * L + k) * (stride + 1)];
            const double s = 1.0 / std::sqrt(std::max(linear / Dim, kTiny)),
                         s_r = 1.0 / std::sqrt(std::max(angular / T, kTiny));
            for (std::size_t k = 0; k < L; ++k) scale[c * L + k] = k <= T ? s : s_r;
            mu[c] = friction[c];
            mu_r[c] = rolling[c] * s / s_r;  // |m| <= mu_r r  <=>  s_r |m~| <= mu_r s r~
        }
        for (std::size_t j = 0; j < size(); ++j) {
            q[j] = scale[j] * free_velocity[j];
            for (std::size_t i = 0; i < size(); ++i) W[j * size() + i] = scale[i] * delassus[j * stride + i] * scale[j];
        }
        norm_q = norm(q);
        double approach = 0.0;
        for (std::size_t c = 0; c < count(); ++c) approach = std::hypot(approach, std::min(q[c * L], 0.0));
        measure = std::max({approach, kLeastMeasure * norm_q, kTiny});
    }
    explicit Scaled(const ContactProblem<Dim>& p)
        : Scaled(p.friction.size(), p.delassus.data(), p.friction.size() * L, p.free_velocity.data(), p.friction.data(),
                 p.rolling.data()) {}

    double entry(std::size_t i, std::size_t j) const { return W[j * size() + i]; }
    /// u = W p + q. By columns: sums of independent entries, for the vectoriser.
    Vector velocity(const Vector& p) const {
        Vector u = q;
        for (std::size_t j = 0; j < size(); ++j)
            for (std::size_t i = 0; i < size(); ++i) u[i] += W[j * size() + i] * p[j];
        return u;
    }
    void set_impulse(const Vector& p, Eigen::VectorXd& impulse) const {
        for (std::size_t i = 0; i < size(); ++i) impulse[static_cast<Eigen::Index>(i)] = scale[i] * p[i];
    }
    Vector scaled_impulse(const Eigen::VectorXd& impulse) const {
        Vector p = Size::vector();
        for (std::size_t i = 0; i < size(); ++i) p[i] = impulse[static_cast<Eigen::Index>(i)] / scale[i];
        return p;
    }
};

/// Residual F of the nonsmooth equations at p with u = W p + q. Per contact with sigma = r_N - u_N:
///   F_N = u_N if sigma > 0 else r_N;   F_T = r_T - proj_{|y| <= mu max(sigma, 0)} (y), y = r_T - u_T;   F_R alike with mu_r.
template <int Dim, int C>
double residual(const Scaled<Dim, C>& s, const typename Scaled<Dim, C>::Vector& p,
                const typename Scaled<Dim, C>::Vector& u, typename Scaled<Dim, C>::Vector& F) {
    constexpr std::size_t T = Scaled<Dim, C>::T, L = Scaled<Dim, C>::L;
    for (std::size_t c = 0; c < s.count(); ++c) {
        const std::size_t n = c * L;
        const double sigma = p[n] - u[n];
        F[n] = sigma > 0.0 ? u[n] : p[n];
        for (std::size_t at = n + 1; at < n + L; at += T) {
            const double threshold = (at == n + 1 ? s.mu : s.mu_r)[c] * std::max(sigma, 0.0);
            double y[T];
            for (std::size_t k = 0; k < T; ++k) y[k] = p[at + k] - u[at + k];
            const double pull = length<T>(y);
            const double share = threshold / pull;
            for (std::size_t k = 0; k < T; ++k) F[at + k] = pull <= threshold ? u[at + k] : p[at + k] - share * y[k];
        }
    }
    return norm(F);
}
template <int Dim, int C>
double residual(const Scaled<Dim, C>& s, const typename Scaled<Dim, C>::Vector& p, typename Scaled<Dim, C>::Vector& F) {
    return residual<Dim, C>(s, p, s.velocity(p), F);
}

/// Generalised Jacobian of F row by row.
template <int Dim, int C>
[[gnu::noinline]] void jacobian(const Scaled<Dim, C>& s, const typename Scaled<Dim, C>::Vector& p,
                                const typename Scaled<Dim, C>::Vector& u, typename Scaled<Dim, C>::Matrix& J) {
    constexpr std::size_t T = Scaled<Dim, C>::T, L = Scaled<Dim, C>::L;
    const std::size_t size = s.size();
    auto copy_row_of_W = [&](std::size_t i) {
        for (std::size_t j = 0; j < size; ++j) J[i * size + j] = s.entry(i, j);
    };
    for (std::size_t c = 0; c < s.count(); ++c) {
        const std::size_t n = c * L;
        const double sigma = p[n] - u[n];
        if (sigma > 0.0) {
            copy_row_of_W(n);
        } else {
            std::fill_n(&J[n * size], size, 0.0);
            J[n * (size + 1)] = 1.0;
        }
        for (std::size_t at = n + 1; at < n + L; at += T) {
            const double limit = (at == n + 1 ? s.mu : s.mu_r)[c];
            const double threshold = limit * std::max(sigma, 0.0);
            double direction[T];
            for (std::size_t k = 0; k < T; ++k) direction[k] = p[at + k] - u[at + k];
            const double pull = length<T>(direction);
            if (pull <= threshold) {  // sticks (or does not roll)
                for (std::size_t k = 0; k < T; ++k) copy_row_of_W(at + k);
                continue;
            }
            const double per_pull = 1.0 / pull;
            for (std::size_t k = 0; k < T; ++k) direction[k] *= per_pull;
            // d(threshold direction) = limit direction dsigma + threshold/pull (I - direction direction^T) dy
            for (std::size_t k = 0; k < T; ++k) {
                double* row = &J[(at + k) * size];
                const double push = sigma > 0.0 ? limit * direction[k] : 0.0;
                for (std::size_t j = 0; j < size; ++j) row[j] = push * s.entry(n, j);
                row[n] -= push;
                row[at + k] += 1.0;
                for (std::size_t m = 0; m < T; ++m) {
                    const double turn = threshold * per_pull * ((k == m ? 1.0 : 0.0) - direction[k] * direction[m]);
                    for (std::size_t j = 0; j < size; ++j) row[j] += turn * s.entry(at + m, j);
                    row[at + m] -= turn;
                }
            }
        }
    }
}

/// Rows change places only where a pivot is smaller than this share of the largest below it: seldom, and so at little cost [-].
constexpr double kLeastPivot = 0.1;

/// b becomes x with A x = b, A row by row, by elimination with threshold pivoting; A is used up. N is the size, 0 where the compiler does not know it.
template <std::size_t N, class Matrix, class Vector>
void solve_linear(std::size_t given_size, Matrix& A, Vector& b) {
    const std::size_t size = N > 0 ? N : given_size;
    for (std::size_t k = 0; k < size; ++k) {
        double largest = 0.0;
        for (std::size_t i = k + 1; i < size; ++i) largest = std::max(largest, std::abs(A[i * size + k]));
        if (!(std::abs(A[k * (size + 1)]) >= kLeastPivot * largest)) {
            std::size_t pivot = k;
            while (pivot + 1 < size && std::abs(A[pivot * size + k]) != largest) ++pivot;
            for (std::size_t j = k; j < size; ++j) std::swap(A[k * size + j], A[pivot * size + j]);
            std::swap(b[k], b[pivot]);
        }
        const double inverse = 1.0 / A[k * (size + 1)];
        A[k * (size + 1)] = inverse;
        for (std::size_t i = k + 1; i < size; ++i) {
            const double factor = A[i * size + k] * inverse;
            for (std::size_t j = k + 1; j < size; ++j) A[i * size + j] -= factor * A[k * size + j];
            b[i] -= factor * b[k];
        }
    }
    for (std::size_t k = size; k-- > 0;) {
        for (std::size_t j = k + 1; j < size; ++j) b[k] -= A[k * size + j] * b[j];
        b[k] *= A[k * (size + 1)];
    }
}

/// Newton with backtracking. Returns the relative residual; p is the best point met.
template <int Dim, int C>
[[gnu::noinline]] double newton(const Scaled<Dim, C>& s, double tolerance, int iterations,
                                typename Scaled<Dim, C>::Vector& p, int& used) {
    using Vector = typename Scaled<Dim, C>::Vector;
    const std::size_t size = s.size();
    const double goal = tolerance * s.measure;
    Vector F = s.vector(), u = s.velocity(p);
    double now = residual<Dim, C>(s, p, u, F);
    Vector best = p;
    double best_norm = now;
    int stalled = 0;
    for (int k = 0; k < iterations && now > goal; ++k, ++used) {
        typename Scaled<Dim, C>::Matrix J = s.matrix();
        jacobian<Dim, C>(s, p, u, J);
        const double regularisation = std::clamp(kRegularisationShare * now / std::max(s.norm_q, kTiny),
                                                 kLeastRegularisation, kMostRegularisation);
        for (std::size_t i = 0; i < size; ++i) J[i * (size + 1)] += regularisation;
        Vector step = F;
        solve_linear<Scaled<Dim, C>::N>(size, J, step);
        if (!std::isfinite(norm(step))) break;
        const Vector start = p;
        auto try_share = [&](double share) {
            for (std::size_t i = 0; i < size; ++i) p[i] = start[i] - share * step[i];
            u = s.velocity(p);
            return residual<Dim, C>(s, p, u, F);
        };
        double trial = try_share(1.0);
        double share = 1.0;
        for (int cut = 1; cut < 8 && !(trial < (1.0 - 1e-4 * share) * now); ++cut) trial = try_share(share *= 0.5);
        // a full step now and then, even uphill, leaves the kinks where the line search would stop for ever
        if (trial >= now) {
            if (++stalled > 3) break;
            trial = try_share(1.0);
        }
        now = trial;
        if (now < best_norm) {
            best_norm = now;
            best = p;
        }
    }
    p = best;
    return best_norm / s.measure;
}

/// One contact, whatever Newton says: for a given r_N friction and rolling are a problem on two discs, solved disc by disc in turn, and the normal velocity
/// that results is continuous in r_N, negative at zero and positive for large r_N: a root is bracketed and bisected. What a disc is moved by of the other is
/// a block of W of its own, since W is not symmetric.
template <int Dim>
[[gnu::noinline]] typename Scaled<Dim, 1>::Vector solve_one_by_bisection(const Scaled<Dim, 1>& s) {
    constexpr int T = Dim - 1;
    using Local = Eigen::Matrix<double, kLocalSize<Dim>, 1>;
    using Tangent = Eigen::Matrix<double, T, 1>;
    using Block = Eigen::Matrix<double, T, T>;
    const Eigen::Matrix<double, kLocalSize<Dim>, kLocalSize<Dim>> W(s.W.data());
    const Local q(s.q.data());
    const double mu = s.mu[0], mu_r = s.mu_r[0];
    Local p = Local::Zero();
    const Block A = W.template block<T, T>(1, 1), B = W.template block<T, T>(1 + T, 1 + T),
                C = W.template block<T, T>(1, 1 + T), D = W.template block<T, T>(1 + T, 1);
    auto normal_velocity = [&](double r) {
        p[0] = r;
        const Tangent a = q.template segment<T>(1) + W.template block<T, 1>(1, 0) * r;
        const Tangent b = q.template segment<T>(1 + T) + W.template block<T, 1>(1 + T, 0) * r;
        Tangent x = p.template segment<T>(1), m = p.template segment<T>(1 + T);
        for (int k = 0; k < 500; ++k) {
            const Tangent x_new = minimise_on_disc<T>(A, a + C * m, mu * r);
            const Tangent m_new = minimise_on_disc<T>(B, b + D * x_new, mu_r * r);
            const double change = (x_new - x).norm() + (m_new - m).norm();
            x = x_new;
            m = m_new;
            if (change <= 1e-15 * (1.0 + x.norm() + m.norm())) break;
        }
        p.template segment<T>(1) = x;
        p.template segment<T>(1 + T) = m;
        return W.row(0).dot(p) + q[0];
    };
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
    typename Scaled<Dim, 1>::Vector result;
    std::copy_n(p.data(), result.size(), result.begin());
    return result;
}

/// One contact in scaled variables: take-off, sticking without rolling, else Newton, else bisection.
template <int Dim>
[[gnu::noinline]] typename Scaled<Dim, 1>::Vector solve_one(const Scaled<Dim, 1>& s, double tolerance,
                                                            const typename Scaled<Dim, 1>::Vector& guess,
                                                            int& newton_used, double& achieved) {
    constexpr std::size_t T = Scaled<Dim, 1>::T, L = Scaled<Dim, 1>::L;
    using Vector = typename Scaled<Dim, 1>::Vector;
    achieved = 0.0;
    if (s.q[0] >= 0.0) return Vector{};
    Vector p = guess;
    if (guess[0] > 0.0) {
        achieved = newton<Dim, 1>(s, tolerance, 4, p, newton_used);  // mostly one iteration away
        if (achieved <= tolerance) return p;
    }
    typename Scaled<Dim, 1>::Matrix W;
    for (std::size_t i = 0; i < L; ++i) {
        p[i] = -s.q[i];
        for (std::size_t j = 0; j < L; ++j) W[i * L + j] = s.entry(i, j);
    }
    solve_linear<L>(L, W, p);
    achieved = 0.0;
    if (p[0] > 0.0 && length<T>(&p[1]) <= s.mu[0] * p[0] && length<T>(&p[1 + T]) <= s.mu_r[0] * p[0]) return p;
    // slide against the sticking impulse: the right side of every kink in most cases
    if (!std::isfinite(norm(p))) p = Vector{};
    p[0] = std::max(p[0], -s.q[0] / s.W[0]);
    achieved = newton<Dim, 1>(s, tolerance, 30, p, newton_used);
    if (achieved <= tolerance) return p;
    const Vector robust = solve_one_by_bisection<Dim>(s);
    Vector F{};
    const double robust_residual = residual<Dim, 1>(s, robust, F) / s.measure;
    if (robust_residual < achieved) {
        achieved = robust_residual;
        return robust;
    }
    return p;
}

/// Moves every contact's impulse into its cone: what Newton leaves is outside by the size of the residual.
template <int Dim, int C>
void clip_to_cone(const Scaled<Dim, C>& s, typename Scaled<Dim, C>::Vector& p) {
    constexpr std::size_t T = Scaled<Dim, C>::T, L = Scaled<Dim, C>::L;
    for (std::size_t c = 0; c < s.count(); ++c) {
        double* r = &p[c * L];
        r[0] = std::max(r[0], 0.0);
        for (std::size_t at = 1; at < L; at += T) {
            const double limit = (at == 1 ? s.mu : s.mu_r)[c] * r[0], pull = length<T>(r + at);
            if (pull > limit)
                for (std::size_t k = 0; k < T; ++k) r[at + k] *= limit / std::max(pull, kTiny);
        }
    }
}

/// Solves contact c exactly with the impulses of the others held.
template <int Dim, int C>
[[gnu::noinline]] void relax_contact(const Scaled<Dim, C>& s, std::size_t c, typename Scaled<Dim, C>::Vector& p) {
    constexpr std::size_t L = Scaled<Dim, C>::L;
    const std::size_t n = c * L, size = s.size();
    std::array<double, L> held, guess;
    for (std::size_t i = 0; i < L; ++i) {
        held[i] = s.q[n + i];
        for (std::size_t j = 0; j < size; ++j)
            if (j < n || j >= n + L) held[i] += s.entry(n + i, j) * p[j];
    }
    Scaled<Dim, 1> local(1, &s.W[n * (size + 1)], size, held.data(), &s.mu[c], &s.mu_r[c]);
    local.measure = std::max(local.norm_q, kTiny);  // the others may carry all: as exact as numbers are
    for (std::size_t i = 0; i < L; ++i) guess[i] = p[n + i] / local.scale[i];
    int used = 0;
    double achieved = 0.0;
    const auto solved = solve_one<Dim>(local, 1e-12, guess, used, achieved);
    for (std::size_t i = 0; i < L; ++i) p[n + i] = local.scale[i] * solved[i];
}

/// One Gauss-Seidel sweep over the contacts.
template <int Dim>
void sweep(const Scaled<Dim, 0>& s, std::vector<double>& p) {
    for (std::size_t c = 0; c < s.count(); ++c) relax_contact<Dim, 0>(s, c, p);
}

/// A cold start: every contact by itself carries its share. Unlike a sweep it favours no contact: where several impulses solve the problem, as for a
/// box that slides on four corners, the one found keeps the symmetry of the problem.
template <int Dim, int C>
void start_together(const Scaled<Dim, C>& s, typename Scaled<Dim, C>::Vector& p) {
    constexpr std::size_t L = Scaled<Dim, C>::L;
    p = s.vector();
    for (std::size_t c = 0; c < s.count(); ++c) {
        auto alone = s.vector();
        relax_contact<Dim, C>(s, c, alone);
        for (std::size_t i = c * L; i < (c + 1) * L; ++i) p[i] = alone[i] / static_cast<double>(s.count());
    }
}

template <int Dim>
double relative_residual(const Scaled<Dim, 0>& s, const std::vector<double>& p) {
    std::vector<double> F(p.size());
    return residual<Dim, 0>(s, p, F) / s.measure;
}

/// Continuation in compliance: contacts made soft by a share of their own diagonal are nearly independent, Newton then finds the solution
/// from anywhere; the compliance is lowered to nothing while Newton follows.
template <int Dim>
std::vector<double> follow_compliance(const Scaled<Dim, 0>& s, double compliance, double lowering,
                                      const ContactSolverSettings& settings, int& newton_used) {
    Scaled<Dim, 0> soft = s;
    auto soften = [&] {
        for (std::size_t i = 0; i < s.W.size(); i += s.size() + 1) soft.W[i] = s.W[i] * (1.0 + compliance);
    };
    std::vector<double> p;
    soften();
    start_together<Dim, 0>(soft, p);
    for (; compliance > 1e-7; compliance *= lowering) {
        soften();
        newton<Dim, 0>(soft, 1e-6, settings.newton_iterations, p, newton_used);
    }
    newton<Dim, 0>(s, settings.tolerance, settings.newton_iterations, p, newton_used);
    return p;
}

/// What Newton alone has left unsolved; `best` is where it got to.
template <int Dim>
void solve_hard(const Scaled<Dim, 0>& s, const ContactSolverSettings& settings, std::vector<double>& best,
                ContactSolverReport& report) {
    std::vector<double> p;
    auto keep_if_better = [&](double achieved) {
        if (!(achieved < report.residual)) return;
        report.residual = achieved;
        best = p;
    };
    const std::array<std::pair<double, double>, 4> first_and_lowering{
        {{1.0, 0.1}, {1.0, 0.4}, {30.0, 0.4}, {0.03, 0.4}}};
    for (const auto& [first, lowering] : first_and_lowering) {
        if (report.residual <= settings.tolerance) return;
        p = follow_compliance<Dim>(s, first, lowering, settings, report.newton_iterations);
        keep_if_better(relative_residual<Dim>(s, p));
    }
    // one contact carries all: the right start where two nearly coincide
    for (std::size_t c = 0; c < s.count() && report.residual > settings.tolerance; ++c) {
        p = s.vector();
        relax_contact<Dim, 0>(s, c, p);
        keep_if_better(newton<Dim, 0>(s, settings.tolerance, settings.newton_iterations, p, report.newton_iterations));
    }
    // Newton again after 1, 2, 4, ... sweeps from where the sweeps are
    for (int next = 1; report.residual > settings.tolerance && report.sweeps < settings.sweeps; next *= 2) {
        p = best;
        clip_to_cone<Dim, 0>(s, p);
        for (int k = 0; k < next && report.sweeps < settings.sweeps; ++k, ++report.sweeps) sweep<Dim>(s, p);
        keep_if_better(relative_residual<Dim>(s, p));
        keep_if_better(newton<Dim, 0>(s, settings.tolerance, settings.newton_iterations, p, report.newton_iterations));
    }
}

template <int Dim, int C>
ContactSolverReport solve(const ContactProblem<Dim>& problem, const ContactSolverSettings& settings,
                          Eigen::VectorXd& impulse) {
    ContactSolverReport report;
    if constexpr (Dim == 2 && C == 1) {
        Eigen::Vector3d alone = impulse;
        if (solve_in_plane(problem.delassus.data(), problem.free_velocity.data(), problem.friction[0],
                           problem.rolling[0], alone.data())) {
            impulse = alone;
            report.status = SolverStatus::Converged;
            return report;
        }
    }
    const Scaled<Dim, C> s(problem);
    auto p = s.scaled_impulse(impulse);
    if constexpr (C == 1) {
        const auto guess = p;
        p = solve_one<Dim>(s, settings.tolerance, guess, report.newton_iterations, report.residual);
    } else {
        const bool guessed = norm(p) > 0.0;
        if (!guessed) start_together<Dim, C>(s, p);  // sorts out most of the contact states
        report.residual =
            newton<Dim, C>(s, settings.tolerance, settings.newton_iterations, p, report.newton_iterations);
        if (guessed && report.residual > settings.tolerance) {  // a guess may lie on the wrong side of the kinks
            auto afresh = p;
            start_together<Dim, C>(s, afresh);
            const double achieved =
                newton<Dim, C>(s, settings.tolerance, settings.newton_iterations, afresh, report.newton_iterations);
            if (achieved < report.residual) {
                report.residual = achieved;
                p = afresh;
            }
        }
        if (report.residual > settings.tolerance) {
            std::vector<double> best(p.begin(), p.end());
            solve_hard<Dim>(Scaled<Dim, 0>(problem), settings, best, report);
            std::copy(best.begin(), best.end(), p.begin());
        }
    }
    clip_to_cone<Dim, C>(s, p);
    s.set_impulse(p, impulse);
    report.status = report.residual <= settings.tolerance ? SolverStatus::Converged : SolverStatus::NotConverged;
    return report;
}

}  // namespace

template <int Dim>
ContactSolverReport solve_contacts(const ContactProblem<Dim>& problem, const ContactSolverSettings& settings,
                                   Eigen::VectorXd& impulse) {
    SCREE_ASSERT(impulse.size() == problem.free_velocity.size());
    switch (problem.count) {  // sizes known to the compiler for the cases that matter
        case 0:
            return {SolverStatus::Converged, 0, 0, 0.0};
        case 1:
            return solve<Dim, 1>(problem, settings, impulse);
        case 2:
            return solve<Dim, 2>(problem, settings, impulse);
        case 3:
            return solve<Dim, 3>(problem, settings, impulse);
        case 4:
            return solve<Dim, 4>(problem, settings, impulse);
        default:
            return solve<Dim, 0>(problem, settings, impulse);
    }
}

template <int Dim>
double natural_map_residual(const ContactProblem<Dim>& problem, const Eigen::VectorXd& impulse) {
    constexpr std::size_t T = Dim - 1, L = kLocalSize<Dim>;
    const Scaled<Dim, 0> s(problem);
    const std::vector<double> p = s.scaled_impulse(impulse), u = s.velocity(p);
    double sum = 0.0;
    for (std::size_t c = 0; c < s.count(); ++c) {
        const Eigen::Map<const Eigen::Matrix<double, kLocalSize<Dim>, 1>> pc(&p[c * L]), uc(&u[c * L]);
        Eigen::Matrix<double, kLocalSize<Dim>, 1> y = pc - uc;
        y[0] -= s.mu[c] * length<T>(&u[c * L + 1]) + s.mu_r[c] * length<T>(&u[c * L + 1 + T]);
        sum += (pc - project_on_cone<Dim>(y, s.mu[c], s.mu_r[c])).squaredNorm();
    }
    return std::sqrt(sum) / std::max(s.norm_q, kTiny);
}

template struct ContactProblem<2>;
template struct ContactProblem<3>;
template ContactSolverReport solve_contacts<2>(const ContactProblem<2>&, const ContactSolverSettings&,
                                               Eigen::VectorXd&);
template ContactSolverReport solve_contacts<3>(const ContactProblem<3>&, const ContactSolverSettings&,
                                               Eigen::VectorXd&);
template double natural_map_residual<2>(const ContactProblem<2>&, const Eigen::VectorXd&);
template double natural_map_residual<3>(const ContactProblem<3>&, const Eigen::VectorXd&);

}  // namespace scree
