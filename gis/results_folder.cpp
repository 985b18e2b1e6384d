// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/results_folder.hpp"

#include "gis/sha256.hpp"
#include "scree/base/error.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <vector>

namespace scree::gis {

namespace fs = std::filesystem;

namespace {

/// Absolute, without links or a slash at the end: the temporary folder must lie on the same disc as the final one.
fs::path resolved(const fs::path& folder) {
    fs::path path = fs::weakly_canonical(fs::absolute(folder));
    return path.has_filename() ? path : path.parent_path();
}

/// Files and links below the folder, relative to it, sorted.
std::vector<fs::path> files_below(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_directory() || entry.is_symlink()) files.push_back(entry.path().lexically_relative(folder));
    }
    std::ranges::sort(files);
    return files;
}

/// Hands a file or a folder to the disc, so that a power cut after the swap finds it whole.
void flush(const fs::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool flushed = file >= 0 && (::fsync(file) == 0 || errno == EINVAL);  // EINVAL: a file system that cannot
    const int reason = errno;
    if (file >= 0) ::close(file);
    if (!flushed) throw ComputeError(path.string() + ": could not be flushed to disc: " + std::strerror(reason));
}

void write_checksums(const fs::path& folder) {
    std::string lines;
    for (const fs::path& file : files_below(folder)) {
        lines += sha256_of_file(folder / file) + "  " + file.generic_string() + "\n";
    }
    std::ofstream out(folder / kChecksumFile, std::ios::binary);
    out << lines;
    if (!out.flush())
        throw ComputeError((folder / kChecksumFile).string() + ": could not be stored; check that the disc has room");
}

/// What an earlier result listed as its own, with the hashes.
std::map<fs::path, std::string> listed_files(const fs::path& folder) {
    constexpr std::size_t kHash = 64, kHashAndBlanks = 66;
    std::map<fs::path, std::string> files = {{kChecksumFile, ""}};
    std::ifstream in(folder / kChecksumFile);
    for (std::string line; std::getline(in, line);) {
        if (line.size() > kHashAndBlanks) files[line.substr(kHashAndBlanks)] = line.substr(0, kHash);
    }
    return files;
}

/// A list of hashes may be anybody's: ours has what every command writes.
bool is_result(const fs::path& folder) {
    return fs::exists(folder / kChecksumFile) && listed_files(folder).contains(kGeoPackageFile);
}

/// What people edit: a project saved in QGIS, a site file. (A GeoPackage changes when it is merely looked at.)
bool is_edited(const fs::path& folder, const fs::path& file, const std::string& hash) {
    const fs::path kind = file.extension();
    return (kind == ".qgs" || kind == ".toml") && sha256_of_file(folder / file) != hash;
}

/// Ours and as we left it, or what a GIS puts beside a file of ours when it opens it.
bool belongs_to_result(const fs::path& folder, const fs::path& file, const std::map<fs::path, std::string>& listed) {
    if (const auto own = listed.find(file); own != listed.end()) return !is_edited(folder, file, own->second);
    const std::string name = file.generic_string();
    static constexpr std::array<std::string_view, 7> kCompanions = {"-wal", "-shm", "-journal", ".aux.xml",
                                                                    ".ovr", ".msk", "~"};
    return std::ranges::any_of(kCompanions, [&](std::string_view suffix) {
        return name.ends_with(suffix) && listed.contains(name.substr(0, name.size() - suffix.size()));
    });
}

/// Moves what is not ours, or was edited, from the folder of an earlier result to the new one. Where both have the name, the old file gets the
/// suffix .previous: nothing of the user's is ever deleted.
void keep_other_files(const fs::path& before, const fs::path& now) {
    const std::map<fs::path, std::string> listed = listed_files(before);
    for (const fs::path& file : files_below(before)) {
        if (belongs_to_result(before, file, listed)) continue;
        fs::path target = now / file;
        while (fs::exists(fs::symlink_status(target))) target += ".previous";
        fs::create_directories(target.parent_path());
        fs::rename(before / file, target);
    }
}

