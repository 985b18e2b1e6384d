// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/results_writer.hpp"
#include "scree/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace scree::test {

/// What results look like, without any physics: a slope that flattens out, blocks that hop along a parabola per jump, and maps
/// that fade away from the middle. Large enough that the GeoTIFFs get overviews. Lambert-93.
class SampleResults {
public:
    static constexpr int kColumns = 300;
    static constexpr int kRows = 600;  ///< row 0 is the southern foot of the slope

    explicit SampleResults(std::string crs_wkt) {
        package.frame = {.easting = 903'000, .northing = 6'455'000, .height = 1'000, .crs = std::move(crs_wkt)};
        package.title = "Sample slope";
        add_vectors();
        add_rasters();
        package.provenance = {{"scree.version", "0.1.0"},
                              {"settings", "[site]\nname = \"Sample <slope> & \\\"path A\\\"\"\n"},
                              {"seed", "42"},
                              {"input.data/dtm.tif.sha256", std::string(64, 'a')},
                              {"count.released", "200"},
                              {"count.at_rest", "180"}};
        package.files = {{"run.toml", "[site]\nname = \"Sample slope\"\n"}};
    }

    gis::ResultsPackage package;

    static double ground(double x, double y) {
        const double s = std::clamp((y - 120.0) / 480.0, 0.0, 1.0);
        const double gully = 6.0 * std::cos((x - 150.0) / 300.0 * 4.0 * std::numbers::pi) * s;
        return 320.0 * s * s - gully + 0.8 * std::sin(x / 7.0) * std::sin(y / 9.0) * s;
    }

private:
    /// Where block i walks: easting as a function of northing.
    static double path_x(int block, double y, double spread) {
        return 150.0 + spread * (600.0 - y) / 6.0 + 6.0 * std::sin(y / 40.0 + block);
    }

    void add_vectors() {
        using gis::VectorLayer;
        VectorLayer stops{
            .title = "Stopping points", .description = "Where the blocks came to rest", .group = "Blocks"};
        stops.data = {"stopping_points",
                      GeometryKind::Point,
                      {{"block_id", FieldType::Integer, "Block"},
                       {"mass_kg", FieldType::Real, "Mass [kg]"},
                       {"stop_reason", FieldType::Text, "Reason of stopping"}},
                      {}};
        VectorLayer releases{.title = "Release points", .description = "Where the blocks started", .group = "Blocks"};
        releases.data = {"release_points", GeometryKind::Point, {{"block_id", FieldType::Integer, "Block"}}, {}};
        VectorLayer lines{.coordinates = gis::Coordinates::XYZM,
                          .title = "Trajectories",
                          .description = "Paths of the centres of mass, M is the time in seconds",
                          .group = "Blocks"};
        lines.data = {
            "trajectories",
            GeometryKind::LineString,
            {{"block_id", FieldType::Integer, "Block"}, {"speed_max_ms", FieldType::Real, "Largest speed [m/s]"}},
            {}};
        static constexpr const char* kReasons[] = {"at_rest", "at_rest",      "at_rest",
                                                   "at_rest", "left_terrain", "time_limit"};
        for (std::int64_t block = 0; block < 200; ++block) {
            RandomStream random(42, static_cast<std::uint64_t>(block), RandomPurpose::Block);
            const int number = static_cast<int>(block);
            const double spread = random.uniform(-1.0, 1.0);
            const double end = 40.0 + 180.0 * random.uniform() * random.uniform();
            const double mass = 100.0 * std::pow(10.0, 2.0 * random.uniform());
            Polyline path;
            for (double y = random.uniform(565.0, 590.0); y > end; y -= 2.5) {
                const double hop = std::abs(std::sin(y / 9.0)) * (y - end) / 120.0;
                const double x = path_x(number, y, spread);
                path.points.emplace_back(x, y, ground(x, y) + 0.5 + hop);
                path.measure.push_back(0.25 * static_cast<double>(path.points.size() - 1));
            }
            stops.data.features.push_back(
                {block, Points{path.points.back()}, {block, mass, std::string(kReasons[block % 6])}});
            releases.data.features.push_back({block, Points{path.points.front()}, {block}});
            if (block % 2 == 0)
                lines.data.features.push_back({block, Polylines{path}, {block, 8.0 + 24.0 * random.uniform()}});
        }
        VectorLayer screens{.coordinates = gis::Coordinates::XY, .title = "Screens", .group = "Protection"};
        screens.data = {"screens", GeometryKind::LineString, {{"name", FieldType::Text, "Name"}}, {}};
        screens.data.features.push_back(
            {0, Polylines{{{{60, 200, 0}, {240, 190, 0}}, {}}}, {std::string("Barrier above the road")}});
        VectorLayer zones{.coordinates = gis::Coordinates::XY, .title = "Deposit zones", .group = "Protection"};
        zones.data = {"deposit_zones",
                      GeometryKind::Polygon,
                      {{"name", FieldType::Text, "Name"}, {"percent", FieldType::Real, "Share of the deposits [%]"}},
                      {}};
        const double limits[] = {20, 80, 140, 220};
        const double shares[] = {34.25, 41.0, 14.5};
        for (int i = 0; i < 3; ++i) {
            const Ring ring = {{40, limits[i]}, {260, limits[i]}, {260, limits[i + 1]}, {40, limits[i + 1]}};
            zones.data.features.push_back(
                {i, MultiPolygon{{ring, {}}}, {"Zone " + std::string(1, static_cast<char>('C' - i)), shares[i]}});
        }
        package.vectors = {std::move(stops), std::move(releases), std::move(screens), std::move(lines),
                           std::move(zones)};
    }

