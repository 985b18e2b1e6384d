// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/distance.hpp"
#include "scree/inference/observation.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace scree {

/// The gap between measurement and simulation, in units of what chance alone would give for so many blocks.
///
/// Pooled gap. D = energy distance between the n measured and the N simulated values (in 1D 2 integral (F-G)^2 dx). If the measured blocks were
/// more blocks of the simulation, its expectation would be exactly
///     floor = a (1/n + 1/N)
/// with a = E|X-X'| of two simulated values, taken over repeats of the same block where the blocks of the test are known (each has equally many
/// repeats; their measured values are then not drawn from the pool, but one from each block), else over all. gap = D / floor: 1 on average if
/// nothing differs, growing with the number of blocks by which a difference shows. Shares are the same thing for 0/1 columns with the distance
/// |x-y| summed over the columns: D = 2 sum (p-q)^2, and a = 2 q (1-q), which is that of half a block where the simulation knows one answer only.
///
/// Score gap, for known blocks. The mean energy score of each measured block against the repeats of that very block, divided by the score that
/// another repeat would have on average (half the mean difference of the repeats). 1 on average if nothing differs, whatever the number of blocks. It
/// is strictly proper, the loss to calibrate with, and sees which block went where. As a test it is weak: its spread is that of single blocks, and a
/// shift that raises it can be hidden by a simulated spread that is too wide, which lowers it; so gaps below chance count, too. Read both gaps.
///
/// Chance. If nothing differs, the measured value of a block might as well have been any of its repeats (or any n of the pool the measured ones): gaps of
/// such exchanges give the interval of chance, 2.5 % to 97.5 %, and p, the share of them, with the measured one, that are not smaller. This is a
/// permutation test: exact for any number of blocks and repeats (Davison & Hinkley 1997, Bootstrap Methods and their Application, section 4.3).

/// Columns that are compared as one.
struct Observable {
    std::string name;             ///< "speed at ES1-A"
    std::string unit;             ///< of the values in the tables, "-" for shares
    std::vector<Column> columns;  ///< distances are Euclidean over them; of shares they are summed
    bool share = false;           ///< 0/1 columns
    bool matched =
        false;  ///< measured on known blocks: a block that did not pass a screen has speed, height, spin and energy 0 there
    bool overall = true;  ///< counts in the overall gap; false for what is another view of something that does
    std::vector<ObservedShare>
        counts;  ///< of shares known as counts only: one per column, with zone as the column's number
};

/// What can be compared: the position of the stops, its views, per screen who passed and how, shares in zones.
std::vector<Observable> make_observables(const Observations& observations, const ObservationOperator& op);

/// The values behind one observable. Strata are the blocks of the test, one measured and equally many simulated values each, or all in one.
struct ObservableSample {
    PointSample measured;                            ///< [unit of the observable]
    PointSample simulated;                           ///< [unit of the observable]
    std::vector<std::vector<std::uint32_t>> strata;  ///< per stratum its simulated points
    std::vector<std::int32_t>
        block_of_stratum;  ///< block of the test, -1 if pooled; of matched ones measured point k is that of stratum k [-]
    std::vector<std::int32_t> member_of_row;  ///< per row of the simulated table its point, -1 if it has none [-]
};
/// Known blocks with fewer simulated values are left out, as nothing can be said about them [-].
inline constexpr std::size_t kLeastRepeats = 3;
/// Simulated values that distances in several dimensions look at, the first ones: the cost grows with the square of their number [-].
inline constexpr std::size_t kMostPoints = 5000;
ObservableSample observable_sample(const ObservationTable& measured, const ObservationTable& simulated,
                                   const Observable& observable);

struct Interval {
    double low = kNaN;   ///< [*]
    double high = kNaN;  ///< [*]
};

struct Gap {
    double gap = kNaN;       ///< 1 on average if nothing differs; NaN if it cannot be computed [-]
    double distance = kNaN;  ///< energy distance, or mean energy score [unit of the values]
    double floor = kNaN;     ///< its expectation if nothing differed [unit of the values]
    Interval
        interval;  ///< 95 % of the gaps that repetitions of the test would give, from the spread over its blocks; NaN without draws [-]
    Interval chance;         ///< 95 % of the gaps that chance gives; NaN without draws [-]
    double p = kNaN;         ///< share of chance at least as far out [-]
    bool two_sided = false;  ///< true: a gap below chance differs, too

