// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/output_sample.hpp"
#include "gis/output_wkt.hpp"
#include "gis/results_writer.hpp"
#include "gis/sha256.hpp"
#include "scree/base/error.hpp"
#include "support/paths.hpp"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <set>
#include <thread>

namespace scree::gis {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

const ResultsPackage& sample() {
    static const ResultsPackage package = test::SampleResults(test::wkt2(2154)).package;
    return package;
}

/// The smallest package: one point.
ResultsPackage small() {
    ResultsPackage package;
    VectorLayer layer;
    layer.data = {"stopping_points", GeometryKind::Point, {}, {{0, Points{{1, 2, 3}}, {}}}};
    package.vectors = {layer};
    return package;
}

std::set<std::string> files_in(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) names.insert(entry.path().lexically_relative(folder).generic_string());
    }
    return names;
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void put(const fs::path& file, const std::string& text) {
    std::ofstream(file) << text;
}

template <class Action>
std::string message_of(Action action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

std::vector<std::string> query(const fs::path& geopackage, const std::string& sql) {
    GDALAllRegister();
    const GDALDatasetUniquePtr file(GDALDataset::Open(geopackage.c_str(), GDAL_OF_VECTOR));
    std::vector<std::string> rows;
    OGRLayer* answer = file->ExecuteSQL(sql.c_str(), nullptr, nullptr);
    if (!answer) return {"no answer: " + std::string(CPLGetLastErrorMsg())};
    for (const auto& row : *answer) {
        std::string text;
        for (int i = 0; i < row->GetFieldCount(); ++i) {
            text += (i > 0 ? "|" : "") + std::string(row->IsFieldSetAndNotNull(i) ? row->GetFieldAsString(i) : "NULL");
        }
        rows.push_back(text);
    }
    file->ReleaseResultSet(answer);
    return rows;
}

// --- what is in the folder ---

TEST(Results, HoldsEveryFileAndItsHash) {
    const test::TempDir dir;
    write_results(dir / "out", sample(), false);
    EXPECT_EQ(files_in(dir.path()).size(), 4 + 2 * sample().rasters.size());
    EXPECT_EQ(text_of(dir / "out/run.toml"), sample().files[0].text);
    EXPECT_TRUE(fs::exists(dir / "out/rasters/energy_kj_p95.tif"));
    const std::string check = "cd '" + (dir / "out").string() + "' && sha256sum --check --quiet --strict SHA256SUMS";
    EXPECT_EQ(std::system(check.c_str()), 0);
    const std::string sums = text_of(dir / "out/SHA256SUMS");
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(sums, '\n')), files_in(dir / "out").size() - 1);
}

TEST(Results, PassTheValidators) {
    const test::TempDir dir;
    write_results(dir / "out", sample(), false);
    const std::string python = "/usr/bin/python3 -m osgeo_utils.samples.";
    if (std::system("/usr/bin/python3 -c 'import osgeo_utils' 2>/dev/null") != 0)
        GTEST_SKIP() << "python3-gdal is not installed";
    const auto run = [&](const std::string& command, const fs::path& file) {
        const fs::path log = dir / "log.txt";
        const int status =
            std::system((python + command + " '" + file.string() + "' >'" + log.string() + "' 2>&1").c_str());
        EXPECT_EQ(status, 0) << text_of(log);
    };
    run("validate_gpkg", dir / "out/results.gpkg");
    for (const auto& entry : fs::directory_iterator(dir / "out/rasters")) {
        if (entry.path().extension() == ".tif") run("validate_cloud_optimized_geotiff --full-check=yes", entry.path());
    }
}

