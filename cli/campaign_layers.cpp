// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/campaign_layers.hpp"

#include "cli/plane_layers.hpp"
#include "cli/profile_layers.hpp"
#include "cli/terrain_layers.hpp"
#include "scree/base/units.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace scree::cli {

namespace {

using gis::Coordinates;
using gis::RasterTheme;

Field integer(std::string name, std::string alias) {
    return {std::move(name), FieldType::Integer, std::move(alias)};
}
Field real(std::string name, std::string alias) {
    return {std::move(name), FieldType::Real, std::move(alias)};
}
Field text(std::string name, std::string alias) {
    return {std::move(name), FieldType::Text, std::move(alias)};
}

gis::VectorLayer empty_layer(const char* name, GeometryKind kind, const char* title, const char* description) {
    gis::VectorLayer layer;
    layer.title = title;
    layer.description = description;
    layer.data.name = name;
    layer.data.kind = kind;
    return layer;
}

FieldValue block_id(const CampaignResult& result, const BlockResult& b) {
    if (b.row < 0) return std::monostate{};
    return result.block_ids[static_cast<std::size_t>(b.row)];
}

FieldValue feature_of(const BlockResult& b) {
    if (b.feature == kNoFeature) return std::monostate{};
    return b.feature;
}

/// Horizontal distance between release and end; in 2D along the profile.
double runout(const BlockResult& b) {
    return b.profile < 0 ? (b.stop - b.release).head<2>().norm() : b.stop_s - b.release_s;
}

/// In 2D: what says where on its profile a block was. Nothing in 3D.
void add_plane_fields(const SiteModel& model, std::vector<Field>& fields, std::initializer_list<Field> chainages) {
    if (!model.in_plane()) return;
    fields.push_back(integer("profile", "Profile"));
    fields.insert(fields.end(), chainages);
}
void add_plane_values(const SiteModel& model, const BlockResult& b, std::vector<FieldValue>& values,
                      std::initializer_list<FieldValue> chainages) {
    if (!model.in_plane()) return;
    values.emplace_back(static_cast<std::int64_t>(b.profile) + 1);
    values.insert(values.end(), chainages);
}

gis::VectorLayer stopping_points(const SiteModel& model, const CampaignResult& result) {
    gis::VectorLayer layer =
        empty_layer("stopping_points", GeometryKind::Point, "Stopping points",
                    "End of every block thrown, with the reason; z is the height of its centre of mass");
    layer.data.fields = {integer("block", "Block number"),
                         text("block_id", "Block of the list"),
                         text("stop_reason", "Why it ended"),
                         real("mass_kg", "Mass [kg]"),
                         real("l1_m", "L1 [m]"),
                         real("l2_m", "L2 [m]"),
                         real("l3_m", "L3 [m]"),
                         real("runout_m", "Horizontal distance from release [m]"),
                         real("drop_m", "Height lost [m]"),
                         real("path_m", "Length of the path [m]"),
                         real("time_s", "Time since release [s]"),
                         real("speed_max_ms", "Largest speed [m/s]"),
                         real("energy_max_kj", "Largest kinetic energy [kJ]"),
                         integer("release_feature", "Release feature")};
    add_plane_fields(model, layer.data.fields,
                     {real("s_m", "Chainage s [m]"), real("release_s_m", "s of the release [m]")});
    const auto& effects = model.campaign.effects;
    const bool breaking = std::any_of(effects.begin(), effects.end(),
                                      [](const Effect& e) { return e.kind == EffectKind::Fragmentation; });
    if (breaking) layer.data.fields.push_back(real("mass_left_kg", "Mass of the largest piece [kg]"));
    for (std::size_t k = 0; k < result.blocks.size(); ++k) {
        const BlockResult& b = result.blocks[k];
        if (!b.done) continue;
        Feature f;
        f.id = static_cast<std::int64_t>(k) + 1;
        f.geometry = Points{b.stop};
        f.values = {static_cast<std::int64_t>(k),
                    block_id(result, b),
                    std::string(kStopReasonNames[static_cast<std::size_t>(b.reason)]),
                    b.mass,
                    b.size.x(),
                    b.size.y(),
                    b.size.z(),
                    runout(b),
                    b.release.z() - b.stop.z(),
                    b.path_length,
                    b.time,
                    b.largest_speed,
                    b.largest_energy / kJoulePerKj,
                    feature_of(b)};
        add_plane_values(model, b, f.values, {b.stop_s, b.release_s});
        if (breaking) f.values.push_back(b.mass_left);
        layer.data.features.push_back(std::move(f));
    }
    return layer;
}

gis::VectorLayer release_points(const SiteModel& model, const CampaignResult& result) {
    gis::VectorLayer layer = empty_layer("release_points", GeometryKind::Point, "Release points",
                                         "Centre of mass of every block at the start");
    layer.data.fields = {integer("block", "Block number"), text("block_id", "Block of the list"),
                         real("mass_kg", "Mass [kg]"), real("raised_m", "Lifted to start free of the ground [m]"),
                         integer("release_feature", "Release feature")};
    add_plane_fields(model, layer.data.fields, {real("s_m", "Chainage s [m]")});
    layer.visible = false;
    for (std::size_t k = 0; k < result.blocks.size(); ++k) {
        const BlockResult& b = result.blocks[k];
        if (!b.done) continue;
        Feature f;
        f.id = static_cast<std::int64_t>(k) + 1;
        f.geometry = Points{b.release};
        f.values = {static_cast<std::int64_t>(k), block_id(result, b), b.mass, b.raised, feature_of(b)};
        add_plane_values(model, b, f.values, {b.release_s});
        layer.data.features.push_back(std::move(f));
    }
    return layer;
}

/// Without the points that are there twice: at an impact the path has one with the speed before it and one with that after.
Polyline line_of(const KeptTrajectory& t) {
    Polyline line;
    for (std::size_t k = 0; k < t.points.size(); ++k) {
        if (k > 0 && t.times[k] == t.times[k - 1] && t.points[k] == t.points[k - 1]) continue;
        line.points.push_back(t.points[k]);
        line.measure.push_back(t.times[k]);
    }
    return line;
}

gis::VectorLayer trajectories(const SiteModel& model, const CampaignResult& result) {
    gis::VectorLayer layer =
        empty_layer("trajectories", GeometryKind::LineString, "Trajectories",
                    "Paths of the centre of mass of the first blocks; M is the time since release [s]");
    layer.coordinates = Coordinates::XYZM;
    layer.data.fields = {integer("block", "Block number"),
                         text("block_id", "Block of the list"),
                         text("stop_reason", "Why it ended"),
                         real("mass_kg", "Mass [kg]"),
                         real("speed_max_ms", "Largest speed [m/s]"),
                         real("energy_max_kj", "Largest kinetic energy [kJ]"),
                         real("runout_m", "Horizontal distance from release [m]")};
    add_plane_fields(model, layer.data.fields, {});
    for (const KeptTrajectory& t : result.trajectories) {
        Polyline line = line_of(t);
        if (line.points.size() < 2) continue;
        const BlockResult& b = result.blocks[static_cast<std::size_t>(t.block)];
        Feature f;
        f.id = t.block + 1;
        f.geometry = Polylines{std::move(line)};
        f.values = {t.block,  block_id(result, b), std::string(kStopReasonNames[static_cast<std::size_t>(b.reason)]),
                    b.mass,   b.largest_speed,     b.largest_energy / kJoulePerKj,
                    runout(b)};
        add_plane_values(model, b, f.values, {});
        layer.data.features.push_back(std::move(f));
    }
    return layer;
}

gis::VectorLayer screen_crossings(const SiteModel& model, const CampaignResult& result) {
    gis::VectorLayer layer = empty_layer("screen_crossings", GeometryKind::Point, "Screen crossings",
                                         "First crossing of each screen by each block");
    layer.data.fields = {text("screen", "Screen"),
                         integer("block", "Block number"),
                         text("block_id", "Block of the list"),
                         real("mass_kg", "Mass, or of what is left of it [kg]"),
                         real("speed_ms", "Speed [m/s]"),
                         real("height_m", "Centre of mass above ground [m]"),
                         real("spin_rads", "Spin [rad/s]"),
                         real("energy_kj", "Kinetic energy [kJ]"),
                         real("time_s", "Time since release [s]"),
                         real("azimuth_deg", "Direction of motion [deg]")};
    add_plane_fields(model, layer.data.fields, {real("s_m", "Chainage s [m]")});
    std::int64_t id = 0;
    for (const ScreenCrossing& c : result.crossings) {
        const BlockResult& b = result.blocks[static_cast<std::size_t>(c.block)];
        Feature f;
        f.id = ++id;
        f.geometry = Points{c.position};
        const double azimuth = degrees_from_radians(std::atan2(c.velocity.x(), c.velocity.y()));
        f.values = {model.campaign.screens[static_cast<std::size_t>(c.screen)].name,
                    c.block,
                    block_id(result, b),
                    c.mass,
                    c.velocity.norm(),
                    c.height,
                    c.spin,
                    c.energy / kJoulePerKj,
                    c.time,
                    azimuth < 0.0 ? azimuth + 360.0 : azimuth};
        add_plane_values(model, b, f.values, {c.s});
        layer.data.features.push_back(std::move(f));
    }
    return layer;
}

/// Where they begin.
gis::VectorLayer impacts(const SiteModel& model, const CampaignResult& result) {
    gis::VectorLayer layer =
        empty_layer("impacts", GeometryKind::Point, "Impacts",
                    "First impacts of each block: what lies between two flights of 0.1 s and more");
    layer.data.fields = {integer("impact", "Number of the impact, from 1"),
                         integer("block", "Block number"),
                         text("block_id", "Block of the list"),
                         real("mass_kg", "Mass, or of what is left of it [kg]"),
                         real("speed_before_ms", "Speed before [m/s]"),
                         real("speed_after_ms", "Speed after [m/s]"),
                         real("rise_before_ms", "Vertical speed before, upwards [m/s]"),
                         real("rise_after_ms", "Vertical speed after, upwards [m/s]"),
                         real("spin_before_rads", "Spin before [rad/s]"),
                         real("spin_after_rads", "Spin after [rad/s]"),
                         real("time_s", "Time since release [s]")};
    add_plane_fields(model, layer.data.fields, {real("s_m", "Chainage s [m]")});
    std::int64_t id = 0;
    for (const FilmedImpact& impact : result.impacts) {
        const BlockResult& b = result.blocks[static_cast<std::size_t>(impact.block)];
        const FilmedImpact::End &before = impact.before, &after = impact.after;
        Feature f;
        f.id = ++id;
        f.geometry = Points{before.position};
        f.values = {std::int64_t{impact.number} + 1,
                    impact.block,
                    block_id(result, b),
                    before.mass,
                    before.velocity.norm(),
                    after.velocity.norm(),
                    before.velocity.z(),
                    after.velocity.z(),
                    before.spin,
                    after.spin,
                    before.time};
        add_plane_values(model, b, f.values, {before.s});
        layer.data.features.push_back(std::move(f));
    }
    return layer;
}

gis::VectorLayer deposit_zones(const SiteModel& model, const CampaignResult& result) {
    gis::VectorLayer layer = empty_layer(
        "deposit_zones", GeometryKind::Polygon, "Deposit zones",
        "Blocks at rest in each zone, their share of all blocks thrown, and the 95 % interval of that share (Wilson)");
    layer.coordinates = Coordinates::XY;
    if (model.in_plane()) {
        layer.description =
            "Stretches of the profiles in each zone: blocks at rest in it, their share of all blocks thrown, and the "
            "95 % interval of that share (Wilson)";
        layer.data.kind = GeometryKind::LineString;
    }
    layer.data.fields = {text("name", "Zone"),
                         integer("count", "Blocks at rest"),
                         integer("released", "Blocks thrown"),
                         real("percent", "Share [%]"),
                         real("percent_low", "Share, lower limit [%]"),
                         real("percent_high", "Share, upper limit [%]")};
    for (std::size_t z = 0; z < result.deposits.size(); ++z) {
        const auto [low, high] = wilson_interval(result.deposits[z].count, result.released);
        Feature f;
        f.id = static_cast<std::int64_t>(z) + 1;
        f.geometry = model.deposit_zones->layer.features[z].geometry;
        if (model.in_plane()) {
            Polylines inside = stretches_in(model, std::get<MultiPolygon>(f.geometry));
            f.geometry = inside.empty() ? Geometry() : std::move(inside);  // a zone that no profile meets
        }
        const double share = result.released > 0
                                 ? static_cast<double>(result.deposits[z].count) / static_cast<double>(result.released)
                                 : 0.0;
        f.values = {result.deposits[z].name,
                    result.deposits[z].count,
                    result.released,
                    100.0 * share,
                    100.0 * low,
                    100.0 * high};
        layer.data.features.push_back(std::move(f));
    }
    return layer;
}

/// The result must outlive the layer, which is filled when it is written.
template <class Value>
gis::RasterLayer raster(const GridShape& cells, const CampaignResult& result, Value value) {
    gis::RasterLayer layer;
    layer.make_values = [cells, &result, value] {
        Grid<float> values(cells, std::numeric_limits<float>::quiet_NaN());
        for (const auto& [cell, statistics] : result.cells) {
            const double v = value(statistics);
            if (std::isfinite(v)) values.values[cell] = static_cast<float>(v);
        }
        return values;
    };
    return layer;
}

template <class Value>
gis::RasterLayer counts(const GridShape& cells, const CampaignResult& result, const char* name, const char* title,
                        const char* definition, RasterTheme theme, Value value) {
    gis::RasterLayer layer = raster(cells, result, value);
    layer.name = name;
    layer.title = title;
    layer.unit = "-";
    layer.quantity_definition = definition;
    layer.group = "Counts";
    layer.theme = theme;
    return layer;
}

/// The name of a user's field as our files spell it: a-z, 0-9 and _, a letter first, each once. The user's own spelling stays as its alias.
std::string plain_name(const std::string& name, std::set<std::string>& taken) {
    constexpr std::size_t kLongest = 50;  // of the 60 that gis allows, leaving room for a number [-]
    std::string plain;
    for (const char c : name) {
        const bool upper = c >= 'A' && c <= 'Z', usable = upper || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (usable)
            plain += upper ? static_cast<char>(c - 'A' + 'a') : c;
        else if (!plain.empty() && plain.back() != '_')
            plain += '_';
        if (plain.size() == kLongest) break;
    }
    const bool letter_first = !plain.empty() && plain.front() >= 'a' && plain.front() <= 'z';
    if (!letter_first) plain = "field_" + plain;
    for (const char* reserved : {"gpkg_", "sqlite_", "rtree_"})
        if (plain.starts_with(reserved)) plain = "field_" + plain;
    while (plain.back() == '_') plain.pop_back();
    std::string unique = plain;
    for (int number = 2; !taken.insert(unique).second; ++number) unique = plain + "_" + std::to_string(number);
    return unique;
}

/// With the number that blocks carry as their release_feature: those of the layer itself begin at 1, whatever the input has.
gis::VectorLayer release_zones(const SiteModel& model) {
    gis::VectorLayer layer = input_layer(model.release, "release_zones", "Release zones", "");
    std::vector<Field>& fields = layer.data.fields;
    const auto at =
        std::find_if(fields.begin(), fields.end(), [](const Field& f) { return f.name == "release_feature"; });
    const auto k = at - fields.begin();
    const bool there = at != fields.end();
    if (there) fields.erase(at);
    fields.push_back(integer("release_feature", "Number in the input"));
    for (Feature& f : layer.data.features) {
        if (there) f.values.erase(f.values.begin() + k);
        f.values.emplace_back(f.id);
    }
    return layer;
}

}  // namespace

