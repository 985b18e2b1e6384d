// SPDX-License-Identifier: GPL-3.0-or-later
// From which strength on an effect would be seen, whatever values a recalibration gives the parameters.
#include "inference/diagnoser_view.hpp"

#include "scree/base/random.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

constexpr const char* kStage = "strengths that would be seen";
/// z beyond the limit at which four of five effects are seen: the 80 % quantile of the normal distribution [-].
constexpr double kFourOfFive = 0.8416;
/// Forms and places of an effect that are looked at, those first whose derivatives promise most [-].
constexpr std::size_t kFormsOfOne = 2;
/// Surveys at most around the parameters that make up for most, on the way to those that make up for more [-]; repeats of their simulations, as a share [-].
constexpr int kSurveys = 3;
constexpr std::int64_t kSurveyShare = 4;
/// How far beyond a survey its derivatives are trusted [steps].
constexpr double kSurveyReach = 2.0;
/// Strengths of each at most, the last one the largest that is allowed; and the factors between them, and at last [-].
constexpr int kStrengths = 6;
constexpr double kGrowth = 2.0, kCloseEnough = 1.5;

/// z to expect of what four of five tests see [-].
double enough_for(const GlobalTest& test) {
    return test.z_limit + kFourOfFive;
}

}  // namespace

/// Models without effect from all over the ranges: each may make up for any effect, so that all are held against all of them.
struct Diagnoser::Substitutes {
    EmulatedSearch search;                 ///< for the parameters that make up for the effect looked at
    std::vector<ObservationTable> tables;  ///< of its trials

    std::optional<Eigen::VectorXd> best_for(const ObservationTable& with, Diagnoser& d);
};

/// The parameters that make up for most of what was simulated with an effect, as single simulations tell; none: stopped.
std::optional<Eigen::VectorXd> Diagnoser::Substitutes::best_for(const ObservationTable& with, Diagnoser& d) {
    View view(ResidualSpace(with, d.measured_, d.problem_.blocks, d.settings_.residuals, d.base_.space->residuals()),
              d.measured_);
    view.observed.mean = mean_residual(view.space.of_reference()).mean;
    std::vector<Eigen::VectorXd> told;
    for (const ObservationTable& t : tables) told.push_back(d.residuals_of(t, view));
    search.tell_of_another(told);
    for (std::size_t trials = 0; trials < d.settings_.power_search;) {
        told.clear();
        for (const Eigen::VectorXd& u : search.ask()) {
            auto without = d.simulate(kStage, d.from_ranges(u), {}, 1);
            if (!without) return std::nullopt;
            told.push_back(d.residuals_of(*without, view));
            tables.push_back(std::move(*without));
            trials += tables.size() > EmulatedSearch::kSpread;
        }
        search.tell(told);
    }
    return d.from_ranges(search.best());
}

/// z to expect of a form at this strength where the parameters make up for most of it; or any value less than enough if it is. A model without effect is held against simulations with it as a calibrated
/// one against measurements, in its own residual space and with the linear absorption of a score test: the model itself, where that absorption leads, the best of the substitutes, and where surveys lead from the best of these.
/// The test looks for what the catalogue does, as fingerprints of the base tell, and for any disagreement, by Q; where neither sees it, what this form does is taken anew from there.
std::optional<double> Diagnoser::expected_z(std::size_t fingerprint, double strength, const GlobalTest& global,
                                            Substitutes& substitutes) {
    EffectDose dose = variants_[fingerprint];
    dose.strength = strength;
    const auto with = simulate(kStage, base_.parameters, {dose}, settings_.repeats);
    if (!with) return std::nullopt;
    dose.strength = taken_at_[fingerprint];
    const double enough = enough_for(global);
    // a test with the effect knows of as many blocks as come by with it: where few do, their speeds say little
    const double tests = telling(with->rows()) / static_cast<double>(measured_.rows());
    const ResidualMean known = mean_residual(
        ResidualSpace(*with, measured_, problem_.blocks, settings_.residuals, base_.space->residuals()).of_reference());

    struct {
        double z = kInfinity;
        Eigen::VectorXd parameters, shift;  ///< to where derivatives lead from there
    } least;
    const auto hold_against = [&](const ResidualSpace& model, const Eigen::VectorXd& at,
                                  const Eigen::MatrixXd& derivatives) {
        const ResidualMean effect = mean_residual(model.of(*with));
        if (!comparable(effect, known)) return true;
        const ResidualMean change{effect.mean - mean_residual(model.of_reference()).mean, effect.together / tests};
        const double over = 1.0 / telling(with->rows()) + 1.0 / telling(model.reference().rows());
        std::vector<Fingerprint> fingerprints = base_.test->fingerprints();
        fingerprints.push_back({change.mean, 1.0 / over, false});
        const Eigen::MatrixXd covariance = row_covariance(model);
        const ScoreTest test(covariance, derivatives, deviation_, std::move(fingerprints));
        const ScoreResult score = test(change);
        double z =
            std::max(test.largest_z(score), z_of_as_much_power(global, score.visibility[score.visibility.size() - 1]));
        if (z < enough && at != base_.parameters) {
            const auto weaker = simulate(kStage, at, {dose}, settings_.repeats);
            if (!weaker) return false;
            const Fingerprint anew = fingerprint_of(*weaker, dose.strength, model);
            z = std::max(z, ScoreTest(covariance, derivatives, deviation_, {anew})(change).z[0]);
        }
        if (z < least.z) least = {z, at, score.shift};
        return true;
    };
    const auto simulate_at = [&](const Eigen::VectorXd& at, const Eigen::MatrixXd& derivatives) {
        auto without = simulate(kStage, at, {}, settings_.repeats);
        return without && hold_against(ResidualSpace(std::move(*without), measured_, problem_.blocks,
                                                     settings_.residuals, base_.space->residuals()),
                                       at, derivatives);
    };
    least.parameters = base_.parameters;
    least.shift = Eigen::VectorXd::Zero(base_.parameters.size());
    if (!hold_against(*base_.space, base_.parameters, base_.slopes.directions)) return std::nullopt;
    if (least.z < enough) return least.z;
    if (!simulate_at(within_ranges(base_.parameters + least.shift), base_.slopes.directions)) return std::nullopt;
    if (least.z < enough) return least.z;

    const auto best = substitutes.best_for(*with, *this);
    if (!best || !simulate_at(*best, base_.slopes.directions)) return std::nullopt;

    for (int surveys = 0; surveys < kSurveys && least.z >= enough; ++surveys) {
        const double before = least.z;
        Survey around;
        around.at = least.parameters;
        around.step = base_.step;
        if (!survey(around, kNoEffect, std::max<std::int64_t>(settings_.repeats / kSurveyShare, 1), *with, kStage))
            return std::nullopt;
        const ScoreTest test(around.covariance, around.slopes.directions, deviation_, {});
        const Eigen::VectorXd
            farthest = kSurveyReach * around.step,
            to = test({around.left, base_.observed.together}).shift.cwiseMin(farthest).cwiseMax(-farthest);
        if (!simulate_at(within_ranges(around.at + to), around.slopes.directions)) return std::nullopt;
        if (!(least.z < before)) break;
    }
    return std::isfinite(least.z) ? least.z : 0.0;  // where nothing could be compared nothing is told
}

