// SPDX-License-Identifier: GPL-3.0-or-later
#include "ensemble/path_recorder.hpp"

#include "dynamics/rigid_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

namespace {

/// Distance between kept points in contact [m]; in flight points are kept every kLineTime, where the chord is off by less than 5 cm.
constexpr double kLineDistance = 0.25;
constexpr double kLineTime = 0.2;   ///< [s]
constexpr double kSpinStep = 0.01;  ///< of free rotation, at most [s]

/// Of both motions at one time: where a contact turns the one into the other, the largest of each would be more than the block ever has.
template <int Dim>
double energy_at(const MotionSegment<Dim>& m, double s) {
    return 0.5 * m.mass * velocity_at(m, s).squaredNorm() + m.rotation_energy_start +
           s * (m.rotation_energy_end - m.rotation_energy_start);
}

/// A block that turns freely is faster and slower on the way, as it tumbles: Euler's equations say how fast it is.
template <int Dim>
double spin_at(const MotionSegment<Dim>& m, double s) {
    if constexpr (Dim == 3) {
        if (m.free_moment.x() > 0.0 && s > 0.0 && s < 1.0) {
            Quat orientation = Quat::Identity();
            Vec3 spin = m.turning;
            rotate_freely(m.free_moment, kSpinStep, s * m.duration, orientation, spin);
            return spin.norm();
        }
    }
    return m.spin_start + s * (m.spin_end - m.spin_start);
}

}  // namespace

template <int Dim>
PathRecorder<Dim>::PathRecorder(const CampaignInput& input, std::int64_t block, BlockResult& result)
    : input_(input),
      block_(block),
      result_(result),
      crossed_(input.screens.size(), false),
      impact_watch_(input.impacts),
      span_speed_(input.screen_span),
      keep_(block < input.kept_trajectories) {
    line_.block = block;
}

template <int Dim>
void PathRecorder<Dim>::segment(const MotionSegment<Dim>& m) {
    // Simpson over the speed: exact to the eye for the length of a parabola's arc
    const double v0 = m.velocity_start.norm(), vm = velocity_at(m, 0.5).norm(), v1 = m.velocity_end.norm();
    result_.path_length += m.duration / 6.0 * (v0 + 4.0 * vm + v1);
    result_.largest_speed = std::max({result_.largest_speed, v0, v1});  // the square of the speed is convex in time
    result_.largest_energy = std::max({result_.largest_energy, energy_at(m, 0.0), energy_at(m, 1.0)});
    if (input_.passages) cross_cells(m);
    if (!crossed_.empty()) {
        fresh_.clear();
        cross_screens(m);
        span_speed_.segment(m, fresh_, crossings_);
    }
    impact_watch_.segment(m,
                          [&](std::int32_t number, const MotionSegment<Dim>& before, const MotionSegment<Dim>& after) {
                              impacts_.push_back({block_, number, impact_end(before, 1.0), impact_end(after, 0.0)});
                          });
    if (keep_) keep_line(m);
}

template <int Dim>
void PathRecorder<Dim>::raise_cell(std::size_t cell, const MotionSegment<Dim>& m, double from, double to) {
    if (!last_values_ || cell != last_cell_) {  // most steps stay in the cell of the one before
        last_values_ = &cells_[cell];
        last_cell_ = cell;
    }
    CellValues& values = *last_values_;
    auto raise = [&](CellQuantity quantity, double value) {
        double& v = values[static_cast<std::size_t>(quantity)];
        v = std::max(v, value);
    };
    raise(CellQuantity::KineticEnergy, std::max(energy_at(m, from), energy_at(m, to)));
    raise(CellQuantity::Speed, std::max(velocity_at(m, from).norm(), velocity_at(m, to).norm()));
    raise(CellQuantity::Spin, m.spin_most);
    raise(CellQuantity::PassingHeight, largest_height(m, from, to));
}

