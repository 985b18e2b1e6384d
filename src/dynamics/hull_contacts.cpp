// SPDX-License-Identifier: GPL-3.0-or-later
#include "dynamics/hull_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// A vertex this close in plan view to the next facet touches that one too, if the two form a valley [m].
constexpr double kValleyMargin = 1e-3;
/// Normals closer than this are one plane: no second contact at the seam of coplanar facets (1 - cosine) [-].
constexpr double kSamePlane = 1e-12;
/// How far below the contact plane the terrain around a tip must fall, sine of the angle [-].
constexpr double kTipAngle = 1e-6;

}  // namespace

HullContacts::HullContacts(const ConvexBlock& block, const Surface& surface, bool vertices_only)
    : block_(block), surface_(surface), vertices_only_(vertices_only), height_(block.vertex_count()), face_value_(block.face_count()) {}

void HullContacts::cover(const Vec3& position, double reach) {
    const double half = block_.radius + reach;
    const Vec2 plan = position.head<2>();
    const Box2 needed = Box2{plan, plan}.grown(half);
    if (covered_ && patch_.box.contains(needed.min) && patch_.box.contains(needed.max)) return;
    // half a block more on each side: enough for many steps, little to copy
    surface_.gather(needed.grown(std::max(0.5 * block_.radius, 0.1)), patch_);
    covered_ = true;
}

bool HullContacts::over_terrain(const Vec3& position) {
    cover(position, 0.0);
    return patch_.facet_at(position.head<2>()) != nullptr;
}

double HullContacts::clearance(const Vec3& position, const Mat3& rotation) {
    cover(position, 0.0);
    if (patch_.facets.empty()) return kInfinity;
    const double centre = patch_.plane_normal.dot(position) - patch_.plane_offset;
    if (centre > 2.0 * block_.radius) return centre - block_.radius;
    measure_heights(position, rotation);
    return lowest_;
}

void HullContacts::measure_heights(const Vec3& position, const Mat3& rotation) {
    const double centre = patch_.plane_normal.dot(position) - patch_.plane_offset;
    const Vec3 n = rotation.transpose() * patch_.plane_normal;
    height_ = n.x() * block_.x + n.y() * block_.y + n.z() * block_.z + centre;
    lowest_ = height_.minCoeff();
}

void HullContacts::detect(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts) {
    contacts.clear();
    cover(position, reach);
    if (patch_.facets.empty()) return;
    const double centre = patch_.plane_normal.dot(position) - patch_.plane_offset;
    if (centre - block_.radius > reach) return;
    measure_heights(position, rotation);
    if (lowest_ > reach) return;
    add_vertex_contacts(position, rotation, reach, contacts);
    if (vertices_only_) return;
    add_tip_contacts(position, rotation, reach, contacts);
    add_crest_contacts(position, rotation, reach, contacts);
}

