// SPDX-License-Identifier: GPL-3.0-or-later
#include "dynamics/hull_contacts.hpp"

#include "dynamics/contact_lengths.hpp"
#include "geometry/hull_kernels.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// Directions between the facets of a crest that are tried for a cut corner [-].
constexpr int kCornerSamples = 8;
/// Crests between facets whose normals are farther apart are sharp: they can get through a thin part of a block unseen (cosine) [-].
constexpr double kSharpCrest = 0.5;
/// How far below the contact plane the terrain around a tip must fall, sine of the angle [-].
constexpr double kTipAngle = 1e-6;

}  // namespace

HullContacts::HullContacts(const ConvexBlock& block, const Surface& surface, bool vertices_only, bool waits_for_all)
    : block_(block),
      surface_(surface),
      vertices_only_(vertices_only),
      least_passed_by_(waits_for_all ? -kInfinity : std::min(kPassedBy, kPassedByShare * block.inner_radius)),
      vertex_free_until_(block.x.size()),
      near_vertices_(static_cast<std::size_t>(block.x.size())),
      height_(block.x.size()),
      height_over_feature_(block.x.size()),
      face_value_(block.nx.size()),
      face_slope_(block.nx.size()) {}

void HullContacts::cover(const Vec3& position, double reach, const Vec2& way) {
    const double half = block_.radius + reach;
    const Vec2 plan = position.head<2>();
    Box2 needed = Box2{plan, plan}.grown(half);
    if (covered_ && patch_.box.contains(needed.min) && patch_.box.contains(needed.max)) return;
    // half a block more on each side, or what the block is about to fly over: enough for many steps, little to copy
    needed.add(needed.min + way);
    needed.add(needed.max + way);
    surface_.gather(needed.grown(std::max(0.5 * block_.radius, 0.1)), patch_);
    covered_ = true;
    node_free_until_.assign(patch_.nodes.size(), -kInfinity);
    edge_free_until_.assign(patch_.edges.size(), -kInfinity);
    const double level = patch_.least_normal_z;
    steepest_slope_ = std::sqrt(std::max(0.0, 1.0 - level * level)) / level;
    edge_apart_.assign(patch_.edges.size(), SupportingPlane{Vec3::Zero(), kInfinity, false});
    vertex_free_until_.setConstant(-kInfinity);
    node_height_.clear();
    edge_faces_.assign(patch_.edges.size(), {0, 0});
    edge_height_.clear();
    edge_per_square_.clear();
    edge_sharp_.clear();
    for (const PatchNode& n : patch_.nodes) node_height_.push_back(patch_.plane.height(n.position));
    for (const PatchEdge& e : patch_.edges) {
        edge_height_.push_back(std::max(patch_.plane.height(e.a), patch_.plane.height(e.b)));
        edge_per_square_.push_back(1.0 / (e.b - e.a).squaredNorm());
        edge_sharp_.push_back(e.normal(0).dot(e.normal(1)) < kSharpCrest);
    }
}

/// Where along a crest the point is that is nearest to a place: 0 to 1.
double HullContacts::nearest_share(std::size_t crest, const Vec3& place) const {
    const PatchEdge& edge = patch_.edges[crest];
    return std::clamp((edge.b - edge.a).dot(place - edge.a) * edge_per_square_[crest], 0.0, 1.0);
}

bool HullContacts::over_terrain(const Vec3& position) {
    const Vec2 plan = position.head<2>();
    if (ahead_.whole && ahead_box_.contains(plan)) return true;
    if (covered_ && patch_.box.contains(plan)) return patch_.facet_at(plan) != nullptr;
    return surface_.facet_at(plan) >= 0;
}

bool HullContacts::buried(const Vec3& position) const {
    const PatchFacet* facet =
        covered_ && patch_.box.contains(position.head<2>()) ? patch_.facet_at(position.head<2>()) : nullptr;
    return facet && facet->gap(position) < -block_.inner_radius;
}

double HullContacts::clearance(const Vec3& position, const Mat3& rotation) {
    cover(position, 0.0, Vec2::Zero());
    if (patch_.facets.empty()) return kInfinity;
    const double centre = patch_.plane.height(position);
    if (centre > 2.0 * block_.radius) return centre - block_.radius;
    measure_heights(position, rotation, patch_.plane);
    return lowest_;
}

void HullContacts::measure_heights(const Vec3& position, const Mat3& rotation, const SupportingPlane& plane) {
    lowest_ = plane_heights(block_, rotation.transpose() * plane.normal, plane.height(position), height_.data());
}

