// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

/// As few digits as say which number it is; whole ones, an id say, without a fraction or an exponent.
inline std::string shortest(double value) {
    constexpr double kWhole = 9007199254740992.0;  // beyond, not every whole number is one
    if (std::abs(value) <= kWhole && value == std::trunc(value)) return words(static_cast<std::int64_t>(value));
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace scree::gis