template <int Dim>
FilmedImpact::End PathRecorder<Dim>::impact_end(const MotionSegment<Dim>& m, double share) const {
    const Vec position = position_at(m, share);
    FilmedImpact::End end;
    end.time = m.start + share * m.duration;
    end.mass = m.mass;
    end.position = on_map(position);
    end.velocity = velocity_on_map(position, velocity_at(m, share));
    end.spin = spin_at(m, share);
    if constexpr (Dim == 2) end.s = position.x();
    return end;
}

template <int Dim>
void PathRecorder<Dim>::add_crossing(std::size_t screen, const MotionSegment<Dim>& m, double share) {
    crossed_[screen] = true;
    const double moving = m.struck ? std::round(share) : share;
    const Vec position = position_at(m, share), velocity = velocity_at(m, moving);
    ScreenCrossing c;
    c.block = block_;
    c.screen = static_cast<std::int32_t>(screen);
    c.time = m.start + share * m.duration;
    c.position = on_map(position);
    c.velocity = velocity_on_map(position, velocity);
    c.spin = spin_at(m, moving);
    c.mass = m.mass;
    c.energy = energy_at(m, moving);
    c.height = position[Dim - 1] - ground(position);
    c.measured_speed = velocity.norm();
    if constexpr (Dim == 2) c.s = position.x();
    fresh_.push_back({crossings_.size(), share});
    crossings_.push_back(c);
}

template <int Dim>
void PathRecorder<Dim>::add_crossings(std::vector<Passed>& passed, const MotionSegment<Dim>& m) {
    std::sort(passed.begin(), passed.end(), [](const Passed& a, const Passed& b) { return a.share < b.share; });
    for (const Passed& p : passed)
        if (!has_crossed(p.line)) add_crossing(screen_of(p.line), m, p.share);
}

template <int Dim>
void PathRecorder<Dim>::keep_point(const MotionSegment<Dim>& m, double share) {
    line_.points.push_back(on_map(position_at(m, share)));
    line_.times.push_back(m.start + share * m.duration);
    line_.speeds.push_back(velocity_at(m, share).norm());
    if constexpr (Dim == 2) line_.chainages.push_back(position_at(m, share).x());
}

template <int Dim>
void PathRecorder<Dim>::keep_line(const MotionSegment<Dim>& m) {
    if (line_.points.empty()) keep_point(m, 0.0);
    beyond_line_.reset();
    if (m.in_contact) {
        if ((on_map(position_at(m, 1.0)) - line_.points.back()).norm() >= kLineDistance)
            keep_point(m, 1.0);
        else
            beyond_line_ = m;
        return;
    }
    keep_point(m, 0.0);
    const int parts = std::max(1, static_cast<int>(std::ceil(m.duration / kLineTime)));
    for (int k = 1; k <= parts; ++k) keep_point(m, static_cast<double>(k) / parts);
}

template class PathRecorder<2>;
template class PathRecorder<3>;

// ---- on the map --------------------------------------------------------------------------------------------------------------------

MapRecorder::MapRecorder(const CampaignInput& input, std::int64_t block, BlockResult& result)
    : PathRecorder(input, block, result) {
    for (const Screen& screen : input.screens) {
        Box2 box;
        for (const Vec2& p : screen.line) box.add(p);
        screen_boxes_.push_back(box);
    }
}

/// True if p lies inside the cell raised last: most steps stay in it.
bool MapRecorder::inside(const Vec2& p) const {
    return (p.array() > cell_box_.min.array()).all() && (p.array() < cell_box_.max.array()).all();
}

