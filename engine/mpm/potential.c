#include "mpm/instances.h"
#include "mpm/potential_kernel.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/volume_root.h"

const char *brunt_mpm_implicit(const brunt_body *body) {
    if (brunt_axisymmetric(&body->particles)) return "rings about an axis have no implicit steps";
    if (brunt_total_lagrangian(&body->particles)) return "total-Lagrangian bodies have no implicit steps";
    if (body->erodes || body->keeps) return "bodies whose particles leave have no implicit steps";
    return brunt_material_implicit(&body->material);
}

brunt_mpm_potential *brunt_mpm_potential_make(brunt_body *body, brunt_error *error) {
    const char *reason = brunt_mpm_implicit(body);
    if (reason) {
        brunt_fail(error, BRUNT_BAD_INPUT, "body '%s': %s", body->name, reason);
        return NULL;
    }
    brunt_mpm_potential *p;
    if (BRUNT_NEW(p, 1, "room for the implicit steps of a body of points", error)) return NULL;
    const brunt_model *strength = body->material.model[BRUNT_STRENGTH];
    p->body = body;
    p->whole = body->material.differences;
    p->history = strength->plastic || strength->shear_viscous || p->whole;
    return p;
}

void brunt_mpm_potential_free(brunt_mpm_potential *p) {
    if (!p) return;
    brunt_free(p->slab), brunt_free(p->force), brunt_free(p->energy), brunt_free(p->limit), brunt_free(p->result);
    brunt_free(p->first), brunt_free(p->node), brunt_free(p->matrix);
    brunt_free(p->coloured), brunt_free(p->place);
    brunt_free(p);
}

size_t brunt_mpm_potential_bytes(const brunt_mpm_potential *p) {
    return sizeof *p + p->slab_capacity + p->force_capacity + p->energy_capacity + p->limit_capacity +
           p->result_capacity + p->first_capacity + p->node_capacity + p->matrix_capacity + p->coloured_capacity +
           p->place_capacity;
}

static brunt_stencils stencils(void *self) {
    const brunt_mpm_potential *p = self;
    return (brunt_stencils){.count = p->stencil_count, .first = p->first, .node = p->node, .version = p->step};
}

// The bins with particles, and the unknowns among their nodes.
static void list_bins(brunt_mpm_potential *p) {
    const brunt_grid *grid = &p->body->grid;
    const int N = grid->order + 1, n = kernel_nodes(grid->dim, grid->kernel);
    int64_t count = 0, nodes = 0;
    for (int32_t b = 0; b < grid->block_count; b++)
        for (int bin = 0; bin < BRUNT_BLOCK_NODES; bin++) {
            const int32_t *start = grid->bin_start + (size_t)b * BRUNT_BIN_STARTS + bin;
            if (start[0] == start[1]) continue;
            int at[3];
            brunt_node_local(grid, bin, at);
            p->first[count++] = nodes;
            for (int k = 0; k < n; k++) {
                const bool flat = grid->dim == 2;
                const int i = flat ? k / N : k / (N * N), j = flat ? k % N : k / N % N, m = flat ? 0 : k % N;
                const int64_t place = grid->mesh ? corners_of(grid, &grid->blocks[b])[3 * bin + k]
                                                 : window_node(grid, &grid->blocks[b], at[0] + i, at[1] + j, at[2] + m);
                const int32_t node = p->number[place];
                if (node < 0) continue;
                p->node[nodes++] = node;
            }
        }
    p->first[count] = nodes;
    p->stencil_count = count;
}

static int reserve_arrays(brunt_mpm_potential *p, brunt_error *error) {
    const brunt_grid *grid = &p->body->grid;
    const int64_t blocks = grid->block_count, tangents = brunt_material_tangents(&p->body->material, grid->dim);
    const int64_t stride = (p->body->particles.slots + 7) / 8 * 8 + 8 * BRUNT_LANES;
    const int32_t *start = grid->bin_start;
    int64_t bins = 0;
    for (int64_t k = 0; k < blocks * BRUNT_BIN_STARTS; k++) bins += k % BRUNT_BIN_STARTS && start[k] > start[k - 1];
    if (BRUNT_CAPACITY(p->slab, (size_t)(tangents * stride), 0, "numbers of tangents of particles", error) ||
        BRUNT_CAPACITY(p->force, (size_t)(blocks * grid->span_nodes * grid->dim), 0, "forces of blocks of particles",
                       error) ||
        BRUNT_CAPACITY(p->energy, (size_t)blocks, 0, "blocks of particles", error) ||
        BRUNT_CAPACITY(p->limit, (size_t)blocks, 0, "blocks of particles", error) ||
        BRUNT_CAPACITY(p->result, (size_t)blocks, 0, "blocks of particles", error) ||
        BRUNT_CAPACITY(p->first, (size_t)bins + 1, 0, "bins of particles", error) ||
        BRUNT_CAPACITY(p->node, (size_t)(bins * kernel_nodes(grid->dim, grid->kernel)) + 1, 0,
                       "grid nodes of bins of particles", error) ||
        brunt_mpm_matrix_reserve(p, error) ||
        BRUNT_CAPACITY_IN(p->body->report, p->body->report_capacity, (size_t)blocks, 0, "blocks of particles", error))
        return BRUNT_FAILED;
    for (int64_t k = 0; k < tangents; k++) p->tangent[k] = p->slab + k * stride;
    return BRUNT_OK;
}

