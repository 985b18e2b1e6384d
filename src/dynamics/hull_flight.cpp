// SPDX-License-Identifier: GPL-3.0-or-later
// Flight: how long a block may go unwatched before anything can touch.
#include "dynamics/arrival.hpp"
#include "dynamics/contact_lengths.hpp"
#include "dynamics/hull_contacts.hpp"
#include "geometry/hull_kernels.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// Farthest and nearest that the plane ahead is laid [s].
constexpr double kFarHorizon = 0.5, kNearHorizon = 0.02;
/// A flight time over the plane that is shorter than this makes it worth looking at the features [s].
constexpr double kNearTime = 2e-3;
/// How far features are looked for: what the fastest point of the block covers in this time [s], and a share of the block's thickness at most [-]: what
/// is passed by and not waited for must not get through the block between two looks. Shorter where the last look found something near.
constexpr double kLongestLook = 0.02, kShortestLook = 2e-3, kLookShare = 0.7;
/// A block in flight has the terrain of so much time copied out at once [s], two radii at most.
constexpr double kPatchTime = 0.1;
/// Euler's equations with |I_i - I_j| <= I_k give |dOmega/dt| <= |Omega|^2 / sqrt(3) and |d^2 Omega/dt^2| <= |Omega|^3, both in the body frame. The
/// acceleration of a point of a freely turning body is then at most (1 + 1/sqrt 3) |Omega|^2 r and changes at most at the rate
/// (2 + 4/sqrt 3) |Omega|^3 r [-].
constexpr double kTurningBound = 1.57735026918962576, kJerkBound = 4.30940107675850306;

/// The plane through a point of the terrain that faces a place.
SupportingPlane plane_facing(const Vec3& place, const Vec3& point) {
    const Vec3 normal = (place - point).normalized();
    return {normal, normal.dot(point), true};
}

}  // namespace

double HullContacts::free_time(const BlockState<3>& s, double spin_bound, double gravity, const Vec3& drag,
                               double& gap) {
    gap = kInfinity;
    const Mat3 rotation = s.orientation.toRotationMatrix();
    const Vec3 spin_change = block_.inertia.cwiseProduct(s.spin).cross(s.spin).cwiseQuotient(block_.inertia);
    const Flight flight{s.velocity,
                        rotation * s.spin,
                        rotation * spin_change,
                        s.spin,
                        spin_change,
                        kTurningBound * spin_bound * spin_bound * block_.radius,
                        kJerkBound * spin_bound * spin_bound * spin_bound * block_.radius,
                        s.velocity.norm() + s.spin.norm() * block_.radius,
                        gravity,
                        drag,
                        drag.norm()};
    const double over_plane = time_over_plane(s.position, rotation, flight);
    if (over_plane > kNearTime) return over_plane;
    return std::max(over_plane, time_to_features(s.position, rotation, flight, gap));
}

/// Lays a plane over the terrain that the block's outline crosses up to the horizon.
void HullContacts::look_ahead(const Vec3& position, const Vec3& velocity) {
    const Vec2 from = position.head<2>(), to = from + horizon_ * velocity.head<2>();
    Box2 box{from, from};
    box.add(to);
    ahead_box_ = box.grown(block_.radius + 1e-3);
    ahead_ = surface_.supporting_plane(ahead_box_);
}

/// How long the block stays over a box that it is flown through [s]; negative if it is not over it. Drag only shortens the way.
double HullContacts::time_over(const Box2& box, const Vec3& position, const Flight& flight) const {
    double t = kLongestFlight;
    for (int k = 0; k < 2; ++k) {
        const double v = flight.velocity[k];
        const double east = box.max[k] - block_.radius - position[k], west = position[k] - block_.radius - box.min[k];
        if (!(east >= 0.0 && west >= 0.0)) return -1.0;
        t = std::min(t, (v > 0.0 ? east : west) / std::max(std::abs(v), 1e-9));
    }
    return t;
}

