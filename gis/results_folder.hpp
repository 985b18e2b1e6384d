// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/dataset.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace scree::gis {

/// The list of a result's files with their SHA-256, as `sha256sum --check` reads it. It marks a folder as a result of ours.
inline constexpr const char* kChecksumFile = "SHA256SUMS";
/// All layers of a result; every result has it.
inline constexpr const char* kGeoPackageFile = "results.gpkg";

/// The folder by a path that ends with its name, so that what lies beside it can be named after it: not with a slash, `.` or `..`.
std::filesystem::path named_folder(const std::filesystem::path& folder);

/// Throws InputError if results cannot go to the folder: it is a file, it holds things but no result, it holds a result and
/// `overwrite` is false, or nothing can be written there. Call it before hours of computing.
void require_free_results_folder(const std::filesystem::path& folder, bool overwrite);

/// Throws InputError if the file lies in the folder, which results would replace.
void require_input_elsewhere(const std::filesystem::path& folder, const std::filesystem::path& input);
/// The same of several.
void require_inputs_elsewhere(const std::filesystem::path& folder, const std::vector<InputFile>& inputs);

/// A folder of results that appears whole or not at all. Files are written under a temporary name beside the final one; commit()
/// lists their hashes, flushes them to disc and swaps the folders in one step. Without commit() nothing of it remains.
class ResultsFolder {
public:
    /// As require_free_results_folder().
    ResultsFolder(const std::filesystem::path& folder, bool overwrite);
    ~ResultsFolder();
    ResultsFolder(const ResultsFolder&) = delete;
    ResultsFolder& operator=(const ResultsFolder&) = delete;

    /// Where to write.
    const std::filesystem::path& path() const { return staging_; }
    /// Of a result that was there before, the files that it listed are removed; whatever else lay in the folder is kept. Without `overwrite`, throws InputError
    /// where another program has written a result meanwhile; this one then stays where it was written.
    void commit();

private:
    std::filesystem::path final_;
    std::filesystem::path staging_;
    bool overwrite_ = false;
    bool committed_ = false;
};

}  // namespace scree::gis
