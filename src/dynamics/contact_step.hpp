// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/rigid_motion.hpp"
#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/contact_solver.hpp"
#include "scree/dynamics/soil.hpp"

#include <span>
#include <vector>

namespace scree {

/// Orthonormal contact frame (N, T1, T2), right-handed, for every unit N.
inline Mat3 contact_frame(const Vec3& n) {
    const Vec3 a = n.cwiseAbs();
    const Vec3 axis = a.x() <= a.y() && a.x() <= a.z() ? Vec3::UnitX() : (a.y() <= a.z() ? Vec3::UnitY() : Vec3::UnitZ());
    Mat3 frame;
    frame.col(0) = n;
    frame.col(1) = n.cross(axis).normalized();
    frame.col(2) = n.cross(frame.col(1));
    return frame;
}
inline Mat2 contact_frame(const Vec2& n) {
    Mat2 frame;
    frame.col(0) = n;
    frame.col(1) = Vec2(n.y(), -n.x());
    return frame;
}

/// How restitution enters a step: u_N+ = -e u_N- for contacts that approach faster than the threshold.
struct RestitutionRule {
    double factor = 0.0;     ///< multiplies e of the soil; 0: no restitution in this step [-]
    double threshold = 0.0;  ///< normal approach speed below which e counts as zero [m/s]
};

/// Velocities after one step with contact: M (v+ - v) = h F + G p with p solving the contact problem (B&A eqs 3-20, theta = 1/2).
/// Keeps its storage and the last impulses from step to step.
template <int Dim>
class ContactStep {
public:
    using Vec = typename Space<Dim>::Vec;
    using Spin = typename Space<Dim>::Spin;
    static constexpr int kLocal = kLocalSize<Dim>;
    static constexpr int kSpin = Dim == 3 ? 3 : 1;

    ContactStep(const BodyInertia<Dim>& body, std::span<const Soil> soils, const ContactSolverSettings& settings)
        : body_(body), soils_(soils), settings_(settings) {}

    /// Directions of the local velocities for these contacts and this rotation of the body: u = linear v + angular Omega.
    void set_contacts(std::span<const Contact<Dim>> contacts, const typename Space<Dim>::Rotation& rotation) {
        contacts_ = contacts;
        const auto rows = static_cast<Eigen::Index>(contacts.size()) * kLocal;
        linear_.setZero(rows, Dim);
        angular_.setZero(rows, kSpin);
        problem_.resize(static_cast<int>(contacts.size()));
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            const auto row = static_cast<Eigen::Index>(c) * kLocal;
            const auto frame = contact_frame(contacts[c].normal);
            for (int k = 0; k < Dim; ++k) {
                linear_.row(row + k) = frame.col(k).transpose();
                angular_.row(row + k) = moment_arm(contacts[c].arm, frame.col(k), rotation).transpose();
            }
            set_rolling_rows(row, frame, rotation);
            const Soil& soil = soils_[contacts[c].soil];
            problem_.friction[c] = soil.friction;
            problem_.rolling[c] = soil.rolling;
        }
    }

    /// Normal velocity of contact c [m/s].
    double normal_velocity(std::size_t c, const BlockState<Dim>& state) const {
        const auto row = static_cast<Eigen::Index>(c) * kLocal;
        return linear_.row(row).dot(state.velocity) + angular_.row(row).dot(state.spin);
    }

