// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/file_lock.hpp"
#include "scree/inference/observation.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace scree::cli {

/// The simulations of a diagnosis on disc, one file each, so that a stopped one can go on. A simulation is known by the words that describe it; whatever
/// the folder holds of another study is not found.
class SimulationStore {
public:
    /// `subject`: all that the simulations depend on beside those words. Nothing is read before it is asked for; the folder appears with the first file.
    /// Throws InputError if another diagnosis writes there, then or, where it began at the same time, with the first file.
    SimulationStore(std::filesystem::path folder, std::string subject);

    std::optional<ObservationTable> find(const std::string& words) const;
    void keep(const std::string& words, const ObservationTable& table);
    /// A file for other use, in the same folder, which is there then.
    std::filesystem::path file(const std::string& name);
    const std::filesystem::path& folder() const { return folder_; }
    const std::string& subject() const { return subject_; }
    /// All that it has kept, and the folder, if nothing else is in it.
    void remove();

private:
    std::filesystem::path file_of(const std::string& words) const;
    /// Makes the folder, and holds it against other diagnoses.
    void make_folder();

    std::filesystem::path folder_;
    std::string subject_;
    FileLock lock_;
};

}  // namespace scree::cli
