// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/population.hpp"

#include "scree/base/random.hpp"

#include <cmath>

namespace scree {

namespace {

double draw_volume(const BlockDistribution& d, RandomStream& random) {
    switch (d.law) {
        case VolumeLaw::Constant:
            return d.volume;
        case VolumeLaw::Uniform:
            return random.uniform(d.volume_min, d.volume_max);
        case VolumeLaw::LogUniform:
            return std::exp(random.uniform(std::log(d.volume_min), std::log(d.volume_max)));
        case VolumeLaw::LogNormal:
            for (;;) {
                const double v = d.volume * std::exp(d.sigma * random.normal());
                if (v >= d.volume_min && v <= d.volume_max) return v;
            }
        case VolumeLaw::PowerLaw: {
            // inverse of the cut-off distribution: v^-b uniform between the two ends
            const double low = std::pow(d.volume_max, -d.exponent), high = std::pow(d.volume_min, -d.exponent);
            return std::pow(random.uniform(low, high), -1.0 / d.exponent);
        }
    }
    return d.volume;
}

}  // namespace

PopulationBlock draw_block(const BlockPopulation& population, std::uint64_t seed, std::uint64_t block) {
    RandomStream random(seed, block, RandomPurpose::Block);
    RandomStream shape_random(seed, block, RandomPurpose::Shape);
    PopulationBlock result;
    if (!population.list.empty()) {
        const std::uint64_t rows = population.list.size();
        result.row = static_cast<std::int64_t>(population.in_turn ? block % rows : random.below(rows));
        const BlockRow& row = population.list[static_cast<std::size_t>(result.row)];
        result.body = make_block(population.shape, row.size, row.mass, shape_random);
        return result;
    }
    const BlockDistribution& d = population.distribution;
    const double volume = draw_volume(d, random);
    const double density = d.density + random.uniform(-1.0, 1.0) * d.density_spread;
    const double r21 = random.uniform(d.ratio_21[0], d.ratio_21[1]), r32 = random.uniform(d.ratio_32[0], d.ratio_32[1]);
    const Vec3 unit(1.0, r21, r21 * r32);
    // the same draw twice: once to learn how much of its box this shape fills, once in the right size
    RandomStream again = shape_random;
    const double filled = make_block(population.shape, unit, 1.0, again).volume;
    result.body = make_block(population.shape, unit * std::cbrt(volume / filled), density * volume, shape_random);
    return result;
}

}  // namespace scree
