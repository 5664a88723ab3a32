// Elements that leave a body: taken out of their blocks, so that what is left goes on as if they had never been there.
//
// Blocks keep their slots, elements never change blocks. A gap is filled by the block's last element, which keeps the
// loops of the kernels without branches, and their cost that of the elements there still are.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fem/kernel.h"
#include "fem/layout.h"
#include "materials/log_strain.h"
#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

static int32_t block_end(const brunt_fem_body *body, int32_t b) {
    return b + 1 < body->block_count ? body->block[b + 1].first : body->slots;
}

static int32_t block_of(const brunt_fem_body *body, int32_t slot) {
    int32_t low = 0, high = body->block_count;
    while (high - low > 1) {
        int32_t middle = low + (high - low) / 2;
        if (body->block[middle].first <= slot)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void count_bonds(brunt_fem_body *body) {
    const int nodes = body->traits->nodes;
    memset(body->bonds, 0, (size_t)body->node_count * sizeof *body->bonds);
    for (int32_t s = 0; s < body->slots; s++)
        for (int a = 0; body->element_id[s] >= 0 && a < nodes; a++)
            body->bonds[body->element_node[(int64_t)s * nodes + a]]++;
}

int brunt_fem_prepare_erosion(brunt_fem_body *body, bool inverted, brunt_error *error) {
    body->mesh_elements = body->element_count;
    body->erodes_inverted = inverted;
    if (BRUNT_NEW(body->bonds, body->node_count, "nodes of a mesh that erodes", error) ||
        BRUNT_NEW(body->mark, body->slots, "marks of elements of a mesh that erodes", error) ||
        BRUNT_NEW(body->rank, body->mesh_elements, "ranks of elements of a mesh that erodes", error))
        return BRUNT_FAILED;
    count_bonds(body);
    return BRUNT_OK;
}

void brunt_fem_ranks(brunt_fem_body *body) {
    if (body->ranked) return;
    memset(body->rank, 0, (size_t)body->mesh_elements * sizeof *body->rank);
    for (int32_t s = 0; s < body->slots; s++)
        if (body->element_id[s] >= 0) body->rank[body->element_id[s]] = 1;
    for (int32_t e = 0, next = 0; e < body->mesh_elements; e++) body->rank[e] = body->rank[e] ? next++ : -1;
    body->ranked = true;
}

// ------------------------------------------------------------------------------------------ taking out

static void copy_slot(brunt_fem_body *body, int32_t to, int32_t from) {
    const size_t nodes = (size_t)body->traits->nodes;
    for (int c = 0; c < body->scalar_count; c++) body->scalar[c][to] = body->scalar[c][from];
    memcpy(body->element_node + (size_t)to * nodes, body->element_node + (size_t)from * nodes,
           nodes * sizeof *body->element_node);
    memcpy(body->local + (size_t)to * nodes, body->local + (size_t)from * nodes, nodes * sizeof *body->local);
    body->element_id[to] = body->element_id[from];
    body->mark[to] = body->mark[from];
}

static void empty_slot(brunt_fem_body *body, int32_t slot) {
    brunt_element_scalars(body, BRUNT_ELEMENT_reference_volume)[0][slot] = 0;
    body->element_id[slot] = -1;
    body->mark[slot] = BRUNT_MARK_NONE;
}

// The rest of the last vector: copies of the last element without volume.
static void pad(brunt_fem_body *body, int32_t b) {
    const int32_t end = body->block[b].first + body->block[b].count;
    for (int32_t s = end; s % BRUNT_LANES != 0; s++) {
        copy_slot(body, s, end - 1);
        empty_slot(body, s);
    }
}

// From the last of a block to the first, so that what moves into a gap stays.
void brunt_fem_remove(brunt_fem_body *body, const int32_t *slots, int32_t count, brunt_fem_workspace *work) {
    const int nodes = body->traits->nodes;
    for (int32_t k = count - 1; k >= 0;) {
        const int32_t b = block_of(body, slots[k]);
        brunt_fem_block *block = &body->block[b];
        for (; k >= 0 && slots[k] >= block->first; k--) {
            const int32_t last = block->first + --block->count;
            for (int a = 0; a < nodes; a++) body->bonds[body->element_node[(int64_t)slots[k] * nodes + a]]--;
            if (slots[k] != last) copy_slot(body, slots[k], last);
            empty_slot(body, last);
            body->element_count--;
        }
        pad(body, b);
        const int32_t marked = body->report[b].marked; // until the sums over blocks have been made anew
        body->element->forces(body, b, 0, work, &body->report[b]);
        body->report[b].marked = marked;
    }
    body->ranked = false;
}

double brunt_fem_stress_work(const brunt_fem_body *body, int32_t block, double dt) {
    return fem_stress_work(body, &body->block[block], (real)dt);
}

// ------------------------------------------------------------------------------------------ strain

// F of the elements from `slot` on in three dimensions; of a membrane, its stretch.
static void deformation(brunt_fem_body *body, int32_t slot, lanes F[9]) {
    real *const *field = brunt_element_scalars(body, BRUNT_ELEMENT_deformation_gradient);
    const int dim = body->point_dim;
    for (int c = 0; c < 9; c++) F[c] = lanes_set(c == 8);
    if (body->traits->membrane)
        F[8] = lanes_load(brunt_element_scalars(body, BRUNT_ELEMENT_thickness_stretch)[0] + slot);
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) F[3 * r + c] = lanes_load(field[r * dim + c] + slot);
}

// Whether any element from `begin` to `end` may be strained to the limit.
static bool may_be_strained(brunt_fem_body *body, int32_t begin, int32_t end, double limit) {
    const real cube = log_strain_cube(limit);
    lane_mask far = lanes_set(-1) < 0;
    for (int32_t s = begin; s < end; s += BRUNT_LANES) {
        lanes F[9];
        deformation(body, s, F);
        far &= log_strain_excess(F, cube) < 0; // not of what is no number
    }
    return lanes_any(~far);
}

void brunt_fem_mark_strained(brunt_fem_body *body, int32_t b, double limit) {
    const brunt_fem_block *block = &body->block[b];
    const int32_t end = block->first + block->count;
    if (!body->traits->membrane &&
        log_strain_all_near(body->point_dim, brunt_element_scalars(body, BRUNT_ELEMENT_deformation_gradient),
                            block->first, end, log_strain_near(limit)))
        return;
    if (!may_be_strained(body, block->first, end, limit)) return;
    for (int32_t s = block->first; s < end; s += BRUNT_LANES) {
        lanes F[9];
        deformation(body, s, F);
        const lanes bound = log_strain_bound(F);
        if (!lanes_any(bound >= (real)(limit * limit * (1 - 1e-5)))) continue;
        for (int32_t l = 0; l < BRUNT_LANES && s + l < end; l++) {
            double one[9];
            for (int c = 0; c < 9; c++) one[c] = (double)F[c][l];
            if (body->mark[s + l] != BRUNT_MARK_NONE || !(equivalent_log_strain(one) >= limit)) continue;
            body->mark[s + l] = BRUNT_MARK_STRAINED;
            body->report[b].marked++;
        }
    }
}

// ------------------------------------------------------------------------------------------ elements of a state

int64_t brunt_fem_elements_count(const brunt_fem_body *body) {
    return (int64_t)body->slots * (1 + body->traits->nodes);
}

void brunt_fem_elements_get(const brunt_fem_body *body, int64_t *out) {
    const int64_t corners = (int64_t)body->slots * body->traits->nodes;
    for (int32_t s = 0; s < body->slots; s++) *out++ = body->element_id[s];
    for (int64_t k = 0; k < corners; k++) *out++ = body->element_node[k];
}

// Place of a node in its block, -1 when it is not of the block.
static int32_t place_in_block(const brunt_fem_body *body, const brunt_fem_block *block, int64_t node) {
    const int32_t *list = body->block_node + block->node_first;
    int32_t low = 0, high = block->node_count;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (list[middle] < node)
            low = middle + 1;
        else
            high = middle;
    }
    return low < block->node_count && list[low] == node ? low : BRUNT_NONE;
}

