// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <ctime>

namespace scree::bench {

/// Time of one of the system's clocks [s].
inline double seconds_of(clockid_t clock) {
    std::timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// How many additions of doubles, each waiting for the one before, this core delivers per second [1/s]. Such a chain is bound by latency alone (4 cycles an
/// addition on most x86 of the last ten years, 2 or 3 on the newest), not by memory, caches or wide instructions: it follows the clock that the core runs at,
/// which shared and hot machines change from minute to minute. A speed divided by this number can be compared between runs on one kind of core.
inline double dependent_additions_per_second(std::int64_t additions = 200'000) {
    const volatile double source = 1.0;  // unknown to the compiler: without -ffast-math it may neither fold nor reorder
    volatile double sink = 0.0;
    double best = 0.0;
    for (int trial = 0; trial < 3; ++trial) {  // the best one: caches warm, no interrupt
        const double one = source;
        double sum = source;
        const double start = seconds_of(CLOCK_THREAD_CPUTIME_ID);
        for (std::int64_t i = 0; i < additions; ++i) sum += one;
        sink = sum;
        best = std::max(best, static_cast<double>(additions) / (seconds_of(CLOCK_THREAD_CPUTIME_ID) - start));
    }
    static_cast<void>(sink);
    return best;
}

/// Adds up time and, from samples of the clock before and after every piece of work, how many dependent additions would have taken as long.
class WorkMeter {
public:
    enum class Time {
        Cpu,
        Real
    };  ///< of this thread, or of the wall, which is what counts for work on several threads
    explicit WorkMeter(Time time = Time::Cpu) : clock_(time == Time::Cpu ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC) {}

    template <class Work>
    void measure(const Work& work) {
        const double before = last_ > 0.0 ? last_ : dependent_additions_per_second();
        const double start = seconds_of(clock_);
        work();
        const double taken = seconds_of(clock_) - start;
        last_ = dependent_additions_per_second();
        seconds_ += taken;
        additions_ += taken * 0.5 * (before + last_);
    }
    double seconds() const { return seconds_; }
    double additions() const { return additions_; }

private:
    clockid_t clock_;
    double seconds_ = 0.0;    ///< [s]
    double additions_ = 0.0;  ///< the same in dependent additions [-]
    double last_ = 0.0;       ///< the latest sample [1/s]
};

}  // namespace scree::bench
