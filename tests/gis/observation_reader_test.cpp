// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements from layers, tables and folders: what is read, how positions come into the local frame, and what is refused.
#include "gis/observation_reader.hpp"

#include "gis/crs.hpp"
#include "gis/dataset.hpp"
#include "gis/input_files.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace scree::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// A terrain of 200 x 200 m in Lambert 93.
LocalFrame frame() {
    return {900000.0, 6400000.0, 1000.0, gis::named_crs("EPSG:2154", "test").wkt};
}
const Box2 kExtent{{0, 0}, {200, 200}};

class ObservationReader : public testing::Test {
protected:
    std::string put(const std::string& name, const std::string& text) {
        const auto file = folder_ / name;
        std::ofstream(file, std::ios::binary) << text;
        return file.string();
    }
    gis::ObservationRecords read(const std::string& path) const {
        return gis::read_observations(path, frame(), kExtent);
    }
    std::string error(const std::string& path) const {
        return input_error_of([&] { read(path); });
    }
    TempDir folder_;
};

TEST_F(ObservationReader, ReadsATableOfStops) {
    const auto o =
        read(put("stops.csv",
                 "block_id,easting_m,northing_m,z_m,crs,mass_kg,L1_m,L2_m,L3_m,position_error_m,censored,broken\n"
                 "A,900010.5,6400020,1003,EPSG:2154,1200,1,1.2,0.8,0.1,,1\n"
                 "B,,,,EPSG:2154,,,,,,yes,0\n"));
    ASSERT_EQ(o.stops.size(), 2U);
    EXPECT_EQ(o.stops[0].row, 2);
    EXPECT_EQ(o.stops[0].body.id, "A");
    EXPECT_EQ(o.stops[0].body.mass, 1200.0);
    EXPECT_EQ(o.stops[0].body.l1, 1.2) << "edges are sorted";
    EXPECT_EQ(o.stops[0].body.l2, 1.0);
    EXPECT_EQ(o.stops[0].position, Vec3(10.5, 20.0, 3.0));
    EXPECT_EQ(o.stops[0].error, 0.1);
    EXPECT_FALSE(o.stops[0].censored);
    EXPECT_TRUE(o.stops[0].broken);
    EXPECT_TRUE(std::isnan(o.stops[1].position.x())) << "thrown, and not found";
    EXPECT_TRUE(std::isnan(o.stops[1].body.mass));
    EXPECT_TRUE(std::isnan(o.stops[1].error));
    EXPECT_TRUE(o.stops[1].censored);
    EXPECT_THAT(o.warnings, IsEmpty());
    EXPECT_THAT(o.sources[0], HasSubstr("stops.csv: 2 records, RGF93"));
}

// An outline of a block has no place of its own: refused, as its position would be lost.
TEST_F(ObservationReader, RefusesStopsDrawnAsPolygons) {
    VectorSpec spec;
    spec.layer = "stopping_points";
    spec.rows = {{"POLYGON((900010 6400010,900011 6400010,900011 6400011,900010 6400010))", "a", 1.0}};
    const std::string file = (folder_ / "field.gpkg").string();
    write_vector(file, spec);
    EXPECT_THAT(error(file), HasSubstr("stopping_points"));
}

// What tells soils and screens apart is in the table of a Shapefile, not in its shapes: the account has both.
TEST_F(ObservationReader, AllPartsOfAShapefileStandBehindIt) {
    VectorSpec spec;
    spec.driver = "ESRI Shapefile";
    spec.rows = {{"POINT(900010 6400010)", "a", 1.0}};
    const std::string file = (folder_ / "zones.shp").string();
    write_vector(file, spec);
    const std::vector<std::string> files = gis::files_behind(file);
    EXPECT_EQ(files.front(), file);
    for (const char* part : {".dbf", ".prj", ".shx"})
        EXPECT_THAT(files, Contains((folder_ / (std::string("zones") + part)).string()));
    const std::string table = put("table.csv", "a,b\n1,2\n");
    EXPECT_EQ(gis::files_behind(table), std::vector<std::string>{table});
}

