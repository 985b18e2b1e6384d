// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/free_keys.hpp"
#include "cli/observed_site.hpp"
#include "cli/space_model.hpp"

#include <optional>
#include <span>

namespace scree::cli {

/// A field test that can be repeated with other values of free keys and with effects that the site does not have.
class FieldTest {
public:
    FieldTest(const SiteFile& site, const SiteModel& model, const ObservedSite& observed, const FreeKeys& keys,
              int threads);

    SiteFile site_at(const CalibrationPoint& point) const { return with_changes(site_, keys_.changes(point)); }
    /// Throws every measured block `repeats` times. `more`: effects beside those of the site. `passages`: statistics of the cells, too. `in_space`: of a 2D
    /// model, this share of the blocks moves in 3D. Interrupted by Ctrl-C.
    CampaignResult run(const SiteFile& candidate, std::uint64_t seed, std::int64_t repeats,
                       std::span<const Effect> more = {}, bool passages = false, double in_space = 0.0) const;
    /// From where they were seen on their way: block k of the campaign is block k mod n of the test, and without a departure it is not thrown. At least one
    /// departs.
    CampaignResult run_from(const SiteFile& candidate, std::uint64_t seed,
                            std::span<const std::optional<Departure>> departures) const;
    /// Why there is no 3D model of the same; empty: there is.
    const std::string& no_space() const { return space_.none; }

private:
    CampaignInput input_for(CampaignInput input, const SiteFile& candidate, std::uint64_t seed, std::int64_t repeats,
                            std::span<const Effect> more, bool passages) const;

    const SiteFile& site_;
    const ObservedSite& observed_;
    const FreeKeys& keys_;
    std::int64_t blocks_;
    CampaignInput input_;
    SpaceModel space_;
};

/// The same test measured in a way that has these faults, too.
ObservedSite with_faults(const ObservedSite& observed, std::span<const Effect> effects);

/// "stopping_points.csv (measured), sha256 ...", a line per file.
std::vector<std::string> input_lines(const SiteModel& model, const ObservedSite& observed);

}  // namespace scree::cli
