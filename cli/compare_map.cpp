// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/compare_figures.hpp"
#include "cli/plot.hpp"
#include "cli/text.hpp"
#include "gis/relief.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

namespace scree::cli {

namespace {

using gis::Svg;
using gis::SvgPanel;
using gis::SvgPen;
using gis::SvgText;

constexpr double kMapWidth = 860.0, kMostHeight = 760.0;                     // [pixel]
constexpr double kLeft = 104.0, kTop = 54.0, kRight = 20.0, kBottom = 56.0;  // [pixel]
constexpr const char* kReleaseColour = "#127a33";
constexpr double kMargin = 0.06;     // of the extent, around what is shown [-]
constexpr double kCellsAcross = 90;  // density cells over the map's longer side [-]
/// Classes of shares of the simulated blocks per cell: from which share on, and colour.
struct ShareClass {
    double share;
    const char* colour;
};
constexpr std::array<ShareClass, 5> kDensityClasses{
    {{0.0, "#fff1c9"}, {0.0005, "#fed58a"}, {0.002, "#fba04f"}, {0.005, "#ea6428"}, {0.01, "#b0300c"}}};
constexpr std::array<ShareClass, 6> kReachClasses{
    {{0.0, "#fff1c9"}, {0.01, "#fed58a"}, {0.05, "#fba04f"}, {0.1, "#ea6428"}, {0.25, "#b0300c"}, {0.5, "#6b0f0f"}}};
/// Cells of a map with their shares.
struct ShareCells {
    std::string what;  ///< "simulated stops"
    std::span<const ShareClass> classes;
    double cell = 0.0;                           ///< [m]
    std::vector<std::pair<Vec2, double>> cells;  ///< south-west corner, share
};

SvgText label(double size, const char* anchor) {
    SvgText text = words(size, anchor);
    text.halo = true;
    return text;
}

/// Where blocks came to rest, and how many of all did not.
struct SimulatedStops {
    std::vector<Vec2> at_rest;
    std::int64_t others = 0;
};
SimulatedStops simulated_stops(const CampaignResult& campaign) {
    SimulatedStops stops;
    for (const BlockResult& b : campaign.blocks) {
        if (!b.done || b.reason == StopReason::Failed) continue;
        if (b.reason == StopReason::AtRest)
            stops.at_rest.push_back(b.stop.head<2>());
        else
            ++stops.others;
    }
    return stops;
}

Box2 shown(const SiteModel& model, const ObservedSite& observed, const std::vector<Vec2>& stops) {
    Box2 box;
    for (const Vec2& p : stops) box.add(p);
    for (const ObservedStop& s : observed.observations.stops)
        if (std::isfinite(s.position.x())) box.add(Vec2(s.position.head<2>()));
    for (const Feature& f : model.release.layer.features) {
        if (const auto* polygons = std::get_if<MultiPolygon>(&f.geometry))
            for (const Polygon& p : *polygons)
                for (const Vec2& v : p.outer) box.add(v);
        if (const auto* points = std::get_if<Points>(&f.geometry))
            for (const Vec3& p : *points) box.add(Vec2(p.head<2>()));
        if (const auto* lines = std::get_if<Polylines>(&f.geometry))
            for (const Polyline& line : *lines)
                for (const Vec3& p : line.points) box.add(Vec2(p.head<2>()));
    }
    const Box2 terrain = model.terrain.data.grid.shape.bounds();
    box = box.grown(kMargin * (box.max - box.min).norm() + 2.0);
    return {box.min.cwiseMax(terrain.min), box.max.cwiseMin(terrain.max)};
}

ShareCells density_cells(const Box2& box, const SimulatedStops& stops, double least_cell) {
    const double cell = std::max(least_cell, gis::round_step((box.max - box.min).maxCoeff() / kCellsAcross, 1));
    std::map<std::pair<int, int>, int> counts;
    for (const Vec2& p : stops.at_rest) {
        const Vec2 at = (p - box.min) / cell;
        ++counts[{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))}];
    }
    ShareCells density{"simulated stops", kDensityClasses, cell, {}};
    for (const auto& [at, count] : counts)
        density.cells.emplace_back(box.min + cell * Vec2(at.first, at.second),
                                   count / static_cast<double>(std::ssize(stops.at_rest) + stops.others));
    return density;
}

ShareCells reach_cells(const SiteModel& model, const CampaignResult& campaign) {
    const GridShape& grid = model.campaign.result_cells;
    const double released = static_cast<double>(std::max<std::int64_t>(campaign.released, 1));
    std::map<std::size_t, double> shares;  // in a fixed order
    for (const auto& [cell, statistics] : campaign.cells)
        if (statistics.passages > 0) shares[cell] = static_cast<double>(statistics.passages) / released;
    ShareCells reach{"reach probability", kReachClasses, grid.cell, {}};
    const auto columns = static_cast<std::size_t>(grid.columns);
    for (const auto& [cell, share] : shares)
        reach.cells.emplace_back(grid.origin + grid.cell * Vec2(cell % columns, cell / columns), share);
    return reach;
}

