// Planes: bodies stick to them, slip along them, are pushed by them, or are mirrored at them.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/boundaries.h"
#include "boundary/kinds.h"
#include "contact/planes/condition.h"
#include "contact/planes/grid_conditions.h"
#include "contact/search/particle_plane.h"
#include "contact/search/plane_contact.h"
#include "materials/material.h"

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

// ------------------------------------------------------------------------------------------ definition

BRUNT_BOUNDARY_ENTRIES(plane, brunt_plane)

brunt_plane_def brunt_plane_def_default(void) { return (brunt_plane_def){.condition = BRUNT_SEPARATE}; }

static const char *body_of(const void *one) { return ((const brunt_plane_def *)one)->body; }

static void free_all(brunt_world_def *def) { brunt_free(def->planes); }

static int check(const brunt_world_def *def, const void *entry, int32_t w, brunt_error *error) {
    const brunt_plane_def *plane = entry;
    char owner[80];
    snprintf(owner, sizeof owner, "boundaries[%d].plane", w);
    BRUNT_TRY(
        brunt_check_choice(owner, ".condition", (unsigned)plane->condition, (unsigned)brunt_condition_count, error));
    BRUNT_CHECK_NUMBERS(owner, {".point", plane->point, def->dimension, BRUNT_ANY_NUMBER},
                        {".normal", plane->normal, def->dimension, BRUNT_ANY_NUMBER},
                        {".friction", &plane->friction, 1, BRUNT_ANY_NUMBER},
                        {".velocity", plane->velocity, def->dimension, BRUNT_ANY_NUMBER});
    return BRUNT_OK;
}

// A plane along an axis holds components of nodes; one that is oblique would couple them.
static bool oblique(const brunt_plane_def *plane) {
    int along = 0;
    for (int a = 0; a < 3; a++) along += plane->normal[a] != 0;
    return along > 1;
}

// Whether there is a body of elements, or of material points, that it acts on.
static bool acts_on(const brunt_world_def *def, const brunt_plane_def *plane, bool meshes) {
    bool any = false;
    for (int32_t i = 0; i < def->body_count && !any; i++)
        any = (def->bodies[i].method != BRUNT_MPM) == meshes &&
              (!plane->body[0] || !strcmp(plane->body, def->bodies[i].name));
    return any;
}

static const char *refusal(const brunt_world_def *def, const void *one, const char **key) {
    if (!brunt_scheme_minimises(def->scheme)) return NULL;
    const brunt_plane_def *plane = one;
    const brunt_condition_row *row = &brunt_conditions[plane->condition];
    *key = ".friction";
    if (def->scheme == BRUNT_STATIC && plane->friction > 0 && !brunt_friction_in_load_steps(def))
        return BRUNT_FRICTION_NOT_STATIC;
    *key = ".condition";
    if (row->pushes || row->sticks || !oblique(plane)) return NULL;
    if (brunt_solver_iterates(def->newton.solver))
        return "newton.solver: implicit steps hold material points on such a plane by tractions, for which conjugate "
               "gradients have no factor: direct or auto";
    return acts_on(def, plane, true) ? "implicit steps hold nodes of meshes on planes that are normal to an axis"
                                     : NULL;
}

// ------------------------------------------------------------------------------------------ making

static const double ON_GRID_LINE = 1e-6; // cells: how far off a symmetry plane may be and still count as on the line

// Index of the axis a plane is normal to, BRUNT_NONE when it is oblique.
static int plane_axis(const brunt_plane_def *plane, int dim) {
    for (int a = 0; a < dim; a++)
        if (fabs(fabs(plane->normal[a]) - 1) < 1e-12) return a;
    return BRUNT_NONE;
}

