// SPDX-License-Identifier: GPL-3.0-or-later
// The command line as a table: what is typed, the exit code, and what is said on either stream.
#include "cli/program.hpp"
#include "cli/site_file.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <sstream>

namespace scree::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

struct UsageCase {
    const char* name;
    std::vector<std::string> args;
    int code;
    const char* out;  ///< fragment of the output; "" means: nothing is printed
    const char* err;  ///< fragment of the diagnostics; "" means: nothing is printed
};

void PrintTo(const UsageCase& c, std::ostream* out) {
    *out << c.name;
}

// A disc that is full must not look like success.
TEST(Usage, WhatCannotBeSaidIsAnError) {
    std::ostream nowhere(nullptr);
    std::ostringstream err;
    EXPECT_EQ(cli::run({"effects"}, nowhere, err), 4);
    EXPECT_THAT(err.str(), HasSubstr("standard output could not be written"));
}

const std::string kQuarry = (quarry_a() / "site.toml").string();

const UsageCase kUsage[] = {
    {"NoCommand", {}, 2, "", "error: no command is given; see scree --help"},
    {"UnknownCommand", {"fly", "site.toml"}, 2, "", "error: there is no command fly; see scree --help"},
    {"UnknownOption", {"run", kQuarry, "--fast"}, 2, "", "--fast; see scree run --help"},
    {"MissingSite", {"run"}, 2, "", "SITE"},
    {"CompareWithoutMeasurements", {"compare", kQuarry}, 2, "", "--observed is required; see scree compare --help"},
    {"MissingFolder", {"init"}, 2, "", "FOLDER"},
    {"MisspeltOption",
     {"run", kQuarry, "--theads", "1"},
     2,
     "",
     "error: there is no option --theads (did you mean --threads?); see scree run --help"},
    {"NoSuchOption", {"run", kQuarry, "--colour=red"}, 2, "", "error: there is no option --colour; see scree run"},
    {"TwoSites", {"check", kQuarry, kQuarry}, 2, "", "not expected"},
    {"ThreadsIsNoNumber", {"run", kQuarry, "--threads", "many"}, 2, "", "--threads"},
    {"ThreadsBelowZero", {"run", kQuarry, "--threads", "-1"}, 2, "", "--threads"},
    {"ProgressOfUnknownStyle", {"run", kQuarry, "--progress=xml"}, 2, "", "--progress"},
    {"SeedIsNoNumber", {"run", kQuarry, "--seed", "x"}, 2, "", "--seed"},
    {"SetWithoutValue", {"check", kQuarry, "--set", "release.count"}, 2, "", "section.key=value"},
    {"SetWithoutSection", {"check", kQuarry, "--set", "count=3"}, 2, "", "section.key=value"},
    {"SettingsOfUnknownFormat", {"settings", "--format", "pdf"}, 2, "", "--format"},
    {"CheckTakesNoOutput", {"check", kQuarry, "--output", "x"}, 2, "", "--output"},

    {"Version", {"--version"}, 0, "0.1.0", ""},
    {"LogNormalBeyondItsEnds",
     {"check", kQuarry, "--set", "blocks.volume_law=log_normal", "--set", "blocks.volume=1000"},
     3,
     "",
     "blocks.volume, the median, = 1000 is larger than blocks.volume_max = 10"},
    {"OneOfSeveralSoilsIsUnknown",
     {"check", kQuarry, "--set", "soil.loose waste|compact wast.friction=0.9"},
     3,
     "",
     "there is no [[soil]] called \"loose waste|compact wast\""},
    {"ABlockAsLargeAsAMountain", {"check", kQuarry, "--set", "blocks.volume=1e30"}, 3, "", "blocks.volume = 1e+30"},
    {"MoreResultCellsThanAnIntegerHolds",
     {"check", kQuarry, "--set", "output.resolution=1e-7"},
     3,
     "",
     "more than the 100 million that are allowed"},
    {"Help", {"--help"}, 0, "Exit codes", ""},
    {"HelpInit", {"init", "--help"}, 0, "FOLDER", ""},
    {"HelpCheck", {"check", "--help"}, 0, "--set", ""},
    {"HelpTerrain", {"terrain", "--help"}, 0, "--overwrite", ""},
    {"HelpProfile", {"profile", "--help"}, 0, "--overwrite", ""},
    {"HelpSaysWhereResultsGo", {"compare", "--help"}, 0, "output.directory of the site file + _compare", ""},
    {"ProfileTakesNoThreads", {"profile", kQuarry, "--threads", "2"}, 2, "", "--threads; see scree profile --help"},
    {"HelpRun", {"run", "--help"}, 0, "--threads", ""},
    {"HelpCompare", {"compare", "--help"}, 0, "--observed", ""},
    {"HelpSettings", {"settings", "--help"}, 0, "--format", ""},
    {"SettingsForAReader", {"settings"}, 0, "| `rolling` | m |", ""},
    {"SettingsAsMarkdown", {"settings", "--format", "markdown"}, 0, "## [[soil]]", ""},
    {"SettingsAsToml", {"settings", "--format", "toml"}, 0, "[[soil]]", ""},

    {"OutputWithoutAName", {"run", kQuarry, "--output", ""}, 2, "", "the name of the folder is empty"},
    {"InitWithoutAName", {"init", ""}, 2, "", "the name of the folder is empty"},
    {"NoSuchSite", {"run", "no/such/site.toml"}, 3, "", "no/such/site.toml cannot be read"},
    {"SiteIsAFolder", {"check", quarry_a().string()}, 3, "", "site.toml"},
    {"KeyMisspelt", {"check", kQuarry, "--set", "terrain.resolutoin=2"}, 3, "", "did you mean terrain.resolution?"},
    {"KeyOfNoSection", {"check", kQuarry, "--set", "weather.rain=2"}, 3, "", "[weather]"},
    {"SetOutOfRange",
     {"check", kQuarry, "--set", "release.height=-1"},
     3,
     "",
     "release.height = -1 is not allowed: give a number from 0 to 1000"},
    {"SetOfWrongType",
     {"check", kQuarry, "--set", "release.count=many"},
     3,
     "",
     "release.count = 'many' is not allowed: give a whole number"},
    {"SetOfUnknownChoice", {"check", kQuarry, "--set", "blocks.shape=cube"}, 3, "", "\"box\""},
    {"SetOfUnknownSoil", {"check", kQuarry, "--set", "soil.moss.friction=1"}, 3, "", "moss"},
    {"SetOfSoilOutOfRange",
     {"check", kQuarry, "--set", "soil.loose waste.restitution=1.5"},
     3,
     "",
     "soil.restitution = 1.5"},
    {"SeedBelowZero", {"run", kQuarry, "--seed", "-1", "--output", "never_written"}, 3, "", "model.seed = -1"},
    {"RangesExchanged",
     {"check", kQuarry, "--set", "blocks.volume_min=30"},
     3,
     "",
     "blocks.volume_min = 30 is larger than blocks.volume_max = 10"},
    {"DensitySpread",
     {"check", kQuarry, "--set", "blocks.density=600", "--set", "blocks.density_spread=700"},
     3,
     "",
     "blocks.density_spread = 700 is larger than nine tenths of blocks.density = 540"},
    {"VolumeExponent", {"check", kQuarry, "--set", "blocks.volume_exponent=400"}, 3, "", "from 0.001 to 20"},
    {"DefaultSoilUnknown",
     {"check", kQuarry, "--set", "zones.default=moss"},
     3,
     "",
     "\"loose waste\", \"compact waste\""},
    {"MeasurementsMissing",
     {"compare", kQuarry, "--observed", "no/such/stops.csv", "--output", "never_written"},
     3,
     "",
     "no/such/stops.csv' do not exist"},
    {"FileMissing", {"check", kQuarry, "--set", "release.file=data/nothing.gpkg"}, 3, "", "nothing.gpkg"},

    {"Check", {"check", kQuarry}, 0, "Next: scree run", "warning: "},
    {"CheckQuietly", {"check", kQuarry, "--quiet"}, 0, "", "warning: "},
    {"SetANumber", {"check", kQuarry, "--set", "terrain.resolution=2"}, 0, "80 x 40 cells of 2 m", "warning: "},
    {"SetAText", {"check", kQuarry, "--set", "site.name=Trial"}, 0, "Trial", "warning: "},
    {"SetASoilByName", {"check", kQuarry, "--set", "soil.loose waste.rolling=0.2"}, 0, "Next: scree run", "warning: "},
    {"SetASoilByNumber", {"check", kQuarry, "--set", "soil.1.friction=0.7"}, 0, "Next: scree run", "warning: "},
};