void HullContacts::detect(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts) {
    contacts.clear();
    passed_by_.clear();
    beyond_rim_ = false;
    cut_ = passed_depth_ = 0.0;
    cover(position, reach, Vec2::Zero());
    if (patch_.facets.empty()) return;
    if (patch_.plane.height(position) - block_.radius > reach) return;
    measure_heights(position, rotation, patch_.plane);
    if (lowest_ > reach) return;
    advance_odometer(position, rotation);
    add_vertex_contacts(position, rotation, reach, contacts);
    if (vertices_only_) return;
    for (std::size_t k = 0; k < patch_.nodes.size(); ++k) {
        if (node_height_[k] < lowest_ - reach) continue;        // the block does not reach down there
        if (odometer_ + reach < node_free_until_[k]) continue;  // it was farther away than the block has moved since
        add_tip_contact(k, position, rotation, reach, contacts);
    }
    for (std::size_t k = 0; k < patch_.edges.size(); ++k) {
        if (edge_height_[k] < lowest_ - reach) continue;  // as above
        if (odometer_ + reach < edge_free_until_[k]) continue;
        add_crest_contacts(k, position, rotation, reach, contacts);
    }
    if (passed_depth_ > kHooked) add_hooked_corner(position, rotation, contacts);
}

// No point of the body moves farther than the centre of mass plus radius times the norm of the change of rotation.
void HullContacts::advance_odometer(const Vec3& position, const Mat3& rotation) {
    odometer_ += (position - last_position_).norm() + block_.radius * (rotation - last_rotation_).norm();
    last_position_ = position;
    last_rotation_ = rotation;
}

void HullContacts::add_vertex_contacts(const Vec3& position, const Mat3& rotation, double reach,
                                       std::vector<Contact<3>>& contacts) {
    // not those that were higher up than the block has moved since
    const std::size_t count = vertices_in_reach(block_, height_.data(), reach, vertex_free_until_.data(),
                                                odometer_ + reach, near_vertices_.data());
    for (std::size_t k = 0; k < count; ++k) {
        const Eigen::Index i = near_vertices_[k];
        Contact<3> contact;
        contact.arm = rotation * block_.vertex(i);
        const Vec3 p = position + contact.arm;
        const PatchFacet* facet = patch_.facet_at(p.head<2>());
        if (!facet) {
            beyond_rim_ = beyond_rim_ || height_[i] < 0.0;
            continue;
        }
        contact.gap = facet->gap(p);
        contact.normal = facet->normal;
        contact.soil = facet->soil;
        contact.motion = ContactMotion::TurnsWithBlock;
        contact.key = {FeaturePair::VertexOnFacet, static_cast<std::int64_t>(i), facet->id};
        if (contact.gap <= reach) {
            contacts.push_back(contact);
        } else if (patch_.plane.whole) {
            // by moving d it comes at most d / cos nearer to the terrain below, cos of the steepest facet's slope
            vertex_free_until_[i] =
                odometer_ + contact.gap * patch_.least_normal_z / facet->normal.z() * kOdometerShare;
        }
        if (facet->inset(p.head<2>()) < kValleyMargin) add_other_facets(p, *facet, reach, contact, contacts);
    }
}

// In a valley a vertex can touch facets on both sides. The neighbour counts if its plane passes below the surface at p (a valley: the surface is the
// upper of the planes); across a crest it passes above and must not count.
void HullContacts::add_other_facets(const Vec3& p, const PatchFacet& below, double reach, Contact<3> contact,
                                    std::vector<Contact<3>>& contacts) const {
    const Vec2 plan = p.head<2>();
    const std::size_t first = contacts.size();
    for (const Vec2& shift : {Vec2(-1, -1), Vec2(1, -1), Vec2(-1, 1), Vec2(1, 1)}) {
        for (const std::int32_t number : patch_.facets_near(plan + kValleyMargin * shift)) {
            const PatchFacet& f = patch_.facets[static_cast<std::size_t>(number)];
            if (f.id == below.id || f.inset(plan) < -kValleyMargin || 1.0 - f.normal.dot(below.normal) < kSamePlane)
                continue;
            if (f.height(plan) > below.height(plan) || f.gap(p) > reach) continue;
            const bool known = std::any_of(
                contacts.begin() + static_cast<std::ptrdiff_t>(first), contacts.end(), [&](const Contact<3>& c) {
                    return c.key.terrain == f.id || 1.0 - c.normal.dot(f.normal) < kSamePlane;
                });
            if (known) continue;
            contact.gap = f.gap(p);
            contact.normal = f.normal;
            contact.soil = f.soil;
            contact.key.terrain = f.id;
            contacts.push_back(contact);
        }
    }
}

