// Mirror planes. A body cut by a symmetry plane that runs through grid nodes is computed as the half of a whole: the
// mirror image's particles would give the nodes exactly what the body gives to the mirrored nodes. So each node gets
// its own sums plus the reflected sums of its partner, and node pairs stay each other's reflection from then on. The
// spare real of a node keeps the mass that the body itself has there, for the energy and momentum ledgers.
#include "contact/planes/symmetry.h"

#include <string.h>

// Nodes further than the kernel reaches from the plane have no partner with mass on the other side; two layers cover a
// cubic kernel and a body that has sunk into the plane by less than a cell.
enum { LAYERS = 2 };

// Momentum that a pair of nodes carries for the body itself: before folding its own, afterwards its share of the common
// velocity.
static void sum_momentum(const real *n, const double x[3], int dim, double factor, double taken, double linear[3],
                         double angular[3]) {
    double p[3] = {0, 0, 0};
    for (int a = 0; a < dim; a++)
        p[a] = factor * (taken * (double)n[BRUNT_NODE_VELOCITY + a] + (double)n[BRUNT_NODE_OLD + a]);
    for (int a = 0; a < 3; a++) {
        int i = (a + 1) % 3, j = (a + 2) % 3;
        linear[a] += p[a];
        angular[a] += x[i] * p[j] - x[j] * p[i];
    }
}

void brunt_symmetry_fold(brunt_body *body, const brunt_symmetry_plane *mirror, double taken,
                         brunt_impulse_account *action) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, axis = mirror->axis;
    double before[3] = {0}, after[3] = {0}, turn_before[3] = {0}, turn_after[3] = {0};
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const brunt_slot *slot = &grid->slots[s];
        int32_t first = slot->coord[axis] * grid->side;
        if (first > mirror->node || first + grid->side <= mirror->node - LAYERS) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            int local[3];
            brunt_node_local(grid, node, local);
            int depth = mirror->node - (first + local[axis]);
            if (depth < 0 || depth > LAYERS) continue;
            real *n = brunt_slot_nodes(grid, s) + node * BRUNT_NODE_REALS;
            int32_t at[3] = {0, 0, 0};
            for (int a = 0; a < dim; a++) at[a] = slot->coord[a] * grid->side + local[a];
            double x[3], y[3];
            brunt_node_position(grid, slot->coord, node, x);
            memcpy(y, x, sizeof y);
            if (depth == 0) {
                sum_momentum(n, x, dim, n[0] > 0 ? (double)(n[BRUNT_NODE_SPARE] / n[0]) : 0, taken, before,
                             turn_before);
                n[BRUNT_NODE_VELOCITY + axis] = n[BRUNT_NODE_OLD + axis] = 0;
                sum_momentum(n, x, dim, n[0] > 0 ? (double)(n[BRUNT_NODE_SPARE] / n[0]) : 0, taken, after, turn_after);
                continue;
            }
            at[axis] = mirror->node + depth;
            y[axis] = grid->origin[axis] + (double)grid->h * at[axis];
            real *m = brunt_grid_node(grid, at);
            if (!m || (n[0] <= 0 && m[0] <= 0)) continue;
            // The share of a node's own mass in what earlier mirrors have put there.
            double own_n = n[0] > 0 ? (double)(n[BRUNT_NODE_SPARE] / n[0]) : 0,
                   own_m = m[0] > 0 ? (double)(m[BRUNT_NODE_SPARE] / m[0]) : 0;
            sum_momentum(n, x, dim, own_n, taken, before, turn_before);
            sum_momentum(m, y, dim, own_m, taken, before, turn_before);
            for (int r = 0; r < BRUNT_NODE_SPARE; r++) {
                real sign = r == BRUNT_NODE_VELOCITY + axis || r == BRUNT_NODE_OLD + axis ? -1 : 1;
                m[r] += sign * n[r];
                n[r] = sign * m[r];
            }
            sum_momentum(n, x, dim, (double)(n[BRUNT_NODE_SPARE] / n[0]), taken, after, turn_after);
            sum_momentum(m, y, dim, (double)(m[BRUNT_NODE_SPARE] / m[0]), taken, after, turn_after);
        }
    }
    for (int a = 0; a < 3; a++) {
        action->impulse[a] += after[a] - before[a];
        action->angular[a] += turn_after[a] - turn_before[a];
    }
}

int brunt_symmetry_images(const brunt_symmetry_plane *mirrors, int mirror_count, const int32_t node[3], int near,
                          int32_t image[BRUNT_MAX_IMAGES][3], real sign[BRUNT_MAX_IMAGES][3]) {
    int count = 1;
    memcpy(image[0], node, sizeof image[0]);
    for (int a = 0; a < 3; a++) sign[0][a] = 1;
    for (int m = 0; m < mirror_count; m++) {
        int axis = mirrors[m].axis;
        int32_t mirrored = 2 * mirrors[m].node - node[axis];
        if (mirrored - node[axis] > 2 * near || node[axis] - mirrored > 2 * near) continue;
        if (mirrored == node[axis]) { // its own image: nothing moves it along the axis
            for (int k = 0; k < count; k++) sign[k][axis] = 0;
            continue;
        }
        for (int k = 0, had = count; k < had && count < BRUNT_MAX_IMAGES; k++, count++) {
            memcpy(image[count], image[k], sizeof image[k]);
            memcpy(sign[count], sign[k], sizeof sign[k]);
            image[count][axis] = mirrored;
            sign[count][axis] = -sign[k][axis];
        }
    }
    return count;
}
