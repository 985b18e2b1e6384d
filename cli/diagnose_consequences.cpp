// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_consequences.hpp"

#include "cli/campaign_layers.hpp"
#include "cli/plane_layers.hpp"
#include "cli/plot.hpp"
#include "scree/inference/distance.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

namespace {

using gis::Svg;
using gis::SvgPanel;

constexpr double kShare = 0.95;                                                           // [-]
constexpr double kWidth = 760.0, kPanel = 170.0, kGap = 64.0, kLeft = 74.0, kTop = 56.0;  // [pixel]
constexpr const char* kBeforeColour = "#8c8c8c";

std::vector<AtScreen> at_screens(const DiagnoseStudy& study, const CampaignResult& campaign) {
    std::vector<AtScreen> all;
    for (const auto& at : first_crossings_of_all(campaign.crossings, study.screen_of, study.screens.size())) {
        const auto high = [&](auto value) {
            std::vector<double> values;
            for (const ScreenCrossing* c : at) values.push_back(value(*c));
            std::sort(values.begin(), values.end());
            return values.empty() ? kNaN : sample_quantile(values, kShare);
        };
        all.push_back(
            {static_cast<double>(at.size()) / static_cast<double>(std::max<std::int64_t>(campaign.released, 1)),
             high([](const ScreenCrossing& c) { return c.velocity.norm(); }),
             high([](const ScreenCrossing& c) { return c.energy; }),
             high([](const ScreenCrossing& c) { return c.height; })});
    }
    return all;
}

/// A value of each cell along a profile, NaN where no block came.
template <class Value>
std::vector<double> along(const SiteModel& model, std::size_t track, const CampaignResult& campaign, Value value) {
    const CampaignInput& c = model.campaign;
    std::vector<double> values(cells_along(c.tracks[track].profile, c.cell_along), kNaN);
    for (const auto& [cell, statistics] : campaign.cells_along[track])
        if (statistics.passages > 0) values[cell] = value(statistics);
    return values;
}

struct Curves {
    std::string title;
    std::vector<double> before, after;
};

template <class Value>
Curves curves(const std::string& title, const SiteModel& model, std::size_t track, const CampaignResult& before,
              const CampaignResult& after, Value value) {
    return {title, along(model, track, before, value), along(model, track, after, value)};
}

void draw_curve(Svg& svg, const SvgPanel& panel, const std::vector<double>& values, double cell, const char* colour) {
    std::vector<Vec2> line;
    const auto draw = [&] {
        if (line.size() > 1) svg.line(line, stroke(colour, 2.0));
        line.clear();
    };
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (std::isfinite(values[k]))
            line.push_back(panel.at({(static_cast<double>(k) + 0.5) * cell, values[k]}));
        else
            draw();
    }
    draw();
}

Figure along_profile(const DiagnoseStudy& study, const AnswerFit& answer, const SiteModel& model, std::size_t track) {
    const ProfileTrack& on = model.campaign.tracks[track];
    const auto high = [](CellQuantity quantity) {
        return [q = static_cast<std::size_t>(quantity)](const CellStatistics& s) {
            return kQuantities[q].factor * s.quantities[q].quantile(kShare);
        };
    };
    std::vector<Curves> panels;
    const auto reach = [&](const CampaignResult& result) {
        return along(model, track, result,
                     [thrown = std::max(blocks_thrown_on(result, track), 1.0)](const CellStatistics& s) {
                         return 100.0 * static_cast<double>(s.passages) / thrown;
                     });
    };
    panels.push_back({"Reach probability [%]", reach(study.campaign), reach(answer.campaign)});
    panels.push_back(
        curves("Energy, 95 % [kJ]", model, track, study.campaign, answer.campaign, high(CellQuantity::KineticEnergy)));
    panels.push_back(curves("Passing height, 95 % [m]", model, track, study.campaign, answer.campaign,
                            high(CellQuantity::PassingHeight)));
    const double cell = model.campaign.cell_along, length = on.profile.length();
    Svg svg(kLeft + kWidth + 24.0, kTop + static_cast<double>(panels.size()) * (kPanel + kGap));
    for (std::size_t k = 0; k < panels.size(); ++k) {
        const Curves& c = panels[k];
        double most = 0.0;
        for (const std::vector<double>* values : {&c.before, &c.after})
            for (const double v : *values) most = std::isfinite(v) ? std::max(most, v) : most;
        const double top = kTop + static_cast<double>(k) * (kPanel + kGap);
        const SvgPanel panel{{{kLeft, top}, {kLeft + kWidth, top + kPanel}},
                             {{0.0, 0.0}, {length, 1.05 * std::max(most, 1e-9)}}};
        draw_x_axis(svg, panel, "Distance along the profile [m]", 12);
        draw_y_axis(svg, panel, c.title, 5);
        for (const ProfileTrack::Mark& mark : on.marks) {
            svg.segment(panel.at({mark.s, panel.data.min.y()}), panel.at({mark.s, panel.data.max.y()}),
                        stroke("#5a2d91", 1.2, "7 3"));
            if (k == 0)
                svg.text(panel.at({mark.s, panel.data.max.y()}) + Vec2(0.0, -4.0),
                         model.campaign.screens[static_cast<std::size_t>(mark.screen)].name, words(11.0, "middle"));
        }
        draw_curve(svg, panel, c.before, cell, kBeforeColour);
        draw_curve(svg, panel, c.after, cell, kSimulatedColour);
        draw_frame(svg, panel);
    }
    Vec2 at(kLeft, 22.0);
    at.x() += draw_legend(svg, at, LegendMark::Line, kBeforeColour, "calibrated model");
    draw_legend(svg, at, LegendMark::Line, kSimulatedColour, "with " + answer.name());
    const bool one = model.campaign.tracks.size() == 1;
    const std::string number = std::to_string(track + 1);
    return {one ? "reach.svg" : "reach_" + number + ".svg",
            "What it changes along " + (one ? std::string("the profile") : "profile " + number),
            "The measured blocks thrown again and again, with the calibrated model and with " + answer.name() +
                ". Energies and heights: 95 % of the blocks that come by stay below.",
            svg.text()};
}

}  // namespace

