// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/convex_block.hpp"

#include <optional>
#include <span>

namespace scree {

/// Convex hull in plain floating point, given only if it is proven: every point but a facet's corners lies below that facet by more than rounding
/// can be, so that it is the one hull that exact arithmetic would find. Nothing where points lie in one face, as for boxes, or nearly so.
std::optional<ConvexHull> plain_hull(std::span<const Vec3> points);

}  // namespace scree
