// SPDX-License-Identifier: GPL-3.0-or-later
// What is written is read back with GDAL, without any code of ours.
#include "gis/output_wkt.hpp"
#include "gis/raster_writer.hpp"
#include "gis/vector_writer.hpp"
#include "scree/base/error.hpp"
#include "support/paths.hpp"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <array>
#include <cmath>

namespace scree::gis {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

LocalFrame lambert93() {
    return {.easting = 903'000, .northing = 6'455'000, .height = 1'000, .crs = test::wkt2(2154)};
}

GDALDatasetUniquePtr open(const std::string& name) {
    GDALAllRegister();
    GDALDatasetUniquePtr file(GDALDataset::Open(name.c_str()));
    EXPECT_TRUE(file) << name;
    return file;
}

VectorLayer points_layer() {
    VectorLayer layer;
    layer.title = "Stopping points";
    layer.data = {"stopping_points",
                  GeometryKind::Point,
                  {{"block_id", FieldType::Integer, "Block"},
                   {"mass_kg", FieldType::Real, "Mass [kg]"},
                   {"stop_reason", FieldType::Text, "Reason"}},
                  {{7, Points{{10.25, 20.5, -3.0}}, {std::int64_t{7}, 812.5, std::string("at_rest")}},
                   {3, Points{{11, 21, 4}}, {std::int64_t{3}, kNaN, std::monostate{}}},
                   {5, std::monostate{}, {std::int64_t{1} << 40, std::int64_t{2}, std::string("échoué")}}}};
    return layer;
}

VectorLayer line_layer() {
    VectorLayer layer{.coordinates = Coordinates::XYZM};
    layer.data = {"trajectories",
                  GeometryKind::LineString,
                  {},
                  {{0, Polylines{{{{0, 0, 50}, {1, -2, 47.5}, {3, -7, 30.125}}, {0, 0.5, 1.25}}}, {}}}};
    return layer;
}

// --- vectors ---

TEST(VectorWriter, PointsKeepOrderValuesAndPlace) {
    const test::TempDir dir;
    const auto written = write_vector_layers(dir / "a.gpkg", lambert93(), std::vector{points_layer()});
    EXPECT_EQ(written[0].features, 3);
    EXPECT_EQ(written[0].extent.min, Vec2(903'010.25, 6'455'020.5));
    EXPECT_EQ(written[0].colour_ranges[0].low, 2.0) << "the range of the masses, without NaN";
    EXPECT_EQ(written[0].colour_ranges[0].high, 812.5);

    const auto file = open(dir / "a.gpkg");
    OGRLayer* layer = file->GetLayerByName("stopping_points");
    ASSERT_TRUE(layer);
    EXPECT_EQ(layer->GetGeomType(), wkbPoint25D);
    EXPECT_STREQ(layer->GetSpatialRef()->GetAuthorityCode(nullptr), "2154");
    EXPECT_TRUE(layer->TestCapability(OLCFastSpatialFilter)) << "no spatial index";

    OGRFeatureUniquePtr row(layer->GetNextFeature());
    EXPECT_EQ(row->GetFID(), 1);
    EXPECT_EQ(row->GetFieldAsInteger64("block_id"), 7);
    EXPECT_EQ(row->GetFieldAsDouble("mass_kg"), 812.5);
    EXPECT_STREQ(row->GetFieldAsString("stop_reason"), "at_rest");
    const OGRPoint* point = row->GetGeometryRef()->toPoint();
    EXPECT_EQ(point->getX(), 903'010.25);
    EXPECT_EQ(point->getY(), 6'455'020.5);
    EXPECT_EQ(point->getZ(), 997.0);

    row.reset(layer->GetNextFeature());
    EXPECT_EQ(row->GetFieldAsInteger64("block_id"), 3);
    EXPECT_TRUE(row->IsFieldNull(row->GetFieldIndex("mass_kg"))) << "NaN is no value";
    EXPECT_TRUE(row->IsFieldNull(row->GetFieldIndex("stop_reason")));

    row.reset(layer->GetNextFeature());
    EXPECT_EQ(row->GetFieldAsInteger64("block_id"), std::int64_t{1} << 40);
    EXPECT_EQ(row->GetFieldAsDouble("mass_kg"), 2.0) << "whole numbers are fine in real fields";
    EXPECT_STREQ(row->GetFieldAsString("stop_reason"), "échoué");
    EXPECT_EQ(row->GetGeometryRef(), nullptr);
}

TEST(VectorWriter, LinesKeepHeightAndTime) {
    const test::TempDir dir;
    write_vector_layers(dir / "a.gpkg", lambert93(), std::vector{line_layer()});
    const auto file = open(dir / "a.gpkg");
    OGRLayer* layer = file->GetLayerByName("trajectories");
    EXPECT_EQ(layer->GetGeomType(), wkbLineStringZM);
    const OGRFeatureUniquePtr row(layer->GetNextFeature());
    const OGRLineString* line = row->GetGeometryRef()->toLineString();
    ASSERT_EQ(line->getNumPoints(), 3);
    EXPECT_EQ(line->getX(2), 903'003.0);
    EXPECT_EQ(line->getY(2), 6'454'993.0);
    EXPECT_EQ(line->getZ(2), 1'030.125);
    EXPECT_EQ(line->getM(2), 1.25);
}

TEST(VectorWriter, PolygonsWithHolesAndParts) {
    VectorLayer layer;
    const Ring square = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    const Ring hole = {{2, 2}, {2, 4}, {4, 4}, {4, 2}};
    const Ring other = {{20, 0}, {22, 0}, {20, 2}};
    layer.data = {"deposit_zones", GeometryKind::Polygon, {}, {{0, MultiPolygon{{square, {hole}}}, {}}}};
    VectorLayer multi = layer;
    multi.data.name = "many";
    multi.data.features.push_back({1, MultiPolygon{{square, {hole}}, {other, {}}}, {}});
    const test::TempDir dir;
    write_vector_layers(dir / "a.gpkg", lambert93(), std::vector{layer, multi});
    const auto file = open(dir / "a.gpkg");
    EXPECT_EQ(file->GetLayerByName("deposit_zones")->GetGeomType(), wkbPolygon);
    OGRLayer* many = file->GetLayerByName("many");
    EXPECT_EQ(many->GetGeomType(), wkbMultiPolygon) << "one feature with two parts makes a layer of several parts";
    const OGRFeatureUniquePtr single(many->GetNextFeature());
    const OGRFeatureUniquePtr pair(many->GetNextFeature());
    EXPECT_DOUBLE_EQ(single->GetGeometryRef()->toMultiPolygon()->get_Area(), 96.0);
    EXPECT_DOUBLE_EQ(pair->GetGeometryRef()->toMultiPolygon()->get_Area(), 98.0);
    EXPECT_TRUE(single->GetGeometryRef()->toMultiPolygon()->getGeometryRef(0)->getExteriorRing()->get_IsClosed());
}

TEST(VectorWriter, WithoutCrsTheLayerIsUndefinedCartesian) {
    const test::TempDir dir;
    write_vector_layers(dir / "a.gpkg", LocalFrame{}, std::vector{points_layer()});
    const auto file = open(dir / "a.gpkg");
    OGRLayer* answer = file->ExecuteSQL(
        "SELECT srs_id FROM gpkg_contents UNION SELECT srs_id FROM gpkg_geometry_columns", nullptr, nullptr);
    ASSERT_EQ(answer->GetFeatureCount(), 1);
    EXPECT_EQ(OGRFeatureUniquePtr(answer->GetNextFeature())->GetFieldAsInteger(0), -1);
    file->ReleaseResultSet(answer);
}

TEST(VectorWriter, ALayerMayComeAsAStream) {
    VectorLayer layer = points_layer();
    layer.data.features.clear();
    layer.data.fields = {{"block_id", FieldType::Integer, "Block"}};
    std::int64_t block = 0;
    layer.next = [&](Feature& feature) {
        if (block == 20'000) return false;
        feature.geometry = Points{{static_cast<double>(block), 0.0, 0.0}};
        feature.values = {block++};
        return true;
    };
    const test::TempDir dir;
    EXPECT_EQ(write_vector_layers(dir / "a.gpkg", lambert93(), std::vector{layer})[0].features, 20'000);
    const auto file = open(dir / "a.gpkg");
    OGRLayer* read = file->GetLayerByName("stopping_points");
    EXPECT_EQ(read->GetFeatureCount(), 20'000);
    const OGRFeatureUniquePtr row(read->GetFeature(12'346));
    EXPECT_EQ(row->GetFieldAsInteger64(0), 12'345);
    EXPECT_EQ(row->GetGeometryRef()->toPoint()->getX(), 915'345.0);
    read->SetSpatialFilterRect(903'099.5, 6'454'999, 903'109.5, 6'455'001);
    EXPECT_EQ(read->GetFeatureCount(), 10) << "through the spatial index";
}

template <class Change>
std::string refusal(Change change) {
    VectorLayer layer = points_layer();
    change(layer);
    const test::TempDir dir;
    try {
        write_vector_layers(dir / "a.gpkg", lambert93(), std::vector{layer});
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(VectorWriter, RefusesWhatDoesNotFitAndSaysWhere) {
    EXPECT_THAT(refusal([](VectorLayer& l) { l.data.name = "Stopping points"; }),
                HasSubstr("\"Stopping points\" cannot be used"));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.data.name = "gpkg_contents"; }), HasSubstr("cannot be used"));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.data.fields[1].name = "block_id"; }), HasSubstr("given twice"));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.data.fields[1].name = "fid"; }), HasSubstr("every layer has already"));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.styles = {{.colour_by = "mass"}}; }), HasSubstr("\"mass\""));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.coordinates = Coordinates::XYZM; }), HasSubstr("points have no M"));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.data.features[1].values.pop_back(); }),
                HasSubstr("feature 2: 2 values for 3 fields"));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.data.features[1].values[0] = 0.5; }),
                HasSubstr("\"block_id\" is not of the field's type"));
    EXPECT_THAT(refusal([](VectorLayer& l) {
                    l.data.features[0].geometry = Points{{kNaN, 0, 0}};
                }),
                HasSubstr("feature 1: a vertex"));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.data.features[0].geometry = Points{}; }), HasSubstr("no parts"));
    EXPECT_THAT(refusal([](VectorLayer& l) { l.data.features[0].geometry = Polylines{}; }),
                HasSubstr("not of the layer's kind"));
    EXPECT_THAT(refusal([](VectorLayer& l) {
                    l = line_layer();
                    std::get<Polylines>(l.data.features[0].geometry)[0].measure.pop_back();
                }),
                HasSubstr("2 measures for 3 points"));
    EXPECT_EQ(refusal([](VectorLayer&) {}), "accepted");
}

