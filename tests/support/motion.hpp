// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/trajectory.hpp"

#include <algorithm>
#include <vector>

namespace scree::test {

/// Keeps the motion and answers where the block was.
template <int Dim>
class MotionRecorder final : public MotionSink<Dim> {
public:
    using Vec = typename Space<Dim>::Vec;

    void segment(const MotionSegment<Dim>& motion) override { segments_.push_back(motion); }
    const std::vector<MotionSegment<Dim>>& segments() const { return segments_; }

    /// The segment during which the time lies; the last one after the end.
    const MotionSegment<Dim>& at(double time) const {
        const auto next = std::upper_bound(segments_.begin(), segments_.end(), time,
                                           [](double t, const MotionSegment<Dim>& s) { return t < s.start; });
        return next == segments_.begin() ? segments_.front() : *(next - 1);
    }
    Vec position(double time) const {
        const MotionSegment<Dim>& s = at(time);
        const double t = std::clamp(time - s.start, 0.0, s.duration);
        return s.position + t * s.velocity_start + 0.5 * t * t / s.duration * (s.velocity_end - s.velocity_start);
    }
    Vec velocity(double time) const {
        const MotionSegment<Dim>& s = at(time);
        const double t = std::clamp(time - s.start, 0.0, s.duration);
        return s.velocity_start + t / s.duration * (s.velocity_end - s.velocity_start);
    }
    static Vec end_position(const MotionSegment<Dim>& s) {
        return s.position + 0.5 * s.duration * (s.velocity_start + s.velocity_end);
    }

private:
    std::vector<MotionSegment<Dim>> segments_;
};

/// A hull on a terrain in one place, to be run with varying settings.
struct HullMechanics {
    const ConvexBlock& block;
    const Surface& surface;
    std::vector<Soil> soils;
    DynamicsSettings settings;

    TrajectoryEnd<3> until(double time, const BlockState<3>& release, MotionSink<3>* sink = nullptr) const {
        DynamicsSettings limited = settings;
        limited.time_limit = time;
        return simulate_block(block, release, surface, soils, limited, sink);
    }
};

/// States every `interval` seconds, in moreau_jean mode: that scheme has no memory, so that a run may stop and go on.
template <class AnyMechanics>
std::vector<BlockState<3>> march(const AnyMechanics& mechanics, const BlockState<3>& release, double interval,
                                 std::size_t count) {
    std::vector<BlockState<3>> states{release};
    while (states.size() < count)
        states.push_back(mechanics.until(interval - 0.5 * mechanics.settings.time_step, states.back()).state);
    return states;
}

inline constexpr double kNeverRest = 1e9;  ///< rest time of runs that shall go on at rest [s]

/// Settings of the reference solutions: the paper's scheme, solved to rounding.
inline DynamicsSettings reference_settings() {
    DynamicsSettings s;
    s.mode = SteppingMode::MoreauJean;
    s.time_step = 1e-3;
    s.rest_time = kNeverRest;
    s.solver.tolerance = 1e-12;
    return s;
}

/// Event mode, or moreau_jean at its own step; solved tightly enough for comparisons with closed forms.
inline DynamicsSettings tight_settings(SteppingMode mode) {
    DynamicsSettings s;
    s.mode = mode;
    s.time_step = mode == SteppingMode::Event ? 8e-3 : 1e-3;
    s.solver.tolerance = 1e-10;
    return s;
}

}  // namespace scree::test
