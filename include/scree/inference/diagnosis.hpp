// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/stretch.hpp"
#include "scree/inference/discrepancy.hpp"
#include "scree/inference/score_test.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scree {

/// Diagnosis: what a calibrated model is missing. Knows nothing of how a simulation is run, nor of what an effect is: effects are names with a strength.
///
/// The calibrated model simulates every measured block many times (ResidualSpace). Chance, with the parameters free, says whether the measurements could
/// be more of the same (global_test). If not, every effect of the catalogue is judged by how well it explains the mean residual: first by its fingerprint
/// (ScoreTest), the finalists then by simulations at the strength and parameters that explain it best, with a Gaussian likelihood of the mean
/// residual whose mean and covariance are simulated there (after the synthetic likelihood of Wood 2010, Nature 466:1102-1104, but every hypothesis in its
/// own residual space and without the determinant of its covariance: a hypothesis that predicts too widely pays through the spread of its residuals only).
/// Their weights, with the price of free strengths and places and beside those of the calibrated model itself and of something that has no name, are the
/// answer: one name, a group that the data cannot tell apart, or none of them where the best one is rejected, too, or where these two remain serious rivals.
/// Where few things were measured, one of many effects is likely to fit whatever is missing: then it takes more for a name. Where one effect is not
/// enough, the best ones become part of the model, and a second is looked for in the same way: at most two are named.

/// One way in which an effect may act: a sign, a parameter other than its strength.
struct EffectVariant {
    std::string label;                 ///< "that holds blocks back"; empty if there is one only
    double most = 3.0;                 ///< largest strength allowed, in units of the reference strength [-]
    std::optional<Stretch> path = {};  ///< it acts on a stretch of this, which is to be found; nothing: it is known
};

/// An effect that may be missing. At strength 0 it is absent.
struct CandidateEffect {
    std::string name;  ///< as in the catalogue
    /// Acts on what is measured, not on what happens; beforehand about as strong as the reference at most.
    bool measurement = false;
    std::vector<EffectVariant> variants;
    /// Where it leaves too much, a second effect is looked for beside it. If not, it is only asked whether it suffices alone.
    bool second_beside = true;
    /// Its strength is a share of the blocks, up to all of them. That of others has no natural end, and any order of magnitude is as likely as any other.
    bool share = false;
};

/// An effect switched on.
struct EffectDose {
    std::size_t effect = 0;  ///< index into the candidates
    std::size_t variant = 0;
    double strength = 0.0;           ///< in units of the reference strength [-]
    std::optional<Stretch> on = {};  ///< where it acts, of a variant that has a path
    bool operator==(const EffectDose&) const = default;
};

/// One simulation to be run.
struct DiagnosisTask {
    std::vector<double> parameters;  ///< of the calibrated model [*]
    std::vector<EffectDose> effects;
    std::uint64_t seed = 0;
    std::int64_t repeats = 0;  ///< of every measured block [-]
};
/// The table that the test would have measured. The same task gives the same table. Nothing: it was stopped.
using DiagnosisSimulation = std::function<std::optional<ObservationTable>(const DiagnosisTask&)>;

struct DiagnosisProblem {
    std::vector<double> calibrated;  ///< parameters of the calibrated model [*]
    std::vector<double> given;       ///< what they were before the calibration; empty: unknown [*]
    std::vector<double> low, high;   ///< ranges that they were calibrated in [*]
    std::vector<double> step;        ///< differences for derivatives: about the parameter's uncertainty [*]
    std::vector<CandidateEffect> effects;
    std::vector<ObservedBlock> blocks;  ///< of the test, empty if unknown
};

