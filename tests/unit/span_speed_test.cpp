// SPDX-License-Identifier: GPL-3.0-or-later
// Speeds as films measure them, along motions whose mean speeds are known.
#include "ensemble/span_speed.hpp"

#include <gtest/gtest.h>

namespace scree {
namespace {

MotionSegment<3> piece(double start, double duration, const Vec3& from, const Vec3& v0, const Vec3& v1, bool contact) {
    MotionSegment<3> m;
    m.start = start;
    m.duration = duration;
    m.position = from;
    m.velocity_start = v0;
    m.velocity_end = v1;
    m.in_contact = contact;
    return m;
}

/// A crossing at time t with the speed that the block has there.
ScreenCrossing crossing(double time, double speed) {
    ScreenCrossing c;
    c.time = time;
    c.measured_speed = speed;
    return c;
}

/// Rolls along x from rest with acceleration 2 m/s^2 in contact: x = t^2. Steps of 10 ms.
void roll(SpanSpeed<3>& film, double until, double screen, std::vector<ScreenCrossing>& crossings) {
    constexpr double h = 0.01;
    const double meets = std::sqrt(screen);
    for (double t = 0.0; t < until - 1e-9; t += h) {
        std::vector<SpanSpeed<3>::Fresh> fresh;
        if (meets > t && meets <= t + h) {
            crossings.push_back(crossing(meets, 2.0 * meets));
            fresh.push_back({0, (meets - t) / h});
        }
        film.segment(piece(t, h, {t * t, 0, 0}, {2 * t, 0, 0}, {2 * (t + h), 0, 0}, true), fresh, crossings);
    }
    film.finish(crossings);
}

TEST(SpanSpeed, IsTheMeanOverTheSpanWhereTheBlockRolls) {
    // screen at x = 4, span 2: from x = 3 to x = 5 in sqrt 5 - sqrt 3 seconds
    SpanSpeed<3> film(2.0);
    std::vector<ScreenCrossing> crossings;
    roll(film, 4.0, 4.0, crossings);
    ASSERT_EQ(crossings.size(), 1U);
    EXPECT_NEAR(crossings[0].measured_speed, 2.0 / (std::sqrt(5.0) - std::sqrt(3.0)), 1e-3);
}

TEST(SpanSpeed, EndsWhereThePathBeginsOrEnds) {
    // screen at x = 0.25, span 2: from the start to x = 1.25
    SpanSpeed<3> from_start(2.0);
    std::vector<ScreenCrossing> crossings;
    roll(from_start, 4.0, 0.25, crossings);
    EXPECT_NEAR(crossings[0].measured_speed, 1.25 / std::sqrt(1.25), 1e-3);
    // screen at x = 4, the film ends at x = 4.41
    SpanSpeed<3> to_end(2.0);
    crossings.clear();
    roll(to_end, 2.1, 4.0, crossings);
    EXPECT_NEAR(crossings[0].measured_speed, 1.41 / (2.1 - std::sqrt(3.0)), 2e-3);
}

TEST(SpanSpeed, IsThatAtTheScreenInFreeFlight) {
    SpanSpeed<3> film(2.0);
    std::vector<ScreenCrossing> crossings;
    const Vec3 v0(8, 0, 4), v1 = v0 + Vec3(0, 0, -9.81);
    crossings.push_back(crossing(0.5, 8.03));
    film.segment(piece(0.0, 1.0, Vec3::Zero(), v0, v1, false), {{0, 0.5}}, crossings);
    film.segment(piece(1.0, 1.0, {8, 0, 0}, v1, v1 + Vec3(0, 0, -9.81), false), {}, crossings);
    film.finish(crossings);
    EXPECT_EQ(crossings[0].measured_speed, 8.03);
}

TEST(SpanSpeed, IsAMeanWhereAnImpactLiesWithinTheSpan) {
    // 10 m/s along x to the impact at x = 10, then 5 m/s. Screen at x = 9.5, span 2: 8.5 to 10 in 0.15 s, 10 to 10.5 in 0.1 s
    SpanSpeed<3> film(2.0);
    std::vector<ScreenCrossing> crossings{crossing(0.95, 10.0)};
    film.segment(piece(0.0, 1.0, Vec3::Zero(), {10, 0, 0}, {10, 0, 0}, false), {{0, 0.95}}, crossings);
    film.segment(piece(1.0, 1.0, {10, 0, 0}, {5, 0, 0}, {5, 0, 0}, false), {}, crossings);
    EXPECT_NEAR(crossings[0].measured_speed, 2.0 / 0.25, 1e-9);
    // the same impact before the screen: screen at x = 10.5, span 2: 9.5 to 10 in 0.05 s, 10 to 11.5 in 0.3 s
    SpanSpeed<3> behind(2.0);
    crossings = {crossing(1.1, 5.0)};
    behind.segment(piece(0.0, 1.0, Vec3::Zero(), {10, 0, 0}, {10, 0, 0}, false), {}, crossings);
    behind.segment(piece(1.0, 1.0, {10, 0, 0}, {5, 0, 0}, {5, 0, 0}, false), {{0, 0.1}}, crossings);
    EXPECT_NEAR(crossings[0].measured_speed, 2.0 / 0.35, 1e-9);
    // and farther away than half the span it does not matter
    SpanSpeed<3> far(2.0);
    crossings = {crossing(1.3, 5.0)};
    far.segment(piece(0.0, 1.0, Vec3::Zero(), {10, 0, 0}, {10, 0, 0}, false), {}, crossings);
    far.segment(piece(1.0, 1.0, {10, 0, 0}, {5, 0, 0}, {5, 0, 0}, false), {{0, 0.3}}, crossings);
    EXPECT_EQ(crossings[0].measured_speed, 5.0);
}

TEST(SpanSpeed, OfNoSpanIsThatAtTheScreen) {
    SpanSpeed<3> film(0.0);
    std::vector<ScreenCrossing> crossings;
    roll(film, 4.0, 4.0, crossings);
    EXPECT_EQ(crossings[0].measured_speed, 4.0);
}

}  // namespace
}  // namespace scree