void brunt_mpm_potential_ask(brunt_mpm_potential *p, brunt_trial_rule rule) { p->rule = rule; }

int brunt_mpm_potential_step(brunt_mpm_potential *p, const brunt_team *team, const int32_t *number, double dt,
                             brunt_error *error) {
    const double c0 = (double)p->body->material.wave_speed;
    p->number = number, p->dt = (real)dt, p->threads = team->threads, p->step++;
    p->moduli = (double)p->body->particles.count * (double)p->body->particle_mass * c0 * c0;
    if (reserve_arrays(p, error)) return BRUNT_FAILED;
    list_bins(p);
    return BRUNT_OK;
}

// --------------------------------------------------------------------------------- a block

typedef enum mpm_wanted { MPM_ENERGY, MPM_GRADIENT, MPM_TANGENT, MPM_LIMIT, MPM_MEAN } mpm_wanted;

typedef struct mpm_call {
    brunt_mpm_potential *p;
    mpm_wanted wanted;
    bool project;
    const double *u, *way;
    double *out, largest;
} mpm_call;

static const real *volume_of(brunt_mpm_potential *p) {
    return brunt_field(&p->body->particles, BRUNT_FIELD_reference_volume)[0];
}

// f^-1 of a vector of the tile.
BRUNT_INLINE void inverse_step(int dim, const mpm_tile *tile, int32_t at, lanes out[9]) {
    lanes f[9];
    for (int c = 0; c < dim * dim; c++) f[c] = lanes_load(tile->f[c] + at);
    if (dim == 2) {
        const lanes over = 1 / (f[0] * f[3] - f[1] * f[2]);
        out[0] = over * f[3], out[1] = -over * f[1], out[2] = -over * f[2], out[3] = over * f[0];
        return;
    }
    lanes minors[3];
    for (int c = 0; c < 3; c++)
        minors[c] = f[3 + (c + 1) % 3] * f[6 + (c + 2) % 3] - f[3 + (c + 2) % 3] * f[6 + (c + 1) % 3];
    const lanes over = 1 / (f[0] * minors[0] + f[1] * minors[1] + f[2] * minors[2]);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int r1 = (r + 1) % 3 * 3, r2 = (r + 2) % 3 * 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            out[3 * c + r] = over * (f[r1 + c1] * f[r2 + c2] - f[r1 + c2] * f[r2 + c1]);
        }
}

// Adds P slope of a vector to the nodes of its kernels, lane by lane.
BRUNT_INLINE void spread_forces(int dim, int kernel, bool same, const kernel_lanes *k, const lanes P[9],
                                double *force) {
    for (int n = 0; n < kernel_nodes(dim, kernel); n++) {
        const kernel_node node = node_of(dim, kernel, k, n);
        for (int i = 0; i < dim; i++) {
            lanes f = P[i * dim] * node.slope[0];
            for (int j = 1; j < dim; j++) f += P[i * dim + j] * node.slope[j];
            if (same) {
                double sum = force[(k->base[0] + node.at) * dim + i];
                for (int l = 0; l < BRUNT_LANES; l++) sum += (double)f[l];
                force[(k->base[0] + node.at) * dim + i] = sum;
                continue;
            }
            for (int l = 0; l < BRUNT_LANES; l++) force[(k->base[l] + node.at) * dim + i] += (double)f[l];
        }
    }
}

