// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/state.hpp"
#include "scree/geometry/convex_polygon.hpp"
#include "scree/geometry/ground_line.hpp"

#include <cstddef>
#include <vector>

namespace scree {

/// Contacts between one convex polygon and the ground of the 2D model: corners of the block on reaches, crests of the ground in sides of the block.
/// The plane's counterpart of HullContacts, with the same rules: a prism on extruded ground has the same contacts, each at both of its ends.
class PlaneContacts {
public:
    /// `vertices_only` leaves out crests (for comparison with codes that lack them). A crest that is passed by may become a contact as the block turns; nearer
    /// than 5 mm and a fifth of the block's inner radius it is not waited for in flight, a corner of the block is nearer to the ground beside it: for a caller
    /// that takes a flight back to where an overlap begins. With `waits_for_all` flights wait for them, too.
    PlaneContacts(const ConvexPolygon& block, const GroundLine& ground, bool vertices_only, bool waits_for_all = false);

    /// All contacts with a gap of at most `reach` [m] for this pose, in an order that depends on the pose only.
    void detect(const Vec2& position, const Mat2& rotation, double reach, std::vector<Contact<2>>& contacts);

    /// How long the block can fly from this state before anything may touch [s], at most kLongestFlight; `gap` is the smallest gap seen, infinite if
    /// the block is far enough not to look. In the plane the spin of a flying block is constant, so that gaps and their rates have exact
    /// derivatives with bounds of third order. `drag` is the acceleration of the centre of mass beside gravity, constant meanwhile, and slows it down
    /// along the profile.
    double free_time(const BlockState<2>& s, double spin_bound, double gravity, const Vec2& drag, double& gap);

    /// False before and beyond the ends of the profile.
    bool over_terrain(const Vec2& position) const { return ground_.contains(position.x()); }

    /// True if at the last look a corner of the block hung beside the ground, and below the straight continuation of its first or last reach: what it
    /// would touch there is not known.
    bool beyond_rim() const { return beyond_rim_; }

    /// True if the centre of mass is deeper in the ground than the block is thick: no contact could be found that holds it.
    bool buried(const Vec2& position) const;

    /// How deep the deepest crest was inside the block at the last look, whether a contact or not [m]. Zero: the block is free of them.
    double cut() const { return cut_; }

    /// How far the block must be raised to lie above the ground with all of its underside; 0 or less if it does [m]. Unlike contacts, this sees a block
    /// through which a needle of the ground passes.
    double sunk(const Vec2& position, const Mat2& rotation) const;

    double radius() const { return block_.radius; }
    double inner_radius() const { return block_.inner_radius; }

private:
    /// The motion in flight.
    struct Flight {
        Vec2 position;             ///< of the centre of mass [m]
        Mat2 rotation;             ///< body to local frame [-]
        Vec2 velocity;             ///< [m/s]
        double spin = 0.0;         ///< [rad/s]
        double gravity = 0.0;      ///< [m/s^2]
        Vec2 drag = Vec2::Zero();  ///< acceleration beside gravity [m/s^2]
        double pull = 0.0;         ///< size of the drag [m/s^2]
        double fastest = 0.0;      ///< largest speed of a point now [m/s]
        double turning = 0.0;      ///< largest acceleration of a point relative to the centre of mass [m/s^2]
        double jerk = 0.0;         ///< largest rate of change of that [m/s^3]
        /// Acceleration of the centre of mass towards a line.
        double fall(const Vec2& normal) const { return gravity * normal.y() - normal.dot(drag); }
    };
    /// A crest near the block.
    struct NearCrest {
        Vec2 point;                      ///< [m]
        std::size_t after = 0;           ///< number of the reach that begins there
        double height = 0.0;             ///< over the line of the neighbourhood: zero or less [m]
        double free_until = -kInfinity;  ///< out of reach while odometer + reach is less [m]
    };
    /// How the crest stands to the block: the side that it is farthest out of, or least deep in.
    struct SideAt {
        Eigen::Index side = 0;
        double outside = 0.0;  ///< distance from that side's line [m]
    };

    void cover(double s, double reach);
    Eigen::Index lowest_vertex(const Vec2& direction);
    void advance_odometer(const Vec2& position, const Mat2& rotation);
    void add_vertex_contacts(const Vec2& position, const Mat2& rotation, const Vec2& direction, double centre,
                             double reach, std::vector<Contact<2>>& contacts);
    void add_vertex_contact(const Vec2& position, const Mat2& rotation, Eigen::Index vertex, double reach,
                            std::vector<Contact<2>>& contacts);
    void add_crest_contacts(const Vec2& position, const Mat2& rotation, double lowest, double reach,
                            std::vector<Contact<2>>& contacts);
    SideAt side_at(const Vec2& in_body) const;
    bool falls_away(const NearCrest& crest, const Vec2& normal) const;
    void add_crest_contact(const NearCrest& crest, double gap, const Vec2& normal, const Vec2& arm,
                           std::vector<Contact<2>>& contacts) const;
    double way_out(const Vec2& p, const Vec2& n) const;
    void add_cut_corner(const NearCrest& crest, double outside, const Vec2& position, const Mat2& rotation,
                        std::vector<Contact<2>>& contacts);
    bool hangs_beside(const Vec2& p) const;
    std::size_t nearest_surface(const Vec2& p, std::size_t below) const;
    bool stands_through(const Vec2& arm, const Mat2& rotation) const;

    double time_in_stretch(const Flight& flight) const;
    void look_ahead(const Flight& flight);
    double time_to_ground(const Flight& flight, double horizon, double& gap);
    double time_of_vertex(const Flight& flight, Eigen::Index vertex, double horizon, double& gap);
    double time_of_crest(const Flight& flight, const NearCrest& crest, double horizon, double& gap);

    const ConvexPolygon& block_;
    const GroundLine& ground_;
    bool vertices_only_;
    double least_passed_by_;  ///< what is passed by nearer than this is not waited for [m]
    bool beyond_rim_ = false;
    double cut_ = 0.0;
    double from_ = kInfinity, to_ = -kInfinity;  ///< stretch that the neighbourhood covers [m]
    SupportingLine line_;                        ///< over the neighbourhood
    std::vector<NearCrest> crests_;              ///< of the neighbourhood
    Eigen::Index lowest_ = 0;                    ///< vertex found lowest last
    std::size_t below_ = 0;                      ///< reach found below a vertex last
    double odometer_ = 0.0;  ///< how far any point of the body can have moved since the start, from look to look [m]
    Vec2 last_position_ = Vec2::Zero();  ///< at the last look [m]
    Mat2 last_rotation_ = Mat2::Identity();
    SupportingLine ahead_;                                   ///< over the ground that the flight crosses next
    double ahead_from_ = kInfinity, ahead_to_ = -kInfinity;  ///< where it holds [m]
};

}  // namespace scree
