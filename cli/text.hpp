// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/discrepancy.hpp"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace scree::cli {

/// Numbers and columns as all reports write them.

/// Three significant digits: "0.0123", "1240".
std::string short_number(double value);

/// A text as a cell of a table with commas between its cells, quoted.
std::string csv_cell(const std::string& text);
/// "0.953", "< 0.001" (of what underflows to 0 as well).
std::string weight_text(double weight);
/// "12.5 %".
std::string percent(std::int64_t part, std::int64_t whole);
/// A gap with as many digits as mean something.
std::string gap_number(double value);
/// 95 % of what chance gives: "0.62 to 1.71".
std::string chance_text(const Gap& gap);
/// "0.30", "0.047", "0.0005": of small ones one digit, which is as small as the draws of chance can tell.
std::string p_text(double p);

/// A column of a table, filled up with spaces; UTF-8.
std::string padded(std::string text, std::size_t width);

/// As a shell takes it for one word: in quotes where it has to be.
std::string shell_word(const std::string& text);

/// "A, B, C".
std::string listed(const std::vector<std::string>& names);
/// "A, B, C, D and 3 more".
std::string listed_few(const std::set<std::string>& names);

/// Edits by insertion, deletion and exchange between two words: how far a misspelt one is from a known one.
std::size_t edit_distance(const std::string& a, const std::string& b);

}  // namespace scree::cli
