// Planes that push and let go, at zero gap.
//
// A wall acts on particles, not on nodes: a particle whose surface would be past the plane at the end of the step gets
// an impulse that just prevents it, given to the nodes with the particle's own weights. Planes of any direction and
// position work alike, and the block of a tilted ramp rests where its surface is. The impulses of all particles in
// reach solve a complementarity problem (push >= 0, gap >= 0, friction within the Coulomb cone).
//
// It is solved by projected Jacobi iteration. Each particle's correction is divided by its row sum of the coupling
// matrix N M^-1 N^T, which is non-negative: the spectrum of the scaled matrix lies in (0, 1], the iteration converges,
// and a uniform approach, the common case, is met in one sweep. All particles of a sweep see the same velocities, so
// neither their order nor the number of threads matters.
//
// Friction acts where the material meets the plane, not at the particle's centre, half a spacing inside: slip is that
// of the velocity extended affinely to that point, with the weights
//   N_i(x_p) (1 + (x_i - x_p) . D^-1 d),  D the kernel's second moment, d from the particle to the point
// whose transpose gives the nodes force and moment of an impulse there exactly. A cylinder rolls on its radius, not on
// that of its outermost particles.
//
// Tried and left: conditions on the nodes behind the plane (the surface then depends on where the plane cuts the cells,
// by up to half a cell); Gauss-Seidel (the first particle visited takes the load of its neighbours, which need 50 to
// 200 sweeps to take it back, against about 10 here).
#include <math.h>
#include <string.h>

#include "contact/constraint/coulomb.h"
#include "contact/planes/particle_plane.h"
#include "contact/distance/particle_extent.h"
#include "contact/planes/boundary.h"
#include "contact/planes/symmetry.h"
#include "base/array.h"
#include "base/memory.h"
#include "mpm/mpm_body.h"
#include "grid/bspline.h"

enum { MAX_SWEEPS = 16 };
static const double SWEEP_TOLERANCE =
    1e-2; // of the greatest correction of velocity in the first sweep: what is left is met again next step
static const double NEAR = 0.5; // cells: how far from a plane particles are looked at, if nothing moves faster

// A vector in space and one number more.
typedef double quad __attribute__((vector_size(32), aligned(8)));

// A node under touching particles.
typedef struct support {
    real *node;
    double inverse_mass; // [1/kg]
    quad v, impulse;     // [m/s]; [N s] of the sweep
    double weight[3];    // sum of what the particles apply to it, along each axis
    double lever[3];     // of what their friction does, of sizes
} support;

// A node under one touching particle. With mirror planes near by, the particle's images act too: `apply` differs from
// `weight`.
typedef struct entry {
    int32_t support, number; // `number`: of the node among the particle's own, without mirrors
    double weight;
    quad apply;
} entry;

// The same of friction, at the surface: of each entry of a touch with friction.
typedef struct lever {
    double weight;
    quad apply;
} lever;

typedef struct touch {
    int64_t slot; // particle
    int wall;
    int32_t first, count;        // its entries
    int32_t levers;              // the first of as many, -1 without friction
    double target;               // [m/s] least velocity along the normal
    double response, response_t; // [1/kg] row sums: along the normal, tangential
    double normal_impulse;       // [N s] along the normal
    double friction_impulse[3];  // [N s] tangential
} touch;

struct brunt_wall_workspace {
    touch *touches;
    size_t touches_capacity;
    int32_t touch_count;
    entry *entries;
    size_t entries_capacity;
    int32_t entry_count;
    lever *levers;
    size_t levers_capacity;
    int32_t lever_count;
    support *supports;
    size_t supports_capacity;
    int32_t support_count;
    int32_t *index;
    size_t index_capacity; // of each node of the grid: its support + 1, 0 for none
};

void brunt_wall_workspace_free(brunt_wall_workspace *workspace) {
    if (!workspace) return;
    brunt_free(workspace->touches);
    brunt_free(workspace->entries);
    brunt_free(workspace->levers);
    brunt_free(workspace->supports);
    brunt_free(workspace->index);
    brunt_free(workspace);
}

