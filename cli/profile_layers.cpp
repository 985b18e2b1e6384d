// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/profile_layers.hpp"

#include "cli/terrain_layers.hpp"
#include "cli/text.hpp"
#include "gis/words.hpp"
#include "scree/base/units.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

namespace {

constexpr int kMicrometres = 6;  // decimals of coordinates in the table: reaches may be as short as that [-]

std::vector<Vec3> points_of(const Profile& p, std::size_t first, std::size_t last) {
    std::vector<Vec3> points;
    for (std::size_t k = first; k <= last; ++k) points.emplace_back(p.place[k].x(), p.place[k].y(), p.z[k]);
    return points;
}

/// "loose waste 0 to 41.2, compact waste 41.2 to 110.5"
std::string soils_along(const Profile& p, const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t k = 0; k < p.reach_count();) {
        std::size_t end = k + 1;
        while (end < p.reach_count() && p.soil[end] == p.soil[k]) ++end;
        text += (text.empty() ? "" : ", ") + names[p.soil[k]] + " " + gis::fixed(p.s[k], 1) + " to " +
                gis::fixed(p.s[end], 1);
        k = end;
    }
    return text;
}

gis::VectorLayer whole_profiles(const SiteProfiles& profiles, const SiteTerrain& terrain) {
    const std::vector<std::string>& soils = terrain.data.soils.soils;
    gis::VectorLayer layer;
    layer.title = "Profiles";
    layer.description =
        "Lines of steepest slope, or along guides, on the model terrain; s is the horizontal distance along them";
    layer.data.name = "profiles";
    layer.data.kind = GeometryKind::LineString;
    layer.data.fields = {{"profile", FieldType::Integer, "Profile"},
                         {"end_reason", FieldType::Text, "Why it ends"},
                         {"length_m", FieldType::Real, "Length [m]"},
                         {"start_s_m", FieldType::Real, "s of the starting point [m]"},
                         {"fall_m", FieldType::Real, "Fall from the starting to the lowest point [m]"},
                         {"lowest_s_m", FieldType::Real, "s of the lowest point [m]"},
                         {"straight_m", FieldType::Real, "Length led straight on over gentle ground [m]"},
                         {"joins_profile", FieldType::Integer, "Earlier profile that it runs into"},
                         {"joins_s_m", FieldType::Real, "s from which they run together [m]"},
                         {"soil", FieldType::Text, "Soils along it, s from and to [m]"}};
    for (std::size_t k = 0; k < profiles.traces.size(); ++k) {
        const ProfileTrace& trace = profiles.traces[k];
        const Profile& p = trace.profile;
        const ProfileFacts facts = facts_of(trace, soils.size());
        Feature f;
        f.id = static_cast<std::int64_t>(k) + 1;
        f.geometry = Polylines{Polyline{points_of(p, 0, p.reach_count()), {}}};
        f.values = {f.id,
                    std::string(kProfileEndNames[static_cast<std::size_t>(trace.end)]),
                    p.length(),
                    trace.start,
                    facts.fall,
                    facts.lowest_s,
                    facts.straight,
                    trace.joins < 0 ? FieldValue{} : FieldValue{std::int64_t{trace.joins} + 1},
                    trace.joins < 0 ? FieldValue{} : FieldValue{trace.joins_at},
                    soils_along(p, soils)};
        layer.data.features.push_back(std::move(f));
    }
    gis::VectorStyle style{.colour = "#000000", .size_mm = 0.4};
    style.label = "\"profile\"";
    layer.styles = {style};
    return layer;
}

