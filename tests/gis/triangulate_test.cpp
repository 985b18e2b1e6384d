// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/triangulate.hpp"

#include "gis/grid_lattice.hpp"
#include "gis/input_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

namespace scree::gis {

namespace {

using ::testing::HasSubstr;

Grid<double> grid_of(int columns, int rows, const std::function<double(double, double)>& z, double cell = 1.0) {
    Grid<double> grid({columns, rows, cell, {100.0, 200.0}});
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const Vec2 p = grid.shape.centre(i, j);
            grid.at(i, j) = z(p.x(), p.y());
        }
    }
    return grid;
}

double hills(double x, double y) {
    return 5 * std::sin(x / 9) * std::cos(y / 7) + 0.3 * x;
}

double area_of(const TriangleMesh& mesh, std::size_t f) {
    const auto& t = mesh.facets[f];
    const Vec3 a = mesh.vertices[static_cast<std::size_t>(t[1])] - mesh.vertices[static_cast<std::size_t>(t[0])];
    const Vec3 b = mesh.vertices[static_cast<std::size_t>(t[2])] - mesh.vertices[static_cast<std::size_t>(t[0])];
    return 0.5 * (a.x() * b.y() - a.y() * b.x());
}

// A mesh in which every facet turns left, and every edge has one facet on each side or lies on the rim; returns the area.
double expect_sound(const TriangleMesh& mesh) {
    double area = 0;
    std::map<std::pair<int, int>, int> edges;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        const auto& t = mesh.facets[f];
        EXPECT_GT(area_of(mesh, f), 0.0) << f;
        area += area_of(mesh, f);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(++edges[std::pair(t[k], t[(k + 1) % 3])], 1);
    }
    for (const Vec3& v : mesh.vertices) EXPECT_TRUE(v.allFinite());
    EXPECT_EQ(mesh.soil.size(), mesh.facets.size());
    return area;
}

std::size_t rim_edges(const TriangleMesh& mesh) {
    std::map<std::pair<int, int>, int> edges;
    for (const auto& t : mesh.facets) {
        for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    }
    std::size_t rim = 0;
    for (const auto& [edge, count] : edges) rim += count == 1;
    return rim;
}

// On which side of the line from a to b the facets lie; every facet must be on one side of it, or beyond its ends.
void expect_respects(const TriangleMesh& mesh, const Vec2& a, const Vec2& b, double margin) {
    const Vec2 d = (b - a).normalized();
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        double low = kInfinity, high = -kInfinity;
        bool along = true;
        for (const auto index : mesh.facets[f]) {
            const Vec2 p = mesh.vertices[static_cast<std::size_t>(index)].head<2>() - a;
            const double side = d.x() * p.y() - d.y() * p.x();
            low = std::min(low, side);
            high = std::max(high, side);
            along = along && p.dot(d) >= 0 && p.dot(d) <= (b - a).norm();
        }
        EXPECT_TRUE(!along || low > -margin || high < margin) << f << " " << low << " " << high;
    }
}

}  // namespace

TEST(GridLattice, LinesAreCutWhereTheyCrossEdges) {
    const Grid<double> grid = grid_of(5, 5, hills);
    const GridLattice lattice(grid);
    const auto pieces = cut_by_lattice(lattice, {0.25, 0.5}, {2.25, 0.5});
    ASSERT_EQ(pieces.size(), 5u);
    EXPECT_EQ(pieces[0].facet, 0);
    EXPECT_EQ(pieces[1].facet, 1);
    EXPECT_EQ(pieces[2].facet, 2);
    EXPECT_EQ(pieces[4].to.uv(), Vec2(2.25, 0.5));
    EXPECT_TRUE(cut_by_lattice(lattice, {-3, 7}, {9, 7}).empty());
    EXPECT_EQ(cut_by_lattice(lattice, {-3, 0.5}, {9, 0.5}).size(), 8u);
}

