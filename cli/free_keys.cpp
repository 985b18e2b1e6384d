// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/free_keys.hpp"

#include "cli/settings.hpp"
#include "cli/text.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace scree::cli {

namespace {

/// Sections whose keys take effect without reading files again.
constexpr std::array<const char*, 5> kFreeSections{"soil", "effect", "blocks", "release", "model"};

/// A key as the tables of settings describe it.
struct KnownKey {
    std::string allowed, unit, value;  ///< value: as it stands, in the first entry if several are meant
    bool is_path = false;
    std::vector<std::string> values;  ///< of all entries that are meant, each once
};

/// One more entry that a key means.
template <class S>
void add_known(const Setting<S>& key, const S& settings, KnownKey& found) {
    const std::string value = key.show(settings);
    if (found.values.empty()) found = {key.allowed, key.unit, value, key.is_path, {}};
    if (std::find(found.values.begin(), found.values.end(), value) == found.values.end()) found.values.push_back(value);
}

/// A number of an [[effect]]; berms are not among them, as they stand in the terrain, nor is what acts on the measurements: they are read once.
bool find_effect_key(const SiteFile& site, const std::string& name, KnownKey& found) {
    const auto last = name.rfind('.');
    const std::string which = last > 7 ? name.substr(7, last - 7) : std::string();
    for (const std::size_t i : entries_meant(which, names_of(site.settings.effects))) {
        const EffectSettings& e = site.settings.effects[i];
        const EffectInfo& info = effect_info(e.effect.kind);
        if (info.hook == EffectHook::Terrain || info.hook == EffectHook::Measurement) continue;
        for (const auto& k : effect_keys(e.effect.kind))
            if (k.key == name.substr(last + 1)) add_known(k, e, found);
    }
    return !found.values.empty();
}

/// False if there is no such key.
bool find_key(const SiteFile& site, const std::string& name, KnownKey& found) {
    if (name.starts_with("effect.")) return find_effect_key(site, name, found);
    if (name.starts_with("soil.")) {
        const auto last = name.rfind('.');
        const std::string soil_name = last > 5 ? name.substr(5, last - 5) : std::string(), key = name.substr(last + 1);
        for (const std::size_t i : entries_meant(soil_name, names_of(site.settings.soils)))
            for (const auto& k : soil_keys())
                if (k.key == key) add_known(k, site.settings.soils[i], found);
        return !found.values.empty();
    }
    for (const auto& k : site_keys())
        if (k.name() == name) add_known(k, site.settings, found);
    return !found.values.empty();
}

/// What a name could have meant: "; write soil.NAME.key, where NAME is one of rock, scree".
std::string there_are(const SiteFile& site, const std::string& name) {
    const bool effect = name.starts_with("effect.");
    if (!effect && !name.starts_with("soil.")) return {};
    std::vector<std::string> names = effect ? names_of(site.settings.effects) : names_of(site.settings.soils);
    if (names.empty()) return "; this site has no [[effect]]";
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return std::string("; write ") + (effect ? "effect" : "soil") + ".NAME.key, where NAME is one of " + listed(names);
}

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
    return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
        end = text.find(separator, begin);
        parts.push_back(trimmed(text.substr(begin, end == std::string::npos ? end : end - begin)));
    }
    return parts;
}

