// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of [[effect]]: those of the place here, those of each kind from the catalogue.
#include "cli/setting_rows.hpp"
#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

namespace {

std::vector<const char*> kind_names() {
    std::vector<const char*> names;
    for (const EffectInfo& info : effect_catalogue()) names.push_back(info.name);
    return names;
}

/// The chainage at one end of the reach, or the station of a net.
Setting<EffectSettings> chainage(const char* key, bool last, const char* help) {
    const auto at = [last](const EffectSettings& s) {
        const auto& reaches = s.effect.place.reaches;
        return !reaches ? kNaN : last ? reaches->front().to : reaches->front().from;
    };
    return {
        "effect",
        key,
        "m",
        range_text(kNotNegative, "a number"),
        help,
        [=, name = std::string("effect.") + key](EffectSettings& s, const toml::node& node, const std::string& where) {
            auto& reaches = s.effect.place.reaches;
            if (!reaches) reaches = std::vector<Stretch>{{0.0, kInfinity}};
            (last ? reaches->front().to : reaches->front().from) = read_number(node, where, name, kNotNegative);
        },
        [=](const EffectSettings& s) { return std::isfinite(at(s)) ? number_text(at(s)) : std::string(); }};
}

Setting<EffectSettings> parameter(const EffectParameter& p, std::size_t index) {
    const Range range{p.low, p.high};
    return {"effect",
            p.key,
            p.unit,
            range_text(range, "a number"),
            std::string(p.meaning) + " Source: " + p.source + ".",
            [=, name = std::string("effect.") + p.key](EffectSettings& s, const toml::node& node,
                                                       const std::string& where) {
                s.effect.values[index] = read_number(node, where, name, range);
            },
            [=](const EffectSettings& s) {
                return std::isnan(s.effect.values[index]) ? std::string() : number_text(s.effect.values[index]);
            }};
}

}  // namespace

std::span<const Setting<EffectSettings>> effect_place_keys() {
    static const std::vector<Setting<EffectSettings>> keys = [] {
        const Row<EffectSettings> effect{"effect"};
        std::vector<Setting<EffectSettings>> k;
        k.push_back({"effect", "kind", "-", "a name of the list", "What acts. Required.",
                     [](EffectSettings& s, const toml::node& node, const std::string& where) {
                         const std::vector<const char*> names = kind_names();
                         const std::string name = read_text(node, where, "effect.kind", false);
                         const auto kind = effect_kind(name);
                         if (!kind)
                             throw InputError(where + ": there is no effect \"" + name +
                                              "\"; scree effects lists them");
                         s.effect = make_effect(*kind);
                     },
                     [](const EffectSettings&) { return std::string(); }});
        k.push_back(effect.text(
            "soil", [](EffectSettings & s) -> auto& { return s.soil; }, "Acts on this [[soil]] only; empty: on all."));
        k.push_back(effect.text(
            "screen", [](EffectSettings & s) -> auto& { return s.effect.place.screen; },
            "Of this screen only; empty: of all."));
        k.push_back(effect.path(
            "file", [](EffectSettings & s) -> auto& { return s.place.file; },
            "Polygons in which it acts; lines of a net or berm; polygons or points of trees."));
        k.push_back(effect.text(
            "layer", [](EffectSettings & s) -> auto& { return s.place.layer; },
            "Layer of that file; empty if it has only one."));
        k.push_back(effect.path(
            "library", [](EffectSettings & s) -> auto& { return s.library; },
            "Shared library of own_law, which needs one: include/scree/own_law.h says how to make it. Its code runs."));
        k.push_back(
            chainage("from", false, "2D: acts from this distance along the profile on; the place of a net or berm."));
        k.push_back(chainage("to", true, "2D: acts up to this distance along the profile."));
        return k;
    }();
    return keys;
}

std::span<const Setting<EffectSettings>> effect_keys(EffectKind kind) {
    static const auto tables = [] {
        std::array<std::vector<Setting<EffectSettings>>, kEffectKinds> all;
        for (const EffectInfo& info : effect_catalogue())
            for (std::size_t k = 0; k < info.parameters.size(); ++k)
                all[static_cast<std::size_t>(info.kind)].push_back(parameter(info.parameters[k], k));
        return all;
    }();
    return tables[static_cast<std::size_t>(kind)];
}

std::string effect_as_toml(const EffectSettings& effect, const std::function<std::string(const std::string&)>& path) {
    std::string text = "kind = " + quoted(effect_info(effect.effect.kind).name) + "\n";
    for (const auto& key : effect_place_keys()) {
        if (key.key == "kind") continue;
        std::string value = key.show(effect);
        const std::string& file = key.key == "library" ? effect.library : effect.place.file;
        if (key.is_path && !file.empty()) value = quoted(path(file));
        if (!value.empty() && value != quoted("")) text += key.key + " = " + value + "\n";
    }
    for (const auto& key : effect_keys(effect.effect.kind)) {
        const std::string value = key.show(effect);
        if (!value.empty()) text += key.key + " = " + value + "\n";
    }
    return text;
}

}  // namespace scree::cli