    bool beyond_chance() const { return gap > chance.high || (two_sided && gap < chance.low); }
};

/// One-dimensional observables only.
struct WassersteinGap {
    double distance = kNaN;  ///< between measured and simulated [unit of the values]
    /// 95 % by resampling the measured blocks, around the distance: resampled ones are larger by what chance adds once more [unit of the values]
    Interval interval;
    double chance_median = kNaN;  ///< of blocks drawn from the simulation against the rest of it [unit of the values]
    double chance_high = kNaN;    ///< 95 % quantile of that [unit of the values]
    double floor_median = kNaN;   ///< of the measured blocks resampled against themselves [unit of the values]
    double floor_high = kNaN;     ///< 95 % quantile of that [unit of the values]
};

struct ObservableGap {
    Observable observable;
    std::size_t measured = 0;   ///< values [-]
    std::size_t simulated = 0;  ///< values [-]
    Gap pooled;
    std::optional<Gap> score;  ///< of matched observables that are no shares
    std::optional<WassersteinGap> wasserstein;
    std::string status;  ///< why there is no gap; empty: there is one
    /// Who passed a screen, in place of motions there of which none has a gap, as where no simulated block gets there.
    bool stands_in = false;
    /// Is part of the overall gap.
    bool counts() const { return (observable.overall || stands_in) && std::isfinite(pooled.gap); }
};

/// Mean distance of the observables that count, each in units of its floor in `reference`, another comparison of the same measurements (of its own where that has none) [-].
/// Models are chosen by this: a model can lower its own gap by scattering more, for that raises its floor. NaN if none counts.
double distance_over(std::span<const ObservableGap> model, std::span<const ObservableGap> reference);

struct Discrepancy {
    std::vector<ObservableGap> observables;
    Gap overall;  ///< mean of the pooled gaps of the observables that count; `distance` and `floor` stay NaN
    std::optional<Gap>
        overall_score;  ///< energy score of all matched columns that count at once, each divided by its scale
};

struct DiscrepancySettings {
    std::int64_t draws =
        1000;                ///< samples of chance; 0: gaps without intervals, which is all that an optimiser needs [-]
    std::uint64_t seed = 1;  ///< of the draws
    bool wasserstein = true;  ///< also the Wasserstein distances, which cost more than all the rest
};

/// Divisor of each column in the overall score: the standard deviation of the simulated values (1 where they do not vary). Take them once, from
/// one simulation, and keep them while models are compared: a model must not win by widening its own scale. [unit of the column]
std::vector<double> column_scales(const ObservationTable& simulated);

/// All gaps of a simulation. `scales`: one per column of the tables, or empty: no overall score.
Discrepancy compare_tables(const ObservationTable& measured, const ObservationTable& simulated,
                           std::span<const Observable> observables, std::span<const double> scales,
                           const DiscrepancySettings& settings);

/// One PIT value (distance.hpp) per measured block and column of a matched observable that is no share.
struct BlockPit {
    std::int32_t block = 0;  ///< of the test [-]
    Column column;
    double u = kNaN;  ///< [-]
};
std::vector<BlockPit> pit_values(const ObservationTable& measured, const ObservationTable& simulated,
                                 std::span<const Observable> observables, std::uint64_t seed);

/// The band that as many blocks of the simulation as were measured would fill: per value 95 % of their distribution functions. One-dimensional.
struct DistributionBand {
    std::vector<double> x;      ///< ascending, evenly spread [unit of the values]
    std::vector<double> share;  ///< of the simulated values at or below x [-]
    std::vector<double> low;    ///< [-]
    std::vector<double> high;   ///< [-]
};
DistributionBand distribution_band(const ObservableSample& sample, std::size_t points,
                                   const DiscrepancySettings& settings);

}  // namespace scree
