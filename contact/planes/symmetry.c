// Symmetry planes. A body cut by a symmetry plane that runs through grid nodes is computed as the half of a whole: the
// mirror image's particles would give the nodes exactly what the body gives to the mirrored nodes. So each node gets
// its own sums plus the reflected sums of its partner, and node pairs stay each other's reflection from then on. What
// sticks to a plane has an image with opposite velocities and forces in all components: it is at rest just there, for
// kernels that reach over it as well. The spare real of a node keeps the mass that the body itself has there, for the
// energy and momentum ledgers.
#include "contact/planes/symmetry.h"

#include <stdlib.h>
#include <string.h>

#include "contact/planes/boundary.h"

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

// What becomes of a node's real in its image.
static real turned(const brunt_symmetry_plane *symmetry_plane, int dim, int r) {
    bool turns = false;
    for (int a = 0; a < dim; a++)
        if (a == symmetry_plane->axis || symmetry_plane->sticks)
            turns = turns || r == BRUNT_NODE_VELOCITY + a || r == BRUNT_NODE_OLD + a;
    return turns ? -1 : 1;
}

static void fold(brunt_body *body, const brunt_symmetry_plane *symmetry_plane, double taken,
                 brunt_impulse_account *account) {
    const brunt_grid *grid = &body->grid;
    const int dim = grid->dim, axis = symmetry_plane->axis;
    double before[3] = {0}, after[3] = {0}, turn_before[3] = {0}, turn_after[3] = {0};
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const brunt_slot *slot = &grid->slots[s];
        int32_t first = slot->coord[axis] * grid->side;
        if (first > symmetry_plane->node || first + grid->side <= symmetry_plane->node - LAYERS) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            int local[3];
            brunt_node_local(grid, node, local);
            int depth = symmetry_plane->node - (first + local[axis]);
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
                for (int a = 0; a < dim; a++)
                    if (a == axis || symmetry_plane->sticks) n[BRUNT_NODE_VELOCITY + a] = n[BRUNT_NODE_OLD + a] = 0;
                sum_momentum(n, x, dim, n[0] > 0 ? (double)(n[BRUNT_NODE_SPARE] / n[0]) : 0, taken, after, turn_after);
                continue;
            }
            at[axis] = symmetry_plane->node + depth;
            y[axis] = grid->origin[axis] + (double)grid->h * at[axis];
            real *m = brunt_grid_node(grid, at);
            if (!m || (n[0] <= 0 && m[0] <= 0)) continue;
            // The share of a node's own mass in what earlier symmetry planes have put there.
            double own_n = n[0] > 0 ? (double)(n[BRUNT_NODE_SPARE] / n[0]) : 0,
                   own_m = m[0] > 0 ? (double)(m[BRUNT_NODE_SPARE] / m[0]) : 0;
            sum_momentum(n, x, dim, own_n, taken, before, turn_before);
            sum_momentum(m, y, dim, own_m, taken, before, turn_before);
            for (int r = 0; r < BRUNT_NODE_SPARE; r++) {
                const real sign = turned(symmetry_plane, dim, r);
                m[r] += sign * n[r];
                n[r] = sign * m[r];
            }
            sum_momentum(n, x, dim, (double)(n[BRUNT_NODE_SPARE] / n[0]), taken, after, turn_after);
            sum_momentum(m, y, dim, (double)(m[BRUNT_NODE_SPARE] / m[0]), taken, after, turn_after);
        }
    }
    for (int a = 0; a < 3; a++) after[a] -= before[a], turn_after[a] -= turn_before[a];
    brunt_impulse_account_reaction(account, after, turn_after);
}

// ------------------------------------------------------------------------------------------ between two symmetry
// planes

static double own_share(const real *n) { return n[0] > 0 ? (double)(n[BRUNT_NODE_SPARE] / n[0]) : 0; }