double HullContacts::time_over_plane(const Vec3& position, const Mat3& rotation, const Flight& flight) {
    double inside = time_over(ahead_box_, position, flight);
    if (inside < 0.5 * kNearHorizon) {
        look_ahead(position, flight.velocity);
        inside = time_over(ahead_box_, position, flight);
    }
    if (!ahead_.whole) inside = std::min(inside, kRimShare * block_.radius / std::max(flight.fastest, 0.1));
    const double centre = ahead_.height(position);
    const double rate = ahead_.normal.dot(flight.velocity);
    const double fall = flight.fall(ahead_.normal);
    double time = 0.0;
    if (centre > block_.radius) time = std::isinf(centre) ? inside : arrival(centre - block_.radius, rate, fall);
    if (time < inside) {
        measure_heights(position, rotation, ahead_);
        if (lowest_ > 0.0)
            time = std::max(time, soonest_on_plane(height_.data(), rotation, ahead_.normal, flight, inside));
    }
    if (time < 0.5 * inside && horizon_ > kNearHorizon) {
        horizon_ *= 0.5;  // over rough or curved ground a near plane lies closer
        ahead_box_ = {};
    } else if (time >= inside) {
        horizon_ = std::min(2.0 * horizon_, kFarHorizon);
    }
    return std::min(time, inside);
}

/// How the vertices near a plane with this normal.
PlaneApproach HullContacts::approach(const Mat3& rotation, const Vec3& normal, const Flight& flight) const {
    const Vec3 n = rotation.transpose() * normal;
    // (n.(Omega x r)) and (n.(dOmega/dt x r + Omega x (Omega x r))) as products with r
    const Vec3& spin = flight.spin_in_body;
    const Vec3 speeding = n.cross(flight.spin_change_in_body) + n.dot(spin) * spin - spin.squaredNorm() * n;
    const double fall = flight.fall(normal);
    return {n.cross(spin), normal.dot(flight.velocity),         -speeding, fall,
            flight.jerk,   std::max(fall, 0.0) + flight.turning};
}

/// With the vertices' heights over the plane, all positive.
double HullContacts::soonest_on_plane(const double* height, const Mat3& rotation, const Vec3& normal,
                                      const Flight& flight, double horizon) const {
    const PlaneApproach nearing = approach(rotation, normal, flight);
    Eigen::Index vertex = 0;
    if (lowest_until(block_, height, nearing, horizon, vertex) > 0.0) return horizon;
    return soonest_arrival(block_, height, nearing, horizon);
}

/// True if the block stays above a plane until `time`: first the sphere around it, whose turning does not matter, then its vertices.
bool HullContacts::keeps_above(const SupportingPlane& plane, const Vec3& position, const Mat3& rotation,
                               const Flight& flight, double time) {
    const double room = plane.height(position) - block_.radius;
    const double fall = std::max(flight.fall(plane.normal), 0.0);
    if (room > 0.0 && room + (plane.normal.dot(flight.velocity) - 0.5 * fall * time) * time > 0.0) return true;
    plane_heights(block_, rotation.transpose() * plane.normal, plane.height(position), height_over_feature_.data());
    Eigen::Index vertex = 0;
    return lowest_until(block_, height_over_feature_.data(), approach(rotation, plane.normal, flight), time, vertex) >
           0.0;
}

