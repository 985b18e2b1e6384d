// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/base/random.hpp"

#include "scree/base/assert.hpp"

#include <Random123/philox.h>

#include <cmath>
#include <numbers>

namespace scree {

// Key = seed, counter = (draw, stream low, stream high, purpose): 2^32 draws of 4 words a stream, far beyond any trajectory.
RandomStream::RandomStream(std::uint64_t seed, std::uint64_t stream, RandomPurpose purpose)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      counter_{0, static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32),
               static_cast<std::uint32_t>(purpose)} {}

void RandomStream::refill() {
    using Philox = r123::Philox4x32;
    const Philox::ctr_type counter = {{counter_[0], counter_[1], counter_[2], counter_[3]}};
    const Philox::key_type key = {{key_[0], key_[1]}};
    const Philox::ctr_type words = Philox()(counter, key);
    block_ = {words[0], words[1], words[2], words[3]};
    ++counter_[0];
    used_ = 0;
}

std::uint64_t RandomStream::bits() {
    if (used_ > 2) refill();
    const auto low = block_[static_cast<std::size_t>(used_)];
    const auto high = block_[static_cast<std::size_t>(used_) + 1];
    used_ += 2;
    return (static_cast<std::uint64_t>(high) << 32) | low;
}

double RandomStream::uniform() {
    return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

std::uint64_t RandomStream::below(std::uint64_t count) {
    SCREE_ASSERT(count > 0);
    // Multiply-shift with rejection of the few values that would make some results likelier.
    __extension__ using Wide = unsigned __int128;
    const std::uint64_t threshold = (0 - count) % count;
    for (;;) {
        const Wide product = static_cast<Wide>(bits()) * count;
        if (static_cast<std::uint64_t>(product) >= threshold) return static_cast<std::uint64_t>(product >> 64);
    }
}

double RandomStream::normal() {
    if (has_spare_) {
        has_spare_ = false;
        return spare_normal_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));  // 1 - u is never zero
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_normal_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
}

}  // namespace scree
