// SPDX-License-Identifier: GPL-3.0-or-later
// Whether one effect suffices, or two act, from diagnoses that are written down here: which are asked, and what is made of them.
#include "inference/second_effect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scree {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;

constexpr std::size_t kDrag = 0, kRolling = 1, kBias = 2;
constexpr double kMostDrag = 4.0, kMostRolling = 2.0;

EffectFinding finalist(std::size_t effect, double misfit, double weight, std::vector<double> parameters) {
    EffectFinding f;
    f.effect = effect;
    f.finalist = true;
    f.misfit = misfit;
    f.weight = weight;
    f.p = 0.4;
    f.strength = 1.0;
    f.parameter_deviation.assign(parameters.size(), 0.05);
    f.parameters = std::move(parameters);
    return f;
}

/// Beside an effect, whose share of its largest strength is the last parameter, nothing is missing.
Diagnosis nothing_beside(double share, double deviation) {
    Diagnosis d;
    d.parameters = {0.3, share};
    d.score.q = 7.0;
    d.score.shift_deviation = Eigen::Vector2d(0.1, deviation);
    d.test.p = 0.6;
    d.simulated_blocks = 100;
    return d;
}

Diagnosis named_beside(EffectFinding f) {
    Diagnosis d;
    d.verdict = Verdict::Named;
    d.parameters = f.parameters;
    d.score.shift_deviation = Eigen::Vector2d(0.1, 0.05);
    d.answer = {f};
    d.findings = {std::move(f)};
    d.simulated_blocks = 100;
    return d;
}

/// What is asked beside which effect, and answered in this order.
class SecondEffect : public testing::Test {
protected:
    SecondEffect() {
        problem.calibrated = {0.5};
        problem.given = {0.6};
        problem.low = {0.0};
        problem.high = {1.0};
        problem.step = {0.1};
        problem.effects = {
            {"drag", false, {{"", kMostDrag}}}, {"rolling", false, {{"", kMostRolling}}}, {"bias", true, {{"", 3.0}}}};
        found.verdict = Verdict::Unknown;
        found.simulated_blocks = 1000;
        found.score.q = 60.0;
        found.findings = {finalist(kDrag, 20.0, 0.97, {0.4}), finalist(kRolling, 25.0, 0.01, {0.45})};
        found.findings[0].p = 0.01;
    }

    bool explain() {
        return explain_with_two(
            problem,
            [this](const DiagnosisTask& task) -> std::optional<ObservationTable> {
                simulated = task;
                return ObservationTable{};
            },
            settings,
            [this](const DiagnosisProblem& of, const DiagnosisSimulation& simulate) {
                asked.push_back(of);
                simulate({of.calibrated, {{kRolling, 0, 0.5, {}}}, 1, 1});
                return answers.at(asked.size() - 1);
            },
            found);
    }

    DiagnosisProblem problem;
    DiagnosisSettings settings;
    Diagnosis found;
    std::vector<Diagnosis> answers;
    std::vector<DiagnosisProblem> asked;
    DiagnosisTask simulated;
};

TEST_F(SecondEffect, TheFirstBecomesPartOfTheModel) {
    answers = {nothing_beside(0.5, 0.05)};
    ASSERT_TRUE(explain());
    ASSERT_EQ(asked.size(), 1U);
    EXPECT_THAT(asked[0].calibrated, ElementsAre(0.4, 0.25)) << "a strength of 1 of 4";
    EXPECT_THAT(asked[0].low, ElementsAre(0.0, 0.0));
    EXPECT_THAT(asked[0].high, ElementsAre(1.0, 1.0));
    EXPECT_EQ(asked[0].step.size(), 2U);
    EXPECT_TRUE(asked[0].given.empty()) << "nobody gave a strength";
    EXPECT_TRUE(asked[0].effects[kDrag].variants.empty()) << "it is there already";
    EXPECT_EQ(asked[0].effects[kRolling].variants.size(), 1U);
    EXPECT_THAT(simulated.parameters, ElementsAre(0.4));
    EXPECT_THAT(simulated.effects, ElementsAre(EffectDose{kDrag, 0, 1.0, {}}, EffectDose{kRolling, 0, 0.5, {}}));
}

TEST_F(SecondEffect, NothingIsLookedForBesideWhatExplainsTooMuch) {
    problem.effects[kDrag].second_beside = false;
    answers = {nothing_beside(0.5, 0.05)};
    ASSERT_TRUE(explain());
    for (const CandidateEffect& e : asked.at(0).effects) EXPECT_TRUE(e.variants.empty());
}

