// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/diagnose_study.hpp"

#include <optional>

/// What the answers of a diagnosis are worth once the model was calibrated with them.
namespace scree::cli {

/// The gap over all is several times the largest of 95 % of chance.
bool is_far_beyond(const CompareStudy& study);

/// Mean distance of the observables, in floors of `yardstick`: distance_over().
double distance_over(const CompareStudy& model, const CompareStudy& yardstick);

/// A model leaves less than another one of the same measurements: of no fewer observables, by distance_over() in the floors of `yardstick`, and no more by
/// the gap over all. (Means of many observables may fall a little while blocks stop elsewhere.)
bool leaves_less(const CompareStudy& model, const CompareStudy& other, const CompareStudy& yardstick);

/// A name with which the model, calibrated anew, is still far from the measurements is none, nor one that predicts blocks that it was not fitted to
/// no better than the model without it, nor two that predict them no better than one of them: the verdict becomes UNKNOWN if no answer is left, and those that are left come first.
void judge_refits(DiagnoseStudy& study);

/// Share of the removable loss on held-out blocks: down to what one more repeat of the simulation would lose [-]. Nothing where there are no folds, or
/// where the model without the answer loses no more than that: what is minimised then says nothing of what is missing.
std::optional<double> removable_gap_closed(const DiagnoseStudy& study, const AnswerFit& answer);

/// What a block that was held out loses less with the answer, in the mean, and the standard error of that [-]: both from differences of the same blocks.
struct HeldOutGain {
    double mean = kNaN, error = kNaN;  ///< [-]
};
/// Nothing where there are no folds.
std::optional<HeldOutGain> held_out_gain(const DiagnoseStudy& study, const AnswerFit& answer);
/// By how much the logarithm of its likelihood is higher. It decides: energy scores hardly see a scatter that is wrong.
std::optional<HeldOutGain> held_out_log_gain(const DiagnoseStudy& study, const AnswerFit& answer);

}  // namespace scree::cli
