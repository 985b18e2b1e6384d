// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "inference/quadratic_fit.hpp"

#include "scree/inference/calibration.hpp"

namespace scree {

/// Minima of the quadratics that records drawn again would give, in the unit cube.
struct MinimumSpread {
    Eigen::VectorXd best;       ///< of all records
    Eigen::MatrixXd draws;      ///< one row per draw
    Eigen::VectorXd low, high;  ///< where minima were looked for
    Eigen::VectorXd half;       ///< of the box
    /// Per draw and parameter, along the way on which the others follow it: slope of the loss at `best` and its curvature, both drawn, per half and half^2.
    Eigen::MatrixXd slope, curvature;
};

/// Looks for minima up to a quarter of the box beyond its sides, never beyond the unit cube.
MinimumSpread spread_of_minimum(const QuadraticFit& fit, const UnitBox& box, std::size_t records, std::int64_t draws,
                                RandomStream random);
/// Likewise the minimum for some records, those with 1.
Eigen::VectorXd minimum_for(const QuadraticFit& fit, const UnitBox& box, const std::vector<char>& records);

/// The box in which to look more closely: as wide as the spread of the minimum asks for, around a point of the box before, because farther away nothing
/// has been seen.
UnitBox closer_box(const MinimumSpread& spread, const UnitBox& box);
/// A box of half widths `half` around `u`, moved into the unit cube.
UnitBox box_around(const Eigen::VectorXd& u, const Eigen::VectorXd& half);

/// Points spread over the unit cube so that each coordinate meets each of `count` slices once (Latin hypercube: McKay, Beckman & Conover 1979).
std::vector<Eigen::VectorXd> latin_hypercube(std::size_t dimension, std::size_t count, RandomStream& random);

/// Between the ends of a parameter and [0, 1].
double value_of(const CalibrationParameter& parameter, double u);
double unit_of(const CalibrationParameter& parameter, double value);

/// A point that was simulated, and whether it is surely worse than the best.
struct TriedPoint {
    Eigen::VectorXd u;
    bool worse = false;
};

/// Intervals: 95 % of the draws, and all values at which the slope of the loss may be zero with a curvature as uncertain as it is: without an end where the loss
/// may be flat (the set of Fieller 1954, J R Stat Soc B 16:175, for a minimum, which is a slope over a curvature; drawn as by Hu & Kalbfleisch 2000, Can J Stat
/// 28:449). Less what lies beyond simulated points of which all are surely worse: a quadratic knows of no walls.
std::vector<ParameterEstimate> estimates_of(const MinimumSpread& spread,
                                            const std::vector<CalibrationParameter>& parameters,
                                            const std::vector<TriedPoint>& tried);
/// Moves draws apart until those of each parameter fill its interval: what lies on a side of the box may be anywhere beyond it, up to the end of the interval.
void widen(MinimumSpread& spread, const std::vector<CalibrationParameter>& parameters,
           const std::vector<ParameterEstimate>& estimates);
/// Of one parameter, all in shares of its range; the interval holds the value.
ParameterEstimate estimate_of(const CalibrationParameter& parameter, double u, double low, double high);
Eigen::MatrixXd correlation_of(const MinimumSpread& spread);
std::vector<CalibrationDirection> directions_of(const MinimumSpread& spread);

}  // namespace scree