// Whether they are elements of this body.
static bool check_elements(brunt_fem_body *body, const int64_t *id, const int64_t *corner) {
    const int nodes = body->traits->nodes;
    memset(body->rank, 0, (size_t)body->mesh_elements * sizeof *body->rank);
    body->ranked = false;
    for (int32_t b = 0; b < body->block_count; b++) {
        bool ended = false;
        for (int32_t s = body->block[b].first; s < block_end(body, b); s++) {
            ended = ended || id[s] < 0;
            if (id[s] < -1 || id[s] >= body->mesh_elements || (ended && id[s] >= 0)) return false;
            if (id[s] >= 0 && body->rank[id[s]]++) return false;
            for (int a = 0; a < nodes; a++)
                if (place_in_block(body, &body->block[b], corner[(int64_t)s * nodes + a]) < 0) return false;
        }
    }
    return true;
}

int brunt_fem_elements_set(brunt_fem_body *body, const int64_t *in, brunt_error *error) {
    const int nodes = body->traits->nodes;
    const int64_t *corner = in + body->slots;
    if (!check_elements(body, in, corner))
        return brunt_fail(error, BRUNT_BAD_INPUT, "the state block 'bodies/%s/elements' is not of this mesh",
                          body->name);
    body->element_count = 0;
    for (int32_t b = 0; b < body->block_count; b++) {
        brunt_fem_block *block = &body->block[b];
        block->count = 0;
        for (int32_t s = block->first; s < block_end(body, b); s++) {
            body->element_id[s] = (int32_t)in[s];
            body->mark[s] = BRUNT_MARK_NONE;
            block->count += in[s] >= 0;
            for (int64_t k = (int64_t)s * nodes; k < (int64_t)(s + 1) * nodes; k++) {
                body->element_node[k] = (int32_t)corner[k];
                body->local[k] = (uint16_t)place_in_block(body, block, corner[k]);
            }
        }
        body->element_count += block->count;
        body->report[b] = (brunt_fem_report){.bad = -1, .stable_step = INFINITY}; // of one that is empty it stays
    }
    count_bonds(body);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ one by itself

struct brunt_fem_single {
    brunt_fem_body body;
    brunt_fem_block block;
    brunt_fem_report report;
    real node[BRUNT_ELEMENT_NODES * BRUNT_FEM_NODE_REALS], start[BRUNT_ELEMENT_NODES * 4],
        partial[BRUNT_ELEMENT_NODES * 4];
    int32_t block_node[BRUNT_ELEMENT_NODES], id[BRUNT_LANES], corner[BRUNT_LANES * BRUNT_ELEMENT_NODES];
    uint16_t local[BRUNT_LANES * BRUNT_ELEMENT_NODES];
    void *slab;
};

brunt_fem_single *brunt_fem_single_make(const brunt_fem_body *body) {
    brunt_fem_single *one = brunt_alloc(sizeof *one);
    real *slab = brunt_alloc((size_t)body->scalar_count * BRUNT_LANES * sizeof *slab);
    if (!one || !slab) {
        brunt_free(one);
        brunt_free(slab);
        return NULL;
    }
    const int nodes = body->traits->nodes;
    one->slab = slab;
    one->body = *body;
    brunt_fem_body *own = &one->body;
    own->node = one->node, own->start = one->start, own->partial = one->partial;
    own->element_id = one->id, own->element_node = one->corner, own->local = one->local;
    own->block = &one->block, own->block_node = one->block_node, own->report = &one->report;
    own->node_count = nodes, own->element_count = own->block_count = 1, own->slots = BRUNT_LANES;
    own->block_nodes = (nodes + 3) / 4 * 4, own->partial_count = nodes;
    own->held = NULL, own->load = NULL, own->bonds = NULL, own->mark = NULL, own->rank = NULL;
    own->erodes_inverted = false;
    for (int c = 0; c < body->scalar_count; c++) own->scalar[c] = slab + (size_t)c * BRUNT_LANES;
    for (int l = 0; l < BRUNT_LANES; l++) {
        one->id[l] = l == 0 ? 0 : -1;
        for (int a = 0; a < nodes; a++) one->corner[l * nodes + a] = one->local[l * nodes + a] = (uint16_t)a;
    }
    for (int a = 0; a < nodes; a++) one->block_node[a] = a;
    return one;
}

void brunt_fem_single_free(brunt_fem_single *single) {
    if (!single) return;
    brunt_free(single->slab);
    brunt_free(single);
}

static void load_single(brunt_fem_single *one, const brunt_fem_body *body, int32_t slot, double back) {
    const int nodes = body->traits->nodes;
    for (int c = 0; c < body->scalar_count; c++)
        for (int l = 0; l < BRUNT_LANES; l++) one->body.scalar[c][l] = body->scalar[c][slot];
    real *volume = brunt_element_scalars(&one->body, BRUNT_ELEMENT_reference_volume)[0];
    for (int l = 1; l < BRUNT_LANES; l++) volume[l] = 0;
    for (int a = 0; a < nodes; a++) {
        const int32_t n = body->element_node[(int64_t)slot * nodes + a];
        real *node = brunt_fem_node(&one->body, a);
        memcpy(node, brunt_fem_node(body, n), BRUNT_FEM_NODE_REALS * sizeof *node);
        memcpy(one->start + 4 * a, body->start + 4 * (size_t)n, 4 * sizeof(real));
        for (int i = 0; i < 3; i++) node[i] -= (real)back * node[BRUNT_FEM_V + i];
    }
}

brunt_fem_share brunt_fem_single_look(brunt_fem_single *one, const brunt_fem_body *body, int32_t slot, double back,
                                      double dt, brunt_fem_workspace *work) {
    const int32_t b = block_of(body, slot);
    load_single(one, body, slot, back);
    one->block = (brunt_fem_block){.count = 1, .node_count = body->traits->nodes, .length = body->block[b].length};
    one->report = (brunt_fem_report){.bad = -1, .wave_speed = body->report[b].wave_speed};
    body->element->forces(&one->body, 0, 0, work, &one->report);
    return (brunt_fem_share){.energy = brunt_fem_energy(&one->body, 0, 1),
                             .hourglass_stored = one->report.hourglass_stored,
                             .half_work = 0.5 * brunt_fem_stress_work(&one->body, 0, dt),
                             .stable_step = one->report.stable_step};
}