TEST_F(SecondEffect, OneSufficesWhereNothingIsMissingBesideIt) {
    answers = {nothing_beside(0.5, 0.05)};
    ASSERT_TRUE(explain());
    EXPECT_EQ(found.verdict, Verdict::Named);
    EXPECT_FALSE(found.together);
    ASSERT_EQ(found.answer.size(), 1U);
    const EffectFinding& f = found.answer[0];
    EXPECT_EQ(f.effect, kDrag);
    EXPECT_THAT(f.parameters, ElementsAre(0.3)) << "as the model that it is part of was left";
    EXPECT_DOUBLE_EQ(f.strength, 0.5 * kMostDrag);
    EXPECT_DOUBLE_EQ(f.strength_deviation, 0.05 * kMostDrag);
    EXPECT_EQ(f.p, 0.6);
    EXPECT_EQ(f.misfit, 7.0);
    EXPECT_EQ(found.findings[0].p, 0.6) << "among all effects it is told as answered";
    EXPECT_EQ(found.findings[0].misfit, 7.0);
    EXPECT_EQ(found.findings[1].misfit, 25.0);
    EXPECT_EQ(found.simulated_blocks, 1100);
}

TEST_F(SecondEffect, AFaultOfTheMeasurementThatSufficesIsAProblemOfTheData) {
    found.findings[0].effect = kBias;
    answers = {nothing_beside(0.5, 0.05)};
    ASSERT_TRUE(explain());
    EXPECT_EQ(found.verdict, Verdict::DataProblem);
}

TEST_F(SecondEffect, OneWithRivalsIsNotNamedThough) {
    found.findings[0].weight = 0.9;
    answers = {nothing_beside(0.5, 0.05)};
    ASSERT_TRUE(explain());
    EXPECT_EQ(found.verdict, Verdict::Unknown);
    EXPECT_TRUE(found.answer.empty());
    EXPECT_EQ(asked.size(), 1U) << "and nothing was found to ask for beside";
    asked.clear();
    problem.effects[kDrag].second_beside = false;
    ASSERT_TRUE(explain());
    EXPECT_TRUE(asked.empty()) << "nor is anything, where no answer could come of it";
}

TEST_F(SecondEffect, OneThatHardlyActsOnceItIsPartOfTheModelIsNone) {
    for (const auto& [share, deviation] : {std::pair{0.01, 0.001}, std::pair{0.2, 0.15}}) {
        answers = {nothing_beside(share, deviation)};
        asked.clear();
        ASSERT_TRUE(explain());
        EXPECT_EQ(found.verdict, Verdict::Unknown) << share;
    }
}

// The second takes the place of the first, and what acts beside it is asked once more.
TEST_F(SecondEffect, TwoAreNamedWhereTheSecondStandsWithoutTheFirst) {
    EffectFinding beside_drag = finalist(kRolling, 12.0, 0.96, {0.35, 0.6});
    EffectFinding beside_rolling = finalist(kDrag, 11.0, 0.98, {0.33, 0.7});
    beside_rolling.strength = 1.5;
    answers = {named_beside(beside_drag), named_beside(beside_rolling)};
    ASSERT_TRUE(explain());
    ASSERT_EQ(asked.size(), 2U);
    EXPECT_THAT(asked[1].calibrated, ElementsAre(0.35, DoubleEq(1.0 / kMostRolling)));
    EXPECT_EQ(asked[1].effects[kDrag].variants.size(), 1U) << "of all effects but that one";
    EXPECT_EQ(found.verdict, Verdict::Named);
    EXPECT_TRUE(found.together);
    ASSERT_EQ(found.answer.size(), 2U);
    EXPECT_EQ(found.answer[0].effect, kRolling);
    EXPECT_DOUBLE_EQ(found.answer[0].strength, 0.7 * kMostRolling);
    EXPECT_EQ(found.answer[1].effect, kDrag);
    EXPECT_EQ(found.answer[1].strength, 1.5);
    for (const EffectFinding& f : found.answer) {
        EXPECT_THAT(f.parameters, ElementsAre(0.33)) << "both with the same parameters";
        EXPECT_EQ(f.weight, 0.96) << "the smaller of the two";
        EXPECT_EQ(f.misfit, 11.0);
    }
    EXPECT_EQ(found.simulated_blocks, 1200);
}

// One effect by another formula than the catalogue's leaves a little of much, and a second takes that up.
TEST_F(SecondEffect, NoPairWhereTheSecondExplainsLittleOfTheWhole) {
    answers = {named_beside(finalist(kRolling, 12.0, 0.96, {0.35, 0.6})),
               named_beside(finalist(kDrag, 11.0, 0.98, {0.33, 0.7}))};
    found.score.q = 120.0;  // of which the drag alone leaves 20
    ASSERT_TRUE(explain());
    EXPECT_EQ(found.verdict, Verdict::Unknown);
    EXPECT_TRUE(found.answer.empty());
    EXPECT_EQ(asked.size(), 2U);

    asked.clear();
    found.score.q = 105.0;
    ASSERT_TRUE(explain());
    EXPECT_TRUE(found.together) << "9 of 85";
}

