// SPDX-License-Identifier: GPL-3.0-or-later
// Effects that change the contact law, against closed forms of a ball (3D) and a disc (2D) on a slope.
#include "dynamics/effects/formulas.hpp"

#include "support/ball.hpp"
#include "support/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scree::test {

namespace {

constexpr double g = kStandardGravity;
constexpr double kDegree = std::numbers::pi / 180.0;
/// Constant accelerations are integrated exactly: what remains is the solver's tolerance.
constexpr double kClosedForm = 1e-7;  ///< [m, m/s]

template <class Dimension>
class EffectLaw : public testing::Test {
protected:
    static constexpr int kDimension = Dimension::value;
    Ball<kDimension> ball;

    /// Normal speeds before and after the first bounce of a drop onto level ground.
    std::pair<double, double> bounce(double height) {
        MotionRecorder<kDimension> motion;
        const double fall = std::sqrt(2.0 * height / g);
        ball.run(ball.at(0.0, height), fall + 0.02, &motion);
        const auto& s = motion.segments();
        EXPECT_GE(s.size(), 2U);
        return {-s[0].velocity_end[kDimension - 1], s[1].velocity_start[kDimension - 1]};
    }
    /// Speed down the slope after a time.
    double speed_after(double way, double speed, bool rolls, double time, double* gone = nullptr) {
        const auto end = ball.run(ball.sliding(way, speed, rolls), time);
        if (gone) *gone = end.state.position.dot(ball.slope.down()) - way;
        return end.state.velocity.dot(ball.slope.down());
    }
};

using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(EffectLaw, Dimensions);

}  // namespace

TYPED_TEST(EffectLaw, PfeifferBowenLowersTheBounceOfFastImpacts) {
    this->ball.soil.restitution = 0.6;
    this->ball.effects = {effect_with(EffectKind::RestitutionPfeifferBowen, {{"half_speed", 4.0}})};
    for (const double height : {0.2, 1.0, 5.0}) {
        const auto [before, after] = this->bounce(height);
        EXPECT_NEAR(after, 0.6 / (1.0 + std::pow(before / 4.0, 2)) * before, 1e-9);
    }
}

TYPED_TEST(EffectLaw, HalfSpeedLowersTheBounceOfFastImpacts) {
    this->ball.soil.restitution = 1.0;
    this->ball.effects = {effect_with(EffectKind::RestitutionHalfSpeed, {{"half_speed", 10.0}})};
    for (const double height : {0.2, 1.0, 5.0}) {
        const auto [before, after] = this->bounce(height);
        EXPECT_NEAR(after, 10.0 / (10.0 + before) * before, 1e-9);
    }
}

TYPED_TEST(EffectLaw, MassLowersTheBounce) {
    this->ball.soil.restitution = 0.6;
    this->ball.effects = {effect_with(EffectKind::RestitutionMass, {{"exponent", -0.2}, {"reference_mass", 1000.0}})};
    for (const double mass : {1000.0, 8000.0}) {
        this->ball.mass = mass;
        const auto [before, after] = this->bounce(1.0);
        EXPECT_NEAR(after / before, 0.6 * std::pow(mass / 1000.0, -0.2), 1e-9);
    }
    this->ball.mass = 1.0;  // 0.6 * 1000^0.2 = 2.4: no bounce gains energy
    const auto [before, after] = this->bounce(1.0);
    EXPECT_NEAR(after / before, 1.0, 1e-9);
}

