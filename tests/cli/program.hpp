// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/app.hpp"

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>
#include <vector>

namespace scree::test {

/// What a command line came to.
struct Outcome {
    int code = -1;  ///< exit code [-]
    std::string out;
    std::string err;
};

/// Runs the program in process.
inline Outcome scree_program(const std::vector<std::string>& args) {
    std::ostringstream out, err;
    Outcome outcome;
    outcome.code = cli::run(args, out, err);
    outcome.out = out.str();
    outcome.err = err.str();
    return outcome;
}

inline std::string text_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline void put(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

inline std::filesystem::path quarry_a() {
    return std::filesystem::path(SCREE_SOURCE_DIR) / "sample_sites" / "quarry_a";
}

/// quarry_a beside its data, with more at its end.
inline std::string quarry_with(const std::filesystem::path& folder, const std::string& more) {
    std::filesystem::create_directory_symlink(quarry_a() / "data", folder / "data");
    put(folder / "site.toml", text_of(quarry_a() / "site.toml") + more);
    return (folder / "site.toml").string();
}

/// Two release polygons of 2 m on the upper slope of quarry_a, 16 m apart.
inline void put_two_releases(const std::filesystem::path& file) {
    const auto square = [](int west, int south) {
        const auto corner = [](int x, int y) { return "[" + std::to_string(x) + "," + std::to_string(y) + "]"; };
        return R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[)" +
               corner(west, south) + "," + corner(west + 2, south) + "," + corner(west + 2, south + 2) + "," +
               corner(west, south + 2) + "," + corner(west, south) + "]]}}";
    };
    put(file, R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::2154"}},)"
              R"("features":[)" +
                  square(890020, 6670036) + "," + square(890020, 6670052) + "]}");
}

/// `scree run` of quarry_a with 20 blocks into a folder, with more options.
inline Outcome run_quarry_a(const std::filesystem::path& output, const std::vector<std::string>& more = {}) {
    std::vector<std::string> args{
        "run", (quarry_a() / "site.toml").string(), "--set", "release.count=20", "--output", output.string()};
    args.insert(args.end(), more.begin(), more.end());
    return scree_program(args);
}

}  // namespace scree::test
