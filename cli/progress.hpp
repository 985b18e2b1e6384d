// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/commands.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <string>

namespace scree::cli {

/// Progress on the error stream: a line that is redrawn on a terminal, plain lines now and then elsewhere, JSON lines when asked.
class Progress {
public:
    Progress(const Context& context, std::string what, std::int64_t total);
    void update(std::int64_t done);
    /// The last state, always shown, and the end of the line.
    void finish(std::int64_t done);

private:
    void show(std::int64_t done, bool last);

    std::ostream& err_;
    std::string what_;
    std::int64_t total_;
    bool quiet_, json_, terminal_;
    std::chrono::steady_clock::time_point start_, shown_;
};

/// While it lives, Ctrl-C (SIGINT) and SIGTERM set flag() instead of ending the program; a second one ends it.
class InterruptScope {
public:
    InterruptScope();
    ~InterruptScope();
    InterruptScope(const InterruptScope&) = delete;
    InterruptScope& operator=(const InterruptScope&) = delete;
    static const std::atomic<bool>& flag();
};

}  // namespace scree::cli
