// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/commands.hpp"
#include "cli/diagnose_candidates.hpp"
#include "cli/setting_rows.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace scree::cli {

namespace {

std::string value_text(const EffectParameter& p) {
    if (std::isnan(p.standard)) return "of the soil";
    std::ostringstream text;
    text << p.standard;
    if (std::string(p.unit) != "-") text << " " << p.unit;
    return text.str();
}

/// Text in lines of at most `width`, all but the first indented.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
    std::istringstream words(text);
    std::string result, line(indent, ' ');
    for (std::string word; words >> word;) {
        if (line.size() > indent && line.size() + 1 + word.size() > width) {
            result += line + "\n";
            line.assign(indent, ' ');
        }
        line += (line.size() > indent ? " " : "") + word;
    }
    return (result + line).substr(indent);
}

void print_catalogue(std::ostream& out) {
    out << "Effects beyond the contact law, one [[effect]] each in the site file; scree effects KIND explains one.\n\n"
        << std::left << std::setw(28) << "kind" << std::setw(18) << "takes hold in"
        << "parameters with their defaults\n";
    for (const EffectInfo& info : effect_catalogue()) {
        out << std::setw(28) << info.name << std::setw(18) << kEffectHookNames[static_cast<std::size_t>(info.hook)];
        for (std::size_t k = 0; k < info.parameters.size(); ++k)
            out << (k ? ", " : "") << info.parameters[k].key << " " << value_text(info.parameters[k]);
        out << "\n";
    }
}

std::string place_text(const EffectLimits& limits) {
    std::string text;
    const auto add = [&](bool it, const char* words) {
        if (it) text += (text.empty() ? "" : "; ") + std::string(words);
    };
    add(limits.soil, "soil: on one [[soil]]");
    add(limits.screen, "screen: of one screen");
    add(limits.zone, "file: in polygons");
    add(limits.lines, "file: along lines, required");
    add(limits.points, "file: at points");
    add(limits.zone || limits.lines, "from, to: along the profile of a 2D model");
    return text.empty() ? "everywhere" : text;
}

void print_effect(std::ostream& out, const EffectInfo& info) {
    constexpr std::size_t kIndent = 18, kWidth = 110;
    const auto line = [&](const char* name, const std::string& text) {
        if (!text.empty()) out << std::left << std::setw(kIndent) << name << wrapped(text, kIndent, kWidth) << "\n";
    };
    out << info.name << ": " << info.title << "\n\n";
    line("formula", info.formula);
    line("source", info.source);
    line("takes hold in", kEffectHookNames[static_cast<std::size_t>(info.hook)]);
    line("where", place_text(info.limits));
    line("seen in", info.seen_in);
    line("note", info.note);
    if (info.limits.needs_impact) line("", "Needs model.mode = \"event\".");
    out << "\n";
    for (const EffectParameter& p : info.parameters) {
        line(p.key, value_text(p) + ", " + range_text({p.low, p.high}, "allowed") + ". " + p.meaning +
                        " Source: " + p.source + ".");
    }
    EffectSettings entry{make_effect(info.kind), {}, {}, info.kind == EffectKind::OwnLaw ? "my_law.so" : ""};
    if (info.limits.lines) entry.place.file = "lines.gpkg";
    out << "\n[[effect]]\n" << effect_as_toml(entry, [](const std::string& p) { return p; });
    for (const EffectParameter& p : info.parameters)
        if (std::isnan(p.standard)) out << "# " << p.key << " = ...    of the soil where it is not given\n";
}

}  // namespace

ExitCode run_effects(const Context& context) {
    if (context.target.empty()) {
        print_catalogue(*context.out);
        return ExitCode::Done;
    }
    const auto kind = effect_kind(context.target);
    if (context.target == kThirdDimension)
        throw InputError(
            "third_dimension is no effect of a model but what a profile leaves out, which scree diagnose "
            "looks for in 2D; model.dimension = 3 simulates it");
    if (!kind) throw InputError("there is no effect " + context.target + "; scree effects lists them");
    print_effect(*context.out, effect_info(*kind));
    return ExitCode::Done;
}

}  // namespace scree::cli
