// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_settings.hpp"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace toml {
inline namespace v3 {
class node;
}
}  // namespace toml

namespace scree::cli {

/// One key of the site file: the only place that says what it is called, what it means and what is allowed. The reader, the reference manual and
/// run.toml follow from it.
template <class Settings>
struct Setting {
    std::string section;  ///< "terrain"
    std::string key;      ///< "resolution"
    std::string unit;     ///< "m", "-"
    std::string allowed;  ///< in words: "0 to 1", "grid, tin"
    std::string help;     ///< what it is and what changing it does
    std::function<void(Settings&, const toml::node&, const std::string& where)> read;  ///< throws InputError
    std::function<std::string(const Settings&)> show;                                  ///< the value as TOML
    bool is_path = false;  ///< a file or folder, relative to the site file

    std::string name() const { return section + "." + key; }
};

/// Every key but those of [[soil]], in the order of the manual.
std::span<const Setting<SiteSettings>> site_keys();
/// The keys of one [[soil]].
std::span<const Setting<Soil>> soil_keys();
/// The keys of an [[effect]] that say where it acts, `kind` first.
std::span<const Setting<EffectSettings>> effect_place_keys();
/// The parameters of one kind of effect, from the catalogue. An unset value shows as an empty text.
std::span<const Setting<EffectSettings>> effect_keys(EffectKind kind);
/// The keys of one [[effect]] that are given or differ from nothing; `path` rewrites paths.
std::string effect_as_toml(const EffectSettings& effect, const std::function<std::string(const std::string&)>& path);
/// One sentence per section.
std::string section_help(const std::string& section);

/// The effective settings as a site file. `path` rewrites paths (to make them relative to another folder).
std::string settings_as_toml(const SiteSettings& settings, const std::function<std::string(const std::string&)>& path);

/// The reference manual of all keys, as Markdown.
std::string settings_manual();

}  // namespace scree::cli
