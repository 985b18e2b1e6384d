// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/rigid_motion.hpp"

#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/contact_solver.hpp"
#include "scree/dynamics/soil.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace scree {

/// Orthonormal contact frame (N, T1, T2), right-handed, for every unit N.
inline Mat3 contact_frame(const Vec3& n) {
    const Vec3 a = n.cwiseAbs();
    const Vec3 axis =
        a.x() <= a.y() && a.x() <= a.z() ? Vec3::UnitX() : (a.y() <= a.z() ? Vec3::UnitY() : Vec3::UnitZ());
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
        room_ = &rooms_[std::min(contacts.size(), rooms_.size() - 1)];
        room_->resize(static_cast<int>(contacts.size()));
        auto& [linear, angular, turned, impulse, problem] = *room_;
        linear.setZero();
        angular.setZero();
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            const auto row = static_cast<Eigen::Index>(c) * kLocal;
            const auto frame = contact_frame(contacts[c].normal);
            for (int k = 0; k < Dim; ++k) {
                linear.row(row + k) = frame.col(k).transpose();
                angular.row(row + k) = moment_arm(contacts[c].arm, frame.col(k), rotation).transpose();
            }
            set_rolling_rows(angular, row, frame, rotation);
            const Soil& soil = soils_[contacts[c].soil];
            problem.friction[c] = soil.friction;
            problem.rolling[c] = soil.rolling;
        }
    }

    /// Normal velocity of contact c [m/s].
    double normal_velocity(std::size_t c, const BlockState<Dim>& state) const {
        const auto row = static_cast<Eigen::Index>(c) * kLocal;
        return room_->linear.row(row).dot(state.velocity) + room_->angular.row(row).dot(state.spin);
    }

    /// Replaces velocity and spin of `state` by those after a step of length h (0: an impact) under `acceleration`.
    ContactSolverReport solve(double h, const Vec& acceleration, const RestitutionRule& rule, BlockState<Dim>& state) {
        switch (contacts_.size()) {  // sizes known to the compiler for the cases that matter
            case 1:
                return solve_sized<kLocal>(h, acceleration, rule, state);
            case 2:
                return solve_sized<2 * kLocal>(h, acceleration, rule, state);
            case 3:
                return solve_sized<3 * kLocal>(h, acceleration, rule, state);
            case 4:
                return solve_sized<4 * kLocal>(h, acceleration, rule, state);
            default:
                return solve_sized<Eigen::Dynamic>(h, acceleration, rule, state);
        }
    }

    /// Normal impulse of contact c in the last solution [N s].
    double normal_impulse(std::size_t c) const { return room_->impulse[static_cast<Eigen::Index>(c) * kLocal]; }
    const ContactProblem<Dim>& problem() const { return room_->problem; }
    const Eigen::VectorXd& impulse() const { return room_->impulse; }

