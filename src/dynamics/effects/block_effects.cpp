// SPDX-License-Identifier: GPL-3.0-or-later
#include "dynamics/effects/block_effects.hpp"

#include "dynamics/effects/formulas.hpp"

#include "scree/base/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

using namespace effect_formula;

/// Longest edge of the smallest piece that a block breaks into [m]: dust would bounce for ever.
constexpr double kSmallestPiece = 0.05;
/// A flight is taken this far beyond a border or an obstacle, so that the next piece begins behind it [m].
constexpr double kPast = 1e-4;
/// Two stretches of a net's line that are crossed this near to each other are crossed at the post between them, once [share of a step].
constexpr double kSamePost = 1e-9;
/// A shorter piece takes another way by as little as its end is off: it could fall short of the border for ever [s].
constexpr double kLeastPiece = 1e-5;

/// Where the way from a to b enters the circle, as a share in (0, 1] of it; infinite if it does not. `offset`: how far the way passes from the
/// centre over the radius.
double entry(const Vec2& a, const Vec2& b, const Vec2& centre, double radius, double& offset) {
    const Vec2 way = b - a, w = a - centre;
    const double length = way.norm();
    if (length == 0.0 || w.squaredNorm() <= radius * radius) return kInfinity;
    const double along = -w.dot(way) / length, beside = cross(w, way) / length;
    if (std::abs(beside) >= radius) return kInfinity;
    const double s = (along - std::sqrt(radius * radius - beside * beside)) / length;
    offset = std::abs(beside) / radius;
    return s > 0.0 && s <= 1.0 ? s : kInfinity;
}

/// Within [0, high]; what is no number stays so.
double clamped(double value, double high = kInfinity) {
    return value < 0.0 ? 0.0 : value > high ? high : value;
}

/// As scree/own_law.h has vectors.
void put(const Vec3& v, double (&to)[3]) {
    std::copy_n(v.data(), 3, to);
}
void put(const Vec2& v, double (&to)[3]) {
    put(Vec3(v.x(), 0.0, v.y()), to);
}

}  // namespace

template <int Dim>
BlockEffects<Dim>::BlockEffects(const EffectInput& input, const EffectBody& body, const EffectGround<Dim>& ground,
                                double gravity)
    : body_(body), ground_(ground), gravity_(-gravity * Vec::Unit(Dim - 1)) {
    std::array<std::uint64_t, kEffectKinds> number{};
    for (const Effect& effect : input.effects) {
        if (!acts_on_motion(effect.kind)) continue;
        const EffectInfo& info = effect_info(effect.kind);
        Part part{effect.kind,
                  info.hook,
                  &effect.place,
                  &effect.own,
                  effect.values,
                  effect_stream(input.seed, effect.kind, number[static_cast<std::size_t>(effect.kind)]++, input.block)};
        if (effect.kind == EffectKind::Trees) draw_next_tree(part);
        if (effect.kind == EffectKind::OwnLaw) part.memory = part.random.uniform();
        if (effect.kind == EffectKind::SoilScatter) part.memory = part.random.normal();
        parts_.push_back(part);
        watches_flight_ = watches_flight_ || info.hook == EffectHook::Force || info.hook == EffectHook::Crossing;
    }
    std::stable_partition(parts_.begin(), parts_.end(), [](const Part& p) { return p.kind == EffectKind::SoilPatch; });
}

// ---- contact law and impacts -------------------------------------------------------------------------------------------------------

