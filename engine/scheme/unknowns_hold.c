// What is given of an implicit step's unknowns: planes, regions and groups of nodes hold components, and move them.
#include <math.h>
#include <string.h>

#include "boundary/curve.h"
#include "contact/planes/condition.h"
#include "scheme/unknowns.h"

static const double ON_PLANE = 1e-6; // cells, mean edges: how far off a plane a node may be and still lie on it

// Holds component `a` of node n by wall w, unless another does already.
static void hold(brunt_unknowns *u, int32_t n, int a, int w, double target, double end) {
    const size_t dof = (size_t)n * (size_t)u->dim + (size_t)a;
    if (u->held[dof]) return;
    u->held[dof] = 1;
    u->holder[dof] = (int16_t)(w + 1);
    u->target[dof] = target, u->end[dof] = end;
}

// ------------------------------------------------------------------------------------------ groups

static void hold_group(brunt_unknowns *u, const brunt_world *world, int k, double dt) {
    const brunt_node_sets *sets = &world->boundaries.sets;
    const brunt_node_set *set = &sets->set[k];
    const brunt_group_def *def = &set->def;
    const bool velocity = def->action == BRUNT_GROUP_VELOCITY;
    if (!velocity && def->action != BRUNT_GROUP_DISPLACEMENT && def->action != BRUNT_GROUP_ROTATION) return;
    const double time = world->clock.time, middle = brunt_curve_at(&def->table, time + 0.5 * dt),
                 then = brunt_curve_at(&def->table, time + dt);
    const brunt_placement goal = brunt_node_set_goal(set, time + dt);
    const int wall = (int)(set->wall - world->boundaries.walls);
    for (int32_t i = 0; i < set->node_count; i++) {
        const int32_t n = set->node[i];
        for (int a = 0; a < u->dim; a++) {
            if (sets->holder[set->fem_index][n][a] != k + 1) continue;
            const double way = velocity ? dt * middle * def->value[a] : brunt_node_set_way(set, &goal, n, a);
            hold(u, u->base[set->fem_index] + n, a, wall, way, velocity ? then * def->value[a] : way / dt);
        }
    }
}

// ------------------------------------------------------------------------------------------ planes

static bool acts_on(const brunt_boundary *wall, int body) { return wall->body < 0 || wall->body == body; }

// Distance of a node to a plane as it is at the start of the step [m].
static double distance(const brunt_unknowns *u, const brunt_plane_def *plane, double time, int32_t n) {
    double gap = 0;
    for (int a = 0; a < u->dim; a++)
        gap += plane->normal[a] *
               (u->place[(size_t)n * (size_t)u->dim + (size_t)a] - plane->point[a] - plane->velocity[a] * time);
    return gap;
}

static void hold_plane_node(brunt_unknowns *u, const brunt_boundary *wall, int w, int32_t n, double dt) {
    const unsigned held = brunt_condition_components(&wall->plane, u->dim);
    for (int a = 0; a < u->dim; a++)
        if (held >> a & 1) hold(u, n, a, w, dt * wall->plane.velocity[a], wall->plane.velocity[a]);
}

// Nodes at a plane and behind it.
static void hold_plane(brunt_unknowns *u, const brunt_world *world, int w, double dt) {
    const brunt_boundary *wall = &world->boundaries.walls[w];
    if (!brunt_boundary_holds(wall)) return;
    const brunt_bodies *bodies = &world->bodies;
    for (int k = 0; k < bodies->fem_count; k++)
        for (int32_t i = 0; acts_on(wall, bodies->fem[k].index) && i < bodies->fem[k].node_count; i++)
            if (distance(u, &wall->plane, world->clock.time, u->base[k] + i) <= ON_PLANE * bodies->fem[k].mean_edge)
                hold_plane_node(u, wall, w, u->base[k] + i, dt);
    for (int i = 0; i < bodies->mpm_count; i++) {
        const brunt_grid *grid = &bodies->mpm[i].grid;
        const int64_t nodes = acts_on(wall, bodies->mpm[i].index) ? (int64_t)grid->slot_count * BRUNT_BLOCK_NODES : 0;
        for (int64_t q = 0; q < nodes; q++) {
            const int32_t n = u->number[i][q];
            if (n >= 0 && distance(u, &wall->plane, world->clock.time, n) <= ON_PLANE * (double)grid->h)
                hold_plane_node(u, wall, w, n, dt);
        }
    }
}

