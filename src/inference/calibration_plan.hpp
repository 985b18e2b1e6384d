// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/calibration.hpp"

#include <cstddef>
#include <vector>

namespace scree {

/// Seeds that the ends of all searches race with [-].
inline constexpr std::size_t kRaceSeeds = 3;
/// Boxes around the best point: the second one follows from the first fit [-].
inline constexpr std::size_t kSurroundingRounds = 2;
/// Simulated points that compete with the quadratic's minimum [-].
inline constexpr std::size_t kSeen = 2;

/// Everything that the settings of a calibration leave open, decided: how much of what is simulated. All [-].
struct CalibrationPlan {
    CalibrationPlan(const CalibrationProblem& problem, const CalibrationSettings& settings);

    /// Simulations in all.
    std::size_t total() const;

    std::vector<std::vector<std::size_t>> levels;  ///< every combination of choices
    std::size_t dimension = 0;                     ///< parameters
    std::size_t screening = 0;                     ///< points of the hypercube
    std::size_t starts = 1;                        ///< searches of each combination
    std::size_t population = 0, generations = 0;   ///< of a search
    std::size_t surroundings = 0;                  ///< points around the best one
    std::size_t folds = 0, places = 0, paths = 0;  ///< that are held out
};

/// Throws InputError where there is nothing to calibrate, or ranges hold nothing.
void check_problem(const CalibrationProblem& problem);

}  // namespace scree
