// Conditions imposed at nodes: stick and slip on the nodes at and behind a plane, given velocities inside a region.
#include "contact/planes/grid_conditions.h"
#include "contact/distance/particle_extent.h"
#include "contact/planes/condition.h"

#include <math.h>
#include <string.h>

#include "base/array.h"

// Nodes beyond the axis of rings are the images of those before it: they get what those get, mirrored. On the axis
// there is no radial velocity.
static void reflect(bool rings, const double place[3], double h, double now[3]) {
    if (!rings) return;
    if (place[0] < -1e-9 * h) now[0] = -now[0];
    if (fabs(place[0]) <= 1e-9 * h) now[0] = 0;
}

static void set_velocity(brunt_body *body, const brunt_slot *slot, int node, const double now[3],
                         const double support[3], unsigned held, brunt_impulse_account *account) {
    const brunt_grid *grid = &body->grid;
    real *n = brunt_slot_nodes(grid, (int32_t)(slot - grid->slots)) + node * BRUNT_NODE_REALS;
    double x[3], J[3] = {0}, old[3] = {0};
    grid->held[(slot - grid->slots) * BRUNT_BLOCK_NODES + node] |= (uint8_t)held;
    brunt_node_position(grid, slot->coord, node, x);
    if (brunt_total_lagrangian(&body->particles)) brunt_extent_deformed(body, (int32_t)(slot - grid->slots), node, x);
    for (int a = 0; a < grid->dim; a++) {
        J[a] = (double)n[BRUNT_NODE_SPARE] * (now[a] - (double)n[BRUNT_NODE_VELOCITY + a]);
        old[a] = (double)n[BRUNT_NODE_OLD + a];
        n[BRUNT_NODE_VELOCITY + a] = (real)now[a];
    }
    brunt_impulse_account_book(account, &account->normal_loss, J, x, old, now, support);
}

// Of a cell: what a node may stand off a plane or a shape that it is meant to lie in. Places of nodes are rounded by as
// much as they are cells away from the origin, in float that of the cell's edge itself.
static const double ON_PLANE = sizeof(real) == 4 ? 1e-4 : 1e-9;

// Position in the frame the region's shape was described in.
static void unplace(const brunt_placement *place, const double x[3], double out[3]) {
    for (int a = 0; a < 3; a++) {
        out[a] = 0;
        for (int r = 0; r < 3; r++) out[a] += place->rotation[3 * r + a] * (x[r] - place->translation[r]);
    }
}

static void apply_region(brunt_body *body, bool rings, brunt_boundary *wall) {
    const brunt_grid *grid = &body->grid;
    unsigned held = 0;
    for (int a = 0; a < grid->dim; a++) held |= (unsigned)wall->where.component[a] << a;
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const brunt_slot *slot = &grid->slots[s];
        double middle[3], local[3], place[3], reach = 0.5 * sqrt((double)grid->dim) * grid->side * (double)grid->h;
        for (int a = 0; a < 3; a++)
            middle[a] = a < grid->dim ? grid->origin[a] + (double)grid->h * (slot->coord[a] + 0.5) * grid->side : 0;
        if (rings) middle[0] = fabs(middle[0]); // what reaches over the axis is no farther from the image of a place
        unplace(&wall->where.place, middle, local);
        if (brunt_shape_distance(&wall->where.shape, grid->dim, local) > reach) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            real *n = brunt_slot_nodes(grid, s) + node * BRUNT_NODE_REALS;
            if (!(n[0] > 0)) continue;
            double x[3], now[3] = {0}, support[3] = {0};
            brunt_node_position(grid, slot->coord, node, place);
            memcpy(x, place, sizeof x);
            if (rings) x[0] = fabs(x[0]);
            unplace(&wall->where.place, x, local);
            if (brunt_shape_distance(&wall->where.shape, grid->dim, local) > ON_PLANE * (double)grid->h) continue;
            for (int a = 0; a < grid->dim; a++) {
                now[a] = wall->where.component[a] ? wall->where.velocity[a] : (double)n[BRUNT_NODE_VELOCITY + a];
                support[a] = wall->where.component[a] ? wall->where.velocity[a] : 0;
            }
            if (wall->where.component[0]) reflect(rings, place, (double)grid->h, now);
            set_velocity(body, slot, node, now, support, held, &wall->last);
        }
    }
}

// Of a total-Lagrangian body the plane lies in the undeformed configuration and holds what was behind it at the start.
static void apply_plane(brunt_body *body, bool rings, brunt_boundary *wall, double time) {
    const brunt_grid *grid = &body->grid;
    if (brunt_total_lagrangian(&body->particles)) time = 0;
    const brunt_plane_def *plane = &wall->plane;
    double offset = 0, reach = ON_PLANE * (double)grid->h;
    const unsigned held = brunt_condition_components(plane, grid->dim);
    const bool sticks = brunt_conditions[plane->condition].sticks;
    for (int a = 0; a < grid->dim; a++) {
        offset += plane->normal[a] * (plane->point[a] + plane->velocity[a] * time);
        reach += fabs(plane->normal[a]) * 0.5 * grid->side * (double)grid->h;
    }
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const brunt_slot *slot = &grid->slots[s];
        double middle = -offset;
        for (int a = 0; a < grid->dim; a++) {
            const double at = grid->origin[a] + (double)grid->h * (slot->coord[a] + 0.5) * grid->side;
            middle += plane->normal[a] * (rings && a == 0 ? fabs(at) : at);
        }
        if (middle > reach) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            real *n = brunt_slot_nodes(grid, s) + node * BRUNT_NODE_REALS;
            if (!(n[0] > 0)) continue;
            double x[3], v[3] = {0}, now[3] = {0}, distance = -offset, approach = 0;
            brunt_node_position(grid, slot->coord, node, x);
            for (int a = 0; a < grid->dim; a++) {
                const double sign = rings && a == 0 && x[0] < 0 ? -1 : 1;
                v[a] = sign * (double)n[BRUNT_NODE_VELOCITY + a];
                distance += plane->normal[a] * sign * x[a];
                approach += plane->normal[a] * (v[a] - plane->velocity[a]);
            }
            if (distance > ON_PLANE * (double)grid->h) continue;
            for (int a = 0; a < grid->dim; a++)
                now[a] = sticks ? plane->velocity[a] : v[a] - approach * plane->normal[a];
            reflect(rings, x, (double)grid->h, now);
            set_velocity(body, slot, node, now, plane->velocity, held, &wall->last);
        }
    }
}

int brunt_condition_clear(brunt_body *body) {
    const size_t bytes = (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES;
    if (BRUNT_RESERVE(body->grid.held, bytes, 0)) return -1;
    memset(body->grid.held, 0, bytes);
    return 0;
}

void brunt_condition_apply(brunt_body *body, brunt_boundary *wall, double time) {
    if (wall->region) {
        if (time >= wall->where.start && time < wall->where.end)
            apply_region(body, brunt_axisymmetric(&body->particles), wall);
    } else {
        apply_plane(body, brunt_axisymmetric(&body->particles), wall, time);
    }
}
