// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/account.hpp"
#include "cli/campaign_layers.hpp"
#include "cli/commands.hpp"
#include "cli/plane_layers.hpp"
#include "cli/plane_pictures.hpp"
#include "cli/progress.hpp"
#include "cli/site_model.hpp"
#include "cli/text.hpp"
#include "gis/results_writer.hpp"
#include "scree/dynamics/contact_problem_file.hpp"
#include "scree/inference/distance.hpp"

#include <algorithm>
#include <array>
#include <ostream>
#include <sstream>

namespace scree::cli {

namespace {

namespace fs = std::filesystem;

/// The first contact problems above the solver's tolerance, named by block.
void add_hard_problems(const CampaignResult& result, std::size_t most, gis::ResultsPackage& package) {
    std::int64_t block = -1;
    int of_block = 0;
    for (std::size_t k = 0; k < std::min(most, result.hard_problems.size()); ++k) {
        const HardProblem& hard = result.hard_problems[k];
        of_block = hard.block == block ? of_block + 1 : 1;
        block = hard.block;
        std::ostringstream text;
        std::visit([&](const auto& problem) { write_contact_problem(text, problem); }, hard.problem);
        package.files.push_back(
            {"contact_problem_" + std::to_string(block) + "_" + std::to_string(of_block) + ".txt", text.str()});
    }
}

void print_profiles(std::ostream& out, const SiteModel& model, const CampaignResult& r) {
    constexpr std::size_t kMostProfiles = 20;
    const std::vector<std::string> lines = profile_summaries(model, r);
    for (std::size_t k = 0; k < std::min(lines.size(), kMostProfiles); ++k) {
        std::string head = "profile " + std::to_string(k + 1);
        head.resize(std::max<std::size_t>(head.size() + 1, 15), ' ');
        out << head << lines[k] << "\n";
    }
    if (lines.size() > kMostProfiles)
        out << "               ... " << lines.size() - kMostProfiles << " more are in the layer profiles\n";
}

/// What makes profiles longer at the ends that blocks have passed in 2D: one clause for each kind of end.
struct EndsPassed {
    std::int64_t upper = 0;  ///< blocks
    std::string remedies;
};

EndsPassed ends_passed(const SiteModel& model, const CampaignResult& r) {
    constexpr std::array<const char*, kProfileEndNames.size()> kRemedies{
        "raise profile.run_up",          "raise profile.longest_crossing", "enlarge the DTM",
        "fill the holes of the DTM",     "raise profile.longest",          "draw the line longer",
        "let profile.converging be keep"};
    EndsPassed ends;
    std::array<std::int64_t, kProfileEndNames.size()> lower{};
    for (const BlockResult& b : r.blocks) {
        if (!b.done || b.reason != StopReason::LeftTerrain) continue;
        const ProfileTrace& trace = model.profiles->traces[static_cast<std::size_t>(b.profile)];
        ++(b.stop_s < 0.5 * trace.profile.length() ? ends.upper : lower[static_cast<std::size_t>(trace.end)]);
    }
    const auto add = [&](std::int64_t count, const std::string& where, const std::string& remedy) {
        if (count == 0) return;
        ends.remedies += (ends.remedies.empty() ? "" : "; ") + std::to_string(count) + " at " + where + ": " + remedy;
    };
    add(ends.upper, "an upper end", "raise profile.head, or draw the line from farther up");
    for (std::size_t k = 0; k < lower.size(); ++k)
        add(lower[k], std::string("a lower end (") + kProfileEndNames[k] + ")", kRemedies[k]);
    return ends;
}

void print_summary(std::ostream& out, const SiteModel& model, const CampaignResult& r, const fs::path& folder) {
    out << r.released << " blocks thrown:";
    for (std::size_t k = 0; k < kStopReasonNames.size(); ++k)
        out << (k ? ", " : " ") << r.reasons[k] << " " << kStopReasonNames[k];
    out << "\n";
    std::vector<double> runout;
    for (const BlockResult& b : r.blocks)
        if (b.done && b.reason == StopReason::AtRest)
            runout.push_back(model.in_plane() ? b.stop_s - b.release_s : (b.stop - b.release).head<2>().norm());
    std::sort(runout.begin(), runout.end());
    if (!runout.empty())
        out << "runout         median " << short_number(sample_quantile(runout, 0.5)) << " m, 95 % quantile "
            << short_number(sample_quantile(runout, 0.95)) << " m, largest " << short_number(runout.back())
            << " m (blocks at rest" << (model.in_plane() ? ", along the profile" : "") << ")\n";
    if (model.in_plane()) print_profiles(out, model, r);
    std::vector<std::string> seen;
    for (const Screen& screen : model.campaign.screens) {
        if (std::find(seen.begin(), seen.end(), screen.name) != seen.end()) continue;
        seen.push_back(screen.name);
        std::vector<double> speeds, energies;
        for (const ScreenCrossing& c : r.crossings) {
            if (model.campaign.screens[static_cast<std::size_t>(c.screen)].name != screen.name) continue;
            speeds.push_back(c.velocity.norm());
            energies.push_back(c.energy / 1000.0);
        }
        if (speeds.empty() && !model.met_screens.contains(screen.name)) {
            out << "screen         " << screen.name << ": stands where no block can pass\n";
            continue;
        }
        std::sort(speeds.begin(), speeds.end());
        std::sort(energies.begin(), energies.end());
        out << "screen         " << screen.name << ": " << percent(static_cast<std::int64_t>(speeds.size()), r.released)
            << " pass";
        if (!speeds.empty())
            out << "; speed median " << short_number(sample_quantile(speeds, 0.5)) << " m/s, 95 % quantile "
                << short_number(sample_quantile(speeds, 0.95)) << " m/s; energy 95 % quantile "
                << short_number(sample_quantile(energies, 0.95)) << " kJ";
        out << "\n";
    }
    for (std::size_t z = 0; z < r.deposits.size(); ++z) {
        const DepositCount& d = r.deposits[z];
        if (d.count == 0 && !model.met_zones[z]) {
            out << "deposit zone   " << d.name << ": lies where no block can stop\n";
            continue;
        }
        const auto [low, high] = wilson_interval(d.count, r.released);
        out << "deposit zone   " << d.name << ": " << percent(d.count, r.released) << " (95 % interval "
            << short_number(100.0 * low) << " to " << short_number(100.0 * high) << " %)\n";
    }
    out << "results        " << (folder / "results.qgs").string() << " (open it in QGIS)\n"
        << "               beside it: results.gpkg (all layers), "
        << (model.in_plane() ? "profile_curves.csv, profile_*.svg (pictures)" : "rasters (GeoTIFFs)")
        << ", run.toml (reproduces the run)\n";
}

}  // namespace

ExitCode run_run(const Context& context) {
    const SiteFile site = context.read_site();
    const fs::path folder = context.results_folder(site);
    require_free_results(context, site, folder);
    warn_of_partial_results(context, folder);
    SiteModel model = load_site(site);
    warn_of_rolling(model);
    gis::require_inputs_elsewhere(folder, model.files);
    for (const EffectSettings& effect : site.settings.effects)
        if (effect_info(effect.effect.kind).hook == EffectHook::Measurement)
            model.warnings.push_back(std::string("effect ") + effect_info(effect.effect.kind).name +
                                     " acts on simulated measurements only: a run is not changed by it");
    print_warnings(context, model.warnings);
    model.campaign.threads = context.threads;

    const InterruptScope interrupt;
    Progress progress(context, "blocks", model.campaign.release.count);
    const CampaignResult result = run_campaign(
        model.campaign, [&](std::int64_t done) { progress.update(done); }, InterruptScope::flag());
    progress.finish(result.released);
    if (result.released == 0) {
        *context.err << "interrupted before the first block was done: nothing is written\n";
        return ExitCode::Interrupted;
    }

    // who asked for a new result in the place of the old one did not ask for a part of it
    const bool beside = result.interrupted && fs::exists(folder) && !fs::is_empty(folder);
    fs::path written = beside ? fs::path(folder.string() + ".interrupted") : folder;
    for (int number = 2; beside && fs::exists(fs::symlink_status(written)); ++number)
        written = folder.string() + ".interrupted-" + std::to_string(number);

    gis::ResultsPackage package;
    package.frame = model.terrain.data.frame;
    package.title = site.settings.name;
    package.vectors = campaign_vectors(model, result);
    package.rasters = campaign_rasters(model, result);
    package.provenance = provenance(site, model, result);
    package.files.push_back({"run.toml", reproducing_toml(site, result, written, "scree run run.toml")});
    if (model.in_plane()) package.files.push_back({"profile_curves.csv", curves_csv(model, result)});
    for (gis::TextFile& picture : run_pictures(site, model, result)) package.files.push_back(std::move(picture));
    add_hard_problems(result, static_cast<std::size_t>(site.settings.contact_problems), package);
    gis::write_results(written, package, context.overwrite);

    if (!context.quiet) print_summary(*context.out, model, result, written);
    const std::int64_t failed = result.reasons[static_cast<std::size_t>(StopReason::Failed)];
    if (failed > 0)
        *context.err
            << "warning: " << failed << " of " << result.released
            << " trajectories failed in the computation; they count in no map, and stopping_points shows where\n";
    // only the scheme of the paper can do that: the mode event takes such a rise back
    constexpr double kRise = 1e-2;  // [m]
    if (const double rise = result.counters.largest_energy_rise; rise > kRise)
        *context.err << "warning: in a step of moreau_jean the energy of a block rose by " << short_number(rise)
                     << " m of fall: Newton's law of restitution with friction allows that where e is large; take "
                        "model.mode = \"event\"\n";
    const auto warn_of = [&](StopReason reason, bool always, const char* what, const std::string& remedy) {
        constexpr double kMany = 0.05;  // of the blocks
        const std::int64_t count = result.reasons[static_cast<std::size_t>(reason)];
        if (always || static_cast<double>(count) > kMany * static_cast<double>(result.released))
            *context.err << "warning: " << count << " of " << result.released << " blocks " << what
                         << ": how far they run and what they would pass is unknown; " << remedy << "\n";
    };
    if (model.in_plane()) {
        const EndsPassed ends = ends_passed(model, result);  // no block runs off the head of a slope that has one
        warn_of(StopReason::LeftTerrain, ends.upper > 0, "passed an end of their profile", ends.remedies);
    } else
        warn_of(StopReason::LeftTerrain, false, "left the terrain", "enlarge the DTM, or fill its holes");
    warn_of(StopReason::TimeLimit, false, "were still moving at the time limit", "raise model.time_limit");
    if (!result.interrupted) return ExitCode::Done;
    *context.err << "interrupted: " << result.released << " of " << model.campaign.release.count
                 << " blocks were thrown and are written" << (beside ? " to " + written.string() : std::string())
                 << "; the results say so"
                 << (beside ? ", and what was in " + folder.string() + " is as it was" : std::string()) << "\n";
    return ExitCode::Interrupted;
}

}  // namespace scree::cli
