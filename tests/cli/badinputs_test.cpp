// SPDX-License-Identifier: GPL-3.0-or-later
// Bad and awkward inputs of the shared data, each in a site whose other inputs are good: what must be refused is refused with one
// sentence and nothing is written; what must work works and says what is odd. Skips where the shared data are absent.
#include "cli/program.hpp"
#include "cli/results.hpp"
#include "gis/input_files.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scree::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr const char* kControlDtm = "control/good_dtm.tif";
constexpr const char* kControlRelease = "control/good_release.gpkg";
constexpr const char* kControlBlocks = "control/good_blocks.csv";

/// A site of awkward inputs; what is not named is the control.
struct AwkwardSite {
    std::string dtm = kControlDtm;
    std::string release = kControlRelease;
    std::string blocks = kControlBlocks;
    std::string more = {};  ///< further lines of [release]
    int count = 5;          ///< blocks [-]
};

/// Absolute paths stay as they are.
fs::path write_site(const TempDir& folder, const fs::path& inputs, const AwkwardSite& site) {
    std::ostringstream text;
    text << "[terrain]\ndtm = '" << (inputs / site.dtm).string()
         << "'\n[[soil]]\nname = 'ground'\nrestitution = 0.3\nfriction = 0.6\nrolling = 0.1\n"
         << "[blocks]\nlist = '" << (inputs / site.blocks).string() << "'\n[release]\nfile = '"
         << (inputs / site.release).string() << "'\ncount = " << site.count << "\nheight = 2.0\n"
         << site.more;
    put(folder / "site.toml", text.str());
    return folder / "site.toml";
}

Outcome run_site(const fs::path& site, const fs::path& out) {
    return scree_program({"run", site.string(), "--output", out.string(), "--quiet"});
}

enum class Judgement { Refuse, Warn, Accept };

struct AwkwardInput {
    const char* name;
    Judgement judgement;
    const char* file;                    ///< in the folder of awkward inputs
    std::vector<std::string> fragments;  ///< of the error or warning; the name of the file is asked for in any case
};

void PrintTo(const AwkwardInput& input, std::ostream* out) {
    *out << input.name;
}

constexpr auto kRefuse = Judgement::Refuse;
constexpr auto kWarn = Judgement::Warn;
constexpr auto kAccept = Judgement::Accept;

