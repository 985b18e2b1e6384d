// SPDX-License-Identifier: GPL-3.0-or-later
// Following an effect, or none, to the parameters and strength that leave least.
#include "inference/diagnoser.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

constexpr const char* kFollowing = "finalists";
/// Change of the misfit, minus twice a log-likelihood, that is noise, at least and as a share of the misfit [-]; and how many surveys in a row without a larger one are the end [-].
constexpr double kSettled = 3.0, kSettledShare = 0.04;
constexpr int kWithoutBetter = 2, kWithoutBetterPlace = 3;
/// On the way there surveys have this share of their simulations [-], and there may be so many of them, so many in a row without a lower misfit.
constexpr std::int64_t kShareOnTheWay = 6;
constexpr int kSurveysOnTheWay = 15, kWithoutBetterOnTheWay = 4;
/// About so many surveys a pursuit takes on the way, and as many at the place [-]: for the time that is left.
constexpr int kUsualSurveys = 4;
/// Of what is measured and seen in the residual space of the model, the share that a hypothesis must speak of [-].
constexpr double kComparable = 0.7;
/// Variance of residuals in the space of few simulations, over that of the mean of these alone [-].
constexpr double kSpaceNoise = 2.0;
/// Steps so many times as long as those that the survey asks for are wide [-].
constexpr double kWideStep = 2.0;
/// How far beyond a survey its derivatives are trusted [steps].
constexpr double kTrust = 4.0;
/// Sweeps over the coordinates of a quadratic problem [-].
constexpr int kSweeps = 300;
/// Step of the strength: z that it makes, share of the strength where that was scanned for, and share of the largest strength at most [-].
constexpr double kStrengthStep = 1.5, kStrengthShare = 0.2, kMostStrengthStep = 0.25;
/// Steps of a place: of the middle at most and at least, of the length and of the path; of the logarithm of the length [-].
constexpr double kMostMiddleStep = 0.3, kLeastMiddleStep = 0.004, kMostLengthStep = 0.5, kLeastLengthStep = 0.1;
/// Finalists whose weight is that of the best one, or what makes up for so much more left, are surveyed once more with it, by so many times the repeats [-].
constexpr double kCloseRace = 10.0;
constexpr std::int64_t kRaceRepeats = 2;
/// Surveys of it at most [-]; and the p of what the best of them leaves, as a share of the level at which it is an explanation, below which there is nothing to decide [-].
constexpr int kRaceRounds = 2;
constexpr double kHopeless = 0.25;
/// Samples of a simulation that its goodness of fit is judged by [-].
constexpr std::int64_t kFitDraws = 299;
/// In how many places of one way of an effect more than one survey is made [-].
constexpr std::ptrdiff_t kPlacesOfOne = 2;

double settled_within(double misfit) {
    return std::max(kSettled, kSettledShare * misfit);
}

}  // namespace

Eigen::MatrixXd design_of(std::size_t factors) {
    const auto pairs = static_cast<Eigen::Index>(design_size(factors)), columns = static_cast<Eigen::Index>(factors);
    Eigen::MatrixXd signs(2 * pairs, columns);
    for (Eigen::Index i = 0; i < pairs; ++i)
        for (Eigen::Index k = 0; k < columns; ++k) {
            const bool minus = std::popcount(static_cast<std::size_t>(i) & static_cast<std::size_t>(k)) % 2 == 1;
            signs(2 * i, k) = minus ? -1.0 : 1.0;
            signs(2 * i + 1, k) = -signs(2 * i, k);
        }
    return signs;
}

void append(ObservationTable& to, const ObservationTable& rows) {
    if (to.columns.empty()) {
        to = rows;
        return;
    }
    to.block.insert(to.block.end(), rows.block.begin(), rows.block.end());
    for (std::size_t k = 0; k < to.values.size(); ++k)
        to.values[k].insert(to.values[k].end(), rows.values[k].begin(), rows.values[k].end());
}

Slopes slopes_of(Eigen::MatrixXd moved, Eigen::MatrixXd means, double rows_over) {
    const Eigen::VectorXd centre = moved.colwise().mean(), mean = means.colwise().mean();
    moved.rowwise() -= centre.transpose();
    means.rowwise() -= mean.transpose();
    const Eigen::MatrixXd squares = moved.transpose() * moved;
    Slopes s;
    s.directions = squares.ldlt().solve(moved.transpose() * means).transpose();
    s.noise = static_cast<double>(means.cols()) * rows_over * squares.diagonal().cwiseMax(1e-12).cwiseInverse();
    s.at_place = mean - s.directions * centre;
    s.centre = centre;
    s.centre_noise = rows_over / static_cast<double>(means.rows());
    s.spread = rows_over * squares.ldlt().solve(Eigen::MatrixXd::Identity(squares.rows(), squares.cols()));
    return s;
}

