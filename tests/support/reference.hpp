// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/state.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace scree::test {

/// Numbers of a comma-separated file with one line of column names.
inline std::vector<std::vector<double>> read_csv(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::string line;
    std::getline(in, line);
    std::vector<std::vector<double>> rows;
    while (std::getline(in, line)) {
        std::vector<double> row;
        std::istringstream fields(line);
        for (std::string field; std::getline(fields, field, ',');) row.push_back(std::strtod(field.c_str(), nullptr));
        if (!row.empty()) rows.push_back(std::move(row));
    }
    if (rows.empty()) throw std::runtime_error(path.string() + ": no rows");
    return rows;
}

/// One row of CASE.csv: the state at a time.
struct ReferenceRow {
    double time = 0.0;  ///< [s]
    BlockState<3> state;
};

/// One row of CASE_contacts.csv: the impulse of one contact over the step that ends at `time`.
struct ReferenceContact {
    double time = 0.0;         ///< [s]
    double normal = 0.0;       ///< r_N [N s]
    double tangential = 0.0;   ///< |r_T| [N s]
    double rolling = 0.0;      ///< |m_R| [N m s]
};

/// A reference solution: CASE.json, CASE.csv and CASE_contacts.csv of the folder described in its README.
class ReferenceCase {
public:
    ReferenceCase(const std::filesystem::path& folder, const std::string& name) : folder_(folder), name_(name) {
        std::ifstream in(folder / (name + ".json"));
        std::stringstream all;
        all << in.rdbuf();
        json_ = all.str();
    }

    /// A number at the top level of the JSON file.
    double number(const std::string& key) const { return numbers(key).front(); }

    /// An array of numbers, or a single one.
    std::vector<double> numbers(const std::string& key) const {
        const auto at = json_.find("\"" + key + "\":");
        if (at == std::string::npos) throw std::runtime_error(name_ + ": no " + key);
        const char* c = json_.c_str() + at + key.size() + 3;
        std::vector<double> values;
        for (bool array = false;;) {
            for (; *c == ' ' || *c == '\n' || *c == ',' || *c == '['; ++c) array = array || *c == '[';
            char* end = nullptr;
            const double value = std::strtod(c, &end);
            if (end == c) break;
            values.push_back(value);
            c = end;
            if (!array) break;
        }
        if (values.empty()) throw std::runtime_error(name_ + ": " + key + " is not a number");
        return values;
    }

    std::vector<ReferenceRow> path() const {
        std::vector<ReferenceRow> rows;
        for (const auto& r : read_csv(folder_ / (name_ + ".csv"))) {
            ReferenceRow row;
            row.time = r.at(0);
            row.state.position = {r.at(1), r.at(2), r.at(3)};
            row.state.orientation = Quat(r.at(4), r.at(5), r.at(6), r.at(7));
            row.state.velocity = {r.at(8), r.at(9), r.at(10)};
            row.state.spin = {r.at(11), r.at(12), r.at(13)};
            rows.push_back(row);
        }
        return rows;
    }

    std::vector<ReferenceContact> contacts() const {
        std::vector<ReferenceContact> rows;
        for (const auto& r : read_csv(folder_ / (name_ + "_contacts.csv")))
            rows.push_back({r.at(0), r.at(2), std::hypot(r.at(3), r.at(4)), std::hypot(r.at(5), r.at(6))});
        return rows;
    }

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
    return out << "position " << d.position << " m, angle " << d.angle << ", velocity " << d.velocity << " m/s, spin " << d.spin << " rad/s";
}

}  // namespace scree::test
