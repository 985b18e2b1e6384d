// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/base/assert.hpp"
#include "scree/base/error.hpp"
#include "scree/dynamics/effects.hpp"
#include "scree/geometry/surface.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace scree {

namespace {

std::size_t parameter_index(EffectKind kind, std::string_view key) {
    const auto parameters = effect_info(kind).parameters;
    const auto found = std::find_if(parameters.begin(), parameters.end(), [&](const auto& p) { return key == p.key; });
    SCREE_ASSERT(found != parameters.end());
    return static_cast<std::size_t>(found - parameters.begin());
}

/// Share of the segment a-b at which it meets the segment c-d, infinite if it does not or only in a.
double meeting(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const Vec2 way = b - a, edge = d - c, w = c - a;
    const double determinant = cross(way, edge);
    if (determinant == 0.0) return kInfinity;
    const double s = cross(w, edge) / determinant, r = cross(w, way) / determinant;
    return s > 0.0 && s <= 1.0 && r >= 0.0 && r <= 1.0 ? s : kInfinity;
}

/// The same on a line: where the way from a to b meets c.
double meeting(double a, double b, double c) {
    const double s = (c - a) / (b - a);
    return a != b && s > 0.0 && s <= 1.0 ? s : kInfinity;
}

}  // namespace

// ---- place -------------------------------------------------------------------------------------------------------------------------

void EffectPlace::limit_to(MultiPolygon polygons) {
    Region region(polygons);
    area = std::make_shared<const Area>(Area{std::move(polygons), std::move(region)});
}

void EffectPlace::sort_points() {
    std::stable_sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); });
}

bool EffectPlace::covers(int soil_there, const Vec2& plan) const {
    return (soil < 0 || soil == soil_there) && (!area || area->region.contains(plan));
}

bool EffectPlace::covers(int soil_there, const Eigen::Matrix<double, 1, 1>& plan) const {
    if (soil >= 0 && soil != soil_there) return false;
    return !reaches || std::any_of(reaches->begin(), reaches->end(),
                                   [&](const Stretch& r) { return plan[0] >= r.from && plan[0] <= r.to; });
}

double EffectPlace::first_border(const Vec2& from, const Vec2& to) const {
    return area ? area->region.first_border(from, to) : kInfinity;
}

double EffectPlace::first_border(const Eigen::Matrix<double, 1, 1>& from, const Eigen::Matrix<double, 1, 1>& to) const {
    double first = kInfinity;
    if (!reaches) return first;
    for (const Stretch& r : *reaches)
        first = std::min({first, meeting(from[0], to[0], r.from), meeting(from[0], to[0], r.to)});
    return first;
}

double EffectPlace::next_line(const Vec2& from, const Vec2& to, double after) const {
    double first = kInfinity;
    for (const Points& line : lines)
        for (std::size_t k = 1; k < line.size(); ++k) {
            const double share = meeting(from, to, line[k - 1].head<2>(), line[k].head<2>());
            if (share > after) first = std::min(first, share);
        }
    return first;
}

double EffectPlace::next_line(const Eigen::Matrix<double, 1, 1>& from, const Eigen::Matrix<double, 1, 1>& to,
                              double after) const {
    double first = kInfinity;
    for (const double station : stations) {
        const double share = meeting(from[0], to[0], station);
        if (share > after) first = std::min(first, share);
    }
    return first;
}

// ---- effect ------------------------------------------------------------------------------------------------------------------------

const EffectParameter& effect_parameter(EffectKind kind, std::string_view key) {
    return effect_info(kind).parameters[parameter_index(kind, key)];
}

double Effect::value(std::string_view key) const {
    return values[parameter_index(kind, key)];
}

void Effect::set(std::string_view key, double value) {
    values[parameter_index(kind, key)] = value;
}

Effect make_effect(EffectKind kind) {
    Effect effect;
    effect.kind = kind;
    const auto parameters = effect_info(kind).parameters;
    for (std::size_t k = 0; k < parameters.size(); ++k) effect.values[k] = parameters[k].standard;
    return effect;
}

RandomStream effect_stream(std::uint64_t seed, EffectKind kind, std::uint64_t number, std::uint64_t block) {
    constexpr int kKindBits = 48, kNumberBits = 40;  // where kind and number begin, above the block
    return {seed, block | (static_cast<std::uint64_t>(kind) << kKindBits) | ((number & 0xff) << kNumberBits),
            RandomPurpose::Effect};
}

