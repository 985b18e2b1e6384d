// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plane_model.hpp"

#include "cli/text.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

namespace scree::cli {

namespace {

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Cells of the curves along all profiles: beyond, neither memory nor a table holds them [-].
constexpr double kMostCurveCells = 1e7;

void require_few_cells(const CampaignInput& c) {
    double cells = 0.0;
    for (const ProfileTrack& track : c.tracks) cells += std::ceil(track.profile.length() / c.cell_along);
    if (cells > kMostCurveCells)
        throw InputError("output.resolution = " + short_number(c.cell_along) + " m gives " + short_number(cells) +
                         " result cells along the profiles, more than the 10 million that are allowed; choose a "
                         "coarser one");
}

void require_whole_profiles(const SiteFile& site, const SiteProfiles& profiles) {
    for (std::size_t k = 0; k < profiles.traces.size(); ++k)
        if (profiles.traces[k].end == ProfileEnd::Merged)
            throw InputError(
                site.file.string() + ": profile.converging = \"merge\" ends profile " + std::to_string(k + 1) +
                " where it runs into another, and blocks would end with it; in 2D use \"keep\" or \"drop\"");
}

/// Screens of the layer where they cut the profiles, and those given by their chainage.
void add_marks(const SiteFile& site, SiteModel& model) {
    CampaignInput& c = model.campaign;
    const std::size_t drawn = c.screens.size();
    const auto chainages = parse_chainages(site.settings.screen_chainages);
    for (const auto& [name, s] : chainages) {
        if (std::any_of(c.screens.begin(), c.screens.end(), [&](const Screen& other) { return other.name == name; }))
            throw InputError(site.file.string() + ": screens.chainages: there are two screens called '" + name +
                             "'; give each a name of its own");
        c.screens.push_back({name, {}, -1});
    }
    std::map<std::string, bool> met;  // a name may have several lines
    for (std::size_t k = 0; k < c.screens.size(); ++k) {
        bool& stands = met[c.screens[k].name];
        for (ProfileTrack& track : c.tracks) {
            std::vector<double> places;
            if (k < drawn)
                places = track.profile.crossings(c.screens[k].line);
            else if (track.profile.contains(chainages[k - drawn].second))
                places = {chainages[k - drawn].second};
            for (const double s : places) track.marks.push_back({static_cast<std::int32_t>(k), s});
            stands = stands || !places.empty();
        }
    }
    for (const auto& [name, stands] : met)
        if (stands)
            model.met_screens.insert(name);
        else
            model.warnings.push_back("screen " + name + " stands on no profile: no block will cross it in 2D");
}

/// Half the width of the widest of blocks [m]: a tree farther from a profile is passed by.
constexpr double kWidest = 10.0;

/// An effect in a place that no profile passes does nothing, which may be a slip.
void warn_of_effects_beside(SiteModel& model) {
    for (const Effect& effect : model.campaign.effects) {
        const EffectPlace& place = effect.place;
        const bool drawn = place.area || !place.points.empty() || !place.lines.empty();
        if (!drawn && !place.reaches && place.stations.empty()) continue;
        if (effect.kind == EffectKind::Berm && drawn) continue;  // it is in the surface
        bool met = false;
        double longest = 0.0;
        for (const ProfileTrack& track : model.campaign.tracks) {
            const double length = track.profile.length();
            longest = std::max(longest, length);
            const EffectPlace along = effects_along({&effect, 1}, track.profile).front().place;
            for (const double s : along.stations) met = met || (s > 0.0 && s < length);
            for (const Vec3& p : along.points) met = met || std::abs(p.y()) < kWidest;
            if (along.reaches)
                for (const Stretch& r : *along.reaches) met = met || (r.from < length && r.to > 0.0);
        }
        if (met) continue;
        std::ostringstream text;
        text << "effect " << effect_info(effect.kind).name
             << (drawn ? " is drawn where no profile passes" : " acts beyond the end of every profile")
             << " (the longest is " << std::lround(longest) << " m long): it does nothing here";
        model.warnings.push_back(text.str());
    }
}

void warn_of_what_is_not_met(const SiteFile& site, SiteModel& model) {
    const SiteSettings& s = site.settings;
    const std::vector<std::int64_t>& left_out = model.profile_release->left_out();
    std::string ids;
    for (std::size_t k = 0; k < std::min<std::size_t>(left_out.size(), 10); ++k)
        ids += (k ? ", " : "") + std::to_string(left_out[k]);
    if (!left_out.empty())
        model.warnings.push_back(s.release.file + ": no profile meets the features " + ids +
                                 (left_out.size() > 10 ? ", ..." : "") +
                                 ": no block starts there in 2D, all start on the others");
    const std::vector<bool>& used = model.profile_release->used();
    const auto idle = std::count(used.begin(), used.end(), false);
    if (idle > 0)
        model.warnings.push_back(std::to_string(idle) + " of " + std::to_string(used.size()) +
                                 " profiles meet no release feature: no block starts on them");
    for (std::size_t z = 0; z < model.campaign.deposit_zones.size(); ++z) {
        const auto& area = std::get<MultiPolygon>(model.deposit_zones->layer.features[z].geometry);
        model.met_zones.push_back(std::any_of(model.campaign.tracks.begin(), model.campaign.tracks.end(),
                                              [&](const ProfileTrack& t) { return !t.profile.inside(area).empty(); }));
        if (!model.met_zones.back())
            model.warnings.push_back("deposit zone " + model.campaign.deposit_zones[z].name +
                                     " lies on no profile: no block can stop in it in 2D");
    }
    if (s.releases.speed > 0.0 && s.azimuth_deg != 0.0)
        model.warnings.push_back(
            "release.azimuth_deg does not matter in 2D: the initial speed points down along the profile");
    if (s.releases.pattern == ReleasePattern::Cells &&
        s.releases.count < static_cast<std::int64_t>(model.profile_release->cell_count()))
        model.warnings.push_back("release.count = " + std::to_string(s.releases.count) + " is less than the " +
                                 std::to_string(model.profile_release->cell_count()) +
                                 " start cells: some cells release no block");
}

}  // namespace

std::vector<std::pair<std::string, double>> parse_chainages(const std::string& text) {
    std::vector<std::pair<std::string, double>> marks;
    for (std::size_t from = 0; from <= text.size() && !trimmed(text).empty();) {
        const std::size_t end = std::min(text.find(',', from), text.size());
        const std::string item = trimmed(text.substr(from, end - from));
        const auto equals = item.rfind('=');
        const std::string name = equals == std::string::npos ? "" : trimmed(item.substr(0, equals)),
                          number = equals == std::string::npos ? "" : trimmed(item.substr(equals + 1));
        double s = 0.0;
        const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), s);
        if (name.empty() || name.find_first_of("=;") != std::string::npos || error != std::errc() ||
            rest != number.data() + number.size() || !std::isfinite(s) || s < 0.0)
            throw InputError("screens.chainages: \"" + item +
                             "\" is no screen: write NAME = CHAINAGE in metres from the upper end of the profiles, "
                             "separated by commas, such as \"ES1 = 39.5, ES2 = 48.5\"");
        marks.emplace_back(name, s);
        from = end + 1;
    }
    return marks;
}

