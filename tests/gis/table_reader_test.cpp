// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/table_reader.hpp"

#include "gis/input_files.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace scree::gis {

namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kHeader = "block_id,mass_kg,L1_m,L2_m,L3_m\n";

BlockList blocks_of(const std::string& text) {
    const test::TempDir dir;
    const std::string file = dir / "blocks.csv";
    std::ofstream(file, std::ios::binary) << text;
    return read_block_list(file);
}

std::string error_of(const std::string& text) {
    return test::input_error_of([&] { blocks_of(text); });
}

}  // namespace

TEST(BlockList, ReadsRowsInOrderAndIgnoresOtherColumns) {
    const BlockList list = blocks_of(
        "note,block_id,mass_kg,L1_m,L2_m,L3_m\r\n\"a, \"\"b\"\"\nc\", A ,500, "
        "0.8,0.6,0.5\r\n\r\nx,B,+1.2e3,1.1,.8,0.6");
    ASSERT_EQ(list.blocks.size(), 2u);
    EXPECT_EQ(list.blocks[0].id, "A");
    EXPECT_EQ(list.blocks[0].mass, 500.0);
    EXPECT_EQ(list.blocks[1].mass, 1200.0);
    EXPECT_EQ(list.blocks[1].l2, 0.8);
    EXPECT_THAT(list.unread_columns, ElementsAre("note"));
    EXPECT_THAT(list.warnings, IsEmpty());
}

TEST(BlockList, EdgesAreSorted) {
    const BlockList list = blocks_of(kHeader + "A,500,0.5,0.8,0.6\n");
    EXPECT_EQ(list.blocks[0].l1, 0.8);
    EXPECT_EQ(list.blocks[0].l2, 0.6);
    EXPECT_EQ(list.blocks[0].l3, 0.5);
    EXPECT_THAT(list.warnings, ElementsAre(AllOf(HasSubstr("sorted"), HasSubstr("line 2"))));
}

TEST(BlockList, SemicolonsAndDecimalCommas) {
    const BlockList list = blocks_of(
        "\xEF\xBB\xBF"
        "block_id;mass_kg;L1_m;L2_m;L3_m\r\nA;500,5;0,8;0,600;0,5\r\n");
    EXPECT_EQ(list.blocks[0].mass, 500.5);
    EXPECT_EQ(list.blocks[0].l2, 0.6);
    EXPECT_THAT(error_of("block_id;mass_kg;L1_m;L2_m;L3_m\nA;1,200;0.8;0.6;0.5\n"),
                AllOf(HasSubstr("'1,200' in line 2"), HasSubstr("thousands")));
    EXPECT_THAT(error_of(kHeader + "A,500,5,0,8,0,6,0,5\n"),
                AllOf(HasSubstr("line 2, has 9 cells"), HasSubstr("decimal commas")));
}

TEST(BlockList, ValuesAreCheckedWithLineAndText) {
    EXPECT_THAT(
        error_of(kHeader +
                 "A,nan,0.8,0.6,0.5\nB,inf,0.8,0.6,0.5\nC,5e2kg,0.8,0.6,0.5\nD,0,1,1,1\nE,-4,1,1,1\nF,,1,1,1\n"),
        AllOf(
            HasSubstr("'nan' in line 2, 'inf' in line 3, '5e2kg' in line 4, '0' in line 5, '-4' in line 6 and 1 more"),
            HasSubstr("mass_kg")));
    EXPECT_THAT(error_of(kHeader), HasSubstr("no rows"));
    EXPECT_THAT(error_of(""), HasSubstr("is empty"));
    EXPECT_THAT(error_of("block_id,mass_kg\nA,500\n"), AllOf(HasSubstr("lacks the column 'L1_m', 'L2_m', 'L3_m'"),
                                                             HasSubstr("and has 'block_id', 'mass_kg'")));
    EXPECT_THAT(error_of(kHeader + "A,500,0.8,0.6,0.5\nB,500,0.8,0.6,0.5\nA,500,0.8,0.6,0.5\n"),
                HasSubstr("'A' in lines 2 and 4"));
    EXPECT_THAT(error_of(kHeader + "\"A,500,0.8\n"), HasSubstr("never closed"));
    EXPECT_THAT(error_of(std::string("a\0b", 3)), HasSubstr("binary"));
    EXPECT_THAT(blocks_of(kHeader + "A,100,0.8,0.6,0.5\n").warnings, Contains(HasSubstr("check the units")));
    EXPECT_THAT(error_of(kHeader + "A,0.5,0.8,0.6,0.5\n"),
                AllOf(HasSubstr("line 2, has a block of 0.5 kg"), HasSubstr("check the units")));
    EXPECT_THAT(test::input_error_of([] { read_block_list("/nowhere/blocks.csv"); }), HasSubstr("does not exist"));
}

