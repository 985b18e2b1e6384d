// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/dynamics/contact_solver.hpp"

#include "scree/base/error.hpp"
#include "scree/base/random.hpp"
#include "scree/dynamics/contact_problem_file.hpp"
#include "scree/geometry/types.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace scree {

namespace {

/// A rigid body with random inertia touched at random points from below, moving into the ground. Forces act along directions that are up to `ahead` [m, rad]
/// from those whose velocities they hold, as in a step that looks ahead: W is not symmetric then.
template <int Dim>
ContactProblem<Dim> random_problem(RandomStream& random, int contacts, double ahead = 0.0) {
    constexpr int L = kLocalSize<Dim>;
    constexpr int dof = Dim == 3 ? 6 : 3;
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(dof, L * contacts);  // generalised directions of the local components
    for (int c = 0; c < contacts; ++c) {
        Eigen::MatrixXd block = Eigen::MatrixXd::Zero(dof, L);
        if constexpr (Dim == 3) {
            Vec3 n(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 1.0);
            n.normalize();
            const Vec3 t1 = n.cross(Vec3::UnitX()).normalized(), t2 = n.cross(t1);
            const Vec3 arm(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, -0.1));
            const Vec3 axes[3] = {n, t1, t2};
            for (int k = 0; k < 3; ++k) {
                block.block<3, 1>(0, k) = axes[k];
                block.block<3, 1>(3, k) = arm.cross(axes[k]);
            }
            block.block<3, 1>(3, 3) = t1;
            block.block<3, 1>(3, 4) = t2;
        } else {
            const double angle = random.uniform(-0.6, 0.6);
            const Vec2 n(-std::sin(angle), std::cos(angle)), t(n.y(), -n.x());
            const Vec2 arm(random.uniform(-0.5, 0.5), random.uniform(-0.5, -0.1));
            const Vec2 axes[2] = {n, t};
            for (int k = 0; k < 2; ++k) {
                block.block<2, 1>(0, k) = axes[k];
                block(2, k) = arm.x() * axes[k].y() - arm.y() * axes[k].x();
            }
            block(2, 2) = 1.0;
        }
        G.middleCols(L * c, L) = block;
    }
    const double mass = std::exp(random.uniform(2.0, 8.0));
    Eigen::VectorXd inverse_mass(dof), velocity(dof);
    for (int k = 0; k < dof; ++k) {
        inverse_mass[k] = 1.0 / (k < Dim ? mass : mass * random.uniform(0.03, 0.15));
        velocity[k] = random.uniform(-3.0, 3.0) - (k == Dim - 1 ? 3.0 : 0.0);
    }
    ContactProblem<Dim> problem;
    problem.resize(contacts);
    Eigen::MatrixXd pushed = G;
    if (ahead > 0.0)
        for (double& entry : pushed.bottomRows(dof - Dim).reshaped()) entry += random.uniform(-ahead, ahead);
    problem.delassus = G.transpose() * inverse_mass.asDiagonal() * pushed;
    problem.free_velocity = G.transpose() * velocity;
    for (int c = 0; c < contacts; ++c) {
        problem.friction[static_cast<std::size_t>(c)] = random.uniform(0.0, 1.2);
        problem.rolling[static_cast<std::size_t>(c)] = random.uniform(0.0, 0.2);
    }
    return problem;
}

