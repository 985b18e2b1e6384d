// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/file_lock.hpp"
#include "scree/inference/calibration.hpp"

#include <filesystem>
#include <fstream>
#include <string>

namespace scree::cli {

/// The simulations of a calibration on disc: a line of JSON that says what is calibrated, then one per simulation, each written as soon as it is done. Numbers
/// read back exactly.
class JournalFile {
public:
    /// Continues a file (`resume`) or begins one; an existing one is replaced at once, or stays as it is. Throws InputError if a file to be continued is
    /// missing or about something else, or another program is writing it, ComputeError if it cannot be written.
    JournalFile(std::filesystem::path file, const std::string& subject, bool resume);
    /// Whether a file is what a calibration left, and not somebody else's of that name.
    static bool is_one(const std::filesystem::path& file);

    /// What the file held when it was opened.
    CalibrationJournal journal;
    /// Writes simulations that were added to `all` since.
    void write(const CalibrationJournal& all);
    const std::filesystem::path& file() const { return file_; }
    /// The whole file.
    std::string text() const;
    void remove();

private:
    void read(const std::string& subject);
    void check() const;

    std::filesystem::path file_;
    std::ofstream out_;
    std::size_t written_ = 0;
    FileLock lock_;
};

}  // namespace scree::cli