// What a GIS writes for itself when it shows a raster changes nothing; a scale does. What another program has in the log of a GeoPackage counts.
TEST_F(ObservationReader, WhatChangesValuesStandsBehindARaster) {
    RasterSpec raster;
    const std::string file = (folder_ / "dtm.tif").string();
    write_raster(file, raster);
    const std::string beside =
        put("dtm.tif.aux.xml",
            "<PAMDataset><PAMRasterBand band=\"1\"><Metadata><MDI key=\"STATISTICS_MEAN\">5</MDI>"
            "</Metadata></PAMRasterBand></PAMDataset>");
    EXPECT_THAT(gis::files_behind(file), testing::Not(Contains(beside)));
    put("dtm.tif.aux.xml", "<PAMDataset><PAMRasterBand band=\"1\"><Scale>1.05</Scale></PAMRasterBand></PAMDataset>");
    EXPECT_THAT(gis::files_behind(file), Contains(beside));

    VectorSpec vector;
    vector.rows = {{"POINT(900010 6400010)", "a", 1.0}};
    const std::string package = (folder_ / "zones.gpkg").string();
    write_vector(package, vector);
    EXPECT_EQ(gis::files_behind(package), std::vector<std::string>{package});
    const std::string log = put("zones.gpkg-wal", "not yet moved");
    EXPECT_THAT(gis::files_behind(package), Contains(log));
}

// A slip in a name must not leave out half of what was measured.
TEST_F(ObservationReader, NamesTablesAndLayersThatItDoesNotRead) {
    const std::string stops = "block_id,easting_m,northing_m,crs\nA,900010,6400020,EPSG:2154\n";
    const std::string crossings = "block_id,screen,speed_ms\nA,S1,5\n";
    put("stopping_points.csv", stops);
    put("Screen_Crossings.CSV", crossings);
    const auto both = read(folder_.path().string());
    EXPECT_EQ(both.crossings.size(), 1U) << "case does not count";
    EXPECT_THAT(both.warnings, IsEmpty());
    put("crossings_2.csv", crossings);
    EXPECT_THAT(read(folder_.path().string()).warnings, Contains(HasSubstr("hold 'crossings_2.csv', which is not")));
    put("screen_crossings.csv", crossings);
    EXPECT_THAT(error(folder_.path().string()), HasSubstr("which one counts?"));

    VectorSpec spec;
    spec.layer = "stopping_points";
    spec.text_field = "block_id";
    spec.rows = {{"POINT(900010 6400010)", "a", 1.0}};
    const std::string file = (folder_ / "field.gpkg").string();
    write_vector(file, spec);
    spec.layer = "crossing";
    write_vector(file, spec, true);
    EXPECT_THAT(read(file).warnings, Contains(HasSubstr("hold 'crossing', which is not read")));
}

TEST_F(ObservationReader, RowsWithoutAnyValueAreSaid) {
    const auto o = read(put("stops.csv", "easting_m,northing_m\n900010,6400020\n,\n,\n\n"));
    EXPECT_EQ(o.stops.size(), 1U);
    EXPECT_THAT(o.warnings, Contains(testing::AllOf(HasSubstr("2 rows without any value"), HasSubstr("line 3"))));
}

// GDAL has names with colons of its own; a path may have one, too.
TEST_F(ObservationReader, FilesWithAColonInTheirPathStandBehindThemselves) {
    std::filesystem::create_directory(folder_ / "run 12:30");
    VectorSpec spec;
    spec.rows = {{"POINT(900010 6400010)", "a", 1.0}};
    const std::string file = (folder_ / "run 12:30" / "zones.gpkg").string();
    write_vector(file, spec);
    EXPECT_THAT(gis::files_behind(file), Contains(file));
    EXPECT_FALSE(gis::input_files({file}).empty());
}

// 14,231 m/s is no thousands: nothing is so fast.
TEST_F(ObservationReader, TakesThreeDecimalsWhereThousandsAreOutOfTheQuestion) {
    const auto o = read(put("film.csv", "screen;block_id;speed_ms;energy_kj\nES1;A;14,231;1,5\n"));
    EXPECT_EQ(o.crossings.at(0).speed, 14.231);
    const std::string unclear = error(put("other.csv", "screen;block_id;energy_kj\nES1;A;14,231\n"));
    EXPECT_THAT(unclear, HasSubstr("a comma that could mean thousands"));
}

// A GIS makes a number with a fraction of a whole one where one is missing.
TEST_F(ObservationReader, NumbersOfBlocksKeepAllTheirDigits) {
    VectorSpec spec;
    spec.layer = "stopping_points";
    spec.text_field = "remark";
    spec.number_field = "block_id";
    spec.rows = {{"POINT(900010 6400010)", "", 20230517001.0}, {"POINT(900011 6400011)", "", 20230517002.0}};
    const std::string file = (folder_ / "stops.gpkg").string();
    write_vector(file, spec);
    const auto o = read(file);
    ASSERT_EQ(o.stops.size(), 2U);
    EXPECT_EQ(o.stops[0].body.id, "20230517001");
    EXPECT_EQ(o.stops[1].body.id, "20230517002");
}

