// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace scree::gis {

/// A constrained Delaunay triangulation in the plane (CGAL, exact predicates). The same calls in the same order give the same result.
class ConstrainedDelaunay {
public:
    using Face = std::array<std::int32_t, 3>;  ///< indices of points, counter-clockwise [-]

    ConstrainedDelaunay();
    ~ConstrainedDelaunay();
    ConstrainedDelaunay(const ConstrainedDelaunay&) = delete;
    ConstrainedDelaunay& operator=(const ConstrainedDelaunay&) = delete;

    /// Index of the point, an old one if it is there already. Fast if it lies near the one before.
    std::int32_t insert(const Vec2& p);
    /// Makes the segment between two points an edge or a chain of edges. Where it crosses another constraint a point is added.
    void constrain(std::int32_t a, std::int32_t b);
    /// Calls `use` for every face that did not exist at the last call (the first time: for every face).
    void for_each_new_face(const std::function<void(const Face&)>& use);
    /// Calls `use` for every face.
    void for_each_face(const std::function<void(const Face&)>& use);
    /// All points by index.
    const std::vector<Vec2>& points() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace scree::gis