/// Of one form, the least strength of which so much z is to be expected, from what its derivatives promise upwards; told too large rather than too small, but for the reference, which is asked for where
/// it lies between. Infinite: none that is allowed.
std::optional<double> Diagnoser::strength_seen(std::size_t fingerprint, double promised, const GlobalTest& global,
                                               Substitutes& substitutes) {
    const double most = std::min(most_of(fingerprint), settings_.power_up_to);
    double unseen = 0.0, seen = kInfinity;
    double strength = std::isfinite(settings_.power_up_to) ? most : promised;
    for (int tried = 1; unseen < most && !(seen <= kCloseEnough * unseen); ++tried) {
        const std::optional<double> z = expected_z(fingerprint, strength, global, substitutes);
        if (!z) return std::nullopt;
        (*z >= enough_for(global) ? seen : unseen) = strength;
        if (unseen == 0.0) break;
        const double next = std::isfinite(seen)       ? std::sqrt(unseen * seen)
                            : tried + 1 == kStrengths ? most
                                                      : std::min(kGrowth * unseen, most);
        strength = unseen < 1.0 && std::min(next, seen) > 1.0 ? 1.0 : next;
    }
    return seen;
}

/// Where nothing is missing, or nothing was measured yet: derivatives tell too much of what parameters make up for far from where they are.
bool Diagnoser::find_strengths_seen(Diagnosis& d) {
    const double enough = enough_for(d.test);
    const Eigen::Index count = base_.parameters.size();
    if (!std::isfinite(enough)) return true;
    const RandomStream random(settings_.seed, next_seed_++, RandomPurpose::Diagnosis);
    std::optional<Substitutes> substitutes;
    if (settings_.power_search > 0 && count > 0)
        substitutes.emplace(EmulatedSearch(count, View::kLeastNoise, random), std::vector<ObservationTable>{});
    for (EffectFinding& f : d.findings) {
        f.smallest_seen = kInfinity;
        std::vector<std::pair<double, std::size_t>> forms;
        for (std::size_t k = 0; k < planned_variants_; ++k) {
            const double promised = enough / std::max(d.score.expected[static_cast<Eigen::Index>(k)], 1e-9);
            if (variants_[k].effect == f.effect && promised <= std::min(most_of(k), settings_.power_up_to))
                forms.emplace_back(promised, k);
        }
        std::sort(forms.begin(), forms.end());
        if (substitutes) forms.resize(std::min(forms.size(), kFormsOfOne));
        plan(forms.size() * (substitutes ? 4 + settings_.power_search + of_survey() : 0));
        for (const auto& [promised, k] : forms) {
            if (!(promised < f.smallest_seen)) break;
            const std::optional<double> seen =
                substitutes ? strength_seen(k, promised, d.test, *substitutes) : promised;
            if (!seen) return false;
            if (!(*seen < f.smallest_seen)) continue;
            f.smallest_seen = *seen;
            f.seen_variant = variants_[k].variant;
            f.seen_on = variants_[k].on;
            if (planning_) show(f, k, d.score);
        }
    }
    d.cosines = cosines_of(d.findings);
    return true;
}

}  // namespace scree