/// Simulations all around `at`, a step away in every direction; measured and simulated rows are seen in the residual space of all of them. More directions
/// share the rows of a survey of parameters and strength. What counts as measured may be simulated, too, with an effect that a model without it is to make up for.
bool Diagnoser::survey(Survey& s, std::size_t fingerprint, std::int64_t repeats, const ObservationTable& measured,
                       const char* stage) {
    const Eigen::Index count = base_.parameters.size();
    const auto unknowns = static_cast<std::size_t>(s.at.size()),
               usual = std::min(unknowns, static_cast<std::size_t>(count) + 1);
    repeats = std::max<std::int64_t>(
        repeats * static_cast<std::int64_t>(design_size(usual)) / static_cast<std::int64_t>(design_size(unknowns)), 1);
    const Eigen::MatrixXd signs = design_of(static_cast<std::size_t>(s.at.size()));
    Eigen::MatrixXd moved(signs.rows(), s.at.size());
    ObservationTable all;
    std::vector<std::size_t> first;
    for (Eigen::Index run = 0; run < signs.rows(); ++run) {
        const Eigen::VectorXd at = within(s.at + signs.row(run).transpose().cwiseProduct(s.step), fingerprint);
        moved.row(run) = at - s.at;
        auto table = simulate(stage, at.head(count), dose_of(fingerprint, at), repeats);
        if (!table) return false;
        first.push_back(all.rows());
        append(all, *table);
    }
    first.push_back(all.rows());
    const ResidualSpace space(std::move(all), measured, problem_.blocks, settings_.residuals, base_.space->residuals());
    s.rows = space.of_reference();
    s.block = space.reference().block;
    Eigen::MatrixXd means(signs.rows(), s.rows.cols());
    const Eigen::RowVectorXd mean = mean_residual(s.rows).mean;
    for (Eigen::Index run = 0; run < signs.rows(); ++run) {  // chance is what differs within a run
        const auto from = static_cast<Eigen::Index>(first[static_cast<std::size_t>(run)]),
                   to = static_cast<Eigen::Index>(first[static_cast<std::size_t>(run) + 1]);
        auto rows = s.rows.middleRows(from, to - from);
        means.row(run) = mean_residual(rows).mean;
        rows.rowwise() += mean - means.row(run);
    }
    s.covariance = row_covariance(s.rows, space.least_variance());
    s.observed = mean_residual(space.of(measured));
    s.slopes = slopes_of(std::move(moved), std::move(means),
                         s.observed.together.diagonal().maxCoeff() * static_cast<double>(signs.rows()) /
                             telling(static_cast<std::size_t>(s.rows.rows())));
    s.left = s.observed.mean - s.slopes.at_place;
    return true;
}

/// Parameters within their ranges, the strength within those allowed.
Eigen::VectorXd Diagnoser::within(Eigen::VectorXd at, std::size_t fingerprint) const {
    const Eigen::Index count = base_.parameters.size();
    at.head(count) = within_ranges(at.head(count));
    if (fingerprint != kNoEffect) at[count] = std::clamp(at[count], 0.0, most_of(fingerprint));
    if (at.size() > count + 1) {
        const Stretch& path = path_of(fingerprint);
        at[count + 2] = std::clamp(at[count + 2], std::log(kShortestShare * path.length()),
                                   std::log(kLongestShare * path.length()));
        const double half = 0.5 * std::exp(at[count + 2]);
        at[count + 1] = std::clamp(at[count + 1], path.from + half, path.to - half);
    }
    return at;
}

const Stretch& Diagnoser::path_of(std::size_t fingerprint) const {
    const EffectDose& v = variants_[fingerprint];
    return *problem_.effects[v.effect].variants[v.variant].path;
}

Eigen::VectorXd Diagnoser::unknowns_of(const Hypothesis& h) const {
    Eigen::VectorXd at(count_of(h.fingerprint));
    const Eigen::Index count = h.parameters.size();
    at.head(count) = h.parameters;
    if (at.size() > count) at[count] = h.strength;
    if (at.size() > count + 1) at.tail(2) << h.on->middle(), std::log(h.on->length());
    return at;
}

