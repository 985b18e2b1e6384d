// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_candidates.hpp"

#include "scree/base/error.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace scree::cli {

namespace {

constexpr double kLeastRolling = 1e-3;  ///< of a patch, whose strength is a factor [m]

/// Everywhere, on each soil besides, on a stretch of the path besides, or on one only; at each screen.
enum class Where { Everywhere, Soils, Stretch, StretchOnly, Screens };

/// A way to search for an effect. The strength scales one parameter from where the effect vanishes to `reference` at strength 1.
struct Search {
    const char* family;  ///< name of the effect that stands for all of its family
    EffectKind kind;
    const char* parameter;
    double reference;  ///< [unit of the parameter]; of low friction and of a patch a factor [-]
    double most;       ///< [-]
    Where where;
    const char* label;  ///< tells the ways of one effect apart
};

using K = EffectKind;

constexpr Search kSearches[] = {
    {"restitution_half_speed", K::RestitutionHalfSpeed, "half_speed", 10.0, 8.0, Where::Everywhere, ""},
    {"restitution_half_speed", K::RestitutionPfeifferBowen, "half_speed", 9.144, 6.0, Where::Everywhere, "squared"},
    {"restitution_mass", K::RestitutionMass, "exponent", -0.15, 6.0, Where::Everywhere, ""},
    {"slip_friction", K::SlipFriction, "ratio", 3.6, 5.0, Where::Everywhere, ""},
    {"friction_speed", K::FrictionSpeed, "limit", 0.7, 3.2, Where::Everywhere, "weaker where it slides fast"},
    {"friction_speed", K::FrictionSpeed, "limit", 1.5, 4.0, Where::Everywhere, "stronger where it slides fast"},
    {"friction_speed", K::FrictionBlockSpeed, "limit", 0.7, 3.2, Where::Everywhere, "weaker under fast blocks"},
    {"friction_speed", K::FrictionBlockSpeed, "limit", 1.5, 4.0, Where::Everywhere, "stronger under fast blocks"},
    {"rolling_speed", K::RollingSpeed, "speed", 5.0, 5.0, Where::Soils, ""},
    {"rolling_size", K::RollingSize, "exponent", 1.0, 3.0, Where::Everywhere, "more for large blocks"},
    {"rolling_size", K::RollingSize, "exponent", -1.0, 2.0, Where::Everywhere, "less for large blocks"},
    {"soil_scatter", K::SoilScatter, "rolling", 0.5, 3.0, Where::Everywhere, "of rolling resistance"},
    {"soil_scatter", K::SoilScatter, "friction", 0.2, 3.0, Where::Everywhere, "of friction"},
    {"low_friction", K::LowFriction, "friction", 0.6, 3.0, Where::Soils, ""},
    {"low_friction", K::LowFriction, "friction", 0.6, 3.0, Where::StretchOnly, ""},
    {"roughness", K::Roughness, "amplitude", 0.05, 8.0, Where::Soils, ""},
    {"soil_patch", K::SoilPatch, "rolling", 3.0, 4.0, Where::StretchOnly, "that holds blocks back"},
    {"soil_patch", K::SoilPatch, "rolling", 1.0 / 3.0, 4.0, Where::StretchOnly, "that lets blocks run"},
    {"ground_drag", K::GroundDrag, "coefficient", 0.3, 30.0, Where::Soils, "linear"},
    {"ground_drag", K::GroundDragQuadratic, "coefficient", 0.03, 30.0, Where::Soils, "quadratic"},
    {"ground_drag", K::ScarDragReduced, "coefficient", 0.03, 30.0, Where::Everywhere, "scar"},
    {"forest_drag", K::ForestDrag, "coefficient", 500.0, 6.0, Where::Stretch, ""},
    {"forest_drag", K::Trees, "density", 400.0, 6.0, Where::Everywhere, "single trees"},
    {"fragmentation", K::Fragmentation, "speed", 8.0, 3.0, Where::Everywhere, ""},
    {"release_motion", K::ReleaseMotion, "speed", 2.0, 4.0, Where::Everywhere, ""},
    {"block_shape", K::BlockShape, "corners", 1.5, 4.0, Where::Everywhere, "rounder"},
    {"block_shape", K::BlockShape, "corners", 1.0 / 1.5, 3.0, Where::Everywhere, "sharper"},
    {"block_shape", K::BlockShape, "elongation", 1.25, 4.0, Where::Everywhere, "longer"},
    {"block_shape", K::BlockShape, "flatness", 1.25, 4.0, Where::Everywhere, "platier"},
    {"speed_error", K::SpeedError, "bias", 0.1, 4.0, Where::Everywhere, "too fast"},
    {"speed_error", K::SpeedError, "bias", -0.1, 4.0, Where::Everywhere, "too slow"},
    {"speed_error", K::SpeedError, "noise", 1.0, 10.0, Where::Everywhere, "noise"},
    {"screen_shift", K::ScreenShift, "shift", 2.0, 5.0, Where::Screens, "down the slope"},
    {"screen_shift", K::ScreenShift, "shift", -2.0, 5.0, Where::Screens, "up the slope"},
    {"slow_missed", K::SlowMissed, "least_speed", 2.0, 4.0, Where::Everywhere, ""},
    {"broken_block", K::BrokenBlock, "last_impact", 0.5, 2.0, Where::Everywhere, ""},
    {"ids_shuffled", K::IdsShuffled, "share", 0.5, 2.0, Where::Everywhere, ""},
    {"height_datum", K::HeightDatum, "offset", 0.3, 10.0, Where::Everywhere, "too high"},
    {"height_datum", K::HeightDatum, "offset", -0.3, 10.0, Where::Everywhere, "too low"},
};

constexpr const char* kAbsent = "said to be absent (diagnosis.without)";
constexpr double kMostForce = 30.0;   ///< largest strength of a force without a name [-]
constexpr double kLeastSpeed = 0.05;  ///< slower, it does not grow as the speed falls [m/s]

/// An acceleration a (v / 1 m/s)^b (m / d)^c against the motion.
void force_in_contact(const scree_contact_state* state, scree_ground_drag_values* drag) {
    const auto& [a, b, c, d] = state->number;
    const double speed = std::max(std::hypot(state->velocity[0], state->velocity[1], state->velocity[2]), kLeastSpeed);
    drag->linear = a * std::pow(speed, b - 1.0) * std::pow(state->mass / d, c);
}

void weaker_bounces(const scree_contact_state* state, scree_contact_law_values* law) {
    law->restitution *= std::max(0.0, 1.0 - state->number[0]);
}

/// To a decimetre.
std::string metres(double chainage) {
    std::ostringstream text;
    text << std::round(10.0 * chainage) / 10.0;
    return text.str();
}

std::string joined(const std::string& a, const std::string& b) {
    return a.empty() || b.empty() ? a + b : a + ", " + b;
}

/// A calibration that makes up for what is missing may end at e = 0, and what is missing act where it does not.
bool may_bounce(const std::vector<Soil>& soils, const FreeKeys& keys) {
    const auto of_restitution = [](const std::string& key) { return key.ends_with(".restitution"); };
    return std::any_of(soils.begin(), soils.end(), [](const Soil& soil) { return soil.restitution > 0.0; }) ||
           std::any_of(keys.problem.parameters.begin(), keys.problem.parameters.end(),
                       [&](const CalibrationParameter& p) { return of_restitution(p.name) && p.high > 0.0; }) ||
           std::any_of(keys.problem.choices.begin(), keys.problem.choices.end(),
                       [&](const CalibrationChoice& c) { return of_restitution(c.name); });
}

/// Which of the test's quantities were measured at all, and what the site lets act.
class Catalogue {
public:
    Catalogue(const SiteFile& site, const SiteModel& model, const ObservedSite& observed, const FreeKeys& keys)
        : s_(site.settings), model_(model), observed_(observed), bounces_(may_bounce(s_.soils, keys)) {
        const ObservationTable table = measured_table(observed.observations, observed.op);
        for (const Column& c : table.columns) measured_.push_back(c.quantity);
        const std::size_t along = table.find({Quantity::Along});
        if (along < table.columns.size())
            for (const double v : table.values[along])
                if (std::isfinite(v)) length_ = std::max(length_, v);
    }