template <int Dim>
ContactLaw BlockEffects<Dim>::law(const Contact<Dim>& contact, const State& s, const ContactSpeed& speed,
                                  const Soil& soil) const {
    ContactLaw law{soil.restitution, soil.friction, soil.rolling};
    for (const Part& p : parts_) {
        if (p.hook != EffectHook::ContactLaw || !p.place->covers(contact.soil, plan(s.position + contact.arm)))
            continue;
        const auto& v = p.value;
        switch (p.kind) {
            case EffectKind::SoilPatch:
                if (!std::isnan(v[0])) law.restitution = v[0];
                if (!std::isnan(v[1])) law.friction = v[1];
                if (!std::isnan(v[2])) law.rolling = v[2];
                break;
            case EffectKind::RestitutionPfeifferBowen:
                law.restitution = pfeiffer_bowen(law.restitution, speed.approach, v[0]);
                break;
            case EffectKind::RestitutionHalfSpeed:
                law.restitution = half_speed(law.restitution, speed.approach, v[0]);
                break;
            case EffectKind::RestitutionMass:
                law.restitution = restitution_of_mass(law.restitution, body_.mass, v[1], v[0]);
                break;
            case EffectKind::SlipFriction:
                law.friction = slip_friction(law.friction, p.memory, v[0], v[1]);
                break;
            case EffectKind::FrictionSpeed:
                law.friction = friction_of_speed(law.friction, speed.sliding, v[0], v[1]);
                break;
            case EffectKind::FrictionBlockSpeed:
                law.friction = friction_of_speed(law.friction, s.velocity.norm(), v[0], v[1]);
                break;
            case EffectKind::RollingSpeed:
                law.rolling = rolling_of_speed(law.rolling, s.velocity.norm(), v[0], v[1]);
                break;
            case EffectKind::RollingSize:
                law.rolling = rolling_of_size(law.rolling, body_.length, v[1], v[0]);
                break;
            case EffectKind::SoilScatter:
                law.rolling *= std::exp(v[0] * p.memory);
                law.friction *= std::exp(v[1] * p.memory);
                law.restitution = std::min(1.0, law.restitution * std::exp(v[2] * p.memory));
                break;
            case EffectKind::LowFriction:
                law.friction = std::min(law.friction, v[0]);
                break;
            case EffectKind::OwnLaw:
                if (p.own->contact_law) {
                    scree_contact_state state = contact_state(p, s, s.position + contact.arm);
                    put(contact.normal, state.normal);
                    state.approach = speed.approach;
                    scree_contact_law_values own{law.restitution, law.friction, law.rolling};
                    p.own->contact_law(&state, &own);
                    law = {clamped(own.restitution, 1.0), clamped(own.friction), clamped(own.rolling)};
                }
                break;
            default:
                break;
        }
    }
    return law;
}

template <int Dim>
scree_contact_state BlockEffects<Dim>::contact_state(const Part& part, const State& s, const Vec& at) const {
    scree_contact_state state{};
    put(at, state.position);
    put(Vec(Vec::Unit(Dim - 1)), state.normal);
    put(s.velocity, state.velocity);
    state.spin = s.spin.norm();
    state.mass = body_.mass;
    state.length = body_.length;
    state.draw = part.memory;
    std::copy(part.value.begin(), part.value.end(), state.number);
    return state;
}

template <int Dim>
bool BlockEffects<Dim>::tilt(const State& s, std::vector<Contact<Dim>>& contacts) {
    bool tilted = false;
    for (Part& p : parts_) {
        if (p.kind != EffectKind::Roughness || p.value[0] <= 0.0) continue;
        const double largest = std::atan(2.0 * p.value[0] / body_.length);
        Eigen::Matrix<double, Dim, Dim> turn;
        bool drawn = false;
        for (Contact<Dim>& c : contacts) {
            if (!p.place->covers(c.soil, plan(s.position + c.arm))) continue;
            if (!drawn) {  // one turn for all contacts of the impact, about an axis in the tangent plane of the first
                if constexpr (Dim == 3) {
                    const double angle = p.random.uniform(0.0, largest),
                                 direction = p.random.uniform(0.0, 2.0 * std::numbers::pi);
                    const Vec3 axis = Eigen::AngleAxisd(direction, c.normal) * c.normal.unitOrthogonal();
                    turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
                } else {
                    turn = Eigen::Rotation2Dd(p.random.uniform(-largest, largest)).toRotationMatrix();
                }
                drawn = true;
            }
            c.normal = (turn * c.normal).normalized();
            tilted = true;
        }
    }
    return tilted;
}

template <int Dim>
void BlockEffects<Dim>::struck(const State& s, std::span<const Contact<Dim>> contacts,
                               std::span<const double> approach) {
    for (Part& p : parts_) {
        if (p.kind != EffectKind::ScarDrag && p.kind != EffectKind::Fragmentation) continue;
        double fastest = 0.0;
        for (std::size_t c = 0; c < contacts.size(); ++c)
            if (p.place->covers(contacts[c].soil, plan(s.position + contacts[c].arm)))
                fastest = std::max(fastest, approach[c]);
        if (fastest <= 0.0) continue;
        if (p.kind == EffectKind::ScarDrag) {
            const double left = p.memory * std::max(0.0, 1.0 - p.memory2 / body_.length);
            const double depth = std::min(scar_depth(body_.mass, 1e6 * p.value[1], fastest), 0.5 * body_.length);
            if (depth < left) continue;  // within the scar of before, which is left behind as it was
            p.memory = depth;
            p.memory2 = 0.0;
        } else if (!broken_ && p.value[1] < 1.0 && body_.length * std::cbrt(p.value[1]) >= kSmallestPiece &&
                   fastest >= p.value[0] && p.memory < p.value[2]) {
            p.memory += 1.0;
            broken_ = true;
            piece_ = p.value[1];
        }
    }
}

