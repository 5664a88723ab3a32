// Material points that face the surfaces of meshes: each that is near looks for the facet it would pass, and becomes a
// contact point whose slave is the grid's velocity at its place.
//
// Friction acts at the particle's surface, not at its centre, half a spacing inside: where a pair has friction its
// points have levers (points.h), with the weights of the velocity extended affinely to there.
//
// The looking is done block by block, by any thread; the points are then made in the order of the blocks. Where a
// mirror plane is near, a node and its images have one velocity, turned over: they are one support, and what a point
// gives it is the sum of the weights of all of them, each turned over, since the image of the point presses too. A node
// on the plane moves along it only. Tangentially the body then gets all of the impulse; what is missing across the
// plane is what the mirror bears.
#include "contact/search/node_to_facet_parts.h"

#include "mpm/mpm_body.h"
#include "grid/bspline.h"
#include "mpm/particles.h"
#include "base/parallel.h"

enum { MAX_NODES = 64, IMAGE_LAYERS = 2, MAX_MIRRORS = 16 };

// Share of what the load of a step brings that a shallow depth may be pushed out against it. Particles that flow along
// a surface are a little behind it all the time: with all of it, as nodes have, a nose that is pushed through a plate
// gave the plate 5 % of its own energy out of nothing. What rests needs only what unfinished sweeps leave, and stays
// where it is with this.
static const double LIFT = 0.02;

typedef struct job {
    const brunt_contact_context *m;
    brunt_node_to_facet *f;
    brunt_body *body;
    int32_t box;
} job;

typedef struct nodes {
    int count;
    real *node[MAX_NODES];
    int32_t at[MAX_NODES][3];
    double weight[MAX_NODES];
} nodes;

// Nodes and weights under particle `s` of block `b`, or at an arm's length from it [m]; NULL: none.
static void particle_nodes(const brunt_body *body, int32_t b, int64_t s, const double *arm, nodes *out) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, n = grid->order + 1;
    int local[3];
    int32_t base[3] = {0, 0, 0};
    double w[3][4] = {{1}, {1}, {1}}, lever[3][4] = {{0}};
    out->count = 0;
    brunt_node_local(grid, body->particles.bin[s], local);
    real *const *x = brunt_kernel_place(&body->particles);
    for (int a = 0; a < dim; a++) {
        base[a] = grid->blocks[b].coord[a] * grid->side + local[a];
        const double u = ((double)x[a][s] - grid->origin[a]) / (double)grid->h - base[a];
        brunt_bspline_weights(grid->order, u, w[a]);
        if (!arm) continue;
        brunt_bspline_levers(grid->order, u, w[a], lever[a]);
        for (int i = 0; i < n; i++) lever[a][i] *= arm[a] / (double)grid->h;
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            for (int l = 0; l < (dim == 3 ? n : 1); l++) {
                const int32_t at[3] = {base[0] + i, base[1] + k, base[2] + l};
                real *found = brunt_grid_node(grid, at);
                if (!found || !(found[BRUNT_NODE_MASS] > 0)) continue;
                memcpy(out->at[out->count], at, sizeof at);
                out->node[out->count] = found;
                double weight = w[0][i] * w[1][k] * w[2][l];
                if (arm)
                    weight += lever[0][i] * w[1][k] * w[2][l] + w[0][i] * lever[1][k] * w[2][l] +
                              w[0][i] * w[1][k] * lever[2][l];
                out->weight[out->count++] = weight;
            }
}

// ------------------------------------------------------------------------------------------ looking

// Keeps a hit that the particle would pass in this step. 0, or -1: out of memory.
static int note_sight(const job *j, struct sight *sight, int32_t b, int64_t s, const double x[3], const hit *h) {
    const brunt_contact_surface *skin = j->m->skin;
    nodes under;
    double v[3] = {0}, old[3] = {0};
    particle_nodes(j->body, b, s, NULL, &under);
    for (int e = 0; e < under.count; e++)
        for (int a = 0; a < j->body->grid.dim; a++) {
            v[a] += under.weight[e] * (double)under.node[e][BRUNT_NODE_VELOCITY + a];
            old[a] += under.weight[e] * (double)under.node[e][BRUNT_NODE_OLD + a];
        }
    const double approach = brunt_node_to_facet_approach(skin, h, x, v, skin->v);
    const double before = brunt_node_to_facet_approach(skin, h, x, old, skin->old);
    const double target = brunt_node_to_facet_target(skin, h->gap, fmin(before, LIFT * approach), before, j->m->dt);
    if (!(approach < target + 1e-6 * skin->mean_edge / j->m->dt)) return 0;
    const size_t used = (size_t)sight->count;
    if (BRUNT_RESERVE_IN(sight->seen, sight->capacity, used + 1, used)) return -1;
    struct seen *seen = &sight->seen[sight->count++];
    *seen = (struct seen){.block = b, .particle = s, .h = *h};
    memcpy(seen->x, x, sizeof seen->x);
    seen->h.target = target;
    return 0;
}