    DiagnosisCatalogue forces() {
        const bool known = observed_.observations.matched;
        DiagnosisCandidate contact{kForceNames[0], "", false, {}}, all{kForceNames[1], "", false, {}},
            bounces{kForceNames[2], "", false, {}}, stretches{kForceNames[3], "", false, {}};
        for (const double power : kSpeedPowers)
            for (const double of_mass : kMassPowers)
                if (known || of_mass == 0.0) contact.variants.push_back(force(power, of_mass));
        DiagnosisVariant everywhere;
        everywhere.kind = K::ForestDrag;
        everywhere.parameter = "coefficient";
        everywhere.reference = 0.3 * typical_mass();
        everywhere.most = kMostForce;
        everywhere.probe = make_effect(K::ForestDrag);
        everywhere.probe->set("height", effect_parameter(K::ForestDrag, "height").high);
        all.variants.push_back(everywhere);
        DiagnosisVariant weaker = probe();
        weaker.reference = 0.2;
        weaker.most = 5.0;
        weaker.probe->own.contact_law = weaker_bounces;
        bounces.variants.push_back(weaker);
        if (length_ > 0.0) stretches.variants.push_back(on_a_stretch(force(1.0, 0.0)));
        result_.candidates = {contact, all};
        if (bounces_) result_.candidates.push_back(bounces);
        if (!stretches.variants.empty()) result_.candidates.push_back(stretches);
        result_.put_on = puts_on();
        return std::move(result_);
    }

