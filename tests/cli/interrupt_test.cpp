// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C, on the real process: it ends soon, with 130, and what was done is written and marked.
#include "cli/process.hpp"
#include "cli/program.hpp"
#include "cli/results.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace scree::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kManyBlocks = 1'000'000;  // more than a test can wait for

TEST(Interrupt, WritesWhatWasDoneAndSaysSo) {
    const TempDir folder;
    const fs::path out = folder / "out";
    Process run({"run", (quarry_a() / "site.toml").string(), "--set", "release.count=" + std::to_string(kManyBlocks),
                 "--output", out.string(), "--progress=json", "--quiet"});
    std::string line = run.line();
    while (!line.empty() && line.find("\"done\"") == std::string::npos) line = run.line();
    ASSERT_THAT(line, HasSubstr("\"done\"")) << "the run never reported progress";
    run.interrupt();
    std::string last;
    while (!(line = run.line()).empty()) last = line;
    ASSERT_EQ(run.wait(), 130);
    EXPECT_THAT(last, HasSubstr("interrupted: "));

    const auto stops = read_points(out / "results.gpkg", "stopping_points");
    EXPECT_GT(stops.size(), 0U);
    EXPECT_LT(stops.size(), static_cast<std::size_t>(kManyBlocks));
    EXPECT_THAT(last, HasSubstr("interrupted: " + std::to_string(stops.size()) + " of " + std::to_string(kManyBlocks)));
    EXPECT_THAT(text_of(out / "run.toml"), HasSubstr("INTERRUPTED"));
    EXPECT_NE(text_of(out / "results.gpkg")
                  .find("true: " + std::to_string(stops.size()) + " of " + std::to_string(kManyBlocks) + " blocks"),
              std::string::npos);
    EXPECT_FALSE(read_points(out / "results.gpkg", "release_points").empty());

    const Outcome taken =
        scree_program({"compare", (quarry_a() / "site.toml").string(), "--observed", out.string(), "--output",
                       (folder / "compared").string(), "--set", "observed.repeats=5", "--set", "observed.draws=100"});
    EXPECT_THAT(taken.err + taken.out, HasSubstr("are those of a run that was interrupted ("));
}

// Who asks for a new result in the place of an old one has not asked for a part of it.
TEST(Interrupt, OverwritesNoResultWithAPartOfOne) {
    const TempDir folder;
    const fs::path out = folder / "out", part = folder / "out.interrupted";
    ASSERT_EQ(run_quarry_a(out).code, 0);
    const auto before = contents_of(out);
    Process run({"run", (quarry_a() / "site.toml").string(), "--set", "release.count=" + std::to_string(kManyBlocks),
                 "--output", out.string(), "--overwrite", "--progress=json", "--quiet"});
    std::string line = run.line();
    while (!line.empty() && line.find("\"done\"") == std::string::npos) line = run.line();
    run.interrupt();
    std::string last;
    while (!(line = run.line()).empty()) last = line;
    ASSERT_EQ(run.wait(), 130);
    EXPECT_THAT(last, HasSubstr("written to " + part.string()));
    EXPECT_EQ(contents_of(out), before);
    EXPECT_THAT(text_of(part / "run.toml"), HasSubstr("INTERRUPTED"));
    EXPECT_FALSE(read_points(part / "results.gpkg", "stopping_points").empty());

    // nor with a part of itself, nor a part with another
    const auto kept = contents_of(part);
    Process again(
        {"run", (part / "run.toml").string(), "--output", out.string(), "--overwrite", "--progress=json", "--quiet"});
    do line = again.line();
    while (!line.empty() && line.find("\"done\"") == std::string::npos);
    again.interrupt();
    while (!(line = again.line()).empty()) last = line;
    ASSERT_EQ(again.wait(), 130);
    EXPECT_THAT(last, HasSubstr("written to " + part.string() + "-2"));
    EXPECT_EQ(contents_of(part), kept);
    EXPECT_EQ(contents_of(out), before);
}

TEST(Interrupt, OfAComparisonWritesNothing) {
    const TempDir folder;
    put(folder / "zones.csv", "name,count,released\n4A,18,20\n");
    Process run({"compare", (quarry_a() / "site.toml").string(), "--observed", (folder / "zones.csv").string(), "--set",
                 "release.count=" + std::to_string(kManyBlocks), "--output", (folder / "out").string(),
                 "--progress=json", "--quiet"});
    std::string line = run.line();
    while (!line.empty() && line.find("\"done\"") == std::string::npos) line = run.line();
    ASSERT_THAT(line, HasSubstr("\"done\"")) << "the run never reported progress";
    run.interrupt();
    std::string last;
    while (!(line = run.line()).empty()) last = line;
    EXPECT_EQ(run.wait(), 130);
    EXPECT_THAT(last, HasSubstr("nothing is written"));
    EXPECT_EQ(contents_of(folder.path()).size(), 1U);
}

TEST(Interrupt, CalibrationKeepsItsSimulationsAndGoesOn) {
    const TempDir folder;
    const fs::path out = folder / "out", journal = folder / "out.journal.jsonl";
    put(folder / "zones.csv", "name,count,released\n3A,5,30\n4A,25,30\n");
    std::vector<std::string> args{"calibrate",       (quarry_a() / "site.toml").string(),
                                  "--observed",      (folder / "zones.csv").string(),
                                  "--output",        out.string(),
                                  "--progress=json", "--quiet",
                                  "--set",           "model.dimension=2"};
    for (const char* option :
         {"--free", "soil.compact waste.rolling=0.01:0.2", "--set", "calibration.screening=100000"})
        args.emplace_back(option);
    EXPECT_THAT(interrupted(args), HasSubstr("--resume goes on from there"));
    EXPECT_FALSE(fs::exists(out));
    const std::string kept = text_of(journal);
    EXPECT_GT(std::count(kept.begin(), kept.end(), '\n'), 1);

    args.emplace_back("--resume");
    interrupted(args);
    EXPECT_TRUE(text_of(journal).starts_with(kept)) << "nothing is simulated twice";
}

}  // namespace
}  // namespace scree::test
