// Conditions imposed at nodes: stick and slip on the nodes at and behind a plane, given velocities inside a region.
#include "contact.h"

#include <math.h>
#include <string.h>

static void set_velocity(const brunt_grid *grid, real *n, const brunt_slot *slot, int node, const double now[3],
                         const double support[3], brunt_action *action) {
    double x[3], J[3] = {0}, old[3] = {0};
    brunt_node_position(grid, slot->coord, node, x);
    for (int a = 0; a < grid->dim; a++) {
        J[a] = (double)n[BRUNT_NODE_SPARE] * (now[a] - (double)n[BRUNT_NODE_VELOCITY + a]);
        old[a] = (double)n[BRUNT_NODE_OLD + a];
        n[BRUNT_NODE_VELOCITY + a] = (real)now[a];
    }
    brunt_action_book(action, &action->normal_loss, J, x, old, now, support);
}

// Position in the frame the region's shape was described in.
static void unplace(const brunt_placement *place, const double x[3], double out[3]) {
    for (int a = 0; a < 3; a++) {
        out[a] = 0;
        for (int r = 0; r < 3; r++) out[a] += place->rotation[3 * r + a] * (x[r] - place->translation[r]);
    }
}

static void apply_region(const brunt_grid *grid, brunt_wall *wall) {
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const brunt_slot *slot = &grid->slots[s];
        double middle[3], local[3], reach = 0.5 * sqrt((double)grid->dim) * grid->side * (double)grid->h;
        for (int a = 0; a < 3; a++)
            middle[a] = a < grid->dim ? grid->origin[a] + (double)grid->h * (slot->coord[a] + 0.5) * grid->side : 0;
        unplace(&wall->where.place, middle, local);
        if (brunt_shape_distance(&wall->where.shape, grid->dim, local) > reach) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            real *n = brunt_slot_nodes(grid, s) + node * BRUNT_NODE_REALS;
            if (!(n[0] > 0)) continue;
            double x[3], now[3] = {0}, support[3] = {0};
            brunt_node_position(grid, slot->coord, node, x);
            unplace(&wall->where.place, x, local);
            if (brunt_shape_distance(&wall->where.shape, grid->dim, local) > 1e-9 * (double)grid->h) continue;
            for (int a = 0; a < grid->dim; a++) {
                now[a] = wall->where.component[a] ? wall->where.velocity[a] : (double)n[BRUNT_NODE_VELOCITY + a];
                support[a] = wall->where.component[a] ? wall->where.velocity[a] : 0;
            }
            set_velocity(grid, n, slot, node, now, support, &wall->last);
        }
    }
}

static void apply_plane(const brunt_grid *grid, brunt_wall *wall, double time) {
    const brunt_plane_def *plane = &wall->plane;
    double offset = 0, reach = 0;
    for (int a = 0; a < grid->dim; a++) {
        offset += plane->normal[a] * (plane->point[a] + plane->velocity[a] * time);
        reach += fabs(plane->normal[a]) * 0.5 * grid->side * (double)grid->h;
    }
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const brunt_slot *slot = &grid->slots[s];
        double middle = -offset;
        for (int a = 0; a < grid->dim; a++)
            middle += plane->normal[a] * (grid->origin[a] + (double)grid->h * (slot->coord[a] + 0.5) * grid->side);
        if (middle > reach) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            real *n = brunt_slot_nodes(grid, s) + node * BRUNT_NODE_REALS;
            if (!(n[0] > 0)) continue;
            double x[3], now[3] = {0}, distance = -offset, approach = 0;
            brunt_node_position(grid, slot->coord, node, x);
            for (int a = 0; a < grid->dim; a++) {
                distance += plane->normal[a] * x[a];
                approach += plane->normal[a] * ((double)n[BRUNT_NODE_VELOCITY + a] - plane->velocity[a]);
            }
            if (distance > 1e-9 * (double)grid->h) continue;
            for (int a = 0; a < grid->dim; a++)
                now[a] = plane->condition == BRUNT_STICK
                             ? plane->velocity[a]
                             : (double)n[BRUNT_NODE_VELOCITY + a] - approach * plane->normal[a];
            set_velocity(grid, n, slot, node, now, plane->velocity, &wall->last);
        }
    }
}

void brunt_condition_apply(brunt_body *body, brunt_wall *wall, double time) {
    if (wall->region) {
        if (time >= wall->where.start && time < wall->where.end) apply_region(&body->grid, wall);
    } else {
        apply_plane(&body->grid, wall, time);
    }
}
