// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/profile_picture.hpp"

#include "gis/long_profile.hpp"
#include "gis/relief.hpp"
#include "gis/styles.hpp"
#include "gis/svg.hpp"
#include "gis/words.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace scree::gis {

namespace {

constexpr double kPlanHeight = 430.0;   // [pixel] of the map in the picture of one profile
constexpr double kMostSection = 720.0;  // [pixel] tallest long profile

// --- plan ---

/// The box of the data grown to the shape of the panel, with a margin.
Box2 fitted(Box2 data, double width, double height, double margin) {
    data = data.grown(margin);
    const Vec2 size = data.max - data.min, middle = 0.5 * (data.min + data.max);
    const double unit = std::max(size.x() / width, size.y() / height);
    const Vec2 half = 0.5 * unit * Vec2(width, height);
    return {middle - half, middle + half};
}

/// Middle of the widest stretch of the polygon at that height between two limits; where it has none, the middle between these.
double middle_inside(const Polygon& polygon, double y, double from, double to) {
    std::vector<double> borders;
    const auto cut = [&](const Ring& ring) {
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
            if ((a.y() < y) != (b.y() < y)) borders.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
        }
    };
    cut(polygon.outer);
    for (const Ring& hole : polygon.holes) cut(hole);
    std::sort(borders.begin(), borders.end());
    double middle = 0.5 * (from + to), widest = 0.0;
    for (std::size_t k = 0; k + 1 < borders.size(); k += 2) {
        const double left = std::max(borders[k], from), right = std::min(borders[k + 1], to);
        if (right - left <= widest) continue;
        widest = right - left;
        middle = 0.5 * (left + right);
    }
    return middle;
}

class Plan {
public:
    Plan(Svg& svg, const ProfileScene& scene, const SvgPanel& panel) : svg_(svg), scene_(scene), panel_(panel) {}

    void ground() {
        const ReliefImage relief = shaded_relief(*scene_.heights, panel_.data);
        if (relief.uri.empty()) return;
        const Vec2 low = panel_.at(relief.extent.min), high = panel_.at(relief.extent.max);
        svg_.image({{low.x(), high.y()}, {high.x(), low.y()}}, relief.uri);
        draw_contours();
    }

    void areas(const std::vector<DrawnArea>& areas, const std::string& colour) {
        for (const DrawnArea& area : areas) {
            for (const Polygon& polygon : area.polygons) {
                std::vector<std::vector<Vec2>> rings{pixels(polygon.outer)};
                for (const Ring& hole : polygon.holes) rings.push_back(pixels(hole));
                svg_.area(rings, {.stroke = colour, .width = 1.3, .fill = colour, .opacity = 0.12});
                svg_.area(rings, {.stroke = colour, .width = 1.3});
            }
        }
    }

    void area_names(const std::vector<DrawnArea>& areas, const std::string& colour) {
        for (const DrawnArea& area : areas) {
            if (area.polygons.empty()) continue;
            Box2 box;
            for (const Vec2& p : area.polygons.front().outer) box.add(p);
            if (!box.overlaps(panel_.data)) continue;
            // low in what can be seen of it: the profile is likely to pass through the middle
            const Vec2 low = box.min.cwiseMax(panel_.data.min), high = box.max.cwiseMin(panel_.data.max);
            const double y = low.y() + 0.15 * (high.y() - low.y());
            svg_.text(panel_.at({middle_inside(area.polygons.front(), y, low.x(), high.x()), y}), area.name,
                      {.anchor = "middle", .colour = colour, .bold = true, .halo = true});
        }
    }

    void screens() {
        for (const DrawnLine& screen : scene_.screens) {
            svg_.line(pixels(screen.points), {.stroke = "#ffffff", .width = 4.0});
            svg_.line(pixels(screen.points), {.stroke = kScreenColour, .width = 2.0});
            // named at the end that is farther up in the picture, if it can be seen
            Vec2 top =
                screen.points.front().y() > screen.points.back().y() ? screen.points.front() : screen.points.back();
            top = top.cwiseMin(panel_.data.max).cwiseMax(panel_.data.min);
            const Vec2 at = panel_.at(top);
            svg_.text(
                {at.x() + 5.0, std::clamp(at.y() + 4.0, panel_.pixels.min.y() + 14.0, panel_.pixels.max.y() - 6.0)},
                screen.name, {.colour = kScreenColour, .bold = true, .halo = true});
        }
    }

    void plain(const DrawnProfile& p) {
        const std::vector<Vec2> line = pixels(p.profile->place);
        svg_.line(line, {.stroke = "#ffffff", .width = 3.0, .opacity = 0.7});
        svg_.line(line, {.stroke = kOtherColour, .width = 1.4});
    }