// A ball that cannot roll slides from rest: v^2 / 2 = integral of g (sin - mu(s) cos) ds, with
// integral of atan(k s) ds = s atan(k s) - ln(1 + k^2 s^2) / (2 k). Steps take mu at their start: first order in h.
TYPED_TEST(EffectLaw, SlipFrictionGrowsAlongTheContact) {
    this->ball.slope.angle = 50 * kDegree;
    this->ball.soil = {"slope", 0.0, 0.4, 10.0};
    const double ratio = 2.5, k = 0.7;
    this->ball.effects = {effect_with(EffectKind::SlipFriction, {{"ratio", ratio}, {"growth", k}})};
    double errors[2];
    for (int n = 0; n < 2; ++n) {
        this->ball.settings.time_step = n == 0 ? 4e-3 : 2e-3;
        double s = 0.0;
        const double v = this->speed_after(0.0, 0.0, false, 2.0, &s);
        const double a = this->ball.slope.angle;
        const double mu = 0.4 * (s + (ratio - 1.0) * 2.0 / std::numbers::pi *
                                         (s * std::atan(k * s) - std::log1p(k * k * s * s) / (2.0 * k)));
        errors[n] = std::abs(v - std::sqrt(2.0 * g * (std::sin(a) * s - std::cos(a) * mu)));
        EXPECT_GT(s, 3.0);
    }
    EXPECT_LT(errors[0], 0.02);
    EXPECT_LT(errors[1], 0.6 * errors[0]);
}

// What a contact has built up decays in flight.
TYPED_TEST(EffectLaw, SlipFrictionIsForgottenInFlight) {
    using B = BlockEffects<TestFixture::kDimension>;
    const std::vector<Effect> effects{
        effect_with(EffectKind::SlipFriction, {{"ratio", 4.0}, {"growth", 1.0}, {"decay", 5.0}})};
    B at_work({effects, 1, 0}, {1000.0, 1.0}, this->ball.slope, g);
    auto state = this->ball.at(2.0, 0.0);
    Contact<TestFixture::kDimension> contact;
    contact.arm = -0.5 * this->ball.slope.normal();
    const auto friction = [&] { return at_work.law(contact, state, {}, this->ball.soil).friction; };
    EXPECT_EQ(friction(), 0.5);
    at_work.moved(state.position - 2.0 * this->ball.slope.down(), 1.0, true, 0.0, state);
    EXPECT_NEAR(friction(), effect_formula::slip_friction(0.5, 2.0, 4.0, 1.0), 1e-12);
    at_work.moved(state.position, 0.3, false, 0.0, state);
    EXPECT_NEAR(friction(), effect_formula::slip_friction(0.5, 2.0 * std::exp(-1.5), 4.0, 1.0), 1e-12);
}

// A ball that cannot roll slides from rest: dv/dt = A - B / (1 + x) with x = v / w, A = g (sin - limit mu cos), B = g (1 - limit) mu cos, so that
// t = w (x / A + B / A^2 ln((A (1 + x) - B) / (A - B))). First order in h.
TYPED_TEST(EffectLaw, FrictionChangesWithTheSpeedOfSliding) {
    this->ball.slope.angle = 40 * kDegree;
    this->ball.soil = {"slope", 0.0, 0.6, 10.0};
    const double w = 3.0;
    // what only slides is as fast as its contact
    for (const auto& [kind, limit] :
         {std::pair{EffectKind::FrictionSpeed, 0.2}, std::pair{EffectKind::FrictionSpeed, 1.3},
          std::pair{EffectKind::FrictionBlockSpeed, 0.2}}) {
        this->ball.effects = {effect_with(kind, {{"limit", limit}, {"speed", w}})};
        const double a = g * (std::sin(this->ball.slope.angle) - limit * 0.6 * std::cos(this->ball.slope.angle)),
                     b = g * (1.0 - limit) * 0.6 * std::cos(this->ball.slope.angle);
        double errors[2];
        for (int n = 0; n < 2; ++n) {
            this->ball.settings.time_step = n == 0 ? 4e-3 : 2e-3;
            const double x = this->speed_after(0.0, 0.0, false, 2.0) / w;
            errors[n] = std::abs(w * (x / a + b / (a * a) * std::log((a * (1.0 + x) - b) / (a - b))) - 2.0);
        }
        EXPECT_LT(errors[0], 2e-3) << limit;
        EXPECT_LT(errors[1], 0.6 * errors[0]) << limit;
    }
}

