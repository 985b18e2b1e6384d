// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/space_model.hpp"

#include "scree/base/assert.hpp"
#include "scree/base/error.hpp"
#include "scree/base/random.hpp"

#include <algorithm>

namespace scree::cli {

namespace {

/// Of the streams of Observation those below are blocks'.
constexpr std::uint64_t kOfDimension = std::uint64_t{1} << 41;

/// As far as the terrain goes on both sides.
std::vector<Vec2> across(const Profile& profile, double chainage, const Surface& surface, const GridShape& shape) {
    const Vec2 at = profile.place_at(chainage), along = profile.direction_at(chainage), left(-along.y(), along.x());
    const auto end = [&](const Vec2& side) {
        Vec2 p = at;
        for (int k = 0; k < shape.columns + shape.rows; ++k) {
            const Vec2 next = p + shape.cell * side;
            if (surface.facet_at(next) < 0) break;
            p = next;
        }
        return p;
    };
    return {end(-left), end(left)};
}

}  // namespace

SpaceModel make_space_model(const SiteFile& site, const SiteModel& plane) {
    SpaceModel model;
    if (!plane.in_plane())
        model.none = "the model has it";
    else if (plane.campaign.tracks.size() != 1)
        model.none = "there are several profiles";
    else
        for (const Effect& e : plane.campaign.effects)
            if (e.place.reaches || !e.place.stations.empty())
                model.none = "an effect of the site has its place along the profile";
    if (!model.none.empty()) return model;
    try {
        model.area = std::make_unique<ReleaseArea>(plane.release.layer, *plane.terrain.surface,
                                                   site.settings.releases.pattern, plane.terrain.data.grid.shape);
    } catch (const InputError& e) {
        model.none = e.what();
        return model;
    }
    CampaignInput& c = model.campaign = plane.campaign;
    const ProfileTrack track = c.tracks.front();
    c.tracks.clear();
    c.profile_release = nullptr;
    c.surface = plane.terrain.surface.get();
    c.area = model.area.get();
    c.effects = plane.terrain.effects;
    c.population.filling = BlockPopulation{}.filling;
    c.result_cells = plane.terrain.data.grid.shape;
    for (const ProfileTrack::Mark& mark : track.marks) {
        std::vector<Vec2>& line = c.screens[static_cast<std::size_t>(mark.screen)].line;
        if (line.empty()) line = across(track.profile, mark.s, *c.surface, c.result_cells);
    }
    return model;
}

std::vector<bool> chosen_share(std::int64_t blocks, double share, std::uint64_t seed) {
    std::vector<bool> chosen(static_cast<std::size_t>(blocks));
    RandomStream random(seed, kOfDimension, RandomPurpose::Observation);
    for (std::size_t k = 0; k < chosen.size(); ++k) chosen[k] = random.uniform() < share;
    return chosen;
}

CampaignResult merged(CampaignResult plane, const CampaignResult& space) {
    SCREE_ASSERT(plane.blocks.size() == space.blocks.size());
    for (std::size_t k = 0; k < plane.blocks.size(); ++k)
        if (space.blocks[k].done) plane.blocks[k] = space.blocks[k];
    plane.released += space.released;
    for (std::size_t k = 0; k < plane.reasons.size(); ++k) plane.reasons[k] += space.reasons[k];
    plane.interrupted |= space.interrupted;
    const auto merge = [&](auto member) {
        auto& to = plane.*member;
        to.insert(to.end(), (space.*member).begin(), (space.*member).end());
        std::stable_sort(to.begin(), to.end(), [](const auto& a, const auto& b) { return a.block < b.block; });
    };
    merge(&CampaignResult::crossings);
    merge(&CampaignResult::impacts);
    return plane;
}

}  // namespace scree::cli
