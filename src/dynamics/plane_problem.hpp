// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace scree {

/// One contact in the plane, u = W p + q with W column by column (3x3), p a guess on entry: it sticks or slides to either side, and rolls to either side or not; each of the nine states is a linear problem. From the
/// state of the guess to the one that its solution asks for, until they agree: mostly at once. False if they do not; p is then used up.
inline bool solve_in_plane(const double* W, const double* q, double mu, double mu_r, double* p) {
    if (q[0] >= 0.0) {
        std::fill_n(p, 3, 0.0);
        return true;
    }
    constexpr double kAtLimit = 1.0 - 1e-6;  // of a guess
    const auto side = [&](double pull, double limit) { return pull > limit ? 1 : pull < -limit ? -1 : 0; };
    int slides = p[0] > 0.0 ? side(p[1], kAtLimit * mu * p[0]) : 0,
        rolls = p[0] > 0.0 ? side(p[2], kAtLimit * mu_r * p[0]) : 0;
    const auto entry = [&](int i, int j) { return W[3 * j + i]; };
    for (int turn = 0; turn < 6; ++turn) {
        // what slides or rolls follows r_N; what does not is unknown, and holds
        double n[3];
        for (int i = 0; i < 3; ++i) n[i] = entry(i, 0) + slides * mu * entry(i, 1) + rolls * mu_r * entry(i, 2);
        if (slides && rolls) {
            p[0] = -q[0] / n[0];
        } else if (slides || rolls) {
            const int k = slides ? 2 : 1;  // the one that holds
            const double per = 1.0 / (n[0] * entry(k, k) - entry(0, k) * n[k]);
            p[0] = (entry(0, k) * q[k] - entry(k, k) * q[0]) * per;
            p[k] = (n[k] * q[0] - n[0] * q[k]) * per;
        } else {
            const double a = entry(1, 1) * entry(2, 2) - entry(1, 2) * entry(2, 1),
                         b = entry(1, 2) * n[2] - n[1] * entry(2, 2),
                         c = n[1] * entry(2, 1) - entry(1, 1) * n[2];  // minors of the first row
            const double per = 1.0 / (n[0] * a + entry(0, 1) * b + entry(0, 2) * c);
            const double d = entry(0, 2) * entry(2, 1) - entry(0, 1) * entry(2, 2),
                         e = n[0] * entry(2, 2) - entry(0, 2) * n[2], f = entry(0, 1) * n[2] - n[0] * entry(2, 1);
            const double g = entry(0, 1) * entry(1, 2) - entry(0, 2) * entry(1, 1),
                         h = entry(0, 2) * n[1] - n[0] * entry(1, 2), i = n[0] * entry(1, 1) - entry(0, 1) * n[1];
            p[0] = -(a * q[0] + d * q[1] + g * q[2]) * per;
            p[1] = -(b * q[0] + e * q[1] + h * q[2]) * per;
            p[2] = -(c * q[0] + f * q[1] + i * q[2]) * per;
        }
        if (slides) p[1] = slides * mu * p[0];
        if (rolls) p[2] = rolls * mu_r * p[0];
        if (!(p[0] > 0.0 && std::isfinite(p[0]))) return false;
        const auto velocity = [&](int i) {
            return entry(i, 0) * p[0] + entry(i, 1) * p[1] + entry(i, 2) * p[2] + q[i];
        };
        const int slides_then = slides ? (slides * velocity(1) <= 0.0 ? slides : 0) : side(p[1], mu * p[0]),
                  rolls_then = rolls ? (rolls * velocity(2) <= 0.0 ? rolls : 0) : side(p[2], mu_r * p[0]);
        if (slides_then == slides && rolls_then == rolls) return true;
        slides = slides_then;
        rolls = rolls_then;
    }
    return false;
}

}  // namespace scree
