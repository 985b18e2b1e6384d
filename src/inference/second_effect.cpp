// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/second_effect.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scree {

namespace {

/// How many of the effects that leave least are tried as the first [-].
constexpr std::size_t kFirsts = 2;
/// A first effect whose strength falls below this share of the largest, once the second is there, was none [-].
constexpr double kLeastStrength = 0.02;
/// Step of its derivative, of the largest strength [-].
constexpr double kStep = 0.08;

struct Pair {
    EffectFinding first, second;
};

/// The model with an effect in it, whose strength, as a share of the largest, is the last parameter.
DiagnosisProblem with_effect(DiagnosisProblem problem, const EffectFinding& f) {
    problem.calibrated = f.parameters;
    problem.calibrated.push_back(f.strength / problem.effects[f.effect].variants[f.variant].most);
    problem.given.clear();
    problem.low.push_back(0.0);
    problem.high.push_back(1.0);
    problem.step.push_back(kStep);
    problem.effects[f.effect].variants.clear();
    return problem;
}

DiagnosisSimulation with_effect(const DiagnosisSimulation& simulate, const EffectFinding& f, double most) {
    return [&simulate, dose = EffectDose{f.effect, f.variant, 0.0}, most](DiagnosisTask task) {
        EffectDose first = dose;
        first.strength = most * task.parameters.back();
        task.parameters.pop_back();
        task.effects.insert(task.effects.begin(), first);
        return simulate(task);
    };
}

bool same(const Pair& a, const Pair& b) {
    const auto effects = [](const Pair& p) { return std::minmax(p.first.effect, p.second.effect); };
    return effects(a) == effects(b);
}

}  // namespace

bool explain_with_two(const DiagnosisProblem& problem, const DiagnosisSimulation& simulate,
                      const DiagnosisSettings& settings, const DiagnosisOfOne& diagnose_one, Diagnosis& d) {
    std::vector<EffectFinding> firsts;
    std::copy_if(d.findings.begin(), d.findings.end(), std::back_inserter(firsts),
                 [](const EffectFinding& f) { return f.finalist; });
    if (firsts.empty() || firsts.front().p > settings.rejected) return true;
    std::stable_sort(firsts.begin(), firsts.end(),
                     [](const EffectFinding& a, const EffectFinding& b) { return a.misfit < b.misfit; });
    firsts.resize(std::min(firsts.size(), kFirsts));
    std::vector<Pair> pairs;
    for (EffectFinding& first : firsts) {
        const double most = problem.effects[first.effect].variants[first.variant].most;
        const Diagnosis more = diagnose_one(with_effect(problem, first), with_effect(simulate, first, most));
        if (more.interrupted) return false;
        d.simulated_blocks += more.simulated_blocks;
        if (more.verdict != Verdict::Named && more.verdict != Verdict::DataProblem) continue;
        if (more.answer.size() != 1) continue;
        Pair pair{first, more.answer.front()};
        const double share = pair.second.parameters.back();
        pair.second.parameters.pop_back();
        if (share < kLeastStrength) continue;
        pair.first.strength = most * share;
        pair.first.parameters = pair.second.parameters;
        pair.first.misfit = pair.second.misfit;
        pair.first.p = pair.second.p;
        pairs.push_back(std::move(pair));
    }
    if (pairs.empty()) return true;
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.second.misfit < b.second.misfit; });
    Pair& best = pairs.front();
    double weight = best.second.weight;
    for (const Pair& other : pairs)
        if (!same(best, other)) weight /= 1.0 + std::exp(0.5 * (best.second.misfit - other.second.misfit));
    if (weight < settings.named) return true;
    best.first.weight = best.second.weight = weight;
    d.together = true;
    d.verdict = problem.effects[best.first.effect].measurement && problem.effects[best.second.effect].measurement
                    ? Verdict::DataProblem
                    : Verdict::Named;
    d.answer = {best.first, best.second};
    return true;
}

}  // namespace scree
