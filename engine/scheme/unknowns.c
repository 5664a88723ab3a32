// Which nodes an implicit step moves: numbers, masses, velocities.
#include <math.h>
#include <string.h>

#include "contact/methods/method.h"
#include "contact/planes/condition.h"
#include "base/array.h"
#include "base/memory.h"
#include "scheme/unknowns.h"

// Of the heaviest node of a body: lighter ones have no weight at any particle, and stay at rest.
static const double LEAST_SHARE = 1e-28;

static bool ties(const brunt_pairs *pairs, int32_t p) {
    return p >= 0 && brunt_contact_node_law(pairs->pair[p].method) != NULL;
}

// The first of the bodies that share nodes with one.
static int32_t first_of(int32_t *tie, int32_t i) {
    while (tie[i] != i) i = tie[i] = tie[tie[i]];
    return i;
}

static void tie_two(int32_t *tie, int32_t i, int32_t k) {
    const int32_t a = first_of(tie, i), b = first_of(tie, k);
    tie[a > b ? a : b] = a > b ? b : a;
}

// Where bodies of points are tied unless an entry says otherwise: from body to body, those that are left are looked at,
// and each is found at once but for the few that are not tied to one.
static int tie_usual(const brunt_pairs *pairs, const brunt_bodies *bodies, int32_t *tie, brunt_error *error) {
    int32_t *left, *found, count = bodies->mpm_count;
    if (BRUNT_NEW(left, 2 * count + 1, "bodies that may be tied", error)) return BRUNT_FAILED;
    for (int32_t i = 0; i < count; i++) left[i] = i;
    found = left + count;
    while (count > 0) {
        int32_t next = 1;
        for (found[0] = left[--count]; next > 0;) {
            const int32_t i = found[--next];
            int32_t kept = 0;
            for (int32_t q = 0; q < count; q++) {
                const int32_t k = left[q];
                if (ties(pairs, brunt_pair_of(&pairs->map, bodies->mpm[i].index, bodies->mpm[k].index)))
                    tie_two(tie, i, k), found[next++] = k;
                else
                    left[kept++] = k;
            }
            count = kept;
        }
    }
    brunt_free(left);
    return BRUNT_OK;
}

// Bodies that share nodes, by the first of them.
static int find_ties(const brunt_pairs *pairs, const brunt_bodies *bodies, int32_t *tie, brunt_error *error) {
    const brunt_pair_map *map = &pairs->map;
    for (int i = 0; i < bodies->mpm_count; i++) tie[i] = i;
    for (int32_t q = 0; q < map->count; q++) {
        const brunt_body *a = bodies->all[map->entry[q].a].mpm, *b = bodies->all[map->entry[q].b].mpm;
        if (a && b && ties(pairs, map->entry[q].pair))
            tie_two(tie, (int32_t)(a - bodies->mpm), (int32_t)(b - bodies->mpm));
    }
    if (map->mesh && ties(pairs, map->usual[0]) && tie_usual(pairs, bodies, tie, error)) return BRUNT_FAILED;
    for (int i = 0; i < bodies->mpm_count; i++) tie[i] = first_of(tie, i);
    return BRUNT_OK;
}

int brunt_unknowns_make(brunt_unknowns *u, const brunt_world *world, brunt_error *error) {
    const brunt_bodies *bodies = &world->bodies;
    u->dim = world->settings.dimension;
    if (BRUNT_NEW(u->plane, world->boundaries.boundary_count + 1, "nodes of walls", error) ||
        BRUNT_NEW(u->base, bodies->fem_count + 1, "meshes with unknowns", error) ||
        BRUNT_NEW(u->grid_base, bodies->mpm_count + 1, "grids with unknowns", error) ||
        BRUNT_NEW(u->number, bodies->mpm_count + 1, "grids with unknowns", error) ||
        BRUNT_NEW(u->number_capacity, bodies->mpm_count + 1, "grids with unknowns", error) ||
        BRUNT_NEW(u->tie, bodies->mpm_count + 1, "bodies that are tied", error) ||
        find_ties(&world->pairs, bodies, u->tie, error))
        return BRUNT_FAILED;
    u->images.any = bodies->mpm_count > 0 && world->boundaries.symmetry_count > 0;
    return BRUNT_OK;
}

void brunt_unknowns_free(brunt_unknowns *u, const brunt_bodies *bodies) {
    for (int i = 0; u->number && i < bodies->mpm_count; i++) brunt_free(u->number[i]);
    void *const all[] = {u->tie,         u->plane,
                         u->grid_base,   u->base,
                         u->number,      u->number_capacity,
                         u->mass,        u->position,
                         u->velocity,    u->held,
                         u->holder,      u->target,
                         u->end,         u->images.leader,
                         u->images.sign, u->images.follower,
                         u->images.mass, u->images.bearers,
                         u->sloped,      u->images.front};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) brunt_free(all[k]);
    *u = (brunt_unknowns){.dim = u->dim};
}

