// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_figures.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// Text as it stands in a page.
std::string escaped(const std::string& text);
/// A picture inside a page, with its caption if it has one.
std::string html_figure(const Figure& figure);
/// Plain cells under their heads.
std::string html_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);
std::string html_list(const std::vector<std::string>& items);
/// A whole page in the style of all reports, without other files.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace scree::cli
