// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/diagnosis.hpp"

#include "inference/diagnoser.hpp"
#include "inference/second_effect.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/error.hpp"
#include "scree/base/random.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// So many times as many effects as finalists are looked at more closely [-], if their z is at least this share of the best one's [-]: an effect is often stronger, and
/// the parameters elsewhere, than its fingerprint tells.
constexpr std::size_t kCandidates = 2;
constexpr double kFinalistShare = 0.2;
/// z to expect at the largest strength allowed, below which an effect is none that could be seen [-].
constexpr double kLeastVisible = 2.0;
/// How many times as strong or weak as kModerate a fingerprint is taken again, how much stronger at once [-], and how often.
constexpr double kOtherStrength = 2.0, kMostGrowth = 4.0;
constexpr int kTakenAgain = 2;
/// How often the calibrated model is moved to where its residuals ask for [-], and by how much at least, in standard deviations.
constexpr int kRecentrings = 2;
constexpr double kLeastMove = 1.5;
/// How many times as long as telling ones steps are too far [-].
constexpr double kFarStep = 2.0;
/// Share of a derivative's squared length that is taken for noise, at most [-].
constexpr double kMostNoise = 0.5;
/// What another place for the parameters must leave less to be looked at, of Q [-].
constexpr double kWorthMoving = 8.0;
/// Where still fewer pass, simulations are no more: their noise counts for less than it is [-].
constexpr double kLeastPassing = 0.1;
/// Weight of chance from which nobody else is asked [-].
constexpr double kLikelyChance = 0.5;
/// How often the model is followed without an effect from where the effect took it [-].
constexpr int kReturns = 2;

