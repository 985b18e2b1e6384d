// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace scree::gis {

/// A text table (CSV) with a header line. Separator: comma, semicolon or tab, as a first line "sep=;" says, else whichever the header holds most of. Quotes, CRLF and a
/// byte order mark are understood; text that is not UTF-8 is taken as ISO-8859-1, with a warning.
struct Table {
    struct Row {
        std::size_t line = 0;            ///< in the file, from 1 [-]
        std::vector<std::string> cells;  ///< as many as the header has, without surrounding blanks
    };
    std::string file;  ///< as given
    char separator = ',';
    std::vector<std::string> header;
    std::vector<Row> rows;
    std::vector<std::string> warnings;
};

/// Throws InputError for a file that cannot be read, is binary, has no header, a column twice (whatever its case), or rows with another number of cells than the header.
Table read_table(const std::string& file, const std::string& purpose);

/// Index of a column; throws InputError that lists the columns there are.
std::size_t column_index(const Table& table, const std::string& column);

/// The numbers of a column; throws InputError that names lines and values unless all are finite and in (above, up to].
/// A decimal comma is understood where the separator is not a comma; what could also be a thousands mark (1,200) is refused.
std::vector<double> number_column(const Table& table, const std::string& column, double above = -kInfinity,
                                  double up_to = kInfinity);

/// A number as a table writes it, none if the text is something else. `comma`: the comma is the decimal point.
std::optional<double> parse_number(std::string text, bool comma);
/// Whether the text is one number for some and another for others: 1,200.
bool is_ambiguous_number(const std::string& text);

/// A block of the block list.
struct BlockRow {
    std::string id;
    double mass = 0.0;  ///< [kg]
    double l1 = 0.0;    ///< longest edge of the box around it [m]
    double l2 = 0.0;    ///< middle edge [m]
    double l3 = 0.0;    ///< shortest edge [m]
};

struct BlockList {
    std::vector<BlockRow> blocks;
    std::vector<std::string> unread_columns;
    std::vector<std::string> warnings;
};

/// Reads the columns block_id, mass_kg, L1_m, L2_m, L3_m; others are ignored. Edges are sorted so that L1 >= L2 >= L3, with a warning
/// where they were not. Ids must be unique. Masses that do not suit the edges (a box of 500 to 3500 kg/m^3) give a warning.
BlockList read_block_list(const std::string& file);

}  // namespace scree::gis