static int32_t find_support(brunt_wall_workspace *w, const brunt_grid *grid, real *node) {
    int32_t *index = &w->index[(node - grid->nodes) / BRUNT_NODE_REALS];
    if (!*index) {
        support *s = &w->supports[w->support_count];
        *s = (support){.node = node, .inverse_mass = 1 / (double)node[BRUNT_NODE_MASS]};
        for (int a = 0; a < grid->dim; a++) s->v[a] = (double)node[BRUNT_NODE_VELOCITY + a];
        *index = ++w->support_count;
    }
    return *index - 1;
}

// A node under the particles of a block, which may be in the next one along an axis.
static real *block_node(const brunt_grid *grid, const brunt_block *block, const int32_t at[3]) {
    int corner = 0, in[3] = {0};
    for (int a = 0; a < grid->dim; a++) {
        const int local = at[a] - block->coord[a] * grid->side, past = local >= grid->side;
        corner = 2 * corner + past, in[a] = local - past * grid->side;
    }
    return brunt_slot_nodes(grid, block->slot[corner]) +
           (size_t)brunt_node_index(grid, in[0], in[1], in[2]) * BRUNT_NODE_REALS;
}

static entry *find_entry(brunt_wall_workspace *w, int32_t first, int32_t at) {
    for (int32_t e = first; e < w->entry_count; e++)
        if (w->entries[e].support == at) return &w->entries[e];
    entry *fresh = &w->entries[w->entry_count++];
    *fresh = (entry){.support = at};
    return fresh;
}

// The first of the nodes under particle `s` of block `b`, how many cells past it the particle is, and weights along
// each axis.
static void place_kernel(const brunt_body *body, int32_t b, int64_t s, int32_t base[3], double u[3],
                         double weight[3][4]) {
    const brunt_grid *grid = &body->grid;
    int local[3];
    brunt_node_local(grid, body->particles.bin[s], local);
    real *const *x = brunt_kernel_place(&body->particles);
    for (int a = 0; a < 3; a++) base[a] = 0, u[a] = 0, weight[a][0] = 1;
    for (int a = 0; a < grid->dim; a++) {
        base[a] = grid->blocks[b].coord[a] * grid->side + local[a];
        u[a] = ((double)x[a][s] - grid->origin[a]) / (double)grid->h - base[a];
        brunt_bspline_weights(grid->order, u[a], weight[a]);
    }
}

// Beside mirrors: entries of a node and its images.
static void add_images(brunt_wall_workspace *w, const brunt_grid *grid, int32_t first, const int32_t at[3], double N,
                       const brunt_symmetry_plane *mirrors, int mirror_count) {
    int32_t image[BRUNT_MAX_IMAGES][3];
    real sign[BRUNT_MAX_IMAGES][3];
    int images = brunt_symmetry_images(mirrors, mirror_count, at, grid->order, image, sign);
    for (int m = 0; m < images; m++) {
        real *node = brunt_grid_node(grid, image[m]);
        if (!node || !(node[BRUNT_NODE_MASS] > 0)) continue;
        entry *e = find_entry(w, first, find_support(w, grid, node));
        if (m == 0) e->weight += N;
        for (int a = 0; a < 3; a++) e->apply[a] += (double)sign[m][a] * N;
    }
}

// Nodes and weights under particle `s` of block `b`. 0, or -1: out of memory.
static int add_entries(brunt_wall_workspace *w, brunt_body *body, int32_t b, int64_t s,
                       const brunt_symmetry_plane *mirrors, int mirror_count) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, n = grid->order + 1;
    const size_t room = 64 * BRUNT_MAX_IMAGES;
    if (BRUNT_RESERVE(w->entries, (size_t)w->entry_count + room, (size_t)w->entry_count) ||
        BRUNT_RESERVE(w->supports, (size_t)w->support_count + room, (size_t)w->support_count))
        return -1;
    int32_t base[3], first = w->entry_count;
    double u[3], weight[3][4];
    place_kernel(body, b, s, base, u, weight);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < (dim == 3 ? n : 1); k++) {
                const double N = weight[0][i] * weight[1][j] * weight[2][k];
                const int32_t at[3] = {base[0] + i, base[1] + j, base[2] + k};
                if (mirror_count) {
                    add_images(w, grid, first, at, N, mirrors, mirror_count);
                    continue;
                }
                real *node = block_node(grid, &grid->blocks[b], at);
                if (!(node[BRUNT_NODE_MASS] > 0)) continue;
                const int32_t found = find_support(w, grid, node);
                w->entries[w->entry_count++] = (entry){found, (i * n + j) * n + k, N, {N, N, N, 0}};
            }
    return 0;
}

