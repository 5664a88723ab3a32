#include "contact/planes/grid_conditions.h"
#include "contact/distance/particle_extent.h"

#include <math.h>
#include <string.h>

#include "base/array.h"

void brunt_condition_reflect(bool axisymmetric, const double position[3], double h, double now[3]) {
    if (!axisymmetric) return;
    if (position[0] < -1e-9 * h) now[0] = -now[0];
    if (fabs(position[0]) <= 1e-9 * h) now[0] = 0;
}

void brunt_condition_hold(brunt_body *body, const brunt_slot *slot, int node, const double now[3], const double rest[3],
                          unsigned held, brunt_impulse_account *account) {
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
    brunt_impulse_account_record(account, &account->normal_loss, J, x, old, now, rest);
}

int brunt_condition_clear(brunt_body *body, brunt_error *error) {
    const size_t bytes = (size_t)body->grid.slot_count * BRUNT_BLOCK_NODES;
    if (BRUNT_CAPACITY(body->grid.held, bytes, 0, "grid nodes under conditions", error)) return BRUNT_FAILED;
    memset(body->grid.held, 0, bytes);
    return BRUNT_OK;
}
