// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/fuzz.hpp"

#include "dynamics/hull_contacts.hpp"

#include "support/fuzz_parts.hpp"
#include "support/scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace scree::test {

namespace {

constexpr int kNodes = 25;

enum class Land { Rough, Ridge, Gully, Cliffs, Noise, Holes };
constexpr std::array<const char*, 6> kLandNames{"rough", "ridge", "gully", "cliffs", "noise", "holes"};

Grid<double> land(RandomStream& random, Land kind, double cell, double slope) {
    GridShape shape;
    shape.columns = shape.rows = kNodes;
    shape.cell = cell;
    shape.origin = Vec2::Constant(-0.5 * kNodes * cell);
    Grid<double> heights(shape);
    const double noise = kind == Land::Noise ? cell * random.uniform(0.2, 1.0) : cell * between_logs(random, 1e-3, 0.3);
    const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi), side = random.uniform(0.2, 2.0);
    const double bench = cell * random.uniform(2.0, 6.0), cliff = std::tan(85.0 * kDegree);
    for (int j = 0; j < kNodes; ++j) {
        for (int i = 0; i < kNodes; ++i) {
            const Vec2 p = shape.centre(i, j);
            const double along = p.x() * std::cos(azimuth) + p.y() * std::sin(azimuth),
                         across = p.y() * std::cos(azimuth) - p.x() * std::sin(azimuth);
            double z = -std::tan(slope) * along + noise * random.uniform(-1.0, 1.0);
            if (kind == Land::Ridge) z -= side * std::abs(across);
            if (kind == Land::Gully) z += side * std::abs(across);
            if (kind == Land::Cliffs) z -= std::floor(along / bench) * cliff * cell;
            if (kind == Land::Holes && random.uniform() < 0.04) z = kNaN;
            heights.at(i, j) = z;
        }
    }
    return heights;
}

ConvexBlock block(RandomStream& random, double largest, std::string& what) {
    static constexpr std::array<const char*, 6> names{"hull", "box", "plate", "needle", "sharp", "hull plate"};
    const auto kind = random.below(names.size());
    what = names[kind];
    ShapeSettings shape;
    shape.shape = kind == 0 || kind == 5 ? BlockShape::Hull : kind == 4 ? BlockShape::Sharp : BlockShape::Box;
    Vec3 size = largest * Vec3(1.0, random.uniform(0.5, 1.0), random.uniform(0.3, 0.5));
    if (kind == 2 || kind == 5) size = largest * Vec3(1.0, 0.5, 0.1);
    if (kind == 3) size = largest * Vec3(1.0, 0.1, 0.1);
    return make_block(shape, size, 2600.0 * size.prod(), random);
}

Quat any_orientation(RandomStream& random) {
    return Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
}
Vec3 any_direction(RandomStream& random) {
    return Vec3(random.normal(), random.normal(), random.normal()).normalized();
}

}  // namespace

FuzzScene fuzz_scene(std::uint64_t number) {
    RandomStream random(77, number, RandomPurpose::Effect);
    FuzzScene scene;
    const auto kind = static_cast<Land>(random.below(kLandNames.size()));
    const double cell = between_logs(random, 0.2, 10.0);
    const double slope =
        random.uniform() < 0.2 ? 85.0 * kDegree * random.uniform() : random.uniform(0.0, 50.0) * kDegree;
    Grid<double> heights = land(random, kind, cell, slope);
    std::vector<SoilId> soil(grid_facet_count(heights.shape));
    for (SoilId& s : soil) s = static_cast<SoilId>(random.below(2));
    scene.surface = make_grid_surface(heights, soil);

    const double largest = between_logs(random, 0.01, std::min(10.0, 6.0 * cell));
    std::string shape;
    scene.block = block(random, largest, shape);
    scene.soils = two_soils(random, scene.block.inner_radius);
    const double half = 0.25 * kNodes * cell;
    BlockState<3>& s = scene.release;
    s.position = {random.uniform(-half, half), random.uniform(-half, half), 0.0};
    const double ground = scene.surface->height(s.position.head<2>());
    s.position.z() = (std::isfinite(ground) ? ground : 0.0) + random.uniform(0.0, 2.0) * largest;
    s.orientation = any_orientation(random);
    s.position.z() += clearing_lift(scene.block, s, *scene.surface, 1e-3);
    const double speed = random.uniform() < 0.3 ? 0.0 : between_logs(random, 0.1, 60.0);
    s.velocity = speed * any_direction(random);
    s.spin = std::min(60.0, 0.2 + speed) * random.uniform() / scene.block.radius * any_direction(random);
    std::ostringstream what;
    what << "scene " << number << ": " << shape << " of " << largest << " m on "
         << kLandNames[static_cast<std::size_t>(kind)] << ", cells " << cell << " m, slope " << slope / kDegree
         << " deg, " << speed << " m/s";
    scene.what = what.str();
    return scene;
}

DynamicsSettings fuzz_settings() {
    DynamicsSettings settings;
    settings.time_limit = 30.0;
    return settings;
}

FuzzOutcome<3> fuzz_block(const FuzzScene& scene, const DynamicsSettings& settings, std::span<const Effect> effects) {
    return thrown<3, HullContacts>(scene.block, scene.release, *scene.surface, scene.soils, settings, effects,
                                   scaled_block);
}

}  // namespace scree::test