double Diagnoser::most_of(std::size_t fingerprint) const {
    const EffectDose& v = variants_[fingerprint];
    return problem_.effects[v.effect].variants[v.variant].most;
}

std::vector<EffectDose> Diagnoser::dose_of(std::size_t fingerprint, const Eigen::VectorXd& at) const {
    if (fingerprint == kNoEffect) return {};
    const Eigen::Index count = base_.parameters.size();
    EffectDose dose = variants_[fingerprint];
    dose.strength = at[count];
    if (dose.on) {
        const double half = 0.5 * std::exp(at[count + 2]);
        dose.on = Stretch{at[count + 1] - half, at[count + 1] + half};
    }
    return {dose};
}

/// Low and high of a change of parameters and strength.
struct Diagnoser::Box {
    Eigen::VectorXd low, high;
};

/// Q of places around a survey, quadratic with its derivatives.
class Diagnoser::LocalMisfit {
public:
    LocalMisfit(const Survey& s, const Eigen::VectorXd& prior) : prior_(prior) {
        const Eigen::LLT<Eigen::MatrixXd> factor(mean_covariance(s.covariance, s.observed.together));
        const Eigen::MatrixXd WD = factor.solve(s.slopes.directions);
        information_ = s.slopes.directions.transpose() * WD;
        information_.diagonal() += prior;
        pull_ = WD.transpose() * s.left;
        here_ = s.left.dot(factor.solve(s.left));
    }

    double at(const Eigen::VectorXd& by) const { return here_ - 2.0 * pull_.dot(by) + by.dot(information_ * by); }
    /// Inverse covariance of all of them.
    const Eigen::MatrixXd& information() const { return information_; }
    /// Standard deviation of each, all others being free.
    Eigen::VectorXd deviations() const { return information_.inverse().diagonal().cwiseMax(0.0).cwiseSqrt(); }
    /// The change that leaves least.
    Eigen::VectorXd best(const Box& box) const { return minimum(information_, pull_, box); }
    /// The same, drawn to where it is, and as the prior has it to where the start is.
    Eigen::VectorXd best(const Box& box, const Eigen::VectorXd& held, const Eigen::VectorXd& to_start) const {
        Eigen::MatrixXd curvature = information_;
        curvature.diagonal() += held;
        return minimum(curvature, pull_ + prior_.cwiseProduct(to_start), box);
    }

private:
    /// Of x'Ax / 2 - b'x, one coordinate after the other.
    static Eigen::VectorXd minimum(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Box& box) {
        Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
        for (int sweep = 0; sweep < kSweeps; ++sweep)
            for (Eigen::Index k = 0; k < x.size(); ++k)
                x[k] = std::clamp(x[k] + (b[k] - A.row(k).dot(x)) / A(k, k), box.low[k], box.high[k]);
        return x;
    }

    Eigen::VectorXd prior_;
    Eigen::MatrixXd information_;
    Eigen::VectorXd pull_;
    double here_;
};

/// So far from a survey to both sides, within the ranges.
Diagnoser::Box Diagnoser::around(const Survey& s, std::size_t fingerprint, const Eigen::VectorXd& reach) const {
    Box box{s.at - reach, s.at + reach};
    const Eigen::Index count = base_.parameters.size();
    for (Eigen::VectorXd* corner : {&box.low, &box.high}) {
        const double middle = s.at.size() > count + 1 ? (*corner)[count + 1] : kNaN;
        *corner = within(*corner, fingerprint) - s.at;
        if (std::isnan(middle)) continue;
        const Stretch& path = path_of(fingerprint);  // whatever the length will be
        (*corner)[count + 1] = std::clamp(middle, path.from, path.to) - s.at[count + 1];
    }
    return box;
}

/// Inverse variances before the test, those of ranges; the strength, if there is one, may be any.
Eigen::VectorXd Diagnoser::prior_of(std::size_t fingerprint) const {
    Eigen::VectorXd prior = Eigen::VectorXd::Zero(count_of(fingerprint));
    prior.head(deviation_.size()) = deviation_.array().square().inverse();
    if (prior.size() > deviation_.size() + 1) {
        const double length = path_of(fingerprint).length(), ratio = std::log(kLongestShare / kShortestShare);
        prior.tail(2) << 12.0 / (length * length), 12.0 / (ratio * ratio);
    }
    return prior;
}

