// SPDX-License-Identifier: GPL-3.0-or-later
// What must not matter: the direction of the slope, its mirror image, where the site lies, how a plane is cut into triangles.
//
// Trajectories of blocks are chaotic: differences grow at every impact, and in jumps where several contacts share an impulse in more than one
// way. The window holds the first impacts only. In event mode the moment of an impact is located to half the activation gap, along
// a way of halvings that depends on the patch of terrain around the block: that, not rounding, is what a turn or a mirror leaves, so the gap is made
// small here and the tolerance is a multiple of it.
#include "scree/geometry/local_frame.hpp"
#include "support/motion.hpp"
#include "support/scenes.hpp"
#include "support/terrains.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scree::test {

namespace {

constexpr double kWindow = 0.75;                        ///< [s]
constexpr double kActivationGap = 1e-6;                 ///< [m]
constexpr double kSame = 1e-6;                          ///< where nothing but rounding differs [m]
constexpr double kSameLocated = 30.0 * kActivationGap;  ///< where impacts are located on other ways [m]
constexpr double kSlope = 36 * kDegree;

const Soil kSoil{"slope", 0.2, 0.5, 0.04};

}  // namespace

class Invariance : public testing::TestWithParam<SteppingMode> {
protected:
    DynamicsSettings settings() const {
        DynamicsSettings s = tight_settings(GetParam());
        s.activation_gap = kActivationGap;
        return s;
    }
    static FramedBlock block(std::uint64_t number) {
        RandomStream random(31, number, RandomPurpose::Shape);
        std::vector<Vec3> points;
        for (int k = 0; k < 25; ++k) {
            const double x = random.uniform(-0.45, 0.45), y = random.uniform(-0.35, 0.35),
                         z = random.uniform(-0.28, 0.28);
            points.emplace_back(x, y, z);
        }
        return {points, 400.0};
    }
    static BlockState<3> release(std::uint64_t number) {
        RandomStream random(31, number, RandomPurpose::Orientation);
        BlockState<3> s;
        const double w = random.normal(), x = random.normal(), y = random.normal(), z = random.normal();
        s.orientation = Quat(w, x, y, z).normalized();
        s.position = {-6.0, 0.15, 6.0 * std::tan(kSlope) + 1.2};
        s.velocity = {1.0, 0.5, 0.0};
        s.spin = {1.0, 2.0, -1.0};
        return s;
    }
    TrajectoryEnd<3> thrown(const FramedBlock& body, const Surface& surface, const BlockState<3>& from) const {
        return HullMechanics{body.block, surface, {kSoil}, settings()}.until(kWindow, body.to_block(from));
    }
    static void expect_same(const BlockState<3>& a, const BlockState<3>& b, double tolerance, double& largest) {
        largest = std::max(largest, (a.position - b.position).norm());
        EXPECT_LT((a.position - b.position).norm(), tolerance);
        EXPECT_LT((a.velocity - b.velocity).norm(),
                  30.0 * tolerance);  // after the last impact a difference has had 0.1 s to become one of position
    }
    double turned_tolerance() const { return GetParam() == SteppingMode::Event ? kSameLocated : kSame; }
};

INSTANTIATE_TEST_SUITE_P(Modes, Invariance, testing::Values(SteppingMode::Event, SteppingMode::MoreauJean),
                         [](const auto& p) {
                             return std::string(kSteppingModeNames[static_cast<std::size_t>(p.param)]);
                         });

// A rough mesh, the block and its motion turned about the vertical: the whole trajectory turns with them.
TEST_P(Invariance, TurnedAboutTheVertical) {
    const TriangleMesh mesh = cut_mesh(15.0, 1.0, Cut::Grid, rough_slope(kSlope, 0.05));
    const auto surface = make_mesh_surface(mesh);
    double largest = 0.0;
    for (std::uint64_t number = 0; number < 6; ++number) {
        const FramedBlock body = block(number);
        const TrajectoryEnd<3> expected = thrown(body, *surface, release(number));
        EXPECT_GT(expected.counters.contact_steps, 0);
        for (const double angle : {30.0, 90.0, 217.0}) {
            const Quat turn(Eigen::AngleAxisd(angle * kDegree, Vec3::UnitZ()));
            const auto turned_surface = make_mesh_surface(mapped(mesh, [&](const Vec3& p) { return turn * p; }));
            BlockState<3> s = release(number);
            s.position = turn * s.position;
            s.velocity = turn * s.velocity;
            s.orientation = turn * s.orientation;
            BlockState<3> end = thrown(body, *turned_surface, s).state;
            end.position = turn.conjugate() * end.position;
            end.velocity = turn.conjugate() * end.velocity;
            expect_same(end, expected.state, turned_tolerance(), largest);
        }
    }
    RecordProperty("largest_m", testing::PrintToString(largest));
}