/// Puts one folder in the place of another. True if the other one now has the first one's name.
bool swap_folders(const fs::path& staging, const fs::path& target) {
    if (!fs::exists(target)) {
        fs::rename(staging, target);
        return false;
    }
    if (::renameat2(AT_FDCWD, staging.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return true;
    // a file system that cannot exchange names: two steps, between which the folder is missing but nothing is lost
    const fs::path aside = staging.string() + ".previous";
    fs::rename(target, aside);
    fs::rename(staging, target);
    fs::rename(aside, staging);
    return true;
}

bool is_mount_point(const fs::path& path) {
    struct stat own = {}, around = {};
    return ::stat(path.c_str(), &own) == 0 && ::stat(path.parent_path().c_str(), &around) == 0 &&
           own.st_dev != around.st_dev;
}

void check_folder(const fs::path& folder, bool overwrite) {
    const fs::path path = resolved(folder);
    const std::string name = folder.string();
    if (fs::exists(path) && !fs::is_directory(path)) {
        throw InputError(name + ": is a file, but results go into a folder; choose another --output");
    }
    if (fs::is_symlink(fs::symlink_status(path)))
        throw InputError(name + ": is a link that leads nowhere; make the folder, or choose another --output");
    if (is_mount_point(path))
        throw InputError(name +
                         ": is where a disc is mounted, and results replace the folder that they go into; choose "
                         "a folder in it with --output");
    if (fs::exists(path) && !fs::is_empty(path)) {
        if (!is_result(path)) {
            throw InputError(name + ": holds files but no earlier result (there is no " + kChecksumFile +
                             " in it that lists " + kGeoPackageFile + "), and is left alone; choose another --output");
        }
        if (!overwrite) {
            throw InputError(name + ": holds a result already; choose another --output or replace it with --overwrite");
        }
    }
    // the new folder is made beside the final one: try it, permission bits do not tell all
    fs::path parent = path.parent_path();
    while (!fs::exists(parent) && parent.has_relative_path()) parent = parent.parent_path();
    const fs::path probe = parent / (path.filename().string() + ".partial-" + std::to_string(::getpid()) + "-0");
    std::error_code refused;
    if (!fs::create_directory(probe, refused)) {
        throw InputError(name + ": results cannot be written, because nothing can be created in " + parent.string() +
                         " (" + refused.message() + "); choose another --output");
    }
    fs::remove(probe);
}

}  // namespace

void require_free_results_folder(const fs::path& folder, bool overwrite) {
    try {
        check_folder(folder, overwrite);
    } catch (const fs::filesystem_error& error) {  // a folder on the way that may not be read, a link in a circle
        throw InputError(folder.string() + ": results cannot be written there (" + error.code().message() +
                         "); choose another --output");
    }
}

fs::path named_folder(const fs::path& folder) {
    const fs::path last = folder.filename();
    if (last == "." || last == "..") return resolved(folder);
    return folder.has_filename() ? folder : folder.parent_path();
}

void require_input_elsewhere(const fs::path& folder, const fs::path& input) {
    std::error_code ignored;
    const fs::path inside = fs::weakly_canonical(fs::absolute(input), ignored).lexically_relative(resolved(folder));
    if (!inside.empty() && inside.begin()->string() != "..")
        throw InputError(input.string() + ": is an input, and lies in " + folder.string() +
                         ", which the results would replace; choose another --output");
}

void require_inputs_elsewhere(const fs::path& folder, const std::vector<InputFile>& inputs) {
    for (const InputFile& input : inputs) require_input_elsewhere(folder, input.path);
}

ResultsFolder::ResultsFolder(const fs::path& folder, bool overwrite) : final_(resolved(folder)), overwrite_(overwrite) {
    require_free_results_folder(folder, overwrite);
    fs::create_directories(final_.parent_path());
    const std::string name = final_.string() + ".partial-" + std::to_string(::getpid());
    staging_ = name;  // one that is there may hold what a killed process had not yet handed back to its owner
    for (int k = 2; !fs::create_directory(staging_); ++k) staging_ = name + "-" + std::to_string(k);
}

ResultsFolder::~ResultsFolder() {
    std::error_code ignored;
    if (!committed_) fs::remove_all(staging_, ignored);
}

void ResultsFolder::commit() {
    write_checksums(staging_);
    for (const fs::path& file : files_below(staging_)) flush(staging_ / file);
    flush(staging_);
    committed_ = true;  // from here on it is somebody's
    const auto refuse_foreign = [&] {
        throw InputError(final_.string() + ": another program has written there meanwhile; this result is kept in " +
                         staging_.string() + ": rename that folder, or remove it");
    };
    if (!overwrite_ && fs::exists(final_) && !fs::is_empty(final_)) refuse_foreign();
    bool replaced = false;
    try {
        replaced = swap_folders(staging_, final_);
    } catch (const fs::filesystem_error& error) {
        if (error.code() == std::errc::directory_not_empty || error.code() == std::errc::file_exists) refuse_foreign();
        throw;
    }
    flush(final_.parent_path());
    if (!replaced) return;
    try {
        keep_other_files(staging_, final_);
        fs::remove_all(staging_);
    } catch (const fs::filesystem_error& error) {
        throw ComputeError(final_.string() +
                           ": the results are there, but what the folder held before could not be cleared away (" +
                           error.what() + "): take from " + staging_.string() + " what is yours, and remove it");
    }
}

}  // namespace scree::gis