size_t brunt_unknowns_bytes(const brunt_unknowns *u, const brunt_bodies *bodies) {
    size_t bytes = u->mass_capacity + u->position_capacity + u->velocity_capacity + u->held_capacity +
                   u->holder_capacity + u->target_capacity + u->end_capacity + u->images.leader_capacity +
                   u->images.follower_capacity + u->images.sign_capacity + u->images.mass_capacity +
                   u->images.bearers_capacity + u->images.front_capacity + u->sloped_capacity;
    for (int i = 0; i < bodies->mpm_count; i++) bytes += u->number_capacity[i];
    return bytes;
}

// ------------------------------------------------------------------------------------------ numbers

// The number that a node has already of a body that this one is tied to; BRUNT_NONE: none.
static int32_t shared_number(const brunt_unknowns *u, const brunt_bodies *bodies, int i, int64_t k) {
    const int32_t *coord = bodies->mpm[i].grid.slots[k / BRUNT_BLOCK_NODES].coord;
    for (int other = u->tie[i]; other < i; other++) {
        if (u->tie[other] != u->tie[i]) continue;
        const int32_t slot = brunt_grid_slot(&bodies->mpm[other].grid, brunt_key(coord));
        const int64_t at = (int64_t)slot * BRUNT_BLOCK_NODES + k % BRUNT_BLOCK_NODES;
        if (slot >= 0 && u->number[other][at] >= 0) return u->number[other][at];
    }
    return BRUNT_NONE;
}

// Numbers of the nodes that have weight at some particle; with linear kernels also of those that have a slope there but
// no weight, when the particle lies on a line of the grid: stress pushes them.
static int number_grid(brunt_unknowns *u, const brunt_bodies *bodies, int i, brunt_error *error) {
    const brunt_grid *grid = &bodies->mpm[i].grid;
    const int64_t nodes = (int64_t)grid->slot_count * BRUNT_BLOCK_NODES;
    if (BRUNT_CAPACITY_IN(u->number[i], u->number_capacity[i], (size_t)nodes + 1, 0, "numbers of grid nodes", error))
        return BRUNT_FAILED;
    double most = 0;
    const bool linear = grid->order == BRUNT_LINEAR;
    if (linear && BRUNT_CAPACITY(u->sloped, (size_t)nodes + 1, 0, "marks of grid nodes", error)) return BRUNT_FAILED;
    if (linear) memset(u->sloped, 0, (size_t)nodes), brunt_body_mark_reached(&bodies->mpm[i], u->sloped);
    for (int64_t k = 0; k < nodes; k++) most = fmax(most, (double)grid->nodes[k * BRUNT_NODE_REALS + BRUNT_NODE_MASS]);
    int64_t next = u->count;
    for (int64_t k = 0; k < nodes; k++) {
        const bool weighs = (double)grid->nodes[k * BRUNT_NODE_REALS + BRUNT_NODE_MASS] > LEAST_SHARE * most ||
                            (linear && u->sloped[k]);
        u->number[i][k] = weighs ? shared_number(u, bodies, i, k) : -1;
        if (weighs && u->number[i][k] < 0) u->number[i][k] = (int32_t)next++;
        if (next > INT32_MAX / 3) break;
    }
    u->count = (int32_t)next;
    if (next <= INT32_MAX / 3) return BRUNT_OK;
    return brunt_fail(error, BRUNT_FAILED, "there are more than %d nodes with unknowns", INT32_MAX / 3);
}

