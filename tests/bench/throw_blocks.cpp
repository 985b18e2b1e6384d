// SPDX-License-Identifier: GPL-3.0-or-later
// Throws a given set of hulls from given releases, takes the CPU time and compares outcomes: compare_siconos.sh, tests/validation/path_a_blocks.sh.
#include "bench/core_clock.hpp"

#include "cli/site_model.hpp"
#include "scree/base/random.hpp"
#include "support/block_set.hpp"
#include "support/two_samples.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace scree::bench {

namespace {

constexpr double kStart = -80.0;  ///< easting of s = 0 in the sample, as in the course of the references [m]

struct Options {
    std::string folder, terrain, out;
    std::string name = "scree", mode = "event";
    std::int64_t blocks = 30, copies = 1;
    std::uint64_t seed = 1;
    double noise = 0.0;  ///< half width of what is added to every node [m]
    Soil soil;
    DynamicsSettings dynamics;
    std::vector<std::string> sets;
};

std::ofstream open(const std::filesystem::path& path) {
    std::ofstream out(path);
    if (!out) throw std::runtime_error(path.string() + ": cannot be written");
    out << std::setprecision(17);
    return out;
}

void throw_all(const Options& options) {
    const auto blocks = test::read_blocks(options.folder);
    const auto surface = test::read_node_grid(options.terrain, options.noise);
    const std::vector<Soil> soils{options.soil};
    std::ofstream out = open(options.out);
    out << "model,block,stop_s,abs_y,v_max,v_at_s39_5,v_at_s48_5,t_end\n";
    TrajectoryCounters counters;
    WorkMeter meter;
    std::int64_t count = 0, in_motion = 0;
    for (std::size_t b = 0; b < blocks.size() && b < static_cast<std::size_t>(options.blocks); ++b) {
        for (std::int64_t copy = 0; copy < options.copies; ++copy, ++count) {
            const test::ThrownBlock block = test::copy_of(blocks[b], b, copy);
            std::vector<Vec3> points;
            for (Eigen::Index v = 0; v < block.body.block.vertex_count(); ++v)
                points.push_back(block.body.block.vertex(v));
            test::Outcome o;
            meter.measure([&] {
                make_block_from_points(points, block.body.block.mass);  // the hull is part of the cost
                o = test::throw_block(block, *surface, soils, options.dynamics, {});
            });
            test::write_outcome(out, options.name, b, o);
            counters.merge(o.counters);
            in_motion += o.reason == StopReason::TimeLimit;
        }
    }
    const auto per_block = [&](double sum) { return sum / static_cast<double>(count); };
    std::printf(
        "blocks %lld\ncpu_s_per_block %.6g\nadditions_per_block %.6g\ncontact_steps_per_block %.1f\n"
        "impacts_per_block %.1f\nin_motion_at_the_end %lld\nunconverged_problems %lld\n",
        static_cast<long long>(count), per_block(meter.seconds()), per_block(meter.additions()),
        per_block(static_cast<double>(counters.contact_steps)), per_block(static_cast<double>(counters.impacts)),
        static_cast<long long>(in_motion), static_cast<long long>(counters.unconverged_problems));
}

/// A terrain, blocks and releases in the files that throw_all reads, from the sample site. The centre of its release area comes to lie at s = 0, y = 0.
void write_sample(const Options& options) {
    namespace fs = std::filesystem;
    const cli::SiteModel site =
        cli::load_site(cli::read_site_file(SCREE_SOURCE_DIR "/sample_sites/quarry_a/site.toml", {}));
    const Grid<double>& grid = site.terrain.data.grid;
    const CampaignInput& campaign = site.campaign;
    fs::create_directories(options.folder);
    std::vector<PopulationBlock> blocks;
    std::vector<BlockState<3>> releases;
    Vec2 centre = Vec2::Zero();
    for (std::int64_t b = 0; b < options.blocks; ++b) {
        const auto number = static_cast<std::uint64_t>(b);
        blocks.push_back(draw_block(campaign.population, options.seed, number));
        std::int64_t feature = 0;
        double raised = 0.0;
        releases.push_back(draw_release(campaign.release, *site.area, *campaign.surface, blocks.back().body,
                                        options.seed, number, feature, raised));
        centre += releases.back().position.head<2>() / static_cast<double>(options.blocks);
    }
    const Vec3 shift(kStart - centre.x(), -centre.y(), 0.0);

    std::ofstream terrain = open(options.terrain);
    const Vec2 corner = grid.shape.centre(0, 0) + shift.head<2>();
    terrain << "ncols " << grid.shape.columns << "\nnrows " << grid.shape.rows << "\nxllcorner " << corner.x()
            << "\nyllcorner " << corner.y() << "\ncellsize " << grid.shape.cell << "\nNODATA_value -9999\n";
    for (int j = grid.shape.rows - 1; j >= 0; --j)
        for (int i = 0; i < grid.shape.columns; ++i)
            terrain << grid.at(i, j) << (i + 1 < grid.shape.columns ? ' ' : '\n');

    std::ofstream list = open(fs::path(options.folder) / "blocks.csv");
    list << "block,x,y,z,qw,qx,qy,qz,mass,I1,I2,I3\n";
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const ConvexBlock& body = blocks[b].body;
        const Vec3 x = releases[b].position + shift;
        const Quat& q = releases[b].orientation;
        list << b << ',' << x.x() << ',' << x.y() << ',' << x.z() << ',' << q.w() << ',' << q.x() << ',' << q.y() << ','
             << q.z() << ',' << body.mass << ',' << body.inertia.x() << ',' << body.inertia.y() << ','
             << body.inertia.z() << '\n';
        std::ofstream hull = open(fs::path(options.folder) / test::hull_file(static_cast<int>(b)));
        hull << "x,y,z\n";
        for (Eigen::Index v = 0; v < body.vertex_count(); ++v)
            hull << body.x[v] << ',' << body.y[v] << ',' << body.z[v] << '\n';
    }
}

