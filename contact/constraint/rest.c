// Constraints that rest: sweeps go where something still happens.
//
// Where bodies lie on each other two sweeps bring most constraints to their condition; rims, where conditions are
// nearly the same ones twice, take many more. A constraint whose last correction is a small share of what ends the
// sweeps is left out until one of its nodes has drifted by as much since it was looked at: what it leaves is then no
// more than a few of those shares. Which rest depends on what all have done in the sweep before, and neither on their
// order nor on the threads.
#include "contact/constraint/rest.h"

#include <string.h>

#include "base/array.h"
#include "contact/constraint/block.h"

int brunt_rest_begin(brunt_constraint_set *p, brunt_error *error) {
    const size_t points = (size_t)p->constraint_count + 1, nodes = (size_t)p->dof_node_count + 1;
    if (BRUNT_CAPACITY(p->corrected, points, 0, "contact points", error) ||
        BRUNT_CAPACITY(p->rests, points, 0, "contact points", error) ||
        BRUNT_CAPACITY(p->drift, nodes, 0, "nodes that contact moves", error) ||
        BRUNT_CAPACITY(p->stirred, nodes, 0, "nodes that contact moves", error))
        return BRUNT_FAILED;
    p->still = 0;
    memset(p->rests, false, points * sizeof *p->rests);
    memset(p->drift, 0, nodes * sizeof *p->drift);
    return BRUNT_OK;
}

void brunt_constraint_gives_nothing(const brunt_constraint_set *p, int64_t k) {
    const brunt_constraint *constraint = &p->constraint[k];
    const int entries = (constraint->friction_point ? 2 : 1) * constraint->count;
    for (int e = 0; e < entries; e++)
        if (p->shared[brunt_constraint_node(p, k, e)]) memset(p->given[constraint->first + e], 0, sizeof *p->given);
}

bool brunt_constraint_rests(const brunt_constraint_set *p, int64_t k) {
    const brunt_constraint *constraint = &p->constraint[k];
    bool awake = !(p->corrected[k] <= p->still);
    for (int32_t e = constraint->first; e < constraint->first + constraint->count && !awake; e++)
        awake = p->stirred[p->entry[e].dof_node];
    if (!awake && !p->rests[k]) brunt_constraint_gives_nothing(p, k);
    return p->rests[k] = !awake;
}