// Vertices first: mostly one of them is the first to touch. Of the rest only what cheaper bounds do not keep away until then is looked at closely.
double HullContacts::time_to_features(const Vec3& position, const Mat3& rotation, const Flight& flight, double& gap) {
    const Vec2 way = kPatchTime * flight.velocity.head<2>();
    cover(position, 0.5 * kNearHorizon * flight.fastest,
          way * std::min(1.0, 2.0 * block_.radius / std::max(way.norm(), 1e-9)));
    beyond_rim_ = false;
    const double look =
        std::clamp(look_time_ * flight.fastest, 1e-3 * block_.inner_radius, kLookShare * block_.inner_radius);
    const double longest = arrival(look, -flight.fastest, flight.gravity + flight.pull);
    double time = std::min(time_over(patch_.box, position, flight), longest);
    if (!patch_.plane.whole) time = std::min(time, kRimShare * block_.radius / std::max(flight.fastest, 0.1));
    if (patch_.facets.empty()) return time;
    measure_heights(position, rotation, patch_.plane);
    advance_odometer(position, rotation);
    time = time_of_vertices(position, rotation, flight, time, gap);
    passed_depth_ = 0.0;
    if (!vertices_only_) time = time_of_tips_and_crests(position, rotation, flight, time, gap);
    look_time_ = time < longest ? std::clamp(4.0 * time, kShortestLook, kLongestLook) : kLongestLook;
    if (gap > 0.0 && passed_depth_ <= kHooked) return time;
    detect(position, rotation, 0.0, near_);
    for (const Contact<3>& c : near_) gap = std::min(gap, c.gap);
    return gap > 0.0 ? time : 0.0;
}

double HullContacts::time_of_vertices(const Vec3& position, const Mat3& rotation, const Flight& flight, double horizon,
                                      double& gap) {
    const PlaneApproach nearing = approach(rotation, patch_.plane.normal, flight);
    double time = horizon;
    auto look_at = [&](Eigen::Index i) {
        const Vec3 arm = rotation * block_.vertex(i), p = position + arm;
        if (const PatchFacet* facet = patch_.facet_at(p.head<2>())) {
            gap = std::min(gap, facet->gap(p));
            time = std::min(time, time_of_vertex(p, arm, *facet, flight, time));
        } else {
            beyond_rim_ = beyond_rim_ || height_[i] < 0.0;
        }
    };
    Eigen::Index first = 0;
    lowest_until(block_, height_.data(), nearing, time, first);
    look_at(first);
    const std::size_t count = vertices_reaching(block_, height_.data(), nearing, time, near_vertices_.data());
    for (std::size_t k = 0; k < count; ++k)
        if (near_vertices_[k] != first) look_at(near_vertices_[k]);
    return time;
}

double HullContacts::time_of_tips_and_crests(const Vec3& position, const Mat3& rotation, const Flight& flight,
                                             double horizon, double& gap) {
    const double lowest = lowest_,
                 sinking = std::max(flight.spin.norm() * block_.radius - patch_.plane.normal.dot(flight.velocity), 0.0),
                 most = std::max(flight.fall(patch_.plane.normal), 0.0) + flight.turning;
    double time = horizon, reach = 0.0, lowest_then = 0.0;
    // until then no point of the block moves farther than `reach`, and none comes lower over the patch's plane than `lowest_then`
    auto set_time = [&](double t) {
        time = t;
        reach = (flight.fastest + 0.5 * (flight.gravity + flight.pull + flight.turning) * t) * t;
        lowest_then = lowest - (sinking + 0.5 * most * t) * t;
    };
    auto look_at = [&](const Contact<3>& c) {
        const double soonest = arrival(c.gap, -flight.fastest, flight.gravity + flight.pull + flight.turning);
        if (soonest < time) set_time(std::min(time, std::max(soonest, time_of_contact(rotation, c, flight, time))));
    };
    auto look_at_contacts = [&] {
        for (const Contact<3>& c : near_) {
            gap = std::min(gap, c.gap);
            if (c.gap > 0.0) look_at(c);
        }
        for (const Contact<3>& c : passed_by_)
            if (c.gap > least_passed_by_) look_at(c);
    };
    set_time(horizon);
    // who waits for all that is passed by forecasts contacts: they may close before anything touches
    const bool culls = least_passed_by_ > 0.0;
    for (std::size_t k = 0; k < patch_.nodes.size(); ++k) {
        if (node_height_[k] < lowest_then || odometer_ + reach < node_free_until_[k]) continue;
        if (culls && keeps_above(plane_facing(position, patch_.nodes[k].position), position, rotation, flight, time))
            continue;
        near_.clear();
        passed_by_.clear();
        add_tip_contact(k, position, rotation, reach, near_);
        look_at_contacts();
    }
    for (std::size_t k = 0; k < patch_.edges.size(); ++k) {
        if (edge_height_[k] < lowest_then || odometer_ + reach < edge_free_until_[k]) continue;
        const PatchEdge& edge = patch_.edges[k];
        const Vec3 nearest = edge.a + nearest_share(k, position) * (edge.b - edge.a);
        if ((nearest - position).squaredNorm() > (block_.radius + reach) * (block_.radius + reach)) continue;
        if (culls && keeps_above(plane_facing(position, nearest), position, rotation, flight, time)) continue;
        near_.clear();
        passed_by_.clear();
        add_crest_contacts(k, position, rotation, reach, near_);
        look_at_contacts();
    }
    return time;
}