void MapRecorder::cross_cells(const MotionSegment<3>& m) {
    const GridShape& grid = input_.result_cells;
    const Vec2 start = m.position.head<2>(), end = position_at(m, 1.0).head<2>();
    if (inside(start) && inside(end)) return raise_cell(cell_, m, 0.0, 1.0);
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
        const Vec2 middle = start + 0.5 * (s + next) * d;
        const int column = grid.column_of(middle.x()), row = grid.row_of(middle.y());
        if (grid.contains(column, row)) {
            cell_ = grid.index(column, row);
            cell_box_.min = grid.origin + grid.cell * Vec2(column, row);
            cell_box_.max = cell_box_.min + Vec2::Constant(grid.cell);
            raise_cell(cell_, m, s, next);
        }
        s = next;
    }
}

/// True if p lies inside the triangle in plan view, not on its outline.
bool MapRecorder::Below::holds(const Vec2& p) const {
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 a = corner[k].head<2>(), side = corner[(k + 1) % 3].head<2>() - a;
        if (!(side.x() * (p.y() - a.y()) - side.y() * (p.x() - a.x()) > 0.0)) return false;
    }
    return true;
}

/// Over one facet the height above it is a downward parabola in time: its largest value is at an end or at the apex. The path is followed from facet to
/// facet.
double MapRecorder::largest_height(const MotionSegment<3>& m, double from, double to) {
    const Vec2 start = m.position.head<2>();
    const Vec2 d = position_at(m, 1.0).head<2>() - start;
    double largest = 0.0;
    double s = from;
    for (int guard = 0; guard < 10000; ++guard) {
        const double probe = std::min(s + 1e-9, to);
        const auto& corner = below_.corner;
        if (!below_.holds(start + probe * d)) {
            const std::int64_t f = input_.surface->facet_at(start + probe * d);
            SoilId soil = 0;
            if (f < 0 || !input_.surface->facet(f, below_.corner, soil)) {
                below_ = {};
                break;
            }
        }
        // where the line leaves the triangle
        double exit = to;
        for (std::size_t k = 0; k < 3 && !below_.holds(start + to * d); ++k) {
            const Vec2 a = corner[k].head<2>(), b = corner[(k + 1) % 3].head<2>();
            const Vec2 inward(-(b - a).y(), (b - a).x());
            const double speed = inward.dot(d);
            if (speed >= 0.0) continue;
            const double at = inward.dot(a - start) / speed;
            if (at > probe) exit = std::min(exit, at);
        }
        // the height is a + b s + c s^2
        const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        auto rise = [&](const Vec3& way) { return normal.dot(way) / normal.z(); };
        const double a = rise(m.position - corner[0]), b = m.duration * rise(m.velocity_start),
                     c = 0.5 * m.duration * rise(m.velocity_end - m.velocity_start);
        auto height = [&](double share) { return a + share * (b + share * c); };
        largest = std::max({largest, height(s), height(exit)});
        if (c < 0.0 && -b / (2.0 * c) > s && -b / (2.0 * c) < exit) largest = std::max(largest, height(-b / (2.0 * c)));
        if (exit >= to) break;
        s = exit;
    }
    return largest;
}

void MapRecorder::cross_screens(const MotionSegment<3>& m) {
    const Vec2 start = m.position.head<2>(), end = position_at(m, 1.0).head<2>();
    Box2 box;
    box.add(start);
    box.add(end);
    std::vector<Passed> passed;
    for (std::size_t k = 0; k < screen_boxes_.size(); ++k) {
        if (has_crossed(k) || !screen_boxes_[k].overlaps(box)) continue;
        const std::vector<Vec2>& line = input_.screens[k].line;
        double first = 2.0;
        for (std::size_t i = 1; i < line.size(); ++i) {
            const Vec2 e = line[i] - line[i - 1], d = end - start, w = line[i - 1] - start;
            const double determinant = cross(d, e);
            if (determinant == 0.0) continue;
            const double s = cross(w, e) / determinant, r = cross(w, d) / determinant;
            if (s >= 0.0 && s <= 1.0 && r >= 0.0 && r <= 1.0) first = std::min(first, s);
        }
        if (first <= 1.0) passed.push_back({k, first});
    }
    add_crossings(passed, m);
}

