// SPDX-License-Identifier: GPL-3.0-or-later
// What is hidden in the measurements of this folder: a drag of the tipped waste that grows as v^1.5. It is none of the forms that scree knows.
#include "scree/own_law.h"

#include <cmath>

extern "C" void scree_contact_law(const scree_contact_state*, scree_contact_law_values*) {}

extern "C" void scree_ground_drag(const scree_contact_state* s, scree_ground_drag_values* drag) {
    const double* v = s->velocity;
    drag->linear =
        s->number[0] * std::pow(v[0] * v[0] + v[1] * v[1] + v[2] * v[2], 0.25);  // force m c v, c = a sqrt(v)
}