// Adds V tau f^-T slope of a vector to the block's nodes.
BRUNT_INLINE void add_forces(int dim, int kernel, brunt_mpm_potential *p, const brunt_block *block, int64_t slot,
                             const mpm_tile *tile, int32_t at) {
    lanes inverse[9], P[9];
    kernel_lanes k;
    kernel_at(dim, kernel, p->body, block, slot, &k);
    inverse_step(dim, tile, at, inverse);
    const lanes volume = lanes_load(volume_of(p) + slot);
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) {
            lanes sum = lanes_set(0);
            for (int a = 0; a < dim; a++) sum += lanes_load(tile->stress[i * dim + a] + at) * inverse[j * dim + a];
            P[i * dim + j] = lanes_select(volume > 0, volume * sum, lanes_set(0));
        }
    if (k.same)
        spread_forces(dim, kernel, true, &k, P, tile->force);
    else
        spread_forces(dim, kernel, false, &k, P, tile->force);
}

// Tangents of a vector times the volume, with f^-1 from both sides: for slopes in the configuration of the grid.
BRUNT_INLINE void pull_back(int dim, brunt_mpm_potential *p, int64_t slot, const mpm_tile *tile, int32_t at) {
    const int rows = dim * dim;
    lanes inverse[9], a[9][9];
    inverse_step(dim, tile, at, inverse);
    const lanes volume = lanes_load(volume_of(p) + slot);
    for (int m = 0; m < rows; m++)
        for (int n = 0; n < rows; n++)
            a[m][n] = volume * lanes_load(p->tangent[brunt_tangent_place(p->whole, dim, m, n)] + slot);
    for (int i = 0; i < dim; i++)
        for (int j = p->whole ? 0 : i; j < dim; j++) {
            lanes half[3][3];
            for (int A = 0; A < dim; A++)
                for (int b = 0; b < dim; b++) {
                    half[A][b] = inverse[A * dim] * a[i * dim][j * dim + b];
                    for (int k = 1; k < dim; k++) half[A][b] += inverse[A * dim + k] * a[i * dim + k][j * dim + b];
                }
            for (int A = 0; A < dim; A++)
                for (int B = i == j && !p->whole ? A : 0; B < dim; B++) {
                    lanes sum = half[A][0] * inverse[B * dim];
                    for (int k = 1; k < dim; k++) sum += half[A][k] * inverse[B * dim + k];
                    lanes_store(p->tangent[brunt_tangent_place(p->whole, dim, i * dim + A, j * dim + B)] + slot, sum);
                }
        }
}

// What is wanted of a tile of `count` particles from `slot` on.
BRUNT_INLINE void evaluate_tile(int dim, int kernel, const mpm_call *call, int32_t b, int64_t slot, int32_t count,
                                const double *window) {
    brunt_mpm_potential *p = call->p;
    const brunt_grid *grid = &p->body->grid;
    const brunt_block *block = &grid->blocks[b];
    brunt_energy_sum *sum = &p->energy[b];
    mpm_tile tile;
    tile.force = p->force + (size_t)b * (size_t)grid->span_nodes * (size_t)dim;
    for (int32_t s = 0; s < count; s += BRUNT_LANES) {
        kernel_lanes k;
        lanes H[9];
        kernel_at(dim, kernel, p->body, block, slot + s, &k);
        field_at(dim, kernel, window, &k, NULL, H);
        deform_points(dim, p->body, slot + s, H, &tile, s);
    }
    brunt_trial_points trial[BRUNT_COMPONENTS];
    trial_tile(p, slot, count, &tile, trial);
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        if (call->wanted == MPM_ENERGY) trial[k].density = tile.density;
        for (int c = 0; c < dim * dim && call->wanted == MPM_GRADIENT; c++) trial[k].stress[c] = tile.stress[c];
        for (int c = 0; c < brunt_material_tangents(&p->body->material, dim) && call->wanted == MPM_TANGENT; c++)
            trial[k].tangent[c] = p->tangent[c] + slot;
    }
    brunt_material_respond(&p->body->material, trial);
    if (call->wanted == MPM_TANGENT && call->project) brunt_material_project(&p->body->material, trial);
    for (int32_t s = 0; s < count; s += BRUNT_LANES) {
        if (call->wanted == MPM_GRADIENT) add_forces(dim, kernel, p, block, slot + s, &tile, s);
        if (call->wanted == MPM_TANGENT) pull_back(dim, p, slot + s, &tile, s);
        if (call->wanted != MPM_ENERGY) continue;
        const lanes volume = lanes_load(volume_of(p) + slot + s);
        const lanes e = lanes_select(volume > 0, volume * lanes_load(tile.density + s), lanes_set(0));
        sum->value += (double)lanes_sum(e), sum->magnitude += (double)lanes_sum(lanes_abs(e));
    }
}

