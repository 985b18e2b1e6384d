// SPDX-License-Identifier: GPL-3.0-or-later
// What the verdict says where there is no name for what is missing.
#include "cli/diagnose_words.hpp"

#include "cli/diagnose_models.hpp"
#include "cli/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace scree::cli {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// The model may be calibrated once more from where it was followed to: what was given stays what the site has.
TEST(DiagnoseWords, WhatWasGivenIsTheSites) {
    DiagnoseStudy study;
    study.keys.problem.parameters = {{"soil.waste.rolling", 0.0, 1.0, 0.04, false}};
    study.keys.problem.choices = {{"soil.waste.choice", {"first", "second"}, 1}};
    study.baseline.result.start = {{0.3}, {0}};
    study.baseline.point = {{0.2}, {0}};
    const auto rows = parameter_rows(study);
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows[1], (std::vector<std::string>{"soil.waste.rolling", "0.04", "0.2"}));
    EXPECT_EQ(rows[2], (std::vector<std::string>{"soil.waste.choice", "second", "first"}));
}

/// A rejected model with finalists of these weights, the first of which leaves what its own simulations leave with the chance p.
DiagnoseStudy unknown(const std::vector<double>& weights, double p) {
    DiagnoseStudy study;
    study.verdict = study.diagnosis.verdict = Verdict::Unknown;
    study.diagnosis.test.p = 0.002;
    study.diagnosis.weight_none = 0.96;
    study.diagnosis.weight_unnamed = 0.04;
    const std::array kinds{EffectKind::GroundDrag, EffectKind::ForestDrag, EffectKind::SlowMissed,
                           EffectKind::Roughness};
    for (std::size_t k = 0; k < weights.size(); ++k) {
        DiagnosisVariant v;
        v.kind = kinds[k];
        v.parameter = effect_info(kinds[k]).parameters.front().key;
        v.reference = 0.2;
        study.catalogue.candidates.push_back({effect_info(kinds[k]).name, "", false, {v}});
        EffectFinding& f = study.diagnosis.findings.emplace_back();
        f.effect = k;
        f.finalist = true;
        f.weight = weights[k];
        f.strength = 2.0;
        f.p = k == 0 ? p : 0.5;
        study.diagnosis.weight_none -= weights[k];
    }
    return study;
}

TEST(DiagnoseWords, ManyThatCouldBeItAreNoNamelessEffect) {
    EXPECT_EQ(verdict_sentence(unknown({0.5, 0.25, 0.15, 0.04}, 0.3)),
              "UNKNOWN: something is missing (p = 0.002), and these measurements do not say what: ground_drag "
              "(coefficient 0.4 1/s, weight 0.500), forest_drag (coefficient 0.4 kg/s, weight 0.250), slow_missed "
              "(least_speed 0.4 m/s, weight 0.150), something without a "
              "name (0.040), or chance (0.020)");
}

TEST(DiagnoseWords, WhatIsRatherChanceMayBeMissing) {
    EXPECT_EQ(verdict_sentence(unknown({0.15}, 0.3)),
              "UNKNOWN: something may be missing (p = 0.002), and these measurements do not say what: ground_drag "
              "(coefficient 0.4 1/s, weight 0.150), something without a name (0.040), or chance (0.810)");
}

TEST(DiagnoseWords, WhatComesNearestAndCannotBeIt) {
    EXPECT_EQ(verdict_sentence(unknown({0.99}, 0.005)),
              "UNKNOWN: something is missing (p = 0.002) that has no name in the catalogue; ground_drag (coefficient "
              "0.4 1/s) comes nearest, "
              "but only 0.5 % of its own simulations look as far off");
}

// What comes nearest is rejected by its own simulations, but something else is not: that must not be denied.
TEST(DiagnoseWords, ARejectedLeaderDoesNotSilenceTheOthers) {
    EXPECT_EQ(verdict_sentence(unknown({0.6, 0.3}, 0.005)),
              "UNKNOWN: something is missing (p = 0.002), and these measurements do not say what: forest_drag "
              "(coefficient 0.4 kg/s, weight 0.300), something without a name (0.040), or chance (0.060); ground_drag "
              "(coefficient 0.4 1/s) comes nearest, but only 0.5 % "
              "of its own simulations look as far off");
}

