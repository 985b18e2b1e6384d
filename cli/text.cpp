// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/text.hpp"

#include "gis/svg.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace scree::cli {

std::string csv_cell(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

std::string short_number(double value) {
    constexpr double kPlain = 1e7;  // up to here without a power of ten
    std::ostringstream s;
    if (std::abs(value) >= 999.5 && std::abs(value) < kPlain) {
        const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
        s << std::fixed << std::setprecision(0) << std::round(value / unit) * unit;
    } else {
        s << std::setprecision(3) << value;
    }
    return s.str();
}

std::string weight_text(double weight) {
    return weight < 0.001 ? "< 0.001" : gis::axis_number(weight, 0.001);
}

std::string percent(std::int64_t part, std::int64_t whole) {
    return short_number(whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0) + " %";
}

std::string gap_number(double value) {
    if (!std::isfinite(value)) return "-";
    return gis::axis_number(value, value < 9.995 ? 0.01 : value < 99.95 ? 0.1 : 1.0);
}

std::string chance_text(const Gap& gap) {
    return gap_number(gap.chance.low) + " to " + gap_number(gap.chance.high);
}

std::string p_text(double p) {
    if (!std::isfinite(p)) return "-";
    if (!(p > 0.0)) return "0";
    const double digit = p < 0.001 ? std::pow(10.0, std::floor(std::log10(p))) : p < 0.0995 ? 0.001 : 0.01;
    return gis::axis_number(p, digit);
}

std::string padded(std::string text, std::size_t width) {
    const auto letters = static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
    return text.append(width - std::min(width, letters), ' ');
}

std::string shell_word(const std::string& text) {
    static constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+@%";
    if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

std::string listed_few(const std::set<std::string>& names) {
    constexpr std::size_t kListed = 4;
    std::string text;
    std::size_t count = 0;
    for (const std::string& name : names)
        if (++count <= kListed) text += (text.empty() ? "" : ", ") + name;
    return count > kListed ? text + " and " + std::to_string(count - kListed) + " more" : text;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t exchanged = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, exchanged});
        }
    }
    return row[b.size()];
}

}  // namespace scree::cli