// The terrain at a crest or tip lies below the plane through it that the contact's normal stands on, and the block above it.
double HullContacts::time_of_contact(const Mat3& rotation, const Contact<3>& contact, const Flight& flight,
                                     double horizon) {
    const double lowest = plane_heights(block_, rotation.transpose() * contact.normal, -contact.normal.dot(contact.arm),
                                        height_over_feature_.data());
    return lowest > 0.0 ? soonest_on_plane(height_over_feature_.data(), rotation, contact.normal, flight, horizon)
                        : 0.0;
}

// The height of a vertex above the surface shrinks at a rate that depends on the facet below; all facets that it may get over count.
double HullContacts::time_of_vertex(const Vec3& p, const Vec3& arm, const PatchFacet& below, const Flight& flight,
                                    double horizon) const {
    const Vec3 u = flight.velocity_at(arm), a = flight.acceleration_at(arm);
    const double height = p.z() - below.height(p.head<2>());
    if (!(height > 0.0)) return 0.0;
    const double hardest = flight.gravity + (flight.turning + flight.pull) / patch_.least_normal_z;
    const double uphill = u.head<2>().norm() * steepest_slope_;
    if (height + (std::min(u.z() - uphill, 0.0) - 0.5 * hardest * horizon) * horizon > 0.0) return horizon;
    double rate = below.rise(u), acceleration = -below.rise(a), steepest = below.normal.z();
    auto time_now = [&] {
        return arrival(height, rate, acceleration, flight.jerk / steepest,
                       flight.gravity + (flight.turning + flight.pull) / steepest, horizon);
    };
    double time = time_now();
    const Vec2 plan = p.head<2>();
    Box2 swept{plan, plan};
    swept.add(plan + time * u.head<2>());
    swept = swept.grown(0.5 * (flight.turning + flight.pull) * time * time);
    const Vec2 low = ((swept.min - patch_.bin_origin) / patch_.bin_size).array().floor(),
               high = ((swept.max - patch_.bin_origin) / patch_.bin_size).array().floor();
    for (int j = std::max(0, static_cast<int>(low.y())); j <= std::min(patch_.bin_rows - 1, static_cast<int>(high.y()));
         ++j) {
        for (int i = std::max(0, static_cast<int>(low.x()));
             i <= std::min(patch_.bin_columns - 1, static_cast<int>(high.x())); ++i) {
            for (const std::int32_t f : patch_.facets_in_bin(i, j)) {
                const PatchFacet& facet = patch_.facets[static_cast<std::size_t>(f)];
                rate = std::min(rate, facet.rise(u));
                acceleration = std::max(acceleration, -facet.rise(a));
                steepest = std::min(steepest, facet.normal.z());
            }
        }
    }
    return std::min(time, time_now());
}

}  // namespace scree