// A ball that rolls does not slide: it is held as it is at rest.
TYPED_TEST(EffectLaw, FrictionOfWhatRollsIsThatAtRest) {
    this->ball.soil = {"level", 0.0, 0.5, 0.02};
    const double rolls = this->speed_after(0.0, 5.0, true, 1.0);
    this->ball.effects = {effect_with(EffectKind::FrictionSpeed, {{"limit", 0.0}, {"speed", 0.5}})};
    EXPECT_NEAR(this->speed_after(0.0, 5.0, true, 1.0), rolls, kClosedForm);
}

// A ball rolls down while mu > tan / (1 + 1 / i), i the share of its moment in m R^2: with mu that falls with its own speed it begins to slip when it is fast.
TYPED_TEST(EffectLaw, FrictionUnderFastBlocksLetsThemSlip) {
    this->ball.slope.angle = 30 * kDegree;
    this->ball.soil = {"slope", 0.0, 0.6, 0.0};
    const auto rolls_after = [&](double time) {
        const auto end = this->ball.run(this->ball.sliding(0.0, 0.0, true), time);
        return end.state.spin.norm() * this->ball.radius / end.state.velocity.norm();
    };
    EXPECT_NEAR(rolls_after(2.0), 1.0, 1e-6);
    this->ball.effects = {effect_with(EffectKind::FrictionBlockSpeed, {{"limit", 0.0}, {"speed", 4.0}})};
    const double needed = std::tan(this->ball.slope.angle) / (1.0 + 1.0 / this->ball.roundness());
    const double fastest = 4.0 * (0.6 / needed - 1.0);  // up to which it rolls
    const double rate = g * std::sin(this->ball.slope.angle) / (1.0 + this->ball.roundness());
    EXPECT_NEAR(rolls_after(0.95 * fastest / rate), 1.0, 1e-6);
    EXPECT_LT(rolls_after(1.5 * fastest / rate), 0.99);
}

// On the level dv/dt = -a (1 + (v / v0)^n), a = g mu_r / ((1 + i) R): with n = 1 v + v0 falls exponentially, with n = 2 atan(v / v0) falls evenly. First
// order in h.
TYPED_TEST(EffectLaw, RollingResistanceGrowsWithSpeed) {
    const double mu_r = 0.02, v0 = 3.0, start = 8.0, time = 3.0;
    this->ball.soil = {"level", 0.0, 0.8, mu_r};
    const double rate = g * mu_r / ((1.0 + this->ball.roundness()) * this->ball.radius * v0);
    for (const auto& [exponent, expected] : {std::pair{1.0, (start + v0) * std::exp(-rate * time) - v0},
                                             std::pair{2.0, v0 * std::tan(std::atan(start / v0) - rate * time)}}) {
        this->ball.effects = {effect_with(EffectKind::RollingSpeed, {{"speed", v0}, {"exponent", exponent}})};
        double errors[2];
        for (int n = 0; n < 2; ++n) {
            this->ball.settings.time_step = n == 0 ? 4e-3 : 2e-3;
            errors[n] = std::abs(this->speed_after(0.0, start, true, time) - expected);
        }
        EXPECT_LT(errors[0], 0.01) << exponent;
        EXPECT_LT(errors[1], 0.6 * errors[0]) << exponent;
    }
}

TYPED_TEST(EffectLaw, RollingResistanceDependsOnSize) {
    const double mu_r = 0.03, exponent = 1.5;
    this->ball.soil = {"level", 0.0, 0.8, mu_r};
    this->ball.effects = {effect_with(EffectKind::RollingSize, {{"exponent", exponent}, {"reference_size", 1.0}})};
    for (const double radius : {0.25, 0.5, 1.0}) {
        this->ball.radius = radius;
        const double deceleration =
            g * mu_r * std::pow(2.0 * radius, exponent) / ((1.0 + this->ball.roundness()) * radius);
        EXPECT_NEAR(this->speed_after(0.0, 5.0, true, 1.0), 5.0 - deceleration, kClosedForm);
    }
}

