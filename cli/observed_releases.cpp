// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/observed_releases.hpp"

#include "cli/text.hpp"

#include <cmath>
#include <map>
#include <set>
#include <string>

namespace scree::cli {

namespace {

/// A release point farther from the release layer is perhaps another block's, or in other coordinates [m].
constexpr double kFarFromRelease = 50.0;

struct NearestFeature {
    std::int64_t id = -1;
    double distance = kInfinity;  ///< in plan view [m]
};

NearestFeature nearest_feature(const FeatureLayer& layer, const Vec2& place) {
    NearestFeature nearest;
    for (const Feature& feature : layer.features) {
        const double distance = plan_distance(place, feature.geometry);
        if (distance < nearest.distance) nearest = {feature.id, distance};
    }
    return nearest;
}

void place_blocks(const SiteFile& site, const SiteModel& model, const std::vector<gis::ReleaseRecord>& records,
                  Observations& observations, std::vector<Finding>& findings) {
    const auto find = [&](Severity severity, const char* check, const std::set<std::string>& blocks,
                          const std::string& before, const std::string& after) {
        if (!blocks.empty()) findings.push_back({severity, check, before + listed_few(blocks) + after});
    };
    const auto points = [](const std::set<std::string>& blocks) {
        return std::to_string(blocks.size()) + (blocks.size() == 1 ? " release point is" : " release points are");
    };
    std::map<std::string, ObservedBlock*> measured;
    for (ObservedBlock& block : observations.blocks) measured[block.id] = &block;
    std::vector<Profile> profiles;
    for (const ProfileTrack& track : model.campaign.tracks) profiles.push_back(track.profile);
    const double farthest = site.settings.profile_release_distance;

    std::set<std::string> seen, twice, unmeasured, off, beside, far;
    for (const gis::ReleaseRecord& r : records) {
        const std::string& id = r.body.id;
        if (!seen.insert(id).second) twice.insert(id);
        const auto at = measured.find(id);
        if (at == measured.end()) unmeasured.insert(id);
        if (at == measured.end() || !std::isfinite(r.position.x())) continue;
        ObservedBlock& block = *at->second;
        const Vec2 place = r.position.head<2>();
        if (model.terrain.surface->facet_at(place) < 0) {
            off.insert(id);
        } else if (!model.in_plane()) {
            block.release = place;
            if (nearest_feature(model.release.layer, place).distance > kFarFromRelease) far.insert(id);
        } else if (const auto foot = ProfileRelease::foot(place, profiles, farthest)) {
            block.release = place;  // the third dimension knows as much of it
            block.profile = static_cast<std::int32_t>(foot->profile);
            block.s = foot->s;
        } else {
            beside.insert(id);
        }
    }
    find(Severity::Error, "release_off_terrain", off, points(off) + " off the DTM or over a hole in it (",
         "): check coordinates and CRS");
    find(Severity::Error, "release_twice", twice, "release_points have more than one row for ", ": one for each block");
    find(Severity::Warning, "release_unmeasured", unmeasured,
         points(unmeasured) + " of blocks that nothing else was measured of (",
         "), and not used: block_id must be that of the stops and crossings");
    find(Severity::Warning, "release_far", far,
         points(far) + " more than " + short_number(kFarFromRelease) + " m from the release layer (",
         "): these blocks start there all the same; check block_id and coordinates");
    find(Severity::Warning, "release_beside_profile", beside,
         points(beside) + " more than " + short_number(farthest) + " m from every profile (",
         "): these blocks start anywhere in the release area along the profile; profile.release_distance is that "
         "distance");
}

/// Number of the profile on which a block was let go, or in 3D of the feature of the release layer; -1: unknown.
std::int64_t path_of(const SiteModel& model, const ObservedBlock& block) {
    if (model.in_plane()) return block.profile < 0 ? -1 : block.profile + 1;
    if (!std::isfinite(block.release.x())) return -1;
    return nearest_feature(model.release.layer, block.release).id;
}

void name_paths(const SiteModel& model, Observations& o) {
    std::map<std::int64_t, std::vector<ObservedBlock*>> paths;  // by their numbers
    for (ObservedBlock& block : o.blocks)
        if (const std::int64_t number = path_of(model, block); number >= 0) paths[number].push_back(&block);
    for (const auto& [number, blocks] : paths) {
        for (ObservedBlock* const block : blocks) block->path = static_cast<std::int32_t>(o.paths.size());
        o.paths.push_back((model.in_plane() ? "profile " : "release feature ") + std::to_string(number));
    }
}

}  // namespace

void place_releases(const SiteFile& site, const SiteModel& model, const std::vector<gis::ReleaseRecord>& records,
                    Observations& observations, std::vector<Finding>& findings) {
    if (site.settings.observed.release_positions) place_blocks(site, model, records, observations, findings);
    name_paths(model, observations);
}

}  // namespace scree::cli
