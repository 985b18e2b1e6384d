// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/observed_site.hpp"
#include "scree/inference/gap_function.hpp"

#include <string>
#include <utility>
#include <vector>

namespace scree::cli {

/// A share of blocks with its 95 % interval (Wilson).
struct ShareEstimate {
    std::int64_t count = 0;  ///< [-]
    std::int64_t of = 0;     ///< [-]
    double share() const { return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : kNaN; }
    std::pair<double, double> interval() const { return wilson_interval(count, of); }
};

struct SharePair {
    std::string name;
    double chainage = kNaN;  ///< of what is passed [m]
    ShareEstimate measured, simulated;
};

/// Location and spread of a sample, in the unit that people read.
struct SampleSummary {
    double mean = kNaN;
    double deviation = kNaN;
    std::vector<double> quantiles;  ///< at kSummaryQuantiles
};
inline constexpr std::array<double, 7> kSummaryQuantiles{0.05, 0.10, 0.25, 0.50, 0.75, 0.90, 0.95};
/// NaN for none; no deviation of a single one.
SampleSummary summary_of(std::vector<double> values);

/// One observable with all that is shown of it.
struct ComparedObservable {
    ObservableGap gap;
    std::string unit;                         ///< that people read: kJ for J
    double factor = 1.0;                      ///< from the unit of the tables to that
    std::string slug;                         ///< name of its files
    std::vector<double> measured, simulated;  ///< of one dimension, in `unit`
    SampleSummary measured_summary, simulated_summary;
    ShareEstimate measured_share, simulated_share;  ///< of shares of one column
    DistributionBand band;                          ///< in `unit`
};

/// Everything that a comparison found; text, JSON and pictures are made from it and from nothing else.
struct CompareStudy {
    std::string title;
    std::int64_t seed = 0;
    std::int64_t repeats = 0;   ///< of matched blocks [-]
    std::size_t blocks = 0;     ///< measured [-]
    std::int64_t released = 0;  ///< simulated blocks [-]
    std::int64_t lost = 0;      ///< of these off the terrain or out of time [-]
    std::int64_t failed = 0;    ///< of these whose computation failed [-]
    std::vector<ComparedObservable> observables;
    Gap overall;
    std::optional<Gap> overall_score;
    std::vector<SharePair> zones;           ///< at rest in each deposit zone
    std::vector<SharePair> beyond_screens;  ///< stopped farther along than where a screen first crosses the axis
    std::vector<SharePair> beyond;          ///< stopped beyond round chainages
    std::vector<BlockPit> pits;
    ObservationTable measured, simulated;
};

/// Of simulated blocks whose end nobody knows: a sentence without its full stop, empty if there are none.
std::string lost_text(const CompareStudy& study);
/// More than one in a hundred, which may matter where it is not the first thing to look at.
bool many_lost(const CompareStudy& study);

CompareStudy make_study(const SiteFile& site, const SiteModel& model, const ObservedSite& observed,
                        const CampaignResult& campaign);

/// "speed at ES1-A" of a column.
std::string column_name(const ObservationOperator& op, const Column& column);

}  // namespace scree::cli
