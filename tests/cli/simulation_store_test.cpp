// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/simulation_store.hpp"

#include "cli/results.hpp"
#include "scree/base/error.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scree::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

ObservationTable table_of_two() {
    ObservationTable table;
    table.columns = {{Quantity::Along, -1}, {Quantity::Speed, 1}};
    table.block = {0, 1, 1};
    table.values = {{1.5, kNaN, -3.0}, {0.0, kInfinity, 2e300}};
    return table;
}

TEST(SimulationStore, GivesBackWhatItKeeps) {
    const TempDir folder;
    cli::SimulationStore store(folder / "journal", "this study");
    EXPECT_FALSE(store.find("baseline"));
    EXPECT_FALSE(fs::exists(store.folder())) << "nothing is written before there is something to keep";
    const ObservationTable table = table_of_two();
    store.keep("baseline", table);
    const auto found = store.find("baseline");
    ASSERT_TRUE(found);
    EXPECT_EQ(found->block, table.block);
    ASSERT_EQ(found->columns.size(), 2U);
    EXPECT_EQ(found->columns[1].quantity, Quantity::Speed);
    EXPECT_EQ(found->columns[1].place, 1);
    EXPECT_TRUE(std::isnan(found->values[0][1]));
    EXPECT_EQ(found->values[0][2], -3.0);
    EXPECT_EQ(found->values[1], table.values[1]);

    EXPECT_FALSE(store.find("other words"));
    store.remove();
    EXPECT_FALSE(fs::exists(store.folder()));
    EXPECT_FALSE(store.find("baseline"));
}

TEST(SimulationStore, DoesNotFindWhatAnotherStudyKept) {
    const TempDir folder;
    cli::SimulationStore(folder / "journal", "this study").keep("baseline", table_of_two());
    EXPECT_FALSE(cli::SimulationStore(folder / "journal", "another study").find("baseline"));
    EXPECT_TRUE(cli::SimulationStore(folder / "journal", "this study").find("baseline")) << "the other one is gone";
}

TEST(SimulationStore, IsOfOneDiagnosisAtATime) {
    const TempDir folder;
    cli::SimulationStore first(folder / "journal", "this study"), second(folder / "journal", "this study");
    first.file("calibration.jsonl");  // before anything else is simulated
    const auto refused = ThrowsMessage<InputError>(HasSubstr("is being written by another diagnosis: wait for it"));
    EXPECT_THAT([&] { second.keep("baseline", table_of_two()); }, refused) << "both had begun";
    EXPECT_THAT([&] { cli::SimulationStore(folder / "journal", "another study"); }, refused);
    first.remove();
    second.keep("baseline", table_of_two());
    EXPECT_TRUE(second.find("baseline")) << "whoever has done its work lets go";
}

TEST(SimulationStore, RemovesNothingOfOthers) {
    const TempDir folder;
    cli::SimulationStore store(folder / "journal", "this study");
    store.keep("baseline", table_of_two());
    fs::create_directory(store.folder() / "notes");
    std::ofstream(store.folder() / "notes" / "a.txt") << "mine";
    store.remove();
    EXPECT_FALSE(store.find("baseline"));
    EXPECT_TRUE(fs::exists(store.folder() / "notes" / "a.txt"));
}

TEST(SimulationStore, DoesNotTakeHalfAFile) {
    const TempDir folder;
    cli::SimulationStore store(folder / "journal", "this study");
    store.keep("baseline", table_of_two());
    for (const auto& entry : fs::directory_iterator(store.folder()))
        for (auto size = fs::file_size(entry.path()); size-- > 0;) {
            fs::resize_file(entry.path(), size);
            EXPECT_FALSE(store.find("baseline")) << size;
        }
}

}  // namespace
}  // namespace scree::test
