// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/soil_zones.hpp"
#include "gis/words.hpp"
#include "scree/geometry/diagonals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree::gis {

namespace {

constexpr double kTouch = 1e-6;  // a boundary that reaches less than this into a facet of a grid only touches it [m]

constexpr double kMuchDivided = 0.2;  // share of the terrain in facets that boundaries divide [-]

using Triangle = std::array<Vec2, 3>;  // in plan, counter-clockwise [m]

double area_of(const Triangle& t) {
    const Vec2 a = t[1] - t[0], b = t[2] - t[0];
    return 0.5 * cross(a, b);
}

// Does the segment reach further than `touch` into the triangle?
bool passes_through(const Vec2& a, const Vec2& b, const Triangle& t, double touch) {
    double from = 0, to = 1;
    for (int k = 0; k < 3; ++k) {
        const Vec2& p = t[static_cast<std::size_t>(k)];
        const Vec2 edge = t[static_cast<std::size_t>((k + 1) % 3)] - p;
        const Vec2 inward = Vec2{-edge.y(), edge.x()} / edge.norm();
        const double at_a = inward.dot(a - p) - touch, at_b = inward.dot(b - p) - touch;
        if (at_a <= 0 && at_b <= 0) return false;
        if (at_a < 0) from = std::max(from, at_a / (at_a - at_b));
        if (at_b < 0) to = std::min(to, at_a / (at_a - at_b));
    }
    return from < to;
}

// Segments of the zones' boundaries in square bins.
class BoundaryIndex {
public:
    BoundaryIndex(const std::vector<Ring>& rings, const Box2& area, double facet_size, double touch) : touch_(touch) {
        std::size_t count = 0;
        for (const Ring& ring : rings) count += ring.size();
        if (count == 0 || area.empty()) return;
        const Vec2 size = area.max - area.min;
        cell_ = std::max({2 * facet_size, size.maxCoeff() / 2048, 1e-3});
        origin_ = area.min;
        columns_ = static_cast<int>(size.x() / cell_) + 1;
        rows_ = static_cast<int>(size.y() / cell_) + 1;
        bins_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
        for (const Ring& ring : rings) {
            for (std::size_t i = 0; i < ring.size(); ++i) insert(ring[i], ring[(i + 1) % ring.size()]);
        }
    }

    bool divides(const Triangle& t) const {
        if (bins_.empty()) return false;
        Box2 box;
        for (const Vec2& p : t) box.add(p);
        bool found = false;
        visit(box, [&](const std::vector<std::size_t>& bin) {
            for (const std::size_t s : bin)
                found = found || passes_through(segments_[s].first, segments_[s].second, t, touch_);
        });
        return found;
    }

private:
    void insert(const Vec2& a, const Vec2& b) {
        segments_.emplace_back(a, b);
        // piece by piece, so that a long oblique segment does not fill the whole of its box
        const int pieces = std::clamp(static_cast<int>((b - a).norm() / cell_), 1, 100000);
        for (int k = 0; k < pieces; ++k) {
            Box2 box;
            box.add(Vec2(a + (b - a) * (static_cast<double>(k) / pieces)));
            box.add(Vec2(a + (b - a) * (static_cast<double>(k + 1) / pieces)));
            visit(box.grown(1e-6), [&](std::vector<std::size_t>& bin) {
                if (bin.empty() || bin.back() != segments_.size() - 1) bin.push_back(segments_.size() - 1);
            });
        }
    }

    template <class Self, class Use>
    static void visit_bins(Self& self, const Box2& box, const Use& use) {
        const auto index = [&](double value, double start, int count) {
            return static_cast<int>(
                std::clamp(std::floor((value - start) / self.cell_), -1.0, static_cast<double>(count)));
        };
        const int i0 = std::max(0, index(box.min.x(), self.origin_.x(), self.columns_));
        const int i1 = std::min(self.columns_ - 1, index(box.max.x(), self.origin_.x(), self.columns_));
        const int j0 = std::max(0, index(box.min.y(), self.origin_.y(), self.rows_));
        const int j1 = std::min(self.rows_ - 1, index(box.max.y(), self.origin_.y(), self.rows_));
        for (int j = j0; j <= j1; ++j) {
            for (int i = i0; i <= i1; ++i)
                use(self.bins_[static_cast<std::size_t>(j) * static_cast<std::size_t>(self.columns_) +
                               static_cast<std::size_t>(i)]);
        }
    }
    template <class Use>
    void visit(const Box2& box, const Use& use) const {
        visit_bins(*this, box, use);
    }
    template <class Use>
    void visit(const Box2& box, const Use& use) {
        visit_bins(*this, box, use);
    }