// How far the ball of material about a particle reaches along n [m].
static double reach_along(brunt_body *body, int64_t s, const double n[3]) {
    const int dim = body->grid.dim, stride = body->particles.point_dim;
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    double square = 0;
    for (int c = 0; c < dim; c++) {
        double t = 0;
        for (int r = 0; r < dim; r++) t += (double)F[r * stride + c][s] * n[r];
        square += t * t;
    }
    return (double)brunt_field(&body->particles, BRUNT_FIELD_reach)[0][s] * sqrt(square);
}

static int look_from_block(const job *j, int32_t b, struct sight *sight) {
    brunt_node_to_facet *f = j->f;
    const brunt_grid *grid = &j->body->grid;
    const int dim = grid->dim;
    double low[3] = {0}, high[3] = {0};
    for (int a = 0; a < dim; a++) {
        low[a] = grid->origin[a] + (double)grid->h * grid->blocks[b].coord[a] * grid->side;
        high[a] = low[a] + (double)grid->h * (grid->side + 1);
    }
    real *const *place = brunt_field(&j->body->particles, BRUNT_FIELD_position);
    if (brunt_total_lagrangian(&j->body->particles)) brunt_body_block_bounds(j->body, b, low, high);
    if (!brunt_node_to_facet_in_reach(f, j->box, low, high, f->range)) return 0;
    for (int64_t s = grid->blocks[b].first; s < grid->blocks[b].first + grid->blocks[b].count; s++) {
        double x[3] = {0}, distance, second;
        for (int a = 0; a < dim; a++) x[a] = (double)place[a][s];
        slave_hits found;
        looker l = {.box = j->box, .body = j->body->index, .x = x};
        if (!brunt_node_to_facet_look(f, &l)) continue;
        brunt_node_to_facet_look_around(j->m, f, &l, -1, &found, &distance, &second);
        for (int32_t q = 0; q < found.count; q++) {
            found.hits[q].gap -= reach_along(j->body, s, found.hits[q].n);
            if (found.hits[q].gap <= f->reach && note_sight(j, sight, b, s, x, &found.hits[q])) return -1;
        }
    }
    return 0;
}

static void look_from_blocks(void *context, int64_t begin, int64_t end, int worker) {
    const job *j = context;
    struct sight *sight = &j->f->sight[worker];
    for (int64_t b = begin; b < end; b++) {
        j->f->run[b] = (struct run){.worker = worker, .first = sight->count};
        if (look_from_block(j, (int32_t)b, sight)) sight->failed = true;
        j->f->run[b].count = sight->count - j->f->run[b].first;
    }
}

// ------------------------------------------------------------------------------------------ supports

// The mirrors that act on a body.
static int mirrors_of(const brunt_contact_context *m, const brunt_body *body, brunt_symmetry_plane out[MAX_MIRRORS]) {
    int count = 0;
    for (int k = 0; k < m->mirror_count && count < MAX_MIRRORS; k++) {
        int on = m->mirrors[k].wall < 0 ? -1 : m->walls[m->mirrors[k].wall].body;
        if (on < 0 || on == body->index) out[count++] = m->mirrors[k];
    }
    return count;
}

// Makes the support of a node and of its images. 0, or -1: out of memory.
static int make_support(brunt_node_to_facet *f, const brunt_body *body, int k, const brunt_symmetry_plane *mirrors,
                        int mirror_count, const int32_t at[3], brunt_constraint_set *points) {
    int32_t image[BRUNT_MAX_IMAGES][3];
    real sign[BRUNT_MAX_IMAGES][3];
    int images = brunt_symmetry_images(mirrors, mirror_count, at, IMAGE_LAYERS, image, sign);
    int32_t support = brunt_constraints_dof_node(points);
    if (support < 0) return -1;
    for (int i = 0; i < images; i++) {
        real *node = brunt_grid_node(&body->grid, image[i]);
        if (!node || !(node[BRUNT_NODE_MASS] > 0)) continue;
        int64_t number = (node - body->grid.nodes) / BRUNT_NODE_REALS;
        if (BRUNT_GROW(f->grid)) return -1;
        struct grid_support *entry = &f->grid[f->grid_count];
        *entry = (struct grid_support){.mpm = k, .node = number, .support = support};
        for (int a = 0; a < 3; a++) entry->sign[a] = (double)sign[i][a];
        f->node_support[k][number] = ++f->grid_count;
        for (int a = 0; a < body->grid.dim && i == 0; a++) {
            points->support[support].v[a] = (double)node[BRUNT_NODE_VELOCITY + a];
            points->support[support].old[a] = (double)node[BRUNT_NODE_OLD + a];
            points->support[support].inverse[a] =
                sign[0][a] != 0 && !brunt_node_held(&body->grid, number, a) ? 1 / (double)node[BRUNT_NODE_MASS] : 0;
        }
    }
    return 0;
}

