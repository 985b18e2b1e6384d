// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/further_instruments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace scree::cli {

namespace {

struct Kind {
    Kinematic kinematic;
    const char* name;
    double ObservedSettings::*error;
};
constexpr std::array kKinds{Kind{Kinematic::Speed, "speeds", &ObservedSettings::speed_error},
                            Kind{Kinematic::Height, "heights", &ObservedSettings::height_error},
                            Kind{Kinematic::Spin, "spins", &ObservedSettings::spin_error}};

/// What every block does at every screen of the test in a campaign.
class Passages {
public:
    Passages(const CampaignResult& campaign, const ObservationOperator& op) : at_(op.screens.size()) {
        for (const ScreenCrossing& c : campaign.crossings) {
            const std::int32_t screen = op.screen_of[static_cast<std::size_t>(c.screen)];
            if (screen >= 0) at_[static_cast<std::size_t>(screen)].try_emplace(c.block, kinematics_of(c));
        }
    }
    /// Of this block there, else the middle of all; 1 where none passes.
    double value(const ObservedCrossing& c, Kinematic kinematic) const {
        const auto k = static_cast<std::size_t>(kinematic);
        const auto& there = at_[static_cast<std::size_t>(c.screen)];
        if (const auto own = there.find(c.block); own != there.end()) return own->second[k];
        std::vector<double> all;
        for (const auto& [block, values] : there) all.push_back(values[k]);
        if (all.empty()) return 1.0;
        std::nth_element(all.begin(), all.begin() + std::ssize(all) / 2, all.end());
        return all[all.size() / 2];
    }

private:
    std::vector<std::map<std::int64_t, KinematicValues>> at_;  ///< per screen, by block
};

}  // namespace

std::vector<FurtherInstrument> further_instruments(const ObservedSite& observed) {
    std::vector<FurtherInstrument> all;
    const ObservationOperator& op = observed.op;
    const bool screens = op.screens.size() > 2 * op.impacts;
    FurtherInstrument together;
    for (const Kind& kind : kKinds) {
        const auto& seen = observed.observations.crossings;
        const auto k = static_cast<std::size_t>(kind.kinematic);
        if (!screens || std::any_of(seen.begin(), seen.end(), [&](const ObservedCrossing& c) {
                return !op.is_impact(c.screen) && std::isfinite(c.value[k]);
            }))
            continue;
        all.push_back({std::string(kind.name) + " at the screens", {kind.kinematic}});
        together.name += (together.name.empty() ? "" : " and ") + std::string(kind.name);
        together.kinematics.push_back(kind.kinematic);
    }
    together.name += " at the screens";
    if (all.size() > 1) all.push_back(together);
    if (op.impacts == 0)
        all.push_back({"films of the first " + std::to_string(kPlannedImpacts) + " impacts", {}, kPlannedImpacts});
    return all;
}

ObservedSite with_instruments(const ObservedSite& observed, std::span<const FurtherInstrument> instruments,
                              const CampaignResult& once, const ObservedSettings& errors) {
    ObservedSite more = observed;
    std::vector<ObservedCrossing>& crossings = more.observations.crossings;
    std::vector<bool> saw(observed.op.screens.size(), false);
    for (const ObservedCrossing& c : crossings) saw[static_cast<std::size_t>(c.screen)] = true;
    for (const ScreenCrossing& c : once.crossings) {
        const std::int32_t screen = observed.op.screen_of[static_cast<std::size_t>(c.screen)];
        if (saw[static_cast<std::size_t>(screen)]) continue;
        ObservedCrossing& passed = crossings.emplace_back();
        passed.block = observed.observations.matched ? static_cast<std::int32_t>(c.block) : -1;
        passed.screen = screen;
        passed.position = c.position;
    }
    const Passages passages(once, observed.op);
    for (const Kind& kind : kKinds) {
        const auto adds = [&](const FurtherInstrument& i) {
            return std::find(i.kinematics.begin(), i.kinematics.end(), kind.kinematic) != i.kinematics.end();
        };
        if (std::none_of(instruments.begin(), instruments.end(), adds)) continue;
        for (ObservedCrossing& c : crossings) {
            if (observed.op.is_impact(c.screen)) continue;
            c.value[static_cast<std::size_t>(kind.kinematic)] = passages.value(c, kind.kinematic);
            c.error[static_cast<std::size_t>(kind.kinematic)] = errors.*kind.error;
        }
    }
    for (const FilmedImpact& i : once.impacts) {
        const std::int32_t start = observed.op.start_of_impact(i.number);
        for (const std::int32_t end : {start, start + 1}) {
            if (saw[static_cast<std::size_t>(end)]) continue;
            ObservedCrossing& c = crossings.emplace_back();
            c.block = observed.observations.matched ? static_cast<std::int32_t>(i.block) : -1;
            c.screen = end;
            const KinematicValues filmed = kinematics_of(end == start ? i.before : i.after);
            for (const Kinematic k : {Kinematic::Speed, Kinematic::Rise}) {
                c.value[static_cast<std::size_t>(k)] = filmed[static_cast<std::size_t>(k)];
                c.error[static_cast<std::size_t>(k)] = errors.speed_error;
            }
        }
    }
    return more;
}

ObservationTable with_one_instrument(const ObservationTable& table, const ObservedSite& observed,
                                     const FurtherInstrument& instrument) {
    const std::vector<Column> without = observed_columns(observed.observations, observed.op);
    const auto kept = [&](const Column& c) {
        if (std::find(without.begin(), without.end(), c) != without.end()) return true;
        if (c.place >= static_cast<std::int32_t>(observed.op.screens.size())) return instrument.impacts > 0;
        if (c.quantity == Quantity::Passed) return !instrument.kinematics.empty();
        return std::any_of(instrument.kinematics.begin(), instrument.kinematics.end(),
                           [&](Kinematic k) { return quantity_of(static_cast<std::size_t>(k)) == c.quantity; });
    };
    ObservationTable chosen;
    chosen.block = table.block;
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
        if (!kept(table.columns[k])) continue;
        chosen.columns.push_back(table.columns[k]);
        chosen.values.push_back(table.values[k]);
    }
    return chosen;
}

}  // namespace scree::cli
