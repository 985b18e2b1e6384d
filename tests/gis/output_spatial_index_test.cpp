// SPDX-License-Identifier: GPL-3.0-or-later
// SQLite checks the tree that was packed for it (rtreecheck), GDAL searches and edits it.
#include "gis/spatial_index.hpp"
#include "gis/vector_writer.hpp"
#include "scree/base/random.hpp"
#include "support/paths.hpp"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>

namespace scree::gis {
namespace {

std::string answer(GDALDataset& file, const std::string& sql) {
    OGRLayer* rows = file.ExecuteSQL(sql.c_str(), nullptr, nullptr);
    if (!rows) return "no answer";
    const OGRFeatureUniquePtr row(rows->GetNextFeature());
    std::string text = row ? row->GetFieldAsString(0) : "no row";
    file.ReleaseResultSet(rows);
    return text;
}

/// Segments of up to 40 m, every seventh feature without a geometry.
VectorLayer segments(std::int64_t count) {
    VectorLayer layer{.coordinates = Coordinates::XY};
    layer.data = {"lines", GeometryKind::LineString, {}, {}};
    RandomStream random(1, 2, RandomPurpose::Block);
    for (std::int64_t i = 0; i < count; ++i) {
        const Vec3 a(random.uniform(0, 1000), random.uniform(0, 2000), 0);
        const Vec3 b = a + Vec3(random.uniform(-20, 20), random.uniform(-20, 20), 0);
        Feature feature;
        if (i % 7 != 6) feature.geometry = Polylines{{{a, b}, {}}};
        layer.data.features.push_back(feature);
    }
    return layer;
}

int count_inside(const VectorLayer& layer, const Box2& window) {
    int count = 0;
    for (const Feature& feature : layer.data.features) {
        const auto* lines = std::get_if<Polylines>(&feature.geometry);
        if (!lines) continue;
        Box2 box;
        for (const Vec3& p : (*lines)[0].points) box.add(Vec2(p.head<2>()));
        count += box.overlaps(window) ? 1 : 0;
    }
    return count;
}

class SpatialIndex : public testing::TestWithParam<int> {};

// around the capacities of a node (51) and of two levels (51^2)
INSTANTIATE_TEST_SUITE_P(Sizes, SpatialIndex, testing::Values(0, 1, 50, 51, 60, 61, 2'600, 3'100, 20'000),
                         [](const auto& size) { return "of" + std::to_string(size.param); });

TEST_P(SpatialIndex, IsSoundFindsAllAndSurvivesEdits) {
    const test::TempDir dir;
    const LocalFrame frame{.easting = 903'000, .northing = 6'455'000, .height = 0, .crs = {}};
    const VectorLayer layer = segments(GetParam());
    write_vector_layers(dir / "a.gpkg", frame, std::vector{layer});

    GDALAllRegister();
    const GDALDatasetUniquePtr file(GDALDataset::Open((dir / "a.gpkg").c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    ASSERT_TRUE(file);
    EXPECT_EQ(answer(*file, "SELECT rtreecheck('rtree_lines_geom')"), "ok");
    OGRLayer* lines = file->GetLayerByName("lines");
    EXPECT_TRUE(lines->TestCapability(OLCFastSpatialFilter));

    // the index alone, not the exact geometry: it must not miss a box that overlaps
    RandomStream random(3, 4, RandomPurpose::Block);
    for (int i = 0; i < 20; ++i) {
        const Vec2 corner(random.uniform(0, 900), random.uniform(0, 1900));
        const Box2 window{corner, corner + Vec2(random.uniform(1, 100), random.uniform(1, 100))};
        const std::string found = answer(*file, "SELECT count(*) FROM rtree_lines_geom WHERE maxx >= " +
                                                    std::to_string(window.min.x() + frame.easting) +
                                                    " AND minx <= " + std::to_string(window.max.x() + frame.easting) +
                                                    " AND maxy >= " + std::to_string(window.min.y() + frame.northing) +
                                                    " AND miny <= " + std::to_string(window.max.y() + frame.northing));
        // floats are 0.06 to 0.5 m apart at such coordinates: the index may find a few more, never fewer
        EXPECT_GE(std::stoi(found), count_inside(layer, window));
        EXPECT_LE(std::stoi(found), count_inside(layer, window.grown(1.0)));
    }

    // edits: the triggers keep the index in step, splitting and merging packed nodes
    ASSERT_EQ(file->StartTransaction(), OGRERR_NONE);
    for (int i = 0; i < 200; ++i) {
        OGRFeature feature(lines->GetLayerDefn());
        auto line = std::make_unique<OGRLineString>();
        line->addPoint(903'500.0 + i * 0.01, 6'456'000.0);
        line->addPoint(903'501.0, 6'456'001.0);
        feature.SetGeometryDirectly(line.release());
        ASSERT_EQ(lines->CreateFeature(&feature), OGRERR_NONE);
    }
    for (GIntBig fid = 1; fid <= GetParam(); fid += 3) ASSERT_EQ(lines->DeleteFeature(fid), OGRERR_NONE);
    ASSERT_EQ(file->CommitTransaction(), OGRERR_NONE);
    EXPECT_EQ(answer(*file, "SELECT rtreecheck('rtree_lines_geom')"), "ok");
    EXPECT_EQ(answer(*file, "SELECT count(*) FROM rtree_lines_geom"),
              answer(*file, "SELECT count(*) FROM lines WHERE geom IS NOT NULL"));
}

TEST(SpatialIndexEntry, RectanglesAreRoundedOutwards) {
    for (const double x : {6'455'000.3, -6'455'000.3, 0.1, -0.1, 0.0, 903'000.0}) {
        const IndexEntry entry = index_entry(1, x, x, x, x);
        EXPECT_LE(static_cast<double>(entry.min_x), x);
        EXPECT_GE(static_cast<double>(entry.max_x), x);
        EXPECT_LE(static_cast<double>(entry.max_y) - static_cast<double>(entry.min_y), std::abs(x) * 2e-7);
    }
}

}  // namespace
}  // namespace scree::gis