TEST(GridLattice, CommonBoundariesBecomeOne) {
    const Grid<double> grid = grid_of(20, 20, hills);
    const GridLattice lattice(grid);
    const Vec2 a = lattice.to_local({1.3, 1.4}), b = lattice.to_local({15.7, 9.1}),
               m = a + 0.4 * (b - a) + Vec2(0.01, -0.02);
    EXPECT_EQ(join_lines(lattice, {{a, b}, {b, m, a}}).size(), 2u);
}

TEST(ConformGrid, WithoutLinesItIsTheGrid) {
    const Grid<double> grid = grid_of(7, 5, hills);
    const Triangulation t = conform_grid(grid, {});
    EXPECT_EQ(t.report.facets, 48u);
    EXPECT_EQ(t.report.vertices, 35u);
    EXPECT_NEAR(expect_sound(t.mesh), 24.0, 1e-12);
    // the order of facets is that of the grid surface
    const auto& f = t.mesh.facets[1];
    EXPECT_EQ(t.mesh.vertices[static_cast<std::size_t>(f[1])].head<2>(), grid.shape.centre(1, 1));
}

TEST(ConformGrid, SurfaceStaysTheSameAndFacetsLieOnOneSide) {
    const Grid<double> grid = grid_of(40, 30, hills);
    const GridLattice lattice(grid);
    const Vec2 a{103.37, 204.91}, b{131.2, 226.4}, c{104.5, 221.8}, d{137.1, 203.3};
    const Triangulation t = conform_grid(grid, {{a, b}, {c, d}});  // they cross
    EXPECT_NEAR(expect_sound(t.mesh), 39.0 * 29.0, 1e-9);
    EXPECT_EQ(rim_edges(t.mesh), 2u * (39 + 29));  // no cracks
    for (const Vec3& v : t.mesh.vertices) {
        const Vec2 uv = lattice.to_lattice(v.head<2>());
        EXPECT_NEAR(v.z(), lattice.height(lattice.facet_at(uv), uv), 1e-9);
    }
    expect_respects(t.mesh, a, b, 0.01);
    expect_respects(t.mesh, c, d, 0.01);
}

// Parted by relief the facets are others, and lines are cut where they cross their edges, along both diagonals.
TEST(ConformGrid, FollowsTheDiagonalsOfTheGrid) {
    Grid<double> grid = grid_of(40, 30, [](double x, double y) { return hills(x, y) + 0.5 * std::sin(37 * x * y); });
    grid.at(20, 20) = kNaN;
    const GridLattice lattice(grid, DiagonalRule::ByRelief);
    const Triangulation t = conform_grid(
        grid, {{{103.37, 204.91}, {131.2, 226.4}}, {{104.5, 221.8}, {137.1, 203.3}}, {{110.0, 215.0}, {111.0, 214.0}}},
        DiagonalRule::ByRelief);
    EXPECT_NEAR(expect_sound(t.mesh), 39.0 * 29.0 - 2.0, 1e-9);  // a square keeps three of its nodes
    EXPECT_EQ(rim_edges(t.mesh), 2u * (39 + 29) + 4);            // no cracks
    int rising = 0;
    for (int j = 0; j < 29; ++j)
        for (int i = 0; i < 39; ++i) rising += lattice.diagonals().rises(i, j);
    EXPECT_GT(rising, 300);
    EXPECT_LT(rising, 39 * 29 - 300);
    for (const auto& f : t.mesh.facets) {
        const Vec3 middle =
            (t.mesh.vertices[static_cast<std::size_t>(f[0])] + t.mesh.vertices[static_cast<std::size_t>(f[1])] +
             t.mesh.vertices[static_cast<std::size_t>(f[2])]) /
            3.0;
        const Vec2 uv = lattice.to_lattice(middle.head<2>());
        EXPECT_NEAR(middle.z(), lattice.height(lattice.facet_at(uv), uv), 1e-9);
    }
}

