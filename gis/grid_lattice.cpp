// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/grid_lattice.hpp"

#include "gis/triangulate.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>
#include <utility>

namespace scree::gis {

namespace {

// Along which lines of the lattice a crossing lies.
enum class Family { Free, Vertical, Horizontal, Falling, Rising };

struct Crossing {
    double t = 0;  // along the segment, 0 to 1 [-]
    Family family = Family::Free;
    std::int64_t line = 0;  // u, v, u + v or v - u [cells]
};

std::int64_t snapped(double value) {
    return std::llround(value * static_cast<double>(kSnap));
}

SnappedPoint point_at(const Crossing& crossing, const Vec2& a, const Vec2& b) {
    const Vec2 p = a + crossing.t * (b - a);
    const std::int64_t line = crossing.line * kSnap;
    switch (crossing.family) {
        case Family::Vertical:
            return {line, snapped(p.y())};
        case Family::Horizontal:
            return {snapped(p.x()), line};
        case Family::Falling:
            return {snapped(p.x()), line - snapped(p.x())};
        case Family::Rising:
            return {snapped(p.x()), line + snapped(p.x())};
        case Family::Free:
            break;
    }
    return {snapped(p.x()), snapped(p.y())};
}

void add_crossings(double from, double to, Family family, std::vector<Crossing>& crossings) {
    if (from == to) return;
    const auto low = static_cast<std::int64_t>(std::ceil(std::min(from, to))),
               high = static_cast<std::int64_t>(std::floor(std::max(from, to)));
    for (std::int64_t line = low; line <= high; ++line) {
        crossings.push_back({(static_cast<double>(line) - from) / (to - from), family, line});
    }
}

// Of each square between neighbouring crossings its own diagonal.
void add_diagonals(const GridLattice& lattice, const Vec2& start, const Vec2& end, std::vector<Crossing>& crossings) {
    const std::size_t count = crossings.size();
    for (std::size_t k = 0; k + 1 < count; ++k) {
        const double from = crossings[k].t, to = crossings[k + 1].t;
        const auto [i, j] = lattice.square(lattice.facet_at(start + 0.5 * (from + to) * (end - start)));
        const bool rises = lattice.diagonals().rises(i, j);
        const double sign = rises ? -1.0 : 1.0;
        const std::int64_t line = rises ? std::int64_t{j} - i : std::int64_t{i} + j + 1;
        const double a = start.y() + sign * start.x(), b = end.y() + sign * end.x();
        const double t = (static_cast<double>(line) - a) / (b - a);
        if (a != b && t >= from && t <= to) crossings.push_back({t, rises ? Family::Rising : Family::Falling, line});
    }
}

// The part of the segment inside of the lattice as parameters; false if there is none (Liang and Barsky 1984).
bool clip(const GridLattice& lattice, const Vec2& a, const Vec2& b, double& from, double& to) {
    const Vec2 d = b - a;
    const Vec2 high(lattice.columns() - 1, lattice.rows() - 1);
    from = 0, to = 1;
    for (int k = 0; k < 2; ++k) {
        if (d[k] == 0) {
            if (a[k] < 0 || a[k] > high[k]) return false;
            continue;
        }
        const double t0 = -a[k] / d[k], t1 = (high[k] - a[k]) / d[k];
        from = std::max(from, std::min(t0, t1));
        to = std::min(to, std::max(t0, t1));
    }
    return from < to;
}

// Vertices of lines, found by place.
class VertexIndex {
public:
    // The vertex that stands for a place: a node or an earlier vertex near by, or a new one.
    SnappedPoint vertex(const Vec2& uv) {
        const Vec2 node(std::round(uv.x()), std::round(uv.y()));
        SnappedPoint best{snapped(uv.x()), snapped(uv.y())};
        double nearest = kJoinDistance;
        for_each_near(uv, [&](const SnappedPoint& p) {
            if ((p.uv() - uv).norm() <= nearest) nearest = (p.uv() - uv).norm(), best = p;
        });
        if ((node - uv).norm() <= kJoinDistance) best = {snapped(node.x()), snapped(node.y())};
        std::vector<SnappedPoint>& bin = bins_[key(best.uv(), 0, 0)];
        if (std::find(bin.begin(), bin.end(), best) == bin.end()) bin.push_back(best);
        return best;
    }
    // Calls `use` for all vertices in the squares around a place, at least one cell far.
    template <class Use>
    void for_each_near(const Vec2& uv, const Use& use) const {
        for (int dj = -1; dj <= 1; ++dj) {
            for (int di = -1; di <= 1; ++di) {
                const auto bin = bins_.find(key(uv, di, dj));
                if (bin == bins_.end()) continue;
                for (const SnappedPoint& p : bin->second) use(p);
            }
        }
    }

private:
    static std::uint64_t key(const Vec2& uv, int di, int dj) {
        const auto i = static_cast<std::int64_t>(std::floor(uv.x())) + di,
                   j = static_cast<std::int64_t>(std::floor(uv.y())) + dj;
        return (static_cast<std::uint64_t>(i) << 32) ^ (static_cast<std::uint64_t>(j) & 0xFFFFFFFFULL);
    }
    std::unordered_map<std::uint64_t, std::vector<SnappedPoint>> bins_;
};

// The vertices within reach of a segment, in its order, its ends included.
std::vector<SnappedPoint> path_along(const GridLattice& lattice, const VertexIndex& index, const SnappedPoint& a,
                                     const SnappedPoint& b) {
    const Vec2 start = a.uv(), d = b.uv() - a.uv();
    std::vector<std::pair<double, SnappedPoint>> found{{0, a}, {1, b}};
    double from = 0, to = 1;
    if (!clip(lattice, start, b.uv(), from, to)) return {a, b};
    const int steps = static_cast<int>(std::ceil((to - from) * d.norm())) + 1;
    for (int k = 0; k <= steps; ++k) {
        index.for_each_near(start + (from + (to - from) * k / steps) * d, [&](const SnappedPoint& p) {
            const double t = (p.uv() - start).dot(d) / d.squaredNorm();
            const bool between = p != a && p != b && t > 0 && t < 1;
            if (between && (start + t * d - p.uv()).norm() <= kJoinDistance) found.emplace_back(t, p);
        });
    }
    std::sort(found.begin(), found.end());
    std::vector<SnappedPoint> path;
    for (const auto& [t, p] : found) {
        if (path.empty() || path.back() != p) path.push_back(p);
    }
    return path;
}

}  // namespace

SnappedSegments join_lines(const GridLattice& lattice, const std::vector<std::vector<Vec2>>& lines) {
    VertexIndex index;
    std::set<std::pair<SnappedPoint, SnappedPoint>> drawn;
    for (const std::vector<Vec2>& line : lines) {
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
            const SnappedPoint a = index.vertex(lattice.to_lattice(line[k])),
                               b = index.vertex(lattice.to_lattice(line[k + 1]));
            if (a != b) drawn.insert(std::minmax(a, b));
        }
    }
    std::set<std::pair<SnappedPoint, SnappedPoint>> joined;
    for (const auto& [a, b] : drawn) {
        const std::vector<SnappedPoint> path = path_along(lattice, index, a, b);
        for (std::size_t k = 0; k + 1 < path.size(); ++k) joined.insert(std::minmax(path[k], path[k + 1]));
    }
    return {joined.begin(), joined.end()};
}

