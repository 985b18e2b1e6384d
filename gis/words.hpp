// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <locale>
#include <sstream>
#include <string>

namespace scree::gis {

/// Joins its arguments into one text, numbers with up to ten significant digits: how messages are put together.
template <class... Parts>
std::string words(const Parts&... parts) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(10);
    (out << ... << parts);
    return out.str();
}

/// "1 cell", "2 cells".
inline std::string counted(std::size_t count, const std::string& noun) {
    return words(count, " ", noun, count == 1 ? "" : "s");
}

/// A number with a given count of decimals: fixed(0.6789, 2) is "0.68".
inline std::string fixed(double value, int decimals) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(decimals);
    out << std::fixed << value;
    return out.str();
}

}  // namespace scree::gis
