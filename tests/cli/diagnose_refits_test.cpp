// SPDX-License-Identifier: GPL-3.0-or-later
// Whether an answer survives its refit: the gap that is left over all, and the blocks that were held out.
#include "cli/diagnose_refits.hpp"

#include "cli/diagnose_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace scree::cli {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const DiagnosisCandidate& candidate(const std::string& name, bool measurement = false) {
    static std::vector<std::unique_ptr<DiagnosisCandidate>> all;
    all.push_back(std::make_unique<DiagnosisCandidate>());
    all.back()->name = name;
    all.back()->measurement = measurement;
    return *all.back();
}

/// Refitted, with the gap over all that it leaves, where 95 % of chance end at 2.4, and the loss of blocks held out.
AnswerFit answer(const std::string& name, double gap, double loss) {
    AnswerFit fit;
    fit.effects.push_back({&candidate(name), {}, {}, 0.0, {}});
    fit.study.overall.gap = gap;
    fit.study.overall.chance = {0.4, 2.4};
    fit.model.result.held_out.loss = loss;
    return fit;
}

DiagnoseStudy study_of(std::vector<AnswerFit> answers) {
    DiagnoseStudy study;
    study.verdict = answers.size() > 1 ? Verdict::Group : Verdict::Named;
    study.answers = std::move(answers);
    study.baseline.result.folds.resize(2);
    study.baseline.result.held_out.loss = 1.0;
    return study;
}

TEST(DiagnoseBudget, FullSearchesLongerWithMoreBlocks) {
    const SiteSettings site;
    const DiagnoseBudget usual = diagnose_budget(site, 2, false), full = diagnose_budget(site, 2, true);
    EXPECT_EQ(full.test.reference_repeats, 3 * usual.test.reference_repeats);
    EXPECT_EQ(full.test.repeats, 3 * usual.test.repeats);
    EXPECT_EQ(full.search.starts, 2 * usual.search.starts);
    EXPECT_EQ(full.search.generations, 2 * usual.search.generations);
    EXPECT_EQ(full.search.repeats, 3 * usual.search.repeats);
    EXPECT_EQ(full.search.final_repeats, 3 * usual.search.final_repeats);
    EXPECT_EQ(full.search.seed, full.test.seed);
}

// The refit that begins at what was followed need not be the calibration that the model has: what the model leaves there is told by the former, by place, too.
TEST(DiagnoseModels, AModelGoesBackToWhereAnotherCalibrationBegan) {
    CalibratedModel model;
    model.strengths = {0.7};
    model.result.start = {{0.1, 0.2}, {}};
    model.result.best = {{0.3, 0.7}, {}};
    model.result.best_fit = {5.0, 1.0};
    model.result.places.push_back({.name = "ES1", .start = {9.0, 1.0}, .best = {5.0, 1.0}, .held_out = {6.0, 1.0}});
    CalibrationResult refit = model.result;
    refit.start = {{0.4, 0.8}, {}};
    refit.start_fit = {3.0, 1.0};
    refit.places[0].start = {3.5, 1.0};
    const CalibratedModel back = at_start_of(refit, model);
    EXPECT_TRUE(back.as_followed);
    EXPECT_EQ(back.point.values, std::vector<double>{0.4});
    EXPECT_EQ(back.strengths, std::vector<double>{0.8});
    EXPECT_EQ(back.result.best_fit.loss, 3.0);
    EXPECT_EQ(back.result.places[0].best.loss, 3.5);
    EXPECT_EQ(back.result.places[0].held_out.loss, 6.0);
}

// Of one observable at a distance of so many floors of the yardstick, and of so large a gap over all.
TEST(DiagnoseRefits, AModelThatLeavesMoreOverAllLeavesNoLess) {
    const auto study = [](double distance, double gap) {
        CompareStudy s;
        s.observables.resize(1);
        ObservableGap& g = s.observables.front().gap;
        g.observable.name = "runout";
        g.observable.overall = true;
        g.pooled.gap = g.pooled.distance = distance;
        g.pooled.floor = 1.0;
        s.overall.gap = gap;
        return s;
    };
    const CompareStudy calibrated = study(22.5, 22.2);
    EXPECT_TRUE(leaves_less(study(21.3, 21.0), calibrated, calibrated));
    EXPECT_FALSE(leaves_less(study(23.0, 21.0), calibrated, calibrated)) << "it scatters more";
    EXPECT_FALSE(leaves_less(study(21.3, 22.8), calibrated, calibrated)) << "blocks stop elsewhere";
    CompareStudy fewer = study(1.0, 1.0);
    fewer.observables.clear();
    EXPECT_FALSE(leaves_less(fewer, calibrated, calibrated));
}