TEST(DiagnoseWords, AStrengthThatMayBeAnythingIsNotDetermined) {
    DiagnosisVariant drag;
    drag.kind = EffectKind::GroundDrag;
    drag.parameter = "coefficient";
    drag.reference = 1.0;
    drag.most = 4.0;
    DiagnosisCandidate candidate{"ground_drag", "", false, {drag}};
    AnsweredEffect e{&candidate, drag, {}, 2.0, {1.5, 2.5}};
    EXPECT_THAT(strength_text(e), HasSubstr("(95 %: 1.5 to 2.5)"));
    e.interval = {0.0, 4.0};
    EXPECT_THAT(strength_text(e), HasSubstr("(not determined, it may be anything that is searched: 0 to 4)"));
    EXPECT_FALSE(e.is_determined());
}

// Of a law on one soil it counts how fast blocks are there, and not how fast they get farther down.
TEST(DiagnoseWords, ALawWasSeenAtTheSpeedsOfItsGround) {
    DiagnosisVariant drag;
    drag.kind = EffectKind::GroundDrag;
    drag.soil = "loose";
    DiagnosisCandidate candidate{"ground_drag", "", false, {drag}};
    DiagnoseStudy study;
    study.verdict = Verdict::Named;
    AnswerFit& fit = study.answers.emplace_back();
    fit.effects.push_back({&candidate, drag, {}, 2.0, {1.5, 2.5}, 15.8});
    fit.campaign.blocks.resize(1);
    fit.campaign.blocks[0].mass = 500.0;
    fit.campaign.blocks[0].largest_speed = 22.7;
    EXPECT_THAT(diagnose_remarks(study), Contains(HasSubstr("95 % of them slower than 15.8 m/s on loose")));
}

TEST(DiagnoseWords, WhereTheThirdDimensionIsNearest3DSaysMore) {
    DiagnoseStudy study = unknown({0.9, 0.05}, 0.005);
    study.in_plane = true;
    EXPECT_THAT(diagnose_remarks(study), Not(Contains(HasSubstr("beside the third dimension"))));
    study.catalogue.candidates[1].variants[0].space = true;
    EXPECT_THAT(diagnose_remarks(study), Not(Contains(HasSubstr("beside the third dimension"))));
    study.catalogue.candidates[0].variants[0].space = true;
    EXPECT_THAT(
        diagnose_remarks(study),
        Contains(HasSubstr("confirm with model.dimension = 3, which also looks for what acts beside the third")));
    EXPECT_THAT(diagnose_remarks(study), Contains(HasSubstr("third_dimension has weight")));
    for (EffectFinding& f : study.diagnosis.findings) f.finalist = false;
    EXPECT_THAT(diagnose_remarks(study), Not(Contains(HasSubstr("third_dimension has weight")))) << "nobody asked";
}

// p is that of the model that was tested, which need not be the one that is told.
TEST(DiagnoseWords, NothingMissingWithOtherParametersThanTheCalibratedOnes) {
    DiagnoseStudy study = unknown({0.9}, 0.3);
    study.verdict = study.diagnosis.verdict = Verdict::None;
    study.keys.problem.parameters = {{"soil.a.friction", 0.3, 0.9, 0.5, false}};
    study.baseline.point = {{0.5}, {}};
    study.before.observables.emplace_back();
    study.diagnosis.parameters = {to_unit(study.keys.problem.parameters[0], 0.51)};
    EXPECT_THAT(verdict_sentence(study), StartsWith("NONE: the calibrated model could"));
    EXPECT_THAT(diagnose_remarks(study), Not(Contains(HasSubstr("p is that of"))));
    study.diagnosis.parameters = {to_unit(study.keys.problem.parameters[0], 0.7)};
    EXPECT_THAT(verdict_sentence(study),
                StartsWith("NONE: the model, with other parameters than the calibrated ones, could"));
    EXPECT_THAT(diagnose_remarks(study),
                Contains(HasSubstr("p is that of the model with soil.a.friction = 0.7 and not 0.5;")));
    study.before.overall.gap = 3.0;
    study.before.overall.chance = {0.5, 2.0};
    EXPECT_THAT(diagnose_remarks(study), Contains(HasSubstr("beyond chance as a whole (gap over all 3")));
}