void add_profiles(const SiteFile& site, SiteModel& model) {
    const SiteSettings& s = site.settings;
    model.profiles = trace_site_profiles(site, model.terrain);
    require_whole_profiles(site, *model.profiles);
    model.warnings.insert(model.warnings.end(), model.profiles->warnings.begin(), model.profiles->warnings.end());
    for (const std::string& file : model.profiles->inputs)
        if (std::find(model.inputs.begin(), model.inputs.end(), file) == model.inputs.end())
            model.inputs.push_back(file);

    CampaignInput& c = model.campaign;
    std::vector<Profile> lines;
    for (const ProfileTrace& trace : model.profiles->traces) {
        c.tracks.push_back({raise_berms(c.effects, trace.profile), {}});  // those given by their chainage
        lines.push_back(trace.profile);
    }
    c.cell_along = s.result_resolution > 0.0 ? s.result_resolution : model.terrain.data.grid.shape.cell;
    require_few_cells(c);
    if (c.population.list.empty()) c.population.filling = mean_filling(c.population.shape);
    try {
        model.profile_release =
            std::make_unique<ProfileRelease>(model.release.layer, lines, s.releases.pattern,
                                             model.terrain.data.grid.shape.cell, s.profile_release_distance);
    } catch (const InputError& e) {
        throw InputError(model.release.report.file + ": " + e.what());  // the core knows no files
    }
    c.profile_release = model.profile_release.get();
    warn_of_effects_beside(model);
    add_marks(site, model);
    warn_of_what_is_not_met(site, model);
}

}  // namespace scree::cli