const AwkwardInput kInputs[] = {
    {"control", kAccept, kControlDtm, {}},
    {"r01_truncated", kRefuse, "raster/r01_truncated.tif", {"cannot be read", "incomplete"}},
    {"r03_html_login_page", kRefuse, "raster/r03_html_login_page.tif", {"HTML"}},
    {"r05_nan_no_nodata_tag", kWarn, "raster/r05_nan_no_nodata_tag.tif", {"NaN without a nodata tag", "holes"}},
    {"r07_int16_metres", kWarn, "raster/r07_int16_metres.tif", {"whole metres"}},
    {"r09_rotated_15deg", kRefuse, "raster/r09_rotated_15deg.tif", {"rotated by 15.00 degrees", "gdalwarp"}},
    {"r11_south_up", kAccept, "raster/r11_south_up.tif", {}},
    {"r13_1x1", kRefuse, "raster/r13_1x1.tif", {"1 x 1 cells"}},
    {"r15_rgb_3band", kRefuse, "raster/r15_rgb_3band.tif", {"3 bands"}},
    {"r17_no_crs", kWarn, "raster/r17_no_crs.tif", {"no coordinate reference system"}},
    {"r19_us_survey_feet_xy", kRefuse, "raster/r19_us_survey_feet_xy.tif", {"US survey foot"}},
    {"r21_vertical_feet_unit", kRefuse, "raster/r21_vertical_feet_unit.tif", {"'ft'"}},
    {"r23_infinities", kRefuse, "raster/r23_infinities.tif", {"infinit", "column 66, row 151"}},
    {"r25_complex_type", kRefuse, "raster/r25_gdal_complex_type.tif", {"complex"}},
    {"r27_gcps_only", kRefuse, "raster/r27_gdal_gcps_only.tif", {"ground control points"}},
    {"r29_vrt_missing_source", kRefuse, "raster/r29_vrt_missing_source.vrt", {"tile_that_does_not_exist.tif"}},
    {"r31_asc_rows_missing", kRefuse, "raster/r31_asc_rows_missing.asc", {"180"}},
    {"r33_asc_no_header", kRefuse, "raster/r33_asc_no_header.asc", {"not a raster"}},
    {"r35_starting_with_nan", kRefuse, "raster/r35_gdal_starting_with_nan.asc", {}},
    {"r37_mask_band",
     kRefuse,
     "raster/r37_mask_band.tif",
     {"good_release.gpkg", "holes"}},  // the control's release lies in the masked part; see below
    {"r39_claims_1e14_cells", kRefuse, "raster/r39_gdal_claims_100000x1632895392.tif", {"100000 x 1632895392 cells"}},
    {"r41_unknown_codec", kRefuse, "raster/r41_gdal_unknown_codec.tif", {"codec"}},
    {"r43_moon_crs_1x1", kRefuse, "raster/r43_gdal_moon_crs_1x1.tif", {"1 x 1 cells"}},
    {"r45_does_not_exist", kRefuse, "raster/r45_does_not_exist.tif", {"does not exist"}},
    {"r47_web_mercator", kRefuse, "raster/r47_web_mercator.tif", {"0.677 m on the ground"}},

    {"v01_epsg4326", kAccept, "vector/v01_release_epsg4326.gpkg", {}},
    {"v03_no_crs", kWarn, "vector/v03_release_no_crs.gpkg", {"no coordinate reference system"}},
    {"v05_empty_layer", kRefuse, "vector/v05_empty_layer.gpkg", {"empty"}},
    {"v07_polygon_zm", kAccept, "vector/v07_polygon_zm.gpkg", {}},
    {"v09_partly_outside", kWarn, "vector/v09_partly_outside.gpkg", {"reaching beyond the terrain", "off the terrain"}},
    {"v11_unicode", kAccept, "vector/v11 Ablösefläche Süd 岩.gpkg", {}},
    {"v13_truncated", kRefuse, "vector/v13_truncated.gpkg", {"malformed"}},
    {"v15_lines", kAccept, "vector/v15_lines.gpkg", {}},  // lines release along their length
    {"v17_overlapping", kAccept, "vector/v17_overlapping.gpkg", {}},
    {"v19_mixed_types", kRefuse, "vector/v19_mixed_types.gpkg", {"feature 2"}},
    {"v23_latlon_swapped",
     kRefuse,
     "vector/v23_geojson_latlon_swapped.geojson",
     {"outside of the terrain", "easting 4718534.2"}},
    {"v25_huge_feature_count", kRefuse, "vector/v25_gdal_huge_feature_count.gpkg", {"'test', 'test2'"}},
    {"v27_20000_vertices", kAccept, "vector/v27_20000_vertices.gpkg", {}},

    {"b01_decimal_comma", kAccept, "blocks/b01_semicolon_decimal_comma_bom.csv", {}},
    {"b03_missing_column", kRefuse, "blocks/b03_missing_column.csv", {"'L3_m'"}},
    {"b05_header_only", kRefuse, "blocks/b05_header_only.csv", {"no rows"}},
    {"b07_nan_text", kRefuse, "blocks/b07_nan_text.csv", {"'nan' in line 2", "'inf' in line 3", "'5e2kg' in line 4"}},
    {"b09_latin1", kWarn, "blocks/b09_latin1.csv", {"UTF-8"}},

    {"c01_empty", kRefuse, "config/c01_empty.toml", {"terrain.dtm", "release.file", "[[soil]]"}},
    {"c03_unclosed_string", kRefuse, "config/c03_unclosed_string.toml", {".toml:2:28"}},
    {"c05_binary", kRefuse, "config/c05_binary.toml", {"not valid TOML", ".toml:1:1"}},
    {"c07_wrong_types", kRefuse, "config/c07_wrong_types.toml", {"[run]", "there are site, terrain"}},
};

