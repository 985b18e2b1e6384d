// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/field_test.hpp"

#include <span>
#include <vector>

namespace scree::cli {

/// From one screen to the next, or to the stop: what the blocks of the test do there, and what the model's do that begin with the state that was measured
/// at the first one. What goes wrong above does not come down with them.
struct ScreenInnovation {
    std::int32_t from = -1, to = -1;  ///< of ObservationOperator::screens; `to` -1: where they stop
    Quantity quantity = Quantity::Along;
    std::size_t blocks = 0;  ///< that both are known of [-]
    double measured = kNaN;  ///< mean over them [m], [m/s], [rad/s], [-]
    double simulated = kNaN;
    double error = kNaN;  ///< standard error of the difference; that of the parameters is not in it
    double standardised() const { return (measured - simulated) / error; }
};

/// What blocks did, each held against restarts of its own.
class RestartedBlocks {
public:
    /// `shares`: of each block only whether it did something, 0 or 1.
    explicit RestartedBlocks(bool shares) : shares_(shares) {}

    /// A block, and at least one restart of it.
    void add(double measured, std::span<const double> restarts);

    std::size_t blocks() const { return differences_.size(); }
    double measured() const { return measured_ / static_cast<double>(blocks()); }  ///< mean
    double simulated() const {
        return simulated_ / static_cast<double>(blocks());
    }  ///< mean of the means of the restarts
    /// Squared standard error of the difference of the two [unit squared]. As the model has it, from the scatter of the restarts of each block, or as the
    /// blocks differ, if they do so more. The chance of a block that did something in k of R restarts is taken for (k + 1/2) / (R + 1), so that it is
    /// neither 0 nor 1, and one block more or less is no news.
    double variance() const;

private:
    bool shares_;
    double measured_ = 0.0, simulated_ = 0.0;
    std::vector<double> differences_;
    double of_shares_ = 0.0;               ///< sum of the variances of a block and its restarts
    double within_ = 0.0, freedom_ = 0.0;  ///< sum of squares within blocks, and its degrees of freedom
    double weight_ = 0.0;                  ///< sum over blocks of 1 + 1 / restarts
};

/// With every measured block restarted kRestarts times at every screen that measured its speed, screens in their order along the path. Its height and spin there
/// are the measured ones where they were measured, and all else, also where along the screen it crosses, is as in a crossing of `campaign`: its own
/// simulated ones, or else those with the nearest speeds. What a restart forgets (how a block is turned, and that it rolls or slides) is taken from
/// simulated blocks that are restarted in the same way: `simulated` is moved by the mean of what these did themselves less what they do restarted, at the
/// speeds that the model has there. Empty where nobody knows which record is of which block, or fewer than kLeastRestarted blocks have one. Nothing: it was
/// stopped.
inline constexpr std::int64_t kRestarts = 10;
inline constexpr std::size_t kLeastRestarted = 8;
std::optional<std::vector<ScreenInnovation>> screen_innovations(const FieldTest& test, const SiteFile& site,
                                                                const ObservedSite& observed,
                                                                const CampaignResult& campaign);

}  // namespace scree::cli
