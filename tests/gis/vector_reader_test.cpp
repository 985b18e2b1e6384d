// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/vector_reader.hpp"

#include "gis/dtm_reader.hpp"
#include "gis/input_files.hpp"
#include "scree/geometry/region.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace scree::gis {

namespace {

using test::TempDir;
using test::VectorSpec;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<GeometryKind> kPolygons{GeometryKind::Polygon};
const Box2 kExtent{{0, 0}, {100, 100}};

// A terrain of 100 x 100 m in Lambert 93.
LocalFrame lambert() {
    static const std::string wkt = [] {
        const TempDir dir;
        test::write_raster(dir / "a.tif", {});
        return read_dtm(dir / "a.tif").frame.crs;
    }();
    return {900000, 6400000, 1000, wkt};
}

std::string square(double x, double y, double size = 10) {
    std::ostringstream out;
    out.precision(12);
    x += 900000, y += 6400000;
    out << "POLYGON ((" << x << ' ' << y << ", " << x << ' ' << y + size << ", " << x + size << ' ' << y + size << ", "
        << x + size << ' ' << y << ", " << x << ' ' << y << "))";
    return out.str();
}

VectorData written_and_read(const VectorSpec& spec, const std::vector<GeometryKind>& kinds = kPolygons) {
    const TempDir dir;
    test::write_vector(dir / "a.gpkg", spec);
    return read_vector({dir / "a.gpkg", "", kinds, "zones"}, lambert(), kExtent);
}

std::string error_of(const VectorSpec& spec, const std::vector<GeometryKind>& kinds = kPolygons) {
    return test::input_error_of([&] { written_and_read(spec, kinds); });
}

}  // namespace

TEST(VectorReader, RingsComeOutInOneForm) {
    VectorSpec spec;
    spec.rows = {
        {"POLYGON ((900000 6400000, 900000 6400010, 900010 6400010, 900010 6400010, 900010 6400000, 900000 6400000), "
         "(900002 6400002, 900004 6400002, 900004 6400004, 900002 6400004, 900002 6400002))",
         "a", 1.0}};
    const VectorData data = written_and_read(spec);
    const auto& polygons = std::get<MultiPolygon>(data.layer.features.at(0).geometry);
    ASSERT_EQ(polygons.size(), 1u);
    EXPECT_EQ(polygons[0].outer, (Ring{{10, 0}, {10, 10}, {0, 10}, {0, 0}}));
    EXPECT_EQ(polygons[0].holes.at(0), (Ring{{2, 4}, {4, 4}, {4, 2}, {2, 2}}));
    EXPECT_EQ(data.report.operation, "");
    EXPECT_THAT(data.report.warnings, IsEmpty());
}

// Results are in UTF-8, whatever an input without a statement of its encoding holds.
TEST(VectorReader, TextThatIsNotUtf8IsTakenAsLatin1AndSaid) {
    VectorSpec spec;
    spec.rows = {{square(10, 10),
                  "M\xFC"
                  "hle",
                  1.0},
                 {square(40, 40),
                  "Stra\xDF"
                  "e",
                  1.0}};
    const VectorData data = written_and_read(spec);
    EXPECT_EQ(std::get<std::string>(data.layer.features.at(0).values.at(0)), "Mühle");
    EXPECT_EQ(std::get<std::string>(data.layer.features.at(1).values.at(0)), "Straße");
    EXPECT_THAT(data.report.warnings, ElementsAre(HasSubstr("ISO-8859-1"))) << "said once";
}

TEST(VectorReader, KeepsHeightsOfPointsAndLinesAndDropsMeasures) {
    VectorSpec spec;
    spec.rows = {{"LINESTRING ZM (900000 6400000 1010 1, 900000 6400000 1011 2, 900005 6400005 1012 3)", "", {}},
                 {"LINESTRING (900000 6400000, 900001 6400001)", "", {}}};
    const VectorData data = written_and_read(spec, {GeometryKind::LineString});
    const auto& line = std::get<Polylines>(data.layer.features[0].geometry).at(0);
    ASSERT_EQ(line.points.size(), 2u);
    EXPECT_EQ(line.points[1], Vec3(5, 5, 12));
    EXPECT_THAT(line.measure, IsEmpty());
    EXPECT_TRUE(std::isnan(std::get<Polylines>(data.layer.features[1].geometry).at(0).points[0].z()));
}

TEST(VectorReader, CurvesBecomeChords) {
    VectorSpec spec;
    spec.rows = {
        {"CURVEPOLYGON (CIRCULARSTRING (900000 6400010, 900010 6400020, 900020 6400010, 900010 6400000, 900000 "
         "6400010))",
         "disc",
         {}}};
    const VectorData data = written_and_read(spec);
    const Region region(std::get<MultiPolygon>(data.layer.features[0].geometry));
    EXPECT_NEAR(region.area(), M_PI * 100, 0.03);
}