// As results of ours have them.
TEST(BlockList, CaseDoesNotCountInItsHeader) {
    const BlockList list = blocks_of("Block_ID,mass_kg,l1_m,l2_m,L3_M,colour\nA,500,0.8,0.6,0.5,grey\n");
    EXPECT_EQ(list.blocks.at(0).l2, 0.6);
    EXPECT_EQ(list.unread_columns, std::vector<std::string>{"colour"});
}

TEST(BlockList, BlankLinesAboveTheHeaderAreNoHeader) {
    EXPECT_EQ(blocks_of("\n\nblock_id;mass_kg;L1_m;L2_m;L3_m\nA;500,5;0,8;0,600;0,5\n").blocks.at(0).mass, 500.5);
}

TEST(BlockList, AFirstLineMayTellTheSeparator) {
    const std::string rows = "block_id;mass_kg;L1_m;L2_m;L3_m\r\nA;500,5;0,8;0,600;0,5\r\n";
    EXPECT_EQ(blocks_of("sep=;\r\n" + rows).blocks.at(0).mass, 500.5);
    EXPECT_EQ(blocks_of("\xEF\xBB\xBFSEP=;\n" + rows).blocks.at(0).l2, 0.6);
    EXPECT_EQ(blocks_of("sep=,\n" + kHeader + "A,500,0.8,0.6,0.5\n").blocks.at(0).mass, 500.0);
    EXPECT_THAT(error_of("sep=;\n" + rows + "B;no;1;1;1\n"), HasSubstr("'no' in line 4")) << "lines of the file";
    EXPECT_THAT(error_of("sep=;"), HasSubstr("is empty"));
}

TEST(BlockList, ColumnsThatDifferInCaseAreOneColumnTwice) {
    EXPECT_THAT(error_of("block_id,mass_kg,Mass_kg,L1_m,L2_m,L3_m\nA,500,5,0.8,0.6,0.5\n"),
                HasSubstr("has the column 'mass_kg' more than once (the other is 'Mass_kg')"));
}

TEST(BlockList, OtherEncodingsAreSaidOnce) {
    const BlockList list = blocks_of(kHeader +
                                     "Bl\xF6"
                                     "ck,500,0.8,0.6,0.5\n");
    EXPECT_EQ(list.blocks[0].id, "Blöck");
    EXPECT_THAT(list.warnings, ElementsAre(HasSubstr("ISO-8859-1")));
}

TEST(AwkwardBlockLists, AreReadRightOrRefused) {
    SCREE_SHARED_OR_SKIP(folder, "badinputs");
    const auto message = [&, folder = folder](const std::string& name) {
        return test::input_error_of([&] { read_block_list(folder / name); });
    };
    EXPECT_EQ(read_block_list(folder / "control/good_blocks.csv").blocks.size(), 3u);
    EXPECT_THAT(read_block_list(folder / "control/good_blocks.csv").warnings, IsEmpty());
    EXPECT_EQ(read_block_list(folder / "blocks/b01_semicolon_decimal_comma_bom.csv").blocks.at(0).mass, 500.5);
    EXPECT_THAT(message("blocks/b03_missing_column.csv"), HasSubstr("'L3_m'"));
    EXPECT_THAT(message("blocks/b05_header_only.csv"), HasSubstr("no rows"));
    EXPECT_THAT(message("blocks/b07_nan_text.csv"), AllOf(HasSubstr("line 2"), HasSubstr("5e2kg")));
    EXPECT_THAT(read_block_list(folder / "blocks/b09_latin1.csv").warnings, ElementsAre(HasSubstr("UTF-8")));
}

}  // namespace scree::gis
