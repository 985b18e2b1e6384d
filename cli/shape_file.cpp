// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/site_model.hpp"
#include "gis/utf8.hpp"
#include "scree/base/error.hpp"

#include <array>
#include <cstring>
#include <fstream>
#include <sstream>

namespace scree::cli {

namespace {

constexpr std::size_t kMostPoints = 10'000'000;

/// Binary STL: 80 bytes of header, the number of triangles, 50 bytes each.
bool is_binary_stl(const std::string& text) {
    if (text.size() < 84) return false;
    std::uint32_t triangles = 0;
    std::memcpy(&triangles, text.data() + 80, 4);
    return text.size() == 84 + 50 * static_cast<std::size_t>(triangles);
}

std::vector<Vec3> read_binary_stl(const std::string& text) {
    std::vector<Vec3> points;
    for (std::size_t at = 84; at + 50 <= text.size(); at += 50) {
        std::array<float, 12> values{};
        std::memcpy(values.data(), text.data() + at, 48);
        for (std::size_t k = 3; k < 12; k += 3)
            points.emplace_back(static_cast<double>(values[k]), static_cast<double>(values[k + 1]),
                                static_cast<double>(values[k + 2]));
    }
    return points;
}

/// OBJ ("v x y z"), text STL ("vertex x y z") or plain "x y z".
std::vector<Vec3> read_text_points(const std::string& text, const std::string& extension, const std::string& file) {
    const std::string keyword = extension == ".obj" ? "v" : extension == ".stl" ? "vertex" : "";
    std::vector<Vec3> points;
    std::istringstream in(text);
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        const bool decimal_comma = line.find_first_of(";\t") != std::string::npos;
        for (char& c : line)
            if (c == ',')
                c = decimal_comma ? '.' : ' ';
            else if (c == ';')
                c = ' ';
        std::istringstream words(line);
        std::string first;
        if (!keyword.empty()) {
            if (!(words >> first) || first != keyword) continue;
        } else if (line.find_first_not_of(" \t\r") == std::string::npos || line[line.find_first_not_of(" \t")] == '#') {
            continue;
        }
        Vec3 p;
        std::string more;
        if (!(words >> p.x() >> p.y() >> p.z()) || !p.allFinite() || (keyword.empty() && words >> more))
            throw InputError(file + ":" + std::to_string(number) + ": \"" + line +
                             "\" is no point: give three finite numbers x y z [m]");
        points.push_back(p);
        if (points.size() > kMostPoints)
            throw InputError(file + " has more than " + std::to_string(kMostPoints) +
                             " points: thin it out, the hull needs a few hundred");
    }
    return points;
}

}  // namespace

std::vector<Vec3> read_shape_points(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in || std::filesystem::is_directory(file))
        throw InputError("block shape " + file.string() + " cannot be read: check blocks.shape_file");
    std::ostringstream buffer;
    buffer << in.rdbuf();
    const std::string text = buffer.str();
    const std::string kind = gis::lower_case(file.extension().string());
    const std::vector<Vec3> points =
        kind == ".stl" && is_binary_stl(text) ? read_binary_stl(text) : read_text_points(text, kind, file.string());
    if (points.size() < 4)
        throw InputError(file.string() + " holds " + std::to_string(points.size()) +
                         " points; a block needs at least 4 (x y z per line, OBJ or STL)");
    try {
        convex_hull(points);  // refuses what spans no volume
    } catch (const InputError& e) {
        throw InputError(file.string() + ": " + e.what());
    }
    return points;
}

}  // namespace scree::cli