// A tip touches the face that it is least deep in, if the terrain around it falls away from that face's plane on all sides; else a crest or a vertex
// touches nearer.
void HullContacts::add_tip_contact(std::size_t k, const Vec3& position, const Mat3& rotation, double reach,
                                   std::vector<Contact<3>>& contacts) {
    const PatchNode& node = patch_.nodes[k];
    const Vec3 arm = node.position - position;
    const double distance = arm.norm();
    if (distance > block_.radius + reach) {
        node_free_until_[k] = odometer_ + (distance - block_.radius) * kOdometerShare;
        return;
    }
    const Vec3 p = rotation.transpose() * arm;
    Eigen::Index face = 0;
    const double outside = farthest_face(block_, p, face);
    if (outside > reach) {
        node_free_until_[k] = odometer_ + outside * kOdometerShare;
        return;
    }
    cut_ = std::max(cut_, -outside);
    const auto spokes =
        std::span(patch_.spokes).subspan(static_cast<std::size_t>(node.first), static_cast<std::size_t>(node.count));
    Contact<3> contact;
    contact.gap = block_.normal(face).dot(p) - block_.offset[face];
    contact.normal = -(rotation * block_.normal(face));
    if (contact.gap < -block_.inner_radius) return;
    contact.motion = ContactMotion::PassesBlock;
    contact.arm = arm;
    contact.key = {FeaturePair::NodeInFace, 0, node.id};
    if (std::any_of(spokes.begin(), spokes.end(),
                    [&](const PatchSpoke& s) { return contact.normal.dot(s.edge) > -kTipAngle * s.edge.norm(); })) {
        passed_by_.push_back(contact);
        return;
    }
    double closest = -1.0;
    for (std::size_t s = 0; s < spokes.size(); ++s) {
        const Vec3 facet = spokes[s].edge.cross(spokes[(s + 1) % spokes.size()].edge).normalized();
        if (facet.dot(contact.normal) <= closest) continue;
        closest = facet.dot(contact.normal);
        contact.soil = spokes[s].soil;
    }
    contacts.push_back(contact);
}

// Between a falling face (left) and a rising one (right), one of which is replaced by the highest face where they meet: the two given, or else the
// highest at both ends.
HullContacts::LowestOnCrest HullContacts::lowest_on_crest(const double* value,
                                                          std::pair<Eigen::Index, Eigen::Index> guess,
                                                          double reach) const {
    const double* slope = face_slope_.data();
    LowestOnCrest low{0.0, 0.0, guess.first, guess.second};
    auto meet = [&] {
        low.t = (value[low.right] - value[low.left]) / (slope[low.left] - slope[low.right]);
        low.height = value[low.left] + low.t * slope[low.left];  // the minimum is no less
    };
    Eigen::Index top = 0;
    if (slope[low.left] < 0.0 && slope[low.right] > 0.0) {
        meet();
        if (low.t > 0.0 && low.t < 1.0 && farthest_on_line(block_, value, slope, low.t, top) <= low.height + 1e-14)
            return low;
    }
    farthest_on_line(block_, value, slope, 0.0, low.left);
    farthest_on_line(block_, value, slope, 1.0, low.right);
    if (slope[low.left] >= 0.0 || slope[low.right] <= 0.0) {
        low.t = slope[low.left] >= 0.0 ? 0.0 : 1.0;
        (low.t == 0.0 ? low.right : low.left) = low.t == 0.0 ? low.left : low.right;
        low.height = value[low.left] + low.t * slope[low.left];
        return low;
    }
    for (int turn = 0; turn < 64; ++turn) {
        meet();
        const double phi = farthest_on_line(block_, value, slope, low.t, top);
        if (low.height > reach || top == low.left || top == low.right || phi <= low.height + 1e-14) break;
        (slope[top] < 0.0 ? low.left : low.right) = top;
    }
    return low;
}

/// True if a facet of the crest does not fall away from the plane with this normal, but for the slack.
static bool falls_short(const Vec3& normal, const PatchEdge& edge, std::size_t side) {
    const Vec3 away = edge.beyond[side] - edge.a;
    const double rise = normal.dot(away);
    return rise > 0.0 && rise * rise > kConeSlack * kConeSlack * away.squaredNorm();
}

