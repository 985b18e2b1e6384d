// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/setting_rows.hpp"

#include "scree/base/error.hpp"

#include <toml++/toml.h>

#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace scree::cli {

std::string number_text(double value) {
    if (value == std::floor(value) && std::abs(value) < 1e15) {
        std::ostringstream s;
        s.precision(17);
        s << value;
        const std::string text = s.str();
        return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
    }
    char buffer[32];
    const auto end =
        std::to_chars(buffer, buffer + sizeof buffer, value).ptr;  // shortest text that reads back the same
    return {buffer, end};
}

namespace {

std::string bound_text(double value) {
    std::ostringstream s;
    s.precision(6);
    constexpr double kMostDigits = 1e16;  // beyond, not every digit is known
    if (value == std::floor(value) && std::abs(value) < kMostDigits) s << std::fixed << std::setprecision(0);
    s << value;
    return s.str();
}

std::string node_text(const toml::node& node) {
    std::ostringstream s;
    node.visit([&](const auto& n) {
        if constexpr (toml::is_floating_point<decltype(n)>)
            s << number_text(*n);
        else if constexpr (toml::is_value<decltype(n)>)
            s << n;
        else
            s << "a table or list";
    });
    return s.str();
}

[[noreturn]] void refuse(const std::string& where, const std::string& name, const toml::node& node,
                         const std::string& allowed) {
    throw InputError(where + ": " + name + " = " + node_text(node) + " is not allowed: give " + allowed);
}

}  // namespace

std::string quoted(const std::string& text) {
    std::ostringstream s;
    s << toml::value<std::string>(text);
    return s.str();
}

std::string range_text(const Range& r, const char* noun) {
    const bool below = std::isfinite(r.low), above = std::isfinite(r.high);
    std::string text = noun;
    if (below && above)
        return text + " from " + bound_text(r.low) + (r.low_included ? "" : " (excluded)") + " to " +
               bound_text(r.high);
    if (below) return text + (r.low_included ? " of at least " : " above ") + bound_text(r.low);
    if (above) return text + " of at most " + bound_text(r.high);
    return text;
}

std::string choice_text(std::span<const char* const> names) {
    std::string text;
    for (const char* name : names) text += (text.empty() ? "" : ", ") + std::string("\"") + name + "\"";
    return text;
}

double read_number(const toml::node& node, const std::string& where, const std::string& name, const Range& range) {
    const auto value = node.value<double>();
    if (!value || !node.is_number() || !std::isfinite(*value) || *value > range.high || *value < range.low ||
        (!range.low_included && *value == range.low))
        refuse(where, name, node, range_text(range, "a number"));
    return *value;
}

std::int64_t read_integer(const toml::node& node, const std::string& where, const std::string& name,
                          const Range& range) {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || static_cast<double>(*value) < range.low || static_cast<double>(*value) > range.high)
        refuse(where, name, node, range_text(range, "a whole number"));
    return *value;
}

std::string read_text(const toml::node& node, const std::string& where, const std::string& name, bool path) {
    const auto value = node.value_exact<std::string>();
    if (!value) refuse(where, name, node, path ? "a path in quotes" : "a text in quotes");
    return *value;
}

bool read_flag(const toml::node& node, const std::string& where, const std::string& name) {
    const auto value = node.value_exact<bool>();
    if (!value) refuse(where, name, node, "true or false");
    return *value;
}

std::vector<std::string> read_texts(const toml::node& node, const std::string& where, const std::string& name) {
    const toml::array* list = node.as_array();
    if (!list) refuse(where, name, node, kTextsAllowed);
    std::vector<std::string> texts;
    for (const toml::node& entry : *list) {
        const auto value = entry.value_exact<std::string>();
        if (!value) refuse(where, name, entry, kTextsAllowed);
        texts.push_back(*value);
    }
    return texts;
}

std::size_t read_choice(const toml::node& node, const std::string& where, const std::string& name,
                        std::span<const char* const> names) {
    const auto value = node.value_exact<std::string>();
    for (std::size_t k = 0; k < names.size(); ++k)
        if (value && *value == names[k]) return k;
    refuse(where, name, node, "one of " + choice_text(names));
}

}  // namespace scree::cli
