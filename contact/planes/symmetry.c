// Symmetry planes. A body cut by a symmetry plane that runs through grid nodes is computed as the half of a whole: the
// mirror image's particles would give the nodes exactly what the body gives to the mirrored nodes. So each node gets
// its own sums plus the reflected sums of its partner, and node pairs stay each other's reflection from then on. What
// sticks to a plane has an image with opposite velocities and forces in all components: it is at rest just there, for
// kernels that reach over it as well. The spare real of a node keeps the mass that the body itself has there, for the
// energy and momentum ledgers.
#include "contact/planes/symmetry.h"

#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "contact/planes/boundary.h"

enum { LAYERS = BRUNT_IMAGE_LAYERS };

// ------------------------------------------------------------------------------------------ what each takes

bool brunt_symmetry_carries(const brunt_symmetry_plane *plane, const int32_t at[3], int axis) {
    return (plane->axis == axis || plane->sticks) && abs(at[plane->axis] - plane->node) <= LAYERS;
}

// How far a plane is from bearing what acts along an axis at a node, 0 the least: near ones that can, across it or as
// they stick, before others; then by their distances; of as near ones those across it.
static int32_t rank(const brunt_symmetry_plane *plane, const int32_t at[3], int axis) {
    enum { FAR = 2, CLASS = 1 << 28 };
    const int32_t distance = 2 * abs(at[plane->axis] - plane->node) + (plane->axis != axis);
    const int class = brunt_symmetry_carries(plane, at, axis) ? 0 : distance > 2 * LAYERS + 1 ? FAR : 1;
    return class * CLASS + (distance < CLASS ? distance : CLASS - 1);
}

void brunt_symmetry_shares(const brunt_symmetry_plane *symmetry, int symmetry_count, const int32_t at[3], int axis,
                           double share[BRUNT_MAX_PLANES]) {
    int32_t least = INT32_MAX;
    int count = 0;
    for (int m = 0; m < symmetry_count; m++) {
        const int32_t has = rank(&symmetry[m], at, axis);
        count = has < least ? 1 : count + (has == least);
        least = has < least ? has : least;
    }
    for (int m = 0; m < symmetry_count; m++) share[m] = rank(&symmetry[m], at, axis) == least ? 1.0 / count : 0;
}

// What planes bear of the momentum of a body, and of its moment about the origin.
typedef struct bearing {
    const brunt_symmetry_plane *plane;
    int count;
    double taken;
    double linear[BRUNT_MAX_PLANES][3], angular[BRUNT_MAX_PLANES][3];
} bearing;

static double own_share(const real *n) { return n[0] > 0 ? (double)(n[BRUNT_NODE_SPARE] / n[0]) : 0; }

// Momentum that a node carries for the body itself: before folding its own, afterwards its share of the common
// velocity.
static void own_momentum(const real *n, int dim, double taken, double p[3]) {
    const double own = own_share(n);
    for (int a = 0; a < dim; a++)
        p[a] = own * (taken * (double)n[BRUNT_NODE_VELOCITY + a] + (double)n[BRUNT_NODE_OLD + a]);
}

// Books that the node at `at` carried `before`.
static void bear(bearing *b, const brunt_grid *grid, const int32_t at[3], const real *n, const double before[3]) {
    double x[3] = {0}, p[3] = {0};
    own_momentum(n, grid->dim, b->taken, p);
    for (int a = 0; a < grid->dim; a++) x[a] = grid->origin[a] + (double)grid->h * at[a], p[a] -= before[a];
    for (int a = 0; a < grid->dim; a++) {
        const int i = (a + 1) % 3, j = (a + 2) % 3;
        double share[BRUNT_MAX_PLANES] = {1};
        if (b->count > 1) brunt_symmetry_shares(b->plane, b->count, at, a, share);
        for (int m = 0; m < b->count; m++) {
            b->linear[m][a] += share[m] * p[a];
            b->angular[m][i] += share[m] * x[j] * p[a];
            b->angular[m][j] -= share[m] * x[i] * p[a];
        }
    }
}

// ------------------------------------------------------------------------------------------ sums

// What becomes of a node's real in its image.
static real turned(const brunt_symmetry_plane *symmetry_plane, int dim, int r) {
    bool turns = false;
    for (int a = 0; a < dim; a++)
        if (a == symmetry_plane->axis || symmetry_plane->sticks)
            turns = turns || r == BRUNT_NODE_VELOCITY + a || r == BRUNT_NODE_OLD + a;
    return turns ? -1 : 1;
}

