// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/state.hpp"

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace scree::test {

/// Numbers of a comma-separated file with one line of column names.
std::vector<std::vector<double>> read_csv(const std::filesystem::path& path);

/// One row of CASE.csv: the state at a time.
struct ReferenceRow {
    double time = 0.0;  ///< [s]
    BlockState<3> state;
};

/// One row of CASE_contacts.csv: the impulse of one contact over the step that ends at `time`.
struct ReferenceContact {
    double time = 0.0;        ///< [s]
    double normal = 0.0;      ///< r_N [N s]
    double tangential = 0.0;  ///< |r_T| [N s]
    double rolling = 0.0;     ///< |m_R| [N m s]
};

/// A reference solution: CASE.json, CASE.csv and CASE_contacts.csv of the folder described in its README.
class ReferenceCase {
public:
    ReferenceCase(const std::filesystem::path& folder, const std::string& name);

    /// A number at the top level of the JSON file.
    double number(const std::string& key) const { return numbers(key).front(); }
    /// An array of numbers, or a single one.
    std::vector<double> numbers(const std::string& key) const;
    std::vector<ReferenceRow> path() const;
    std::vector<ReferenceContact> contacts() const;

private:
    std::filesystem::path folder_;
    std::string name_;
    std::string json_;
};

/// Largest differences between two states, each in its own unit.
struct StateDeviation {
    double position = 0.0;  ///< [m]
    double angle = 0.0;     ///< of the rotation between the two orientations [rad]
    double velocity = 0.0;  ///< [m/s]
    double spin = 0.0;      ///< [rad/s]

    void add(const BlockState<3>& a, const BlockState<3>& b) {
        position = std::max(position, (a.position - b.position).norm());
        angle = std::max(angle, 2.0 * (a.orientation.conjugate() * b.orientation).vec().norm());
        velocity = std::max(velocity, (a.velocity - b.velocity).norm());
        spin = std::max(spin, (a.spin - b.spin).norm());
    }
    double largest() const { return std::max({position, angle, velocity, spin}); }
};

inline std::ostream& operator<<(std::ostream& out, const StateDeviation& d) {
    return out << "position " << d.position << " m, angle " << d.angle << ", velocity " << d.velocity << " m/s, spin "
               << d.spin << " rad/s";
}

}  // namespace scree::test
