// SPDX-License-Identifier: GPL-3.0-or-later
#include "dynamics/plane_contacts.hpp"

#include "dynamics/arrival.hpp"
#include "dynamics/contact_lengths.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// How far ahead the line is laid, and how much of it must be left to use it again [s].
constexpr double kHorizon = 0.12, kLeastHorizon = 0.08;

/// The vector turned by a right angle, from x to z.
Vec2 perpendicular(const Vec2& a) {
    return {-a.y(), a.x()};
}
/// Along a reach with this normal, towards larger chainages.
Vec2 tangent(const Vec2& normal) {
    return {normal.y(), -normal.x()};
}

}  // namespace

PlaneContacts::PlaneContacts(const ConvexPolygon& block, const GroundLine& ground, bool vertices_only,
                             bool waits_for_all)
    : block_(block),
      ground_(ground),
      vertices_only_(vertices_only),
      least_passed_by_(waits_for_all ? -kInfinity : std::min(kPassedBy, kPassedByShare * block.inner_radius)) {}

bool PlaneContacts::buried(const Vec2& position) const {
    return ground_.contains(position.x()) &&
           ground_.reach(ground_.reach_at(position.x(), below_)).gap(position) < -block_.inner_radius;
}

void PlaneContacts::cover(double s, double reach) {
    const double half = block_.radius + reach;
    if (s - half >= from_ && s + half <= to_) return;
    const double margin = std::max(0.5 * block_.radius, 0.1);  // enough for many steps, little to lay
    from_ = s - half - margin;
    to_ = s + half + margin;
    line_ = ground_.supporting_line(from_, to_);
    below_ = ground_.reach_at(s);
    crests_.clear();
    for (std::size_t k = ground_.reach_at(from_) + 1; k < ground_.reach_count() && ground_.reach(k).from <= to_; ++k)
        if (ground_.is_crest(k)) crests_.push_back({ground_.corner(k), k, line_.height(ground_.corner(k)), -kInfinity});
}

/// Heights of a convex polygon's corners fall to the lowest and rise again: downhill from the one that was lowest last.
Eigen::Index PlaneContacts::lowest_vertex(const Vec2& direction) {
    const Eigen::Index count = block_.vertex_count();
    Eigen::Index best = lowest_;
    double least = direction.dot(block_.vertex(best));
    for (const Eigen::Index step : {Eigen::Index{1}, count - 1}) {
        for (Eigen::Index turns = 0; turns < count; ++turns) {
            const Eigen::Index next = best + step < count ? best + step : best + step - count;
            const double height = direction.dot(block_.vertex(next));
            if (!(height < least)) break;
            least = height;
            best = next;
        }
    }
    lowest_ = best;
    return best;
}

