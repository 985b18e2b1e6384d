// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/site_profiles.hpp"

#include "scree/base/error.hpp"
#include "scree/base/units.hpp"
#include "scree/geometry/region.hpp"

#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace scree::cli {

namespace {

constexpr std::size_t kMostProfiles = 2000;  // more would be a map, not sections [-]

ProfileSettings profile_settings(const SiteSettings& s) {
    ProfileSettings settings = s.profile;
    settings.gentle_slope = radians_from_degrees(s.profile_gentle_slope_deg);
    return settings;
}

void require_few(std::size_t count, const std::string& file, const std::string& what) {
    if (count > kMostProfiles)
        throw InputError(file + ": " + std::to_string(count) + " " + what + "; at most " +
                         std::to_string(kMostProfiles) +
                         " are possible: choose a larger profile.spacing, or fewer features");
}

/// Where blocks start, of the release layer and of that in which profiles start.
Region areas_of(std::span<const FeatureLayer* const> layers) {
    MultiPolygon all;
    for (const FeatureLayer* layer : layers)
        for (const Feature& feature : layer->features)
            if (const auto* polygons = std::get_if<MultiPolygon>(&feature.geometry))
                all.insert(all.end(), polygons->begin(), polygons->end());
    return Region(all);
}

/// Lines from points, lines and polygons.
void trace_from_starts(const SiteSettings& s, const SiteTerrain& terrain, const Region& releases, ProfileTracer& tracer,
                       SiteProfiles& out) {
    const FeatureLayer& layer = out.features.layer;
    const std::vector<ProfileStart> starts = profile_starts(layer, s.profile_spacing);
    require_few(starts.size(), out.source, "starting points");
    std::size_t outside = 0, level = 0;
    for (const ProfileStart& start : starts) {
        if (terrain.surface->facet_at(start.at) < 0) {
            ++outside;
            continue;
        }
        ProfileTrace trace = tracer.steepest(start.at, &releases);
        if (trace.profile.empty())
            ++level;
        else
            out.traces.push_back(std::move(trace));
    }
    const std::string of = " of " + std::to_string(starts.size()) + " starting points ";
    if (out.traces.empty())
        throw InputError(out.source + ": no profile can begin there: " + std::to_string(outside) + of +
                         "lie off the terrain or over a hole of it, " + std::to_string(level) +
                         " on level ground; move them, or name others in profile.start");
    if (outside > 0)
        out.warnings.push_back(out.source + ": " + std::to_string(outside) + of +
                               "lie off the terrain or over a hole of it: no profile begins there");
    if (level > 0)
        out.warnings.push_back(out.source + ": " + std::to_string(level) + of +
                               "lie on level ground, which has no direction to go: no profile begins there");
}

/// Blocks go down a line from its first point. One that was drawn the other way round would have them run backwards.
void require_downhill(const Profile& drawn, const std::string& which, std::vector<std::string>& warnings) {
    constexpr double kUphill = 0.2;  // of what such a line rises it falls less [-]
    double up = 0.0, down = 0.0;
    for (std::size_t k = 1; k < drawn.vertex_count(); ++k)
        (drawn.z[k] > drawn.z[k - 1] ? up : down) += std::abs(drawn.z[k] - drawn.z[k - 1]);
    if (up <= down) return;
    const std::string rises =
        which + ": the line ends " + std::to_string(std::lround(up - down)) + " m higher than it begins";
    if (down < kUphill * up)
        throw InputError(rises + ", but lines are drawn downhill: turn it round (in QGIS with Reverse line direction)");
    warnings.push_back(rises + ": lines are drawn downhill; turn it round if this one was drawn uphill");
}

/// Lines along guides.
void trace_guides(const SiteSettings& s, const SiteTerrain& terrain, const Region& releases, ProfileTracer& tracer,
                  SiteProfiles& out) {
    std::size_t count = 0;
    for (const Feature& feature : out.features.layer.features) {
        const auto* lines = std::get_if<Polylines>(&feature.geometry);
        if (!lines) continue;
        require_few(count += lines->size(), out.source, "lines");
        for (const Polyline& line : *lines) {
            std::vector<Vec2> plan;
            for (const Vec3& p : line.points) plan.emplace_back(p.head<2>());
            const std::string which = out.source + ", feature " + std::to_string(feature.id);
            if (plan.empty() || terrain.surface->facet_at(plan.front()) < 0)
                throw InputError(which +
                                 ": the line begins off the terrain or over a hole of it; let it begin on the terrain");
            ProfileTrace trace =
                s.profile_mode == ProfileMode::Guided ? tracer.guided(plan, &releases) : tracer.along(plan);
            if (trace.profile.empty())
                throw InputError(which +
                                 ": no profile can be led along this line: it has no length, or the ground is level "
                                 "at its first point");
            require_downhill(tracer.along(plan).profile, which, out.warnings);
            if (s.profile_mode == ProfileMode::Line && trace.end != ProfileEnd::LineEnd)
                out.warnings.push_back(which + ": the line leaves the terrain at s = " +
                                       std::to_string(static_cast<int>(trace.profile.length())) +
                                       " m: the profile ends there");
            out.traces.push_back(std::move(trace));
        }
    }
    if (out.traces.empty()) throw InputError(out.source + ": there is no line in it");
}

/// Lines that were led on the ground without its berms get the heights with them: a dam ends no profile, and blocks that pass it go on.
void raise_profiles(const SiteSettings& s, const Surface& surface, std::vector<ProfileTrace>& traces) {
    ProfileTracer tracer(surface, profile_settings(s));
    for (ProfileTrace& trace : traces) {
        const Profile bare = std::move(trace.profile);
        const std::vector<Course> course = std::move(trace.course);
        trace.profile = tracer.along(bare.place).profile;
        trace.course.clear();
        for (std::size_t k = 0; k < trace.profile.reach_count(); ++k)
            trace.course.push_back(course[bare.reach_at(0.5 * (trace.profile.s[k] + trace.profile.s[k + 1]))]);
    }
}

}  // namespace