// Beside mirrors: a node and its images.
static void add_lever(brunt_wall_workspace *w, const brunt_grid *grid, const touch *t, const int32_t at[3], double N,
                      const brunt_symmetry_plane *mirrors, int mirror_count) {
    int32_t image[BRUNT_MAX_IMAGES][3];
    real sign[BRUNT_MAX_IMAGES][3];
    int images = brunt_symmetry_images(mirrors, mirror_count, at, grid->order, image, sign);
    for (int m = 0; m < images; m++) {
        const real *node = brunt_grid_node(grid, image[m]);
        if (!node || !(node[BRUNT_NODE_MASS] > 0)) continue;
        const int32_t found = w->index[(node - grid->nodes) / BRUNT_NODE_REALS] - 1;
        int32_t e = 0;
        while (w->entries[t->first + e].support != found) e++;
        lever *to = &w->levers[t->levers + e];
        if (m == 0) to->weight += N;
        for (int a = 0; a < 3; a++) to->apply[a] += (double)sign[m][a] * N;
    }
}

// Levers of the entries of a touch, which add_entries has made; `arm`: from the particle to its surface, where its
// kernel lives [m]. 0, or -1: out of memory.
static int add_levers(brunt_wall_workspace *w, const brunt_body *body, int32_t b, touch *t, const double arm[3],
                      const brunt_symmetry_plane *mirrors, int mirror_count) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, n = grid->order + 1;
    const size_t used = (size_t)w->lever_count;
    if (BRUNT_RESERVE(w->levers, used + (size_t)t->count, used)) return -1;
    t->levers = w->lever_count, w->lever_count += t->count;
    lever *levers = w->levers + t->levers;
    memset(levers, 0, (size_t)t->count * sizeof *levers);
    int32_t base[3];
    double u[3], weight[3][4], slope[3][4] = {{0}}, N[64] = {0};
    place_kernel(body, b, t->slot, base, u, weight);
    for (int a = 0; a < dim; a++) {
        brunt_bspline_levers(grid->order, u[a], weight[a], slope[a]);
        for (int i = 0; i < n; i++) slope[a][i] *= arm[a] / (double)grid->h;
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < (dim == 3 ? n : 1); k++)
                N[(i * n + j) * n + k] = (weight[0][i] + slope[0][i]) * weight[1][j] * weight[2][k] +
                                         weight[0][i] * (slope[1][j] * weight[2][k] + weight[1][j] * slope[2][k]);
    for (int32_t e = 0; e < t->count && !mirror_count; e++) {
        const double rub = N[w->entries[t->first + e].number];
        levers[e] = (lever){rub, {rub, rub, rub, 0}};
    }
    for (int m = 0; m < n * n * n && mirror_count; m++) {
        const int32_t at[3] = {base[0] + m / (n * n), base[1] + m / n % n, base[2] + m % n};
        if (dim == 3 || m % n == 0) add_lever(w, grid, t, at, N[m], mirrors, mirror_count);
    }
    return 0;
}

static quad particle_velocity(const brunt_wall_workspace *w, const touch *t) {
    quad v = {0};
    for (int32_t e = t->first; e < t->first + t->count; e++)
        v += w->entries[e].weight * w->supports[w->entries[e].support].v;
    return v;
}

// Beside it that at the surface, of a touch with levers.
static quad surface_velocity(const brunt_wall_workspace *w, const touch *t, quad *at_surface) {
    quad v = {0}, u = {0};
    const entry *e = &w->entries[t->first];
    const lever *l = &w->levers[t->levers];
    for (const entry *end = e + t->count; e < end; e++, l++) {
        const quad node = w->supports[e->support].v;
        v += e->weight * node, u += l->weight * node;
    }
    *at_surface = u;
    return v;
}