// ---- along a profile ---------------------------------------------------------------------------------------------------------------

ProfileRecorder::ProfileRecorder(const CampaignInput& input, const ProfileTrack& track, const GroundLine& ground,
                                 std::int64_t block, BlockResult& result)
    : PathRecorder(input, block, result),
      track_(track),
      ground_(ground),
      cell_count_(cells_along(track.profile, input.cell_along)) {}

Vec3 ProfileRecorder::on_map(const Vec2& position) const {
    const Vec2 place = track_.profile.place_at(position.x());
    return {place.x(), place.y(), position.y()};
}

Vec3 ProfileRecorder::velocity_on_map(const Vec2& position, const Vec2& velocity) const {
    const Vec2 plan = velocity.x() * track_.profile.direction_at(position.x());
    return {plan.x(), plan.y(), velocity.y()};
}

void ProfileRecorder::cross_cells(const MotionSegment<2>& m) {
    const double cell = input_.cell_along, start = m.position.x() / cell, end = position_at(m, 1.0).x() / cell;
    const int direction = end >= start ? 1 : -1;
    auto cell_of = [&](double at) { return static_cast<std::int64_t>(std::floor(at)); };
    const std::int64_t last = cell_of(end);
    double share = 0.0;
    for (std::int64_t k = cell_of(start);; k += direction) {
        const double edge = static_cast<double>(direction > 0 ? k + 1 : k);
        const double next = k == last ? 1.0 : std::clamp((edge - start) / (end - start), share, 1.0);
        // beyond the rim there is no cell; the last one takes the very end of the profile
        if (k >= 0 && k < static_cast<std::int64_t>(cell_count_))
            raise_cell(static_cast<std::size_t>(k), m, share, next);
        if (k == last) break;
        share = next;
    }
}

void ProfileRecorder::cross_screens(const MotionSegment<2>& m) {
    const double start = m.position.x(), end = position_at(m, 1.0).x();
    std::vector<Passed> passed;
    for (const ProfileTrack::Mark& mark : track_.marks) {
        const auto screen = static_cast<std::size_t>(mark.screen);
        if (has_crossed(screen) || start == end || (mark.s - start) * (mark.s - end) > 0.0) continue;
        passed.push_back({screen, (mark.s - start) / (end - start)});
    }
    add_crossings(passed, m);
}

/// Over one reach the height above it is a downward parabola in time: its largest value is at an end or at the apex.
double ProfileRecorder::largest_height(const MotionSegment<2>& m, double from, double to) {
    const double start = m.position.x(), way = position_at(m, 1.0).x() - start;
    const double rise = m.duration * m.velocity_start.y(),
                 curvature = 0.5 * m.duration * (m.velocity_end.y() - m.velocity_start.y());
    auto largest_over = [&](const GroundReach& reach, double low, double high) {
        const double a = m.position.y() - reach.height(start), b = rise - reach.slope * way;
        auto height = [&](double share) { return a + share * (b + share * curvature); };
        const double largest = std::max(height(low), height(high));
        const double apex = curvature < 0.0 ? -0.5 * b / curvature : -1.0;
        return apex > low && apex < high ? std::max(largest, height(apex)) : largest;
    };
    const double s = start + from * way, t = start + to * way;
    const std::size_t first = ground_.reach_at(std::min(s, t)), last = ground_.reach_at(std::max(s, t), first);
    if (first == last) return std::max(0.0, largest_over(ground_.reach(first), from, to));
    double largest = 0.0;
    for (std::size_t k = first; k <= last; ++k) {
        const GroundReach& reach = ground_.reach(k);
        const double enters = std::clamp((reach.from - start) / way, from, to),
                     leaves = std::clamp((reach.to - start) / way, from, to);
        largest = std::max(largest, largest_over(reach, std::min(enters, leaves), std::max(enters, leaves)));
    }
    return largest;
}

}  // namespace scree