bool acts_on_motion(EffectKind kind) {
    const EffectHook hook = effect_info(kind).hook;
    return hook == EffectHook::ContactLaw || hook == EffectHook::Impact || hook == EffectHook::ContactForce ||
           hook == EffectHook::Force || hook == EffectHook::Crossing;
}

void check_effect(const Effect& effect, bool event_mode) {
    const EffectInfo& info = effect_info(effect.kind);
    const EffectPlace& place = effect.place;
    const std::string name = std::string("effect ") + info.name;
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
        const EffectParameter& p = info.parameters[k];
        const double value = effect.values[k];
        const bool unset = std::isnan(value) && std::isnan(p.standard);
        const bool neutral = value == p.neutral;  // also where the range ends before
        if (unset || neutral || (value >= p.low && value <= p.high)) continue;
        std::ostringstream text;
        text << name << ": " << p.key << " = " << value << " is not allowed: give a number from " << p.low << " to "
             << p.high;
        throw InputError(text.str());
    }
    auto refuse = [&](bool given, bool allowed, const char* what) {
        if (given && !allowed) throw InputError(name + " cannot be limited to " + what + ": remove that");
    };
    refuse(place.soil >= 0, info.limits.soil, "a soil");
    refuse(!place.screen.empty(), info.limits.screen, "a screen");
    refuse(place.area || place.reaches, info.limits.zone, "polygons or a reach");
    refuse(!place.points.empty(), info.limits.points, "points");
    refuse(!place.lines.empty() || !place.stations.empty(), info.limits.lines, "lines");
    if (info.limits.needs_impact && !event_mode)
        throw InputError(name +
                         " acts at the instant of an impact, which model.mode = \"moreau_jean\" does not know: use "
                         "\"event\"");
}

// ---- along a profile ---------------------------------------------------------------------------------------------------------------

namespace {

/// What two lists of stretches have in common.
std::vector<Stretch> overlaps(const std::vector<Stretch>& some, const std::vector<Stretch>& others) {
    std::vector<Stretch> common;
    for (const Stretch& a : some)
        for (const Stretch& b : others)
            if (std::max(a.from, b.from) < std::min(a.to, b.to))
                common.push_back({std::max(a.from, b.from), std::min(a.to, b.to)});
    return common;
}

}  // namespace

std::vector<Effect> effects_along(std::span<const Effect> effects, const Profile& profile) {
    std::vector<Effect> result(effects.begin(), effects.end());
    for (Effect& effect : result) {
        EffectPlace& place = effect.place;
        if (place.area) {
            const std::vector<Stretch> inside = profile.inside(place.area->polygons);
            place.reaches = place.reaches ? overlaps(inside, *place.reaches) : inside;
        }
        for (const Points& line : place.lines) {
            if (effect.kind == EffectKind::Berm) break;  // it is in the surface that the profile was cut from
            std::vector<Vec2> plan;
            for (const Vec3& p : line) plan.push_back(p.head<2>());
            for (const double s : profile.crossings(plan)) place.stations.push_back(s);
        }
        for (Vec3& p : place.points) {
            const Profile::Nearest nearest = profile.nearest(p.head<2>());
            p = {nearest.s, nearest.offset, kNaN};
        }
        std::sort(place.stations.begin(), place.stations.end());
        place.sort_points();
        place.area.reset();
        place.lines.clear();
    }
    return result;
}

// ---- berms -------------------------------------------------------------------------------------------------------------------------

