// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/diagnose_study.hpp"

#include <string>
#include <vector>

/// The models of a diagnosis: the site with or without the effects of an answer, calibrated, simulated, and held against blocks that it was not fitted to.
namespace scree::cli {

/// Simulations for the verdict, and for the calibration of every model with and without an answer.
struct DiagnoseBudget {
    DiagnosisSettings test;
    CalibrationSettings search;
};
/// As the site has them. `full`: three times the simulations for the verdict, twice as many searches of twice the length, with three times the blocks.
DiagnoseBudget diagnose_budget(const SiteSettings& site, std::size_t free_parameters, bool full);

/// Position in a range, 0 to 1, by ratios if it is searched so.
double to_unit(const CalibrationParameter& p, double value);
/// The value there, within the range.
double from_unit(const CalibrationParameter& p, double u);

/// One of the effects is the third dimension, of a model that is 2D.
bool in_space(const std::vector<AnsweredEffect>& effects);
/// Where the strength is with 95 %, as all residuals of the test say; any that is allowed if they do not. A refit minimises one distance, which often tells
/// little of a strength: it has to stay here.
Interval strength_range(const AnsweredEffect& effect);

/// The model at the point where `refit`, a calibration of the same problem, began. What was held out stays as its own calibration predicted it.
CalibratedModel at_start_of(const CalibrationResult& refit, CalibratedModel model);

/// Whoever interrupts is told by `study.interrupted`; what is returned then counts for nothing.
class DiagnosedModels {
public:
    DiagnosedModels(const DiagnoseInput& input, DiagnoseStudy& study, const FieldTest& test)
        : in_(input), study_(study), test_(test) {}

    /// The same search for every model: ranges, budget and random numbers; effects add their strengths to the parameters. Begins at these parameters, in the
    /// unit cube, or, if there are none, where the site has them. `name` is that of its journal.
    CalibratedModel calibrated(const std::string& name, const std::vector<AnsweredEffect>& effects,
                               const std::vector<double>& begin);

    /// The model simulated for the report; `campaign` is what it is made from.
    CompareStudy compared(const CalibratedModel& model, const std::vector<AnsweredEffect>& effects,
                          CampaignResult& campaign);

    /// A refit minimises a part of what is compared, and may end far from the rest. Where it began, at what was followed, all measurements had their part: a
    /// model that is far beyond chance goes back there, with its comparison and campaign, if that leaves less. One rule for the model with and without
    /// effects. Blocks held out were predicted by refits either way.
    void stay_as_followed(const CalibrationResult& refit, const std::vector<AnsweredEffect>& effects,
                          CalibratedModel& model, CompareStudy& compared_model, CampaignResult& campaign);

    /// Gaps of the observables, in their order, each block simulated at the parameters of the fold that left it out. Empty without folds, or where nobody knows
    /// which record is of which block.
    std::vector<Gap> held_out_gaps(const CalibratedModel& model, const std::vector<AnsweredEffect>& effects);

    /// The effects at the strengths that are the last parameters of a point.
    std::vector<Effect> dosed(const std::vector<AnsweredEffect>& effects, const CalibrationPoint& point) const;

private:
    std::string journal_subject(const std::string& name) const;

    const DiagnoseInput& in_;
    DiagnoseStudy& study_;
    const FieldTest& test_;
};

}  // namespace scree::cli