static bool falls_away(const Vec3& normal, const PatchEdge& edge) {
    return !falls_short(normal, edge, 0) && !falls_short(normal, edge, 1);
}

// Along the crest a + t (b - a), phi(t) = max_f (n_f.x - d_f) over the block's faces is convex and piecewise linear: its least value is how deep the crest
// is in the block. Where that lies inside the crest, two faces meet: their common edge crosses the crest, and the combination of the two normals that
// is perpendicular to the crest is the direction of contact. Where a face lies almost flat on the crest, the other end of the face touches too.
void HullContacts::add_crest_contacts(std::size_t k, const Vec3& position, const Mat3& rotation, double reach,
                                      std::vector<Contact<3>>& contacts) {
    const PatchEdge& edge = patch_.edges[k];
    const CrestInBody crest{edge, rotation.transpose() * (edge.a - position), rotation.transpose() * (edge.b - edge.a)};
    // a plane that has separated the two may still do
    SupportingPlane& apart = edge_apart_[k];
    double room = apart.height(crest.a) + std::min(apart.normal.dot(crest.d), 0.0);
    Vec3 outward = apart.normal;
    if (!(room > reach)) {
        // the direction from the crest's nearest point to the centre does if the block does not reach that far
        outward = crest.a + nearest_share(k, position) * crest.d;
        const double distance = outward.norm();
        room = distance - (distance > block_.radius + reach ? block_.radius : support(block_, outward) / distance);
    }
    // where the terrain does not fall away from that plane, a sharp crest may have got through a thin part of the block since the last look
    auto may_be_through = [&](double distance) {
        return edge_sharp_[k] && distance >= 0.0 && distance < block_.inner_radius &&
               !falls_away(rotation * -outward.normalized(), edge);
    };
    if (room > reach && !may_be_through(room)) {
        edge_free_until_[k] = odometer_ + room * kOdometerShare;
        return;
    }

    face_lines(block_, crest.a, crest.d, face_value_.data(), face_slope_.data());
    const LowestOnCrest low = lowest_on_crest(face_value_.data(), edge_faces_[k], reach);
    const double outside = low.height;
    if (outside < 0.0) cut_ = std::max(cut_, -outside);
    const Eigen::Index left = low.left, right = low.right;
    const double t = low.t, *slope = face_slope_.data();
    // of left: the sum is perpendicular to the crest
    const double share = left == right ? 1.0 : -slope[right] / (slope[left] - slope[right]);
    outward = share * block_.normal(left) + (1.0 - share) * block_.normal(right);
    if (may_be_through(outside) && add_passed_corner(edge, position, rotation, contacts)) return;
    // least at an end: the tip there touches, or the next crest; a face that lies almost flat across that end touches here with its other end
    if (low.left == low.right) {
        apart = {block_.normal(low.left), block_.offset[low.left], false};
        if (outside > reach)
            edge_free_until_[k] = odometer_ + outside * kOdometerShare;
        else
            add_far_end(crest, low.t, low.left, low.t == 0.0 ? +1.0 : -1.0, reach, rotation, contacts);
        remember_passed(k, outside);
        return;
    }
    edge_faces_[k] = {left, right};
    apart = {outward, share * block_.offset[left] + (1.0 - share) * block_.offset[right], false};
    if (outside > reach) {
        edge_free_until_[k] = odometer_ + outside * kOdometerShare;
        return;
    }
    if (!add_crest_contact(crest, t, outward, left, right, reach, rotation, contacts) && outside < 0.0 &&
        !add_cut_corner(edge, position, rotation, contacts))
        remember_passed(k, outside);
    add_far_end(crest, t, right, +1.0, reach, rotation, contacts);
    add_far_end(crest, t, left, -1.0, reach, rotation, contacts);
}

