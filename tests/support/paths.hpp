// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace scree::test {

/// The real sites, reference solutions and awkward files that are not part of the project: SCREE_SHARED_DATA, or the folder
/// `shared` beside the checkout. Empty where there is none: the test then skips.
inline std::filesystem::path shared_data(const std::string& relative) {
    namespace fs = std::filesystem;
    const char* given = std::getenv("SCREE_SHARED_DATA");
    const fs::path root = given ? fs::path(given) : fs::path(SCREE_SOURCE_DIR).parent_path() / "shared";
    const fs::path path = root / relative;
    return fs::exists(path) ? path : fs::path{};
}

/// A fresh folder for one test, removed at the end.
class TempDir {
public:
    TempDir() {
        std::string pattern = (std::filesystem::temp_directory_path() / "scree_test_XXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
    }
    ~TempDir() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TempDir(const TempDir&) = delete;
    TempDir& operator=(const TempDir&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

}  // namespace scree::test

/// Skips the test where the shared data are absent.
#define SCREE_SHARED_OR_SKIP(variable, relative)                                 \
    const std::filesystem::path variable = ::scree::test::shared_data(relative); \
    if (variable.empty()) GTEST_SKIP() << "shared data not found: " << relative