bool read_number(const std::string& text, double& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

std::string unquoted(const std::string& text) {
    return text.size() >= 2 && (text.front() == '"' || text.front() == '\'') ? text.substr(1, text.size() - 2) : text;
}

/// A choice as TOML: flags as they are, names in quotes.
std::string choice_text(const std::string& level) {
    return level == "true" || level == "false" ? level : "\"" + level + "\"";
}

class Reader {
public:
    Reader(const SiteFile& site, std::string entry) : site_(site), entry_(std::move(entry)) {}

    void read(FreeKeys& keys) const {
        const auto equals = entry_.find('=');
        if (equals == std::string::npos) refuse("is not of the form KEY=LOW:HIGH or KEY=A,B,C");
        const std::string name = trimmed(entry_.substr(0, equals)), text = trimmed(entry_.substr(equals + 1));
        const std::string section = name.substr(0, name.find('.'));
        KnownKey key;
        if (!find_key(site_, name, key))
            refuse(
                "names no key of this site that can be freed (scree settings lists all; berms and effects on "
                "measurements cannot be calibrated)" +
                there_are(site_, name));
        const bool may = std::find(kFreeSections.begin(), kFreeSections.end(), section) != kFreeSections.end();
        const bool number = key.allowed.starts_with("a number") || key.allowed.starts_with("a whole number");
        const bool choice = key.allowed.starts_with("\"") || key.allowed == "true or false";
        if (!may || key.is_path || (!number && !choice) || name == "model.seed" || name == "model.dimension" ||
            name == "release.count" || name == "release.pattern")
            refuse(
                "names a key that cannot be calibrated: take numbers and choices of [[soil]], [[effect]], [blocks], "
                "[release] and [model], but for release.count, release.pattern, model.seed and model.dimension");
        for (const auto& p : keys.problem.parameters) refuse_twice(name, p.name);
        for (const auto& c : keys.problem.choices) refuse_twice(name, c.name);
        number ? add_parameter(keys, name, key, text) : add_choice(keys, name, key, text);
    }

private:
    [[noreturn]] void refuse(const std::string& what) const {
        throw InputError("free parameter \"" + entry_ + "\" " + what);
    }

    /// Names that mean one key of one entry: "soil.a|b.rolling" and "soil.*.rolling".
    void refuse_twice(const std::string& name, const std::string& other) const {
        const auto part = [](const std::string& key) { return key.substr(key.rfind('.') + 1); };
        const auto which = [](const std::string& key) {
            const auto begin = key.find('.') + 1, end = key.rfind('.');
            return end > begin ? key.substr(begin, end - begin) : std::string();
        };
        bool both = name == other;
        if (part(name) == part(other) && name.substr(0, 5) == other.substr(0, 5)) {
            const std::vector<std::string> names = name.starts_with("soil.")     ? names_of(site_.settings.soils)
                                                   : name.starts_with("effect.") ? names_of(site_.settings.effects)
                                                                                 : std::vector<std::string>();
            const std::vector<std::size_t> one = entries_meant(which(name), names),
                                           two = entries_meant(which(other), names);
            both = both || std::find_first_of(one.begin(), one.end(), two.begin(), two.end()) != one.end();
        }
        if (both) refuse("frees " + (name == other ? name : "what " + other + " frees") + " a second time");
    }

    void add_parameter(FreeKeys& keys, const std::string& name, const KnownKey& key, const std::string& text) const {
        const std::vector<std::string> parts = split(text, ':');
        CalibrationParameter p;
        p.name = name;
        if (parts.size() < 2 || parts.size() > 3 || (parts.size() == 3 && parts[2] != "log") ||
            !read_number(parts[0], p.low) || !read_number(parts[1], p.high))
            refuse("needs a range, " + name + "=LOW:HIGH or " + name + "=LOW:HIGH:log");
        p.logarithmic = parts.size() == 3;
        if (!(p.low < p.high)) refuse("has an empty range: LOW must be below HIGH");
        if (p.logarithmic && p.low <= 0.0) refuse("is searched by ratios: its range must begin above 0");
        double least = kInfinity, most = -kInfinity;
        keys.given.emplace_back();
        for (const std::string& value : key.values) {
            double given = 0.0;
            if (!read_number(value, given)) continue;  // not set
            if (given < p.low || given > p.high)
                refuse("does not contain the value of the site, " + value +
                       ": widen the range, or change the value with --set");
            least = std::min(least, given);
            most = std::max(most, given);
            keys.given.back() += (keys.given.back().empty() ? "" : ", ") + value;
        }
        if (least == most)
            p.start = least;
        else if (least < most)
            p.start = p.logarithmic ? std::sqrt(least * most) : 0.5 * (least + most);
        keys.uneven.push_back(least < most);
        keys.problem.parameters.push_back(p);
        keys.units.push_back(key.unit);
        keys.whole.push_back(key.allowed.starts_with("a whole number"));
        for (const double end : {p.low, p.high})  // the table of settings knows what is allowed
            with_changes(site_, {name + "=" + keys.text(keys.units.size() - 1, end)});
    }

    void add_choice(FreeKeys& keys, const std::string& name, const KnownKey& key, const std::string& text) const {
        CalibrationChoice choice;
        choice.name = name;
        choice.levels = split(text, ',');
        if (choice.levels.size() < 2)
            refuse("needs at least two choices, " + name + "=A,B; allowed are " + key.allowed);
        for (const std::string& level : choice.levels) {
            if (std::count(choice.levels.begin(), choice.levels.end(), level) > 1) refuse("names " + level + " twice");
            if (name == "blocks.shape" && level == "file" && unquoted(key.value) != "file")
                refuse("cannot try the shape file: it would have to be that of the site");
            with_changes(site_, {name + "=" + choice_text(level)});
        }
        const auto own = std::find(choice.levels.begin(), choice.levels.end(), unquoted(key.value));
        if (own == choice.levels.end())
            refuse("does not contain the choice of the site, " + key.value + ": add it, or change it with --set");
        choice.start = static_cast<std::size_t>(own - choice.levels.begin());
        keys.problem.choices.push_back(std::move(choice));
    }

    const SiteFile& site_;
    std::string entry_;
};

}  // namespace