TEST(VectorReader, TransformsFromOtherSystemsAndSaysHowWell) {
    VectorSpec spec;
    spec.crs = "EPSG:4326";
    spec.rows = {{"POINT (5.523806636 44.670519183)", "", {}}};  // gdaltransform of (900010, 6400020)
    const VectorData data = written_and_read(spec, {GeometryKind::Point});
    const Vec3 p = std::get<Points>(data.layer.features[0].geometry).at(0);
    EXPECT_NEAR(p.x(), 10, 1e-3);
    EXPECT_NEAR(p.y(), 20, 1e-3);
    EXPECT_TRUE(std::isnan(p.z()));
    EXPECT_NE(data.report.operation, "");
    EXPECT_FALSE(std::isnan(data.report.accuracy));
}

TEST(VectorReader, KindIsCheckedFeatureByFeature) {
    VectorSpec spec;
    spec.rows = {{square(0, 0), "a", {}}, {"POINT (900000 6400000)", "b", {}}};
    EXPECT_THAT(error_of(spec), AllOf(HasSubstr("feature 2"), HasSubstr("Point"), HasSubstr("polygons are needed")));
    EXPECT_THAT(error_of(spec, {GeometryKind::Polygon, GeometryKind::Point}),
                AllOf(HasSubstr("feature 2"), HasSubstr("layer of its own")));
}

TEST(VectorReader, PolygonThatCrossesItselfIsRefusedWithThePlace) {
    VectorSpec spec;
    spec.rows = {
        {"POLYGON ((900000 6400000, 900010 6400010, 900010 6400000, 900000 6400010, 900000 6400000))", "a", {}}};
    EXPECT_THAT(error_of(spec),
                AllOf(HasSubstr("feature 1"), HasSubstr("900005 6400005"), HasSubstr("Fix geometries")));
}

TEST(VectorReader, LayersAreChosenByName) {
    const TempDir dir;
    VectorSpec spec;
    spec.rows = {{square(0, 0), "a", {}}};
    spec.layer = "Fläche 岩";
    test::write_vector(dir / "ä.gpkg", spec);
    spec.layer = "other";
    test::write_vector(dir / "ä.gpkg", spec, true);
    const auto read = [&](const std::string& layer) {
        return read_vector({dir / "ä.gpkg", layer, kPolygons, "zones"}, lambert(), kExtent);
    };
    EXPECT_EQ(read("Fläche 岩").layer.name, "Fläche 岩");
    for (const char* name : {"", "none"}) {
        EXPECT_THAT(test::input_error_of([&] { read(name); }),
                    AllOf(HasSubstr("'Fläche 岩', 'other'"), HasSubstr("ä.gpkg")));
    }
}

TEST(VectorReader, PlaceIsComparedWithTheTerrain) {
    VectorSpec spec;
    spec.rows = {{square(50, 50), "in", {}}, {square(95, 50), "across", {}}, {square(500, 50), "out", {}}};
    EXPECT_THAT(written_and_read(spec).report.warnings,
                AllOf(Contains(HasSubstr("1 feature reaching beyond the terrain (first: 2)")),
                      Contains(HasSubstr("(first: 3)"))));
    spec.rows = {{square(500, 50), "out", {}}};
    EXPECT_THAT(error_of(spec), AllOf(HasSubstr("wholly outside"), HasSubstr("easting 900500.0 to 900510.0"),
                                      HasSubstr("northing 6400000.0 to 6400100.0")));
    spec.rows = {{"POLYGON ((6400000 900000, 6400000 900010, 6400010 900010, 6400000 900000))", "swapped", {}}};
    EXPECT_THAT(error_of(spec), HasSubstr("x and y exchanged"));
}

TEST(VectorReader, MissingGeometriesAndEmptyLayers) {
    VectorSpec spec;
    EXPECT_THAT(error_of(spec), HasSubstr("is empty"));
    spec.rows = {{"", "a", {}}, {square(0, 0), "b", {}}};
    const VectorData data = written_and_read(spec);
    EXPECT_EQ(data.layer.features.size(), 1u);
    EXPECT_THAT(data.report.warnings, Contains(HasSubstr("without a geometry (first: 1)")));
}

