// Solid elements with one point, in two and three dimensions.
#include "base/volume_root.h"
#include "fem/potential_parts.h"

// CALL(dimensions, nodes) with those of a body's elements as literals, for functions that go over them.
#define SIZE(dim, nodes) ((dim)*16 + (nodes))
#define BY_SIZE(body, CALL)                                                                                            \
    switch (SIZE((body)->dim, (body)->traits->nodes)) {                                                                \
    case SIZE(2, 3): CALL(2, 3); break;                                                                                \
    case SIZE(2, 4): CALL(2, 4); break;                                                                                \
    case SIZE(3, 4): CALL(3, 4); break;                                                                                \
    case SIZE(3, 8): CALL(3, 8); break;                                                                                \
    default: BRUNT_ASSERT(!"elements of this size");                                                                   \
    }

// --------------------------------------------------------------------------------- making

static void shape_of(brunt_fem_potential *p, int32_t slot) {
    const brunt_fem_body *body = p->body;
    const int n = p->nodes, dim = p->dim;
    double x[NODE_LIMIT][3] = {{0}}, square = 0;
    real b[NODE_LIMIT][3];
    for (int a = 0; a < n; a++)
        for (int i = 0; i < dim; i++)
            x[a][i] = (double)body->start[(size_t)body->element_node[(size_t)slot * n + a] * 4 + i];
    body->element->gradient((const double(*)[3])x, b);
    const double volume = body->element->volume((const double(*)[3])x);
    for (int a = 0; a < n; a++)
        for (int i = 0; i < dim; i++) {
            p->b[a * dim + i][slot] = b[a][i];
            square += (double)b[a][i] * (double)b[a][i];
        }
    for (int m = 0; m < p->modes; m++) {
        const int8_t *mode = body->element->hourglass[m];
        double carried[3] = {0};
        for (int a = 0; a < n; a++)
            for (int i = 0; i < dim; i++) carried[i] += mode[a] * (x[a][i] - x[0][i]);
        for (int a = 0; a < n; a++) {
            double gamma = mode[a];
            for (int i = 0; i < dim; i++) gamma -= carried[i] * (double)b[a][i];
            p->gamma[m * n + a][slot] = (real)gamma;
        }
    }
    const double c0 = (double)body->material.wave_speed, modulus = (double)body->material.density * c0 * c0;
    if (p->modes) // k n = coefficient rho c0^2 V sum b.b / dim (element.inc)
        p->spring[slot] = (real)((double)body->hourglass_coefficient * modulus * volume * square / (dim * n));
}

static int make(brunt_fem_potential *p, brunt_error *error) {
    const int shapes = p->nodes * p->dim, shares = p->nodes * p->modes, tangents = p->tangents;
    const size_t stride = ((size_t)p->body->slots + 7) / 8 * 8 + 8;
    p->slab_bytes = (size_t)(2 * shapes + shares + tangents + 1) * stride * sizeof(real);
    if (BRUNT_NEW(p->slab, p->slab_bytes / sizeof *p->slab, "numbers of elements of a mesh", error))
        return BRUNT_FAILED;
    real *at = p->slab;
    for (int k = 0; k < shapes; k++, at += stride) p->b[k] = at;
    for (int k = 0; k < shapes; k++, at += stride) p->g[k] = at;
    for (int k = 0; k < shares; k++, at += stride) p->gamma[k] = at;
    for (int k = 0; k < tangents; k++, at += stride) p->tangent[k] = at;
    p->spring = at;
    for (int32_t s = 0; s < p->body->slots; s++) shape_of(p, s);
    return BRUNT_OK;
}

// --------------------------------------------------------------------------------- a tile of elements

typedef struct fem_tile {
    real F[9][FEM_TILE], f[9][FEM_TILE], density[FEM_TILE], stress[9][FEM_TILE];
    int32_t elements;       // that are not padding
    lanes value, magnitude; // of the block's energy so far
} __attribute__((aligned(64))) fem_tile;

// Values of a field of the body's nodes, dim each, at the nodes of the elements of a vector.
BRUNT_INLINE void nodal_values(int dim, int nodes, const brunt_fem_potential *p, const double *field, int64_t slot,
                               lanes out[NODE_LIMIT][3]) {
    const int32_t *node = p->body->element_node + slot * nodes;
    for (int a = 0; a < nodes; a++) {
        real column[3][BRUNT_LANES] __attribute__((aligned(64)));
        for (int l = 0; l < BRUNT_LANES; l++)
            for (int i = 0; i < dim; i++) column[i][l] = (real)field[(size_t)node[l * nodes + a] * (size_t)dim + i];
        for (int i = 0; i < dim; i++) out[a][i] = lanes_load(column[i]);
    }
}

