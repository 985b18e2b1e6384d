// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/discrepancy.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scree {

/// Calibration: the parameters of a model for which it predicts a field test best, and how well the test determines them. Knows nothing of how a simulation
/// is run: it calls a function that says what each measured block loses.
///
/// Loss. Every record (measured block) has a loss, the lower the better, whose mean over the records is minimised; a strictly proper score, so that it is least
/// in expectation for the distribution that the record was drawn from. Beside it stands the loss that one more repeat of the simulation would have in
/// its place; the ratio of the two sums is the gap, 1 on average if nothing differs. Gaps are reported and never minimised: a model could lower its gap by
/// scattering more.
///
/// Search. Losses are noisy. A Latin hypercube and then CMA-ES (src/inference/cma_es.hpp) from several starts; inside a generation all candidates see the same
/// random numbers, so that ranks depend on parameters and not on luck, between generations they change, so that luck is not fitted. Choices (block shapes)
/// are searched one by one and raced against each other with fresh common numbers.
///
/// What the data identify. Around the best point a quadratic is fitted to the loss of every record, at points with independent random numbers. Records drawn
/// again with replacement, with the noise of the fit redrawn, give other quadratics with other minima: their spread is that of the estimate
/// (M-estimation: van der Vaart 1998, Asymptotic Statistics, chapters 5 and 23), for models that are wrong, too. Because the fit is linear in the
/// losses, this costs no further simulation; nor do the k fits of the cross-validation, whose minima are then simulated anew.

/// A number that is calibrated.
struct CalibrationParameter {
    std::string name;
    double low = 0.0;          ///< [*]
    double high = 1.0;         ///< [*]
    double start = kNaN;       ///< of the uncalibrated model; NaN: the middle [*]
    bool logarithmic = false;  ///< searched by ratios, for ranges over orders of magnitude; needs a positive lower end
};

/// Something that takes one of a few values.
struct CalibrationChoice {
    std::string name;
    std::vector<std::string> levels;
    std::size_t start = 0;  ///< of the uncalibrated model [-]
};

/// Records of one path down the slope.
struct CalibrationPath {
    std::string name;
    std::vector<std::size_t> records;  ///< [-]
};

struct CalibrationProblem {
    std::vector<CalibrationParameter> parameters;
    std::vector<CalibrationChoice> choices;
    std::size_t records = 0;  ///< measured blocks [-]
    /// Where it was measured (a screen, the stops). If there are several, each is left out once, and predicted by what the others say.
    std::vector<std::string> places = {};
    /// If there are several, each is left out once, too, and predicted by what all other records say.
    std::vector<CalibrationPath> paths = {};
};

struct CalibrationPoint {
    std::vector<double> values;       ///< one per parameter [*]
    std::vector<std::size_t> levels;  ///< one per choice [-]
    bool operator==(const CalibrationPoint&) const = default;
};

enum class CalibrationStage { Screening, Search, Race, Surroundings, Judgement };
inline constexpr std::array<const char*, 5> kCalibrationStageNames{"screening", "search", "race", "surroundings",
                                                                   "judgement"};

/// One simulation to be run.
struct CalibrationTask {
    CalibrationStage stage = CalibrationStage::Screening;
    CalibrationPoint point;
    std::uint64_t seed = 0;
    std::int64_t repeats = 0;  ///< of each measured block [-]
    bool operator==(const CalibrationTask&) const = default;
};

/// What it said, per record; empty where nothing can be said of a simulation as a whole.
struct SimulatedLoss {
    std::vector<double> loss;   ///< [-]
    std::vector<double> floor;  ///< loss of one more repeat in its place [-]
    /// What of both belongs to each place of the problem, a vector over the records per place [-].
    std::vector<std::vector<double>> loss_at = {}, floor_at = {};
    std::vector<double> log_loss = {};  ///< logarithmic score per record, for decisions; empty: not asked for [-]
};
/// Runs a simulation. The same task must give the same result. Nothing: it was stopped, and so is the calibration.
using LossFunction = std::function<std::optional<SimulatedLoss>(const CalibrationTask&)>;

struct CalibrationEvaluation {
    CalibrationTask task;
    SimulatedLoss result;
};
/// All evaluations in their order. Calibration is a function of problem, settings and losses, so that a stopped one resumes by running again with the
/// journal that it left: what is in there is not simulated again.
using CalibrationJournal = std::vector<CalibrationEvaluation>;

struct CalibrationSettings {
    std::uint64_t seed = 1;
    std::int64_t starts =
        2;  ///< of the search, shared out among the levels, at least one each; more find remote minima [-]
    std::int64_t screening = 0;    ///< points of the Latin hypercube per level; 0: 4 per parameter, at least 8 [-]
    std::int64_t population = 0;   ///< candidates of a generation; 0: 4 + 3 ln(parameters), as Hansen has it [-]
    std::int64_t generations = 8;  ///< per start; a search that is cut short leaves more to the surroundings [-]
    std::int64_t search_repeats =
        5;  ///< of each block, in screening and search: noise is cheaper than precision there [-]
    std::int64_t surroundings = 0;     ///< points of the quadratic fit; 0: 5 per coefficient, at least 40 [-]
    std::int64_t repeats = 10;         ///< of each block, in race and surroundings [-]
    std::int64_t final_repeats = 100;  ///< of each block, in the judgement [-]
    std::int64_t folds = 5;            ///< of the cross-validation, at most the records; below 2: none [-]
    std::int64_t draws = 2000;         ///< of the records, behind the intervals [-]
};

