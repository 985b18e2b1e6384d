// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/site_file.hpp"

#include "cli/settings.hpp"
#include "cli/text.hpp"
#include "scree/base/error.hpp"
#include "scree/base/units.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

namespace scree::cli {

namespace {

std::string read_text(const std::filesystem::path& file) {
    if (std::filesystem::is_directory(file))
        throw InputError(file.string() + " is a folder: give the site file in it, " + (file / "site.toml").string());
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw InputError("site file " + file.string() +
                         " cannot be read: check the path, or write a new one with scree init FOLDER");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Names with very many dots would take the parser deeper than its stack.
void require_shallow(const std::string& text, const std::string& name) {
    constexpr std::ptrdiff_t kMostDots = 100;
    std::istringstream lines(text);
    std::string line;
    for (std::size_t number = 1; std::getline(lines, line); ++number)
        if (const auto end =
                line.begin() + static_cast<std::ptrdiff_t>(std::min(line.find_first_of("=\"'#"), line.size()));
            std::count(line.begin(), end, '.') > kMostDots)
            throw InputError(name + ":" + std::to_string(number) +
                             ": a name of more than a hundred parts is no key of a site file: see scree settings");
}

toml::table parse(const std::string& text, const std::string& name) {
    require_shallow(text, name);
    try {
        return toml::parse(text, name);
    } catch (const toml::parse_error& e) {
        std::ostringstream message;
        message << name << ":" << e.source().begin.line << ":" << e.source().begin.column
                << ": not valid TOML (UTF-8): " << e.description();
        const std::string_view said = e.description();  // C:\data\dtm.tif
        if (said.find("escape sequence") != said.npos || said.find("unicode scalar") != said.npos)
            message
                << "; in double quotes a backslash begins a special character: write paths with /, or in single quotes";
        throw InputError(message.str());
    }
}

[[noreturn]] void unknown_section(const std::string& where, const std::string& name) {
    std::string known, best;
    std::size_t distance = 1000;
    auto consider = [&](const std::string& section) {
        known += (known.empty() ? "" : ", ") + section;
        if (edit_distance(section, name) >= distance) return;
        distance = edit_distance(section, name);
        best = section;
    };
    for (std::string last = "soil"; const auto& key : site_keys()) {
        if (key.section != last) consider(key.section);
        last = key.section;
    }
    consider("soil");
    consider("effect");
    throw InputError(where + ": the section [" + name + "] is unknown; " +
                     (distance <= 2 ? "did you mean [" + best + "]?" : "there are " + known) +
                     " (scree settings lists all keys)");
}

[[noreturn]] void unknown_key(const std::string& where, const std::string& name) {
    std::string best, section = name.substr(0, name.find('.'));
    std::size_t distance = 1000;
    std::string siblings;
    for (const auto& key : site_keys()) {
        if (edit_distance(key.name(), name) < distance) {
            distance = edit_distance(key.name(), name);
            best = key.name();
        }
        if (key.section == section) siblings += (siblings.empty() ? "" : ", ") + key.key;
    }
    std::string hint = distance <= 3      ? "; did you mean " + best + "?"
                       : siblings.empty() ? ""
                                          : "; [" + section + "] knows " + siblings;
    throw InputError(where + ": the key " + name + " is unknown" + hint + " (scree settings lists all keys)");
}

std::string location(const std::string& file, const toml::node& node) {
    return node.source().begin ? file + ":" + std::to_string(node.source().begin.line) : file + " (--set)";
}

void read_soils(const toml::node& node, const std::string& file, std::vector<Soil>& soils) {
    const toml::array* list = node.as_array();
    if (!list || list->empty() || !list->is_array_of_tables())
        throw InputError(location(file, node) + ": soil must be a list of tables: begin each soil with [[soil]]");
    for (const toml::node& entry : *list) {
        Soil soil;
        const std::string called = (*entry.as_table())["name"].value_or(std::string());
        const auto where = [&](const toml::node& at) {
            return location(file, at) + (called.empty() ? "" : ", soil \"" + called + "\"");
        };
        for (const auto& [key, value] : *entry.as_table()) {
            const std::string name(key.str());
            const auto known =
                std::find_if(soil_keys().begin(), soil_keys().end(), [&](const auto& k) { return k.key == name; });
            if (known == soil_keys().end())
                throw InputError(where(value) + ": [[soil]] has no key " + name +
                                 "; it knows name, restitution, friction, rolling");
            known->read(soil, value, where(value));
        }
        if (soil.name.empty())
            throw InputError(location(file, entry) + ": a [[soil]] has no name: zones refer to soils by name");
        if (std::any_of(soils.begin(), soils.end(), [&](const Soil& s) { return s.name == soil.name; }))
            throw InputError(location(file, entry) + ": two soils are called \"" + soil.name + "\": names must differ");
        soils.push_back(soil);
    }
    if (soils.size() > static_cast<std::size_t>(kMaxSoils))
        throw InputError(location(file, node) + ": " + std::to_string(soils.size()) + " soils; at most " +
                         std::to_string(kMaxSoils) + " are possible");
}

/// The keys of one [[effect]], `kind` first because it says which others there are.
EffectSettings read_effect(const toml::table& table, const std::string& file) {
    EffectSettings effect;
    const toml::node* kind = table.get("kind");
    if (!kind) throw InputError(location(file, table) + ": an [[effect]] has no kind: scree effects lists the kinds");
    effect_place_keys().front().read(effect, *kind, location(file, *kind));
    const EffectInfo& info = effect_info(effect.effect.kind);
    const auto find = [](auto keys, const std::string& name) {
        const auto found = std::find_if(keys.begin(), keys.end(), [&](const auto& k) { return k.key == name; });
        return found == keys.end() ? nullptr : &*found;
    };
    for (const auto& [key, value] : table) {
        const std::string name(key.str());
        if (name == "kind") continue;
        const auto* known = find(effect_keys(info.kind), name);
        if (!known) known = find(effect_place_keys(), name);
        if (!known) {
            std::string names;
            for (const auto& k : effect_keys(info.kind)) names += (names.empty() ? "" : ", ") + k.key;
            throw InputError(location(file, value) + ": effect " + info.name + " has no key " + name + "; it knows " +
                             names + " and where it acts (scree effects " + info.name + ")");
        }
        known->read(effect, value, location(file, value));
    }
    return effect;
}

void read_effects(const toml::node& node, const std::string& file, std::vector<EffectSettings>& effects) {
    const toml::array* list = node.as_array();
    if (!list || list->empty() || !list->is_array_of_tables())
        throw InputError(location(file, node) + ": effect must be a list of tables: begin each with [[effect]]");
    for (const toml::node& entry : *list) effects.push_back(read_effect(*entry.as_table(), file));
}

/// The value of a change as TOML; what is no TOML is a text.
toml::table changed_value(const std::string& text) {
    if (text.find_first_of("\n\r") != std::string::npos)
        throw InputError("--set: a value is one line, not \"" + text + "\"; give each change a --set of its own");
    try {
        return toml::parse("value = " + text);
    } catch (const toml::parse_error&) {
        return toml::table{{"value", text}};
    }
}

/// Puts `--set section.key=value` into the table as if it stood in the file.
void apply_change(toml::table& table, const std::string& change) {
    const auto equals = change.find('=');
    const auto dot = change.find('.');
    if (equals == std::string::npos || dot == std::string::npos || dot > equals)
        throw InputError("--set " + change + " is not of the form section.key=value, such as terrain.resolution=2");
    const std::string section = change.substr(0, dot), text = change.substr(equals + 1);
    std::string key = change.substr(dot + 1, equals - dot - 1);
    const toml::table holder = changed_value(text);
    const toml::node& value = *holder.get("value");
    std::vector<toml::table*> targets;
    if (section == "soil" || section == "effect") {
        const char* name = section == "soil" ? "name" : "kind";
        const auto last = key.rfind('.');
        if (last == std::string::npos)
            throw InputError("--set " + change + ": say which " + section + ", " + section + "." +
                             (section == "soil" ? "NAME." : "KIND.") + key + "=" + text);
        const std::string which = key.substr(0, last);
        key = key.substr(last + 1);
        toml::array* list = table[section].as_array();
        std::vector<std::string> names_there;
        for (std::size_t i = 0; list && i < list->size(); ++i) {
            const toml::table* entry = (*list)[i].as_table();
            names_there.push_back(entry ? (*entry)[name].value_or(std::string()) : std::string());
        }
        for (const std::size_t i : entries_meant(which, names_there))
            if (toml::table* entry = (*list)[i].as_table()) targets.push_back(entry);
        if (targets.empty()) {
            std::string names;
            for (std::size_t i = 0; list && i < list->size(); ++i)
                if (const toml::table* entry = (*list)[i].as_table())
                    names += (names.empty() ? "\"" : ", \"") + (*entry)[name].value_or(std::string()) + "\"";
            throw InputError("--set " + change + ": there is no [[" + section + "]] called \"" + which +
                             "\" in the site file, " + (names.empty() ? "which has none" : "only " + names));
        }
    } else {
        if (!table.contains(section)) table.insert_or_assign(section, toml::table{});
        targets.push_back(table[section].as_table());
        if (!targets.back()) throw InputError("--set " + change + ": " + section + " is not a table in the site file");
    }
    for (toml::table* target : targets) value.visit([&](const auto& v) { target->insert_or_assign(key, v); });
}

void require(bool condition, const std::string& message) {
    if (!condition) throw InputError(message);
}

/// What a single key cannot know.
void check_together(const SiteFile& site) {
    const SiteSettings& s = site.settings;
    const std::string file = site.file.string();
    std::string missing;
    if (s.dtm.empty()) missing += " terrain.dtm";
    if (s.release.file.empty()) missing += " release.file";
    if (s.soils.empty()) missing += " [[soil]]";
    require(missing.empty(),
            file + ": required keys are missing:" + missing + " (scree init FOLDER writes a commented example)");
    auto ordered = [&](double low, double high, const char* a, const char* b) {
        std::ostringstream values;
        values << a << " = " << low << " is larger than " << b << " = " << high;
        require(low <= high, file + ": " + values.str() + ": set one of them otherwise");
    };
    ordered(s.distribution.volume_min, s.distribution.volume_max, "blocks.volume_min", "blocks.volume_max");
    if (s.distribution.law == VolumeLaw::LogNormal) {  // which draws again what lies beyond the ends
        ordered(s.distribution.volume_min, s.distribution.volume, "blocks.volume_min", "blocks.volume, the median,");
        ordered(s.distribution.volume, s.distribution.volume_max, "blocks.volume, the median,", "blocks.volume_max");
    }
    ordered(s.distribution.density_spread, 0.9 * s.distribution.density, "blocks.density_spread",
            "nine tenths of blocks.density");
    ordered(s.distribution.ratio_21[0], s.distribution.ratio_21[1], "blocks.ratio_21_min", "blocks.ratio_21_max");
    ordered(s.distribution.ratio_32[0], s.distribution.ratio_32[1], "blocks.ratio_32_min", "blocks.ratio_32_max");
    ordered(s.dynamics.activation_gap, s.dynamics.release_gap, "model.activation_gap", "model.release_gap");
    require(s.shape != BlockShape::File || !s.shape_file.empty(),
            file + ": blocks.shape = \"file\" needs blocks.shape_file");
    require(s.profile_mode == ProfileMode::Steepest || !s.profile_guide.file.empty(),
            file + ": profile.mode = \"" + kProfileModeNames[static_cast<std::size_t>(s.profile_mode)] +
                "\" needs profile.guide, a file of lines");
    require(s.observed.axis != AxisChoice::Line || !s.observed.line.file.empty(),
            file + ": observed.axis = \"line\" needs observed.line_file");
    if (!s.default_soil.empty()) {
        std::string names;
        bool found = false;
        for (const Soil& soil : s.soils) {
            found = found || soil.name == s.default_soil;
            names += (names.empty() ? "\"" : ", \"") + soil.name + "\"";
        }
        require(found, file + ": zones.default = \"" + s.default_soil + "\" is no [[soil]]; there are " + names);
    }
}

}  // namespace

std::optional<GdalName> SiteFile::gdal_name(const std::string& path) const {
    namespace fs = std::filesystem;
    std::error_code ignored;
    for (const char* archive : {"/vsizip/", "/vsitar/", "/vsigzip/", "/vsi7z/", "/vsirar/"}) {
        const std::string_view inner =
            path.starts_with(archive) ? std::string_view(path).substr(std::strlen(archive)) : "";
        const bool braced = inner.starts_with('{');
        if (inner.empty() || inner.starts_with("vsi") || inner.starts_with("/vsi")) continue;
        const std::size_t from = std::strlen(archive) + braced,
                          to = braced ? std::min(path.find('}'), path.size()) : path.size();
        return GdalName{path.substr(0, from), path.substr(from, to - from), path.substr(to)};
    }
    if (path.starts_with("/vsi")) return GdalName{path, "", ""};
    if (path.find(':') == std::string::npos || fs::exists(folder / path, ignored)) return std::nullopt;
    // DRIVER:FILE:PART, DRIVER:"FILE":PART, GTIFF_DIR:2:FILE
    for (std::size_t colon = path.find(':'); colon != std::string::npos; colon = path.find(':', colon + 1)) {
        const std::size_t from = colon + 1 + (path.compare(colon + 1, 1, "\"") == 0);
        const std::size_t to = std::min(path.find_first_of(":\"", from), path.size());
        const std::string inner = path.substr(from, to - from);
        // what is a file of the working directory alone is one that is missing, and not another site's
        if (!inner.empty() && (fs::is_regular_file(beside(inner), ignored) || fs::is_regular_file(inner, ignored)))
            return GdalName{path.substr(0, from), inner, path.substr(to)};
    }
    return GdalName{path, "", ""};
}

std::filesystem::path SiteFile::resolve(const std::string& path) const {
    const std::optional<GdalName> name = gdal_name(path);
    if (!name) return beside(path);
    return name->path.empty() ? path : name->with(beside(name->path).string());
}

std::filesystem::path SiteFile::beside(const std::string& path) const {
    namespace fs = std::filesystem;
    const fs::path p(path), joined = folder / p, plain = joined.lexically_normal();
    std::error_code ignored;
    if (p.is_absolute()) return p;
    // where a link stands before "..", the way through it leads elsewhere
    return fs::weakly_canonical(joined, ignored) == fs::weakly_canonical(plain, ignored) ? plain : joined;
}

SiteFile read_site_file(const std::filesystem::path& file, const std::vector<std::string>& changes) {
    SiteFile site;
    site.file = file;
    site.folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
    const std::string name = file.string();
    toml::table table = parse(read_text(file), name);
    for (const std::string& change : changes) apply_change(table, change);

    for (const auto& [section, node] : table) {
        const std::string section_name(section.str());
        if (section_name == "soil") {
            read_soils(node, name, site.settings.soils);
            continue;
        }
        if (section_name == "effect") {
            read_effects(node, name, site.settings.effects);
            continue;
        }
        const toml::table* keys = node.as_table();
        if (section_help(section_name).empty()) unknown_section(location(name, node), section_name);
        if (!keys)
            throw InputError(location(name, node) + ": " + section_name + " must be a table: begin it with [" +
                             section_name + "]");
        for (const auto& [key, value] : *keys) {
            const std::string key_name = section_name + "." + std::string(key.str());
            const auto known = std::find_if(site_keys().begin(), site_keys().end(),
                                            [&](const auto& k) { return k.name() == key_name; });
            if (known == site_keys().end()) unknown_key(location(name, value), key_name);
            known->read(site.settings, value, location(name, value));
        }
    }
    check_together(site);
    return site;
}

std::vector<std::size_t> entries_meant(std::string_view which, const std::vector<std::string>& names) {
    const auto means = [&](std::string_view one, std::size_t number) {
        if (one == "*" || one == names[number]) return true;
        return one == std::to_string(number) && std::find(names.begin(), names.end(), one) == names.end();
    };
    std::set<std::size_t> meant;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (which == names[i]) meant.insert(i);  // which may have a | in it
    for (std::string_view rest = which; meant.empty() || rest.size() < which.size();) {
        const auto bar = rest.find('|');
        bool any = false;
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (!means(rest.substr(0, bar), i)) continue;
            any = true;
            meant.insert(i);
        }
        if (!any) return {};  // the others alone are not what is wanted
        if (bar == std::string_view::npos) break;
        rest.remove_prefix(bar + 1);
    }
    return {meant.begin(), meant.end()};
}

std::vector<std::string> names_of(const std::vector<Soil>& soils) {
    std::vector<std::string> names;
    for (const Soil& soil : soils) names.push_back(soil.name);
    return names;
}

std::vector<std::string> names_of(const std::vector<EffectSettings>& effects) {
    std::vector<std::string> names;
    for (const EffectSettings& e : effects) names.emplace_back(effect_info(e.effect.kind).name);
    return names;
}

SiteFile with_changes(SiteFile site, const std::vector<std::string>& changes) {
    const std::string where = site.file.string() + " (changed)";
    for (const std::string& change : changes) {
        const auto equals = change.find('=');
        const std::string name = change.substr(0, equals);
        const toml::table holder =
            changed_value(equals == std::string::npos ? std::string() : change.substr(equals + 1));
        const toml::node& value = *holder.get("value");
        const auto begin = name.find('.'), last = name.rfind('.');
        const std::string section = name.substr(0, begin), key = name.substr(last + 1),
                          which = last > begin ? name.substr(begin + 1, last - begin - 1) : std::string();
        SiteSettings& settings = site.settings;
        bool meant = false;
        const auto read = [&](const auto& rows, auto& entry) {
            const auto row = std::find_if(rows.begin(), rows.end(), [&](const auto& k) { return k.key == key; });
            if (row == rows.end()) unknown_key(where, name);
            row->read(entry, value, where);
            meant = true;
        };
        if (section == "soil") {
            for (const std::size_t i : entries_meant(which, names_of(settings.soils)))
                read(soil_keys(), settings.soils[i]);
        } else if (section == "effect") {
            for (const std::size_t i : entries_meant(which, names_of(settings.effects)))
                read(effect_keys(settings.effects[i].effect.kind), settings.effects[i]);
        } else {
            for (const auto& row : site_keys())
                if (row.name() == name) {
                    row.read(settings, value, where);
                    meant = true;
                }
        }
        if (!meant) unknown_key(where, name);
    }
    check_together(site);
    return site;
}

}  // namespace scree::cli
