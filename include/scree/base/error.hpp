// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace scree {

/// Exit codes of the command line.
enum class ExitCode { Done = 0, Usage = 2, BadInput = 3, CouldNotCompute = 4, Interrupted = 130 };

/// Root of all errors that Scree throws. The message is one sentence that says what is wrong, where (file, layer, row, key),
/// the value found, what is allowed and what to do.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The user can mend it: a file, a setting, a geometry.
class InputError : public Error {
public:
    using Error::Error;
};

/// The machine or the method failed: disc full, a file that cannot be written, an operation on geometries that fails.
class ComputeError : public Error {
public:
    using Error::Error;
};

}  // namespace scree