TEST_F(ObservationReader, UnderstandsDecimalCommasBetweenSemicolons) {
    const auto o = read(put("stops.csv", "easting_m;northing_m;crs\n900010,5;6400020,25;EPSG:2154\n"));
    EXPECT_EQ(o.stops[0].position.head<2>(), Vec2(10.5, 20.25));
}

TEST_F(ObservationReader, ReadsATableOfCrossings) {
    const auto o = read(put("film.csv",
                            "screen,block_id,speed_ms,height_m,spin_rads,energy_kj,speed_error_ms\n"
                            "ES1,A,7.5,0.4,,12.5,0.7\nES1,B,,,,,\n"));
    ASSERT_EQ(o.crossings.size(), 2U);
    EXPECT_EQ(o.crossings[0].screen, "ES1");
    EXPECT_EQ(o.crossings[0].speed, 7.5);
    EXPECT_EQ(o.crossings[0].height, 0.4);
    EXPECT_TRUE(std::isnan(o.crossings[0].spin));
    EXPECT_EQ(o.crossings[0].energy, 12.5);
    EXPECT_EQ(o.crossings[0].speed_error, 0.7);
    EXPECT_TRUE(std::isnan(o.crossings[0].position.x()));
    EXPECT_TRUE(std::isnan(o.crossings[1].speed)) << "it passed, nothing was measured";
}

TEST_F(ObservationReader, ReadsSharesAsCountsOrPercent) {
    const auto o = read(put("shares.csv", "name,count,percent,released\n1A,1,2,50\n2A,,4,50\n3A,10,,50\n"));
    ASSERT_EQ(o.shares.size(), 3U);
    EXPECT_EQ(o.shares[0].count, 1);
    EXPECT_EQ(o.shares[1].count, 2);
    EXPECT_EQ(o.shares[2].thrown, 50);
    EXPECT_THAT(error(put("many.csv", "name,count,released\n1A,51,50\n")), HasSubstr("counts 51 blocks"));
    EXPECT_THAT(error(put("share.csv", "name,percent,released\n1A,0.7,50\n")),
                AllOf(HasSubstr("says 0.7 % of 50 blocks, which are 0.35"), HasSubstr("70, not 0.7")));
    EXPECT_THAT(error(put("half.csv", "name,percent,released\n1A,67.5,50\n")), HasSubstr("no whole number"));
    EXPECT_EQ(read(put("rounded.csv", "name,percent,released\n1A,33.3,30\n2A,67,30\n")).shares.at(1).count, 20);
    EXPECT_THAT(error(put("wrong.csv", "name,count,percent,released\n1A,10,2,50\n")),
                HasSubstr("says 2 % but counts 10 of 50"));
}

TEST_F(ObservationReader, ReadsAFolderOfTables) {
    put("stopping_points.csv", "block_id,easting_m,northing_m,crs\nA,900010,6400020,EPSG:2154\n");
    put("screen_crossings.csv", "screen,block_id,speed_ms\nES1,A,7.5\n");
    put("release_points.csv", "block_id,easting_m,northing_m,crs\nA,900001,6400002,EPSG:2154\n");
    put("notes.csv", "this,is,not,read\n1,2,3,4\n");
    const auto o = read(folder_.path().string());
    EXPECT_EQ(o.stops.size(), 1U);
    EXPECT_EQ(o.crossings.size(), 1U);
    ASSERT_EQ(o.releases.size(), 1U);
    EXPECT_EQ(o.releases[0].position.head<2>(), Vec2(1.0, 2.0));
    EXPECT_EQ(o.files.size(), 3U);
}

TEST_F(ObservationReader, TakesATableWithoutRowsForATestInWhichNothingWasSeen) {
    put("stopping_points.csv", "block_id,easting_m,northing_m,crs\nA,900010,6400020,EPSG:2154\n");
    const std::string crossings = put("screen_crossings.csv", "screen,block_id,speed_ms\n");
    const auto o = read(folder_.path().string());
    EXPECT_EQ(o.stops.size(), 1U);
    EXPECT_THAT(o.crossings, IsEmpty());
    EXPECT_THAT(o.warnings, IsEmpty());
    EXPECT_THAT(o.sources, Contains(HasSubstr("screen_crossings.csv: 0 records")));
    EXPECT_THAT(error(crossings), HasSubstr("hold no stop, crossing, impact or share"));
    EXPECT_THAT(error(put("no_header.csv", "")), HasSubstr("is empty"));
}