// sum_a u_a (x) b_a
BRUNT_INLINE void mean_slope(int dim, int nodes, const brunt_fem_potential *p, int64_t slot,
                             const lanes u[NODE_LIMIT][3], lanes H[9]) {
    for (int j = 0; j < dim; j++)
        for (int i = 0; i < dim; i++) H[i * dim + j] = lanes_set(0);
    for (int a = 0; a < nodes; a++)
        for (int j = 0; j < dim; j++) {
            const lanes b = lanes_load(p->b[a * dim + j] + slot);
            for (int i = 0; i < dim; i++) H[i * dim + j] += u[a][i] * b;
        }
}

// F, and with a history f = F F_old^-1, of a vector of elements, number `at` of the tile.
BRUNT_INLINE void deform(int dim, const brunt_fem_potential *p, int64_t slot, const lanes H[9], fem_tile *tile,
                         int32_t at) {
    lanes F[9], old[9], inverse[9], f[9];
    for (int c = 0; c < dim * dim; c++) {
        F[c] = H[c] + (real)(c % (dim + 1) == 0);
        lanes_store(tile->F[c] + at, F[c]);
    }
    if (!p->history) return;
    real **was = brunt_element_scalars(p->body, BRUNT_ELEMENT_deformation_gradient);
    for (int c = 0; c < dim * dim; c++) old[c] = lanes_load(was[c] + slot);
    inverse_matrix(dim, old, inverse);
    multiply(dim, F, inverse, f);
    for (int c = 0; c < dim * dim; c++) lanes_store(tile->f[c] + at, f[c]);
}

BRUNT_INLINE void deform_tile(int dim, int nodes, const brunt_fem_potential *p, int64_t slot, int32_t count,
                              fem_tile *tile) {
    for (int32_t s = 0; s < count; s += BRUNT_LANES) {
        lanes u[NODE_LIMIT][3], H[9];
        nodal_values(dim, nodes, p, p->displacement, slot + s, u);
        mean_slope(dim, nodes, p, slot + s, (const lanes(*)[3])u, H);
        deform(dim, p, slot + s, H, tile, s);
    }
}

// The tile's trial of each component: `count` elements from `slot` on.
static void trial_points(const brunt_fem_potential *p, int64_t slot, int32_t count, fem_tile *tile,
                         brunt_trial_points trial[BRUNT_COMPONENTS]) {
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        trial[k] = (brunt_trial_points){.count = count, .dim = p->dim, .dt = p->dt, .rule = p->rule};
        if (!p->body->material.model[k]) continue;
        const brunt_material_points points = brunt_fem_points(p->body, (brunt_component)k, slot, count);
        for (int c = 0; c < p->dim * p->dim; c++) trial[k].F[c] = tile->F[c], trial[k].f[c] = tile->f[c];
        for (int s = 0; s < BRUNT_MAX_STATE; s++) trial[k].state[s] = points.state[s];
        for (int c = 0; c < BRUNT_SYMMETRIC(p->dim); c++) trial[k].old_stress[c] = points.stress[c];
        trial[k].volume = points.volume;
    }
}

BRUNT_INLINE lanes volumes(const brunt_fem_potential *p, int64_t slot) {
    return lanes_load(brunt_element_scalars(p->body, BRUNT_ELEMENT_reference_volume)[0] + slot);
}

// q = gamma . u of an hourglass mode, and k, 0 of padding.
BRUNT_INLINE lanes hourglass(int dim, int nodes, const brunt_fem_potential *p, int64_t slot, int mode,
                             const lanes u[NODE_LIMIT][3], lanes q[3]) {
    for (int i = 0; i < dim; i++) q[i] = lanes_set(0);
    for (int a = 0; a < nodes; a++) {
        const lanes gamma = lanes_load(p->gamma[mode * nodes + a] + slot);
        for (int i = 0; i < dim; i++) q[i] += gamma * u[a][i];
    }
    return lanes_select(volumes(p, slot) > 0, lanes_load(p->spring + slot), lanes_set(0));
}

BRUNT_INLINE void add_energies(int dim, int nodes, const brunt_fem_potential *p, int64_t slot, fem_tile *tile,
                               int32_t at) {
    const lanes volume = volumes(p, slot);
    const lane_mask there = volume > 0;
    lanes energy = lanes_select(there, volume * lanes_load(tile->density + at), lanes_set(0));
    tile->value += energy, tile->magnitude += lanes_abs(energy);
    if (!p->modes) return;
    lanes u[NODE_LIMIT][3], q[3];
    nodal_values(dim, nodes, p, p->displacement, slot, u);
    for (int m = 0; m < p->modes; m++) {
        const lanes k = hourglass(dim, nodes, p, slot, m, (const lanes(*)[3])u, q);
        energy = (real)0.5 * k * dot(dim, q, q);
        tile->value += energy, tile->magnitude += energy;
    }
}