/// Nothing left where nothing can be compared is no explanation: a simulation in which no block passes a screen says nothing of speeds there.
bool Diagnoser::comparable(const ResidualMean& measured, const ResidualMean& with) {
    return measured.together.trace() >= kComparable * with.together.trace();
}

/// The same, asked of simulated rows. Where rows are blocks they must speak of as much as the measured ones; of a pool that tells only who passed, of everything a little.
bool Diagnoser::simulates_enough(const ResidualMean& simulated, std::size_t rows, const ResidualMean& observed) const {
    if (only_who_passed_)
        return (simulated.together.diagonal().array() >= static_cast<double>(ResidualSpace::kLeastRows) ||
                observed.together.diagonal().array() == 0.0)
            .all();
    return simulated.together.trace() / static_cast<double>(rows) >=
           kComparable * observed.together.trace() / static_cast<double>(measured_.rows());
}

/// What a hypothesis leaves at the best place among the simulations of a survey: what derivatives promise farther away often does not come true.
void Diagnoser::judge(Hypothesis& h, const Survey& s) const {
    const LocalMisfit misfit(s, prior_of(h.fingerprint));
    const Eigen::VectorXd by = misfit.best(around(s, h.fingerprint, s.step)), to = within(s.at + by, h.fingerprint);
    const Eigen::Index count = deviation_.size();
    h.q = comparable(s.observed, base_.observed) ? misfit.at(by) : kInfinity;
    h.q_deviation = std::isfinite(h.q) ? 2.0 * std::sqrt(kSpaceNoise * h.q * s.slopes.variance_at(by)) : 0.0;
    h.parameters = to.head(count);
    h.step = s.step;
    const Eigen::VectorXd deviations = misfit.deviations();
    h.parameter_deviation.assign(deviations.data(), deviations.data() + count);
    if (h.fingerprint == kNoEffect) return;
    h.strength = std::max(to[count], kLeastStrength * most_of(h.fingerprint));
    h.strength_deviation = deviations[count];
    h.on = dose_of(h.fingerprint, to).front().on;
    if (!h.on) return;
    h.middle_deviation = deviations[count + 1];
    h.middle_deviation = std::hypot(h.middle_deviation, h.place_spread);  // other places may explain as much
    Eigen::MatrixXd information = misfit.information();
    information(count, count) += 12.0 / (most_of(h.fingerprint) * most_of(h.fingerprint));  // of those allowed
    h.log_room = log_volume(information, 3);
}

/// Steps of the next survey: of parameters and place such as would be told, of the strength as before.
Eigen::VectorXd Diagnoser::next_steps(const Survey& s, std::size_t fingerprint) const {
    const Eigen::Index count = deviation_.size();
    Eigen::VectorXd step = s.step;
    step.head(count) = telling_steps(s.slopes, s.covariance, s.observed.together);
    if (step.size() > count + 1) {
        const Eigen::MatrixXd J = s.slopes.directions.rightCols(2);
        const Eigen::LLT<Eigen::MatrixXd> factor(mean_covariance(s.covariance, s.observed.together));
        step.tail(2) =
            kTellingStep / J.cwiseProduct(factor.solve(J)).colwise().sum().transpose().array().max(1e-24).sqrt();
    }
    return limited(std::move(step), s.at, fingerprint);
}

/// Neither longer than derivatives hold nor shorter than makes sense.
Eigen::VectorXd Diagnoser::limited(Eigen::VectorXd step, const Eigen::VectorXd& at, std::size_t fingerprint) const {
    const Eigen::Index count = deviation_.size();
    step.head(count) =
        step.head(count).cwiseMin(Eigen::Map<const Eigen::VectorXd>(problem_.step.data(), count)).cwiseMax(kLeastStep);
    if (step.size() > count) {
        const double most = most_of(fingerprint);
        step[count] = std::clamp(step[count], kLeastStrength * most, kMostStrengthStep * most);
    }
    if (step.size() > count + 1) {
        const double length = std::exp(at[count + 2]), least = kLeastMiddleStep * path_of(fingerprint).length();
        step[count + 1] = std::clamp(step[count + 1], least, std::max(least, kMostMiddleStep * length));
        step[count + 2] = std::clamp(step[count + 2], kLeastLengthStep, kMostLengthStep);
    }
    return step;
}

