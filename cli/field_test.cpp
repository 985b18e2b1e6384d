// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/field_test.hpp"

#include "cli/progress.hpp"
#include "gis/dataset.hpp"

#include <algorithm>
#include <filesystem>

namespace scree::cli {

FieldTest::FieldTest(const SiteFile& site, const SiteModel& model, const ObservedSite& observed, const FreeKeys& keys,
                     int threads)
    : site_(site),
      observed_(observed),
      keys_(keys),
      blocks_(blocks_of(observed)),
      input_(model.campaign),
      space_(make_space_model(site, model)) {
    for (CampaignInput* input : {&input_, &space_.campaign}) {
        input->threads = threads;
        input->kept_trajectories = 0;
    }
}

namespace {

CampaignResult thrown(const CampaignInput& input) {
    return run_campaign(
        input, [](std::int64_t) {}, InterruptScope::flag());
}

}  // namespace

CampaignResult FieldTest::run(const SiteFile& candidate, std::uint64_t seed, std::int64_t repeats,
                              std::span<const Effect> more, bool passages, double in_space) const {
    CampaignInput plane = input_for(input_, candidate, seed, repeats, more, passages);
    if (in_space <= 0.0) return thrown(plane);
    CampaignInput space = input_for(space_.campaign, candidate, seed, repeats, more, passages);
    if (in_space >= 1.0) return thrown(space);
    space.thrown = chosen_share(space.release.count, in_space, seed);
    plane.thrown = space.thrown;
    plane.thrown.flip();
    return merged(thrown(plane), thrown(space));
}

CampaignResult FieldTest::run_from(const SiteFile& candidate, std::uint64_t seed,
                                   std::span<const std::optional<Departure>> departures) const {
    CampaignInput input = input_for(input_, candidate, seed, std::ssize(departures) / blocks_, {}, false);
    for (const std::optional<Departure>& from : departures) {
        input.thrown.push_back(from.has_value());
        input.departures.push_back(from.value_or(Departure{}));
    }
    return thrown(input);
}

CampaignInput FieldTest::input_for(CampaignInput input, const SiteFile& candidate, std::uint64_t seed,
                                   std::int64_t repeats, std::span<const Effect> more, bool passages) const {
    input.passages = passages;
    SiteFile site = candidate;
    site.settings.observed.repeats = repeats;
    apply_parameters(site, input);
    input.dynamics.kept_problems = 0;
    input.seed = seed;
    input.release.count = repeats * blocks_;
    match_campaign(site, observed_, input);
    shift_screens(more, observed_.op.axis, input);
    input.effects.insert(input.effects.end(), more.begin(), more.end());
    return input;
}

ObservedSite with_faults(const ObservedSite& observed, std::span<const Effect> effects) {
    ObservedSite faulty = observed;
    faulty.op.effects.insert(faulty.op.effects.end(), effects.begin(), effects.end());
    return faulty;
}

std::vector<std::string> input_lines(const SiteModel& model, const ObservedSite& observed) {
    std::vector<std::string> lines;
    const auto add = [&](const gis::InputFile& file, const char* what) {
        lines.push_back(std::filesystem::path(file.path).filename().string() + what + ", sha256 " + file.sha256);
    };
    for (const gis::InputFile& file : observed.files) add(file, " (measured)");
    for (const gis::InputFile& file : model.files) add(file, "");
    return lines;
}

}  // namespace scree::cli
