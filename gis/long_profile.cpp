// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/long_profile.hpp"

#include "gis/words.hpp"

#include <algorithm>

namespace scree::gis {

namespace {

constexpr double kLeastSection = 200.0;  // [pixel] lowest long profile
constexpr double kLetter = 7.0;          // [pixel] width of a letter in it, to see where there is room

class Section {
public:
    Section(Svg& svg, const ProfileScene& scene, const DrawnProfile& drawn, const SvgPanel& panel)
        : svg_(svg), scene_(scene), drawn_(drawn), profile_(*drawn.profile), panel_(panel) {}

    void draw(bool titled) {
        axes(titled);
        ground();
        stretches(scene_.releases, kReleaseColour, 20.0, "release");
        stretches(scene_.deposit_zones, kZoneColour, 42.0, "");
        screens();
        svg_.circle(panel_.at({drawn_.start, profile_.height_at(drawn_.start)}), 4.5,
                    {.stroke = "#ffffff", .width = 1.5, .fill = kReleaseColour});
    }

private:
    void axes(bool titled) {
        SvgAxes axes;
        if (titled) axes.x_title = kChainageTitle;
        axes.y_title = "Height [m]";
        axes.offset = {0.0, scene_.frame.height};
        draw_axes(svg_, panel_, axes);
    }

    void ground() {
        std::vector<Vec2> line;
        for (std::size_t k = 0; k < profile_.vertex_count(); ++k) line.push_back(panel_.at(profile_.vertex(k)));
        const double bottom = panel_.pixels.max.y();
        for_runs(
            profile_, [&](std::size_t k) { return profile_.soil[k]; },
            [&](std::size_t from, std::size_t to) {
                const std::string colour = category_colour(profile_.soil[from]);
                std::vector<Vec2> run(line.begin() + static_cast<std::ptrdiff_t>(from),
                                      line.begin() + static_cast<std::ptrdiff_t>(to) + 1);
                std::vector<Vec2> fill = run;
                fill.emplace_back(run.back().x(), bottom);
                fill.emplace_back(run.front().x(), bottom);
                const std::vector<std::vector<Vec2>> rings{fill};
                svg_.area(rings, {.fill = colour, .opacity = 0.22});
                svg_.line(run, {.stroke = colour, .width = 3.5});
            });
        svg_.line(line, {.stroke = "#000000", .width = 1.0});
        for_runs(
            profile_, [&](std::size_t k) { return static_cast<bool>(drawn_.straight[k]); },
            [&](std::size_t from, std::size_t to) {
                if (!drawn_.straight[from]) return;
                svg_.segment({line[from].x(), bottom - 6.0}, {line[to].x(), bottom - 6.0},
                             {.stroke = "#000000", .width = 1.6, .dashes = "4 3"});
            });
    }

    /// Bars along the top where the profile lies in an area, with their names where there is room.
    void stretches(const std::vector<DrawnArea>& areas, const std::string& colour, double depth,
                   const std::string& name) {
        std::vector<std::pair<Stretch, std::string>> all;
        for (const DrawnArea& area : areas)
            for (const Stretch& s : profile_.inside(area.polygons))
                all.emplace_back(s, name.empty() ? area.name : name);
        std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first.from < b.first.from; });
        const double y = panel_.pixels.min.y() + depth;
        double named = -kInfinity;  // where the last name ends [pixel]
        for (const auto& [s, text] : all) {
            const double from = panel_.at({s.from, 0.0}).x(), to = panel_.at({s.to, 0.0}).x();
            svg_.segment({from, y}, {to, y}, {.stroke = colour, .width = 4.0});
            for (const double end : {from, to})
                svg_.segment({end, y - 5.0}, {end, y + 5.0}, {.stroke = colour, .width = 1.2});
            const double half = 0.5 * kLetter * static_cast<double>(text.size());
            const double x = std::clamp(0.5 * (from + to), panel_.pixels.min.x() + half,
                                        std::max(panel_.pixels.min.x() + half, panel_.pixels.max.x() - half));
            if (x - half < named) continue;
            named = x + half;
            svg_.text({x, y - 6.0}, text, {.size = 11.0, .anchor = "middle", .colour = colour, .halo = true});
        }
    }

    void screens() {
        const std::vector<std::pair<double, std::string>> marks = screens_along(scene_, drawn_);
        std::vector<double> row_end;  // where the words of each row end [pixel]
        for (const auto& [s, name] : marks) {
            const double x = panel_.at({s, 0.0}).x();
            const std::string text = name + ", s = " + fixed(s, 1) + " m";
            std::size_t row = 0;
            while (row < row_end.size() && row_end[row] > x) ++row;
            if (row == row_end.size()) row_end.push_back(0.0);
            row_end[row] = x + kLetter * static_cast<double>(text.size());
            const double top = panel_.pixels.min.y() + 52.0 + 15.0 * static_cast<double>(row);
            svg_.segment({x, top}, {x, panel_.pixels.max.y()},
                         {.stroke = kScreenColour, .width = 1.3, .dashes = "6 3"});
            svg_.text({x + 4.0, top + 12.0}, text, {.size = 11.0, .colour = kScreenColour, .halo = true});
        }
    }

    Svg& svg_;
    const ProfileScene& scene_;
    const DrawnProfile& drawn_;
    const Profile& profile_;
    SvgPanel panel_;
};

}  // namespace

std::string soil_name(const ProfileScene& scene, SoilId soil) {
    return soil < scene.soils.size() ? scene.soils[soil] : words("soil ", static_cast<int>(soil));
}

void titles(Svg& svg, const std::string& title, const std::string& facts) {
    svg.text({kLeft, 26.0}, title, {.size = 18.0, .bold = true});
    svg.text({kLeft, 48.0}, facts, {.size = 13.0});
}

std::vector<std::pair<double, std::string>> screens_along(const ProfileScene& scene, const DrawnProfile& drawn) {
    std::vector<std::pair<double, std::string>> marks = drawn.marks;
    for (const DrawnLine& screen : scene.screens)
        for (const double s : drawn.profile->crossings(screen.points)) marks.emplace_back(s, screen.name);
    std::sort(marks.begin(), marks.end());
    return marks;
}

SvgPanel section_panel(const Profile& p, double top, double most, double& exaggeration) {
    const auto [low, high] = std::minmax_element(p.z.begin(), p.z.end());
    const double width = kWidth - kRight - kLeft;
    const double unit = p.length() / width;
    // room above the ground for zones and screens
    const double drop = std::max(*high - *low, 0.02 * p.length());
    const double equal = 1.1 * drop / unit + 60.0;
    const double height = std::clamp(equal, kLeastSection, most);
    exaggeration = equal > most ? (height - 60.0) / (1.1 * drop / unit) : 1.0;
    const double bottom = *low - 0.1 * drop;
    return {{{kLeft, top}, {kWidth - kRight, top + height}},
            {{0.0, bottom}, {p.length(), bottom + height * unit / exaggeration}}};
}

void draw_long_profile(Svg& svg, const ProfileScene& scene, const DrawnProfile& drawn, const SvgPanel& panel,
                       bool titled) {
    Section(svg, scene, drawn, panel).draw(titled);
}

}  // namespace scree::gis
