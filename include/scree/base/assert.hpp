// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// SCREE_ASSERT(condition): a programmer's mistake, never a user's. Checked in Debug and RelWithDebInfo, free in Release.
#ifdef SCREE_ENABLE_ASSERT
namespace scree {
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);
}
#define SCREE_ASSERT(condition) ((condition) ? void(0) : ::scree::assertion_failed(#condition, __FILE__, __LINE__))
#else
#define SCREE_ASSERT(condition) void(0)
#endif