// Particles that the plane would catch in this step.
static int find_touches(const brunt_contact_context *m, brunt_wall_workspace *w, brunt_body *body, int index) {
    const double time = m->time, dt = m->dt;
    const brunt_grid *grid = &body->grid;
    const brunt_plane_def *plane = &m->walls[index].plane;
    brunt_particles *p = &body->particles;
    const int dim = grid->dim, stride = p->point_dim;
    const double h = (double)grid->h;
    real *const *x = brunt_field(p, BRUNT_FIELD_position), *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    const real *reach = brunt_field(p, BRUNT_FIELD_reach)[0];
    double offset = 0, wall_speed = 0, half = 0;
    for (int a = 0; a < dim; a++) {
        offset += plane->normal[a] * (plane->point[a] + plane->velocity[a] * time);
        wall_speed += plane->normal[a] * plane->velocity[a];
        half += fabs(plane->normal[a]) * (0.5 * grid->side + 2) * h;
    }
    const double near = fmax(NEAR * h, ((double)body->speed + fabs(wall_speed)) * dt);
    for (int32_t b = 0; b < grid->block_count; b++) {
        const brunt_block *block = &grid->blocks[b];
        double middle = -offset;
        for (int a = 0; a < dim; a++)
            middle += plane->normal[a] * (grid->origin[a] + h * (block->coord[a] + 0.5) * grid->side);
        if (middle > half + near + 4 * h && !brunt_total_lagrangian(p)) continue;
        for (int64_t s = block->first; s < block->first + block->count; s++) {
            double distance = -offset, square = 0;
            for (int a = 0; a < dim; a++) distance += plane->normal[a] * (double)x[a][s];
            if (distance > near + 4 * h) continue;
            for (int c = 0; c < dim; c++) {
                double t = 0;
                for (int r = 0; r < dim; r++) t += (double)F[r * stride + c][s] * plane->normal[r];
                square += t * t;
            }
            double gap = distance - (double)reach[s] * sqrt(square);
            if (gap > near) continue;
            if (BRUNT_RESERVE(w->touches, (size_t)(w->touch_count + 1), (size_t)w->touch_count)) return -1;
            touch *t = &w->touches[w->touch_count];
            *t = (touch){.slot = s,
                         .wall = index,
                         .first = w->entry_count,
                         .levers = -1,
                         .target = wall_speed - fmax(gap, 0) / dt};
            if (add_entries(w, body, b, s, m->mirrors, m->mirror_count)) return -1;
            t->count = w->entry_count - t->first;
            const quad v = particle_velocity(w, t);
            double approach = 0;
            for (int a = 0; a < dim; a++) approach += plane->normal[a] * v[a];
            if (approach > t->target + 1e-6 * h / dt)
                w->entry_count = t->first;
            else if (w->touch_count++, plane->friction > 0) {
                double arm[3], kernel_arm[3];
                brunt_extent_arm(body, s, plane->normal, distance, arm, kernel_arm);
                if (add_levers(w, body, b, t, kernel_arm, m->mirrors, m->mirror_count)) return -1;
            }
        }
    }
    return 0;
}

// Adds what a touch with a lever applies to the nodes along each axis. `crossed`: its friction works along what others
// push.
static void load_levers(brunt_wall_workspace *w, const touch *t, int dim, bool crossed) {
    for (int32_t e = 0; e < t->count; e++) {
        const entry *along = &w->entries[t->first + e];
        const quad rub = w->levers[t->levers + e].apply;
        support *s = &w->supports[along->support];
        for (int a = 0; a < dim; a++) {
            s->lever[a] += fabs(rub[a]);
            if (crossed) s->weight[a] += fmax(fabs(rub[a]) - along->apply[a], 0);
        }
    }
}