    DiagnosisCatalogue make(const std::string& no_space) {
        for (const Search& search : kSearches) {
            const EffectInfo& info = effect_info(search.kind);
            const std::string reason = reason_against(search, info);
            if (!reason.empty()) {
                const std::string line = std::string(info.name) + ": " + reason;
                if (std::find(result_.left_out.begin(), result_.left_out.end(), line) == result_.left_out.end())
                    result_.left_out.push_back(line);
                continue;
            }
            add(search, candidate(search.family, info));
        }
        add_third_dimension(no_space);
        for (const char* line :
             {"net, berm: where they stand is known; draw them into the site and compare",
              "scar_drag: as ground_drag, which is searched; its depth needs impacts that were measured",
              "air_drag: a per cent of the weight at most",
              "spin at the release: a number of the site that a calibration can free, release.spin"})
            result_.left_out.emplace_back(line);
        result_.put_on = puts_on();
        return std::move(result_);
    }

private:
    /// A law of our own whose number `a` is the strength.
    static DiagnosisVariant probe() {
        DiagnosisVariant v;
        v.kind = K::OwnLaw;
        v.parameter = "a";
        v.start = 0.0;
        v.probe = make_effect(K::OwnLaw);
        return v;
    }

    /// Against the motion in contact.
    DiagnosisVariant force(double speed_power, double mass_power) const {
        DiagnosisVariant v = probe();
        std::ostringstream text;
        text << "speed^" << speed_power << " mass^" << mass_power;
        v.label = text.str();
        v.reference = 0.3;
        v.most = kMostForce;
        v.probe->own.ground_drag = force_in_contact;
        v.probe->set("b", speed_power);
        v.probe->set("c", mass_power);
        v.probe->set("d", typical_mass());
        return v;
    }

    double typical_mass() const {
        double sum = 0.0, count = 0.0;
        for (const ObservedBlock& b : observed_.observations.blocks)
            if (b.has_body()) {
                sum += std::log(b.mass);
                count += 1.0;
            }
        return count > 0.0 ? std::exp(sum / count) : 1000.0;
    }

    bool measured(Quantity q) const { return std::find(measured_.begin(), measured_.end(), q) != measured_.end(); }
    bool has_effect(EffectKind kind) const {
        return std::any_of(s_.effects.begin(), s_.effects.end(),
                           [&](const EffectSettings& e) { return e.effect.kind == kind; });
    }

    /// Those of the site, without the starts and ends of impacts.
    std::size_t screens() const { return observed_.op.screens.size() - 2 * observed_.op.impacts; }

    bool said_to_be_absent(const std::string& name) const {
        return std::find(s_.diagnosis_without.begin(), s_.diagnosis_without.end(), name) != s_.diagnosis_without.end();
    }

    /// Why an effect is not searched for; empty: it is.
    std::string reason_against(const Search& search, const EffectInfo& info) const {
        if (said_to_be_absent(search.family)) return kAbsent;
        if (has_effect(search.kind)) return "the site has it";
        if (info.limits.needs_impact && s_.dynamics.mode != SteppingMode::Event) return "needs model.mode = \"event\"";
        const bool known = observed_.observations.matched;
        const EffectKind k = search.kind;
        if ((k == K::RestitutionHalfSpeed || k == K::RestitutionPfeifferBowen || k == K::RestitutionMass) && !bounces_)
            return "cannot be seen, every soil has e = 0";
        if ((k == K::RestitutionMass || k == K::RollingSize || k == K::IdsShuffled) && !known)
            return "needs blocks that are identified";
        if ((k == K::SpeedError || k == K::SlowMissed) && !measured(Quantity::Speed)) return "no speeds were measured";
        if (k == K::ScreenShift && screens() == 0) return "there are no screens";
        if (k == K::BrokenBlock && !has_effect(K::Fragmentation))
            return "needs blocks that break, the effect fragmentation";
        if (k == K::BrokenBlock && !measured(Quantity::Along)) return "no stops were measured";
        if (k == K::HeightDatum && !measured(Quantity::Height)) return "no passing heights were measured";
        if (k == K::BlockShape && search.parameter == std::string("corners") && s_.shape != BlockShape::Hull)
            return "corners are fixed by blocks.shape";
        if (k == K::BlockShape && search.parameter == std::string("flatness") && model_.in_plane())
            return "flatness is not looked for in 2D, where blocks have no thickness";
        if (search.where == Where::StretchOnly && !(length_ > 0.0)) return "no stops were measured along the path";
        return {};
    }

