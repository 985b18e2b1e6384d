// SPDX-License-Identifier: GPL-3.0-or-later
// The site file that a diagnosis writes: where it looks for what.
#include "cli/diagnose_report.hpp"
#include "cli/program.hpp"
#include "cli/site_file.hpp"
#include "support/paths.hpp"

#include <gtest/gtest.h>

namespace scree::cli {
namespace {

using namespace scree::test;
namespace fs = std::filesystem;

const DiagnosisCandidate kDrag{"ground_drag", "", false, {}}, kSpace{"third_dimension", "", false, {}};

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
    put(first / "site_extended.toml", extended_toml(named(quarry_a() / "site.toml", kDrag, placed), first));
    const SiteFile once = read_site_file(first / "site_extended.toml", {});
    ASSERT_EQ(once.settings.effects.size(), 1U);
    EXPECT_EQ(once.settings.effects[0].place.file, "results.gpkg") << "both may be moved together";
    EXPECT_EQ(once.settings.effects[0].place.layer, zone_name(0));

    put(second / "site_extended.toml", extended_toml(named(first / "site_extended.toml", kDrag, placed), second));
    const SiteFile twice = read_site_file(second / "site_extended.toml", {});
    ASSERT_EQ(twice.settings.effects.size(), 2U);
    EXPECT_EQ(twice.resolve(twice.settings.effects[0].place.file), first / "results.gpkg");
    EXPECT_EQ(twice.resolve(twice.settings.effects[1].place.file), second / "results.gpkg");
    EXPECT_EQ(twice.resolve(twice.settings.dtm), once.resolve(once.settings.dtm));
}

TEST(DiagnoseExtended, KeepsItsScreensIn3D) {
    const TempDir folder;
    const fs::path first = folder / "first", second = folder / "second";
    for (const fs::path& f : {first, second}) fs::create_directories(f);
    DiagnosisVariant space;
    space.space = true;
    put(first / "site_extended.toml", extended_toml(named(quarry_a() / "site.toml", kSpace, space), first));
    const SiteFile once = read_site_file(first / "site_extended.toml", {});
    EXPECT_EQ(once.settings.dimension, 3);
    EXPECT_EQ(once.settings.screens.file, "results.gpkg");
    EXPECT_EQ(once.settings.screens.layer, kScreensInSpace);

    DiagnoseStudy nothing;
    nothing.site = once;
    put(second / "site_extended.toml", extended_toml(nothing, second));
    const SiteFile twice = read_site_file(second / "site_extended.toml", {});
    EXPECT_EQ(twice.resolve(twice.settings.screens.file), first / "results.gpkg");
    EXPECT_EQ(twice.settings.screens.layer, kScreensInSpace);
}

}  // namespace
}  // namespace scree::cli
