// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/inference/axis.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scree {

Axis::Axis(const Vec2& origin, double azimuth)
    : Axis(std::vector<Vec2>{origin, origin + Vec2(std::sin(azimuth), std::cos(azimuth))}) {}

Axis::Axis(std::vector<Vec2> line) {
    for (const Vec2& p : line) {
        if (!line_.empty() && p == line_.back()) continue;
        starts_.push_back(line_.empty() ? 0.0 : starts_.back() + (p - line_.back()).norm());
        line_.push_back(p);
    }
    SCREE_ASSERT(line_.size() >= 2);
}

AxisPlace Axis::place(const Vec2& p) const {
    AxisPlace best;
    double nearest = kInfinity;
    for (std::size_t k = 0; k + 1 < line_.size(); ++k) {
        const Vec2 span = line_[k + 1] - line_[k];
        const double length = span.norm();
        const Vec2 direction = span / length;
        double along = direction.dot(p - line_[k]);
        if (k > 0) along = std::max(along, 0.0);
        if (k + 2 < line_.size()) along = std::min(along, length);
        const Vec2 off = p - (line_[k] + along * direction);
        if (off.norm() >= nearest) continue;
        nearest = off.norm();
        const double side = cross(direction, p - line_[k]) >= 0.0 ? 1.0 : -1.0;
        best = {starts_[k] + along, side * nearest};
    }
    return best;
}

Vec2 Axis::point(double along) const {
    std::size_t k = 0;
    while (k + 2 < line_.size() && along >= starts_[k + 1]) ++k;
    return line_[k] + (along - starts_[k]) * (line_[k + 1] - line_[k]).normalized();
}

double Axis::crossing(const std::vector<Vec2>& line) const {
    double first = kNaN;
    for (std::size_t k = 0; k + 1 < line_.size(); ++k) {
        const Vec2 direction = (line_[k + 1] - line_[k]).normalized();
        const double length = starts_[k + 1] - starts_[k];
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            const Vec2 other = line[i + 1] - line[i], gap = line[i] - line_[k];
            const double turn = cross(direction, other);
            if (turn == 0.0) continue;  // parallel
            const double along = cross(gap, other) / turn, share = cross(gap, direction) / turn;
            const bool on_reach = (k == 0 || along >= 0.0) && (k + 2 == line_.size() || along <= length);
            if (!on_reach || share < 0.0 || share > 1.0) continue;
            if (!(first <= starts_[k] + along)) first = starts_[k] + along;
        }
    }
    return first;
}

}  // namespace scree
