// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/surface.hpp"

#include "scree/base/error.hpp"
#include "support/scenes.hpp"
#include "support/terrains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

namespace scree::test {

TEST(Surface, HeightAndNormalOfAPlane) {
    auto plane = [](double x, double y) { return 3.0 + 0.5 * x - 0.2 * y; };
    const Vec3 normal = Vec3(-0.5, 0.2, 1.0).normalized();
    const auto grid = grid_terrain(5.0, 1.0, plane);
    const auto mesh = make_mesh_surface(cut_mesh(5.0, 1.0, Cut::Random, plane));
    RandomStream random(51, 1, RandomPurpose::Effect);
    for (int k = 0; k < 500; ++k) {
        const double x = random.uniform(-5.0, 5.0), y = random.uniform(-5.0, 5.0);
        for (const Surface* surface : {grid.get(), mesh.get()}) {
            EXPECT_NEAR(surface->height(Vec2(x, y)), plane(x, y), 1e-12);
            EXPECT_NEAR((surface->normal(Vec2(x, y)) - normal).norm(), 0.0, 1e-12);
        }
    }
}

// Cell (i, j) of nodes is split along (i+1, j)-(i, j+1): the lower left half is facet 2c, the upper right one 2c + 1.
TEST(Surface, GridFacetsFollowTheDiagonal) {
    const auto surface = grid_terrain(2.0, 1.0, [](double x, double y) { return x == 0.0 && y == 0.0 ? 1.0 : 0.0; });
    ASSERT_EQ(surface->facet_count(), 32);
    EXPECT_EQ(surface->facet_at(Vec2(-1.9, -1.9)), 0);
    EXPECT_EQ(surface->facet_at(Vec2(-1.1, -1.1)), 1);
    EXPECT_EQ(surface->facet_at(Vec2(-0.9, -1.9)), 2);
    EXPECT_EQ(surface->facet_at(Vec2(-1.9, -0.9)), 8);
    // the pyramid around the centre node, along the diagonal at half height and across it at none
    EXPECT_NEAR(surface->height(Vec2(-0.5, 0.5)), 0.5, 1e-12);
    EXPECT_NEAR(surface->height(Vec2(0.5, 0.5)), 0.0, 1e-12);
    std::array<Vec3, 3> corners;
    SoilId soil = 0;
    for (std::int64_t f = 0; f < surface->facet_count(); ++f) {
        ASSERT_TRUE(surface->facet(f, corners, soil));
        EXPECT_GT((corners[1] - corners[0]).cross(corners[2] - corners[0]).z(), 0.0);
        EXPECT_EQ(surface->facet_at(((corners[0] + corners[1] + corners[2]) / 3.0).head<2>()), f);
    }
}

TEST(Surface, HolesAndTheOutsideHaveNoHeight) {
    const auto surface = grid_terrain(3.0, 1.0, [](double x, double y) { return x == 1.0 && y == 1.0 ? kNaN : 2.0; });
    EXPECT_TRUE(std::isnan(surface->height(Vec2(1.1, 1.1))));
    EXPECT_EQ(surface->facet_at(Vec2(0.9, 0.9)), -1);
    EXPECT_EQ(surface->height(Vec2(-1.5, -1.5)), 2.0);
    EXPECT_EQ(surface->facet_at(Vec2(3.1, 0.0)), -1);
    EXPECT_TRUE(std::isnan(surface->height(Vec2(0.0, -3.1))));
    TerrainPatch patch;
    surface->gather(surface->bounds(), patch);
    EXPECT_EQ(patch.facets.size(), static_cast<std::size_t>(surface->facet_count()) - 6);  // six facets meet in a node
    EXPECT_EQ(patch.facet_at(Vec2(1.1, 1.1)), nullptr);
    const auto mesh = make_mesh_surface(mesh_of(*surface));
    EXPECT_EQ(mesh->facet_count(), surface->facet_count() - 6);
    EXPECT_TRUE(std::isnan(mesh->height(Vec2(1.1, 1.1))));
}

// What lies on the outline of a hole, nodes above all, belongs to the facets around: rasters of the terrain and release cells are taken there.
TEST(Surface, TheOutlineOfAHoleIsTerrain) {
    for (const DiagonalRule rule : {DiagonalRule::Alike, DiagonalRule::ByRelief}) {
        Grid<double> heights(GridShape{7, 7, 0.3, {-1.05, -1.05}});
        for (int j = 0; j < 7; ++j)
            for (int i = 0; i < 7; ++i) heights.at(i, j) = i == 3 && j == 3 ? kNaN : 0.1 * ((i * 7 + j * 3) % 5);
        const auto surface = make_grid_surface(heights, std::vector<SoilId>(grid_facet_count(heights.shape)), rule);
        for (int j = 0; j < 7; ++j)
            for (int i = 0; i < 7; ++i) {
                const Vec2 at = heights.shape.centre(i, j);
                if (i == 3 && j == 3)
                    EXPECT_EQ(surface->facet_at(at), -1);
                else
                    EXPECT_NEAR(surface->height(at), heights.at(i, j), 1e-6) << i << " " << j;
            }
        EXPECT_EQ(surface->facet_at(heights.shape.centre(3, 3) + Vec2(0.01, 0.02)), -1);
    }
}

// Where the terrain ends its edges are crests with a wall on one side, and its nodes tips with a spoke down the wall.
TEST(Surface, RimsAreCrestsAndTipsOfAWall) {
    const auto grid = grid_terrain(3.0, 1.0, [](double x, double y) { return x == 1.0 && y == 1.0 ? kNaN : 2.0; });
    const auto mesh = make_mesh_surface(mesh_of(*grid));
    for (const Surface* surface : {grid.get(), mesh.get()}) {
        TerrainPatch patch;
        surface->gather(surface->bounds().grown(0.5), patch);
        EXPECT_FALSE(patch.plane.whole);
        EXPECT_EQ(patch.edges.size(), 4u * 6u + 6u);  // around the square and around the hole
        for (const PatchEdge& e : patch.edges) {
            EXPECT_EQ(e.normal(0), Vec3::UnitZ());
            const Vec3 out = e.normal(1);
            EXPECT_NEAR(out.z(), 0.0, 1e-15);
            const Vec2 middle = 0.5 * (e.a + e.b).head<2>();
            EXPECT_GE(surface->facet_at(middle - 0.1 * out.head<2>()), 0);
            EXPECT_LT(surface->facet_at(middle + 0.1 * out.head<2>()), 0);
        }
        EXPECT_EQ(patch.nodes.size(), 24u + 6u);
        for (const PatchNode& n : patch.nodes) {
            const auto spokes =
                std::span(patch.spokes).subspan(static_cast<std::size_t>(n.first), static_cast<std::size_t>(n.count));
            EXPECT_EQ(std::count_if(spokes.begin(), spokes.end(),
                                    [](const PatchSpoke& s) { return s.edge.normalized() == Vec3(-Vec3::UnitZ()); }),
                      1);
        }
    }
}

TEST(Surface, GridAndMeshAgreeOnRoughTerrain) {
    const auto grid = grid_terrain(6.0, 0.5, rough_slope(30 * kDegree, 0.1));
    const auto mesh = make_mesh_surface(mesh_of(*grid));
    RandomStream random(52, 1, RandomPurpose::Effect);
    for (int k = 0; k < 1000; ++k) {
        const double x = random.uniform(-6.2, 6.2), y = random.uniform(-6.2, 6.2);
        const Vec2 p(x, y);
        EXPECT_EQ(grid->facet_at(p), mesh->facet_at(p));
        if (grid->facet_at(p) < 0) continue;
        EXPECT_NEAR(grid->height(p), mesh->height(p), 1e-12);
    }
}

namespace {

/// Nodes a metre apart at x, y = -half ... half.
Grid<double> grid_of(int half, const std::function<double(double, double)>& height) {
    Grid<double> grid({2 * half + 1, 2 * half + 1, 1.0, {-half - 0.5, -half - 0.5}});
    for (int j = 0; j <= 2 * half; ++j)
        for (int i = 0; i <= 2 * half; ++i) grid.at(i, j) = height(i - half, j - half);
    return grid;
}

std::unique_ptr<Surface> by_relief(const Grid<double>& grid) {
    return make_grid_surface(grid, std::vector<SoilId>(grid_facet_count(grid.shape), 0), DiagonalRule::ByRelief);
}

/// Heights of +-0.3 m on a slope to the east; the same wherever it is asked.
double rough(double x, double y) {
    return rough_slope(20 * kDegree, 0.3)(x, y);
}

}  // namespace

// A gully and a ridge keep their lines whichever way they go; parted alike, dams stand in one of the two.
TEST(SurfaceByRelief, GulliesAndRidgesKeepTheirLines) {
    for (const double sign : {1.0, -1.0})
        for (const double way : {1.0, -1.0}) {
            const auto surface =
                by_relief(grid_of(5, [&](double x, double y) { return sign * std::abs(x - way * y); }));
            for (double s = -4.9; s < 5.0; s += 0.1) {
                EXPECT_NEAR(surface->height(Vec2(way * s, s)), 0.0, 1e-12) << sign << " " << way << " " << s;
                if (s < 4.4) {
                    EXPECT_NEAR(surface->height(Vec2(way * s, s + 0.5)), 0.5 * sign, 1e-12);
                }
            }
        }
}

// A terrain that is mirrored or turned by 90 degrees is the mirrored or turned surface.
TEST(SurfaceByRelief, HasNoGrain) {
    const auto surface = by_relief(grid_of(8, rough));
    const auto mirrored = by_relief(grid_of(8, [](double x, double y) { return rough(-x, y); }));
    const auto turned = by_relief(grid_of(8, [](double x, double y) { return rough(y, -x); }));
    const auto alike = make_grid_surface(grid_of(8, [](double x, double y) { return rough(-x, y); }),
                                         std::vector<SoilId>(2 * 16 * 16, 0));
    RandomStream random(52, 1, RandomPurpose::Effect);
    double grain = 0.0;
    for (int k = 0; k < 2000; ++k) {
        const double x = random.uniform(-8.0, 8.0), y = random.uniform(-8.0, 8.0);
        EXPECT_NEAR(surface->height(Vec2(x, y)), mirrored->height(Vec2(-x, y)), 1e-12);
        EXPECT_NEAR(surface->height(Vec2(x, y)), turned->height(Vec2(-y, x)), 1e-12);
        grain = std::max(grain, std::abs(surface->height(Vec2(x, y)) - alike->height(Vec2(-x, y))));
    }
    EXPECT_GT(grain, 0.1) << "or the test says nothing";
}

// Facets, crests, tips and rims are those of the same triangles as a mesh, with holes as without.
TEST(SurfaceByRelief, IsTheSameAsAMesh) {
    for (const bool holes : {false, true}) {
        const auto grid = by_relief(grid_of(6, [&](double x, double y) {
            const bool hole =
                holes && ((x == 1.0 && y == 2.0) || (x == -3.0 && std::abs(y) < 1.5) || (x == 4.0 && y == 4.0));
            return hole ? kNaN : rough(x, y);
        }));
        const auto mesh = make_mesh_surface(mesh_of(*grid));
        EXPECT_EQ(mesh->facet_count() < grid->facet_count(), holes);
        TerrainPatch a, b;
        grid->gather(Box2{{-9, -9}, {9, 9}}, a);
        mesh->gather(Box2{{-9, -9}, {9, 9}}, b);
        EXPECT_EQ(a.facets.size(), b.facets.size());
        EXPECT_EQ(a.edges.size(), b.edges.size());
        EXPECT_EQ(a.nodes.size(), b.nodes.size());
        EXPECT_GT(a.edges.size(), 100u);
        EXPECT_GT(a.nodes.size(), 5u);
        const auto sum_of = [](const TerrainPatch& p) {
            Vec3 sum = Vec3::Zero();
            for (const PatchEdge& e : p.edges) sum += e.a + e.b + e.beyond[0] + e.beyond[1];
            for (const PatchNode& n : p.nodes) sum += n.position;
            for (const PatchSpoke& s : p.spokes) sum += s.edge.cwiseAbs();
            return sum;
        };
        EXPECT_LT((sum_of(a) - sum_of(b)).norm(), 1e-9);
        RandomStream random(52, 1, RandomPurpose::Effect);
        for (int k = 0; k < 1000; ++k) {
            const double x = random.uniform(-6.2, 6.2), y = random.uniform(-6.2, 6.2);
            const Vec2 p(x, y);
            ASSERT_EQ(grid->facet_at(p) < 0, mesh->facet_at(p) < 0);
            if (grid->facet_at(p) >= 0) {
                EXPECT_NEAR(grid->height(p), mesh->height(p), 1e-12);
            }
        }
    }
}

TEST(Surface, MeshRefusesFoldedFacets) {
    TriangleMesh mesh = cut_mesh(2.0, 1.0, Cut::Grid, [](double, double) { return 0.0; });
    std::swap(mesh.facets[3][0], mesh.facets[3][1]);
    EXPECT_THROW(make_mesh_surface(mesh), InputError);
}

}  // namespace scree::test
