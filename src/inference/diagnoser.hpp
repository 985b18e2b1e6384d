// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/diagnosis.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <bit>
#include <map>
#include <span>

namespace scree {

/// Pairs of simulations behind the derivatives with respect to so many parameters: the next power of two.
inline std::size_t design_size(std::size_t parameters) {
    return std::bit_ceil(std::max<std::size_t>(parameters, 1));
}

/// Signs of a folded-over two-level design (Box & Hunter 1961, Technometrics 3:311-351): one run per row, one factor per column; pairs of rows are opposite. From a Hadamard matrix: every
/// run tells about every factor, so the noise of a derivative is that of all runs together, and curvature cancels.
Eigen::MatrixXd design_of(std::size_t factors);

/// Of tables with the same columns.
void append(ObservationTable& to, const ObservationTable& rows);

/// Derivatives of the mean residual, from simulations all around a place.
struct Slopes {
    Eigen::MatrixXd directions;  ///< one column per parameter
    Eigen::VectorXd
        noise;  ///< what the noise of the simulations adds to the squared length of each, over the covariance of the measured mean [-]
    Eigen::VectorXd at_place;   ///< mean residual at the place itself
    Eigen::VectorXd centre;     ///< mean of how far the simulations are from the place
    double centre_noise = 0.0;  ///< variance of the mean of all of them, over that of the measured mean [-]
    Eigen::MatrixXd spread;     ///< covariance of the derivatives, over the same
    /// Variance of what they say of a place so far from theirs, over that of the measured mean [-].
    double variance_at(const Eigen::VectorXd& by) const {
        return centre_noise + (by - centre).dot(spread * (by - centre));
    }
};
/// By least squares with a constant: at the end of a range one side is missing. One row per simulation: how far its parameters are from the place,
/// and its mean residual; `rows_over` measured rows per row of one simulation.
Slopes slopes_of(Eigen::MatrixXd moved, Eigen::MatrixXd means, double rows_over);

/// Places on a path that an effect is looked for at first, and parts of each at a closer look.
inline constexpr std::size_t kStrips = 6, kPartsOfStrip = 3;
/// From part number `from` of so many to before part number `to`.
Stretch part_of(const Stretch& path, std::size_t from, std::size_t to, std::size_t parts);
/// z to expect that a fingerprint is taken at [-].
inline constexpr double kModerate = 6.0;
/// Lengths of a stretch that an effect acts on, least and most, as shares of the path [-].
inline constexpr double kShortestShare = 0.02, kLongestShare = 0.5;

/// Least strength that is followed, as a share of the largest [-].
inline constexpr double kLeastStrength = 0.01;

/// Telling steps, in standard deviations of an unknown if all else were known; and the shortest of parameters, of a range [-].
inline constexpr double kTellingStep = 1.5, kLeastStep = 0.005;

/// What leaves so much more than the best one, with less than that to gain, is not followed any further [-].
inline constexpr double kFarBehind = 15.0;

/// Logarithm of the integral of exp(-x'Ax / 2) over the last unknowns, so many, the best of the others being taken for each of their values: with information A. Where two of them make up for each
/// other it is far below that of the product of their standard deviations.
double log_volume(const Eigen::MatrixXd& information, Eigen::Index last);

/// A finalist that is no effect: the model itself.
inline constexpr std::size_t kNoEffect = static_cast<std::size_t>(-1);
/// One effect, or none, with its parameters, as far as it has been followed.
struct Hypothesis {
    std::size_t fingerprint = kNoEffect;
    Eigen::VectorXd parameters;
    double strength = 0.0;
    double strength_deviation = kNaN;
    std::optional<Stretch> on;  ///< where the effect acts, if that is to be found
    double middle_deviation = kNaN;
    double place_spread = 0.0;  ///< of the middle, as fingerprints of places nearby have it [m]
    double log_room = kNaN;     ///< log_volume() of strength, middle [m] and logarithm of the length together
    std::vector<double> parameter_deviation;
    Eigen::VectorXd step;      ///< of a survey around all of them; before the first one, nothing: unknown
    double q = kInfinity;      ///< what is left [-]
    double q_deviation = 0.0;  ///< of that, as simulations scatter [-]
    double p = 0.0;
    bool raced = false;  ///< q and p are those of a close race
    /// Other forms of the effect that were followed, with the logarithms of their weights: what they say for it counts as well.
    std::map<std::size_t, double> other_forms;
};

/// Shares of rivals in all weight, from its logarithms, whose standard deviations are those of what surveys scatter by: the mean over what all of them may
/// really be. Of two that are close neither is sure.
std::vector<double> mean_weights(const std::vector<double>& log_weights, const std::vector<double>& deviations,
                                 std::uint64_t seed);

/// By weight, then z.
void best_first(std::vector<EffectFinding>& findings);

/// Finalists that their own simulations reject (p of at most `rejected`) are no explanation. Unless the heaviest is one of them, which may be the right one all
/// the same, they lose the weight that the tail of what surveys scatter by has left them to all that could be it, in proportion.
void leave_out_rejected(Diagnosis& d, double rejected);

/// What diagnose() and plan_test() do, step by step: the model is tested and judged in diagnosis.cpp, effects are looked for in diagnoser_search.cpp,
/// followed in diagnoser_follow.cpp, their places found in diagnoser_places.cpp, and all of them weighed in diagnoser_weights.cpp; diagnoser_power.cpp says
/// what would have been seen.
class Diagnoser {
public:
    Diagnoser(const DiagnosisProblem& problem, const ObservationTable& measured, const DiagnosisSettings& settings,
              const DiagnosisSimulation& simulate, const std::function<void(const DiagnosisProgress&)>& progress);

