// Accelerated sweeps: with how much of the last correction each begins (constraint.h).
#include "contact/constraint/acceleration.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "contact/constraint/parts.h"

int brunt_acceleration_begin(brunt_constraint_set *p, brunt_error *error) {
    const size_t points = (size_t)p->constraint_count, dofs = (size_t)p->dof_node_count;
    if (BRUNT_CAPACITY(p->point_past, points, 0, "contact points", error) ||
        BRUNT_CAPACITY(p->dof_past, dofs + 1, 0, "nodes that contact moves", error) ||
        BRUNT_CAPACITY(p->turned_back, points / BRUNT_CONSTRAINT_GRAIN + 2, 0, "groups of contact points", error))
        return BRUNT_FAILED;
    p->momentum = 0;
    memset(p->point_past, 0, points * sizeof *p->point_past);
    for (size_t s = 0; s < dofs; s++) {
        memcpy(p->dof_past[s].v, p->now[s], sizeof p->dof_past[s].v);
        memcpy(p->dof_past[s].impulse, p->received[s], sizeof p->dof_past[s].impulse);
    }
    return BRUNT_OK;
}

double brunt_acceleration_next(brunt_constraint_set *p, int64_t chunks, double weight) {
    double back = 0;
    for (int64_t c = 0; c < chunks; c++) back += p->turned_back[c];
    if (back > 0) {
        p->momentum = 0;
        return 1;
    }
    const double next = 0.5 * (1 + sqrt(1 + 4 * weight * weight));
    p->momentum = (weight - 1) / next;
    return next;
}
