// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/second_effect.hpp"

#include <algorithm>
#include <optional>

namespace scree {

namespace {

/// A first effect whose strength falls below this share of the largest, once the second is there, was none [-].
constexpr double kLeastStrength = 0.02;
/// Nor was one that is not so many standard deviations from zero then [-].
constexpr double kSure = 2.0;
/// What a second effect explains besides, as a share of what the best one explains alone, below which it may take up what the formula of the catalogue leaves of the one that acts:
/// fitted best, v leaves 2 % of the square of v^1.5 where speeds are spread evenly from 0 on, and 6 % of that of v^2 [-].
constexpr double kFormulaShare = 0.1;
/// Step of its derivative, of the largest strength [-].
constexpr double kStep = 0.08;

/// The model with an effect in it, whose strength, as a share of the largest, is the last parameter; and what may be missing beside it.
DiagnosisProblem with_effect(DiagnosisProblem problem, const EffectFinding& f) {
    problem.calibrated = f.parameters;
    problem.calibrated.push_back(f.strength / problem.effects[f.effect].variants[f.variant].most);
    problem.given.clear();
    problem.low.push_back(0.0);
    problem.high.push_back(1.0);
    problem.step.push_back(kStep);
    const bool second_beside = problem.effects[f.effect].second_beside;
    for (std::size_t k = 0; k < problem.effects.size(); ++k)
        if (k == f.effect || !second_beside) problem.effects[k].variants.clear();
    return problem;
}

DiagnosisSimulation with_effect(const DiagnosisSimulation& simulate, const EffectFinding& f, double most) {
    return [&simulate, dose = EffectDose{f.effect, f.variant, 0.0, f.on}, most](DiagnosisTask task) {
        EffectDose first = dose;
        first.strength = most * task.parameters.back();
        task.parameters.pop_back();
        task.effects.insert(task.effects.begin(), first);
        return simulate(task);
    };
}

/// Of the finalists the one whose simulations leave least; none: not a finalist.
EffectFinding leaving_least(const std::vector<EffectFinding>& findings) {
    EffectFinding best;
    for (const EffectFinding& f : findings)
        if (f.finalist && (!best.finalist || f.misfit < best.misfit)) best = f;
    return best;
}

/// Still there with the other one beside it.
bool acts(double share, double deviation) {
    return share >= kLeastStrength && share >= kSure * deviation;
}

/// The first effect as the diagnosis beside it leaves it: its share of the largest strength is the last parameter there.
EffectFinding as_left(EffectFinding first, double most, std::vector<double> parameters, double deviation) {
    first.strength = most * parameters.back();
    first.strength_deviation = most * deviation;
    parameters.pop_back();
    first.parameters = std::move(parameters);
    return first;
}

/// The first effect suffices alone where nothing is missing beside it.
bool answer_with_one(const EffectFinding& first, double most, const Diagnosis& beside,
                     const DiagnosisSettings& settings, Diagnosis& d) {
    const double deviation = beside.score.shift_deviation[beside.score.shift_deviation.size() - 1];
    if (beside.verdict != Verdict::None || first.weight < settings.named || !acts(beside.parameters.back(), deviation))
        return false;
    d.answer = {as_left(first, most, beside.parameters, deviation)};
    d.answer.front().p = beside.test.p;
    d.answer.front().misfit = beside.score.q;
    return true;
}

/// Of what was found beside another, whose share of its largest strength is the last parameter.
EffectFinding without_share(EffectFinding f) {
    f.parameters.pop_back();
    return f;
}

/// What was found beside the first effect, or came nearest there and leaves less than that alone; else not a finalist.
EffectFinding second_beside(const EffectFinding& first, const Diagnosis& beside) {
    EffectFinding second;
    if (beside.answer.size() == 1)
        second = beside.answer.front();
    else if (beside.verdict == Verdict::Unknown)
        second = leaving_least(beside.findings);
    return second.misfit < first.misfit ? without_share(second) : EffectFinding();
}

/// Of an effect where it is the one name beside another; nothing where it is not.
std::optional<double> weight_beside(const Diagnosis& beside, const EffectFinding& f) {
    if (beside.answer.size() != 1 || beside.answer.front().effect != f.effect) return std::nullopt;
    return beside.answer.front().weight;
}

/// Of two effects that leave so much together; else the other formula of one may be all there is.
bool second_explains_enough(double left, const EffectFinding& best_alone, const Diagnosis& d) {
    return best_alone.misfit - left >= kFormulaShare * (d.score.q - best_alone.misfit);
}

/// What is the name beside the one acts, and explains enough.
bool could_be_two(const Diagnosis& beside, const EffectFinding& best_alone, const Diagnosis& d) {
    if (beside.answer.size() != 1) return false;
    const EffectFinding& other = beside.answer.front();
    return second_explains_enough(other.misfit, best_alone, d) &&
           acts(other.parameters.back(), other.parameter_deviation.back());
}

/// The one, which has that weight beside the other, and what is the name beside it.
void answer_with_two(const EffectFinding& one, double most, double weight, EffectFinding other, Diagnosis& d) {
    d.answer = {as_left(one, most, other.parameters, other.parameter_deviation.back())};
    d.answer.front().p = other.p;
    d.answer.front().weight = other.weight = std::min(weight, other.weight);
    d.answer.front().misfit = other.misfit;
    other.parameters = d.answer.front().parameters;
    d.answer.push_back(std::move(other));
    d.together = true;
}

}  // namespace

bool explain_with_two(const DiagnosisProblem& problem, const DiagnosisSimulation& simulate,
                      const DiagnosisSettings& settings, const DiagnosisOfOne& diagnose_one, Diagnosis& d) {
    const auto most = [&](const EffectFinding& f) { return problem.effects[f.effect].variants[f.variant].most; };
    const auto beside = [&](const EffectFinding& f) {
        Diagnosis more = diagnose_one(with_effect(problem, f), with_effect(simulate, f, most(f)));
        d.simulated_blocks += more.simulated_blocks;
        return more;
    };
    const EffectFinding first = leaving_least(d.findings);
    if (!first.finalist || d.findings.front().p > settings.rejected) return true;
    const bool any_second = problem.effects[first.effect].second_beside && second_explains_enough(0.0, first, d);
    if (first.weight < settings.named && !any_second) return true;  // whatever is beside it
    const Diagnosis beside_first = beside(first);
    if (beside_first.interrupted) return false;
    bool answered = answer_with_one(first, most(first), beside_first, settings, d);
    const EffectFinding second = !answered && any_second ? second_beside(first, beside_first) : EffectFinding();
    if (second.finalist) {
        const Diagnosis beside_second = beside(second);
        if (beside_second.interrupted) return false;
        if (could_be_two(beside_second, first, d)) {
            const EffectFinding& other = beside_second.answer.front();
            std::optional<double> weight = weight_beside(beside_first, second);
            if (!weight || other.effect != first.effect) {  // it was not held against its rivals beside that
                const Diagnosis beside_other = beside(without_share(other));
                if (beside_other.interrupted) return false;
                weight = weight_beside(beside_other, second);
            }
            if (weight) answer_with_two(second, most(second), *weight, other, d);
            answered = weight.has_value();
        }
    }
    if (!answered) return true;
    if (d.answer.size() == 1)  // as it is told among the others
        for (EffectFinding& f : d.findings)
            if (f.effect == d.answer.front().effect) {
                f.p = d.answer.front().p;
                f.misfit = d.answer.front().misfit;
            }
    const auto measurement = [&](const EffectFinding& f) { return problem.effects[f.effect].measurement; };
    d.verdict = std::all_of(d.answer.begin(), d.answer.end(), measurement) ? Verdict::DataProblem : Verdict::Named;
    return true;
}

}  // namespace scree
