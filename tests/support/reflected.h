// Scenes beside their mirror images, with axes that change places and bodies in another order: what their suites share.
#pragma once

#include "tests/support/def_world.h"

enum { AXES = 3 };

// Which axis goes to each, and whether it is turned round.
typedef struct reflection {
    const char *name;
    int from[AXES];
    double sign[AXES];
    bool swap; // the order of the two, which goes by their names
} reflection;

static const reflection plain = {"plain", {0, 1, 2}, {1, 1, 1}, false};
static const reflection reflections[] = {
    {"the other order", {0, 1, 2}, {1, 1, 1}, true},  {"x turned round", {0, 1, 2}, {-1, 1, 1}, false},
    {"z turned round", {0, 1, 2}, {1, 1, -1}, true},  {"x for y", {1, 0, 2}, {1, 1, 1}, false},
    {"x for z, turned", {2, 1, 0}, {1, 1, -1}, true}, {"about the diagonal", {1, 2, 0}, {1, 1, 1}, false},
};
enum { REFLECTIONS = sizeof reflections / sizeof *reflections };

static inline void reflect(const reflection *r, const double x[AXES], double out[AXES]) {
    for (int a = 0; a < AXES; a++) out[a] = r->sign[a] * x[r->from[a]];
}

typedef struct outcome {
    double energy[6], momentum[2][AXES]; // [J]; of each body, as without a mirror [kg m/s]
} outcome;

static inline outcome outcome_of(brunt_world *world, const reflection *r) {
    outcome out;
    const brunt_energy e = world_energy(world);
    memcpy(out.energy, (const double[6]){e.kinetic, e.internal, e.contact, e.friction, e.hourglass, e.transfer},
           sizeof out.energy);
    for (int k = 0; k < 2; k++) {
        const brunt_body_sums s = world_sums(world, r->swap ? !k : k);
        for (int a = 0; a < AXES; a++) out.momentum[k][r->from[a]] = r->sign[a] * s.momentum[a];
    }
    return out;
}

static inline double greatest_between(const outcome *a, const outcome *b, double energy, double momentum) {
    double most = 0;
    for (int k = 0; k < 6; k++) most = fmax(most, fabs(a->energy[k] - b->energy[k]) / energy);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < AXES; i++) most = fmax(most, fabs(a->momentum[k][i] - b->momentum[k][i]) / momentum);
    return most;
}
