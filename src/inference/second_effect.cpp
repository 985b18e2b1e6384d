// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/second_effect.hpp"

namespace scree {

namespace {

/// A first effect whose strength falls below this share of the largest, once the second is there, was none [-].
constexpr double kLeastStrength = 0.02;
/// Nor was one that is not so many standard deviations from zero then [-].
constexpr double kSure = 2.0;
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

}  // namespace

bool explain_with_two(const DiagnosisProblem& problem, const DiagnosisSimulation& simulate,
                      const DiagnosisSettings& settings, const DiagnosisOfOne& diagnose_one, Diagnosis& d) {
    EffectFinding first;
    for (const EffectFinding& f : d.findings)
        if (f.finalist && (!first.finalist || f.misfit < first.misfit)) first = f;
    if (!first.finalist || d.findings.front().p > settings.rejected) return true;
    const double most = problem.effects[first.effect].variants[first.variant].most;
    const Diagnosis more = diagnose_one(with_effect(problem, first), with_effect(simulate, first, most));
    if (more.interrupted) return false;
    d.simulated_blocks += more.simulated_blocks;
    const bool alone = more.verdict == Verdict::None && first.weight >= settings.named;
    const bool pair =
        (more.verdict == Verdict::Named || more.verdict == Verdict::DataProblem) && more.answer.size() == 1;
    if (!alone && !pair) return true;
    std::vector<double> parameters = pair ? more.answer.front().parameters : more.parameters;
    const double share = parameters.back();
    const double deviation = pair ? more.answer.front().parameter_deviation.back() : first.strength_deviation / most;
    if (share < kLeastStrength || share < kSure * deviation) return true;
    first.strength_deviation = most * deviation;
    parameters.pop_back();
    first.strength = most * share;
    first.parameters = parameters;
    first.p = more.test.p;
    d.answer = {first};
    if (pair) {
        EffectFinding second = more.answer.front();
        second.parameters = parameters;
        d.answer.front().p = second.p;
        d.answer.front().weight = second.weight;
        d.answer.front().misfit = second.misfit;
        d.answer.push_back(std::move(second));
    }
    d.together = pair;
    d.verdict = Verdict::DataProblem;
    for (const EffectFinding& f : d.answer)
        if (!problem.effects[f.effect].measurement) d.verdict = Verdict::Named;
    return true;
}

}  // namespace scree
