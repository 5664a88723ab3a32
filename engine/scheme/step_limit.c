// What decides how long an explicit step is: the body, its element, and how much longer steps were without them.
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/memory.h"
#include "scheme/scheme.h"

enum { SHARE = 100 }; // one element in so many

typedef struct element_step {
    double step; // [s]
    int64_t id;
} element_step;

static int shorter(const void *a, const void *b) {
    const element_step *one = a, *two = b;
    return one->step < two->step ? -1 : one->step > two->step ? 1 : (one->id > two->id) - (one->id < two->id);
}

// The steps of a body's elements, the shortest first. How many, BRUNT_NONE: out of memory.
static int64_t sort_elements(brunt_scratch *scratch, const brunt_fem_body *fem, element_step *list) {
    brunt_fem_single *single = brunt_fem_single_make(fem);
    int64_t count = 0;
    if (!single) return BRUNT_NONE;
    for (int32_t b = 0; b < fem->block_count; b++)
        for (int32_t s = fem->block[b].first; s < fem->block[b].first + fem->block[b].count; s++)
            if (fem->element_id[s] >= 0)
                list[count++] = (element_step){
                    brunt_fem_single_look(single, fem, s, 0, 0, &scratch->meshes[0]).stable_step, fem->element_id[s]};
    brunt_fem_single_free(single);
    qsort(list, (size_t)count, sizeof *list, shorter);
    return count;
}

static int look_at_elements(brunt_scratch *scratch, const brunt_fem_body *fem, brunt_step_limit *limit,
                            brunt_error *error) {
    element_step *list;
    if (BRUNT_NEW(list, (size_t)fem->slots + 1, "steps of elements", error)) return BRUNT_FAILED;
    const int64_t count = sort_elements(scratch, fem, list);
    if (count > 0) {
        const int64_t few = (count + SHARE - 1) / SHARE;
        limit->element = list[0].id, limit->element_step = list[0].step;
        limit->few = few, limit->without_few = few < count ? list[few].step : INFINITY;
    }
    brunt_free(list);
    return count < 0 ? brunt_fail(error, BRUNT_FAILED, "Out of memory for steps of elements.") : BRUNT_OK;
}

int brunt_world_step_limit(brunt_world *world, brunt_step_limit *limit, brunt_error *error) {
    *limit = (brunt_step_limit){.body = BRUNT_NONE, .element = -1, .step = INFINITY, .without_body = INFINITY};
    if (world->plan.implicit) return BRUNT_OK;
    for (int i = 0; i < world->bodies.count; i++) {
        const double step = brunt_body_step(world, i, brunt_boundary_speed(&world->boundaries));
        if (step < limit->step)
            limit->without_body = limit->step, limit->step = step, limit->body = i;
        else
            limit->without_body = fmin(limit->without_body, step);
    }
    if (limit->body < 0) return BRUNT_OK;
    const brunt_fem_body *fem = world->bodies.all[limit->body].fem;
    return fem ? look_at_elements(&world->scratch, fem, limit, error) : BRUNT_OK;
}
