// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/site_model.hpp"

#include "cli/off_ground.hpp"
#include "cli/plane_model.hpp"
#include "cli/text.hpp"
#include "gis/dataset.hpp"
#include "gis/table_reader.hpp"
#include "scree/base/error.hpp"
#include "scree/base/units.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace scree::cli {

namespace {

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

std::vector<DepositZone> make_deposit_zones(const gis::VectorData& data, const std::string& field) {
    const std::vector<std::string> names = gis::text_field(data, field);
    std::vector<DepositZone> zones;
    for (std::size_t k = 0; k < data.layer.features.size(); ++k)
        zones.push_back({names[k], Region(std::get<MultiPolygon>(data.layer.features[k].geometry))});
    return zones;
}

BlockPopulation make_population(const SiteFile& site, SiteModel& model) {
    const SiteSettings& s = site.settings;
    BlockPopulation population;
    if (s.shape == BlockShape::File) {
        population.shape.file_points = read_shape_points(site.resolve(s.shape_file));
        model.inputs.push_back(site.resolve(s.shape_file).string());
    }
    if (s.block_list.empty()) return population;
    const gis::BlockList list = gis::read_block_list(site.resolve(s.block_list).string());
    append(model.warnings, list.warnings);
    model.unread_block_columns = list.unread_columns;
    model.inputs.push_back(site.resolve(s.block_list).string());
    for (const gis::BlockRow& row : list.blocks)
        population.list.push_back({row.id, row.mass, {row.l1, row.l2, row.l3}});
    return population;
}

/// Cells of result rasters, of which there are two dozen, that are finer than the terrain.
constexpr double kMostResultCells = 1e8;

GridShape result_cells(const GridShape& model, double resolution) {
    if (resolution <= 0.0 || resolution == model.cell) return model;
    GridShape cells = model;  // same north-west corner, so that coarser cells line up with the model's
    cells.cell = resolution;
    const double columns = std::ceil(model.columns * model.cell / resolution - 1e-9),
                 rows = std::ceil(model.rows * model.cell / resolution - 1e-9);
    if (resolution < model.cell && columns * rows > kMostResultCells)
        throw InputError(
            "output.resolution = " + short_number(resolution) + " m gives " + short_number(columns) + " x " +
            short_number(rows) +
            " result cells, more than the 100 million that are allowed; choose a coarser one, or cut out the "
            "site with gdal_translate -projwin");
    cells.columns = std::max(1, static_cast<int>(columns));
    cells.rows = std::max(1, static_cast<int>(rows));
    cells.origin.y() = model.origin.y() + model.rows * model.cell - cells.rows * resolution;
    return cells;
}

}  // namespace

std::vector<Screen> make_screens(const gis::VectorData& data, const std::string& field) {
    const std::vector<std::string> names = gis::text_field(data, field);
    std::vector<Screen> screens;
    auto add_ring = [&](const std::string& name, const Ring& ring) {
        Screen screen{name, ring, -1};
        screen.line.push_back(ring.front());
        screens.push_back(screen);
    };
    for (std::size_t k = 0; k < data.layer.features.size(); ++k) {
        const Geometry& geometry = data.layer.features[k].geometry;
        if (const auto* lines = std::get_if<Polylines>(&geometry)) {
            // the parts of one feature are one screen: joined by their own end points only, never by a bridge
            for (const Polyline& line : *lines) {
                Screen screen{names[k], {}, -1};
                for (const Vec3& p : line.points) screen.line.push_back(p.head<2>());
                screens.push_back(screen);
            }
        } else if (const auto* polygons = std::get_if<MultiPolygon>(&geometry)) {
            for (const Polygon& polygon : *polygons) {
                add_ring(names[k], polygon.outer);
                for (const Ring& hole : polygon.holes) add_ring(names[k], hole);
            }
        }
    }
    for (std::size_t k = 0; k < screens.size(); ++k) {
        const auto first =
            std::find_if(screens.begin(), screens.end(), [&](const Screen& s) { return s.name == screens[k].name; });
        if (first != screens.begin() + static_cast<std::ptrdiff_t>(k))
            screens[k].part_of = static_cast<std::int32_t>(first - screens.begin());
    }
    return screens;
}

