/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A law as a user would write it: ground_drag with the coefficient a, rolling_speed with the speed b and exponent 1. */
#include "scree/own_law.h"

#include <math.h>

void scree_contact_law(const scree_contact_state* s, scree_contact_law_values* law) {
    const double speed =
        sqrt(s->velocity[0] * s->velocity[0] + s->velocity[1] * s->velocity[1] + s->velocity[2] * s->velocity[2]);
    if (s->number[1] > 0.0) law->rolling *= 1.0 + pow(speed / s->number[1], 1.0);
}

void scree_ground_drag(const scree_contact_state* s, scree_ground_drag_values* drag) {
    drag->linear = s->number[0];
}