TEST(DiagnoseRefits, AnAnswerThatClosesTheGapAndPredictsBetterStays) {
    DiagnoseStudy study = study_of({answer("ground_drag", 4.7, 0.9)});
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::Named);
    EXPECT_THAT(study.demoted, IsEmpty());
}

TEST(DiagnoseRefits, AModelStillFarBeyondChanceHasNoName) {
    DiagnoseStudy study = study_of({answer("ids_shuffled", 4.9, 0.5)});
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::Unknown);
    EXPECT_THAT(study.demoted, HasSubstr("ids_shuffled"));
    EXPECT_THAT(study.demoted, HasSubstr("far beyond chance"));
}

TEST(DiagnoseRefits, BlocksHeldOutMustBePredictedBetter) {
    DiagnoseStudy study = study_of({answer("ground_drag", 1.0, 1.0)});
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::Unknown);
    EXPECT_THAT(study.demoted, HasSubstr("held out"));
}

TEST(DiagnoseRefits, ByMoreThanChance) {
    AnswerFit fit = answer("ground_drag", 1.0, 0.9);
    const auto judged = [&](std::vector<double> gains, Verdict verdict) {
        DiagnoseStudy study = study_of({fit});
        study.verdict = verdict;
        study.blocks = gains.size();
        study.baseline.result.held_out_log_losses.assign(gains.size(), 1.0);
        for (const double gain : gains) study.answers[0].model.result.held_out_log_losses.push_back(1.0 - gain);
        judge_refits(study);
        return study;
    };
    EXPECT_EQ(judged({0.1, 0.2, 0.1, 0.2}, Verdict::Named).verdict, Verdict::Named);
    const DiagnoseStudy doubtful = judged({-0.5, 0.7, -0.4, 0.8}, Verdict::Named);  // 0.15 +- 0.35
    EXPECT_EQ(doubtful.verdict, Verdict::Unknown);
    EXPECT_THAT(doubtful.demoted, HasSubstr("no more than chance can do (logarithm: 0.15 +- 0.3"));
    EXPECT_EQ(judged({-0.5, 0.7, -0.4, 0.8}, Verdict::DataProblem).verdict, Verdict::Unknown);
    EXPECT_EQ(judged({-0.2, 0.9, -0.1, 0.6}, Verdict::Named).verdict, Verdict::Named) << "0.30 +- 0.27";
    EXPECT_EQ(judged({-0.3, 0.9, -0.2, 0.6}, Verdict::Named).verdict, Verdict::Unknown) << "0.25 +- 0.30";
    EXPECT_EQ(judged({-0.5, 0.7, -0.4, 0.8}, Verdict::Group).verdict, Verdict::Group) << "no name is said";
}

// Faults that cannot be told apart are a group like any other.
TEST(DiagnoseRefits, SeveralFaultsAreAGroup) {
    DiagnoseStudy study = study_of({answer("speed_error", 1.0, 0.9), answer("slow_missed", 1.0, 0.9)});
    study.verdict = Verdict::DataProblem;
    study.blocks = 4;
    study.baseline.result.held_out_log_losses.assign(4, 1.0);
    for (AnswerFit& a : study.answers) a.model.result.held_out_log_losses = {1.5, 0.3, 1.4, 0.2};
    EXPECT_EQ(study.standing(), 2U);
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::DataProblem);
    EXPECT_EQ(study.standing(), 2U);
    study.answers.pop_back();
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::Unknown) << "of one that stands alone more is asked";
}

TEST(DiagnoseRefits, TwoEffectsMustPredictThemBetterThanOneOfThem) {
    AnswerFit two = answer("ground_drag", 1.0, 0.5);
    two.effects.push_back({&candidate("soil_patch"), {}, {}, 0.0, {}});
    for (const auto& [alone, verdict] : {std::pair{0.6, Verdict::Named}, {0.5, Verdict::Unknown}}) {
        two.loss_of_one = alone;
        DiagnoseStudy study = study_of({two});
        judge_refits(study);
        EXPECT_EQ(study.verdict, verdict);
        EXPECT_THAT(
            study.demoted,
            HasSubstr(verdict == Verdict::Unknown ? "ground_drag and soil_patch than with one of them alone" : ""));
    }
}