TEST_F(ObservationReader, ReadsImpacts) {
    const std::string head =
        "block_id,impact,speed_before_ms,speed_after_ms,rise_before_ms,rise_after_ms,speed_error_ms\n";
    const auto o = read(put("impacts.csv", head + "A,1,9.5,6,-7.5,1.5,0.3\nA,2,8,5,,,\n"));
    ASSERT_EQ(o.impacts.size(), 2U);
    EXPECT_EQ(o.impacts[0].body.id, "A");
    EXPECT_EQ(o.impacts[0].before.speed, 9.5);
    EXPECT_EQ(o.impacts[0].before.rise, -7.5);
    EXPECT_EQ(o.impacts[0].after.speed, 6.0);
    EXPECT_EQ(o.impacts[0].speed_error, 0.3);
    EXPECT_TRUE(std::isnan(o.impacts[0].after.spin));
    EXPECT_EQ(o.impacts[1].impact, 2);
    EXPECT_TRUE(std::isnan(o.impacts[1].after.rise));
    EXPECT_THAT(o.warnings, IsEmpty());
    EXPECT_THAT(error(put("a.csv", head + "A,1,9.5,,,,\n")),
                HasSubstr("line 2, lacks speed_after_ms; an impact needs the speeds before and after it."));
    EXPECT_THAT(error(put("c.csv", head + "A,1.5,5,4,,,\n")), HasSubstr("no whole number in the field 'impact'"));
    EXPECT_THAT(error(put("d.csv", head + "A,0,5,4,,,\n")), HasSubstr("'0' in the field 'impact'; allowed is"));
}

TEST_F(ObservationReader, ReadsLayersOfAGeoPackage) {
    const std::string file = (folder_ / "obs.gpkg").string();
    VectorSpec stops;
    stops.layer = "stopping_points";
    stops.text_field = "block_id";
    stops.number_field = "mass_kg";
    stops.rows = {{"POINT Z (900010 6400020 1003)", "A", 800.0}, {"", "B", std::nullopt}};
    write_vector(file, stops);
    VectorSpec screens = stops;
    screens.layer = "screen_crossings";
    screens.text_field = "screen";
    screens.number_field = "speed_ms";
    screens.rows = {{"", "ES1", 6.5}};
    write_vector(file, screens, true);
    const auto o = read(file);
    ASSERT_EQ(o.stops.size(), 2U);
    EXPECT_EQ(o.stops[0].position, Vec3(10.0, 20.0, 3.0));
    EXPECT_EQ(o.stops[0].body.mass, 800.0);
    EXPECT_TRUE(std::isnan(o.stops[1].position.x()));
    ASSERT_EQ(o.crossings.size(), 1U);
    EXPECT_EQ(o.crossings[0].speed, 6.5);
}

// A table of a database or a spreadsheet has no points; some rows of a layer may have none either.
TEST_F(ObservationReader, RecordsWithoutAPointArePlacedByTheirFields) {
    const std::string file = (folder_ / "obs.gpkg").string();
    VectorSpec stops;
    stops.layer = "stopping_points";
    stops.text_field = "easting_m";
    stops.number_field = "northing_m";
    stops.rows = {{"", "900010", 6400020.0}, {"POINT (900011 6400021)", "", std::nullopt}, {"", "", std::nullopt}};
    write_vector(file, stops);
    const auto o = read(file);
    ASSERT_EQ(o.stops.size(), 3U);
    EXPECT_EQ(o.stops[0].position.head<2>(), Vec2(10.0, 20.0));
    EXPECT_EQ(o.stops[1].position.head<2>(), Vec2(11.0, 21.0));
    EXPECT_TRUE(std::isnan(o.stops[2].position.x()));
    EXPECT_THAT(o.warnings, Contains(HasSubstr("names no CRS in a column crs")));
    stops.rows = {{"POINT (900011 6400021)", "900099", 6400099.0}, {"", "", std::nullopt}};
    write_vector((folder_ / "both.gpkg").string(), stops);
    const auto both = read((folder_ / "both.gpkg").string());
    EXPECT_EQ(both.stops.at(0).position.head<2>(), Vec2(11.0, 21.0)) << "the point counts";
    EXPECT_THAT(both.warnings, IsEmpty()) << "nothing had to be taken from fields";
    stops.rows = {{"", "9e9", 6400020.0}};
    write_vector((folder_ / "far.gpkg").string(), stops);
    EXPECT_THAT(error((folder_ / "far.gpkg").string()), HasSubstr("wholly outside of the terrain"));
}

