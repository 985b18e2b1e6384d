// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/geometry/surface.hpp"

#include "scree/base/error.hpp"
#include "support/scenes.hpp"
#include "support/terrains.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

TEST(Surface, MeshRefusesFoldedFacets) {
    TriangleMesh mesh = cut_mesh(2.0, 1.0, Cut::Grid, [](double, double) { return 0.0; });
    std::swap(mesh.facets[3][0], mesh.facets[3][1]);
    EXPECT_THROW(make_mesh_surface(mesh), InputError);
}

}  // namespace scree::test
