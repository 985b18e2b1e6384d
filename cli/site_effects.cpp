// SPDX-License-Identifier: GPL-3.0-or-later
// [[effect]] of the site file to effects with their places in the terrain's frame.
#include "cli/own_law.hpp"
#include "cli/site_terrain.hpp"
#include "gis/utf8.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace scree::cli {

namespace {

/// What the file of an effect may hold.
std::vector<GeometryKind> kinds_of(const EffectLimits& limits) {
    std::vector<GeometryKind> kinds;
    if (limits.zone) kinds.push_back(GeometryKind::Polygon);
    if (limits.lines) kinds.push_back(GeometryKind::LineString);
    if (limits.points) kinds.push_back(GeometryKind::Point);
    return kinds;
}

void place_features(const FeatureLayer& layer, EffectPlace& place) {
    MultiPolygon area;
    for (const Feature& feature : layer.features) {
        if (const auto* polygons = std::get_if<MultiPolygon>(&feature.geometry))
            area.insert(area.end(), polygons->begin(), polygons->end());
        else if (const auto* lines = std::get_if<Polylines>(&feature.geometry))
            for (const Polyline& line : *lines) place.lines.push_back(line.points);
        else if (const auto* points = std::get_if<Points>(&feature.geometry))
            place.points.insert(place.points.end(), points->begin(), points->end());
    }
    if (!area.empty()) place.limit_to(std::move(area));
    place.sort_points();
}

/// A field that is called like a number of the effect looks as if it mattered: say that it does not.
void warn_of_fields(const FeatureLayer& layer, const Effect& effect, const std::string& file,
                    std::vector<std::string>& warnings) {
    const EffectInfo& info = effect_info(effect.kind);
    for (const Field& field : layer.fields)
        for (const EffectParameter& p : info.parameters) {
            const std::string name = gis::lower_case(field.name);
            if (name != p.key && !name.starts_with(std::string(p.key) + "_")) continue;
            std::ostringstream text;
            text << "effect " << info.name << ": the field " << field.name << " of " << file
                 << " is not read: " << p.key << " is ";
            if (const double value = effect.value(p.key); std::isfinite(value))
                text << value << (std::string(p.unit) == "-" ? "" : std::string(" ") + p.unit);
            else
                text << "not set";
            text << " for all its features; give those that differ a file and an [[effect]] of their own";
            warnings.push_back(text.str());
        }
}

SoilId soil_number(const SiteSettings& s, const std::string& name, const std::string& where) {
    std::string names;
    for (std::size_t k = 0; k < s.soils.size(); ++k) {
        if (s.soils[k].name == name) return static_cast<SoilId>(k);
        names += (names.empty() ? "\"" : ", \"") + s.soils[k].name + "\"";
    }
    throw InputError(where + ": soil \"" + name + "\" is no [[soil]]; there are " + names);
}

/// A crest that falls between the nodes is lost.
void warn_of_low_berm(const Effect& berm, const SiteTerrain& terrain, std::vector<std::string>& warnings) {
    constexpr double kLow = 0.8;  // of the height that is asked for [-]
    if (berm.kind != EffectKind::Berm) return;
    const double height = berm.value("height");
    const BermCrest crest = crest_of(berm, terrain.data.grid.shape);
    if (!(crest.lowest < kLow * height)) return;
    std::ostringstream text;
    text.precision(3);
    text << "effect berm: its crest is cut down between the nodes of the terrain, to " << crest.mean
         << " m in the mean and " << crest.lowest << " m at the lowest where " << height
         << " m are asked for: take a finer terrain.resolution (cells of " << terrain.data.grid.shape.cell
         << " m now), a sixteenth of its width of " << berm.value("width") << " m for nine tenths of the height";
    warnings.push_back(text.str());
}

}  // namespace

