// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_refits.hpp"

#include "cli/diagnose_words.hpp"
#include "cli/text.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace scree::cli {

/// A gap over all so many times the largest of 95 % of chance is far beyond it [-].
constexpr double kFarBeyond = 2.0;

/// Standard errors by which blocks held out must be more likely with a name, as cross-validation prefers the simpler model (Breiman et al. 1984) [-].
constexpr double kGainErrors = 1.0;

bool is_far_beyond(const CompareStudy& study) {
    return study.overall.gap > kFarBeyond * study.overall.chance.high;
}

static std::vector<ObservableGap> gaps_of(const CompareStudy& study) {
    std::vector<ObservableGap> gaps;
    for (const ComparedObservable& o : study.observables) gaps.push_back(o.gap);
    return gaps;
}

double distance_over(const CompareStudy& model, const CompareStudy& yardstick) {
    return scree::distance_over(gaps_of(model), gaps_of(yardstick));
}

bool leaves_less(const CompareStudy& model, const CompareStudy& other, const CompareStudy& yardstick) {
    const auto count = [](const CompareStudy& study) {
        return std::ranges::count_if(study.observables, &ObservableGap::counts, &ComparedObservable::gap);
    };
    return count(model) >= count(other) && !(model.overall.gap > other.overall.gap) &&
           distance_over(model, yardstick) < distance_over(other, yardstick);
}

/// A law as strong as is searched at all, within a standard deviation: nobody knows how strong it would have to be, and what stands in for something else ends there. (What acts in a place may hold
/// all that comes, however much stronger it is.)
static const AnsweredEffect* at_the_end_of_its_range(const AnswerFit& answer) {
    for (const AnsweredEffect& e : answer.effects)
        if (e.has_strength() && !e.variant.on && !e.candidate->measurement &&
            e.finding.strength + e.finding.strength_deviation >= e.variant.most)
            return &e;
    return nullptr;
}

void judge_refits(DiagnoseStudy& study) {
    auto& answers = study.answers;
    if (answers.empty()) return;
    const auto demote = [&](const std::string& why) {
        study.demoted = why;
        study.verdict = Verdict::Unknown;
    };
    const auto explains = [&](const AnswerFit& a) { return !is_far_beyond(a.study); };
    if (std::none_of(answers.begin(), answers.end(), explains))
        return demote("with " + answers.front().name() +
                      ", which comes nearest, the model is still far beyond chance as a whole");
    std::stable_partition(answers.begin(), answers.end(), explains);
    if (study.verdict == Verdict::Named)
        if (const AnsweredEffect* const e = at_the_end_of_its_range(answers.front()))
            return demote(e->candidate->name +
                          ", which comes nearest, would have to be about as strong as is searched at all (" +
                          most_searched(e->variant) + "), and may stand in for something else");
    if (study.baseline.result.folds.empty()) return;
    const double without = study.baseline.result.held_out.loss;
    const auto better = [&](const AnswerFit& a) {
        return explains(a) && a.model.result.held_out.loss < std::min(without, a.loss_of_one);
    };
    if (std::none_of(answers.begin(), answers.end(), better))
        return demote("the blocks held out are predicted no better with " + answers.front().name() + " than " +
                      (answers.front().loss_of_one < without ? "with one of them alone" : "without"));
    std::stable_partition(answers.begin(), answers.end(), better);
    if (study.several()) return;  // no name is said
    const std::optional<HeldOutGain> gain = held_out_log_gain(study, answers.front());
    if (gain && gain->mean <= kGainErrors * gain->error)
        demote(
            "with " + answers.front().name() +
            (gain->mean > 0.0
                 ? ", which comes nearest, blocks held out are more likely by no more than chance can do (logarithm: "
                 : ", which comes nearest, blocks held out are no more likely (logarithm: ") +
            short_number(gain->mean) + " +- " + short_number(gain->error) + ")");
}

std::optional<double> removable_gap_closed(const DiagnoseStudy& study, const AnswerFit& answer) {
    const CalibrationFit &without = study.baseline.result.held_out, &with = answer.model.result.held_out;
    if (study.baseline.result.folds.empty() || !(without.loss > with.floor)) return std::nullopt;
    return (without.loss - with.loss) / (without.loss - with.floor);
}

/// Records of one block are not independent of each other: where nobody knows which are, the error is that of as many gains as there are blocks.
static std::optional<HeldOutGain> gain_of(const std::vector<double>& without, const std::vector<double>& with,
                                          std::size_t blocks) {
    if (without.size() < 2 || with.size() != without.size()) return std::nullopt;
    std::vector<double> gains;
    for (std::size_t k = 0; k < without.size(); ++k)
        if (const double gain = without[k] - with[k]; std::isfinite(gain)) gains.push_back(gain);
    if (gains.size() < 2) return std::nullopt;
    const SampleSummary gain = summary_of(gains);
    return HeldOutGain{gain.mean, gain.deviation / std::sqrt(static_cast<double>(std::min(gains.size(), blocks)))};
}

std::optional<HeldOutGain> held_out_gain(const DiagnoseStudy& study, const AnswerFit& answer) {
    return gain_of(study.baseline.result.held_out_losses, answer.model.result.held_out_losses, study.blocks);
}

std::optional<HeldOutGain> held_out_log_gain(const DiagnoseStudy& study, const AnswerFit& answer) {
    return gain_of(study.baseline.result.held_out_log_losses, answer.model.result.held_out_log_losses, study.blocks);
}

}  // namespace scree::cli
