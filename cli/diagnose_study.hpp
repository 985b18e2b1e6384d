// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_study.hpp"
#include "cli/diagnose_candidates.hpp"
#include "cli/diagnose_restarts.hpp"
#include "cli/field_test.hpp"
#include "cli/simulation_store.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scree::cli {

/// 97.5 % quantile of the normal distribution [-].
inline constexpr double kNinetyFive = 1.959964;

/// A model that was calibrated, with or without effects: their strengths are the last parameters.
struct CalibratedModel {
    CalibrationPoint point;         ///< of the free keys
    std::vector<double> strengths;  ///< of the effects that have one [-]
    CalibrationResult result;
    std::size_t evaluations = 0;  ///< simulations that it took [-]
    bool as_followed =
        false;  ///< `point` is where the diagnosis followed it to, which its calibration left for what is worse as a whole
};

/// The model without effects at other parameters than calibrated.
struct MovedModel {
    CalibrationPoint point;
    CompareStudy study;  ///< of the measured blocks
    CampaignResult campaign;
};

/// An effect of an answer.
struct AnsweredEffect {
    const DiagnosisCandidate* candidate = nullptr;
    DiagnosisVariant variant;  ///< on the ground that the refit ended with
    EffectFinding finding;
    double strength = 0.0;  ///< refitted, if it has one [-]
    bool has_strength() const { return !variant.space; }
    Interval interval;      ///< 95 % of it, as the residuals of the test say, within which the refit stays [-]
    double fastest = kNaN;  ///< 95 % of the blocks are slower wherever there is ground of its soil, if it has one [m/s]
    /// False if the interval is all that is searched.
    bool is_determined() const { return interval.low > 0.0 || interval.high < variant.most; }
};

/// An answer, refitted: one effect, or two that act together. The third dimension is there or not, without a strength to fit.
struct AnswerFit {
    std::vector<AnsweredEffect> effects;
    CalibratedModel model;
    CompareStudy study;  ///< of the measured blocks
    CampaignResult campaign;
    std::vector<Gap> held_out;  ///< of each observable of `study`, of blocks held out; empty without folds
    double loss_of_one =
        kInfinity;  ///< on blocks held out, of the better of its effects alone; of two that act together

    double weight() const { return effects.front().finding.weight; }
    bool in_space() const;     ///< the model is 2D, and the answer is 3D
    std::string name() const;  ///< forms, "ground_drag_quadratic and air_drag"
};

/// What the same test would tell with one more instrument or more blocks: of a plan about the whole catalogue, of a group about its members.
struct WithInstrument {
    std::string name;
    Diagnosis plan;       ///< findings and cosines, of the test's own number of blocks
    double blocks = 1.0;  ///< many times those of the test [-]
};

/// Everything that a diagnosis found; text, JSON, site file and pictures are made from it and from nothing else.
struct DiagnoseStudy {
    SiteFile site;  ///< as it was given
    FreeKeys keys;
    CalibrationSettings search;
    DiagnosisSettings settings;
    DiagnosisCatalogue catalogue;
    std::vector<std::string> screens;     ///< the last 2 * impacts are starts and ends of impacts
    std::size_t impacts = 0;              ///< of a block, that were measured [-]
    std::vector<std::string> zones;       ///< deposit zones
    std::vector<std::int32_t> screen_of;  ///< of `screens`, of each screen of the site [-]
    std::vector<Finding> audit;
    std::vector<std::string> inputs;          ///< a line each
    std::size_t blocks = 0;                   ///< measured [-]
    std::vector<ObservedBlock> known_blocks;  ///< the blocks of the test, where it is known which is which
    bool planning = false;                    ///< nothing was measured yet
    bool in_plane = false;
    std::string distances;  ///< what distances along the path count along, and from where, for people
    double beside = kNaN;   ///< standard deviation of the measured stops to the sides of the axis [m]

