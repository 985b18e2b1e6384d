// SPDX-License-Identifier: GPL-3.0-or-later
#include "ensemble/path_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

namespace {

/// Distance between kept points in contact [m]; in flight points are kept every kLineTime, where the chord is off by less than 5 cm.
constexpr double kLineDistance = 0.25;
constexpr double kLineTime = 0.2;  ///< [s]

/// Motion at the share s in [0, 1] of a segment.
Vec3 position_at(const MotionSegment<3>& m, double s) {
    const double t = s * m.duration;
    return m.position + t * (m.velocity_start + 0.5 * s * (m.velocity_end - m.velocity_start));
}
Vec3 velocity_at(const MotionSegment<3>& m, double s) {
    return m.velocity_start + s * (m.velocity_end - m.velocity_start);
}

double energy_at(const MotionSegment<3>& m, double mass, double s) {
    return 0.5 * mass * velocity_at(m, s).squaredNorm() + std::max(m.rotation_energy_start, m.rotation_energy_end);
}

}  // namespace

PathRecorder::PathRecorder(const CampaignInput& input, std::int64_t block, double mass, BlockResult& result)
    : input_(input),
      block_(block),
      mass_(mass),
      result_(result),
      crossed_(input.screens.size(), false),
      span_speed_(input.screen_span),
      keep_(block < input.kept_trajectories) {
    for (const Screen& screen : input.screens) {
        Box2 box;
        for (const Vec2& p : screen.line) box.add(p);
        screen_boxes_.push_back(box);
    }
    line_.block = block;
}

void PathRecorder::segment(const MotionSegment<3>& m) {
    // Simpson over the speed: exact to the eye for the length of a parabola's arc
    const double v0 = m.velocity_start.norm(), vm = velocity_at(m, 0.5).norm(), v1 = m.velocity_end.norm();
    result_.path_length += m.duration / 6.0 * (v0 + 4.0 * vm + v1);
    result_.largest_speed = std::max({result_.largest_speed, v0, v1});  // the square of the speed is convex in time
    result_.largest_energy = std::max({result_.largest_energy, energy_at(m, mass_, 0.0), energy_at(m, mass_, 1.0)});
    cross_cells(m);
    cross_screens(m);
    if (keep_) keep_line(m);
}

void PathRecorder::cross_cells(const MotionSegment<3>& m) {
    const GridShape& grid = input_.result_cells;
    const Vec2 start = m.position.head<2>(), end = position_at(m, 1.0).head<2>();
    const Vec2 d = end - start;
    // all shares of the segment at which a grid line is crossed, in order
    double s = 0.0;
    while (s < 1.0) {
        const Vec2 here = start + s * d;
        double next = 1.0;
        for (int axis = 0; axis < 2; ++axis) {
            if (d[axis] == 0.0) continue;
            const double u = (here[axis] - grid.origin[axis]) / grid.cell;
            // the next line strictly ahead: rounding must not return the one that we stand on
            double line = d[axis] > 0.0 ? std::floor(u + 1e-9) + 1.0 : std::ceil(u - 1e-9) - 1.0;
            const double at = (grid.origin[axis] + line * grid.cell - start[axis]) / d[axis];
            if (at > s) next = std::min(next, at);
        }
        enter_cell(m, start + 0.5 * (s + next) * d, s, next);
        s = next;
    }
}

void PathRecorder::enter_cell(const MotionSegment<3>& m, const Vec2& middle, double from, double to) {
    const GridShape& grid = input_.result_cells;
    const int column = grid.column_of(middle.x()), row = grid.row_of(middle.y());
    if (!grid.contains(column, row)) return;
    CellValues& values = cells_[grid.index(column, row)];
    auto raise = [&](CellQuantity quantity, double value) {
        double& v = values[static_cast<std::size_t>(quantity)];
        v = std::max(v, value);
    };
    raise(CellQuantity::KineticEnergy, std::max(energy_at(m, mass_, from), energy_at(m, mass_, to)));
    raise(CellQuantity::Speed, std::max(velocity_at(m, from).norm(), velocity_at(m, to).norm()));
    raise(CellQuantity::Spin, std::max(m.spin_start, m.spin_end));
    raise(CellQuantity::PassingHeight, largest_height(m, from, to));
}