// Row sums of the coupling matrix: the velocity a particle gains when every touching particle gets one unit of impulse.
// On one plane pushes and friction are at right angles, and do not couple.
static void prepare(brunt_wall_workspace *w, const brunt_wall *walls, int dim) {
    const bool crossed = w->touches[0].wall != w->touches[w->touch_count - 1].wall;
    for (int32_t e = 0; e < w->entry_count; e++)
        for (int a = 0; a < dim; a++) w->supports[w->entries[e].support].weight[a] += w->entries[e].apply[a];
    for (int32_t k = 0; k < w->touch_count && w->lever_count; k++)
        if (w->touches[k].levers >= 0) load_levers(w, &w->touches[k], dim, crossed);
    for (int32_t k = 0; k < w->touch_count; k++) {
        touch *t = &w->touches[k];
        const double *n = walls[t->wall].plane.normal;
        double along[3] = {0}, across[3] = {0};
        for (int32_t e = t->first; e < t->first + t->count; e++) {
            const support *s = &w->supports[w->entries[e].support];
            for (int a = 0; a < dim; a++) along[a] += w->entries[e].weight * s->weight[a] * s->inverse_mass;
            if (t->levers < 0) continue;
            const double size = fabs(w->levers[t->levers + e - t->first].weight),
                         rub = crossed ? fmax(size, w->entries[e].weight) : size;
            for (int a = 0; a < dim; a++) across[a] += rub * (crossed ? s->weight : s->lever)[a] * s->inverse_mass;
        }
        for (int a = 0; a < dim; a++)
            t->response += n[a] * n[a] * along[a], t->response_t = fmax(t->response_t, across[a]);
        if (crossed && t->levers >= 0) t->response = fmax(t->response, t->response_t);
    }
}

// Brings one particle to its condition, as far as it is concerned; returns the velocity this is worth [m/s].
static double visit(brunt_wall_workspace *w, touch *t, const brunt_plane_def *plane, int dim) {
    double normal_velocity = 0, wall_normal = 0;
    quad u = {0}, v = t->levers < 0 ? particle_velocity(w, t) : surface_velocity(w, t, &u), J = {0}, rub = {0};
    for (int a = 0; a < dim; a++)
        normal_velocity += plane->normal[a] * v[a], wall_normal += plane->normal[a] * plane->velocity[a];
    double normal_impulse = fmax(0, t->normal_impulse + (t->target - normal_velocity) / t->response),
           step = normal_impulse - t->normal_impulse;
    t->normal_impulse = normal_impulse;
    double changed = fabs(step) * t->response;
    for (int a = 0; a < dim; a++) J[a] = step * plane->normal[a];
    if (plane->friction > 0) {
        double wanted[3], change[3];
        normal_velocity = 0;
        for (int a = 0; a < dim; a++) normal_velocity += plane->normal[a] * u[a];
        for (int a = 0; a < dim; a++) {
            double slip = u[a] - plane->velocity[a] - (normal_velocity - wall_normal) * plane->normal[a];
            wanted[a] = t->friction_impulse[a] - slip / t->response_t;
        }
        brunt_coulomb_project(dim, plane->friction, normal_impulse, wanted, t->friction_impulse, change);
        for (int a = 0; a < dim; a++) rub[a] = change[a];
        changed = fmax(changed, brunt_coulomb_norm(dim, change) * t->response_t);
    }
    if (!(changed > 0)) return changed;
    const entry *e = &w->entries[t->first], *const end = e + t->count;
    if (t->levers < 0) {
        for (; e < end; e++) w->supports[e->support].impulse += e->apply * J;
        return changed;
    }
    for (const lever *l = &w->levers[t->levers]; e < end; e++, l++)
        w->supports[e->support].impulse += e->apply * J + l->apply * rub;
    return changed;
}

static void give_impulses(brunt_wall_workspace *w, int dim) {
    for (int32_t k = 0; k < w->support_count; k++) {
        support *s = &w->supports[k];
        for (int a = 0; a < dim; a++) {
            real *v = &s->node[BRUNT_NODE_VELOCITY + a];
            *v += (real)(s->impulse[a] * s->inverse_mass);
            s->v[a] = (double)*v;
        }
        s->impulse = (quad){0};
    }
}