// It counts only if both terrain facets fall away from the plane through the crest with this normal; false if they do not.
bool HullContacts::add_crest_contact(const CrestInBody& crest, double t, const Vec3& outward, Eigen::Index face,
                                     Eigen::Index other_face, double reach, const Mat3& rotation,
                                     std::vector<Contact<3>>& contacts) {
    const double length = outward.norm();
    if (length < 1e-9) return true;
    Contact<3> contact;
    contact.gap = (face_value_[face] + t * face_slope_[face]) / length;
    if (contact.gap > reach || contact.gap < -block_.inner_radius) return true;
    contact.normal = rotation * (-outward / length);
    const PatchEdge& edge = crest.edge;
    contact.arm = rotation * (crest.a + t * crest.d);
    contact.key.pair = FeaturePair::EdgeOnEdge;
    if (!falls_away(contact.normal, edge)) {
        passed_by_.push_back(contact);
        return false;
    }
    contact.soil = edge.soil[contact.normal.dot(edge.normal(0)) >= contact.normal.dot(edge.normal(1)) ? 0 : 1];
    const auto [low, high] = std::minmax(face, other_face);
    contact.key = {FeaturePair::EdgeOnEdge, static_cast<std::int64_t>(low * block_.face_count() + high), edge.id};
    contacts.push_back(contact);
    return true;
}

// A crest that has cut into a corner of the block may be nearest to faces that it did not come through. What the terrain can push along are the
// directions between the normals of the crest's facets: the contact is the one among them in which the overlap is least. At either end of the range a
// vertex touches a facet, which is found as such, or hooks under the crest (add_hooked_corner).
bool HullContacts::add_cut_corner(const PatchEdge& edge, const Vec3& position, const Mat3& rotation,
                                  std::vector<Contact<3>>& contacts) {
    const std::array<Vec3, 2> facet{edge.normal(0), edge.normal(1)};
    auto direction = [&](double s) -> Vec3 { return ((1.0 - s) * facet[0] + s * facet[1]).normalized(); };
    auto separation = [&](double s) {
        const Vec3 n = direction(s);
        return n.dot(position - edge.a) - support(block_, rotation.transpose() * -n);
    };
    double best = 0.0, most = -kInfinity;
    for (int k = 0; k <= kCornerSamples; ++k) {
        const double s = static_cast<double>(k) / kCornerSamples;
        const double room = separation(s);
        if (room > most) {
            most = room;
            best = s;
        }
    }
    double low = best - 1.0 / kCornerSamples, high = best + 1.0 / kCornerSamples;
    if (low < 0.0 || high > 1.0) return false;
    for (int k = 0; k < 24; ++k) {
        const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
        (separation(a) < separation(b) ? low : high) = separation(a) < separation(b) ? a : b;
    }
    // the vertices that are lowest on either side of the best direction: their edge crosses the crest
    Vec3 end[2];
    std::int64_t number[2];
    for (int side = 0; side < 2; ++side) {
        const Vec3 n = rotation.transpose() * direction(side == 0 ? low : high);
        Eigen::Index lowest = 0;
        (n.x() * block_.x + n.y() * block_.y + n.z() * block_.z).head(block_.vertex_count()).minCoeff(&lowest);
        end[side] = rotation * block_.vertex(lowest);
        number[side] = lowest;
    }
    Contact<3> contact;
    contact.normal = direction(0.5 * (low + high));
    const Vec3 along = edge.b - edge.a;
    const Vec3 across = contact.normal.cross(along);
    const double before = across.dot(position + end[0] - edge.a), after = across.dot(position + end[1] - edge.a);
    if (!(before * after < 0.0)) return false;
    const Vec3 crossing = position + end[0] + before / (before - after) * (end[1] - end[0]) - edge.a;
    const double t = along.dot(crossing) / along.squaredNorm();
    if (t < 0.0 || t > 1.0) return false;
    contact.arm = edge.a + t * along - position;  // on the crest, as for every contact with one
    contact.gap = contact.normal.dot(crossing);
    if (contact.gap > 0.0 || contact.gap < -block_.inner_radius) return false;
    contact.soil = edge.soil[low + high < 1.0 ? 0 : 1];
    const auto [first, second] = std::minmax(number[0], number[1]);
    const std::int64_t faces = block_.face_count();
    contact.key = {FeaturePair::EdgeOnEdge, faces * faces + first * block_.vertex_count() + second, edge.id};
    contacts.push_back(contact);
    return true;
}

// A corner that slips over a crest may hook under it: the faces that it is nearest to push it deeper in, and the vertex that should hold it is
// beyond the crest. What is cut deeper than contacts are left with is pushed out along the shortest way.
void HullContacts::add_hooked_corner(const Vec3& position, const Mat3& rotation, std::vector<Contact<3>>& contacts) {
    for (const Contact<3>& c : contacts)
        if (-c.gap > 0.5 * passed_depth_) return;  // on its way out already
    const Contact<3> contact = shortest_way_out(patch_.edges[passed_crest_], position, rotation);
    if (contact.gap >= -block_.inner_radius) contacts.push_back(contact);
}

