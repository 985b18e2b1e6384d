// SPDX-License-Identifier: GPL-3.0-or-later
// Steepest-slope profiles against lines that are known in closed form, and every rule of ProfileSettings on a terrain made for it.
//
// Tolerances. On a plane, and on any surface whose facets lie in the planes of the formula, a line is exact but for rounding (kExact).
// On a curved surface the facets are not the surface: lines through facets with cells of size h depart from the true line by an amount
// that falls with h. Measured (largest distance, h = 2, 1, 0.5, 0.25 m): dome 0.100, 0.021, 0.0057, 0.0018 m; saddle
// 1.04, 0.147, 0.040, 0.011 m; cone 0.57, 0.022, 0.019, 0.011 m. The tests ask for twice that, and that the error falls.
#include "scree/geometry/profile_trace.hpp"

#include "support/scenes.hpp"
#include "support/terrains.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

namespace scree::test {
namespace {

constexpr double kExact = 1e-9;  // [m] rounding of some hundred edges at coordinates of 100 m

using Height = std::function<double(double, double)>;

/// The pure steepest line: no average, no rules.
ProfileSettings bare() {
    ProfileSettings s;
    s.smoothing = 0.0;
    s.gentle_slope = 0.0;
    s.highest_rise = 0.0;
    s.run_up = 0.0;
    s.head = 0.0;
    return s;
}

ProfileTrace trace(const Surface& surface, const ProfileSettings& settings, const Vec2& start) {
    ProfileTracer tracer(surface, settings);
    return tracer.steepest(start);
}

/// Distance to the left of the ray from `start` along `direction`.
double aside(const Vec2& p, const Vec2& start, const Vec2& direction) {
    const Vec2 u = direction.normalized(), d = p - start;
    return u.x() * d.y() - u.y() * d.x();
}

/// Heights and soils of a trace are those of the surface, chainages are distances, and vertices lie on edges.
void expect_section(const ProfileTrace& t, const Surface& surface) {
    const Profile& p = t.profile;
    ASSERT_FALSE(p.empty());
    ASSERT_EQ(t.course.size(), p.reach_count());
    for (std::size_t k = 0; k < p.reach_count(); ++k) {
        EXPECT_NEAR(p.s[k + 1] - p.s[k], (p.place[k + 1] - p.place[k]).norm(), kExact);
        const Vec2 middle = 0.5 * (p.place[k] + p.place[k + 1]);
        EXPECT_NEAR(surface.height(middle), 0.5 * (p.z[k] + p.z[k + 1]), 1e-5) << "a reach lies in one facet";
        std::array<Vec3, 3> corners;
        SoilId soil = 0;
        ASSERT_TRUE(surface.facet(surface.facet_at(middle), corners, soil));
        EXPECT_EQ(p.soil[k], soil);
    }
}

/// Largest distance from the true line of a trace, as far as it is within `radius` of the origin.
double largest_error(const Surface& surface, const ProfileSettings& settings, const Vec2& start, double radius,
                     const std::function<double(const Vec2&)>& error) {
    const ProfileTrace t = trace(surface, settings, start);
    double largest = 0.0;
    for (const Vec2& p : t.profile.place)
        if (p.norm() <= radius) largest = std::max(largest, std::abs(error(p)));
    EXPECT_GT(t.profile.length(), 0.5 * radius);
    return largest;
}

// --- closed forms ---

TEST(ProfileTrace, PlaneAtEveryAzimuth) {
    for (int azimuth = 0; azimuth < 360; azimuth += 15) {
        const Vec2 down(std::cos(azimuth * kDegree), std::sin(azimuth * kDegree));
        const Height plane = [=](double x, double y) { return -std::tan(35 * kDegree) * down.dot(Vec2(x, y)); };
        const Vec2 start = -20.0 * down + Vec2(0.3, -0.7);
        const auto grid = grid_terrain(30.0, 1.0, plane);
        const auto mesh = make_mesh_surface(cut_mesh(30.0, 1.5, Cut::Alternating, plane));
        for (const Surface* surface : {grid.get(), mesh.get()}) {
            for (const double smoothing : {0.0, 5.0}) {
                ProfileSettings settings = bare();
                settings.smoothing = smoothing;
                const ProfileTrace t = trace(*surface, settings, start);
                for (const Vec2& p : t.profile.place) EXPECT_NEAR(aside(p, start, down), 0.0, 1e-5) << azimuth;
                EXPECT_EQ(t.end, ProfileEnd::Rim);
                EXPECT_NEAR(t.profile.z.front() - t.profile.z.back(), std::tan(35 * kDegree) * t.profile.length(),
                            1e-5);
                expect_section(t, *surface);
            }
        }
    }
}

TEST(ProfileTrace, ConeGivesRays) {
    const Vec2 start(5.3, 2.9);
    const auto error = [&](const Vec2& p) { return aside(p, start, start); };
    const Height cone = [](double x, double y) { return -0.7 * std::hypot(x, y); };
    EXPECT_LT(largest_error(*grid_terrain(50, 1.0, cone), bare(), start, 40, error), 0.05);
    EXPECT_LT(largest_error(*grid_terrain(50, 0.25, cone), bare(), start, 40, error), 0.023);
}

// z = -(a x^2 + b y^2): dy/dx = (b y) / (a x), so that y = y0 (x / x0)^(b/a); with b = 2 a a parabola.
TEST(ProfileTrace, ParaboloidGivesParabolas) {
    const Vec2 start(5, 3);
    const auto error = [&](const Vec2& p) { return p.x() - start.x() * std::sqrt(p.y() / start.y()); };
    const Height dome = [](double x, double y) { return -0.005 * x * x - 0.01 * y * y; };
    const double coarse = largest_error(*grid_terrain(50, 1.0, dome), bare(), start, 40, error);
    const double fine = largest_error(*grid_terrain(50, 0.5, dome), bare(), start, 40, error);
    EXPECT_LT(coarse, 0.043);
    EXPECT_LT(fine, 0.4 * coarse) << "second order: a quarter";
    ProfileSettings smooth = bare();
    smooth.smoothing = 5.0;  // the average of a paraboloid is the paraboloid, lower by a constant
    EXPECT_LT(largest_error(*grid_terrain(50, 1.0, dome), smooth, start, 40, error), 0.043);
}

// z = k (y^2 - x^2): dy/dx = -y/x, so that x y is constant.
TEST(ProfileTrace, SaddleGivesHyperbolas) {
    const Vec2 start(1, 30);
    const auto error = [](const Vec2& p) { return (p.x() * p.y() - 30.0) / p.norm(); };
    const Height saddle = [](double x, double y) { return 0.02 * (y * y - x * x); };
    const double coarse = largest_error(*grid_terrain(50, 1.0, saddle), bare(), start, 40, error);
    const double fine = largest_error(*grid_terrain(50, 0.5, saddle), bare(), start, 40, error);
    EXPECT_LT(coarse, 0.3);
    EXPECT_LT(fine, 0.4 * coarse);
}

/// A V-gully that falls by 0.4 along `u`, its sides by 0.6 across.
Height gully(const Vec2& u) {
    const Vec2 v(-u.y(), u.x());
    return [=](double x, double y) { return -0.4 * u.dot(Vec2(x, y)) + 0.6 * std::abs(v.dot(Vec2(x, y))); };
}

// Down the side along (0.4, -0.6), that is 10 m to the thalweg over 6.67 m along it; then along the thalweg: an edge of facets.
TEST(ProfileTrace, GullyIsEnteredAndFollowed) {
    const auto aligned = grid_terrain(40, 1.0, gully({1, 0}));
    const double turn = 0.4;
    const Vec2 u(std::cos(turn), std::sin(turn)), v(-u.y(), u.x());
    const auto turned = make_mesh_surface(mapped(mesh_of(*aligned), [&](const Vec3& p) {
        return Vec3(p.x() * u.x() + p.y() * v.x(), p.x() * u.y() + p.y() * v.y(), p.z());
    }));
    const struct {
        const Surface& surface;
        Vec2 along, across;
    } cases[] = {{*aligned, {1, 0}, {0, 1}}, {*turned, u, v}};
    for (const auto& c : cases) {
        const ProfileTrace t = trace(c.surface, bare(), -30.0 * c.along + 10.0 * c.across);
        for (const Vec2& p : t.profile.place) {
            const double gone = c.along.dot(p) + 30.0;
            EXPECT_NEAR(c.across.dot(p), std::max(0.0, 10.0 - 1.5 * gone), 1e-5);
        }
        EXPECT_EQ(t.end, ProfileEnd::Rim);
        EXPECT_NEAR(t.profile.length(), std::hypot(10.0, 20.0 / 3.0) + 70.0 - 20.0 / 3.0, 1e-4);
    }
}

// A thalweg that runs through the facets: the line stays within a cell of it.
TEST(ProfileTrace, GullyAcrossTheGridIsFollowedWithinACell) {
    const Vec2 u(std::cos(0.4), std::sin(0.4)), v(-u.y(), u.x());
    for (const double cell : {1.0, 0.5}) {
        const auto surface = grid_terrain(40, cell, gully(u));
        const ProfileTrace t = trace(*surface, bare(), -30.0 * u + 10.0 * v);
        for (const Vec2& p : t.profile.place)
            EXPECT_NEAR(v.dot(p), std::max(0.0, 10.0 - 1.5 * (u.dot(p) + 30.0)), cell);
        EXPECT_EQ(t.end, ProfileEnd::Rim);
    }
}

TEST(ProfileTrace, AverageStraightensARoughSlope) {
    const auto surface = grid_terrain(40, 1.0, rough_slope(35 * kDegree, 0.2));
    const Vec2 start(-30.2, 0.1);
    auto wander = [&](double smoothing) {
        ProfileSettings settings;
        settings.smoothing = smoothing;
        const ProfileTrace t = trace(*surface, settings, start);
        EXPECT_EQ(t.end, ProfileEnd::Rim);
        expect_section(t, *surface);
        double turned = 0.0;  // length beyond the straight one
        for (std::size_t k = 0; k < t.profile.reach_count(); ++k)
            turned += (t.profile.place[k + 1] - t.profile.place[k]).norm();
        return turned - (t.profile.place.back() - t.profile.place.front()).norm();
    };
    const double raw = wander(0.0), smooth = wander(5.0);
    EXPECT_GT(raw, 1.0);
    EXPECT_LT(smooth, 0.1 * raw);
}

// --- rules ---

/// Slope of 35 degrees to the east with a track from x = 0 to 6, all falling by 0.05 to the north; `track` is its own fall outwards.
Height slope_with_track(double track, double along = 0.05) {
    const double steep = std::tan(35 * kDegree);
    return [=](double x, double y) {
        const double across = x < 0.0 ? -steep * x : x < 6.0 ? -track * x : -6.0 * track - steep * (x - 6.0);
        return across - along * y;
    };
}

// The paper's rule for path B. Without it the line would turn by 68 degrees on the track (atan(0.05 / 0.02)).
TEST(ProfileTrace, TrackIsCrossedInTheDirectionOfTheSlopeAbove) {
    const Vec2 start(-25.3, -5.2), down(std::tan(35 * kDegree), 0.05);
    for (const double track : {0.02, 0.0, -0.1}) {  // outwards, level, inwards: a counter-slope of 0.6 m
        const auto surface = grid_terrain(40, 1.0, slope_with_track(track));
        for (const double smoothing : {0.0, 4.0}) {
            ProfileSettings settings;
            settings.smoothing = smoothing;
            const ProfileTrace t = trace(*surface, settings, start);
            EXPECT_EQ(t.end, ProfileEnd::Rim);
            EXPECT_GT(t.profile.place.back().x(), 39.9);
            // the average makes the slope bend a little beside the track
            for (const Vec2& p : t.profile.place) EXPECT_NEAR(aside(p, start, down), 0.0, smoothing > 0.0 ? 0.5 : 1e-4);
            expect_section(t, *surface);
        }
    }
    // bare, the line leaves the direction
    const auto surface = grid_terrain(40, 1.0, slope_with_track(0.02));
    const ProfileTrace t = trace(*surface, bare(), start);
    double furthest = 0.0;
    for (const Vec2& p : t.profile.place) furthest = std::max(furthest, aside(p, start, down));
    EXPECT_GT(furthest, 10.0);
}

TEST(ProfileTrace, CrossingIsStraight) {
    const auto surface = grid_terrain(40, 1.0, slope_with_track(0.02));
    ProfileSettings settings;
    settings.smoothing = 0.0;
    const ProfileTrace t = trace(*surface, settings, Vec2(-25.3, -5.2));
    double crossed = 0.0;
    for (std::size_t k = 0; k < t.profile.reach_count(); ++k)
        if (t.course[k] == Course::Straight && t.profile.s[k] > t.start) crossed += t.profile.s[k + 1] - t.profile.s[k];
    EXPECT_NEAR(crossed, 6.0 / std::cos(std::atan(0.05 / std::tan(35 * kDegree))), 1e-4);
}

TEST(ProfileTrace, PitsAreCrossedUpToTheHighestRise) {
    // a bowl in the slope: 3 m deep below it where it is deepest, its lower lip about 1.0 m above its bottom
    const Height slope = [](double x, double y) {
        return -0.5 * x - 3.0 * std::exp(-(x * x + (y - 1.0) * (y - 1.0)) / 9.0);
    };
    const auto surface = grid_terrain(40, 0.5, slope);
    ProfileSettings settings;
    settings.smoothing = 0.0;
    settings.highest_rise = 2.0;
    const ProfileTrace crossed = trace(*surface, settings, Vec2(-25.2, 0.9));
    EXPECT_EQ(crossed.end, ProfileEnd::Rim);
    EXPECT_GT(crossed.profile.place.back().x(), 39.9);
    settings.highest_rise = 0.2;
    settings.run_up = 7.0;
    const ProfileTrace held = trace(*surface, settings, Vec2(-25.2, 0.9));
    EXPECT_EQ(held.end, ProfileEnd::Pit);
    EXPECT_NEAR(held.profile.place.back().x(), 7.0, 3.0) << "on the counter-slope, run_up beyond the rise";
    const auto lowest = std::min_element(held.profile.z.begin(), held.profile.z.end());
    EXPECT_GT(held.profile.z.back(), *lowest - 4.0);
    EXPECT_LT(std::abs(held.profile.place[static_cast<std::size_t>(lowest - held.profile.z.begin())].y()), 3.0);
}

// A dam across the slope's foot is climbed by the line, and then ends it; the ground behind is there.
TEST(ProfileTrace, DamHigherThanTheRiseEndsTheLine) {
    const Height ground = [](double x, double) {
        return x < 0.0 ? -0.7 * x : 4.0 * std::exp(-(x - 15.0) * (x - 15.0) / 8.0);
    };
    const auto surface = grid_terrain(60, 1.0, ground);
    ProfileSettings settings;
    settings.smoothing = 0.0;
    const ProfileTrace t = trace(*surface, settings, Vec2(-40.2, 3.3));
    EXPECT_EQ(t.end, ProfileEnd::Pit);
    for (const Vec2& p : t.profile.place) EXPECT_NEAR(p.y(), 3.3, 1e-5);
    EXPECT_GT(t.profile.place.back().x(), 30.0) << "20 m beyond the place where it has climbed 1 m";
    EXPECT_LT(t.profile.place.back().x(), 36.0);
}

TEST(ProfileTrace, PlatformEndsTheLineAfterTheLongestCrossing) {
    const auto surface = grid_terrain(100, 1.0, [](double x, double) { return x < 0.0 ? -0.7 * x : 0.0; });
    ProfileSettings settings;
    settings.smoothing = 0.0;
    settings.longest_crossing = 43.5;
    const ProfileTrace t = trace(*surface, settings, Vec2(-30.2, 3.3));
    EXPECT_EQ(t.end, ProfileEnd::Flat);
    EXPECT_NEAR(t.profile.place.back().x(), 43.5, 1e-6) << "cut inside a facet";
    EXPECT_NEAR(t.profile.place.back().y(), 3.3, 1e-6);
    EXPECT_NEAR(t.profile.z.back(), 0.0, kExact);
}

// A gully whose floor falls by 0.1 only and bends by 60 degrees: straight on is a wall, along the floor the ground gets steep again.
TEST(ProfileTrace, GentleGullyFloorIsFollowedRoundABend) {
    const double bend = 60 * kDegree;
    const Vec2 before(1, 0), after(std::cos(bend), std::sin(bend));
    const Height ground = [=](double x, double y) {
        const Vec2 p(x, y);
        // along the axis: steep to -12, gentle to 12, steep again; banks rise by 0.8 m per m
        const Vec2 u = p.dot(before + after) < 0.0 ? before : after;
        const double along = p.dot(u), across = std::abs(u.x() * y - u.y() * x);
        const double fall = along < -12.0  ? -0.5 * (along + 12.0)
                            : along < 12.0 ? -0.1 * (along + 12.0)
                                           : -2.4 - 0.5 * (along - 12.0);
        return fall + 0.8 * across;
    };
    const auto surface = grid_terrain(50, 1.0, ground);
    const ProfileTrace t = trace(*surface, ProfileSettings{}, Vec2(-40.2, 0.1));
    EXPECT_EQ(t.end, ProfileEnd::Rim);
    const Vec2 last = t.profile.place.back();
    EXPECT_GT(last.norm(), 45.0);
    EXPECT_NEAR(aside(last, Vec2::Zero(), after), 0.0, 2.0);
}

TEST(ProfileTrace, EndsAtARimAndAtAHole) {
    const Height slope = [](double x, double y) { return x > 5.0 && x < 9.0 && std::abs(y) < 3.0 ? kNaN : -0.7 * x; };
    const auto surface = grid_terrain(20, 1.0, slope);
    const ProfileTrace hole = trace(*surface, ProfileSettings{}, Vec2(-10.3, 0.4));
    EXPECT_EQ(hole.end, ProfileEnd::NoData);
    EXPECT_NEAR(hole.profile.place.back().x(), 5.0, 1e-6);
    EXPECT_NEAR(hole.profile.z.back(), -3.5, 1e-6);
    const ProfileTrace rim = trace(*surface, ProfileSettings{}, Vec2(-10.3, 8.4));
    EXPECT_EQ(rim.end, ProfileEnd::Rim);
    EXPECT_NEAR(rim.profile.place.back().x(), 20.0, 1e-6);
}

// What counts is the outline of the terrain, not the frame of the raster around it.
TEST(ProfileTrace, EndsAtTheRimOfARoundTerrain) {
    const auto surface =
        grid_terrain(20, 1.0, [](double x, double y) { return std::hypot(x, y) > 17.5 ? kNaN : -0.7 * x; });
    const auto mesh = make_mesh_surface(mesh_of(*surface));
    for (const Surface* s : {surface.get(), mesh.get()}) {
        const ProfileTrace t = trace(*s, ProfileSettings{}, Vec2(-10.3, 3.4));
        EXPECT_EQ(t.end, ProfileEnd::Rim);
        EXPECT_NEAR(t.profile.place.back().norm(), 17.0, 1.0);
    }
}

TEST(ProfileTrace, EndsAtTheLongest) {
    const auto surface = grid_terrain(50, 1.0, [](double x, double y) { return -0.6 * x - 0.3 * y; });
    ProfileSettings settings;
    settings.longest = 31.25;
    settings.head = 4.0;
    const ProfileTrace t = trace(*surface, settings, Vec2(-20.3, -10.4));
    EXPECT_EQ(t.end, ProfileEnd::LengthLimit);
    EXPECT_NEAR(t.start, 4.0, 1e-5);
    EXPECT_NEAR(t.profile.length(), 35.25, 1e-5) << "counted from the starting point";
    EXPECT_NEAR((t.profile.place_at(t.start) - Vec2(-20.3, -10.4)).norm(), 0.0, 1e-5);
    expect_section(t, *surface);
}

TEST(ProfileTrace, LevelGroundGivesNone) {
    const auto surface = grid_terrain(20, 1.0, [](double, double) { return 3.0; });
    const ProfileTrace t = trace(*surface, ProfileSettings{}, Vec2(0.3, 0.4));
    EXPECT_TRUE(t.profile.empty());
    EXPECT_EQ(t.end, ProfileEnd::Flat);
}

TEST(ProfileTrace, GentleStartIsFollowedToTheSlope) {
    // a plateau that falls by 0.05 to the south, to an edge at y = -10
    const auto surface =
        grid_terrain(40, 1.0, [](double, double y) { return y > -10.0 ? 0.05 * y : -0.5 + 0.8 * (y + 10.0); });
    ProfileSettings settings;
    settings.smoothing = 0.0;
    const ProfileTrace t = trace(*surface, settings, Vec2(3.2, 5.4));
    EXPECT_EQ(t.end, ProfileEnd::Rim);
    for (const Vec2& p : t.profile.place) EXPECT_NEAR(p.x(), 3.2, 1e-5);
    EXPECT_NEAR(t.profile.place.back().y(), -40.0, 1e-5);
}

TEST(ProfileTrace, HeadReachesBehindTheReleaseArea) {
    const auto surface = grid_terrain(60, 1.0, [](double x, double) { return -0.7 * x; });
    const Region area({Polygon{{{-30, -10}, {-10, -10}, {-10, 10}, {-30, 10}}, {}}});
    ProfileSettings settings;
    settings.head = 5.0;
    ProfileTracer tracer(*surface, settings);
    const ProfileTrace t = tracer.steepest(Vec2(-20.2, 0.3), &area);
    EXPECT_LE(t.profile.place.front().x(), -35.0 + 1e-5);
    EXPECT_GT(t.profile.place.front().x(), -37.0) << "to the next edge of a facet, then 5 m";
    const auto stretches = t.profile.inside({Polygon{{{-30, -10}, {-10, -10}, {-10, 10}, {-30, 10}}, {}}});
    ASSERT_EQ(stretches.size(), 1U);
    EXPECT_NEAR(stretches[0].to - stretches[0].from, 20.0, 1e-5) << "all of the area that lies on the line";
    expect_section(t, *surface);
}

// The head of a line from the lower area ends behind the upper one, not in it; and behind a ring, not in its hole.
TEST(ProfileTrace, HeadReachesBehindAllReleaseAreas) {
    const auto surface = grid_terrain(60, 1.0, [](double x, double) { return -0.7 * x; });
    const auto strip = [](double from, double to) { return Ring{{from, -10}, {to, -10}, {to, 10}, {from, 10}}; };
    const MultiPolygon two{{strip(-30, -26), {}}, {strip(-24, -20), {}}};
    const MultiPolygon ring{{strip(-30, -18), {{{-24, -3}, {-24, 3}, {-26, 3}, {-26, -3}}}}};
    for (const MultiPolygon& areas : {two, ring})
        for (const double head : {2.5, 5.0, 9.0}) {
            const Region releases(areas);
            ProfileSettings settings;
            settings.head = head;
            ProfileTracer tracer(*surface, settings);
            for (const ProfileTrace& t : {tracer.steepest(Vec2(-22.2, 0.3), &releases),
                                          tracer.guided(std::array{Vec2(-22.2, 0.3), Vec2(20.0, 0.3)}, &releases)}) {
                EXPECT_LE(t.profile.place.front().x(), -30.0 - head + 1e-5) << head;
                EXPECT_GT(t.profile.place.front().x(), -32.0 - head) << head;
                double released = 0.0;
                for (const Stretch& s : t.profile.inside(areas)) released += s.length();
                EXPECT_NEAR(released, areas.size() == 2 ? 8.0 : 10.0, 1e-2) << head;  // a guide pulls aside
            }
        }
    // farther apart than the head is long, they do not matter to each other
    ProfileSettings settings;
    settings.head = 1.5;
    const Region releases(two);
    ProfileTracer tracer(*surface, settings);
    EXPECT_GT(tracer.steepest(Vec2(-22.2, 0.3), &releases).profile.place.front().x(), -26.0);
}

// The line crosses soils: each reach has that of its facet, head included.
TEST(ProfileTrace, SoilsAreThoseOfTheFacets) {
    Grid<double> heights(GridShape{41, 41, 1.0, {-20.5, -20.5}});
    for (int j = 0; j < 41; ++j)
        for (int i = 0; i < 41; ++i) heights.at(i, j) = -0.7 * (i - 20);
    std::vector<SoilId> soil(grid_facet_count(heights.shape));
    for (std::size_t f = 0; f < soil.size(); ++f)
        soil[f] = static_cast<SoilId>((f / 2) % 40 < 12 ? 1 : (f / 2) % 40 < 25 ? 2 : 3);
    const auto surface = make_grid_surface(heights, soil);
    const ProfileTrace t = trace(*surface, ProfileSettings{}, Vec2(-7.3, 0.4));
    expect_section(t, *surface);
    EXPECT_EQ(t.profile.soil.front(), 1) << "x = -12.3 in the head";
    EXPECT_EQ(t.profile.soil_at(t.start + 1.0), 2);
    EXPECT_EQ(t.profile.soil.back(), 3);
}

// Whatever the ground and the settings: a line is a section of the terrain, as long as allowed, and ends for a reason that fits its place.
TEST(ProfileTrace, RoughGroundWithHolesGivesSections) {
    const auto rough = rough_slope(20 * kDegree, 0.4);
    const Height ground = [&](double x, double y) {
        const bool hole = std::hypot(x - 8, y - 3) < 3.0 || std::hypot(x + 9, y + 12) < 2.0;
        return hole ? kNaN : rough(x, y) + 1.5 * std::sin(0.5 * x) * std::sin(0.4 * y);
    };
    const auto grid = grid_terrain(25, 0.5, ground);
    const auto mesh = make_mesh_surface(mesh_of(*grid));
    RandomStream random(61, 1, RandomPurpose::Effect);
    std::array<int, kProfileEndNames.size()> ends{};
    for (int k = 0; k < 300; ++k) {
        const Surface& surface = k % 2 == 0 ? *grid : *mesh;
        ProfileSettings settings;
        settings.smoothing = k % 3 == 0 ? 0.0 : random.uniform(0.3, 6.0);
        settings.gentle_slope = random.uniform(0.0, 30.0) * kDegree;
        settings.highest_rise = random.uniform(0.0, 2.0);
        settings.longest_crossing = random.uniform(0.0, 40.0);
        settings.longest = random.uniform(5.0, 60.0);
        settings.head = random.uniform(0.0, 5.0);
        const double x = random.uniform(-24.0, 24.0), y = random.uniform(-24.0, 24.0);
        if (surface.facet_at({x, y}) < 0) continue;
        const ProfileTrace t = trace(surface, settings, {x, y});
        if (t.profile.empty()) continue;
        ++ends[static_cast<std::size_t>(t.end)];
        expect_section(t, surface);
        EXPECT_LE(t.profile.length() - t.start,
                  settings.longest + kExact + (t.end == ProfileEnd::Pit ? settings.run_up : 0.0));
        EXPECT_NEAR((t.profile.place_at(t.start) - Vec2(x, y)).norm(), 0.0, 2e-6);
        const bool at_hole = std::hypot(t.profile.place.back().x() - 8, t.profile.place.back().y() - 3) < 4.0 ||
                             std::hypot(t.profile.place.back().x() + 9, t.profile.place.back().y() + 12) < 3.0;
        const bool at_rim = t.profile.place.back().cwiseAbs().maxCoeff() > 25.0 - 2e-6;
        EXPECT_TRUE(t.end != ProfileEnd::NoData || at_hole);
        EXPECT_EQ(t.end == ProfileEnd::Rim,
                  at_rim && t.end != ProfileEnd::Pit && t.end != ProfileEnd::LengthLimit && t.end != ProfileEnd::Flat);
    }
    for (const ProfileEnd end :
         {ProfileEnd::Pit, ProfileEnd::Flat, ProfileEnd::Rim, ProfileEnd::NoData, ProfileEnd::LengthLimit})
        EXPECT_GT(ends[static_cast<std::size_t>(end)], 0) << kProfileEndNames[static_cast<std::size_t>(end)];
}

// --- along and guided ---

TEST(ProfileTrace, AlongALineIsTheSection) {
    const auto surface = grid_terrain(20, 1.0, rough_slope(30 * kDegree, 0.3));
    ProfileTracer tracer(*surface, ProfileSettings{});
    const std::vector<Vec2> line{{-15.3, -4.2}, {3, 5}, {3, 12}, {10, 12}};  // also through nodes and along edges
    const ProfileTrace t = tracer.along(line);
    EXPECT_EQ(t.end, ProfileEnd::LineEnd);
    expect_section(t, *surface);
    double length = 0.0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) length += (line[k + 1] - line[k]).norm();
    EXPECT_NEAR(t.profile.length(), length, 1e-5);
    for (const Vec2& corner : line) EXPECT_NEAR(t.profile.nearest(corner).offset, 0.0, 1e-5);
    for (double s = 0.01; s < t.profile.length(); s += 0.37)
        EXPECT_NEAR(t.profile.height_at(s), surface->height(t.profile.place_at(s)), 1e-5);
    const std::vector<Vec2> out{{0, 0}, {30, 0}};
    const ProfileTrace left = tracer.along(out);
    EXPECT_EQ(left.end, ProfileEnd::Rim);
    EXPECT_NEAR(left.profile.length(), 20.0, 1e-5);
}

// On a plane that falls east, a guide to the north-east: the line rests where the pull of the guide balances the slope across it.
// Pull d / width against the slope across the guide 0.5 sin(45 deg): d = 0.354 width, on the downhill side.
TEST(ProfileTrace, GuideHoldsTheLine) {
    const auto surface = grid_terrain(60, 0.5, [](double x, double) { return -0.5 * x; });
    ProfileSettings settings;
    settings.smoothing = 0.0;
    settings.guide_width = 6.0;
    settings.head = 0.0;
    ProfileTracer tracer(*surface, settings);
    const std::vector<Vec2> guide{{-40.1, -40.2}, {10, 9.9}};
    const ProfileTrace t = tracer.guided(guide);
    const double balance = 0.5 * std::sqrt(0.5) * settings.guide_width;
    int held = 0;
    for (const Vec2& p : t.profile.place) {
        const double along = (p - guide[0]).dot((guide[1] - guide[0]).normalized());
        if (along < 40.0 || along > 60.0) continue;
        EXPECT_NEAR(aside(p, guide[0], guide[1] - guide[0]), -balance, 0.25);
        ++held;
    }
    EXPECT_GT(held, 20);
    EXPECT_EQ(t.end, ProfileEnd::Rim);
    const std::size_t n = t.profile.vertex_count();
    EXPECT_NEAR((t.profile.place[n - 1] - t.profile.place[n - 10]).normalized().y(), 0.0, 1e-6)
        << "free beyond the guide";
}

TEST(ProfileTrace, GuideLeadsOverWhatALineWouldNotCross) {
    // a valley to the east; the guide leads up over its southern side, 6 m high, into the next one
    const auto surface = grid_terrain(
        60, 1.0, [](double x, double y) { return -0.4 * x + 6.0 * std::cos(y * std::numbers::pi / 20.0); });
    ProfileSettings settings;
    ProfileTracer tracer(*surface, settings);
    const std::vector<Vec2> guide{{-50.2, 20.1}, {-20, 20}, {-10, -20}, {10, -20}};
    const ProfileTrace t = tracer.guided(guide);
    EXPECT_EQ(t.end, ProfileEnd::Rim);
    EXPECT_NEAR(t.profile.place.back().y(), -20.0, 1.5);
    const Profile led = tracer.along(guide).profile;
    for (const Vec2& p : t.profile.place) {
        EXPECT_LT(p.x() < 5.0 ? std::abs(led.nearest(p).offset) : 0.0, 10.0);
    }
}

// --- many lines ---

TEST(ProfileTrace, LinesThatMeetAreFound) {
    const auto surface = grid_terrain(40, 1.0, gully({1, 0}));
    ProfileSettings settings;
    settings.smoothing = 0.0;
    ProfileTracer tracer(*surface, settings);
    const std::vector<Vec2> starts{{-30.1, 8.2}, {-28.1, -6.3}, {-25.3, 9.4}};
    auto traces = [&] {
        std::vector<ProfileTrace> t;
        for (const Vec2& p : starts) t.push_back(tracer.steepest(p));
        return t;
    };
    auto kept = traces();
    EXPECT_EQ(find_junctions(kept, 0.5, Converging::Keep), 0U);
    ASSERT_EQ(kept.size(), 3U);
    EXPECT_EQ(kept[0].joins, -1);
    for (const std::size_t k : {1U, 2U}) {
        EXPECT_EQ(kept[k].joins, 0);
        // beside the thalweg, 0.5 m before it at the most
        EXPECT_LE(std::abs(kept[k].profile.place_at(kept[k].joins_at).y()), 0.5 + 1e-9);
        EXPECT_EQ(kept[k].end, ProfileEnd::Rim);
    }
    auto merged = traces();
    EXPECT_EQ(find_junctions(merged, 0.5, Converging::Merge), 0U);
    ASSERT_EQ(merged.size(), 3U);
    for (const std::size_t k : {1U, 2U}) {
        EXPECT_EQ(merged[k].end, ProfileEnd::Merged);
        EXPECT_NEAR(merged[k].profile.length(), merged[k].joins_at, kExact);
        EXPECT_EQ(merged[k].course.size(), merged[k].profile.reach_count());
    }
    auto dropped = traces();
    EXPECT_EQ(find_junctions(dropped, 0.5, Converging::Drop), 2U);
    EXPECT_EQ(dropped.size(), 1U);
    auto apart = traces();
    apart.erase(apart.begin() + 1, apart.end());
    apart.push_back(trace(*surface, bare(), Vec2(39.2, 20.0)));
    EXPECT_EQ(find_junctions(apart, 0.5, Converging::Drop), 0U);
    EXPECT_EQ(apart[1].joins, -1);
}

TEST(ProfileStarts, OnePerFeatureOrEverySpacing) {
    FeatureLayer layer;
    const Ring square{{0, 0}, {10, 0}, {10, 4}, {0, 4}};
    const Ring hook{{0, 0}, {10, 0}, {10, 10}, {8, 10}, {8, 2}, {0, 2}};  // its centroid lies outside
    layer.features = {{1, MultiPolygon{Polygon{square, {}}}, {}},
                      {2, MultiPolygon{Polygon{hook, {}}}, {}},
                      {3, Polylines{Polyline{{{0, 0, 5}, {0, 9, 5}}, {}}}, {}},
                      {4, Points{{1, 2, 3}, {4, 5, 6}}, {}}};
    const auto one = profile_starts(layer, 0.0);
    ASSERT_EQ(one.size(), 5U);
    EXPECT_NEAR((one[0].at - Vec2(5, 2)).norm(), 0.0, kExact);
    EXPECT_TRUE(Region(std::get<MultiPolygon>(layer.features[1].geometry)).contains(one[1].at));
    EXPECT_NEAR((one[2].at - Vec2(0, 4.5)).norm(), 0.0, kExact);
    EXPECT_NEAR((one[4].at - Vec2(4, 5)).norm(), 0.0, kExact);
    EXPECT_EQ(one[4].feature, 3U);
    layer.features.erase(layer.features.begin() + 1);
    const auto spaced = profile_starts(layer, 2.0);
    // 5 x 1 of the lattice through (5, 2) that lie inside (points on the outline may or may not), 4 on the line, 2 points
    std::array<int, 3> count{};
    for (const ProfileStart& s : spaced) ++count[s.feature];
    EXPECT_GE(count[0], 5);
    EXPECT_LE(count[0], 15);
    EXPECT_EQ(count[1], 4);
    EXPECT_EQ(count[2], 2);
    EXPECT_EQ(profile_starts(layer, 100.0).size(), 4U) << "at least one each";
}

}  // namespace
}  // namespace scree::test
