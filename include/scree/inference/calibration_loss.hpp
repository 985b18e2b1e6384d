// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/calibration.hpp"
#include "scree/inference/gap_function.hpp"

namespace scree {

/// Of fewer measured blocks the score of a path is luck [-].
inline constexpr std::size_t kLeastOnPath = 5;

/// What each measured block loses in a simulation, for calibrate(): the energy score (distance.hpp) of what was measured on it against the simulated values
/// that could have been its own, summed over the observables that count in the overall gap. A strictly proper score: least in expectation for the
/// distribution that the block was drawn from. A known block is held against its own repeats, others against the pool; shares that are known as counts
/// are as many records of 0 and 1.
///
/// Each observable is divided by half the mean difference of its measured values (for shares p (1-p) with half a block added on either side), so that it
/// counts as much as any other whatever its unit, and by the number of observables. This yardstick is taken from the test alone: no model can move it. The
/// mean loss of pooled observables is then, up to a constant that no parameter changes, their mean energy distance.
///
/// For decisions also the logarithmic score, -ln of the likelihood (Good 1952): shares are (k + 1/2) / (n + 1) where k of n repeats have it, numbers have
/// Student's distribution. At a screen who passed counts once, and numbers are of those that passed.
class CalibrationLoss {
public:
    explicit CalibrationLoss(GapFunction function);

    /// Rows of the measured table, then one per block of each count [-].
    std::size_t records() const { return records_; }
    /// Where they were measured: the stops, a screen, the films of impacts.
    const std::vector<std::string>& places() const { return places_; }
    /// Records of the known blocks of each path; paths of fewer than kLeastOnPath are left away.
    std::vector<CalibrationPath> paths() const;
    /// Tells a problem its records, places and paths.
    void describe(CalibrationProblem& problem) const;
    /// Names of the observables that are minimised.
    std::vector<std::string> observables() const;
    /// Empty where a measured block has fewer than kLeastRepeats simulated values: losses over different blocks cannot be compared. `seed` draws the errors of
    /// the measurements.
    SimulatedLoss operator()(const CampaignResult& campaign, std::uint64_t seed) const;

private:
    struct Values {
        std::vector<std::size_t> records = {};         ///< with a value [-]
        std::vector<std::vector<double>> points = {};  ///< their values [unit of the observable]
    };
    struct Part {
        Observable observable;
        std::size_t place = 0;  ///< index into the places [-]
        double weight = 0.0;    ///< of its scores in the loss of a record [1 / unit of the values]
        Values measured;
    };
    /// What counts in the logarithmic score: the likelihood of each record under what was simulated of its block, or of all.
    struct Likelihood {
        Observable observable;
        bool of_block = false;
        Values measured;
        std::vector<double> least_spread;  ///< that simulations are believed to have, per column [unit of the values]
        std::vector<double> far;  ///< root of the mean square of what was measured, per column [unit of the values]
    };
    /// Of known blocks alone, or of every record.
    Values measured_of(const Observable& observable, bool of_block) const;
    /// Fill what was measured of a part, and return its yardstick.
    double add_rows(Part& part) const;
    double add_counts(Part& part);
    void find_likelihoods();
    bool add_scores(const Part& part, const ObservationTable& simulated, SimulatedLoss& loss) const;
    void add_log_scores(const Likelihood& likelihood, const ObservationTable& simulated,
                        std::vector<double>& log_loss) const;

    GapFunction function_;
    std::vector<Part> parts_;
    std::vector<Likelihood> likelihoods_;
    std::size_t records_ = 0;
    std::vector<std::string> places_;
};

}  // namespace scree