    /// What there is to look at: a plan, a model as a calibration left it, or one that was followed.
    enum class Of { Plan, Calibrated, Followed };
    Diagnosis run(Of of);

private:
    std::optional<ObservationTable> simulate(const char* stage, const Eigen::VectorXd& parameters,
                                             std::vector<EffectDose> effects, std::int64_t repeats);
    Eigen::VectorXd within_ranges(Eigen::VectorXd parameters) const;
    /// So many simulations are to come, beside those that were planned and not done.
    void plan(std::size_t simulations) { planned_ = std::max(planned_, done_) + simulations; }
    /// Simulations that a base takes, and that following one finalist may take.
    std::size_t of_base() const { return 1 + 2 * design_size(problem_.calibrated.size()) + variants_.size(); }
    std::size_t of_finalist() const { return of_survey() * static_cast<std::size_t>(settings_.rounds); }
    std::size_t of_survey() const { return 2 * design_size(problem_.calibrated.size() + 1); }
    bool build_space(std::span<const Residual> residuals = {});
    bool differentiate();
    bool differentiate_over(const Eigen::VectorXd& step);
    Eigen::VectorXd telling_steps(const Slopes& slopes, const Eigen::MatrixXd& covariance,
                                  const Eigen::MatrixXd& together) const;
    void take_slopes();
    bool recentre();
    Fingerprint fingerprint_of(const ObservationTable& with, double strength, const ResidualSpace& model) const;
    /// Simulated rows that tell something, of so many: all, or in a pool of crossings alone as many as pass where fewest do.
    double telling(std::size_t rows) const { return passing_ * static_cast<double>(rows); }
    std::optional<Fingerprint> take_fingerprint(const EffectDose& dose, std::int64_t repeats);
    bool take_fingerprints();
    bool visible(std::size_t fingerprint, const ScoreResult& score) const;
    bool visible_anywhere(std::size_t first_strip, const ScoreResult& score) const;
    std::optional<std::vector<Fingerprint>> take_parts(std::size_t first_strip, const ScoreResult& score);
    bool look_closer(Diagnosis& d);
    struct Substitutes;
    std::optional<double> expected_z(std::size_t fingerprint, double strength, const GlobalTest& global,
                                     Substitutes& substitutes);
    std::optional<double> strength_seen(std::size_t fingerprint, double promised, const GlobalTest& global,
                                        Substitutes& substitutes);
    bool find_strengths_seen(Diagnosis& d);
    void judge(Diagnosis& d) const;
    void find(Diagnosis& d) const;
    std::size_t fingerprint_of(const EffectFinding& f) const;
    Eigen::MatrixXd cosines_of(const std::vector<EffectFinding>& findings) const;
    void show(EffectFinding& f, std::size_t fingerprint, const ScoreResult& score) const;
    std::vector<EffectFinding> findings(const ScoreResult& score, double z_limit) const;
    Eigen::VectorXd from_ranges(const Eigen::VectorXd& u) const;
    Hypothesis unfollowed(std::size_t fingerprint) const;
    std::vector<Hypothesis> finalists(const std::vector<EffectFinding>& findings) const;
    /// Simulations all around a place, and what is measured seen from there.
    struct Survey {
        Eigen::VectorXd at, step;  ///< as `unknowns_of` has them; step in each of them
        Slopes slopes;
        ResidualRows rows;                ///< of all its simulations
        std::vector<std::int32_t> block;  ///< of the test that each of them is one of
        Eigen::MatrixXd covariance;       ///< of single rows
        ResidualMean observed;
        Eigen::VectorXd left;  ///< what is measured less what is simulated at `at`
    };
    struct Box;
    class LocalMisfit;
    /// A hypothesis on its way.
    struct Pursuit {
        Hypothesis best;  ///< so far
        Survey here;      ///< the last one, and where the next one will be
        Survey of_best;
        Eigen::VectorXd start;
        double trust = 0.0;           ///< how far derivatives are trusted [steps]
        double left = kInfinity;      ///< at the last survey [-]
        double promised = kInfinity;  ///< the least that its derivatives promise to leave anywhere [-]
        bool on_the_way = true;       ///< with few simulations
        int surveys = 0, without_better = 0;
        bool settled = false;
    };
    bool survey(Survey& s, std::size_t fingerprint, std::int64_t repeats, const ObservationTable& measured,
                const char* stage);
    Box around(const Survey& s, std::size_t fingerprint, const Eigen::VectorXd& reach) const;
    Eigen::VectorXd prior_of(std::size_t fingerprint) const;
    /// Parameters; with an effect its strength; where its place is to be found the middle [m] and the logarithm of the length [ln m].
    Eigen::VectorXd unknowns_of(const Hypothesis& h) const;
    Eigen::Index count_of(std::size_t fingerprint) const {
        return deviation_.size() + (fingerprint == kNoEffect ? 0 : variants_[fingerprint].on ? 3 : 1);
    }
    Eigen::VectorXd next_steps(const Survey& s, std::size_t fingerprint) const;
    Eigen::VectorXd limited(Eigen::VectorXd step, const Eigen::VectorXd& at, std::size_t fingerprint) const;
    static bool comparable(const ResidualMean& measured, const ResidualMean& with);
    bool simulates_enough(const ResidualMean& simulated, std::size_t rows, const ResidualMean& observed) const;
    void judge(Hypothesis& h, const Survey& s) const;
    Eigen::VectorXd within(Eigen::VectorXd at, std::size_t fingerprint) const;
    double most_of(std::size_t fingerprint) const;
    const Stretch& path_of(std::size_t fingerprint) const;
    std::vector<EffectDose> dose_of(std::size_t fingerprint, const Eigen::VectorXd& at) const;
    std::optional<double> left_at(double strength, std::size_t fingerprint);
    std::optional<std::vector<Hypothesis>> strong_finalists();
    bool find_place_from(const Pursuit& p, std::size_t fingerprint, std::optional<Hypothesis>& found);
    bool pursue_place_from(std::size_t p, std::size_t fingerprint, std::vector<Pursuit>& pursuits, double& least);
    bool look_again(std::vector<Pursuit>& pursuits, double least);
    Pursuit begin(Hypothesis h) const;
    bool advance(Pursuit& p);
    Eigen::VectorXd reach_of(const Pursuit& p, const LocalMisfit& misfit) const;
    void go(Pursuit& p) const;
    struct WideSearch;
    WideSearch search_for(Hypothesis h);
    Eigen::VectorXd unknowns_at(const WideSearch& w, const Eigen::VectorXd& u) const;
    struct View;
    Eigen::VectorXd residuals_of(const ObservationTable& table, const View& view) const;
    bool search(WideSearch& w, std::size_t trials, const View& view);
    bool look_from(const Eigen::VectorXd& at, std::size_t fingerprint, std::vector<WideSearch>& ways, View& view);
    bool look_from_best(std::vector<WideSearch>& ways, View& view);
    bool search_in_stages(std::vector<WideSearch>& ways, const std::function<std::size_t(std::size_t)>& going_on,
                          const Hypothesis* seen_from);
    double spread_near(const Hypothesis& h) const;
    Hypothesis found_by(const WideSearch& w) const;
    bool search_widely(const std::vector<Hypothesis>& chosen, const Hypothesis* seen_from,
                       std::vector<Hypothesis>& found);
    bool search_without(std::vector<Hypothesis>& found);
    Eigen::VectorXd given_parameters() const {
        return Eigen::Map<const Eigen::VectorXd>(problem_.given.data(), std::ssize(problem_.given));
    }
    Hypothesis arrived(Pursuit p) const;
    bool follow(Hypothesis& h);
    /// But for the place.
    bool same_way(const Hypothesis& a, const Hypothesis& b) const {
        const EffectDose &of_a = variants_[a.fingerprint], &of_b = variants_[b.fingerprint];
        return of_a.effect == of_b.effect && of_a.variant == of_b.variant;
    }
    bool hopeless(const Pursuit& p, double least) const;
    bool pursue(std::vector<Pursuit>& pursuits, double& least);
    bool follow_best(std::vector<Hypothesis> chosen, std::vector<Hypothesis>& followed);
    bool hear_others(const Diagnosis& d, std::vector<Hypothesis>& followed);
    bool survey_all(std::vector<Hypothesis> chosen, std::vector<Pursuit>& pursuits);
    static double least_of(const std::vector<Hypothesis>& followed);
    bool race(Hypothesis& h);
    bool race_without(Hypothesis without);
    bool decide_close_race(std::vector<Hypothesis>& followed);
    /// For simulations that are many together, or a first look.
    std::int64_t half_repeats() const { return std::max<std::int64_t>(settings_.repeats / 2, 1); }
    std::int64_t repeats_on_the_way() const;
    bool rejected(const Diagnosis& d) const { return d.test.p <= settings_.level; }
    /// By something that happens: before an instrument is blamed, the ground is asked from all sides.
    bool explained(const Diagnosis& d) const {
        if (d.findings.empty()) return false;
        const EffectFinding& best = d.findings.front();
        return best.finalist && best.p > settings_.rejected && !problem_.effects[best.effect].measurement;
    }
    bool move_base(Diagnosis& d, const Hypothesis& without);
    bool settle_base(Diagnosis& d);
    bool return_without(Diagnosis& d, const Hypothesis& with);
    bool follow_from_given(Diagnosis& d, std::vector<Hypothesis>& followed);
    double log_weight(const Hypothesis& h) const;
    std::optional<std::size_t> nearest_fingerprint(const Hypothesis& h, const ScoreResult& score) const;
    void weigh(Diagnosis& d, std::vector<Hypothesis>& followed) const;
    void conclude(Diagnosis& d, std::vector<Hypothesis>& followed) const;
    double goodness_of_fit(const Survey& survey, std::size_t fingerprint, double left) const;

