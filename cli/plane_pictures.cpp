// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plane_pictures.hpp"

#include "cli/campaign_layers.hpp"
#include "cli/profile_scene.hpp"
#include "cli/text.hpp"
#include "gis/run_picture.hpp"
#include "gis/words.hpp"

#include <algorithm>
#include <array>

namespace scree::cli {

namespace {

const char* const kStopColour = "#0072b2";
const char* const kMeanColour = "#009e73";
const char* const kHighColour = "#d55e00";
const char* const kLargestColour = "#7f7f7f";

/// Blocks of one profile, in per cent of those thrown on it: where they stop, and how many cross a cell.
struct Shares {
    std::vector<double> stop, reach;  ///< [%]
    std::int64_t thrown = 0;
    std::array<std::int64_t, 4> reasons{};
};

Shares shares_of(const CampaignInput& c, const CampaignResult& result, std::size_t number) {
    Shares shares;
    const std::size_t cells = cells_along(c.tracks[number].profile, c.cell_along);
    shares.stop.assign(cells, 0.0);
    shares.reach.assign(cells, 0.0);
    for (const BlockResult& b : result.blocks) {
        if (!b.done || b.profile != static_cast<std::int32_t>(number)) continue;
        ++shares.thrown;
        ++shares.reasons[static_cast<std::size_t>(b.reason)];
        if (b.reason == StopReason::Failed) continue;
        const double last = std::clamp(b.stop_s / c.cell_along, 0.0, static_cast<double>(cells) - 1.0);
        if (b.reason == StopReason::AtRest) shares.stop[static_cast<std::size_t>(last)] += 1.0;
    }
    for (const auto& [cell, statistics] : result.cells_along[number])
        shares.reach[cell] = static_cast<double>(statistics.passages);
    for (std::vector<double>* values : {&shares.stop, &shares.reach})
        for (double& v : *values) v *= 100.0 / static_cast<double>(std::max<std::int64_t>(shares.thrown, 1));
    return shares;
}

/// Mean, 95 % quantile and largest value of a quantity in the cells of a profile.
gis::DrawnPanel panel_of(const CampaignInput& c, const CampaignResult& result, std::size_t number,
                         CellQuantity quantity, const std::string& title) {
    const std::size_t cells = cells_along(c.tracks[number].profile, c.cell_along);
    const auto q = static_cast<std::size_t>(quantity);
    const double factor = kQuantities[q].factor;
    std::vector<double> mean(cells, kNaN), high(cells, kNaN), largest(cells, kNaN);
    for (const auto& [cell, statistics] : result.cells_along[number]) {
        if (statistics.passages == 0) continue;
        const QuantityStatistics& s = statistics.quantities[q];
        mean[cell] = factor * mean_of(s, statistics.passages);
        high[cell] = factor * s.quantile(0.95);
        largest[cell] = factor * s.largest;
    }
    return {title,
            {{"mean", kMeanColour, mean, ""},
             {"95 % quantile", kHighColour, high, ""},
             {"maximum", kLargestColour, largest, "3 2"}}};
}

gis::DrawnRun run_of(const SiteModel& model, const CampaignResult& result, std::size_t number, const Shares& shares) {
    const CampaignInput& c = model.campaign;
    gis::DrawnRun run;
    run.cell = c.cell_along;
    run.facts = gis::counted(static_cast<std::size_t>(shares.thrown), "block") + " in 2D:";
    for (std::size_t k = 0; k < kStopReasonNames.size(); ++k)
        if (shares.reasons[k] > 0)
            run.facts +=
                (run.facts.back() == ':' ? " " : ", ") + std::to_string(shares.reasons[k]) + " " + kStopReasonNames[k];
    run.facts += "; cells of " + short_number(c.cell_along) + " m";
    for (const KeptTrajectory& t : result.trajectories) {
        const BlockResult& b = result.blocks[static_cast<std::size_t>(t.block)];
        if (b.profile != static_cast<std::int32_t>(number)) continue;
        std::vector<Vec2> path;
        for (std::size_t k = 0; k < t.points.size(); ++k) path.emplace_back(t.chainages[k], t.points[k].z());
        run.paths.push_back(std::move(path));
        if (b.reason == StopReason::AtRest) run.stops.emplace_back(b.stop_s, b.stop.z());
    }
    run.panels.push_back({"Stops [%]", {{"stops", kStopColour, shares.stop, ""}}, true});
    run.panels.push_back({"Crossed by [%]", {{"crossed by", kStopColour, shares.reach, ""}}, false, 105.0});
    run.panels.push_back(panel_of(c, result, number, CellQuantity::KineticEnergy, "Energy [kJ]"));
    run.panels.push_back(panel_of(c, result, number, CellQuantity::PassingHeight, "Height [m]"));
    run.panels.push_back(panel_of(c, result, number, CellQuantity::Speed, "Speed [m/s]"));
    return run;
}

}  // namespace

std::vector<gis::TextFile> run_pictures(const SiteFile& site, const SiteModel& model, const CampaignResult& result) {
    std::vector<gis::TextFile> pictures;
    if (!model.in_plane()) return pictures;
    gis::ProfileScene scene = profile_scene(site.settings.name, model.terrain, *model.profiles);
    for (std::size_t k = 0; k < model.campaign.screens.size(); ++k) {
        const Screen& screen = model.campaign.screens[k];
        if (!screen.line.empty()) {
            scene.screens.push_back({screen.name, screen.line});
            continue;
        }
        for (std::size_t p = 0; p < model.campaign.tracks.size(); ++p)
            for (const ProfileTrack::Mark& mark : model.campaign.tracks[p].marks)
                if (mark.screen == static_cast<std::int32_t>(k))
                    scene.profiles[p].marks.emplace_back(mark.s, screen.name);
    }
    if (model.deposit_zones) scene.deposit_zones = drawn_areas(*model.deposit_zones, site.settings.deposit_zones.field);
    scene.releases = drawn_areas(model.release, "");
    const auto most = static_cast<std::size_t>(site.settings.profile_pictures);
    for (std::size_t k = 0; k < scene.profiles.size() && pictures.size() < most; ++k) {
        const Shares shares = shares_of(model.campaign, result, k);
        if (shares.thrown == 0) continue;
        gis::DrawnRun run = run_of(model, result, k, shares);
        run.title = site.settings.name + ": run on profile " + scene.profiles[k].name;
        pictures.push_back({"profile_" + scene.profiles[k].name + ".svg", gis::run_picture(scene, k, run)});
    }
    return pictures;
}

}  // namespace scree::cli
