// Constraints that are alike, as many at once as a vector holds: those of nodes on facets and on planes, by far the
// most of what meshes make. A sweep streams a block in place of its constraints and their entries, which are a kilobyte
// each, and does to each what solve.c does to one alone: which are in blocks changes nothing. Private to the solution.
#pragma once

#include "base/simd.h"
#include "contact/constraint/constraint.h"

enum { BRUNT_BLOCK_ENTRIES = BRUNT_LANE_ENTRIES, BRUNT_BLOCK_MASTERS = BRUNT_BLOCK_ENTRIES - 1 };

typedef struct brunt_constraint_block {
    int32_t count; // entries of each; 0: they are not alike, and the rest is unused; BRUNT_NONE: not looked at yet
    bool rubs;     // some have friction
    bool shared;   // some of their nodes are
    // What a sweep looks at comes first, and what it does only where friction is.
    int32_t dof_node[BRUNT_BLOCK_ENTRIES][BRUNT_DOUBLES];
    doubles weight[BRUNT_BLOCK_ENTRIES];             // of all components
    doubles height_gradient[BRUNT_BLOCK_MASTERS][3]; // of all entries but the first
    doubles n[3], facet[3], target, scale;           // as those of the constraints
    doubles unit;                                    // [kg] `scale` by the row sum
    doubles normal_impulse;                          // [N s]
    doubles friction, unit_t, friction_impulse[3];
    doubles_mask slips;
    doubles row_sum, row_sum_t;
    int32_t first[BRUNT_DOUBLES];
} brunt_constraint_block;

// Makes block b of constraints from b * BRUNT_DOUBLES on, unless they are not alike or that has been done.
void brunt_block_make(brunt_constraint_set *set, int64_t b);
// What weigh_constraint, share_constraint, sum_row and solve_constraint of solve.c do; the greatest correction of a
// sweep [m/s].
void brunt_block_share(const brunt_constraint_set *set, brunt_constraint_block *block);
void brunt_block_sum_rows(const brunt_constraint_set *set, brunt_constraint_block *block);
double brunt_block_solve(const brunt_constraint_set *set, brunt_constraint_block *block);
// Back to what was before the first sweep; and to the constraints what the sweeps came to.
void brunt_block_take_back(brunt_constraint_block *block);
void brunt_block_finish(brunt_constraint_set *set, int64_t b);
// Makes the rates of the constraints of block b.
void brunt_block_rates(const brunt_constraint_set *set, int64_t b);
// The node of entry e of constraint k, wherever it is, once all blocks are made.
static inline int32_t brunt_constraint_node(const brunt_constraint_set *set, int64_t k, int e) {
    const brunt_constraint *constraint = &set->constraint[k];
    return constraint->laned ? set->block[k / BRUNT_DOUBLES].dof_node[e][k % BRUNT_DOUBLES]
                             : set->entry[constraint->first + e].dof_node;
}
// Writes the entries of the constraints of block b that are in its lanes alone.
void brunt_block_write_entries(brunt_constraint_set *set, int64_t b);
