// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/contact.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/surface.hpp"

#include <cstdint>
#include <vector>

namespace scree {

/// Contacts between one convex block and the terrain in 3D: block vertices on facets, terrain tips in faces, block edges on crests.
/// Keeps the terrain patch around the block from call to call.
class HullContacts {
public:
    /// `vertices_only` leaves out tips and crests (for comparison with codes that lack them).
    HullContacts(const ConvexBlock& block, const Surface& surface, bool vertices_only);

    /// All contacts with a gap of at most `reach` [m] for this pose, in an order that depends on the pose only.
    void detect(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts);

    /// Lower bound of every gap [m]: distance of the block from a plane that the terrain around it does not reach; cheap.
    double clearance(const Vec3& position, const Mat3& rotation);

    /// False if there is no terrain below the centre of mass: outside the DTM or over a hole.
    bool over_terrain(const Vec3& position);

    double radius() const { return block_.radius; }
    double inner_radius() const { return block_.inner_radius; }

private:
    void cover(const Vec3& position, double reach);
    void add_vertex_contacts(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts);
    void add_other_facets(const Vec3& p, const PatchFacet& below, double reach, Contact<3> contact, std::vector<Contact<3>>& contacts) const;
    void add_tip_contacts(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts);
    void add_crest_contacts(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts);
    /// A terrain crest in the body frame: the points a + t d, t in [0, 1].
    struct CrestInBody {
        const PatchEdge& edge;
        Vec3 a;  ///< [m]
        Vec3 d;  ///< [m]
    };
    /// The plane distance of face f along the crest is value + t slope [m].
    double value(Eigen::Index f, const CrestInBody& crest) const;
    double slope(Eigen::Index f, const CrestInBody& crest) const;
    void add_crest_contact(const CrestInBody& crest, double t, const Vec3& outward, Eigen::Index face, Eigen::Index other_face, double reach,
                           const Mat3& rotation, std::vector<Contact<3>>& contacts) const;
    void add_far_end(const CrestInBody& crest, double t, Eigen::Index face, double direction, double reach, const Mat3& rotation,
                     std::vector<Contact<3>>& contacts) const;

    /// True if terrain at p lies so far below the patch plane that the block, which does not reach down there, cannot touch it.
    bool below_block(const Vec3& p, double reach) const { return patch_.plane_normal.dot(p) - patch_.plane_offset < lowest_ - reach; }
    /// Largest of normal.p - offset over the faces; `face` is where.
    double outside(const Vec3& p_body, Eigen::Index& face) const;
    void measure_heights(const Vec3& position, const Mat3& rotation);

    const ConvexBlock& block_;
    const Surface& surface_;
    bool vertices_only_;
    TerrainPatch patch_;
    bool covered_ = false;
    Eigen::ArrayXd height_;       ///< of each vertex over the patch plane [m]
    mutable Eigen::ArrayXd face_value_;  ///< room for outside() [m]
    double lowest_ = 0.0;         ///< the least of them [m]
};

}  // namespace scree
