// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/plane_scenes.hpp"

#include <cmath>
#include <numbers>

namespace scree::test {

Profile profile_of(std::span<const Vec2> corners, std::span<const SoilId> soil) {
    std::vector<Vec3> points;
    for (const Vec2& c : corners) points.emplace_back(c.x(), 0.0, c.y());
    const std::vector<SoilId> same(points.empty() ? 0 : points.size() - 1, 0);
    return make_profile(points, soil.empty() ? std::span<const SoilId>(same) : soil);
}

GroundLine inclined_line(double slope, double length, double piece) {
    std::vector<Vec2> corners;
    const int pieces = static_cast<int>(std::ceil(length / piece));
    for (int k = 0; k <= pieces; ++k) {
        const double s = std::min(k * piece, length);
        corners.emplace_back(s, -std::tan(slope) * s);
    }
    return ground_of(corners);
}

std::vector<Vec2> regular_polygon(int corners, double radius) {
    std::vector<Vec2> points;
    for (int k = 0; k < corners; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / corners - 0.5 * std::numbers::pi;
        points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return points;
}

BlockState<2> on_slope(double slope, double along, double height) {
    BlockState<2> s;
    s.orientation = -slope;
    s.position = along * Vec2(std::cos(slope), -std::sin(slope)) + height * Vec2(std::sin(slope), std::cos(slope));
    return s;
}

}  // namespace scree::test
