// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/state.hpp"
#include "scree/geometry/convex_block.hpp"
#include "scree/geometry/surface.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace scree {

struct PlaneApproach;

/// Contacts between one convex block and the terrain in 3D: block vertices on facets, terrain tips in faces, block edges on crests.
/// Keeps the terrain patch around the block from call to call.
class HullContacts {
public:
    /// `vertices_only` leaves out tips and crests (for comparison with codes that lack them). A tip or crest that is passed by may become a contact as the
    /// block turns; nearer than 5 mm and a fifth of the block's inner radius it is not waited for in flight, it would stop every flight over a crest: for a
    /// caller that takes a flight back to where an overlap begins. With `waits_for_all` flights wait for them, too.
    HullContacts(const ConvexBlock& block, const Surface& surface, bool vertices_only, bool waits_for_all = false);

    /// All contacts with a gap of at most `reach` [m] for this pose, in an order that depends on the pose and, where faces are equally
    /// near to a crest, on the look before.
    void detect(const Vec3& position, const Mat3& rotation, double reach, std::vector<Contact<3>>& contacts);

    /// Lower bound of every gap [m]: distance of the block from a plane that the terrain around it does not reach; cheap.
    double clearance(const Vec3& position, const Mat3& rotation);

    /// How long the block can fly from this state before anything may touch [s], at most kLongestFlight; `gap` is the smallest gap seen, infinite if
    /// the block is far enough not to look. Every point of the block is taken to move towards the terrain with its velocity of now and the largest
    /// acceleration that torque-free flight with a spin of at most `spin_bound` [rad/s] allows; bounds of second order make the steps long. `drag` is the
    /// acceleration of the centre of mass beside gravity, constant meanwhile, and slows it down in plan view.
    double free_time(const BlockState<3>& s, double spin_bound, double gravity, const Vec3& drag, double& gap);

    /// False if there is no terrain below the centre of mass: outside the DTM or over a hole.
    bool over_terrain(const Vec3& position);

    /// True if the centre of mass is deeper in the ground than the block is thick: no contact could be found that holds it.
    bool buried(const Vec3& position) const;

    /// True if at the last look a vertex hung beside the terrain, over a hole or outside, and below the plane that supports the terrain around: what
    /// it would touch there is not known, and coming back it would meet the ground from the side.
    bool beyond_rim() const { return beyond_rim_; }

    /// How deep the deepest terrain tip or crest was inside the block at the last look, whether a contact or not: one that is deeper in than any contact
    /// can be is none [m]. Zero: the block is free of them.
    double cut() const { return cut_; }

    double radius() const { return block_.radius; }
    double inner_radius() const { return block_.inner_radius; }

private:
    /// Velocity of the body's points in flight and how much it can change.
    struct Flight {
        Vec3 velocity;      ///< of the centre of mass [m/s]
        Vec3 spin;          ///< local frame [rad/s]
        Vec3 spin_change;   ///< its rate, local frame [rad/s^2]
        Vec3 spin_in_body;  ///< the same two in the body frame
        Vec3 spin_change_in_body;
        double turning;  ///< largest acceleration of a point relative to the centre of mass during the flight [m/s^2]
        double jerk;     ///< largest rate of change of that [m/s^3]
        double fastest;  ///< largest speed of a point now [m/s]
        double gravity;  ///< [m/s^2]
        Vec3 drag;       ///< [m/s^2]
        double pull;     ///< size of the drag [m/s^2]
        Vec3 velocity_at(const Vec3& arm) const { return velocity + spin.cross(arm); }
        Vec3 acceleration_at(const Vec3& arm) const {
            return spin_change.cross(arm) + spin.cross(spin.cross(arm)) - gravity * Vec3::UnitZ() + drag;
        }
        /// Acceleration of the centre of mass towards a plane.
        double fall(const Vec3& normal) const { return gravity * normal.z() - normal.dot(drag); }
    };
    double time_over_plane(const Vec3& position, const Mat3& rotation, const Flight& flight);
    double time_to_features(const Vec3& position, const Mat3& rotation, const Flight& flight, double& gap);
    double time_of_vertices(const Vec3& position, const Mat3& rotation, const Flight& flight, double horizon,
                            double& gap);
    double time_of_tips_and_crests(const Vec3& position, const Mat3& rotation, const Flight& flight, double horizon,
                                   double& gap);
    PlaneApproach approach(const Mat3& rotation, const Vec3& normal, const Flight& flight) const;
    double soonest_on_plane(const double* height, const Mat3& rotation, const Vec3& normal, const Flight& flight,
                            double horizon) const;
    bool keeps_above(const SupportingPlane& plane, const Vec3& position, const Mat3& rotation, const Flight& flight,
                     double time);
    double time_of_contact(const Mat3& rotation, const Contact<3>& contact, const Flight& flight, double horizon);
    double time_of_vertex(const Vec3& p, const Vec3& arm, const PatchFacet& below, const Flight& flight,
                          double horizon) const;
    double time_over(const Box2& box, const Vec3& position, const Flight& flight) const;
    void look_ahead(const Vec3& position, const Vec3& velocity);

