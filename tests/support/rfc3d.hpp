// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/contact_solver.hpp"

#include <filesystem>

namespace scree::test {

/// Reads a rolling-friction problem of Siconos' test data: dimension (5), number of contacts, matrix (storage 0: dense by columns, 1: sparse
/// blocks by columns), q, mu, mu_r.
ContactProblem<3> read_rfc3d(const std::filesystem::path& path);

}  // namespace scree::test
