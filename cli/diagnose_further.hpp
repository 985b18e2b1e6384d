// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/diagnose_study.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// What a planned test would see if it were more than it is.
struct FurtherRow {
    std::string name;               ///< "as planned", "spins at the screens", "twice as many blocks"
    std::size_t seen = 0;           ///< effects that 4 of 5 tests see at their reference strength [-]
    std::size_t alike = 0;          ///< pairs of effects that look alike [-]
    std::vector<std::string> also;  ///< effects that are seen, and are not as planned
};
/// First the test as planned. Empty unless a test was planned.
std::vector<FurtherRow> further_rows(const DiagnoseStudy& study);

/// Of a group: with which instruments, and from how many blocks on, its members would be told apart; a sentence each, empty of other verdicts.
std::vector<std::string> telling_apart_sentences(const DiagnoseStudy& study);

/// Effects that are seen and of which the fingerprints have at least this cosine look alike [-].
inline constexpr double kSameLooks = 0.9;
/// Do two effects of a plan look alike?
bool look_alike(const Diagnosis& plan, const EffectFinding& a, const EffectFinding& b);

}  // namespace scree::cli
