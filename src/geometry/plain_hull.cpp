// SPDX-License-Identifier: GPL-3.0-or-later
// Quickhull (Barber, Dobkin & Huhdanpaa 1996). Rounding may mislead it: the proof at the end tells.
#include "geometry/plain_hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace scree {

namespace {

/// Bound of the rounding error of a determinant of three differences of points, as a share of the volume of the points' box (Shewchuk 1997: less than
/// half of this) [-].
constexpr double kDeterminantError = 1e-14;

constexpr std::int32_t kNone = -1;

struct Facet {
    std::array<std::int32_t, 3> corner;  ///< counter-clockwise from outside
    Vec3 normal;                         ///< not unit
    Vec3 on;                             ///< the first corner
    std::int32_t outside = kNone;        ///< first of the points above it that it has to care for
    std::int32_t farthest = kNone;       ///< the highest of them
    double height = 0.0;                 ///< its height times the normal's length

    double above(const Vec3& p) const { return normal.dot(p - on); }
};

class QuickHull {
public:
    explicit QuickHull(std::span<const Vec3> points) : points_(points), next_(points.size(), kNone) {}

    /// False if the points seem to span no volume.
    bool build() {
        if (points_.size() < 4 || !start()) return false;
        for (std::size_t turns = 0; turns < points_.size(); ++turns) {
            const auto open =
                std::find_if(facets_.begin(), facets_.end(), [](const Facet& f) { return f.farthest != kNone; });
            if (open == facets_.end()) return true;
            add(open->farthest);
        }
        return false;
    }
    const std::vector<Facet>& facets() const { return facets_; }

private:
    const Vec3& point(std::int32_t i) const { return points_[static_cast<std::size_t>(i)]; }

    Facet facet(std::int32_t a, std::int32_t b, std::int32_t c) const {
        Facet f;
        f.corner = {a, b, c};
        f.normal = (point(b) - point(a)).cross(point(c) - point(a));
        f.on = point(a);
        return f;
    }

    /// The point for which `size` is largest.
    template <class Size>
    std::int32_t largest(const Size& size) const {
        std::int32_t best = 0;
        double most = -kInfinity;
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(points_.size()); ++i) {
            const double s = size(point(i));
            if (s > most) {
                most = s;
                best = i;
            }
        }
        return best;
    }

    /// A large tetrahedron.
    bool start() {
        const std::int32_t a = largest([](const Vec3& p) { return p.x(); });
        const std::int32_t b = largest([&](const Vec3& p) { return (p - point(a)).squaredNorm(); });
        const Vec3 along = point(b) - point(a);
        const std::int32_t c = largest([&](const Vec3& p) { return along.cross(p - point(a)).squaredNorm(); });
        const Facet base = facet(a, b, c);
        const std::int32_t d = largest([&](const Vec3& p) { return std::abs(base.above(p)); });
        const double height = base.above(point(d));
        if (height == 0.0) return false;
        if (height > 0.0)
            facets_ = {facet(a, c, b), facet(a, b, d), facet(b, c, d), facet(c, a, d)};
        else
            facets_ = {facet(a, b, c), facet(a, d, b), facet(b, d, c), facet(c, d, a)};
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(points_.size()); ++i) assign(i, 0);
        return true;
    }

    /// Gives a point to the first facet, from the given one on, that it is above; what is above none is inside.
    void assign(std::int32_t i, std::size_t first) {
        for (std::size_t k = first; k < facets_.size(); ++k) {
            Facet& f = facets_[k];
            if (i == f.corner[0] || i == f.corner[1] || i == f.corner[2]) return;
            const double height = f.above(point(i));
            if (!(height > 0.0)) continue;
            next_[static_cast<std::size_t>(i)] = f.outside;
            f.outside = i;
            if (height > f.height) {
                f.height = height;
                f.farthest = i;
            }
            return;
        }
    }

    /// Facets that see the point give way to those between it and their outline.
    void add(std::int32_t apex) {
        const Vec3& p = point(apex);
        const auto seen =
            std::partition(facets_.begin(), facets_.end(), [&](const Facet& f) { return f.above(p) <= 0.0; });
        gone_.assign(seen, facets_.end());
        facets_.erase(seen, facets_.end());
        const std::size_t first = facets_.size();
        auto among_gone = [&](std::int32_t a, std::int32_t b) {
            return std::any_of(gone_.begin(), gone_.end(), [&](const Facet& f) {
                return (f.corner[0] == a && f.corner[1] == b) || (f.corner[1] == a && f.corner[2] == b) ||
                       (f.corner[2] == a && f.corner[0] == b);
            });
        };
        for (const Facet& f : gone_) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t a = f.corner[k], b = f.corner[(k + 1) % 3];
                if (!among_gone(b, a)) facets_.push_back(facet(a, b, apex));
            }
        }
        for (const Facet& f : gone_) {
            for (std::int32_t i = f.outside; i != kNone;) {
                const std::int32_t next = next_[static_cast<std::size_t>(i)];
                if (i != apex) assign(i, first);
                i = next;
            }
        }
    }

    std::span<const Vec3> points_;
    std::vector<std::int32_t> next_;  ///< of each point: the next one of the same facet
    std::vector<Facet> facets_;
    std::vector<Facet> gone_;
};

/// True if every facet has all other points below it beyond doubt. As many different facets of the hull as V corners can have at most, 2 V - 4, are all
/// of it.
bool proven(std::span<const Vec3> points, const std::vector<Facet>& facets, std::size_t corners) {
    if (facets.size() + 4 != 2 * corners) return false;
    std::vector<std::array<std::int32_t, 3>> known;
    for (const Facet& f : facets) {
        known.push_back(f.corner);
        std::sort(known.back().begin(), known.back().end());
    }
    std::sort(known.begin(), known.end());
    if (std::adjacent_find(known.begin(), known.end()) != known.end()) return false;
    Vec3 low = points.front(), high = points.front();
    for (const Vec3& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double doubt = kDeterminantError * (high - low).prod();
    for (const Facet& f : facets) {
        int not_below = 0;
        for (const Vec3& p : points) not_below += f.above(p) < -doubt ? 0 : 1;
        if (not_below != 3) return false;
    }
    return true;
}

}  // namespace

std::optional<ConvexHull> plain_hull(std::span<const Vec3> points) {
    QuickHull quick(points);
    if (!quick.build()) return std::nullopt;
    ConvexHull hull;
    std::vector<std::int32_t> number(points.size(), kNone);
    for (const Facet& f : quick.facets()) {
        for (const std::int32_t i : f.corner) {
            std::int32_t& n = number[static_cast<std::size_t>(i)];
            if (n != kNone) continue;
            n = static_cast<std::int32_t>(hull.vertices.size());
            hull.vertices.push_back(points[static_cast<std::size_t>(i)]);
        }
    }
    if (!proven(points, quick.facets(), hull.vertices.size())) return std::nullopt;
    for (const Facet& f : quick.facets()) {
        auto corner = f.corner;
        for (std::int32_t& i : corner) i = number[static_cast<std::size_t>(i)];
        hull.facets.push_back(corner);
    }
    return hull;
}

}  // namespace scree