// Entries of the slave: of each support the weights of all its nodes, turned over as they are.
static int add_slave(brunt_node_to_facet *f, const brunt_body *body, int k, const brunt_symmetry_plane *mirrors,
                     int mirror_count, const nodes *under, brunt_constraint_set *points) {
    const int32_t first = points->entry_count;
    for (int e = 0; e < under->count; e++) {
        const int64_t number = (under->node[e] - body->grid.nodes) / BRUNT_NODE_REALS;
        if (!f->node_support[k][number] && make_support(f, body, k, mirrors, mirror_count, under->at[e], points))
            return -1;
        const struct grid_support *g = &f->grid[f->node_support[k][number] - 1];
        int32_t entry = mirror_count ? first : points->entry_count; // without mirrors each node has its own
        while (entry < points->entry_count && points->entry[entry].support != g->support) entry++;
        if (entry == points->entry_count && brunt_constraints_entry(points, g->support, 0) < 0) return -1;
        for (int a = 0; a < 3; a++) points->entry[entry].weight[a] += under->weight[e] * g->sign[a];
    }
    return 0;
}

// What the last point rubs with: the same supports, at the particle's surface.
static int add_lever(const brunt_contact_context *m, const brunt_node_to_facet *f, brunt_body *body, int k,
                     const struct seen *seen, brunt_constraint_set *points) {
    const int32_t number = points->point_count - 1;
    double arm[3], kernel_arm[3], x[3];
    const double extent = brunt_extent_along(body, seen->particle, seen->h.n);
    brunt_extent_arm(body, seen->particle, seen->h.n, extent + seen->h.gap, arm, kernel_arm);
    for (int a = 0; a < 3; a++) x[a] = seen->x[a] + arm[a];
    const int32_t first = brunt_constraints_friction_point(points, x);
    if (first < 0) return -1;
    brunt_constraint *point = &points->point[number];
    nodes under;
    particle_nodes(body, seen->block, seen->particle, kernel_arm, &under);
    for (int e = 0; e < under.count; e++) {
        const int64_t node = (under.node[e] - body->grid.nodes) / BRUNT_NODE_REALS;
        const struct grid_support *g = &f->grid[f->node_support[k][node] - 1];
        int32_t entry = first;
        while (points->entry[entry].support != g->support) entry++;
        for (int a = 0; a < 3; a++) points->entry[entry].weight[a] += under.weight[e] * g->sign[a];
    }
    brunt_master master;
    brunt_node_to_facet_master(m->skin, &seen->h, x, &master);
    brunt_node_to_facet_entries(f, &master, point, &points->entry[first + point->count - master.count]);
    return 0;
}

static int add_point(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_body *body, int k,
                     const brunt_symmetry_plane *mirrors, int mirror_count, const struct seen *seen,
                     brunt_constraint_set *points) {
    const brunt_contact_surface *skin = m->skin;
    brunt_master master;
    nodes under;
    particle_nodes(body, seen->block, seen->particle, NULL, &under);
    brunt_node_to_facet_master(skin, &seen->h, seen->x, &master);
    for (int c = 0; c < master.count; c++)
        if (brunt_node_to_facet_support(f, skin, master.node[c], points) < 0) return -1;
    int32_t at = brunt_constraints_add(points);
    if (at < 0) return -1;
    brunt_node_to_facet_point(m, &seen->h, seen->x, body->index, &points->point[at]);
    points->point[at].target = seen->h.target, points->point[at].tag = -1 - k;
    points->point[at].area = body->spacing * (body->grid.dim == 3  ? body->spacing
                                              : skin->axisymmetric ? 2 * M_PI * seen->x[0]
                                                                   : 1);
    if (add_slave(f, body, k, mirrors, mirror_count, &under, points)) return -1;
    const int32_t first = points->entry_count;
    for (int c = 0; c < master.count; c++)
        if (brunt_constraints_entry(points, f->support_of[master.node[c]], 0) < 0) return -1;
    brunt_node_to_facet_entries(f, &master, &points->point[at], points->entry + first);
    return points->point[at].friction > 0 ? add_lever(m, f, body, k, seen, points) : 0;
}