static int make(const brunt_boundary_making *m, const void *one, int index, brunt_error *error) {
    const brunt_world_def *def = m->def;
    brunt_boundaries *all = m->all;
    brunt_boundary *boundary = &all->boundary[index];
    boundary->plane = *(const brunt_plane_def *)one;
    brunt_plane_def *plane = &boundary->plane;
    double size = 0;
    for (int a = 0; a < def->dimension; a++) size += plane->normal[a] * plane->normal[a];
    if (!(size > 0) || !isfinite(size)) REFUSE("boundaries[%d].plane.normal: it has no direction", index);
    for (int a = 0; a < 3; a++) plane->normal[a] = a < def->dimension ? plane->normal[a] / sqrt(size) : 0;
    if (!(plane->friction >= 0)) REFUSE("boundaries[%d].friction: %g is negative", index, plane->friction);
    bool moves = plane->velocity[0] != 0 || plane->velocity[1] != 0 || plane->velocity[2] != 0;
    int axis = plane_axis(plane, def->dimension);
    double at = axis < 0 ? 0 : (plane->point[axis] - def->origin[axis]) / def->cell;
    bool on_line = axis >= 0 && !moves && fabs(at - round(at)) < ON_GRID_LINE;
    if (!acts_on(def, plane, false)) { // meshes hold their nodes on any plane themselves
        all->has_friction = all->has_friction || plane->friction > 0;
        return BRUNT_OK;
    }
    const brunt_condition_row *row = &brunt_conditions[plane->condition];
    if (row->images && !on_line)
        REFUSE("boundaries[%d] (%s): a symmetry plane must stand still, be normal to an axis and lie on a grid line "
               "(cell %g m)",
               index, boundary->name, def->cell);
    // Nodes of splines that hold on a line of the grid would hold half a cell before it; images hold what is there.
    // What is behind it from the start they cannot: hold_what_is_behind of world.c.
    const bool odd = on_line && row->sticks && def->kernel != BRUNT_LINEAR;
    if (on_line && (row->symmetry || odd)) {
        if (all->symmetry_count == (int)(sizeof all->symmetry / sizeof all->symmetry[0]))
            REFUSE("boundaries: more than 16 planes of symmetry or on lines of the grid");
        for (int k = 0; k < all->symmetry_count; k++) {
            const brunt_symmetry_plane *other = &all->symmetry[k];
            int32_t apart = (int32_t)round(at) - other->node;
            if (!odd && other->boundary >= 0 && other->axis == axis && apart != 0 && abs(apart) <= (int)def->kernel &&
                brunt_boundary_has_fluid(def))
                brunt_warn(
                    m->messages,
                    "boundaries[%d] (%s): this plane of symmetry or slip and '%s' are %d cells apart; the kernel "
                    "reaches over both, and fluids leak: at least %d are wanted",
                    index, boundary->name, all->boundary[other->boundary].name, abs(apart), (int)def->kernel + 1);
        }
        boundary->symmetry_plane = all->symmetry_count;
        all->symmetry[all->symmetry_count++] = (brunt_symmetry_plane){.axis = axis,
                                                                      .node = (int32_t)round(at),
                                                                      .side = plane->normal[axis] > 0 ? 1 : -1,
                                                                      .sticks = odd,
                                                                      .boundary = index};
        return BRUNT_OK;
    }
    // On a line of the grid nodes hold; elsewhere those behind it would, as much as a cell away.
    boundary->in_pieces =
        brunt_scheme_minimises(def->scheme) && !row->pushes && !on_line && !brunt_solver_iterates(def->newton.solver);
    if (row->of_fluids && brunt_boundary_has_fluid(def))
        brunt_warn(m->messages, "boundaries[%d] (%s): %s", index, boundary->name, row->of_fluids);
    all->meets_points = all->meets_points || row->pushes;
    all->has_conditions = all->has_conditions || !row->pushes;
    all->has_friction = all->has_friction || (row->pushes && plane->friction > 0);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ steps

static const double *velocity(const brunt_boundary *b) { return b->plane.velocity; }

// Of a total-Lagrangian body the plane lies in the undeformed configuration and holds what was behind it at the start.
static void hold_grid(const brunt_held_grid *g, brunt_boundary *boundary, double time) {
    brunt_body *body = g->body;
    if (boundary->symmetry_plane >= 0 || !brunt_boundary_holds(boundary)) return;
    const bool axisymmetric = brunt_axisymmetric(&body->particles);
    const brunt_grid *grid = &body->grid;
    if (brunt_total_lagrangian(&body->particles)) time = 0;
    const brunt_plane_def *plane = &boundary->plane;
    double offset = 0, extent = BRUNT_ON_BOUNDARY * (double)grid->h;
    const unsigned held = brunt_condition_components(plane, grid->dim);
    const bool sticks = brunt_conditions[plane->condition].sticks;
    for (int a = 0; a < grid->dim; a++) {
        offset += plane->normal[a] * (plane->point[a] + plane->velocity[a] * time);
        extent += fabs(plane->normal[a]) * 0.5 * grid->side * (double)grid->h;
    }
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const brunt_slot *slot = &grid->slots[s];
        double middle = -offset;
        for (int a = 0; a < grid->dim; a++) {
            const double at = grid->origin[a] + (double)grid->h * (slot->coord[a] + 0.5) * grid->side;
            middle += plane->normal[a] * (axisymmetric && a == 0 ? fabs(at) : at);
        }
        if (middle > extent) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            real *n = brunt_slot_nodes(grid, s) + node * BRUNT_NODE_REALS;
            if (!(n[0] > 0)) continue;
            double x[3], v[3] = {0}, now[3] = {0}, distance = -offset, approach = 0;
            brunt_node_position(grid, slot->coord, node, x);
            for (int a = 0; a < grid->dim; a++) {
                const double sign = axisymmetric && a == 0 && x[0] < 0 ? -1 : 1;
                v[a] = sign * (double)n[BRUNT_NODE_VELOCITY + a];
                distance += plane->normal[a] * sign * x[a];
                approach += plane->normal[a] * (v[a] - plane->velocity[a]);
            }
            if (distance > BRUNT_ON_BOUNDARY * (double)grid->h) continue;
            for (int a = 0; a < grid->dim; a++)
                now[a] = sticks ? plane->velocity[a] : v[a] - approach * plane->normal[a];
            brunt_condition_reflect(axisymmetric, x, (double)grid->h, now);
            brunt_condition_hold(g, slot, node, now, plane->velocity, held, &boundary->last);
        }
    }
}

static unsigned hold_at(const brunt_boundary *b, int dim, double time, const double x[3], double tolerance,
                        double v[3]) {
    if (!brunt_boundary_holds(b) || brunt_plane_distance(&b->plane, time, x) > tolerance) return 0;
    for (int a = 0; a < dim; a++) v[a] = b->plane.velocity[a];
    return brunt_condition_components(&b->plane, dim);
}

const brunt_boundary_kind brunt_kind_plane = {
    BRUNT_BOUNDARY_ROW("plane"),
    .is_plane = true,
    .body = body_of,
    .refusal = refusal,
    .velocity = velocity,
    .hold_grid = hold_grid,
    .hold_at = hold_at,
    .holds_meshes = true,
    .near_surface = brunt_plane_near_surface,
    .meet_surface = brunt_plane_meet_surface,
    .meet_points = brunt_plane_meet_points,
};
