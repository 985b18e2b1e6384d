// SPDX-License-Identifier: GPL-3.0-or-later
// The site file that a diagnosis writes: where it looks for what.
#include "cli/diagnose_extended.hpp"

#include "cli/diagnose_report.hpp"
#include "cli/program.hpp"
#include "cli/site_file.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scree::cli {
namespace {

using namespace scree::test;
using testing::HasSubstr;
namespace fs = std::filesystem;

const DiagnosisCandidate kDrag{"ground_drag", "", false, {}}, kForest{"forest_drag", "", false, {}},
    kSpace{"third_dimension", "", false, {}};

/// A diagnosis of the site that names this.
DiagnoseStudy named(const fs::path& site, const DiagnosisCandidate& candidate, const DiagnosisVariant& variant) {
    DiagnoseStudy study;
    study.site = read_site_file(site, {});
    study.verdict = Verdict::Named;
    study.answers.emplace_back().effects.push_back({&candidate, variant, {}, 1.0, {}});
    return study;
}

// Every diagnosis keeps its places in its own results: the second must not take those of the first for its own.
TEST(DiagnoseExtended, MayBeDiagnosedAgain) {
    const TempDir folder;
    const fs::path first = folder / "first", second = folder / "second";
    for (const fs::path& f : {first, second}) fs::create_directories(f);
    DiagnosisVariant placed;
    placed.parameter = "coefficient";
    placed.reference = 1.0;
    placed.on = Stretch{40.0, 55.0};
    put(first / "site_extended.toml", extended_toml(named(quarry_a() / "site.toml", kDrag, placed), 0, first));
    const SiteFile once = read_site_file(first / "site_extended.toml", {});
    ASSERT_EQ(once.settings.effects.size(), 1U);
    EXPECT_EQ(once.settings.effects[0].place.file, "results.gpkg") << "both may be moved together";
    EXPECT_EQ(once.settings.effects[0].place.layer, "effect_zone");

    put(second / "site_extended.toml", extended_toml(named(first / "site_extended.toml", kDrag, placed), 0, second));
    const SiteFile twice = read_site_file(second / "site_extended.toml", {});
    ASSERT_EQ(twice.settings.effects.size(), 2U);
    EXPECT_EQ(twice.resolve(twice.settings.effects[0].place.file), first / "results.gpkg");
    EXPECT_EQ(twice.resolve(twice.settings.effects[1].place.file), second / "results.gpkg");
    EXPECT_EQ(twice.resolve(twice.settings.dtm), once.resolve(once.settings.dtm));
}

// A folder that is named without a path, and that a diagnosis is still to make.
TEST(DiagnoseExtended, ItsPathsAreRelativeBeforeItsFolderIsThere) {
    DiagnosisVariant space;
    space.space = true;
    const std::string text = extended_toml(named(quarry_a() / "site.toml", kSpace, space), 0, "not_there_yet");
    EXPECT_THAT(text, HasSubstr("dtm = '../"));
    EXPECT_THAT(text, HasSubstr("quarry_a/data/dtm.tif'"));
}

// No member of a group is more than a guess: each has a file that says so and leads to its own place.
TEST(DiagnoseExtended, EveryMemberOfAGroupHasAFile) {
    const TempDir folder;
    DiagnosisVariant placed;
    placed.parameter = "coefficient";
    placed.reference = 1.0;
    placed.on = Stretch{40.0, 55.0};
    DiagnoseStudy study = named(quarry_a() / "site.toml", kDrag, placed);
    placed.kind = EffectKind::ForestDrag;
    study.answers.emplace_back().effects.push_back({&kForest, placed, {}, 2.0, {}});
    EXPECT_EQ(study.site_files(), 0U) << "measurements that cannot be used";
    study.before.observables.emplace_back();
    EXPECT_EQ(study.site_files(), 1U);
    study.verdict = Verdict::Group;
    ASSERT_EQ(study.site_files(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
        const fs::path file = folder.path() / extended_name(k);
        put(file, extended_toml(study, k, folder.path()));
        EXPECT_THAT(text_of(file), HasSubstr("# This file has " + study.answers[k].name() + ".\n"));
        EXPECT_THAT(text_of(file), HasSubstr("site_extended_2.toml is the site with forest_drag"));
        const SiteFile site = read_site_file(file, {});
        ASSERT_EQ(site.settings.effects.size(), 1U);
        EXPECT_EQ(site.settings.effects[0].effect.kind, study.answers[k].effects[0].variant.kind);
        EXPECT_EQ(site.settings.effects[0].place.layer, k == 0 ? "effect_zone" : "effect_zone_2");
    }
    study.verdict = Verdict::Unknown;
    EXPECT_EQ(study.site_files(), 1U) << "of the model that was tested";
    EXPECT_EQ(study.answer(), nullptr);
}

// Without an answer: calibrated values, unless others left less over all.
TEST(DiagnoseExtended, WithoutAnAnswerItHasWhatLeavesLeast) {
    const TempDir folder;
    DiagnoseStudy study;
    study.site = read_site_file(quarry_a() / "site.toml", {});
    study.keys = read_free_keys(study.site, {"soil.compact waste.rolling=0.01:0.3:log"});
    study.verdict = Verdict::Unknown;
    Gap& before = study.before.observables.emplace_back().gap.pooled;
    before.gap = 3.0;
    before.distance = 6.0;
    before.floor = 2.0;
    study.baseline.point.values = {0.25};
    study.diagnosis.parameters = {0.5};
    study.diagnosis.score.shift = Eigen::VectorXd::Constant(1, 0.2);
    EXPECT_NEAR(study.tested_point().values[0], 0.01 * std::pow(30.0, 0.5), 1e-12);
    EXPECT_NEAR(study.asked_point().values[0], 0.01 * std::pow(30.0, 0.7), 1e-12) << "a step along ratios";
    study.diagnosis.score.shift[0] = 0.9;
    EXPECT_EQ(study.asked_point().values[0], 0.3) << "the end of the range";
    EXPECT_THAT(extended_toml(study, 0, folder.path()), HasSubstr("rolling = 0.25\n"));
    study.moved = MovedModel{study.asked_point(), {}, {}};
    study.moved->study.observables = study.before.observables;
    Gap& told = study.moved->study.observables.front().gap.pooled;
    told.distance = 4.0;
    told.floor = 1.0;
    told.gap = 4.0;
    const std::string moved = extended_toml(study, 0, folder.path());
    EXPECT_THAT(moved, HasSubstr("rolling = 0.3\n"));
    EXPECT_THAT(moved, HasSubstr("rolling = 0.3 and not 0.25"));
    EXPECT_THAT(moved, HasSubstr("mean distance 2.00, of the calibrated model 3.00"));
}

TEST(DiagnoseExtended, KeepsItsScreensIn3D) {
    const TempDir folder;
    const fs::path first = folder / "first", second = folder / "second";
    for (const fs::path& f : {first, second}) fs::create_directories(f);
    DiagnosisVariant space;
    space.space = true;
    put(first / "site_extended.toml", extended_toml(named(quarry_a() / "site.toml", kSpace, space), 0, first));
    const SiteFile once = read_site_file(first / "site_extended.toml", {});
    EXPECT_EQ(once.settings.dimension, 3);
    EXPECT_EQ(once.settings.screens.file, "results.gpkg");
    EXPECT_EQ(once.settings.screens.layer, kScreensInSpace);

    DiagnoseStudy nothing;
    nothing.site = once;
    put(second / "site_extended.toml", extended_toml(nothing, 0, second));
    const SiteFile twice = read_site_file(second / "site_extended.toml", {});
    EXPECT_EQ(twice.resolve(twice.settings.screens.file), first / "results.gpkg");
    EXPECT_EQ(twice.settings.screens.layer, kScreensInSpace);
}

}  // namespace
}  // namespace scree::cli
