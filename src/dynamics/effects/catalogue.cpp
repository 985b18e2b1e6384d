// SPDX-License-Identifier: GPL-3.0-or-later
// The catalogue: one table of all effects. Reader, manual, checks and `scree effects` follow from it.
#include "scree/base/assert.hpp"
#include "scree/dynamics/effects.hpp"

#include <array>
#include <string>

namespace scree {

namespace {

constexpr double kInf = kInfinity, kNo = kNaN;

constexpr const char* kPlatRock = "CRSP; constant as in PlatRock's Pfeiffer model";
constexpr const char* kChoice = "range chosen wide enough for rockfall";
constexpr EffectLimits kAnywhere{}, kOnGround{true, true}, kOnGroundAtImpact{true, true, false, false, true},
    kInZone{true, true}, kOnLines{false, false, true}, kAtScreen{false, false, false, false, false, true};

using P = EffectParameter;

constexpr P kPfeifferBowen[] = {{"half_speed", "m/s", 9.144, 0.1, 1e6, kInf,
                                 "Normal speed at which e has fallen to half. Smaller: fast blocks bounce less.",
                                 kPlatRock}};
constexpr P kHalfSpeed[] = {{"half_speed", "m/s", 10.0, 0.1, 1e6, kInf,
                             "Normal speed at which e has fallen to half. Smaller: blocks bounce less.",
                             "Bourrier's soil model in PlatRock: 0 to 50 m/s, 10 as default"}};
constexpr P kMass[] = {
    {"exponent", "-", -0.15, -1.0, 0.0, 0.0, "More negative: heavy blocks bounce less.", kChoice},
    {"reference_mass", "kg", 1000.0, 1e-3, 1e7, kNo, "Mass for which e is that of the soil.", kChoice}};
constexpr P kSlip[] = {
    {"ratio", "-", 3.6, 1.0, 20.0, 1.0, "Largest friction over that of the soil. Larger: sliding blocks tip and hop.",
     "Leine et al. 2014 use 6.5, Lu et al. 2019 3.6 (0.55 to 2.0)"},
    {"growth", "1/m", 3.0, 0.01, 100.0, kNo, "kappa: how fast friction grows with the way in contact.",
     "Lu et al. 2019; Leine et al. 2014 use 0.7"},
    {"decay", "1/s", 185.0, 0.1, 1e4, kNo, "beta: how fast the way is forgotten in flight.",
     "Lu et al. 2019; Leine et al. 2014 use 20"}};
constexpr P kFrictionSpeed[] = {
    {"limit", "-", 0.3, 0.0, 5.0, 1.0,
     "Friction at high speed over that at rest. Smaller: what slides fast is hardly held.",
     "Lucas et al. 2014: 0.13 for landslides of all sizes; 1 to 5 (stronger when fast) chosen"},
    {"speed", "m/s", 4.0, 0.1, 1e3, kNo, "Sliding speed at which half of the change is reached.", "Lucas et al. 2014"}};
constexpr P kFrictionBlockSpeed[] = {
    {"limit", "-", 0.3, 0.0, 5.0, 1.0, "Friction of a fast block over that of a slow one. Smaller: fast blocks slip.",
     kChoice},
    {"speed", "m/s", 4.0, 0.1, 1e3, kNo, "Speed of the block at which half of the change is reached.", kChoice}};
constexpr P kRollingSpeed[] = {{"speed", "m/s", 5.0, 0.1, 1e6, kInf,
                                "Speed at which the resistance has doubled. Smaller: fast blocks are slowed.", kChoice},
                               {"exponent", "-", 1.0, 0.5, 3.0, kNo, "How steeply the resistance grows.", kChoice}};
constexpr P kRollingSize[] = {
    {"exponent", "-", 1.0, -2.0, 3.0, 0.0,
     "0: a constant lever arm, the contact law itself; 1: a constant rolling angle; 1.2 to 1.7: sinkage; negative: "
     "large "
     "blocks pass over what stops small ones.",
     kChoice},
    {"reference_size", "m", 1.0, 0.01, 100.0, kNo, "L for which mu_r is that of the soil.", kChoice}};
constexpr P kSoilScatter[] = {
    {"rolling", "-", 0.5, -3.0, 3.0, 0.0,
     "Standard deviation of ln mu_r between blocks. Larger: some blocks go far, others stop early.", kChoice},
    {"friction", "-", 0.0, -3.0, 3.0, 0.0, "The same of ln mu; of the other sign: low where mu_r is high.", kChoice},
    {"restitution", "-", 0.0, -3.0, 3.0, 0.0, "The same of ln e.", kChoice}};
constexpr P kLowFriction[] = {{"friction", "-", 0.2, 0.0, 10.0, kInf,
                               "Largest mu on the layer. Smaller slides farther.",
                               "0.1 to 0.3 for wet, frozen or grassy ground"}};
constexpr P kRoughness[] = {
    {"amplitude", "m", 0.05, 0.0, 2.0, 0.0,
     "S: height of bumps that the terrain model leaves out. Larger scatters more, small blocks first.",
     "Pfeiffer & Bowen 1989: measured on the slope"}};
constexpr P kPatch[] = {{"restitution", "-", kNo, 0.0, 1.0, kNo, "e on the patch.", "as of a soil"},
                        {"friction", "-", kNo, 0.0, 10.0, kNo, "mu on the patch.", "as of a soil"},
                        {"rolling", "m", kNo, 0.0, 10.0, kNo, "mu_r on the patch.", "as of a soil"}};
constexpr P kGroundDrag[] = {{"coefficient", "1/s", 0.3, 0.0, 20.0, 0.0,
                              "c: deceleration per speed. Larger: slower, without stopping earlier on steep ground.",
                              kChoice}};
constexpr P kGroundDragQuadratic[] = {{"coefficient", "1/m", 0.05, 0.0, 10.0, 0.0,
                                       "c: deceleration per speed squared. Larger: a lower limit to the speed.",
                                       kChoice}};
constexpr P kScar[] = {
    {"resistance", "-", 2.5, 0.0, 10.0, 0.0, "C_f + C_s. Larger: slower on soft ground.",
     "Lu et al. 2019: C_f = 1.0, C_s from 0.1 to 4.0, 1.5 used"},
    {"modulus", "MPa", 15.0, 0.1, 1000.0, kNo, "M_E of the ground. Smaller: deeper scars, more drag.",
     "Lu et al. 2019: 10 to 25 at Chant Sura"},
    {"density", "kg/m3", 1700.0, 500.0, 3000.0, kNo, "Of the ground.", "Lu et al. 2019"}};
constexpr P kScarReduced[] = {{"coefficient", "-", 0.1, 0.0, 10.0, 0.0,
                               "k: drag of a scar that is always as deep, relative to the block. Larger: slower.",
                               "0.01 to 0.5 spans the values of scar_drag"}};
constexpr P kAir[] = {
    {"drag_coefficient", "-", 1.0, 0.0, 3.0, 0.0, "C_d of the block.", "0.5 of a sphere to 1.1 of a cube"},
    {"air_density", "kg/m3", 1.2, 0.1, 2.0, kNo, "1.2 near the sea, 1.0 at 2000 m.", "standard atmosphere"}};
constexpr P kForest[] = {
    {"coefficient", "kg/s", 500.0, 0.0, 1e5, 0.0, "C: force per speed. Larger: slower, light blocks most.",
     "250 open, 500 medium, 750 dense: presets in use, check before relying on them"},
    {"height", "m", 20.0, 0.1, 100.0, kNo, "Of the canopy: it acts on centres of mass below it.", kChoice}};
constexpr P kTrees[] = {
    {"diameter", "m", 0.3, 0.01, 3.0, kNo, "DBH, diameter of the trunks at breast height.", "measured"},
    {"density", "1/ha", 400.0, 0.0, 1e4, 0.0, "Trunks per hectare where no points are given.", "measured"},
    {"strength", "-", 1.0, 0.0, 5.0, 0.0, "Fracture energy over that of silver fir.",
     "Dorren & Berger 2006: by species"},
    {"height", "m", 20.0, 0.1, 100.0, kNo, "Of the trunks: centres of mass above it pass over.", kChoice}};
constexpr P kNet[] = {
    {"capacity", "kJ", 500.0, 0.0, 2e4, 0.0, "Energy that it takes. Less energetic blocks are held.", "its data sheet"},
    {"height", "m", 4.0, 0.1, 30.0, kNo, "Centres of mass that cross higher above the ground are not touched.",
     "its data sheet"}};
constexpr P kBerm[] = {{"height", "m", 2.0, 0.0, 30.0, 0.0, "H of the crest above the ground.", "its plan"},
                       {"width", "m", 6.0, 0.1, 200.0, kNo, "W from foot to foot.", "its plan"}};
constexpr P kFragmentation[] = {
    {"speed", "m/s", 8.0, 0.1, 1e6, kInf, "Normal speed of impact from which a block breaks. Smaller: earlier.",
     "5 to 12 m/s in quarry tests"},
    {"share", "-", 0.5, 0.01, 1.0, 1.0, "Of the volume in the largest piece, which goes on.",
     "0.1 to 0.6 in quarry tests"},
    {"most", "-", 1.0, 1.0, 100.0, kNo, "How often a block may break.", kChoice}};
constexpr P kOwnLaw[] = {{"a", "-", 0.0, -1e9, 1e9, kNo, "A number that the law is given.", "your law says what it is"},
                         {"b", "-", 0.0, -1e9, 1e9, kNo, "Another.", "your law says what it is"},
                         {"c", "-", 0.0, -1e9, 1e9, kNo, "Another.", "your law says what it is"},
                         {"d", "-", 0.0, -1e9, 1e9, kNo, "Another.", "your law says what it is"}};
constexpr P kReleaseMotion[] = {
    {"speed", "m/s", 2.0, 0.0, 50.0, 0.0, "Added at the start, down the slope.", "0 to 6 m/s"},
    {"spin", "rad/s", 0.0, 0.0, 100.0, 0.0, "Added at the start, in the sense of rolling down the slope.", kChoice}};
constexpr P kShape[] = {
    {"corners", "-", 1.0, 0.1, 10.0, 1.0, "Factor on the number of corners: above 1 rounder, below 1 sharper.",
     kChoice},
    {"elongation", "-", 1.0, 0.2, 5.0, 1.0, "Factor on L1/L2, volume kept: above 1 longer.", kChoice},
    {"flatness", "-", 1.0, 0.2, 5.0, 1.0, "Factor on L2/L3, volume kept: above 1 platier.", kChoice}};
constexpr P kSpeedError[] = {
    {"bias", "-", 0.1, -0.5, 0.5, 0.0, "Measured speeds are (1 + bias) times the true ones.", kChoice},
    {"noise", "m/s", 0.0, 0.0, 20.0, 0.0, "Standard deviation of the error of a speed.",
     "1 m/s for 0.5 m of picking error"}};
constexpr P kScreenShift[] = {{"shift", "m", 2.0, -100.0, 100.0, 0.0,
                               "The screen stood so much farther along the path than the map says.", kChoice}};
constexpr P kSlowMissed[] = {
    {"least_speed", "m/s", 2.0, 0.0, 50.0, 0.0, "Slower passages were not recorded.", kChoice}};
constexpr P kBroken[] = {
    {"last_impact", "-", 1.0, 0.0, 1.0, 0.0,
     "Share of the broken blocks that are recorded where they were last struck as a whole, the others at their largest "
     "piece.",
     "Bourrier & Acary 2022 record either"}};
constexpr P kShuffled[] = {
    {"share", "-", 1.0, 0.0, 1.0, 0.0, "Share of the block numbers that were mixed up.", kChoice}};
constexpr P kDatum[] = {{"offset", "m", 0.5, -100.0, 100.0, 0.0, "Measured heights are so much higher.", kChoice}};

using K = EffectKind;
using H = EffectHook;

constexpr EffectInfo kCatalogue[] = {
    {K::RestitutionPfeifferBowen, "restitution_pfeiffer_bowen", "restitution falls with the speed of impact",
     H::ContactLaw, kOnGround,
     "e' = e / (1 + (v_n / half_speed)^2), v_n the normal speed of the contact before the impact",
     "Pfeiffer & Bowen 1989, Computer simulation of rockfalls, Bull Assoc Eng Geol 26", "passing heights, impact pairs",
     "Invisible where the soil has e = 0.", kPfeifferBowen},
    {K::RestitutionHalfSpeed, "restitution_half_speed", "restitution falls with the speed of impact", H::ContactLaw,
     kOnGround, "e' = e half_speed / (v_n + half_speed), v_n the normal speed of the contact before the impact",
     "Bourrier's form in PlatRock (there with e = 1)", "passing heights, impact pairs",
     "Invisible where the soil has e = 0.", kHalfSpeed},
    {K::RestitutionMass, "restitution_mass", "heavy blocks bounce less", H::ContactLaw, kOnGround,
     "e' = min(1, e (m / reference_mass)^exponent)", "empirical; mass dependence: Asteriou & Tsiambaos 2018",
     "heights and speeds with masses", "Invisible where the soil has e = 0; needs blocks that are identified.", kMass},
    {K::SlipFriction, "slip_friction", "friction grows along a contact", H::ContactLaw, kOnGround,
     "mu' = mu (1 + (ratio - 1) 2/pi atan(growth s)); ds/dt = |v| in contact, -decay s in flight",
     "Leine et al. 2014, Simulation of rockfall trajectories with consideration of rock shape, eqs 46-47",
     "spin, heights; angular blocks more than round ones",
     "The soil's mu is that of a fresh contact. Limited to a soil it acts there, but the way s counts on every soil.",
     kSlip},
    {K::FrictionSpeed, "friction_speed", "friction changes with the speed of sliding", H::ContactLaw, kOnGround,
     "mu' = mu (limit + (1 - limit) / (1 + u / speed)), u the sliding speed of the contact",
     "Lucas, Mangeney & Ampuero 2014, Frictional velocity-weakening in landslides, Nat Commun 5:3417",
     "spin and speeds; stops farther or nearer than speeds say",
     "The soil's mu is that of a contact that does not slide.", kFrictionSpeed},
    {K::FrictionBlockSpeed, "friction_block_speed", "friction changes with the speed of the block", H::ContactLaw,
     kOnGround, "mu' = mu (limit + (1 - limit) / (1 + |v| / speed)), v the velocity of the centre of mass",
     "empirical: the form of friction_speed", "spin and speeds; stops farther or nearer than speeds say",
     "Ground that gives way under what is fast, whether it slides or rolls; what slides alone: friction_speed.",
     kFrictionBlockSpeed},
    {K::RollingSpeed, "rolling_speed", "rolling resistance grows with speed", H::ContactLaw, kOnGround,
     "mu_r' = mu_r (1 + (|v| / speed)^exponent)", "empirical", "speeds and stops; spin separates it from drag",
     "Easily taken for a rounder or sharper shape.", kRollingSpeed},
    {K::RollingSize, "rolling_size", "rolling resistance depends on size", H::ContactLaw, kOnGround,
     "mu_r' = mu_r (L / reference_size)^exponent, L = (L1 + L2 + L3) / 3",
     "empirical; exponent 1 is geometric similarity", "stops and speeds with masses",
     "Invisible where blocks are not identified.", kRollingSize},
    {K::SoilScatter, "soil_scatter", "every block meets ground of its own", H::ContactLaw, kOnGround,
     "mu_r' = mu_r exp(rolling z), mu' = mu exp(friction z), e' = min(1, e exp(restitution z)), z normal of mean 0 and "
     "variance 1, one for each block",
     "lognormal; that coefficients are drawn from distributions: Stevens 1998, RocFall (thesis, Univ. of Toronto)",
     "spread of stops and speeds, and that a block which is slow at one screen is slow at the next",
     "An entry is one number of each block, for all of its soils; numbers that are independent need an entry each.",
     kSoilScatter},
    {K::LowFriction, "low_friction", "a wet, frozen or smooth layer", H::ContactLaw, kOnGround,
     "mu' = min(mu, friction)", "Coulomb's law", "spin collapses, stops farther",
     "What comes after it in the site file may raise mu again.", kLowFriction},
    {K::Roughness, "roughness", "bumps that the terrain model leaves out", H::Impact, kOnGroundAtImpact,
     "at an impact the normals are turned by an angle drawn evenly from 0 to atan(2 S / L), about an axis drawn evenly "
     "in the "
     "tangent plane (in 2D by an angle of either sign)",
     "Pfeiffer & Bowen 1989 (there in 2D)", "spread of everything, heights, lateral spread",
     "Only at the instant of an impact: a turned normal that lasts would feed energy into the motion.", kRoughness},
    {K::SoilPatch, "soil_patch", "other ground in a place", H::ContactLaw, kOnGround,
     "e, mu, mu_r of the contact are those given here", "Bourrier & Acary 2022, eqs 13-20",
     "stops in one place, segments between screens", "Applied before all other changes of the contact law.", kPatch},
    {K::GroundDrag, "ground_drag", "soft ground, slow motion", H::ContactForce, kOnGround,
     "F = -m c v while in contact", "viscous drag, as in RAMMS-type models of soft ground",
     "speeds fall, hardly more stops",
     "Limits the speed on a slope without stopping the block. Acts while the ground bears the block: what slides or "
     "rolls "
     "is slowed, fast angular blocks, which touch the ground and leave it, hardly.",
     kGroundDrag},
    {K::GroundDragQuadratic, "ground_drag_quadratic", "soft ground, fast motion", H::ContactForce, kOnGround,
     "F = -m c |v| v while in contact", "quadratic drag", "fast blocks are slowed, hardly more stops",
     "Acts while the ground bears the block, as ground_drag.", kGroundDragQuadratic},
    {K::ScarDrag, "scar_drag", "blocks plough compactable soil", H::ContactForce, kOnGroundAtImpact,
     "F = -1/2 (C_f + C_s) density A(d) |v| v while in contact; an impact makes a scar of d = 0.1 m^(1/3) M_E^(-0.4) "
     "v_n^0.8, with "
     "M_E in kN/m2, and at most L/2, if that is deeper than what is left of the one before; on the way d falls to 0 "
     "over L; A: what a sphere of diameter L sunk in by d shows "
     "in front",
     "Lu et al. 2019, Modelling rockfall impact with scarring in compactable soils, eqs 8-14; the way over which a "
     "scar is left "
     "behind is Scree's",
     "speeds, small blocks most; v over spin rises",
     "Force through the centre of mass: no torque. Acts while the ground bears the block: a block that leaves its scar "
     "at "
     "once, in a bounce, is not slowed.",
     kScar},
    {K::ScarDragReduced, "scar_drag_reduced", "blocks plough soft soil, one number", H::ContactForce, kOnGround,
     "F = -m k |v| v / L while in contact", "Lu et al. 2019 with A proportional to L^2", "speeds, small blocks most",
     "Acts while the ground bears the block, as ground_drag.", kScarReduced},
    {K::AirDrag, "air_drag", "air", H::Force, kInZone, "F = -1/2 air_density C_d pi/4 L^2 |v| v", "drag equation",
     "hardly anything: 1 % of the weight of a block of 0.8 m at 20 m/s", "", kAir},
    {K::ForestDrag, "forest_drag", "forest as a drag zone", H::Force, kInZone, "F = -C v below the canopy",
     "Leine et al. 2014 and RAMMS practice", "speeds on a stretch, light blocks most",
     "A stand of single trees is `trees`.", kForest},
    {K::Trees,
     "trees",
     "single trees",
     H::Crossing,
     {false, true, false, true},
     "a trunk takes E = f 38.7 DBH^2.31 J (DBH in cm) times min(1, max(0, -0.046 + 1.026 / (1 + 10^(-8.007 (0.58 - "
     "x))))), x "
     "the offset of the path from the trunk's axis over (L + DBH) / 2; without points a trunk is met on the way with "
     "density (L + DBH) per metre, "
     "x even from 0 to 1",
     "Dorren & Berger 2006, Stem breakage of trees and energy dissipation during rockfall impacts, Tree Physiology 26",
     "two groups of speeds, light blocks most",
     "No sideways deflection; speed and spin fall alike.",
     kTrees},
    {K::Net, "net", "a net or wall", H::Crossing, kOnLines,
     "a centre of mass that crosses the line below the height loses the energy `capacity`; one with less is held "
     "there: at_rest",
     "energy balance", "stops just uphill, speeds just downhill",
     "Every block meets it intact. Heights count from the ground, vertically.", kNet},
    {K::Berm, "berm", "a dam, or a terrain model that lacks one", H::Terrain, kOnLines,
     "height of the ground + H max(0, 1 - 2 d / W), d the distance from the line", "geometry",
     "stops just uphill, heights just downhill",
     "Nodes are raised, and between them the crest is lower: by up to 1.4 cells / W of its height; in 2D, placed by "
     "from, it is exact.",
     kBerm},
    {K::Fragmentation, "fragmentation", "blocks break", H::Impact, kOnGroundAtImpact,
     "an impact with v_n >= speed leaves a block of the same form with `share` of volume and mass, with its centre of "
     "mass and velocities",
     "threshold on the normal speed; compare RockGIS (Matas et al. 2017)",
     "two groups of stops, speeds and energies behind hard impacts",
     "The largest piece is followed, the others are not. None is made that is shorter than 5 cm.", kFragmentation},
    {K::OwnLaw, "own_law", "a law of your own", H::ContactLaw, kOnGround,
     "what the library says: e, mu, mu_r of a contact and a drag while the ground bears the block, as functions of the "
     "state",
     "include/scree/own_law.h", "what it changes",
     "`library` names a shared library with the functions; its code runs inside scree. Never searched by scree "
     "diagnose.",
     kOwnLaw},
    {K::ReleaseMotion, "release_motion", "blocks start with a push", H::Release, kAnywhere,
     "v0 + speed along the steepest fall of the ground (over 2 m on each side), spin about the horizontal across it",
     "kinematics", "speeds at the first screen", "", kReleaseMotion},
    {K::BlockShape, "block_shape", "rounder, sharper, longer or platier blocks", H::Block, kAnywhere,
     "corners times `corners`; L1/L2 times elongation, L2/L3 times flatness, L1 L2 L3 kept", "geometry",
     "everything from the first metres on",
     "The great impostor: measure shapes before naming a rolling law. In 2D a block has no thickness: another "
     "flatness makes it larger or smaller.",
     kShape},
    {K::SpeedError, "speed_error", "speeds are measured wrong", H::Measurement, kAnywhere,
     "v_measured = (1 + bias) v + noise N(0, 1)", "measurement model", "speeds move, stops do not", "", kSpeedError},
    {K::ScreenShift, "screen_shift", "a screen is misplaced", H::Measurement, kAtScreen,
     "values are those at the chainage of the screen + shift", "measurement model", "all values of one screen", "",
     kScreenShift},
    {K::SlowMissed, "slow_missed", "the camera misses slow blocks", H::Measurement, kAnywhere,
     "a passage with v < least_speed is not recorded", "measurement model", "few slow passages", "", kSlowMissed},
    {K::BrokenBlock, "broken_block", "what is recorded of a broken block", H::Measurement, kAnywhere,
     "the stop of a share of the broken blocks is the place of their last whole impact", "Bourrier & Acary 2022",
     "stops on steep ground", "Blocks must break in the model: with fragmentation.", kBroken},
    {K::IdsShuffled, "ids_shuffled", "block numbers are mixed up", H::Measurement, kAnywhere,
     "the numbers of a share of the blocks are permuted evenly", "measurement model",
     "no correlation with mass where there should be one", "", kShuffled},
    {K::HeightDatum, "height_datum", "heights refer to another datum", H::Measurement, kAnywhere,
     "z_measured = z + offset", "measurement model", "passing heights all shifted", "", kDatum},
};
static_assert(std::size(kCatalogue) == kEffectKinds);

/// Row of each kind.
constexpr std::array<std::size_t, kEffectKinds> kRow = [] {
    std::array<std::size_t, kEffectKinds> row{};
    for (std::size_t k = 0; k < kEffectKinds; ++k) row[static_cast<std::size_t>(kCatalogue[k].kind)] = k;
    return row;
}();

}  // namespace

std::span<const EffectInfo> effect_catalogue() {
    return kCatalogue;
}

const EffectInfo& effect_info(EffectKind kind) {
    const EffectInfo& info = kCatalogue[kRow[static_cast<std::size_t>(kind)]];
    SCREE_ASSERT(info.kind == kind);
    return info;
}

std::optional<EffectKind> effect_kind(std::string_view name) {
    for (const EffectInfo& info : kCatalogue)
        if (name == info.name) return info.kind;
    return std::nullopt;
}

}  // namespace scree