TEST(DiagnoseWords, StopsInAStretchAreToldAsShares) {
    DiagnoseStudy study = unknown({0.9}, 0.3);
    const Column along{Quantity::Along, -1};
    study.diagnosis.residuals.push_back({ResidualKind::Window, along, {}, 20.0, 30.0});
    study.diagnosis.score.standardised = Eigen::VectorXd::Constant(1, 5.2);
    study.diagnosis.test.residual_p = Eigen::VectorXd::Constant(1, 0.001);
    ComparedObservable& o = study.before.observables.emplace_back();
    o.gap.observable.columns = {along};
    o.measured = {5.0, 20.0, 29.9, 30.0};
    o.simulated = {5.0, 6.0, 19.9, 25.0, 30.0, 41.0, 42.0, 43.0, 44.0, 45.0};
    EXPECT_THAT(where_sentences(study).front(),
                AllOf(HasSubstr("are more than simulated: 50 % measured, 10 % simulated (5.2")));
}

TEST(DiagnoseWords, AProbabilityHasTheDigitsThatItCanHave) {
    const auto text = [](double p) { return p_text(p); };
    EXPECT_EQ(text(0.504), "0.50");
    EXPECT_EQ(text(0.0471), "0.047");
    EXPECT_EQ(text(1.0 / 1000.0), "0.001");
    EXPECT_EQ(text(1.0 / 2000.0), "0.0005");
    EXPECT_EQ(text(1.0 / 10000.0), "0.0001");
    EXPECT_EQ(text(kNaN), "-");
}

TEST(DiagnoseWords, DepositZonesAreToldAsShares) {
    DiagnoseStudy study = unknown({0.9}, 0.3);
    study.zones = {"upper", "lower"};
    study.diagnosis.residuals.push_back({ResidualKind::Passed, {Quantity::InZone, 1}, {}, 0.0, 0.0});
    study.diagnosis.score.standardised = Eigen::VectorXd::Constant(1, -3.3);
    study.diagnosis.test.residual_p = Eigen::VectorXd::Constant(1, 0.005);
    study.before.zones = {{"upper", kNaN, {5, 20}, {60, 400}}, {"lower", kNaN, {10, 20}, {360, 400}}};
    EXPECT_THAT(where_sentences(study).front(),
                HasSubstr("share that stops in lower is lower than simulated: 50 % measured, 90 % simulated (3.3"));
}

// Single trees and a stand as a zone are one family, and each has words of its own.
TEST(DiagnoseWords, AFamilyIsDescribedByTheFormThatIsNamed) {
    DiagnoseStudy study = unknown({0.99}, 0.3);
    study.verdict = Verdict::Named;
    const DiagnosisCandidate forest{"forest_drag", effect_info(EffectKind::ForestDrag).title, false, {}};
    DiagnosisVariant trees;
    trees.kind = EffectKind::Trees;
    study.answers.emplace_back().effects.push_back({&forest, trees, {}, 1.0, {}});
    EXPECT_THAT(verdict_sentence(study), HasSubstr(effect_info(EffectKind::Trees).title));
    EXPECT_THAT(verdict_sentence(study), Not(HasSubstr(forest.title)));
}

/// Six blocks, of 100 kg and each twice the one before, and what was measured and simulated of them.
struct SixBlocks {
    DiagnoseStudy study = unknown({0.9}, 0.3);
    const Column first{Quantity::Speed, 0}, second{Quantity::Speed, 1};

    SixBlocks() {
        study.screens = {"ES1", "ES2"};
        study.diagnosis.test.residual_p = Eigen::VectorXd::Constant(1, 0.001);
        for (int k = 0; k < 6; ++k) {
            ObservedBlock b;
            b.mass = 100.0 * std::pow(2.0, k);
            b.size = {std::pow(4.0, k % 2), 1.0, 1.0};
            b.order = k;
            study.known_blocks.push_back(b);
        }
        for (ObservationTable* table : {&study.before.measured, &study.before.simulated}) {
            table->columns = {first, second};
            table->block = {0, 1, 2, 3, 4, 5};
        }
        for (const Column& c : {first, second}) {
            ComparedObservable& o = study.before.observables.emplace_back();
            o.gap.observable.columns = {c};
            o.unit = "m/s";
        }
    }
    void set(std::vector<std::vector<double>> measured, std::vector<std::vector<double>> simulated) {
        study.before.measured.values = std::move(measured);
        study.before.simulated.values = std::move(simulated);
    }
    std::string sentence(const Residual& residual, double z) {
        study.diagnosis.residuals = {residual};
        study.diagnosis.score.standardised = Eigen::VectorXd::Constant(1, z);
        return where_sentences(study).front();
    }
};

