// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/base/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace scree {

TEST(RandomStream, SameKeySameNumbers) {
    RandomStream a(7, 17, RandomPurpose::Shape);
    RandomStream b(7, 17, RandomPurpose::Shape);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(a.bits(), b.bits());
}

TEST(RandomStream, StreamsDifferInSeedStreamAndPurpose) {
    std::set<std::uint64_t> first;
    for (std::uint64_t seed : {0u, 1u}) {
        for (std::uint64_t stream : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 32}) {
            for (auto purpose : {RandomPurpose::Block, RandomPurpose::Shape})
                first.insert(RandomStream(seed, stream, purpose).bits());
        }
    }
    EXPECT_EQ(first.size(), 12u);
}

TEST(RandomStream, MomentsAreThoseOfTheDistributions) {
    RandomStream r(1, 2, RandomPurpose::Block);
    const int n = 200000;
    double sum = 0, sum2 = 0, nsum = 0, nsum2 = 0;
    for (int i = 0; i < n; ++i) {
        const double u = r.uniform();
        ASSERT_GE(u, 0.0);
        ASSERT_LT(u, 1.0);
        sum += u;
        sum2 += u * u;
        const double z = r.normal();
        nsum += z;
        nsum2 += z * z;
    }
    // five standard errors
    EXPECT_NEAR(sum / n, 0.5, 5 * std::sqrt(1.0 / 12 / n));
    EXPECT_NEAR(sum2 / n, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / n));
    EXPECT_NEAR(nsum / n, 0.0, 5 / std::sqrt(n));
    EXPECT_NEAR(nsum2 / n, 1.0, 5 * std::sqrt(2.0 / n));
}

TEST(RandomStream, BelowIsUniform) {
    RandomStream r(3, 4, RandomPurpose::Block);
    int counts[3] = {};
    const int n = 90000;
    for (int i = 0; i < n; ++i) ++counts[r.below(3)];
    for (int c : counts) EXPECT_NEAR(c, n / 3.0, 5 * std::sqrt(n * 2.0 / 9));
}

}  // namespace scree
