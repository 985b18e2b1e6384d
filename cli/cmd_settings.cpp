// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/commands.hpp"
#include "cli/settings.hpp"

#include <ostream>

namespace scree::cli {

ExitCode run_settings(const Context& context) {
    if (context.format == "toml") {
        SiteSettings defaults;
        defaults.dtm = "data/dtm.tif";
        defaults.release.file = "data/release.gpkg";
        defaults.soils.push_back({.name = "ground"});
        *context.out << "# All keys with their defaults. Three you must set yourself: terrain.dtm, release.file and "
                        "[[soil]].\n"
                        "# What each means, its unit and its range: scree settings\n\n"
                     << settings_as_toml(defaults, [](const std::string& path) { return path; });
    } else {
        *context.out << settings_manual();
    }
    return ExitCode::Done;
}

}  // namespace scree::cli
