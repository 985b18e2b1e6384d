// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_file.hpp"
#include "gis/results_folder.hpp"
#include "scree/base/error.hpp"

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace scree::cli {

enum class ProgressStyle { Automatic, Json };

/// What a command was given and where it writes.
struct Context {
    std::string target;                ///< site file, folder for init, or kind for effects
    std::vector<std::string> changes;  ///< --set key=value
    std::string output;                ///< --output; empty: as the site file says
    bool overwrite = false;
    int threads = 0;  ///< 0: all cores
    bool quiet = false;
    ProgressStyle progress = ProgressStyle::Automatic;
    std::string format = "markdown";  ///< of `settings`: markdown or toml
    std::string observed;             ///< --observed: measurements of `compare`, `calibrate`, `sweep`, `diagnose`
    std::vector<std::string> free;    ///< --free: of `calibrate` and `diagnose`
    bool resume = false;              ///< --resume: of `calibrate` and `diagnose`
    bool plan = false;                ///< --plan: of `diagnose`
    bool full = false;                ///< --full: of `diagnose`
    std::string instruments = "stops,speed";  ///< --instruments: of `diagnose --plan`
    std::int64_t sets = 20;                   ///< --sets: of `sweep` [-]
    std::ostream* out = nullptr;
    std::ostream* err = nullptr;

    SiteFile read_site() const { return read_site_file(target, changes); }
    /// Folder of the results of this site, without a slash at the end: what stands beside it has its name and more.
    std::filesystem::path results_folder(const SiteFile& site) const {
        const std::filesystem::path folder =
            output.empty() ? site.beside(site.settings.output_directory) : std::filesystem::path(output);
        return gis::named_folder(folder);
    }
};

ExitCode run_init(const Context& context);
ExitCode run_check(const Context& context);
ExitCode run_terrain(const Context& context);
ExitCode run_profile(const Context& context);
ExitCode run_run(const Context& context);
ExitCode run_compare(const Context& context);
ExitCode run_calibrate(const Context& context);
ExitCode run_sweep(const Context& context);
ExitCode run_diagnose(const Context& context);
ExitCode run_settings(const Context& context);
ExitCode run_effects(const Context& context);

/// Of the program: what unfinished work of an earlier run must share to be gone on with.
std::string version_number();
/// Version of the program and, where git knew it, the commit that it was built from: "0.1.0 (6e355a4)", with a plus if files were changed.
std::string version();
/// Prints warnings to the error stream, each once.
void print_warnings(const Context& context, const std::vector<std::string>& warnings);
struct ObservedSite;
/// Prints what the audit of measurements found; true if it stops here.
bool print_findings(const Context& context, const ObservedSite& observed);
/// Throws InputError if results cannot go to the folder, or would replace what is there untold, or the site file itself.
void require_free_results(const Context& context, const SiteFile& site, const std::filesystem::path& folder);
/// Names unfinished folders of results beside this one. They are not removed: they could belong to a run on another machine.
void warn_of_partial_results(const Context& context, const std::filesystem::path& folder);

}  // namespace scree::cli