/// From the base, whose derivatives are known, or from where the steps are: no way is left there to be looked for with few simulations.
Diagnoser::Pursuit Diagnoser::begin(Hypothesis h) const {
    const bool any = h.fingerprint != kNoEffect;
    const Eigen::Index count = base_.parameters.size(), size = count_of(h.fingerprint);
    Pursuit p;
    p.trust = kTrust;
    if (h.parameters.size() == 0) h.parameters = base_.parameters;
    p.start = unknowns_of(h);
    Survey& s = p.here;
    s.at = p.start;
    if (h.step.size() > 0) {
        s.step = h.step;
        p.on_the_way = false;
        p.best = std::move(h);
        p.best.q = kInfinity;
        return p;
    }
    s.step = base_.step;
    s.slopes = base_.slopes;
    s.covariance = row_covariance(*base_.space);
    s.observed = base_.observed;
    s.left = base_.observed.mean;
    if (any) {
        const Fingerprint& f = base_.test->fingerprints()[h.fingerprint];
        const double seen = (*base_.test)(base_.observed).visibility[static_cast<Eigen::Index>(h.fingerprint)],
                     most = most_of(h.fingerprint);
        s.step.conservativeResize(size);
        s.step[count] = std::clamp(std::max(kStrengthStep / std::max(seen, 1e-9), kStrengthShare * h.strength),
                                   kLeastStrength * most, kMostStrengthStep * most);
        s.slopes.directions.conservativeResize(Eigen::NoChange, size);
        s.slopes.directions.rightCols(size - count).setZero();
        s.slopes.directions.col(count) = f.change;
        if (h.on) s.step.tail(2) << kMostMiddleStep * h.on->length(), kMostLengthStep;
    }
    const bool elsewhere = h.parameters != base_.parameters, far = h.strength > 0.0 || elsewhere;
    if (elsewhere) s.step.head(count) = Eigen::Map<const Eigen::VectorXd>(problem_.step.data(), count);
    p.best = std::move(h);
    p.best.q = kInfinity;
    if (!far) go(p);
    return p;
}

std::int64_t Diagnoser::repeats_on_the_way() const {
    return std::max<std::int64_t>(settings_.repeats / kShareOnTheWay, 1);
}

/// How far derivatives are trusted: some steps, and farther where a change of one parameter is undone by others.
Eigen::VectorXd Diagnoser::reach_of(const Pursuit& p, const LocalMisfit& misfit) const {
    return p.trust * p.here.step.cwiseMax(misfit.deviations());
}

/// To where the last survey promises least; what its simulations hardly tell apart stays where it is.
void Diagnoser::go(Pursuit& p) const {
    Survey& s = p.here;
    const std::size_t fingerprint = p.best.fingerprint;
    const LocalMisfit misfit(s, prior_of(fingerprint));
    const Eigen::VectorXd reach = reach_of(p, misfit);
    s.at += misfit.best(around(s, fingerprint, reach), reach.array().square().inverse(), p.start - s.at);
    s.at = within(s.at, fingerprint);
}

/// Gauss-Newton on parameters, strength and place. Simulations are noisy, so that no two of them are compared on the way: every step comes from a survey of
/// simulations all around, in the residual space of these, and is limited to where they tell something; one that leaves more is taken back and halved. Few
/// simulations show the way, more of them the place.
bool Diagnoser::advance(Pursuit& p) {
    const std::size_t fingerprint = p.best.fingerprint;
    if (p.of_best.at.size() > 0) go(p);
    if (!survey(p.here, fingerprint, p.on_the_way ? repeats_on_the_way() : half_repeats(), measured_, kFollowing))
        return false;
    const LocalMisfit misfit(p.here, prior_of(fingerprint));
    p.left = misfit.at(Eigen::VectorXd::Zero(p.here.at.size()));
    p.promised =
        misfit.at(misfit.best(around(p.here, fingerprint, Eigen::VectorXd::Constant(p.here.at.size(), kInfinity))));
    Hypothesis here = p.best;
    judge(here, p.here);
    p.without_better = here.q < p.best.q - settled_within(here.q) ? 0 : p.without_better + 1;
    if (here.q < p.best.q) {
        p.settled =
            p.left - misfit.at(misfit.best(around(p.here, fingerprint, reach_of(p, misfit)))) < settled_within(p.left);
        const Eigen::VectorXd step = next_steps(p.here, fingerprint);
        const bool wide = (p.here.step.array() > kWideStep * step.array()).any();
        p.here.step = here.step = step;
        p.best = std::move(here);
        p.of_best = p.here;
        if (wide && p.on_the_way) {  // seen in so wide a space little is left anywhere: to be seen again
            p.best.q = kInfinity;
            p.settled = false;
        }
    } else if (p.of_best.at.size() == 0) {  // nothing to begin with
        p.settled = true;
        return true;
    } else {  // too far
        p.here = p.of_best;
        p.trust *= 0.5;
    }
    const int patience = p.on_the_way ? kWithoutBetterOnTheWay : p.best.on ? kWithoutBetterPlace : kWithoutBetter;
    if (++p.surveys == (p.on_the_way ? kSurveysOnTheWay : settings_.rounds) || p.without_better == patience)
        p.settled = true;
    if (p.settled && p.on_the_way) {
        p.on_the_way = p.settled = false;
        p.surveys = p.without_better = 0;
        p.trust = kTrust;
        p.best.q = kInfinity;
        p.here = p.of_best;
    }
    p.here.rows.resize(0, 0);  // what is judged later are those of the best
    return true;
}