void load_effects(const SiteFile& site, SiteTerrain& terrain) {
    const SiteSettings& s = site.settings;
    for (const EffectSettings& given : s.effects) {
        Effect effect = given.effect;
        const EffectInfo& info = effect_info(effect.kind);
        const std::string where = site.file.string() + ": effect " + info.name;
        if (effect.place.reaches && s.dimension == 3)
            throw InputError(where +
                             ": from and to are distances along a profile, for model.dimension = 2: give a file "
                             "of polygons or lines instead");
        if (effect.place.reaches && !info.limits.lines)
            for (const Stretch& r : *effect.place.reaches)
                if (r.from > r.to) {
                    std::ostringstream text;
                    text << where << ": from = " << r.from << " m lies beyond to = " << r.to
                         << " m; chainages grow down the profile: exchange them";
                    throw InputError(text.str());
                }
        if (!given.soil.empty()) effect.place.soil = soil_number(s, given.soil, where);
        if (!given.place.file.empty()) {
            const std::vector<GeometryKind> kinds = kinds_of(info.limits);
            if (kinds.empty()) throw InputError(where + " acts everywhere: remove file = \"" + given.place.file + "\"");
            const std::string purpose = std::string("effect ") + info.name;
            const gis::VectorData data = read_site_layer(site, given.place, purpose.c_str(), kinds, terrain);
            place_features(data.layer, effect.place);
            warn_of_fields(data.layer, effect, given.place.file, terrain.effect_warnings);
            terrain.effect_inputs.push_back(site.resolve(given.place.file).string());
            terrain.effect_warnings.insert(terrain.effect_warnings.end(), data.report.warnings.begin(),
                                           data.report.warnings.end());
        }
        if (effect.kind == EffectKind::OwnLaw) {
            if (given.library.empty())
                throw InputError(where + " needs library, the shared library that holds the law");
            const std::filesystem::path library = site.resolve(given.library);
            effect.own = load_own_law(library, where);
            terrain.effect_inputs.push_back(library.string());
        } else if (!given.library.empty()) {
            throw InputError(where + " takes no library: only own_law does");
        }
        if (effect.kind == EffectKind::SoilPatch &&
            std::all_of(effect.values.begin(), effect.values.begin() + std::ssize(info.parameters),
                        [](double v) { return std::isnan(v); }))
            terrain.effect_warnings.push_back(where +
                                              " changes nothing: give friction, rolling or restitution of the patch");
        if (info.limits.lines && effect.place.reaches && !effect.place.lines.empty())
            throw InputError(where + " stands in two ways, by its file and by from: remove one of them");
        if (info.limits.lines && effect.place.reaches && std::isfinite(effect.place.reaches->front().to))
            throw InputError(where + " stands at one chainage, from: remove to");
        if (!effect.place.points.empty() && (effect.place.area || effect.place.reaches))
            throw InputError(where +
                             " has single trees (points) and a stand (polygons, from, to): these are two "
                             "effects, each with an [[effect]] of its own");
        if (info.limits.lines && effect.place.reaches) {  // a station along the profile
            effect.place.stations.push_back(effect.place.reaches->front().from);
            effect.place.reaches.reset();
        }
        if (info.limits.lines && effect.place.lines.empty() && effect.place.stations.empty())
            throw InputError(where + " stands nowhere: give its line in a file");
        try {
            check_effect(effect, s.dynamics.mode == SteppingMode::Event);
        } catch (const InputError& e) {
            throw InputError(site.file.string() + ": " + e.what());
        }
        if (effect.place.stations.empty()) warn_of_low_berm(effect, terrain, terrain.effect_warnings);
        terrain.effects.push_back(std::move(effect));
    }
}

std::string effect_text(const EffectSettings& effect) {
    const EffectInfo& info = effect_info(effect.effect.kind);
    std::ostringstream text;
    text << info.name;
    if (!effect.soil.empty()) text << " on " << effect.soil;
    if (!effect.place.file.empty()) text << " at the features of " << effect.place.file;
    if (effect.effect.place.reaches)
        for (const Stretch& r : *effect.effect.place.reaches) {
            text << " from " << r.from;
            if (std::isfinite(r.to)) text << " to " << r.to;
            text << " m along the profile";
        }
    const char* separator = ": ";
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
        if (std::isnan(effect.effect.values[k])) continue;
        text << separator << info.parameters[k].key << " " << effect.effect.values[k];
        if (std::string(info.parameters[k].unit) != "-") text << " " << info.parameters[k].unit;
        separator = ", ";
    }
    return text.str();
}

}  // namespace scree::cli
