// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/soil_zones.hpp"

#include "gis/polygon_overlap.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scree::gis {

namespace {

constexpr double kSliverWidth = 0.1;  // an overlap that is nowhere wider is taken for inexact drawing [m]
constexpr int kBins = 128;            // bins along each axis of the index [-]

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += words(text.empty() ? "'" : ", '", name, "'");
    return text;
}

Box2 box_of(const MultiPolygon& polygons) {
    Box2 box;
    for (const Polygon& polygon : polygons) {
        for (const Vec2& p : polygon.outer) box.add(p);
    }
    return box;
}

}  // namespace

SoilZones::SoilZones(const SoilZoneSettings& settings) : settings_(settings) {
    SCREE_ASSERT(settings.default_soil < settings.soils.size());
}

SoilZones::SoilZones(const VectorData& polygons, const SoilZoneSettings& settings) : SoilZones(settings) {
    const std::string place =
        words("The soil zones '", polygons.report.file, "', layer '", polygons.report.layer, "',");
    const std::vector<std::string> names = text_field(polygons, settings.field);
    std::vector<double> priorities(names.size(), 0.0);
    if (!settings.priority_field.empty()) priorities = number_field(polygons, {.field = settings.priority_field});

    for (std::size_t f = 0; f < names.size(); ++f) {
        const Feature& feature = polygons.layer.features[f];
        const auto* shape = std::get_if<MultiPolygon>(&feature.geometry);
        if (!shape)
            throw InputError(
                words(place, " have feature ", feature.id, ", which is no polygon; draw soils as polygons."));
        const auto soil = std::find(settings.soils.begin(), settings.soils.end(), names[f]);
        if (soil == settings.soils.end()) {
            throw InputError(words(place, " have the soil '", names[f], "' in feature ", feature.id,
                                   ", which is not among the soils of the site: ", listed(settings.soils),
                                   "; correct the name or add the soil."));
        }
        zones_.push_back(
            {Region(*shape), *shape, static_cast<SoilId>(soil - settings.soils.begin()), priorities[f], feature.id});
    }
    // the first zone that contains a point is its zone
    std::stable_sort(zones_.begin(), zones_.end(),
                     [](const Zone& a, const Zone& b) { return a.priority > b.priority; });
    build_index();
    check_overlaps(polygons);
    for (const Zone& zone : zones_) {
        for (const Polygon& polygon : zone.polygons) {
            boundaries_.push_back(polygon.outer);
            boundaries_.insert(boundaries_.end(), polygon.holes.begin(), polygon.holes.end());
        }
    }
}

void SoilZones::build_index() {
    for (const Zone& zone : zones_) bounds_.add(zone.region.bounds());
    bins_.resize(kBins * kBins);
    bin_ = (bounds_.max - bounds_.min) / kBins;
    for (std::size_t z = 0; z < zones_.size(); ++z) {
        const Box2 box = zones_[z].region.bounds();
        const Eigen::Array2i low = ((box.min - bounds_.min).array() / bin_.array()).cast<int>().max(0).min(kBins - 1);
        const Eigen::Array2i high = ((box.max - bounds_.min).array() / bin_.array()).cast<int>().max(0).min(kBins - 1);
        for (int y = low.y(); y <= high.y(); ++y) {
            for (int x = low.x(); x <= high.x(); ++x)
                bins_[static_cast<std::size_t>(y * kBins + x)].push_back(static_cast<int>(z));
        }
    }
}

int SoilZones::zone_at(const Vec2& p) const {
    if (!bounds_.contains(p)) return -1;
    const Eigen::Array2i bin = ((p - bounds_.min).array() / bin_.array()).cast<int>().max(0).min(kBins - 1);
    for (const int z : bins_[static_cast<std::size_t>(bin.y() * kBins + bin.x())]) {
        if (zones_[static_cast<std::size_t>(z)].region.contains(p)) return z;
    }
    return -1;
}

SoilId SoilZones::soil_at(const Vec2& p) const {
    return soil_of(zone_at(p));
}

void SoilZones::check_overlaps(const VectorData& polygons) {
    // sweep along x, so that only neighbours are compared
    std::vector<std::pair<Box2, const Zone*>> order;
    for (const Zone& zone : zones_) order.emplace_back(box_of(zone.polygons), &zone);
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.first.min.x() < b.first.min.x(); });

    double sliver_area = 0;
    std::size_t slivers = 0, conflicts = 0;
    std::string text;
    for (std::size_t a = 0; a < order.size(); ++a) {
        for (std::size_t b = a + 1; b < order.size() && order[b].first.min.x() <= order[a].first.max.x(); ++b) {
            const Zone *first = order[a].second, *second = order[b].second;
            if (first->soil == second->soil || first->priority != second->priority ||
                !order[a].first.overlaps(order[b].first))
                continue;
            const Overlap overlap = polygon_overlap(first->polygons, second->polygons, kSliverWidth);
            if (overlap.area <= 0) continue;
            if (!overlap.is_wide) {
                sliver_area += overlap.area;
                ++slivers;
            } else if (++conflicts <= 3) {
                if (first->id > second->id) std::swap(first, second);
                text += words(conflicts > 1 ? ", " : "", "features ", first->id, " ('", settings_.soils[first->soil],
                              "') and ", second->id, " ('", settings_.soils[second->soil], "') by ",
                              fixed(overlap.area, 1), " m2");
            }
        }
    }
    const std::string place =
        words("The soil zones '", polygons.report.file, "', layer '", polygons.report.layer, "',");
    if (conflicts > 0) {
        throw InputError(words(place, " overlap: ", text,
                               conflicts > 3 ? words(" and ", conflicts - 3, " more pairs") : std::string(),
                               settings_.priority_field.empty()
                                   ? "; draw them apart or name a numeric field as priority, in which the higher wins."
                                   : "; give them different priorities or draw them apart."));
    }
    if (slivers > 0) {
        warnings_.push_back(words(place, " overlap in ", slivers, " slivers of ", fixed(sliver_area, 2),
                                  " m2 in all; the feature that comes first wins there."));
    }
}

}  // namespace scree::gis
