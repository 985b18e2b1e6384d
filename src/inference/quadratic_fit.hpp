// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/random.hpp"

#include <Eigen/Core>

#include <vector>

namespace scree {

/// A box in the unit cube.
struct UnitBox {
    Eigen::VectorXd centre, half;  ///< [-]
    bool holds(const Eigen::VectorXd& u, double slack) const {
        return ((u - centre).cwiseAbs().array() <= half.array() * (1.0 + slack)).all();
    }
};

/// a + b.z + 1/2 z.C z with z = (u - centre) / half.
struct Quadratic {
    double constant = 0.0;
    Eigen::VectorXd slope;
    Eigen::MatrixXd curvature;
};

/// Least squares of quadratics, one per record, on the same points. Coefficients are linear in the losses: those of any weighted mean of the records are the
/// weighted mean of theirs.
class QuadraticFit {
public:
    static std::size_t coefficients(std::size_t dimension) { return (dimension + 1) * (dimension + 2) / 2; }

    /// `losses`: one row per point, one column per record. Needs more points than coefficients. Points outside the box count less, by the square of how
    /// many times too far they are: they hold the quadratic where those inside leave it free. So do points whose mean loss is far above that of most: what
    /// the quadratic is to describe is the valley, not its walls.
    QuadraticFit(const std::vector<Eigen::VectorXd>& points, const Eigen::MatrixXd& losses, const UnitBox& box);

    /// Coefficients of the records' mean with these weights, which sum to one.
    Eigen::VectorXd coefficients_of(const Eigen::VectorXd& weights) const { return per_record_ * weights; }
    /// Standard deviation of that mean around its quadratic, from point to point.
    double noise(const Eigen::VectorXd& weights) const;
    /// Share of the variance of that mean that the quadratic explains.
    double explained(const Eigen::VectorXd& weights) const;
    /// An error of those coefficients such as noise and misfit give them: residuals with random signs and sizes (wild bootstrap: Wu 1986, Ann Stat
    /// 14:1261-1295), which need not be alike everywhere.
    Eigen::VectorXd coefficient_error(const Eigen::VectorXd& weights, RandomStream& random) const;
    Quadratic quadratic(const Eigen::VectorXd& coefficients) const;
    std::size_t points() const { return static_cast<std::size_t>(losses_.rows()); }

private:
    Eigen::Index dimension_ = 0;
    Eigen::VectorXd trust_;       ///< square roots of the weights of the points
    Eigen::VectorXd shrunk_;      ///< by how much the fit shrinks the residuals of noise that is alike everywhere
    double freedom_ = 0.0;        ///< squared residuals of unit noise, summed
    Eigen::MatrixXd losses_;      ///< points x records
    Eigen::MatrixXd per_record_;  ///< coefficients x records
    Eigen::MatrixXd residual_;    ///< points x records, times trust_
    Eigen::MatrixXd inverse_;     ///< coefficients x points
};

/// Where a quadratic is least between `low` and `high` (in z): exact if it is convex, else the least of what descents from the middle of the box and of
/// its faces find.
Eigen::VectorXd least_in_box(const Quadratic& q, const Eigen::VectorXd& low, const Eigen::VectorXd& high);

}  // namespace scree
