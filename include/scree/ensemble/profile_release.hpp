// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/state.hpp"
#include "scree/ensemble/release.hpp"
#include "scree/geometry/convex_polygon.hpp"
#include "scree/geometry/feature.hpp"
#include "scree/geometry/ground_line.hpp"
#include "scree/geometry/profile.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace scree {

/// Where blocks start on profiles in 2D.
///
/// Blocks are shared out over the release features as in 3D: polygons in proportion to their area, lines to their length, points equally. The blocks of a
/// feature start where profiles meet it:
///   polygon: on the stretches of profiles inside it, uniformly by length, so that evenly spaced profiles share it by area;
///   line:    where profiles cross it, in equal shares; a line that none crosses lies along one: between the feet of its points on the nearest profile;
///   point:   at its foot on the nearest profile.
/// Points and lines farther than a distance from every profile, and polygons that no profile passes through, release nothing.
class ProfileRelease {
public:
    /// Throws InputError if no feature meets a profile. `cell` is the length of the start cells for ReleasePattern::Cells (block after block over the middles
    /// of the cells that lie in polygons), `farthest` the distance of points and lines from their profile [m].
    ProfileRelease(const FeatureLayer& layer, std::span<const Profile> profiles, ReleasePattern pattern, double cell,
                   double farthest);

    /// A place on a profile.
    struct Place {
        std::size_t profile = 0;   ///< index of the profile [-]
        double s = 0.0;            ///< chainage [m]
        std::int64_t feature = 0;  ///< release feature
    };
    Place draw(std::uint64_t seed, std::uint64_t block) const;

    /// Foot of a point on the nearest profile, of no feature; none where every profile is farther than `farthest` [m].
    static std::optional<Place> foot(const Vec2& point, std::span<const Profile> profiles, double farthest);

    /// Features with a geometry that release nothing.
    const std::vector<std::int64_t>& left_out() const { return left_out_; }
    /// Number of start cells for ReleasePattern::Cells [-].
    std::size_t cell_count() const { return cells_.size(); }
    /// Profiles on which at least one block can start.
    const std::vector<bool>& used() const { return used_; }

private:
    struct Span {
        std::size_t profile = 0;
        double from = 0.0;  ///< [m]
        double to = 0.0;    ///< [m]
    };
    struct Source {
        std::int64_t feature = 0;
        double weight = 0.0;  ///< area, length or 1, only relative within one kind [m^2, m, -]
        std::vector<Span> spans;
        double length = 0.0;  ///< of all spans [m]
    };
    void add(std::int64_t feature, double weight, std::vector<Span> spans);
    static std::vector<Span> spans_of(const Polyline& line, std::span<const Profile> profiles, double farthest);

    ReleasePattern pattern_;
    std::vector<Source> sources_;
    double total_weight_ = 0.0;  ///< [same as weight]
    std::vector<Place> cells_;
    std::vector<std::int64_t> left_out_;
    std::vector<bool> used_;
};

/// Start of a block in 2D: at the place, with a random angle and, if a spin is set, a random sense of it. An initial speed points along the profile towards
/// larger chainages, at its elevation above the horizontal; the azimuth does not matter. A block that would touch the ground is raised until it is free.
BlockState<2> draw_release(const ReleaseSettings& settings, double chainage, const GroundLine& ground,
                           const ConvexPolygon& block, std::uint64_t seed, std::uint64_t number, double& raised);

/// Of a Departure, on its profile (release.hpp).
BlockState<2> draw_departure(const Departure& from, const GroundLine& ground, const ConvexPolygon& block,
                             std::uint64_t seed, std::uint64_t number, double& raised);

}  // namespace scree
