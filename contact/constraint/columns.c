// Which points press on a shared degree-of-freedom node: the transpose of the points' entries.
//
// Groups of points are counted and filled at once, each to its own places. Whatever their number, a column is in the
// order of the points.
#include "contact/constraint/columns.h"

#include "base/array.h"
#include "contact/constraint/block.h"

enum { GROUP = 1024, MAX_GROUPS = 8 };

// Points in groups of their order, so many each, but no more groups than MAX_GROUPS.
static int32_t group_size(const brunt_constraint_set *p) {
    const int32_t even = (p->constraint_count + MAX_GROUPS - 1) / MAX_GROUPS;
    return even > GROUP ? (even + BRUNT_DOUBLES - 1) / BRUNT_DOUBLES * BRUNT_DOUBLES : GROUP;
}

// Whether no node of the block that begins with constraint k is shared: most blocks are inside a part.
static bool is_inside(const brunt_constraint_set *p, int32_t k) {
    const brunt_constraint_block *b = &p->block[k / BRUNT_DOUBLES];
    bool shared = !b->count;
    for (int e = 0; e < b->count; e++)
        for (int l = 0; l < BRUNT_DOUBLES; l++) shared |= p->shared[b->dof_node[e][l]];
    return !shared;
}

// The next constraint from k on that may have a shared node.
static int32_t next_sharing(const brunt_constraint_set *p, int32_t k) {
    while (k % BRUNT_DOUBLES == 0 && k < p->constraint_count && is_inside(p, k)) k += BRUNT_DOUBLES;
    return k;
}

static int32_t end_of_group(const brunt_constraint_set *p, int64_t g) {
    const int64_t end = (g + 1) * group_size(p);
    return (int32_t)(end < p->constraint_count ? end : p->constraint_count);
}

// How many entries each group has of each node, those of friction points with the others.
static void count_entries(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    const int32_t size = group_size(p);
    for (int64_t g = begin; g < end; g++) {
        int32_t *at = p->column_at + g * p->dof_node_count;
        for (int32_t s = 0; s < p->dof_node_count; s++)
            if (p->shared[s]) at[s] = 0;
        const int32_t last = end_of_group(p, g);
        for (int32_t k = next_sharing(p, (int32_t)g * size); k < last; k = next_sharing(p, k + 1)) {
            const brunt_constraint *constraint = &p->constraint[k];
            const int32_t each = constraint->friction_point ? 2 : 1;
            for (int e = 0; e < constraint->count; e++) {
                const int32_t s = brunt_constraint_node(p, k, e);
                if (p->shared[s]) at[s] += each;
            }
        }
    }
}

// Where each node begins, and within it each group.
static void place_columns(brunt_constraint_set *p, int32_t groups) {
    int32_t next = 0;
    for (int32_t s = 0; s < p->dof_node_count; s++) {
        p->column_first[s] = next;
        for (int32_t g = 0; g < groups && p->shared[s]; g++) {
            int32_t *at = &p->column_at[(size_t)g * (size_t)p->dof_node_count + (size_t)s];
            const int32_t count = *at;
            *at = next, next += count;
        }
    }
    p->column_first[p->dof_node_count] = next;
}

static void fill_columns(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    const int32_t size = group_size(p);
    for (int64_t g = begin; g < end; g++) {
        int32_t *at = p->column_at + g * p->dof_node_count;
        const int32_t last = end_of_group(p, g);
        for (int32_t k = next_sharing(p, (int32_t)g * size); k < last; k = next_sharing(p, k + 1)) {
            const brunt_constraint *constraint = &p->constraint[k];
            for (int e = 0; e < constraint->count; e++) {
                const int32_t s = brunt_constraint_node(p, k, e);
                if (!p->shared[s]) continue;
                const int32_t entry = constraint->first + e;
                p->column[at[s]++] = (struct brunt_constraint_column){k, entry};
                if (constraint->friction_point)
                    p->column[at[s]++] = (struct brunt_constraint_column){k, entry + constraint->count};
            }
        }
    }
}

int brunt_constraints_make_columns(brunt_constraint_set *p, int threads, brunt_timer *timer, brunt_error *error) {
    const int32_t groups = (p->constraint_count + group_size(p) - 1) / group_size(p);
    const size_t entries = (size_t)p->entry_count + 1, dof_nodes = (size_t)p->dof_node_count + 1;
    if (BRUNT_CAPACITY(p->column, entries, 0, "entries of contact points", error) ||
        BRUNT_CAPACITY(p->column_first, dof_nodes, 0, "nodes that contact moves", error) ||
        BRUNT_CAPACITY(p->column_at, dof_nodes * (size_t)groups, 0, "nodes of groups of contact points", error) ||
        BRUNT_CAPACITY(p->given, entries, 0, "impulses of contact points", error))
        return BRUNT_FAILED;
    brunt_parallel(threads, groups, 1, count_entries, p, timer);
    place_columns(p, groups);
    brunt_parallel(threads, groups, 1, fill_columns, p, timer);
    return BRUNT_OK;
}
