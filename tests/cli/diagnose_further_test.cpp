// SPDX-License-Identifier: GPL-3.0-or-later
// What follows from an answer: what it changes at the screens and on the way there, and what would have to be measured to know more.
#include "cli/diagnose_further.hpp"

#include "cli/diagnose_consequences.hpp"
#include "cli/further_instruments.hpp"
#include "cli/plane_layers.hpp"
#include "cli/program.hpp"
#include "cli/site_file.hpp"
#include "cli/site_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>

namespace scree::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const DiagnosisCandidate kDrag{"ground_drag", "", false, {}}, kPatch{"soil_patch", "", false, {}},
    kBias{"speed_error", "", true, {}};

/// Two effects of these visibilities at their reference strength, and the cosine between them.
Diagnosis plan(double first, double second, double cosine) {
    Diagnosis d;
    d.test.z_limit = 2.5;
    d.cosines.resize(2, 2);
    d.cosines << 1.0, cosine, cosine, 1.0;
    for (std::size_t e = 0; e < 2; ++e) {
        EffectFinding& f = d.findings.emplace_back();
        f.effect = e;
        f.visible = true;
        f.visibility = e == 0 ? first : second;
        f.smallest_seen = (d.test.z_limit + 0.8416) / f.visibility;
    }
    return d;
}

TEST(DiagnoseFurther, AGroupIsToldApartFromSoManyBlocksOn) {
    DiagnoseStudy study;
    study.verdict = Verdict::Group;
    study.blocks = 50;
    for (const DiagnosisCandidate* c : {&kDrag, &kPatch}) {
        study.answers.emplace_back().effects.push_back({c, {}, {}, 2.0, {}});  // of strength 2
    }
    // z of the difference: 2 * 2 * sqrt(1 - 0.81) = 1.74, so 50 (3 / 1.74)^2 = 148 blocks; 4 * sqrt(1 - 0.25) = 3.46 and 38 blocks; none
    study.further = {{"the same instruments", plan(2.0, 3.0, 0.9)},
                     {"spins at the screens", plan(2.0, 3.0, -0.5)},
                     {"heights at the screens", plan(2.0, 3.0, 1.0)}};
    EXPECT_THAT(
        telling_apart_sentences(study),
        ElementsAre("with the same instruments: told apart from about 150 blocks on",
                    "with spins at the screens: told apart from about 40 blocks on",
                    "with heights at the screens: not told apart by any number of blocks that is worth throwing"));
    study.planning = true;
    EXPECT_THAT(telling_apart_sentences(study), IsEmpty());
}

TEST(DiagnoseFurther, APlanCountsWhatMoreWouldShow) {
    DiagnoseStudy study;
    study.planning = true;
    study.catalogue.candidates = {kDrag, kPatch};
    study.diagnosis = plan(4.0, 4.0, 0.5);                            // of all forms, with their price
    study.further = {{"the same instruments", plan(4.0, 2.8, 0.95)},  // 3.34 are needed
                     {"spins at the screens", plan(5.0, 3.5, 0.7)},
                     {"twice as many blocks", plan(4.0, 2.8, 0.95), 2.0}};
    const std::vector<FurtherRow> rows = further_rows(study);
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows[0].seen, 1U);
    EXPECT_EQ(rows[0].alike, 1U);
    EXPECT_EQ(rows[1].seen, 2U);
    EXPECT_EQ(rows[1].alike, 0U);
    EXPECT_THAT(rows[1].also, ElementsAre("soil_patch"));
    EXPECT_EQ(rows[2].name, "with twice as many blocks");
    EXPECT_THAT(rows[2].also, ElementsAre("soil_patch")) << "2.8 sqrt(2) = 3.96";
    EXPECT_EQ(rows[2].alike, 1U) << "more blocks do not turn a fingerprint";
}

/// A campaign of so many blocks, and a test of 12 blocks that measured stops and speeds.
struct Quarry {
    SiteFile site;
    SiteModel model;
    ObservedSite observed;

    explicit Quarry(int dimension)
        : site(read_site_file(test::quarry_a() / "site.toml",
                              {"model.dimension=" + std::to_string(dimension), "release.count=12"})),
          model(load_site(site)),
          observed(planned_test(site, model, "stops,speed")) {}

    CampaignResult run(double rolling, std::int64_t blocks = 60, std::size_t impacts = 0) const {
        CampaignInput input = model.campaign;
        input.impacts = static_cast<std::int32_t>(impacts);
        for (Soil& soil : input.soils) soil.rolling = rolling;
        input.release.count = blocks;
        const std::atomic<bool> stop{false};
        return run_campaign(
            input, [](std::int64_t) {}, stop);
    }
    DiagnoseStudy answered(const DiagnosisCandidate& candidate) const {
        DiagnoseStudy study;
        study.verdict = Verdict::Named;
        study.screens = observed.op.screens;
        study.screen_of = observed.op.screen_of;
        study.campaign = run(0.02);
        study.answers.emplace_back().effects.push_back({&candidate, {}, {}, 1.0, {}});
        study.answers.back().campaign = run(0.3);
        return study;
    }
};