// ln of what a block meets over what the soil has: normal with the given deviations, one number of each block in all its contacts, another of a second entry.
TYPED_TEST(EffectLaw, EveryBlockMeetsGroundOfItsOwn) {
    const Soil ground{"ground", 0.3, 0.5, 0.04};
    const std::vector<Effect> one{
        effect_with(EffectKind::SoilScatter, {{"rolling", 0.6}, {"friction", -0.3}, {"restitution", 2.0}})};
    const std::vector<Effect> two{one[0], one[0]};
    const int count = 4000;
    double mean = 0.0, square = 0.0, together = 0.0;
    for (int block = 0; block < count; ++block) {
        const auto id = static_cast<std::uint64_t>(block);
        const BlockEffects<TestFixture::kDimension> at_work({one, 3, id}, {1000.0, 1.0}, this->ball.slope, g);
        const ContactLaw law = at_work.law({}, {}, {}, ground);
        const double z = std::log(law.rolling / ground.rolling) / 0.6;
        EXPECT_NEAR(law.friction, ground.friction * std::exp(-0.3 * z), 1e-12);
        EXPECT_NEAR(law.restitution, std::min(1.0, ground.restitution * std::exp(2.0 * z)), 1e-12);
        EXPECT_EQ(at_work.law({}, {}, {3.0, 2.0}, ground).rolling, law.rolling);
        const BlockEffects<TestFixture::kDimension> both({two, 3, id}, {1000.0, 1.0}, this->ball.slope, g);
        const double other = std::log(both.law({}, {}, {}, ground).rolling / law.rolling) / 0.6;
        mean += z / count;
        square += z * z / count;
        together += z * other / count;
    }
    EXPECT_NEAR(mean, 0.0, 4.0 / std::sqrt(count));
    EXPECT_NEAR(square, 1.0, 4.0 * std::sqrt(2.0 / count));
    EXPECT_NEAR(together, 0.0, 4.0 / std::sqrt(count));
}

TYPED_TEST(EffectLaw, LowFrictionIsTheLesserOfTwo) {
    this->ball.slope.angle = 40 * kDegree;
    this->ball.soil = {"slope", 0.0, 0.3, 10.0};
    const auto speed = [&](double friction) {
        this->ball.effects = {effect_with(EffectKind::LowFriction, {{"friction", friction}})};
        return this->speed_after(0.0, 0.0, false, 1.0);
    };
    const double a = this->ball.slope.angle;
    EXPECT_NEAR(speed(0.1), g * (std::sin(a) - 0.1 * std::cos(a)), kClosedForm);
    EXPECT_NEAR(speed(0.5), g * (std::sin(a) - 0.3 * std::cos(a)), kClosedForm);
}

// Slides over the border of a patch: v^2 = 2 (a1 s1 + a2 s2). The border is crossed within a step: v h / 2 of way at most.
TYPED_TEST(EffectLaw, PatchHasItsOwnSoil) {
    this->ball.slope.angle = 40 * kDegree;
    this->ball.soil = {"slope", 0.0, 0.2, 10.0};
    const double a = this->ball.slope.angle, border = 3.0 * std::cos(a);  // x at which 3 m are gone
    // the contact is under the centre of mass along the normal: it starts at x = 0
    this->ball.effects = {between(effect_with(EffectKind::SoilPatch, {{"friction", 0.6}}), border, 1e3)};
    this->ball.settings.time_step = 1e-3;
    double way = 0.0;
    const double v = this->speed_after(0.0, 0.0, false, 1.5, &way);
    ASSERT_GT(way, 4.0);
    const double a1 = g * (std::sin(a) - 0.2 * std::cos(a)), a2 = g * (std::sin(a) - 0.6 * std::cos(a));
    EXPECT_NEAR(v * v, 2.0 * (a1 * 3.0 + a2 * (way - 3.0)), 2.0 * (a1 - a2) * 5e-3);
}

// A patch acts before what other effects make of the soil, whatever the order in the site file.
TYPED_TEST(EffectLaw, PatchComesFirst) {
    const std::vector<Effect> effects{
        effect_with(EffectKind::RollingSize, {{"exponent", 1.0}, {"reference_size", 0.5}}),
        effect_with(EffectKind::SoilPatch, {{"rolling", 0.1}})};
    const BlockEffects<TestFixture::kDimension> at_work({effects, 1, 0}, {1000.0, 1.0}, this->ball.slope, g);
    const ContactLaw law = at_work.law({}, {}, {}, {"ground", 0.1, 0.5, 0.04});
    EXPECT_DOUBLE_EQ(law.rolling, 0.2);
    EXPECT_DOUBLE_EQ(law.restitution, 0.1);
    EXPECT_DOUBLE_EQ(law.friction, 0.5);
}