/// Impulses in the cone, residual below tolerance, and, where W is symmetric, energy not gained: p.(u_before + u_after)/2 <= 0.
template <int Dim>
void check_random_problems(int contacts, int count, double tolerance, double ahead = 0.0) {
    RandomStream random(99, static_cast<std::uint64_t>(contacts), RandomPurpose::Effect);
    ContactSolverSettings settings;
    settings.tolerance = tolerance;
    int failed = 0;
    for (int k = 0; k < count; ++k) {
        const ContactProblem<Dim> problem = random_problem<Dim>(random, contacts, ahead);
        Eigen::VectorXd p = Eigen::VectorXd::Zero(problem.free_velocity.size());
        const ContactSolverReport report = solve_contacts(problem, settings, p);
        if (report.status != SolverStatus::Converged) {
            ++failed;
            continue;
        }
        EXPECT_LE(natural_map_residual(problem, p), 20 * tolerance) << "problem " << k;
        constexpr int T = Dim - 1;
        for (int c = 0; c < contacts; ++c) {
            const Eigen::Index n = c * kLocalSize<Dim>;
            EXPECT_GE(p[n], 0.0);
            EXPECT_LE(p.template segment<T>(n + 1).norm(),
                      problem.friction[static_cast<std::size_t>(c)] * p[n] * (1 + 1e-12) + 1e-12);
            EXPECT_LE(p.template segment<T>(n + 1 + T).norm(),
                      problem.rolling[static_cast<std::size_t>(c)] * p[n] * (1 + 1e-12) + 1e-12);
        }
        if (ahead > 0.0) continue;
        const Eigen::VectorXd& before = problem.free_velocity;
        const Eigen::VectorXd after = problem.delassus * p + before;
        const double scale = p.cwiseAbs().dot(before.cwiseAbs()) + 1e-12;
        EXPECT_LE(0.5 * p.dot(before + after), tolerance * scale) << "problem " << k;
    }
    EXPECT_EQ(failed, 0) << "of " << count << " problems with " << contacts << " contacts";
}

}  // namespace

TEST(ContactSolver, RandomProblemsOneContact3D) {
    check_random_problems<3>(1, 20000, 1e-10);
}
TEST(ContactSolver, RandomProblemsTwoContacts3D) {
    check_random_problems<3>(2, 5000, 1e-10);
}
TEST(ContactSolver, RandomProblemsThreeContacts3D) {
    check_random_problems<3>(3, 3000, 1e-10);
}
TEST(ContactSolver, RandomProblemsFiveContacts3D) {
    check_random_problems<3>(5, 1000, 1e-10);
}
TEST(ContactSolver, RandomProblemsOneContact2D) {
    check_random_problems<2>(1, 20000, 1e-10);
}
TEST(ContactSolver, RandomProblemsTwoContacts2D) {
    check_random_problems<2>(2, 5000, 1e-10);
}
TEST(ContactSolver, RandomProblemsFourContacts2D) {
    check_random_problems<2>(4, 1000, 1e-10);
}

TEST(ContactSolver, StepsThatLookAheadOneContact3D) {
    check_random_problems<3>(1, 20000, 1e-10, 0.05);
}
TEST(ContactSolver, StepsThatLookAheadThreeContacts3D) {
    check_random_problems<3>(3, 3000, 1e-10, 0.02);
}
TEST(ContactSolver, StepsThatLookAheadOneContact2D) {
    check_random_problems<2>(1, 20000, 1e-10, 0.05);
}

TEST(ContactSolver, ProjectionIsTheNearestPointOfTheCone) {
    RandomStream random(5, 0, RandomPurpose::Effect);
    for (int k = 0; k < 2000; ++k) {
        Eigen::Matrix<double, 5, 1> p, other;
        for (int i = 0; i < 5; ++i) p[i] = random.uniform(-1, 1);
        const double mu = random.uniform(0.0, 1.5), mu_r = random.uniform(0.0, 1.5);
        const auto x = project_on_cone<3>(p, mu, mu_r);
        ASSERT_GE(x[0], 0.0);
        ASSERT_LE(x.segment<2>(1).norm(), mu * x[0] + 1e-12);
        ASSERT_LE(x.segment<2>(3).norm(), mu_r * x[0] + 1e-12);
        for (int j = 0; j < 20; ++j) {  // variational inequality against points of the cone
            other[0] = random.uniform(0.0, 2.0);
            for (int i = 1; i < 5; ++i) other[i] = random.uniform(-1, 1);
            other.segment<2>(1) *= mu * other[0] / std::max(other.segment<2>(1).norm(), mu * other[0] + 1e-30);
            other.segment<2>(3) *= mu_r * other[0] / std::max(other.segment<2>(3).norm(), mu_r * other[0] + 1e-30);
            ASSERT_LE((p - x).dot(other - x), 1e-9);
        }
    }
}