// Between the underside and the ground the difference is linear between corners of either.
double PlaneContacts::sunk(const Vec2& position, const Mat2& rotation) const {
    double most = -kInfinity;
    const Eigen::Index count = block_.vertex_count();
    for (Eigen::Index k = 0; k < count; ++k) {
        const Vec2 a = position + rotation * block_.vertex(k), b = position + rotation * block_.vertex((k + 1) % count);
        if (ground_.contains(a.x())) most = std::max(most, ground_.height(a.x()) - a.y());
        if (!(a.x() < b.x())) continue;  // an upper side
        for (std::size_t c = ground_.reach_at(a.x()) + 1; c < ground_.reach_count() && ground_.corner(c).x() < b.x();
             ++c) {
            const Vec2 corner = ground_.corner(c);
            most = std::max(most, corner.y() - a.y() - (corner.x() - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
        }
    }
    return most;
}

// ---- contacts ----------------------------------------------------------------------------------------------------------------------

void PlaneContacts::detect(const Vec2& position, const Mat2& rotation, double reach,
                           std::vector<Contact<2>>& contacts) {
    contacts.clear();
    beyond_rim_ = false;
    cut_ = 0.0;
    cover(position.x(), reach);
    const double centre = line_.height(position);
    if (centre - block_.radius > reach) return;
    const Vec2 direction = rotation.transpose() * line_.normal;
    const double lowest = centre + direction.dot(block_.vertex(lowest_vertex(direction)));
    if (lowest > reach) return;
    advance_odometer(position, rotation);
    add_vertex_contacts(position, rotation, direction, centre, reach, contacts);
    if (!vertices_only_) add_crest_contacts(position, rotation, lowest, reach, contacts);
}

// No point of the body moves farther than the centre of mass plus radius times the norm of the change of rotation.
void PlaneContacts::advance_odometer(const Vec2& position, const Mat2& rotation) {
    odometer_ += (position - last_position_).norm() + block_.radius * (rotation - last_rotation_).norm();
    last_position_ = position;
    last_rotation_ = rotation;
}

/// Those that reach down to the line of the neighbourhood are neighbours of the lowest one.
void PlaneContacts::add_vertex_contacts(const Vec2& position, const Mat2& rotation, const Vec2& direction,
                                        double centre, double reach, std::vector<Contact<2>>& contacts) {
    const Eigen::Index count = block_.vertex_count();
    auto near = [&](Eigen::Index i) { return centre + direction.dot(block_.vertex(i)) <= reach; };
    Eigen::Index first = lowest_, number = 1;
    for (Eigen::Index i = first; number < count; ++number) {
        i = i > 0 ? i - 1 : count - 1;
        if (!near(i)) break;
        first = i;
    }
    for (Eigen::Index i = first, k = 0; k < count; ++k) {
        if (k >= number && !near(i)) break;
        add_vertex_contact(position, rotation, i, reach, contacts);
        i = i + 1 < count ? i + 1 : 0;
    }
}

void PlaneContacts::add_vertex_contact(const Vec2& position, const Mat2& rotation, Eigen::Index vertex, double reach,
                                       std::vector<Contact<2>>& contacts) {
    Contact<2> contact;
    contact.arm = rotation * block_.vertex(vertex);
    const Vec2 p = position + contact.arm;
    if (!ground_.contains(p.x())) {
        beyond_rim_ = beyond_rim_ || hangs_beside(p);
        return;
    }
    below_ = ground_.reach_at(p.x(), below_);
    const std::size_t touched = nearest_surface(p, below_);
    const GroundReach& below = ground_.reach(touched);
    contact.gap = below.gap(p);
    contact.normal = below.normal;
    contact.soil = below.soil;
    contact.motion = ContactMotion::TurnsWithBlock;
    contact.key = {FeaturePair::VertexOnFacet, static_cast<std::int64_t>(vertex), static_cast<std::int64_t>(touched)};
    const auto first = static_cast<std::ptrdiff_t>(contacts.size());
    if (contact.gap <= reach) contacts.push_back(contact);
    if (touched != below_) return;
    // In a valley it can touch reaches on both sides. The neighbour counts if its line passes below the ground at p (a valley: the ground is the upper of
    // the lines); across a crest it passes above and must not count.
    auto add_other = [&](std::size_t other) {
        const GroundReach& r = ground_.reach(other);
        if (r.height(p.x()) > below.height(p.x()) || r.gap(p) > reach || 1.0 - r.normal.dot(below.normal) < kSamePlane)
            return;
        if (std::any_of(contacts.begin() + first, contacts.end(),
                        [&](const Contact<2>& c) { return 1.0 - c.normal.dot(r.normal) < kSamePlane; }))
            return;
        contact.gap = r.gap(p);
        contact.normal = r.normal;
        contact.soil = r.soil;
        contact.key.terrain = static_cast<std::int64_t>(other);
        contacts.push_back(contact);
    };
    for (std::size_t k = below_; k > 0 && ground_.reach(k).from > p.x() - kValleyMargin; --k) add_other(k - 1);
    for (std::size_t k = below_ + 1; k < ground_.reach_count() && ground_.reach(k).from < p.x() + kValleyMargin; ++k)
        add_other(k);
}

/// The reach below a corner; but a corner that is deep under the top of a cliff and has hardly entered its face touches the face.
std::size_t PlaneContacts::nearest_surface(const Vec2& p, std::size_t below) const {
    double least_deep = ground_.reach(below).gap(p);
    if (least_deep > -kValleyMargin) return below;
    std::size_t nearest = below;
    auto look_at = [&](std::size_t k) {
        const GroundReach& r = ground_.reach(k);
        const double along = tangent(r.normal).dot(p - ground_.corner(k)), gap = r.gap(p);
        if (gap <= least_deep || gap > 0.0 || along < 0.0 || along * r.normal.y() > r.to - r.from) return;
        least_deep = gap;
        nearest = k;
    };
    for (std::size_t k = below; k > 0 && ground_.reach(k).from > p.x() - kValleyMargin; --k) look_at(k - 1);
    for (std::size_t k = below + 1; k < ground_.reach_count() && ground_.reach(k).from < p.x() + kValleyMargin; ++k)
        look_at(k);
    return nearest;
}

bool PlaneContacts::hangs_beside(const Vec2& p) const {
    return ground_.reach(p.x() < 0.0 ? 0 : ground_.reach_count() - 1).gap(p) < 0.0;
}

// A crest touches the side that it is least deep in, if the ground falls away from that side's line on both sides; else a corner touches nearer.
void PlaneContacts::add_crest_contacts(const Vec2& position, const Mat2& rotation, double lowest, double reach,
                                       std::vector<Contact<2>>& contacts) {
    const double far = block_.radius + reach;
    for (NearCrest& crest : crests_) {
        if (crest.height < lowest - reach) continue;         // the block does not reach down there
        if (odometer_ + reach < crest.free_until) continue;  // it was farther away than the block has moved since
        const Vec2 arm = crest.point - position;
        const double distance = arm.norm();
        const bool above = arm.y() > 0.0 && std::abs(arm.x()) < block_.radius;
        if (distance > far && !above) {
            crest.free_until = odometer_ + (distance - block_.radius) * kOdometerShare;
            continue;
        }
        const SideAt at = side_at(rotation.transpose() * arm);
        const Vec2 normal = -(rotation * block_.normal(at.side));
        const bool under_block = normal.y() >= 0.0;
        if (at.outside > reach && under_block) {
            crest.free_until = odometer_ + at.outside * kOdometerShare;
            continue;
        }
        cut_ = std::max(cut_, -at.outside);
        if (at.outside <= reach && falls_away(crest, normal)) {
            add_crest_contact(crest, at.outside, normal, arm, contacts);
            contacts.back().motion = ContactMotion::PassesBlock;
        } else if (at.outside < 0.0 || (!under_block && stands_through(arm, rotation)))
            add_cut_corner(crest, at.outside, position, rotation, contacts);
    }
}

/// True if the point at this arm, outside the block, lies above its underside: what stands below it goes through the block.
bool PlaneContacts::stands_through(const Vec2& arm, const Mat2& rotation) const {
    for (Eigen::Index k = 0; k < block_.vertex_count(); ++k) {
        const Vec2 a = rotation * block_.vertex(k), b = rotation * block_.vertex((k + 1) % block_.vertex_count());
        if (!(a.x() <= arm.x() && arm.x() < b.x())) continue;
        return (b - a).dot(perpendicular(arm - a)) < 0.0;
    }
    return false;
}

PlaneContacts::SideAt PlaneContacts::side_at(const Vec2& in_body) const {
    SideAt at{0, -kInfinity};
    for (Eigen::Index k = 0; k < block_.vertex_count(); ++k) {
        const double outside = block_.nx[k] * in_body.x() + block_.nz[k] * in_body.y() - block_.offset[k];
        if (outside > at.outside) at = {k, outside};
    }
    return at;
}

/// True if the ground on both sides of the crest falls away from the line through it with this normal, but for the slack.
bool PlaneContacts::falls_away(const NearCrest& crest, const Vec2& normal) const {
    return normal.dot(tangent(ground_.reach(crest.after).normal)) <= kConeSlack &&
           -normal.dot(tangent(ground_.reach(crest.after - 1).normal)) <= kConeSlack;
}

void PlaneContacts::add_crest_contact(const NearCrest& crest, double gap, const Vec2& normal, const Vec2& arm,
                                      std::vector<Contact<2>>& contacts) const {
    const GroundReach &before = ground_.reach(crest.after - 1), &after = ground_.reach(crest.after);
    Contact<2> contact;
    contact.gap = gap;
    contact.normal = normal;
    contact.arm = arm;
    contact.soil = normal.dot(before.normal) >= normal.dot(after.normal) ? before.soil : after.soil;
    contact.key = {FeaturePair::NodeInFace, 0, static_cast<std::int64_t>(crest.after)};
    contacts.push_back(contact);
}

// A crest that has cut into a corner of the block may be nearest to a side that it did not come through. What the ground can push along are the
// directions between the normals of the crest's reaches: the contact is the one among them in which the way out is shortest. That is a side of the block,
// or an end of the range, where a corner of the block touches a reach: found as such, unless
//   it has slipped over the crest and hooks under it: the crest is then deeper in the block than what contacts are left with;
//   the crest is a needle through the block, outside of it: its way out is that of the lowest corner, which has come out behind.
void PlaneContacts::add_cut_corner(const NearCrest& crest, double outside, const Vec2& position, const Mat2& rotation,
                                   std::vector<Contact<2>>& contacts) {
    Vec2 arm = crest.point - position;
    const Vec2 in_body = rotation.transpose() * arm;
    double way = kInfinity;
    Vec2 normal = Vec2::Zero();
    for (Eigen::Index k = 0; k < block_.vertex_count(); ++k) {
        const double depth = block_.offset[k] - block_.normal(k).dot(in_body);
        const Vec2 n = -(rotation * block_.normal(k));
        if (depth >= way || !falls_away(crest, n)) continue;
        way = depth;
        normal = n;
    }
    for (const std::size_t k : {crest.after - 1, crest.after}) {
        const Vec2& n = ground_.reach(k).normal;
        const Vec2 direction = rotation.transpose() * n, lowest = block_.vertex(lowest_vertex(direction));
        const double along = outside < 0.0 ? way_out(in_body, direction) : direction.dot(in_body - lowest);
        if (along >= way) continue;
        if (outside < 0.0) {
            if (-outside <= kHooked) return;
        } else {
            arm = rotation * lowest;
            const bool known = std::any_of(contacts.begin(), contacts.end(), [&](const Contact<2>& c) {
                return c.arm == arm && 1.0 - c.normal.dot(n) < kSamePlane;
            });
            if (along < 0.0 || known) return;
        }
        way = along;
        normal = n;
    }
    if (std::isinf(way)) return;
    cut_ = std::max(cut_, way);
    add_crest_contact(crest, -way, normal, arm, contacts);
}

/// How far the block must go along n until a point of it, body frame, is on its surface; negative if it is out already.
double PlaneContacts::way_out(const Vec2& p, const Vec2& n) const {
    double way = kInfinity;
    for (Eigen::Index k = 0; k < block_.vertex_count(); ++k) {
        const double rate = -block_.normal(k).dot(n);
        if (rate > 0.0) way = std::min(way, (block_.offset[k] - block_.normal(k).dot(p)) / rate);
    }
    return way;
}

// ---- flight ------------------------------------------------------------------------------------------------------------------------

double PlaneContacts::free_time(const BlockState<2>& s, double, double gravity, const Vec2& drag, double& gap) {
    gap = kInfinity;
    beyond_rim_ = false;
    Flight flight;
    flight.position = s.position;
    flight.rotation << std::cos(s.orientation), -std::sin(s.orientation), std::sin(s.orientation),
        std::cos(s.orientation);
    flight.velocity = s.velocity;
    flight.spin = s.spin[0];
    flight.gravity = gravity;
    flight.drag = drag;
    flight.pull = drag.norm();
    flight.fastest = s.velocity.norm() + std::abs(flight.spin) * block_.radius;
    flight.turning = flight.spin * flight.spin * block_.radius;
    flight.jerk = std::abs(flight.spin) * flight.turning;
    double inside = time_in_stretch(flight);
    if (inside < kLeastHorizon) {
        look_ahead(flight);
        inside = time_in_stretch(flight);
    }
    if (!ahead_.whole) inside = std::min(inside, kRimShare * block_.radius / std::max(flight.fastest, 0.1));
    const double centre = ahead_.height(flight.position), rate = ahead_.normal.dot(flight.velocity);
    if (std::isinf(centre)) return inside;
    if (centre > block_.radius && arrival(centre - block_.radius, rate, flight.fall(ahead_.normal)) >= inside)
        return inside;
    return time_to_ground(flight, inside, gap);
}

/// How long the block stays over the stretch that the line ahead covers [s]; negative if it is not in it.
double PlaneContacts::time_in_stretch(const Flight& flight) const {
    const double s = flight.position.x(), v = flight.velocity.x();
    const double room = ahead_to_ - block_.radius - s, behind = s - block_.radius - ahead_from_;
    if (!(room >= 0.0 && behind >= 0.0)) return -1.0;
    return std::min(kLongestFlight, (v > 0.0 ? room : behind) / std::max(std::abs(v), 1e-9));
}

void PlaneContacts::look_ahead(const Flight& flight) {
    const double s = flight.position.x(), way = kHorizon * flight.velocity.x(), margin = block_.radius + 1e-3;
    ahead_from_ = s + std::min(way, 0.0) - margin;
    ahead_to_ = s + std::max(way, 0.0) + margin;
    ahead_ = ground_.supporting_line(ahead_from_, ahead_to_);
}

/// Lower bound of the time until something touches, at most `horizon`, within which the block stays over the stretch of the line ahead.
double PlaneContacts::time_to_ground(const Flight& flight, double horizon, double& gap) {
    const double centre = ahead_.height(flight.position), rate = ahead_.normal.dot(flight.velocity);
    const double most = std::max(flight.fall(ahead_.normal), 0.0) + flight.turning;
    const Vec2 m = flight.rotation.transpose() * ahead_.normal;
    below_ = ground_.reach_at(flight.position.x());
    double time = horizon;
    const Eigen::Index count = block_.vertex_count(), lowest = lowest_vertex(m);
    for (Eigen::Index k = 0; k < count; ++k) {
        const Eigen::Index i = lowest + k < count ? lowest + k : lowest + k - count;
        const double x = block_.x[i], z = block_.z[i];
        const double height = centre + m.x() * x + m.y() * z, approach = rate + flight.spin * (m.y() * x - m.x() * z);
        if (height + std::min(approach, 0.0) * time - 0.5 * most * time * time > 0.0) continue;  // not even to the line
        time = time_of_vertex(flight, i, time, gap);
    }
    if (vertices_only_) return time;
    const double way = flight.velocity.x() * time;
    const double from = flight.position.x() + std::min(way, 0.0) - block_.radius,
                 to = flight.position.x() + std::max(way, 0.0) + block_.radius;
    for (std::size_t k = ground_.reach_at(from) + 1; k < ground_.reach_count() && ground_.reach(k).from <= to; ++k)
        if (ground_.is_crest(k)) time = time_of_crest(flight, {ground_.corner(k), k, 0.0, 0.0}, time, gap);
    return time;
}

// The corner can touch a reach when it is on its line and within its chainages, whichever comes later.
double PlaneContacts::time_of_vertex(const Flight& flight, Eigen::Index vertex, double horizon, double& gap) {
    const Vec2 arm = flight.rotation * block_.vertex(vertex), p = flight.position + arm;
    if (!ground_.contains(p.x())) {
        beyond_rim_ = beyond_rim_ || hangs_beside(p);
        return horizon;  // no look is far away near the rim
    }
    const Vec2 u = flight.velocity + flight.spin * perpendicular(arm);
    const Vec2 a = -flight.gravity * Vec2::UnitY() - flight.spin * flight.spin * arm + flight.drag;
    below_ = ground_.reach_at(p.x(), below_);
    double time = horizon;
    auto look_at = [&](std::size_t k, double entry) {
        const GroundReach& r = ground_.reach(k);
        const double height = r.gap(p);
        const double closed = height > 0.0 ? arrival(height, r.normal.dot(u), -r.normal.dot(a), flight.jerk,
                                                     std::max(flight.fall(r.normal), 0.0) + flight.turning, time)
                                           : 0.0;
        time = std::min(time, std::max(entry, closed));
    };
    gap = std::min(gap, ground_.reach(below_).gap(p));
    look_at(below_, 0.0);
    // how far it gets to either side meanwhile, at most
    auto way = [&](double speed) {
        return (std::max(speed, 0.0) + 0.5 * (flight.turning + flight.pull) * time) * time;
    };
    for (std::size_t k = below_ + 1; k < ground_.reach_count(); ++k) {
        const double distance = std::max(ground_.reach(k).from - p.x(), 0.0);
        if (distance > way(u.x())) break;
        look_at(k, arrival(distance, -u.x(), flight.turning + flight.pull));
    }
    for (std::size_t k = below_; k > 0; --k) {
        const double distance = std::max(p.x() - ground_.reach(k).from, 0.0);
        if (distance > way(-u.x())) break;
        look_at(k - 1, arrival(distance, u.x(), flight.turning + flight.pull));
    }
    return time;
}

// As long as one side of the block has the crest on its outer side, the two do not touch. Its distance f = n.(c - x) - d has, with n' = w n^, n^ the normal
// turned by a right angle, x' = v and x'' = a, gravity and drag:
//     f' = w n^.(c - x) - n.v,    f'' = -w^2 n.(c - x) - 2 w n^.v - n.a,    |f'''| <= |w|^3 |c - x| + 3 w^2 |v| + 3 |w| |a|.
double PlaneContacts::time_of_crest(const Flight& flight, const NearCrest& crest, double horizon, double& gap) {
    const Vec2 arm = crest.point - flight.position;
    const double distance = arm.norm(), speed = flight.velocity.norm(), g = flight.gravity + flight.pull;
    const double speed_then = speed + g * horizon, way = (speed + 0.5 * g * horizon) * horizon;
    if (distance - block_.radius > way) return horizon;
    const SideAt at = side_at(flight.rotation.transpose() * arm);
    const Vec2 n = flight.rotation * block_.normal(at.side);
    double room = at.outside;
    if (falls_away(crest, -n)) {
        gap = std::min(gap, at.outside);
        if (at.outside <= 0.0) return 0.0;
    } else {
        if (at.outside <= 0.0) {
            std::vector<Contact<2>> cut;
            add_cut_corner(crest, at.outside, flight.position, flight.rotation, cut);
            for (const Contact<2>& c : cut) gap = std::min(gap, c.gap);
            if (!cut.empty()) return 0.0;
        }
        if (at.outside <= least_passed_by_) room += kHooked;  // how deep it may get before something holds it
    }
    const double w = flight.spin, size = std::abs(w), reach = distance + way;
    const double rate = w * perpendicular(n).dot(arm) - n.dot(flight.velocity);
    const double acceleration = w * w * n.dot(arm) + 2.0 * w * perpendicular(n).dot(flight.velocity) - flight.fall(n);
    return arrival(room, rate, acceleration, size * size * size * reach + 3.0 * w * w * speed_then + 3.0 * size * g,
                   w * w * reach + 2.0 * size * speed_then + g, horizon);
}

}  // namespace scree