/// The fragment is in the text; an empty fragment means that the text is empty.
void expect_said(const std::string& text, const std::string& fragment) {
    if (fragment.empty()) {
        EXPECT_THAT(text, IsEmpty());
    } else {
        EXPECT_THAT(text, HasSubstr(fragment));
    }
}

class Usage : public testing::TestWithParam<UsageCase> {};

TEST_P(Usage, SaysWhatItShould) {
    const UsageCase& c = GetParam();
    const Outcome outcome = scree_program(c.args);
    EXPECT_EQ(outcome.code, c.code) << outcome.err;
    expect_said(outcome.out, c.out);
    expect_said(outcome.err, c.err);
    if (c.code != 0) {
        EXPECT_EQ(outcome.err.rfind("error: ", 0), 0U) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << "one sentence, one line";
    }
}
INSTANTIATE_TEST_SUITE_P(Table, Usage, testing::ValuesIn(kUsage),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(Settings, ChangesReachTheSite) {
    const cli::SiteFile site =
        cli::read_site_file(kQuarry, {"soil.loose waste.rolling=0.2", "soil.1.friction=0.7", "release.count=7",
                                      "site.name=Trial", "terrain.conforming=false"});
    EXPECT_EQ(site.settings.soils[0].rolling, 0.2);
    EXPECT_EQ(site.settings.soils[1].friction, 0.7);
    EXPECT_EQ(site.settings.releases.count, 7);
    EXPECT_EQ(site.settings.name, "Trial");
    EXPECT_FALSE(site.settings.conforming);
}

TEST(Settings, PrintedTomlIsReadAgain) {
    const TempDir folder;
    const std::string printed = scree_program({"settings", "--format", "toml"}).out;
    put(folder / "site.toml", printed);
    const cli::SiteFile site = cli::read_site_file(folder / "site.toml", {});
    const cli::SiteSettings defaults;
    EXPECT_EQ(site.settings.soils.size(), 1U);
    EXPECT_EQ(site.settings.dynamics.time_step, defaults.dynamics.time_step);
    EXPECT_EQ(site.settings.releases.count, defaults.releases.count);
    EXPECT_EQ(site.settings.distribution.volume, defaults.distribution.volume);
    EXPECT_EQ(site.settings.result_resolution, defaults.result_resolution);
}

TEST(Settings, ManualListsEveryKeyOfThePrintedToml) {
    const std::string manual = scree_program({"settings"}).out;
    std::istringstream printed(scree_program({"settings", "--format", "toml"}).out);
    int keys = 0;
    for (std::string line; std::getline(printed, line);) {
        const auto equals = line.find(" = ");
        if (line.starts_with("#") || equals == std::string::npos) continue;
        EXPECT_THAT(manual, HasSubstr("| `" + line.substr(0, equals) + "` |"));
        ++keys;
    }
    EXPECT_GT(keys, 50);
}

TEST(Init, WritesASiteThatOnlyLacksItsData) {
    const TempDir folder;
    const std::string file = (folder / "new site/site.toml").string();
    const Outcome made = scree_program({"init", (folder / "new site").string()});
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("scree check"));
    EXPECT_EQ(cli::read_site_file(file, {}).settings.diagonals, DiagonalRule::ByRelief) << "no grain on rough ground";
    const Outcome checked = scree_program({"check", file});
    EXPECT_EQ(checked.code, 3);
    EXPECT_THAT(checked.err, HasSubstr("dtm.tif"));

    const std::string before = text_of(file);
    const Outcome again = scree_program({"init", (folder / "new site").string()});
    EXPECT_EQ(again.code, 3);
    EXPECT_THAT(again.err, HasSubstr("exists already"));
    EXPECT_EQ(text_of(file), before);
}