    const DiagnosisProblem& problem_;
    const ObservationTable& measured_;
    const DiagnosisSettings& settings_;
    const DiagnosisSimulation& simulate_;
    const std::function<void(const DiagnosisProgress&)>& progress_;
    std::vector<EffectDose>
        variants_;  ///< of all effects, at the reference strength; at the end places that a closer look has found
    bool only_who_passed_ = false;  ///< rows of a pool with crossings of which nobody knows how many were thrown
    double passing_ = 1.0;          ///< of such a pool: share of the simulated rows that its rarest residual knows [-]
    std::vector<double> place_spread_;  ///< of the middle of each of these, as the closer look has it [m]
    std::vector<double> taken_at_;      ///< strength that the fingerprint of each was last taken at [-]
    std::size_t planned_variants_ = 0;  ///< those before these: the measurements had no part in choosing them
    /// A simulation near a model, for derivatives.
    struct Nearby {
        Eigen::VectorXd parameters;
        ObservationTable table;
    };
    /// A model without effects, and how it changes with parameters and effects.
    struct Base {
        Eigen::VectorXd parameters;
        std::optional<ResidualSpace> space;
        ResidualMean observed;
        std::vector<Nearby> nearby;
        Eigen::VectorXd step;  ///< of the simulations around
        Slopes slopes;
        std::optional<ScoreTest> test;  ///< with the fingerprints
    };
    Base base_;
    Eigen::VectorXd deviation_;                ///< of the parameters before the test: of their ranges
    std::vector<Hypothesis> searched_widely_;  ///< ways to act, whatever their place
    Hypothesis without_;                       ///< the model without effects, where it was followed best, raced
    bool planning_ = false;                    ///< nothing was measured yet
    std::size_t done_ = 0, planned_ = 0;
    std::int64_t simulated_ = 0;
    std::uint64_t next_seed_ = 0;
};

}  // namespace scree
