// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_restarts.hpp"

#include "cli/compare_study.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace scree::cli {

namespace {

double variance_of_mean(const std::vector<double>& values) {
    const double deviation = summary_of(values).deviation;
    return deviation * deviation / static_cast<double>(values.size());
}

/// Value of a table, NaN where there is no such column.
double value_of(const ObservationTable& table, const Column& column, std::size_t row) {
    const std::size_t k = table.find(column);
    return k < table.columns.size() ? table.values[k][row] : kNaN;
}

/// What blocks of a campaign would have been measured to do, and which block each row is.
struct Told {
    ObservationTable table;
    std::vector<std::int64_t> number;  ///< in the campaign, ascending

    Told(const CampaignResult& campaign, const ObservedSite& observed, std::uint64_t seed)
        : table(simulated_table(campaign, observed.observations, observed.op, seed)) {
        for (std::int64_t k = 0; k < std::ssize(campaign.blocks); ++k) {
            const BlockResult& b = campaign.blocks[static_cast<std::size_t>(k)];
            if (b.done && b.reason != StopReason::Failed) number.push_back(k);
        }
    }
    double value(const Column& column, std::int64_t block) const {
        const auto at = std::lower_bound(number.begin(), number.end(), block);
        return at != number.end() && *at == block
                   ? value_of(table, column, static_cast<std::size_t>(at - number.begin()))
                   : kNaN;
    }
};

/// A state that a screen has told.
struct ScreenState {
    double speed = kNaN, height = kNaN, spin = kNaN;
};

ScreenState state_of(const ObservationTable& table, std::int32_t screen, std::size_t row) {
    return {value_of(table, {Quantity::Speed, screen}, row), value_of(table, {Quantity::Height, screen}, row),
            value_of(table, {Quantity::Spin, screen}, row)};
}

/// Simulated crossings that a block of the test may be restarted from, but for that of block `not_of` of the campaign.
std::vector<const ScreenCrossing*> like(const std::vector<const ScreenCrossing*>& at, std::int64_t block,
                                        std::int64_t blocks, double speed, std::int64_t not_of) {
    std::vector<const ScreenCrossing*> own, nearest;
    for (const ScreenCrossing* c : at)
        if (c->block != not_of) (c->block % blocks == block ? own : nearest).push_back(c);
    if (!own.empty()) return own;
    std::stable_sort(nearest.begin(), nearest.end(), [&](const ScreenCrossing* a, const ScreenCrossing* b) {
        return std::abs(a->measured_speed - speed) < std::abs(b->measured_speed - speed);
    });
    nearest.resize(std::min(nearest.size(), static_cast<std::size_t>(kRestarts)));
    return nearest;
}

Departure departure(const ScreenCrossing& c, const CampaignResult& campaign, const ScreenState& state) {
    Departure from;
    from.position = c.position;
    if (std::isfinite(state.height)) from.position.z() += state.height - c.height;
    from.velocity = c.velocity * (state.speed / c.velocity.norm());
    from.spin = std::isfinite(state.spin) ? state.spin : c.spin;
    from.profile = campaign.blocks[static_cast<std::size_t>(c.block)].profile;
    from.s = c.s;
    return from;
}

class Restarts {
public:
    Restarts(const FieldTest& test, const SiteFile& site, const ObservedSite& observed, const CampaignResult& campaign)
        : test_(test),
          site_(site),
          observed_(observed),
          campaign_(campaign),
          seed_(static_cast<std::uint64_t>(site.settings.seed)),
          blocks_(std::ssize(observed.observations.blocks)),
          measured_(measured_table(observed.observations, observed.op)),
          simulated_(campaign, observed, seed_) {}

    /// False: stopped.
    bool run(std::vector<ScreenInnovation>& all) {
        const auto crossings =
            first_crossings_of_all(campaign_.crossings, observed_.op.screen_of, observed_.op.screens.size());
        std::vector<std::int32_t> passed;  // by anybody, of those that measured
        for (std::size_t k = 0; k < crossings.size(); ++k)
            if (const auto screen = static_cast<std::int32_t>(k);
                !crossings[k].empty() && measured_.find({Quantity::Passed, screen}) < measured_.columns.size())
                passed.push_back(screen);
        for (std::size_t k = 0; k < passed.size(); ++k)
            if (!restart(passed[k], crossings[static_cast<std::size_t>(passed[k])],
                         k + 1 < passed.size() ? passed[k + 1] : -1, all))
                return false;
        return true;
    }

private:
    using Departures = std::vector<std::optional<Departure>>;

