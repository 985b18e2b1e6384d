// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/release.hpp"

#include "ensemble/turned_free.hpp"

#include "scree/base/error.hpp"
#include "scree/dynamics/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

/// Trial points per source by which the share inside the terrain is estimated.
constexpr int kTrials = 200;
/// Draws before a block that always lands off the terrain is given up; the estimate above has then already refused such areas.
constexpr int kMostDraws = 100000;

double plan_length(const Polyline& line) {
    double length = 0.0;
    for (std::size_t i = 1; i < line.points.size(); ++i)
        length += (line.points[i] - line.points[i - 1]).head<2>().norm();
    return length;
}

Quat uniform_orientation(RandomStream& random) {
    // Shoemake 1992, Graphics Gems III: uniform on the unit quaternions
    const double u = random.uniform(), a = 2.0 * std::numbers::pi * random.uniform(),
                 b = 2.0 * std::numbers::pi * random.uniform();
    const double s = std::sqrt(1.0 - u), t = std::sqrt(u);
    return {t * std::cos(b), s * std::sin(a), s * std::cos(a), t * std::sin(b)};
}

}  // namespace

ReleaseArea::ReleaseArea(const FeatureLayer& layer, const Surface& surface, ReleasePattern pattern,
                         const GridShape& cells)
    : surface_(surface), pattern_(pattern) {
    for (const Feature& feature : layer.features) {
        if (const auto* polygons = std::get_if<MultiPolygon>(&feature.geometry)) {
            const Region region(*polygons);
            if (region.area() > 0.0) sources_.push_back({feature.id, region.area(), region});
        } else if (const auto* lines = std::get_if<Polylines>(&feature.geometry)) {
            for (const Polyline& line : *lines)
                if (plan_length(line) > 0.0) sources_.push_back({feature.id, plan_length(line), line});
        } else if (const auto* points = std::get_if<Points>(&feature.geometry)) {
            for (const Vec3& p : *points) sources_.push_back({feature.id, 1.0, Vec2(p.head<2>())});
        }
    }
    if (sources_.empty())
        throw InputError("release layer " + layer.name +
                         " holds no polygon, line or point to release from: draw at least one");

    int inside = 0;
    RandomStream random(0, 0, RandomPurpose::ReleasePosition);
    for (Source& source : sources_) {
        int hits = 0;
        for (int k = 0; k < kTrials; ++k) hits += surface_.facet_at(draw_from(source, random)) >= 0 ? 1 : 0;
        const auto* region = std::get_if<Region>(&source.place);
        if (hits == 0 && (!region || starts_in(*region, cells).empty())) source.weight = 0.0;  // off it altogether
        inside += hits;
        total_weight_ += source.weight;
    }
    inside_share_ = static_cast<double>(inside) / (kTrials * static_cast<double>(sources_.size()));
    if (!(total_weight_ > 0.0))
        throw InputError(
            "release layer " + layer.name +
            " lies outside the terrain, over holes in it, or is so large that hardly any of it lies over the "
            "terrain: no block could start; cut it to the slopes that release blocks");
    if (pattern == ReleasePattern::Cells) find_cells(cells);
}

std::vector<Vec2> ReleaseArea::starts_in(const Region& region, const GridShape& cells) const {
    std::vector<Vec2> centres;
    const Box2 box = region.bounds();
    for (int j = std::max(0, cells.row_of(box.min.y())); j <= std::min(cells.rows - 1, cells.row_of(box.max.y())); ++j)
        for (int i = std::max(0, cells.column_of(box.min.x()));
             i <= std::min(cells.columns - 1, cells.column_of(box.max.x())); ++i) {
            const Vec2 centre = cells.centre(i, j);
            if (region.contains(centre) && surface_.facet_at(centre) >= 0) centres.push_back(centre);
        }
    return centres;
}

void ReleaseArea::find_cells(const GridShape& cells) {
    for (const Source& source : sources_)
        if (const auto* region = std::get_if<Region>(&source.place))
            for (const Vec2& centre : starts_in(*region, cells)) cells_.emplace_back(centre, source.feature);
    if (cells_.empty())
        throw InputError(
            "release.pattern is \"cells\", but no cell centre of the terrain lies in a release polygon: draw larger "
            "polygons or use \"random\"");
}

Vec2 ReleaseArea::draw_from(const Source& source, RandomStream& random) const {
    if (const auto* region = std::get_if<Region>(&source.place)) return region->sample(random);
    if (const auto* point = std::get_if<Vec2>(&source.place)) return *point;
    const auto& line = std::get<Polyline>(source.place);
    double left = random.uniform() * plan_length(line);
    for (std::size_t i = 1; i < line.points.size(); ++i) {
        const Vec2 a = line.points[i - 1].head<2>(), b = line.points[i].head<2>();
        const double length = (b - a).norm();
        if (left <= length || i + 1 == line.points.size())
            return a + std::min(left / std::max(length, 1e-300), 1.0) * (b - a);
        left -= length;
    }
    return line.points.front().head<2>();
}

std::uint64_t start_cell(std::uint64_t seed, std::uint64_t block, std::uint64_t count) {
    const std::uint64_t run = block / count;
    const std::uint64_t first = run == 0 ? 0 : RandomStream(seed, run, RandomPurpose::ReleasePosition).below(count);
    return (first + block % count) % count;
}

