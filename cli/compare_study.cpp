// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/compare_study.hpp"

#include "cli/text.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace scree::cli {

namespace {

constexpr std::size_t kBandPoints = 201;
constexpr int kRoundChainages = 12;  // about so many passing shares are listed [-]

/// A file name: letters, digits and single underscores.
std::string slug_of(const std::string& name, std::set<std::string>& taken) {
    std::string slug;
    for (const char c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
        if (plain)
            slug += c;
        else if (!slug.empty() && slug.back() != '_')
            slug += '_';
    }
    while (!slug.empty() && slug.back() == '_') slug.pop_back();
    if (slug.empty()) slug = "observable";
    std::string unique = slug;
    for (int k = 2; !taken.insert(unique).second; ++k) unique = slug + "_" + std::to_string(k);
    return unique;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& v : values) v *= factor;
    return values;
}

std::vector<double> finite(const ObservationTable& table, const Column& column) {
    std::vector<double> values;
    const std::size_t k = table.find(column);
    if (k == table.columns.size()) return values;
    for (const double v : table.values[k])
        if (std::isfinite(v)) values.push_back(v);
    return values;
}

ShareEstimate share_above(const std::vector<double>& values, double limit) {
    return {std::count_if(values.begin(), values.end(), [&](double v) { return v > limit; }),
            static_cast<std::int64_t>(values.size())};
}

ComparedObservable compared(const ObservableGap& gap, const CompareStudy& study, const DiscrepancySettings& settings,
                            std::set<std::string>& slugs) {
    ComparedObservable c;
    c.gap = gap;
    c.unit = gap.observable.unit == "J" ? "kJ" : gap.observable.unit;
    c.factor = gap.observable.unit == "J" ? 1e-3 : 1.0;
    c.slug = slug_of(gap.observable.name, slugs);
    if (gap.observable.columns.size() > 1) return c;
    if (gap.observable.share) {
        const Column& column = gap.observable.columns[0];
        c.measured_share = share_above(finite(study.measured, column), 0.5);
        for (const ObservedShare& s : gap.observable.counts) c.measured_share = {s.count, s.thrown};
        c.simulated_share = share_above(finite(study.simulated, column), 0.5);
        return c;
    }
    const ObservableSample sample = observable_sample(study.measured, study.simulated, gap.observable);
    c.measured = scaled(sample.measured.values, c.factor);
    c.simulated = scaled(sample.simulated.values, c.factor);
    c.measured_summary = summary_of(c.measured);
    c.simulated_summary = summary_of(c.simulated);
    if (c.measured.empty() || c.simulated.empty()) return c;
    c.band = distribution_band(sample, kBandPoints, settings);
    c.band.x = scaled(std::move(c.band.x), c.factor);
    return c;
}

std::vector<SharePair> zone_shares(const CompareStudy& study, const ObservedSite& observed) {
    std::vector<SharePair> zones;
    for (std::size_t z = 0; z < observed.op.zones.size(); ++z) {
        const Column column{Quantity::InZone, static_cast<std::int32_t>(z)};
        SharePair pair{observed.op.zones[z], kNaN, share_above(finite(study.measured, column), 0.5),
                       share_above(finite(study.simulated, column), 0.5)};
        for (const ObservedShare& s : observed.observations.shares)
            if (pair.measured.of == 0 && s.zone == column.place) pair.measured = {s.count, s.thrown};
        if (pair.measured.of > 0) zones.push_back(pair);
    }
    return zones;
}

/// Shares of the stops that lie farther along than something.
void add_passing(CompareStudy& study, const SiteModel& model, const ObservedSite& observed) {
    const std::vector<double> measured = finite(study.measured, {Quantity::Along, -1}),
                              simulated = finite(study.simulated, {Quantity::Along, -1});
    if (measured.empty() || simulated.empty()) return;
    std::map<std::string, double> first;  // of screens in several parts
    const std::vector<double> chainages = screen_chainages(model, observed.op.axis);
    for (std::size_t k = 0; k < chainages.size(); ++k) {
        if (!std::isfinite(chainages[k])) continue;
        double& at = first.try_emplace(model.campaign.screens[k].name, chainages[k]).first->second;
        at = std::min(at, chainages[k]);
    }
    for (const auto& [name, at] : first)
        study.beyond_screens.push_back({name, at, share_above(measured, at), share_above(simulated, at)});
    std::sort(study.beyond_screens.begin(), study.beyond_screens.end(),
              [](const SharePair& a, const SharePair& b) { return a.chainage < b.chainage; });
    const double farthest = std::max(*std::max_element(measured.begin(), measured.end()),
                                     *std::max_element(simulated.begin(), simulated.end()));
    const double rough = std::max(farthest, 1.0) / kRoundChainages;
    double step = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double digit : {1.0, 2.0, 5.0, 10.0}) {
        if (digit * step < rough) continue;
        step *= digit;
        break;
    }
    for (double at = step; at < farthest; at += step)
        study.beyond.push_back({{}, at, share_above(measured, at), share_above(simulated, at)});
}

}  // namespace

