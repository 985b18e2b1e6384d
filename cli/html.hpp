// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_figures.hpp"

#include <string>

namespace scree::cli {

/// Text as it stands in a page.
std::string escaped(const std::string& text);
/// A picture inside a page, with its caption if it has one.
std::string html_figure(const Figure& figure);
/// A whole page in the style of all reports, without other files.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace scree::cli