// For a crest that is outside the block, beyond faces that the terrain does not fall away from: if a point of the block lies in the ground below the
// crest, deeper than contacts are left with and than those found so far, it has got there through the block.
bool HullContacts::add_passed_corner(const PatchEdge& edge, const Vec3& position, const Mat3& rotation,
                                     std::vector<Contact<3>>& contacts) {
    const Contact<3> contact = shortest_way_out(edge, position, rotation);
    if (contact.gap < -block_.inner_radius) return false;
    const Vec3 inside = position + contact.arm + contact.gap * contact.normal;
    const PatchFacet* facet = patch_.facet_at(inside.head<2>());
    if (!facet || facet->gap(inside) >= -kHooked) return false;
    for (const Contact<3>& c : contacts)
        if (c.gap <= facet->gap(inside)) return false;
    contacts.push_back(contact);
    return true;
}

// Contact of a crest along the direction, between the normals of its facets, both included, in which the block's way out is shortest.
Contact<3> HullContacts::shortest_way_out(const PatchEdge& edge, const Vec3& position, const Mat3& rotation) {
    const Vec3 a = rotation.transpose() * (edge.a - position), d = rotation.transpose() * (edge.b - edge.a);
    face_lines(block_, a, d, face_value_.data(), face_slope_.data());
    const Vec3 facet[2] = {edge.normal(0), edge.normal(1)};
    Contact<3> contact;
    contact.gap = -kInfinity;
    for (int k = 0; k <= kCornerSamples; ++k) {
        const double s = static_cast<double>(k) / kCornerSamples;
        const Vec3 normal = ((1.0 - s) * facet[0] + s * facet[1]).normalized();
        double t = 0.0;
        const double way = way_out(rotation.transpose() * normal, t);
        // not above zero: the block passes the crest by in that direction
        if (way <= 0.0 || -way <= contact.gap) continue;
        contact.gap = -way;
        contact.normal = normal;
        contact.arm = rotation * (a + t * d);
        contact.soil = edge.soil[s < 0.5 ? 0 : 1];
    }
    const std::int64_t faces = block_.face_count(), vertices = block_.vertex_count();
    contact.key = {FeaturePair::EdgeOnEdge, faces * faces + vertices * vertices, edge.id};
    return contact;
}

// How far the block must go along n until the crest is on its surface: the height of the lowest point of the crest over the faces is a convex function of
// that way; Newton's method from far outside comes down to its zero, step by step along its pieces.
double HullContacts::way_out(const Vec3& n, double& t) const {
    const Eigen::ArrayXd rate = -(block_.nx * n.x() + block_.ny * n.y() + block_.nz * n.z());
    double way = 2.0 * block_.radius;
    std::pair<Eigen::Index, Eigen::Index> faces{0, 0};
    for (int k = 0; k < 64; ++k) {
        const Eigen::ArrayXd value = face_value_ + way * rate;
        const LowestOnCrest low = lowest_on_crest(value.data(), faces, kInfinity);
        faces = {low.left, low.right};
        t = low.t;
        double rise = rate[low.left];
        if (low.left != low.right) {
            const double share = face_slope_[low.right] / (face_slope_[low.right] - face_slope_[low.left]);
            rise = share * rate[low.left] + (1.0 - share) * rate[low.right];
        }
        if (low.height <= 1e-12) break;
        if (!(rise > 0.0)) return kInfinity;  // the block never meets the crest
        way -= low.height / rise;
    }
    return way;
}

// From the deepest point the crest follows one face in the given direction up to the next face that rises above it.
void HullContacts::add_far_end(const CrestInBody& crest, double t, Eigen::Index face, double direction, double reach,
                               const Mat3& rotation, std::vector<Contact<3>>& contacts) {
    const double rise = face_slope_[face];
    const double room = direction > 0.0 ? 1.0 - t : t;
    if (face_value_[face] + t * rise + std::abs(rise) * std::min(room, 0.02) > reach)
        return;  // steep: the far end is out of reach
    Eigen::Index next = face;
    const double nearest = next_on_line(block_, face_value_.data(), face_slope_.data(), t, face, direction, room, next);
    if (next == face) return;  // the face reaches beyond the crest's end: the tip there touches
    const Vec3 unit = crest.d.normalized();
    const Vec3 normal = block_.normal(face);
    add_crest_contact(crest, t + direction * nearest, normal - normal.dot(unit) * unit, face, next, reach, rotation,
                      contacts);
}

}  // namespace scree
