// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace scree {

/// What a random stream is for. Streams of different purposes are independent, so that drawing one more number for the shape
/// does not change the release position.
enum class RandomPurpose : std::uint32_t {
    Block = 1,
    Shape = 2,
    ReleasePosition = 3,
    Orientation = 4,
    Effect = 5,
    Resampling = 6,
    Observation = 7,
    Calibration = 8,
    Diagnosis = 9
};

/// A counter-based random stream: Philox4x32-10 (Salmon et al. 2011, SC'11) keyed by (seed, stream number, purpose).
/// Its numbers depend on nothing else: not on threads, order, or how many other streams exist. Identical on every platform.
class RandomStream {
public:
    RandomStream(std::uint64_t seed, std::uint64_t stream, RandomPurpose purpose);

    /// 64 random bits.
    std::uint64_t bits();
    /// Uniform in [0, 1) with 53 bits.
    double uniform();
    /// Uniform in [low, high).
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Uniform integer in [0, count); count > 0. Unbiased (Lemire 2019).
    std::uint64_t below(std::uint64_t count);
    /// Standard normal (Box-Muller).
    double normal();

private:
    void refill();

    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_;
    std::array<std::uint32_t, 4> block_{};
    int used_ = 4;               ///< how many words of block_ have been given out
    double spare_normal_ = 0.0;  ///< second value of the last Box-Muller pair [-]
    bool has_spare_ = false;
};

}  // namespace scree
