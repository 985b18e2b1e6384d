// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace scree::gis {

/// Text that may stand in an XML attribute or element: markup escaped, control characters that XML forbids replaced by a space.
std::string xml_text(std::string_view text);

/// The shortest decimal text that reads back as the same number, whatever the locale; 17 digits at most.
std::string number_text(double value);

}  // namespace scree::gis