// Mirrored at the plane y = 0: terrain, block (its points), position and velocity; the spin is an axial vector.
TEST_P(Invariance, Mirrored) {
    const TriangleMesh mesh = cut_mesh(15.0, 1.0, Cut::Grid, rough_slope(kSlope, 0.05));
    const auto surface = make_mesh_surface(mesh);
    auto mirror = [](const Vec3& p) { return Vec3(p.x(), -p.y(), p.z()); };
    const auto mirrored_surface = make_mesh_surface(mapped(mesh, mirror, true));
    double largest = 0.0;
    for (std::uint64_t number = 0; number < 6; ++number) {
        const FramedBlock body = block(number);
        // the points in the local frame's directions, so that the orientation is the identity and mirrors to itself
        std::vector<Vec3> points, mirrored_points;
        BlockState<3> s = release(number);
        for (Eigen::Index i = 0; i < body.block.vertex_count(); ++i) {
            points.push_back(s.orientation * body.block.vertex(i));
            mirrored_points.push_back(mirror(points.back()));
        }
        s.orientation.setIdentity();
        const TrajectoryEnd<3> expected = thrown({points, 400.0}, *surface, s);
        s.position = mirror(s.position);
        s.velocity = mirror(s.velocity);
        s.spin = -mirror(s.spin);
        BlockState<3> end = thrown({mirrored_points, 400.0}, *mirrored_surface, s).state;
        end.position = mirror(end.position);
        end.velocity = mirror(end.velocity);
        expect_same(end, expected.state, turned_tolerance(), largest);
    }
    RecordProperty("largest_m", testing::PrintToString(largest));
}

// Map coordinates of 1e6 m never reach the core: a site moved by whole metres with its local origin gives the same bits.
TEST_P(Invariance, MovedWithItsLocalFrame) {
    const auto heights = rough_slope(kSlope, 0.05);
    auto site = [&](double easting, double northing) {
        const LocalFrame frame{easting, northing, 500.0, ""};
        TriangleMesh mesh = cut_mesh(15.0, 1.0, Cut::Grid, heights);
        for (Vec3& v : mesh.vertices) {
            v.z() = std::round(v.z() * 1024.0) / 1024.0;  // exact in either frame
            v = frame.to_local(frame.to_map(v));
        }
        return make_mesh_surface(std::move(mesh));
    };
    const auto here = site(0.0, 0.0), far = site(2'600'000.0, 1'200'000.0);
    for (std::uint64_t number = 0; number < 4; ++number) {
        const FramedBlock body = block(number);
        const TrajectoryEnd<3> a = thrown(body, *here, release(number)), b = thrown(body, *far, release(number));
        EXPECT_EQ(a.state.position, b.state.position);
        EXPECT_EQ(a.state.velocity, b.state.velocity);
        EXPECT_EQ(a.state.spin, b.state.spin);
    }
}

// A plane is a plane: whatever its triangles. Corner contacts on a slope with nodes under the path, and with coarse and fine cells.
TEST_P(Invariance, CutOfAPlane) {
    auto plane = [](double x, double) { return -std::tan(kSlope) * x; };
    const auto grid = grid_terrain(16.0, 1.0, plane);
    std::vector<std::unique_ptr<Surface>> cuts;
    for (const Cut cut : {Cut::Grid, Cut::OtherDiagonal, Cut::Alternating, Cut::Random})
        cuts.push_back(make_mesh_surface(cut_mesh(16.0, 1.0, cut, plane)));
    cuts.push_back(grid_terrain(16.0, 0.25, plane));
    cuts.push_back(grid_terrain(16.0, 8.0, plane));
    double largest = 0.0;
    for (std::uint64_t number = 0; number < 6; ++number) {
        const FramedBlock body = block(number);
        const TrajectoryEnd<3> expected = thrown(body, *grid, release(number));
        EXPECT_GT(expected.counters.contact_steps, 0);
        for (const auto& surface : cuts)
            expect_same(thrown(body, *surface, release(number)).state, expected.state, kSame, largest);
    }
    RecordProperty("largest_m", testing::PrintToString(largest));
}

}  // namespace scree::test
