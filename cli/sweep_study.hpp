// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/compare_study.hpp"

#include <string>
#include <vector>

namespace scree::cli {

/// A sweep: what keys do to what the field test measured, one key at a time from the site as it is, each value simulated as several sets of blocks. All values
/// are compared as pools: the blocks of a set are those of the test, but which is which does not matter.

/// Something that one number per set says.
struct SweepMeasure {
    std::string name;        ///< "speed at ES1-A, mean", "at rest in 3A"
    std::string unit;        ///< that people read, "%" for shares
    double measured = kNaN;  ///< in the field test
};

/// A distribution over sets.
struct SetSpread {
    double mean = kNaN;
    double deviation = kNaN;
    double low = kNaN, high = kNaN;  ///< 95 % of the sets lie between
};
SetSpread spread_over_sets(std::vector<double> values);

struct SweepValue {
    std::string key, value;   ///< empty for the site as it is
    std::int64_t blocks = 0;  ///< of a set [-]
    SetSpread influence;      ///< overall gap of a set to the site as it is, 1 on average if the key does nothing [-]
    double told_apart =
        kNaN;  ///< share of the sets farther from the site as it is than 95 % of its own sets of as many blocks are [-]
    double gap = kNaN;                ///< overall gap to the measurements, of all sets together [-]
    std::vector<SetSpread> measures;  ///< in the unit of the measure
};

struct SweepStudy {
    std::string title;
    std::int64_t seed = 0, sets = 0;
    std::vector<std::string> observables;  ///< that the overall gap is the mean of
    std::vector<SweepMeasure> measures;
    SweepValue base;
    std::vector<SweepValue> values;  ///< key after key, in the order given
};

/// A key with the values that it takes.
struct SweptKey {
    std::string key;
    std::vector<std::string> values;
};
/// Splits `--set` changes into keys with several values, "KEY=a,b,c", and the rest. Throws InputError if none has several.
std::vector<SweptKey> swept_keys(const std::vector<std::string>& changes, std::vector<std::string>& fixed);

}  // namespace scree::cli