// Without rolling_size in the catalogue, rolling resistance that grows with size was named restitution_mass, exponent -0.79 +- 0.2, where -0.9 is the last one.
TEST(DiagnoseRefits, WhatMustBeAsStrongAsIsSearchedHasNoName) {
    AnswerFit fit = answer("restitution_mass", 1.0, 0.5);
    fit.effects.front().variant.kind = EffectKind::RestitutionMass;
    fit.effects.front().variant.parameter = "exponent";
    fit.effects.front().variant.reference = -0.15;
    fit.effects.front().variant.most = 6.0;
    fit.effects.front().finding.strength = 5.3;
    const auto judged = [&](double deviation, bool measurement, Verdict verdict) {
        fit.effects.front().candidate = &candidate("restitution_mass", measurement);
        fit.effects.front().finding.strength_deviation = deviation;
        DiagnoseStudy study = study_of({fit});
        study.verdict = verdict;
        judge_refits(study);
        return study;
    };
    const DiagnoseStudy at_end = judged(1.4, false, Verdict::Named);
    EXPECT_EQ(at_end.verdict, Verdict::Unknown);
    EXPECT_THAT(at_end.demoted, HasSubstr("as strong as is searched at all (exponent -0.9)"));
    EXPECT_EQ(judged(0.3, false, Verdict::Named).verdict, Verdict::Named);
    EXPECT_EQ(judged(1.4, true, Verdict::DataProblem).verdict, Verdict::DataProblem) << "all numbers may be mixed up";
}

TEST(DiagnoseRefits, WithoutFoldsTheGapDecides) {
    DiagnoseStudy study = study_of({answer("ground_drag", 1.0, 1.0)});
    study.baseline.result.folds.clear();
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::Named);
}

TEST(DiagnoseRefits, OfAGroupThoseThatSurviveComeFirst) {
    DiagnoseStudy study = study_of({answer("far", 9.0, 0.5), answer("worse", 1.0, 1.1), answer("good", 1.0, 0.9)});
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::Group);
    EXPECT_EQ(study.answers.front().name(), "good");
}

TEST(DiagnoseRefits, OneAndTheSameMemberPassesBoth) {
    DiagnoseStudy study = study_of({answer("far", 9.0, 0.5), answer("worse", 1.0, 1.1)});
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::Unknown);
    EXPECT_THAT(study.demoted, HasSubstr("no better with worse"));
}

TEST(DiagnoseRefits, NothingAnsweredNothingTaken) {
    DiagnoseStudy study = study_of({});
    study.verdict = Verdict::None;
    judge_refits(study);
    EXPECT_EQ(study.verdict, Verdict::None);
    EXPECT_THAT(study.demoted, IsEmpty());
}

TEST(DiagnoseRefits, TheShareClosedIsThatOfWhatCouldBeClosed) {
    const DiagnoseStudy study = study_of({});
    AnswerFit half = answer("ground_drag", 1.0, 0.9);
    half.model.result.held_out.floor = 0.8;
    ASSERT_TRUE(removable_gap_closed(study, half));
    EXPECT_NEAR(*removable_gap_closed(study, half), 0.5, 1e-12);
    half.model.result.held_out.floor = 1.0;
    EXPECT_FALSE(removable_gap_closed(study, half)) << "nothing was left to close";
}

TEST(DiagnoseRefits, TheGainOfBlocksHeldOutHasAnError) {
    DiagnoseStudy study = study_of({});
    AnswerFit fit = answer("ground_drag", 1.0, 0.9);
    EXPECT_FALSE(held_out_gain(study, fit)) << "nothing was held out";
    study.blocks = 4;
    study.baseline.result.held_out_losses = {1.0, 5.0, 3.0, 9.0};
    fit.model.result.held_out_losses = {0.0, 4.0, 1.0, 9.0};  // 1, 1, 2 and 0 less
    const auto gain = held_out_gain(study, fit);
    ASSERT_TRUE(gain);
    EXPECT_NEAR(gain->mean, 1.0, 1e-12);
    EXPECT_NEAR(gain->error, std::sqrt(2.0 / 3.0 / 4.0), 1e-12);
    study.blocks = 2;
    EXPECT_NEAR(held_out_gain(study, fit)->error, std::sqrt(2.0 / 3.0 / 2.0), 1e-12)
        << "nobody knows which records are of one block";
    study.blocks = 4;
    EXPECT_FALSE(held_out_log_gain(study, fit));
    study.baseline.result.held_out_log_losses = {3.0, kNaN, 5.0, 7.0};
    fit.model.result.held_out_log_losses = {2.0, 1.0, 3.0, kNaN};  // 1 and 2 less where both are known
    const auto likelier = held_out_log_gain(study, fit);
    ASSERT_TRUE(likelier);
    EXPECT_NEAR(likelier->mean, 1.5, 1e-12);
    EXPECT_NEAR(likelier->error, 0.5, 1e-12);
}

TEST(DiagnoseRefits, WithoutFoldsNoShareIsClosed) {
    DiagnoseStudy study = study_of({});
    study.baseline.result.folds.clear();
    EXPECT_FALSE(removable_gap_closed(study, answer("ground_drag", 1.0, 0.5)));
}

}  // namespace
}  // namespace scree::cli