Hypothesis Diagnoser::arrived(Pursuit p) const {
    if (std::isfinite(p.best.q)) p.best.p = goodness_of_fit(p.of_best, p.best.fingerprint, p.best.q);
    return std::move(p.best);
}

bool Diagnoser::follow(Hypothesis& h) {
    Pursuit p = begin(std::move(h));
    while (!p.settled)
        if (!advance(p)) return false;
    h = arrived(std::move(p));
    return true;
}

/// Cannot come near the least that is left by another, even if its derivatives promise as much too little as they promise to gain.
bool Diagnoser::hopeless(const Pursuit& p, double least) const {
    return p.promised - std::max(p.left - p.promised - kFarBehind, 0.0) > least + kFarBehind;
}

/// One survey of the one that promises most at a time, until all have settled or are hopeless.
bool Diagnoser::pursue(std::vector<Pursuit>& pursuits, double& least) {
    for (;;) {
        Pursuit* next = nullptr;
        std::size_t surveys = 0;
        for (Pursuit& p : pursuits) {
            if (p.settled || hopeless(p, least)) continue;
            surveys += static_cast<std::size_t>(std::max((p.on_the_way ? 2 : 1) * kUsualSurveys - p.surveys, 1));
            if (!next || p.promised < next->promised) next = &p;
        }
        if (!next) return true;
        planned_ = done_ + surveys * of_survey();
        if (!advance(*next)) return false;
        if (!next->on_the_way) least = std::min(least, next->best.q);
    }
}

double Diagnoser::least_of(const std::vector<Hypothesis>& followed) {
    double least = kInfinity;
    for (const Hypothesis& h : followed) least = std::min(least, h.q);
    return least;
}

/// Every one by a survey; those that promise most go on, a few places of each way to act.
bool Diagnoser::survey_all(std::vector<Hypothesis> chosen, std::vector<Pursuit>& pursuits) {
    plan(chosen.size() * of_survey());
    std::vector<Pursuit> all;
    for (Hypothesis& h : chosen) {
        all.push_back(begin(std::move(h)));
        if (!advance(all.back())) return false;
        if (all.back().of_best.at.size() == 0) all.pop_back();
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Pursuit& a, const Pursuit& b) { return a.promised < b.promised; });
    for (Pursuit& p : all)
        if (std::count_if(pursuits.begin(), pursuits.end(),
                          [&](const Pursuit& other) { return same_way(other.best, p.best); }) < kPlacesOfOne)
            pursuits.push_back(std::move(p));
    return true;
}

