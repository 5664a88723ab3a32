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
// Tried and left: conditions on the nodes behind the plane (the surface then depends on where the plane cuts the cells,
// by up to half a cell); Gauss-Seidel (the first particle visited takes the load of its neighbours, who need 50 to 200
// sweeps to take it back, against about 10 here).
#include <math.h>
#include <string.h>

#include "contact.h"
#include "memory.h"
#include "transfer.h"

enum { MAX_SWEEPS = 16 };
static const double SWEEP_TOLERANCE =
    1e-2; // of the greatest correction of velocity in the first sweep: what is left is met again next step
static const double NEAR = 0.5; // cells: how far from a plane particles are looked at, if nothing moves faster

// A node under touching particles.
typedef struct support {
    real *node;
    double inverse_mass, weight[3]; // [1/kg]; sum of what the particles apply to it, along each axis
    double impulse[3];              // [N s] of the sweep
} support;

// A node under one touching particle. With mirror planes near by, the particle's images act too: `apply` differs from
// `weight`.
typedef struct entry {
    int32_t support;
    double weight, apply[3];
} entry;

typedef struct touch {
    int64_t slot; // particle
    int wall;
    int32_t first, count;        // its entries
    double target;               // [m/s] least velocity along the normal
    double response, response_t; // [1/kg] row sums: along the normal, tangential
    double push;                 // [N s] along the normal
    double drag[3];              // [N s] tangential
} touch;

struct brunt_wall_workspace {
    touch *touches;
    size_t touches_capacity;
    int32_t touch_count;
    entry *entries;
    size_t entries_capacity;
    int32_t entry_count;
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
    brunt_free(workspace->supports);
    brunt_free(workspace->index);
    brunt_free(workspace);
}

static int32_t find_support(brunt_wall_workspace *w, const brunt_grid *grid, real *node) {
    int32_t *index = &w->index[(node - grid->nodes) / BRUNT_NODE_REALS];
    if (!*index) {
        w->supports[w->support_count] = (support){.node = node, .inverse_mass = 1 / (double)node[BRUNT_NODE_MASS]};
        *index = ++w->support_count;
    }
    return *index - 1;
}

static entry *find_entry(brunt_wall_workspace *w, int32_t first, int32_t at) {
    for (int32_t e = first; e < w->entry_count; e++)
        if (w->entries[e].support == at) return &w->entries[e];
    entry *fresh = &w->entries[w->entry_count++];
    *fresh = (entry){.support = at};
    return fresh;
}

// Nodes and weights under particle `s` of block `b`. 0, or -1: out of memory.
static int add_entries(brunt_wall_workspace *w, brunt_body *body, int32_t b, int64_t s, const brunt_mirror *mirrors,
                       int mirror_count) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, n = grid->order + 1;
    const size_t room = 64 * BRUNT_MAX_IMAGES;
    if (brunt_reserve((void **)&w->entries, &w->entries_capacity, ((size_t)w->entry_count + room) * sizeof(entry),
                      (size_t)w->entry_count * sizeof(entry)) ||
        brunt_reserve((void **)&w->supports, &w->supports_capacity, ((size_t)w->support_count + room) * sizeof(support),
                      (size_t)w->support_count * sizeof(support)))
        return -1;
    int local[3];
    int32_t base[3] = {0, 0, 0}, first = w->entry_count;
    double weight[3][4] = {{1}, {1}, {1}};
    brunt_node_local(grid, body->particles.bin[s], local);
    real *const *x = brunt_kernel_place(&body->particles);
    for (int a = 0; a < dim; a++) {
        base[a] = grid->blocks[b].coord[a] * grid->side + local[a];
        brunt_kernel_weights(grid->order, ((double)x[a][s] - grid->origin[a]) / (double)grid->h - base[a], weight[a]);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < (dim == 3 ? n : 1); k++) {
                double N = weight[0][i] * weight[1][j] * weight[2][k];
                const int32_t at[3] = {base[0] + i, base[1] + j, base[2] + k};
                int32_t image[BRUNT_MAX_IMAGES][3];
                real sign[BRUNT_MAX_IMAGES][3];
                int images = brunt_mirror_images(mirrors, mirror_count, at, grid->order, image, sign);
                for (int m = 0; m < images; m++) {
                    real *node = brunt_grid_node(grid, image[m]);
                    if (!node || !(node[BRUNT_NODE_MASS] > 0)) continue;
                    int32_t found = find_support(w, grid, node);
                    entry *e = &w->entries[w->entry_count];
                    if (mirror_count)
                        e = find_entry(w, first, found);
                    else
                        *e = (entry){.support = found}, w->entry_count++;
                    if (m == 0) e->weight += N;
                    for (int a = 0; a < 3; a++) e->apply[a] += (double)sign[m][a] * N;
                }
            }
    return 0;
}

