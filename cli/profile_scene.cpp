// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/profile_scene.hpp"

#include "cli/profile_layers.hpp"

namespace scree::cli {

gis::ProfileScene profile_scene(const std::string& title, const SiteTerrain& terrain, const SiteProfiles& profiles) {
    gis::ProfileScene scene;
    scene.title = title;
    scene.frame = terrain.data.frame;
    scene.heights = &terrain.data.grid;
    scene.soils = terrain.data.soils.soils;
    for (std::size_t k = 0; k < profiles.traces.size(); ++k) {
        const ProfileTrace& trace = profiles.traces[k];
        gis::DrawnProfile drawn;
        drawn.name = std::to_string(k + 1);
        drawn.facts = profile_words(trace, facts_of(trace, scene.soils.size()));
        drawn.profile = &trace.profile;
        for (const Course course : trace.course) drawn.straight.push_back(course == Course::Straight);
        drawn.start = trace.start;
        scene.profiles.push_back(std::move(drawn));
    }
    return scene;
}

std::vector<gis::DrawnArea> drawn_areas(const gis::VectorData& data, const std::string& field) {
    const std::vector<std::string> names =
        field.empty() ? std::vector<std::string>(data.layer.features.size()) : gis::text_field(data, field);
    std::vector<gis::DrawnArea> areas;
    for (std::size_t k = 0; k < data.layer.features.size(); ++k)
        if (const auto* polygons = std::get_if<MultiPolygon>(&data.layer.features[k].geometry))
            areas.push_back({names[k], *polygons});
    return areas;
}

}  // namespace scree::cli