AwkwardSite site_around(const std::string& file) {
    AwkwardSite site;
    if (file.starts_with("raster/")) site.dtm = file;
    if (file.starts_with("vector/")) site.release = file;
    if (file.starts_with("blocks/")) site.blocks = file;
    return site;
}

class BadInputs : public testing::TestWithParam<AwkwardInput> {};

TEST_P(BadInputs, IsJudged) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    const AwkwardInput& input = GetParam();
    const std::string file = input.file;
    const TempDir folder;
    const fs::path out = folder / "out";
    const fs::path site = file.starts_with("config/") ? inputs / file : write_site(folder, inputs, site_around(file));
    const auto before = contents_of(folder.path());

    const Outcome checked = scree_program({"check", site.string(), "--quiet"});
    const Outcome run = run_site(site, out);
    for (const Outcome& outcome : {checked, run}) {
        EXPECT_EQ(outcome.code, input.judgement == Judgement::Refuse ? 3 : 0) << outcome.err;
        EXPECT_THAT(outcome.out, IsEmpty());
        for (const std::string& fragment : input.fragments) EXPECT_THAT(outcome.err, HasSubstr(fragment));
        if (input.judgement == Judgement::Accept) {
            EXPECT_THAT(outcome.err, IsEmpty());
        } else {
            EXPECT_THAT(outcome.err, HasSubstr(fs::path(file).filename().string()));
        }
        if (input.judgement == Judgement::Refuse) {
            EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
            EXPECT_TRUE(outcome.err.starts_with("error: ")) << outcome.err;
        }
    }
    if (input.judgement == Judgement::Refuse) {
        EXPECT_EQ(contents_of(folder.path()), before) << "nothing may be written";
        return;
    }
    const auto stops = read_points(out / "results.gpkg", "stopping_points");
    EXPECT_EQ(stops.size(), 5U);
    for (const PointRow& stop : stops) {
        EXPECT_TRUE(stop.at.allFinite());
        EXPECT_TRUE(std::isfinite(stop.number("energy_max_kj")));
        EXPECT_NE(stop.values.at("stop_reason"), "failed");
    }
    EXPECT_TRUE(raster_facts(out / "rasters" / "energy_kj_max.tif").finite);
}
INSTANTIATE_TEST_SUITE_P(Shared, BadInputs, testing::ValuesIn(kInputs),
                         [](const auto& row) { return std::string(row.param.name); });

/// Stopping points or release points of a run of the site.
std::vector<PointRow> points_of(const fs::path& inputs, const AwkwardSite& site, const std::string& layer) {
    const TempDir folder;
    const Outcome run = run_site(write_site(folder, inputs, site), folder / "out");
    EXPECT_EQ(run.code, 0) << run.err;
    return read_points(folder / "out" / "results.gpkg", layer);
}

double largest_distance(const std::vector<PointRow>& a, const std::vector<PointRow>& b) {
    if (a.size() != b.size() || a.empty()) return kInfinity;
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, (a[k].at - b[k].at).norm());
    return largest;
}

TEST(BadInputsResult, SouthUpRasterGivesTheControlsStops) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    const auto control = points_of(inputs, {}, "stopping_points"),
               south_up = points_of(inputs, {.dtm = "raster/r11_south_up.tif"}, "stopping_points");
    EXPECT_LT(largest_distance(control, south_up), 1e-6);
}