    /// Replaces velocity and spin of `state` by those after a step of length h (0: an impact) under `acceleration`.
    ContactSolverReport solve(double h, const Vec& acceleration, const RestitutionRule& rule, BlockState<Dim>& state) {
        const auto response = spin_response(body_.moment, state.spin, h);
        const Vec velocity = state.velocity + h * acceleration;
        const Spin spin = free_spin(body_.moment, state.spin, response, h);
        turned_.noalias() = angular_ * response;
        problem_.delassus.noalias() = linear_ * linear_.transpose() / body_.mass;
        problem_.delassus.noalias() += turned_ * angular_.transpose();
        problem_.free_velocity.noalias() = linear_ * velocity;
        problem_.free_velocity.noalias() += angular_ * spin;
        if (rule.factor > 0.0) {
            for (std::size_t c = 0; c < contacts_.size(); ++c) {
                const double before = normal_velocity(c, state);
                if (before < -rule.threshold)
                    problem_.free_velocity[static_cast<Eigen::Index>(c) * kLocal] += rule.factor * soils_[contacts_[c].soil].restitution * before;
            }
        }
        impulse_.setZero(problem_.free_velocity.size());
        if (h > 0.0) guess_from_last_step(h);
        const ContactSolverReport report = solve_contacts<Dim>(problem_, settings_, impulse_);
        if (h > 0.0) remember(h);
        state.velocity = velocity + linear_.transpose() * impulse_ / body_.mass;
        state.spin = spin + response * (angular_.transpose() * impulse_);
        return report;
    }

    /// Normal impulse of contact c in the last solution [N s].
    double normal_impulse(std::size_t c) const { return impulse_[static_cast<Eigen::Index>(c) * kLocal]; }
    const ContactProblem<Dim>& problem() const { return problem_; }
    const Eigen::VectorXd& impulse() const { return impulse_; }

private:
    /// Contact forces of the last step, kept with the features that they acted on.
    struct Memory {
        ContactKey key;
        typename Space<Dim>::Rotation frame;                  ///< contact frame [-]
        Eigen::Matrix<double, kLocal, 1> force;               ///< impulse per time in that frame [N, N m]
    };
    void remember(double h) {
        memory_.clear();
        for (std::size_t c = 0; c < contacts_.size(); ++c)
            memory_.push_back({contacts_[c].key, contact_frame(contacts_[c].normal), impulse_.template segment<kLocal>(static_cast<Eigen::Index>(c) * kLocal) / h});
    }
    /// Forces hardly change from step to step: a good first guess for the solver.
    void guess_from_last_step(double h) {
        for (std::size_t c = 0; c < contacts_.size(); ++c) {
            for (const Memory& m : memory_) {
                if (!same_pair(m.key, contacts_[c].key)) continue;
                const auto frame = contact_frame(contacts_[c].normal);
                auto guess = impulse_.template segment<kLocal>(static_cast<Eigen::Index>(c) * kLocal);
                const Vec force = m.frame * m.force.template head<Dim>();
                guess.template head<Dim>() = h * (frame.transpose() * force);
                const Vec moment = m.frame.template rightCols<Dim - 1>() * m.force.template tail<Dim - 1>();
                guess.template tail<Dim - 1>() = h * (frame.template rightCols<Dim - 1>().transpose() * moment);
                break;
            }
        }
    }
    static Vec3 moment_arm(const Vec3& arm, const Vec3& direction, const Mat3& rotation) { return rotation.transpose() * arm.cross(direction); }
    static Space<2>::Spin moment_arm(const Vec2& arm, const Vec2& direction, const Mat2&) {
        return Space<2>::Spin(arm.x() * direction.y() - arm.y() * direction.x());
    }
    void set_rolling_rows(Eigen::Index row, const Mat3& frame, const Mat3& rotation) {
        angular_.row(row + 3) = (rotation.transpose() * frame.col(1)).transpose();
        angular_.row(row + 4) = (rotation.transpose() * frame.col(2)).transpose();
    }
    void set_rolling_rows(Eigen::Index row, const Mat2&, const Mat2&) { angular_(row + 2, 0) = 1.0; }

    BodyInertia<Dim> body_;
    std::span<const Soil> soils_;
    ContactSolverSettings settings_;
    std::span<const Contact<Dim>> contacts_;
    Eigen::Matrix<double, Eigen::Dynamic, Dim> linear_;
    Eigen::Matrix<double, Eigen::Dynamic, kSpin> angular_;
    Eigen::Matrix<double, Eigen::Dynamic, kSpin> turned_;
    ContactProblem<Dim> problem_;
    Eigen::VectorXd impulse_;
    std::vector<Memory> memory_;
};

}  // namespace scree