TEST(ContactSolver, ReferenceProblemsTo1em10) {
    SCREE_SHARED_OR_SKIP(folder, "reference/rfc3d");
    int read = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".dat") continue;
        std::ifstream file(entry.path());
        const auto problem = read_contact_problem<3>(file, entry.path().string());
        Eigen::VectorXd p = Eigen::VectorXd::Zero(problem.free_velocity.size());
        ContactSolverSettings settings;
        settings.tolerance = 1e-11;
        settings.sweeps = 5000;
        const ContactSolverReport report = solve_contacts(problem, settings, p);
        EXPECT_LE(natural_map_residual(problem, p), 1e-10)
            << entry.path() << " sweeps " << report.sweeps << " newton " << report.newton_iterations << " residual "
            << report.residual;
        ++read;
    }
    EXPECT_GT(read, 0);
}

/// Solves all problems of a folder beside this file, as `scree run` keeps them from the field.
template <class Check>
static void for_kept_problems(const std::string& folder, const Check& check) {
    int read = 0;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(SCREE_SOURCE_DIR) /
                                                                 "tests/unit/contact_problems" / folder)) {
        SCOPED_TRACE(entry.path());
        std::ifstream file(entry.path());
        const auto problem = read_contact_problem<3>(file, entry.path().string());
        Eigen::VectorXd p = Eigen::VectorXd::Zero(problem.free_velocity.size());
        ContactSolverSettings settings;
        settings.tolerance = 1e-6;
        check(problem, solve_contacts(problem, settings, p), p);
        ++read;
    }
    EXPECT_GT(read, 0);
}

TEST(ContactSolver, HardProblemsFromTheField) {
    for_kept_problems("solvable", [](const auto& problem, const ContactSolverReport& report, const auto& p) {
        EXPECT_EQ(report.status, SolverStatus::Converged);
        EXPECT_LE(natural_map_residual(problem, p), 1e-5);
    });
}

// Newton's restitution between walls that face each other: no impulses give both contacts the rebound that it asks for. The solver says so, and what
// it returns is bounded and in the cone.
TEST(ContactSolver, ProblemsWithoutSolution) {
    for_kept_problems("without_solution", [](const auto& problem, const ContactSolverReport& report, const auto& p) {
        EXPECT_EQ(report.status, SolverStatus::NotConverged);
        EXPECT_LE((problem.delassus * p).norm(), 10.0 * problem.free_velocity.norm());
        for (int c = 0; c < problem.count; ++c) {
            const auto i = static_cast<std::size_t>(c);
            EXPECT_GE(p[5 * c], 0.0);
            EXPECT_LE(p.segment(5 * c + 1, 2).norm(), problem.friction[i] * p[5 * c] * (1.0 + 1e-12));
            EXPECT_LE(p.segment(5 * c + 3, 2).norm(), problem.rolling[i] * p[5 * c] * (1.0 + 1e-12));
        }
    });
}

template <int Dim>
static void check_file_round_trip() {
    RandomStream random(9, 0, RandomPurpose::Effect);
    const ContactProblem<Dim> problem = random_problem<Dim>(random, 3);
    std::stringstream text;
    write_contact_problem(text, problem);
    const auto copy = read_contact_problem<Dim>(text, "copy");
    EXPECT_EQ(copy.count, 3);
    EXPECT_EQ(copy.delassus, problem.delassus);
    EXPECT_EQ(copy.free_velocity, problem.free_velocity);
    EXPECT_EQ(copy.friction, problem.friction);
    EXPECT_EQ(copy.rolling, problem.rolling);
}
TEST(ContactProblemFile, KeepsAllDigits) {
    check_file_round_trip<2>();
    check_file_round_trip<3>();
}

TEST(ContactProblemFile, SaysWhatIsWrong) {
    auto message = [](const std::string& text) {
        std::istringstream in(text);
        try {
            read_contact_problem<3>(in, "p.txt");
        } catch (const InputError& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    EXPECT_THAT(message("3 1"), testing::HasSubstr("p.txt: number 2 (size of a contact): a whole number from 5 to 5"));
    EXPECT_THAT(message("5 1 0 5 5 5 5 1 2 x"), testing::HasSubstr("number 10 (entry of W): a number is missing"));
    EXPECT_THAT(message("5 1 2"), testing::HasSubstr("storage of W"));
}

}  // namespace scree