std::vector<LinePiece> cut_by_lattice(const GridLattice& lattice, const Vec2& a, const Vec2& b) {
    std::vector<LinePiece> pieces;
    double from = 0, to = 1;
    if (!clip(lattice, a, b, from, to)) return pieces;
    const Vec2 high(lattice.columns() - 1, lattice.rows() - 1);
    const auto inside = [&](const Vec2& p) { return Vec2(p.cwiseMax(Vec2::Zero()).cwiseMin(high)); };
    const auto on_snap = [](const Vec2& p) { return SnappedPoint{snapped(p.x()), snapped(p.y())}.uv(); };
    const Vec2 start = on_snap(inside(a + from * (b - a))), end = on_snap(inside(a + to * (b - a)));

    std::vector<Crossing> crossings{{0, Family::Free, 0}, {1, Family::Free, 0}};
    add_crossings(start.x(), end.x(), Family::Vertical, crossings);
    add_crossings(start.y(), end.y(), Family::Horizontal, crossings);
    const auto sort = [&] {
        std::sort(crossings.begin(), crossings.end(), [](const Crossing& p, const Crossing& q) {
            return std::pair(p.t, static_cast<int>(p.family)) < std::pair(q.t, static_cast<int>(q.family));
        });
    };
    sort();
    add_diagonals(lattice, start, end, crossings);
    sort();
    for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
        const SnappedPoint p = point_at(crossings[k], start, end), q = point_at(crossings[k + 1], start, end);
        if (p == q) continue;
        // the place before snapping tells the facet: both ends lie on its rim or inside of it
        const double middle = 0.5 * (crossings[k].t + crossings[k + 1].t);
        pieces.push_back({p, q, lattice.facet_at(start + middle * (end - start))});
    }
    return pieces;
}

}  // namespace scree::gis