// Where a node of a total-Lagrangian body is now, as the particle that touches sees it: x_p + F (X_i - X_p).
static void deformed_place(brunt_body *body, int64_t s, double x[3]) {
    brunt_particles *p = &body->particles;
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient), *const *X = brunt_kernel_place(p),
                *const *here = brunt_field(p, BRUNT_FIELD_position);
    double now[3] = {0};
    for (int r = 0; r < p->dim; r++) {
        now[r] = (double)here[r][s];
        for (int c = 0; c < p->dim; c++) now[r] += (double)F[r * p->dim + c][s] * (x[c] - (double)X[c][s]);
    }
    memcpy(x, now, sizeof now);
}

// Booked node by node: near mirror planes a node keeps only the body's own share of what it is given, the rest is the
// mirror's reaction.
static void book(const brunt_wall_workspace *w, brunt_body *body, brunt_wall *walls) {
    const brunt_grid *grid = &body->grid;
    for (int32_t k = 0; k < w->touch_count; k++) {
        const touch *t = &w->touches[k];
        brunt_wall *wall = &walls[t->wall];
        if (!(t->normal_impulse > 0)) continue;
        for (int32_t e = t->first; e < t->first + t->count; e++) {
            const real *n = w->supports[w->entries[e].support].node;
            int64_t number = (n - grid->nodes) / BRUNT_NODE_REALS;
            double normal_impulse[3] = {0}, friction_impulse[3] = {0}, x[3], old[3] = {0}, now[3] = {0};
            double own = (double)(n[BRUNT_NODE_SPARE] / n[BRUNT_NODE_MASS]);
            brunt_node_position(grid, grid->slots[number / BRUNT_BLOCK_NODES].coord, (int)(number % BRUNT_BLOCK_NODES),
                                x);
            if (brunt_total_lagrangian(&body->particles)) deformed_place(body, t->slot, x);
            for (int a = 0; a < grid->dim; a++) {
                normal_impulse[a] = own * w->entries[e].apply[a] * t->normal_impulse * wall->plane.normal[a];
                if (t->levers >= 0)
                    friction_impulse[a] = own * w->levers[t->levers + e - t->first].apply[a] * t->friction_impulse[a];
                old[a] = (double)n[BRUNT_NODE_OLD + a], now[a] = (double)n[BRUNT_NODE_VELOCITY + a];
            }
            brunt_impulse_account *last = &wall->last;
            brunt_impulse_account_book(last, &last->normal_loss, normal_impulse, x, old, now, wall->plane.velocity);
            if (wall->plane.friction > 0)
                brunt_impulse_account_book(last, &last->friction_loss, friction_impulse, x, old, now,
                                           wall->plane.velocity);
        }
    }
}

int brunt_planes_apply(const brunt_contact_context *m, brunt_body *body, brunt_wall_workspace **workspace) {
    brunt_wall *walls = m->walls;
    if (!*workspace) *workspace = brunt_alloc(sizeof **workspace);
    brunt_wall_workspace *w = *workspace;
    if (!w || BRUNT_RESERVE(w->index, (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES, 0)) return -1;
    w->touch_count = w->entry_count = w->lever_count = w->support_count = 0;
    int failed = 0;
    for (int k = 0; k < m->wall_count && !failed; k++) {
        if (walls[k].region || walls[k].plane.condition != BRUNT_SEPARATE) continue;
        if (walls[k].body >= 0 && walls[k].body != body->index) continue;
        failed = find_touches(m, w, body, k);
    }
    if (!failed && w->touch_count) {
        double first = 0;
        prepare(w, walls, body->grid.dim);
        for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
            double greatest = 0;
            for (int32_t k = 0; k < w->touch_count; k++)
                greatest = fmax(greatest, visit(w, &w->touches[k], &walls[w->touches[k].wall].plane, body->grid.dim));
            give_impulses(w, body->grid.dim);
            first = fmax(first, greatest);
            if (greatest <= SWEEP_TOLERANCE * first) break;
        }
        book(w, body, walls);
    }
    for (int32_t k = 0; k < w->support_count; k++)
        w->index[(w->supports[k].node - body->grid.nodes) / BRUNT_NODE_REALS] = 0;
    return failed;
}
