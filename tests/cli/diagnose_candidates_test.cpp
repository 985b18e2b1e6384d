// SPDX-License-Identifier: GPL-3.0-or-later
// What is searched for, as the core is told of it.
#include "cli/diagnose_candidates.hpp"

#include "cli/diagnose_models.hpp"
#include "cli/diagnose_study.hpp"
#include "cli/program.hpp"
#include "cli/site_file.hpp"
#include "cli/site_model.hpp"

#include <gtest/gtest.h>

#include <set>

namespace scree::cli {
namespace {

TEST(DiagnoseCandidates, BesideTheThirdDimensionNothingElseIsLookedFor) {
    const SiteFile site = read_site_file(test::quarry_a() / "site.toml", {"model.dimension=2"});
    bool in_space = false, others = false;
    for (const CandidateEffect& e : make_candidates(site, load_site(site), ObservedSite{}, {}, "").for_core()) {
        (e.name == kThirdDimension ? in_space : others) = true;
        EXPECT_EQ(e.second_beside, e.name != kThirdDimension) << e.name;
    }
    EXPECT_TRUE(in_space && others);
}

// Friction of the ground is the limit that a wet layer lowers: from wherever a calibration has put it.
TEST(DiagnoseCandidates, LowFrictionIsLowerThanTheGround) {
    const SiteFile site = read_site_file(test::quarry_a() / "site.toml", {"model.dimension=2"});
    std::size_t seen = 0;
    for (const DiagnosisCandidate& c : make_candidates(site, load_site(site), ObservedSite{}, {}, "").candidates)
        for (const DiagnosisVariant& v : c.variants) {
            if (v.kind != EffectKind::LowFriction) continue;
            ++seen;
            if (v.place.soil >= 0) {
                EXPECT_EQ(v.value(0.0), site.settings.soils[static_cast<std::size_t>(v.place.soil)].friction);
            }
            for (const double friction : {0.15, 0.3, 0.9}) {
                std::vector<Soil> soils(site.settings.soils.size());
                for (Soil& soil : soils) soil.friction = friction;
                const DiagnosisVariant there = v.on_ground(soils);
                EXPECT_DOUBLE_EQ(there.value(0.0), friction);
                EXPECT_LT(there.value(1.0), 0.7 * friction);
                EXPECT_LT(there.value(v.most), 0.3 * friction);
            }
            std::vector<Soil> soils(2);
            soils[0].friction = 0.9;
            soils[1].friction = 0.4;
            const double here = v.place.soil == 1 ? 0.4 : 0.9;  // of all soils the largest is lowered first
            EXPECT_DOUBLE_EQ(v.on_ground(soils).value(0.0), here) << v.label;
        }
    EXPECT_GT(seen, 0U);
}

// What a strength stands for is told as it was simulated: on the ground of the model that was tested, or that a finalist was followed to.
TEST(DiagnoseCandidates, StrengthsAreToldOnTheGroundThatTheyWereSimulatedOn) {
    DiagnoseStudy study;
    study.site = read_site_file(test::quarry_a() / "site.toml", {"model.dimension=2"});
    study.keys = read_free_keys(study.site, {"soil.*.friction=0.3:0.9"});
    study.baseline.point = {{0.8}, {}};
    study.diagnosis.parameters = {to_unit(study.keys.problem.parameters[0], 0.4)};
    const SiteFile calibrated = with_changes(study.site, study.keys.changes(study.baseline.point));
    study.catalogue = make_candidates(calibrated, load_site(study.site), ObservedSite{}, {}, "");
    std::size_t seen = 0;
    for (std::size_t e = 0; e < study.catalogue.candidates.size(); ++e)
        for (std::size_t v = 0; v < study.catalogue.candidates[e].variants.size(); ++v) {
            if (study.catalogue.candidates[e].variants[v].kind != EffectKind::LowFriction) continue;
            ++seen;
            EffectFinding f;
            f.effect = e;
            f.variant = f.seen_variant = v;
            EXPECT_DOUBLE_EQ(study.catalogue.variant(e, v, {}).value(0.0), 0.8);
            EXPECT_DOUBLE_EQ(study.variant_of(f).value(0.0), 0.4);
            EXPECT_DOUBLE_EQ(study.seen_variant_of(f).value(0.0), 0.4);
            f.finalist = true;
            f.parameters = {to_unit(study.keys.problem.parameters[0], 0.6)};
            EXPECT_DOUBLE_EQ(study.variant_of(f).value(0.0), 0.6);
        }
    EXPECT_GT(seen, 0U);
}

// A calibration may end where nothing bounces: what weakens the bounce may be missing where it does not.
TEST(DiagnoseCandidates, BouncesAreLookedForWhereverTheyAreFree) {
    const SiteFile site = read_site_file(test::quarry_a() / "site.toml", {"model.dimension=2", "soil.*.restitution=0"});
    const SiteModel model = load_site(site);
    const auto searched = [&](const FreeKeys& keys) {
        std::set<std::string> names;
        for (const DiagnosisCandidate& c : make_candidates(site, model, ObservedSite{}, keys, "").candidates)
            names.insert(c.name);
        for (const DiagnosisCandidate& c : make_forces(site, model, ObservedSite{}, keys).candidates)
            names.insert(c.name);
        return names;
    };
    const std::set<std::string> none = searched(read_free_keys(site, {"soil.*.friction=0.3:0.9"})),
                                free = searched(read_free_keys(site, {"soil.*.restitution=0:0.4"}));
    for (const char* name : {"restitution_half_speed", "bounces"}) {
        EXPECT_EQ(none.count(name), 0U) << name;
        EXPECT_EQ(free.count(name), 1U) << name;
    }
}

}  // namespace
}  // namespace scree::cli
