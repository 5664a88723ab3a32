// Bodies of material points, as bodies.
//
// Particles are saved without padding in the order they lie in memory. That order is part of the state: sorting is
// stable, so a restored world sorts them into the same places and every later sum has the same bits.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/simd.h"
#include "body/bodies.h"
#include "body/fields.h"
#include "body/points.h"

static const char REAL_TYPE = sizeof(real) == 8 ? 'd' : 'f';

// Particles of a part, more or less: a thread takes some fifty microseconds for them.
enum { PART = 2048 };

static int32_t parts(const brunt_body_ref *ref) { return 1 + (int32_t)((ref->mpm->particles.count - 1) / PART); }

// Bounds of slots begin .. end.
static void bound(const brunt_particles *p, int64_t begin, int64_t end, double low[3], double high[3]) {
    real *const *x = p->scalar + p->field[BRUNT_FIELD_position].first;
    const int64_t whole = begin + (end - begin) / BRUNT_LANES * BRUNT_LANES;
    for (int a = 0; a < p->dim; a++) {
        lanes least = lanes_set(INFINITY), most = lanes_set(-INFINITY);
        for (int64_t s = begin; s < whole; s += BRUNT_LANES) {
            lane_mask real_one = {0}; // else padding, or left in the last step
            for (int l = 0; l < BRUNT_LANES; l++) real_one[l] = p->id[s + l] >= 0 ? -1 : 0;
            const lanes at = lanes_load(x[a] + s);
            least = lanes_min(lanes_select(real_one, at, least), least);
            most = lanes_max(lanes_select(real_one, at, most), most);
        }
        low[a] = fmin(low[a], (double)lanes_min_of(least)), high[a] = fmax(high[a], (double)lanes_max_of(most));
        for (int64_t s = whole; s < end; s++)
            if (p->id[s] >= 0) low[a] = fmin(low[a], (double)x[a][s]), high[a] = fmax(high[a], (double)x[a][s]);
    }
}

// The first slot of block b; past the last one that of what comes after it.
static int64_t first_slot(const brunt_body *body, int32_t b) {
    return b < body->grid.block_count ? body->grid.blocks[b].first : body->particles.slots;
}

// A part has whole blocks: how much room there is in these may be another after a restart.
static void measure(const brunt_body_ref *ref, int32_t part, brunt_body_measure *measure) {
    brunt_body *body = ref->mpm;
    const int64_t all = body->grid.block_count, count = parts(ref);
    const int32_t begin = (int32_t)(all * part / count), end = (int32_t)(all * (part + 1) / count);
    const int64_t first = part ? first_slot(body, begin) : 0, last = first_slot(body, end);
    measure->sums = brunt_slots_audit(body, NULL, first, last);
    measure->energy = brunt_body_energy(body, begin, end);
    bound(&body->particles, first, last, measure->low, measure->high);
}

static uint64_t hash(const brunt_body_ref *ref) {
    const brunt_particles *p = &ref->mpm->particles;
    uint64_t sum = 0;
    for (int64_t s = 0; s < p->slots; s++) {
        if (p->id[s] < 0) continue;
        uint64_t h = brunt_hash_add((uint64_t)ref->mpm->index, (uint64_t)p->id[s]);
        for (int k = 0; k < p->scalar_count; k++) {
            uint64_t bits = 0;
            memcpy(&bits, &p->scalar[k][s], sizeof(real));
            h = brunt_hash_add(h, bits);
        }
        sum += h;
    }
    return sum;
}

static const char *name(const brunt_body_ref *ref) { return ref->mpm->name; }
static const brunt_material *material(const brunt_body_ref *ref) { return &ref->mpm->material; }
static brunt_method method(const brunt_body_ref *ref) { return (void)ref, BRUNT_MPM; }
static int dim(const brunt_body_ref *ref) { return ref->mpm->particles.dim; }
static double fineness(const brunt_body_ref *ref) { return ref->mpm->spacing; }
static void validate(const brunt_body_ref *ref) { brunt_body_validate(ref->mpm); }

static int64_t count(const brunt_body_ref *ref, brunt_location at) {
    return at == BRUNT_AT_PARTICLES ? ref->mpm->particles.count : 0;
}