    void by_soil(const DrawnProfile& p) {
        const std::vector<Vec2> line = pixels(p.profile->place);
        svg_.line(line, {.stroke = "#ffffff", .width = 7.0});
        for_runs(
            *p.profile, [&](std::size_t k) { return p.profile->soil[k]; },
            [&](std::size_t from, std::size_t to) {
                svg_.line(std::span(line).subspan(from, to - from + 1),
                          {.stroke = category_colour(p.profile->soil[from]), .width = 4.5});
            });
        for_runs(
            *p.profile, [&](std::size_t k) { return static_cast<bool>(p.straight[k]); },
            [&](std::size_t from, std::size_t to) {
                if (p.straight[from])
                    svg_.line(std::span(line).subspan(from, to - from + 1),
                              {.stroke = "#000000", .width = 1.4, .dashes = "4 3"});
            });
    }

    void start(const DrawnProfile& p) {
        const bool crowded = scene_.profiles.size() > 40;
        svg_.circle(panel_.at(p.profile->place_at(p.start)), crowded ? 2.5 : 4.5,
                    {.stroke = "#ffffff", .width = crowded ? 0.7 : 1.5, .fill = kReleaseColour});
    }

    /// Marks with the chainage at round distances, and at the end.
    void chainages(const Profile& p) {
        const double step = round_step(p.length(), 8);
        for (double s = 0.0; s <= p.length(); s += step) {
            const Vec2 across = Vec2(-p.direction_at(s).y(), p.direction_at(s).x());
            const Vec2 at = panel_.at(p.place_at(s)), side(across.x(), -across.y());  // pixels count downwards
            svg_.segment(at - 7.0 * side, at + 7.0 * side, {.stroke = "#000000", .width = 1.6});
            const Vec2 label = at + 16.0 * side;
            svg_.text({label.x(), label.y() + 4.0}, axis_number(s, step) + " m",
                      {.size = 11.0,
                       .anchor = side.x() < -0.3  ? "end"
                                 : side.x() > 0.3 ? "start"
                                                  : "middle",
                       .halo = true});
        }
    }

    /// Where there is room: a number among others helps nobody.
    void names() {
        std::vector<Vec2> taken;
        for (const DrawnProfile& p : scene_.profiles) {
            const Vec2 at = panel_.at(p.profile->place.front());
            if (std::any_of(taken.begin(), taken.end(), [&](const Vec2& t) {
                    return std::abs(t.x() - at.x()) < 24.0 && std::abs(t.y() - at.y()) < 12.0;
                }))
                continue;
            taken.push_back(at);
            svg_.text({at.x() + 6.0, at.y() - 6.0}, p.name, {.bold = true, .halo = true});
        }
    }

    void frame() {
        SvgAxes axes;
        axes.x_title = "Easting [m]";
        axes.y_title = "Northing [m]";
        axes.offset = {scene_.frame.easting, scene_.frame.northing};
        axes.grid = false;
        axes.most_x = 8;
        axes.most_y = 6;
        draw_axes(svg_, panel_, axes);
        scale_bar();
    }

private:
    std::vector<Vec2> pixels(std::span<const Vec2> points) const {
        std::vector<Vec2> out;
        for (const Vec2& p : points) out.push_back(panel_.at(p));
        return out;
    }

    void draw_contours() {
        const auto& h = *scene_.heights;
        double low = kInfinity, high = -kInfinity;
        for (int j = 0; j < h.shape.rows; ++j) {
            for (int i = 0; i < h.shape.columns; ++i) {
                if (std::isnan(h.at(i, j)) || !panel_.data.contains(h.shape.centre(i, j))) continue;
                low = std::min(low, h.at(i, j));
                high = std::max(high, h.at(i, j));
            }
        }
        if (!(high > low)) return;
        const double interval = round_step(high - low, 20);
        const double base = -scene_.frame.height;  // heights that people read are round
        std::vector<std::pair<Vec2, std::string>> labels;
        for (const Contour& contour : contours(h, panel_.data, interval, base)) {
            const double height = contour.height + scene_.frame.height;
            const bool index = std::abs(std::remainder(height, 5.0 * interval)) < 0.1 * interval;
            const std::vector<Vec2> line = pixels(contour.points);
            svg_.line(line, {.stroke = "#6b4a1f", .width = index ? 1.1 : 0.5, .opacity = index ? 0.75 : 0.5});
            if (!index || line.size() < 30) continue;
            const Vec2 middle = line[line.size() / 2];
            const bool free = std::none_of(labels.begin(), labels.end(),
                                           [&](const auto& l) { return (l.first - middle).norm() < 60.0; });
            if (free && panel_.pixels.grown(-20.0).contains(middle))
                labels.emplace_back(middle, axis_number(height, interval));
        }
        for (const auto& [at, text] : labels)
            svg_.text({at.x(), at.y() + 4.0}, text,
                      {.size = 10.0, .anchor = "middle", .colour = "#5a3d18", .halo = true});
    }

