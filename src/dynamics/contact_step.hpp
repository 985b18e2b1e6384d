// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/rigid_motion.hpp"

#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/contact_solver.hpp"
#include "scree/dynamics/soil.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
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

/// Velocities after one step with contact: M (v+ - v) = h F + G p, u = H^T v+, with p and u solving the contact problem (B&A eqs 3-20, theta = 1/2).
/// G = H at one pose, or H at the end of the step and G in its mean (look_ahead). Keeps its storage and the last impulses from step to step.
template <int Dim>
class ContactStep {
public:
    using Vec = typename Space<Dim>::Vec;
    using Spin = typename Space<Dim>::Spin;
    static constexpr int kLocal = kLocalSize<Dim>;

    ContactStep(const BodyInertia<Dim>& body, std::span<const Soil> soils, const ContactSolverSettings& settings)
        : body_(body), soils_(soils), settings_(settings) {}

    /// Directions of the local velocities for these contacts and this rotation of the body: u = linear v + angular Omega.
    void set_contacts(std::span<const Contact<Dim>> contacts, const typename Space<Dim>::Rotation& rotation) {
        contacts_ = contacts;
        rotation_ = rotation;
        ahead_ = false;
        held_.reset();
        const std::size_t count = contacts.size();
        rows_.resize(count * kLocal);
        frames_.resize(count);
        restitution_.resize(count);
        room_ = &rooms_[std::min(count, rooms_.size() - 1)];
        room_->problem.resize(static_cast<int>(count));
        room_->impulse.resize(static_cast<Eigen::Index>(count) * kLocal);
        for (std::size_t c = 0; c < count; ++c) {
            frames_[c] = contact_frame(contacts[c].normal);
            set_rows(&rows_[c * kLocal], contacts[c].arm, frames_[c], rotation);
            const Soil& soil = soils_[contacts[c].soil];
            room_->problem.friction[c] = soil.friction;
            room_->problem.rolling[c] = soil.rolling;
            restitution_[c] = soil.restitution;
        }
    }

    /// A step of length h from this state: its contacts hold the velocities at its end, as the pose will be there, and forces act along the mean of the
    /// directions at both ends. So positions, which move with the mean velocity, keep contacts closed to third order in h: with directions of the
    /// start alone a block that rolls over a corner is lifted off it by (h omega)^2 / 2 of the corner's arm in every step.
    void look_ahead(const BlockState<Dim>& state, double h) {
        const auto [rotation, turn] = turn_by(state.orientation, rotation_, Spin(h * state.spin));
        end_rows_.resize(rows_.size());
        mean_rows_.resize(rows_.size());
        for (std::size_t c = 0; c < contacts_.size(); ++c) {
            const Contact<Dim>& contact = contacts_[c];
            Vec arm = contact.arm;
            auto frame = frames_[c];
            if (contact.motion == ContactMotion::TurnsWithBlock) {
                arm = turn * arm;
            } else if (contact.motion == ContactMotion::PassesBlock) {
                arm -= h * state.velocity;
                frame = turn * frame;
            }
            set_rows(&end_rows_[c * kLocal], arm, frame, rotation);
        }
        for (std::size_t i = 0; i < rows_.size(); ++i)
            mean_rows_[i] = {0.5 * (rows_[i].linear + end_rows_[i].linear),
                             0.5 * (rows_[i].angular + end_rows_[i].angular)};
        ahead_ = true;
    }

    /// In the next steps with these contacts the block does not turn about this direction (a unit vector), by whatever torque that takes. In the plane there
    /// is no such turning.
    void hold_turning(const Vec& about) {
        if constexpr (Dim == 3) held_ = rotation_.transpose() * about;
    }

    /// Replaces what the soil says for contact c: restitution [-], friction [-], rolling resistance [m].
    void set_law(std::size_t c, double restitution, double friction, double rolling) {
        restitution_[c] = restitution;
        room_->problem.friction[c] = friction;
        room_->problem.rolling[c] = rolling;
    }

    /// Normal velocity of contact c [m/s].
    double normal_velocity(std::size_t c, const BlockState<Dim>& state) const {
        return rows_[c * kLocal].velocity(state.velocity, state.spin);
    }

    /// Speed of contact c along the ground [m/s].
    double sliding_speed(std::size_t c, const BlockState<Dim>& state) const {
        double squares = 0.0;
        for (std::size_t k = 1; k < Dim; ++k)
            squares += std::pow(rows_[c * kLocal + k].velocity(state.velocity, state.spin), 2);
        return std::sqrt(squares);
    }