std::vector<gis::VectorLayer> campaign_vectors(const SiteModel& model, const CampaignResult& result) {
    std::vector<gis::VectorLayer> layers;
    layers.push_back(stopping_points(model, result));
    layers.push_back(release_points(model, result));
    if (!model.campaign.screens.empty()) {
        layers.push_back(screen_crossings(model, result));
        if (model.screens) layers.push_back(input_layer(*model.screens, "screens", "Screens", ""));
    }
    if (model.campaign.impacts > 0) layers.push_back(impacts(model, result));
    if (model.campaign.kept_trajectories > 0) layers.push_back(trajectories(model, result));
    if (!model.campaign.deposit_zones.empty()) layers.push_back(deposit_zones(model, result));
    if (model.in_plane()) {
        layers.push_back(curves_layer(model, result));
        for (gis::VectorLayer& layer : profile_layers(*model.profiles, model.terrain))
            layers.push_back(std::move(layer));
    }
    layers.push_back(release_zones(model));
    return layers;
}

gis::RasterLayer reach_probability_raster(const GridShape& cells, const CampaignResult& result) {
    const double released = static_cast<double>(std::max<std::int64_t>(result.released, 1));
    gis::RasterLayer layer =
        counts(cells, result, "reach_probability", "Reach probability",
               "share of the blocks thrown that crossed the cell", RasterTheme::Probability,
               [released](const CellStatistics& c) { return static_cast<double>(c.passages) / released; });
    layer.visible = true;
    return layer;
}