static int fit_room(brunt_node_to_facet *f, const brunt_body *body, int k, int threads) {
    const size_t held = (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES;
    if (BRUNT_RESERVE_IN(f->node_support[k], f->node_support_capacity[k], held, 0) ||
        RESERVE(f, run, body->grid.block_count + 1))
        return -1;
    memset(f->node_support[k], 0, held * sizeof *f->node_support[k]);
    if (!f->sight) {
        if (!(f->sight = brunt_alloc((size_t)threads * sizeof *f->sight))) return -1;
        f->sight_count = threads;
    }
    for (int t = 0; t < f->sight_count; t++) f->sight[t].count = 0, f->sight[t].failed = false;
    return 0;
}

int brunt_node_to_facet_particles(const brunt_contact_context *m, brunt_node_to_facet *f, brunt_body *body, int k,
                                  int32_t box, brunt_constraint_set *points) {
    job j = {m, f, body, box};
    if (fit_room(f, body, k, m->threads)) return -1;
    brunt_parallel(m->threads, body->grid.block_count, 1, look_from_blocks, &j, m->timer);
    for (int t = 0; t < f->sight_count; t++)
        if (f->sight[t].failed) return -1;
    brunt_symmetry_plane mirrors[MAX_MIRRORS];
    const int mirror_count = mirrors_of(m, body, mirrors);
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        const struct run *run = &f->run[b];
        const struct seen *seen = f->sight[run->worker].seen;
        for (int32_t i = run->first; i < run->first + run->count; i++)
            if (add_point(m, f, body, k, mirrors, mirror_count, &seen[i], points)) return -1;
    }
    return 0;
}

// ------------------------------------------------------------------------------------------ the way back

static void add_moment(const double x[3], const double P[3], double factor, double linear[3], double angular[3]) {
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        linear[a] += factor * P[a];
        angular[a] += factor * (x[b] * P[c] - x[c] * P[b]);
    }
}

// What the body's own share of the nodes has got, less what the points gave it, is the mirrors'.
static void book_mirrors(const brunt_contact_context *m, const brunt_body *body, int k, double linear[3],
                         double angular[3], const brunt_constraint_set *points) {
    brunt_symmetry_plane mirrors[MAX_MIRRORS];
    const int count = mirrors_of(m, body, mirrors);
    for (int32_t p = 0; p < points->point_count; p++) {
        const brunt_constraint *point = &points->point[p];
        double push[3];
        if (point->tag != -1 - k || !(point->push > 0)) continue;
        for (int a = 0; a < 3; a++) push[a] = point->push * point->n[a];
        add_moment(point->x, push, -1, linear, angular);
        add_moment(point->lever ? points->lever[point->lever - 1].x : point->x, point->drag, -1, linear, angular);
    }
    for (int a = 0; a < 3; a++) {
        int i = 0;
        while (i < count && mirrors[i].axis != a) i++;
        if (i < count && mirrors[i].wall >= 0) m->walls[mirrors[i].wall].last.impulse[a] += linear[a];
        if (mirrors[0].wall >= 0) m->walls[mirrors[0].wall].last.angular[a] += angular[a];
    }
}

void brunt_node_to_facet_give_grids(const brunt_contact_context *m, brunt_body *mpm, brunt_node_to_facet *f,
                                    const brunt_constraint_set *points) {
    for (int32_t g = 0; g < f->grid_count;) {
        const int k = f->grid[g].mpm;
        brunt_body *body = &mpm[k];
        const brunt_grid *grid = &body->grid;
        double linear[3] = {0}, angular[3] = {0};
        brunt_symmetry_plane mirrors[MAX_MIRRORS];
        const bool mirrored = mirrors_of(m, body, mirrors) > 0;
        for (; g < f->grid_count && f->grid[g].mpm == k; g++) {
            const struct grid_support *entry = &f->grid[g];
            real *node = grid->nodes + entry->node * BRUNT_NODE_REALS;
            double P[3] = {0}, x[3];
            for (int a = 0; a < grid->dim; a++) {
                const brunt_dof_node *support = &points->support[entry->support];
                double v = entry->sign[a] * support->v[a];
                if (brunt_node_held(grid, entry->node, a)) // the condition takes it again, and books it
                    v += entry->sign[a] * support->impulse[a] / (double)node[BRUNT_NODE_MASS];
                P[a] = (double)node[BRUNT_NODE_SPARE] * (v - (double)node[BRUNT_NODE_VELOCITY + a]);
                node[BRUNT_NODE_VELOCITY + a] = (real)v;
            }
            if (!mirrored) continue;
            brunt_node_position(grid, grid->slots[entry->node / BRUNT_BLOCK_NODES].coord,
                                (int)(entry->node % BRUNT_BLOCK_NODES), x);
            add_moment(x, P, 1, linear, angular);
        }
        if (mirrored) book_mirrors(m, body, k, linear, angular, points);
    }
}