TEST(DiagnoseWords, EveryVerdictHasItsSentence) {
    DiagnoseStudy study = unknown({0.5, 0.45}, 0.3);
    study.verdict = Verdict::None;
    EXPECT_EQ(verdict_sentence(study),
              "NONE: the calibrated model could have produced these measurements (p = 0.002); nothing is missing that "
              "they could show");
    for (const DiagnosisCandidate& c : study.catalogue.candidates) {
        AnswerFit& fit = study.answers.emplace_back();
        fit.effects.push_back({&c, c.variants.front(), {}, 0.0, {}});
        fit.effects.back().variant.label = "linear";
        fit.model.result.held_out.loss = -1.0;
    }
    study.verdict = Verdict::Group;
    EXPECT_EQ(verdict_sentence(study), "GROUP: ground_drag or forest_drag; these measurements cannot tell them apart");
    const std::vector<std::string> remarks = diagnose_remarks(study);
    EXPECT_THAT(remarks, Contains(HasSubstr("site_extended_2.toml is the site with forest_drag")));
    EXPECT_THAT(remarks, Contains(StartsWith("ground_drag would show in "))) << "which measurement would tell";
    study.answers.pop_back();
    study.verdict = Verdict::Named;
    EXPECT_EQ(verdict_sentence(study), "NAMED: ground_drag, linear (soft ground, slow motion)");
    EXPECT_THAT(diagnose_remarks(study), Contains("the name is the best of 2 that were searched"));
    study.verdict = Verdict::DataProblem;
    EXPECT_EQ(verdict_sentence(study),
              "DATA PROBLEM: ground_drag, linear; check how it was measured before anything else");
    study.answers.clear();
    EXPECT_EQ(verdict_sentence(study), "DATA PROBLEM: the measurements cannot be used as they are");
}

TEST(DiagnoseWords, BetweenScreensNothingIsToldBesideNone) {
    DiagnoseStudy study = unknown({0.9}, 0.3);
    study.screens = {"ES1", "ES2"};
    study.innovations.push_back({0, 1, Quantity::Speed, 20, 8.0, 10.0, 0.4});
    EXPECT_THAT(innovation_sentences(study),
                testing::ElementsAre("from ES1 to ES2: speed [m/s] 8 measured, 10 simulated (20 blocks, 5 standard "
                                     "errors)"));
    study.verdict = Verdict::None;
    EXPECT_TRUE(innovation_sentences(study).empty());
    EXPECT_TRUE(innovation_rows(study).front().stands_out) << "the table has it";
}

// Parameters that are searched by ratios have moved by ratios; choices that were moved are told.
TEST(DiagnoseWords, WhatWasMovedIsTold) {
    DiagnoseStudy study = unknown({0.9}, 0.3);
    study.keys.problem.parameters = {{"soil.a.rolling", 0.002, 0.15, 0.05, true},
                                     {"soil.a.friction", 0.3, 0.9, 0.5, false}};
    study.keys.problem.choices = {{"blocks.shape", {"hull", "box"}, 0}};
    study.baseline.point = {{0.002, 0.5}, {0}};
    study.moved = MovedModel{{{0.009, 0.52}, {1}}, {}, {}};
    EXPECT_THAT(diagnose_remarks(study),
                Contains(HasSubstr("less is left over all with soil.a.rolling = 0.009 and not 0.002, "
                                   "blocks.shape = box and not hull: ")));
    study.moved->point = {{0.0021, 0.5}, {0}};
    EXPECT_THAT(diagnose_remarks(study), Contains(HasSubstr("with parameters that are nearly the calibrated")));
}

