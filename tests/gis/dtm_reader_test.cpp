// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/dtm_reader.hpp"

#include "gis/input_files.hpp"
#include "scree/base/error.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <limits>

namespace scree::gis {

namespace {

using test::RasterSpec;
using test::TempDir;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Dtm written_and_read(const RasterSpec& spec) {
    const TempDir dir;
    const std::string file = dir / "dtm.tif";
    test::write_raster(file, spec);
    return read_dtm(file);
}

std::string error_of(const RasterSpec& spec) {
    return test::input_error_of([&] { written_and_read(spec); });
}

RasterSpec with_cell(double value) {
    RasterSpec spec;
    spec.value = [value, plane = spec.value](int c, int r) { return c == 3 && r == 4 ? value : plane(c, r); };
    return spec;
}

}  // namespace

TEST(DtmReader, PutsEveryCellInItsPlace) {
    const Dtm dtm = written_and_read({});
    EXPECT_EQ(dtm.columns, 40);
    EXPECT_EQ(dtm.rows, 30);
    EXPECT_EQ(dtm.dx, 2.0);
    EXPECT_EQ(dtm.dy, 2.0);
    EXPECT_EQ(dtm.frame.easting, 900000.0);
    EXPECT_EQ(dtm.frame.northing, 6400000.0);
    EXPECT_EQ(dtm.frame.height, 1100.0);
    EXPECT_THAT(dtm.frame.crs, HasSubstr("PROJCRS"));
    EXPECT_THAT(dtm.report.crs_name, AllOf(HasSubstr("Lambert-93"), HasSubstr("EPSG:2154")));
    EXPECT_EQ(dtm.north_west, Vec2(13.0, 77.0));
    EXPECT_EQ(dtm.at(0, 29), 100.25);  // first row of the file is in the north
    EXPECT_EQ(dtm.at(39, 0), 100.25 + 0.5 * 39 - 0.75 * 29);
    EXPECT_EQ(dtm.report.valid_fraction, 1.0);
    EXPECT_THAT(dtm.report.warnings, IsEmpty());
}

TEST(DtmReader, SingleCellsFarFromAllAroundAreSaid) {
    const double there = 1200.25 + 0.5 * 3 - 0.75 * 4;
    EXPECT_THAT(written_and_read(with_cell(there + 30.0)).report.warnings, IsEmpty()) << "a tower of 15 cells";
    for (const double by : {60.0, -60.0})
        EXPECT_THAT(written_and_read(with_cell(there + by)).report.warnings,
                    ElementsAre(AllOf(HasSubstr("1 cell more than 40 m above or below"),
                                      HasSubstr("column 4 from the west and row 5 from the north"))));
}

TEST(DtmReader, RowsFromSouthAndColumnsFromEastAreTurned) {
    const Dtm north_up = written_and_read({});
    RasterSpec south_up;
    south_up.geotransform = {900013.0, 2.0, 0.0, 6400077.0 - 60.0, 0.0, 2.0};
    south_up.value = [plane = RasterSpec().value](int c, int r) { return plane(c, 29 - r); };
    RasterSpec west_left = south_up;
    west_left.geotransform = {900013.0 + 80.0, -2.0, 0.0, 6400077.0 - 60.0, 0.0, 2.0};
    west_left.value = [plane = RasterSpec().value](int c, int r) { return plane(39 - c, 29 - r); };
    for (const RasterSpec& spec : {south_up, west_left}) {
        const Dtm dtm = written_and_read(spec);
        EXPECT_EQ(dtm.heights, north_up.heights);
        EXPECT_EQ(dtm.north_west, north_up.north_west);
    }
}

TEST(DtmReader, CellsMayBeOblong) {
    RasterSpec spec;
    spec.geotransform[5] = -3.0;
    const Dtm dtm = written_and_read(spec);
    EXPECT_EQ(dtm.dx, 2.0);
    EXPECT_EQ(dtm.dy, 3.0);
    EXPECT_EQ(dtm.bounds().max - dtm.bounds().min, Vec2(80.0, 90.0));
}

TEST(DtmReader, NodataNanAndTagBeyondFloatAreHoles) {
    RasterSpec tagged = with_cell(-9999);
    tagged.nodata = -9999;
    EXPECT_TRUE(std::isnan(written_and_read(tagged).at(3, 25)));

    EXPECT_TRUE(std::isnan(written_and_read(with_cell(kNaN)).at(3, 25)));

    RasterSpec lowest = with_cell(-std::numeric_limits<float>::max());
    lowest.type = "Float32";
    lowest.nodata = -3.4028234663852886e38;
    const Dtm dtm = written_and_read(lowest);
    EXPECT_TRUE(std::isnan(dtm.at(3, 25)));
    EXPECT_DOUBLE_EQ(dtm.report.valid_fraction, 1.0 - 1.0 / 1200.0);
}

TEST(DtmReader, UntaggedNodataIsRefusedWithTheCure) {
    for (const double value : {-9999.0, -32768.0, -3.4e38, 1e20, 65535.0, -999.0}) {
        EXPECT_THAT(error_of(with_cell(value)),
                    AllOf(HasSubstr("gdal_translate -a_nodata"), HasSubstr("column 4, row 5")))
            << value;
    }
    EXPECT_THAT(error_of(with_cell(0)), AllOf(HasSubstr("holes filled with zero"), HasSubstr("-a_nodata 0")));
    RasterSpec low;  // no height far above zero
    low.value = [](int c, int r) { return c == 3 && r == 4 ? -99.0 : 40.25 + c + r; };
    EXPECT_THAT(error_of(low), HasSubstr("-a_nodata -99"));
    low.value = [](int c, int r) { return c == 3 && r == 4 ? 0.0 : 40.25 + c + r; };
    EXPECT_THAT(written_and_read(low).report.warnings, Contains(HasSubstr("1 cell of height 0")));
    EXPECT_THAT(error_of(with_cell(kInfinity)), AllOf(HasSubstr("infinity"), HasSubstr("column 4, row 5")));
}

TEST(DtmReader, HeightsInCentimetresAreNoNodata) {
    RasterSpec spec;
    spec.value = [](int c, int r) { return 115000.0 + 10.0 * c + 7.0 * r; };
    EXPECT_THAT(error_of(spec),
                AllOf(HasSubstr("centimetres or feet"), HasSubstr("-scale"), Not(HasSubstr("-a_nodata"))));
}

TEST(DtmReader, ScaleAndOffsetAreApplied) {
    RasterSpec spec;
    spec.type = "Int16";
    spec.scale = 0.1;
    spec.offset = 1000;
    spec.value = [](int c, int r) { return 10.0 * c + r; };
    const Dtm dtm = written_and_read(spec);
    EXPECT_NEAR(dtm.at(5, 29) + dtm.frame.height, 1005.0, 1e-9);
    EXPECT_THAT(dtm.report.warnings, Contains(HasSubstr("scaled heights")));
}

// A tag written by mistake would make a plain of any mountain.
TEST(DtmReader, AScaleThatLeavesNothingIsRefusedAndAPlainWarnedOf) {
    RasterSpec spec;
    spec.scale = 0.0;
    EXPECT_THAT(error_of(spec), AllOf(HasSubstr("the scale 0"), HasSubstr("gdal_edit.py -scale 1")));
    RasterSpec plain;
    plain.value = [](int, int) { return 12.5; };
    EXPECT_THAT(written_and_read(plain).report.warnings,
                ElementsAre(HasSubstr("the same height in all its cells, 12.5 m")));
}

// One cell is enough to lose the blocks of a channel; where a survey ends is no hole.
TEST(DtmReader, HolesAmidGroundAreSaid) {
    RasterSpec hole = with_cell(-9999);
    hole.nodata = -9999;
    EXPECT_THAT(written_and_read(hole).report.warnings,
                ElementsAre(AllOf(HasSubstr("1 cell without a height amid others"),
                                  HasSubstr("column 4 from the west and row 5 from the north"))));
    RasterSpec bay;  // open to the west, over a corner
    bay.nodata = -9999;
    bay.value = [plane = RasterSpec().value](int c, int r) {
        return (c < 3 && r == 5) || (c == 3 && r == 6) ? -9999.0 : plane(c, r);
    };
    EXPECT_THAT(written_and_read(bay).report.warnings, IsEmpty());
}

TEST(DtmReader, WholeMetresAreWarnedOf) {
    RasterSpec spec;
    spec.type = "Int16";
    EXPECT_THAT(written_and_read(spec).report.warnings, Contains(HasSubstr("whole metres")));
}

TEST(DtmReader, UnitsAndFramesThatWouldSilentlyBeWrongAreRefused) {
    RasterSpec degrees;
    degrees.crs = "EPSG:4326";
    degrees.geotransform = {6.0, 1e-4, 0, 45.0, 0, -1e-4};
    EXPECT_THAT(error_of(degrees), AllOf(HasSubstr("degrees"), HasSubstr("EPSG:32632")));
    degrees.crs = "";
    EXPECT_THAT(error_of(degrees), HasSubstr("seems to be in degrees"));

    RasterSpec feet;
    feet.crs = "EPSG:2227";
    feet.geotransform = {6500000, 10, 0, 2100000, 0, -10};
    EXPECT_THAT(error_of(feet), HasSubstr("US survey foot"));

    RasterSpec vertical_feet;
    vertical_feet.crs = "EPSG:2154+6360";
    EXPECT_THAT(error_of(vertical_feet), AllOf(HasSubstr("heights in"), HasSubstr("foot")));

    OGRSpatialReference in_one;  // eastings, northings and heights in a single CRS
    ASSERT_EQ(in_one.SetFromUserInput("EPSG:2154"), OGRERR_NONE);
    ASSERT_EQ(in_one.PromoteTo3D(nullptr), OGRERR_NONE);
    char* wkt = nullptr;
    const char* const options[] = {"FORMAT=WKT2", nullptr};
    ASSERT_EQ(in_one.exportToWkt(&wkt, options), OGRERR_NONE);
    vertical_feet.crs = wkt;
    CPLFree(wkt);
    const std::string metre = "LENGTHUNIT[\"metre\",1";
    vertical_feet.crs.replace(vertical_feet.crs.rfind(metre), metre.size(), "LENGTHUNIT[\"foot\",0.3048");
    EXPECT_THAT(error_of(vertical_feet), AllOf(HasSubstr("heights in"), HasSubstr("0.3048")));

    RasterSpec band_feet;
    band_feet.unit = "ft";
    EXPECT_THAT(error_of(band_feet), AllOf(HasSubstr("'ft'"), HasSubstr("0.3048")));

    RasterSpec mercator;
    mercator.crs = "EPSG:3857";
    mercator.geotransform = {1250000, 2, 0, 6000000, 0, -2};
    EXPECT_THAT(error_of(mercator), AllOf(HasSubstr("Pseudo-Mercator"), HasSubstr("0.67")));

    RasterSpec rotated;
    rotated.geotransform[2] = 0.3;
    rotated.geotransform[4] = 0.3;
    EXPECT_THAT(error_of(rotated), HasSubstr("rotated"));

    RasterSpec none;
    none.geotransform = {0, 1, 0, 0, 0, 1};
    EXPECT_THAT(error_of(none), HasSubstr("no georeference"));
}

// An alpha band hides cells whatever its type; GDAL itself looks at those of whole numbers only.
TEST(DtmReader, AlphaBandsHideCells) {
    for (const char* type : {"Float32", "Float64", "UInt16"}) {
        RasterSpec spec;
        spec.type = type;
        spec.value = [](int c, int) { return c < 10 ? 0.0 : 1200.0 + c; };
        spec.alpha = [](int c, int) { return c < 10 ? 0.0 : 1.0; };
        const Dtm dtm = written_and_read(spec);
        EXPECT_DOUBLE_EQ(dtm.report.valid_fraction, 0.75) << type;
        EXPECT_TRUE(std::isnan(dtm.at(9, 0))) << type;
        EXPECT_FALSE(std::isnan(dtm.at(10, 0))) << type;
    }
}

TEST(DtmReader, AxesThatPointTheOtherWayAreRefused) {
    RasterSpec spec;
    spec.crs = "EPSG:2053";  // Hartebeesthoek94 / Lo29: westings and southings
    spec.geotransform = {10000, 2, 0, 2900000, 0, -2};
    EXPECT_THAT(error_of(spec), AllOf(HasSubstr("Lo29"), HasSubstr("west or south")));
    spec.crs = "EPSG:5513";  // Krovak: southings and westings
    EXPECT_THAT(error_of(spec), HasSubstr("west or south"));
    RasterSpec depths;
    depths.crs = "EPSG:2154+5831";
    EXPECT_THAT(error_of(depths), HasSubstr("positive downwards"));
    RasterSpec northings_first;
    northings_first.crs = "EPSG:31467";  // Gauss-Krueger: northings come first, and grow to the north
    northings_first.geotransform = {3500000, 2, 0, 5300000, 0, -2};
    EXPECT_THAT(written_and_read(northings_first).report.crs_name, HasSubstr("31467"));
}

TEST(DtmReader, CompoundCrsIsReducedToItsHorizontalPart) {
    RasterSpec spec;
    spec.crs = "EPSG:2154+5720";
    const Dtm dtm = written_and_read(spec);
    EXPECT_THAT(dtm.frame.crs, ::testing::Not(HasSubstr("COMPOUND")));
    EXPECT_THAT(dtm.report.crs_name, HasSubstr("Lambert-93"));
}

TEST(DtmReader, ShapesThatAreNoTerrainAreRefused) {
    RasterSpec bands;
    bands.bands = 3;
    EXPECT_THAT(error_of(bands), HasSubstr("3 bands"));
    RasterSpec small;
    small.columns = 1;
    EXPECT_THAT(error_of(small), HasSubstr("1 x 30"));
    RasterSpec complex;
    complex.type = "CFloat32";
    EXPECT_THAT(error_of(complex), HasSubstr("complex"));
    RasterSpec empty;
    empty.nodata = 7;
    empty.value = [](int, int) { return 7.0; };
    EXPECT_THAT(error_of(empty), HasSubstr("0 cells with a height"));

    const TempDir dir;
    test::write_raster(dir / "a.tif", {});
    DtmSettings settings;
    settings.max_cells = 1000;
    EXPECT_THAT(test::input_error_of([&] { read_dtm(dir / "a.tif", settings); }),
                AllOf(HasSubstr("40 x 30"), HasSubstr("1000")));
    EXPECT_THAT(test::input_error_of([&] { read_dtm(dir / "b.tif"); }), HasSubstr("does not exist"));
}

// Files that were found in the wild or made to be awkward: name, words that the refusal must contain.
struct Refused {
    const char* file;
    std::vector<std::string> says;
};

class AwkwardRaster : public ::testing::TestWithParam<Refused> {};

TEST_P(AwkwardRaster, IsRefusedWithAReason) {
    SCREE_SHARED_OR_SKIP(folder, "badinputs/raster");
    const std::string message = test::input_error_of([&] { read_dtm(folder / GetParam().file); });
    EXPECT_THAT(message, HasSubstr(GetParam().file));
    for (const std::string& word : GetParam().says) EXPECT_THAT(message, HasSubstr(word));
}

INSTANTIATE_TEST_SUITE_P(
    Files, AwkwardRaster,
    ::testing::Values(
        Refused{"r01_truncated.tif", {"damaged or incomplete"}}, Refused{"r03_html_login_page.tif", {"HTML"}},
        Refused{"r09_rotated_15deg.tif", {"rotated by 15"}}, Refused{"r13_1x1.tif", {"1 x 1"}},
        Refused{"r15_rgb_3band.tif", {"3 bands"}}, Refused{"r19_us_survey_feet_xy.tif", {"foot"}},
        Refused{"r21_vertical_feet_unit.tif", {"'ft'"}}, Refused{"r23_infinities.tif", {"infinity", "column"}},
        Refused{"r25_gdal_complex_type.tif", {"complex"}}, Refused{"r27_gdal_gcps_only.tif", {"control points"}},
        Refused{"r29_vrt_missing_source.vrt", {"tile_that_does_not_exist.tif"}},
        Refused{"r31_asc_rows_missing.asc", {"damaged or incomplete"}}, Refused{"r33_asc_no_header.asc", {"GDAL says"}},
        Refused{"r35_gdal_starting_with_nan.asc", {}}, Refused{"r39_gdal_claims_100000x1632895392.tif", {"1632895392"}},
        Refused{"r41_gdal_unknown_codec.tif", {"codec"}}, Refused{"r43_gdal_moon_crs_1x1.tif", {"1 x 1"}},
        Refused{"r45_does_not_exist.tif", {"does not exist"}}, Refused{"r47_web_mercator.tif", {"Pseudo-Mercator"}}),
    [](const auto& test) { return std::string(test.param.file).substr(0, 3); });

TEST(AwkwardRasters, UsableOnesAreReadRight) {
    SCREE_SHARED_OR_SKIP(folder, "badinputs");
    const Dtm control = read_dtm(folder / "control/good_dtm.tif");
    EXPECT_THAT(control.report.warnings, IsEmpty());
    const Dtm south_up = read_dtm(folder / "raster/r11_south_up.tif");
    EXPECT_EQ(south_up.heights.size(), control.heights.size());
    for (std::size_t i = 0; i < control.heights.size(); ++i) {
        if (std::isnan(control.heights[i])) continue;
        ASSERT_EQ(south_up.heights[i], control.heights[i]) << i;
    }
    EXPECT_NEAR((south_up.north_west - control.north_west).norm(), 0, 1e-6);

    const Dtm holes = read_dtm(folder / "raster/r05_nan_no_nodata_tag.tif");
    EXPECT_LT(holes.report.valid_fraction, 1.0);

    const Dtm masked = read_dtm(folder / "raster/r37_mask_band.tif");
    for (const int column : {89, 90, 129}) EXPECT_EQ(std::isnan(masked.at(column, 100)), column >= 90) << column;

    EXPECT_THAT(read_dtm(folder / "raster/r07_int16_metres.tif").report.warnings, Contains(HasSubstr("whole metres")));
    const Dtm no_crs = read_dtm(folder / "raster/r17_no_crs.tif");
    EXPECT_THAT(no_crs.report.warnings, Contains(HasSubstr("no coordinate reference system")));
    EXPECT_EQ(no_crs.frame.crs, "");
}

}  // namespace scree::gis