Eigen::VectorXd to_vector(const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

Diagnoser::Diagnoser(const DiagnosisProblem& problem, const ObservationTable& measured,
                     const DiagnosisSettings& settings, const DiagnosisSimulation& simulate,
                     const std::function<void(const DiagnosisProgress&)>& progress)
    : problem_(problem), measured_(measured), settings_(settings), simulate_(simulate), progress_(progress) {
    SCREE_ASSERT(problem.low.size() == problem.calibrated.size() && problem.high.size() == problem.calibrated.size() &&
                 problem.step.size() == problem.calibrated.size());
    base_.parameters = to_vector(problem.calibrated);
    deviation_ = (to_vector(problem.high) - to_vector(problem.low)) / std::sqrt(12.0);
    for (std::size_t e = 0; e < problem.effects.size(); ++e)
        for (std::size_t v = 0; v < problem.effects[e].variants.size(); ++v) {
            const std::optional<Stretch>& path = problem.effects[e].variants[v].path;
            for (std::size_t k = 0; k < (path ? kStrips : 1); ++k)
                variants_.push_back(
                    {e, v, 1.0, path ? std::optional(part_of(*path, k, k + 1, kStrips)) : std::nullopt});
        }
    planned_variants_ = variants_.size();
    bool any_passed = false, any_seen = false;
    for (std::size_t k = 0; k < measured.columns.size(); ++k) {
        const Column& c = measured.columns[k];
        if (c.place < 0 || c.quantity == Quantity::InZone ||
            std::none_of(measured.values[k].begin(), measured.values[k].end(),
                         [](double v) { return std::isfinite(v); }))
            continue;
        (c.quantity == Quantity::Passed ? any_passed : any_seen) = true;
    }
    only_who_passed_ = problem.blocks.empty() && any_seen && !any_passed;
    planned_ = kRecentrings + of_base() + settings.finalists * of_finalist();
}

std::optional<ObservationTable> Diagnoser::simulate(const char* stage, const Eigen::VectorXd& parameters,
                                                    std::vector<EffectDose> effects, std::int64_t repeats) {
    if (progress_) progress_({stage, done_, std::max(planned_, done_ + 1)});
    DiagnosisTask task{{parameters.data(), parameters.data() + parameters.size()},
                       std::move(effects),
                       RandomStream(settings_.seed, next_seed_++, RandomPurpose::Diagnosis).bits() >> 2,
                       static_cast<std::int64_t>(std::ceil(static_cast<double>(repeats) / passing_))};
    auto table = simulate_(task);
    ++done_;
    if (table) simulated_ += static_cast<std::int64_t>(table->rows());
    return table;
}

/// A place of the unit cube.
Eigen::VectorXd Diagnoser::from_ranges(const Eigen::VectorXd& u) const {
    const Eigen::VectorXd low = to_vector(problem_.low);
    return low + u.cwiseProduct(to_vector(problem_.high) - low);
}

Eigen::VectorXd Diagnoser::within_ranges(Eigen::VectorXd parameters) const {
    for (Eigen::Index k = 0; k < parameters.size(); ++k)
        parameters[k] = std::clamp(parameters[k], problem_.low[static_cast<std::size_t>(k)],
                                   problem_.high[static_cast<std::size_t>(k)]);
    return parameters;
}

bool Diagnoser::build_space(std::span<const Residual> residuals) {
    const auto build = [&] {
        auto reference = simulate("calibrated model", base_.parameters, {}, settings_.reference_repeats);
        if (reference)
            base_.space.emplace(std::move(*reference), measured_, problem_.blocks, settings_.residuals, residuals);
        return reference.has_value();
    };
    if (!build()) return false;
    if (only_who_passed_ && passing_ == 1.0 && !base_.space->residuals().empty()) {
        // every record is of a block that passed: as many of these are needed as of blocks where all are known
        const ResidualRows own = base_.space->of_reference();
        const double least = mean_residual(own).together.diagonal().minCoeff() / static_cast<double>(own.rows());
        passing_ = std::clamp(least, kLeastPassing, 1.0);
        if (passing_ < 1.0 && !build()) return false;
    }
    if (base_.space->residuals().empty())
        throw InputError("Nothing that was measured is known of at least " + std::to_string(ResidualSpace::kLeastRows) +
                         " blocks: a diagnosis cannot tell chance from a disagreement; measure more blocks");
    base_.observed = mean_residual(base_.space->of(measured_));
    return true;
}

/// Simulations around the model, for derivatives; again, nearer, where the steps turn out to be long for what the measurements can tell.
bool Diagnoser::differentiate() {
    base_.step = to_vector(problem_.step);
    if (!differentiate_over(base_.step)) return false;
    const Eigen::VectorXd telling = telling_steps(base_.slopes, row_covariance(*base_.space), base_.observed.together);
    const bool far = (base_.step.array() > kFarStep * telling.array()).any();
    base_.step = telling;
    return !far || differentiate_over(telling);
}

bool Diagnoser::differentiate_over(const Eigen::VectorXd& step) {
    const Eigen::MatrixXd signs = design_of(problem_.step.size());
    base_.nearby.clear();
    for (Eigen::Index run = 0; run < signs.rows(); ++run) {
        Eigen::VectorXd at = within_ranges(base_.parameters + signs.row(run).transpose().cwiseProduct(step));
        auto table = simulate("derivatives", at, {}, settings_.repeats);
        if (!table) return false;
        base_.nearby.push_back({std::move(at), std::move(*table)});
    }
    take_slopes();
    return true;
}

/// The derivatives in the residual space of the reference.
void Diagnoser::take_slopes() {
    const auto runs = static_cast<Eigen::Index>(base_.nearby.size());
    Eigen::MatrixXd moved(runs, base_.parameters.size()), means(runs, base_.observed.mean.size());
    for (Eigen::Index k = 0; k < runs; ++k) {
        const Nearby& n = base_.nearby[static_cast<std::size_t>(k)];
        moved.row(k) = n.parameters - base_.parameters;
        means.row(k) = mean_residual(base_.space->of(n.table)).mean;
    }
    base_.slopes = slopes_of(std::move(moved), std::move(means), 1.0 / static_cast<double>(settings_.repeats));
}

/// Steps of parameters by which a measured test of this size would tell two models apart, if all else were known.
Eigen::VectorXd Diagnoser::telling_steps(const Slopes& slopes, const Eigen::MatrixXd& covariance,
                                         const Eigen::MatrixXd& together) const {
    const Eigen::Index count = base_.parameters.size();
    const Eigen::MatrixXd J = slopes.directions.leftCols(count);
    const Eigen::LLT<Eigen::MatrixXd> factor(mean_covariance(covariance, together));
    const Eigen::VectorXd squared = J.cwiseProduct(factor.solve(J)).colwise().sum();
    const Eigen::ArrayXd information = (squared - slopes.noise.head(count)).cwiseMax((1.0 - kMostNoise) * squared);
    return (kTellingStep / information.max(1e-24).sqrt()).min(to_vector(problem_.step).array()).max(kLeastStep);
}

/// Calibrated parameters minimise another loss than the test weighs by, and the test is linear in them: it begins where its own weights put the
/// parameters, as long as that leaves less.
bool Diagnoser::recentre() {
    for (int round = 0; round < kRecentrings; ++round) {
        const ScoreTest test(row_covariance(*base_.space), base_.slopes.directions, deviation_, {});
        const ScoreResult score = test(base_.observed);
        const Eigen::VectorXd before = base_.parameters;
        if (!((score.shift.array() / score.shift_deviation.array()).abs().maxCoeff() > kLeastMove)) return true;
        std::optional<ResidualSpace> kept;
        kept.swap(base_.space);
        const ResidualMean observed = base_.observed;
        const Slopes slopes = base_.slopes;
        base_.parameters = within_ranges(base_.parameters + score.shift);
        if (!build_space(kept->residuals())) return false;
        take_slopes();
        const ScoreTest moved(row_covariance(*base_.space), base_.slopes.directions, deviation_, {});
        if (comparable(base_.observed, observed) && moved(base_.observed).q < score.q) continue;
        base_.parameters = before;
        base_.space.swap(kept);
        base_.observed = observed;
        base_.slopes = slopes;
        return true;
    }
    return true;
}

/// In units of the reference strength, whatever strength was simulated.
Fingerprint Diagnoser::fingerprint_of(const ObservationTable& with, double strength, const ResidualSpace& model) const {
    return {mean_residual(model.of(with)).mean / strength, telling(with.rows()) * strength * strength};
}

std::optional<Fingerprint> Diagnoser::take_fingerprint(const EffectDose& dose, std::int64_t repeats) {
    const auto table = simulate("fingerprints", base_.parameters, {dose}, repeats);
    if (!table) return std::nullopt;
    return fingerprint_of(*table, dose.strength, *base_.space);
}

/// Every effect is looked at where it would stand out clearly but not by far: weaker, the noise of the simulation hides what it does; stronger, what it does is not
/// proportional to its strength, least of all where probabilities have run into 0 and 1.
bool Diagnoser::take_fingerprints() {
    const Eigen::MatrixXd covariance = row_covariance(*base_.space);
    std::vector<Fingerprint> fingerprints;
    taken_at_.resize(variants_.size(), kNaN);
    for (const EffectDose& v : variants_) {
        double& known = taken_at_[fingerprints.size()];
        const double most = most_of(fingerprints.size());
        EffectDose dose = v;
        dose.strength = std::isnan(known) ? std::min(dose.strength, most) : known;
        auto fingerprint = take_fingerprint(dose, std::isnan(known) ? half_repeats() : settings_.repeats);
        for (int again = 0; fingerprint && again < kTakenAgain; ++again) {
            const double seen =
                ScoreTest(covariance, base_.slopes.directions, deviation_, {*fingerprint})(base_.observed)
                    .visibility[0];
            const double better = std::min(kModerate / std::max(seen, 1e-9), most), factor = better / dose.strength;
            if (factor > 1.0 / kOtherStrength && factor < kOtherStrength) break;
            dose.strength *= std::min(factor, kMostGrowth);
            fingerprint = take_fingerprint(dose, settings_.repeats);
        }
        if (!fingerprint) return false;
        known = dose.strength;
        fingerprints.push_back(std::move(*fingerprint));
    }
    base_.test.emplace(covariance, base_.slopes.directions, deviation_, std::move(fingerprints));
    const ScoreResult score = (*base_.test)(base_.observed);
    for (std::size_t k = 0; k < variants_.size(); ++k) base_.test->judge(k, k < planned_variants_ && visible(k, score));
    return true;
}

/// At the largest strength allowed.
bool Diagnoser::visible(std::size_t fingerprint, const ScoreResult& score) const {
    return score.visibility[static_cast<Eigen::Index>(fingerprint)] * most_of(fingerprint) >= kLeastVisible;
}

void Diagnoser::judge(Diagnosis& d) const {
    d.residuals = base_.space->residuals();
    d.test = global_test(*base_.test, (*base_.test)(base_.observed), NullRows(*base_.space, measured_), settings_.draws,
                         settings_.level, settings_.seed);
    find(d);
}

/// What the score says of every effect.
void Diagnoser::find(Diagnosis& d) const {
    d.score = (*base_.test)(base_.observed);
    d.looked_at = variants_;
    d.findings = findings(d.score, d.test.z_limit);
    d.cosines = cosines_of(d.findings);
    best_first(d.findings);
}

/// In the order of the candidates.
Eigen::MatrixXd Diagnoser::cosines_of(const std::vector<EffectFinding>& findings) const {
    const Eigen::MatrixXd all = base_.test->cosines(base_.observed.together);
    const auto count = static_cast<Eigen::Index>(problem_.effects.size());
    Eigen::MatrixXd cosines = Eigen::MatrixXd::Identity(count, count);
    for (const EffectFinding& a : findings)
        for (const EffectFinding& b : findings)
            cosines(static_cast<Eigen::Index>(a.effect), static_cast<Eigen::Index>(b.effect)) =
                all(static_cast<Eigen::Index>(fingerprint_of(a)), static_cast<Eigen::Index>(fingerprint_of(b)));
    return cosines;
}

void Diagnoser::show(EffectFinding& f, std::size_t fingerprint, const ScoreResult& score) const {
    const auto i = static_cast<Eigen::Index>(fingerprint);
    f.variant = variants_[fingerprint].variant;
    f.on = variants_[fingerprint].on;
    f.visible = visible(fingerprint, score);
    f.z = score.z[i];
    f.visibility = score.visibility[i];
}

std::size_t Diagnoser::fingerprint_of(const EffectFinding& f) const {
    const auto found = std::find_if(variants_.begin(), variants_.end(), [&](const EffectDose& v) {
        return v.effect == f.effect && v.variant == f.variant && v.on == f.on;
    });
    return static_cast<std::size_t>(found - variants_.begin());
}

/// Every effect by its best variant: what can be seen, then what explains most; of a plan the one that can be seen most clearly.
std::vector<EffectFinding> Diagnoser::findings(const ScoreResult& score, double z_limit) const {
    std::vector<EffectFinding> all;
    for (std::size_t e = 0; e < problem_.effects.size(); ++e) {
        EffectFinding f;
        f.effect = e;
        Eigen::Index at = -1;
        for (std::size_t k = 0; k < variants_.size(); ++k) {
            if (variants_[k].effect != e) continue;
            const auto i = static_cast<Eigen::Index>(k);
            const auto better = [&](Eigen::Index a, Eigen::Index b) {
                const double most_a = score.expected[a] * most_of(static_cast<std::size_t>(a)),
                             most_b = score.expected[b] * most_of(static_cast<std::size_t>(b));
                if (planning_) return most_a > most_b;
                const bool seen_a = visible(static_cast<std::size_t>(a), score),
                           seen_b = visible(static_cast<std::size_t>(b), score);
                return seen_a != seen_b ? seen_a : score.z[a] > score.z[b];
            };
            if (at < 0 || better(i, at)) at = i;
            f.beyond_chance = f.beyond_chance || (k < planned_variants_ && visible(k, score) && score.z[i] > z_limit);
        }
        if (at < 0) continue;
        show(f, static_cast<std::size_t>(at), score);
        all.push_back(f);
    }
    return all;
}

/// An effect of the base, where its fingerprint is.
Hypothesis Diagnoser::unfollowed(std::size_t fingerprint) const {
    Hypothesis h;
    h.fingerprint = fingerprint;
    h.parameters = base_.parameters;
    h.on = variants_[fingerprint].on;
    if (fingerprint >= planned_variants_) h.place_spread = place_spread_[fingerprint - planned_variants_];
    return h;
}

/// The best variant of every effect that comes near the best one; of what acts in a place the places that a closer look has found, too.
std::vector<Hypothesis> Diagnoser::finalists(const std::vector<EffectFinding>& findings) const {
    const ScoreResult score = (*base_.test)(base_.observed);
    std::vector<EffectFinding> visible;
    std::copy_if(findings.begin(), findings.end(), std::back_inserter(visible),
                 [](const EffectFinding& f) { return f.visible && f.z > 0.0; });
    std::stable_sort(visible.begin(), visible.end(),
                     [](const EffectFinding& a, const EffectFinding& b) { return a.z > b.z; });
    visible.resize(std::min(visible.size(), kCandidates * settings_.finalists));
    std::vector<Hypothesis> chosen;
    const auto near_best = [&](double z) { return z >= kFinalistShare * visible.front().z; };
    for (const EffectFinding& f : visible) {
        if (!near_best(f.z)) break;
        const std::size_t best = fingerprint_of(f);
        chosen.push_back(unfollowed(best));
        for (std::size_t k = planned_variants_; k < variants_.size(); ++k)
            if (variants_[k].effect == f.effect && k != best && near_best(score.z[static_cast<Eigen::Index>(k)]))
                chosen.push_back(unfollowed(k));
    }
    return chosen;
}

/// Tests the model at the parameters of a hypothesis without effect, and stays there if chance has more to say for it.
bool Diagnoser::move_base(Diagnosis& d, const Hypothesis& without) {
    if (without.q > d.score.q - kWorthMoving) return true;
    plan(of_base());
    Base before;
    std::swap(before, base_);
    base_.parameters = without.parameters;
    Diagnosis moved;
    moved.interrupted = d.interrupted;
    if (!build_space(before.space->residuals()) || !differentiate() || !take_fingerprints()) return false;
    judge(moved);
    const bool as_likely = moved.test.p == d.test.p;  // with so few draws both may be the least that can be told
    if (moved.test.p > d.test.p || (as_likely && moved.score.q < d.score.q))
        d = std::move(moved);
    else
        std::swap(before, base_);
    return true;
}

/// A model that is rejected gets what every effect gets, and more: its parameters are followed to where its own simulations leave least, from where they are, from
/// those that were given and from the best that a search all over the ranges finds.
bool Diagnoser::settle_base(Diagnosis& d) {
    plan(3 * of_finalist());
    std::vector<Hypothesis> starts{{}};
    if (!search_without(starts)) return false;
    if (!problem_.given.empty()) starts.emplace_back().parameters = given_parameters();
    std::vector<Pursuit> pursuits;
    for (Hypothesis& h : starts) {
        pursuits.push_back(begin(std::move(h)));
        if (!advance(pursuits.back())) return false;
    }
    double least = kInfinity;
    if (!pursue(pursuits, least)) return false;
    Hypothesis without;
    for (Pursuit& p : pursuits) {
        Hypothesis h = arrived(std::move(p));
        if (h.q < without.q) without = std::move(h);
    }
    return race_without(without) && move_base(d, without);
}

/// An effect takes the parameters along when it is followed, perhaps out of a valley in which the model without it was stuck: the effect would get the name for what
/// parameters alone explain. From where it has arrived the model is followed without it.
bool Diagnoser::return_without(Diagnosis& d, const Hypothesis& with) {
    plan(of_base() + of_finalist());
    Base before;
    std::swap(before, base_);
    base_.parameters = with.parameters;
    Hypothesis without;
    if (!build_space(before.space->residuals()) || !differentiate() || !follow(without)) return false;
    std::swap(before, base_);
    return race_without(without) && move_base(d, without);
}

/// Where nothing on the slope that was followed could have produced the measurements: a calibration makes up for what is missing, with parameters at which the missing effect may be out of sight: a rolling resistance that grows with size
/// does nothing where none is left; or it has settled in the wrong valley. The same look again from the parameters that were given before the calibration.
bool Diagnoser::follow_from_given(Diagnosis& d, std::vector<Hypothesis>& followed) {
    plan(of_base() + (1 + settings_.finalists) * of_finalist());
    Base calibrated, given;
    std::swap(calibrated, base_);
    base_.parameters = given_parameters();
    Hypothesis without;
    if (!build_space(calibrated.space->residuals()) || !differentiate() || !follow(without)) return false;
    std::swap(given, base_);
    std::swap(calibrated, base_);
    if (!race_without(without) || !move_base(d, without)) return false;
    if (!rejected(d)) return true;
    std::swap(given, base_);
    if (!take_fingerprints()) return false;
    auto chosen = strong_finalists();
    if (!chosen) return false;
    if (!follow_best(std::move(*chosen), followed)) return false;
    std::swap(given, base_);
    return decide_close_race(followed);
}

Diagnosis Diagnoser::run(Of of) {
    const bool measured = of != Of::Plan;
    planning_ = !measured;
    Diagnosis d;
    d.interrupted = true;
    if (!build_space() || !differentiate() || (of == Of::Calibrated && !recentre()) || !take_fingerprints()) return d;
    judge(d);
    if (measured && rejected(d) && !settle_base(d)) return d;
    std::vector<Hypothesis> followed;
    bool asked_given = problem_.given.empty(), heard_others = false;
    for (int round = 0; measured && rejected(d); ++round) {
        if (!look_closer(d) || !follow_best(finalists(d.findings), followed) || !decide_close_race(followed)) return d;
        conclude(d, followed);
        if (!heard_others && d.weight_none < kLikelyChance) {
            heard_others = true;
            if (!hear_others(d, followed)) return d;
            conclude(d, followed);
        }
        if (!explained(d) && !asked_given) {
            asked_given = true;
            if (!follow_from_given(d, followed)) return d;
            if (!rejected(d)) break;
            conclude(d, followed);
        }
        if (d.answer.empty()) break;
        const Eigen::VectorXd before = base_.parameters;
        if (!return_without(d, followed.front())) return d;
        if (base_.parameters == before || (round == kReturns && rejected(d))) {
            conclude(d, followed);  // perhaps less is left without effect than was known
            break;
        }
    }
    if ((of == Of::Plan || (of == Of::Calibrated && !rejected(d))) && !find_strengths_seen(d)) return d;
    d.parameters.assign(base_.parameters.data(), base_.parameters.data() + base_.parameters.size());
    d.simulated_blocks = simulated_;
    d.interrupted = false;
    return d;
}

Diagnosis diagnose(const DiagnosisProblem& problem, const ObservationTable& measured, const DiagnosisSettings& settings,
                   const DiagnosisSimulation& simulate, const std::function<void(const DiagnosisProgress&)>& progress) {
    const auto one = [&](const DiagnosisProblem& of, const DiagnosisSimulation& with) {
        return Diagnoser(of, measured, settings, with, progress).run(Diagnoser::Of::Followed);
    };
    Diagnosis d = Diagnoser(problem, measured, settings, simulate, progress).run(Diagnoser::Of::Calibrated);
    if (!d.interrupted && d.verdict == Verdict::Unknown)
        d.interrupted = !explain_with_two(problem, simulate, settings, one, d);
    return d;
}

Diagnosis plan_test(const DiagnosisProblem& problem, const ObservationTable& planned, const DiagnosisSettings& settings,
                    const DiagnosisSimulation& simulate,
                    const std::function<void(const DiagnosisProgress&)>& progress) {
    return Diagnoser(problem, planned, settings, simulate, progress).run(Diagnoser::Of::Plan);
}

}  // namespace scree