TEST(VectorWriter, AFailureOfTheDiscIsAnErrorWithGdalsReason) {
    try {
        write_vector_layers("/proc/no/such/folder/a.gpkg", lambert93(), std::vector{points_layer()});
        FAIL();
    } catch (const ComputeError& error) {
        EXPECT_THAT(error.what(), HasSubstr("GDAL says"));
    }
}

// --- rasters ---

/// Value 100 row + column, row 0 in the south; one cell without a value.
RasterLayer raster(int columns, int rows) {
    RasterLayer layer{.name = "energy_kj_max",
                      .title = "Largest energy",
                      .unit = "kJ",
                      .quantity_definition = "Largest kinetic energy in the cell",
                      .theme = RasterTheme::Energy};
    layer.values = Grid<float>({.columns = columns, .rows = rows, .cell = 2.0, .origin = {10, 20}});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column)
            layer.values.at(column, row) = static_cast<float>(100 * row + column);
    }
    layer.values.at(1, 1) = std::nanf("");
    return layer;
}

float read_pixel(GDALDataset& file, int x, int y) {
    float value = 0;
    EXPECT_EQ(file.GetRasterBand(1)->RasterIO(GF_Read, x, y, 1, 1, &value, 1, 1, GDT_Float32, 0, 0, nullptr), CE_None);
    return value;
}

