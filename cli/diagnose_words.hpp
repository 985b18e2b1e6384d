// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/diagnose_study.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// What was found, in one sentence.
std::string verdict_sentence(const DiagnoseStudy& study);
/// "; standard deviations and p are those of the model that was tested, with ...": where that is not the calibrated one; else empty.
std::string tested_elsewhere(const DiagnoseStudy& study);
/// Where the calibrated model and the measurements disagree, beyond chance even for so many looks; a sentence each, worst first.
std::vector<std::string> where_sentences(const DiagnoseStudy& study);
/// What lies between two screens, or the last one and the stop, whatever went wrong above: what stands out of the table, if the verdict is not NONE.
struct InnovationRow {
    std::string from, to;    ///< "ES1-A", "the stop"
    std::string what;        ///< "speed [m/s]"
    std::size_t blocks = 0;  ///< [-]
    double measured = 0.0, simulated = 0.0;
    double standardised = 0.0;  ///< their difference in standard errors [-]
    bool stands_out = false;    ///< beyond chance even for so many looks
};
std::vector<InnovationRow> innovation_rows(const DiagnoseStudy& study);
/// Those that stand out, a sentence each.
std::vector<std::string> innovation_sentences(const DiagnoseStudy& study);
/// What a reader must know before using the answer, a sentence each.
std::vector<std::string> diagnose_remarks(const DiagnoseStudy& study);

/// "95 % of chance, for all together": what limits in pictures are.
std::string chance_words(const DiagnoseStudy& study);

/// "ground_drag, linear, on loose waste".
std::string variant_name(const DiagnosisVariant& v);
/// "coefficient 0.3 1/s": at strength 1.
std::string reference_strength(const DiagnosisVariant& v);
/// "coefficient 9 1/s": the largest strength that is searched; empty where there is none to search for.
std::string most_searched(const DiagnosisVariant& v);
/// "coefficient 0.31 1/s (95 %: 0.2 to 0.45)", and where its middle is if it acts on a stretch that was looked for.
std::string strength_text(const AnsweredEffect& e);
/// Where the middle of the stretch is with 95 % that an effect acts on [m].
Interval middle_interval(const AnsweredEffect& e);
/// Gap of what is fitted on blocks held out, "-" without folds.
std::string held_out_text(const CalibratedModel& m);
/// "closes 80 % of the removable gap of blocks held out", "a block held out is more likely with ground_drag, the logarithm of its likelihood higher by 0.4 +- 0.1"; as far as there are any.
std::vector<std::string> held_out_sentences(const DiagnoseStudy& study, const AnswerFit& answer);
/// Free parameters and choices as given, calibrated, told where no answer stands, and with every answer; under a row of heads.
std::vector<std::vector<std::string>> parameter_rows(const DiagnoseStudy& study);
/// Smallest strength that four of five tests would see, "not visible" if none does.
std::string smallest_seen(const DiagnoseStudy& study, const EffectFinding& f);
/// Effects that look like this one after a recalibration.
std::string look_alikes(const DiagnoseStudy& study, const EffectFinding& f);

}  // namespace scree::cli
