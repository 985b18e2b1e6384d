// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/run_picture.hpp"

#include "gis/long_profile.hpp"
#include "gis/words.hpp"

#include <algorithm>
#include <cmath>

namespace scree::gis {

namespace {

constexpr double kMostSection = 430.0;                // [pixel] tallest long profile
constexpr double kPanel = 118.0;                      // [pixel] height of a panel
constexpr double kGap = 24.0;                         // [pixel] between panels: room for the numbers of the axis
constexpr double kSpan = kWidth - kRight - kLeft;     // [pixel] width of a panel
constexpr double kBesideKey = 8.0, kKeyLetter = 6.7;  // [pixel]
constexpr double kRoom = 1.08, kRoomForKey = 1.25;    // top of a panel over what lies highest [-]
const char* const kPathColour = "#31688e";

class Panel {
public:
    Panel(Svg& svg, const DrawnPanel& drawn, double cell, double length, double top)
        : svg_(svg), drawn_(drawn), cell_(cell) {
        double largest = drawn.top;
        if (largest <= 0.0) {
            const double under_key = drawn.curves.size() > 1 ? length * (1.0 - key_width() / kSpan) : kInfinity;
            for (const DrawnCurve& curve : drawn.curves)
                for (std::size_t k = 0; k < curve.values.size(); ++k) {
                    const double room = static_cast<double>(k + 1) * cell > under_key ? kRoomForKey : kRoom;
                    largest = std::max(largest, std::isfinite(curve.values[k]) ? room * curve.values[k] : 0.0);
                }
            if (largest <= 0.0) largest = 1.0;
        }
        panel_ = {{{kLeft, top}, {kWidth - kRight, top + kPanel}}, {{0.0, 0.0}, {length, largest}}};
    }

    void draw(const std::vector<std::pair<double, std::string>>& screens, bool last) {
        SvgAxes axes;
        axes.y_title = drawn_.title;
        if (last) axes.x_title = kChainageTitle;
        axes.most_y = 4;
        draw_axes(svg_, panel_, axes);
        for (std::size_t k = 0; k < drawn_.curves.size(); ++k)
            if (k == 0 && drawn_.bars)
                bars(drawn_.curves[k]);
            else
                steps(drawn_.curves[k]);
        for (const auto& [s, name] : screens) {
            const double x = panel_.at({s, 0.0}).x();
            svg_.segment({x, panel_.pixels.min.y()}, {x, panel_.pixels.max.y()},
                         {.stroke = kScreenColour, .width = 1.0, .dashes = "6 3"});
        }
        if (drawn_.curves.size() > 1) key();
    }

private:
    double left_of(std::size_t cell) const { return std::min(static_cast<double>(cell) * cell_, panel_.data.max.x()); }

    void bars(const DrawnCurve& curve) {
        for (std::size_t k = 0; k < curve.values.size(); ++k) {
            if (!(curve.values[k] > 0.0)) continue;
            const Vec2 low = panel_.at({left_of(k), 0.0}), high = panel_.at({left_of(k + 1), curve.values[k]});
            svg_.box({{low.x(), high.y()}, {high.x(), low.y()}}, {.fill = curve.colour, .opacity = 0.85});
        }
    }

    /// The value of a cell over its whole length.
    void steps(const DrawnCurve& curve) {
        std::vector<Vec2> line;
        auto finish = [&] {
            if (line.size() > 1) svg_.line(line, {.stroke = curve.colour, .width = 1.5, .dashes = curve.dashes});
            line.clear();
        };
        for (std::size_t k = 0; k < curve.values.size(); ++k) {
            if (!std::isfinite(curve.values[k])) {
                finish();
                continue;
            }
            line.push_back(panel_.at({left_of(k), curve.values[k]}));
            line.push_back(panel_.at({left_of(k + 1), curve.values[k]}));
        }
        finish();
    }

    double key_width() const {
        double width = kBesideKey;
        for (const DrawnCurve& curve : drawn_.curves)
            width += kKeyLetter * static_cast<double>(curve.name.size()) + 44.0;
        return width;
    }

    /// In the upper right corner, the first curve last.
    void key() {
        double x = panel_.pixels.max.x() - kBesideKey;
        const double y = panel_.pixels.min.y() + 15.0;
        for (auto curve = drawn_.curves.rbegin(); curve != drawn_.curves.rend(); ++curve) {
            svg_.text({x, y}, curve->name, {.size = 11.0, .anchor = "end", .halo = true});
            x -= kKeyLetter * static_cast<double>(curve->name.size()) + 8.0;
            svg_.segment({x - 20.0, y - 4.0}, {x, y - 4.0},
                         {.stroke = curve->colour, .width = 2.0, .dashes = curve->dashes});
            x -= 36.0;
        }
    }

    Svg& svg_;
    const DrawnPanel& drawn_;
    double cell_;
    SvgPanel panel_;
};

}  // namespace

std::string run_picture(const ProfileScene& scene, std::size_t number, const DrawnRun& run) {
    const DrawnProfile& drawn = scene.profiles[number];
    const Profile& profile = *drawn.profile;
    double exaggeration = 1.0;
    const double section_top = kTop + kLegend;
    const SvgPanel section = section_panel(profile, section_top, kMostSection, exaggeration);
    const double below = section.pixels.max.y() + kGap;
    const auto count = static_cast<double>(run.panels.size());
    Svg svg(kWidth, below + count * (kPanel + kGap) + kFoot - kGap + 12.0);

    for (const std::vector<Vec2>& path : run.paths) {
        std::vector<Vec2> line;
        for (const Vec2& p : path) line.push_back(section.at(p));
        svg.line(line, {.stroke = kPathColour, .width = 0.7, .opacity = 0.55});
    }
    svg.mask_outside(section.pixels);
    titles(svg, run.title, run.facts);
    draw_long_profile(svg, scene, drawn, section, run.panels.empty());
    for (const Vec2& stop : run.stops)
        svg.circle(section.at(stop), 2.4, {.stroke = "#ffffff", .width = 0.6, .fill = "#0072b2"});

    Legend keys(svg, kTop + 12.0);
    for (std::size_t soil = 0; soil < scene.soils.size(); ++soil)
        if (std::find(profile.soil.begin(), profile.soil.end(), soil) != profile.soil.end())
            keys.soil(soil_name(scene, static_cast<SoilId>(soil)), category_colour(soil));
    if (std::find(drawn.straight.begin(), drawn.straight.end(), true) != drawn.straight.end())
        keys.dashed("led straight on");
    if (!run.paths.empty()) keys.line(counted(run.paths.size(), "path"), {.stroke = kPathColour, .width = 1.5});
    svg.text({kWidth - kRight, kTop + 12.0},
             exaggeration == 1.0 ? "equal scales" : "heights x " + fixed(exaggeration, 2), {.anchor = "end"});

    const auto screens = screens_along(scene, drawn);
    for (std::size_t k = 0; k < run.panels.size(); ++k) {
        const double top = below + static_cast<double>(k) * (kPanel + kGap);
        Panel(svg, run.panels[k], run.cell, profile.length(), top).draw(screens, k + 1 == run.panels.size());
    }
    return svg.text();
}

}  // namespace scree::gis
