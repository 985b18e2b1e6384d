// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/base/random.hpp"
#include "scree/inference/discrepancy.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace scree {

/// All values of a row for an observable, or nothing if one is missing. A known block that has not passed a screen has a motion of 0 there.
std::vector<double> point_of(const ObservationTable& table, std::size_t row, const Observable& observable);

/// Which rows of a simulated table to use, at most `most` of them: the first ones, of known blocks equally many of each. Blocks with fewer than
/// kLeastRepeats rows are left out.
std::vector<char> balanced_rows(const ObservationTable& simulated, std::size_t most);

/// The pooled gap of one observable, as a function of which members of a pool were "measured". The pool holds the simulated values and, behind them, the
/// measured ones: if both come from one distribution, every choice of members is as likely as the one that was made, so that chance is known
/// exactly, however few there are (permutation test: Davison & Hinkley 1997, section 4.3).
class GapStatistic {
public:
    struct Value {
        double distance = kNaN;  ///< [unit of the values]
        double floor = kNaN;     ///< [unit of the values]
        double gap() const { return distance / floor; }
    };

    virtual ~GapStatistic() = default;

    /// With these members as the measured values and all others as the simulation. Of several strata one each, in their order.
    virtual Value value(std::span<const std::uint32_t> members) const = 0;
    /// Wasserstein distance likewise; NaN unless of one dimension [unit of the values].
    virtual double wasserstein(std::span<const std::uint32_t>) const { return kNaN; }
    /// As it was measured.
    virtual Value measured() const { return value(measured_members_); }
    /// Variance of the distance through its first-order dependence on the measured values [unit^2].
    virtual double slope_variance() const = 0;
    /// Members as the measured ones may equally well have been: one of each stratum, or as many of a single one, each once.
    std::vector<std::uint32_t> draw_members(RandomStream& random) const;
    const std::vector<std::uint32_t>& measured_members() const { return measured_members_; }

protected:
    explicit GapStatistic(const ObservableSample& sample);

    std::vector<std::vector<std::uint32_t>> strata_;  ///< members, simulated and measured
    std::vector<std::uint32_t> measured_members_;
    std::size_t simulated_ = 0;  ///< members that were simulated [-]
    std::size_t drawn_ = 0;      ///< members to draw of a single stratum [-]
};

/// The statistic that suits the observable; there must be measured and at least kLeastRepeats simulated values.
std::unique_ptr<GapStatistic> make_gap_statistic(const Observable& observable, const ObservableSample& sample);

/// Known blocks with what was measured and what their repeats gave; columns that were not measured are left out block by block.
struct ScoreInput {
    struct Block {
        std::vector<double> observation;  ///< scaled [-]
        PointSample repeats;              ///< scaled [-]
    };
    std::vector<Block> blocks;
};
/// All columns at once, each divided by its scale.
ScoreInput score_input(const ObservationTable& measured, const ObservationTable& simulated,
                       std::span<const Column> columns, std::span<const double> scales);

/// Energy scores of known blocks, as a function of which of its repeats, or the measurement, is held against the others.
class ScoreStatistic {
public:
    explicit ScoreStatistic(const ScoreInput& input);

    std::size_t blocks() const { return score_.size(); }
    double mean_score() const;  ///< of the measurements [as the scaled values]
    double floor() const;       ///< [as the scaled values]
    /// Standard error of the mean score, from its spread over the blocks [as the scaled values].
    double standard_error() const;
    /// Gap if of each block any one of measurement and repeats had been measured [-].
    double draw(RandomStream& random) const;

private:
    /// Per block, and per member of it (the measurement first): its score against the other members, and what they would have on average.
    std::vector<std::vector<double>> score_, floor_;
};

}  // namespace scree
