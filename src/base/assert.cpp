// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/base/assert.hpp"

#include <cstdio>
#include <cstdlib>

namespace scree {

// Declared here too: the header declares it only where assertions are on, a consumer may differ from the library.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

void assertion_failed(const char* condition, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: internal error, please report: %s does not hold\n", file, line, condition);
    std::abort();
}

}  // namespace scree
