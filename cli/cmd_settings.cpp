// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/commands.hpp"
#include "cli/settings.hpp"

#include <ostream>

namespace scree::cli {

ExitCode run_settings(const Context& context) {
    if (context.format == "toml") {
        SiteSettings defaults;
        defaults.soils.emplace_back();
        *context.out << settings_as_toml(defaults, [](const std::string& path) { return path; });
    } else {
        *context.out << settings_manual();
    }
    return ExitCode::Done;
}

}  // namespace scree::cli