/// FILE:MODEL, a set of outcomes.
std::vector<test::Outcome> read_set(const std::string& set) {
    const std::size_t colon = set.find(':');
    if (colon == std::string::npos) throw std::runtime_error(set + ": say FILE:MODEL");
    return test::read_outcomes(set.substr(0, colon), set.substr(colon + 1));
}

/// Quantiles of every observable in every set, and how far each is from the first one, as a table in Markdown.
void compare(const Options& options) {
    const std::vector<test::Outcome> first = read_set(options.sets.at(0));
    std::puts(
        "| observable | set | values | 10 % | 25 % | median (95 %) | 75 % | 90 % | mean | KS distance | its "
        "probability |");
    std::puts("|---|---|---|---|---|---|---|---|---|---|---|");
    for (std::size_t k = 0; k < test::kObservables.size(); ++k) {
        const std::vector<double> reference = test::values_of(first, k);
        for (const std::string& set : options.sets) {
            const std::vector<double> values = test::values_of(read_set(set), k);
            if (values.empty()) continue;
            double mean = 0.0;
            for (const double v : values) mean += v / static_cast<double>(values.size());
            const auto interval = test::bootstrap_median(values, 0.95);
            std::printf("| %s | %s | %zu | %.1f | %.1f | %.1f (%.1f to %.1f) | %.1f | %.1f | %.1f |",
                        test::kObservables[k], set.substr(set.find(':') + 1).c_str(), values.size(),
                        test::quantile(values, 0.1), test::quantile(values, 0.25), test::median(values), interval[0],
                        interval[1], test::quantile(values, 0.75), test::quantile(values, 0.9), mean);
            if (&set == &options.sets.front()) {
                std::puts(" | |");
                continue;
            }
            const double distance = test::ks_distance(values, reference);
            std::printf(
                " %.3f | %.2g |\n", distance,
                test::ks_probability(distance, static_cast<int>(values.size()), static_cast<int>(reference.size())));
        }
    }
}

int run(int argc, char** argv) {
    Options options;
    CLI::App app("Throws a set of hulls down a grid of heights; see tests/bench/compare_siconos.sh");
    app.require_subcommand(1);
    CLI::App* sample = app.add_subcommand("sample", "write terrain, hulls and releases of the sample site");
    CLI::App* thrown = app.add_subcommand("throw", "throw the blocks of a folder");
    CLI::App* clock = app.add_subcommand("clock", "print the dependent additions per second of this core");
    CLI::App* compared = app.add_subcommand("compare", "print how far sets of outcomes are from the first of them");
    for (CLI::App* command : {sample, thrown}) {
        command->add_option("folder", options.folder, "blocks.csv and hull_NN.csv")->required();
        command->add_option("terrain", options.terrain, "heights of nodes, ESRI ASCII grid")->required();
        command->add_option("--blocks", options.blocks, "how many, at most [-]");
    }
    sample->add_option("--seed", options.seed, "of blocks and releases [-]");
    thrown->add_option("out", options.out, "CSV, a row per block")->required();
    thrown->add_option("--noise", options.noise, "half width of noise added to every node of the terrain [m]");
    thrown->add_option("--name", options.name, "of this set in the file");
    thrown->add_option("--copies", options.copies, "of each block, from beside its release [-]");
    thrown->add_option("--mode", options.mode, "event or moreau_jean")->check(CLI::IsMember({"event", "moreau_jean"}));
    thrown->add_option("--step", options.dynamics.time_step, "time step [s]");
    thrown->add_option("--time", options.dynamics.time_limit, "longest trajectory [s]");
    thrown->add_option("--tolerance", options.dynamics.solver.tolerance, "of the contact solver [-]");
    thrown->add_flag("--vertices-only", options.dynamics.vertices_only, "no contacts of terrain tips and crests");
    thrown->add_option("--restitution", options.soil.restitution, "e [-]");
    thrown->add_option("--friction", options.soil.friction, "mu [-]");
    thrown->add_option("--rolling", options.soil.rolling, "mu_r [m]");
    compared->add_option("sets", options.sets, "FILE:MODEL ..., the reference first")->required();
    CLI11_PARSE(app, argc, argv);
    options.dynamics.mode = options.mode == "event" ? SteppingMode::Event : SteppingMode::MoreauJean;
    if (sample->parsed()) write_sample(options);
    if (thrown->parsed()) throw_all(options);
    if (clock->parsed()) std::printf("%.6g\n", dependent_additions_per_second());
    if (compared->parsed()) compare(options);
    return 0;
}

}  // namespace

}  // namespace scree::bench

int main(int argc, char** argv) {
    try {
        return scree::bench::run(argc, argv);
    } catch (const std::exception& e) {
        std::cerr << "scree_throw: " << e.what() << '\n';
        return 4;
    }
}