gis::VectorLayer reaches(const SiteProfiles& profiles, const SiteTerrain& terrain) {
    const std::vector<std::string>& soils = terrain.data.soils.soils;
    gis::VectorLayer layer;
    layer.title = "Profiles by soil";
    layer.description =
        "Stretches of the profiles with one soil, led in one way: steepest, straight on, or along a given line";
    layer.data.name = "profile_reaches";
    layer.data.kind = GeometryKind::LineString;
    layer.data.fields = {{"profile", FieldType::Integer, "Profile"},        {"soil", FieldType::Text, "Soil"},
                         {"course", FieldType::Text, "How it was led"},     {"from_s_m", FieldType::Real, "From s [m]"},
                         {"to_s_m", FieldType::Real, "To s [m]"},           {"fall_m", FieldType::Real, "Fall [m]"},
                         {"slope_deg", FieldType::Real, "Mean slope [deg]"}};
    for (std::size_t k = 0; k < profiles.traces.size(); ++k) {
        const ProfileTrace& trace = profiles.traces[k];
        const Profile& p = trace.profile;
        for (std::size_t from = 0; from < p.reach_count();) {
            std::size_t to = from + 1;
            while (to < p.reach_count() && p.soil[to] == p.soil[from] && trace.course[to] == trace.course[from]) ++to;
            Feature f;
            f.id = static_cast<std::int64_t>(layer.data.features.size()) + 1;
            f.geometry = Polylines{Polyline{points_of(p, from, to), {}}};
            const double fall = p.z[from] - p.z[to];
            f.values = {static_cast<std::int64_t>(k) + 1,
                        soils[p.soil[from]],
                        std::string(kCourseNames[static_cast<std::size_t>(trace.course[from])]),
                        p.s[from],
                        p.s[to],
                        fall,
                        degrees_from_radians(std::atan(fall / (p.s[to] - p.s[from])))};
            layer.data.features.push_back(std::move(f));
            from = to;
        }
    }
    gis::VectorStyle style = soil_style(terrain, "soil");
    style.size_mm = 1.2;
    layer.styles = {style};
    return layer;
}

std::string end_words(ProfileEnd end) {
    switch (end) {
        case ProfileEnd::Pit:
            return "in a pit or at a counter-slope";
        case ProfileEnd::Flat:
            return "on gentle ground";
        case ProfileEnd::Rim:
            return "at the rim of the terrain";
        case ProfileEnd::NoData:
            return "at a hole in the terrain";
        case ProfileEnd::LengthLimit:
            return "at the length limit";
        case ProfileEnd::LineEnd:
            return "with the given line";
        case ProfileEnd::Merged:
            break;
    }
    return "in another profile";
}

}  // namespace

ProfileFacts facts_of(const ProfileTrace& trace, std::size_t soils) {
    const Profile& p = trace.profile;
    ProfileFacts facts;
    facts.soil_length.assign(soils, 0.0);
    facts.lowest_s = trace.start;
    const double top = p.height_at(trace.start);
    for (std::size_t k = 0; k < p.reach_count(); ++k) {
        const double length = p.s[k + 1] - p.s[k];
        facts.soil_length[p.soil[k]] += length;
        if (p.s[k] < trace.start) continue;
        if (trace.course[k] == Course::Straight) facts.straight += length;
        if (top - p.z[k + 1] <= facts.fall) continue;
        facts.fall = top - p.z[k + 1];
        facts.lowest_s = p.s[k + 1];
    }
    return facts;
}

std::string profile_words(const ProfileTrace& trace, const ProfileFacts& facts) {
    return gis::fixed(trace.profile.length(), 1) + " m long, falls " + gis::fixed(facts.fall, 1) +
           " m to s = " + gis::fixed(facts.lowest_s, 1) + " m, ends " + end_words(trace.end) + " (" +
           kProfileEndNames[static_cast<std::size_t>(trace.end)] + ")";
}

std::vector<gis::VectorLayer> profile_layers(const SiteProfiles& profiles, const SiteTerrain& terrain) {
    return {whole_profiles(profiles, terrain), reaches(profiles, terrain)};
}

std::string profiles_csv(const SiteProfiles& profiles, const SiteTerrain& terrain) {
    std::string text = "profile,s_m,easting_m,northing_m,height_m,soil,course\n";
    for (std::size_t n = 0; n < profiles.traces.size(); ++n) {
        const ProfileTrace& trace = profiles.traces[n];
        const Profile& p = trace.profile;
        for (std::size_t k = 0; k < p.vertex_count(); ++k) {
            const MapPoint at = terrain.data.frame.to_map({p.place[k].x(), p.place[k].y(), p.z[k]});
            text += std::to_string(n + 1);
            for (const double value : {p.s[k], at.easting, at.northing, at.height})
                text += "," + gis::fixed(value, kMicrometres);
            // the last vertex begins no reach
            if (k < p.reach_count())
                text += "," + csv_cell(terrain.data.soils.soils[p.soil[k]]) + "," +
                        kCourseNames[static_cast<std::size_t>(trace.course[k])] + "\n";
            else
                text += ",,\n";
        }
    }
    return text;
}

}  // namespace scree::cli