/// Over one facet the height above it is a downward parabola in time: its largest value is at an end or at the apex. The path is followed from facet to
/// facet.
double PathRecorder::largest_height(const MotionSegment<3>& m, double from, double to) const {
    const Vec2 start = m.position.head<2>();
    const Vec2 d = position_at(m, 1.0).head<2>() - start;
    double largest = 0.0;
    double s = from;
    for (int guard = 0; guard < 10000; ++guard) {
        const double probe = std::min(s + 1e-9, to);
        const std::int64_t f = input_.surface->facet_at(start + probe * d);
        std::array<Vec3, 3> corner;
        SoilId soil = 0;
        if (f < 0 || !input_.surface->facet(f, corner, soil)) break;
        // where the line leaves the triangle
        double exit = to;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2 a = corner[k].head<2>(), b = corner[(k + 1) % 3].head<2>();
            const Vec2 inward(-(b - a).y(), (b - a).x());
            const double speed = inward.dot(d);
            if (speed >= 0.0) continue;
            const double at = inward.dot(a - start) / speed;
            if (at > probe) exit = std::min(exit, at);
        }
        const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        auto height = [&](double share) {
            const Vec3 p = position_at(m, share);
            return normal.dot(p - corner[0]) / normal.z();
        };
        largest = std::max({largest, height(s), height(exit)});
        // apex of a + b s + c s^2
        const double h0 = height(0.0), h1 = height(1.0), hm = height(0.5);
        const double c = 2.0 * (h0 + h1 - 2.0 * hm), b = h1 - h0 - c;
        if (c < 0.0 && -b / (2.0 * c) > s && -b / (2.0 * c) < exit) largest = std::max(largest, height(-b / (2.0 * c)));
        if (exit >= to) break;
        s = exit;
    }
    return largest;
}

void PathRecorder::cross_screens(const MotionSegment<3>& m) {
    if (screen_boxes_.empty()) return;
    fresh_.clear();
    const Vec2 start = m.position.head<2>(), end = position_at(m, 1.0).head<2>();
    Box2 box;
    box.add(start);
    box.add(end);
    for (std::size_t k = 0; k < screen_boxes_.size(); ++k) {
        if (crossed_[k] || !screen_boxes_[k].overlaps(box)) continue;
        const std::vector<Vec2>& line = input_.screens[k].line;
        double first = 2.0;
        for (std::size_t i = 1; i < line.size(); ++i) {
            const Vec2 e = line[i] - line[i - 1], d = end - start, w = line[i - 1] - start;
            const double determinant = d.x() * e.y() - d.y() * e.x();
            if (determinant == 0.0) continue;
            const double s = (w.x() * e.y() - w.y() * e.x()) / determinant,
                         r = (w.x() * d.y() - w.y() * d.x()) / determinant;
            if (s >= 0.0 && s <= 1.0 && r >= 0.0 && r <= 1.0) first = std::min(first, s);
        }
        if (first > 1.0) continue;
        crossed_[k] = true;
        ScreenCrossing c;
        c.block = block_;
        c.screen = static_cast<std::int32_t>(k);
        c.time = m.start + first * m.duration;
        c.position = position_at(m, first);
        c.velocity = velocity_at(m, first);
        c.spin = m.spin_start + first * (m.spin_end - m.spin_start);
        c.energy = 0.5 * mass_ * c.velocity.squaredNorm() + m.rotation_energy_start +
                   first * (m.rotation_energy_end - m.rotation_energy_start);
        c.height = c.position.z() - input_.surface->height(c.position.head<2>());
        c.measured_speed = c.velocity.norm();
        fresh_.push_back({crossings_.size(), first});
        crossings_.push_back(c);
    }
    span_speed_.segment(m, fresh_, crossings_);
}

void PathRecorder::keep_line(const MotionSegment<3>& m) {
    auto keep = [&](double s) {
        line_.points.push_back(position_at(m, s));
        line_.times.push_back(m.start + s * m.duration);
        line_.speeds.push_back(velocity_at(m, s).norm());
    };
    if (line_.points.empty()) keep(0.0);
    if (m.in_contact) {
        if ((position_at(m, 1.0) - line_.points.back()).norm() >= kLineDistance) keep(1.0);
        return;
    }
    keep(0.0);
    const int parts = std::max(1, static_cast<int>(std::ceil(m.duration / kLineTime)));
    for (int k = 1; k <= parts; ++k) keep(static_cast<double>(k) / parts);
}

}  // namespace scree
