// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/file_lock.hpp"

#include "scree/base/error.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

namespace scree::cli {

FileLock::~FileLock() {
    release();
}

void FileLock::release() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
}

void FileLock::hold(const std::filesystem::path& path, const std::string& who) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0 && ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(descriptor);
        throw InputError(path.string() + " is being written by " + who + ": wait for it, or choose another --output");
    }
    release();
    descriptor_ = descriptor;
}

}  // namespace scree::cli
