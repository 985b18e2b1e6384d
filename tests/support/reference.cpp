// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace scree::test {

std::vector<std::vector<double>> read_csv(const std::filesystem::path& path) {
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

ReferenceCase::ReferenceCase(const std::filesystem::path& folder, const std::string& name)
    : folder_(folder), name_(name) {
    std::ifstream in(folder / (name + ".json"));
    std::stringstream all;
    all << in.rdbuf();
    json_ = all.str();
}

std::vector<double> ReferenceCase::numbers(const std::string& key) const {
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

std::vector<ReferenceRow> ReferenceCase::path() const {
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

std::vector<ReferenceContact> ReferenceCase::contacts() const {
    std::vector<ReferenceContact> rows;
    for (const auto& r : read_csv(folder_ / (name_ + "_contacts.csv")))
        rows.push_back({r.at(0), r.at(2), std::hypot(r.at(3), r.at(4)), std::hypot(r.at(5), r.at(6))});
    return rows;
}

}  // namespace scree::test