// Cells of 3 m do not fit into 160 m: the model is narrower than the DTM.
TEST(Check, TellsTheExtentOfTheDtmAndOfTheModel) {
    const Outcome run = scree_program({"check", (quarry_a() / "site.toml").string(), "--set", "terrain.resolution=3"});
    ASSERT_EQ(run.code, 0) << run.err;
    const auto model = run.out.find("model  ");
    ASSERT_NE(model, std::string::npos);
    EXPECT_THAT(run.out.substr(0, model), HasSubstr("easting 890000.0 to 890160.0"));
    EXPECT_THAT(run.out.substr(model), HasSubstr("easting 890000.0 to 890159.0"));
}

TEST(Init, CheckPassesOnceTheDataAreThere) {
    const TempDir folder;
    ASSERT_EQ(scree_program({"init", folder.path().string()}).code, 0);
    std::filesystem::copy(quarry_a() / "data", folder / "data", std::filesystem::copy_options::recursive);
    const Outcome checked =
        scree_program({"check", (folder / "site.toml").string(), "--set", "soil.loose.name=loose waste", "--set",
                       "soil.compact.name=compact waste", "--set", "zones.default=loose waste"});
    EXPECT_EQ(checked.code, 0) << checked.err;
    EXPECT_THAT(checked.out, HasSubstr("Inputs are good"));
}

TEST(Init, RefusesAFolderThatCannotBeMade) {
    const TempDir folder;
    put(folder / "file", "not a folder");
    const Outcome made = scree_program({"init", (folder / "file").string()});
    EXPECT_EQ(made.code, 3);
    EXPECT_THAT(made.err, HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace scree::test