    CalibratedModel baseline;
    CompareStudy before;  ///< the calibrated model
    CampaignResult campaign;
    std::vector<Gap> held_out;  ///< of each observable of `before`, of blocks held out; empty without folds or answers
    std::vector<ScreenInnovation> innovations;  ///< of the model at told_point()
    Diagnosis diagnosis;
    std::optional<MovedModel> moved;  ///< where no answer stands: what leaves less over all than the calibrated model
    Verdict verdict = Verdict::None;  ///< after the refits
    std::vector<AnswerFit> answers;   ///< refitted, best first
    DiagnosisCatalogue forces;        ///< without a name, tried where the verdict is UNKNOWN
    Diagnosis by_force;               ///< z of each of their ways and places (looked_at); empty: not tried
    std::vector<WithInstrument> further;     ///< of a plan or a group; the first is the test as it was measured
    std::vector<std::size_t> tested_levels;  ///< choices (`keys`) of the model that was tested [-]
    std::string demoted;  ///< why the verdict is weaker than the diagnosis alone has it; empty: it is not
    bool interrupted = false;

    /// The best one; null where there is none, or where none was left by the refits.
    const AnswerFit* answer() const { return standing() == 0 ? nullptr : &answers.front(); }
    /// Answers that cannot be told apart: effects, or faults of the measurement.
    bool several() const {
        return verdict == Verdict::Group || (verdict == Verdict::DataProblem && answers.size() > 1);
    }
    /// How many answers stand: of a group every member, else one or none.
    std::size_t standing() const {
        if (verdict == Verdict::Unknown) return 0;
        return several() ? answers.size() : std::min<std::size_t>(answers.size(), 1);
    }
    /// Measurements were held against the model.
    bool judged() const { return !planning && !before.observables.empty(); }
    /// Site files to write: one for each answer that stands, else that of told_point(); none where nothing was judged.
    std::size_t site_files() const { return judged() ? std::max<std::size_t>(standing(), 1) : 0; }
    const DiagnosisCandidate& candidate_of(const EffectFinding& f) const { return catalogue.candidates[f.effect]; }
    /// Parameters as the site has them, wherever a calibration began; the middle of the range of what it does not have.
    CalibrationPoint given_point() const;
    /// Parameters of the model without effect that was tested: all measurements together had it moved there, the calibration minimises a part of them.
    CalibrationPoint tested_point() const;
    /// What its residuals ask for still: one linear step from there, within the ranges. It was not simulated by the diagnosis.
    CalibrationPoint asked_point() const;
    /// Of the calibrated parameters, the tested ones and those asked for still, and where the best of them is beyond chance those of the nearest models seen on the
    /// way, the ones that leave the least over all: told where no answer stands.
    const CalibrationPoint& told_point() const { return moved ? moved->point : baseline.point; }
    const CompareStudy& told() const { return moved ? moved->study : before; }
    /// The form and place of a finding, on the ground of the model that was tested, or of the parameters that a finalist was followed to.
    DiagnosisVariant variant_of(const EffectFinding& f) const;
    /// Those in which the least of it would have been seen.
    DiagnosisVariant seen_variant_of(const EffectFinding& f) const;
};

/// Stage, simulations done and planned in it.
using DiagnoseProgress = std::function<void(const std::string& stage, std::size_t done, std::size_t planned)>;

/// What all stages work on.
struct DiagnoseInput {
    const SiteFile& site;
    const SiteModel& model;
    const ObservedSite& observed;
    int threads = 0;
    SimulationStore& store;
    DiagnoseProgress progress;
};

/// Calibrates the model, tests it, follows what may be missing, refits the answer with the same search and judges it on held-out blocks. Fills all but the
/// fields that the caller knows (site, keys, search, settings, inputs).
void run_study(const DiagnoseInput& input, DiagnoseStudy& study);

/// What the test in `input.observed`, of which values say only what would be measured, could see with the site's own parameters.
void plan_study(const DiagnoseInput& input, DiagnoseStudy& study);

}  // namespace scree::cli