// Residuals count once the parameters fit the rest: means that are equal, or the other way round, say something else.
TEST(DiagnoseWords, MeansAreToldWhereTheySayWhatTheResidualSays) {
    SixBlocks test;
    const std::vector<double> measured{3.0, 4.0, 5.0, 5.0, 6.0, 7.0},
        other(6, 9.0);  // mean 5, a standard error of 0.58
    const auto sentence_with = [&](double factor, double shift, ResidualKind kind = ResidualKind::Level) {
        std::vector<double> simulated;
        for (const double v : measured) simulated.push_back(5.0 + shift + factor * (v - 5.0));
        test.set({measured, other}, {simulated, other});
        return test.sentence({kind, test.first, {}}, 3.85);
    };
    const std::string parameters = "speed at ES1 is larger than simulated, once the parameters fit the rest (3.85";
    EXPECT_THAT(sentence_with(1.0, 0.5), StartsWith(parameters));
    EXPECT_THAT(sentence_with(1.0, -0.5), StartsWith(parameters));
    EXPECT_THAT(sentence_with(1.0, -0.7),
                StartsWith("speed at ES1 is larger than simulated: mean 5 m/s measured, 4.3 m/s simulated (3.85"));
    EXPECT_THAT(
        sentence_with(0.5, 0.0, ResidualKind::Spread),
        StartsWith("spread of speed at ES1 is wider than simulated: standard deviation 1.41 m/s measured, 0.707 "
                   "m/s simulated (3.85"));
    EXPECT_THAT(sentence_with(0.8, 0.0, ResidualKind::Spread), HasSubstr("once the parameters fit the rest"));
}

TEST(DiagnoseWords, MeansAreOfTheBlocksThatPassed) {
    SixBlocks test;
    test.set({{10.0, 11.0, 9.0, kNaN, kNaN, kNaN}, std::vector<double>(6, 9.0)},
             {{8.0, 8.5, 7.5, 8.0, 8.0, kNaN}, std::vector<double>(6, 9.0)});
    EXPECT_THAT(test.sentence({ResidualKind::Level, test.first, {}}, 4.0),
                StartsWith("speed at ES1 is larger than simulated: mean 10 m/s measured, 8 m/s simulated (4"));
}

TEST(DiagnoseWords, TrendsAreToldPerDoubling) {
    SixBlocks test;
    const std::vector<double> steady{8.0, 8.1, 8.0, 8.1, 8.0, 8.1}, fast(6, 9.0);
    test.set({{10.0, 9.0, 8.0, 7.0, 6.0, 5.0}, fast}, {{8.0, 8.5, 9.0, 9.5, 10.0, 10.5}, fast});
    EXPECT_THAT(
        test.sentence({ResidualKind::MassTrend, test.first, {}}, -4.0),
        StartsWith("speed at ES1 falls more with mass than simulated: per doubling of the mass -1 m/s measured, "
                   "0.5 m/s simulated (4"));
    EXPECT_THAT(test.sentence({ResidualKind::OrderTrend, test.first, {}}, -4.0),
                StartsWith("speed at ES1 falls in the course of the test: per ten blocks -10 m/s measured, 5 m/s "
                           "simulated (4"));
    // the calibrated model's own numbers say the contrary
    EXPECT_THAT(test.sentence({ResidualKind::MassTrend, test.first, {}}, 4.0),
                StartsWith("speed at ES1 rises more with mass than simulated, once the parameters fit the rest (4"));
    // every second block is four times as long
    test.set({{8.0, 9.0, 8.0, 9.0, 8.0, 9.0}, fast}, {steady, fast});
    EXPECT_THAT(test.sentence({ResidualKind::ShapeTrend, test.first, {}}, 4.0),
                HasSubstr(": per doubling of L1/L3 0.5 m/s measured, 0.05 m/s simulated (4"));
    // nobody knows which block is which
    test.study.known_blocks.clear();
    EXPECT_THAT(test.sentence({ResidualKind::ShapeTrend, test.first, {}}, 4.0),
                StartsWith("speed at ES1 rises more with elongation than simulated (4"));
}

