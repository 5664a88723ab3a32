// The end of an implicit step: particles go where the grid went.
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "mpm/instances.h"
#include "mpm/potential_kernel.h"

typedef struct mpm_commit {
    brunt_mpm_potential *p;
    const brunt_mpm_motion *motion;
} mpm_commit;

// Windows of the block: displacements, velocities, those at the start.
typedef struct mpm_windows {
    double u[WINDOW_LIMIT * 3], v[WINDOW_LIMIT * 3], old[WINDOW_LIMIT * 3];
} mpm_windows;

// What the grid says at a vector of particles.
typedef struct grid_motion {
    lanes u[3], H[9];                      // sum w u, and its gradient
    lanes v[3], old[3], kinetic, slope[9]; // sum w v, of the start, sum w |v|^2, gradient of v
    lanes B[9], turn[9];                   // sum w v (x_i - x_p)^T, sum w v du^T
} grid_motion;

BRUNT_INLINE void motion_at(int dim, int kernel, const mpm_windows *w, const kernel_lanes *k, real h, bool flip,
                            grid_motion *m) {
    field_at(dim, kernel, w->u, k, m->u, m->H);
    m->kinetic = lanes_set(0);
    for (int i = 0; i < dim; i++) m->v[i] = m->old[i] = lanes_set(0);
    for (int c = 0; c < dim * dim; c++) m->B[c] = m->turn[c] = m->slope[c] = lanes_set(0);
    for (int n = 0; n < kernel_nodes(dim, kernel); n++) {
        const kernel_node node = node_of(dim, kernel, k, n);
        lanes u[3], v[3], old[3];
        window_values(dim, k->same, w->u, k, node.at, u);
        window_values(dim, k->same, w->v, k, node.at, v);
        if (flip) window_values(dim, k->same, w->old, k, node.at, old);
        for (int i = 0; i < dim; i++) {
            const lanes weighed = node.weight * v[i];
            m->v[i] += weighed, m->kinetic += weighed * v[i];
            if (flip) m->old[i] += node.weight * old[i];
            for (int j = 0; j < dim; j++) {
                if (kernel_order(kernel) > 1) m->B[i * dim + j] += weighed * (((real)node.index[j] - k->local[j]) * h);
                m->turn[i * dim + j] += weighed * (u[j] - m->u[j]);
                m->slope[i * dim + j] += v[i] * node.slope[j];
            }
        }
    }
}

// C = B D^-1. The linear kernel's D depends on the place and vanishes at nodes, where B does too: its first part is the
// gradient of v, exactly; the second, which is of the order of D times the step, is left out where there is no D.
BRUNT_INLINE void store_affine(int dim, int kernel, brunt_body *body, int64_t slot, const grid_motion *m) {
    const brunt_grid *grid = &body->grid;
    real *const *x = brunt_field(&body->particles, BRUNT_FIELD_position);
    real *const *C = brunt_field(&body->particles, BRUNT_FIELD_affine);
    for (int a = 0; a < dim; a++) {
        const lanes D =
            bspline_moment(kernel_order(kernel), lanes_load(x[a] + slot) - (real)grid->origin[a], grid->h, grid->inv_h);
        const lane_mask there = D > LANES_REAL_EPSILON * grid->h * grid->h;
        for (int i = 0; i < dim; i++) {
            const lanes turn = (real)0.5 * (m->turn[i * dim + a] - m->turn[a * dim + i]);
            const lanes first = kernel_order(kernel) == 1 ? m->slope[i * dim + a] : m->B[i * dim + a] / D;
            lanes_store(C[i * dim + a] + slot,
                        first + lanes_select(there, turn / lanes_select(there, D, lanes_set(1)), lanes_set(0)));
        }
    }
}

// |C|^2 weighed by D where the particles are now.
BRUNT_INLINE lanes affine_square(int dim, int kernel, brunt_body *body, int64_t slot) {
    const brunt_grid *grid = &body->grid;
    real *const *x = brunt_field(&body->particles, BRUNT_FIELD_position);
    real *const *C = brunt_field(&body->particles, BRUNT_FIELD_affine);
    lanes sum = lanes_set(0);
    for (int a = 0; a < dim; a++) {
        const lanes D =
            bspline_moment(kernel_order(kernel), lanes_load(x[a] + slot) - (real)grid->origin[a], grid->h, grid->inv_h);
        for (int i = 0; i < dim; i++) sum += lanes_load(C[i * dim + a] + slot) * lanes_load(C[i * dim + a] + slot) * D;
    }
    return sum;
}

// Material of a tile, whose F becomes the particles'.
static void commit_material(brunt_mpm_potential *p, int64_t slot, int32_t count, mpm_tile *tile,
                            brunt_block_report *report) {
    brunt_body *body = p->body;
    const int dim = body->grid.dim;
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    brunt_trial_points trial[BRUNT_COMPONENTS];
    brunt_material_points points[BRUNT_COMPONENTS];
    real plastic[TILE_LIMIT];
    trial_tile(p, slot, count, tile, trial);
    for (int c = 0; c < dim * dim; c++) memcpy(F[c] + slot, tile->F[c], (size_t)count * sizeof(real));
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        points[k] = brunt_body_points(body, (brunt_component)k, slot, count);
        points[k].dt = p->dt;
    }
    const brunt_update_result result = brunt_material_commit(&body->material, trial, points, plastic);
    if (result.wave_speed > report->wave_speed) report->wave_speed = result.wave_speed;
    if (result.bad >= 0 && report->bad < 0) report->bad = (int32_t)slot + result.bad, report->reason = result.reason;
}

