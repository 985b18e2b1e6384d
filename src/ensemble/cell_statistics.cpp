// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/cell_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace scree {

namespace {

constexpr double kSmallest = 1e-3;  ///< below, a value is in bin zero
constexpr double kSumUnit = 1e-4;

/// Exponent and first six bits of the mantissa of a double: bins that are wider than the last by at most 1/64, without a logarithm.
constexpr int kDropped = 46;
static_assert(1.0 / 128.0 < kQuantileError);

std::int32_t bin_of(double value) {
    return value < kSmallest ? 0 : static_cast<std::int32_t>(std::bit_cast<std::uint64_t>(value) >> kDropped);
}

/// The value that is off by at most the stated error everywhere in the bin: the harmonic mean of its ends.
double value_of(std::int32_t bin) {
    if (bin == 0) return 0.0;
    const auto end = [](std::int32_t b) { return std::bit_cast<double>(static_cast<std::uint64_t>(b) << kDropped); };
    const double low = end(bin), high = end(bin + 1);
    return 2.0 * low * high / (low + high);
}

}  // namespace

void LogHistogram::add(double value) {
    const std::int32_t bin = bin_of(value);
    auto place = bins_.begin();
    for (std::size_t left = bins_.size(); left > 0;) {  // lower_bound, by arithmetic: no branch can foresee these
        const std::size_t half = (left + 1) / 2;
        const bool before = place[static_cast<std::ptrdiff_t>(half - 1)].first < bin;
        place += before ? static_cast<std::ptrdiff_t>(half) : 0;
        left = before ? left - half : half - 1;
    }
    if (place != bins_.end() && place->first == bin)
        ++place->second;
    else
        bins_.insert(place, {bin, 1});
}

void LogHistogram::merge(const LogHistogram& other) {
    std::vector<std::pair<std::int32_t, std::uint32_t>> sum;
    sum.reserve(bins_.size() + other.bins_.size());
    auto a = bins_.begin();
    auto b = other.bins_.begin();
    while (a != bins_.end() || b != other.bins_.end()) {
        if (b == other.bins_.end() || (a != bins_.end() && a->first < b->first)) {
            sum.push_back(*a++);
        } else if (a == bins_.end() || b->first < a->first) {
            sum.push_back(*b++);
        } else {
            sum.emplace_back(a->first, a->second + b->second);
            ++a;
            ++b;
        }
    }
    bins_ = std::move(sum);
}

std::int64_t LogHistogram::count() const {
    std::int64_t n = 0;
    for (const auto& [bin, count] : bins_) n += count;
    return n;
}

double LogHistogram::quantile(double q) const {
    const std::int64_t n = count();
    if (n == 0) return kNaN;
    const auto rank =
        std::clamp<std::int64_t>(static_cast<std::int64_t>(std::ceil(q * static_cast<double>(n) - 1e-9)), 1, n);
    std::int64_t below = 0;
    for (const auto& [bin, count] : bins_) {
        below += count;
        if (below >= rank) return value_of(bin);
    }
    return value_of(bins_.back().first);
}

void QuantityStatistics::add(double value) {
    sum += std::llround(value / kSumUnit);
    largest = std::max(largest, value);
    histogram.add(value);
}

void QuantityStatistics::merge(const QuantityStatistics& other) {
    sum += other.sum;
    largest = std::max(largest, other.largest);
    histogram.merge(other.histogram);
}

void CellStatistics::add_passage(const CellValues& values) {
    ++passages;
    for (std::size_t k = 0; k < kCellQuantities; ++k) quantities[k].add(std::max(values[k], 0.0));
}

void CellStatistics::merge(const CellStatistics& other) {
    passages += other.passages;
    deposits += other.deposits;
    for (std::size_t k = 0; k < kCellQuantities; ++k) quantities[k].merge(other.quantities[k]);
}

void merge_cells(CellMap& into, const CellMap& from) {
    for (const auto& [cell, statistics] : from) into[cell].merge(statistics);
}

double QuantityStatistics::quantile(double q) const {
    return std::min(histogram.quantile(q), largest);  // NaN of an empty one stays
}

std::pair<double, double> wilson_interval(std::int64_t k, std::int64_t n) {
    if (n <= 0) return {0.0, 1.0};
    constexpr double z = 1.959963984540054;  // 97.5 % quantile of the standard normal
    const double count = static_cast<double>(n), p = static_cast<double>(k) / count;
    const double centre = (p + z * z / (2.0 * count)) / (1.0 + z * z / count);
    const double half = z / (1.0 + z * z / count) * std::sqrt(p * (1.0 - p) / count + z * z / (4.0 * count * count));
    return {k == 0 ? 0.0 : std::max(0.0, centre - half),
            k == n ? 1.0 : std::min(1.0, centre + half)};  // exact at both ends, not within rounding
}

}  // namespace scree