static void particle_velocity(const brunt_wall_workspace *w, const touch *t, int dim, double v[3]) {
    v[0] = v[1] = v[2] = 0;
    for (int32_t e = t->first; e < t->first + t->count; e++) {
        const real *node = w->supports[w->entries[e].support].node;
        for (int a = 0; a < dim; a++) v[a] += w->entries[e].weight * (double)node[BRUNT_NODE_VELOCITY + a];
    }
}

static double fastest(const brunt_body *body) {
    double speed = 0;
    for (int32_t b = 0; b < body->grid.block_count; b++) speed = fmax(speed, (double)body->report[b].speed);
    return speed;
}

// Particles that the plane would catch in this step.
static int find_touches(brunt_wall_workspace *w, brunt_body *body, const brunt_wall *walls, int index,
                        const brunt_mirror *mirrors, int mirror_count, double time, double dt) {
    const brunt_grid *grid = &body->grid;
    const brunt_plane_def *plane = &walls[index].plane;
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
    const double near = fmax(NEAR * h, (fastest(body) + fabs(wall_speed)) * dt);
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
            if (brunt_reserve((void **)&w->touches, &w->touches_capacity, (size_t)(w->touch_count + 1) * sizeof(touch),
                              (size_t)w->touch_count * sizeof(touch)))
                return -1;
            touch *t = &w->touches[w->touch_count];
            *t = (touch){.slot = s, .wall = index, .first = w->entry_count, .target = wall_speed - fmax(gap, 0) / dt};
            if (add_entries(w, body, b, s, mirrors, mirror_count)) return -1;
            t->count = w->entry_count - t->first;
            double v[3], approach = 0;
            particle_velocity(w, t, dim, v);
            for (int a = 0; a < dim; a++) approach += plane->normal[a] * v[a];
            if (approach > t->target + 1e-6 * h / dt)
                w->entry_count = t->first;
            else
                w->touch_count++;
        }
    }
    return 0;
}

// Row sums of the coupling matrix: the velocity a particle gains when every touching particle gets one unit of impulse.
static void prepare(brunt_wall_workspace *w, const brunt_wall *walls, int dim) {
    for (int32_t e = 0; e < w->entry_count; e++)
        for (int a = 0; a < dim; a++) w->supports[w->entries[e].support].weight[a] += w->entries[e].apply[a];
    for (int32_t k = 0; k < w->touch_count; k++) {
        touch *t = &w->touches[k];
        const double *n = walls[t->wall].plane.normal;
        double along[3] = {0};
        for (int32_t e = t->first; e < t->first + t->count; e++) {
            const support *s = &w->supports[w->entries[e].support];
            for (int a = 0; a < dim; a++) along[a] += w->entries[e].weight * s->weight[a] * s->inverse_mass;
        }
        for (int a = 0; a < dim; a++)
            t->response += n[a] * n[a] * along[a], t->response_t = fmax(t->response_t, along[a]);
    }
}

