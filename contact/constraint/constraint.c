// Sets of constraints: what they are made of, and room for it.
#include "contact/constraint/constraint.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "contact/constraint/block.h"

void brunt_constraints_validate(const brunt_constraint_set *p) {
    for (int32_t s = 0; s < p->dof_node_count; s++)
        for (int a = 0; a < 3; a++) BRUNT_ASSERT(p->dof_node[s].inverse[a] >= 0);
    for (int32_t k = 0; k < p->constraint_count; k++) {
        const brunt_constraint *c = &p->constraint[k];
        const int32_t end = c->first + (c->friction_point ? 2 : 1) * c->count;
        BRUNT_ASSERT(c->first >= 0 && c->count > 0 && end <= p->entry_count);
        for (int e = 0; e < end - c->first; e++)
            BRUNT_ASSERT(brunt_constraint_node(p, k, e) >= 0 && brunt_constraint_node(p, k, e) < p->dof_node_count);
        BRUNT_ASSERT(c->friction_point >= 0 && c->friction_point <= p->friction_point_count);
        BRUNT_ASSERT(!c->touch || !c->friction_point); // what is given back rubs where it pushes
        BRUNT_ASSERT(fabs(c->n[0] * c->n[0] + c->n[1] * c->n[1] + c->n[2] * c->n[2] - 1) < 1e-6);
        BRUNT_ASSERT(c->account && c->friction >= 0 && c->spring >= 0 && (c->spring > 0 || c->least <= 0));
        BRUNT_ASSERT(c->normal_impulse >= fmin(c->least, 0));
        BRUNT_ASSERT(!c->sticks || c->friction > 0);
    }
}

void brunt_constraints_clear(brunt_constraint_set *p) {
    p->constraint_count = p->entry_count = p->friction_point_count = p->dof_node_count = p->open_blocks = 0;
}

void brunt_constraints_free(brunt_constraint_set *p) {
    brunt_free(p->constraint);
    brunt_free(p->entry);
    brunt_free(p->friction_point);
    brunt_free(p->dof_node);
    brunt_free(p->part_of);
    brunt_free(p->chunk_place);
    brunt_free(p->marks);
    brunt_free(p->shared), brunt_free(p->own), brunt_free(p->own_first);
    brunt_free(p->state);
    brunt_free(p->before);
    brunt_free(p->rates);
    brunt_free(p->inverse);
    brunt_free(p->received);
    brunt_free(p->sum);
    brunt_free(p->load);
    brunt_free(p->column);
    brunt_free(p->column_first);
    brunt_free(p->column_at);
    brunt_free(p->given);
    brunt_free(p->block);
    brunt_free(p->changed);
    brunt_free(p->recorded);
    brunt_free(p->corrected);
    brunt_free(p->rests);
    brunt_free(p->drift);
    brunt_free(p->stirred);
    brunt_free(p->point_past);
    brunt_free(p->dof_past);
    brunt_free(p->turned_back);
    brunt_free(p->release);
    brunt_free(p->kicks), brunt_free(p->settled), brunt_free(p->kicked);
    memset(p, 0, sizeof *p);
}

#define ADD(p, array, what, error)                                                                                     \
    (BRUNT_CAPACITY_MORE((p)->array, what, error)                                                                      \
         ? BRUNT_NONE                                                                                                  \
         : (memset(&(p)->array[(p)->array##_count], 0, sizeof *(p)->array), (p)->array##_count++))

int32_t brunt_constraints_dof_node(brunt_constraint_set *p, brunt_error *error) {
    return ADD(p, dof_node, "nodes that contact moves", error);
}

int32_t brunt_constraints_add(brunt_constraint_set *p, brunt_error *error) {
    int32_t at = ADD(p, constraint, "contact points", error);
    if (at >= 0) p->constraint[at].first = p->entry_count;
    return at;
}

int32_t brunt_constraints_entry(brunt_constraint_set *p, int32_t dof_node, double weight, brunt_error *error) {
    int32_t at = ADD(p, entry, "entries of contact points", error);
    if (at < 0) return BRUNT_NONE;
    p->entry[at].dof_node = dof_node;
    for (int a = 0; a < 3; a++) p->entry[at].weight[a] = weight;
    p->constraint[p->constraint_count - 1].count++;
    return at;
}

int32_t brunt_constraints_friction_point(brunt_constraint_set *p, const double x[3], brunt_error *error) {
    const int32_t at = ADD(p, friction_point, "friction points", error), first = p->entry_count;
    brunt_constraint *constraint = &p->constraint[p->constraint_count - 1];
    if (at < 0) return BRUNT_NONE;
    memcpy(p->friction_point[at].x, x, sizeof p->friction_point[at].x);
    for (int32_t e = 0; e < constraint->count; e++) {
        const int32_t entry = ADD(p, entry, "entries of contact points", error);
        if (entry < 0) return BRUNT_NONE;
        p->entry[entry].dof_node = p->entry[constraint->first + e].dof_node;
    }
    constraint->friction_point = at + 1;
    return first;
}

int brunt_constraints_reserve(brunt_constraint_set *p, int32_t points, int32_t entries, int32_t dofs,
                              brunt_error *error) {
    return BRUNT_CAPACITY(p->constraint, (size_t)points + 1, (size_t)p->constraint_count, "contact points", error) ||
                   BRUNT_CAPACITY(p->entry, (size_t)entries + 1, (size_t)p->entry_count, "entries of contact points",
                                  error) ||
                   BRUNT_CAPACITY(p->dof_node, (size_t)dofs + 1, (size_t)p->dof_node_count, "nodes that contact moves",
                                  error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}
