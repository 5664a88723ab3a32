// Regions of the grid of material points with a prescribed velocity.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/check.h"
#include "base/memory.h"
#include "boundary/boundaries.h"
#include "boundary/kinds.h"
#include "contact/planes/grid_conditions.h"
#include "geometry/shape_check.h"

BRUNT_BOUNDARY_ENTRIES(region, brunt_region)

brunt_region_def brunt_region_def_default(void) {
    return (brunt_region_def){.place = brunt_placement_identity(), .component = {true, true, true}, .end = INFINITY};
}

static const char *body_of(const void *one) { return ((const brunt_region_def *)one)->body; }

static void free_all(brunt_world_def *def) {
    for (int32_t i = 0; i < def->region_count; i++) brunt_shape_free(&def->regions[i].shape);
    brunt_free(def->regions);
}

static int check(const brunt_world_def *def, const void *entry, int32_t w, brunt_error *error) {
    const brunt_region_def *region = entry;
    char owner[80];
    snprintf(owner, sizeof owner, "boundaries[%d].region", w);
    BRUNT_CHECK_NUMBERS(owner, {".velocity", region->velocity, def->dimension, BRUNT_ANY_NUMBER},
                        {".start", &region->start, 1, BRUNT_OR_INFINITE}, {".end", &region->end, 1, BRUNT_OR_INFINITE});
    BRUNT_TRY(brunt_check_shape(owner, &region->shape, def->dimension, 0, error));
    BRUNT_TRY(brunt_check_placement(owner, &region->place, error));
    return BRUNT_OK;
}

static int make(const brunt_boundary_making *m, const void *one, int w, brunt_error *error) {
    (void)error;
    m->all->boundary[w].where = *(const brunt_region_def *)one;
    m->all->has_conditions = true;
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ steps

static const double *velocity(const brunt_boundary *b) { return b->where.velocity; }

static bool acts_at(const brunt_boundary *b, double time) { return time >= b->where.start && time < b->where.end; }

// Position in the frame the region's shape was described in.
static void unplace(const brunt_placement *place, const double x[3], double out[3]) {
    for (int a = 0; a < 3; a++) {
        out[a] = 0;
        for (int r = 0; r < 3; r++) out[a] += place->rotation[3 * r + a] * (x[r] - place->translation[r]);
    }
}

static void hold_grid(const brunt_held_grid *g, brunt_boundary *boundary, double time) {
    brunt_body *body = g->body;
    if (!acts_at(boundary, time)) return;
    const bool axisymmetric = brunt_axisymmetric(&body->particles);
    const brunt_grid *grid = &body->grid;
    unsigned held = 0;
    for (int a = 0; a < grid->dim; a++) held |= (unsigned)boundary->where.component[a] << a;
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const brunt_slot *slot = &grid->slots[s];
        double middle[3], local[3], place[3], extent = 0.5 * sqrt((double)grid->dim) * grid->side * (double)grid->h;
        for (int a = 0; a < 3; a++)
            middle[a] = a < grid->dim ? grid->origin[a] + (double)grid->h * (slot->coord[a] + 0.5) * grid->side : 0;
        if (axisymmetric)
            middle[0] = fabs(middle[0]); // what reaches over the axis is no farther from the image of a place
        unplace(&boundary->where.place, middle, local);
        if (brunt_shape_distance(&boundary->where.shape, grid->dim, local) > extent) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            real *n = brunt_slot_nodes(grid, s) + node * BRUNT_NODE_REALS;
            if (!(n[0] > 0)) continue;
            double x[3], now[3] = {0}, rest[3] = {0};
            brunt_node_position(grid, slot->coord, node, place);
            memcpy(x, place, sizeof x);
            if (axisymmetric) x[0] = fabs(x[0]);
            unplace(&boundary->where.place, x, local);
            if (brunt_shape_distance(&boundary->where.shape, grid->dim, local) > BRUNT_ON_BOUNDARY * (double)grid->h)
                continue;
            for (int a = 0; a < grid->dim; a++) {
                now[a] =
                    boundary->where.component[a] ? boundary->where.velocity[a] : (double)n[BRUNT_NODE_VELOCITY + a];
                rest[a] = boundary->where.component[a] ? boundary->where.velocity[a] : 0;
            }
            if (boundary->where.component[0]) brunt_condition_reflect(axisymmetric, place, (double)grid->h, now);
            brunt_condition_hold(g, slot, node, now, rest, held, &boundary->last);
        }
    }
}

static unsigned hold_at(const brunt_boundary *b, int dim, double time, const double x[3], double tolerance,
                        double v[3]) {
    double local[3];
    unsigned held = 0;
    if (!acts_at(b, time)) return 0;
    unplace(&b->where.place, x, local);
    if (brunt_shape_distance(&b->where.shape, dim, local) > tolerance) return 0;
    for (int a = 0; a < dim; a++) v[a] = b->where.velocity[a], held |= (unsigned)b->where.component[a] << a;
    return held;
}

const brunt_boundary_kind brunt_kind_region = {
    BRUNT_BOUNDARY_ROW("region"), .body = body_of, .velocity = velocity, .hold_grid = hold_grid, .hold_at = hold_at,
};