    void cover(const Vec3& position, double reach, const Vec2& way);
    void add_vertex_contacts(const Vec3& position, const Mat3& rotation, double reach,
                             std::vector<Contact<3>>& contacts);
    void add_other_facets(const Vec3& p, const PatchFacet& below, double reach, Contact<3> contact,
                          std::vector<Contact<3>>& contacts) const;
    void add_tip_contact(std::size_t tip, const Vec3& position, const Mat3& rotation, double reach,
                         std::vector<Contact<3>>& contacts);
    void add_crest_contacts(std::size_t crest, const Vec3& position, const Mat3& rotation, double reach,
                            std::vector<Contact<3>>& contacts);
    /// A terrain crest in the body frame: the points a + t d, t in [0, 1].
    struct CrestInBody {
        const PatchEdge& edge;
        Vec3 a;  ///< [m]
        Vec3 d;  ///< [m]
    };
    bool add_crest_contact(const CrestInBody& crest, double t, const Vec3& outward, Eigen::Index face,
                           Eigen::Index other_face, double reach, const Mat3& rotation,
                           std::vector<Contact<3>>& contacts);
    bool add_cut_corner(const PatchEdge& edge, const Vec3& position, const Mat3& rotation,
                        std::vector<Contact<3>>& contacts);
    bool add_passed_corner(const PatchEdge& edge, const Vec3& position, const Mat3& rotation,
                           std::vector<Contact<3>>& contacts);
    Contact<3> shortest_way_out(const PatchEdge& edge, const Vec3& position, const Mat3& rotation);
    void add_hooked_corner(const Vec3& position, const Mat3& rotation, std::vector<Contact<3>>& contacts);
    double way_out(const Vec3& n, double& t) const;
    /// Where the highest of the block's faces is lowest along a crest.
    struct LowestOnCrest {
        double t;                  ///< place on the crest, 0 to 1 [-]
        double height;             ///< negative: depth in the block [m]
        Eigen::Index left, right;  ///< the faces that meet there; the same if it is at an end
    };
    LowestOnCrest lowest_on_crest(const double* value, std::pair<Eigen::Index, Eigen::Index> guess, double reach) const;
    void remember_passed(std::size_t crest, double outside) {
        if (-outside <= passed_depth_) return;
        passed_depth_ = -outside;
        passed_crest_ = crest;
    }
    void add_far_end(const CrestInBody& crest, double t, Eigen::Index face, double direction, double reach,
                     const Mat3& rotation, std::vector<Contact<3>>& contacts);

    double nearest_share(std::size_t crest, const Vec3& place) const;
    void advance_odometer(const Vec3& position, const Mat3& rotation);
    void measure_heights(const Vec3& position, const Mat3& rotation, const SupportingPlane& plane);

    const ConvexBlock& block_;
    const Surface& surface_;
    bool vertices_only_;
    double least_passed_by_;  ///< what is passed by nearer than this is not waited for [m]
    TerrainPatch patch_;
    bool covered_ = false;
    bool beyond_rim_ = false;
    double cut_ = 0.0;
    double passed_depth_ = 0.0;     ///< of the crest that is deepest in the block without being a contact [m]
    std::size_t passed_crest_ = 0;  ///< which one
    std::vector<std::pair<Eigen::Index, Eigen::Index>> edge_faces_;  ///< the two that were nearest to each crest
    std::vector<double> node_height_;  ///< of each tip of the patch over its plane: zero or less [m]
    std::vector<double> edge_height_;  ///< of the higher end of each crest [m]
    double odometer_ = 0.0;  ///< how far any point of the body can have moved since the start, from look to look [m]
    Vec3 last_position_ = Vec3::Zero();  ///< at the last look [m]
    Mat3 last_rotation_ = Mat3::Identity();
    std::vector<double> node_free_until_;  ///< a tip is out of reach while odometer + reach is less [m]
    std::vector<double> edge_free_until_;  ///< same for crests [m]
    std::vector<double> edge_per_square_;  ///< one over the square of each crest's length [1/m^2]
    std::vector<char> edge_sharp_;         ///< it can get through a thin part of the block between two looks
    double steepest_slope_ = 0.0;          ///< of the patch, tangent [-]
    std::vector<SupportingPlane>
        edge_apart_;                ///< body frame, normals not of unit length: the block is below, the crest was above
    SupportingPlane ahead_;         ///< over the terrain that the flight crosses next
    Box2 ahead_box_;                ///< where it holds; empty: nowhere
    double horizon_ = 0.1;          ///< how far ahead it is laid [s]
    double look_time_ = 0.02;       ///< how far ahead features are looked for in flight [s]
    std::vector<Contact<3>> near_;  ///< room for free_time
    std::vector<Contact<3>>
        passed_by_;  ///< tips and crests within reach that touch nothing in this pose: a vertex or another crest is nearer
    Eigen::ArrayXd vertex_free_until_;         ///< same for the block's vertices [m]
    std::vector<Eigen::Index> near_vertices_;  ///< room for those that a flight looks at
    Eigen::ArrayXd height_;                    ///< of each vertex over the plane last measured from [m]
    double lowest_ = 0.0;                      ///< the least of them [m]
    Eigen::ArrayXd height_over_feature_;       ///< the same over the plane through a tip or crest [m]
    Eigen::ArrayXd face_value_;  ///< plane distance of each face along the crest at hand: value + t slope [m]
    Eigen::ArrayXd face_slope_;  ///< [m]
};

}  // namespace scree
