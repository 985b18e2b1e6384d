// SPDX-License-Identifier: GPL-3.0-or-later
// The statistics that other tests rest on, against values worked out by hand or tabulated.
#include "support/two_samples.hpp"

#include "scree/base/random.hpp"

#include <gtest/gtest.h>

namespace scree::test {

TEST(TwoSamples, DistanceIsTheLargestStep) {
    EXPECT_DOUBLE_EQ(ks_distance({1.0, 2.0, 3.0}, {4.0, 5.0}), 1.0);
    EXPECT_DOUBLE_EQ(ks_distance({1.0, 3.0}, {2.0, 4.0}), 0.5);
    EXPECT_DOUBLE_EQ(ks_distance({1.0, 2.0, 2.0, 5.0}, {2.0, 5.0, 1.0, 2.0}), 0.0);
}

// n = m = 2: of the six orders, two are wholly apart (D = 1), all have D >= 1/2.
TEST(TwoSamples, ProbabilityCountsPaths) {
    EXPECT_NEAR(ks_probability(1.0, 2, 2), 2.0 / 6.0, 1e-12);
    EXPECT_NEAR(ks_probability(0.5, 2, 2), 1.0, 1e-12);
    EXPECT_NEAR(ks_probability(1.0, 3, 4), 2.0 / 35.0, 1e-12);
}

// Tables of the two-sample test (Massey 1952, Ann. Math. Stat. 23): for n = m = 30 the distance 13/30 is beyond the 1 % limit, 12/30 is not.
TEST(TwoSamples, ProbabilityMatchesTables) {
    EXPECT_LT(ks_probability(13.0 / 30.0, 30, 30), 0.01);
    EXPECT_GT(ks_probability(12.0 / 30.0, 30, 30), 0.01);
}

TEST(TwoSamples, QuantilesLieBetweenMembers) {
    EXPECT_DOUBLE_EQ(median({3.0, 1.0, 2.0}), 2.0);
    EXPECT_DOUBLE_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
    EXPECT_DOUBLE_EQ(quantile({0.0, 10.0}, 0.05), 0.5);
    EXPECT_THROW(quantile({}, 0.5), std::invalid_argument);
}

// The median of n normal values has a standard error of sqrt(pi / (2 n)): 0.0396 for 1000, the interval is 3.92 of them wide. The bootstrap's own error for
// that n is about a tenth of it.
TEST(TwoSamples, BootstrapKnowsTheErrorOfAMedian) {
    RandomStream random(3, 1, RandomPurpose::Resampling);
    std::vector<double> a, b;
    for (int i = 0; i < 1000; ++i) {
        a.push_back(random.normal());
        b.push_back(5.0 + random.normal());
    }
    const auto one = bootstrap_median(a, 0.95);
    EXPECT_NEAR(one[1] - one[0], 3.92 * 0.0396, 0.04);
    const auto two = bootstrap_median_difference(a, b, 0.95);
    EXPECT_NEAR(two[1] - two[0], 3.92 * 0.0396 * 1.414, 0.06);
    EXPECT_NEAR(0.5 * (two[0] + two[1]), -5.0, 0.15);
}

}  // namespace scree::test
