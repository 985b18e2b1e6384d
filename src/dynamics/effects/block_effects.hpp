// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dynamics/effects/drag_flight.hpp"

#include "scree/base/random.hpp"
#include "scree/dynamics/contact.hpp"
#include "scree/dynamics/effects.hpp"
#include "scree/dynamics/soil.hpp"
#include "scree/dynamics/state.hpp"

#include <optional>
#include <span>
#include <vector>

namespace scree {

/// The ground as effects see it.
template <int Dim>
class EffectGround {
public:
    using Vec = typename Space<Dim>::Vec;
    virtual ~EffectGround() = default;
    virtual double height(
        const Vec& position) const = 0;               ///< of the ground below or above, NaN where there is none [m]
    virtual int soil(const Vec& position) const = 0;  ///< SoilId there, -1 where there is no ground
};

/// e [-], mu [-], mu_r [m] of one contact.
struct ContactLaw {
    double restitution = 0.0;
    double friction = 0.0;
    double rolling = 0.0;
};

/// How a contact moves.
struct ContactSpeed {
    double approach = 0.0;  ///< normal to the ground, 0 if the contact parts [m/s]
    double sliding = 0.0;   ///< along the ground [m/s]
};

/// All effects on the motion of one block, with what they remember of its way. The engine asks; no effect adds energy:
/// e stays within [0, 1], friction and rolling resistance only dissipate, drag opposes the velocity, crossings scale velocities down.
template <int Dim>
class BlockEffects {
public:
    using Vec = typename Space<Dim>::Vec;
    using State = BlockState<Dim>;

    /// `ground` outlives this object.
    BlockEffects(const EffectInput& input, const EffectBody& body, const EffectGround<Dim>& ground, double gravity);

    bool empty() const { return parts_.empty(); }

    // --- contact law and impacts ---

    /// The law at a contact of a block with this state.
    ContactLaw law(const Contact<Dim>& contact, const State& s, const ContactSpeed& speed, const Soil& soil) const;
    /// Turns the normals of an impact; false if it leaves them alone.
    bool tilt(const State& s, std::vector<Contact<Dim>>& contacts);
    /// After an impact: `approach` as it was, one per contact.
    void struck(const State& s, std::span<const Contact<Dim>> contacts, std::span<const double> approach);
    /// True if the last impact broke the block.
    bool broken() const { return broken_; }
    /// The block is the largest piece from here on: the factor on its lengths.
    double take_piece();

    // --- forces ---

    /// Drag where these contacts bear.
    Drag drag_in_contact(std::span<const Contact<Dim>> contacts, const State& s) const;
    /// Acceleration beside the contact forces in a step of length h [s] with this drag in contact; lowers the velocity of `s` by what drag takes. For a
    /// drag rate c, v becomes v exp(-c h) and gravity g (1 - exp(-c h)) / (c h): exact for a constant rate and constant other forces.
    Vec drive(double h, Drag drag, State& s) const;
    /// How the flight goes on from here: a parabola and how long it holds.
    FlightArc<Dim> flight_arc(const State& s);
    /// The flight was not flown as foreseen.
    void forget_flight() { second_.reset(); }

    // --- on the way ---

    /// The block has moved from `from` to where `s` is; crossings may lower its velocities.
    void moved(const Vec& from, double duration, bool in_contact, double kinetic_energy, State& s);
    /// True if a net holds the block, and how far in plan view the motion went beyond its line [m].
    bool held() const { return held_; }
    double beyond_net() const { return beyond_net_; }
    std::int64_t crossings_struck() const { return crossings_struck_; }
    std::int64_t breaks() const { return breaks_; }
    const EffectBody& body() const { return body_; }

private:
    using Plan = Eigen::Matrix<double, Dim - 1, 1>;
    /// An effect at work.
    struct Part {
        EffectKind kind;
        EffectHook hook;
        const EffectPlace* place;
        const OwnLaw* own;
        std::array<double, kMostEffectParameters> value;  ///< in the order of the catalogue [*]
        RandomStream random;
        double memory =
            0.0;  ///< slip [m]; depth of the scar [m]; way to the next tree [m]; breaks so far; number drawn [-]
        double memory2 = 0.0;  ///< way since the scar was made [m]
    };
    static Plan plan(const Vec& p) { return p.template head<Dim - 1>(); }
    double height_over_ground(const Vec& p) const { return p[Dim - 1] - ground_.height(p); }
    bool acts_on_flight_at(const Part& part, const Vec& p) const;
    bool has_to_look_at(const Part& part, const Vec& p) const;
    bool has_to_look_at(const Vec& p) const;
    bool enters(const Vec& from, const Vec& to) const;
    double scar_drag(const Part& part) const;
    Drag drag_at(const Vec& position) const;
    scree_contact_state contact_state(const Part& part, const State& s, const Vec& at) const;
    template <class Met>
    void for_each_tree(const Part& part, const Vec& from, const Vec& to, const Met& met) const;
    double first_change(const Vec& from, const Vec& to) const;
    double change_time(const State& s, const DragFlight<Dim>& flight) const;
    void cross(Part& part, const Vec& from, double& kinetic, State& s);
    void draw_next_tree(Part& part);
    void lose(double energy, double& kinetic, State& s);

    EffectBody body_;
    const EffectGround<Dim>& ground_;
    Vec gravity_;
    std::vector<Part> parts_;  ///< soil patches first
    bool watches_flight_ = false;
    std::optional<FlightArc<Dim>> second_;  ///< what follows the arc under way
    bool broken_ = false;
    double piece_ = 1.0;  ///< share of the volume left by the last break [-]
    bool held_ = false;
    double beyond_net_ = 0.0;
    std::int64_t crossings_struck_ = 0, breaks_ = 0;
};

extern template class BlockEffects<2>;
extern template class BlockEffects<3>;

}  // namespace scree
