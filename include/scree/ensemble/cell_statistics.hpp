// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/grid.hpp"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace scree {

/// What is collected in every result cell, one value per passing block: the largest that the block reached inside the cell.
enum class CellQuantity { KineticEnergy, PassingHeight, Speed, Spin };
inline constexpr std::size_t kCellQuantities = 4;
/// [J], [m] (centre of mass above the terrain, vertically), [m/s], [rad/s]
using CellValues = std::array<double, kCellQuantities>;

/// Relative error of quantiles taken from a LogHistogram [-].
inline constexpr double kQuantileError = 0.01;

/// Counts in bins whose ends are nearly in one ratio: a quantile is off by at most 1 % of its value (Masson, Rim & Lee 2019, DDSketch). Adding and merging are integer
/// sums: the result does not depend on the order.
class LogHistogram {
public:
    void add(double value);
    void merge(const LogHistogram& other);
    std::int64_t count() const;
    /// The value below or at which a share q of all values lies (nearest rank); NaN if empty. Values under 1e-3 count as 0.
    double quantile(double q) const;

private:
    std::vector<std::pair<std::int32_t, std::uint32_t>> bins_;  ///< (bin, count), in order of the bins
};

/// Energies of large blocks, in 1e-4 J, over a million passages are too much for 64 bits.
__extension__ using WideInteger = __int128;

/// One quantity in one cell. Sums are kept in integers so that the mean does not depend on the order of the blocks either.
struct QuantityStatistics {
    WideInteger sum = 0;   ///< in units of 1e-4 of the quantity's unit [1e-4]
    double largest = 0.0;  ///< [unit of the quantity]
    LogHistogram histogram;

    void add(double value);
    void merge(const QuantityStatistics& other);
    /// That of the histogram, but never beyond the largest value [unit of the quantity].
    double quantile(double q) const;
};

struct CellStatistics {
    std::int64_t passages = 0;  ///< blocks that crossed the cell, each counted once [-]
    std::int64_t deposits = 0;  ///< blocks that came to rest in it [-]
    std::array<QuantityStatistics, kCellQuantities> quantities;

    void add_passage(const CellValues& values);
    void merge(const CellStatistics& other);
};

/// Statistics of all cells touched so far, by index in the result grid.
using CellMap = std::unordered_map<std::size_t, CellStatistics>;
void merge_cells(CellMap& into, const CellMap& from);

/// 95 % interval of a share k of n (Wilson 1927): lower and upper limit [-].
std::pair<double, double> wilson_interval(std::int64_t k, std::int64_t n);

}  // namespace scree