/// Rectangles of their classes.
void draw_cells(Svg& svg, const SvgPanel& panel, const ShareCells& shares) {
    for (const auto& [corner, share] : shares.cells) {
        const char* colour = shares.classes.front().colour;
        for (const ShareClass& c : shares.classes)
            if (share >= c.share) colour = c.colour;
        svg.box({panel.at({corner.x(), corner.y() + shares.cell}), panel.at({corner.x() + shares.cell, corner.y()})},
                fill(colour, 0.8));
    }
}

/// The northernmost point of a line inside a box, of those a step apart; NaN if none is.
Vec2 northernmost(const std::vector<Vec2>& line, const Box2& box) {
    constexpr int kSteps = 200;
    Vec2 best = Vec2::Constant(kNaN);
    for (std::size_t i = 1; i < line.size(); ++i) {
        for (int k = 0; k <= kSteps; ++k) {
            const Vec2 p = line[i - 1] + k / double{kSteps} * (line[i] - line[i - 1]);
            if (box.contains(p) && !(p.y() <= best.y())) best = p;
        }
    }
    return best;
}

void draw_places(Svg& svg, const SvgPanel& panel, const SiteModel& model, const ObservedSite& observed) {
    for (const Feature& f : model.release.layer.features) {
        if (const auto* polygons = std::get_if<MultiPolygon>(&f.geometry)) {
            for (const Polygon& p : *polygons) {
                std::vector<Vec2> ring;
                for (const Vec2& v : p.outer) ring.push_back(panel.at(v));
                ring.push_back(ring.front());
                svg.line(ring, stroke(kReleaseColour, 2.0));
            }
        } else if (const auto* lines = std::get_if<Polylines>(&f.geometry)) {
            for (const Polyline& l : *lines) {
                std::vector<Vec2> line;
                for (const Vec3& v : l.points) line.push_back(panel.at(v.head<2>()));
                svg.line(line, stroke(kReleaseColour, 2.0));
            }
        } else if (const auto* points = std::get_if<Points>(&f.geometry)) {
            for (const Vec3& v : *points) svg.circle(panel.at(v.head<2>()), 3.0, stroke(kReleaseColour, 1.5));
        }
    }
    int number = 0;
    for (const Screen& screen : model.campaign.screens) {
        if (screen.line.empty()) continue;  // given by its chainage
        std::vector<Vec2> line;
        for (const Vec2& v : screen.line) line.push_back(panel.at(v));
        svg.line(line, stroke("#5a2d91", 1.8, "7 3"));
        // named at its northernmost point in the picture, neighbours at different heights
        const Vec2 top = northernmost(screen.line, panel.data);
        if (!std::isfinite(top.x())) continue;
        const Vec2 at = panel.at(top);
        const bool at_edge = at.x() + text_width(screen.name, 11.0) + 8.0 > panel.pixels.max.x();
        svg.text(at + Vec2(at_edge ? -5.0 : 5.0, 14.0 + 14.0 * (number++ % 2)), screen.name,
                 label(11.0, at_edge ? "end" : "start"));
    }
    // the axis, as far as it is in the picture
    const double far = (panel.data.max - panel.data.min).norm();
    const std::vector<Vec2>& axis = observed.op.axis.line();
    std::vector<Vec2> line{panel.at(observed.op.axis.point(0.0))};
    for (std::size_t k = 1; k + 1 < axis.size(); ++k) line.push_back(panel.at(axis[k]));
    const double last = observed.op.axis.place(axis.back()).along;
    for (double at = last; at < last + far; at += 0.01 * far) {
        const Vec2 p = observed.op.axis.point(at);
        if (panel.data.contains(p)) line.push_back(panel.at(p));
    }
    svg.line(line, stroke("#222222", 1.0, "2 3"));
}

void draw_measured(Svg& svg, const SvgPanel& panel, const ObservedSite& observed) {
    SvgPen dot = stroke("#ffffff", 1.2);
    dot.fill = kMeasuredColour;
    for (const ObservedStop& s : observed.observations.stops)
        if (std::isfinite(s.position.x())) svg.circle(panel.at(s.position.head<2>()), 4.2, dot);
}