TEST(ConformGrid, HolesKeepCompleteFacets) {
    Grid<double> grid = grid_of(10, 10, hills);
    grid.at(4, 4) = kNaN;
    const Triangulation t = conform_grid(grid, {{{100.0, 204.6}, {110.0, 204.7}}});
    EXPECT_NEAR(expect_sound(t.mesh), 81.0 - 3.0, 1e-9);  // six facets meet in a node
}

TEST(Tin, PlaneNeedsFewFacets) {
    const Triangulation t =
        triangulate_tin(grid_of(200, 100, [](double x, double y) { return 0.5 * x - 0.2 * y; }), {}, 0.01);
    EXPECT_EQ(t.report.facets, 2u);
    EXPECT_EQ(t.report.nodes, 20000u);
    EXPECT_LT(t.report.max_error, 1e-9);
    EXPECT_NEAR(expect_sound(t.mesh), 199.0 * 99.0, 1e-9);
}

TEST(Tin, EveryNodeIsWithinTheTolerance) {
    const Grid<double> grid = grid_of(300, 200, hills);
    std::size_t last = 2 * 299 * 199;
    for (const double tolerance : {0.01, 0.1, 1.0}) {
        const Triangulation t = triangulate_tin(grid, {}, tolerance);
        EXPECT_LE(t.report.max_error, tolerance);
        EXPECT_LE(t.report.rms_error, t.report.max_error);
        EXPECT_LT(t.report.facets, last);
        EXPECT_NEAR(expect_sound(t.mesh), 299.0 * 199.0, 1e-6);
        last = t.report.facets;
    }
}

TEST(Tin, LinesBecomeEdges) {
    const Grid<double> grid = grid_of(60, 50, hills);
    const Vec2 a{103.37, 204.91}, b{151.2, 236.4}, c{104.5, 241.8}, d{157.1, 203.3};
    const Triangulation t = triangulate_tin(grid, {{a, b}, {c, d}}, 0.2);
    EXPECT_NEAR(expect_sound(t.mesh), 59.0 * 49.0, 1e-9);
    EXPECT_LE(t.report.max_error, 0.2);
    expect_respects(t.mesh, a, b, 0.01);
    expect_respects(t.mesh, c, d, 0.01);
}

TEST(Tin, RimFollowsHoles) {
    Grid<double> grid = grid_of(60, 50, hills);
    // a round hole and a corner without heights
    for (int j = 0; j < 50; ++j) {
        for (int i = 0; i < 60; ++i) {
            if (std::hypot(i - 30, j - 25) < 8 || i + j < 20) grid.at(i, j) = kNaN;
        }
    }
    const ConstraintLines lines{{{100, 225}, {160, 226}}, {{130, 190}, {131, 260}}};
    const Triangulation t = triangulate_tin(grid, lines, 0.05);
    const Triangulation full = conform_grid(grid, {});
    EXPECT_NEAR(expect_sound(t.mesh), expect_sound(full.mesh), 1e-9);
    EXPECT_LE(t.report.max_error, 0.05);
    EXPECT_EQ(t.report.nodes, full.report.nodes);
}

TEST(Tin, SameInputGivesTheSameMesh) {
    const Grid<double> grid = grid_of(80, 70, hills);
    const ConstraintLines lines{{{103, 204}, {151.2, 236.4}}};
    const Triangulation one = triangulate_tin(grid, lines, 0.1), two = triangulate_tin(grid, lines, 0.1);
    EXPECT_EQ(one.mesh.facets, two.mesh.facets);
    EXPECT_EQ(one.mesh.vertices, two.mesh.vertices);
}

TEST(Tin, ToleranceMustBePositive) {
    EXPECT_THAT(test::input_error_of([] { triangulate_tin(grid_of(5, 5, hills), {}, 0.0); }),
                HasSubstr("greater than 0"));
}

}  // namespace scree::gis
