// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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
    /// A file held against other programs as long as this lives, or the program; where it is absent, or its file system knows no locks, nothing is.
    class Lock {
    public:
        Lock() = default;
        ~Lock();
        Lock(const Lock&) = delete;
        Lock& operator=(const Lock&) = delete;
        /// Lets go of the one before. Throws InputError if another program holds the file.
        void hold(const std::filesystem::path& file);

    private:
        int descriptor_ = -1;
    };

    void read(const std::string& subject);
    void check() const;

    std::filesystem::path file_;
    std::ofstream out_;
    std::size_t written_ = 0;
    Lock lock_;
};

}  // namespace scree::cli