// F^-T b_a of all nodes.
BRUNT_INLINE void spatial_gradients(int dim, int nodes, const brunt_fem_potential *p, int64_t slot,
                                    const fem_tile *tile, int32_t at, lanes g[NODE_LIMIT][3]) {
    lanes F[9], inverse[9];
    for (int c = 0; c < dim * dim; c++) F[c] = lanes_load(tile->F[c] + at);
    inverse_matrix(dim, F, inverse);
    for (int a = 0; a < nodes; a++)
        for (int i = 0; i < dim; i++) {
            g[a][i] = lanes_load(p->b[a * dim] + slot) * inverse[i];
            for (int j = 1; j < dim; j++) g[a][i] += lanes_load(p->b[a * dim + j] + slot) * inverse[j * dim + i];
        }
}

// Adds the gradient of a vector of elements to the block's records.
BRUNT_INLINE void add_forces(int dim, int nodes, const brunt_fem_potential *p, int64_t slot, const fem_tile *tile,
                             int32_t at, real *partial) {
    const int32_t rest = tile->elements - at, some = rest < BRUNT_LANES ? rest : BRUNT_LANES;
    lanes g[NODE_LIMIT][3], f[NODE_LIMIT][3], tau[9];
    const lanes volume = volumes(p, slot);
    spatial_gradients(dim, nodes, p, slot, tile, at, g);
    for (int c = 0; c < dim * dim; c++) tau[c] = volume * lanes_load(tile->stress[c] + at);
    for (int a = 0; a < nodes; a++)
        for (int i = 0; i < dim; i++) f[a][i] = dot(dim, tau + i * dim, g[a]);
    if (p->modes) {
        lanes u[NODE_LIMIT][3], q[3];
        nodal_values(dim, nodes, p, p->displacement, slot, u);
        for (int m = 0; m < p->modes; m++) {
            const lanes k = hourglass(dim, nodes, p, slot, m, (const lanes(*)[3])u, q);
            for (int a = 0; a < nodes; a++)
                for (int i = 0; i < dim; i++) f[a][i] += k * lanes_load(p->gamma[m * nodes + a] + slot) * q[i];
        }
    }
    for (int a = 0; a < nodes; a++) add_to_records(partial, p->body->local + slot * nodes + a, nodes, some, dim, f[a]);
}

// Elements of one block.
BRUNT_INLINE void evaluate(int dim, int nodes, const fem_call *call, int32_t b) {
    brunt_fem_potential *p = call->p;
    const brunt_fem_block *block = &p->body->block[b];
    const int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    real *partial = p->force + (size_t)block->node_first * 4;
    if (call->wanted == FEM_GRADIENT) memset(partial, 0, (size_t)block->node_count * 4 * sizeof *partial);
    fem_tile tile;
    tile.value = tile.magnitude = lanes_set(0);
    for (int32_t first = 0; first < padded; first += FEM_TILE) {
        const int32_t count = padded - first < FEM_TILE ? padded - first : FEM_TILE;
        const int64_t slot = (int64_t)block->first + first;
        tile.elements = block->count - first;
        deform_tile(dim, nodes, p, slot, count, &tile);
        brunt_trial_points trial[BRUNT_COMPONENTS];
        trial_points(p, slot, count, &tile, trial);
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            if (call->wanted == FEM_ENERGY) trial[k].density = tile.density;
            for (int c = 0; c < dim * dim && call->wanted == FEM_GRADIENT; c++) trial[k].stress[c] = tile.stress[c];
            for (int c = 0; c < p->tangents && call->wanted == FEM_TANGENT; c++)
                trial[k].tangent[c] = p->tangent[c] + slot;
        }
        brunt_material_respond(&p->body->material, trial);
        if (call->wanted == FEM_TANGENT && call->project) brunt_material_project(&p->body->material, trial);
        for (int32_t s = 0; s < count; s += BRUNT_LANES) {
            if (call->wanted == FEM_ENERGY) add_energies(dim, nodes, p, slot + s, &tile, s);
            if (call->wanted == FEM_GRADIENT) add_forces(dim, nodes, p, slot + s, &tile, s, partial);
            if (call->wanted != FEM_TANGENT) continue;
            lanes g[NODE_LIMIT][3];
            spatial_gradients(dim, nodes, p, slot + s, &tile, s, g);
            for (int a = 0; a < nodes; a++)
                for (int i = 0; i < dim; i++) lanes_store(p->g[a * dim + i] + slot + s, g[a][i]);
        }
    }
    p->energy[b] =
        (brunt_energy_sum){.value = (double)lanes_sum(tile.value), .magnitude = (double)lanes_sum(tile.magnitude)};
}