TEST_F(ObservationReader, TablesOfAFolderMayBeFilesOfAnyKind) {
    VectorSpec stops;
    stops.layer = "whatever";
    stops.text_field = "block_id";
    stops.rows = {{"POINT (900010 6400020)", "A", 1.0}};
    write_vector((folder_ / "stopping_points.gpkg").string(), stops);
    put("screen_crossings.csv", "screen,block_id,speed_ms\nES1,A,3\n");
    const auto o = read(folder_.path().string());
    ASSERT_EQ(o.stops.size(), 1U);
    EXPECT_EQ(o.stops[0].position.head<2>(), Vec2(10.0, 20.0));
    EXPECT_EQ(o.crossings.size(), 1U);
    write_vector((folder_ / "more.gpkg").string(), stops);
    EXPECT_THAT(read(folder_.path().string()).warnings, Contains(HasSubstr("hold 'more.gpkg', which is not read")));
    put("stopping_points.csv", "easting_m,northing_m\n900010,6400020\n");
    EXPECT_THAT(error(folder_.path().string()), HasSubstr("which one counts?"));
    std::filesystem::remove(folder_ / "stopping_points.csv");
    write_vector((folder_ / "results.gpkg").string(), stops);
    EXPECT_THAT(error(folder_.path().string()), HasSubstr("'results.gpkg' and 'stopping_points.gpkg': which one"));
}

// No block came to a screen: a table with fields and without rows.
TEST_F(ObservationReader, ALayerMayBeEmpty) {
    const std::string file = (folder_ / "obs.gpkg").string();
    VectorSpec spec;
    spec.layer = "stopping_points";
    spec.text_field = "block_id";
    spec.rows = {{"POINT (900010 6400020)", "A", 1.0}};
    write_vector(file, spec);
    spec.layer = "screen_crossings";
    spec.text_field = "screen";
    spec.rows = {};
    write_vector(file, spec, true);
    const auto o = read(file);
    EXPECT_EQ(o.stops.size(), 1U);
    EXPECT_TRUE(o.crossings.empty());
}

TEST_F(ObservationReader, TransformsFromAnyCrsAndSaysSo) {
    // gdaltransform: EPSG:2154 (900010, 6400020) is 5.523806636 E 44.670519183 N; the ninth decimal is 0.1 mm
    const auto earth = read(put("earth.csv", "longitude_deg,latitude_deg\n5.523806636,44.670519183\n"));
    ASSERT_EQ(earth.stops.size(), 1U);
    EXPECT_NEAR(earth.stops[0].position.x(), 10.0, 1e-3);
    EXPECT_NEAR(earth.stops[0].position.y(), 20.0, 1e-3);
    EXPECT_THAT(earth.sources[0], HasSubstr("transformed by"));
    EXPECT_THAT(earth.sources[0], HasSubstr("WGS 84"));

    VectorSpec stops;
    stops.layer = "stopping_points";
    stops.crs = "EPSG:4326";
    stops.text_field = "block_id";
    stops.number_field = "mass_kg";
    stops.rows = {{"POINT (5.523806636 44.670519183)", "A", 800.0}};
    const std::string file = (folder_ / "earth.gpkg").string();
    write_vector(file, stops);
    const auto layer = read(file);
    EXPECT_NEAR((layer.stops[0].position - earth.stops[0].position).head<2>().norm(), 0.0, 1e-6)
        << "table and layer agree";
    EXPECT_THAT(layer.sources[0], HasSubstr("transformed by"));
}

TEST_F(ObservationReader, WarnsWhereItHasToAssumeTheCrs) {
    const auto o = read(put("stops.csv", "easting_m,northing_m\n900010,6400020\n"));
    EXPECT_THAT(o.warnings, Contains(HasSubstr("names no CRS in a column crs")));
    EXPECT_EQ(o.stops[0].position.head<2>(), Vec2(10.0, 20.0));
}

TEST_F(ObservationReader, WarnsOfFieldsThatAreNotRead) {
    const auto o = read(put("film.csv", "screen,speed,speed_ms,time_s\nES1,3,4,5\n"));
    ASSERT_EQ(o.warnings.size(), 1U);
    EXPECT_THAT(o.warnings[0], HasSubstr("not read: 'speed';"));
}