static int reserve(brunt_unknowns *u, brunt_error *error) {
    const size_t n = (size_t)u->count + 1, all = n * (size_t)u->dim;
    return BRUNT_CAPACITY(u->mass, n, 0, "unknowns", error) || BRUNT_CAPACITY(u->position, all, 0, "unknowns", error) ||
                   BRUNT_CAPACITY(u->velocity, all, 0, "unknowns", error) ||
                   BRUNT_CAPACITY(u->held, all, 0, "unknowns", error) ||
                   BRUNT_CAPACITY(u->holder, all, 0, "unknowns", error) ||
                   BRUNT_CAPACITY(u->target, all, 0, "unknowns", error) ||
                   BRUNT_CAPACITY(u->end, all, 0, "unknowns", error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

static void take_mesh(brunt_unknowns *u, const brunt_fem_body *fem, int32_t base) {
    for (int32_t i = 0; i < fem->node_count; i++) {
        const real *node = brunt_fem_node(fem, i);
        const size_t n = (size_t)(base + i);
        u->mass[n] = (double)node[BRUNT_FEM_MASS];
        for (int a = 0; a < u->dim; a++) {
            u->position[n * (size_t)u->dim + (size_t)a] = (double)node[BRUNT_FEM_X + a];
            u->velocity[n * (size_t)u->dim + (size_t)a] = (double)node[BRUNT_FEM_V + a];
        }
    }
}

static void take_grid(brunt_unknowns *u, const brunt_grid *grid, const int32_t *number) {
    for (int64_t k = 0; k < (int64_t)grid->slot_count * BRUNT_BLOCK_NODES; k++) {
        if (number[k] < 0) continue;
        const real *node = grid->nodes + k * BRUNT_NODE_REALS;
        const size_t n = (size_t)number[k];
        double x[3];
        brunt_grid_node_place(grid, (int32_t)(k / BRUNT_BLOCK_NODES), (int)(k % BRUNT_BLOCK_NODES), x);
        u->mass[n] += (double)node[BRUNT_NODE_MASS];
        for (int a = 0; a < u->dim; a++) {
            u->position[n * (size_t)u->dim + (size_t)a] = x[a];
            u->velocity[n * (size_t)u->dim + (size_t)a] += (double)node[BRUNT_NODE_VELOCITY + a]; // momentum as yet
        }
    }
}

static bool moves(const brunt_boundary *boundary) {
    const double *v = boundary->plane.velocity;
    return brunt_boundary_pushes(boundary) && (v[0] != 0 || v[1] != 0 || v[2] != 0);
}

static void take_plane(brunt_unknowns *u, const brunt_plane_def *plane, double time, int32_t n) {
    u->mass[n] = 0;
    for (int a = 0; a < u->dim; a++) {
        u->position[n * (int64_t)u->dim + a] = plane->point[a] + plane->velocity[a] * time;
        u->velocity[n * (int64_t)u->dim + a] = plane->velocity[a];
    }
}

int brunt_unknowns_number(brunt_unknowns *u, brunt_world *world, brunt_error *error) {
    const brunt_bodies *bodies = &world->bodies;
    const brunt_boundary *boundaries = world->boundaries.boundary;
    u->count = 0;
    for (int k = 0; k < bodies->fem_count; k++) u->base[k] = u->count, u->count += bodies->fem[k].node_count;
    u->mesh_count = u->count;
    for (int i = 0; i < bodies->mpm_count; i++) {
        u->grid_base[i] = u->count;
        if (number_grid(u, bodies, i, error)) return BRUNT_FAILED;
    }
    u->grid_base[bodies->mpm_count] = u->count;
    for (int w = 0; w < world->boundaries.boundary_count; w++) u->plane[w] = moves(&boundaries[w]) ? u->count++ : -1;
    if (reserve(u, error)) return BRUNT_FAILED;
    for (int k = 0; k < bodies->fem_count; k++) take_mesh(u, &bodies->fem[k], u->base[k]);
    const int32_t grids = u->mesh_count;
    memset(u->mass + grids, 0, (size_t)(u->count - grids) * sizeof *u->mass);
    memset(u->velocity + (size_t)grids * (size_t)u->dim, 0,
           (size_t)(u->count - grids) * (size_t)u->dim * sizeof *u->velocity);
    for (int i = 0; i < bodies->mpm_count; i++) take_grid(u, &bodies->mpm[i].grid, u->number[i]);
    if (brunt_unknowns_symmetry(u, world, error)) return BRUNT_FAILED;
    brunt_unknowns_divide(u, world);
    for (int w = 0; w < world->boundaries.boundary_count; w++)
        if (u->plane[w] >= 0) take_plane(u, &boundaries[w].plane, world->clock.time, u->plane[w]);
    return BRUNT_OK;
}

int32_t brunt_unknowns_node_at(const brunt_unknowns *u, const brunt_bodies *bodies, int i, const int32_t at[3]) {
    const brunt_grid *own = &bodies->mpm[i].grid;
    int32_t block[3] = {0, 0, 0}, local[3] = {0, 0, 0};
    for (int a = 0; a < own->dim; a++) {
        block[a] = (int32_t)floor((double)at[a] / own->side);
        local[a] = at[a] - block[a] * own->side;
    }
    for (int other = u->tie[i]; other < bodies->mpm_count; other++) {
        if (u->tie[other] != u->tie[i]) continue;
        const int32_t slot = brunt_grid_slot(&bodies->mpm[other].grid, brunt_key(block));
        const int64_t node = (int64_t)slot * BRUNT_BLOCK_NODES + brunt_node_index(own, local[0], local[1], local[2]);
        if (slot >= 0 && u->number[other][node] >= 0) return u->number[other][node];
    }
    return BRUNT_NONE;
}

brunt_unknown_location brunt_unknowns_location(const brunt_unknowns *u, const brunt_bodies *bodies, int32_t n) {
    brunt_unknown_location at = {.body = -1, .node = -1};
    for (int a = 0; a < u->dim; a++) at.x[a] = u->position[(size_t)n * (size_t)u->dim + (size_t)a];
    for (int k = 0; k < bodies->fem_count; k++)
        if (n >= u->base[k] && n < u->base[k] + bodies->fem[k].node_count)
            at.body = bodies->fem[k].index, at.node = bodies->fem[k].node_id[n - u->base[k]];
    for (int i = 0; i < bodies->mpm_count && at.body < 0; i++)
        for (int64_t k = 0; k < (int64_t)bodies->mpm[i].grid.slot_count * BRUNT_BLOCK_NODES && at.body < 0; k++)
            if (u->number[i][k] == n) at.body = bodies->mpm[i].index, at.node = k;
    return at;
}
