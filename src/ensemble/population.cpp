// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/population.hpp"

#include "scree/base/error.hpp"
#include "scree/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace scree {

namespace {

/// Ends of a log-normal distribution that are so near each other that hardly a draw from all of it lies between them [standard deviations].
constexpr double kNarrow = 1.0;

/// A standard normal number between two ends around 0, at most kNarrow apart: by rejection from a uniform one.
double normal_between(double low, double high, RandomStream& random) {
    for (;;) {
        const double z = random.uniform(low, high);
        if (random.uniform() <= std::exp(-0.5 * z * z)) return z;
    }
}

double draw_volume(const BlockDistribution& d, RandomStream& random) {
    switch (d.law) {
        case VolumeLaw::Constant:
            return d.volume;
        case VolumeLaw::Uniform:
            return random.uniform(d.volume_min, d.volume_max);
        case VolumeLaw::LogUniform:
            return std::exp(random.uniform(std::log(d.volume_min), std::log(d.volume_max)));
        case VolumeLaw::LogNormal: {
            const double low = std::log(d.volume_min / d.volume) / d.sigma,
                         high = std::log(d.volume_max / d.volume) / d.sigma;
            if (high - low < kNarrow) return d.volume * std::exp(d.sigma * normal_between(low, high, random));
            for (;;) {
                const double v = d.volume * std::exp(d.sigma * random.normal());
                if (v >= d.volume_min && v <= d.volume_max) return v;
            }
        }
        case VolumeLaw::PowerLaw: {
            // inverse of the cut-off distribution: v^-b uniform between the two ends
            const double low = std::pow(d.volume_max, -d.exponent), high = std::pow(d.volume_min, -d.exponent);
            return std::pow(random.uniform(low, high), -1.0 / d.exponent);
        }
    }
    return d.volume;
}

/// How many bodies make the mean filling: known to 1 % then for random hulls [-].
constexpr std::uint64_t kFillingSamples = 100;

/// What is drawn before the shape.
struct Measures {
    std::int64_t row = -1;
    Vec3 size = Vec3::Zero();  ///< of a list: L1, L2, L3; else their ratios to L1 [m]
    double mass = 0.0;         ///< [kg]
    double volume = 0.0;       ///< without a list [m^3]
};

Measures draw_measures(const BlockPopulation& population, std::uint64_t seed, std::uint64_t block) {
    RandomStream random(seed, block, RandomPurpose::Block);
    Measures m;
    if (!population.list.empty()) {
        const std::uint64_t rows = population.list.size();
        m.row = static_cast<std::int64_t>(population.in_turn ? block % rows : random.below(rows));
        const BlockRow& row = population.list[static_cast<std::size_t>(m.row)];
        m.size = row.size;
        m.mass = row.mass;
        return m;
    }
    const BlockDistribution& d = population.distribution;
    m.volume = draw_volume(d, random);
    const double density = d.density + random.uniform(-1.0, 1.0) * d.density_spread;
    const double r21 = random.uniform(d.ratio_21[0], d.ratio_21[1]), r32 = random.uniform(d.ratio_32[0], d.ratio_32[1]);
    m.size = {1.0, r21, r21 * r32};
    m.mass = density * m.volume;
    return m;
}

}  // namespace

namespace {

/// Mean number of corners of a shape, and of its polygon in 2D, times the factor; sharp and round blocks become hulls with as many.
void scale_corners(ShapeSettings& shape, double factor) {
    if (factor == 1.0) return;
    if (shape.shape == BlockShape::Sharp || shape.shape == BlockShape::Round) {
        shape.points = shape.polygon_points = shape.shape == BlockShape::Sharp ? kSharpPoints : kRoundPoints;
        shape.shape = BlockShape::Hull;
    }
    if (shape.shape != BlockShape::Hull && shape.shape != BlockShape::Ellipsoid)
        throw InputError(
            std::string("effect block_shape: blocks of the shape \"") +
            kBlockShapeNames[static_cast<std::size_t>(shape.shape)] +
            "\" have no free number of corners: leave out corners, or take hull, sharp, round or ellipsoid");
    shape.points = std::max(4, static_cast<int>(std::lround(factor * shape.points)));
    shape.polygon_points = std::max(3, static_cast<int>(std::lround(factor * shape.polygon_points)));
}

}  // namespace

BlockPopulation reshaped(const BlockPopulation& population, std::span<const Effect> effects) {
    BlockPopulation result = population;
    for (const Effect& effect : effects) {
        if (effect.kind != EffectKind::BlockShape) continue;
        scale_corners(result.shape, effect.value("corners"));
        if (result.list.empty() && effect.value("corners") != 1.0) result.filling = mean_filling(result.shape);
        const double longer = effect.value("elongation"), flatter = effect.value("flatness");
        const double middle = std::cbrt(flatter / longer);  // on L2, so that the product of the three factors is 1
        for (BlockRow& row : result.list)
            row.size = row.size.cwiseProduct(Vec3(longer * middle, middle, middle / flatter));
        for (double& ratio : result.distribution.ratio_21) ratio /= longer;
        for (double& ratio : result.distribution.ratio_32) ratio /= flatter;
    }
    return result;
}

PopulationBlock draw_block(const BlockPopulation& population, std::uint64_t seed, std::uint64_t block) {
    RandomStream shape_random(seed, block, RandomPurpose::Shape);
    const Measures m = draw_measures(population, seed, block);
    if (m.row >= 0) return {make_block(population.shape, m.size, m.mass, shape_random), m.row};
    // the same draw twice: once to learn how much of its box this shape fills, once in the right size
    RandomStream again = shape_random;
    const double filled = make_block(population.shape, m.size, 1.0, again).volume;
    return {make_block(population.shape, m.size * std::cbrt(m.volume / filled), m.mass, shape_random), -1};
}

PopulationPolygon draw_polygon(const BlockPopulation& population, std::uint64_t seed, std::uint64_t block) {
    RandomStream shape_random(seed, block, RandomPurpose::Shape);
    const Measures m = draw_measures(population, seed, block);
    const Vec3 size = m.row >= 0 ? m.size : m.size * std::cbrt(m.volume / (population.filling * m.size.prod()));
    return {make_polygon(population.shape, size, m.mass, shape_random), m.row};
}

double mean_filling(const ShapeSettings& shape) {
    double sum = 0.0;
    for (std::uint64_t k = 0; k < kFillingSamples; ++k) {
        RandomStream random(0, k, RandomPurpose::Shape);
        sum += make_block(shape, Vec3::Ones(), 1.0, random).volume;
    }
    return sum / static_cast<double>(kFillingSamples);
}

}  // namespace scree
