// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/profile_trace.hpp"

#include "geometry/direction_surface.hpp"
#include "geometry/facet_walk.hpp"

#include "scree/base/assert.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace scree {

namespace {

/// A place on the line, with the reach that leads to it.
struct LinePoint {
    Vec2 at = Vec2::Zero();  // [m]
    double z = 0.0;          // height of the terrain [m]
    SoilId soil = 0;
    Course course = Course::Steepest;
};

/// A piece of a line: tried first, and kept if it leads on.
struct Leg {
    enum class End { Going, SteepGround, Stuck, Blocked, TooLong, Edge, Arrived };
    std::vector<LinePoint> points;  // without the one that it starts from
    Spot spot;                      // where it has got to
    double length = 0.0;            // [m]
    End end = End::Going;

    void go(const Spot& to, double z, SoilId soil, Course course) {
        length += (to.at - spot.at).norm();
        points.push_back({to.at, z, soil, course});
        spot = to;
    }
};

/// Unit direction from b to a, or none if they are at the same place.
std::optional<Vec2> direction_between(const Vec2& a, const Vec2& b) {
    const double distance = (b - a).norm();
    if (distance < kWalkSnap) return std::nullopt;
    return Vec2((b - a) / distance);
}

/// A line in plan as a profile without heights: its chainages and nearest points.
Profile plan_line(std::span<const Vec2> line) {
    std::vector<Vec3> points;
    for (const Vec2& p : line) points.emplace_back(p.x(), p.y(), 0.0);
    return make_profile(points, std::vector<SoilId>(points.empty() ? 0 : points.size() - 1, 0));
}

}  // namespace

class ProfileTracer::Implementation {
public:
    Implementation(const Surface& surface, const ProfileSettings& settings)
        : walk_(surface),
          levels_(surface, settings.smoothing),
          settings_(settings),
          steep_(std::tan(settings.gentle_slope)) {}

    ProfileTrace steepest(const Vec2& start, const Region* releases);
    ProfileTrace guided(std::span<const Vec2> guide, const Region* releases);
    ProfileTrace along(std::span<const Vec2> line);

private:
    // --- the whole line ---
    void begin(const Vec2& start);
    void descend();
    bool cross_gentle_ground();
    void keep(const Leg& leg);
    void leave_guide(bool arrived = false);
    Vec2 heading() const;
    std::vector<LinePoint> head(const Region* releases);
    ProfileTrace finish(const std::vector<LinePoint>& head) const;

    // --- legs ---
    using Heading = std::function<std::optional<Vec2>(const Spot&)>;
    struct Limits {
        double length = kInfinity;  // [m]
        double rise = kInfinity;    // [m]
        bool to_steep_ground = false;
    };
    Leg leg_from(const Spot& spot) const {
        Leg leg;
        leg.spot = spot;
        return leg;
    }
    Leg straight(const Spot& from, const Heading& heading, Course course, const Limits& limits);
    Leg straight(const Spot& from, const Vec2& direction, const Limits& limits) {
        return straight(
            from, [direction](const Spot&) { return direction; }, Course::Straight, limits);
    }
    Leg towards(const Spot& from, const Vec2& target, Course course, double rise);
    Leg follow_gentle_ground(const Spot& from);
    bool steep_onwards(const Spot& spot, const Vec2& direction);
    ProfileEnd edge_reason(const Spot& spot) { return walk_.on_outer_rim(spot) ? ProfileEnd::Rim : ProfileEnd::NoData; }

    FacetWalk walk_;
    DirectionSurface levels_;
    ProfileSettings settings_;
    double steep_;  // [-] least fall of steep ground

    std::vector<LinePoint> points_;
    Spot spot_;
    double length_ = 0.0;  // [m]
    ProfileEnd end_ = ProfileEnd::Flat;
    Profile guide_;  // empty: none, or left behind
};

// --- legs ---