    DiagnosisCandidate& candidate(const std::string& family, const EffectInfo& info) {
        for (DiagnosisCandidate& c : result_.candidates)
            if (c.name == family) return c;
        result_.candidates.push_back({family, info.title, info.hook == EffectHook::Measurement, {}});
        return result_.candidates.back();
    }

    void add(const Search& search, DiagnosisCandidate& to) const {
        DiagnosisVariant v;
        v.kind = search.kind;
        v.label = search.label;
        v.parameter = search.parameter;
        v.reference = search.reference;
        v.most = search.most;
        v = v.on_ground(s_.soils);
        if (search.where == Where::Screens) {
            for (std::size_t k = 0; k < screens(); ++k) {
                DiagnosisVariant at = v;
                at.place.screen = observed_.op.screens[k];
                if (screens() > 1) at.label = joined(at.place.screen, v.label);
                to.variants.push_back(at);
            }
            return;
        }
        if (search.where != Where::StretchOnly) to.variants.push_back(v);
        if (search.where == Where::Soils && s_.soils.size() > 1)
            for (std::size_t k = 0; k < s_.soils.size(); ++k) {
                DiagnosisVariant on = v;
                on.place.soil = static_cast<int>(k);
                on.soil = s_.soils[k].name;
                on.label = joined(v.label, "on " + on.soil);
                to.variants.push_back(on.on_ground(s_.soils));
            }
        if ((search.where == Where::Stretch || search.where == Where::StretchOnly) && length_ > 0.0)
            to.variants.push_back(on_a_stretch(v));
    }

    void add_third_dimension(const std::string& no_space) {
        if (!model_.in_plane()) return;
        const std::string reason = said_to_be_absent(kThirdDimension) ? kAbsent : no_space;
        if (!reason.empty()) {
            result_.left_out.push_back(std::string(kThirdDimension) + ": " + reason);
            return;
        }
        DiagnosisVariant v;
        v.space = true;
        v.parameter = "share";
        v.reference = 0.5;
        v.most = 2.0;
        result_.candidates.push_back({kThirdDimension, "what a profile leaves out", false, {v}});
    }

    DiagnosisVariant on_a_stretch(DiagnosisVariant v) const {
        v.path = Stretch{0.0, length_};
        return v;
    }

    /// Across the whole terrain between two chainages, on the ground in the middle.
    std::function<DiagnosisVariant(const DiagnosisVariant&, const Stretch&)> puts_on() const {
        const std::vector<ProfileTrack>& tracks = model_.campaign.tracks;
        return [axis = observed_.op.axis, terrain = model_.terrain.data.grid.shape.bounds(),
                surface = model_.terrain.surface.get(), soils = s_.soils,
                profile = tracks.size() == 1 ? tracks.front().profile : Profile()](const DiagnosisVariant& variant,
                                                                                   const Stretch& on) {
            DiagnosisVariant v = variant;
            v.path.reset();
            v.on = on;
            v.label = joined(v.label, "from " + metres(on.from) + " to " + metres(on.to) + " m");
            const Vec2 a = axis.point(on.from), b = axis.point(on.to), along = (b - a).normalized();
            const Vec2 left(-along.y(), along.x());
            double right_end = 0.0, left_end = 0.0;  // of the terrain, from the axis
            for (const double x : {terrain.min.x(), terrain.max.x()})
                for (const double y : {terrain.min.y(), terrain.max.y()}) {
                    right_end = std::min(right_end, (Vec2(x, y) - a).dot(left));
                    left_end = std::max(left_end, (Vec2(x, y) - a).dot(left));
                }
            const MultiPolygon area{
                {{a + right_end * left, b + right_end * left, b + left_end * left, a + left_end * left}, {}}};
            v.place.limit_to(area);
            if (!profile.empty())
                if (const std::vector<Stretch> inside = profile.inside(area); !inside.empty())
                    v.on_profile = Stretch{inside.front().from, inside.back().to};
            std::array<Vec3, 3> corners;
            const std::int64_t f = surface->facet_at(axis.point(on.middle()));
            if (f >= 0) surface->facet(f, corners, v.ground);
            return v.on_ground(soils);
        };
    }

