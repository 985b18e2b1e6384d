// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/effects.hpp"

#include <filesystem>
#include <string>

namespace scree::cli {

/// Loads the functions of scree/own_law.h from a shared library, which stays loaded as long as the result or a copy of it. Throws InputError that
/// begins with `where` if it cannot be loaded or has none of them.
OwnLaw load_own_law(const std::filesystem::path& library, const std::string& where);

}  // namespace scree::cli