    void scale_bar() {
        const double length = round_step(panel_.data.max.x() - panel_.data.min.x(), 12);
        const Vec2 right(panel_.pixels.max.x() - 14.0, panel_.pixels.max.y() - 14.0);
        const Vec2 left(right.x() - length * panel_.scale(), right.y());
        svg_.segment(left, right, {.stroke = "#ffffff", .width = 7.0});
        svg_.segment(left, right, {.stroke = "#000000", .width = 3.0});
        svg_.text({0.5 * (left.x() + right.x()), right.y() - 7.0}, axis_number(length, length) + " m",
                  {.size = 11.0, .anchor = "middle", .halo = true});
    }

    Svg& svg_;
    const ProfileScene& scene_;
    SvgPanel panel_;
};

// --- around it ---

SvgPanel plan_panel(const Box2& data, double top, double height) {
    const Box2 pixels{{kLeft, top}, {kWidth - kRight, top + height}};
    const double margin = std::max(5.0, 0.06 * (data.max - data.min).maxCoeff());
    return {pixels, fitted(data, kWidth - kRight - kLeft, height, margin)};
}

}  // namespace

std::string profiles_plan(const ProfileScene& scene) {
    Box2 box;
    for (const DrawnProfile& p : scene.profiles)
        for (const Vec2& place : p.profile->place) box.add(place);
    const Vec2 size = box.max - box.min;
    const double height = std::clamp(0.9 * kWidth * size.y() / std::max(size.x(), 1e-3), 350.0, 900.0);
    Svg svg(kWidth, kTop + height + kFoot + 12.0);
    titles(svg, scene.title + ": profiles",
           counted(scene.profiles.size(), "profile") + "; numbers at their upper ends");
    const SvgPanel panel = plan_panel(box, kTop, height);
    Plan plan(svg, scene, panel);
    plan.ground();
    plan.areas(scene.deposit_zones, kZoneColour);
    plan.areas(scene.releases, kReleaseColour);
    for (const DrawnProfile& p : scene.profiles) plan.plain(p);
    for (const DrawnProfile& p : scene.profiles) plan.start(p);
    plan.screens();
    plan.area_names(scene.deposit_zones, kZoneColour);
    plan.names();
    svg.mask_outside(panel.pixels);
    titles(svg, scene.title + ": profiles",
           counted(scene.profiles.size(), "profile") + ", numbered at the upper end where there is room");
    plan.frame();
    return svg.text();
}

std::string profile_picture(const ProfileScene& scene, std::size_t number) {
    const DrawnProfile& drawn = scene.profiles[number];
    const Profile& profile = *drawn.profile;
    Box2 box;
    for (const Vec2& place : profile.place) box.add(place);
    const double legend = kTop + kPlanHeight + kFoot + kLegend, section_top = legend + 20.0;
    double exaggeration = 1.0;
    const SvgPanel below = section_panel(profile, section_top, kMostSection, exaggeration);
    Svg svg(kWidth, below.pixels.max.y() + kFoot + 12.0);
    const SvgPanel panel = plan_panel(box, kTop, kPlanHeight);
    Plan plan(svg, scene, panel);
    plan.ground();
    plan.areas(scene.deposit_zones, kZoneColour);
    plan.areas(scene.releases, kReleaseColour);
    for (const DrawnProfile& other : scene.profiles)
        if (&other != &drawn) plan.plain(other);
    plan.by_soil(drawn);
    plan.chainages(profile);
    plan.start(drawn);
    plan.screens();
    plan.area_names(scene.deposit_zones, kZoneColour);
    svg.mask_outside(panel.pixels);
    titles(svg, scene.title + ": profile " + drawn.name, drawn.facts);
    plan.frame();

    Legend keys(svg, legend);
    for (std::size_t soil = 0; soil < scene.soils.size(); ++soil)
        if (std::find(profile.soil.begin(), profile.soil.end(), soil) != profile.soil.end())
            keys.soil(soil_name(scene, static_cast<SoilId>(soil)), category_colour(soil));
    if (std::find(drawn.straight.begin(), drawn.straight.end(), true) != drawn.straight.end())
        keys.dashed("led straight on");
    keys.dot("start");
    draw_long_profile(svg, scene, drawn, below, true);
    svg.text({kWidth - kRight, legend},
             exaggeration == 1.0 ? "long profile: equal scales" : "long profile: heights x " + fixed(exaggeration, 2),
             {.anchor = "end"});
    return svg.text();
}

}  // namespace scree::gis