// Along u + t p the deformation gradient is F + t D: its J is a polynomial in t. The smallest of the elements' steps.
BRUNT_INLINE void limit_of(int dim, int nodes, const fem_call *call, int32_t b) {
    brunt_fem_potential *p = call->p;
    const brunt_fem_block *block = &p->body->block[b];
    double least = call->largest;
    for (int32_t at = 0; at < block->count; at += BRUNT_LANES) {
        const int64_t slot = (int64_t)block->first + at;
        lanes u[NODE_LIMIT][3], F[9], D[9];
        nodal_values(dim, nodes, p, p->displacement, slot, u);
        mean_slope(dim, nodes, p, slot, (const lanes(*)[3])u, F);
        for (int c = 0; c < dim; c++) F[c * (dim + 1)] += 1;
        nodal_values(dim, nodes, p, p->way, slot, u);
        mean_slope(dim, nodes, p, slot, (const lanes(*)[3])u, D);
        least = least_step_to_volume(dim, F, D, least);
    }
    p->limit[b] = least;
}

// Of one element: V g_a . a . g_b, and k gamma_a gamma_b of its hourglass modes.
BRUNT_INLINE void element_hessian(int dim, int nodes, const brunt_fem_potential *p, int64_t slot, double *dense) {
    const int rows = dim * dim, size = dim * nodes;
    const double volume = (double)brunt_element_scalars(p->body, BRUNT_ELEMENT_reference_volume)[0][slot];
    double a[9][9], g[NODE_LIMIT][3];
    const bool whole = p->body->material.differences;
    for (int m = 0; m < rows; m++)
        for (int n = 0; n < rows; n++)
            a[m][n] = volume * (double)p->tangent[brunt_tangent_place(whole, dim, m, n)][slot];
    for (int k = 0; k < nodes; k++)
        for (int i = 0; i < dim; i++) g[k][i] = (double)p->g[k * dim + i][slot];
    for (int B = 0; B < nodes; B++) {
        double T[9][3]; // a . g_B: row (i, a), column j
        for (int m = 0; m < rows; m++)
            for (int j = 0; j < dim; j++) {
                T[m][j] = 0;
                for (int b = 0; b < dim; b++) T[m][j] += a[m][j * dim + b] * g[B][b];
            }
        for (int A = 0; A < nodes; A++)
            for (int i = 0; i < dim; i++)
                for (int j = 0; j < dim; j++) {
                    double sum = 0;
                    for (int c = 0; c < dim; c++) sum += g[A][c] * T[i * dim + c][j];
                    dense[(A * dim + i) * size + B * dim + j] = sum;
                }
    }
    for (int m = 0; m < p->modes; m++)
        for (int A = 0; A < nodes; A++)
            for (int B = 0; B < nodes; B++) {
                const double k = (double)p->spring[slot] * (double)p->gamma[m * nodes + A][slot] *
                                 (double)p->gamma[m * nodes + B][slot];
                for (int i = 0; i < dim; i++) dense[(A * dim + i) * size + B * dim + i] += k;
            }
}

// Of one vector of elements: V a : (sum_b x_b (x) g_b) . g_a, and k gamma_a (gamma . x).
BRUNT_INLINE void add_product(int dim, int nodes, const fem_call *call, int64_t slot, int32_t some, real *partial) {
    const brunt_fem_potential *p = call->p;
    const lanes volume = volumes(p, slot);
    lanes x[NODE_LIMIT][3], f[NODE_LIMIT][3], H[9], T[9];
    nodal_values(dim, nodes, p, call->way, slot, x);
    for (int c = 0; c < dim * dim; c++) H[c] = lanes_set(0);
    for (int a = 0; a < nodes; a++)
        for (int j = 0; j < dim; j++) {
            const lanes g = lanes_load(p->g[a * dim + j] + slot);
            for (int i = 0; i < dim; i++) H[i * dim + j] += x[a][i] * g;
        }
    for (int m = 0; m < dim * dim; m++) {
        lanes sum = lanes_set(0);
        for (int n = 0; n < dim * dim; n++)
            sum += lanes_load(p->tangent[brunt_tangent_place(false, dim, m, n)] + slot) * H[n];
        T[m] = volume * sum;
    }
    for (int a = 0; a < nodes; a++)
        for (int i = 0; i < dim; i++) {
            f[a][i] = lanes_set(0);
            for (int j = 0; j < dim; j++) f[a][i] += T[i * dim + j] * lanes_load(p->g[a * dim + j] + slot);
        }
    for (int m = 0; m < p->modes; m++) {
        lanes q[3];
        const lanes k = hourglass(dim, nodes, p, slot, m, (const lanes(*)[3])x, q);
        for (int a = 0; a < nodes; a++)
            for (int i = 0; i < dim; i++) f[a][i] += k * lanes_load(p->gamma[m * nodes + a] + slot) * q[i];
    }
    for (int a = 0; a < nodes; a++) add_to_records(partial, p->body->local + slot * nodes + a, nodes, some, dim, f[a]);
}

