// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/observation.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace scree {

/// Measured blocks as a reference simulation sees them: numbers that are zero on average, whatever the mass, shape or release of a block, if the block was
/// one more of the simulation. The mean of them over the measured blocks is what localisation, tests and fingerprints of effects work with.
///
/// The reference simulates every known block many times (or, where blocks are unknown, one pool). A value becomes its probability integral transform
/// among the repeats of its own block, u in [0, 1) (distance.hpp), and that a standardised level sqrt(12) (u - 1/2) and spread sqrt(180) ((u - 1/2)^2 - 1/12).
/// Of a block that hardly ever gets there it is that among the repeats of all blocks: the rows of the reference are ranked alike, and the mean stays zero.

enum class ResidualKind {
    Passed,  ///< passed the screen, or stopped in the deposit zone: 0 or 1 less the share of the block's repeats that did
    Level,       ///< the value is high (positive) or low for this block
    Spread,      ///< it lies far from the middle (positive), or near it
    MassTrend,   ///< level times the standardised logarithm of the mass: heavy blocks are high (positive)
    ShapeTrend,  ///< level times the standardised logarithm of L1/L3: long blocks are high
    OrderTrend,  ///< level times the standardised place of the block in the order of the test, where that was written down
    Together,  ///< product of two levels: both values are high or low in the same blocks; of one record if blocks are unknown
    Innovation,  ///< of known blocks: level among simulated blocks that passed the screen before in a like state: what happened on the way in between
    Window       ///< stopped in a stretch of the path, less the share of the block's repeats that did
};

struct Residual {
    ResidualKind kind = ResidualKind::Level;
    Column column;  ///< what was measured
    Column other;   ///< Together: the second one; Innovation: the speed before, at a screen or the start of an impact
    double from = kNaN;  ///< Window: chainage [m]
    double to = kNaN;    ///< [m]
    bool operator==(const Residual&) const = default;
};

struct ResidualSettings {
    std::size_t windows =
        6;  ///< stretches of the path with equal shares of the simulated stops; more of them find sharper peaks with less power [-]
    std::size_t neighbours = 60;  ///< simulated blocks in a like state, for innovations [-]
    std::uint64_t seed = 1;       ///< of ties
};

/// Residuals of some rows: NaN where a row has nothing to say (not measured, or the block did not get there).
using ResidualRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class ResidualSpace {
public:
    /// `reference` holds the rows of a simulation, with the same columns as `measured`, screens in their order along the path; a block with no more than kLeastMembers simulated values of a
    /// column is compared with all of them, or with none where these are no more than kLeastPooled. `blocks` are those of the test (empty if unknown).
    /// `residuals` of another space are taken as they are, where there are any.
    ResidualSpace(ObservationTable reference, const ObservationTable& measured, std::span<const ObservedBlock> blocks,
                  const ResidualSettings& settings, std::span<const Residual> residuals = {});
    static constexpr std::size_t kLeastMembers = 5, kLeastPooled = 100;

    /// Residuals that at least kLeastRows measured rows have something to say about.
    const std::vector<Residual>& residuals() const { return residuals_; }
    static constexpr std::size_t kLeastRows = 8;

    /// Residuals of a table with the same columns, whose rows are not those of the reference. Less the mean over the reference, which is that of a
    /// correct model.
    ResidualRows of(const ObservationTable& table) const;
    /// Residuals of the reference's own rows, each among the others.
    const ResidualRows& of_reference() const { return own_; }
    const ObservationTable& reference() const { return reference_; }
    /// Least variance of single rows, per residual, in the covariance of a test: a share that the reference sees hardly ever otherwise (all blocks pass a
    /// screen) has its variance from a handful of rows or from none, and whoever weighs by it hears of nothing else. One of the n measured blocks more or
    /// less is no news: the variance of a share counts as 1/n at least [-].
    const Eigen::VectorXd& least_variance() const { return least_variance_; }

private:
    void choose(const ObservationTable& measured, const ResidualSettings& settings,
                std::span<const Residual> residuals);
    void add_state(const Column& screen, const Column& target);
    ResidualRows raw(const ObservationTable& table, bool own) const;
    double level(const ObservationTable& table, std::size_t row, std::size_t column, bool own) const;
    double expected_share(const ObservationTable& table, std::size_t column, std::size_t row, bool own) const;
    double covariate(const std::vector<double>& of_block, std::int32_t block) const;
    double mass_of(std::int32_t block) const;
    using RowsOfOne = Eigen::Ref<Eigen::VectorXd, 0, Eigen::InnerStride<>>;
    void innovations(const ObservationTable& table, const Residual& residual, bool own, RowsOfOne out) const;
    void windows(const ObservationTable& table, const Residual& residual, bool own, RowsOfOne out) const;
    std::size_t stratum(std::int32_t block) const;

    /// Simulated rows that passed a screen, by their speed there.
    struct ByState {
        Column screen, target;
        std::vector<std::uint32_t> rows;
        std::vector<double> speed;                      ///< ascending [m/s]
        std::vector<double> value, mass, height, rise;  ///< in that order; the last two may be empty [*]
    };

    ObservationTable reference_;
    ResidualSettings settings_;
    bool known_;                                            ///< which records are of one block
    std::vector<std::vector<std::vector<double>>> sorted_;  ///< per column and stratum, ascending [*]
    std::vector<std::vector<double>> pooled_;               ///< per column, of all strata, ascending [*]
    std::vector<std::vector<double>> sums_;             ///< their sums: of who passed, or is in a zone, how many [*]
    std::vector<double> log_mass_, log_shape_, order_;  ///< per block of the test, standardised [-]
    std::vector<ByState> states_;
    std::vector<Residual> residuals_;
    Eigen::VectorXd mean_;            ///< of the raw residuals of the reference [-]
    Eigen::VectorXd least_variance_;  ///< per residual [-]
    ResidualRows own_;
};

/// "speed at ES2", for people: needs the names of screens and deposit zones.
std::string residual_name(const Residual& residual, std::span<const std::string> screens,
                          std::span<const std::string> zones = {});

}  // namespace scree
