// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/facet_walk.hpp"

#include "scree/geometry/profile.hpp"
#include "scree/geometry/surface.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>

namespace scree {

/// Averaged heights of a terrain: the value at p of the plane that fits the terrain around p best, by weighted least squares with the
/// weights (1 - d^2/R^2)^2 at distance d < R. A plane stays what it is, also beside a rim. The terrain is sampled at the points of a
/// lattice of R/5 that is fixed in space: the average is then a smooth function of p however rough the terrain is.
class SmoothedHeights {
public:
    SmoothedHeights(const Surface& surface, double radius) : surface_(surface), radius_(radius) {}

    /// At a node of the terrain; its own height if the radius is 0, or where too little terrain is around to fit a plane [m].
    double at(const Vec3& node);

private:
    double sample(std::int64_t i, std::int64_t j);
    double fit(const Vec3& node);

    struct PlaceHash {
        std::size_t operator()(const std::array<std::uint64_t, 2>& key) const;
    };
    using Cache = std::unordered_map<std::array<std::uint64_t, 2>, double, PlaceHash>;

    const Surface& surface_;
    double radius_;  ///< [m]
    Cache nodes_;    ///< [m]
    Cache samples_;  ///< [m]
};

/// What lines descend on: averaged heights, with the pull of a guide where there is one.
class DirectionSurface {
public:
    DirectionSurface(const Surface& surface, double smoothing) : heights_(surface, smoothing) {}

    /// Pulls with the potential d^2 / (2 width), d the distance from the guide; null: no pull. The guide must outlive its use.
    void set_guide(const Profile* guide, double width) {
        guide_ = guide;
        width_ = width;
    }
    double ground(const Vec3& node) { return heights_.at(node); }  ///< without the pull [m]
    double level(const Vec3& node);                                ///< with the pull [m]

private:
    SmoothedHeights heights_;
    const Profile* guide_ = nullptr;
    double width_ = 1.0;  ///< [m]
};

/// The way down from a spot.
struct Descent {
    enum class State {
        Goes,
        Level,
        Edge
    };  ///< Level: nowhere lower; Edge: only beyond the rim of the terrain or of a hole
    State state = State::Level;
    Spot to;                        ///< where the steepest line next meets an edge or a node
    Vec2 direction = Vec2::Zero();  ///< unit [-]
    double rate = 0.0;              ///< fall of the ground per length, without the pull of a guide [-]
    SoilId soil = 0;
};

/// A line that falls by less than this per length is level [-].
inline constexpr double kLevelRate = 1e-6;

/// The steepest way down (up: sign = -1) from the spot: through a facet, or along an edge that both facets drain to. Of equally steep ways the
/// one through the facet of the lowest number.
Descent steepest_descent(FacetWalk& walk, DirectionSurface& surface, const Spot& spot, double sign = 1.0);

/// Out of a pit by the lowest way (priority flood from node to node; Barnes et al. 2014, Computers & Geosciences 62): the first node that
/// is lower than the spot, if no node on the way there is higher than it by more than `rise` [m] or farther than `reach` [m].
std::optional<Vec3> lowest_way_out(FacetWalk& walk, DirectionSurface& surface, const Spot& spot, double rise,
                                   double reach);

/// Level of the direction surface at a spot [m].
double level_at(FacetWalk& walk, DirectionSurface& surface, const Spot& spot);

}  // namespace scree