    /// Replaces velocity and spin of `state` by those after a step of length h (0: an impact) under `acceleration`.
    ContactSolverReport solve(double h, const Vec& acceleration, const RestitutionRule& rule, BlockState<Dim>& state) {
        auto& [problem, impulse] = *room_;
        const std::vector<Row>&held = ahead_ ? end_rows_ : rows_, &pushed = ahead_ ? mean_rows_ : rows_;
        const auto response = response_of(spin_response(body_.moment, state.spin, h));
        const Vec velocity = state.velocity + h * acceleration;
        const Spin spin = free_spin(body_.moment, state.spin, response, h);
        double* w = problem.delassus.data();  // column by column
        for (std::size_t j = 0; j < held.size(); ++j) {
            const Vec push = pushed[j].linear / body_.mass;
            const Spin turn = response * pushed[j].angular;
            for (const Row& row : held) *w++ = row.velocity(push, turn);
            problem.free_velocity[static_cast<Eigen::Index>(j)] = held[j].velocity(velocity, spin);
        }
        for (std::size_t c = 0; rule.factor > 0.0 && c < contacts_.size(); ++c) {
            const double before = normal_velocity(c, state);
            if (before < -rule.threshold)
                problem.free_velocity[static_cast<Eigen::Index>(c) * kLocal] += rule.factor * restitution_[c] * before;
        }
        impulse.setZero();
        if (h > 0.0) guess_from_last_step(h);
        const ContactSolverReport report = solve_contacts<Dim>(problem, settings_, impulse);
        if (h > 0.0 && !held_) remember(h);
        Vec push = Vec::Zero();
        Spin turn = Spin::Zero();
        for (std::size_t i = 0; i < pushed.size(); ++i) {
            push += impulse[static_cast<Eigen::Index>(i)] * pushed[i].linear;
            turn += impulse[static_cast<Eigen::Index>(i)] * pushed[i].angular;
        }
        state.velocity = velocity + push / body_.mass;
        state.spin = spin + response * turn;
        return report;
    }

    /// Replaces velocity and spin of `state` by those after an impact without restitution, with the directions of the start also where a step looks ahead.
    void stop_approach(BlockState<Dim>& state) {
        const bool ahead = std::exchange(ahead_, false);
        solve(0.0, Vec::Zero(), RestitutionRule{}, state);
        ahead_ = ahead;
    }

    /// The next contacts are new ones.
    void forget() { memory_.clear(); }

    /// Normal impulse of contact c in the last solution [N s].
    double normal_impulse(std::size_t c) const { return room_->impulse[static_cast<Eigen::Index>(c) * kLocal]; }
    std::span<const Contact<Dim>> contacts() const { return contacts_; }
    const ContactProblem<Dim>& problem() const { return room_->problem; }
    const Eigen::VectorXd& impulse() const { return room_->impulse; }

private:
    /// Change of spin by an angular impulse [1/(kg m^2)]. Of one that is held fast only what leaves the spin about that direction as it is.
    template <class Matrix>
    Matrix response_of(const Matrix& free) const {
        if (!held_) return free;
        const Spin along = free * *held_;
        return free - along * (free.transpose() * *held_).transpose() / held_->dot(along);
    }

    /// One local velocity: linear.v + angular.Omega.
    struct Row {
        Vec linear;
        Spin angular;
        double velocity(const Vec& v, const Spin& spin) const { return linear.dot(v) + angular.dot(spin); }
    };
    /// Problem and impulses for one number of contacts, so that storage is hardly ever allocated anew.
    struct Room {
        ContactProblem<Dim> problem;
        Eigen::VectorXd impulse;
    };
    static void set_rows(Row* rows, const Vec3& arm, const Mat3& frame, const Mat3& rotation) {
        const Vec3 arm_in_body = rotation.transpose() * arm;
        const Mat3 frame_in_body = rotation.transpose() * frame;
        for (int k = 0; k < 3; ++k) rows[k] = {frame.col(k), arm_in_body.cross(frame_in_body.col(k))};
        for (int k = 3; k < 5; ++k) rows[k] = {Vec3::Zero(), frame_in_body.col(k - 2)};
    }
    static void set_rows(Row* rows, const Vec2& arm, const Mat2& frame, const Mat2&) {
        for (int k = 0; k < 2; ++k) rows[k] = {frame.col(k), Spin(arm.x() * frame(1, k) - arm.y() * frame(0, k))};
        rows[2] = {Vec2::Zero(), Spin(1.0)};
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
            memory_.push_back({contacts_[c].key, frames_[c],
                               room_->impulse.template segment<kLocal>(static_cast<Eigen::Index>(c) * kLocal) / h});
    }
    /// Forces hardly change from step to step: a good first guess for the solver.
    void guess_from_last_step(double h) {
        for (std::size_t c = 0; c < contacts_.size(); ++c) {
            for (const Memory& m : memory_) {
                if (!same_pair(m.key, contacts_[c].key)) continue;
                const auto& frame = frames_[c];
                auto guess = room_->impulse.template segment<kLocal>(static_cast<Eigen::Index>(c) * kLocal);
                const Vec force = m.frame * m.force.template head<Dim>();
                guess.template head<Dim>() = h * (frame.transpose() * force);
                const Vec moment = m.frame.template rightCols<Dim - 1>() * m.force.template tail<Dim - 1>();
                guess.template tail<Dim - 1>() = h * (frame.template rightCols<Dim - 1>().transpose() * moment);
                break;
            }
        }
    }
    BodyInertia<Dim> body_;
    std::span<const Soil> soils_;
    ContactSolverSettings settings_;
    std::span<const Contact<Dim>> contacts_;
    typename Space<Dim>::Rotation rotation_;             ///< at the start of the step
    std::vector<Row> rows_;                              ///< kLocal for each contact
    std::vector<Row> end_rows_, mean_rows_;              ///< the same at the end of the step, and the mean of both
    bool ahead_ = false;                                 ///< a step from here to there
    std::optional<Spin> held_;                           ///< no turning about this direction, in the axes of the block
    std::vector<typename Space<Dim>::Rotation> frames_;  ///< of each contact
    std::vector<double> restitution_;                    ///< of each contact [-]
    std::array<Room, 6> rooms_;                          ///< for 0 to 4 contacts, the last for more
    Room* room_ = nullptr;                               ///< of the contacts at hand
    std::vector<Memory> memory_;
};

}  // namespace scree