// The nodes of slots [from, end) and their images, which no others have.
static void fold_slots(const brunt_grid *grid, const brunt_symmetry_plane *symmetry_plane, int32_t from, int32_t end,
                       bearing *b) {
    const int dim = grid->dim, axis = symmetry_plane->axis;
    for (int32_t s = from; s < end; s++) {
        const brunt_slot *slot = &grid->slots[s];
        int32_t first = slot->coord[axis] * grid->side;
        if (first > symmetry_plane->node || first + grid->side <= symmetry_plane->node - LAYERS) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            int local[3];
            brunt_node_local(grid, node, local);
            int depth = symmetry_plane->node - (first + local[axis]);
            if (depth < 0 || depth > LAYERS) continue;
            real *n = brunt_slot_nodes(grid, s) + node * BRUNT_NODE_REALS;
            int32_t at[3] = {0, 0, 0}, to[3];
            double before[3] = {0}, image_before[3] = {0};
            for (int a = 0; a < dim; a++) at[a] = slot->coord[a] * grid->side + local[a];
            if (depth == 0) {
                own_momentum(n, dim, b->taken, before);
                for (int a = 0; a < dim; a++)
                    if (a == axis || symmetry_plane->sticks) n[BRUNT_NODE_VELOCITY + a] = n[BRUNT_NODE_OLD + a] = 0;
                bear(b, grid, at, n, before);
                continue;
            }
            memcpy(to, at, sizeof to);
            to[axis] = symmetry_plane->node + depth;
            real *m = brunt_grid_node(grid, to);
            if (!m || (n[0] <= 0 && m[0] <= 0)) continue;
            own_momentum(n, dim, b->taken, before);
            own_momentum(m, dim, b->taken, image_before);
            for (int r = 0; r < BRUNT_NODE_SPARE; r++) {
                const real sign = turned(symmetry_plane, dim, r);
                m[r] += sign * n[r];
                n[r] = sign * m[r];
            }
            bear(b, grid, at, n, before);
            bear(b, grid, to, m, image_before);
        }
    }
}

// Slots are folded by chunks, each with what is borne in it; as many for any number of threads.
enum { CHUNKS = 16 };
typedef struct fold_job {
    const brunt_grid *grid;
    const brunt_symmetry_plane *plane;
    bearing *borne; // by chunk
} fold_job;

static void fold_chunks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const fold_job *j = context;
    const int64_t slots = j->grid->slot_count;
    for (int64_t c = begin; c < end; c++)
        fold_slots(j->grid, j->plane, (int32_t)(slots * c / CHUNKS), (int32_t)(slots * (c + 1) / CHUNKS), &j->borne[c]);
}

// ------------------------------------------------------------------------------------------ between two symmetry
// planes

// What a symmetry plane has added to a node goes on to the node's images by the other: that with the most mass has it
// all.
static void share_sums(const brunt_body *body, const brunt_symmetry_plane symmetry[2], const int32_t at[3],
                       bearing *b) {
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
        double before[3] = {0};
        if (!node[i]) continue;
        own_momentum(node[i], grid->dim, b->taken, before);
        for (int r = 0; r < BRUNT_NODE_SPARE && i != from; r++) node[i][r] = node[from][r];
        for (int a = 0; a < grid->dim; a++) {
            const real factor = i == from && sign[i][a] != 0 ? 1 : sign[i][a] * sign[from][a];
            node[i][BRUNT_NODE_VELOCITY + a] *= factor, node[i][BRUNT_NODE_OLD + a] *= factor;
        }
        bear(b, grid, image[i], node[i], before);
    }
}

static void share_between(brunt_body *body, const brunt_symmetry_plane symmetry[2], bearing *b) {
    const brunt_grid *grid = &body->grid;
    const int axis = symmetry[0].axis;
    const int32_t least = (symmetry[0].node < symmetry[1].node ? symmetry[0] : symmetry[1]).node - LAYERS,
                  most = (symmetry[0].node < symmetry[1].node ? symmetry[1] : symmetry[0]).node + LAYERS;
    for (int32_t s = 0; s < grid->slot_count; s++) {
        const int32_t *coord = grid->slots[s].coord;
        if (coord[axis] * grid->side > most || (coord[axis] + 1) * grid->side <= least) continue;
        for (int node = 0; node < BRUNT_BLOCK_NODES; node++) {
            int local[3];
            int32_t at[3] = {0};
            brunt_node_local(grid, node, local);
            for (int a = 0; a < grid->dim; a++) at[a] = coord[a] * grid->side + local[a];
            if (at[axis] >= least && at[axis] <= most) share_sums(body, symmetry, at, b);
        }
    }
}

// Whether one of the planes before it is at the same place: what its image has is in the sums already.
static bool folded_before(const brunt_symmetry_plane *symmetry, int m) {
    bool before = false;
    for (int k = 0; k < m; k++)
        before = before || (symmetry[k].axis == symmetry[m].axis && symmetry[k].node == symmetry[m].node);
    return before;
}

