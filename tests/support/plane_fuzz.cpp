// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/plane_fuzz.hpp"

#include "dynamics/plane_contacts.hpp"

#include "support/fuzz_parts.hpp"
#include "support/plane_scenes.hpp"
#include "support/scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace scree::test {

namespace {

/// How many block lengths the ground is long [-].
constexpr double kLengths = 40.0;

enum class Ground { Rough, Benches, Gully, Spikes, Noise };
constexpr std::array<const char*, 5> kGroundNames{"rough", "benches", "gully", "spikes", "noise"};

std::vector<Vec2> land(RandomStream& random, Ground kind, double length, double cell, double slope, double narrowest) {
    const bool even = random.uniform() < 0.3;
    const double noise =
        kind == Ground::Noise ? cell * random.uniform(0.2, 1.0) : cell * between_logs(random, 1e-3, 0.3);
    const double side = random.uniform(0.2, 2.0), bench = cell * random.uniform(2.0, 6.0);
    const double cliff = std::tan(random.uniform(85.0, 89.9) * kDegree);
    std::vector<Vec2> corners;
    double s = 0.0, fallen = 0.0;
    while (s < length) {
        double z = -std::tan(slope) * s + noise * random.uniform(-1.0, 1.0);
        if (kind == Ground::Gully) z += side * std::abs(s - 0.5 * length);
        if (kind == Ground::Spikes && random.uniform() < 0.2) z += cell * random.uniform(0.0, 5.0);
        corners.emplace_back(s, z - fallen);
        s += std::max(even ? cell : cell * between_logs(random, 0.01, 2.0),
                      kind == Ground::Spikes || kind == Ground::Noise ? narrowest : 0.0);
        if (kind == Ground::Benches && std::floor(s / bench) > std::floor(corners.back().x() / bench)) {
            const double drop = random.uniform(0.2, 3.0) * bench * (random.uniform() < 0.2 ? -0.3 : 1.0);
            const Vec2 edge(s, -std::tan(slope) * s - fallen);
            corners.push_back(edge);
            s += std::abs(drop) / cliff;
            fallen += drop;
            corners.emplace_back(s, edge.y() - drop);
            s += 0.5 * cell;
        }
    }
    return corners;
}

ConvexPolygon polygon(RandomStream& random, double largest, std::string& what) {
    static constexpr std::array<const char*, 6> names{"hull", "box", "plate", "triangle", "sharp", "ellipse"};
    const auto kind = random.below(names.size());
    what = names[kind];
    ShapeSettings shape;
    Vec3 size = largest * Vec3(1.0, random.uniform(0.3, 1.0), 0.3);
    if (kind == 2) size.y() = 0.1 * largest;
    const double mass = 2600.0 * size.prod();
    if (kind == 3)
        return make_polygon_from_points({{0.0, 0.0},
                                         {largest, random.uniform(-0.2, 0.2) * largest},
                                         {random.uniform(0.0, 1.0) * largest, random.uniform(0.25, 1.0) * largest}},
                                        mass);
    shape.shape = kind == 0   ? BlockShape::Hull
                  : kind == 4 ? BlockShape::Sharp
                  : kind == 5 ? BlockShape::Ellipsoid
                              : BlockShape::Box;
    return make_polygon(shape, size, mass, random);
}

}  // namespace

PlaneFuzzScene plane_fuzz_scene(std::uint64_t number) {
    RandomStream random(78, number, RandomPurpose::Effect);
    const auto kind = static_cast<Ground>(random.below(kGroundNames.size()));
    const double largest = between_logs(random, 0.01, 10.0), cell = largest * between_logs(random, 0.1, 10.0);
    const double slope =
        random.uniform() < 0.2 ? 85.0 * kDegree * random.uniform() : random.uniform(-10.0, 50.0) * kDegree;
    const double length = kLengths * std::max(largest, cell);
    std::string shape;
    const ConvexPolygon block = polygon(random, largest, shape);
    const std::vector<Vec2> corners = land(random, kind, length, cell, slope, 2.0 * block.inner_radius);
    std::vector<SoilId> soil(corners.size() - 1);
    for (SoilId& s : soil) s = static_cast<SoilId>(random.below(2));
    PlaneFuzzScene scene{{}, GroundLine(profile_of(corners, soil)), {}, block, {}};
    scene.soils = two_soils(random, block.inner_radius);
    BlockState<2>& s = scene.release;
    s.position.x() = scene.ground.length() * random.uniform(0.1, 0.7);
    s.position.y() = scene.ground.height(s.position.x()) + random.uniform(0.0, 2.0) * largest;
    s.orientation = random.uniform(0.0, 2.0 * std::numbers::pi);
    s.position.y() += clearing_lift(block, s, scene.ground, 1e-3);
    const double speed = random.uniform() < 0.3 ? 0.0 : between_logs(random, 0.1, 60.0);
    const double towards = random.uniform(0.0, 2.0 * std::numbers::pi);
    s.velocity = speed * Vec2(std::cos(towards), std::sin(towards));
    s.spin[0] = std::min(60.0, 0.2 + speed) * random.uniform(-1.0, 1.0) / block.radius;
    std::ostringstream what;
    what << "scene " << number << ": " << shape << " of " << largest << " m on "
         << kGroundNames[static_cast<std::size_t>(kind)] << ", reaches about " << cell << " m, slope "
         << slope / kDegree << " deg, " << speed << " m/s";
    scene.what = what.str();
    return scene;
}

FuzzOutcome<2> plane_fuzz_block(const PlaneFuzzScene& scene, const DynamicsSettings& settings,
                                std::span<const Effect> effects) {
    return thrown<2, PlaneContacts>(scene.block, scene.release, scene.ground, scene.soils, settings, effects,
                                    scaled_polygon);
}

}  // namespace scree::test