/// How well the test determines a parameter, by the length of its interval in shares of its range.
enum class Identification { Well, Weakly, Not };
inline constexpr std::array<const char*, 3> kIdentificationNames{"identified", "weakly identified", "not identified"};
inline constexpr double kWellIdentified = 0.35;  ///< intervals shorter than this share of the range [-]
inline constexpr double kNotIdentified =
    0.70;  ///< and longer than this: little more than the range itself was learned [-]
/// Estimates nearer to an end of their range than this share of it lie on its edge [-].
inline constexpr double kAtEdge = 0.02;

struct ParameterEstimate {
    double value = kNaN;  ///< [*]
    Interval interval;    ///< 95 %; ends at an end of the range where the losses do not bound it before [*]
    Identification identified = Identification::Not;
    bool at_low = false;   ///< the estimate lies on the lower end of its range
    bool at_high = false;  ///< or on the upper end
};

/// A combination of parameters with its own uncertainty, in units of the ranges; the first one of a list is known best.
struct CalibrationDirection {
    std::vector<double> weights;  ///< one per parameter, of unit length [-]
    double deviation =
        kNaN;  ///< standard deviation along it; 0.29 would be that of a range of which nothing is known [-]
};

/// Mean loss and gap of a point over records.
struct CalibrationFit {
    double loss = kNaN;   ///< [-]
    double floor = kNaN;  ///< [-]
    double gap() const { return loss / floor; }
};

struct CalibrationSearch {
    CalibrationPoint begin, end;
    CalibrationFit fit;  ///< of its end, in the race
    Interval behind;  ///< 95 % of the loss by which it is behind the best one, from the records; empty for the best [-]
    bool same_minimum = false;  ///< its end lies among the plausible ones around the best point
};

struct CalibrationFold {
    std::vector<std::size_t> held_out;  ///< records [-]
    CalibrationPoint point;             ///< best for the others
    CalibrationFit training, test;      ///< of the others, of those held out
    CalibrationFit start_test;          ///< of those held out, with the uncalibrated model
};

/// A place, or a path, that the calibration was not told about, and what it predicts there.
struct CalibrationPlace {
    std::string name;
    CalibrationPoint point = {};              ///< best for the others
    CalibrationFit training = {}, test = {};  ///< of the others, of the one left out
    /// There: uncalibrated; of the calibration that knows all; over all folds.
    CalibrationFit start = {}, best = {}, held_out = {};
    bool is_path = false;   ///< blocks that went down it, with all that was measured on them
    bool was_seen = false;  ///< `point` is that of all records: what was left out had its part in finding it
};

/// How well the quadratic describes the losses around the best point.
struct SurroundingsFit {
    std::size_t points = 0;  ///< that it rests on [-]
    double noise =
        kNaN;  ///< standard deviation of a mean loss from one simulation to the next, and what no quadratic describes [-]
    double explained = kNaN;  ///< share of the variance of the mean losses [-]
    bool holds = true;        ///< false: its minimum is worse than a point that was simulated, which then is the result
    std::vector<double> low, high;  ///< the box that they lie in [*]
};

struct CalibrationResult {
    bool interrupted = false;  ///< nothing below is then filled
    CalibrationPoint start, best;
    std::vector<ParameterEstimate> parameters;
    Eigen::MatrixXd correlation;  ///< of the estimates [-]
    std::vector<CalibrationDirection> directions;
    std::vector<CalibrationSearch> searches;  ///< best first
    SurroundingsFit surroundings;
    CalibrationFit start_fit, best_fit;  ///< of all records, same random numbers
    std::vector<CalibrationFold> folds;
    CalibrationFit held_out, held_out_start;  ///< over all folds
    std::vector<double> held_out_losses;  ///< of every record, by the fold that left it out; empty without folds [-]
    std::vector<double> held_out_log_losses;  ///< the same by the logarithmic score; NaN where that is not known [-]
    std::vector<CalibrationPlace> places;     ///< then paths; empty if there is one only, or no cross-validation
    std::vector<std::vector<double>>
        draws;  ///< plausible parameter values, for pictures and predictions: per draw one per parameter [*]
    /// Every fold chose the point that all records together chose: what is held out had its part in finding it.
    bool held_out_was_seen = false;
};

struct CalibrationProgress {
    CalibrationStage stage = CalibrationStage::Screening;
    std::size_t done = 0;     ///< simulations [-]
    std::size_t planned = 0;  ///< of so many [-]
    double gap = kNaN;        ///< of the last one [-]
    double best_gap = kNaN;   ///< of the one with the least loss so far [-]
};

/// The settings with nothing left open about how much is simulated: what a problem of so many parameters gets by default. Models with more and with fewer
/// parameters than that then have the same search.
CalibrationSettings with_budget_of(CalibrationSettings settings, std::size_t parameters);

/// Simulations that a calibration takes [-].
std::size_t planned_evaluations(const CalibrationProblem& problem, const CalibrationSettings& settings);

/// Throws InputError if the problem makes no sense (no records, empty ranges, starts outside) or the journal belongs to another one. `journal` grows by
/// every simulation before `progress` is told.
CalibrationResult calibrate(const CalibrationProblem& problem, const CalibrationSettings& settings,
                            const LossFunction& function, CalibrationJournal& journal,
                            const std::function<void(const CalibrationProgress&)>& progress);

}  // namespace scree