TEST(BadInputsResult, MaskedColumnsAreOutside) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    constexpr double kCell = 4.99767823057900, kFirstMasked = 168637.299292918934952 + 90 * kCell;  // [m]
    const TempDir folder;
    VectorSpec straddling;
    straddling.crs = "EPSG:31287";
    straddling.rows = {
        {"POLYGON ((169057 362610, 169117 362610, 169117 362650, 169057 362650, 169057 362610))", "box", 1.0}};
    write_vector((folder / "release.gpkg").string(), straddling);
    const AwkwardSite site{
        .dtm = "raster/r37_mask_band.tif", .release = (folder / "release.gpkg").string(), .count = 20};
    ASSERT_EQ(run_site(write_site(folder, inputs, site), folder / "out").code, 0);
    const auto releases = read_points(folder / "out" / "results.gpkg", "release_points"),
               stops = read_points(folder / "out" / "results.gpkg", "stopping_points");
    ASSERT_EQ(releases.size(), 20U);
    for (const PointRow& release : releases) EXPECT_LT(release.at.x(), kFirstMasked);
    for (const PointRow& stop : stops) EXPECT_LT(stop.at.x(), kFirstMasked + 0.5);
}

TEST(BadInputsResult, DegreesAreTransformed) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    for (const PointRow& release :
         points_of(inputs, {.release = "vector/v01_release_epsg4326.gpkg", .count = 20}, "release_points")) {
        EXPECT_GT(release.at.x(), 169119.566 - 1.0);
        EXPECT_LT(release.at.x(), 169159.566 + 1.0);
        EXPECT_GT(release.at.y(), 362610.313 - 1.0);
        EXPECT_LT(release.at.y(), 362650.313 + 1.0);
    }
}

TEST(BadInputsResult, HeightsOfPolygonsAreIgnored) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    const auto control = points_of(inputs, {}, "release_points"),
               with_heights = points_of(inputs, {.release = "vector/v07_polygon_zm.gpkg"}, "release_points");
    EXPECT_LT(largest_distance(control, with_heights), 0.01) << "of 9999 m";
}

TEST(BadInputsResult, PartsOffTheTerrainReleaseNothing) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    for (const PointRow& release :
         points_of(inputs, {.release = "vector/v09_partly_outside.gpkg", .count = 20}, "release_points"))
        EXPECT_GT(release.at.x(), 168637.299);
}

TEST(BadInputsResult, UnicodeNamesSurvive) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    const TempDir folder;
    const AwkwardSite awkward{.release = "vector/v11 Ablösefläche Süd 岩.gpkg"};
    const fs::path site = write_site(folder, inputs, awkward);
    ASSERT_EQ(run_site(site, folder / "out").code, 0);
    EXPECT_THAT(fields_of(folder / "out" / "results.gpkg", "release_zones"), testing::Contains("gr_e_m"));
    EXPECT_THAT(text_of(folder / "out" / "results.gpkg"), HasSubstr("Größe m³"));
    EXPECT_LT(largest_distance(points_of(inputs, {}, "stopping_points"),
                               read_points(folder / "out" / "results.gpkg", "stopping_points")),
              1e-6);
    const Outcome wrong = scree_program({"check", site.string(), "--set", "release.layer=Süd"});
    EXPECT_EQ(wrong.code, 3);
    EXPECT_THAT(wrong.err, HasSubstr("Ablösefläche Süd (岩)"));
}

TEST(BadInputsResult, OverlappingFeaturesEachSendTheirShare) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    std::map<std::string, int> count;
    for (const PointRow& release :
         points_of(inputs, {.release = "vector/v17_overlapping.gpkg", .count = 60}, "release_points"))
        ++count[release.values.at("release_feature")];
    EXPECT_EQ(count.size(), 3U);
    for (const auto& [feature, blocks] : count) EXPECT_GT(blocks, 5) << feature;
}

