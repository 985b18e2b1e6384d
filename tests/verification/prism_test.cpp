// SPDX-License-Identifier: GPL-3.0-or-later
// A prism locked to a plane, on ground extruded across it, must move as its section does in the 2D model. Every contact of the plane is there twice, at
// both ends of the prism: a corner on a reach is two vertices on facets, a crest in a side two block edges on a terrain edge.
#include "support/motion.hpp"
#include "support/plane_scenes.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scree::test {

namespace {

constexpr double kWidth = 0.6;       ///< of the prism [m]
constexpr double kHalfGround = 2.0;  ///< of the ground across [m]
constexpr double kLocked = 1e6;      ///< factor of the moments about the other axes [-]

/// A rough slope: 30 degrees with bumps, a cliff of 3 m and a bench.
std::vector<Vec2> rough_slope(std::uint64_t number) {
    RandomStream random(61, number, RandomPurpose::Effect);
    std::vector<Vec2> corners;
    for (double s = 0.0; s < 60.0; s += random.uniform(0.3, 1.2)) {
        double z = -std::tan(30 * kDegree) * s + random.uniform(-0.08, 0.08);
        if (s > 12.0) z -= 3.0;
        if (s > 30.0) z = -std::tan(30 * kDegree) * 30.0 - 3.0 + random.uniform(-0.03, 0.03);
        corners.emplace_back(s, z);
    }
    return corners;
}

std::unique_ptr<Surface> extruded(const std::vector<Vec2>& corners) {
    TriangleMesh mesh;
    for (const Vec2& c : corners)
        for (const double y : {-kHalfGround, kHalfGround}) mesh.vertices.emplace_back(c.x(), y, c.y());
    for (std::int32_t k = 0; k + 1 < static_cast<std::int32_t>(corners.size()); ++k) {
        mesh.facets.push_back({2 * k, 2 * k + 2, 2 * k + 1});
        mesh.facets.push_back({2 * k + 2, 2 * k + 3, 2 * k + 1});
    }
    mesh.soil.assign(mesh.facets.size(), 0);
    return make_mesh_surface(mesh);
}

/// The polygon as a prism that cannot turn out of the plane; symmetry holds it in the plane otherwise.
FramedBlock prism(const ConvexPolygon& polygon) {
    std::vector<Vec3> points;
    for (Eigen::Index i = 0; i < polygon.vertex_count(); ++i)
        for (const double y : {-0.5 * kWidth, 0.5 * kWidth}) points.emplace_back(polygon.x[i], y, polygon.z[i]);
    FramedBlock body(points, polygon.mass);
    const Vec3 across = (body.to_body * Vec3::UnitY()).cwiseAbs();
    for (int k = 0; k < 3; ++k)
        if (across[k] < 0.9) body.block.inertia[k] *= kLocked;
    return body;
}

/// The angle counts from x to z, which is about -y.
BlockState<3> in_space(const BlockState<2>& s) {
    BlockState<3> t;
    t.position = {s.position.x(), 0.0, s.position.y()};
    t.velocity = {s.velocity.x(), 0.0, s.velocity.y()};
    t.orientation = Quat(Eigen::AngleAxisd(-s.orientation, Vec3::UnitY()));
    t.spin = {0.0, -s.spin[0], 0.0};
    return t;
}

struct Pair {
    std::vector<Vec2> corners;
    GroundLine ground;
    std::unique_ptr<Surface> surface;
    ConvexPolygon polygon;
    FramedBlock body;
    BlockState<2> release;

    explicit Pair(std::uint64_t number)
        : corners(rough_slope(number)),
          ground(ground_of(corners)),
          surface(extruded(corners)),
          polygon(random_polygon(number)),
          body(prism(polygon)) {
        RandomStream random(62, number, RandomPurpose::Orientation);
        release.position = {4.0, ground.height(4.0) + 1.5};
        release.orientation = random.uniform(0.0, 6.28);
        release.velocity = {random.uniform(0.0, 3.0), 0.0};
        release.spin[0] = random.uniform(-3.0, 0.0);
    }
    static ConvexPolygon random_polygon(std::uint64_t number) {
        RandomStream random(61, number, RandomPurpose::Shape);
        return make_polygon({}, {0.9, 0.7, kWidth}, 500.0, random);
    }
};

}  // namespace

TEST(Prism, HasTheMomentOfItsSection) {
    const Pair pair(1);
    const Vec3 across = (pair.body.to_body * Vec3::UnitY()).cwiseAbs();
    double about_axis = 0.0;
    for (int k = 0; k < 3; ++k)
        if (across[k] > 0.9) about_axis = pair.body.block.inertia[k];
    EXPECT_NEAR(about_axis / pair.polygon.inertia, 1.0, 1e-12);
}

// The same steps: what differs is rounding, the solver's last digits and the lock. Single contacts grow such differences tenfold a second.
TEST(Prism, FollowsTheSectionInFixedSteps) {
    for (std::uint64_t number = 0; number < 8; ++number) {
        const Pair pair(number);
        const std::vector<Soil> soils{{"s", 0.3, 0.5, 0.03}};
        const DynamicsSettings settings = reference_settings();
        MotionRecorder<2> in_plane;
        MotionRecorder<3> space;
        const double time = 2.0;
        PolygonMechanics{pair.polygon, pair.ground, soils, settings}.until(time, pair.release, &in_plane);
        HullMechanics{pair.body.block, *pair.surface, soils, settings}.until(
            time, pair.body.to_block(in_space(pair.release)), &space);
        bool touched = false;
        double deviation = 0.0;
        for (const auto& s : in_plane.segments()) {
            const Vec3 other = space.position(s.start);
            deviation = std::max(deviation, (Vec2(other.x(), other.z()) - s.position).norm());
            touched = touched || s.in_contact;
        }
        RecordProperty("deviation_" + std::to_string(number), testing::PrintToString(deviation));
        EXPECT_TRUE(touched);
        EXPECT_LT(deviation, 1e-8) << "pair " << number;
    }
}

// Event mode locates contacts within the activation gap, in space on a way of its own: differences begin with that size.
TEST(Prism, FollowsTheSectionInEventMode) {
    for (std::uint64_t number = 0; number < 8; ++number) {
        const Pair pair(number);
        const std::vector<Soil> soils{{"s", 0.3, 0.5, 0.03}};
        DynamicsSettings settings = tight_settings(SteppingMode::Event);
        settings.activation_gap = 1e-6;
        MotionRecorder<2> in_plane;
        MotionRecorder<3> space;
        const double time = 1.5;
        const auto a =
            PolygonMechanics{pair.polygon, pair.ground, soils, settings}.until(time, pair.release, &in_plane);
        const auto b = HullMechanics{pair.body.block, *pair.surface, soils, settings}.until(
            time, pair.body.to_block(in_space(pair.release)), &space);
        const double deviation = (Vec2(b.state.position.x(), b.state.position.z()) - a.state.position).norm();
        RecordProperty("deviation_" + std::to_string(number), testing::PrintToString(deviation));
        EXPECT_GT(a.counters.impacts, 0);
        EXPECT_LT(deviation, 1e-3) << "pair " << number;
    }
}

}  // namespace scree::test
