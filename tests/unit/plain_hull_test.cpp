// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/plain_hull.hpp"

#include "scree/base/random.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace scree::test {

namespace {

std::vector<Vec3> cloud(std::uint64_t number, int count, const Vec3& size) {
    RandomStream random(47, number, RandomPurpose::Shape);
    std::vector<Vec3> points;
    for (int k = 0; k < count; ++k) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        points.push_back(size.cwiseProduct(Vec3(x, y, z)));
    }
    return points;
}

using Triangle = std::array<double, 9>;

/// The same whichever corner comes first.
Triangle triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto from = [](const Vec3& p, const Vec3& q, const Vec3& r) {
        return Triangle{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), r.x(), r.y(), r.z()};
    };
    return std::min({from(a, b, c), from(b, c, a), from(c, a, b)});
}

/// Every three points that have all others below them.
std::set<Triangle> all_facets(const std::vector<Vec3>& points) {
    std::set<Triangle> facets;
    for (const Vec3& a : points)
        for (const Vec3& b : points)
            for (const Vec3& c : points) {
                if (a == b || b == c || c == a) continue;
                const Vec3 normal = (b - a).cross(c - a);
                const auto below = [&](const Vec3& p) { return p == a || p == b || p == c || normal.dot(p - a) < 0.0; };
                if (std::all_of(points.begin(), points.end(), below)) facets.insert(triangle(a, b, c));
            }
    return facets;
}

}  // namespace

TEST(PlainHull, FindsEveryFacetAndNoOther) {
    for (std::uint64_t k = 0; k < 40; ++k) {
        const std::vector<Vec3> points =
            cloud(k, 5 + static_cast<int>(k % 12), k % 2 ? Vec3(1.0, 1.0, 1.0) : Vec3(2.0, 0.3, 0.04));
        const auto hull = plain_hull(points);
        ASSERT_TRUE(hull) << k;
        std::set<Triangle> facets;
        for (const auto& [a, b, c] : hull->facets) {
            const auto at = [&](std::int32_t i) { return hull->vertices[static_cast<std::size_t>(i)]; };
            facets.insert(triangle(at(a), at(b), at(c)));
        }
        EXPECT_EQ(facets.size(), hull->facets.size()) << k;
        EXPECT_EQ(facets, all_facets(points)) << k;
    }
}

TEST(PlainHull, HullsOfManyPointsAreClosed) {
    for (std::uint64_t k = 0; k < 20; ++k) {
        const auto hull = plain_hull(cloud(100 + k, 400, Vec3(0.9, 0.7, 0.55)));
        ASSERT_TRUE(hull) << k;
        std::set<std::pair<std::int32_t, std::int32_t>> sides;
        for (const auto& f : hull->facets)
            for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(sides.emplace(f[i], f[(i + 1) % 3]).second) << k;
        for (const auto& [a, b] : sides) EXPECT_TRUE(sides.count({b, a})) << k;
    }
}

TEST(PlainHull, DoubtfulFacetsAreLeftToExactArithmetic) {
    const std::vector<Vec3> box = box_points(Vec3(0.9, 0.7, 0.55));
    EXPECT_FALSE(plain_hull(box));
    std::vector<Vec3> almost = box;
    for (std::size_t i = 0; i < almost.size(); ++i) almost[i] *= 1.0 + 1e-15 * static_cast<double>(i % 3);
    EXPECT_FALSE(plain_hull(almost));
    std::vector<Vec3> with_middle = cloud(7, 30, Vec3::Ones());
    const auto hull = plain_hull(with_middle);
    ASSERT_TRUE(hull);
    with_middle.push_back(0.5 * (hull->vertices[static_cast<std::size_t>(hull->facets[0][0])] +
                                 hull->vertices[static_cast<std::size_t>(hull->facets[0][1])]));
    EXPECT_FALSE(plain_hull(with_middle));
    EXPECT_FALSE(plain_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_FALSE(plain_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_FALSE(plain_hull(std::vector<Vec3>(8, Vec3(1, 2, 3))));
}

}  // namespace scree::test