TYPED_TEST(EffectLaw, OneSoilOnly) {
    Effect low = effect_with(EffectKind::LowFriction, {{"friction", 0.1}});
    low.place.soil = 2;
    const std::vector<Effect> effects{low};
    const BlockEffects<TestFixture::kDimension> at_work({effects, 1, 0}, {1000.0, 1.0}, this->ball.slope, g);
    Contact<TestFixture::kDimension> contact;
    contact.soil = 1;
    EXPECT_DOUBLE_EQ(at_work.law(contact, {}, {}, this->ball.soil).friction, 0.5);
    contact.soil = 2;
    EXPECT_DOUBLE_EQ(at_work.law(contact, {}, {}, this->ball.soil).friction, 0.1);
}

// ---- roughness -------------------------------------------------------------------------------------------------------------------

// The tilt is spread evenly from 0 to atan(2 S / L), its direction all round: means of both against their standard errors.
TYPED_TEST(EffectLaw, RoughnessTiltsEvenly) {
    constexpr int kDim = TestFixture::kDimension;
    using Vec = typename Space<kDim>::Vec;
    const std::vector<Effect> effects{effect_with(EffectKind::Roughness, {{"amplitude", 0.1}})};
    const double largest = std::atan(0.2);
    const int count = 4000;
    double mean = 0.0, square = 0.0, most = 0.0;
    Vec sideways = Vec::Zero();
    for (int block = 0; block < count; ++block) {
        BlockEffects<kDim> at_work({effects, 3, static_cast<std::uint64_t>(block)}, {1000.0, 1.0}, this->ball.slope, g);
        std::vector<Contact<kDim>> contacts(1);
        contacts[0].normal = this->ball.slope.normal();
        ASSERT_TRUE(at_work.tilt({}, contacts));
        EXPECT_NEAR(contacts[0].normal.norm(), 1.0, 1e-12);
        const double angle = std::acos(std::min(1.0, contacts[0].normal.dot(this->ball.slope.normal())));
        mean += angle / count;
        square += angle * angle / count;
        most = std::max(most, angle);
        sideways += contacts[0].normal / count;
    }
    EXPECT_NEAR(mean, largest / 2.0, 4.0 * largest / std::sqrt(12.0 * count));
    EXPECT_NEAR(square, largest * largest / 3.0, 0.02 * largest * largest);
    EXPECT_LE(most, largest + 1e-9);
    EXPECT_GT(most, 0.99 * largest);
    EXPECT_NEAR(sideways[0], 0.0, 4.0 * largest / std::sqrt(3.0 * count));
}

// A ball without friction that lands obliquely: one impact turns the velocity into the tilted tangent plane and keeps its tangential part; sliding on
// it is not touched again.
TYPED_TEST(EffectLaw, RoughnessActsAtTheInstantOfAnImpactOnly) {
    constexpr int kDim = TestFixture::kDimension;
    this->ball.soil = {"level", 0.0, 0.0, 0.0};
    this->ball.effects = {effect_with(EffectKind::Roughness, {{"amplitude", 0.05}})};
    int lifted = 0;
    for (std::uint64_t block = 0; block < 40; ++block) {
        this->ball.block = block;
        auto release = this->ball.at(0.0, 0.5);
        release.velocity[0] = 10.0;
        MotionRecorder<kDim> motion;
        const auto end = this->ball.run(release, 0.6, &motion);
        ASSERT_EQ(end.reason, StopReason::TimeLimit);
        const auto& s = motion.segments();
        double before = end.energy_start;
        for (const auto& m : s) {
            const double e = 500.0 * m.velocity_start.squaredNorm() + 1000.0 * g * m.position[kDim - 1];
            EXPECT_LE(e, before + 1000.0 * g * 1e-6);
            before = e;
            if (m.in_contact) {  // what lasts does not kick
                EXPECT_LE(m.velocity_end[kDim - 1], std::max(0.0, m.velocity_start[kDim - 1]) + 1e-9);
            }
        }
        lifted += s[1].velocity_start[kDim - 1] > 0.1;
    }
    EXPECT_GT(lifted, 10);
    EXPECT_LT(lifted, 30);  // about half of the bumps face the block
}

