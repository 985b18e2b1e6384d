// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/app.hpp"

#include "cli/commands.hpp"
#include "cli/text.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <new>
#include <ostream>

namespace scree::cli {

namespace {

enum class Target { Site, Folder, Kind, None };

struct Command {
    const char* name;
    const char* description;
    Target target;
    bool writes_results;  ///< takes --output, --overwrite
    bool computes;        ///< takes --threads, --progress
    ExitCode (*run)(const Context&);
};

/// Every command. To add one, add its file and an entry here.
constexpr std::array kCommands{
    Command{"init", "Write a folder with a commented site.toml to fill in", Target::Folder, false, false, run_init},
    Command{"check", "Read and judge every input of a site; nothing is run", Target::Site, false, false, run_check},
    Command{"terrain", "Write the model terrain as layers: heights, slope, facets with soils", Target::Site, true,
            false, run_terrain},
    Command{"profile", "Trace steepest-slope profiles: lines with soils, tables and pictures", Target::Site, true,
            false, run_profile},
    Command{"run", "Throw the blocks of a site, in 3D or along profiles in 2D, and write results for a GIS",
            Target::Site, true, true, run_run},
    Command{"compare", "Hold the model of a site against measurements: gaps in units of chance, pictures, report",
            Target::Site, true, true, run_compare},
    Command{"calibrate", "Find the values of free keys that fit measurements best, and how well these determine them",
            Target::Site, true, true, run_calibrate},
    Command{"sweep", "Show what keys do, one at a time, beside the scatter from repeat to repeat", Target::Site, true,
            true, run_sweep},
    Command{"diagnose", "Find out whether the calibrated model misses an effect, which one, and what it changes",
            Target::Site, true, true, run_diagnose},
    Command{"settings", "Print the reference manual of all keys of the site file", Target::None, false, false,
            run_settings},
    Command{"effects", "Print the catalogue of effects, or all about one of them", Target::Kind, false, false,
            run_effects},
};

const Command* find_command(const std::string& name) {
    const auto found =
        std::find_if(kCommands.begin(), kCommands.end(), [&](const Command& c) { return c.name == name; });
    return found == kCommands.end() ? nullptr : &*found;
}

/// Empty if the text is section.key=value; otherwise what is wrong with it.
std::string is_change(const std::string& text) {
    const auto equals = text.find('='), dot = text.find('.');
    return equals == std::string::npos || dot == std::string::npos || dot > equals
               ? text + " is not of the form section.key=value, such as terrain.resolution=2"
               : "";
}

/// An unset variable of a script is no folder.
std::string is_folder_name(const std::string& text) {
    return text.empty() ? "the name of the folder is empty" : "";
}

/// Where results go unless --output says otherwise: beside output.directory, so that no command replaces the results of another.
std::string output_help(const Command& command) {
    const std::string suffix = command.run == run_run        ? ""
                               : command.run == run_diagnose ? " + _diagnose, with --plan + _plan"
                                                             : std::string(" + _") + command.name;
    return "Folder of the results (default: output.directory of the site file" + suffix + ")";
}

void add_options(CLI::App& sub, const Command& command, Context& context) {
    if (command.target == Target::Site) {
        sub.add_option("SITE", context.target, "Site file (site.toml)")->type_name("")->required();
        sub.add_option("--set", context.changes,
                       command.run == run_sweep
                           ? "A key with the values to try, --set soil.NAME.rolling=0.02,0.05,0.1, or with one for all "
                             "(repeatable)"
                           : "Change a key of the site file for this run: --set release.count=50 (repeatable)")
            ->type_name("KEY=VALUE")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
            ->check(is_change, "");
        sub.add_option_function<std::int64_t>(
               "--seed", [&](std::int64_t seed) { context.changes.push_back("model.seed=" + std::to_string(seed)); },
               "Short for --set model.seed=N")
            ->type_name("N");
        sub.add_flag("--quiet,-q", context.quiet, "No progress and no summary, only warnings and errors");
    }
    if (command.target == Target::Folder)
        sub.add_option("FOLDER", context.target, "Folder of the new site")
            ->type_name("")
            ->required()
            ->check(is_folder_name, "");
    if (command.target == Target::Kind)
        sub.add_option("KIND", context.target, "The effect to explain; without it all are listed")->type_name("");
    if (command.writes_results) {
        sub.add_option("--output", context.output, output_help(command))
            ->type_name("FOLDER")
            ->check(is_folder_name, "");
        sub.add_flag("--overwrite", context.overwrite, "Replace results that are there already");
    }
    if (command.computes) {
        sub.add_option("--threads", context.threads,
                       "Number of threads, 0 (the default) is all cores. Does not change the results")
            ->type_name("N")
            ->check(CLI::Range(0, 1024).description(""));
        sub.add_option_function<std::string>(
               "--progress",
               [&](const std::string& style) {
                   context.progress = style == "json" ? ProgressStyle::Json : ProgressStyle::Automatic;
               },
               "auto, or json: one JSON object a line on the error stream")
            ->type_name("STYLE")
            ->check(CLI::IsMember({"auto", "json"}));
    }
    const std::string name = command.name;
    if (name == "compare" || name == "calibrate" || name == "sweep" || name == "diagnose")
        sub.add_option(
               "--observed", context.observed,
               "Measurements: a GeoPackage, a folder of tables, a table (CSV), or a folder of results of scree run "
               "(gis/README.md describes layers and columns)")
            ->type_name("OBS")
            ->required(name != "diagnose");
    if (name == "calibrate" || name == "diagnose") {
        sub.add_option(
               "--free", context.free,
               "A key with its range, soil.NAME.rolling=0.01:0.1 (:log searches by ratios), or with choices, "
               "blocks.shape=hull,box (repeatable; default: calibration.free of the site file" +
                   std::string(name == "diagnose" ? "; without it restitution, friction and rolling of all soils)"
                                                  : ")"))
            ->type_name("KEY=RANGE")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
            ->check(is_change, "");
        sub.add_flag("--resume", context.resume, "Go on with what was interrupted");
    }
    if (name == "diagnose") {
        sub.add_flag("--full", context.full,
                     "Three times the simulations, longer calibrations: weaker effects, more certain names");
        sub.add_flag(
            "--plan", context.plan,
            "Nothing is measured yet: what a test of release.count blocks, such as --set release.count=50, with "
            "these instruments could see, and what to measure in addition");
        sub.add_option("--instruments", context.instruments,
                       "With --plan, what would be measured of each block: stops, at the screens speed, height, "
                       "spin, and the speeds before and after its first three impacts (default stops,speed; all: "
                       "stops,speed,height,spin,impacts)")
            ->type_name("LIST")
            ->needs("--plan");
    }
    if (name == "sweep")
        sub.add_option("--sets", context.sets, "Sets of blocks per value, behind the scatter (default 20)")
            ->type_name("N")
            ->check(CLI::Range(4, 100000).description(""));
    if (name == "settings")
        sub.add_option("--format", context.format,
                       "markdown (the manual; the default) or toml (a site file with all defaults)")
            ->type_name("FORMAT")
            ->check(CLI::IsMember({"markdown", "toml"}));
}

/// Of a command: what was said of an option that it does not have, with the nearest one that it has; nothing if none was given.
std::string unknown_option(const CLI::App& sub, const std::vector<std::string>& args) {
    for (const std::string& arg : args) {
        const std::string name = arg.substr(0, arg.find('='));
        if (!name.starts_with("--") || name == "--" || sub.get_option_no_throw(name)) continue;
        std::string best;
        std::size_t distance = 3;
        for (const CLI::Option* option : sub.get_options())
            for (const std::string& known : option->get_lnames())
                if (const std::size_t d = edit_distance("--" + known, name); d < distance) {
                    distance = d;
                    best = known;
                }
        return "there is no option " + name + (best.empty() ? "" : " (did you mean --" + best + "?)");
    }
    return {};
}

ExitCode dispatch(const std::vector<std::string>& args, Context& context) {
    CLI::App app{
        "Scree predicts where falling rocks go: rigid blocks of real shape on a georeferenced terrain, results for a "
        "GIS.",
        "scree"};
    app.set_version_flag("--version", version());
    app.require_subcommand(1);
    app.footer(
        "A first run: sample_sites/quickstart.sh. Keys of the site file: scree settings. Exit codes: 0 done, 2 usage, "
        "3 bad input, 4 could not compute, 130 interrupted.");
    for (const Command& command : kCommands)
        add_options(*app.add_subcommand(command.name, command.description), command, context);
    std::vector<std::string> reversed(args.rbegin(), args.rend());
    try {
        app.parse(reversed);
    } catch (const CLI::Success& e) {  // --help, --version
        app.exit(e, *context.out, *context.err);
        return ExitCode::Done;
    } catch (const CLI::ParseError& e) {
        const Command* command = args.empty() ? nullptr : find_command(args.front());
        std::string said = e.what();
        if (args.empty())
            said = "no command is given";
        else if (!command && !args.front().starts_with("-"))
            said = "there is no command " + args.front();
        if (const std::string unknown = command ? unknown_option(*app.get_subcommand(args.front()), args) : "";
            !unknown.empty())
            said = unknown;
        *context.err << "error: " << said << "; see scree " << (command ? std::string(command->name) + " " : "")
                     << "--help\n";
        return ExitCode::Usage;
    }
    for (const Command& command : kCommands)
        if (app.got_subcommand(command.name)) return command.run(context);
    return ExitCode::Usage;
}

}  // namespace

std::string version_number() {
    return SCREE_VERSION;
}

std::string version() {
    constexpr std::string_view kCommit =
#include "commit.inc"
        ;
    return std::string(SCREE_VERSION) + (kCommit.empty() ? "" : " (" + std::string(kCommit) + ")");
}

void print_warnings(const Context& context, const std::vector<std::string>& warnings) {
    std::vector<std::string> seen;
    for (const std::string& w : warnings) {
        if (std::find(seen.begin(), seen.end(), w) != seen.end()) continue;
        seen.push_back(w);
        *context.err << "warning: " << w << "\n";
    }
}

void require_free_results(const Context& context, const SiteFile& site, const std::filesystem::path& folder) {
    gis::require_free_results_folder(folder, context.overwrite);
    gis::require_input_elsewhere(folder, site.file);
}

void warn_of_partial_results(const Context& context, const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path path = fs::weakly_canonical(fs::absolute(folder, ignored), ignored);
    const std::string prefix = path.filename().string() + ".partial-";
    for (const auto& entry : fs::directory_iterator(path.parent_path(), ignored))
        if (entry.path().filename().string().starts_with(prefix))
            *context.err << "warning: " << entry.path().string()
                         << " is what a run left behind that was killed while it wrote, if none is writing now: take "
                            "from it what is yours, and remove it\n";
}

// The only place that catches: every error becomes one sentence and an exit code.
int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
    Context context;
    context.out = &out;
    context.err = &err;
    try {
        const ExitCode code = dispatch(args, context);
        if (code != ExitCode::Done || out.flush()) return static_cast<int>(code);
        err << "error: what was to be said on the standard output could not be written: is the disc full?\n";
    } catch (const InputError& e) {
        err << "error: " << e.what() << "\n";
        return static_cast<int>(ExitCode::BadInput);
    } catch (const std::filesystem::filesystem_error& e) {
        err << "error: " << e.path1().string() << ": cannot be read or written (" << e.code().message()
            << "); check the path, its permissions and the room on the disc\n";
        // a folder that may not be entered, links in a circle, a name that is too long
        if (e.code() != std::errc::no_space_on_device && e.code() != std::errc::io_error)
            return static_cast<int>(ExitCode::BadInput);
    } catch (const std::bad_alloc&) {
        err << "error: not enough memory: take a coarser resolution, a smaller DTM or fewer blocks (a block "
               "takes some 200 bytes, release.count)\n";
    } catch (const std::exception& e) {
        err << "error: " << e.what() << "\n";
    }
    return static_cast<int>(ExitCode::CouldNotCompute);
}

}  // namespace scree::cli