// A plane that moves and pushes has a node of its own, which is nobody's account: what it does is told by contact.
static void hold_moving_plane(brunt_unknowns *u, int32_t n, int a, double dt) {
    const size_t dof = (size_t)n * (size_t)u->dim + (size_t)a;
    u->held[dof] = 1;
    u->end[dof] = u->velocity[dof], u->target[dof] = dt * u->velocity[dof];
}

// ------------------------------------------------------------------------------------------ regions

static void hold_region_grid(brunt_unknowns *u, const brunt_boundary *wall, int w, const brunt_grid *grid,
                             const int32_t *number, double dt) {
    const brunt_region_def *where = &wall->where;
    for (int64_t q = 0; q < (int64_t)grid->slot_count * BRUNT_BLOCK_NODES; q++) {
        const int32_t n = number[q];
        if (n < 0) continue;
        double local[3] = {0};
        for (int a = 0; a < 3; a++)
            for (int r = 0; r < 3; r++)
                local[a] +=
                    where->place.rotation[3 * r + a] *
                    ((r < u->dim ? u->place[(size_t)n * (size_t)u->dim + (size_t)r] : 0) - where->place.translation[r]);
        if (brunt_shape_distance(&where->shape, u->dim, local) > ON_PLANE * (double)grid->h) continue;
        for (int a = 0; a < u->dim; a++)
            if (where->component[a]) hold(u, n, a, w, dt * where->velocity[a], where->velocity[a]);
    }
}

static void hold_region(brunt_unknowns *u, const brunt_world *world, int w, double dt) {
    const brunt_boundary *wall = &world->boundaries.walls[w];
    const double time = world->clock.time;
    if (!(time >= wall->where.start && time < wall->where.end)) return;
    for (int i = 0; i < world->bodies.mpm_count; i++)
        if (acts_on(wall, world->bodies.mpm[i].index))
            hold_region_grid(u, wall, w, &world->bodies.mpm[i].grid, u->number[i], dt);
}

void brunt_unknowns_hold(brunt_unknowns *u, const brunt_world *world, double dt) {
    const size_t all = (size_t)u->count * (size_t)u->dim;
    memset(u->held, 0, all);
    memset(u->holder, 0, all * sizeof *u->holder);
    memset(u->target, 0, all * sizeof *u->target);
    memset(u->end, 0, all * sizeof *u->end);
    for (int w = 0; w < world->boundaries.wall_count; w++)
        for (int a = 0; u->plane[w] >= 0 && a < u->dim; a++) hold_moving_plane(u, u->plane[w], a, dt);
    for (int k = 0; k < world->boundaries.sets.count; k++) hold_group(u, world, k, dt);
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        const brunt_boundary *wall = &world->boundaries.walls[w];
        if (wall->group) continue;
        if (wall->region)
            hold_region(u, world, w, dt);
        else
            hold_plane(u, world, w, dt);
    }
}

int32_t brunt_unknowns_passed(const brunt_unknowns *u, const brunt_world *world, const double *way, double dt,
                              const brunt_boundary **wall) {
    const brunt_bodies *bodies = &world->bodies;
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        *wall = &world->boundaries.walls[w];
        const brunt_plane_def *plane = &(*wall)->plane;
        if (!brunt_boundary_holds(*wall)) continue;
        for (int k = 0; k < bodies->fem_count; k++) {
            const double slack = ON_PLANE * bodies->fem[k].mean_edge;
            const int32_t nodes = acts_on(*wall, bodies->fem[k].index) ? bodies->fem[k].node_count : 0;
            for (int32_t n = u->base[k]; n < u->base[k] + nodes; n++) {
                const double before = distance(u, plane, world->clock.time, n);
                double after = before;
                for (int a = 0; a < u->dim; a++)
                    after += plane->normal[a] * (way[n * (int64_t)u->dim + a] - dt * plane->velocity[a]);
                if (before > slack && after < -slack) return n;
            }
        }
    }
    return -1;
}
