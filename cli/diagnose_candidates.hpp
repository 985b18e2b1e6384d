// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/free_keys.hpp"
#include "cli/observed_site.hpp"
#include "scree/inference/diagnosis.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scree::cli {

/// One way in which an effect may be missing, as a function of its strength.
struct DiagnosisVariant {
    EffectKind kind = EffectKind::GroundDrag;
    std::string label;      ///< "on loose waste", "between 40 and 55 m"; empty if there is one way only
    std::string parameter;  ///< key of the catalogue whose value the strength stands for
    double start =
        kNaN;  ///< its value at strength 0 where the catalogue has none: that of the ground there (on_ground) [*]
    double reference =
        0.0;            ///< its value at strength 1; of a soil patch and of low friction, as a share of `start` [*]
    double most = 3.0;  ///< largest strength that is searched [-]
    EffectPlace place;
    std::string soil;  ///< name, for the site file; empty: all
    std::optional<Stretch>
        path;  ///< it acts on some stretch of this, along the axis of the observations, which is to be found
    std::optional<Stretch> on;  ///< the stretch that `place` is
    std::optional<Stretch>
        on_profile;  ///< the same by the chainage of the profile, which from and to of a site count; of a 2D model with one profile

    SoilId ground = 0;  ///< soil in the middle of `place`, which a soil patch changes
    std::optional<Effect>
        probe;           ///< what acts where the catalogue has no effect for it, but for `parameter` and `place`
    bool space = false;  ///< no effect, but blocks of a 2D model that move in 3D; the strength is twice their share

    /// The same with `start` as these soils have it: where parameters of soils move, so does what changes nothing.
    DiagnosisVariant on_ground(std::span<const Soil> soils) const;
    /// Value of the parameter: where the effect vanishes at 0, `reference` at 1.
    double value(double strength) const;
    /// Not of `space`.
    Effect at(double strength) const;
    /// Name of the catalogue.
    const char* form() const;
    const char* unit() const;
    const char* seen_in() const;
};

/// A family of effects that differ in their formula only, and that no field test tells apart: named together.
struct DiagnosisCandidate {
    std::string name;   ///< of the catalogue, of the family's first member
    std::string title;  ///< a few words
    bool measurement = false;
    std::vector<DiagnosisVariant> variants;
};

/// What was searched for, and what was not and why.
struct DiagnosisCatalogue {
    std::vector<DiagnosisCandidate> candidates;
    std::vector<std::string> left_out;  ///< "net: where one stands is known", a sentence each
    /// A variant that has a path, on a stretch of it. Asks the terrain, which must live as long.
    std::function<DiagnosisVariant(const DiagnosisVariant&, const Stretch&)> put_on;

    DiagnosisVariant variant(std::size_t effect, std::size_t variant, const std::optional<Stretch>& on) const {
        const DiagnosisVariant& v = candidates[effect].variants[variant];
        return on ? put_on(v, *on) : v;
    }
    std::vector<CandidateEffect> for_core() const;
};

/// Names in diagnosis.without must be those of effects that are searched for. Throws InputError.
void check_absent_effects(const SiteSettings& settings);

/// Everything of the effects' catalogue that this site and test can be searched for, and of a 2D model the third dimension, if nothing stands against it.
/// Effects that the site has already are left out. What a calibration may change counts with all its values: `keys`.
DiagnosisCatalogue make_candidates(const SiteFile& calibrated, const SiteModel& model, const ObservedSite& observed,
                                   const FreeKeys& keys, const std::string& no_space);
inline constexpr const char* kThirdDimension = "third_dimension";

/// Forces without a name, for what has none: they say in which phase of the motion, at which speeds, masses and places something is missing. As candidates:
/// against the motion while the ground bears the block, growing with powers of speed and of mass (each of kSpeedPowers with each of kMassPowers); the same all
/// the way, in flight as well, proportional to speed over mass; bounces that are weaker; and the first, proportional to the speed, on a stretch of the path.
DiagnosisCatalogue make_forces(const SiteFile& calibrated, const SiteModel& model, const ObservedSite& observed,
                               const FreeKeys& keys);
inline constexpr std::array kSpeedPowers{0.0, 1.0, 2.0};
inline constexpr std::array kMassPowers{0.0, -0.5,
                                        0.5};  ///< of the acceleration; only the first where blocks are unknown
inline constexpr std::array kForceNames{"contact", "all the way", "bounces", "stretches"};

}  // namespace scree::cli
