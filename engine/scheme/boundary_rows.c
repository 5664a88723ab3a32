// The patches of a step: which pieces of lines reach which bodies, and how they see the grid.
#include "scheme/boundary_rows.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "grid/weigh.h"
#include "linear/block_matrix.h"
#include "materials/material.h"

// b beside the stiffness of the grid: sets the number of sweeps. Where there is no energy it also says, of what may
// leave or slip, which of it does so after a step of Newton's method, and goes to and fro where it is stiffer than what
// it holds.
static const double STIFF = 1e3, SOFT = 3;
static const double NEAR = 0.1; // cells: what is nearer has come

// ------------------------------------------------------------------------------------------ nodes

// Adds a boundary particle's share of a node.
static int add_node(brunt_boundary_rows *rows, brunt_boundary_patch *p, const brunt_boundary_particle *b, int32_t n,
                    double weight, brunt_error *error) {
    const int64_t begin = rows->first[rows->patch_count];
    int64_t *end = &rows->first[rows->patch_count + 1];
    if (!rows->mark[n]) {
        if (BRUNT_CAPACITY(rows->node, (size_t)*end + 1, (size_t)*end, "nodes of pieces of boundaries", error) ||
            BRUNT_CAPACITY(rows->weight, (size_t)*end + 1, (size_t)*end, "nodes of pieces of boundaries", error))
            return BRUNT_FAILED;
        memset(rows->weight[*end], 0, sizeof *rows->weight);
        rows->node[*end] = n;
        rows->mark[n] = (int32_t)(++*end - begin);
    }
    double *to = rows->weight[begin + rows->mark[n] - 1], direction[3];
    for (int k = 0; k < p->rows; k++) {
        brunt_boundary_surface_direction(p->surface, b, k, direction);
        for (int a = 0; a < 3; a++) to[3 * k + a] += weight * direction[a];
    }
    p->size += weight;
    return BRUNT_OK;
}

// Adds `weight` of a boundary particle at x; to *share what of it is on nodes that have mass.
static int add_place(brunt_boundary_rows *rows, brunt_boundary_patch *p, const brunt_boundary_particle *b,
                     const double x[3], double weight, double *share, brunt_error *error) {
    brunt_grid_weights at;
    brunt_grid_weigh(&rows->bodies->mpm[p->body].grid, x, weight, &at);
    for (int k = 0; k < at.count; k++) {
        const int32_t n =
            at.weight[k] > 0 ? brunt_unknowns_node_at(rows->unknowns, rows->bodies, p->body, at.at[k]) : BRUNT_NONE;
        if (n < 0) continue;
        if (add_node(rows, p, b, n, at.weight[k], error)) return BRUNT_FAILED;
        *share += at.weight[k];
    }
    return BRUNT_OK;
}

// How many places stand for a boundary particle. Cells of a lattice are cut alike by a line, and what its particles
// miss of one they miss of all; triangles of a mesh are cut at other places each.
static int places_of(const brunt_boundary_rows *rows, const brunt_boundary_patch *p) {
    enum { IN_A_CELL = 32 };
    const int particles = p->surface->def.particles;
    const bool mesh = rows->bodies->mpm[p->body].grid.mesh != NULL;
    return mesh && particles < IN_A_CELL ? (IN_A_CELL + particles - 1) / particles : 1;
}