// Brings one particle to its condition, as far as it is concerned; returns the velocity this is worth [m/s].
static double visit(brunt_wall_workspace *w, touch *t, const brunt_plane_def *plane, int dim) {
    double v[3], J[3] = {0}, normal_velocity = 0, wall_normal = 0;
    particle_velocity(w, t, dim, v);
    for (int a = 0; a < dim; a++)
        normal_velocity += plane->normal[a] * v[a], wall_normal += plane->normal[a] * plane->velocity[a];
    double push = fmax(0, t->push + (t->target - normal_velocity) / t->response), step = push - t->push;
    t->push = push;
    double changed = fabs(step) * t->response;
    for (int a = 0; a < dim; a++) J[a] = step * plane->normal[a];
    if (plane->friction > 0) {
        double drag[3], size = 0, moved = 0;
        for (int a = 0; a < dim; a++) {
            double slip = v[a] - plane->velocity[a] - (normal_velocity - wall_normal) * plane->normal[a];
            drag[a] = t->drag[a] - slip / t->response_t;
            size += drag[a] * drag[a];
        }
        size = sqrt(size);
        double most = plane->friction * push, scale = size > most ? most / size : 1;
        for (int a = 0; a < dim; a++) {
            double now = scale * drag[a], add = now - t->drag[a];
            J[a] += add;
            moved += add * add;
            t->drag[a] = now;
        }
        changed = fmax(changed, sqrt(moved) * t->response_t);
    }
    if (changed > 0)
        for (int32_t e = t->first; e < t->first + t->count; e++) {
            support *s = &w->supports[w->entries[e].support];
            for (int a = 0; a < dim; a++) s->impulse[a] += w->entries[e].apply[a] * J[a];
        }
    return changed;
}

static void give_impulses(brunt_wall_workspace *w, int dim) {
    for (int32_t k = 0; k < w->support_count; k++) {
        support *s = &w->supports[k];
        for (int a = 0; a < dim; a++) {
            s->node[BRUNT_NODE_VELOCITY + a] += (real)(s->impulse[a] * s->inverse_mass);
            s->impulse[a] = 0;
        }
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
        if (!(t->push > 0)) continue;
        for (int32_t e = t->first; e < t->first + t->count; e++) {
            const real *n = w->supports[w->entries[e].support].node;
            int64_t number = (n - grid->nodes) / BRUNT_NODE_REALS;
            double push[3] = {0}, drag[3] = {0}, x[3], old[3] = {0}, now[3] = {0};
            double own = (double)(n[BRUNT_NODE_SPARE] / n[BRUNT_NODE_MASS]);
            brunt_node_position(grid, grid->slots[number / BRUNT_BLOCK_NODES].coord, (int)(number % BRUNT_BLOCK_NODES),
                                x);
            if (brunt_total_lagrangian(&body->particles)) deformed_place(body, t->slot, x);
            for (int a = 0; a < grid->dim; a++) {
                double share = own * w->entries[e].apply[a];
                push[a] = share * t->push * wall->plane.normal[a], drag[a] = share * t->drag[a];
                old[a] = (double)n[BRUNT_NODE_OLD + a], now[a] = (double)n[BRUNT_NODE_VELOCITY + a];
            }
            brunt_action *last = &wall->last;
            brunt_action_book(last, &last->normal_loss, push, x, old, now, wall->plane.velocity);
            if (wall->plane.friction > 0)
                brunt_action_book(last, &last->friction_loss, drag, x, old, now, wall->plane.velocity);
        }
    }
}

int brunt_walls_apply(brunt_body *body, brunt_wall *walls, int wall_count, const brunt_mirror *mirrors,
                      int mirror_count, double time, double dt, brunt_wall_workspace **workspace) {
    if (!*workspace) *workspace = brunt_alloc(sizeof **workspace);
    brunt_wall_workspace *w = *workspace;
    if (!w || brunt_reserve((void **)&w->index, &w->index_capacity,
                            (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES * sizeof *w->index, 0))
        return -1;
    w->touch_count = w->entry_count = w->support_count = 0;
    int failed = 0;
    for (int k = 0; k < wall_count && !failed; k++) {
        if (walls[k].region || walls[k].plane.condition != BRUNT_SEPARATE) continue;
        if (walls[k].body >= 0 && walls[k].body != body->index) continue;
        failed = find_touches(w, body, walls, k, mirrors, mirror_count, time, dt);
    }
    if (!failed && w->touch_count) {
        double first = 0;
        prepare(w, walls, body->grid.dim);
        for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
            double most = 0;
            for (int32_t k = 0; k < w->touch_count; k++)
                most = fmax(most, visit(w, &w->touches[k], &walls[w->touches[k].wall].plane, body->grid.dim));
            give_impulses(w, body->grid.dim);
            first = fmax(first, most);
            if (most <= SWEEP_TOLERANCE * first) break;
        }
        book(w, body, walls);
    }
    for (int32_t k = 0; k < w->support_count; k++)
        w->index[(w->supports[k].node - body->grid.nodes) / BRUNT_NODE_REALS] = 0;
    return failed;
}