namespace {

/// A name on several features may be meant, and may be a slip.
void warn_of_shared_names(const gis::VectorData& data, const VectorInput& input, const char* what_follows,
                          std::vector<std::string>& warnings) {
    const std::vector<std::string> names = gis::text_field(data, input.field);
    std::map<std::string, int> count;
    for (const std::string& name : names) ++count[name];
    for (const auto& [name, features] : count)
        if (features > 1)
            warnings.push_back(input.file + ": " + std::to_string(features) + " features are called '" + name +
                               "': " + what_follows + "; give them names of their own if they are not one");
}

}  // namespace

/// Where blocks start in 3D.
void add_release_area(const SiteFile& site, SiteModel& model) {
    const SiteSettings& s = site.settings;
    try {
        model.area = std::make_unique<ReleaseArea>(model.release.layer, *model.terrain.surface, s.releases.pattern,
                                                   model.terrain.data.grid.shape);
    } catch (const InputError& e) {
        const gis::Terrain& terrain = model.terrain.data;
        throw InputError(model.release.report.file + ": " + e.what() + " (it spans " +
                         gis::extent_text(model.release.report.extent, terrain.frame) + ", the terrain " +
                         terrain.dtm.file + " " + gis::extent_text(terrain.grid.shape.bounds(), terrain.frame) +
                         ", of which " + short_number(100.0 * terrain.dtm.valid_fraction) +
                         " % have a height)");  // the core knows no files
    }
    if (const double off = 1.0 - model.area->inside_share(); off > 0.001) {
        model.warnings.push_back(s.release.file + ": about " + short_number(100.0 * off) +
                                 " % of the release features lie off the terrain; blocks start on the rest only");
    }
    model.campaign.surface = model.terrain.surface.get();
    model.campaign.area = model.area.get();
    model.campaign.result_cells = result_cells(model.terrain.data.grid.shape, s.result_resolution);
    if (s.releases.pattern == ReleasePattern::Cells &&
        s.releases.count < static_cast<std::int64_t>(model.area->cell_count()))
        model.warnings.push_back("release.count = " + std::to_string(s.releases.count) + " is less than the " +
                                 std::to_string(model.area->cell_count()) +
                                 " start cells: some cells release no block");
}

void apply_parameters(const SiteFile& site, CampaignInput& c) {
    const SiteSettings& s = site.settings;
    c.population.in_turn = s.block_order == BlockOrder::InTurn;
    c.population.distribution = s.distribution;
    const bool other_shape = c.population.shape.shape != s.shape || c.population.shape.points != s.points ||
                             c.population.shape.polygon_points != s.polygon_points;
    c.population.shape.shape = s.shape;
    c.population.shape.points = s.points;
    c.population.shape.polygon_points = s.polygon_points;
    if (other_shape && !c.tracks.empty() && c.population.list.empty())
        c.population.filling = mean_filling(c.population.shape);
    c.soils = s.soils;
    c.dynamics = s.dynamics;
    c.dynamics.kept_problems = static_cast<int>(s.contact_problems);
    c.release = s.releases;
    c.release.azimuth = radians_from_degrees(s.azimuth_deg);
    c.release.elevation = radians_from_degrees(s.elevation_deg);
    c.seed = static_cast<std::uint64_t>(s.seed);
    for (std::size_t k = 0; k < c.effects.size(); ++k) c.effects[k].values = s.effects[k].effect.values;
}

static void require_screens_of_effects(const SiteFile& site, const CampaignInput& campaign) {
    for (const Effect& effect : campaign.effects) {
        const std::string& name = effect.place.screen;
        const auto called_so = [&](const Screen& s) { return s.name == name; };
        if (name.empty() || std::any_of(campaign.screens.begin(), campaign.screens.end(), called_so)) continue;
        std::set<std::string> names;
        for (const Screen& s : campaign.screens) names.insert(s.name);
        throw InputError(
            site.file.string() + ": effect " + effect_info(effect.kind).name + ": there is no screen \"" + name + "\"" +
            (names.empty() ? ": the site has no [screens]" : "; there are " + listed({names.begin(), names.end()})));
    }
}