template <int Dim>
double BlockEffects<Dim>::take_piece() {
    const double factor = std::cbrt(piece_);
    body_.mass *= piece_;
    const double length = factor * body_.length;
    for (Part& p : parts_) {
        if (p.kind == EffectKind::Trees)  // the way to the next tree of a stand: what is smaller meets fewer
            p.memory *= (body_.length + p.value[0]) / (length + p.value[0]);
        if (p.kind == EffectKind::ScarDrag) p.memory = std::min(p.memory, 0.5 * length);
    }
    body_.length = length;
    ++breaks_;
    broken_ = false;
    second_.reset();
    return factor;
}

// ---- forces ------------------------------------------------------------------------------------------------------------------------

template <int Dim>
bool BlockEffects<Dim>::acts_on_flight_at(const Part& p, const Vec& position) const {
    if (!p.place->covers(p.place->soil < 0 ? -1 : ground_.soil(position), plan(position))) return false;
    if (p.kind == EffectKind::ForestDrag) return height_over_ground(position) <= p.value[1];
    if (p.kind == EffectKind::Trees) return height_over_ground(position) <= p.value[3];
    return true;
}

/// True if it hangs on the height above the ground, or on the soil, whether the effect acts on a flight there: such flights are looked at again and again.
/// Elsewhere borders and obstacles count, which are known from afar: up to them a block flies as it would without them, to the last digit.
template <int Dim>
bool BlockEffects<Dim>::has_to_look_at(const Part& p, const Vec& position) const {
    if (p.hook != EffectHook::Force && p.hook != EffectHook::Crossing) return false;
    if (p.place->soil >= 0) return true;
    const bool canopy = p.kind == EffectKind::ForestDrag || (p.kind == EffectKind::Trees && p.place->points.empty());
    return canopy && p.place->covers(-1, plan(position));
}

template <int Dim>
bool BlockEffects<Dim>::has_to_look_at(const Vec& position) const {
    return std::any_of(parts_.begin(), parts_.end(), [&](const Part& p) { return has_to_look_at(p, position); });
}

/// True if an effect on flights begins or ends between two places that are next to each other.
template <int Dim>
bool BlockEffects<Dim>::enters(const Vec& from, const Vec& to) const {
    return std::any_of(parts_.begin(), parts_.end(), [&](const Part& p) {
        const bool on_flights = p.hook == EffectHook::Force || p.hook == EffectHook::Crossing;
        return on_flights && p.place->soil < 0 && p.place->covers(-1, plan(from)) != p.place->covers(-1, plan(to));
    });
}

/// Quadratic drag of the scar that the block is in [1/m].
template <int Dim>
double BlockEffects<Dim>::scar_drag(const Part& p) const {
    const double depth = p.memory * std::max(0.0, 1.0 - p.memory2 / body_.length);
    return 0.5 * p.value[0] * p.value[2] * scar_area(0.5 * body_.length, depth) / body_.mass;
}

template <int Dim>
Drag BlockEffects<Dim>::drag_at(const Vec& position) const {
    Drag drag;
    for (const Part& p : parts_) {
        if (p.hook != EffectHook::Force || !acts_on_flight_at(p, position)) continue;
        if (p.kind == EffectKind::AirDrag)
            drag.quadratic +=
                0.5 * p.value[1] * p.value[0] * 0.25 * std::numbers::pi * body_.length * body_.length / body_.mass;
        else
            drag.linear += p.value[0] / body_.mass;
    }
    return drag;
}