BRUNT_INLINE void product_of(int dim, int nodes, const fem_call *call, int32_t b) {
    brunt_fem_potential *p = call->p;
    const brunt_fem_block *block = &p->body->block[b];
    real *partial = p->force + (size_t)block->node_first * 4;
    memset(partial, 0, (size_t)block->node_count * 4 * sizeof *partial);
    for (int32_t at = 0; at < block->count; at += BRUNT_LANES) {
        const int32_t rest = block->count - at;
        add_product(dim, nodes, call, (int64_t)block->first + at, rest < BRUNT_LANES ? rest : BRUNT_LANES, partial);
    }
}

// Elements of a block to where their nodes are now: F, material, partial forces and report.
BRUNT_INLINE void commit_block(int dim, int nodes, brunt_fem_potential *p, int32_t b, brunt_fem_workspace *work) {
    brunt_fem_body *body = p->body;
    const brunt_fem_block *block = &body->block[b];
    const int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    real **kept = brunt_element_scalars(body, BRUNT_ELEMENT_deformation_gradient);
    brunt_update_result worst = {.bad = -1};
    fem_tile tile;
    for (int32_t first = 0; first < padded; first += FEM_TILE) {
        const int32_t count = padded - first < FEM_TILE ? padded - first : FEM_TILE;
        const int64_t slot = (int64_t)block->first + first;
        deform_tile(dim, nodes, p, slot, count, &tile);
        brunt_trial_points trial[BRUNT_COMPONENTS];
        brunt_material_points points[BRUNT_COMPONENTS];
        real plastic[FEM_TILE];
        trial_points(p, slot, count, &tile, trial);
        for (int c = 0; c < dim * dim; c++) memcpy(kept[c] + slot, tile.F[c], (size_t)count * sizeof(real));
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            points[k] = brunt_fem_points(body, (brunt_component)k, slot, count);
            points[k].dt = p->dt, points[k].cell = block->length;
        }
        const brunt_update_result result = brunt_material_commit(&body->material, trial, points, plastic);
        worst.wave_speed = worst.wave_speed > result.wave_speed ? worst.wave_speed : result.wave_speed;
        if (result.bad >= 0 && worst.bad < 0) worst.bad = (int32_t)slot + result.bad, worst.reason = result.reason;
    }
    brunt_fem_report *report = &body->report[b];
    report->wave_speed = worst.wave_speed; // the stable step's
    body->element->forces(body, b, 0, work, report);
    report->bad = worst.bad, report->reason = worst.reason;
}

// --------------------------------------------------------------------------------- the kind

static void evaluate_block(const fem_call *call, int32_t b) {
#define EVALUATE(dim, nodes) evaluate(dim, nodes, call, b)
    BY_SIZE(call->p->body, EVALUATE)
}

static void limit_block(const fem_call *call, int32_t b) {
#define LIMIT(dim, nodes) limit_of(dim, nodes, call, b)
    BY_SIZE(call->p->body, LIMIT)
}

static void hessian(const brunt_fem_potential *p, int64_t slot, double *dense) {
#define FILL(dim, nodes) element_hessian(dim, nodes, p, slot, dense)
    BY_SIZE(p->body, FILL)
}

static void product(const fem_call *call, int32_t b) {
#define PRODUCT(dim, nodes) product_of(dim, nodes, call, b)
    BY_SIZE(call->p->body, PRODUCT)
}

static void commit(brunt_fem_potential *p, int32_t b, brunt_fem_workspace *work) {
#define COMMIT(dim, nodes) commit_block(dim, nodes, p, b, work)
    BY_SIZE(p->body, COMMIT)
}

const fem_potential_kind brunt_fem_solid_potential = {.make = make,
                                                      .evaluate = evaluate_block,
                                                      .limit = limit_block,
                                                      .hessian = hessian,
                                                      .product = product,
                                                      .commit = commit};