TEST(Results, DatabaseHoldsStylesAliasesAndProvenance) {
    const test::TempDir dir;
    write_results(dir / "out", sample(), false);
    const fs::path gpkg = dir / "out/results.gpkg";
    EXPECT_THAT(
        query(gpkg,
              "SELECT f_table_name, f_table_schema, f_geometry_column, styleName, useAsDefault FROM layer_styles"),
        ElementsAre("stopping_points||geom|By mass|1", "stopping_points||geom|By reason of stopping|0",
                    "release_points||geom|Default|1", "screens||geom|Default|1",
                    "trajectories||geom|By largest speed|1", "trajectories||geom|Plain|0",
                    "deposit_zones||geom|By share of the deposits|1"));
    EXPECT_THAT(query(gpkg,
                      "SELECT count(*) FROM layer_styles WHERE f_table_name = 'deposit_zones' AND styleQML LIKE "
                      "'%name=\"style\"%value=\"no\"%'"),
                ElementsAre("1"))
        << "a fill would change the colours of the rasters below";
    EXPECT_THAT(query(gpkg,
                      "SELECT count(*) FROM gpkg_2d_gridded_tile_ancillary WHERE coalesce(min, max, mean, std_dev) "
                      "IS NOT NULL"),
                ElementsAre("0"))
        << "GDAL takes those of all rasters for each";
    EXPECT_THAT(query(gpkg, "SELECT column_name, title FROM gpkg_data_columns WHERE table_name = 'stopping_points'"),
                ElementsAre("block_id|Block", "mass_kg|Mass [kg]", "stop_reason|Reason of stopping"));
    EXPECT_THAT(query(gpkg, "SELECT key, value FROM run WHERE key <> 'settings' LIMIT 2"),
                ElementsAre("scree.version|0.1.0", "seed|42"));
    EXPECT_THAT(query(gpkg, "SELECT value FROM run WHERE key = 'settings'"), ElementsAre(sample().provenance[1].value));
    EXPECT_THAT(query(gpkg, "SELECT data_type FROM gpkg_contents WHERE table_name = 'run'"), ElementsAre("attributes"));
    const auto metadata =
        query(gpkg,
              "SELECT md_standard_uri, reference_scope, metadata FROM gpkg_metadata m"
              " JOIN gpkg_metadata_reference r ON r.md_file_id = m.id WHERE reference_scope = 'geopackage'");
    ASSERT_EQ(metadata.size(), 1U);
    EXPECT_THAT(metadata[0], HasSubstr("http://www.isotc211.org/2005/gmd|geopackage|"));
    EXPECT_THAT(metadata[0], HasSubstr("count.released: 200"));
    EXPECT_THAT(query(gpkg, "SELECT count(*) FROM gpkg_contents WHERE data_type = '2d-gridded-coverage'"),
                ElementsAre("6"));
    EXPECT_THAT(query(gpkg, "SELECT DISTINCT last_change FROM gpkg_contents"), ElementsAre("2000/01/01 00:00:00+00"));
    EXPECT_EQ(text_of(gpkg).substr(18, 2), "\x01\x01") << "write-ahead log mode needs a writable folder to be read";
}