template <int Dim>
Drag BlockEffects<Dim>::drag_in_contact(std::span<const Contact<Dim>> contacts, const State& s) const {
    Drag drag;
    for (const Part& p : parts_) {
        const bool own = p.kind == EffectKind::OwnLaw && p.own->ground_drag;
        if (p.hook != EffectHook::ContactForce && !own) continue;
        if (std::none_of(contacts.begin(), contacts.end(),
                         [&](const Contact<Dim>& c) { return p.place->covers(c.soil, plan(s.position + c.arm)); }))
            continue;
        if (p.kind == EffectKind::GroundDrag) drag.linear += p.value[0];
        if (p.kind == EffectKind::GroundDragQuadratic) drag.quadratic += p.value[0];
        if (p.kind == EffectKind::ScarDragReduced) drag.quadratic += p.value[0] / body_.length;
        if (p.kind == EffectKind::ScarDrag) drag.quadratic += scar_drag(p);
        if (own) {
            const scree_contact_state state = contact_state(p, s, s.position);
            scree_ground_drag_values values{};
            p.own->ground_drag(&state, &values);
            drag += Drag{clamped(values.linear), clamped(values.quadratic)};
        }
    }
    return drag;
}

template <int Dim>
typename BlockEffects<Dim>::Vec BlockEffects<Dim>::drive(double h, Drag drag, State& s) const {
    if (watches_flight_) drag += drag_at(s.position);
    const double x = drag.rate(s.velocity.norm()) * h;
    if (x <= 0.0) return gravity_;
    s.velocity *= std::exp(-x);
    return gravity_ * (-std::expm1(-x) / x);
}

template <int Dim>
FlightArc<Dim> BlockEffects<Dim>::flight_arc(const State& s) {
    if (!watches_flight_) return {gravity_, kInfinity};
    if (second_) {
        const FlightArc<Dim> arc = *second_;
        second_.reset();
        return arc;
    }
    // who starts on a border is on the other side of it at once
    if (const double speed = plan(s.velocity).norm();
        speed > 0.0 && enters(s.position, s.position + kPast / speed * s.velocity))
        return {gravity_, std::clamp(kPast / speed, kLeastPiece, DragFlight<Dim>::kLongest)};
    const Drag drag = drag_at(s.position);
    const double longest = !drag.none()                 ? DragFlight<Dim>::longest(drag, gravity_, s.velocity)
                           : has_to_look_at(s.position) ? DragFlight<Dim>::kLongest
                                                        : DragFlight<Dim>::kUndisturbed;
    DragFlight<Dim> flight(drag, gravity_, s, longest);
    const double change = change_time(s, flight);
    if (change < flight.duration()) flight = DragFlight<Dim>(drag, gravity_, s, std::max(change, kLeastPiece));
    if (flight.second.duration > 0.0) second_ = flight.second;
    return flight.first;
}

// ---- on the way --------------------------------------------------------------------------------------------------------------------

/// Calls `met(share, offset)` for every tree of known position that is met, with the share of the way at which it is; `offset` over (L + DBH) / 2.
template <int Dim>
template <class Met>
void BlockEffects<Dim>::for_each_tree(const Part& p, const Vec& from, const Vec& to, const Met& met) const {
    const double radius = 0.5 * (body_.length + p.value[0]);
    const Points& trees = p.place->points;
    const double low = std::min(from.x(), to.x()) - radius, high = std::max(from.x(), to.x()) + radius;
    for (auto tree =
             std::lower_bound(trees.begin(), trees.end(), low, [](const Vec3&t, double x) { return t.x() < x; });
         tree != trees.end() && tree->x() <= high; ++tree) {
        double offset = 0.0, share = kInfinity;
        if constexpr (Dim == 3) {
            share = entry(from.template head<2>(), to.template head<2>(), tree->template head<2>(), radius, offset);
        } else {  // where the profile passes it
            offset = std::abs(tree->y()) / radius;
            share = (tree->x() - from.x()) / (to.x() - from.x());
            if (!(offset < 1.0 && share > 0.0)) share = kInfinity;
        }
        if (share <= 1.0) met(share, offset);
    }
}

/// Share of the way in plan at which something begins, ends or stands, infinite if there is nothing.
template <int Dim>
double BlockEffects<Dim>::first_change(const Vec& from, const Vec& to) const {
    double first = kInfinity;
    for (const Part& p : parts_) {
        if (p.hook != EffectHook::Force && p.hook != EffectHook::Crossing) continue;
        first = std::min(first, p.place->first_border(plan(from), plan(to)));
        if (p.kind == EffectKind::Net) first = std::min(first, p.place->next_line(plan(from), plan(to), 0.0));
        if (p.kind != EffectKind::Trees) continue;
        if (!p.place->points.empty())
            for_each_tree(p, from, to, [&](double share, double) { first = std::min(first, share); });
        else if (acts_on_flight_at(p, from))
            first = std::min(first, p.memory / std::max((plan(to) - plan(from)).norm(), 1e-300));
    }
    return first;
}