// What a symmetry plane has added to a node goes on to the node's images by the other: that with the most mass has it
// all.
static void share_sums(const brunt_body *body, const brunt_symmetry_plane symmetry[2], const int32_t at[3],
                       double taken, double sums[4][3]) {
    const brunt_grid *grid = &body->grid;
    const int axis = symmetry[0].axis;
    int32_t image[BRUNT_MAX_IMAGES][3];
    real sign[BRUNT_MAX_IMAGES][3], *node[BRUNT_MAX_IMAGES];
    const int count = brunt_symmetry_images(symmetry, 2, at, LAYERS, image, sign);
    int from = 0;
    for (int i = 0; i < count; i++) {
        node[i] = brunt_grid_node(grid, image[i]);
        if (node[i] && image[i][axis] < at[axis]) return; // those of that node
        if (node[i] && node[i][0] > node[from][0]) from = i;
    }
    for (int i = 0; i < count && node[from][0] > 0; i++) {
        double x[3] = {0};
        if (!node[i]) continue;
        for (int a = 0; a < grid->dim; a++) x[a] = grid->origin[a] + (double)grid->h * image[i][a];
        sum_momentum(node[i], x, grid->dim, own_share(node[i]), taken, sums[0], sums[1]);
        for (int r = 0; r < BRUNT_NODE_SPARE && i != from; r++) node[i][r] = node[from][r];
        for (int a = 0; a < grid->dim; a++) {
            const real factor = i == from && sign[i][a] != 0 ? 1 : sign[i][a] * sign[from][a];
            node[i][BRUNT_NODE_VELOCITY + a] *= factor, node[i][BRUNT_NODE_OLD + a] *= factor;
        }
        sum_momentum(node[i], x, grid->dim, own_share(node[i]), taken, sums[2], sums[3]);
    }
}

static void share_between(brunt_body *body, const brunt_symmetry_plane symmetry[2], double taken,
                          brunt_impulse_account *account) {
    const brunt_grid *grid = &body->grid;
    const int axis = symmetry[0].axis;
    const int32_t least = (symmetry[0].node < symmetry[1].node ? symmetry[0] : symmetry[1]).node - LAYERS,
                  most = (symmetry[0].node < symmetry[1].node ? symmetry[1] : symmetry[0]).node + LAYERS;
    double sums[4][3] = {{0}}; // linear and angular, before and after
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const int32_t *coord = grid->slots[s].coord;
        if (coord[axis] * grid->side > most || (coord[axis] + 1) * grid->side <= least) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            int local[3];
            int32_t at[3] = {0};
            brunt_node_local(grid, node, local);
            for (int a = 0; a < grid->dim; a++) at[a] = coord[a] * grid->side + local[a];
            if (at[axis] >= least && at[axis] <= most) share_sums(body, symmetry, at, taken, sums);
        }
    }
    for (int a = 0; a < 3; a++) sums[2][a] -= sums[0][a], sums[3][a] -= sums[1][a];
    brunt_impulse_account_reaction(account, sums[2], sums[3]);
}

void brunt_symmetry_fold(brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count, double taken,
                         brunt_impulse_account *const *account) {
    for (int m = 0; m < symmetry_count; m++) {
        fold(body, &symmetry[m], taken, account[m]);
        for (int k = 0; k < m; k++) {
            const int32_t apart = symmetry[k].axis == symmetry[m].axis ? abs(symmetry[k].node - symmetry[m].node) : 0;
            if (apart > 0 && apart <= 2 * LAYERS)
                share_between(body, (brunt_symmetry_plane[2]){symmetry[k], symmetry[m]}, taken, account[k]);
        }
    }
}

// ------------------------------------------------------------------------------------------ what moves on

// The first of the planes that a slot has nodes near to, or BRUNT_NONE.
static int plane_near(const brunt_grid *grid, const brunt_slot *slot, const brunt_symmetry_plane *symmetry, int count) {
    for (int m = 0; m < count; m++) {
        const int first = slot->coord[symmetry[m].axis] * grid->side;
        if (first <= symmetry[m].node + LAYERS && first + grid->side > symmetry[m].node - LAYERS) return m;
    }
    return BRUNT_NONE;
}

void brunt_symmetry_remember(const brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count,
                             double *own) {
    const brunt_grid *grid = &body->grid;
    for (int32_t s = 0; s < grid->slot_count; s++) {
        if (plane_near(grid, &grid->slots[s], symmetry, symmetry_count) < 0) continue;
        const real *n = brunt_slot_nodes(grid, s);
        double *to = own + (size_t)s * BRUNT_BLOCK_NODES * 3;
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++, n += BRUNT_NODE_REALS, to += 3)
            for (int a = 0; a < 3; a++) to[a] = (double)n[BRUNT_NODE_VELOCITY + a];
    }
}

