// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace scree {

/// The three parameters of the contact law (B&A section 3.1.1). They belong to the facet that is touched.
struct Soil {
    std::string name;
    double restitution = 0.0;  ///< e of Newton's impact law; more bounces higher and runs farther [-]
    double friction = 0.5;     ///< mu of Coulomb friction; less slides more [-]
    double rolling =
        0.04;  ///< mu_r, lever arm of the rolling resistance, a LENGTH (B&A Table 1); more stops earlier [m]

    bool operator==(const Soil&) const = default;
};

}  // namespace scree