    const SiteSettings& s_;
    const SiteModel& model_;
    const ObservedSite& observed_;
    const bool bounces_;  ///< on some soil e is not 0, or may become so
    std::vector<Quantity> measured_;
    double length_ = 0.0;  ///< of the path along the axis: the farthest stop [m]
    DiagnosisCatalogue result_;
};

}  // namespace

DiagnosisVariant DiagnosisVariant::on_ground(std::span<const Soil> soils) const {
    DiagnosisVariant v = *this;
    if (kind == EffectKind::LowFriction && place.soil >= 0) {
        v.start = soils[static_cast<std::size_t>(place.soil)].friction;
    } else if (kind == EffectKind::LowFriction) {  // from the largest downwards: of several soils any may be there
        v.start = 0.0;
        for (const Soil& one : soils) v.start = std::max(v.start, one.friction);
    }
    if (kind == EffectKind::SoilPatch) v.start = std::max(kLeastRolling, soils[ground].rolling);
    return v;
}

double DiagnosisVariant::value(double strength) const {
    if (space) return std::clamp(strength * reference, 0.0, 1.0);
    const EffectParameter& p = effect_parameter(kind, parameter);
    const double neutral = std::isnan(start) ? p.neutral : start;
    double v = 0.0;
    if (kind == EffectKind::SoilPatch || kind == EffectKind::LowFriction)
        v = neutral * std::pow(reference, strength);
    else if (kind == EffectKind::BlockShape)
        v = neutral * std::pow(reference / neutral, strength);  // factors
    else if (std::isinf(neutral))
        v = strength > 0.0 ? reference / strength : p.high;
    else
        v = neutral + strength * (reference - neutral);
    return std::clamp(v, p.low, p.high);
}

Effect DiagnosisVariant::at(double strength) const {
    Effect effect = probe ? *probe : make_effect(kind);
    effect.place = place;
    // one of what it may change at a time
    if (kind == EffectKind::SpeedError) effect.set("bias", 0.0);
    if (kind == EffectKind::SoilScatter) effect.set("rolling", 0.0);
    effect.set(parameter, value(strength));
    return effect;
}

const char* DiagnosisVariant::form() const {
    return space ? kThirdDimension : effect_info(kind).name;
}

const char* DiagnosisVariant::unit() const {
    return space ? "-" : effect_parameter(kind, parameter).unit;
}

const char* DiagnosisVariant::seen_in() const {
    return space ? "where blocks stop beside the profile" : effect_info(kind).seen_in;
}

std::vector<CandidateEffect> DiagnosisCatalogue::for_core() const {
    std::vector<CandidateEffect> list;
    for (const DiagnosisCandidate& c : candidates) {
        CandidateEffect e{c.name, c.measurement, {}};
        for (const DiagnosisVariant& v : c.variants) {
            e.variants.push_back({v.label, v.most, v.path});
            // left to a diagnosis in 3D, which does not simulate in 2D besides
            if (v.space) {
                e.second_beside = false;
                e.share = true;
            }
        }
        list.push_back(std::move(e));
    }
    return list;
}

void check_absent_effects(const SiteSettings& settings) {
    std::vector<std::string> families;
    for (const Search& search : kSearches)
        if (families.empty() || families.back() != search.family) families.emplace_back(search.family);
    families.emplace_back(kThirdDimension);
    for (const std::string& name : settings.diagnosis_without) {
        if (std::find(families.begin(), families.end(), name) != families.end()) continue;
        std::string names;
        for (const std::string& family : families) names.append(names.empty() ? "" : ", ").append(family);
        throw InputError("diagnosis.without: \"" + name + "\" is no effect that is searched for; there are " + names);
    }
}

DiagnosisCatalogue make_forces(const SiteFile& calibrated, const SiteModel& model, const ObservedSite& observed,
                               const FreeKeys& keys) {
    return Catalogue(calibrated, model, observed, keys).forces();
}

DiagnosisCatalogue make_candidates(const SiteFile& calibrated, const SiteModel& model, const ObservedSite& observed,
                                   const FreeKeys& keys, const std::string& no_space) {
    return Catalogue(calibrated, model, observed, keys).make(no_space);
}

}  // namespace scree::cli