// a rolling resistance is the way by which the ground's push runs ahead of the middle of a block: farther out than its edge there is no contact to push.
void warn_of_rolling(SiteModel& model) {
    constexpr std::uint64_t kTried = 200;
    const BlockPopulation population = reshaped(model.campaign.population, model.campaign.effects);
    double largest = 0.0;
    if (population.list.empty()) {
        for (std::uint64_t k = 0; k < kTried; ++k)
            largest = std::max(largest, draw_block(population, model.campaign.seed, k).body.size.x());
    } else {
        for (const BlockRow& row : population.list) largest = std::max(largest, row.size.x());
    }
    for (const Soil& soil : model.campaign.soils)
        if (soil.rolling > 0.5 * largest)
            model.warnings.push_back("soil." + soil.name + ".rolling = " + short_number(soil.rolling) +
                                     " m is more than half the length of the largest block (" + short_number(largest) +
                                     " m): no block can roll there; it is a length in metres, of centimetres mostly");
}

/// Blocks from which on memory is worth a word: each takes some 200 bytes [-].
static constexpr std::int64_t kManyBlocks = 20'000'000;

/// Longest step of the paper's scheme that is used without a word [s].
static constexpr double kMoreauJeanStep = 2e-3;

SiteModel load_site(const SiteFile& site) {
    const SiteSettings& s = site.settings;
    SiteModel model;
    model.terrain = load_terrain(site);
    model.warnings = model.terrain.data.warnings();
    append(model.warnings, model.terrain.effect_warnings);
    if (s.dynamics.mode == SteppingMode::MoreauJean && s.dynamics.time_step > kMoreauJeanStep)
        model.warnings.push_back(
            "model.mode = \"moreau_jean\" with model.time_step = " + short_number(s.dynamics.time_step) +
            " s: its runouts depend on the step, and the paper's is 0.001 s");
    if (s.dimension == 3 && !s.screen_chainages.empty())
        model.warnings.emplace_back(
            "screens.chainages are places along a profile, and in 3D there is none: those screens do not stand; "
            "draw them, and give screens.file");
    append(model.inputs, terrain_inputs(site, model.terrain));

    model.release =
        read_site_layer(site, s.release, "release",
                        {GeometryKind::Polygon, GeometryKind::LineString, GeometryKind::Point}, model.terrain);
    append(model.warnings, model.release.report.warnings);
    model.inputs.push_back(site.resolve(s.release.file).string());
    CampaignInput& c = model.campaign;
    c.population = make_population(site, model);
    if (!s.screens.file.empty()) {
        model.screens = read_site_layer(site, s.screens, "screens", {GeometryKind::LineString, GeometryKind::Polygon},
                                        model.terrain);
        append(model.warnings, model.screens->report.warnings);
        model.inputs.push_back(site.resolve(s.screens.file).string());
        c.screens = make_screens(*model.screens, s.screens.field);
        warn_of_shared_names(*model.screens, s.screens, "they count as one screen, at which a block is measured once",
                             model.warnings);
    }
    if (!s.deposit_zones.file.empty()) {
        model.deposit_zones =
            read_site_layer(site, s.deposit_zones, "deposit zones", {GeometryKind::Polygon}, model.terrain);
        append(model.warnings, model.deposit_zones->report.warnings);
        model.inputs.push_back(site.resolve(s.deposit_zones.file).string());
        c.deposit_zones = make_deposit_zones(*model.deposit_zones, s.deposit_zones.field);
        warn_of_shared_names(*model.deposit_zones, s.deposit_zones,
                             "a run counts in each of them, and measurements by that name mean all", model.warnings);
    }
    c.effects = model.terrain.effects;
    apply_parameters(site, c);
    c.kept_trajectories = s.trajectories;
    c.impacts = static_cast<std::int32_t>(s.impacts);
    if (s.dimension == 2)
        add_profiles(site, model);
    else {
        add_release_area(site, model);
        find_off_ground(model);
    }
    if (s.releases.count > kManyBlocks)
        model.warnings.push_back("release.count = " + std::to_string(s.releases.count) + " blocks take some " +
                                 short_number(2e-7 * static_cast<double>(s.releases.count)) + " GB of memory");
    require_screens_of_effects(site, c);
    model.files = gis::input_files(model.inputs);
    return model;
}

}  // namespace scree::cli
