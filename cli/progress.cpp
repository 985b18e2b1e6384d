// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress.hpp"

#include <unistd.h>

#include <cmath>
#include <csignal>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <utility>

namespace scree::cli {

namespace {

using Clock = std::chrono::steady_clock;

std::string duration_text(double seconds) {
    const auto s = static_cast<std::int64_t>(std::llround(seconds));
    std::ostringstream text;
    if (s >= 3600)
        text << s / 3600 << " h " << (s / 60) % 60 << " min";
    else if (s >= 60)
        text << s / 60 << " min " << s % 60 << " s";
    else
        text << s << " s";
    return text.str();
}

std::atomic<bool> interrupted{false};

extern "C" void on_interrupt(int signal) {
    if (interrupted.exchange(true)) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
}

}  // namespace

Progress::Progress(const Context& context, std::string what, std::int64_t total)
    : err_(*context.err),
      what_(std::move(what)),
      total_(total),
      quiet_(context.quiet),
      json_(context.progress == ProgressStyle::Json),
      terminal_(context.err == &std::cerr && isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      shown_(start_) {}

void Progress::update(std::int64_t done) {
    const double since = std::chrono::duration<double>(Clock::now() - shown_).count();
    if (since < (terminal_ ? 0.1 : json_ ? 0.5 : 10.0)) return;
    show(done, false);
    shown_ = Clock::now();
}

void Progress::finish(std::int64_t done) {
    show(done, true);
}

void Progress::show(std::int64_t done, bool last) {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    const double rate = static_cast<double>(done - skipped_) / std::max(elapsed, 1e-9);
    const double left = rate > 0.0 ? static_cast<double>(total_ - done) / rate : 0.0;
    if (json_) {
        err_ << "{\"event\": \"progress\", \"what\": \"" << what_ << "\", \"done\": " << done
             << ", \"total\": " << total_ << ", \"rate_per_s\": " << rate << ", \"seconds_left\": " << left
             << (note_.empty() ? "" : ", \"note\": \"" + note_ + "\"") << "}" << std::endl;
        return;
    }
    if (quiet_) return;
    std::ostringstream line;
    line << done << " of " << total_ << " " << what_ << ", " << std::setprecision(3) << rate << "/s";
    if (last)
        line << ", " << duration_text(elapsed);
    else
        line << ", " << duration_text(left) << " left";
    if (!note_.empty()) line << "; " << note_;
    if (terminal_) {
        const int width = 30;
        const int filled = static_cast<int>(width * static_cast<double>(done) /
                                            static_cast<double>(std::max<std::int64_t>(total_, 1)));
        err_ << "\r[" << std::string(static_cast<std::size_t>(filled), '=')
             << std::string(static_cast<std::size_t>(width - filled), ' ') << "] " << line.str() << "\033[K"
             << (last ? "\n" : "") << std::flush;
    } else {
        err_ << line.str() << std::endl;
    }
}

InterruptScope::InterruptScope() {
    interrupted = false;
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
}
InterruptScope::~InterruptScope() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}
const std::atomic<bool>& InterruptScope::flag() {
    return interrupted;
}

}  // namespace scree::cli