private:
    /// Room for one number of contacts, so that storage is hardly ever allocated anew.
    struct Room {
        Eigen::Matrix<double, Eigen::Dynamic, Dim> linear;
        Eigen::Matrix<double, Eigen::Dynamic, kSpin> angular, turned;
        Eigen::VectorXd impulse;
        ContactProblem<Dim> problem;

        void resize(int contacts) {
            linear.resize(contacts * kLocal, Dim);
            angular.resize(contacts * kLocal, kSpin);
            turned.resize(contacts * kLocal, kSpin);
            impulse.resize(contacts * kLocal);
            problem.resize(contacts);
        }
    };

    template <int N>
    ContactSolverReport solve_sized(double h, const Vec& acceleration, const RestitutionRule& rule,
                                    BlockState<Dim>& state) {
        auto& problem = room_->problem;
        const Eigen::Index rows = room_->linear.rows();
        const Eigen::Map<const Eigen::Matrix<double, N, Dim>> linear(room_->linear.data(), rows, Dim);
        const Eigen::Map<const Eigen::Matrix<double, N, kSpin>> angular(room_->angular.data(), rows, kSpin);
        Eigen::Map<Eigen::Matrix<double, N, kSpin>> turned(room_->turned.data(), rows, kSpin);
        Eigen::Map<Eigen::Matrix<double, N, N>> delassus(problem.delassus.data(), rows, rows);
        Eigen::Map<Eigen::Matrix<double, N, 1>> free_velocity(problem.free_velocity.data(), rows),
            impulse(room_->impulse.data(), rows);

        const auto response = spin_response(body_.moment, state.spin, h);
        const Vec velocity = state.velocity + h * acceleration;
        const Spin spin = free_spin(body_.moment, state.spin, response, h);
        // lazy products: the general ones do not pay for three columns
        turned = angular.lazyProduct(response);
        delassus = linear.lazyProduct(linear.transpose()) / body_.mass;
        delassus += turned.lazyProduct(angular.transpose());
        free_velocity = linear.lazyProduct(velocity);
        free_velocity += angular.lazyProduct(spin);
        if (rule.factor > 0.0) {
            for (std::size_t c = 0; c < contacts_.size(); ++c) {
                const double before = normal_velocity(c, state);
                if (before < -rule.threshold)
                    free_velocity[static_cast<Eigen::Index>(c) * kLocal] +=
                        rule.factor * soils_[contacts_[c].soil].restitution * before;
            }
        }
        impulse.setZero();
        if (h > 0.0) guess_from_last_step(h);
        const ContactSolverReport report = solve_contacts<Dim>(problem, settings_, room_->impulse);
        if (h > 0.0) remember(h);
        state.velocity = velocity + linear.transpose().lazyProduct(impulse) / body_.mass;
        state.spin = spin + response * angular.transpose().lazyProduct(impulse);
        return report;
    }

    /// Contact forces of the last step, kept with the features that they acted on.
    struct Memory {
        ContactKey key;
        typename Space<Dim>::Rotation frame;     ///< contact frame [-]
        Eigen::Matrix<double, kLocal, 1> force;  ///< impulse per time in that frame [N, N m]
    };
    void remember(double h) {
        memory_.clear();
        for (std::size_t c = 0; c < contacts_.size(); ++c)
            memory_.push_back({contacts_[c].key, contact_frame(contacts_[c].normal),
                               room_->impulse.template segment<kLocal>(static_cast<Eigen::Index>(c) * kLocal) / h});
    }
    /// Forces hardly change from step to step: a good first guess for the solver.
    void guess_from_last_step(double h) {
        for (std::size_t c = 0; c < contacts_.size(); ++c) {
            for (const Memory& m : memory_) {
                if (!same_pair(m.key, contacts_[c].key)) continue;
                const auto frame = contact_frame(contacts_[c].normal);
                auto guess = room_->impulse.template segment<kLocal>(static_cast<Eigen::Index>(c) * kLocal);
                const Vec force = m.frame * m.force.template head<Dim>();
                guess.template head<Dim>() = h * (frame.transpose() * force);
                const Vec moment = m.frame.template rightCols<Dim - 1>() * m.force.template tail<Dim - 1>();
                guess.template tail<Dim - 1>() = h * (frame.template rightCols<Dim - 1>().transpose() * moment);
                break;
            }
        }
    }
    static Vec3 moment_arm(const Vec3& arm, const Vec3& direction, const Mat3& rotation) {
        return rotation.transpose() * arm.cross(direction);
    }
    static Space<2>::Spin moment_arm(const Vec2& arm, const Vec2& direction, const Mat2&) {
        return Space<2>::Spin(arm.x() * direction.y() - arm.y() * direction.x());
    }
    template <class Rows>
    static void set_rolling_rows(Rows& angular, Eigen::Index row, const Mat3& frame, const Mat3& rotation) {
        angular.row(row + 3) = (rotation.transpose() * frame.col(1)).transpose();
        angular.row(row + 4) = (rotation.transpose() * frame.col(2)).transpose();
    }
    template <class Rows>
    static void set_rolling_rows(Rows& angular, Eigen::Index row, const Mat2&, const Mat2&) {
        angular(row + 2, 0) = 1.0;
    }

    BodyInertia<Dim> body_;
    std::span<const Soil> soils_;
    ContactSolverSettings settings_;
    std::span<const Contact<Dim>> contacts_;
    std::array<Room, 6> rooms_;  ///< for 0 to 4 contacts, the last for more
    Room* room_ = nullptr;       ///< of the contacts at hand
    std::vector<Memory> memory_;
};

}  // namespace scree
