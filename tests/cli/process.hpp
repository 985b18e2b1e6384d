// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

extern char** environ;

namespace scree::test {

/// The program as a process whose error stream is read here.
class Process {
public:
    explicit Process(std::vector<std::string> args) {
        args.insert(args.begin(), SCREE_PROGRAM);
        std::vector<char*> argv;
        for (std::string& arg : args) argv.push_back(arg.data());
        argv.push_back(nullptr);
        std::array<int, 2> ends{};
        if (::pipe2(ends.data(), O_CLOEXEC) != 0) return;
        posix_spawn_file_actions_t actions;
        ::posix_spawn_file_actions_init(&actions);
        ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
        const int failed = ::posix_spawn(&id_, SCREE_PROGRAM, &actions, nullptr, argv.data(), environ);
        if (failed) id_ = -1;
        EXPECT_EQ(failed, 0) << "cannot start " << SCREE_PROGRAM;
        ::posix_spawn_file_actions_destroy(&actions);
        ::close(ends[1]);
        err_ = ::fdopen(ends[0], "r");
    }
    ~Process() {
        if (err_) ::fclose(err_);
        if (id_ > 0 && !ended_) {
            ::kill(id_, SIGKILL);
            ::waitpid(id_, nullptr, 0);
        }
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// The next line of the error stream, "" at its end.
    std::string line() {
        std::array<char, 4096> buffer{};
        return err_ && std::fgets(buffer.data(), buffer.size(), err_) ? std::string(buffer.data()) : std::string();
    }
    void interrupt() const {
        if (id_ > 0) ::kill(id_, SIGINT);  // -1 would be everybody
    }
    /// The exit code, or -signal.
    int wait() {
        if (id_ <= 0) return -1;
        int status = 0;
        ::waitpid(id_, &status, 0);
        ended_ = true;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    }

private:
    pid_t id_ = -1;
    std::FILE* err_ = nullptr;
    bool ended_ = false;
};

/// Runs the program with --progress=json and sends Ctrl-C after its `after`-th report of progress, of the stage if one is given: the last line that it said.
inline std::string interrupted(const std::vector<std::string>& args, int after = 1, const std::string& stage = "") {
    Process run(args);
    std::string line, last;
    while (after > 0 && !(line = run.line()).empty())
        after -= line.find("\"done\"") != std::string::npos && line.find(stage) != std::string::npos;
    EXPECT_THAT(line, testing::HasSubstr("\"done\"")) << "it never reported progress";
    run.interrupt();
    for (line = run.line(); !line.empty(); line = run.line()) last = line;
    EXPECT_EQ(run.wait(), 130);
    return last;
}

}  // namespace scree::test
