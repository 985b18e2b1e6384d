// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks that are drawn from distributions, and those of a list.
#include "scree/ensemble/population.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace scree::test {
namespace {

constexpr std::uint64_t kDraws = 4000;
/// Largest distance of an empirical distribution function from the true one, times the square root of the number: beyond this in one case of 10 000 (Kolmogorov) [-].
constexpr double kFarthest = 2.2;

BlockPopulation boxes(VolumeLaw law) {
    BlockPopulation population;
    population.shape.shape = BlockShape::Box;
    population.distribution.law = law;
    population.distribution.volume = 0.4;
    population.distribution.volume_min = 0.2;
    population.distribution.volume_max = 5.0;
    population.distribution.sigma = 0.7;
    population.distribution.exponent = 1.3;
    return population;
}

double kolmogorov(std::vector<double> values, const std::function<double(double)>& distribution) {
    std::sort(values.begin(), values.end());
    const auto n = static_cast<double>(values.size());
    double most = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double p = distribution(values[k]), rank = static_cast<double>(k);
        most = std::max({most, std::abs(p - rank / n), std::abs(p - (rank + 1.0) / n)});
    }
    return std::sqrt(n) * most;
}

TEST(Population, VolumesFollowTheirLaws) {
    const auto normal = [](double v) { return 0.5 * std::erfc(-std::log(v / 0.4) / (0.7 * std::sqrt(2.0))); };
    const std::vector<std::pair<VolumeLaw, std::function<double(double)>>> laws{
        {VolumeLaw::Uniform, [](double v) { return (v - 0.2) / 4.8; }},
        {VolumeLaw::LogUniform, [](double v) { return std::log(v / 0.2) / std::log(25.0); }},
        {VolumeLaw::LogNormal, [&](double v) { return (normal(v) - normal(0.2)) / (normal(5.0) - normal(0.2)); }},
        // N(volume > v) ~ v^-1.3, cut at both ends
        {VolumeLaw::PowerLaw, [](double v) { return (1.0 - std::pow(v / 0.2, -1.3)) / (1.0 - std::pow(25.0, -1.3)); }}};
    for (const auto& [law, distribution] : laws) {
        const BlockPopulation population = boxes(law);
        std::vector<double> volumes, polygons;
        for (std::uint64_t k = 0; k < kDraws; ++k) {
            const PopulationBlock block = draw_block(population, 3, k);
            EXPECT_NEAR(block.body.mass, 2600.0 * block.body.volume, 1e-6) << "the density has no spread";
            EXPECT_EQ(block.row, -1);
            volumes.push_back(block.body.volume);
            polygons.push_back(draw_polygon(population, 3, k).body.mass / 2600.0);
        }
        EXPECT_GE(*std::min_element(volumes.begin(), volumes.end()), 0.2 - 1e-9);
        EXPECT_LE(*std::max_element(volumes.begin(), volumes.end()), 5.0 + 1e-9);
        const char* const name = kVolumeLawNames[static_cast<std::size_t>(law)];
        EXPECT_LT(kolmogorov(volumes, distribution), kFarthest) << name;
        EXPECT_LT(kolmogorov(polygons, distribution), kFarthest) << name;
    }
}

TEST(Population, DensitiesAndEdgesAreUniformBetweenTheirEnds) {
    BlockPopulation population = boxes(VolumeLaw::Constant);
    population.distribution.density_spread = 300.0;
    population.distribution.ratio_21 = {0.6, 0.9};
    population.distribution.ratio_32 = {0.5, 0.7};
    std::vector<double> densities, second, third;
    for (std::uint64_t k = 0; k < kDraws; ++k) {
        const ConvexBlock block = draw_block(population, 3, k).body;
        EXPECT_NEAR(block.volume, 0.4, 1e-9);
        densities.push_back(block.mass / block.volume);
        second.push_back(block.size.y() / block.size.x());
        third.push_back(block.size.z() / block.size.y());
    }
    const auto between = [](double low, double high) { return [=](double v) { return (v - low) / (high - low); }; };
    EXPECT_LT(kolmogorov(densities, between(2300.0, 2900.0)), kFarthest);
    EXPECT_LT(kolmogorov(second, between(0.6, 0.9)), kFarthest);
    EXPECT_LT(kolmogorov(third, between(0.5, 0.7)), kFarthest);
}

TEST(Population, RowsOfAListInTurnOrByChance) {
    BlockPopulation population = boxes(VolumeLaw::Constant);
    population.list = {{"A", 500.0, {1.0, 0.8, 0.6}}, {"B", 700.0, {1.2, 0.9, 0.7}}, {"C", 900.0, {1.4, 1.0, 0.8}}};
    population.in_turn = true;
    for (std::uint64_t k = 0; k < 7; ++k) {
        const PopulationBlock block = draw_block(population, 3, k);
        EXPECT_EQ(block.row, static_cast<std::int64_t>(k % 3));
        EXPECT_EQ(block.body.mass, population.list[k % 3].mass);
        EXPECT_LT((block.body.size - population.list[k % 3].size).norm(), 1e-9);
    }
    population.in_turn = false;
    std::vector<int> drawn(3, 0);
    for (std::uint64_t k = 0; k < kDraws; ++k) ++drawn[static_cast<std::size_t>(draw_block(population, 3, k).row)];
    for (const int count : drawn) EXPECT_NEAR(count, kDraws / 3.0, 120.0);  // four standard errors of 30
}

}  // namespace
}  // namespace scree::test