SampleSummary summary_of(std::vector<double> values) {
    SampleSummary s;
    if (values.empty()) return s;
    const double n = static_cast<double>(values.size());
    s.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double squares = 0.0;
    for (const double v : values) squares += (v - s.mean) * (v - s.mean);
    if (n > 1.0) s.deviation = std::sqrt(squares / (n - 1.0));
    std::sort(values.begin(), values.end());
    for (const double q : kSummaryQuantiles) s.quantiles.push_back(sample_quantile(values, q));
    return s;
}

std::string column_name(const ObservationOperator& op, const Column& column) {
    const auto at_screen = [&](const char* what) { return what + op.screens[static_cast<std::size_t>(column.place)]; };
    switch (column.quantity) {
        case Quantity::Along:
            return "distance along";
        case Quantity::Lateral:
            return "lateral";
        case Quantity::Runout:
            return "runout";
        case Quantity::Passed:
            return at_screen("passing ");
        case Quantity::Speed:
            return at_screen("speed at ");
        case Quantity::Height:
            return at_screen("height at ");
        case Quantity::Spin:
            return at_screen("spin at ");
        case Quantity::Energy:
            return at_screen("energy at ");
        case Quantity::Rise:
            return at_screen("rise at ");
        case Quantity::InZone:
            return "at rest in " + op.zones[static_cast<std::size_t>(column.place)];
    }
    return {};
}

std::string lost_text(const CompareStudy& study) {
    std::string text;
    if (study.lost > 0)
        text = percent(study.lost, study.released) +
               " of the simulated blocks left the terrain or ran out of time: they count where they were last seen";
    if (study.failed > 0)
        text += (text.empty() ? "" : "; ") + percent(study.failed, study.released) +
                " of the simulated blocks came to nothing, as their computation failed, and do not count";
    return text;
}

bool many_lost(const CompareStudy& study) {
    return 100 * (study.lost + study.failed) > study.released;
}

CompareStudy make_study(const SiteFile& site, const SiteModel& model, const ObservedSite& observed,
                        const CampaignResult& campaign) {
    CompareStudy study;
    const auto seed = static_cast<std::uint64_t>(site.settings.seed);
    const DiscrepancySettings settings{site.settings.observed.draws, seed, true};
    study.title = site.settings.name;
    study.seed = site.settings.seed;
    const Observations& o = observed.observations;
    const GapFunction gaps(o, observed.op);
    study.blocks = static_cast<std::size_t>(blocks_of(observed));
    study.repeats = o.matched ? site.settings.observed.repeats : 0;
    study.measured = gaps.measured();
    study.simulated = gaps.simulated(campaign, seed);
    const std::vector<Observable>& observables = gaps.observables();
    const Discrepancy d =
        compare_tables(study.measured, study.simulated, observables, column_scales(study.simulated), settings);
    study.released = campaign.released;
    study.lost = campaign.reasons[static_cast<std::size_t>(StopReason::LeftTerrain)] +
                 campaign.reasons[static_cast<std::size_t>(StopReason::TimeLimit)];
    study.failed = campaign.reasons[static_cast<std::size_t>(StopReason::Failed)];
    study.overall = d.overall;
    study.overall_score = d.overall_score;
    std::set<std::string> slugs{"map", "gaps", "overview", "passing", "pit", "deposit_zones"};
    for (const ObservableGap& gap : d.observables) study.observables.push_back(compared(gap, study, settings, slugs));
    study.zones = zone_shares(study, observed);
    add_passing(study, model, observed);
    study.pits = pit_values(study.measured, study.simulated, observables, seed);
    return study;
}

}  // namespace scree::cli