namespace {

/// Keys of which one must not exceed the other, wherever a search goes: with the first at its highest and the second at its lowest the site must still be one,
/// whatever law its blocks follow (some orders hold for one law only).
void require_ordered(const SiteFile& site, const FreeKeys& keys) {
    static constexpr std::array<std::array<const char*, 2>, 7> kOrdered{
        {{"blocks.volume_min", "blocks.volume_max"},
         {"blocks.volume_min", "blocks.volume"},
         {"blocks.volume", "blocks.volume_max"},
         {"blocks.density_spread", "blocks.density"},
         {"blocks.ratio_21_min", "blocks.ratio_21_max"},
         {"blocks.ratio_32_min", "blocks.ratio_32_max"},
         {"model.activation_gap", "model.release_gap"}}};
    std::vector<std::string> laws{""};
    for (const CalibrationChoice& c : keys.problem.choices)
        if (c.name == "blocks.volume_law") laws = c.levels;
    for (const auto& pair : kOrdered) {
        std::vector<std::string> changes;
        for (std::size_t i = 0; i < keys.problem.parameters.size(); ++i) {
            const CalibrationParameter& p = keys.problem.parameters[i];
            if (p.name == pair[0]) changes.push_back(p.name + "=" + keys.text(i, p.high));
            if (p.name == pair[1]) changes.push_back(p.name + "=" + keys.text(i, p.low));
        }
        for (const std::string& law : laws) {
            std::vector<std::string> with_law = changes;
            if (!law.empty()) with_law.push_back("blocks.volume_law=" + choice_text(law));
            try {
                with_changes(site, with_law);
            } catch (const InputError& e) {
                throw InputError(std::string("the ranges of the free parameters overlap: ") + e.what());
            }
        }
    }
}

}  // namespace

std::string FreeKeys::text(std::size_t i, double value) const {
    if (is_whole(i)) return std::to_string(std::llround(value));
    char buffer[32];
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};  // the shortest that reads back the same
}

std::vector<std::string> FreeKeys::changes(const CalibrationPoint& point) const {
    std::vector<std::string> list;
    for (std::size_t i = 0; i < point.values.size(); ++i) {
        const CalibrationParameter& p = problem.parameters[i];
        constexpr double kSame = 1e-12;  // of the range
        if (i < uneven.size() && uneven[i] && std::abs(point.values[i] - p.start) <= kSame * (p.high - p.low)) continue;
        list.push_back(p.name + "=" + text(i, point.values[i]));
    }
    for (std::size_t i = 0; i < point.levels.size(); ++i)
        list.push_back(problem.choices[i].name + "=" + choice_text(problem.choices[i].levels[point.levels[i]]));
    return list;
}

FreeKeys read_free_keys(const SiteFile& site, const std::vector<std::string>& entries) {
    if (entries.empty())
        throw InputError(site.file.string() +
                         ": nothing is free to be calibrated: give --free KEY=LOW:HIGH, or free = [\"KEY=LOW:HIGH\"] "
                         "in [calibration]; "
                         "for example --free \"soil." +
                         site.settings.soils.front().name + ".rolling=0.01:0.1\"");
    FreeKeys keys;
    for (const std::string& entry : entries) Reader(site, entry).read(keys);
    require_ordered(site, keys);
    return keys;
}

std::string value_of_key(const SiteFile& site, const std::string& key) {
    KnownKey found;
    return find_key(site, key, found) ? unquoted(found.value) : std::string();
}

}  // namespace scree::cli
