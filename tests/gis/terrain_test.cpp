// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/terrain.hpp"

#include "gis/input_files.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace scree::gis {

namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// 0.5 m cells of a wavy slope, two soils whose common boundary runs obliquely, and a road as a breakline.
class TerrainFiles : public ::testing::Test {
protected:
    TerrainFiles() {
        test::RasterSpec raster;
        raster.columns = raster.rows = 200;
        raster.geotransform = {900000, 0.5, 0, 6400100, 0, -0.5};
        raster.value = [](int c, int r) { return 1200 + 0.4 * r + 2 * std::sin(c / 20.0); };
        test::write_raster(dir_ / "dtm.tif", raster);

        test::VectorSpec zones;
        zones.rows = {
            {"POLYGON ((899990 6399990, 900030 6399990, 900060 6400110, 899990 6400110, 899990 6399990))", "rock", 1},
            {"POLYGON ((900030 6399990, 900110 6399990, 900110 6400110, 900060 6400110, 900030 6399990))", "scree", 1}};
        test::write_vector(dir_ / "zones.gpkg", zones);

        test::VectorSpec road;
        road.rows = {{"LINESTRING (900000 6400020, 900100 6400030)", "road", {}}};
        test::write_vector(dir_ / "lines.gpkg", road);
    }

    TerrainSource source() const {
        TerrainSource s;
        s.dtm = dir_ / "dtm.tif";
        s.resolution = 1;
        s.zones_file = dir_ / "zones.gpkg";
        s.zones.soils = {"meadow", "rock", "scree"};
        return s;
    }

    static Terrain read_terrain(const TerrainSource& s) {
        Terrain terrain = read_grid(s);
        add_facets(s, terrain);
        return terrain;
    }

    test::TempDir dir_;
};

}  // namespace

TEST_F(TerrainFiles, GridTakesSoilsByCentroid) {
    const Terrain terrain = read_terrain(source());
    EXPECT_FALSE(terrain.mesh);
    EXPECT_EQ(terrain.grid.shape.columns, 100);
    EXPECT_EQ(terrain.grid_soil.size(), 2u * 99 * 99);
    EXPECT_GT(terrain.soils.divided_area, 0.0);
    EXPECT_EQ(terrain.soils.gap_area, 0.0);
    EXPECT_THAT(terrain.warnings(), IsEmpty());
}

TEST_F(TerrainFiles, ConformingFacetsLieInOneZone) {
    for (const Surface surface : {Surface::Grid, Surface::Tin}) {
        TerrainSource s = source();
        s.surface = surface;
        s.conforming = true;
        s.breaklines_file = dir_ / "lines.gpkg";
        const Terrain terrain = read_terrain(s);
        ASSERT_TRUE(terrain.mesh);
        EXPECT_THAT(terrain.grid_soil, IsEmpty());
        EXPECT_EQ(terrain.mesh->soil.size(), terrain.mesh->facets.size());
        // the boundary is x = 30 + (y + 10) / 4; nodes from 0.5 to 99.5; lines are moved by less than 1/256 of a cell
        EXPECT_NEAR(terrain.soils.area[1], 99.0 * 44.5, 99.0 / 256);
        EXPECT_NEAR(terrain.soils.area[1] + terrain.soils.area[2], 99.0 * 99.0, 1e-6);
        EXPECT_EQ(terrain.soils.divided_area, 0.0);
        EXPECT_LE(terrain.triangulation->max_error, 0.1);
    }
}

TEST_F(TerrainFiles, RunsOnTheAwkwardControlSite) {
    SCREE_SHARED_OR_SKIP(folder, "badinputs/control");
    TerrainSource s;
    s.dtm = folder / "good_dtm.tif";
    s.resolution = 5;
    s.zones.soils = {"ground"};
    const Terrain terrain = read_terrain(s);
    EXPECT_GT(terrain.grid.shape.columns, 100);
    EXPECT_LT(terrain.resampling.rms_difference, 0.5);
    EXPECT_THAT(terrain.warnings(), IsEmpty());
}

}  // namespace scree::gis