/// Straight on from facet to facet; `heading` says whereto, anew at every edge, and says nothing when it is there.
Leg ProfileTracer::Implementation::straight(const Spot& from, const Heading& heading, Course course,
                                            const Limits& limits) {
    Leg leg = leg_from(from);
    const bool watches_level = limits.to_steep_ground || limits.rise < kInfinity;
    const double top = watches_level ? level_at(walk_, levels_, from) : 0.0;
    double level = top, lowest = top;
    while (leg.end == Leg::End::Going) {
        const std::optional<Vec2> direction = heading(leg.spot);
        if (!direction) {
            leg.end = Leg::End::Arrived;
        } else if (limits.to_steep_ground && level < top && steep_onwards(leg.spot, *direction)) {
            leg.end = Leg::End::SteepGround;
        } else if (const std::optional<FacetWalk::Step> step = walk_.step(leg.spot, *direction); !step) {
            leg.end = Leg::End::Edge;
        } else {
            const double length = (step->to.at - leg.spot.at).norm(), left = limits.length - leg.length;
            const bool stops = length > left;
            const Spot to =
                stops ? spot_in(step->through, leg.spot.at + left / length * (step->to.at - leg.spot.at)) : step->to;
            leg.go(to, walk_.height(to), step->through.soil, course);
            if (watches_level) level = level_at(walk_, levels_, to);
            lowest = std::min(lowest, level);
            if (stops) leg.end = Leg::End::TooLong;
            if (level - lowest > limits.rise) leg.end = Leg::End::Blocked;
        }
    }
    return leg;
}

/// Straight to a place, which becomes a vertex.
Leg ProfileTracer::Implementation::towards(const Spot& from, const Vec2& target, Course course, double rise) {
    const Limits limits{(target - from.at).norm(), rise, false};
    const Heading heading = [&](const Spot& spot) { return direction_between(spot.at, target); };
    Leg leg = straight(from, heading, course, limits);
    if (leg.end == Leg::End::TooLong) leg.end = Leg::End::Arrived;
    return leg;
}

/// Down the steepest line of gentle ground, out of pits by their lowest way, until the ground is steep.
Leg ProfileTracer::Implementation::follow_gentle_ground(const Spot& from) {
    Leg leg = leg_from(from);
    for (;;) {
        if (leg.length >= settings_.longest_crossing) leg.end = Leg::End::TooLong;
        const Descent descent = steepest_descent(walk_, levels_, leg.spot);
        if (descent.state == Descent::State::Edge) leg.end = Leg::End::Edge;
        if (descent.state == Descent::State::Goes && descent.rate >= steep_) leg.end = Leg::End::SteepGround;
        if (leg.end != Leg::End::Going) return leg;
        if (descent.state == Descent::State::Goes) {
            leg.go(descent.to, walk_.height(descent.to), descent.soil, Course::Steepest);
            continue;
        }
        const std::optional<Vec3> exit =
            lowest_way_out(walk_, levels_, leg.spot, settings_.highest_rise, settings_.longest_crossing - leg.length);
        Leg out;
        if (exit) out = towards(leg.spot, exit->head<2>(), Course::Straight, settings_.highest_rise);
        if (out.end != Leg::End::Arrived) {
            leg.end = Leg::End::Stuck;
            return leg;
        }
        leg.points.insert(leg.points.end(), out.points.begin(), out.points.end());
        leg.length += out.length;
        leg.spot = out.spot;
    }
}

bool ProfileTracer::Implementation::steep_onwards(const Spot& spot, const Vec2& direction) {
    const Descent descent = steepest_descent(walk_, levels_, spot);
    return descent.state == Descent::State::Goes && descent.rate >= steep_ && descent.direction.dot(direction) > 0.0;
}

// --- the whole line ---

void ProfileTracer::Implementation::begin(const Vec2& start) {
    const bool on_terrain = find_spot(walk_.surface(), start, spot_);
    SCREE_ASSERT(on_terrain);
    static_cast<void>(on_terrain);
    points_.assign(1, LinePoint{spot_.at, walk_.height(spot_), 0, Course::Steepest});
    length_ = 0.0;
    end_ = ProfileEnd::Flat;
    guide_ = {};
    levels_.set_guide(nullptr, settings_.guide_width);
}

void ProfileTracer::Implementation::keep(const Leg& leg) {
    points_.insert(points_.end(), leg.points.begin(), leg.points.end());
    spot_ = leg.spot;
    length_ += leg.length;
}

/// Direction of the line's last `memory` metres; zero if it has hardly begun.
Vec2 ProfileTracer::Implementation::heading() const {
    double length = 0.0;
    std::size_t k = points_.size() - 1;
    Vec2 from = points_[k].at;
    while (k > 0 && length < settings_.memory) {
        --k;
        const double reach = (points_[k].at - points_[k + 1].at).norm();
        const double share = std::min(1.0, (settings_.memory - length) / reach);
        from = points_[k + 1].at + share * (points_[k].at - points_[k + 1].at);
        length += reach;
    }
    return direction_between(from, spot_.at).value_or(Vec2::Zero());
}