/// From where they are and from where a search all over the ranges leads. Adds them to those that have been followed.
bool Diagnoser::follow_best(std::vector<Hypothesis> chosen, std::vector<Hypothesis>& followed) {
    std::vector<Pursuit> pursuits;
    if (std::vector<Hypothesis> found; search_widely(chosen, nullptr, found))
        chosen.insert(chosen.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
    else
        return false;
    double least = least_of(followed);
    if (!survey_all(std::move(chosen), pursuits) || !pursue(pursuits, least) || !look_again(pursuits, least))
        return false;
    for (Pursuit& p : pursuits) followed.push_back(arrived(std::move(p)));
    return true;
}

/// At parameters that make up for what is missing its own fingerprint may point the other way: before there is a name, what has not been looked for yet is, all over the ranges, and what comes
/// near is followed from there.
bool Diagnoser::hear_others(const Diagnosis& d, std::vector<Hypothesis>& followed) {
    std::vector<Hypothesis> others, found;
    for (const EffectFinding& f : d.findings)
        if (f.visible && std::none_of(followed.begin(), followed.end(),
                                      [&](const Hypothesis& h) { return variants_[h.fingerprint].effect == f.effect; }))
            others.push_back(unfollowed(fingerprint_of(f)));
    const auto best = std::min_element(followed.begin(), followed.end(),
                                       [](const Hypothesis& a, const Hypothesis& b) { return a.q < b.q; });
    if (!search_widely(others, best == followed.end() ? nullptr : &*best, found)) return false;
    if (found.empty()) return true;
    std::vector<Pursuit> pursuits;
    double least = least_of(followed);
    if (!survey_all(std::move(found), pursuits) || !pursue(pursuits, least)) return false;
    for (Pursuit& p : pursuits) followed.push_back(arrived(std::move(p)));
    return decide_close_race(followed);
}

/// Again, with more simulations.
bool Diagnoser::race(Hypothesis& h) {
    h.raced = true;
    h.q = kInfinity;
    bool more = true;
    for (int round = 0; round < kRaceRounds && more; ++round) {
        Survey s;
        s.at = unknowns_of(h);
        s.step = h.step;
        if (!survey(s, h.fingerprint, kRaceRepeats * settings_.repeats, measured_, kFollowing)) return false;
        Hypothesis here = h;
        judge(here, s);
        if (!(here.q < h.q)) break;
        here.p = goodness_of_fit(s, h.fingerprint, here.q);
        h = std::move(here);
        const LocalMisfit misfit(s, prior_of(h.fingerprint));
        more = misfit.at(misfit.best(around(s, h.fingerprint, kTrust * s.step))) < h.q - settled_within(h.q);
    }
    return true;
}

/// The model without effects is weighed against effects by surveys like theirs: where it leaves less than it is known to, it is raced, too.
bool Diagnoser::race_without(Hypothesis without) {
    if (!(without.q < without_.q)) return true;
    if (!race(without)) return false;
    if (without.q < without_.q) without_ = std::move(without);
    return true;
}

/// Half the repeats find the way, but their noise must not decide between effects that weigh nearly the same, nor whether any of them is an explanation. Of many surveys with few
/// simulations the least is a lucky one: who leads by it is asked first, though nobody is near, and then whoever is close to what that has come to.
bool Diagnoser::decide_close_race(std::vector<Hypothesis>& followed) {
    const auto runs = [](const Hypothesis& h) { return std::isfinite(h.q); };
    for (bool first = true;; first = false) {
        double most = -kInfinity, best_p = 0.0;
        for (const Hypothesis& h : followed) {
            if (!runs(h)) continue;
            most = std::max(most, log_weight(h));
            best_p = std::max(best_p, h.p);
        }
        std::size_t close = 0, waiting = 0;
        Hypothesis* next = nullptr;
        for (Hypothesis& h : followed) {
            if (!runs(h) || log_weight(h) < most - 0.5 * kCloseRace) continue;
            ++close;
            if (h.raced) continue;
            ++waiting;
            if (!next || log_weight(h) > log_weight(*next)) next = &h;
        }
        const bool leads = next && log_weight(*next) == most;
        if (!next || (close < 2 && !leads) || (first && best_p <= kHopeless * settings_.rejected)) return true;
        planned_ = done_ + waiting * of_survey();
        if (!race(*next)) return false;
    }
}

/// How often as many rows of the simulations themselves leave as much, with parameters, strength and place free for them, too.
double Diagnoser::goodness_of_fit(const Survey& survey, std::size_t fingerprint, double left) const {
    const NullRows null(survey.rows, survey.block, base_.space->residuals(), measured_);
    const ScoreTest own(survey.covariance, survey.slopes.directions,
                        prior_of(fingerprint).array().inverse().sqrt().matrix(), {});
    std::int64_t at_least = 0;
    for (std::int64_t k = 0; k < kFitDraws; ++k)
        if (own(mean_residual(null.draw(settings_.seed, static_cast<std::uint64_t>(k)))).q >= left) ++at_least;
    return static_cast<double>(at_least + 1) / static_cast<double>(kFitDraws + 1);
}

}  // namespace scree
