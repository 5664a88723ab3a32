// Differences that hold nodes without material.
#include "scheme/ghost.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "grid/background.h"
#include "linear/block_matrix.h"
#include "materials/material.h"

enum { RUN_LIMIT = 5 };
static const double PARAMETER = 1e-3; // c: anything from 1e-6 to 0.1 does
static const double WEAK = 0.5;       // of the mass of a full cell: lighter nodes are held
static const double difference[][RUN_LIMIT] = {{0}, {1, -2, 1}, {1, -3, 3, -1}, {1, -4, 6, -4, 1}};
_Static_assert(BRUNT_COUNT(difference) == BRUNT_CUBIC + 1, "a row for each kernel");

// ------------------------------------------------------------------------------------------ runs

// A run from `at` along an axis: whether all its nodes are there, and one of them is weak.
static bool find_run(const brunt_unknowns *u, const brunt_bodies *bodies, int i, const int32_t from[3], int axis,
                     int32_t *node) {
    const brunt_body *body = &bodies->mpm[i];
    const double full = (double)body->material.density * pow((double)body->grid.h, u->dim);
    int32_t at[3] = {from[0], from[1], from[2]};
    bool weak = false;
    for (int k = 0; k < body->grid.order + 2; k++) {
        at[axis] = from[axis] + k;
        node[k] = brunt_unknowns_node_at(u, bodies, i, at);
        if (node[k] < 0) return false;
        weak = weak || u->mass[node[k]] < WEAK * full;
    }
    return weak;
}

static int add_run(brunt_ghost *g, const int32_t *node, const double *share, int length, double stiffness,
                   brunt_error *error) {
    const size_t runs = (size_t)g->runs, entries = (size_t)(g->runs ? g->first[g->runs] : 0);
    if (BRUNT_CAPACITY(g->first, runs + 2, runs + 1, "runs of nodes with little material", error) ||
        BRUNT_CAPACITY(g->stiffness, runs + 1, runs, "runs of nodes with little material", error) ||
        BRUNT_CAPACITY(g->share, entries + RUN_LIMIT, entries, "nodes of runs with little material", error) ||
        BRUNT_CAPACITY(g->node, entries + RUN_LIMIT, entries, "nodes of runs with little material", error))
        return BRUNT_FAILED;
    memcpy(g->node + entries, node, (size_t)length * sizeof *node);
    memcpy(g->share + entries, share, (size_t)length * sizeof *share);
    g->stiffness[runs] = stiffness;
    g->first[runs] = (int64_t)entries;
    g->first[++g->runs] = (int64_t)entries + length;
    return BRUNT_OK;
}

// The four nodes of an edge between triangles: whether all are there, and one is weak.
static bool find_edge(const brunt_unknowns *u, const brunt_bodies *bodies, int i, const int32_t edge[4],
                      int32_t node[4]) {
    const brunt_body *body = &bodies->mpm[i];
    bool weak = false;
    for (int k = 0; k < 4; k++) {
        int32_t at[3];
        brunt_grid_mesh_node(edge[k], at);
        node[k] = brunt_unknowns_node_at(u, bodies, i, at);
        if (node[k] < 0) return false;
        weak = weak || u->mass[node[k]] < WEAK * (double)body->material.density * body->grid.mesh->area[edge[k]];
    }
    return weak;
}

// The weights of a triangle's corners, the ends of its edge and the node across it, at the node beyond.
static void find_shares(const brunt_background *mesh, const int32_t edge[4], double share[4]) {
    const double *p = mesh->node[edge[0]], *q = mesh->node[edge[1]], *r = mesh->node[edge[2]], *x = mesh->node[edge[3]];
    const double whole = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    share[1] = -((x[0] - p[0]) * (r[1] - p[1]) - (x[1] - p[1]) * (r[0] - p[0])) / whole;
    share[2] = -((q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0])) / whole;
    share[0] = -1 - share[1] - share[2], share[3] = 1;
}

// Whether body i, or one that it is tied to, has nodes of a block of a mesh.
static bool has_block(const brunt_unknowns *u, const brunt_bodies *bodies, int i, int32_t block) {
    for (int other = u->tie[i]; other < bodies->mpm_count; other++)
        if (u->tie[other] == u->tie[i] && bodies->mpm[other].grid.reached[block]) return true;
    return false;
}

static int add_edges(brunt_ghost *g, const brunt_bodies *bodies, int i, double stiffness, brunt_error *error) {
    const brunt_background *mesh = bodies->mpm[i].grid.mesh;
    for (int32_t block = 0; block * BRUNT_BLOCK_NODES < mesh->node_count; block++) {
        if (!has_block(g->unknowns, bodies, i, block)) continue;
        for (int32_t e = mesh->edge_first[block]; e < mesh->edge_first[block + 1]; e++) {
            int32_t node[4];
            double share[4];
            if (!find_edge(g->unknowns, bodies, i, mesh->edge[e], node)) continue;
            find_shares(mesh, mesh->edge[e], share);
            if (add_run(g, node, share, 4, stiffness, error)) return BRUNT_FAILED;
        }
    }
    return BRUNT_OK;
}

