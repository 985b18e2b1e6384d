// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/profile.hpp"
#include "scree/geometry/types.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scree {

/// A line above the ground over some stretch: normal.x <= offset for every point x of it.
struct SupportingLine {
    Vec2 normal = Vec2::UnitY();  ///< unit, upwards [-]
    double offset = -kInfinity;   ///< [m]; no ground at all: minus infinity
    bool whole = false;           ///< true: there is ground over the whole stretch

    double height(const Vec2& p) const { return normal.dot(p) - offset; }
};

/// One straight piece of the ground as contact detection needs it. A point p is above its line by normal.p - offset.
struct GroundReach {
    Vec2 normal;          ///< unit, upwards [-]
    double offset = 0.0;  ///< normal.p of the line's points [m]
    double slope = 0.0;   ///< dz/ds [-]
    double from = 0.0;    ///< chainages of its ends [m]
    double to = 0.0;      ///< [m]
    double start = 0.0;   ///< height where it begins [m]
    SoilId soil = 0;

    double gap(const Vec2& p) const { return normal.dot(p) - offset; }
    double height(double s) const { return start + slope * (s - from); }
};

/// The ground of the 2D model: the polyline (s, z) of a profile with normals, crests and an index over the chainage. Immutable, shared by all threads.
class GroundLine {
public:
    /// Throws InputError if the profile is empty.
    explicit GroundLine(const Profile& profile);

    std::size_t reach_count() const { return reaches_.size(); }
    const GroundReach& reach(std::size_t k) const { return reaches_[k]; }
    double length() const { return reaches_.back().to; }
    bool contains(double s) const { return s >= 0.0 && s <= length(); }

    /// Number of the reach at a chainage, the first or last one before and beyond the ends.
    std::size_t reach_at(double s) const {
        std::size_t k = bins_[static_cast<std::size_t>(
            std::clamp(s * bins_per_metre_, 0.0, static_cast<double>(bins_.size() - 1)))];
        while (k + 1 < reaches_.size() && reaches_[k].to < s) ++k;
        while (k > 0 && reaches_[k].from > s) --k;
        return k;
    }
    /// The same from a reach nearby.
    std::size_t reach_at(double s, std::size_t near) const {
        while (near + 1 < reaches_.size() && reaches_[near].to < s) ++near;
        while (near > 0 && reaches_[near].from > s) --near;
        return near;
    }
    double height(double s) const;  ///< [m]; NaN before and beyond the ends

    /// Where reach k begins.
    Vec2 corner(std::size_t k) const { return {reaches_[k].from, reaches_[k].start}; }
    /// True if the ground falls away on both sides of where reach k begins, by more than kCrestAngle: there it can poke into a block's side.
    bool is_crest(std::size_t k) const { return crest_[k] != 0; }

    /// A line above the ground from chainage `from` to `to`, along the chord between them.
    SupportingLine supporting_line(double from, double to) const;

private:
    std::vector<GroundReach> reaches_;
    std::vector<std::uint8_t> crest_;
    std::vector<std::uint32_t> bins_;  ///< reach at the beginning of each stretch of equal length
    double bins_per_metre_ = 1.0;      ///< [1/m]
};

}  // namespace scree
