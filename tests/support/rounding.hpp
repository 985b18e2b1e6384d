// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace scree::test {

/// What rounding may change of a length of metres [m] or of a number of about one [-].
inline constexpr double kRounding = 1e-12;

}  // namespace scree::test
