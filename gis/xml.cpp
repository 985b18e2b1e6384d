// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/xml.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace scree::gis {

std::string xml_text(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            // as references: a parser turns them into spaces in attributes otherwise
            case '\n':
                out += "&#10;";
                break;
            case '\t':
                out += "&#9;";
                break;
            default:
                out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return out;
}

std::string number_text(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    std::array<char, 32> buffer{};
    // plain notation for what people read (1000000, 0.0001), exponents beyond
    const double size = std::abs(value);
    const auto format =
        size == 0 || (size >= 1e-5 && size < 1e10) ? std::chars_format::fixed : std::chars_format::general;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format);
    return {buffer.data(), end.ptr};
}

}  // namespace scree::gis