    std::vector<std::pair<Vec2, Vec2>> segments_;  // [m]
    std::vector<std::vector<std::size_t>> bins_;   // indices of segments
    double touch_ = kTouch;                        // [m]
    double cell_ = 1;                              // [m]
    Vec2 origin_ = Vec2::Zero();                   // [m]
    int columns_ = 0, rows_ = 0;                   // [-]
};

// Takes the facets one by one.
class Assignment {
public:
    Assignment(const SoilZones& zones, std::size_t facets, const Box2& area, double facet_size, double touch)
        : zones_(zones), boundary_(zones.boundaries(), area, facet_size, touch) {
        result_.soil.assign(facets, zones.settings().default_soil);
        result_.report.soils = zones.settings().soils;
        result_.report.area.assign(zones.settings().soils.size(), 0.0);
        result_.report.warnings = zones.warnings();
    }

    void take(std::size_t facet, const Triangle& t) {
        const int zone = zones_.zone_at((t[0] + t[1] + t[2]) / 3);
        const SoilId soil = zones_.soil_of(zone);
        const double area = area_of(t);
        result_.soil[facet] = soil;
        result_.report.area[soil] += area;
        total_ += area;
        if (zone < 0) result_.report.gap_area += area;
        if (boundary_.divides(t)) result_.report.divided_area += area;
    }

    FacetSoils finish() {
        SoilReport& report = result_.report;
        const auto share = [&](double area) {
            return words(fixed(area, 1), " m2 (", fixed(100 * area / std::max(total_, 1e-300), 1), " %)");
        };
        if (!zones_.boundaries().empty() && report.gap_area > 0) {
            report.warnings.push_back(words("The soil zones leave ", share(report.gap_area),
                                            " of the terrain without a soil: it takes the default, '",
                                            report.soils[zones_.settings().default_soil], "'."));
        }
        if (report.divided_area > kMuchDivided * total_) {
            report.warnings.push_back(
                words("Boundaries of soil zones divide facets of ", share(report.divided_area),
                      " of the terrain, each of which has the soil at its centroid: soils lie beside their zones by "
                      "as much as facets are large. Set terrain.conforming = true, or take smaller cells."));
        }
        if (!zones_.boundaries().empty() && report.gap_area >= total_) {
            report.warnings.push_back(
                "The soil zones cover no facet of the terrain at all: check that they belong to this site.");
        }
        return std::move(result_);
    }

private:
    const SoilZones& zones_;
    BoundaryIndex boundary_;
    FacetSoils result_;
    double total_ = 0;  // [m^2]
};

}  // namespace

FacetSoils assign_soils(const SoilZones& zones, const Grid<double>& grid, DiagonalRule rule) {
    const GridShape& shape = grid.shape;
    const std::size_t cells = static_cast<std::size_t>(std::max(0, shape.columns - 1)) *
                              static_cast<std::size_t>(std::max(0, shape.rows - 1));
    Assignment assignment(zones, 2 * cells, shape.bounds(), shape.cell, kTouch);
    const Diagonals diagonals(grid, rule);
    std::size_t facet = 0;
    for (int j = 0; j + 1 < shape.rows; ++j) {
        for (int i = 0; i + 1 < shape.columns; ++i) {
            for (const int half : {0, 1}) {
                Triangle t;
                double sum = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto [di, dj] = diagonals.corners(i, j, half)[k];
                    t[k] = shape.centre(i + di, j + dj);
                    sum += grid.at(i + di, j + dj);
                }
                if (!std::isnan(sum)) assignment.take(facet + static_cast<std::size_t>(half), t);
            }
            facet += 2;
        }
    }
    return assignment.finish();
}

FacetSoils assign_soils(const SoilZones& zones, const TriangleMesh& mesh, double touch) {
    Box2 area;
    for (const Vec3& v : mesh.vertices) area.add(v.head<2>());
    const double mean_size =
        mesh.facets.empty() ? 1.0 : std::sqrt((area.max - area.min).prod() / static_cast<double>(mesh.facets.size()));
    Assignment assignment(zones, mesh.facets.size(), area, mean_size, touch);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        Triangle t;
        for (std::size_t k = 0; k < 3; ++k) t[k] = mesh.vertices[static_cast<std::size_t>(mesh.facets[f][k])].head<2>();
        assignment.take(f, t);
    }
    return assignment.finish();
}

}  // namespace scree::gis
