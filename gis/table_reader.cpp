// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/table_reader.hpp"

#include "gis/utf8.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

namespace scree::gis {

namespace {

constexpr std::uintmax_t kMaxBytes = 256u
                                     << 20;  // a table larger than this is no table of blocks or observations [bytes]
constexpr std::size_t kListed = 5;           // how many offenders a message names

std::string load(const std::string& file, const std::string& purpose) {
    namespace fs = std::filesystem;
    const std::string place = words("Cannot read the ", purpose, " '", file, "': ");
    std::error_code error;
    if (!fs::exists(file, error)) throw InputError(place + "the file does not exist; check the path.");
    if (!fs::is_regular_file(file, error)) throw InputError(place + "it is not a file; name a table in CSV format.");
    if (fs::file_size(file, error) > kMaxBytes)
        throw InputError(words(place, "it is larger than ", kMaxBytes >> 20, " MB; is it the right file?"));
    std::ifstream in(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in || in.bad()) throw InputError(place + "the file cannot be opened for reading; check its permissions.");
    if (text.rfind("\xEF\xBB\xBF", 0) == 0) text.erase(0, 3);
    if (text.find('\0') != std::string::npos) {
        const bool utf16 = text.rfind("\xFF\xFE", 0) == 0 || text.rfind("\xFE\xFF", 0) == 0;
        throw InputError(
            place + (utf16 ? "it is in UTF-16; save it as CSV in UTF-8." : "it is binary; save it as CSV in UTF-8."));
    }
    return text;
}

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t");
    return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// What a first line "sep=;" of a spreadsheet says; the line is blanked, so that lines keep their numbers.
std::optional<char> told_separator(std::string& text) {
    const std::size_t first = text.find_first_not_of("\r\n"), end = first + 5;
    if (first == std::string::npos || text.size() < end || lower_case(text.substr(first, 4)) != "sep=")
        return std::nullopt;
    const char separator = text[end - 1];
    if (end < text.size() && text[end] != '\r' && text[end] != '\n') return std::nullopt;
    if (separator != ',' && separator != ';' && separator != '\t') return std::nullopt;
    std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(first), 5, ' ');
    return separator;
}

char separator_of(const std::string& text) {
    const std::size_t first = std::min(text.find_first_not_of("\r\n "), text.size());
    const std::string header = text.substr(first, text.find_first_of("\r\n", first) - first);
    const auto count = [&](char c) { return std::count(header.begin(), header.end(), c); };
    return std::max({',', ';', '\t'}, [&](char a, char b) { return count(a) < count(b); });
}

// RFC 4180, with the separator found and line ends of any system.
// Rows of cells without anything in them go to `blank_lines`; empty lines are nothing.
std::vector<Table::Row> split(const std::string& text, char separator, const std::string& place,
                              std::vector<std::size_t>& blank_lines) {
    std::vector<Table::Row> rows;
    Table::Row row{1, {}};
    std::string cell;
    std::size_t line = 1;
    bool quoted = false, was_quoted = false;
    const auto end_cell = [&] {
        row.cells.push_back(was_quoted ? cell : trimmed(cell));
        cell.clear();
        was_quoted = false;
    };
    const auto end_row = [&] {
        end_cell();
        const bool blank =
            std::all_of(row.cells.begin(), row.cells.end(), [](const std::string& c) { return c.empty(); });
        if (!blank)
            rows.push_back(std::move(row));
        else if (row.cells.size() > 1)
            blank_lines.push_back(row.line);
        row = {line, {}};
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\n' || (c == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'))) ++line;
        if (quoted) {
            if (c != '"')
                cell += c;
            else if (i + 1 < text.size() && text[i + 1] == '"')
                cell += text[++i];
            else
                quoted = false;
        } else if (c == '"' && trimmed(cell).empty()) {
            quoted = was_quoted = true;
            cell.clear();
        } else if (c == separator) {
            end_cell();
        } else if (c == '\r' || c == '\n') {
            if (c == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
            end_row();
        } else if (!was_quoted || (c != ' ' && c != '\t')) {
            cell += c;
        }
    }
    if (quoted) throw InputError(words(place, " opens a quote in line ", row.line, " that is never closed; close it."));
    end_row();
    return rows;
}

}  // namespace

