// Which rows of the scheme's table the scene calls for (scheme/scheme.h), and what implicit steps keep. No state: it
// follows from the definition.
#pragma once

#include "body/bodies.h"
#include "boundary/boundaries.h"
#include "brunt.h"

// The rows in their order, and the passes that they are parts of, as they are listed: pass_of[i] is that of row[i].
enum { BRUNT_PASS_LIMIT = 32 };
typedef struct brunt_plan {
    const struct brunt_pass_row *row[BRUNT_PASS_LIMIT], *pass[BRUNT_PASS_LIMIT];
    int pass_of[BRUNT_PASS_LIMIT], row_count, pass_count;
    struct brunt_implicit *implicit; // what implicit steps keep, NULL of explicit ones (scheme/implicit.h)
} brunt_plan;

// Of a world that is made, but for its plan. Nothing but `implicit` is to be freed.
void brunt_plan_make(brunt_plan *plan, const brunt_world *world);
// Aborts where rows and passes do not belong together.
void brunt_plan_validate(const brunt_plan *plan);
// What implicit steps keep beside the world, once its bodies are sorted. BRUNT_OK, or the code of what is wrong.
int brunt_implicit_make(brunt_world *world, const brunt_world_def *def, brunt_error *error);
void brunt_implicit_free(brunt_plan *plan, const brunt_bodies *bodies);
// What load steps with friction keep from step to step, as numbers (contact/barrier/barrier_memory.c): of meshes in
// three dimensions more or fewer as steps go on. BRUNT_OK, or BRUNT_FAILED: out of memory.
int64_t brunt_implicit_kept_count(const brunt_plan *plan);
void brunt_implicit_kept_get(const brunt_plan *plan, double *to);
bool brunt_implicit_kept_fits(const brunt_plan *plan, int64_t count);
int brunt_implicit_kept_set(const brunt_plan *plan, const double *from, int64_t count, brunt_error *error);
// Aborts where unknowns, terms, contact or matrices do not belong to each other and to what there is in the world.
void brunt_implicit_validate(const struct brunt_implicit *implicit, const brunt_bodies *bodies,
                             const brunt_boundaries *boundaries, int pairs);