TEST_F(ObservationReader, TakesTheNumberOfABlockOfScreeAsItsId) {
    const auto o =
        read(put("stopping_points.csv",
                 "block,block_id,stop_reason,easting_m,northing_m,crs\n0,B07,at_rest,900010,6400020,EPSG:2154\n"
                 "1,B07,left_terrain,900199,6400020,EPSG:2154\n2,B01,failed,900010,6400020,EPSG:2154\n"));
    ASSERT_EQ(o.stops.size(), 2U) << "a failed computation observes nothing";
    EXPECT_EQ(o.stops[0].body.id, "0");
    EXPECT_EQ(o.stops[1].body.id, "1");
    EXPECT_TRUE(o.stops[1].censored);
    EXPECT_THAT(o.warnings, Contains(HasSubstr("1 record of failed computations")));
}

struct Fault {
    const char* name;
    const char* text;
    const char* says;
};
void PrintTo(const Fault& f, std::ostream* out) {
    *out << f.name;
}
const Fault kFaults[] = {
    {"ANumberThatIsNone", "screen,speed_ms\nES1,fast\n", "line 2, has 'fast' in the field 'speed_ms'"},
    {"ANegativeSpeed", "screen,speed_ms\nES1,-3\n", "allowed is a finite number of at least 0"},
    {"ACrossingWithoutAScreen", "screen,speed_ms\n,3\n", "line 2, names no screen"},
    {"HalfAPosition", "easting_m,northing_m\n900010,\n", "line 2, has half a position"},
    {"OneCoordinateOnly", "easting_m,speed_ms\n900010,3\n", "lacks the field 'northing_m'"},
    {"PositionsTwice", "easting_m,northing_m,longitude_deg,latitude_deg\n1,2,3,4\n", "positions twice"},
    {"AnUnknownCrs", "easting_m,northing_m,crs\n900010,6400020,EPSG:999999\n",
     "CRS 'EPSG:999999', which PROJ does not know"},
    {"DegreesForMetres", "easting_m,northing_m,crs\n5.5,44.6,EPSG:4326\n", "in metres but names the CRS"},
    {"TwoCrs", "easting_m,northing_m,crs\n900010,6400020,EPSG:2154\n900010,6400020,EPSG:2056\n",
     "use one CRS in a table"},
    {"SomeWithoutACrs", "easting_m,northing_m,crs\n900010,6400020,\n900010,6400020,EPSG:2154\n",
     "line 2, has a position but no CRS, where others have 'EPSG:2154'"},
    {"FarAway", "easting_m,northing_m,crs\n700000,6600000,EPSG:2154\n", "wholly outside of the terrain"},
    {"AnUnknownStopReason", "easting_m,northing_m,crs,stop_reason\n900010,6400020,EPSG:2154,asleep\n",
     "stop_reason 'asleep'"},
    {"AFlagThatIsNone", "easting_m,northing_m,crs,broken\n900010,6400020,EPSG:2154,perhaps\n", "allowed is 0 or 1"},
    {"AShareWithoutBlocks", "name,count,released\n1A,3,\n", "needs the number of blocks thrown"},
    {"AColumnTwice", "screen,speed_ms,speed_ms\nES1,3,4\n", "has the column 'speed_ms' more than once"},
    {"NothingKnown", "x,y\n1,2\n", "holds neither stops"},
};
class ObservationFaults : public ObservationReader, public testing::WithParamInterface<Fault> {};
TEST_P(ObservationFaults, AreNamedWithTheirPlace) {
    const std::string said = error(put("table.csv", GetParam().text));
    EXPECT_THAT(said, HasSubstr(GetParam().says));
    EXPECT_THAT(said, HasSubstr("table.csv"));
}
INSTANTIATE_TEST_SUITE_P(Table, ObservationFaults, testing::ValuesIn(kFaults),
                         [](const auto& row) { return std::string(row.param.name); });

TEST_F(ObservationReader, SaysWhatIsReadWhereThereIsNothing) {
    EXPECT_THAT(error((folder_ / "nothing.gpkg").string()), HasSubstr("do not exist"));
    EXPECT_THAT(error(folder_.path().string()), HasSubstr("holds no table of observations"));
    VectorSpec other;
    other.layer = "trees";
    other.rows = {{"POINT (900010 6400020)", "A", 800.0}};
    const std::string file = (folder_ / "trees.gpkg").string();
    write_vector(file, other);
    EXPECT_THAT(error(file), HasSubstr("only 'trees'"));
    EXPECT_THAT(error(file), HasSubstr("stopping_points"));
}

}  // namespace
}  // namespace scree::test
