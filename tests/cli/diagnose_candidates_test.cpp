// SPDX-License-Identifier: GPL-3.0-or-later
// What is searched for, as the core is told of it.
#include "cli/diagnose_candidates.hpp"

#include "cli/program.hpp"
#include "cli/site_file.hpp"
#include "cli/site_model.hpp"

#include <gtest/gtest.h>

namespace scree::cli {
namespace {

TEST(DiagnoseCandidates, BesideTheThirdDimensionNothingElseIsLookedFor) {
    const SiteFile site = read_site_file(test::quarry_a() / "site.toml", {"model.dimension=2"});
    bool in_space = false, others = false;
    for (const CandidateEffect& e : make_candidates(site, load_site(site), ObservedSite{}, "").for_core()) {
        (e.name == kThirdDimension ? in_space : others) = true;
        EXPECT_EQ(e.second_beside, e.name != kThirdDimension) << e.name;
    }
    EXPECT_TRUE(in_space && others);
}

// Friction of the ground is the limit that a wet layer lowers: from wherever a calibration has put it.
TEST(DiagnoseCandidates, LowFrictionIsLowerThanTheGround) {
    const SiteFile site = read_site_file(test::quarry_a() / "site.toml", {"model.dimension=2"});
    std::size_t seen = 0;
    for (const DiagnosisCandidate& c : make_candidates(site, load_site(site), ObservedSite{}, "").candidates)
        for (const DiagnosisVariant& v : c.variants) {
            if (v.kind != EffectKind::LowFriction) continue;
            ++seen;
            for (const double friction : {0.15, 0.3, 0.9}) {
                std::vector<Soil> soils(1);
                soils[0].friction = friction;
                const DiagnosisVariant there = v.on_ground(soils);
                EXPECT_DOUBLE_EQ(there.value(0.0), friction);
                EXPECT_LT(there.value(1.0), 0.7 * friction);
                EXPECT_LT(there.value(v.most), 0.3 * friction);
            }
        }
    EXPECT_GT(seen, 0U);
}

}  // namespace
}  // namespace scree::cli