/// Value at a place on the map, found through the file's own georeference.
float value_at(GDALDataset& file, double easting, double northing) {
    std::array<double, 6> t{};
    EXPECT_EQ(file.GetGeoTransform(t.data()), CE_None);
    return read_pixel(file, static_cast<int>(std::floor((easting - t[0]) / t[1])),
                      static_cast<int>(std::floor((northing - t[3]) / t[5])));
}

void expect_in_place(GDALDataset& file, const RasterLayer& layer, const LocalFrame& frame) {
    std::array<double, 6> t{};
    ASSERT_EQ(file.GetGeoTransform(t.data()), CE_None);
    EXPECT_THAT(t, testing::ElementsAre(903'010, 2, 0, 6'455'020 + 2.0 * layer.values.shape.rows, 0, -2));
    EXPECT_EQ(file.GetRasterXSize(), layer.values.shape.columns);
    EXPECT_EQ(file.GetRasterYSize(), layer.values.shape.rows);
    ASSERT_TRUE(file.GetSpatialRef());
    EXPECT_STREQ(file.GetSpatialRef()->GetAuthorityCode(nullptr), "2154");
    EXPECT_STREQ(file.GetRasterBand(1)->GetUnitType(), "kJ");
    // the centre of a cell, and points just inside its corners: no shift by half a cell
    for (const double aside : {-0.99, 0.0, 0.99}) {
        const Vec2 centre = layer.values.shape.centre(2, 0);
        EXPECT_EQ(value_at(file, frame.easting + centre.x() + aside, frame.northing + centre.y() + aside), 2.0F);
    }
    EXPECT_EQ(value_at(file, 903'010.1, 6'455'020.1), 0.0F) << "south-western corner";
    EXPECT_EQ(value_at(file, 903'010.1, 6'455'025.9), 200.0F) << "two rows further north";
    const float none = value_at(file, 903'013, 6'455'023);
    const double declared = file.GetRasterBand(1)->GetNoDataValue();
    EXPECT_TRUE(std::isnan(declared) ? std::isnan(none) : static_cast<double>(none) == declared) << none;
}

TEST(RasterWriter, GeoTiffLiesOnItsCells) {
    const test::TempDir dir;
    const RasterLayer layer = raster(4, 3);
    write_geotiff(dir / "energy_kj_max.tif", lambert93(), layer);
    EXPECT_TRUE(fs::exists(dir / "energy_kj_max.qml"));
    EXPECT_FALSE(fs::exists(dir / "energy_kj_max.tif.aux.xml"));
    const auto file = open(dir / "energy_kj_max.tif");
    expect_in_place(*file, layer, lambert93());
    EXPECT_TRUE(std::isnan(file->GetRasterBand(1)->GetNoDataValue()));
    EXPECT_STREQ(file->GetRasterBand(1)->GetMetadataItem("QUANTITY"), "Largest kinetic energy in the cell");
}

TEST(RasterWriter, CoverageLiesOnItsCells) {
    const test::TempDir dir;
    const RasterLayer layer = raster(4, 3);
    write_vector_layers(dir / "a.gpkg", lambert93(), std::vector{points_layer()});
    append_coverage(dir / "a.gpkg", lambert93(), layer);
    RasterLayer second = raster(300, 500);  // several tiles of 256 that do not fill up
    second.name = "speed_ms_max";
    second.title = "Largest speed";
    append_coverage(dir / "a.gpkg", lambert93(), second);
    expect_in_place(*open("GPKG:" + (dir / "a.gpkg").string() + ":energy_kj_max"), layer, lambert93());
    expect_in_place(*open("GPKG:" + (dir / "a.gpkg").string() + ":speed_ms_max"), second, lambert93());
    const auto file = open(dir / "a.gpkg");
    EXPECT_TRUE(file->GetLayerByName("stopping_points")) << "the vectors are still there";
    OGRLayer* answer = file->ExecuteSQL(
        "SELECT field_name, quantity_definition, grid_cell_encoding, uom, data_null"
        " FROM gpkg_2d_gridded_coverage_ancillary WHERE tile_matrix_set_name = 'energy_kj_max'",
        nullptr, nullptr);
    const OGRFeatureUniquePtr row(answer->GetNextFeature());
    EXPECT_STREQ(row->GetFieldAsString(0), "Largest energy");
    EXPECT_STREQ(row->GetFieldAsString(1), "Largest kinetic energy in the cell");
    EXPECT_STREQ(row->GetFieldAsString(2), "grid-value-is-area");
    EXPECT_STREQ(row->GetFieldAsString(3), "kJ");
    EXPECT_EQ(row->GetFieldAsDouble(4), -9999.0);
    file->ReleaseResultSet(answer);
}

TEST(RasterWriter, OverviewsShowTheLargestCell) {
    const test::TempDir dir;
    RasterLayer layer{.name = "energy_kj_max", .theme = RasterTheme::Energy};
    layer.values = Grid<float>({.columns = 1'301, .rows = 900}, std::nanf(""));
    layer.values.at(700, 333) = 5'000.0F;  // the only block of its neighbourhood
    layer.values.at(701, 333) = 1.0F;
    write_geotiff(dir / "energy_kj_max.tif", lambert93(), layer);
    const auto file = open(dir / "energy_kj_max.tif");
    GDALRasterBand* band = file->GetRasterBand(1);
    ASSERT_EQ(band->GetOverviewCount(), 2);
    for (int i = 0; i < 2; ++i) {
        GDALRasterBand* overview = band->GetOverview(i);
        std::vector<float> values(static_cast<std::size_t>(overview->GetXSize()) *
                                  static_cast<std::size_t>(overview->GetYSize()));
        ASSERT_EQ(overview->RasterIO(GF_Read, 0, 0, overview->GetXSize(), overview->GetYSize(), values.data(),
                                     overview->GetXSize(), overview->GetYSize(), GDT_Float32, 0, 0, nullptr),
                  CE_None);
        const int factor = 2 << i;
        const int x = 700 / factor;
        const int y = (899 - 333) / factor;
        EXPECT_EQ(values[static_cast<std::size_t>(y * overview->GetXSize() + x)], 5'000.0F);
        EXPECT_EQ(std::ranges::count_if(values, [](float v) { return !std::isnan(v); }), 1);
    }
}

TEST(RasterWriter, WithoutCrsNoneIsInvented) {
    const test::TempDir dir;
    write_vector_layers(dir / "a.gpkg", LocalFrame{}, {});
    append_coverage(dir / "a.gpkg", LocalFrame{}, raster(4, 3));
    write_geotiff(dir / "energy_kj_max.tif", LocalFrame{}, raster(4, 3));
    EXPECT_EQ(open(dir / "energy_kj_max.tif")->GetSpatialRef(), nullptr);
    const auto file = open(dir / "a.gpkg");
    OGRLayer* answer = file->ExecuteSQL(
        "SELECT srs_id FROM gpkg_contents UNION SELECT srs_id FROM gpkg_tile_matrix_set", nullptr, nullptr);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->GetFeatureCount(), 1);
    EXPECT_EQ(OGRFeatureUniquePtr(answer->GetNextFeature())->GetFieldAsInteger(0), -1);
    file->ReleaseResultSet(answer);
}

TEST(RasterWriter, RefusesWhatCannotBeStored) {
    const test::TempDir dir;
    RasterLayer layer = raster(4, 3);
    layer.values.values.pop_back();
    EXPECT_THROW(write_geotiff(dir / "a.tif", lambert93(), layer), InputError);
    layer = raster(4, 3);
    layer.name = "Energy kJ";
    EXPECT_THROW(write_geotiff(dir / "a.tif", lambert93(), layer), InputError);
    layer = raster(4, 3);
    layer.values.at(0, 0) = -9999.0F;
    write_vector_layers(dir / "a.gpkg", lambert93(), {});
    EXPECT_THROW(append_coverage(dir / "a.gpkg", lambert93(), layer), InputError);
    EXPECT_THROW(write_geotiff("/proc/no/such/folder/a.tif", lambert93(), raster(4, 3)), ComputeError);
    EXPECT_THROW(write_geotiff(dir / "a.tif", LocalFrame{.crs = "nonsense"}, raster(4, 3)), InputError);
}

}  // namespace
}  // namespace scree::gis