void brunt_symmetry_carry(const brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count,
                          const double *own, double reach, brunt_impulse_account *const *account) {
    const brunt_grid *grid = &body->grid;
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const int m = plane_near(grid, &grid->slots[s], symmetry, symmetry_count);
        if (m < 0) continue;
        const real *n = brunt_slot_nodes(grid, s);
        const double *p = own + (size_t)s * BRUNT_BLOCK_NODES * 3;
        double turn[3] = {0};
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++, n += BRUNT_NODE_REALS, p += 3)
            for (int a = 0; a < 3 && n[BRUNT_NODE_MASS] > 0; a++) {
                const int i = (a + 1) % 3, j = (a + 2) % 3;
                const double v[2] = {(double)(n[BRUNT_NODE_VELOCITY + i] / n[BRUNT_NODE_MASS]),
                                     (double)(n[BRUNT_NODE_VELOCITY + j] / n[BRUNT_NODE_MASS])};
                turn[a] += reach * (v[0] * p[j] - v[1] * p[i]);
            }
        brunt_impulse_account_reaction(account[m], (const double[3]){0, 0, 0}, turn);
    }
}

// ------------------------------------------------------------------------------------------ images

int brunt_symmetry_of(const brunt_contact_context *m, const brunt_body *body,
                      brunt_symmetry_plane out[BRUNT_MAX_PLANES]) {
    int count = 0;
    for (int k = 0; k < m->symmetry_count; k++)
        if (m->symmetry[k].boundary < 0 || brunt_boundary_acts_on(&m->boundaries[m->symmetry[k].boundary], body->index))
            out[count++] = m->symmetry[k];
    return count;
}

int brunt_symmetry_bearer(const brunt_symmetry_plane *symmetry, int symmetry_count, int axis) {
    int bearer = BRUNT_NONE;
    for (int k = symmetry_count - 1; k >= 0; k--)
        if (symmetry[k].axis == axis || (symmetry[k].sticks && (bearer < 0 || symmetry[bearer].axis != axis)))
            bearer = k;
    return bearer;
}

// Adds the images of those there are by one symmetry plane; where it goes through one, nothing moves them along its
// axis.
static int add_images(const brunt_symmetry_plane *symmetry_plane, int near, int32_t image[BRUNT_MAX_IMAGES][3],
                      real sign[BRUNT_MAX_IMAGES][3], int count) {
    const int axis = symmetry_plane->axis, had = count;
    for (int k = 0; k < had && count < BRUNT_MAX_IMAGES; k++) {
        int32_t to[3] = {image[k][0], image[k][1], image[k][2]};
        to[axis] = 2 * symmetry_plane->node - image[k][axis];
        if (abs(to[axis] - image[k][axis]) > 2 * near) continue;
        int found = 0;
        while (found < count && memcmp(image[found], to, sizeof to) != 0) found++;
        for (int a = 0; found == k && a < 3; a++)
            for (int i = 0; i < count && (a == axis || symmetry_plane->sticks); i++) sign[i][a] = 0;
        if (found < count) continue;
        memcpy(image[count], to, sizeof to);
        memcpy(sign[count], sign[k], sizeof sign[k]);
        for (int a = 0; a < 3; a++) sign[count][a] *= a == axis || symmetry_plane->sticks ? -1 : 1;
        count++;
    }
    return count;
}

int brunt_symmetry_images(const brunt_symmetry_plane *symmetry, int symmetry_count, const int32_t node[3], int near,
                          int32_t image[BRUNT_MAX_IMAGES][3], real sign[BRUNT_MAX_IMAGES][3]) {
    int count = 1, before = 0;
    memcpy(image[0], node, sizeof image[0]);
    for (int a = 0; a < 3; a++) sign[0][a] = 1;
    while (count > before) {
        before = count;
        for (int m = 0; m < symmetry_count; m++) count = add_images(&symmetry[m], near, image, sign, count);
    }
    return count;
}