/// A bar of round length in the lower left corner.
void draw_scale(Svg& svg, const SvgPanel& panel) {
    const double length = gis::round_step(0.12 * (panel.data.max.x() - panel.data.min.x()), 1);
    const Vec2 from(panel.pixels.min.x() + 16.0, panel.pixels.max.y() - 16.0),
        to = from + Vec2(length * panel.scale(), 0.0);
    svg.segment(from, to, stroke("#ffffff", 6.0));
    svg.segment(from, to, stroke("#222222", 3.0));
    svg.text(0.5 * (from + to) + Vec2(0.0, -7.0), gis::axis_number(length, length) + " m", label(12.0, "middle"));
}

void draw_class_legend(Svg& svg, Vec2 at, const ShareCells& shares) {
    const SvgText plain = words(11.5, "start");
    const std::string head = shares.what + " per cell of " +
                             gis::axis_number(shares.cell, shares.cell < 1.0 ? 0.1 : 1.0) + " m, share of the blocks:";
    svg.text(at, head, plain);
    at.x() += text_width(head, 11.5) + 12.0;
    for (const ShareClass& c : shares.classes) {
        svg.box({at + Vec2(0.0, -10.0), at + Vec2(16.0, 1.0)}, fill(c.colour));
        const std::string from = c.share == 0.0 ? "> 0" : gis::axis_number(100.0 * c.share, 0.01) + " %";
        svg.text(at + Vec2(20.0, 0.0), from, plain);
        at.x() += 30.0 + text_width(from, 11.5);
    }
}

/// The terrain inside the box with these cells, release, screens, axis and measured stops.
std::string drawn_map(const std::string& title, const SiteModel& model, const ObservedSite& observed, const Box2& box,
                      const ShareCells& shares) {
    const Vec2 extent = box.max - box.min;
    const double scale = std::min(kMapWidth / extent.x(), kMostHeight / extent.y());
    const Vec2 size = scale * extent;
    const double width = std::max(size.x(), 640.0);  // the legend needs room
    Svg svg(kLeft + width + kRight, kTop + size.y() + kBottom);
    const SvgPanel panel{{{kLeft, kTop}, Vec2(kLeft, kTop) + size}, box};

    const gis::ReliefImage relief = gis::shaded_relief(model.terrain.data.grid, box);
    if (!relief.uri.empty())
        svg.image({panel.at({relief.extent.min.x(), relief.extent.max.y()}),
                   panel.at({relief.extent.max.x(), relief.extent.min.y()})},
                  relief.uri);
    draw_cells(svg, panel, shares);
    draw_places(svg, panel, model, observed);
    draw_measured(svg, panel, observed);
    draw_scale(svg, panel);
    svg.mask_outside(panel.pixels);

    gis::SvgAxes axes;
    axes.x_title = "Easting [m]";
    axes.y_title = "Northing [m]";
    axes.offset = {model.terrain.data.frame.easting, model.terrain.data.frame.northing};
    axes.grid = false;
    axes.most_x = 7;
    axes.most_y = 7;
    draw_axes(svg, panel, axes);
    svg.text({12.0, 20.0}, title, words(13.5, "start", true));
    Vec2 at(kLeft + 200.0, 20.0);
    at.x() = std::max(at.x(), 30.0 + text_width(title, 14.5));
    if (!observed.observations.stops.empty())
        at.x() += draw_legend(svg, at, LegendMark::Dot, kMeasuredColour, "measured stops");
    at.x() += draw_legend(svg, at, LegendMark::Line, kReleaseColour, "release");
    if (!model.campaign.screens.empty()) draw_legend(svg, at, LegendMark::Line, "#5a2d91", "screens");
    draw_class_legend(svg, {12.0, 42.0}, shares);
    return svg.text();
}

}  // namespace

Figure compare_map(const CompareStudy& study, const SiteModel& model, const ObservedSite& observed,
                   const CampaignResult& campaign) {
    const SimulatedStops stops = simulated_stops(campaign);
    const Box2 box = shown(model, observed, stops.at_rest);
    return {
        "map.svg", "Map",
        std::string(observed.observations.stops.empty() ? "Density of the simulated stops"
                                                        : "Measured stops over the density of the simulated ones") +
            (stops.others == 0 ? ""
                               : " (" + percent(stops.others, stops.others + std::ssize(stops.at_rest)) +
                                     " of the blocks did not come to rest on the terrain: not drawn)") +
            ". Dotted: the axis along which distance counts, " + observed.axis_text + ".",
        drawn_map(study.title, model, observed, box, density_cells(box, stops, model.terrain.data.grid.shape.cell))};
}

Figure reach_map(const std::string& title, const SiteModel& model, const ObservedSite& observed,
                 const CampaignResult& campaign) {
    const Box2 box = shown(model, observed, simulated_stops(campaign).at_rest);
    return {"reach.svg", "Reach probability, " + title,
            "Share of the measured blocks, thrown again and again, that cross a cell.",
            drawn_map(title, model, observed, box, reach_cells(model, campaign))};
}

}  // namespace scree::cli