// Adds a boundary particle, by places along what it stands for; *share: its weight on nodes that have mass.
static int add_particle(brunt_boundary_rows *rows, brunt_boundary_patch *p, const brunt_boundary_particle *b,
                        const double way[3], double *share, brunt_error *error) {
    const int places = places_of(rows, p);
    *share = 0;
    for (int k = 0; k < places; k++) {
        const double along = ((k + 0.5) / places - 0.5) * b->weight;
        double x[3];
        for (int a = 0; a < 3; a++) x[a] = b->x[a] + way[a] + (places > 1 ? along * b->tangent[0][a] : 0);
        if (add_place(rows, p, b, x, b->weight / places, share, error)) return BRUNT_FAILED;
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ patches

static double stiffness(const brunt_boundary_rows *rows, const brunt_boundary_patch *p) {
    const brunt_material *material = &rows->bodies->mpm[p->body].material;
    const double c = (double)material->wave_speed, h = rows->cell;
    const double inertia = rows->still ? 0 : 4 * h / (rows->dt * rows->dt);
    return (p->leaves && rows->forces ? SOFT : STIFF) * (double)material->density * (c * c / h + inertia);
}

// How the surface moves along the rows, by `step`, at a boundary particle that is `gap` from the body.
static void add_motion(brunt_boundary_patch *p, const brunt_boundary_particle *b, const double step[3], double share,
                       double gap) {
    for (int k = 0; k < p->rows; k++) {
        double direction[3], along = 0;
        brunt_boundary_surface_direction(p->surface, b, k, direction);
        for (int a = 0; a < 3; a++) along += step[a] * direction[a];
        p->prescribed[k] += share * along;
        p->goal[k] += share * (along - (p->leaves && k == 0 ? gap : 0));
    }
}

// What sticks to a surface that turns goes as its nodes would with that.
static void turn_nodes(const brunt_boundary_rows *rows, brunt_boundary_patch *p) {
    const int dim = rows->unknowns->dim;
    memset(p->prescribed, 0, sizeof p->prescribed);
    for (int64_t e = rows->first[rows->patch_count]; e < rows->first[rows->patch_count + 1]; e++) {
        double x[3] = {0}, way[3];
        for (int a = 0; a < dim; a++) x[a] = rows->unknowns->position[rows->node[e] * (int64_t)dim + a];
        brunt_boundary_surface_goes(p->surface, x, way);
        for (int k = 0; k < p->rows; k++)
            for (int a = 0; a < dim; a++) p->prescribed[k] += rows->weight[e][3 * k + a] * way[a];
    }
    memcpy(p->goal, p->prescribed, sizeof p->goal);
}

static void close_patch(brunt_boundary_rows *rows, brunt_boundary_patch *p) {
    const brunt_boundary_surface *s = p->surface;
    double kept[3];
    brunt_boundary_surface_bring(s, s->traction + 3 * ((size_t)p->body * (size_t)s->pieces + (size_t)p->piece), kept);
    if (s->turned.particle && s->def.condition == BRUNT_STICK) turn_nodes(rows, p);
    for (int k = 0; k < p->rows; k++) p->multiplier[k] = p->before[k] = kept[k];
    // In load steps what rubs sticks until it is known what presses: there is nothing else that could hold it.
    p->bound = !p->rubs ? 0 : rows->still ? INFINITY : s->def.friction * fmax(0, -kept[0]);
    p->stiffness = stiffness(rows, p);
    for (int64_t k = rows->first[rows->patch_count]; k < rows->first[rows->patch_count + 1]; k++)
        rows->mark[rows->node[k]] = 0;
    if (p->size > 0) rows->patch_count++;
}

// A piece before a body whose distances are in `gap`.
static int add_patch(brunt_boundary_rows *rows, brunt_boundary_surface *s, int32_t piece, int body,
                     const brunt_boundary_extent *extent, brunt_error *error) {
    const size_t count = (size_t)rows->patch_count;
    bool any = false;
    for (int32_t b = s->first[piece]; b < s->first[piece + 1]; b++) any = any || rows->here[b] < INFINITY;
    if (!any) return BRUNT_OK;
    if (BRUNT_CAPACITY(rows->patch, count + 1, count, "pieces of boundaries", error) ||
        BRUNT_CAPACITY(rows->first, count + 2, count + 1, "pieces of boundaries", error))
        return BRUNT_FAILED;
    brunt_boundary_patch *p = &rows->patch[count];
    *p = (brunt_boundary_patch){.surface = s, .piece = piece, .body = body};
    p->rows = brunt_boundary_surface_rows(s, rows->unknowns->dim);
    p->leaves = s->def.condition == BRUNT_SEPARATE, p->rubs = p->leaves && p->rows > 1;
    rows->first[count + 1] = rows->first[count];
    for (int32_t b = s->first[piece]; b < s->first[piece + 1]; b++) {
        const brunt_boundary_particle *particle = brunt_boundary_surface_particle(s, b);
        double share;
        if (rows->here[b] == INFINITY) continue;
        if (add_particle(rows, p, particle, extent->way, &share, error)) return BRUNT_FAILED;
        add_motion(p, particle, s->turned.particle ? s->turned.goes[b] : extent->step, share, rows->here[b]);
        // A grain that has been drawn out is longer than its nodes reach: its end holds nothing, and comes no nearer.
        if (!(share > 0) && rows->here[b] > NEAR * rows->cell) rows->unseen = s;
    }
    close_patch(rows, p);
    return BRUNT_OK;
}

// Which parts of what a step asks are made.
typedef struct build {
    brunt_world *world;
    bool looks, adds;          // distances; patches
    brunt_boundary_ways *ways; // how far material points go, with distances beside those of before; NULL: by velocities
    void *context;
} build;

// Distances of a body, and those that are tied to it, from the particles of a surface.
static void look_at_body(brunt_boundary_rows *rows, brunt_boundary_surface *s, int i, brunt_boundary_extent *extent,
                         const build *b) {
    for (int32_t k = 0; k < s->particle_count && !b->ways; k++) rows->here[k] = INFINITY;
    for (int other = i; other < rows->bodies->mpm_count; other++) {
        brunt_body *body = &rows->bodies->mpm[other];
        if (rows->unknowns->tie[other] != i || !brunt_boundary_surface_acts(s, body)) continue;
        if (brunt_boundary_surface_far(s, &rows->bounds[other], extent)) continue;
        extent->frame = rows->surfaces->frame[other];
        extent->moved = b->ways ? b->ways(b->context, other) : NULL;
        if (brunt_boundary_surface_extent(s, body, extent, rows->here)) rows->passed = s;
    }
}

static int add_surface(brunt_boundary_rows *rows, brunt_boundary_surface *s, brunt_boundary_extent *extent,
                       const build *b, brunt_error *error) {
    for (int i = 0; i < rows->bodies->mpm_count; i++) {
        if (rows->unknowns->tie[i] != i) continue;
        if (b->looks) look_at_body(rows, s, i, extent, b);
        for (int32_t k = 0; k < s->particle_count; k++) rows->reached += rows->here[k] < INFINITY;
        for (int32_t piece = 0; piece < s->pieces && b->adds; piece++)
            if (add_patch(rows, s, piece, i, extent, error)) return BRUNT_FAILED;
        rows->here += s->particle_count;
    }
    return BRUNT_OK;
}

// Room for the matrix of the largest patch.
static int reserve_arrays(brunt_boundary_rows *rows, brunt_error *error) {
    int64_t most = 1;
    rows->row_count = 0;
    for (int32_t p = 0; p < rows->patch_count; p++)
        rows->patch[p].row = rows->row_count, rows->row_count += rows->patch[p].rows;
    rows->exact = rows->forces && !rows->still && rows->row_count <= rows->answer_limit;
    for (int32_t p = 0; p < rows->patch_count; p++) {
        const int64_t nodes = rows->first[p + 1] - rows->first[p];
        if (nodes > most) most = nodes;
        if (nodes > BRUNT_STENCIL_LIMIT)
            return brunt_fail(error, BRUNT_FAILED,
                              "a piece of boundary '%s' has %lld nodes of the grid, %d are the most: piece is too long",
                              rows->patch[p].surface->boundary->name, (long long)nodes, BRUNT_STENCIL_LIMIT);
    }
    most *= rows->unknowns->dim;
    return BRUNT_CAPACITY(rows->dense, (size_t)(most * most), 0, "values of the matrix of a piece of a boundary",
                          error);
}

// Where bodies are within the step.
static void take_bounds(brunt_boundary_rows *rows, const build *b) {
    for (int i = 0; i < rows->bodies->mpm_count; i++)
        brunt_boundary_body_bounds(&rows->bodies->mpm[i], rows->dt, b->ways ? b->ways(b->context, i) : NULL,
                                   &rows->bounds[i]);
}

static int reserve_gaps(brunt_boundary_rows *rows, brunt_error *error) {
    size_t count = 1;
    rows->any_leave = false;
    for (int k = 0; k < rows->surfaces->count; k++) {
        const brunt_boundary_surface *s = &rows->surfaces->surface[k];
        rows->any_leave = rows->any_leave || s->def.condition == BRUNT_SEPARATE;
        count += (size_t)s->particle_count * (size_t)rows->bodies->mpm_count;
    }
    return BRUNT_CAPACITY(rows->gap, count, 0, "particles of boundaries", error) ||
                   BRUNT_CAPACITY(rows->bounds, (size_t)rows->bodies->mpm_count + 1, 0, "bodies of points", error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

// How the surface goes within the step.
static void take_way(brunt_boundary_surface *s, double now, double dt, brunt_boundary_extent *extent) {
    double end[3];
    if (s->turned.particle) {
        brunt_boundary_surface_turn(s, now, dt);
        return;
    }
    brunt_boundary_surface_way(s, now, extent->way);
    brunt_boundary_surface_way(s, now + dt, end);
    for (int a = 0; a < 3; a++) extent->step[a] = end[a] - extent->way[a];
}

static int go_round(brunt_boundary_rows *rows, const build *b, brunt_error *error) {
    const double now = b->world->clock.time;
    rows->here = rows->gap, rows->reached = 0, rows->passed = rows->too_far = NULL;
    if (b->looks) take_bounds(rows, b);
    if (b->adds) rows->patch_count = 0, rows->version++, rows->unseen = NULL, rows->first[0] = 0;
    for (int k = 0; k < rows->surfaces->count; k++) {
        brunt_boundary_surface *s = &rows->surfaces->surface[k];
        brunt_boundary_extent extent = {.dt = rows->dt};
        if (b->adds && b->looks && brunt_boundary_window_follow(s, rows->bodies, rows->unknowns->dim, error))
            return BRUNT_FAILED;
        take_way(s, now, rows->dt, &extent);
        if (brunt_boundary_surface_turns_far(s) && (rows->too_far = s))
            return brunt_fail(error, BRUNT_FAILED,
                              "boundary '%s' turns by %.3g rad within a step, a quarter of a turn is the most: shorter "
                              "ones are wanted",
                              s->boundary->name, s->turned.angle);
        rows->cell = s->cell;
        if (add_surface(rows, s, &extent, b, error)) return BRUNT_FAILED;
    }
    return b->adds ? reserve_arrays(rows, error) : BRUNT_OK;
}

int brunt_boundary_rows_step(brunt_boundary_rows *rows, brunt_world *world, const brunt_unknowns *unknowns, double dt,
                             brunt_error *error) {
    const build b = {.world = world, .looks = true, .adds = true};
    rows->unknowns = unknowns, rows->bodies = &world->bodies, rows->surfaces = &world->boundaries.surfaces;
    rows->dt = dt, rows->swept = 0;
    if (BRUNT_CAPACITY(rows->first, 1, 0, "pieces of boundaries", error) ||
        BRUNT_CAPACITY(rows->mark, (size_t)unknowns->count + 1, 0, "unknowns", error) || reserve_gaps(rows, error))
        return BRUNT_FAILED;
    memset(rows->mark, 0, (size_t)unknowns->count * sizeof *rows->mark);
    return go_round(rows, &b, error);
}

int brunt_boundary_rows_look(brunt_boundary_rows *rows, brunt_world *world, brunt_boundary_ways *ways, void *context,
                             bool *more, brunt_error *error) {
    const build look = {.world = world, .looks = true, .ways = ways, .context = context};
    const int64_t reached = rows->reached;
    if (go_round(rows, &look, error)) return BRUNT_FAILED;
    *more = rows->reached > reached;
    return BRUNT_OK;
}

int brunt_boundary_rows_grow(brunt_boundary_rows *rows, brunt_world *world, brunt_error *error) {
    const build add = {.world = world, .adds = true};
    return go_round(rows, &add, error);
}

void brunt_boundary_rows_free(brunt_boundary_rows *rows) {
    void *const all[] = {rows->patch, rows->first,  rows->node,  rows->weight, rows->mark,
                         rows->gap,   rows->bounds, rows->dense, rows->answer};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) brunt_free(all[k]);
    *rows = (brunt_boundary_rows){.patch_count = 0};
}

size_t brunt_boundary_rows_bytes(const brunt_boundary_rows *rows) {
    return rows->patch_capacity + rows->first_capacity + rows->node_capacity + rows->weight_capacity +
           rows->mark_capacity + rows->gap_capacity + rows->bounds_capacity + rows->dense_capacity +
           rows->answer_capacity;
}
