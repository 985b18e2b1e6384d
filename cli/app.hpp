// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace scree::cli {

/// The program without its process: runs the command line `args` (without the program's name), results to `out`, diagnostics and progress to `err`.
/// Returns the exit code (ExitCode).
int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

}  // namespace scree::cli
