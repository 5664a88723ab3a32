// What leaves bodies at the end of a step, and what lets it.
#pragma once

#include "account/ledger.h"
#include "base/parallel.h"
#include "boundary/node_sets.h"

struct brunt_erosion_work;

typedef struct brunt_erosion {
    bool active;                     // elements or material points may leave their bodies
    int count;                       // of bodies
    brunt_eroded *account;           // of each body; NULL without erosion. Saved with the state
    brunt_erosion_def *rule;         // of each body; NULL without erosion
    struct brunt_erosion_work *work; // of meshes that erode; NULL without erosion
} brunt_erosion;

// What erosion acts on at the end of a step.
typedef struct brunt_erosion_step {
    const brunt_bodies *bodies;
    brunt_node_sets *sets;
    brunt_ledger *ledger;
    brunt_fem_workspace *workspace; // a thread each
    double dt, time, steps;         // [s], [s], [-]
    int threads;
    brunt_timer *timer;
} brunt_erosion_step;

// The accounts and lists of bodies that erode. Before the first step.
int brunt_erosion_make(brunt_erosion *erosion, const brunt_bodies *bodies, const brunt_world_def *def,
                       brunt_error *error);
void brunt_erosion_free(brunt_erosion *erosion);
void brunt_erosion_validate(const brunt_erosion *erosion);
// Marks elements that have failed, are strained, or short of step; those that were inside out are marked already.
void brunt_erosion_mark_elements(const brunt_erosion *erosion, const brunt_erosion_step *step);
// Takes out elements that have a mark, counted in the reports of their blocks, and records them; `any`: there were
// such. BRUNT_OK, or BRUNT_FAILED with the reason.
int brunt_erosion_take_elements(brunt_erosion *erosion, const brunt_erosion_step *step, bool *any, brunt_error *error);
// The same of material points, marks and all.
void brunt_erosion_take_points(brunt_erosion *erosion, const brunt_erosion_step *step);
// The accounts, as doubles.
int64_t brunt_erosion_state_count(const brunt_erosion *erosion);
void brunt_erosion_state_get(const brunt_erosion *erosion, double *out);
void brunt_erosion_state_set(brunt_erosion *erosion, const double *in);
