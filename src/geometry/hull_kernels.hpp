// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/convex_block.hpp"

namespace scree {

// The loops over all vertices and faces of a block, with the widest instruction set that the processor has when the program runs. Sums are formed
// point by point without fused operations, and least and largest do not depend on the order: every instruction set gives the same numbers.

/// height[i] = n.p_i + offset of all vertices (filling included); returns the least.
double plane_heights(const ConvexBlock& block, const Vec3& n, double offset, double* height);

/// The vertices with height[i] <= most and not_before[i] <= now, in order; returns how many. `vertices` has room for all, filling included.
std::size_t vertices_in_reach(const ConvexBlock& block, const double* height, double most, const double* not_before,
                              double now, Eigen::Index* vertices);

/// Largest n.p_i over the vertices: how far the block reaches in the direction n.
double support(const ConvexBlock& block, const Vec3& n);

/// How vertices near a plane: vertex i comes nearer as height[i] + (rate_vector.p_i + rate) t - a/2 t^2 at worst, where a is at most
/// acceleration_vector.p_i + acceleration + jerk t, and at most `most`.
struct PlaneApproach {
    Vec3 rate_vector;          ///< [1/s]
    double rate;               ///< [m/s]
    Vec3 acceleration_vector;  ///< [1/s^2]
    double acceleration;       ///< [m/s^2]
    double jerk;               ///< [m/s^3]
    double most;               ///< [m/s^2], positive
};

/// Lower bound of the time at which the first vertex reaches the plane [s], at most the horizon. Heights must be positive.
double soonest_arrival(const ConvexBlock& block, const double* height, const PlaneApproach& approach, double horizon);

/// Lower bound of the heights of all vertices from now until `time`; `vertex` is the first that may come so low. Where it is positive, none reaches
/// the plane: without roots and quotients it costs a fraction of an arrival.
double lowest_until(const ConvexBlock& block, const double* height, const PlaneApproach& approach, double time,
                    Eigen::Index& vertex);

/// The vertices for which that bound is not positive, in order; returns how many. `vertices` has room for all, filling included.
std::size_t vertices_reaching(const ConvexBlock& block, const double* height, const PlaneApproach& approach,
                              double time, Eigen::Index* vertices);

/// Largest of normal.p - offset over the faces; `face` is the first where it is.
double farthest_face(const ConvexBlock& block, const Vec3& p, Eigen::Index& face);

/// Along the line a + t d the plane distance of face f is value[f] + t slope[f].
void face_lines(const ConvexBlock& block, const Vec3& a, const Vec3& d, double* value, double* slope);

/// Largest of value[f] + t slope[f] over the faces; `face` is the first where it is.
double farthest_on_line(const ConvexBlock& block, const double* value, const double* slope, double t,
                        Eigen::Index& face);

/// From t on, in the direction +1 or -1, face `face` is the highest on the line: how far until another rises above it, which is `next`; at least
/// 1e-9. Returns `room` and leaves `next` alone if none does before.
double next_on_line(const ConvexBlock& block, const double* value, const double* slope, double t, Eigen::Index face,
                    double direction, double room, Eigen::Index& next);

}  // namespace scree
