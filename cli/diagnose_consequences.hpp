// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_figures.hpp"
#include "cli/diagnose_study.hpp"

#include <array>
#include <string>
#include <vector>

namespace scree::cli {

/// The best answer, if it acts on blocks and not on measurements; null if there is none.
const AnswerFit* answer_on_blocks(const DiagnoseStudy& study);

/// What a barrier at a screen is designed for, by one model; 95 % values of the blocks that pass, NaN where none does.
struct AtScreen {
    double passed = 0.0;   ///< share of the blocks [-]
    double speed = kNaN;   ///< [m/s]
    double energy = kNaN;  ///< kinetic, translation and rotation [J]
    double height = kNaN;  ///< of the centre of mass above the terrain [m]
};
/// The same screen with the calibrated model, and with the answer.
struct ScreenChange {
    std::string screen;
    AtScreen before, after;
};
/// One value of it, in the unit in which it is told.
struct ChangedValue {
    const char* name;  ///< with the unit, as in JSON
    double before, after;
};
/// Share that passes [%], speed [m/s], energy [kJ], height [m].
std::array<ChangedValue, 4> values_of(const ScreenChange& change);
/// Of an answer that stands and acts on blocks; else empty.
std::vector<ScreenChange> changes_at_screens(const DiagnoseStudy& study, std::size_t answer);

/// 95 % of the blocks are slower than this in every cell with ground of that soil that many cross [m/s]; NaN if none does.
double fastest_on(const SiteModel& model, const CampaignResult& campaign, const std::string& soil);

/// How many blocks come how far, before and after: curves along the profile with energies and heights in 2D, maps in 3D.
std::vector<Figure> consequence_figures(const DiagnoseStudy& study, const SiteModel& model,
                                        const ObservedSite& observed);

}  // namespace scree::cli
