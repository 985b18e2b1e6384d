// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Lengths, angles and times by which contacts are found, the same in 3D and in the plane.

namespace scree {

/// Overlap that is left alone [m].
inline constexpr double kPenetrationSlop = 3e-4;
/// A crest that nothing keeps out is left in the block to this depth [m]: more than contacts that hold let it in.
inline constexpr double kHooked = kPenetrationSlop + 5e-5;
/// A vertex this close in plan view to the next facet, or reach, touches that one too, if the two form a valley [m].
inline constexpr double kValleyMargin = 1e-3;
/// Normals closer than this are one plane, or line: no second contact at the seam of straight pieces (1 - cosine) [-].
inline constexpr double kSamePlane = 1e-12;
/// How far a contact normal may lie outside the normals of a crest's facets [rad]. The overlap that is left alone, over a few decimetres, leaves the
/// block's tilt as uncertain: without slack a block that lies on an almost flat crest would lose and find its contacts for ever.
inline constexpr double kConeSlack = 2e-3;
/// What is passed by nearer than this is not waited for in flight [m], and than this share of the inner radius: a small block could pass through it [-].
inline constexpr double kPassedBy = 5e-3, kPassedByShare = 0.2;
/// Longest flight between two looks at the terrain [s].
inline constexpr double kLongestFlight = 0.25;
/// Where terrain has holes or ends, share of the radius that is flown at most between two looks [-].
inline constexpr double kRimShare = 0.25;
/// Share of a distance that counts as room to move in: leaves rounding behind [-].
inline constexpr double kOdometerShare = 1.0 - 1e-9;

}  // namespace scree