static int add_body(brunt_ghost *g, const brunt_bodies *bodies, int i, brunt_error *error) {
    const brunt_unknowns *u = g->unknowns;
    const brunt_body *body = &bodies->mpm[i];
    const double c = (double)body->material.wave_speed, h = (double)body->grid.h,
                 stiffness = PARAMETER * (double)body->material.density * c * c * pow(h, u->dim - 2);
    if (body->grid.mesh) return add_edges(g, bodies, i, stiffness, error);
    for (int64_t k = 0; k < (int64_t)body->grid.slot_count * BRUNT_BLOCK_NODES; k++) {
        const int32_t n = u->number[i][k];
        int32_t at[3], node[RUN_LIMIT];
        int local[3];
        if (n < 0 || g->seen[n]) continue;
        g->seen[n] = 1;
        brunt_node_local(&body->grid, (int)(k % BRUNT_BLOCK_NODES), local);
        for (int a = 0; a < 3; a++)
            at[a] = body->grid.slots[k / BRUNT_BLOCK_NODES].coord[a] * body->grid.side + local[a];
        for (int axis = 0; axis < u->dim; axis++)
            if (find_run(u, bodies, i, at, axis, node) &&
                add_run(g, node, difference[body->grid.order], body->grid.order + 2, stiffness, error))
                return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

static bool is_held(const brunt_boundaries *boundaries, const brunt_body *body) {
    for (int k = 0; k < boundaries->surfaces.count; k++)
        if (brunt_boundary_surface_acts(&boundaries->surfaces.surface[k], body)) return true;
    return false;
}

int brunt_ghost_step(brunt_ghost *g, const brunt_world *world, const brunt_unknowns *unknowns, brunt_error *error) {
    g->unknowns = unknowns;
    g->runs = 0, g->version++;
    if (BRUNT_CAPACITY(g->seen, (size_t)unknowns->count + 1, 0, "unknowns", error) ||
        BRUNT_CAPACITY(g->first, 1, 0, "runs of nodes with little material", error))
        return BRUNT_FAILED;
    memset(g->seen, 0, (size_t)unknowns->count);
    g->first[0] = 0;
    for (int i = 0; i < world->bodies.mpm_count; i++)
        if (is_held(&world->boundaries, &world->bodies.mpm[i]) && add_body(g, &world->bodies, i, error))
            return BRUNT_FAILED;
    return BRUNT_OK;
}

void brunt_ghost_free(brunt_ghost *g) {
    brunt_free(g->first), brunt_free(g->node), brunt_free(g->share), brunt_free(g->stiffness), brunt_free(g->seen);
    *g = (brunt_ghost){.runs = 0};
}

size_t brunt_ghost_bytes(const brunt_ghost *g) {
    return g->first_capacity + g->node_capacity + g->share_capacity + g->stiffness_capacity + g->seen_capacity;
}

// ------------------------------------------------------------------------------------------ the term

static const double *differences(const brunt_ghost *g, int64_t run) { return g->share + g->first[run]; }

// q . u of a component.
static double bend(const brunt_ghost *g, int64_t run, int a, const double *u) {
    const double *q = differences(g, run);
    double sum = 0;
    for (int64_t k = g->first[run]; k < g->first[run + 1]; k++)
        sum += *q++ * u[g->node[k] * (int64_t)g->unknowns->dim + a];
    return sum;
}

static brunt_energy_sum ghost_energy(void *term, const brunt_team *team, const double *u) {
    (void)team;
    const brunt_ghost *g = term;
    brunt_energy_sum sum = {0};
    for (int64_t run = 0; run < g->runs; run++)
        for (int a = 0; a < g->unknowns->dim; a++) {
            const double b = bend(g, run, a, u);
            sum.value += 0.5 * g->stiffness[run] * b * b;
        }
    sum.magnitude = sum.value;
    return sum;
}

static void ghost_gradient(void *term, const brunt_team *team, const double *u, double *gradient) {
    (void)team;
    const brunt_ghost *g = term;
    for (int64_t run = 0; run < g->runs; run++)
        for (int a = 0; a < g->unknowns->dim; a++) {
            const double force = g->stiffness[run] * bend(g, run, a, u), *q = differences(g, run);
            for (int64_t k = g->first[run]; k < g->first[run + 1]; k++)
                gradient[g->node[k] * (int64_t)g->unknowns->dim + a] += *q++ * force;
        }
}

static brunt_stencils ghost_stencils(void *term) {
    const brunt_ghost *g = term;
    return (brunt_stencils){.count = g->runs, .first = g->first, .node = g->node, .version = g->version};
}

static void ghost_hessian(void *term, const brunt_team *team, const double *u, bool project,
                          struct brunt_block_matrix *h) {
    (void)team, (void)u, (void)project; // it has no negative eigenvalues
    const brunt_ghost *g = term;
    const int dim = g->unknowns->dim;
    for (int64_t run = 0; run < g->runs; run++) {
        const int length = (int)(g->first[run + 1] - g->first[run]);
        const double *q = differences(g, run);
        double dense[RUN_LIMIT * 3 * RUN_LIMIT * 3] = {0};
        for (int e = 0; e < length; e++)
            for (int f = 0; f < length; f++)
                for (int a = 0; a < dim; a++)
                    dense[((e * dim + a) * length + f) * dim + a] = g->stiffness[run] * q[e] * q[f];
        brunt_block_matrix_add(h, g->node + g->first[run], length, dense);
    }
}

const brunt_term_ops brunt_ghost_ops = {.name = "nodes without material",
                                        .energy = ghost_energy,
                                        .gradient = ghost_gradient,
                                        .stencils = ghost_stencils,
                                        .hessian = ghost_hessian};