TEST(BadInputsResult, ValuesThatAreReadMustMakeSense) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    const TempDir folder;
    AwkwardSite awkward{.release = "vector/v21_bad_values.gpkg"};
    awkward.more = "[zones]\nfile = '" + (inputs / "vector/v21_bad_values.gpkg").string() + "'\nfield = 'block_m3'\n";
    const fs::path site = write_site(folder, inputs, awkward);
    const Outcome refused = scree_program({"check", site.string()});
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr("v21_bad_values.gpkg"));
    // volumes in a release layer are not read: blocks come from [blocks]. The check says so.
    put(folder / "plain.toml", text_of(write_site(folder, inputs, {.release = "vector/v21_bad_values.gpkg"})));
    const Outcome checked = scree_program({"check", (folder / "plain.toml").string()});
    EXPECT_EQ(checked.code, 0);
    EXPECT_THAT(checked.out, HasSubstr("fields that are not read: block_m3"));
}

TEST(BadInputsResult, ManyVerticesReleaseManyBlocks) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    EXPECT_EQ(points_of(inputs, {.release = "vector/v27_20000_vertices.gpkg", .count = 300}, "release_points").size(),
              300U);
}

TEST(BadInputsResult, DecimalCommasAreRead) {
    SCREE_SHARED_OR_SKIP(inputs, "badinputs");
    for (const PointRow& stop :
         points_of(inputs, {.blocks = "blocks/b01_semicolon_decimal_comma_bom.csv"}, "stopping_points")) {
        EXPECT_GT(stop.number("mass_kg"), 100.0);
        EXPECT_LT(stop.number("mass_kg"), 4000.0);
    }
}

TEST(BadInputsResult, WrongTypesNameKeyValueAndRange) {
    const TempDir folder;
    struct Case {
        const char* line;
        const char* said;
    };
    for (const Case& c :
         {Case{"[model]\nseed = \"abc\"\n",
               "site.toml:2: model.seed = 'abc' is not allowed: give a whole number from 0"},
          Case{"[release]\ncount = -5\n", "site.toml:2: release.count = -5 is not allowed: give a whole number from 1"},
          Case{"[model]\ntime_step = nan\n",
               "site.toml:2: model.time_step = nan is not allowed: give a number from 1e-06 to 0.02"},
          Case{"[model]\ntime_limit = inf\n",
               "site.toml:2: model.time_limit = inf is not allowed: give a number from 0.1"},
          Case{"[model]\ngravity = 0.0\n",
               "site.toml:2: model.gravity = 0.0 is not allowed: give a number from 0.1 to 30"},
          Case{"[terrain]\nresolution = \"fine\"\n",
               "site.toml:2: terrain.resolution = 'fine' is not allowed: give a number of at least 0"},
          Case{"[model]\ngravity = [9.81]\n", "model.gravity = a table or list is not allowed"},
          Case{"model = 3\n", "site.toml:1: model must be a table: begin it with [model]"},
          Case{"soil = 3\n", "begin each soil with [[soil]]"}, Case{"[[soil]]\nfriction = 1\n", "has no name"},
          Case{"[[soil]]\nname = 'a'\n[[soil]]\nname = 'a'\n", "two soils are called \"a\""},
          Case{"[[soil]]\nname = 'a'\nrestitution = 2\n",
               "site.toml:3, soil \"a\": soil.restitution = 2 is not allowed: give a number from 0 to 1"},
          Case{"[[soil]]\nname = 'a'\nmu = 2\n", "site.toml:3, soil \"a\": [[soil]] has no key mu"},
          Case{"[terrain]\ndtm = \"C:\\data\\dtm.tif\"\n",
               "site.toml:2:11: not valid TOML (UTF-8): Error while parsing string: unknown escape sequence '\\d'; in "
               "double quotes a backslash begins a special character: write paths with /, or in single quotes"},
          Case{"[terain]\ndtm = 'a'\n", "site.toml:1: the section [terain] is unknown; did you mean [terrain]?"},
          Case{"[[effect]]\nkind = 'forest'\n", "there is no effect"}}) {
        put(folder / "site.toml", c.line);
        const Outcome checked = scree_program({"check", (folder / "site.toml").string()});
        EXPECT_EQ(checked.code, 3);
        EXPECT_THAT(checked.err, HasSubstr(c.said));
    }
}

}  // namespace
}  // namespace scree::test
