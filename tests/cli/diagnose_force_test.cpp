// SPDX-License-Identifier: GPL-3.0-or-later
// What has no name, told as a force: the laws of the forces, and what is said of their z.
#include "cli/diagnose_force.hpp"

#include "cli/program.hpp"
#include "cli/site_file.hpp"
#include "cli/site_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace scree::cli {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Two known blocks that stopped 60 and 90 m along the axis.
ObservedSite two_blocks() {
    ObservedSite observed;
    Observations& o = observed.observations;
    o.blocks.resize(2);
    for (std::size_t k = 0; k < 2; ++k) {
        o.blocks[k].id = std::to_string(k);
        o.blocks[k].mass = k == 0 ? 400.0 : 900.0;
        o.blocks[k].size = {0.9, 0.8, 0.7};
        o.stops.push_back(
            {1, static_cast<std::int32_t>(k), {60.0 + 30.0 * static_cast<double>(k), 0.0, kNaN}, 0.0, false, false});
    }
    o.matched = true;
    o.thrown = 2;
    return observed;
}

DiagnosisCatalogue forces_of_quarry(const ObservedSite& observed) {
    const SiteFile site = read_site_file(test::quarry_a() / "site.toml", {"model.dimension=2"});
    return make_forces(site, load_site(site), observed, {});
}

TEST(DiagnoseForce, InContactItIsAPowerOfSpeedAndMass) {
    const DiagnosisCatalogue forces = forces_of_quarry(two_blocks());
    const DiagnosisCandidate& contact = forces.candidates.front();
    ASSERT_EQ(contact.name, kForceNames[0]);
    ASSERT_EQ(contact.variants.size(), kSpeedPowers.size() * kMassPowers.size());
    for (std::size_t k = 0; k < contact.variants.size(); ++k) {
        const double strength = 2.0, speed = 5.0, mass = 1200.0;
        const Effect effect = contact.variants[k].at(strength);
        scree_contact_state state{};
        state.velocity[0] = 3.0;
        state.velocity[2] = -4.0;
        state.mass = mass;
        std::copy(effect.values.begin(), effect.values.end(), state.number);
        scree_ground_drag_values drag{};
        ASSERT_NE(effect.own.ground_drag, nullptr);
        effect.own.ground_drag(&state, &drag);
        const double b = kSpeedPowers[k / kMassPowers.size()], c = kMassPowers[k % kMassPowers.size()];
        EXPECT_NEAR(drag.linear * speed, 0.6 * std::pow(speed, b) * std::pow(mass / 600.0, c), 1e-12)
            << contact.variants[k].label;
        EXPECT_EQ(drag.quadratic, 0.0);
        EXPECT_EQ(contact.variants[k].at(0.0).value("a"), 0.0) << "absent at strength 0";
    }
}

TEST(DiagnoseForce, MassesSayNothingWhereBlocksAreUnknown) {
    ObservedSite pool = two_blocks();
    pool.observations.matched = false;
    const DiagnosisCatalogue forces = forces_of_quarry(pool);
    EXPECT_EQ(forces.candidates.front().variants.size(), kSpeedPowers.size());
    EXPECT_EQ(forces.candidates.back().name, kForceNames[3]);
}

TEST(DiagnoseForce, OnAStretchOfThePathItActsThereAndNowhereElse) {
    ObservedSite observed = two_blocks();
    observed.op.axis = Axis(std::vector<Vec2>{{2.0, 40.0}, {102.0, 40.0}});
    const SiteFile site = read_site_file(test::quarry_a() / "site.toml", {});
    const SiteModel model = load_site(site);
    const DiagnosisCatalogue forces = make_forces(site, model, observed, {});
    const std::size_t stretches = forces.candidates.size() - 1;
    const DiagnosisVariant& anywhere = forces.candidates[stretches].variants.front();
    EXPECT_EQ(anywhere.path, (Stretch{0.0, 88.0})) << "to the farthest stop";
    const DiagnosisVariant v = forces.variant(stretches, 0, Stretch{20.03, 31.5});
    EXPECT_EQ(v.label, "speed^1 mass^0, from 20 to 31.5 m");
    EXPECT_EQ(v.on, (Stretch{20.03, 31.5}));
    EXPECT_FALSE(v.path);
    for (const double y : {5.0, 40.0, 75.0}) {
        EXPECT_FALSE(v.place.covers(0, Vec2(22.0, y)));
        EXPECT_TRUE(v.place.covers(0, Vec2(22.1, y)));
        EXPECT_TRUE(v.place.covers(0, Vec2(33.4, y)));
        EXPECT_FALSE(v.place.covers(0, Vec2(33.6, y)));
    }
}