TEST(VectorFields, ValuesAreCheckedTogether) {
    VectorSpec spec;
    spec.number_field = "block_m3";
    spec.rows = {{square(0, 0), "a", 2.5}, {square(0, 0), "b", -1}, {square(0, 0), " ", {}}};
    const VectorData data = written_and_read(spec);
    NumberRule rule{.field = "block_m3", .low = 0, .low_included = false};
    EXPECT_THAT(test::input_error_of([&] { number_field(data, rule); }),
                AllOf(HasSubstr("feature 2: -1"), HasSubstr("feature 3: no value"), HasSubstr("greater than 0")));
    rule = {.field = "block_m3", .low = -5, .null_allowed = true};
    const std::vector<double> numbers = number_field(data, rule);
    EXPECT_EQ(numbers[0], 2.5);
    EXPECT_TRUE(std::isnan(numbers[2]));
    EXPECT_THAT(test::input_error_of([&] { text_field(data, "soil"); }), HasSubstr("feature 3"));
    EXPECT_THAT(test::input_error_of([&] { text_field(data, "sol"); }),
                AllOf(HasSubstr("no field 'sol'"), HasSubstr("'soil', 'block_m3'")));
}

// --- awkward files ---

namespace {

struct Site {
    LocalFrame frame;
    Box2 extent;
};

Site control_site(const std::filesystem::path& folder) {
    const Dtm dtm = read_dtm(folder / "control/good_dtm.tif");
    return {dtm.frame, dtm.bounds()};
}

VectorData read_awkward(const std::filesystem::path& folder, const std::string& name, const std::string& layer = "") {
    const Site site = control_site(folder);
    return read_vector({folder / name, layer, kPolygons, "release zones"}, site.frame, site.extent);
}

Vec2 centre_of(const VectorData& data) {
    return Region(std::get<MultiPolygon>(data.layer.features.at(0).geometry)).bounds().max;
}

}  // namespace

TEST(AwkwardVectors, AreRefusedWithAReason) {
    SCREE_SHARED_OR_SKIP(folder, "badinputs");
    const auto message = [&, folder = folder](const std::string& name, const std::string& layer = "") {
        return test::input_error_of([&] { read_awkward(folder, name, layer); });
    };
    EXPECT_THAT(message("vector/v05_empty_layer.gpkg"), HasSubstr("is empty"));
    EXPECT_THAT(message("vector/v13_truncated.gpkg"), AllOf(HasSubstr("v13_truncated.gpkg"), HasSubstr("malformed")));
    EXPECT_THAT(message("vector/v15_lines.gpkg"), AllOf(HasSubstr("Line String"), HasSubstr("polygons are needed")));
    EXPECT_THAT(message("vector/v19_mixed_types.gpkg"), HasSubstr("feature 2, a Point"));
    EXPECT_THAT(message("vector/v23_geojson_latlon_swapped.geojson"),
                AllOf(HasSubstr("outside"), HasSubstr("x and y exchanged")));
    EXPECT_THAT(message("vector/v25_gdal_huge_feature_count.gpkg"), HasSubstr("'test', 'test2'"));
    EXPECT_THAT(message("vector/v25_gdal_huge_feature_count.gpkg", "test"), HasSubstr("(385, -293)"));
}

TEST(AwkwardVectors, UsableOnesAreReadRight) {
    SCREE_SHARED_OR_SKIP(folder, "badinputs");
    const VectorData control = read_awkward(folder, "control/good_release.gpkg");
    EXPECT_THAT(control.report.warnings, IsEmpty());
    for (const char* name :
         {"vector/v01_release_epsg4326.gpkg", "vector/v03_release_no_crs.gpkg", "vector/v07_polygon_zm.gpkg",
          "vector/v11 Ablösefläche Süd 岩.gpkg", "vector/v17_overlapping.gpkg", "vector/v27_20000_vertices.gpkg"}) {
        const VectorData data = read_awkward(folder, name);
        EXPECT_LT((centre_of(data) - centre_of(control)).norm(), 1.0) << name;
    }
    EXPECT_THAT(read_awkward(folder, "vector/v03_release_no_crs.gpkg").report.warnings,
                ElementsAre(HasSubstr("no coordinate reference system")));
    EXPECT_THAT(read_awkward(folder, "vector/v09_partly_outside.gpkg").report.warnings,
                ElementsAre(HasSubstr("reaching beyond")));
    const VectorData values = read_awkward(folder, "vector/v21_bad_values.gpkg");
    EXPECT_THAT(test::input_error_of(
                    [&] { number_field(values, {.field = "block_m3", .low = 0, .high = 1e5, .low_included = false}); }),
                AllOf(HasSubstr("feature 1: -1, feature 2: 0, feature 3: 1e+30, feature 4: no value"),
                      HasSubstr("at most 100000")));
}

}  // namespace scree::gis
