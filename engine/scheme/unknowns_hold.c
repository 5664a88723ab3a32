// What is given of an implicit step's unknowns: planes, regions and groups of nodes hold components, and move them.
#include <math.h>
#include <string.h>

#include "boundary/curve.h"
#include "contact/planes/condition.h"
#include "contact/search/plane_contact.h"
#include "scheme/unknowns.h"

static const double ON_PLANE = 1e-6; // cells, mean edges: how far off a plane a node may be and still lie on it

// Holds component `a` of node n by boundary w, unless another does already.
static void hold(brunt_unknowns *u, int32_t n, int a, int w, double target, double end) {
    const size_t dof = (size_t)n * (size_t)u->dim + (size_t)a;
    if (u->held[dof]) return;
    u->held[dof] = 1;
    u->holder[dof] = w + 1;
    u->target[dof] = target, u->end[dof] = end;
}

// ------------------------------------------------------------------------------------------ groups

static void hold_group(brunt_unknowns *u, const brunt_world *world, int k, double dt) {
    const brunt_node_set *set = &world->boundaries.sets.set[k];
    const brunt_group_def *def = &set->def;
    const bool velocity = !set->does->goal;
    if (!set->does->moves) return;
    const double time = world->clock.time, middle = brunt_curve_at(&def->table, time + 0.5 * dt),
                 then = brunt_curve_at(&def->table, time + dt);
    const brunt_placement goal = brunt_node_set_goal(set, time + dt);
    const int boundary = (int)(set->boundary - world->boundaries.boundary);
    for (int32_t i = 0; i < set->node_count; i++) {
        const int32_t n = set->node[i];
        for (int a = 0; a < u->dim; a++) {
            if (!(set->holds[i] >> a & 1)) continue;
            const double way = velocity ? dt * middle * def->value[a] : brunt_node_set_way(set, &goal, n, a);
            hold(u, u->base[set->fem_index] + n, a, boundary, way, velocity ? then * def->value[a] : way / dt);
        }
    }
}

// ------------------------------------------------------------------------------------------ planes, regions

static void hold_node(brunt_unknowns *u, const brunt_world *world, int w, int32_t n, double tolerance, double dt) {
    const brunt_boundary *boundary = &world->boundaries.boundary[w];
    double x[3] = {0}, v[3] = {0};
    for (int a = 0; a < u->dim; a++) x[a] = u->position[(size_t)n * (size_t)u->dim + (size_t)a];
    const unsigned held = boundary->kind->hold_at(boundary, u->dim, world->clock.time, x, tolerance, v);
    for (int a = 0; a < u->dim; a++)
        if (held >> a & 1) hold(u, n, a, w, dt * v[a], v[a]);
}

// Distance of a node to a plane as it is at the start of the step [m].
static double distance(const brunt_unknowns *u, const brunt_plane_def *plane, double time, int32_t n) {
    double x[3] = {0};
    for (int a = 0; a < u->dim; a++) x[a] = u->position[(size_t)n * (size_t)u->dim + (size_t)a];
    return brunt_plane_distance(plane, time, x);
}

// Nodes of meshes in a boundary, or at it and behind it.
static void hold_meshes(brunt_unknowns *u, const brunt_world *world, int w, double dt) {
    const brunt_boundary *boundary = &world->boundaries.boundary[w];
    const brunt_bodies *bodies = &world->bodies;
    int k, end;
    brunt_bodies_meshes(bodies, boundary->body, &k, &end);
    for (; boundary->kind->holds_meshes && k < end; k++)
        for (int32_t n = 0; n < bodies->fem[k].node_count; n++)
            hold_node(u, world, w, u->base[k] + n, ON_PLANE * bodies->fem[k].mean_edge, dt);
}

// The same of grids; images then follow what they are of.
static void hold_points(brunt_unknowns *u, const brunt_world *world, int w, double dt) {
    const brunt_boundary *boundary = &world->boundaries.boundary[w];
    const brunt_bodies *bodies = &world->bodies;
    int i, end;
    brunt_bodies_points(bodies, boundary->body, &i, &end);
    for (; i < end && !boundary->in_pieces; i++) {
        const brunt_grid *grid = &bodies->mpm[i].grid;
        const double tolerance = ON_PLANE * (double)grid->h;
        for (int64_t q = 0; q < (int64_t)grid->slot_count * BRUNT_BLOCK_NODES; q++) {
            if (u->number[i][q] >= 0) hold_node(u, world, w, u->number[i][q], tolerance, dt);
        }
    }
}

// A plane that moves and pushes has a node of its own, which is in no account: what it does is told by contact.
static void hold_moving_plane(brunt_unknowns *u, int32_t n, int a, double dt) {
    const size_t dof = (size_t)n * (size_t)u->dim + (size_t)a;
    u->held[dof] = 1;
    u->end[dof] = u->velocity[dof], u->target[dof] = dt * u->velocity[dof];
}

void brunt_unknowns_hold(brunt_unknowns *u, const brunt_world *world, double dt) {
    const size_t all = (size_t)u->count * (size_t)u->dim;
    memset(u->held, 0, all);
    memset(u->holder, 0, all * sizeof *u->holder);
    memset(u->target, 0, all * sizeof *u->target);
    memset(u->end, 0, all * sizeof *u->end);
    for (int w = 0; w < world->boundaries.boundary_count; w++)
        for (int a = 0; u->plane[w] >= 0 && a < u->dim; a++) hold_moving_plane(u, u->plane[w], a, dt);
    for (int k = 0; k < world->boundaries.sets.count; k++) hold_group(u, world, k, dt);
    // What is on a plane with images rests there, whatever else would move it: they would not be opposite.
    for (int m = 0; m < world->boundaries.symmetry_count; m++)
        if (world->boundaries.symmetry[m].boundary >= 0)
            hold_points(u, world, world->boundaries.symmetry[m].boundary, dt);
    for (int w = 0; w < world->boundaries.boundary_count; w++)
        if (world->boundaries.boundary[w].kind->hold_at) hold_meshes(u, world, w, dt);
    for (int w = world->boundaries.boundary_count - 1; w >= 0; w--) // as in explicit steps the last one has it
        if (world->boundaries.boundary[w].kind->hold_at) hold_points(u, world, w, dt);
    if (u->images.any) brunt_unknowns_hold_images(u);
}

int32_t brunt_unknowns_passed(const brunt_unknowns *u, const brunt_world *world, const double *way, double dt,
                              const brunt_boundary **boundary) {
    const brunt_bodies *bodies = &world->bodies;
    for (int w = 0; w < world->boundaries.boundary_count; w++) {
        *boundary = &world->boundaries.boundary[w];
        const brunt_plane_def *plane = &(*boundary)->plane;
        if (!brunt_boundary_holds(*boundary)) continue;
        int k, end;
        brunt_bodies_meshes(bodies, (*boundary)->body, &k, &end);
        for (; k < end; k++) {
            const double tolerance = ON_PLANE * bodies->fem[k].mean_edge;
            for (int32_t n = u->base[k]; n < u->base[k] + bodies->fem[k].node_count; n++) {
                const double before = distance(u, plane, world->clock.time, n);
                double after = before;
                for (int a = 0; a < u->dim; a++)
                    after += plane->normal[a] * (way[n * (int64_t)u->dim + a] - dt * plane->velocity[a]);
                if (before > tolerance && after < -tolerance) return n;
            }
        }
    }
    return BRUNT_NONE;
}
