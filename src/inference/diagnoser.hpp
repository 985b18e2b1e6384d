// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/diagnosis.hpp"

#include <Eigen/Cholesky>

#include <span>

namespace scree {

/// A finalist that is no effect: the model itself.
inline constexpr std::size_t kNoEffect = static_cast<std::size_t>(-1);
/// One effect, or none, with its parameters, as far as it has been followed.
struct Hypothesis {
    std::size_t fingerprint = kNoEffect;
    Eigen::VectorXd parameters;
    double strength = 0.0;
    double strength_deviation = kNaN;
    double q = kInfinity;  ///< what is left [-]
    double p = 0.0;
    bool from_given = false;  ///< followed from the parameters that the site was given
};

/// What diagnose() and plan_test() do, step by step: the model is tested and judged in diagnosis.cpp, effects are followed in diagnoser_follow.cpp.
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
    /// Simulations that a base takes, and that following one finalist may take.
    std::size_t of_base() const { return 1 + 2 * problem_.calibrated.size() + variants_.size(); }
    std::size_t of_finalist() const { return static_cast<std::size_t>(settings_.rounds) + 1; }
    bool build_space(std::span<const Residual> residuals = {});
    bool differentiate();
    void take_jacobian();
    bool recentre();
    bool take_fingerprints();
    void judge(Diagnosis& d) const;
    std::size_t fingerprint_of(const EffectFinding& f) const;
    std::vector<EffectFinding> findings(const ScoreResult& score, double z_limit) const;
    std::vector<Hypothesis> finalists(const std::vector<EffectFinding>& findings) const;
    /// A simulation, and what is measured seen from there.
    struct Point {
        Eigen::VectorXd at;          ///< parameters, then the strength if there is an effect
        ResidualRows rows;           ///< of the simulation
        Eigen::MatrixXd covariance;  ///< of rows
        ResidualMean observed;
        double misfit = kInfinity;
        Eigen::LLT<Eigen::MatrixXd> factor() const {
            return Eigen::LLT<Eigen::MatrixXd>(mean_covariance(covariance, observed.together));
        }
    };
    bool look(Point& p, std::size_t fingerprint, std::int64_t repeats);
    std::optional<std::vector<Hypothesis>> strong_finalists();
    bool follow(Hypothesis& h);
    bool rejected(const Diagnosis& d) const { return d.test.p <= settings_.level; }
    bool move_base(Diagnosis& d, const Hypothesis& without);
    bool settle_base(Diagnosis& d);
    bool follow_from_given(Diagnosis& d, std::vector<Hypothesis>& followed);
    void weigh(Diagnosis& d, std::vector<Hypothesis>& followed) const;
    void conclude(Diagnosis& d, std::vector<Hypothesis>& followed) const;
    double goodness_of_fit(const ResidualRows& rows, const Eigen::MatrixXd& covariance,
                           const Eigen::MatrixXd& directions, const ResidualMean& observed) const;

    const DiagnosisProblem& problem_;
    const ObservationTable& measured_;
    const DiagnosisSettings& settings_;
    const DiagnosisSimulation& simulate_;
    const std::function<void(const DiagnosisProgress&)>& progress_;
    std::vector<EffectDose> variants_;  ///< of all effects, at the reference strength
    /// Simulations on either side of a model, of one parameter.
    struct Difference {
        ObservationTable above, below;
        double width = 0.0;  ///< [*]
    };
    /// A model without effects, and how it changes with parameters and effects.
    struct Base {
        Eigen::VectorXd parameters;
        std::optional<ResidualSpace> space;
        ResidualMean observed;
        std::vector<Difference> differences;
        Eigen::MatrixXd jacobian;
        std::optional<ScoreTest> test;  ///< with the fingerprints
    };
    Base base_;
    Eigen::VectorXd deviation_;  ///< of the parameters before the test: of their ranges
    std::size_t done_ = 0, planned_ = 0;
    std::int64_t simulated_ = 0;
    std::uint64_t next_seed_ = 0;
};

}  // namespace scree