/// The guide ends where the nearest of its points is its last one.
void ProfileTracer::Implementation::leave_guide(bool arrived) {
    if (guide_.empty()) return;
    if (!arrived && guide_.nearest(spot_.at).s < guide_.length() - kWalkSnap) return;
    guide_ = {};
    levels_.set_guide(nullptr, settings_.guide_width);
}

/// Rules 2 to 4 of the settings. False if the profile ends here.
bool ProfileTracer::Implementation::cross_gentle_ground() {
    if (!guide_.empty()) {
        Limits limits;
        limits.length = settings_.longest;
        limits.to_steep_ground = true;
        const Heading along_guide = [&](const Spot& spot) -> std::optional<Vec2> {
            const double s = guide_.nearest(spot.at).s;
            if (s >= guide_.length() - kWalkSnap) return std::nullopt;
            const double ahead = std::min(s + settings_.guide_width, guide_.length());
            return direction_between(spot.at, guide_.place_at(ahead));
        };
        const Leg leg = straight(spot_, along_guide, Course::Straight, limits);
        keep(leg);
        if (leg.end == Leg::End::Arrived) leave_guide(true);
        if (leg.end == Leg::End::Edge) end_ = edge_reason(spot_);
        return leg.end != Leg::End::Edge;
    }

    Vec2 direction = heading();
    Leg ahead;
    Limits limits{settings_.longest_crossing, settings_.highest_rise, true};
    if (!direction.isZero()) {
        ahead = straight(spot_, direction, limits);
        if (ahead.end == Leg::End::SteepGround) {
            keep(ahead);
            return true;
        }
    }
    if (direction.isZero() || ahead.end == Leg::End::Blocked) {
        const Leg aside = follow_gentle_ground(spot_);
        if (aside.end == Leg::End::SteepGround) {
            keep(aside);
            return true;
        }
        if (direction.isZero()) {
            // the line began on gentle ground: what there is of a steepest line is the slope above
            keep(aside);
            end_ = aside.end == Leg::End::Edge ? edge_reason(spot_) : ProfileEnd::Flat;
            direction = heading();
            if (aside.end != Leg::End::Stuck || direction.isZero()) return false;
            ahead = straight(spot_, direction, limits);
            if (ahead.end == Leg::End::SteepGround) {
                keep(ahead);
                return true;
            }
        }
    }
    keep(ahead);
    end_ = ahead.end == Leg::End::Edge      ? edge_reason(spot_)
           : ahead.end == Leg::End::Blocked ? ProfileEnd::Pit
                                            : ProfileEnd::Flat;
    if (end_ == ProfileEnd::Pit) keep(straight(spot_, direction, {settings_.run_up, kInfinity, false}));
    return false;
}

void ProfileTracer::Implementation::descend() {
    while (length_ < settings_.longest) {
        leave_guide();
        const Descent descent = steepest_descent(walk_, levels_, spot_);
        if (descent.state == Descent::State::Edge) {
            end_ = edge_reason(spot_);
            return;
        }
        if (descent.state == Descent::State::Goes && descent.rate >= steep_) {
            Leg leg = leg_from(spot_);
            leg.go(descent.to, walk_.height(descent.to), descent.soil, Course::Steepest);
            keep(leg);
        } else if (!cross_gentle_ground()) {
            break;
        }
    }
    if (length_ < settings_.longest) return;
    // cut where the length is reached
    end_ = ProfileEnd::LengthLimit;
    while (points_.size() > 2) {
        const double reach = (points_.back().at - points_[points_.size() - 2].at).norm();
        if (length_ - reach < settings_.longest) break;
        length_ -= reach;
        points_.pop_back();
    }
    const LinePoint& from = points_[points_.size() - 2];
    LinePoint& to = points_.back();
    const double share = std::max(0.0, length_ - settings_.longest) / (to.at - from.at).norm();
    to.at -= share * (to.at - from.at);
    to.z -= share * (to.z - from.z);
}