std::vector<gis::RasterLayer> campaign_rasters(const SiteModel& model, const CampaignResult& result) {
    if (model.in_plane()) return {heights_layer(model.terrain)};
    std::vector<gis::RasterLayer> layers;
    const GridShape& cells = model.campaign.result_cells;
    layers.push_back(reach_probability_raster(cells, result));
    layers.push_back(counts(cells, result, "passages", "Passages", "blocks that crossed the cell, each counted once",
                            RasterTheme::Count,
                            [](const CellStatistics& c) { return static_cast<double>(c.passages); }));
    layers.push_back(
        counts(cells, result, "deposits", "Deposits", "blocks that came to rest in the cell", RasterTheme::Count,
               [](const CellStatistics& c) { return c.deposits > 0 ? static_cast<double>(c.deposits) : kNaN; }));
    for (const QuantityInfo& q : kQuantities) {
        const auto k = static_cast<std::size_t>(q.quantity);
        auto add = [&](const std::string& suffix, const std::string& words, auto value) {
            gis::RasterLayer layer = raster(cells, result, [k, value, factor = q.factor](const CellStatistics& c) {
                return c.passages > 0 ? factor * value(c.quantities[k], c.passages) : kNaN;
            });
            layer.name = std::string(q.name) + "_" + suffix;
            layer.title = std::string(q.title) + ", " + words;
            layer.unit = q.unit;
            layer.quantity_definition = words + " over the blocks that crossed the cell, of each block's largest " +
                                        q.definition + " inside the cell";
            layer.group = q.title;
            layer.theme = q.theme;
            layers.push_back(std::move(layer));
        };
        add("mean", "mean", [](const QuantityStatistics& s, std::int64_t n) { return mean_of(s, n); });
        for (const int percent : kPercents)
            add(std::string("p").append(std::to_string(percent)), std::to_string(percent) + " % quantile",
                [percent](const QuantityStatistics& s, std::int64_t) { return s.quantile(0.01 * percent); });
        add("max", "maximum", [](const QuantityStatistics& s, std::int64_t) { return s.largest; });
    }
    return layers;
}

gis::VectorLayer input_layer(const gis::VectorData& data, const std::string& name, const std::string& title,
                             const std::string& group) {
    gis::VectorLayer layer;
    layer.data = data.layer;
    layer.data.name = name;
    std::set<std::string> taken{"fid", "geom", "run",
                                "layer_styles"};  // names that mean something in a GeoPackage of ours
    for (Field& field : layer.data.fields) {
        if (field.alias.empty()) field.alias = field.name;
        field.name = plain_name(field.name, taken);
    }
    layer.title = title;
    layer.group = group;
    layer.coordinates = Coordinates::XY;
    return layer;
}

}  // namespace scree::cli