void HullContacts::add_vertex_contacts(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts) {
    for (Eigen::Index i = 0; i < height_.size(); ++i) {
        if (height_[i] > reach) continue;
        Contact<3> contact;
        contact.arm = rotation * block_.vertex(i);
        const Vec3 p = position + contact.arm;
        const PatchFacet* facet = patch_.facet_at(p.head<2>());
        if (!facet) continue;
        contact.gap = facet->gap(p);
        contact.normal = facet->normal;
        contact.soil = facet->soil;
        contact.key = {FeaturePair::VertexOnFacet, static_cast<std::int64_t>(i), facet->id};
        if (contact.gap <= reach) contacts.push_back(contact);
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
            if (f.id == below.id || f.inset(plan) < -kValleyMargin || 1.0 - f.normal.dot(below.normal) < kSamePlane) continue;
            if (f.height(plan) > below.height(plan) || f.gap(p) > reach) continue;
            const bool known = std::any_of(contacts.begin() + static_cast<std::ptrdiff_t>(first), contacts.end(), [&](const Contact<3>& c) {
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

double HullContacts::outside(const Vec3& p, Eigen::Index& face) const {
    face_value_ = block_.nx * p.x() + block_.ny * p.y() + block_.nz * p.z() - block_.offset;
    const double largest = face_value_.maxCoeff();
    face = 0;
    while (face_value_[face] != largest) ++face;
    return largest;
}

// A tip touches the face that it is least deep in, if the terrain around it falls away from that face's plane on all sides; else a crest or a vertex
// touches nearer.
void HullContacts::add_tip_contacts(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts) {
    const double far = block_.radius + reach;
    for (const PatchNode& node : patch_.nodes) {
        const Vec3 arm = node.position - position;
        if (arm.squaredNorm() > far * far || below_block(node.position, reach)) continue;
        const Vec3 p = rotation.transpose() * arm;
        Eigen::Index face = 0;
        if (outside(p, face) > reach) continue;
        const auto spokes = std::span(patch_.spokes).subspan(static_cast<std::size_t>(node.first), static_cast<std::size_t>(node.count));
        Contact<3> contact;
        contact.gap = block_.normal(face).dot(p) - block_.offset[face];
        contact.normal = -(rotation * block_.normal(face));
        if (contact.gap < -block_.inner_radius) continue;
        if (std::any_of(spokes.begin(), spokes.end(), [&](const PatchSpoke& s) { return contact.normal.dot(s.direction) > -kTipAngle; })) continue;
        contact.arm = arm;
        double closest = -1.0;
        for (const PatchSpoke& s : spokes) {
            if (s.normal.dot(contact.normal) <= closest) continue;
            closest = s.normal.dot(contact.normal);
            contact.soil = s.soil;
        }
        contact.key = {FeaturePair::NodeInFace, 0, node.id};
        contacts.push_back(contact);
    }
}

// Along the crest a + t (b - a), phi(t) = max_f (n_f.x - d_f) over the block's faces is convex and piecewise linear: its least value is how deep the crest
// is in the block. Where that lies inside the crest, two faces meet: their common edge crosses the crest, and the combination of the two normals that
// is perpendicular to the crest is the direction of contact. Where a face lies almost flat on the crest, the other end of the face touches too.
void HullContacts::add_crest_contacts(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts) {
    const double far = block_.radius + reach;
    for (const PatchEdge& edge : patch_.edges) {
        const Vec3 along = edge.b - edge.a;
        const Vec3 from_a = position - edge.a;
        const double foot = std::clamp(along.dot(from_a) / along.squaredNorm(), 0.0, 1.0);
        if ((from_a - foot * along).squaredNorm() > far * far || (below_block(edge.a, reach) && below_block(edge.b, reach))) continue;
        // the direction from the crest's nearest point to the centre separates the two if the block does not reach that far
        const Vec3 to_crest = rotation.transpose() * (foot * along - from_a);
        const double distance = to_crest.norm();
        if (distance - (to_crest.x() * block_.x + to_crest.y() * block_.y + to_crest.z() * block_.z).maxCoeff() / distance > reach) continue;
        const CrestInBody crest{edge, rotation.transpose() * -from_a, rotation.transpose() * along};

        // minimise phi between a falling face (left) and a rising one (right), replacing one of them by the highest face where they meet
        Eigen::Index left = 0, right = 0, top = 0;
        outside(crest.a, left);
        outside(crest.a + crest.d, right);
        // least at an end: the tip there touches, or the next crest; a face that lies almost flat across that end touches here with its other end
        if (slope(left, crest) >= 0.0) {
            add_far_end(crest, 0.0, left, +1.0, reach, rotation, contacts);
            continue;
        }
        if (slope(right, crest) <= 0.0) {
            add_far_end(crest, 1.0, right, -1.0, reach, rotation, contacts);
            continue;
        }
        double t = 0.0;
        for (int k = 0; k < 64; ++k) {
            t = (value(right, crest) - value(left, crest)) / (slope(left, crest) - slope(right, crest));
            const double phi = outside(crest.a + t * crest.d, top);
            const double bound = value(left, crest) + t * slope(left, crest);  // from below, for the minimum
            if (bound > reach || top == left || top == right || phi <= bound + 1e-14) break;
            (slope(top, crest) < 0.0 ? left : right) = top;
        }
        const double share = -slope(right, crest) / (slope(left, crest) - slope(right, crest));  // of left: the sum is perpendicular to the crest
        add_crest_contact(crest, t, share * block_.normal(left) + (1.0 - share) * block_.normal(right), left, right, reach, rotation, contacts);
        add_far_end(crest, t, right, +1.0, reach, rotation, contacts);
        add_far_end(crest, t, left, -1.0, reach, rotation, contacts);
    }
}

double HullContacts::slope(Eigen::Index f, const CrestInBody& c) const {
    return block_.nx[f] * c.d.x() + block_.ny[f] * c.d.y() + block_.nz[f] * c.d.z();
}
double HullContacts::value(Eigen::Index f, const CrestInBody& c) const {
    return block_.nx[f] * c.a.x() + block_.ny[f] * c.a.y() + block_.nz[f] * c.a.z() - block_.offset[f];
}

// It counts only if both terrain facets fall away from the plane through the crest with this normal.
void HullContacts::add_crest_contact(const CrestInBody& crest, double t, const Vec3& outward, Eigen::Index face, Eigen::Index other_face, double reach,
                                     const Mat3& rotation, std::vector<Contact<3>>& contacts) const {
    const double length = outward.norm();
    if (length < 1e-9) return;
    Contact<3> contact;
    contact.gap = (value(face, crest) + t * slope(face, crest)) / length;
    if (contact.gap > reach || contact.gap < -block_.inner_radius) return;
    contact.normal = rotation * (-outward / length);
    const PatchEdge& edge = crest.edge;
    if (contact.normal.dot(edge.beyond[0] - edge.a) >= 0.0 || contact.normal.dot(edge.beyond[1] - edge.a) >= 0.0) return;
    contact.arm = rotation * (crest.a + t * crest.d);
    contact.soil = edge.soil[contact.normal.dot(edge.normal[0]) >= contact.normal.dot(edge.normal[1]) ? 0 : 1];
    const auto [low, high] = std::minmax(face, other_face);
    contact.key = {FeaturePair::EdgeOnEdge, static_cast<std::int64_t>(low * block_.face_count() + high), edge.id};
    contacts.push_back(contact);
}

// From the deepest point the crest follows one face in the given direction up to the next face that rises above it.
void HullContacts::add_far_end(const CrestInBody& crest, double t, Eigen::Index face, double direction, double reach, const Mat3& rotation,
                               std::vector<Contact<3>>& contacts) const {
    const double rise = slope(face, crest);
    const double room = direction > 0.0 ? 1.0 - t : t;
    if (value(face, crest) + t * rise + std::abs(rise) * std::min(room, 0.02) > reach) return;  // steep: the far end is out of reach
    double nearest = room;
    Eigen::Index next = face;
    for (Eigen::Index f = 0; f < block_.face_count(); ++f) {
        const double steeper = direction * (slope(f, crest) - rise);
        if (steeper <= 1e-12) continue;
        const double distance = (value(face, crest) + t * rise - value(f, crest) - t * slope(f, crest)) / steeper;
        if (distance >= 1e-9 && distance < nearest) {
            nearest = distance;
            next = f;
        }
    }
    if (next == face) return;  // the face reaches beyond the crest's end: the tip there touches
    const Vec3 unit = crest.d.normalized();
    const Vec3 normal = block_.normal(face);
    add_crest_contact(crest, t + direction * nearest, normal - normal.dot(unit) * unit, face, next, reach, rotation, contacts);
}

}  // namespace scree
