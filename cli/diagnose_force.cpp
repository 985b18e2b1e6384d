// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_force.hpp"

#include "cli/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree::cli {

namespace {

constexpr double kForceSeen = 2.0;  // z of a force that explains anything [-]
constexpr double kForceMost = 0.5;  // share of what is off beyond chance that a force must take away to explain it [-]
constexpr double kForceTold = 4.0;  // by which the square of a z is larger where two ways of a force are told apart [-]

/// One way of a force, with the z of its fingerprint.
struct ForceWay {
    std::string words;
    double z = 0.0;
};

/// "while they touch the ground (z = 5.1; all the way: 3.2)", or the first two with "or" where the data do not tell them apart.
std::string best_of(std::vector<ForceWay> ways, double sign) {
    std::stable_sort(ways.begin(), ways.end(),
                     [&](const ForceWay& a, const ForceWay& b) { return sign * a.z > sign * b.z; });
    const auto gain = [&](const ForceWay& w) { return sign * w.z > 0.0 ? w.z * w.z : 0.0; };
    std::string text = ways.front().words, others;
    std::size_t like = 1;
    while (like < ways.size() && gain(ways.front()) - gain(ways[like]) < kForceTold)
        text += " or " + ways[like++].words;
    for (std::size_t k = 1; k < ways.size(); ++k)
        others += "; " + ways[k].words + ": " + short_number(sign * ways[k].z);
    return text + " (z = " + short_number(sign * ways.front().z) + others + ")";
}

/// z of all ways and places of a force, those of candidates that were not tried empty; nothing of what no strength that was tried could show: its z is noise.
std::vector<double> force_z(const DiagnoseStudy& study, const std::string& name) {
    std::vector<double> z;
    const ScoreResult& score = study.by_force.score;
    Eigen::Index at = 0;
    for (const EffectDose& d : study.by_force.looked_at) {
        const DiagnosisCandidate& force = study.forces.candidates[d.effect];
        const bool visible = score.visibility[at] * force.variants[d.variant].most >= kForceSeen;
        if (force.name == name) z.push_back(visible ? score.z[at] : 0.0);
        ++at;
    }
    return z;
}

/// The places that a force was tried on, in the same order.
std::vector<Stretch> force_places(const DiagnoseStudy& study) {
    std::vector<Stretch> places;
    for (const EffectDose& d : study.by_force.looked_at)
        if (d.on) places.push_back(*d.on);
    return places;
}

}  // namespace

std::vector<std::string> force_sentences(const DiagnoseStudy& study) {
    if (study.by_force.score.z.size() == 0) return {};
    const std::vector<double> contact = force_z(study, kForceNames[0]), all = force_z(study, kForceNames[1]),
                              bounces = force_z(study, kForceNames[2]), stretches = force_z(study, kForceNames[3]);
    const std::size_t masses = contact.size() / kSpeedPowers.size();
    const auto largest = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const double of_contact = *std::max_element(contact.begin(), contact.end(), largest);
    std::vector<ForceWay> phases{{"while they touch the ground", of_contact},
                                 {"all the way, in flight as well", all.front()}};
    if (!bounces.empty()) phases.push_back({"in bounces, which are weaker or stronger", bounces.front()});
    const double best =
        std::max_element(phases.begin(), phases.end(), [&](auto& a, auto& b) { return largest(a.z, b.z); })->z;
    if (std::abs(best) < kForceSeen)
        return {"no force along the motion explains it, in whatever phase (z of at most " +
                short_number(std::abs(best)) + ")"};
    const double sign = best > 0.0 ? 1.0 : -1.0;
    std::vector<std::string> sentences;
    const double beyond_chance = study.by_force.score.q - static_cast<double>(study.by_force.residuals.size()) +
                                 static_cast<double>(study.keys.problem.parameters.size());
    const double taken = study.by_force.score.z.array().square().maxCoeff();
    if (taken < kForceMost * beyond_chance)
        sentences.push_back("no force along the motion explains it: the best takes away " +
                            short_number(100.0 * taken / beyond_chance) +
                            " % of what is off beyond chance; what follows is of that part only");
    sentences.push_back(std::string("blocks behave as if they were held back ") + (sign > 0.0 ? "more" : "less") +
                        " than in the model " + best_of(phases, sign));
    if (!(sign * of_contact > kForceSeen)) return sentences;
    std::vector<ForceWay> speeds, of_masses;
    std::size_t power = 0;
    for (std::size_t k = 0; k < kSpeedPowers.size(); ++k) {
        speeds.push_back({"speed^" + short_number(kSpeedPowers[k]), contact[k * masses]});
        if (sign * contact[k * masses] > sign * contact[power * masses]) power = k;
    }
    sentences.push_back("while they touch the ground it grows with " + best_of(speeds, sign));
    const std::array<const char*, kMassPowers.size()> words{"alike for all masses", "more for light blocks",
                                                            "more for heavy blocks"};
    for (std::size_t k = 0; k < masses; ++k) of_masses.push_back({words[k], contact[power * masses + k]});
    if (masses > 1) sentences.push_back("it is " + best_of(of_masses, sign));
    if (stretches.empty()) return sentences;
    std::vector<ForceWay> places{{"all along the path", contact[masses]}};
    const std::vector<Stretch> on = force_places(study);
    for (std::size_t k = 0; k < stretches.size(); ++k)
        places.push_back({"from " + short_number(on[k].from) + " to " + short_number(on[k].to) + " m", stretches[k]});
    const bool told =
        std::any_of(places.begin(), places.end(), [&](const ForceWay& w) { return sign * w.z >= kForceSeen; });
    if (told) sentences.push_back("it acts " + best_of(places, sign));
    return sentences;
}

}  // namespace scree::cli