Vec2 ReleaseArea::draw(std::uint64_t seed, std::uint64_t block, std::int64_t& feature) const {
    if (pattern_ == ReleasePattern::Cells) {
        const auto& [centre, source] = cells_[start_cell(seed, block, cells_.size())];
        feature = source;
        return centre;
    }
    RandomStream random(seed, block, RandomPurpose::ReleasePosition);
    for (int k = 0; k < kMostDraws; ++k) {
        double target = random.uniform() * total_weight_;
        std::size_t s = 0;
        while (s + 1 < sources_.size() && target >= sources_[s].weight) target -= sources_[s++].weight;
        if (sources_[s].weight <= 0.0) continue;
        const Vec2 p = draw_from(sources_[s], random);
        if (surface_.facet_at(p) < 0) continue;
        feature = sources_[s].feature;
        return p;
    }
    throw InputError(
        "hardly any of the release area lies over the terrain: cut the polygons of release.file to the slopes that "
        "release blocks");
}

BlockState<3> draw_release(const ReleaseSettings& settings, const ReleaseArea& area, const Surface& surface,
                           const ConvexBlock& block, std::uint64_t seed, std::uint64_t number, std::int64_t& feature,
                           double& raised, const Vec2& fixed) {
    const Vec2 plan = std::isfinite(fixed.x()) ? fixed : area.draw(seed, number, feature);
    RandomStream random(seed, number, RandomPurpose::Orientation);
    BlockState<3> state;
    state.orientation = uniform_orientation(random);
    const double height = settings.height + settings.height_spread * random.uniform(-1.0, 1.0);
    state.position = {plan.x(), plan.y(), surface.height(plan) + height};
    state.velocity =
        settings.speed * Vec3(std::sin(settings.azimuth) * std::cos(settings.elevation),
                              std::cos(settings.azimuth) * std::cos(settings.elevation), std::sin(settings.elevation));
    const double z = random.uniform(-1.0, 1.0), phi = random.uniform(0.0, 2.0 * std::numbers::pi),
                 r = std::sqrt(1.0 - z * z);
    state.spin = settings.spin * Vec3(r * std::cos(phi), r * std::sin(phi), z);
    raised = clearing_lift(block, state, surface, kReleaseGap);
    state.position.z() += raised;
    return state;
}

BlockState<3> draw_departure(const Departure& from, const Surface& surface, const ConvexBlock& block,
                             std::uint64_t seed, std::uint64_t number, double& raised) {
    RandomStream random(seed, number, RandomPurpose::Orientation);
    BlockState<3> state;
    state.position = from.position;
    state.velocity = from.velocity;
    state = turned_free(
        state, [&] { return uniform_orientation(random); },
        [&](const BlockState<3>& s) { return clearing_lift(block, s, surface, 0.0); }, raised);
    const Vec3 across = Vec3::UnitZ().cross(from.velocity);  // rolling forward turns about it
    if (across.norm() > 0.0) state.spin = from.spin * (state.orientation.conjugate() * across.normalized());
    return state;
}

namespace {

/// Slopes under a block are those between points so far on either side [m].
constexpr double kSlopeBase = 2.0;
/// Where there is less ground to both sides it has no slope [m].
constexpr double kShortestBase = 0.05;
/// Gentler ground is level [-].
constexpr double kLevel = 1e-6;

/// By how much the ground falls per metre, from its height so far ahead; near an edge or a hole as far as there is ground [-].
template <class Height>
double fall_along(Height height) {
    const auto reach = [&](double side) {
        double by = kSlopeBase;
        while (by > kShortestBase && !std::isfinite(height(side * by))) by *= 0.5;
        return std::isfinite(height(side * by)) ? side * by : 0.0;
    };
    const double back = reach(-1.0), ahead = reach(1.0);
    return (height(back) - height(ahead)) / (ahead - back);
}

bool pushes(std::span<const Effect> effects) {
    return std::any_of(effects.begin(), effects.end(),
                       [](const Effect& e) { return e.kind == EffectKind::ReleaseMotion; });
}

}  // namespace

void push_release(std::span<const Effect> effects, const Surface& surface, BlockState<3>& state) {
    if (!pushes(effects)) return;
    const Vec2 p = state.position.head<2>();
    Vec2 fall;
    for (int k = 0; k < 2; ++k) fall[k] = fall_along([&](double by) { return surface.height(p + by * Vec2::Unit(k)); });
    if (!fall.allFinite() || fall.norm() < kLevel) return;
    const Vec3 down = Vec3(fall.x(), fall.y(), -fall.squaredNorm()).normalized();
    const Vec3 across = Vec3::UnitZ().cross(down).normalized();  // rolling downhill turns about it
    for (const Effect& effect : effects) {
        if (effect.kind != EffectKind::ReleaseMotion) continue;
        state.velocity += effect.value("speed") * down;
        state.spin += effect.value("spin") * (state.orientation.conjugate() * across);
    }
}

void push_release(std::span<const Effect> effects, const Profile& profile, BlockState<2>& state) {
    if (!pushes(effects)) return;
    const double s = state.position.x();
    const double fall = fall_along([&](double by) { return profile.height_at(s + by); });
    if (!std::isfinite(fall) || std::abs(fall) < kLevel) return;
    const double sign = fall > 0.0 ? 1.0 : -1.0;
    const Vec2 down = Vec2(sign, -std::abs(fall)).normalized();
    for (const Effect& effect : effects) {
        if (effect.kind != EffectKind::ReleaseMotion) continue;
        state.velocity += effect.value("speed") * down;
        state.spin[0] -= sign * effect.value("spin");  // angles count from x to z
    }
}

}  // namespace scree
