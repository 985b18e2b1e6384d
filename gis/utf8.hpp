// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace scree::gis {

/// Whether a text is in UTF-8, as all results are.
bool is_utf8(const std::string& text);
/// A text in ISO-8859-1, of which every byte is a character.
std::string utf8_from_latin1(const std::string& text);

/// A to Z in lower case; other letters stay.
std::string lower_case(std::string text);

}  // namespace scree::gis