// The functions of scree/own_law.h: what a law sees, and that it cannot create energy.
TYPED_TEST(EffectLaw, OwnLawSeesTheContactAndIsKeptWithinBounds) {
    static scree_contact_state seen;
    this->ball.soil = {"slope", 0.5, 0.3, 0.01};
    Effect own = effect_with(EffectKind::OwnLaw, {{"c", 0.7}});
    own.own.contact_law = [](const scree_contact_state* s, scree_contact_law_values* law) {
        if (s->approach > seen.approach) seen = *s;
        law->restitution = s->number[2];
    };
    this->ball.effects = {own};
    seen = {};
    const auto [before, after] = this->bounce(1.0);
    EXPECT_NEAR(after, 0.7 * before, 1e-9);
    EXPECT_NEAR(seen.approach, before, 1e-9);
    EXPECT_NEAR(seen.velocity[2], -before, 1e-9);
    EXPECT_EQ(seen.velocity[1], 0.0);
    EXPECT_NEAR(seen.position[2], 0.0, 1e-6);
    EXPECT_EQ(seen.normal[2], 1.0);
    EXPECT_EQ(seen.mass, this->ball.mass);
    EXPECT_EQ(seen.number[2], 0.7);
    EXPECT_TRUE(seen.draw >= 0.0 && seen.draw < 1.0);

    own.own.contact_law = [](const scree_contact_state*, scree_contact_law_values* law) { *law = {7.0, -1.0, -1.0}; };
    this->ball.effects = {own};
    const auto [fall, rise] = this->bounce(1.0);
    EXPECT_NEAR(rise, fall, 1e-9) << "e is cut to 1";

    // drag without friction on a slope: the closed form of ground_drag, and none that pushes
    this->ball.slope.angle = 30 * kDegree;
    this->ball.soil = {"slope", 0.0, 0.0, 0.0};
    own.own.contact_law = nullptr;
    own.own.ground_drag = [](const scree_contact_state* s, scree_ground_drag_values* drag) {
        drag->linear = s->number[2];
    };
    this->ball.effects = {own};
    EXPECT_NEAR(this->speed_after(0.0, 0.0, false, 2.0), g * 0.5 * (1.0 - std::exp(-0.7 * 2.0)) / 0.7, 1e-6);
    own.set("c", -0.7);
    this->ball.effects = {own};
    EXPECT_NEAR(this->speed_after(0.0, 0.0, false, 2.0), g * 0.5 * 2.0, 1e-6);
}

// A law of the user that gives no number ends the block as failed, before anything looks for contacts at a place that is none.
TYPED_TEST(EffectLaw, OwnLawThatGivesNoNumberFailsTheBlock) {
    constexpr int kDim = TestFixture::kDimension;
    this->ball.soil = {"slope", 0.5, 0.3, 0.01};
    for (const bool drag : {false, true}) {
        Effect own = effect_with(EffectKind::OwnLaw, {});
        if (drag)
            own.own.ground_drag = [](const scree_contact_state*, scree_ground_drag_values* d) { d->linear = kNaN; };
        else
            own.own.contact_law = [](const scree_contact_state*, scree_contact_law_values* law) {
                law->restitution = kNaN;
            };
        this->ball.effects = {own};
        auto release = this->ball.at(0.0, 1.0);
        release.velocity[0] = 2.0;
        MotionRecorder<kDim> motion;
        EXPECT_EQ(this->ball.run(release, 5.0, &motion).reason, StopReason::Failed) << drag;
        for (const auto& m : motion.segments()) EXPECT_TRUE(m.position.allFinite() && m.velocity_end.allFinite());
    }
}

}  // namespace scree::test