BRUNT_INLINE void commit_block(int dim, int kernel, const mpm_commit *commit, int32_t b) {
    brunt_mpm_potential *p = commit->p;
    const brunt_mpm_motion *motion = commit->motion;
    brunt_body *body = p->body;
    const brunt_block *block = &body->grid.blocks[b];
    const int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    const bool flips = motion->transfer == BRUNT_FLIP, affine = motion->transfer == BRUNT_APIC;
    const real flip = flips ? (real)motion->flip : 0;
    real *const *x = brunt_field(&body->particles, BRUNT_FIELD_position);
    real *const *v = brunt_field(&body->particles, BRUNT_FIELD_velocity);
    const real *mass = brunt_field(&body->particles, BRUNT_FIELD_mass)[0];
    lanes kinetic = lanes_set(0), grid_kinetic = lanes_set(0), fastest = lanes_set(0);
    mpm_windows windows;
    mpm_tile tile;
    fill_window(p, block, motion->u, windows.u);
    fill_window(p, block, motion->v, windows.v);
    if (flips) fill_window(p, block, motion->v_old, windows.old);
    brunt_block_report *report = &body->report[b];
    *report = (brunt_block_report){.bad = -1};
    for (int32_t first = 0; first < padded; first += TILE_LIMIT) {
        const int32_t count = padded - first < TILE_LIMIT ? padded - first : TILE_LIMIT;
        for (int32_t at = 0; at < count; at += BRUNT_LANES) {
            const int64_t slot = (int64_t)block->first + first + at;
            kernel_lanes k;
            grid_motion m;
            lanes square = lanes_set(0);
            kernel_at(dim, kernel, body, block, slot, &k);
            motion_at(dim, kernel, &windows, &k, body->grid.h, flips, &m);
            deform_points(dim, body, slot, m.H, &tile, at);
            if (affine) store_affine(dim, kernel, body, slot, &m);
            for (int i = 0; i < dim; i++) {
                lanes now = m.v[i];
                if (flips) now = flip * (lanes_load(v[i] + slot) + (m.v[i] - m.old[i])) + (1 - flip) * m.v[i];
                lanes_store(v[i] + slot, now);
                lanes_store(x[i] + slot, lanes_load(x[i] + slot) + m.u[i]);
                square += now * now;
            }
            fastest = lanes_max(fastest, square);
            if (affine) square += affine_square(dim, kernel, body, slot);
            kinetic += lanes_load(mass + slot) * square;
            grid_kinetic += lanes_load(mass + slot) * m.kinetic;
        }
        commit_material(p, (int64_t)block->first + first, count, &tile, report);
    }
    report->kinetic = 0.5 * (double)lanes_sum(kinetic);
    report->speed = (real)sqrt((double)lanes_max_of(fastest));
    p->result[b] = (mpm_block_result){report->kinetic, 0.5 * (double)lanes_sum(grid_kinetic)};
}

#define INSTANCE(name, dim, kernel)                                                                                    \
    static void potential_commit_##name(const mpm_commit *commit, int32_t block) {                                     \
        commit_block(dim, kernel, commit, block);                                                                      \
    }
MPM_INSTANCES(INSTANCE)
#define FOUND(name, dim, kernel) [kernel][dim] = potential_commit_##name,
typedef void block_instance(const mpm_commit *commit, int32_t block);
static block_instance *const instances[][4] = {MPM_INSTANCES(FOUND)};

static void commit_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const mpm_commit *commit = context;
    const brunt_grid *grid = &commit->p->body->grid;
    block_instance *instance = instances[grid->kernel][grid->dim];
    (void)worker;
    for (int64_t b = begin; b < end; b++) instance(commit, (int32_t)b);
}

int brunt_mpm_commit(brunt_mpm_potential *p, const brunt_team *team, const brunt_mpm_motion *motion,
                     brunt_mpm_result *result, brunt_error *error) {
    brunt_body *body = p->body;
    mpm_commit commit = {p, motion};
    brunt_parallel(team->threads, body->grid.block_count, 1, commit_blocks, &commit, team->timer);
    *result = (brunt_mpm_result){0};
    double grid_kinetic = 0;
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const brunt_block_report *report = &body->report[b];
        if (report->bad >= 0) {
            double at[3] = {0};
            for (int i = 0; i < body->grid.dim; i++)
                at[i] = (double)brunt_field(&body->particles, BRUNT_FIELD_position)[i][report->bad];
            return brunt_fail(error, BRUNT_FAILED, "body '%s': particle %lld at (%g, %g, %g) m: %s", body->name,
                              (long long)body->particles.id[report->bad], at[0], at[1], at[2], report->reason);
        }
        result->kinetic += report->kinetic, grid_kinetic += p->result[b].grid_kinetic;
        if (report->speed > result->speed) result->speed = report->speed;
        if (report->wave_speed > result->wave_speed) result->wave_speed = report->wave_speed;
    }
    result->transfer = grid_kinetic - result->kinetic;
    body->speed = result->speed;
    return BRUNT_OK;
}