TEST(Results, SameInputGivesTheSameBytes) {
    const test::TempDir dir;
    write_results(dir / "first", sample(), false);
    std::this_thread::sleep_for(std::chrono::milliseconds(1'100));  // a time of writing would show: files know seconds
    write_results(dir / "second/deeper", sample(), false);
    EXPECT_EQ(text_of(dir / "first/SHA256SUMS"), text_of(dir / "second/deeper/SHA256SUMS"));
    for (const std::string& file : files_in(dir / "first")) {
        EXPECT_EQ(sha256_of_file(dir / "first" / file), sha256_of_file(dir / "second/deeper" / file)) << file;
    }
}

TEST(Results, NeitherVectorsNorRastersAreNeeded) {
    const test::TempDir dir;
    ResultsPackage package;
    package.provenance = {{"seed", "1"}};
    write_results(dir / "nothing", package, false);
    EXPECT_THAT(query(dir / "nothing/results.gpkg", "SELECT value FROM run"), ElementsAre("1"));
    package.rasters = {sample().rasters[0]};
    write_results(dir / "rasters", package, false);
    EXPECT_TRUE(fs::exists(dir / "rasters/rasters/energy_kj_p95.tif"));
}

// --- whole or not at all ---

TEST(ResultsFolder, AnEarlierResultIsReplacedOnlyWhenTold) {
    const test::TempDir dir;
    write_results(dir / "out", sample(), false);
    const std::string before = text_of(dir / "out/SHA256SUMS");
    EXPECT_THAT(message_of([&] { write_results(dir / "out", small(), false); }), HasSubstr("--overwrite"));
    EXPECT_THAT(message_of([&] { require_free_results_folder(dir / "out", false); }), HasSubstr("--overwrite"));
    EXPECT_EQ(text_of(dir / "out/SHA256SUMS"), before);
    write_results(dir / "out", small(), true);
    EXPECT_THAT(files_in(dir.path()), ElementsAre("out/SHA256SUMS", "out/results.gpkg", "out/results.qgs"))
        << "files of the earlier result are gone, and so is the temporary folder";
}

// Two runs to one new folder: the second one to end keeps its result beside that of the first.
TEST(ResultsFolder, AResultWrittenMeanwhileIsNotReplaced) {
    const test::TempDir dir;
    ResultsFolder late(dir / "out", false);
    put(late.path() / "results.gpkg", "late");
    write_results(dir / "out", small(), false);
    const std::string before = text_of(dir / "out/results.gpkg");
    EXPECT_THAT(message_of([&] { late.commit(); }), HasSubstr("another program has written there meanwhile"));
    EXPECT_EQ(text_of(dir / "out/results.gpkg"), before);
    EXPECT_EQ(text_of(late.path() / "results.gpkg"), "late");
}

std::sig_atomic_t volatile told_to_end = 0;

// Ctrl-C while results are written: they are whole first.
TEST(Results, AnInterruptWaitsUntilTheyAreWhole) {
    const test::TempDir dir;
    ResultsPackage package = sample();
    int seen_while_writing = -1;
    const Grid<float> values = package.rasters.front().values;
    package.rasters.front().make_values = [&] {
        std::raise(SIGINT);
        seen_while_writing = told_to_end;
        return values;
    };
    const auto before = std::signal(SIGINT, [](int) { told_to_end = 1; });
    write_results(dir / "out", package, false);
    std::signal(SIGINT, before);
    EXPECT_EQ(seen_while_writing, 0);
    EXPECT_EQ(told_to_end, 1);
    EXPECT_TRUE(fs::exists(dir / "out" / kChecksumFile));
}

// Anybody may keep a list of hashes beside data.
TEST(ResultsFolder, AListOfHashesAloneIsNoResult) {
    const test::TempDir dir;
    fs::create_directory(dir / "lidar");
    put(dir / "lidar/tile.laz", "points");
    put(dir / "lidar/SHA256SUMS", std::string(64, 'a') + "  tile.laz\n");
    for (const bool overwrite : {false, true})
        EXPECT_THAT(message_of([&] { write_results(dir / "lidar", small(), overwrite); }),
                    HasSubstr("no earlier result"));
    EXPECT_EQ(text_of(dir / "lidar/tile.laz"), "points");
    fs::create_directory_symlink(dir / "gone", dir / "link");
    EXPECT_THAT(message_of([&] { require_free_results_folder(dir / "link", true); }), HasSubstr("leads nowhere"));
}

TEST(ResultsFolder, WhatWasEditedSurvives) {
    const test::TempDir dir;
    write_results(dir / "out", small(), false);
    put(dir / "out/results.qgs", "with my labels");
    write_results(dir / "out", small(), true);
    EXPECT_EQ(text_of(dir / "out/results.qgs.previous"), "with my labels");
    write_results(dir / "out", small(), true);
    EXPECT_THAT(files_in(dir.path()),
                ElementsAre("out/SHA256SUMS", "out/results.gpkg", "out/results.qgs", "out/results.qgs.previous"));
}

TEST(ResultsFolder, FilesOfTheUserSurvive) {
    const test::TempDir dir;
    ResultsPackage package = small();
    package.files = {{"report.html", "old"}};
    write_results(dir / "out", package, false);
    put(dir / "out/my_map.qgz", "mine");
    put(dir / "out/results.gpkg-shm", "left by a GIS");
    put(dir / "out/report.html.ovr", "as overviews beside a raster: they show what was there before");
    fs::create_directory(dir / "out/photos");
    put(dir / "out/photos/block.jpg", "mine too");
    put(dir / "out/run.toml", "not listed, though called like a file of ours");
    package.files = {{"run.toml", "new"}};
    write_results(dir / "out", package, true);
    EXPECT_THAT(files_in(dir.path()),
                ElementsAre("out/SHA256SUMS", "out/my_map.qgz", "out/photos/block.jpg", "out/results.gpkg",
                            "out/results.qgs", "out/run.toml", "out/run.toml.previous"));
    EXPECT_EQ(text_of(dir / "out/run.toml"), "new");
    EXPECT_EQ(text_of(dir / "out/my_map.qgz"), "mine");
}

// A process that was killed after the swap, with the same number as this one: in a container every run may have it.
TEST(ResultsFolder, WhatAKilledProcessHadNotHandedBackIsNeverRemoved) {
    const test::TempDir dir;
    const fs::path left = dir / ("out.partial-" + std::to_string(::getpid()));
    fs::create_directory(left);
    put(left / "notes.md", "mine");
    write_results(dir / "out", small(), false);
    EXPECT_EQ(text_of(left / "notes.md"), "mine");
    EXPECT_EQ(std::distance(fs::directory_iterator(dir.path()), {}), 2);
}

TEST(ResultsFolder, FilesThatCannotBeHandedBackAreNamed) {
    const test::TempDir dir;
    write_results(dir / "out", small(), false);
    put(dir / "out/notes.md", "mine");
    fs::create_directory(dir / "out/table.csv");
    put(dir / "out/table.csv/inside", "mine, in a folder called like a file of the new result");
    ResultsPackage package = small();
    package.files = {{"table.csv", "new"}};
    try {
        write_results(dir / "out", package, true);
        FAIL() << "a file cannot hold files";
    } catch (const ComputeError& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("the results are there"), HasSubstr("out.partial-")));
    }
    EXPECT_EQ(text_of(dir / "out/table.csv"), "new");
    std::size_t mine = 0;
    for (const auto& entry : fs::recursive_directory_iterator(dir.path()))
        mine += entry.is_regular_file() && text_of(entry.path()).starts_with("mine");
    EXPECT_EQ(mine, 2U) << "nothing is lost";
}