SiteProfiles trace_site_profiles(const SiteFile& site, const SiteTerrain& terrain) {
    const SiteSettings& s = site.settings;
    const bool free = s.profile_mode == ProfileMode::Steepest;
    VectorInput input = !free ? s.profile_guide : !s.profile_start.file.empty() ? s.profile_start : s.release;
    std::vector<GeometryKind> kinds{GeometryKind::LineString};
    if (free) kinds = {GeometryKind::Polygon, GeometryKind::LineString, GeometryKind::Point};

    SiteProfiles out;
    out.source = input.file;
    out.features = read_site_layer(site, input, free ? "starting points of profiles" : "guiding lines", kinds, terrain);
    out.inputs.push_back(site.resolve(input.file).string());
    out.warnings = out.features.report.warnings;
    if (free && !s.profile_guide.file.empty())
        out.warnings.emplace_back("profile.guide is not read with profile.mode = \"steepest\"; take guided or line");
    if (!free && !s.profile_start.file.empty())
        out.warnings.emplace_back("profile.start is not read with profile.mode = \"" +
                                  std::string(kProfileModeNames[static_cast<std::size_t>(s.profile_mode)]) +
                                  "\": its lines begin where they were drawn");
    ProfileTracer tracer(terrain.without_berms ? *terrain.without_berms : *terrain.surface, profile_settings(s));
    const bool starts_are_releases = free && s.profile_start.file.empty();
    const FeatureLayer release =
        starts_are_releases
            ? FeatureLayer{}
            : read_site_layer(site, s.release, "release",
                              {GeometryKind::Polygon, GeometryKind::LineString, GeometryKind::Point}, terrain)
                  .layer;
    const Region releases = areas_of(std::array{&release, &std::as_const(out.features.layer)});
    if (free)
        trace_from_starts(s, terrain, releases, tracer, out);
    else
        trace_guides(s, terrain, releases, tracer, out);
    if (terrain.without_berms) raise_profiles(s, *terrain.surface, out.traces);
    out.left_out = find_junctions(out.traces, s.profile_merge_distance, s.profile_converging);
    return out;
}

}  // namespace scree::cli
