// SPDX-License-Identifier: GPL-3.0-or-later
// Impacts as films show them: what lies between two flights that are long enough.
#include "ensemble/impact_watch.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scree {
namespace {

/// When an impact began and ended, and the speeds there.
struct Seen {
    std::int32_t impact;
    double began, speed_before, ended, speed_after;
    bool operator==(const Seen&) const = default;
};

/// Pieces of motion along x, each with a speed that it keeps.
class Film {
public:
    explicit Film(std::int32_t most) : watch_(most) {}
    void piece(double duration, double speed, bool contact) {
        MotionSegment<3> m;
        m.start = time_;
        m.duration = duration;
        m.velocity_start = m.velocity_end = {speed, 0, 0};
        m.in_contact = contact;
        time_ += duration;
        watch_.segment(m, [&](std::int32_t impact, const MotionSegment<3>& before, const MotionSegment<3>& after) {
            seen.push_back({impact, before.start + before.duration, before.velocity_end.x(), after.start,
                            after.velocity_start.x()});
        });
    }
    void flight(double duration, double speed) { piece(duration, speed, false); }
    void contact(double duration, double speed) { piece(duration, speed, true); }

    std::vector<Seen> seen;

private:
    double time_ = 0.0;
    ImpactWatch<3> watch_;
};

TEST(ImpactWatch, SeesStartAndEndOfEachImpact) {
    Film film(3);
    film.flight(0.5, 10.0);
    film.contact(0.25, 8.0);
    film.flight(0.5, 6.0);
    film.flight(0.5, 4.0);  // another velocity and no contact between: a bounce that took no time
    film.contact(0.5, 3.0);
    EXPECT_EQ(film.seen, (std::vector<Seen>{{0, 0.5, 10.0, 0.75, 6.0}, {1, 1.25, 6.0, 1.25, 4.0}}))
        << "the last impact has no end: no flight follows";
}

TEST(ImpactWatch, HopsBelongToTheImpact) {
    Film film(3);
    film.flight(0.05, 12.0);  // too short to be the flight before an impact
    film.contact(0.25, 11.0);
    film.flight(0.5, 10.0);
    film.contact(0.125, 8.0);
    film.flight(0.0625, 7.0);
    film.contact(0.125, 6.5);
    film.flight(0.5, 6.0);
    EXPECT_EQ(film.seen, (std::vector<Seen>{{0, 0.8, 10.0, 0.8 + 0.3125, 6.0}}));
}

TEST(ImpactWatch, AFlightOfSeveralArcsIsOne) {
    Film film(2);
    for (int k = 0; k < 4; ++k) film.flight(0.0625, 9.0);
    film.contact(0.25, 8.0);
    for (int k = 0; k < 4; ++k) film.flight(0.0625, 5.0);
    EXPECT_EQ(film.seen, (std::vector<Seen>{{0, 0.25, 9.0, 0.5, 5.0}}));
}

TEST(ImpactWatch, StopsAtTheNumberAskedFor) {
    Film film(1);
    for (int k = 0; k < 5; ++k) {
        film.flight(0.5, 10.0);
        film.contact(0.25, 8.0);
    }
    EXPECT_EQ(film.seen.size(), 1U);
    Film none(0);
    none.flight(0.5, 10.0);
    none.contact(0.5, 8.0);
    EXPECT_TRUE(none.seen.empty());
}

}  // namespace
}  // namespace scree