TEST(DiagnoseFurther, SaysWhatChangesAtTheScreens) {
    const Quarry quarry(2);
    const DiagnoseStudy study = quarry.answered(kDrag);
    const std::vector<ScreenChange> changes = changes_at_screens(study, 0);
    ASSERT_EQ(changes.size(), quarry.observed.op.screens.size());
    for (std::size_t s = 0; s < changes.size(); ++s) {
        std::set<std::int64_t> passed;
        double fastest = 0.0;
        for (const ScreenCrossing& c : study.campaign.crossings) {
            if (study.screen_of[static_cast<std::size_t>(c.screen)] != static_cast<std::int32_t>(s)) continue;
            passed.insert(c.block);
            fastest = std::max(fastest, c.velocity.norm());
        }
        EXPECT_DOUBLE_EQ(changes[s].before.passed, static_cast<double>(passed.size()) / 60.0);
        EXPECT_LE(changes[s].before.speed, fastest);
        EXPECT_LE(changes[s].after.passed, changes[s].before.passed) << "held back by the ground";
    }
    EXPECT_LT(changes.back().after.passed, changes.back().before.passed);
    EXPECT_THAT(changes_at_screens(quarry.answered(kBias), 0), IsEmpty())
        << "a fault of the measurement moves no block";

    DiagnoseStudy two = study;
    two.answers.push_back(two.answers.front());
    EXPECT_THAT(changes_at_screens(two, 1), IsEmpty()) << "only the best is named";
    two.verdict = Verdict::Group;
    EXPECT_EQ(changes_at_screens(two, 1).size(), changes.size()) << "any member of a group may be at work";
    two.verdict = Verdict::Unknown;
    EXPECT_THAT(changes_at_screens(two, 0), IsEmpty());
}

TEST(DiagnoseFurther, ReachIsAShareOfTheBlocksOfThatProfile) {
    CampaignResult result;
    for (const auto& [profile, done] : {std::pair{0, true}, {1, true}, {0, true}, {0, false}}) {
        result.blocks.emplace_back();
        result.blocks.back().profile = profile;
        result.blocks.back().done = done;
    }
    EXPECT_EQ(blocks_thrown_on(result, 0), 2.0);
    EXPECT_EQ(blocks_thrown_on(result, 1), 1.0);
}

TEST(DiagnoseFurther, DrawsHowFarBlocksComeBeforeAndAfter) {
    const Quarry plane(2), space(3);
    const std::vector<Figure> curves = consequence_figures(plane.answered(kDrag), plane.model, plane.observed);
    ASSERT_EQ(curves.size(), 1U);
    EXPECT_THAT(curves[0].svg, HasSubstr("Reach probability [%]"));
    EXPECT_THAT(curves[0].svg, HasSubstr("with ground_drag"));
    const std::vector<Figure> maps = consequence_figures(space.answered(kDrag), space.model, space.observed);
    ASSERT_EQ(maps.size(), 2U);
    EXPECT_EQ(maps[0].file, "reach_calibrated.svg");
    EXPECT_EQ(maps[1].file, "reach_extended.svg");
    for (const Figure& f : maps) EXPECT_THAT(f.svg, HasSubstr("reach probability per cell"));
}

TEST(DiagnoseFurther, AnInstrumentAddsItsColumnsAlone) {
    const Quarry quarry(2);
    const std::vector<FurtherInstrument> all = further_instruments(quarry.observed);
    ASSERT_EQ(all.size(), 4U) << "heights, spins, both; impacts";
    EXPECT_EQ(all[0].name, "heights at the screens");
    EXPECT_EQ(all[2].name, "heights and spins at the screens");
    EXPECT_EQ(all[3].name, "films of the first 3 impacts");
    ObservedSite filmed = quarry.observed;
    filmed.op.add_impacts(all[3].impacts);
    const ObservedSite more =
        with_instruments(filmed, all, quarry.run(0.05, 12, all[3].impacts), quarry.site.settings.observed);
    const ObservationTable table = measured_table(more.observations, more.op),
                           as_it_is = measured_table(quarry.observed.observations, quarry.observed.op),
                           heights = with_one_instrument(table, quarry.observed, all[0]),
                           impacts = with_one_instrument(table, quarry.observed, all[3]),
                           nothing = with_one_instrument(table, quarry.observed, {"nothing", {}, 0});
    EXPECT_EQ(nothing.columns, as_it_is.columns);
    EXPECT_EQ(heights.columns.size(), as_it_is.columns.size() + quarry.observed.op.screens.size());
    ASSERT_EQ(impacts.columns.size(), as_it_is.columns.size() + 12) << "speed and rise, before and after, three times";
    const std::size_t rise =
        impacts.find({Quantity::Rise, static_cast<std::int32_t>(quarry.observed.op.screens.size())});
    ASSERT_LT(rise, impacts.columns.size());
    EXPECT_GT(std::count_if(impacts.values[rise].begin(), impacts.values[rise].end(),
                            [](double v) { return std::isfinite(v) && v < -5.0; }),
              6)
        << "as in the simulation, where blocks fall from 4 m: states that nothing simulated is like say nothing";
    const std::size_t height = heights.find({Quantity::Height, 0});
    ASSERT_LT(height, heights.columns.size());
    std::set<double> different;
    for (const double v : heights.values[height])
        if (std::isfinite(v)) different.insert(v);
    EXPECT_GT(different.size(), 3U);
    for (std::size_t k = 0; k < nothing.columns.size(); ++k)
        for (std::size_t row = 0; row < nothing.rows(); ++row)
            EXPECT_EQ(std::isnan(nothing.values[k][row]), std::isnan(as_it_is.values[k][row]));
    EXPECT_THAT(further_instruments(more), IsEmpty()) << "all there is, is measured";
}

}  // namespace
}  // namespace scree::cli