/// When, on this flight, the block comes to where an effect begins, ends or strikes; a little later, so that it is behind it then. Infinite if it does
/// not. In plan view the flight is straight.
template <int Dim>
double BlockEffects<Dim>::change_time(const State& s, const DragFlight<Dim>& flight) const {
    const double whole = flight.duration();
    const Vec end = flight.position(s, whole);
    const auto first_time = [&](auto reached) {
        double low = 0.0, high = whole;
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (low + high);
            (reached(middle) ? high : low) = middle;
        }
        return high;
    };
    double time = kInfinity;
    const double share = first_change(s.position, end);
    if (share <= 1.0) {
        const double way = share * (plan(end) - plan(s.position)).norm() + kPast;
        time = first_time([&](double t) { return (plan(flight.position(s, t)) - plan(s.position)).norm() >= way; });
    }
    for (const Part& p : parts_) {  // the canopy
        if ((p.kind != EffectKind::ForestDrag && p.kind != EffectKind::Trees) || !has_to_look_at(p, s.position))
            continue;
        const double height = p.kind == EffectKind::ForestDrag ? p.value[1] : p.value[3];
        const bool below = height_over_ground(s.position) <= height;
        if ((height_over_ground(end) <= height) != below)
            time = std::min(time, first_time([&](double t) {
                                return (height_over_ground(flight.position(s, t)) <= height) != below;
                            }));
    }
    return time;
}

template <int Dim>
void BlockEffects<Dim>::draw_next_tree(Part& p) {
    const double per_metre = p.value[1] * 1e-4 * (body_.length + p.value[0]);
    p.memory += per_metre > 0.0 ? -std::log1p(-p.random.uniform()) / per_metre : kInfinity;
}

/// Takes energy from the motion, speed and spin alike.
template <int Dim>
void BlockEffects<Dim>::lose(double energy, double& kinetic, State& s) {
    ++crossings_struck_;
    second_.reset();
    const double left = std::max(0.0, kinetic - energy);
    const double factor = kinetic > 0.0 ? std::sqrt(left / kinetic) : 0.0;
    s.velocity *= factor;
    s.spin *= factor;
    kinetic = left;
}

/// What a step in contact meets, which may be several lines or trees.
template <int Dim>
void BlockEffects<Dim>::cross(Part& p, const Vec& from, double& kinetic, State& s) {
    if (held_) return;  // what stands behind is not met
    if (p.kind == EffectKind::Net) {
        const auto next = [&](double after) { return p.place->next_line(plan(from), plan(s.position), after); };
        for (double share = next(0.0); share <= 1.0; share = next(share + kSamePost)) {
            if (!(height_over_ground(from + share * (s.position - from)) <= p.value[1])) continue;
            lose(1000.0 * p.value[0], kinetic, s);
            if (kinetic > 0.0) continue;
            held_ = true;
            beyond_net_ = (1.0 - share) * (plan(s.position) - plan(from)).norm();
            return;
        }
        return;
    }
    const double capacity = tree_capacity(p.value[0], p.value[2]);
    if (!p.place->points.empty()) {
        for_each_tree(p, from, s.position, [&](double share, double offset) {
            if (height_over_ground(from + share * (s.position - from)) <= p.value[3])
                lose(capacity * tree_share(offset), kinetic, s);
        });
    } else if (acts_on_flight_at(p, 0.5 * (from + s.position))) {
        p.memory -= (plan(s.position) - plan(from)).norm();
        while (p.memory <= 0.0) {
            lose(capacity * tree_share(p.random.uniform()), kinetic, s);
            draw_next_tree(p);
        }
    }
}

template <int Dim>
void BlockEffects<Dim>::moved(const Vec& from, double duration, bool in_contact, double kinetic_energy, State& s) {
    const double way = (s.position - from).norm();
    for (Part& p : parts_) {
        if (p.kind == EffectKind::SlipFriction) {
            p.memory = in_contact ? p.memory + way : p.memory * std::exp(-p.value[2] * duration);
        } else if (p.kind == EffectKind::ScarDrag) {
            p.memory2 += way;
        } else if (p.hook == EffectHook::Crossing) {
            cross(p, from, kinetic_energy, s);
        }
    }
}

template class BlockEffects<2>;
template class BlockEffects<3>;

}  // namespace scree
