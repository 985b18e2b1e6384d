// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/direction_surface.hpp"

#include "scree/base/assert.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <bit>
#include <cmath>
#include <queue>
#include <set>
#include <vector>

namespace scree {

namespace {

constexpr double kSamplesPerRadius = 5.0;  // [-] about 78 samples in the circle
constexpr double kLeastPivot = 1e-6;  // [-] of the fit's normal matrix, relative: below it the samples lie in a line

/// A level at the corners of a facet, as a plane.
struct FacetLevels {
    std::array<double, 3> level;  // [m]
    Vec2 gradient;                // [-]
};

FacetLevels levels_of(DirectionSurface& surface, const WalkFacet& facet, bool pull) {
    FacetLevels f;
    for (std::size_t k = 0; k < 3; ++k)
        f.level[k] = pull ? surface.level(facet.corner[k]) : surface.ground(facet.corner[k]);
    const Vec2 a = (facet.corner[1] - facet.corner[0]).head<2>(), b = (facet.corner[2] - facet.corner[0]).head<2>();
    const double p = f.level[1] - f.level[0], q = f.level[2] - f.level[0];
    const double twice_area = cross(a, b);
    f.gradient = Vec2(p * b.y() - q * a.y(), q * a.x() - p * b.x()) / twice_area;
    return f;
}

double level_on(const WalkFacet& facet, const FacetLevels& f, const Vec2& p) {
    return f.level[0] + f.gradient.dot(p - facet.corner[0].head<2>());
}

/// Level of a spot on an edge or a node, which does not depend on the facet that it is seen from.
double level_on_edge(DirectionSurface& surface, const Spot& spot, bool pull) {
    const double a = pull ? surface.level(spot.first) : surface.ground(spot.first);
    if (spot.on == Spot::On::Node) return a;
    const double b = pull ? surface.level(spot.second) : surface.ground(spot.second);
    const Vec2 along = (spot.second - spot.first).head<2>();
    return a + (spot.at - spot.first.head<2>()).dot(along) / along.squaredNorm() * (b - a);
}

}  // namespace

std::size_t SmoothedHeights::PlaceHash::operator()(const std::array<std::uint64_t, 2>& key) const {
    std::uint64_t h = key[0] * 0x9e3779b97f4a7c15ULL + key[1];  // splitmix64
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<std::size_t>(h ^ (h >> 31));
}

double SmoothedHeights::sample(std::int64_t i, std::int64_t j) {
    const auto [entry, added] =
        samples_.try_emplace({static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j)}, 0.0);
    if (added) {
        const double spacing = radius_ / kSamplesPerRadius;
        entry->second = surface_.height(spacing * Vec2(static_cast<double>(i), static_cast<double>(j)));
    }
    return entry->second;
}

double SmoothedHeights::fit(const Vec3& node) {
    const double spacing = radius_ / kSamplesPerRadius;
    const auto first = [&](double x) { return static_cast<std::int64_t>(std::ceil((x - radius_) / spacing)); };
    const auto last = [&](double x) { return static_cast<std::int64_t>(std::floor((x + radius_) / spacing)); };
    Mat3 normal = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (std::int64_t j = first(node.y()); j <= last(node.y()); ++j) {
        for (std::int64_t i = first(node.x()); i <= last(node.x()); ++i) {
            const Vec2 d = (spacing * Vec2(static_cast<double>(i), static_cast<double>(j)) - node.head<2>()) / radius_;
            const double rest = 1.0 - d.squaredNorm();
            if (rest <= 0.0) continue;
            const double z = sample(i, j);
            if (std::isnan(z)) continue;
            const Vec3 basis(1.0, d.x(), d.y());
            normal.selfadjointView<Eigen::Lower>().rankUpdate(basis, rest * rest);
            right += rest * rest * (z - node.z()) * basis;
        }
    }
    const Eigen::LDLT<Mat3> solver(normal);
    if (!(solver.vectorD().minCoeff() > kLeastPivot * normal(0, 0))) return node.z();
    return node.z() + solver.solve(right).x();
}

double SmoothedHeights::at(const Vec3& node) {
    if (radius_ <= 0.0) return node.z();
    const auto [entry, added] =
        nodes_.try_emplace({std::bit_cast<std::uint64_t>(node.x()), std::bit_cast<std::uint64_t>(node.y())}, 0.0);
    if (added) entry->second = fit(node);
    return entry->second;
}