namespace {

double distance(const Vec2& p, const Points& line) {
    double least = kInfinity;
    for (std::size_t k = 1; k < line.size(); ++k) {
        const Vec2 a = line[k - 1].head<2>(), way = line[k].head<2>() - a;
        const double t = std::clamp((p - a).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
        least = std::min(least, (p - a - t * way).norm());
    }
    return least;
}

double distance(double s, const std::vector<double>& stations) {
    double least = kInfinity;
    for (const double station : stations) least = std::min(least, std::abs(s - station));
    return least;
}

/// Height of a berm above the ground at the distance d from its line [m].
double berm_height(const Effect& berm, double d) {
    return berm.value("height") * std::max(0.0, 1.0 - 2.0 * d / berm.value("width"));
}

/// Of all berms at a place in plan [m].
double raised_by(std::span<const Effect> effects, const Vec2& p) {
    double raise = 0.0;
    for (const Effect& effect : effects) {
        if (effect.kind != EffectKind::Berm) continue;
        double d = kInfinity;
        for (const Points& line : effect.place.lines) d = std::min(d, distance(p, line));
        if (std::isfinite(d)) raise += berm_height(effect, d);
    }
    return raise;
}

bool has_berm(std::span<const Effect> effects) {
    return std::any_of(effects.begin(), effects.end(), [](const Effect& e) { return e.kind == EffectKind::Berm; });
}

}  // namespace

void raise_berms(std::span<const Effect> effects, Grid<double>& heights) {
    if (!has_berm(effects)) return;
    for (int row = 0; row < heights.shape.rows; ++row)
        for (int column = 0; column < heights.shape.columns; ++column)
            heights.at(column, row) += raised_by(effects, heights.shape.centre(column, row));
}

BermCrest crest_of(const Effect& berm, const GridShape& shape) {
    constexpr double kSamplesOfACell = 8.0;
    BermCrest crest;
    double sum = 0.0, count = 0.0;
    for (const Points& line : berm.place.lines)
        for (std::size_t k = 1; k < line.size(); ++k) {
            const Vec2 from = line[k - 1].head<2>(), to = line[k].head<2>();
            const Vec2 low = from.cwiseMin(to), high = from.cwiseMax(to);
            GridShape around = shape;  // the nodes about this piece of the line
            const int west = std::max(shape.column_of(low.x()) - 1, 0), south = std::max(shape.row_of(low.y()) - 1, 0);
            around.columns = std::min(shape.column_of(high.x()) + 2, shape.columns) - west;
            around.rows = std::min(shape.row_of(high.y()) + 2, shape.rows) - south;
            if (around.columns < 2 || around.rows < 2) continue;
            around.origin += shape.cell * Vec2(west, south);
            Grid<double> raised(around, 0.0);
            raise_berms({&berm, 1}, raised);
            const auto surface = make_grid_surface(
                std::move(raised), std::vector<SoilId>(2 * static_cast<std::size_t>(around.columns - 1) *
                                                       static_cast<std::size_t>(around.rows - 1)));
            const double steps = std::max(std::ceil(kSamplesOfACell * (to - from).norm() / shape.cell), 1.0);
            for (double step = 0.0; step <= steps; ++step) {
                const double height = surface->height(from + step / steps * (to - from));
                if (!std::isfinite(height)) continue;
                crest.lowest = std::fmin(crest.lowest, height);
                sum += height;
                count += 1.0;
            }
        }
    if (count > 0.0) crest.mean = sum / count;
    return crest;
}

Profile raise_berms(std::span<const Effect> effects, const Profile& profile) {
    Profile result = profile;
    if (!has_berm(effects) || profile.empty()) return result;
    auto insert = [&](double s) {
        if (!(s > 0.0 && s < result.length())) return;
        const std::size_t reach = result.reach_at(s);
        if (s - result.s[reach] < kShortestReach || result.s[reach + 1] - s < kShortestReach) return;
        const double z = result.height_at(s);
        const Vec2 place = result.place_at(s);
        const auto at = static_cast<std::ptrdiff_t>(reach) + 1;
        result.s.insert(result.s.begin() + at, s);
        result.z.insert(result.z.begin() + at, z);
        result.place.insert(result.place.begin() + at, place);
        result.soil.insert(result.soil.begin() + at, result.soil[reach]);
    };
    for (const Effect& effect : effects) {
        if (effect.kind != EffectKind::Berm) continue;
        const double half = 0.5 * effect.value("width");
        for (const double station : effect.place.stations)
            for (const double s : {station - half, station, station + half}) insert(s);
    }
    for (std::size_t k = 0; k < result.vertex_count(); ++k)
        for (const Effect& effect : effects)
            if (effect.kind == EffectKind::Berm && !effect.place.stations.empty())
                result.z[k] += berm_height(effect, distance(result.s[k], effect.place.stations));
    return result;
}

}  // namespace scree