// The most by which a component differs among the nodes of a window.
BRUNT_INLINE double widest(int dim, int nodes, const double *window) {
    double most = 0;
    for (int i = 0; i < dim; i++) {
        double low = window[i], high = window[i];
        for (int n = 1; n < nodes; n++) {
            const double value = window[n * dim + i];
            low = value < low ? value : low, high = value > high ? value : high;
        }
        most = high - low > most ? high - low : most;
    }
    return most;
}

// Whether no volume of a block can be lost on the way, by its nodes alone: slopes of a kernel along an axis add up to
// nothing, and their sizes to no more than 2 / h, so that no entry of f - I is above `widest` over h; with three of
// them in a row below 1 the determinant of f is above 0. An entry of 0.2 is far from that.
BRUNT_INLINE bool keeps_volume(int dim, int kernel, const mpm_call *call, const double *u, const double *way) {
    const int nodes = window_nodes(dim, kernel);
    if (kernel == BRUNT_GRID_MESH) return false; // triangles may be as flat as they like
    return (widest(dim, nodes, u) + call->largest / 0.9 * widest(dim, nodes, way)) * (double)call->p->body->grid.inv_h <
           0.2;
}

BRUNT_INLINE void evaluate(int dim, int kernel, const mpm_call *call, int32_t b) {
    brunt_mpm_potential *p = call->p;
    const brunt_grid *grid = &p->body->grid;
    const brunt_block *block = &grid->blocks[b];
    const int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    double window[WINDOW_LIMIT * 3], way[WINDOW_LIMIT * 3];
    double *force = p->force + (size_t)b * (size_t)grid->span_nodes * (size_t)dim;
    fill_window(p, block, call->u, window);
    if (call->wanted == MPM_LIMIT) fill_window(p, block, call->way, way);
    if (call->wanted == MPM_GRADIENT) memset(force, 0, (size_t)grid->span_nodes * (size_t)dim * sizeof *force);
    p->energy[b] = (brunt_energy_sum){0};
    p->limit[b] = call->largest;
    if (call->wanted == MPM_LIMIT && keeps_volume(dim, kernel, call, window, way)) return;
    if (call->wanted < MPM_LIMIT) {
        for (int32_t first = 0; first < padded; first += TILE_LIMIT)
            evaluate_tile(dim, kernel, call, b, (int64_t)block->first + first,
                          padded - first < TILE_LIMIT ? padded - first : TILE_LIMIT, window);
        return;
    }
    for (int64_t slot = block->first; slot < block->first + padded; slot += BRUNT_LANES) {
        kernel_lanes k;
        lanes mean[3], F[9], D[9];
        kernel_at(dim, kernel, p->body, block, slot, &k);
        field_at(dim, kernel, window, &k, mean, F);
        if (call->wanted == MPM_LIMIT) {
            for (int c = 0; c < dim; c++) F[c * (dim + 1)] += 1;
            field_at(dim, kernel, way, &k, NULL, D);
            p->limit[b] = least_step_to_volume(dim, F, D, p->limit[b]);
            continue;
        }
        for (int l = 0; l < BRUNT_LANES; l++)
            for (int i = 0; i < dim; i++) call->out[(slot + l) * dim + i] = (double)mean[i][l];
    }
}

#define INSTANCE(name, dim, kernel)                                                                                    \
    static void potential_##name(const mpm_call *call, int32_t block) { evaluate(dim, kernel, call, block); }
MPM_INSTANCES(INSTANCE)
#define FOUND(name, dim, kernel) [kernel][dim] = potential_##name,
typedef void block_instance(const mpm_call *call, int32_t block);
static block_instance *const instances[][4] = {MPM_INSTANCES(FOUND)};

static void run_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const mpm_call *call = context;
    const brunt_grid *grid = &call->p->body->grid;
    block_instance *instance = instances[grid->kernel][grid->dim];
    (void)worker;
    for (int64_t b = begin; b < end; b++) instance(call, (int32_t)b);
}

static void run(mpm_call *call, const brunt_team *team) {
    brunt_parallel(team->threads, call->p->body->grid.block_count, 1, run_blocks, call, team->timer);
}

// --------------------------------------------------------------------------------- the term

