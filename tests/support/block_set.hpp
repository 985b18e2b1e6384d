// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/trajectory.hpp"
#include "support/scenes.hpp"

#include <array>
#include <filesystem>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace scree::test {

/// Points of a CSV file x,y,z with one line of names.
std::vector<Vec3> read_points(const std::filesystem::path& path);

/// ESRI ASCII grid as a surface whose nodes are the grid's values, the first at the lower left corner given, as the references read it. One soil, number 0.
/// `noise`: half width of independent uniform noise added to every node [m].
std::unique_ptr<Surface> read_node_grid(const std::filesystem::path& path, double noise = 0.0);

/// A block and how it starts, in the axes of its points.
struct ThrownBlock {
    FramedBlock body;
    BlockState<3> release;
};

/// Name of the file with the points of a block: hull_07.csv.
std::string hull_file(int number);

/// The blocks of a folder as in path_a_blocks: blocks.csv (block,x,y,z,qw,qx,qy,qz,mass,I1,I2,I3) and hull_NN.csv. Throws std::runtime_error where the
/// inertia of a hull, homogeneous and of the block's mass, is not the one listed.
std::vector<ThrownBlock> read_blocks(const std::filesystem::path& folder);

/// Where s and its lines lie: s = x - start [m].
struct Course {
    double start = -80.0;                     ///< [m]
    std::array<double, 2> lines{39.5, 48.5};  ///< [m]
};

/// What outcomes.csv of the references says about one trajectory.
struct Outcome {
    double stop = kNaN;                            ///< s of the centre of mass at the end [m]
    double lateral = kNaN;                         ///< |y| there [m]
    double largest_speed = 0.0;                    ///< [m/s]
    std::array<double, 2> line_speed{kNaN, kNaN};  ///< at the first crossing of each line, NaN if there was none [m/s]
    double time = 0.0;                             ///< at the end [s]
    StopReason reason = StopReason::Failed;
    TrajectoryCounters counters;
};

/// Copy 0 of a block starts as given, the others up to 1 cm beside it, east and north: their paths part within seconds.
ThrownBlock copy_of(const ThrownBlock& block, std::size_t number, std::int64_t copy);

Outcome throw_block(const ThrownBlock& thrown, const Surface& surface, const std::vector<Soil>& soils,
                    const DynamicsSettings& settings, const Course& course);

/// The five observables of an outcome, and their names in the header line of outcomes.csv.
inline constexpr std::array<const char*, 5> kObservables{"stop_s", "abs_y", "v_max", "v_at_s39_5", "v_at_s48_5"};
double observable(const Outcome& outcome, std::size_t which);
/// The values of one observable in a set; crossings that did not take place are left out.
std::vector<double> values_of(const std::vector<Outcome>& outcomes, std::size_t which);

/// Rows of one model in a file like outcomes.csv: model,block,stop_s,abs_y,v_max,v_at_s39_5,v_at_s48_5,t_end. The name may hold commas. Throws
/// std::runtime_error if there are none.
std::vector<Outcome> read_outcomes(const std::filesystem::path& path, const std::string& model);
void write_outcome(std::ostream& out, const std::string& model, std::size_t block, const Outcome& outcome);

}  // namespace scree::test