// Speeds are the greatest of the whole body, so that the step does not depend on how blocks cut it.
static double stable_step(const brunt_body_ref *ref, double cell, double around, double load) {
    (void)load;
    const brunt_body *body = ref->mpm;
    double wave = 0, speed = around;
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        wave = fmax(wave, (double)body->report[b].wave_speed);
        speed = fmax(speed, (double)body->report[b].speed);
        if (isnan(body->report[b].wave_speed) || isnan(body->report[b].speed)) return NAN;
    }
    return wave + speed > 0 ? cell / (wave + speed) : INFINITY;
}

static double first_step(const brunt_body_ref *ref, double cell) {
    return cell / (double)ref->mpm->material.wave_speed;
}
static double transit(const brunt_body_ref *ref, double cell) { return first_step(ref, cell); }

// ------------------------------------------------------------------------------------------ state: ids, then fields

static int block_count(const brunt_body_ref *ref) {
    const brunt_particles *p = &ref->mpm->particles;
    int n = 1;
    for (int f = 0; f < p->field_count; f++) n += p->field[f].components > 0;
    return n;
}

// The field of a block, NULL: the ids.
static const brunt_particle_field *field_of(const brunt_particles *p, int block) {
    for (int f = 0; block && f < p->field_count; f++)
        if (p->field[f].components && --block == 0) return &p->field[f];
    return NULL;
}

static brunt_state_block block_info(const brunt_body_ref *ref, int index) {
    const brunt_particles *p = &ref->mpm->particles;
    const brunt_particle_field *field = field_of(p, index);
    brunt_state_block block = {.type = field ? REAL_TYPE : 'i', .count = p->count * (field ? field->components : 1)};
    snprintf(block.name, sizeof block.name, "bodies/%s/%s", ref->mpm->name, field ? field->name : "id");
    return block;
}

static void block_get(const brunt_body_ref *ref, int block, void *out) {
    const brunt_particles *p = &ref->mpm->particles;
    const brunt_particle_field *field = field_of(p, block);
    int64_t n = 0;
    for (int c = 0; c < (field ? field->components : 1); c++)
        for (int64_t s = 0; s < p->slots; s++) {
            if (p->id[s] < 0) continue;
            if (field)
                ((real *)out)[n++] = p->scalar[field->first + c][s];
            else
                ((int64_t *)out)[n++] = p->id[s];
        }
}

// Particles without gaps between them, in their order; new ones at the end are all 0. Their grid is out of date then.
void brunt_points_close_ranks(brunt_particles *p, int64_t count) {
    int64_t n = 0;
    for (int64_t s = 0; s < p->slots; s++) {
        if (p->id[s] < 0) continue;
        for (int k = 0; k < p->scalar_count && n < s; k++) p->scalar[k][n] = p->scalar[k][s];
        p->id[n++] = p->id[s];
    }
    for (int k = 0; k < p->scalar_count; k++)
        for (int64_t s = n; s < count; s++) p->scalar[k][s] = 0;
    p->count = p->slots = count;
    p->holes = false;
}

static int set_ids(brunt_particles *p, const char *name, const int64_t *id, int64_t count, brunt_error *error) {
    bool *there;
    if (BRUNT_NEW(there, p->made + 1, "marks of particles", error)) return BRUNT_FAILED;
    int64_t s = 0;
    for (; s < count && id[s] >= 0 && id[s] < p->made && !there[id[s]]; s++) there[id[s]] = true;
    brunt_free(there);
    if (s < count)
        return brunt_fail(error, BRUNT_BAD_INPUT, "the state block '%s' holds the id %lld, which is %s", name,
                          (long long)id[s], id[s] >= 0 && id[s] < p->made ? "there twice" : "out of range");
    brunt_points_close_ranks(p, count);
    memcpy(p->id, id, (size_t)count * sizeof *id);
    return BRUNT_OK;
}

static void set_field(brunt_particles *p, const brunt_particle_field *field, const real *in) {
    for (int c = 0; c < field->components; c++)
        for (int64_t s = 0; s < p->slots; s++)
            if (p->id[s] >= 0) p->scalar[field->first + c][s] = *in++;
}

static int block_set(const brunt_body_ref *ref, int block, const void *in, int64_t count, brunt_error *error) {
    brunt_particles *p = &ref->mpm->particles;
    if (!block) return set_ids(p, block_info(ref, block).name, in, count, error);
    set_field(p, field_of(p, block), in);
    return BRUNT_OK;
}

const brunt_body_ops brunt_points_ops = BRUNT_BODY_OPS(points);
