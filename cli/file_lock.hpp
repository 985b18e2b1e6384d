// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace scree::cli {

/// A file or folder held against other programs as long as this lives, or the program; where it is absent, or its file system knows no locks, nothing is.
class FileLock {
public:
    FileLock() = default;
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;
    /// Lets go of what was held before. Throws InputError if another program, `who` ("another calibration"), holds it.
    void hold(const std::filesystem::path& path, const std::string& who);
    bool holds() const { return descriptor_ >= 0; }
    void release();

private:
    int descriptor_ = -1;
};

}  // namespace scree::cli
