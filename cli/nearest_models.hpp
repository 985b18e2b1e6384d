// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/inference/calibration.hpp"
#include "scree/inference/gap_function.hpp"

#include <utility>
#include <vector>

namespace scree::cli {

/// Of the models without effects that a diagnosis simulates on its way, those that leave least over all. Each was seen in few simulations: who is to be
/// believed is simulated again. In a model of which no block passes a screen speeds there do not count: it is not nearer for that.
class NearestModels {
public:
    explicit NearestModels(GapFunction gaps) : gaps_(std::move(gaps)) {}

    /// `table` is what the test would have measured at `point`. Of a point that is seen again what more blocks say counts.
    void look_at(const CalibrationPoint& point, const ObservationTable& table);
    /// At most kKept, the nearest first.
    std::vector<CalibrationPoint> points() const;

    static constexpr std::size_t kKept = 4;

private:
    struct Seen {
        std::ptrdiff_t observables = 0;  ///< that count in the overall gap [-]
        double excess = 0.0;
        std::size_t rows = 0;  ///< simulated [-]
        CalibrationPoint point;
        bool nearer_than(const Seen& other) const {
            return observables != other.observables ? observables > other.observables : excess < other.excess;
        }
    };
    GapFunction gaps_;
    std::vector<ObservableGap> yardstick_;  ///< the first model seen: the floors that distances are measured by
    std::vector<Seen> seen_;                ///< the nearest first
};

}  // namespace scree::cli