void brunt_symmetry_fold(brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count, double taken,
                         brunt_impulse_account *const *account, int threads, brunt_timer *timer) {
    if (!symmetry_count) return;
    bearing borne[CHUNKS], all = {.plane = symmetry, .count = symmetry_count, .taken = taken};
    for (int c = 0; c < CHUNKS; c++) borne[c] = all;
    for (int m = 0; m < symmetry_count; m++) {
        if (folded_before(symmetry, m)) continue;
        fold_job job = {&body->grid, &symmetry[m], borne};
        brunt_parallel(threads, CHUNKS, 1, fold_chunks, &job, timer);
        for (int k = 0; k < m; k++) {
            const int32_t apart = symmetry[k].axis == symmetry[m].axis ? abs(symmetry[k].node - symmetry[m].node) : 0;
            if (apart > 0 && apart <= 2 * LAYERS)
                share_between(body, (brunt_symmetry_plane[2]){symmetry[k], symmetry[m]}, &all);
        }
    }
    for (int m = 0; m < symmetry_count; m++) {
        for (int c = 0; c < CHUNKS; c++)
            for (int a = 0; a < 3; a++)
                all.linear[m][a] += borne[c].linear[m][a], all.angular[m][a] += borne[c].angular[m][a];
        brunt_impulse_account_reaction(account[m], all.linear[m], all.angular[m]);
    }
}

// ------------------------------------------------------------------------------------------ what moves on

// Whether a slot has nodes near one of the planes.
static bool near_any(const brunt_grid *grid, const brunt_slot *slot, const brunt_symmetry_plane *symmetry, int count) {
    for (int m = 0; m < count; m++) {
        const int first = slot->coord[symmetry[m].axis] * grid->side;
        if (first <= symmetry[m].node + LAYERS && first + grid->side > symmetry[m].node - LAYERS) return true;
    }
    return false;
}

void brunt_symmetry_remember(const brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count,
                             double *own) {
    const brunt_grid *grid = &body->grid;
    for (int32_t s = 0; s < grid->slot_count; s++) {
        if (!near_any(grid, &grid->slots[s], symmetry, symmetry_count)) continue;
        const real *n = brunt_slot_nodes(grid, s);
        double *to = own + (size_t)s * BRUNT_BLOCK_NODES * 3;
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++, n += BRUNT_NODE_REALS, to += 3)
            for (int a = 0; a < 3; a++) to[a] = (double)n[BRUNT_NODE_VELOCITY + a];
    }
}

void brunt_symmetry_carry(const brunt_body *body, const brunt_symmetry_plane *symmetry, int symmetry_count,
                          const double *own, double reach, brunt_impulse_account *const *account) {
    const brunt_grid *grid = &body->grid;
    double turn[BRUNT_MAX_PLANES][3] = {{0}};
    for (int32_t s = 0; s < grid->slot_count; s++) {
        if (!near_any(grid, &grid->slots[s], symmetry, symmetry_count)) continue;
        const real *n = brunt_slot_nodes(grid, s);
        const double *p = own + (size_t)s * BRUNT_BLOCK_NODES * 3;
        for (int k = 0; k < BRUNT_BLOCK_NODES; k++, n += BRUNT_NODE_REALS, p += 3) {
            double share[BRUNT_MAX_PLANES];
            int32_t at[3] = {0};
            int local[3];
            if (!(n[BRUNT_NODE_MASS] > 0)) continue;
            brunt_node_local(grid, k, local);
            for (int a = 0; a < grid->dim; a++) at[a] = grid->slots[s].coord[a] * grid->side + local[a];
            brunt_symmetry_shares(symmetry, symmetry_count, at, BRUNT_NONE, share);
            for (int a = 0; a < 3; a++) {
                const int i = (a + 1) % 3, j = (a + 2) % 3;
                const double v[2] = {(double)(n[BRUNT_NODE_VELOCITY + i] / n[BRUNT_NODE_MASS]),
                                     (double)(n[BRUNT_NODE_VELOCITY + j] / n[BRUNT_NODE_MASS])};
                for (int m = 0; m < symmetry_count; m++) turn[m][a] += share[m] * reach * (v[0] * p[j] - v[1] * p[i]);
            }
        }
    }
    for (int m = 0; m < symmetry_count; m++)
        brunt_impulse_account_reaction(account[m], (const double[3]){0, 0, 0}, turn[m]);
}

// ------------------------------------------------------------------------------------------ images

int brunt_symmetry_distinct(brunt_symmetry_plane *symmetry, int symmetry_count) {
    int count = 0;
    for (int k = 0; k < symmetry_count; k++) {
        const brunt_symmetry_plane plane = symmetry[k];
        bool stuck = false; // those that stick are kept, before k and behind it
        for (int m = 0; m < symmetry_count && !plane.sticks; m++)
            stuck = stuck || ((m < count || m > k) && symmetry[m].sticks && symmetry[m].axis == plane.axis &&
                              symmetry[m].node == plane.node);
        if (!stuck) symmetry[count++] = plane;
    }
    return count;
}

int brunt_symmetry_of(const brunt_contact_context *m, const brunt_body *body,
                      brunt_symmetry_plane out[BRUNT_MAX_PLANES]) {
    int count = 0;
    for (int k = 0; k < m->symmetry_count; k++)
        if (m->symmetry[k].boundary < 0 || brunt_boundary_acts_on(&m->boundaries[m->symmetry[k].boundary], body->index))
            out[count++] = m->symmetry[k];
    return brunt_symmetry_distinct(out, count);
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
