#include "body/bodies.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"

const char *brunt_bodies_name(const brunt_bodies *bodies, int body) {
    const brunt_body_ref *ref = &bodies->all[body];
    return ref->ops->name(ref);
}

const brunt_material *brunt_bodies_material(const brunt_bodies *bodies, int body) {
    const brunt_body_ref *ref = &bodies->all[body];
    return ref->ops->material(ref);
}

int brunt_bodies_find(const brunt_bodies *bodies, const char *name) {
    int low = 0, high = bodies->count;
    while (low < high) {
        const int middle = (low + high) / 2, order = strcmp(brunt_bodies_name(bodies, middle), name);
        if (order == 0) return middle;
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return BRUNT_NONE;
}

void brunt_bodies_meshes(const brunt_bodies *bodies, int body, int *first, int *end) {
    const brunt_fem_body *fem = body < 0 ? NULL : bodies->all[body].fem;
    *first = fem ? (int)(fem - bodies->fem) : 0;
    *end = fem ? *first + 1 : body < 0 ? bodies->fem_count : 0;
}

void brunt_bodies_points(const brunt_bodies *bodies, int body, int *first, int *end) {
    const brunt_body *mpm = body < 0 ? NULL : bodies->all[body].mpm;
    *first = mpm ? (int)(mpm - bodies->mpm) : 0;
    *end = mpm ? *first + 1 : body < 0 ? bodies->mpm_count : 0;
}

brunt_body_ref *brunt_bodies_summed(const brunt_bodies *bodies, int i) {
    const bool points = i < bodies->mpm_count;
    return &bodies->all[points ? bodies->mpm[i].index : bodies->fem[i - bodies->mpm_count].index];
}

// ------------------------------------------------------------------------------------------ what they sum up to

static const brunt_body_measure nothing = {.low = {INFINITY, INFINITY, INFINITY},
                                           .high = {-INFINITY, -INFINITY, -INFINITY}};

static void add_part(brunt_body_measure *to, const brunt_body_measure *part) {
    brunt_audit_add(&to->sums, &part->sums);
    to->energy.internal += part->energy.internal, to->energy.plastic += part->energy.plastic;
    to->energy.viscosity += part->energy.viscosity, to->energy.heat += part->energy.heat;
    for (int a = 0; a < 3; a++) {
        to->low[a] = fmin(to->low[a], part->low[a]);
        to->high[a] = fmax(to->high[a], part->high[a]);
    }
}

brunt_body_measure brunt_body_measure_of(const brunt_body_ref *body) {
    brunt_body_measure sum = nothing;
    for (int32_t p = 0; p < body->ops->parts(body); p++) {
        brunt_body_measure part = nothing;
        body->ops->measure(body, p, &part);
        add_part(&sum, &part);
    }
    return sum;
}

static void measure_parts(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_bodies *bodies = context;
    for (int64_t t = begin; t < end; t++) {
        brunt_body_part *part = &bodies->part[t];
        const brunt_body_ref *body = &bodies->all[part->body];
        part->measure = nothing;
        body->ops->measure(body, part->part, &part->measure);
    }
}

void brunt_bodies_measure(brunt_bodies *bodies, int threads) {
    size_t count = 0;
    brunt_error error;
    for (int32_t b = 0; b < bodies->count; b++) {
        const int32_t parts = bodies->all[b].ops->parts(&bodies->all[b]);
        if (BRUNT_CAPACITY(bodies->part, count + (size_t)parts, count, "sums of bodies", &error)) return;
        for (int32_t p = 0; p < parts; p++) bodies->part[count++] = (brunt_body_part){.body = b, .part = p};
    }
    if (BRUNT_CAPACITY(bodies->measure, (size_t)bodies->count, 0, "sums of bodies", &error)) return;
    brunt_parallel_each(threads, (int64_t)count, measure_parts, bodies, NULL);
    for (int b = 0; b < bodies->count; b++) bodies->measure[b] = nothing;
    for (size_t t = 0; t < count; t++) add_part(&bodies->measure[bodies->part[t].body], &bodies->part[t].measure);
    bodies->measured = true;
}

void brunt_bodies_forget(brunt_bodies *bodies) { bodies->measured = false; }

brunt_body_measure brunt_bodies_measure_of(const brunt_bodies *bodies, const brunt_body_ref *body) {
    return bodies->measured ? bodies->measure[body - bodies->all] : brunt_body_measure_of(body);
}

// ------------------------------------------------------------------------------------------ blocks and arrays

// Its fields, and what else it has.
static int32_t arrays_of(const brunt_body_ref *body) {
    int32_t n = BRUNT_BODY_ARRAYS;
    for (int f = 0; body->mpm && f < body->mpm->particles.field_count; f++)
        n += body->mpm->particles.field[f].components > 0;
    for (int f = 0; body->fem && f < body->fem->field_count; f++) n += body->fem->field[f].components > 0;
    return n;
}

int brunt_bodies_number(brunt_bodies *bodies, brunt_error *error) {
    const int count = bodies->count;
    if (BRUNT_NEW(bodies->first_block, count + 1, "blocks of the state", error) ||
        BRUNT_NEW(bodies->first_array, count + 1, "arrays of bodies", error))
        return BRUNT_FAILED;
    for (int i = 0; i < count; i++) {
        const brunt_body_ref *body = &bodies->all[i];
        bodies->first_block[i + 1] = bodies->first_block[i] + body->ops->block_count(body);
        bodies->first_array[i + 1] = bodies->first_array[i] + arrays_of(body);
    }
    return BRUNT_OK;
}

int brunt_bodies_holding(const brunt_bodies *bodies, const int32_t *first, int32_t index) {
    int low = 0, high = bodies->count; // the last that begins at or before it
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (first[middle] <= index)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

void brunt_bodies_free(brunt_bodies *bodies) {
    for (int i = 0; bodies->mpm && i < bodies->mpm_count; i++) brunt_body_free(&bodies->mpm[i]);
    for (int k = 0; bodies->fem && k < bodies->fem_count; k++) brunt_fem_free(&bodies->fem[k]);
    brunt_background_free(&bodies->background);
    brunt_free(bodies->all);
    brunt_free(bodies->mpm);
    brunt_free(bodies->fem);
    brunt_free(bodies->mesh_reports);
    brunt_free(bodies->first_block);
    brunt_free(bodies->first_array);
    brunt_free(bodies->tasks.node);
    brunt_free(bodies->tasks.element);
    brunt_free(bodies->tasks.sums);
    brunt_free(bodies->measure);
    brunt_free(bodies->part);
}

void brunt_bodies_validate(const brunt_bodies *bodies) {
    BRUNT_ASSERT(bodies->mpm_count + bodies->fem_count == bodies->count);
    for (int i = 0; i < bodies->count; i++) {
        const brunt_body_ref *ref = &bodies->all[i];
        BRUNT_ASSERT(!ref->mpm != !ref->fem && ref->ops == (ref->mpm ? &brunt_points_ops : &brunt_mesh_ops));
        BRUNT_ASSERT((ref->mpm ? ref->mpm->index : ref->fem->index) == i);
        BRUNT_ASSERT(!i || strcmp(brunt_bodies_name(bodies, i - 1), brunt_bodies_name(bodies, i)) < 0);
        BRUNT_ASSERT(bodies->first_block[i + 1] - bodies->first_block[i] == ref->ops->block_count(ref));
        BRUNT_ASSERT(bodies->first_array[i + 1] - bodies->first_array[i] == arrays_of(ref));
        ref->ops->validate(ref);
    }
}
