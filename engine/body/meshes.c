// Bodies of finite elements, as bodies.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "body/bodies.h"
#include "body/fields.h"

static const char REAL_TYPE = sizeof(real) == 8 ? 'd' : 'f';

// Nodes of a part: a thread takes some fifty microseconds for them and their elements.
enum { PART = 2048 };

static int32_t parts(const brunt_body_ref *ref) { return 1 + (ref->fem->node_count - 1) / PART; }

static void bound(const brunt_fem_body *fem, int32_t begin, int32_t end, double low[3], double high[3]) {
    for (int32_t n = begin; n < end; n++) {
        const real *x = brunt_fem_node(fem, n);
        const bool left = fem->element_count && brunt_fem_removed(fem, n);
        for (int a = 0; !left && a < fem->dim; a++)
            low[a] = fmin(low[a], (double)x[a]), high[a] = fmax(high[a], (double)x[a]);
    }
}

static void measure(const brunt_body_ref *ref, int32_t part, brunt_body_measure *measure) {
    brunt_fem_body *fem = ref->fem;
    const int64_t count = parts(ref), nodes = fem->node_count, blocks = fem->block_count;
    const int32_t begin = (int32_t)(nodes * part / count), end = (int32_t)(nodes * (part + 1) / count);
    const brunt_fem_sums of = brunt_fem_audit(fem, begin, end);
    brunt_audit *a = &measure->sums;
    a->mass = of.mass, a->kinetic = of.kinetic;
    a->scale_linear = of.scale_linear, a->scale_angular = of.scale_angular;
    for (int k = 0; k < 3; k++)
        a->linear[k] = of.momentum[k], a->angular[k] = of.angular[k], a->moment[k] = of.first_moment[k];
    measure->energy = brunt_fem_energy(fem, (int32_t)(blocks * part / count), (int32_t)(blocks * (part + 1) / count));
    bound(fem, begin, end, measure->low, measure->high);
}

static uint64_t hash(const brunt_body_ref *ref) {
    const brunt_fem_body *fem = ref->fem;
    uint64_t h = (uint64_t)fem->index + 0x51ed27;
    for (size_t k = 0; k < (size_t)fem->node_count * BRUNT_FEM_NODE_REALS; k++) {
        uint64_t bits = 0;
        memcpy(&bits, &fem->node[k], sizeof(real));
        h = brunt_hash_add(h, bits);
    }
    for (int c = 0; c < fem->scalar_count; c++)
        for (int32_t s = 0; s < fem->slots; s++) {
            if (fem->element_id[s] < 0) continue;
            uint64_t bits = 0;
            memcpy(&bits, &fem->scalar[c][s], sizeof(real));
            h = brunt_hash_add(h, bits);
        }
    for (int32_t s = 0; fem->bonds && s < fem->slots; s++) h = brunt_hash_add(h, (uint64_t)(int64_t)fem->element_id[s]);
    return h;
}

static const char *name(const brunt_body_ref *ref) { return ref->fem->name; }
static const brunt_material *material(const brunt_body_ref *ref) { return &ref->fem->material; }
static int dim(const brunt_body_ref *ref) { return ref->fem->dim; }
static double fineness(const brunt_body_ref *ref) { return (double)ref->fem->mean_edge; }
static double first_step(const brunt_body_ref *ref, double cell) { return (void)cell, ref->fem->least_step; }
static double transit(const brunt_body_ref *ref, double cell) {
    const brunt_fem_body *fem = ref->fem;
    return (void)cell, fmax(fem->mean_edge, fem->scaled_edge) / (double)fem->material.wave_speed;
}
static void validate(const brunt_body_ref *ref) { brunt_fem_validate(ref->fem); }

static brunt_method method(const brunt_body_ref *ref) {
    return ref->fem->traits->membrane ? BRUNT_MEMBRANE : BRUNT_FEM;
}

static int64_t count(const brunt_body_ref *ref, brunt_location at) {
    return at == BRUNT_AT_NODES ? ref->fem->node_count : at == BRUNT_AT_ELEMENTS ? ref->fem->element_count : 0;
}

// Elements alone are stable up to dt_e. That is dt^2 omega^2 <= 4 of springs, but with dampers, of rates half a step
// behind, dt^2 omega^2 + 2 c dt <= 4, which at a share s of dt_e is at most 4 s: with loads 4 dt / dt_e + dt^2 q <= 4.
static double stable_step(const brunt_body_ref *ref, double cell, double around, double load) {
    (void)cell, (void)around;
    const double inverse = 1 / brunt_fem_blocks_step(ref->fem);
    return load > 0 ? 2 / (inverse + sqrt(inverse * inverse + load)) : 1 / inverse;
}

// ------------------------------------------------------------------------------------------ state

// Nodes; of bodies that erode the elements that there still are; fields.
enum { NODES = -1, ELEMENTS = -2 };

static int block_count(const brunt_body_ref *ref) {
    const brunt_fem_body *fem = ref->fem;
    int n = fem->bonds ? 2 : 1;
    for (int f = 0; f < fem->field_count; f++) n += fem->field[f].components > 0;
    return n;
}

// The field of a block, or what else it is.
static int field_of(const brunt_fem_body *fem, int block) {
    if (block-- == 0) return NODES;
    if (fem->bonds && block-- == 0) return ELEMENTS;
    int f = 0;
    while (!fem->field[f].components || block-- > 0) f++;
    return f;
}

static brunt_state_block block_info(const brunt_body_ref *ref, int index) {
    const brunt_fem_body *fem = ref->fem;
    const int f = field_of(fem, index);
    brunt_state_block block = {.type = f == ELEMENTS ? 'i' : REAL_TYPE};
    block.count = f == NODES      ? (int64_t)fem->node_count * BRUNT_FEM_NODE_REALS
                  : f == ELEMENTS ? brunt_fem_elements_count(fem)
                                  : (int64_t)fem->slots * fem->field[f].components;
    snprintf(block.name, sizeof block.name, "bodies/%s/%s", fem->name,
             f == NODES      ? "nodes"
             : f == ELEMENTS ? "elements"
                             : fem->field[f].name);
    return block;
}

static void block_get(const brunt_body_ref *ref, int block, void *out) {
    const brunt_fem_body *fem = ref->fem;
    const int f = field_of(fem, block);
    if (f == ELEMENTS) brunt_fem_elements_get(fem, out);
    if (f == NODES) memcpy(out, fem->node, (size_t)fem->node_count * BRUNT_FEM_NODE_REALS * sizeof(real));
    for (int c = 0; f >= 0 && c < fem->field[f].components; c++)
        memcpy((real *)out + (size_t)c * (size_t)fem->slots, fem->scalar[fem->field[f].first + c],
               (size_t)fem->slots * sizeof(real));
}

static int block_set(const brunt_body_ref *ref, int block, const void *in, int64_t count, brunt_error *error) {
    (void)count;
    brunt_fem_body *fem = ref->fem;
    const int f = field_of(fem, block);
    if (f == ELEMENTS && brunt_fem_elements_set(fem, in, error)) return BRUNT_BAD_INPUT;
    if (f == NODES) memcpy(fem->node, in, (size_t)fem->node_count * BRUNT_FEM_NODE_REALS * sizeof(real));
    for (int c = 0; f >= 0 && c < fem->field[f].components; c++)
        memcpy(fem->scalar[fem->field[f].first + c], (const real *)in + (size_t)c * (size_t)fem->slots,
               (size_t)fem->slots * sizeof(real));
    return BRUNT_OK;
}

const brunt_body_ops brunt_mesh_ops = BRUNT_BODY_OPS(mesh);