TEST_F(SecondEffect, NoneIsAskedForWhereItCouldExplainNoMoreThanLittle) {
    answers = {named_beside(finalist(kRolling, 12.0, 0.96, {0.35, 0.6}))};
    found.score.q = 230.0;  // a tenth of the 210 that the drag explains is more than it leaves
    ASSERT_TRUE(explain());
    EXPECT_EQ(asked.size(), 1U) << "but whether the first suffices is";
    EXPECT_EQ(found.verdict, Verdict::Unknown);

    asked.clear();
    found.findings[0].weight = 0.9;
    ASSERT_TRUE(explain());
    EXPECT_TRUE(asked.empty()) << "and that is not where it has rivals";
}

TEST_F(SecondEffect, WhatComesNearestBesideTheFirstIsAskedThoughItHasNoName) {
    Diagnosis beside = nothing_beside(0.5, 0.05);
    beside.verdict = Verdict::Unknown;
    beside.findings = {finalist(kBias, 15.0, 0.5, {0.3, 0.4}), finalist(kRolling, 12.0, 0.4, {0.35, 0.6})};
    answers = {beside, nothing_beside(0.5, 0.05)};
    ASSERT_TRUE(explain());
    ASSERT_EQ(asked.size(), 2U);
    EXPECT_TRUE(asked[1].effects[kRolling].variants.empty());
    EXPECT_EQ(found.verdict, Verdict::Unknown) << "nothing is missing beside that, so there are no two";
}

TEST_F(SecondEffect, WhatComesNearestIsHeldAgainstItsRivalsBeforeAPairIsNamed) {
    Diagnosis rivals = nothing_beside(0.5, 0.05);
    rivals.verdict = Verdict::Unknown;
    rivals.findings = {finalist(kRolling, 12.0, 0.4, {0.35, 0.6}), finalist(kBias, 12.5, 0.3, {0.3, 0.4})};
    const Diagnosis beside_rolling = named_beside(finalist(kDrag, 11.0, 0.98, {0.33, 0.7}));
    answers = {rivals, beside_rolling, rivals};
    ASSERT_TRUE(explain());
    ASSERT_EQ(asked.size(), 3U);
    EXPECT_TRUE(asked[2].effects[kDrag].variants.empty()) << "beside the other of the two";
    EXPECT_THAT(asked[2].calibrated, ElementsAre(0.33, DoubleEq(1.0 / kMostDrag)));
    EXPECT_EQ(found.verdict, Verdict::Unknown);
    EXPECT_TRUE(found.answer.empty());

    asked.clear();
    answers = {rivals, beside_rolling, named_beside(finalist(kRolling, 11.2, 0.96, {0.34, 0.5}))};
    ASSERT_TRUE(explain());
    EXPECT_TRUE(found.together);
    ASSERT_EQ(found.answer.size(), 2U);
    EXPECT_EQ(found.answer[0].effect, kRolling);
    EXPECT_EQ(found.answer[0].weight, 0.96);
    EXPECT_EQ(found.answer[1].weight, 0.96);
}

TEST_F(SecondEffect, NoPairWhereNoneIsNamedOrOneOfTheTwoHardlyActs) {
    const EffectFinding beside_drag = finalist(kRolling, 12.0, 0.96, {0.35, 0.6});
    EffectFinding gone = finalist(kDrag, 11.0, 0.98, {0.33, 0.01});
    answers = {named_beside(beside_drag), named_beside(gone)};
    ASSERT_TRUE(explain());
    EXPECT_EQ(found.verdict, Verdict::Unknown);

    asked.clear();
    answers = {named_beside(finalist(kRolling, 21.0, 0.96, {0.35, 0.6}))};
    ASSERT_TRUE(explain());
    EXPECT_EQ(asked.size(), 1U) << "it leaves more than the first alone";
    EXPECT_EQ(found.verdict, Verdict::Unknown);
    EXPECT_TRUE(found.answer.empty());
}

TEST_F(SecondEffect, NothingIsAskedWhereTheBestCouldHaveLeftAsMuch) {
    found.findings[0].p = 0.1;
    ASSERT_TRUE(explain());
    EXPECT_TRUE(asked.empty());
    found.findings[0].p = 0.01;
    for (EffectFinding& f : found.findings) f.finalist = false;
    ASSERT_TRUE(explain());
    EXPECT_TRUE(asked.empty()) << "nor where none was followed";
}

TEST_F(SecondEffect, StopsWhereADiagnosisWasStopped) {
    answers = {Diagnosis{}};
    answers[0].interrupted = true;
    EXPECT_FALSE(explain());
    asked.clear();
    answers = {named_beside(finalist(kRolling, 12.0, 0.96, {0.35, 0.6})), answers[0]};
    EXPECT_FALSE(explain());
    EXPECT_EQ(asked.size(), 2U);
    EXPECT_EQ(found.verdict, Verdict::Unknown);
}

}  // namespace
}  // namespace scree
