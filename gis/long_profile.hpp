// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/profile_picture.hpp"
#include "gis/styles.hpp"
#include "gis/svg.hpp"

#include <string>
#include <utility>
#include <vector>

namespace scree::gis {

// What the pictures of profiles share: sizes and colours, legend, titles, and the long profile itself.

inline constexpr double kWidth = 1000.0;  // of the picture [pixel]
inline constexpr double kLeft = 100.0;    // [pixel] room for the numbers of the vertical axes
inline constexpr double kRight = 20.0;    // [pixel]
inline constexpr double kTop = 62.0;      // [pixel] room for title and facts
inline constexpr double kFoot = 48.0;     // [pixel] room for the numbers and title of a horizontal axis
inline constexpr double kLegend = 26.0;   // [pixel] height of the row of the legend
inline constexpr const char* kScreenColour = "#b30059";
inline constexpr const char* kReleaseColour = "#cc3311";
inline constexpr const char* kZoneColour = "#117733";
inline constexpr const char* kOtherColour = "#1a1a1a";
inline constexpr const char* kChainageTitle = "Chainage s, horizontal distance along the profile [m]";

std::string soil_name(const ProfileScene& scene, SoilId soil);

/// Runs of reaches with one value: calls use(first, last + 1).
template <class Value, class Use>
void for_runs(const Profile& p, const Value& value, const Use& use) {
    for (std::size_t k = 0; k < p.reach_count();) {
        std::size_t end = k + 1;
        while (end < p.reach_count() && value(end) == value(k)) ++end;
        use(k, end);
        k = end;
    }
}

/// The keys of what the picture shows, in one row.
class Legend {
public:
    Legend(Svg& svg, double y) : svg_(svg), y_(y) {}

    void soil(const std::string& name, const std::string& colour) {
        svg_.box({{x_, y_ - 9.0}, {x_ + 22.0, y_ + 1.0}}, {.stroke = "#000000", .width = 0.6, .fill = colour});
        words_after(28.0, name);
    }
    void dashed(const std::string& name) {
        svg_.segment({x_, y_ - 4.0}, {x_ + 26.0, y_ - 4.0}, {.stroke = "#000000", .width = 1.6, .dashes = "4 3"});
        words_after(32.0, name);
    }
    void line(const std::string& name, const SvgPen& pen) {
        svg_.segment({x_, y_ - 4.0}, {x_ + 26.0, y_ - 4.0}, pen);
        words_after(32.0, name);
    }
    void dot(const std::string& name) {
        svg_.circle({x_ + 5.0, y_ - 4.0}, 4.5, {.stroke = "#ffffff", .width = 1.5, .fill = kReleaseColour});
        words_after(14.0, name);
    }

private:
    void words_after(double offset, const std::string& name) {
        svg_.text({x_ + offset, y_}, name, {});
        x_ += offset + 7.0 * static_cast<double>(name.size()) + 18.0;
    }

    Svg& svg_;
    double x_ = kLeft, y_;  // [pixel]
};

void titles(Svg& svg, const std::string& title, const std::string& facts);

/// Where the screens cut the profile, and those given by their chainage, ascending.
std::vector<std::pair<double, std::string>> screens_along(const ProfileScene& scene, const DrawnProfile& drawn);

/// Equal scales if the long profile is then at most `most` pixels high; otherwise heights are drawn smaller, by the factor `exaggeration`.
SvgPanel section_panel(const Profile& p, double top, double most, double& exaggeration);

/// Ground with its soils, releases and zones along the top, screens, starting point; the horizontal axis with its title if `titled`.
void draw_long_profile(Svg& svg, const ProfileScene& scene, const DrawnProfile& drawn, const SvgPanel& panel,
                       bool titled);

}  // namespace scree::gis
