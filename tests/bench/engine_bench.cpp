// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of the engine, on one core: hulls, detection, solver, flight. Things per second of CPU time, and per 1e9 dependent additions.
#include "bench/scenes.hpp"
#include "dynamics/hull_contacts.hpp"

#include "scree/base/random.hpp"
#include "scree/dynamics/contact_solver.hpp"
#include "scree/dynamics/trajectory.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace scree::bench {

namespace {

constexpr double kReach = 0.05;  ///< gaps that detection is asked for [m]
constexpr double kStep = 4e-3;   ///< time between two looks [s]
constexpr int kTracks = 32;      ///< places on the slope [-]
constexpr int kLooks = 16;       ///< at each of them, as the block rolls on [-]
constexpr int kProblems = 64;    ///< contact problems of one size [-]
constexpr double kSlope = 35.0;  ///< length of the upper slope of the site [m]

/// Drawing a block from the list and building its hull of about 50 vertices.
void hull_build(benchmark::State& state) {
    const Scene& scene = Scene::get(Ground::Smooth);
    std::uint64_t number = 0;
    WorkMeter meter;
    meter.measure([&] {
        for (auto _ : state) benchmark::DoNotOptimize(scene.block(number++));
    });
    report(state, static_cast<std::int64_t>(number), meter);
}
BENCHMARK(hull_build)->Unit(benchmark::kMicrosecond);

/// Poses of a block that rolls over the ground, a millimetre above it, look after look.
std::vector<BlockState<3>> rolling_poses(const Scene& scene, const ConvexBlock& block) {
    std::vector<BlockState<3>> poses;
    for (std::uint64_t track = 0; track < kTracks; ++track) {
        RandomStream random(7, track, RandomPurpose::Effect);
        BlockState<3> s = scene.release(block, track);
        s.position.x() += random.uniform(0.0, kSlope);
        s.velocity = {6.0, 0.0, -4.0};
        s.spin = {0.0, 8.0, 0.0};
        for (int look = 0; look < kLooks; ++look) {
            s.position += kStep * s.velocity;
            s.orientation = (s.orientation * Quat(Eigen::AngleAxisd(kStep * 8.0, Vec3::UnitY()))).normalized();
            s.position.z() = scene.surface->height(s.position.head<2>()) + 0.5 * block.inner_radius;
            s.position.z() += clearing_lift(block, s, *scene.surface, 1e-3);
            poses.push_back(s);
        }
    }
    return poses;
}

/// All contacts of a block near the ground. Arguments: rough, with crests and tips.
void detection(benchmark::State& state) {
    const Scene& scene = Scene::get(state.range(0) != 0 ? Ground::Rough : Ground::Smooth);
    const ConvexBlock block = scene.block(7);
    const std::vector<BlockState<3>> poses = rolling_poses(scene, block);
    HullContacts finder(block, *scene.surface, state.range(1) == 0);
    std::vector<Contact<3>> contacts;
    std::int64_t looks = 0, found = 0;
    WorkMeter meter;
    meter.measure([&] {
        for (auto _ : state) {
            const BlockState<3>& s = poses[static_cast<std::size_t>(looks) % poses.size()];
            finder.detect(s.position, s.orientation.toRotationMatrix(), kReach, contacts);
            found += static_cast<std::int64_t>(contacts.size());
            ++looks;
        }
    });
    report(state, looks, meter);
    state.counters["contacts"] = static_cast<double>(found) / static_cast<double>(looks);
}
BENCHMARK(detection)
    ->ArgNames({"rough", "crests"})
    ->Args({0, 0})
    ->Args({0, 1})
    ->Args({1, 0})
    ->Args({1, 1})
    ->Unit(benchmark::kNanosecond);

/// The contact problem of a block that falls onto these contacts: W = G^T M^-1 G, q = G^T v.
ContactProblem<3> problem_of(const ConvexBlock& block, const BlockState<3>& s,
                             const std::vector<Contact<3>>& contacts) {
    const auto count = static_cast<Eigen::Index>(contacts.size());
    const Mat3 rotation = s.orientation.toRotationMatrix();
    Eigen::MatrixXd g = Eigen::MatrixXd::Zero(5 * count, 6);
    ContactProblem<3> problem;
    problem.resize(static_cast<int>(count));
    for (Eigen::Index c = 0; c < count; ++c) {
        const Contact<3>& contact = contacts[static_cast<std::size_t>(c)];
        Mat3 frame;
        frame.col(0) = contact.normal;
        frame.col(1) = contact.normal.unitOrthogonal();
        frame.col(2) = contact.normal.cross(frame.col(1));
        for (int k = 0; k < 3; ++k) {
            g.block<1, 3>(5 * c + k, 0) = frame.col(k).transpose();
            g.block<1, 3>(5 * c + k, 3) = (rotation.transpose() * contact.arm.cross(frame.col(k))).transpose();
        }
        for (int k = 1; k < 3; ++k) g.block<1, 3>(5 * c + 2 + k, 3) = (rotation.transpose() * frame.col(k)).transpose();
        problem.friction[static_cast<std::size_t>(c)] = 0.5;
        problem.rolling[static_cast<std::size_t>(c)] = 0.04;
    }
    Eigen::Matrix<double, 6, 1> inverse_mass, velocity;
    inverse_mass << Vec3::Constant(1.0 / block.mass), block.inertia.cwiseInverse();
    velocity << s.velocity, s.spin;
    problem.delassus = g * inverse_mass.asDiagonal() * g.transpose();
    problem.free_velocity = g * velocity;
    return problem;
}

/// Problems of one size from the rough slope: the nearest places of one pose each.
std::vector<ContactProblem<3>> problems_of_size(std::size_t count) {
    const Scene& scene = Scene::get(Ground::Rough);
    const ConvexBlock block = scene.block(7);
    HullContacts finder(block, *scene.surface, false);
    std::vector<Contact<3>> contacts;
    std::vector<ContactProblem<3>> problems;
    for (const BlockState<3>& s : rolling_poses(scene, block)) {
        for (double reach = 0.01; reach < 1.0; reach *= 1.3) {
            finder.detect(s.position, s.orientation.toRotationMatrix(), reach, contacts);
            if (contacts.size() >= count) break;
        }
        if (contacts.size() < count) continue;
        std::sort(contacts.begin(), contacts.end(),
                  [](const Contact<3>& a, const Contact<3>& b) { return a.gap < b.gap; });
        contacts.resize(count);
        problems.push_back(problem_of(block, s, contacts));
        if (problems.size() == kProblems) break;
    }
    return problems;
}

/// Contact problems without a first guess. Arguments: number of contacts, digits of the tolerance.
void solver(benchmark::State& state) {
    const auto problems = problems_of_size(static_cast<std::size_t>(state.range(0)));
    ContactSolverSettings settings;
    settings.tolerance = std::pow(10.0, -static_cast<double>(state.range(1)));
    Eigen::VectorXd impulse;
    std::int64_t solved = 0, iterations = 0, unconverged = 0;
    WorkMeter meter;
    meter.measure([&] {
        for (auto _ : state) {
            const ContactProblem<3>& problem = problems[static_cast<std::size_t>(solved) % problems.size()];
            impulse.setZero(problem.free_velocity.size());
            const ContactSolverReport r = solve_contacts(problem, settings, impulse);
            iterations += r.newton_iterations;
            unconverged += r.status == SolverStatus::NotConverged;
            ++solved;
        }
    });
    report(state, solved, meter);
    state.counters["newton_iterations"] = static_cast<double>(iterations) / static_cast<double>(solved);
    state.counters["unconverged"] = static_cast<double>(unconverged) / static_cast<double>(solved);
}
BENCHMARK(solver)
    ->ArgNames({"contacts", "digits"})
    ->ArgsProduct({{1, 2, 3, 4, 6}, {4}})
    ->ArgsProduct({{1, 2, 3, 4, 6}, {10}})
    ->Unit(benchmark::kNanosecond);

/// Ends where a block that flies first touches something.
class FirstContact final : public MotionSink<3> {
public:
    void segment(const MotionSegment<3>& motion) override {
        if (time <= 0.0) time = motion.in_contact ? motion.start : motion.start + motion.duration;
    }
    double time = 0.0;  ///< [s]
};

/// Flights from the release to just before the ground, turning at 5 rad/s, moving at 8 m/s along the slope. Argument: rough.
void flight(benchmark::State& state) {
    const Scene& scene = Scene::get(state.range(0) != 0 ? Ground::Rough : Ground::Smooth);
    struct Flight {
        ConvexBlock block;
        BlockState<3> start;
        DynamicsSettings settings;
    };
    std::vector<Flight> flights;
    for (std::uint64_t number = 0; number < kTracks; ++number) {
        Flight f{scene.block(number), {}, {}};
        f.start = scene.release(f.block, number);
        f.start.velocity = {6.5, 0.0, -4.5};
        f.start.spin = {1.0, 4.8, 1.0};
        FirstContact contact;
        simulate_block(f.block, f.start, *scene.surface, scene.site.campaign.soils, f.settings, &contact);
        f.settings.time_limit = 0.98 * contact.time;
        flights.push_back(std::move(f));
    }
    std::int64_t flown = 0, looks = 0;
    double seconds = 0.0;
    WorkMeter meter;
    meter.measure([&] {
        for (auto _ : state) {
            const Flight& f = flights[static_cast<std::size_t>(flown) % flights.size()];
            const TrajectoryEnd<3> end =
                simulate_block(f.block, f.start, *scene.surface, scene.site.campaign.soils, f.settings);
            looks += end.counters.flight_evaluations;
            seconds += end.time;
            ++flown;
        }
    });
    report(state, flown, meter);
    state.counters["looks"] = static_cast<double>(looks) / static_cast<double>(flown);
    state.counters["flight_s"] = seconds / static_cast<double>(flown);
}
BENCHMARK(flight)->ArgName("rough")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

}  // namespace

}  // namespace scree::bench