double DirectionSurface::level(const Vec3& node) {
    double pull = 0.0;
    if (guide_) {
        const double distance = guide_->nearest(node.head<2>()).offset;
        pull = distance * distance / (2.0 * width_);
    }
    return heights_.at(node) + pull;
}

Descent steepest_descent(FacetWalk& walk, DirectionSurface& surface, const Spot& spot, double sign) {
    constexpr double kInward = 1e-12;  // [-] a direction along an edge does not point into the facet beside it
    const std::vector<WalkFacet>& around = walk.around(spot);
    SCREE_ASSERT(!around.empty());
    Descent best;
    double steepest = kLevelRate;
    for (const WalkFacet& facet : around) {
        const Vec2 down = -sign * levels_of(surface, facet, true).gradient;
        const double fall = down.norm();
        if (fall <= steepest || points_into(facet, spot, down / fall) <= kInward) continue;
        steepest = fall;
        best.state = Descent::State::Goes;
        best.direction = down / fall;
        best.to = leave_facet(facet, spot, best.direction);
        best.rate = -sign * levels_of(surface, facet, false).gradient.dot(best.direction);
        best.soil = facet.soil;
    }
    if (spot.on == Spot::On::Facet) return best;

    const double here = level_on_edge(surface, spot, true);
    const EdgesAt edges = edges_at(around, spot);
    bool at_rim = false;
    for (std::size_t k = 0; k < edges.node.size(); ++k) {
        at_rim = at_rim || edges.rim[k];
        if (edges.rim[k]) continue;  // the way down from a rim leads off the terrain, not along it
        const Vec2 along = edges.node[k].head<2>() - spot.at;
        const double fall = sign * (here - surface.level(edges.node[k])) / along.norm();
        if (fall <= steepest) continue;
        steepest = fall;
        best.state = Descent::State::Goes;
        best.direction = along.normalized();
        best.to = spot_at_node(edges.node[k]);
        best.rate = sign * (level_on_edge(surface, spot, false) - surface.ground(edges.node[k])) / along.norm();
        best.soil = around.front().soil;
        for (const WalkFacet& facet : around) {
            // the lowest facet number beside the edge
            const bool beside = std::any_of(facet.corner.begin(), facet.corner.end(), [&](const Vec3& c) {
                return c.x() == edges.node[k].x() && c.y() == edges.node[k].y();
            });
            if (!beside) continue;
            best.soil = facet.soil;
            break;
        }
    }
    if (best.state != Descent::State::Goes && at_rim) best.state = Descent::State::Edge;
    return best;
}

std::optional<Vec3> lowest_way_out(FacetWalk& walk, DirectionSurface& surface, const Spot& spot, double rise,
                                   double reach) {
    const double bottom = level_at(walk, surface, spot);
    using Entry = std::pair<double, Vec3>;
    const auto later = [](const Entry& a, const Entry& b) {
        if (a.first != b.first) return a.first > b.first;
        return a.second.x() != b.second.x() ? a.second.x() > b.second.x() : a.second.y() > b.second.y();
    };
    std::priority_queue<Entry, std::vector<Entry>, decltype(later)> rim(later);
    std::set<std::pair<double, double>> seen;
    const auto flood = [&](const Spot& from) {
        for (const WalkFacet& facet : walk.around(from)) {
            for (const Vec3& node : facet.corner) {
                if ((node.head<2>() - spot.at).norm() > reach || !seen.insert({node.x(), node.y()}).second) continue;
                const double level = surface.level(node);
                if (level <= bottom + rise) rim.push({level, node});
            }
        }
    };
    flood(spot);
    while (!rim.empty()) {
        const auto [level, node] = rim.top();
        rim.pop();
        if (level < bottom) return node;
        flood(spot_at_node(node));
    }
    return std::nullopt;
}

double level_at(FacetWalk& walk, DirectionSurface& surface, const Spot& spot) {
    if (spot.on != Spot::On::Facet) return level_on_edge(surface, spot, true);
    const WalkFacet& facet = walk.around(spot).front();
    return level_on(facet, levels_of(surface, facet, true), spot.at);
}

}  // namespace scree
