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

}  // namespace
}  // namespace scree::cli