/// Rule 5: ground behind the starting point, from there upwards.
std::vector<LinePoint> ProfileTracer::Implementation::head(const Region* releases) {
    if (points_.size() < 2) return {};
    const Vec2 start = points_.front().at;
    Leg leg;
    find_spot(walk_.surface(), start, leg.spot);
    const double step = 0.1 * std::max(settings_.head, 1.0);  // areas are left to within this [m]
    const auto released = [&](const Vec2& p) { return releases && releases->contains(p); };
    for (;;) {
        while (released(leg.spot.at) && leg.length < settings_.longest) {
            const Descent ascent = steepest_descent(walk_, levels_, leg.spot, -1.0);
            if (ascent.state != Descent::State::Goes || ascent.rate < steep_) break;
            leg.go(ascent.to, walk_.height(ascent.to), ascent.soil, Course::Steepest);
        }
        // straight on: away from where the line goes first, over the length that the head has, or will have
        Vec2 below = start;
        double length = 0.0;
        for (std::size_t k = 1; k < points_.size() && length < std::max(leg.length, settings_.head); ++k) {
            below = points_[k].at;
            length += (points_[k].at - points_[k - 1].at).norm();
        }
        const std::optional<Vec2> direction = direction_between(below, leg.spot.at);
        if (!direction) return leg.points;
        double left = 0.0;
        while (left < settings_.longest_crossing && released(leg.spot.at + left * *direction)) left += step;
        double next = left;  // to another area, or to the other side of a hole
        while (next < left + settings_.head && !released(leg.spot.at + next * *direction)) next += step;
        const bool ends = next >= left + settings_.head || leg.length >= settings_.longest;
        const Leg more = straight(leg.spot, *direction, {ends ? left + settings_.head : next, kInfinity, false});
        leg.points.insert(leg.points.end(), more.points.begin(), more.points.end());
        leg.length += more.length;
        leg.spot = more.spot;
        if (ends || more.end == Leg::End::Edge) return leg.points;
    }
}

/// The line with the terrain's heights.
ProfileTrace ProfileTracer::Implementation::finish(const std::vector<LinePoint>& head) const {
    ProfileTrace trace;
    trace.end = end_;
    // the head was led upwards: the reach that leads to a point of it leads, downwards, to the one before
    std::vector<LinePoint> line;
    for (std::size_t k = head.size(); k > 0; --k) {
        line.push_back(head[k - 1]);
        if (k < head.size()) {
            line.back().soil = head[k].soil;
            line.back().course = head[k].course;
        }
    }
    line.insert(line.end(), points_.begin(), points_.end());
    if (!head.empty()) {
        line[head.size()].soil = head.front().soil;
        line[head.size()].course = head.front().course;
    }
    std::vector<Vec3> points;
    std::vector<SoilId> soil;
    std::size_t start = 0;
    for (std::size_t k = 0; k < line.size(); ++k) {
        const LinePoint& p = line[k];
        // as make_profile() does, to keep the courses in step
        if (points.empty() || (p.at - points.back().head<2>()).norm() >= kShortestReach) {
            if (!points.empty()) {
                soil.push_back(p.soil);
                trace.course.push_back(p.course);
            }
            points.emplace_back(p.at.x(), p.at.y(), p.z);
        }
        if (k == head.size()) start = points.size() - 1;
    }
    trace.profile = make_profile(points, soil);
    if (trace.profile.empty())
        trace.course.clear();
    else
        trace.start = trace.profile.s[start];
    SCREE_ASSERT(trace.course.size() == trace.profile.reach_count());
    return trace;
}

ProfileTrace ProfileTracer::Implementation::steepest(const Vec2& start, const Region* releases) {
    begin(start);
    descend();
    return finish(head(releases));
}

ProfileTrace ProfileTracer::Implementation::guided(std::span<const Vec2> guide, const Region* releases) {
    SCREE_ASSERT(!guide.empty());
    begin(guide.front());
    guide_ = plan_line(guide);
    if (!guide_.empty()) levels_.set_guide(&guide_, settings_.guide_width);
    descend();
    return finish(head(releases));
}

ProfileTrace ProfileTracer::Implementation::along(std::span<const Vec2> line) {
    SCREE_ASSERT(!line.empty());
    begin(line.front());
    end_ = ProfileEnd::LineEnd;
    for (std::size_t k = 1; k < line.size(); ++k) {
        const Leg leg = towards(spot_, line[k], Course::Given, kInfinity);
        keep(leg);
        if (leg.end != Leg::End::Edge) continue;
        end_ = edge_reason(spot_);
        break;
    }
    return finish({});
}

ProfileTracer::ProfileTracer(const Surface& surface, const ProfileSettings& settings)
    : implementation_(std::make_unique<Implementation>(surface, settings)) {}
ProfileTracer::~ProfileTracer() = default;
ProfileTrace ProfileTracer::steepest(const Vec2& start, const Region* releases) {
    return implementation_->steepest(start, releases);
}
ProfileTrace ProfileTracer::guided(std::span<const Vec2> guide, const Region* releases) {
    return implementation_->guided(guide, releases);
}
ProfileTrace ProfileTracer::along(std::span<const Vec2> line) {
    return implementation_->along(line);
}

}  // namespace scree
