// SPDX-License-Identifier: GPL-3.0-or-later
#include "inference/calibration_plan.hpp"

#include "inference/cma_es.hpp"
#include "inference/quadratic_fit.hpp"

#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

std::size_t positive(std::int64_t n) {
    return static_cast<std::size_t>(std::max<std::int64_t>(n, 0));
}

}  // namespace

CalibrationPlan::CalibrationPlan(const CalibrationProblem& problem, const CalibrationSettings& s)
    : dimension(problem.parameters.size()) {
    levels.emplace_back();
    for (const CalibrationChoice& choice : problem.choices) {
        std::vector<std::vector<std::size_t>> more;
        for (const auto& before : levels)
            for (std::size_t l = 0; l < choice.levels.size(); ++l) {
                more.push_back(before);
                more.back().push_back(l);
            }
        levels = std::move(more);
    }
    folds = s.folds < 2 || dimension == 0 ? 0 : std::min(positive(s.folds), problem.records);
    const auto if_several = [&](std::size_t n) { return folds == 0 || n < 2 ? 0 : n; };
    places = if_several(problem.places.size());
    paths = if_several(problem.paths.size());
    if (dimension == 0) return;
    const CalibrationSettings decided = with_budget_of(s, dimension);
    screening = positive(decided.screening);
    starts = std::min(std::max<std::size_t>(1, positive(decided.starts) / levels.size()), screening);
    population = std::max<std::size_t>(2, positive(decided.population));
    generations = positive(decided.generations);
    surroundings = std::max(positive(decided.surroundings),  // each round must be able to fit
                            kSurroundingRounds * (QuadraticFit::coefficients(dimension) + 2));
}

std::size_t CalibrationPlan::total() const {
    return levels.size() * (screening + starts * (population * generations + (dimension > 0 ? 3 : 1) * kRaceSeeds)) +
           surroundings + (dimension > 0 ? 3 + kSeen : 2) + (folds + places + paths) * (1 + kSeen);
}

void check_problem(const CalibrationProblem& problem) {
    if (problem.records < 2)
        throw InputError("a calibration needs at least two measured blocks; there are " +
                         std::to_string(problem.records));
    if (problem.parameters.empty() && problem.choices.empty())
        throw InputError("a calibration needs at least one free parameter or choice");
    for (const CalibrationParameter& p : problem.parameters) {
        if (!(p.low < p.high))
            throw InputError("the range of " + p.name + " is empty: its lower end must be below its upper end");
        if (p.logarithmic && !(p.low > 0.0))
            throw InputError("the range of " + p.name + " is searched by ratios and must begin above 0");
        if (std::isfinite(p.start) && (p.start < p.low || p.start > p.high))
            throw InputError("the value of " + p.name + " lies outside its range: widen the range or change the value");
    }
    for (const CalibrationChoice& c : problem.choices)
        if (c.levels.empty() || c.start >= c.levels.size())
            throw InputError("the choice " + c.name + " must have levels, and the model's own must be one of them");
}

CalibrationSettings with_budget_of(CalibrationSettings s, std::size_t parameters) {
    const auto unless_set = [](std::int64_t& setting, std::size_t usual) {
        if (setting <= 0) setting = static_cast<std::int64_t>(usual);
    };
    unless_set(s.screening, std::max<std::size_t>(8, 4 * parameters));
    unless_set(s.population, static_cast<std::size_t>(CmaEs::default_population(std::max<std::size_t>(parameters, 1))));
    unless_set(s.surroundings, std::max<std::size_t>(40, 5 * QuadraticFit::coefficients(parameters)));
    return s;
}

std::size_t planned_evaluations(const CalibrationProblem& problem, const CalibrationSettings& settings) {
    return CalibrationPlan(problem, settings).total();
}

}  // namespace scree