    template <class Value>
    Grid<float> map(Value value) const {
        Grid<float> out({.columns = kColumns, .rows = kRows, .cell = 1.0, .origin = Vec2::Zero()}, std::nanf(""));
        for (int row = 0; row < kRows; ++row) {
            for (int column = 0; column < kColumns; ++column) {
                const Vec2 p = out.shape.centre(column, row);
                const double across = (p.x() - 150.0) / (12.0 + (600.0 - p.y()) / 6.0);
                const double share = p.y() > 590.0 || p.y() < 25.0 ? 0.0 : std::max(0.0, 1.0 - across * across);
                out.at(column, row) = static_cast<float>(value(p, share));
            }
        }
        return out;
    }

    void add_rasters() {
        const auto where = [](double share, double value) { return share > 0.0 ? value : kNaN; };
        const auto pace = [](const Vec2& p) {
            return std::sin(std::numbers::pi * std::clamp((p.y() - 20.0) / 580.0, 0.0, 1.0));
        };
        package.rasters = {
            {.name = "energy_kj_p95",
             .title = "Kinetic energy, 95th percentile",
             .unit = "kJ",
             .quantity_definition = "95th percentile of the largest kinetic energy of each block in the cell",
             .group = "Kinetic energy",
             .theme = gis::RasterTheme::Energy,
             .visible = true,
             .values = map([&](const Vec2& p, double share) {
                 return where(share, 2500.0 * share * share * pace(p) * pace(p));
             })},
            {.name = "height_m_p95",
             .title = "Passing height, 95th percentile",
             .unit = "m",
             .group = "Passing height",
             .theme = gis::RasterTheme::Height,
             .values = map([&](const Vec2& p, double share) { return where(share, 9.0 * share * pace(p)); })},
            {.name = "speed_ms_max",
             .title = "Speed, largest",
             .unit = "m/s",
             .group = "Speed",
             .theme = gis::RasterTheme::Speed,
             .values =
                 map([&](const Vec2& p, double share) { return where(share, 34.0 * std::sqrt(share) * pace(p)); })},
            {.name = "passages",
             .title = "Passages",
             .unit = "-",
             .group = "Frequency",
             .theme = gis::RasterTheme::Count,
             .values = map([&](const Vec2&, double share) { return std::floor(140.0 * share * share); })},
            {.name = "reach_probability",
             .title = "Reach probability",
             .unit = "-",
             .group = "Frequency",
             .theme = gis::RasterTheme::Probability,
             .values = map([&](const Vec2&, double share) { return share * share; })},
            {.name = "terrain_m",
             .title = "Terrain",
             .unit = "m",
             .theme = gis::RasterTheme::Terrain,
             .visible = true,
             .values = map([&](const Vec2& p, double) { return 1'000.0 + ground(p.x(), p.y()); })}};
    }
};

}  // namespace scree::test