struct DiagnosisSettings {
    std::uint64_t seed = 1;
    std::int64_t reference_repeats = 150;  ///< of every block by the calibrated model [-]
    std::int64_t repeats = 20;  ///< of every block, per derivative and fingerprint: fewer blur what is visible [-]
    std::int64_t draws = 999;   ///< of chance [-]
    double level = 0.05;        ///< share of models without a flaw that are rejected [-]
    std::size_t finalists = 6;  ///< effects that are simulated at their best strength [-]
    std::size_t wide_search =
        200;  ///< simulations of a search all over the ranges, for a form that goes on to its end; a fifth at least, and no fewer than 40, for every one; 0: no such searches [-]
    /// Trials of a search for parameters that would make up for an effect, for each strength that might be seen; 0: that is told by derivatives alone [-].
    std::size_t power_search = 16;
    double power_up_to =
        kInfinity;   ///< nobody asks for stronger ones; finite: nor from where below that on it is seen [-]
    int rounds = 6;  ///< surveys at the place where one has arrived, at most: it ends where it has settled [-]
    double prior_none =
        0.5;  ///< weight of the calibrated model before the data, once the test has rejected it; the effects share the rest [-]
    double prior_unnamed = 0.2;  ///< share of what is missing that has no name in the catalogue, before the data [-]
    double named = 0.95;         ///< weight at which one name is said; less says groups [-]
    double group = 0.95;         ///< weight that a group has to reach [-]
    std::size_t largest_group = 3;
    double rejected =
        0.05;  ///< an explanation whose own simulations look like the measurements less often than this is none [-]
    ResidualSettings residuals;
};

enum class Verdict { None, Named, Group, Unknown, DataProblem };
inline constexpr std::array<const char*, 5> kVerdictNames{"NONE", "NAMED", "GROUP", "UNKNOWN", "DATA PROBLEM"};

/// How an effect fared.
struct EffectFinding {
    std::size_t effect = 0, variant = 0;  ///< the variant that explains most
    std::optional<Stretch> on;            ///< and where
    bool visible = false;                 ///< at some strength that is allowed
    double z = kNaN;                      ///< of its fingerprint [-]
    double visibility = kNaN;             ///< z to expect at the reference strength [-]
    /// Infinite: none of those allowed; NaN: something is missing, and nobody asks.
    double smallest_seen = kNaN;     ///< strength that would be seen with a probability of 80 % [-]
    std::size_t seen_variant = 0;    ///< the variant that is seen at the smallest strength, which this is
    std::optional<Stretch> seen_on;  ///< and where
    bool beyond_chance =
        false;  ///< z of a variant is beyond the limit of the test; of places, of one of those that were looked at from the start
    // of finalists
    bool finalist = false;
    double strength = kNaN;                   ///< that explains most [-]
    double strength_deviation = kNaN;         ///< its standard deviation, the parameters being free [-]
    double middle_deviation = kNaN;           ///< of the middle of `on`, all else being free [m]
    std::vector<double> parameters;           ///< with it [*]
    std::vector<double> parameter_deviation;  ///< their standard deviations, all else being free [*]
    double misfit = kNaN;                     ///< Q that is left [-]
    double p = kNaN;                          ///< of so much being left if this is the answer [-]
    double weight = 0.0;  ///< among the finalists, the calibrated model and something without a name [-]
};

struct Diagnosis {
    bool interrupted = false;  ///< nothing below is then filled
    Verdict verdict = Verdict::None;
    double weight_none = 1.0;             ///< of the calibrated model as it is [-]
    double weight_unnamed = 0.0;          ///< of something that is not in the catalogue [-]
    std::vector<EffectFinding> answer;    ///< one if named, several of a group or data problem, best first
    bool together = false;                ///< the two of `answer` act both: neither suffices alone
    std::vector<EffectFinding> findings;  ///< of all effects, by weight, then z
    std::vector<double>
        parameters;  ///< of the calibrated model that was tested, moved to where its residuals ask for [*]
    std::vector<Residual> residuals;
    ScoreResult score;
    std::vector<EffectDose> looked_at;  ///< what each z of the score is of
    GlobalTest test;
    Eigen::MatrixXd cosines;  ///< between the effects' best variants, in the order of the candidates [-]
    std::int64_t simulated_blocks = 0;
};

struct DiagnosisProgress {
    const char* stage = "";
    std::size_t done = 0, planned = 0;  ///< simulations [-]
};

Diagnosis diagnose(const DiagnosisProblem& problem, const ObservationTable& measured, const DiagnosisSettings& settings,
                   const DiagnosisSimulation& simulate, const std::function<void(const DiagnosisProgress&)>& progress);

/// What a test could see, before anything is measured: `planned` is a table with the columns and blocks of the test, in which values only say what will
/// be measured. Of the result hold findings (visibility, smallest_seen), cosines, residuals and the limits of the global test; z and p mean nothing.
Diagnosis plan_test(const DiagnosisProblem& problem, const ObservationTable& planned, const DiagnosisSettings& settings,
                    const DiagnosisSimulation& simulate, const std::function<void(const DiagnosisProgress&)>& progress);

}  // namespace scree