static bool acts_on_blocks(const AnswerFit& answer) {
    return std::any_of(answer.effects.begin(), answer.effects.end(),
                       [](const AnsweredEffect& e) { return !e.candidate->measurement; });
}

const AnswerFit* answer_on_blocks(const DiagnoseStudy& study) {
    const AnswerFit* a = study.planning ? nullptr : study.answer();
    return a && acts_on_blocks(*a) ? a : nullptr;
}

std::array<ChangedValue, 4> values_of(const ScreenChange& c) {
    return {{{"passed_percent", 100.0 * c.before.passed, 100.0 * c.after.passed},
             {"speed_p95_ms", c.before.speed, c.after.speed},
             {"energy_p95_kj", c.before.energy / kJoulePerKj, c.after.energy / kJoulePerKj},
             {"height_p95_m", c.before.height, c.after.height}}};
}

double fastest_on(const SiteModel& model, const CampaignResult& campaign, const std::string& soil) {
    constexpr std::int64_t kMany = 20;  // of fewer a quantile says little
    const CampaignInput& c = model.campaign;
    double fastest = kNaN;
    const auto add = [&](SoilId of_cell, const CellStatistics& s) {
        if (c.soils[of_cell].name != soil || s.passages < kMany) return;
        fastest = std::fmax(fastest, s.quantities[static_cast<std::size_t>(CellQuantity::Speed)].quantile(kShare));
    };
    for (std::size_t k = 0; k < c.tracks.size(); ++k) {
        const Profile& profile = c.tracks[k].profile;
        for (const auto& [cell, statistics] : campaign.cells_along[k])
            add(profile.soil_at(std::min((static_cast<double>(cell) + 0.5) * c.cell_along, profile.length())),
                statistics);
    }
    for (const auto& [cell, statistics] : campaign.cells) {
        const auto columns = static_cast<std::size_t>(c.result_cells.columns);
        const std::int64_t facet = c.surface->facet_at(
            c.result_cells.centre(static_cast<int>(cell % columns), static_cast<int>(cell / columns)));
        std::array<Vec3, 3> corners;
        SoilId of_facet = 0;
        if (facet >= 0 && c.surface->facet(facet, corners, of_facet)) add(of_facet, statistics);
    }
    return fastest;
}

std::vector<ScreenChange> changes_at_screens(const DiagnoseStudy& study, std::size_t answer) {
    std::vector<ScreenChange> changes;
    if (answer >= study.standing() || !acts_on_blocks(study.answers[answer])) return changes;
    const std::vector<AtScreen> before = at_screens(study, study.campaign),
                                after = at_screens(study, study.answers[answer].campaign);
    for (std::size_t s = 0; s + 2 * study.impacts < study.screens.size(); ++s)
        changes.push_back({study.screens[s], before[s], after[s]});
    return changes;
}

std::vector<Figure> consequence_figures(const DiagnoseStudy& study, const SiteModel& model,
                                        const ObservedSite& observed) {
    const AnswerFit* answer = answer_on_blocks(study);
    if (!answer) return {};
    if (answer->in_space()) return {};  // a profile and a map are not put side by side
    if (model.in_plane()) {
        std::vector<Figure> profiles;
        for (std::size_t k = 0; k < model.campaign.tracks.size(); ++k)
            if (!answer->campaign.cells_along[k].empty()) profiles.push_back(along_profile(study, *answer, model, k));
        return profiles;
    }
    std::vector<Figure> maps{reach_map("calibrated model", model, observed, study.campaign),
                             reach_map("with " + answer->name(), model, observed, answer->campaign)};
    maps[0].file = "reach_calibrated.svg";
    maps[1].file = "reach_extended.svg";
    return maps;
}

}  // namespace scree::cli