TEST(DiagnoseWords, WhatGoesTogetherIsToldAsCorrelation) {
    SixBlocks test;
    test.set({{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, {2.0, 4.0, 6.0, 8.0, 10.0, 12.0}},
             {{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, {3.0, 1.0, 2.0, 3.0, 1.0, 2.0}});
    EXPECT_THAT(test.sentence({ResidualKind::Together, test.first, test.second}, 4.0),
                HasSubstr("go together more than simulated: correlation 1 measured, -0.239 simulated (4"));
}

TEST(DiagnoseWords, BlocksAreHeldAgainstThoseThatWereAsFastBefore) {
    SixBlocks test;
    const std::vector<double> before{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
    test.set({before, {4.0, 5.2, 5.8, 7.0, 8.0, kNaN}}, {before, {2.0, 3.0, 4.0, 5.0, 6.0, 7.0}});
    EXPECT_THAT(test.sentence({ResidualKind::Innovation, test.second, {Quantity::Height, 0}}, 4.0),
                Not(HasSubstr("measured")))
        << "no such column";
    EXPECT_THAT(test.sentence({ResidualKind::Innovation, test.second, test.first}, 4.0),
                HasSubstr("is larger than simulated: mean 6 m/s measured, 4 m/s simulated (4"));
}

TEST(DiagnoseWords, ANameThatWasTakenBack) {
    DiagnoseStudy study = unknown({0.99}, 0.3);
    study.demoted = "the blocks held out are predicted no better with ground_drag than without";
    EXPECT_EQ(verdict_sentence(study),
              "UNKNOWN: something is missing (p = 0.002), but it gets no name: the blocks held out are "
              "predicted no better with ground_drag than without");
}

TEST(DiagnoseWords, WhereNoFoldHasAPointOfItsOwnNothingWasHeldOut) {
    DiagnoseStudy study = unknown({0.99}, 0.3);
    study.before.observables.emplace_back();
    study.baseline.result.folds.resize(3);
    study.baseline.result.held_out_was_seen = true;
    const auto said = Contains(StartsWith("every fold of the calibrated model ends at the point that all blocks"));
    EXPECT_THAT(diagnose_remarks(study), said);
    study.baseline.result.held_out_was_seen = false;
    EXPECT_THAT(diagnose_remarks(study), Not(said));
}

TEST(DiagnoseWords, AStrengthAndWhereItActs) {
    DiagnosisCandidate patch{"soil_patch", "", false, {}};
    DiagnosisVariant v;
    v.kind = EffectKind::SoilPatch;
    v.parameter = "rolling";
    v.start = 0.05;
    v.reference = 2.0;
    v.path = Stretch{0.0, 120.0};
    patch.variants.push_back(v);
    AnsweredEffect e;
    e.candidate = &patch;
    e.variant = v;
    e.variant.on = Stretch{29.24, 39.6};
    e.strength = 1.0;
    e.interval = {0.0, 2.0};
    e.finding.middle_deviation = 1.5;
    EXPECT_EQ(strength_text(e), "rolling 0.1 m (95 %: 0.05 to 0.2), its middle at 34.4 m (95 %: 31.5 to 37.4)");
    e.finding.middle_deviation = kNaN;
    EXPECT_EQ(strength_text(e), "rolling 0.1 m (95 %: 0.05 to 0.2), its middle at 34.4 m (95 %: 0 to 120)");
}

// What was found on one slope is no law of nature, and a place is none at all.
TEST(DiagnoseWords, HowFarItMayBeCarried) {
    const DiagnosisCandidate drag{"ground_drag", "", false, {}}, bias{"speed_error", "", true, {}};
    DiagnoseStudy study;
    study.verdict = Verdict::Named;
    AnswerFit& answer = study.answers.emplace_back();
    for (const double mass : {420.0, 1900.0}) {
        answer.campaign.blocks.emplace_back();
        answer.campaign.blocks.back().mass = mass;
        answer.campaign.blocks.back().largest_speed = 14.0;
    }
    AnsweredEffect e;
    e.variant.kind = EffectKind::GroundDrag;
    e.variant.parameter = "coefficient";
    const auto said = [&](const DiagnosisCandidate& candidate) {
        e.candidate = &candidate;
        answer.effects = {e};
        const std::vector<std::string> remarks = diagnose_remarks(study);
        return remarks.empty() ? std::string() : remarks.back();
    };
    EXPECT_THAT(said(drag), HasSubstr("blocks of 420 to 1900 kg"));
    EXPECT_THAT(said(drag), HasSubstr("it may be carried to ground like this"));
    EXPECT_THAT(said(bias), HasSubstr("says nothing of other slopes"));
    e.variant.on = Stretch{20.0, 30.0};
    EXPECT_THAT(said(drag), HasSubstr("belongs to that place"));
}

TEST(DiagnoseWords, NothingComesNear) {
    DiagnoseStudy study = unknown({}, 1.0);
    EXPECT_EQ(verdict_sentence(study),
              "UNKNOWN: something may be missing (p = 0.002) that has no name in the catalogue");
    study.diagnosis.weight_none = 0.04;
    EXPECT_EQ(verdict_sentence(study), "UNKNOWN: something is missing (p = 0.002) that has no name in the catalogue");
}

}  // namespace
}  // namespace scree::cli