std::optional<double> parse_number(std::string text, bool comma) {
    if (comma) {
        const std::size_t at = text.find(',');
        if (at != std::string::npos &&
            (text.find(',', at + 1) != std::string::npos || text.find('.') != std::string::npos))
            return std::nullopt;
        if (at != std::string::npos) text[at] = '.';
    }
    if (!text.empty() && text.front() == '+') text.erase(0, 1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

bool is_ambiguous_number(const std::string& text) {
    const std::size_t comma = text.find(',');
    return comma != std::string::npos && comma >= 1 && comma <= 3 && text.size() == comma + 4 && text[0] != '0' &&
           std::all_of(text.begin(), text.end(), [](char c) { return c == ',' || (c >= '0' && c <= '9'); });
}

Table read_table(const std::string& file, const std::string& purpose) {
    Table table;
    table.file = file;
    std::string text = load(file, purpose);
    const std::string place = words("The ", purpose, " '", file, "'");
    if (!is_utf8(text)) {
        text = utf8_from_latin1(text);
        table.warnings.push_back(
            words(place, " is not in UTF-8: it is taken to be in ISO-8859-1; save it as UTF-8 if names look wrong."));
    }
    const std::optional<char> told = told_separator(text);
    table.separator = told ? *told : separator_of(text);
    std::vector<std::size_t> blank_lines;
    table.rows = split(text, table.separator, place, blank_lines);
    if (!blank_lines.empty())
        table.warnings.push_back(words(place, " has ", counted(blank_lines.size(), "row"),
                                       " without any value (first in line ", blank_lines.front(),
                                       "), left out; a row that counts, as of a block that was thrown and not found, "
                                       "needs one, its block_id for example."));
    if (table.rows.empty()) throw InputError(words(place, " is empty; it needs at least a header line."));
    table.header = std::move(table.rows.front().cells);
    table.rows.erase(table.rows.begin());
    for (std::size_t k = 0; k < table.header.size(); ++k)
        for (std::size_t j = 0; j < k; ++j)
            if (!table.header[k].empty() && lower_case(table.header[j]) == lower_case(table.header[k]))
                throw InputError(
                    words(place, " has the column '", table.header[j], "' more than once",
                          table.header[j] == table.header[k] ? "" : words(" (the other is '", table.header[k], "')"),
                          ": which one counts? Keep one, or rename the others."));
    for (const Table::Row& row : table.rows) {
        if (row.cells.size() == table.header.size()) continue;
        throw InputError(words(
            place, ", line ", row.line, ", has ", row.cells.size(), " cells where the header has ", table.header.size(),
            row.cells.size() > table.header.size() && table.separator == ','
                ? "; if it has decimal commas, write decimal points or separate the cells by semicolons."
                : "; complete the line."));
    }
    return table;
}

std::size_t column_index(const Table& table, const std::string& column) {
    const auto found = std::find(table.header.begin(), table.header.end(), column);
    if (found != table.header.end()) return static_cast<std::size_t>(found - table.header.begin());
    std::string names;
    for (const std::string& name : table.header) names += words(names.empty() ? "'" : ", '", name, "'");
    throw InputError(words("The table '", table.file, "' has no column '", column, "'; it has ", names, "."));
}

std::vector<double> number_column(const Table& table, const std::string& column, double above, double up_to) {
    const std::size_t index = column_index(table, column);
    const bool comma = table.separator != ',';
    std::vector<double> numbers;
    std::string wrong;
    std::size_t count = 0;
    bool ambiguous = false;
    for (const Table::Row& row : table.rows) {
        const std::string& text = row.cells[index];
        const std::optional<double> value = parse_number(text, comma);
        const bool unclear = comma && is_ambiguous_number(text);
        ambiguous = ambiguous || unclear;
        if (!value || !(*value > above && *value <= up_to) || unclear) {
            if (++count <= kListed) wrong += words(count > 1 ? ", '" : "'", text, "' in line ", row.line);
        }
        numbers.push_back(value.value_or(kNaN));
    }
    if (count == 0) return numbers;
    throw InputError(
        words("The table '", table.file, "' has values in the column '", column, "' that cannot be used: ", wrong,
              count > kListed ? words(" and ", count - kListed, " more") : std::string(),
              "; each must be a finite number", std::isfinite(above) ? words(" greater than ", above) : std::string(),
              std::isfinite(up_to) ? words(std::isfinite(above) ? " and" : "", " of at most ", up_to) : std::string(),
              ambiguous ? ", and without a comma that could mean thousands." : " without a unit."));
}

BlockList read_block_list(const std::string& file) {
    Table table = read_table(file, "block list");
    constexpr std::array<const char*, 5> kColumns{"block_id", "mass_kg", "L1_m", "L2_m", "L3_m"};
    for (std::string& name : table.header)
        for (const char* column : kColumns)
            if (lower_case(name) == lower_case(column)) name = column;
    BlockList list;
    list.warnings = table.warnings;
    const std::string place = words("The block list '", file, "'");
    if (table.rows.empty()) throw InputError(words(place, " has a header but no rows; add at least one."));

    // generous limits: they catch wrong units, not large blocks
    constexpr double kMaxMass = 1e9, kMaxEdge = 1000;  // [kg], [m]
    constexpr double kMinBoxDensity = 500,
                     kMaxBoxDensity = 3500;  // mass over the volume of the box around the block [kg/m^3]
    constexpr double kAbsurd = 4.0;          // times beyond these: no block, a slip of units [-]
    std::string missing;
    for (const char* name : kColumns) {
        if (std::find(table.header.begin(), table.header.end(), name) == table.header.end())
            missing += words(missing.empty() ? "'" : ", '", name, "'");
    }
    if (!missing.empty()) {
        std::string found;
        for (const std::string& name : table.header) found += words(found.empty() ? "'" : ", '", name, "'");
        throw InputError(words(
            place, " lacks the column ", missing, "; it must have block_id, mass_kg, L1_m, L2_m, L3_m",
            table.header.size() == 1 ? ", separated by commas, semicolons or tabs" : "", ", and has ", found, "."));
    }
    const std::size_t id = column_index(table, "block_id");
    const std::vector<double> mass = number_column(table, "mass_kg", 0, kMaxMass);
    const std::array edges = {number_column(table, "L1_m", 0, kMaxEdge), number_column(table, "L2_m", 0, kMaxEdge),
                              number_column(table, "L3_m", 0, kMaxEdge)};

    for (const std::string& name : table.header)
        if (std::find(kColumns.begin(), kColumns.end(), name) == kColumns.end()) list.unread_columns.push_back(name);
    std::vector<std::pair<std::string, std::size_t>> seen;
    std::size_t unsorted = 0, strange = 0, first_unsorted = 0, first_strange = 0;
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        const std::size_t line = table.rows[r].line;
        std::array l = {edges[0][r], edges[1][r], edges[2][r]};
        if (!std::is_sorted(l.rbegin(), l.rend()) && ++unsorted == 1) first_unsorted = line;
        std::sort(l.rbegin(), l.rend());
        const double density = mass[r] / (l[0] * l[1] * l[2]);
        if (!(density >= kMinBoxDensity && density <= kMaxBoxDensity) && ++strange == 1) first_strange = line;
        if (!(density >= kMinBoxDensity / kAbsurd && density <= kMaxBoxDensity * kAbsurd))
            throw InputError(words(place, ", line ", line, ", has a block of ", mass[r], " kg and ", l[0], " x ", l[1],
                                   " x ", l[2], " m: its mass / (L1 L2 L3) of ", density,
                                   " kg/m3 is that of no rock, which has ", kMinBoxDensity, " to ", kMaxBoxDensity,
                                   "; check the units (kg, m)."));
        list.blocks.push_back({table.rows[r].cells[id], mass[r], l[0], l[1], l[2]});
        if (list.blocks.back().id.empty())
            throw InputError(words(place, ", line ", line, ", has no block_id; give each block a name of its own."));
        seen.emplace_back(list.blocks.back().id, line);
    }
    std::sort(seen.begin(), seen.end());
    const auto twice =
        std::adjacent_find(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice != seen.end()) {
        throw InputError(words(place, " has the block_id '", twice->first, "' in lines ", twice->second, " and ",
                               (twice + 1)->second, "; give each block a name of its own."));
    }
    if (unsorted > 0) {
        list.warnings.push_back(words(place, " has ", counted(unsorted, "block"),
                                      " with edges not in the order L1 >= L2 >= L3 (first in line ", first_unsorted,
                                      "); sorted here."));
    }
    if (strange > 0) {
        list.warnings.push_back(words(place, " has ", counted(strange, "block"),
                                      " with a mass that does not suit the edges (first in line ", first_strange,
                                      "): mass / (L1 L2 L3) of rock is between ", kMinBoxDensity, " and ",
                                      kMaxBoxDensity, " kg/m3; check the units."));
    }
    return list;
}

}  // namespace scree::gis