TEST(ResultsFolder, OtherFoldersAndFilesAreLeftAlone) {
    const test::TempDir dir;
    fs::create_directory(dir / "home");
    put(dir / "home/thesis.txt", "years of work");
    put(dir / "file", "");
    for (const bool overwrite : {false, true}) {
        EXPECT_THAT(message_of([&] { write_results(dir / "home", small(), overwrite); }),
                    HasSubstr("no earlier result"));
        EXPECT_THAT(message_of([&] { write_results(dir / "file", small(), overwrite); }), HasSubstr("is a file"));
    }
    EXPECT_THAT(files_in(dir.path()), ElementsAre("file", "home/thesis.txt"));
}

TEST(ResultsFolder, EmptyFolderLinkAndTrailingSlashAreFine) {
    const test::TempDir dir;
    fs::create_directories(dir / "disc/real");
    fs::create_directory_symlink(dir / "disc/real", dir / "link");
    write_results(dir.path() / "link/", small(), false);
    EXPECT_TRUE(fs::is_symlink(dir / "link"));
    EXPECT_TRUE(fs::exists(dir / "disc/real/results.gpkg"));
    write_results(dir / "link", small(), true);
    EXPECT_TRUE(fs::is_symlink(dir / "link"));
}

TEST(ResultsFolder, AFailureLeavesNothingAndAnEarlierResultWhole) {
    const test::TempDir dir;
    ResultsPackage bad = sample();
    bad.rasters.back().values.values.pop_back();  // found out when everything else is written
    EXPECT_THROW(write_results(dir / "out", bad, false), InputError);
    EXPECT_THAT(files_in(dir.path()), IsEmpty());
    EXPECT_FALSE(fs::exists(dir / "out"));

    write_results(dir / "out", small(), false);
    const std::string before = text_of(dir / "out/SHA256SUMS");
    EXPECT_THROW(write_results(dir / "out", bad, true), InputError);
    EXPECT_EQ(text_of(dir / "out/SHA256SUMS"), before);
    EXPECT_EQ(files_in(dir.path()).size(), 3U);
}

TEST(ResultsFolder, AFolderThatCannotBeWrittenIsRefusedAtOnce) {
    EXPECT_THAT(message_of([] { require_free_results_folder("/proc/scree/out", false); }), HasSubstr("/proc"));
    const test::TempDir dir;
    put(dir / "file", "");
    EXPECT_THAT(message_of([&] { require_free_results_folder(dir / "file/out", false); }),
                HasSubstr("nothing can be created in"));
    fs::create_symlink("circle", dir / "circle");
    EXPECT_THAT(message_of([&] { require_free_results_folder(dir / "circle/out", false); }),
                HasSubstr("cannot be written there"));
}

TEST(Results, FilesMayLieInAFolderOfTheirOwn) {
    const test::TempDir dir;
    ResultsPackage package = small();
    package.files = {{"report.html", "a report"}, {"figures/map.svg", "a map"}, {"figures/bars.svg", "bars"}};
    write_results(dir / "out", package, false);
    EXPECT_EQ(text_of(dir / "out/figures/map.svg"), "a map");
    EXPECT_THAT(text_of(dir / "out/SHA256SUMS"), HasSubstr("figures/bars.svg"));
    package.files.pop_back();
    write_results(dir / "out", package, true);
    EXPECT_FALSE(fs::exists(dir / "out/figures/bars.svg")) << "it belonged to the result that was replaced";
}

TEST(Results, NamesAndTitlesMustDiffer) {
    const test::TempDir dir;
    ResultsPackage twice = small();
    twice.vectors.push_back(twice.vectors[0]);
    EXPECT_THAT(message_of([&] { write_results(dir / "out", twice, false); }),
                HasSubstr("\"stopping_points\" is given twice"));
    twice.vectors[1].data.name = "others";
    twice.vectors[1].title = "stopping_points";
    EXPECT_THAT(message_of([&] { write_results(dir / "out", twice, false); }), HasSubstr("the title"));
    for (const char* name :
         {"", "..", "a/b/c", "/a", "../a", "a/..", "a/", "rasters/a", "results.gpkg", "SHA256SUMS"}) {
        ResultsPackage package = small();
        package.files = {{name, ""}};
        EXPECT_THAT(message_of([&] { write_results(dir / "out", package, false); }), HasSubstr("cannot be called"));
    }
    EXPECT_THAT(files_in(dir.path()), IsEmpty());
}

}  // namespace
}  // namespace scree::gis
