// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_extended.hpp"

namespace scree::cli {

/// The first has no number.
static std::string numbered(const std::string& name, std::size_t index) {
    return index == 0 ? name : name + "_" + std::to_string(index + 1);
}

std::string zone_name(const DiagnoseStudy& study, std::size_t answer, std::size_t effect) {
    for (std::size_t k = 0; k < answer; ++k) effect += study.answers[k].effects.size();
    return numbered("effect_zone", effect);
}

std::string extended_name(std::size_t answer) {
    return numbered("site_extended", answer) + ".toml";
}

/// The screens stand in a layer of their own, those that were given by their chainage as well.
static void put_in_space(SiteSettings& settings, const std::filesystem::path& results) {
    settings.dimension = 3;
    if (settings.observed.axis == AxisChoice::Automatic) settings.observed.axis = AxisChoice::Profile;
    if (settings.screens.file.empty() && settings.screen_chainages.empty()) return;
    settings.screens.file = results.string();
    settings.screens.layer = kScreensInSpace;
    settings.screens.field = "name";
    settings.screen_chainages.clear();
}

SiteFile extended_site(const DiagnoseStudy& study, std::size_t index, const std::filesystem::path& results) {
    const AnswerFit& answer = study.answers[index];
    SiteFile site = with_changes(study.site, study.keys.changes(answer.model.point));
    for (std::size_t k = 0; k < answer.effects.size(); ++k) {
        const AnsweredEffect& e = answer.effects[k];
        if (e.variant.space) {
            put_in_space(site.settings, results);
            continue;
        }
        EffectSettings entry;
        entry.effect = e.variant.at(e.strength);
        entry.soil = e.variant.soil;
        if (e.variant.on) {
            entry.place.file = results.string();
            entry.place.layer = zone_name(study, index, k);
        }
        site.settings.effects.push_back(std::move(entry));
    }
    return site;
}

}  // namespace scree::cli
