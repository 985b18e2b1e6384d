// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/block_set.hpp"

#include "scree/base/random.hpp"
#include "support/reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

namespace scree::test {

namespace {

constexpr double kBeside = 0.01;  ///< how far beside its release a copy may start [m]

/// Notes speeds along a path.
class SpeedRecorder final : public MotionSink<3> {
public:
    SpeedRecorder(const Course& course, Outcome& outcome) : course_(course), outcome_(outcome) {}

    void segment(const MotionSegment<3>& motion) override {
        // with a constant acceleration the speed is largest at one of the ends
        outcome_.largest_speed =
            std::max({outcome_.largest_speed, motion.velocity_start.norm(), motion.velocity_end.norm()});
        for (std::size_t k = 0; k < course_.lines.size(); ++k)
            if (std::isnan(outcome_.line_speed[k]))
                outcome_.line_speed[k] = speed_at(course_.start + course_.lines[k], motion);
    }

private:
    /// Speed when the segment first reaches x, NaN if it does not. Blocks start before the lines.
    static double speed_at(double x, const MotionSegment<3>& motion) {
        const double along = motion.velocity_start.x(), left = x - motion.position.x();
        const Vec3 acceleration = (motion.velocity_end - motion.velocity_start) / std::max(motion.duration, 1e-300);
        const double root = along * along + 2.0 * acceleration.x() * left;
        if (left < 0.0 || root < 0.0 || along + std::sqrt(root) <= 0.0) return kNaN;
        const double t = 2.0 * left / (along + std::sqrt(root));
        return t <= motion.duration ? (motion.velocity_start + t * acceleration).norm() : kNaN;
    }

    const Course& course_;
    Outcome& outcome_;
};

}  // namespace

std::vector<Vec3> read_points(const std::filesystem::path& path) {
    std::vector<Vec3> points;
    for (const auto& row : read_csv(path)) points.emplace_back(row.at(0), row.at(1), row.at(2));
    return points;
}

std::unique_ptr<Surface> read_node_grid(const std::filesystem::path& path, double noise) {
    std::ifstream in(path);
    std::string word;
    GridShape shape;
    double x = 0.0, y = 0.0, nodata = 0.0;
    in >> word >> shape.columns >> word >> shape.rows >> word >> x >> word >> y >> word >> shape.cell >> word >> nodata;
    shape.origin = Vec2(x, y) - Vec2::Constant(0.5 * shape.cell);
    Grid<double> heights(shape);
    for (int j = shape.rows - 1; j >= 0; --j)
        for (int i = 0; i < shape.columns; ++i) in >> heights.at(i, j);
    if (!in) throw std::runtime_error(path.string() + ": short file");
    RandomStream random(1, 0, RandomPurpose::Effect);
    for (double& z : heights.values) z += noise > 0.0 ? random.uniform(-noise, noise) : 0.0;
    std::vector<SoilId> soil(grid_facet_count(shape), 0);
    return make_grid_surface(std::move(heights), std::move(soil));
}

std::string hull_file(int number) {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "hull_%02d.csv", number);
    return name.data();
}

std::vector<ThrownBlock> read_blocks(const std::filesystem::path& folder) {
    std::vector<ThrownBlock> blocks;
    for (const auto& row : read_csv(folder / "blocks.csv")) {
        const std::string hull = hull_file(static_cast<int>(row.at(0)));
        ThrownBlock thrown{FramedBlock(read_points(folder / hull), row.at(8)), {}};
        thrown.release.position = {row[1], row[2], row[3]};
        thrown.release.orientation = Quat(row[4], row[5], row[6], row[7]).normalized();
        const Mat3 axes = thrown.body.to_body.toRotationMatrix();
        const Mat3 inertia = axes.transpose() * thrown.body.block.inertia.asDiagonal() * axes;
        const Vec3 listed(row.at(9), row.at(10), row.at(11));
        if ((inertia - Mat3(listed.asDiagonal())).norm() > 1e-9 * listed.norm())
            throw std::runtime_error((folder / hull).string() + ": inertia differs from the one in blocks.csv");
        blocks.push_back(std::move(thrown));
    }
    return blocks;
}

ThrownBlock copy_of(const ThrownBlock& block, std::size_t number, std::int64_t copy) {
    ThrownBlock moved = block;
    if (copy > 0) {
        RandomStream random(1, number * 1'000'000 + static_cast<std::uint64_t>(copy), RandomPurpose::ReleasePosition);
        moved.release.position.x() += random.uniform(-kBeside, kBeside);
        moved.release.position.y() += random.uniform(-kBeside, kBeside);
    }
    return moved;
}

Outcome throw_block(const ThrownBlock& thrown, const Surface& surface, const std::vector<Soil>& soils,
                    const DynamicsSettings& settings, const Course& course) {
    Outcome outcome;
    SpeedRecorder recorder(course, outcome);
    const TrajectoryEnd<3> end =
        simulate_block(thrown.body.block, thrown.body.to_block(thrown.release), surface, soils, settings, &recorder);
    outcome.stop = end.state.position.x() - course.start;
    outcome.lateral = std::abs(end.state.position.y());
    outcome.time = end.time;
    outcome.reason = end.reason;
    outcome.counters = end.counters;
    return outcome;
}

double observable(const Outcome& outcome, std::size_t which) {
    const std::array<double, 5> all{outcome.stop, outcome.lateral, outcome.largest_speed, outcome.line_speed[0],
                                    outcome.line_speed[1]};
    return all.at(which);
}

std::vector<double> values_of(const std::vector<Outcome>& outcomes, std::size_t which) {
    std::vector<double> values;
    for (const Outcome& o : outcomes)
        if (const double value = observable(o, which); !std::isnan(value)) values.push_back(value);
    return values;
}

std::vector<Outcome> read_outcomes(const std::filesystem::path& path, const std::string& model) {
    std::ifstream in(path);
    std::string line;
    std::getline(in, line);
    std::vector<Outcome> outcomes;
    while (std::getline(in, line)) {
        std::array<double, 7> field{};  // from the right: the name of the model may hold commas
        std::size_t comma = 0;
        for (std::size_t k = field.size(); k-- > 0 && comma != std::string::npos;
             line.resize(std::min(comma, line.size()))) {
            comma = line.rfind(',');
            if (comma != std::string::npos) field[k] = std::strtod(line.c_str() + comma + 1, nullptr);
        }
        if (comma == std::string::npos) throw std::runtime_error(path.string() + ": a row without 8 columns: " + line);
        if (line == model)
            outcomes.push_back({field[1], field[2], field[3], {field[4], field[5]}, field[6], StopReason::AtRest, {}});
    }
    if (outcomes.empty()) throw std::runtime_error(path.string() + ": no rows of \"" + model + "\"");
    return outcomes;
}

void write_outcome(std::ostream& out, const std::string& model, std::size_t block, const Outcome& outcome) {
    out << model << ',' << block;
    for (std::size_t k = 0; k < kObservables.size(); ++k) out << ',' << observable(outcome, k);
    out << ',' << outcome.time << '\n';
}

}  // namespace scree::test