// Nodes of slots: what the blocks around give, in their order.
static void gather_slots(void *context, int64_t begin, int64_t end, int worker) {
    const mpm_gather *gather = context;
    const brunt_mpm_potential *p = gather->p;
    const brunt_grid *grid = &p->body->grid;
    const int dim = grid->dim, span = grid->span, side = grid->side;
    (void)worker;
    for (int64_t s = begin; s < end; s++)
        for (int n = 0; n < BRUNT_BLOCK_NODES; n++) {
            const int32_t unknown = p->number[s * BRUNT_BLOCK_NODES + n];
            int local[3];
            if (unknown < 0) continue;
            brunt_node_local(grid, n, local);
            for (int corner = 0; corner < grid->corners; corner++) {
                const int32_t source = grid->slots[s].source[corner];
                int at = 0;
                bool inside = source >= 0;
                for (int a = 0; a < dim; a++) {
                    const int x = local[a] + (corner >> (dim - 1 - a) & 1) * side;
                    inside = inside && x < span;
                    at = at * span + x;
                }
                if (!inside) continue;
                const double *f = p->force + ((size_t)source * (size_t)grid->span_nodes + (size_t)at) * (size_t)dim;
                for (int i = 0; i < dim; i++) gather->out[(int64_t)unknown * gather->stride + i] += f[i];
            }
        }
}

// Nodes of a mesh: what the triangles around give, in their order.
static void gather_mesh(void *context, int64_t begin, int64_t end, int worker) {
    const mpm_gather *gather = context;
    const brunt_mpm_potential *p = gather->p;
    const brunt_grid *grid = &p->body->grid;
    (void)worker;
    for (int64_t n = begin * BRUNT_BLOCK_NODES; n < end * BRUNT_BLOCK_NODES; n++)
        for (int32_t k = grid->source_first[n]; k < grid->source_first[n + 1] && p->number[n] >= 0; k++)
            for (int i = 0; i < 2; i++)
                gather->out[(int64_t)p->number[n] * gather->stride + i] += p->force[(int64_t)grid->source[k] * 2 + i];
}

void brunt_mpm_gather(mpm_gather *gather, const brunt_team *team) {
    const brunt_grid *grid = &gather->p->body->grid;
    brunt_parallel(team->threads, grid->slot_count, 1, grid->mesh ? gather_mesh : gather_slots, gather, team->timer);
}

static brunt_energy_sum energy(void *self, const brunt_team *team, const double *u) {
    brunt_mpm_potential *p = self;
    mpm_call call = {.p = p, .wanted = MPM_ENERGY, .u = u};
    run(&call, team);
    brunt_energy_sum sum = {.moduli = p->moduli};
    for (int32_t b = 0; b < p->body->grid.block_count; b++)
        sum.value += p->energy[b].value, sum.magnitude += p->energy[b].magnitude;
    return sum;
}

static void gradient(void *self, const brunt_team *team, const double *u, double *g) {
    brunt_mpm_potential *p = self;
    mpm_call call = {.p = p, .wanted = MPM_GRADIENT, .u = u};
    run(&call, team);
    brunt_mpm_gather(&(mpm_gather){p, g, p->body->grid.dim}, team);
}

static void hessian(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *h) {
    brunt_mpm_potential *p = self;
    mpm_call call = {.p = p, .wanted = MPM_TANGENT, .project = project, .u = u};
    run(&call, team);
    brunt_mpm_add_matrix(p, team, h);
}

static void linearise(void *self, const brunt_team *team, const double *u, bool project, brunt_block_matrix *blocks) {
    brunt_mpm_potential *p = self;
    mpm_call call = {.p = p, .wanted = MPM_TANGENT, .project = project, .u = u};
    run(&call, team);
    brunt_mpm_add_diagonal(p, team, blocks);
}

static void product(void *self, const brunt_team *team, const double *x, double *y) {
    brunt_mpm_add_product(self, team, x, y);
}

static double limit(void *self, const brunt_team *team, const double *u, const double *way, double largest) {
    brunt_mpm_potential *p = self;
    mpm_call call = {.p = p, .wanted = MPM_LIMIT, .u = u, .way = way, .largest = largest};
    run(&call, team);
    for (int32_t b = 0; b < p->body->grid.block_count; b++) largest = fmin(largest, p->limit[b]);
    return largest;
}

void brunt_mpm_interpolate(brunt_mpm_potential *p, const brunt_team *team, const double *u, double *out) {
    mpm_call call = {.p = p, .wanted = MPM_MEAN, .u = u, .out = out};
    run(&call, team);
}

brunt_term brunt_mpm_potential_term(brunt_mpm_potential *p) {
    static const brunt_term_ops ops = {.name = "material points",
                                       .limit = limit,
                                       .gradient = gradient,
                                       .stencils = stencils,
                                       .hessian = hessian,
                                       .linearise = linearise,
                                       .product = product,
                                       .energy = energy};
    return (brunt_term){.ops = &ops, .self = p};
}
