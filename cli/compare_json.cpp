// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/commands.hpp"
#include "cli/compare_report.hpp"
#include "cli/json.hpp"

namespace scree::cli {

namespace {

Json pair(double low, double high) {
    return Json::array({low, high});
}

Json gap_json(const Gap& gap, double factor) {
    Json json;
    json["gap"] = gap.gap;
    json["gap_95"] = ends_of(gap.interval);
    json["chance_95"] = ends_of(gap.chance);
    json["p"] = gap.p;
    json["distance"] = factor * gap.distance;
    json["floor"] = factor * gap.floor;
    return json;
}

Json summary_json(const SampleSummary& s) {
    Json json;
    json["mean"] = s.mean;
    json["standard_deviation"] = s.deviation;
    Json quantiles = Json::object();
    for (std::size_t k = 0; k < s.quantiles.size(); ++k)
        quantiles[std::to_string(static_cast<int>(100.0 * kSummaryQuantiles[k] + 0.5))] = s.quantiles[k];
    json["quantiles_percent"] = quantiles;
    return json;
}

Json wasserstein_json(const WassersteinGap& w, double factor) {
    Json json;
    json["distance"] = factor * w.distance;
    json["distance_95"] = pair(factor * w.interval.low, factor * w.interval.high);
    json["chance_median"] = factor * w.chance_median;
    json["chance_p95"] = factor * w.chance_high;
    json["resampled_median"] = factor * w.floor_median;
    json["resampled_p95"] = factor * w.floor_high;
    return json;
}

Json share_json(const ShareEstimate& share) {
    const auto [low, high] = share.interval();
    return {{"count", share.count}, {"of", share.of}, {"share", share.share()}, {"share_95", pair(low, high)}};
}

Json observable_json(const ComparedObservable& o) {
    Json json;
    json["name"] = o.gap.observable.name;
    json["unit"] = o.unit;
    json["known_blocks"] = o.gap.observable.matched;
    json["counts_in_overall"] = o.gap.observable.overall;
    json["measured_n"] = o.gap.measured;
    json["simulated_n"] = o.gap.simulated;
    if (!o.gap.status.empty()) json["status"] = o.gap.status;
    if (!o.measured.empty()) json["measured"] = summary_json(o.measured_summary);
    if (!o.simulated.empty()) json["simulated"] = summary_json(o.simulated_summary);
    if (o.measured_share.of > 0) {
        json["measured"] = share_json(o.measured_share);
        json["simulated"] = share_json(o.simulated_share);
    }
    json["pooled"] = gap_json(o.gap.pooled, o.factor);
    if (o.gap.score) json["per_block"] = gap_json(*o.gap.score, o.factor);
    if (o.gap.wasserstein) json["wasserstein"] = wasserstein_json(*o.gap.wasserstein, o.factor);
    if (!o.band.x.empty())
        json["distribution"] = {
            {"x", o.band.x}, {"simulated", o.band.share}, {"chance_low", o.band.low}, {"chance_high", o.band.high}};
    return json;
}

Json pairs_json(const std::vector<SharePair>& pairs, bool chainage) {
    Json list = Json::array();
    for (const SharePair& p : pairs) {
        Json json;
        if (!p.name.empty()) json["name"] = p.name;
        if (chainage) json["distance_along_m"] = p.chainage;
        json["measured"] = share_json(p.measured);
        json["simulated"] = share_json(p.simulated);
        list.push_back(json);
    }
    return list;
}

Json axis_json(const SiteModel& model, const ObservedSite& observed) {
    const LocalFrame& frame = model.terrain.data.frame;
    Json line = Json::array();
    for (const Vec2& p : observed.op.axis.line()) line.push_back({p.x() + frame.easting, p.y() + frame.northing});
    return {{"description", observed.axis_text},
            {"origin", {observed.op.origin.x() + frame.easting, observed.op.origin.y() + frame.northing}},
            {"line", line}};
}

}  // namespace

std::string compare_json(const CompareStudy& study, const SiteModel& model, const ObservedSite& observed,
                         const CampaignResult& campaign) {
    Json json;
    json["program"] = "scree " + version();
    json["site"] = study.title;
    json["seed"] = study.seed;
    json["design"] = observed.observations.matched ? "known blocks" : "pool";
    json["measured_blocks"] = study.blocks;
    if (observed.observations.matched) json["repeats"] = study.repeats;
    Json ends = Json::object();
    for (std::size_t k = 0; k < kStopReasonNames.size(); ++k) ends[kStopReasonNames[k]] = campaign.reasons[k];
    json["simulated"] = {{"released", campaign.released}, {"ended", ends}};
    json["axis"] = axis_json(model, observed);
    Json overall;
    overall["pooled"] = gap_json(study.overall, 1.0);
    if (study.overall_score) overall["per_block"] = gap_json(*study.overall_score, 1.0);
    json["overall"] = overall;
    Json list = Json::array();
    for (const ComparedObservable& o : study.observables) list.push_back(observable_json(o));
    json["observables"] = list;
    json["deposit_zones"] = pairs_json(study.zones, false);
    json["stopped_beyond_screens"] = pairs_json(study.beyond_screens, true);
    json["stopped_beyond"] = pairs_json(study.beyond, true);
    Json pits = Json::array();
    for (const BlockPit& p : study.pits)
        pits.push_back({{"block_id", observed.observations.blocks[static_cast<std::size_t>(p.block)].id},
                        {"observable", column_name(observed.op, p.column)},
                        {"pit", p.u}});
    json["pit"] = pits;
    Json findings = Json::array();
    for (const Finding& f : observed.findings)
        findings.push_back({{"severity", f.severity == Severity::Error ? "error" : "warning"},
                            {"check", f.check},
                            {"sentence", f.sentence}});
    json["findings"] = findings;
    json["sources"] = observed.sources;
    return json_text(json, 1) + "\n";
}

}  // namespace scree::cli
