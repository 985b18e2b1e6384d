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
    /// There is more or less to do than it seemed.
    void expect(std::int64_t total) { total_ = total; }
    /// Words behind the numbers, from the next line on: "search, gap 1.3".
    void note(std::string words) { note_ = std::move(words); }
    /// The first so many were done before: they do not count for the rate.
    void skip(std::int64_t done) { skipped_ = done; }
    /// The last state, always shown, and the end of the line.
    void finish(std::int64_t done);

private:
    void show(std::int64_t done, bool last);

    std::ostream& err_;
    std::string what_, note_;
    std::int64_t total_, skipped_ = 0;
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