    bool restart(std::int32_t screen, const std::vector<const ScreenCrossing*>& at, std::int32_t to,
                 std::vector<ScreenInnovation>& all) {
        Departures measured(static_cast<std::size_t>(kRestarts * blocks_)), control = measured;
        std::vector<std::int64_t> original(measured.size(), -1);  // of each control, in the campaign
        std::size_t restarted = 0;
        for (std::size_t row = 0; row < measured_.rows(); ++row) {
            const std::int64_t block = measured_.block[row];
            const ScreenState state = state_of(measured_, screen, row);
            if (block < 0 || !(state.speed > 0.0)) continue;
            const auto from = like(at, block, blocks_, state.speed, -1);
            for (std::int64_t r = 0; r < kRestarts; ++r)
                measured[index(r, block)] =
                    departure(*from[static_cast<std::size_t>(r) % from.size()], campaign_, state);
            ++restarted;
        }
        if (restarted < kLeastRestarted) return true;
        for (std::size_t row = 0; row < simulated_.number.size(); ++row) {
            const std::int64_t number = simulated_.number[row], r = number / blocks_, block = number % blocks_;
            const ScreenState state = state_of(simulated_.table, screen, row);
            if (r >= kRestarts || !(state.speed > 0.0)) continue;
            const auto from = like(at, block, blocks_, state.speed, number);
            if (from.empty()) continue;
            control[index(r, block)] = departure(*from[static_cast<std::size_t>(r) % from.size()], campaign_, state);
            original[index(r, block)] = number;
        }
        const CampaignResult onward = test_.run_from(site_, seed_, measured);
        if (onward.interrupted) return false;
        const CampaignResult controls = test_.run_from(site_, seed_, control);
        if (controls.interrupted) return false;
        const Told restarts(onward, observed_, seed_), repeated(controls, observed_, seed_);
        std::vector<Column> columns{{Quantity::Along, -1}};
        if (to >= 0)
            columns = {{Quantity::Passed, to}, {Quantity::Speed, to}, {Quantity::Height, to}, {Quantity::Spin, to}};
        for (const Column& column : columns) {
            ScreenInnovation innovation = compared(column, restarts, repeated, original);
            if (innovation.blocks < kLeastRestarted) continue;
            innovation.from = screen;
            innovation.to = to;
            all.push_back(innovation);
        }
        return true;
    }

    std::size_t index(std::int64_t repeat, std::int64_t block) const {
        return static_cast<std::size_t>(repeat * blocks_ + block);
    }

    ScreenInnovation compared(const Column& column, const Told& restarts, const Told& repeated,
                              const std::vector<std::int64_t>& original) const {
        RestartedBlocks blocks(column.quantity == Quantity::Passed);
        for (std::size_t row = 0; row < measured_.rows(); ++row) {
            const double value = value_of(measured_, column, row);
            std::vector<double> of_block;
            for (std::int64_t r = 0; r < kRestarts && measured_.block[row] >= 0; ++r)
                if (const double v = restarts.value(column, r * blocks_ + measured_.block[row]); std::isfinite(v))
                    of_block.push_back(v);
            if (std::isfinite(value) && !of_block.empty()) blocks.add(value, of_block);
        }
        std::vector<double> lost;
        for (std::size_t k = 0; k < original.size(); ++k) {
            if (original[k] < 0) continue;
            const double d =
                simulated_.value(column, original[k]) - repeated.value(column, static_cast<std::int64_t>(k));
            if (std::isfinite(d)) lost.push_back(d);
        }
        ScreenInnovation innovation;
        innovation.quantity = column.quantity;
        if (std::min(lost.size(), blocks.blocks()) < kLeastRestarted) return innovation;
        innovation.blocks = blocks.blocks();
        innovation.measured = blocks.measured();
        innovation.simulated = blocks.simulated() + summary_of(lost).mean;
        if (column.quantity == Quantity::Passed) innovation.simulated = std::clamp(innovation.simulated, 0.0, 1.0);
        innovation.error = std::sqrt(blocks.variance() + variance_of_mean(lost));
        return innovation;
    }

    const FieldTest& test_;
    const SiteFile& site_;
    const ObservedSite& observed_;
    const CampaignResult& campaign_;
    std::uint64_t seed_;
    std::int64_t blocks_;
    ObservationTable measured_;
    Told simulated_;
};

}  // namespace

void RestartedBlocks::add(double measured, std::span<const double> restarts) {
    const Eigen::Map<const Eigen::ArrayXd> values(restarts.data(), std::ssize(restarts));
    const auto count = static_cast<double>(restarts.size());
    const double mean = values.mean(), chance = (values.sum() + 0.5) / (count + 1.0);
    measured_ += measured;
    simulated_ += mean;
    differences_.push_back(measured - mean);
    of_shares_ += chance * (1.0 - chance) * (1.0 + 1.0 / count);
    within_ += (values - mean).square().sum();
    freedom_ += count - 1.0;
    weight_ += 1.0 + 1.0 / count;
}

double RestartedBlocks::variance() const {
    const double n = static_cast<double>(blocks());
    const double as_blocks_differ = variance_of_mean(differences_);
    if (shares_) return std::max({of_shares_ / (n * n), 1.0 / (n * n), as_blocks_differ});
    return std::max(freedom_ > 0.0 ? within_ / freedom_ * weight_ / (n * n) : 0.0, as_blocks_differ);
}

std::optional<std::vector<ScreenInnovation>> screen_innovations(const FieldTest& test, const SiteFile& site,
                                                                const ObservedSite& observed,
                                                                const CampaignResult& campaign) {
    std::vector<ScreenInnovation> all;
    if (observed.observations.matched && !Restarts(test, site, observed, campaign).run(all)) return std::nullopt;
    return all;
}

}  // namespace scree::cli
