/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A law of your own: the effect `own_law` takes it from a shared library with C linkage, at least one of the two functions below.
 *
 *     cc -shared -fPIC -O2 -I include -o my_law.so my_law.c
 *
 *     [[effect]]
 *     kind = "own_law"
 *     library = "my_law.so"
 *     a = 0.5
 *
 * SI units. Called for every contact in every step, from several threads at once: no state, no locks, no output. The same arguments must
 * give the same numbers. Energy is never created: e is cut to [0, 1], mu, mu_r and drag at 0. A value that is no number fails the block. */
#ifndef SCREE_OWN_LAW_H
#define SCREE_OWN_LAW_H

#ifdef __cplusplus
extern "C" {
#endif

/* What a law may depend on. Vectors are (x east, y north, z up) in 3D, in metres from the rounded origin that the run uses; in 2D (s, 0, z), s
 * the distance along the profile. */
typedef struct scree_contact_state {
    double position[3];   /* of the contact; of the centre of mass for drag [m] */
    double normal[3];     /* of the ground; (0, 0, 1) for drag [-] */
    double velocity[3];   /* of the centre of mass [m/s] */
    double spin;          /* angular speed [rad/s] */
    double approach;      /* normal speed towards the ground, 0 if the contact parts; 0 for drag [m/s] */
    double mass;          /* [kg] */
    double length;        /* (L1 + L2 + L3) / 3 [m] */
    double draw;          /* a number of this block, even in [0, 1) [-] */
    double number[4];     /* a, b, c, d of the entry in the site file [*] */
} scree_contact_state;

/* Given as the soil and the effects before have them, to be changed. */
typedef struct scree_contact_law_values {
    double restitution, friction, rolling; /* e [-], mu [-], mu_r [m] */
} scree_contact_law_values;

/* Acceleration -(linear + quadratic |v|) v of the centre of mass while the ground bears the block (not in a bounce): given as 0, to be set. */
typedef struct scree_ground_drag_values {
    double linear, quadratic; /* [1/s], [1/m] */
} scree_ground_drag_values;

void scree_contact_law(const scree_contact_state* state, scree_contact_law_values* law);
void scree_ground_drag(const scree_contact_state* state, scree_ground_drag_values* drag);

#ifdef __cplusplus
}
#endif

#endif
