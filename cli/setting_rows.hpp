// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/settings.hpp"

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

/// Builders of rows, for the files that hold tables of settings.
namespace scree::cli {

struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_included = true;
};
inline constexpr Range kPositive{0.0, std::numeric_limits<double>::infinity(), false};
inline constexpr Range kNotNegative{0.0};
inline constexpr Range kVolumes{1e-6, 1e6};  ///< of blocks: a pebble, a hill [m^3]

/// "a number from 0 to 1"
std::string range_text(const Range& range, const char* noun);
/// The shortest text that reads back the same, as TOML.
std::string number_text(double value);
std::string quoted(const std::string& text);

/// A value of the site file, or InputError that names place, key, value and what is allowed.
double read_number(const toml::node& node, const std::string& where, const std::string& name, const Range& range);
std::int64_t read_integer(const toml::node& node, const std::string& where, const std::string& name,
                          const Range& range);
std::string read_text(const toml::node& node, const std::string& where, const std::string& name, bool path);
bool read_flag(const toml::node& node, const std::string& where, const std::string& name);
std::vector<std::string> read_texts(const toml::node& node, const std::string& where, const std::string& name);
std::size_t read_choice(const toml::node& node, const std::string& where, const std::string& name,
                        std::span<const char* const> names);
inline constexpr const char* kTextsAllowed = "a list of texts in quotes, [\"...\", \"...\"]";
/// "grid", "tin"
std::string choice_text(std::span<const char* const> names);

/// Builders of table rows. `at` maps settings to the member.
template <class S>
struct Row {
    std::string section;

    template <class Access>
    Setting<S> number(std::string key, std::string unit, Range range, Access at, std::string help) const {
        return {section,
                key,
                unit,
                range_text(range, "a number"),
                help,
                [=, name = section + "." + key](S& s, const toml::node& node, const std::string& where) {
                    at(s) = read_number(node, where, name, range);
                },
                [=](const S& s) { return number_text(at(const_cast<S&>(s))); }};
    }

    template <class Access>
    Setting<S> integer(std::string key, Range range, Access at, std::string help) const {
        return {section,
                key,
                "-",
                range_text(range, "a whole number"),
                help,
                [=, name = section + "." + key](S& s, const toml::node& node, const std::string& where) {
                    at(s) =
                        static_cast<std::remove_reference_t<decltype(at(s))>>(read_integer(node, where, name, range));
                },
                [=](const S& s) { return std::to_string(at(const_cast<S&>(s))); }};
    }

    template <class Access>
    Setting<S> text(std::string key, Access at, std::string help, bool path = false) const {
        return {section,
                key,
                "-",
                path ? "a path in quotes" : "a text in quotes",
                help,
                [=, name = section + "." + key](S& s, const toml::node& node, const std::string& where) {
                    at(s) = read_text(node, where, name, path);
                },
                [=](const S& s) { return quoted(at(const_cast<S&>(s))); },
                path};
    }
    template <class Access>
    Setting<S> path(std::string key, Access at, std::string help) const {
        return text(std::move(key), at, std::move(help), true);
    }

    template <class Access>
    Setting<S> texts(std::string key, Access at, std::string help) const {
        return {section,
                key,
                "-",
                kTextsAllowed,
                help,
                [=, name = section + "." + key](S& s, const toml::node& node, const std::string& where) {
                    at(s) = read_texts(node, where, name);
                },
                [=](const S& s) {
                    std::string list;
                    for (const std::string& entry : at(const_cast<S&>(s)))
                        list += (list.empty() ? "" : ", ") + quoted(entry);
                    return "[" + list + "]";
                }};
    }

    template <class Access>
    Setting<S> flag(std::string key, Access at, std::string help) const {
        return {section,
                key,
                "-",
                "true or false",
                help,
                [=, name = section + "." + key](S& s, const toml::node& node, const std::string& where) {
                    at(s) = read_flag(node, where, name);
                },
                [=](const S& s) { return at(const_cast<S&>(s)) ? "true" : "false"; }};
    }

    template <class Access, std::size_t N>
    Setting<S> choice(std::string key, const std::array<const char*, N>& names, Access at, std::string help) const {
        return {section,
                key,
                "-",
                choice_text(names),
                help,
                [=, name = section + "." + key](S& s, const toml::node& node, const std::string& where) {
                    at(s) =
                        static_cast<std::remove_reference_t<decltype(at(s))>>(read_choice(node, where, name, names));
                },
                [=](const S& s) { return quoted(names[static_cast<std::size_t>(at(const_cast<S&>(s)))]); }};
    }
};

}  // namespace scree::cli
