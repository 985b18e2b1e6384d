// SPDX-License-Identifier: GPL-3.0-or-later
// Thirty blocks on a slope like path A of the paper against the reference's outcomes: where they stop and how fast they are. Single paths part after a few
// impacts, so distributions are compared. The same comparison must reject another soil, or it would mean nothing: 30 blocks of the reference tell samples
// apart that differ by about 0.9 of a standard deviation. The numbers of a larger run are in tests/validation/README.md.
#include "support/block_set.hpp"
#include "support/paths.hpp"
#include "support/two_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree::test {

namespace {

constexpr std::int64_t kCopies = 4;  ///< of each block, for a sharper distribution on our side [-]

struct PathA {
    std::unique_ptr<Surface> surface;
    std::vector<ThrownBlock> blocks;
    std::vector<Outcome> reference;
    Soil soil{"slope", 0.0, 0.5, 0.04};

    explicit PathA(const std::filesystem::path& folder)
        : surface(read_node_grid(folder / "path_a.asc")),
          blocks(read_blocks(folder / "path_a_blocks")),
          reference(read_outcomes(folder / "path_a_blocks/outcomes.csv", "exact vertex contact")) {}

    std::vector<Outcome> thrown(DynamicsSettings settings, std::int64_t copies = kCopies) const {
        settings.time_limit = 15.0;
        std::vector<Outcome> outcomes;
        for (std::size_t b = 0; b < blocks.size(); ++b)
            for (std::int64_t copy = 0; copy < copies; ++copy)
                outcomes.push_back(throw_block(copy_of(blocks[b], b, copy), *surface, {soil}, settings, Course{}));
        return outcomes;
    }
};

DynamicsSettings paper_scheme(bool vertices_only) {
    DynamicsSettings settings;
    settings.mode = SteppingMode::MoreauJean;
    settings.time_step = 1e-3;
    settings.vertices_only = vertices_only;
    return settings;
}

/// Kolmogorov-Smirnov, and the difference of the medians within its bootstrap interval, for each of the five observables at this level.
void expect_same_distributions(const std::vector<Outcome>& ours, const std::vector<Outcome>& reference, double level) {
    for (std::size_t k = 0; k < kObservables.size(); ++k) {
        const auto a = values_of(ours, k), b = values_of(reference, k);
        const double distance = ks_distance(a, b);
        EXPECT_GT(ks_probability(distance, static_cast<int>(a.size()), static_cast<int>(b.size())), level)
            << kObservables[k] << ": distance " << distance;
        const auto difference = bootstrap_median_difference(a, b, 1.0 - level);
        EXPECT_LE(difference[0], 0.0) << kObservables[k] << ": medians " << median(a) << ", " << median(b);
        EXPECT_GE(difference[1], 0.0) << kObservables[k] << ": medians " << median(a) << ", " << median(b);
    }
    EXPECT_EQ(std::count_if(ours.begin(), ours.end(), [](const Outcome& o) { return o.reason == StopReason::Failed; }),
              0);
}

}  // namespace

TEST(PathABlocks, SameSchemeSameContactsSameDistributions) {
    SCREE_SHARED_OR_SKIP(folder, "reference");
    const PathA path(folder);
    ASSERT_EQ(path.blocks.size(), 30U);
    ASSERT_EQ(path.reference.size(), 30U);
    expect_same_distributions(path.thrown(paper_scheme(true)), path.reference, 0.01);
}

// Another law of contact, so a lower level: it need not agree exactly.
TEST(PathABlocks, ContactsOfCrestsKeepTheDistributions) {
    SCREE_SHARED_OR_SKIP(folder, "reference");
    const PathA path(folder);
    expect_same_distributions(path.thrown(paper_scheme(false)), path.reference, 0.001);
}

// The default mode goes about a metre farther than the scheme of the reference, which has not converged at its step; 30 blocks do not show that.
TEST(PathABlocks, EventModeKeepsTheDistributions) {
    SCREE_SHARED_OR_SKIP(folder, "reference");
    const PathA path(folder);
    expect_same_distributions(path.thrown(DynamicsSettings{}), path.reference, 0.001);
}

// Solved to rounding, some blocks stay with the reference to the foot of the first cut: six pass it within 1 cm/s. Speeds there
// spread by 1 m/s, so chance would give none or one.
TEST(PathABlocks, SomePathsAreFollowedToTheFirstCut) {
    SCREE_SHARED_OR_SKIP(folder, "reference");
    const PathA path(folder);
    DynamicsSettings settings = paper_scheme(true);
    settings.solver.tolerance = 1e-12;
    const auto ours = path.thrown(settings, 1);
    int followed = 0;
    for (std::size_t b = 0; b < ours.size(); ++b)
        followed += std::abs(ours[b].line_speed[0] - path.reference[b].line_speed[0]) < 0.01;
    RecordProperty("followed", followed);
    EXPECT_GE(followed, 3);
}

TEST(PathABlocks, AnotherSoilIsRejected) {
    SCREE_SHARED_OR_SKIP(folder, "reference");
    PathA path(folder);
    const auto probability = [&] {
        const auto a = values_of(path.thrown(DynamicsSettings{}), 0), b = values_of(path.reference, 0);
        return ks_probability(ks_distance(a, b), static_cast<int>(a.size()), static_cast<int>(b.size()));
    };
    path.soil.rolling = 0.08;
    EXPECT_LT(probability(), 0.001) << "stops with twice the rolling resistance";
    path.soil.rolling = 0.04;
    path.soil.friction = 0.3;
    EXPECT_LT(probability(), 0.001) << "stops with little friction";
}

}  // namespace scree::test