/// A study in which forces were tried, with these z in contact (power of speed by power of mass), all the way, and on two stretches.
DiagnoseStudy tried(std::vector<double> contact, double all, std::vector<double> stretches) {
    DiagnoseStudy study;
    const auto add = [&](const char* name, const std::vector<double>& z) {
        const std::size_t effect = study.forces.candidates.size();
        study.forces.candidates.push_back({name, "", false, {}});
        const bool on_stretches = name == kForceNames[3];
        for (std::size_t k = 0; k < z.size(); ++k) {
            const double from = 30.0 * static_cast<double>(k);
            EffectDose dose{effect, on_stretches ? 0 : k, 1.0, {}};
            if (on_stretches) dose.on = Stretch{from, from + 30.0};
            study.by_force.looked_at.push_back(dose);
            Eigen::VectorXd& all_z = study.by_force.score.z;
            all_z.conservativeResize(all_z.size() + 1);
            all_z[all_z.size() - 1] = z[k];
            study.by_force.score.visibility.setConstant(all_z.size(), 1.0);
            study.forces.candidates.back().variants.emplace_back().most = 10.0;
        }
    };
    add(kForceNames[0], contact);
    add(kForceNames[1], {all});
    add(kForceNames[3], stretches);
    return study;
}

TEST(DiagnoseForce, SaysPhaseSpeedMassAndPlace) {
    const auto said = force_sentences(tried({1, 1, 1, 6, 3, 2, 5.9, 2, 2}, 2.0, {1.0, 7.0}));
    ASSERT_EQ(said.size(), 4U);
    EXPECT_THAT(said[0], HasSubstr("held back more than in the model while they touch the ground (z = 6; all the way"));
    EXPECT_THAT(said[1], HasSubstr("speed^1 or speed^2 (z = 6")) << "not told apart";
    EXPECT_THAT(said[2], HasSubstr("it is alike for all masses (z = 6"));
    EXPECT_THAT(said[3], HasSubstr("it acts from 30 to 60 m (z = 7"));
}

// Beyond where most blocks stop a force could do nothing: what its fingerprint finds there is noise.
TEST(DiagnoseForce, SaysNoPlaceWhereNoForceCouldBeSeen) {
    DiagnoseStudy study = tried({1, 1, 1, 6, 3, 2, 5.9, 2, 2}, 2.0, {4.0, 7.0});
    study.by_force.score.visibility.tail<1>().setConstant(0.1);
    const auto said = force_sentences(study);
    ASSERT_EQ(said.size(), 4U);
    EXPECT_THAT(said[3], HasSubstr("it acts all along the path (z = 6; from 0 to 30 m: 4"));
}

TEST(DiagnoseForce, SaysThatTheModelHoldsBackTooMuch) {
    const auto said = force_sentences(tried({-5, -1, -1, -1, 0, 0, 0, 0, 0}, -1.0, {-1.0, -1.0}));
    ASSERT_EQ(said.size(), 3U) << "no stretch explains anything: no place is said";
    EXPECT_THAT(said[0], HasSubstr("held back less than in the model while they touch the ground (z = 5"));
    EXPECT_THAT(said[1], HasSubstr("speed^0 (z = 5"));
}

TEST(DiagnoseForce, SaysThatNoForceExplainsIt) {
    const auto said = force_sentences(tried({1, 1, 1, 1, -1.5, 1, 0, 0, 0}, 0.5, {3.0, 0.0}));
    ASSERT_EQ(said.size(), 1U);
    EXPECT_THAT(said[0], HasSubstr("no force along the motion explains it"));
}

TEST(DiagnoseForce, SaysHowMuchAForceLeaves) {
    DiagnoseStudy study = tried({6, 0, 0, 0, 0, 0, 0, 0, 0}, 0.0, {0.0, 0.0});
    study.by_force.residuals.resize(20);
    study.by_force.score.q = 20.0 + 40.0;
    EXPECT_THAT(force_sentences(study)[0], HasSubstr("held back more")) << "36 of 40";
    study.by_force.score.q = 20.0 + 360.0;
    const auto said = force_sentences(study);
    EXPECT_THAT(said[0], HasSubstr("no force along the motion explains it: the best takes away 10 % of what is off"));
    EXPECT_THAT(said[1], HasSubstr("held back more"));
}

TEST(DiagnoseForce, IsSilentWhereNoneWasTried) {
    EXPECT_THAT(force_sentences(DiagnoseStudy{}), IsEmpty());
}

}  // namespace
}  // namespace scree::cli
