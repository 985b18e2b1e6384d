// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/diagnosis.hpp"

namespace scree {

/// Diagnosis of a problem with at most one effect more than it has.
using DiagnosisOfOne = std::function<Diagnosis(const DiagnosisProblem&, const DiagnosisSimulation&)>;

/// Where the best single effect leaves more than its own simulations do: the second against the one-effect model. The first becomes part of the model, its
/// strength a parameter like the others, and the diagnosis is done again without it. If nothing is missing then, with derivatives taken where the first stands, it suffices
/// alone after all. What is found beside it, or comes nearest, may be right where the first is a false friend of both: it takes the place of the first, and what
/// acts beside it is asked once more, of all effects. Each of two must be the one name beside the other. One name is said then, or no pair; none, either, where the second explains so little beside the best one that this is
/// perhaps but of another formula. Fills the answer of `d` and its verdict, or leaves both as they are. False:
/// it was stopped.
bool explain_with_two(const DiagnosisProblem& problem, const DiagnosisSimulation& simulate,
                      const DiagnosisSettings& settings, const DiagnosisOfOne& diagnose_one, Diagnosis& d);

}  // namespace scree
