// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/diagnose_further.hpp"

#include "cli/text.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

namespace {

/// z of the difference between two effects at which one of them has almost all the weight: the likelihoods differ by exp(9/2) [-].
constexpr double kToldApart = 3.0;
/// Many times the blocks of the test: nobody would throw so many [-].
constexpr double kMostGrowth = 20.0;

double cosine(const Diagnosis& d, const EffectFinding& a, const EffectFinding& b) {
    return d.cosines(static_cast<Eigen::Index>(a.effect), static_cast<Eigen::Index>(b.effect));
}

/// With `growth` times the blocks an effect is seen that is weaker by the root of that.
bool is_seen(const EffectFinding& f, double growth) {
    return f.smallest_seen <= std::sqrt(growth);
}

FurtherRow row_of(const std::string& name, const Diagnosis& d, double growth, const FurtherRow& planned,
                  const std::vector<std::string>& names, std::vector<std::string>& seen) {
    FurtherRow row{name, 0, 0, {}};
    seen.clear();
    for (const EffectFinding& f : d.findings)
        if (is_seen(f, growth)) seen.push_back(names[f.effect]);
    row.seen = seen.size();
    for (std::size_t a = 0; a < d.findings.size(); ++a)
        for (std::size_t b = a + 1; b < d.findings.size(); ++b)
            row.alike += look_alike(d, d.findings[a], d.findings[b]);
    for (const std::string& s : seen)
        if (!planned.name.empty() && std::find(planned.also.begin(), planned.also.end(), s) == planned.also.end())
            row.also.push_back(s);
    return row;
}

/// Least z of the difference between two members of a group at the strengths found.
double least_difference(const DiagnoseStudy& study, const Diagnosis& plan) {
    double least = kInfinity;
    const auto z_of = [&](const EffectFinding& f) {
        return f.visibility * study.answers[f.effect].effects.front().strength;
    };
    for (const EffectFinding& a : plan.findings)
        for (const EffectFinding& b : plan.findings) {
            if (a.effect >= b.effect) continue;
            const double c = std::min(std::abs(cosine(plan, a, b)), 1.0);
            least = std::min(least, std::min(z_of(a), z_of(b)) * std::sqrt(1.0 - c * c));
        }
    return least;
}

}  // namespace

bool look_alike(const Diagnosis& plan, const EffectFinding& a, const EffectFinding& b) {
    return a.effect != b.effect && cosine(plan, a, b) >= kSameLooks && a.visible && b.visible;
}

std::vector<FurtherRow> further_rows(const DiagnoseStudy& study) {
    if (!study.planning || study.further.empty()) return {};
    std::vector<std::string> names, seen, seen_then;
    for (const DiagnosisCandidate& c : study.catalogue.candidates) names.push_back(c.name);
    const Diagnosis& as_planned = study.further.front().plan;
    std::vector<FurtherRow> rows{row_of("as planned", as_planned, 1.0, {}, names, seen)};
    const FurtherRow planned{"as planned", 0, 0, seen};
    for (std::size_t k = 1; k < study.further.size(); ++k) {
        const WithInstrument& w = study.further[k];
        rows.push_back(row_of("with " + w.name, w.plan, w.blocks, planned, names, seen_then));
    }
    return rows;
}

std::vector<std::string> telling_apart_sentences(const DiagnoseStudy& study) {
    std::vector<std::string> sentences;
    if (study.planning || study.answers.size() < 2) return sentences;
    for (const WithInstrument& w : study.further) {
        const double z = least_difference(study, w.plan);
        const double blocks = static_cast<double>(study.blocks) * std::pow(kToldApart / std::max(z, 1e-9), 2.0);
        const std::string how = "with " + w.name + ": ";
        if (blocks > kMostGrowth * static_cast<double>(study.blocks))
            sentences.push_back(how + "not told apart by any number of blocks that is worth throwing");
        else
            sentences.push_back(how + "told apart from about " +
                                short_number(std::max(10.0, 10.0 * std::ceil(blocks / 10.0))) + " blocks on");
    }
    return sentences;
}

}  // namespace scree::cli
