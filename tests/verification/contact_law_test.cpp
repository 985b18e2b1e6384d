// SPDX-License-Identifier: GPL-3.0-or-later
// The contact law on the contacts that real trajectories meet: impulses in the cone, dissipating, solved to the tolerance.
#include "dynamics/contact_step.hpp"

#include "support/motion.hpp"
#include "support/rounding.hpp"
#include "support/scenes.hpp"
#include "support/terrains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree::test {

namespace {

/// What the law asks of one solved problem. `before` and `after` are local velocities, e = 0.
struct LawCheck {
    int problems = 0, unconverged = 0;
    double worst_residual = 0.0;  ///< of the converged problems [-]
    double worst_cone =
        0.0;  ///< excess of |r_T| over mu r_N and |m_R| over mu_r r_N, relative to the normal impulses [-]
    double worst_gain = 0.0;      ///< work of the impulses, relative to the kinetic energy before [-]
    double worst_approach = 0.0;  ///< largest -u_N after, relative to the speed before [-]

    void add(const ContactStep<3>& step, const ContactSolverReport& report, const BodyInertia<3>& body,
             const BlockState<3>& before, const BlockState<3>& after) {
        ++problems;
        if (report.status != SolverStatus::Converged) {
            ++unconverged;
            return;
        }
        const auto& problem = step.problem();
        const Eigen::VectorXd& p = step.impulse();
        worst_residual = std::max(worst_residual, natural_map_residual(problem, p));
        double normal = 1e-12;
        for (int c = 0; c < problem.count; ++c) normal += std::max(p[5 * c], 0.0);
        for (int c = 0; c < problem.count; ++c) {
            const auto k = static_cast<std::size_t>(c);
            worst_cone = std::max({worst_cone, -p[5 * c] / normal,
                                   (p.segment<2>(5 * c + 1).norm() - problem.friction[k] * p[5 * c]) / normal,
                                   (p.segment<2>(5 * c + 3).norm() - problem.rolling[k] * p[5 * c]) / normal});
            worst_approach = std::max(worst_approach,
                                      -step.normal_velocity(k, after) / (before.velocity.norm() + before.spin.norm()));
        }
        worst_gain = std::max(
            worst_gain, (kinetic_energy(body, after) - kinetic_energy(body, before)) / kinetic_energy(body, before));
    }
};

/// Follows blocks down a rough slope by the paper's scheme, written out: detect, impulses at standing time, move.
template <class Visit>
void follow_blocks(int blocks, double step_length, Visit&& visit) {
    const auto surface = grid_terrain(25.0, 1.0, rough_slope(33 * kDegree, 0.05));
    const std::vector<Soil> soils{Soil{"slope", 0.0, 0.5, 0.04}};
    for (int number = 0; number < blocks; ++number) {
        RandomStream random(61, static_cast<std::uint64_t>(number), RandomPurpose::Shape);
        const ConvexBlock block = make_block({}, {0.9, 0.7, 0.55}, 400.0, random);
        const BodyInertia<3> body{block.mass, block.inertia};
        HullContacts finder(block, *surface, false);
        ContactStep<3> step(body, soils, {});
        BlockState<3> s;
        const double w = random.normal(), x = random.normal(), y = random.normal(), z = random.normal();
        s.orientation = Quat(w, x, y, z).normalized();
        s.position = {-20.0, 0.2, surface->height(Vec2(-20.0, 0.2)) + 1.0};
        std::vector<Contact<3>> contacts;
        for (int k = 0; k < 4000 && finder.over_terrain(s.position); ++k) {
            s.velocity.z() -= step_length * kStandardGravity;
            finder.detect(s.position, rotation_matrix(s.orientation), 1e-4, contacts);
            if (!contacts.empty()) {
                step.set_contacts(contacts, rotation_matrix(s.orientation));
                const BlockState<3> before = s;
                const ContactSolverReport report = step.solve(0.0, Vec3::Zero(), {}, s);
                visit(step, report, body, before, s);
            }
            s.position += step_length * s.velocity;
            rotate_freely(body.moment, step_length, step_length, s.orientation, s.spin);
        }
    }
}

}  // namespace

TEST(ContactLaw, HoldsAlongRealTrajectories) {
    LawCheck check;
    follow_blocks(12, 2e-3, [&](const auto&... all) { check.add(all...); });
    RecordProperty("problems", check.problems);
    RecordProperty("unconverged", check.unconverged);
    RecordProperty("worst_residual", testing::PrintToString(check.worst_residual));
    RecordProperty("worst_cone", testing::PrintToString(check.worst_cone));
    RecordProperty("worst_gain", testing::PrintToString(check.worst_gain));
    RecordProperty("worst_approach", testing::PrintToString(check.worst_approach));
    const double tolerance = ContactSolverSettings{}.tolerance;
    EXPECT_GT(check.problems, 2000);
    EXPECT_LE(check.unconverged, check.problems / 1000);
    // the solver stops on the residual of its Newton equations, before the impulses are clipped into the cone: the natural map may say a little more
    EXPECT_LE(check.worst_residual, 1.5 * tolerance);
    EXPECT_LE(check.worst_cone, kRounding);
    EXPECT_LE(check.worst_gain, tolerance);
    EXPECT_LE(check.worst_approach, 10.0 * tolerance);
}

TEST(ContactFrame, IsOrthonormalAndRightHandedForEveryNormal) {
    std::vector<Vec3> normals;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x != 0 || y != 0 || z != 0) normals.push_back(Vec3(x, y, z).normalized());
    RandomStream random(62, 1, RandomPurpose::Effect);
    while (normals.size() < 100'000) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        const Vec3 near_axis = normals.size() % 3 == 0 ? Vec3(1e-9 * x, 1e-9 * y, z) : Vec3(x, y, z);
        normals.push_back(near_axis.normalized());
    }
    double worst = 0.0;
    for (const Vec3& n : normals) {
        const Mat3 frame = contact_frame(n);
        worst = std::max({worst, (frame.transpose() * frame - Mat3::Identity()).norm(),
                          std::abs(frame.determinant() - 1.0), (frame.col(0) - n).norm()});
    }
    EXPECT_LT(worst, 1e-14);
}

}  // namespace scree::test
