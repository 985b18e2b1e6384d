// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/ensemble/profile_release.hpp"

#include "ensemble/turned_free.hpp"

#include "scree/base/error.hpp"
#include "scree/dynamics/trajectory.hpp"
#include "scree/geometry/region.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

std::vector<Vec2> plan_of(const Polyline& line) {
    std::vector<Vec2> plan;
    for (const Vec3& p : line.points) plan.emplace_back(p.head<2>());
    return plan;
}

double length_of(const std::vector<Vec2>& line) {
    double length = 0.0;
    for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
    return length;
}

}  // namespace

ProfileRelease::ProfileRelease(const FeatureLayer& layer, std::span<const Profile> profiles, ReleasePattern pattern,
                               double cell, double farthest)
    : pattern_(pattern), used_(profiles.size(), false) {
    for (const Feature& feature : layer.features) {
        if (const auto* polygons = std::get_if<MultiPolygon>(&feature.geometry)) {
            std::vector<Span> spans;
            for (std::size_t k = 0; k < profiles.size(); ++k)
                for (const Stretch& s : profiles[k].inside(*polygons)) spans.push_back({k, s.from, s.to});
            for (const Span& span : spans)
                for (double s = (std::floor(span.from / cell) + 0.5) * cell; s < span.to; s += cell)
                    if (s >= span.from) cells_.push_back({span.profile, s, feature.id});
            add(feature.id, Region(*polygons).area(), std::move(spans));
        } else if (const auto* lines = std::get_if<Polylines>(&feature.geometry)) {
            for (const Polyline& line : *lines)
                add(feature.id, length_of(plan_of(line)), spans_of(line, profiles, farthest));
        } else if (const auto* points = std::get_if<Points>(&feature.geometry)) {
            for (const Vec3& p : *points) {
                std::vector<Span> spans;
                if (const auto at = foot(p.head<2>(), profiles, farthest)) spans.push_back({at->profile, at->s, at->s});
                add(feature.id, 1.0, std::move(spans));
            }
        }
    }
    if (sources_.empty())
        throw InputError("no profile meets a feature of the release layer " + layer.name +
                         ": lead profiles through its polygons, or nearer to its lines and points than "
                         "profile.release_distance; scree profile shows them");
    if (pattern == ReleasePattern::Cells && cells_.empty())
        throw InputError(
            "release.pattern is \"cells\", but no cell of a profile has its middle in a release polygon: "
            "draw larger polygons or use \"random\"");
    std::sort(left_out_.begin(), left_out_.end());
    left_out_.erase(std::unique(left_out_.begin(), left_out_.end()), left_out_.end());
}

void ProfileRelease::add(std::int64_t feature, double weight, std::vector<Span> spans) {
    if (!(weight > 0.0)) return;
    if (spans.empty()) {
        left_out_.push_back(feature);
        return;
    }
    Source source{feature, weight, std::move(spans), 0.0};
    for (const Span& span : source.spans) {
        source.length += span.to - span.from;
        used_[span.profile] = true;
    }
    total_weight_ += weight;
    sources_.push_back(std::move(source));
}

std::vector<ProfileRelease::Span> ProfileRelease::spans_of(const Polyline& line, std::span<const Profile> profiles,
                                                           double farthest) {
    const std::vector<Vec2> plan = plan_of(line);
    std::vector<Span> spans;
    for (std::size_t k = 0; k < profiles.size(); ++k)
        for (const double s : profiles[k].crossings(plan)) spans.push_back({k, s, s});
    if (!spans.empty()) return spans;
    double nearest = farthest;
    for (std::size_t k = 0; k < profiles.size(); ++k) {
        Span along{k, kInfinity, -kInfinity};
        double distance = 0.0;
        for (const Vec2& p : plan) {
            const Profile::Nearest foot = profiles[k].nearest(p);
            distance = std::max(distance, std::abs(foot.offset));
            along.from = std::min(along.from, foot.s);
            along.to = std::max(along.to, foot.s);
        }
        if (distance > nearest || (!spans.empty() && distance == nearest)) continue;
        nearest = distance;
        spans = {along};
    }
    return spans;
}

std::optional<ProfileRelease::Place> ProfileRelease::foot(const Vec2& point, std::span<const Profile> profiles,
                                                          double farthest) {
    std::optional<Place> place;
    double nearest = farthest;
    for (std::size_t k = 0; k < profiles.size(); ++k) {
        const Profile::Nearest at = profiles[k].nearest(point);
        const double distance = std::abs(at.offset);
        if (distance > nearest || (place && distance == nearest)) continue;
        nearest = distance;
        place = Place{k, at.s, kNoFeature};
    }
    return place;
}

ProfileRelease::Place ProfileRelease::draw(std::uint64_t seed, std::uint64_t block) const {
    if (pattern_ == ReleasePattern::Cells) return cells_[start_cell(seed, block, cells_.size())];
    RandomStream random(seed, block, RandomPurpose::ReleasePosition);
    double target = random.uniform() * total_weight_;
    std::size_t s = 0;
    while (s + 1 < sources_.size() && target >= sources_[s].weight) target -= sources_[s++].weight;
    const Source& source = sources_[s];
    if (source.length <= 0.0) {
        const Span& span = source.spans[static_cast<std::size_t>(random.below(source.spans.size()))];
        return {span.profile, span.from, source.feature};
    }
    double left = random.uniform() * source.length;
    std::size_t k = 0;
    while (k + 1 < source.spans.size() && left >= source.spans[k].to - source.spans[k].from) {
        left -= source.spans[k].to - source.spans[k].from;
        ++k;
    }
    const Span& span = source.spans[k];
    return {span.profile, std::min(span.from + left, span.to), source.feature};
}

BlockState<2> draw_release(const ReleaseSettings& settings, double chainage, const GroundLine& ground,
                           const ConvexPolygon& block, std::uint64_t seed, std::uint64_t number, double& raised) {
    RandomStream random(seed, number, RandomPurpose::Orientation);
    BlockState<2> state;
    state.orientation = 2.0 * std::numbers::pi * random.uniform();
    const double height = settings.height + settings.height_spread * random.uniform(-1.0, 1.0);
    state.position = {chainage, ground.height(chainage) + height};
    state.velocity = settings.speed * Vec2(std::cos(settings.elevation), std::sin(settings.elevation));
    state.spin[0] = random.uniform() < 0.5 ? -settings.spin : settings.spin;
    raised = clearing_lift(block, state, ground, kReleaseGap);
    state.position.y() += raised;
    return state;
}

BlockState<2> draw_departure(const Departure& from, const GroundLine& ground, const ConvexPolygon& block,
                             std::uint64_t seed, std::uint64_t number, double& raised) {
    RandomStream random(seed, number, RandomPurpose::Orientation);
    BlockState<2> state;
    state.position = {from.s, from.position.z()};
    state.velocity = {from.velocity.head<2>().norm(), from.velocity.z()};
    state.spin[0] = -from.spin;  // angles count from x to z
    return turned_free(
        state, [&] { return 2.0 * std::numbers::pi * random.uniform(); },
        [&](const BlockState<2>& s) { return clearing_lift(block, s, ground, 0.0); }, raised);
}

}  // namespace scree
