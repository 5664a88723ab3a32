// Symmetry planes in an implicit step: a body that they cut is computed by its own points, with nodes that are each
// other's images moving as one. What the images' points would bring is that mirrored, so that the energy is that of the
// part there is, and its minimum that of the whole.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "contact/planes/followed.h"
#include "scheme/unknowns.h"

const brunt_fold *brunt_unknowns_fold(const brunt_unknowns *u) {
    return u->images.any && u->images.fold.count ? &u->images.fold : NULL;
}

// ------------------------------------------------------------------------------------------ which are images

// Symmetry planes that act on a body of points, or on one that it shares nodes with.
static int symmetry_of(const brunt_unknowns *u, const brunt_world *world, int i,
                       brunt_symmetry_plane symmetry[BRUNT_MAX_PLANES]) {
    int count = 0;
    for (int m = 0; m < world->boundaries.symmetry_count; m++) {
        const brunt_symmetry_plane *symmetry_plane = &world->boundaries.symmetry[m];
        int k, end;
        brunt_bodies_points(&world->bodies, world->boundaries.boundary[symmetry_plane->boundary].body, &k, &end);
        const bool all = end - k == world->bodies.mpm_count, one = k < end && u->tie[k] == u->tie[i];
        if (all || one) symmetry[count++] = *symmetry_plane;
    }
    return brunt_symmetry_distinct(symmetry, count);
}

// Node n at grid coordinates `at` of body i: whom it follows, with which signs.
static void find_leader(brunt_unknowns *u, const brunt_world *world, int i, int32_t n, const int32_t at[3],
                        const brunt_symmetry_plane *symmetry, int symmetry_count) {
    const brunt_boundary *boundary = world->boundaries.boundary;
    double share[BRUNT_MAX_PLANES];
    int32_t image[BRUNT_MAX_IMAGES][3], leader = n;
    real sign[BRUNT_MAX_IMAGES][3];
    const int count = brunt_symmetry_images(symmetry, symmetry_count, at, BRUNT_IMAGE_LAYERS, image, sign);
    int from = 0, others = 0;
    int32_t front = BRUNT_NONE;
    for (int k = 0; k < count; k++) {
        const int32_t other = k ? brunt_unknowns_node_at(u, &world->bodies, i, image[k]) : n;
        bool before = other >= 0;
        for (int m = 0; m < symmetry_count; m++) before = before && brunt_symmetry_before(&symmetry[m], image[k]) >= 0;
        if (before) front = other;
        others += k && other >= 0;
        if (other >= 0 && other < leader) leader = other, from = k;
    }
    u->images.leader[n] = leader;
    u->images.front[n] = front >= 0 ? front : leader;
    for (int a = 0; a < u->dim; a++) {
        const int64_t k = n * (int64_t)u->dim + a;
        u->images.sign[k] = (double)sign[from][a];
        if (!others && sign[0][a] != 0) continue;
        brunt_symmetry_shares(symmetry, symmetry_count, at, a, share);
        for (int m = 0; m < symmetry_count; m++)
            u->images.bearers[k] |= (uint32_t)(share[m] > 0) << boundary[symmetry[m].boundary].symmetry_plane;
    }
}

static void find_leaders(brunt_unknowns *u, const brunt_world *world, int i) {
    const brunt_grid *grid = &world->bodies.mpm[i].grid;
    brunt_symmetry_plane symmetry[BRUNT_MAX_PLANES];
    const int count = symmetry_of(u, world, i, symmetry);
    for (int64_t q = 0; count && q < (int64_t)grid->slot_count * BRUNT_BLOCK_NODES; q++) {
        int32_t at[3] = {0};
        int local[3];
        if (u->number[i][q] < 0) continue;
        brunt_node_local(grid, (int)(q % BRUNT_BLOCK_NODES), local);
        for (int a = 0; a < grid->dim; a++) at[a] = grid->slots[q / BRUNT_BLOCK_NODES].coord[a] * grid->side + local[a];
        find_leader(u, world, i, u->number[i][q], at, symmetry, count);
    }
}

// Masses of all images together, at their leaders.
static void add_masses(brunt_unknowns *u) {
    const brunt_images *images = &u->images;
    for (int64_t k = 0; k < (int64_t)u->count * u->dim; k++) {
        const int32_t n = (int32_t)(k / u->dim);
        if (images->sign[k] != 0) images->mass[images->leader[n] * (int64_t)u->dim + k % u->dim] += u->mass[n];
    }
}

int brunt_unknowns_symmetry(brunt_unknowns *u, const brunt_world *world, brunt_error *error) {
    brunt_images *images = &u->images;
    const size_t n = (size_t)u->count + 1, all = n * (size_t)u->dim;
    if (!images->any) return BRUNT_OK;
    if (BRUNT_CAPACITY(images->leader, n, 0, "images of nodes", error) ||
        BRUNT_CAPACITY(images->front, n, 0, "images of nodes", error) ||
        BRUNT_CAPACITY(images->follower, n, 0, "images of nodes", error) ||
        BRUNT_CAPACITY(images->sign, all, 0, "images of nodes", error) ||
        BRUNT_CAPACITY(images->mass, all, 0, "images of nodes", error) ||
        BRUNT_CAPACITY(images->bearers, all, 0, "images of nodes", error))
        return BRUNT_FAILED;
    memset(images->mass, 0, all * sizeof *images->mass);
    memset(images->bearers, 0, all * sizeof *images->bearers);
    for (size_t k = 0; k < all; k++) images->sign[k] = 1;
    for (int32_t k = 0; k < u->count; k++) images->leader[k] = images->front[k] = k;
    for (int i = 0; i < world->bodies.mpm_count; i++) find_leaders(u, world, i);
    int32_t count = 0;
    for (int32_t k = 0; k < u->count; k++)
        if (images->leader[k] != k) images->follower[count++] = k;
    images->fold = (brunt_fold){count, images->follower, images->leader, images->sign};
    add_masses(u);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ momenta and forces

double brunt_unknowns_bearers(const brunt_unknowns *u, int64_t k) {
    int count = 0;
    for (uint32_t bits = u->images.bearers[k]; bits; bits &= bits - 1) count++;
    return 1.0 / count;
}

// Sums over all images by their masses, for each of them.
static void divide(const brunt_unknowns *u, int64_t first, double *sum) {
    const double *mass = u->images.any ? u->images.mass : NULL;
    if (mass) brunt_fold_gather(&u->images.fold, u->dim, sum);
    for (int64_t k = first; k < (int64_t)u->count * u->dim; k++) {
        const double of = mass ? mass[k] : u->mass[k / u->dim];
        sum[k] = of > 0 ? sum[k] / of : 0;
    }
    if (mass) brunt_fold_spread(&u->images.fold, u->dim, sum);
}

// Adds momentum, `mass` [kg] of each node's velocity (NULL: 1), to what symmetry planes bear, with a sign.
static void bear(const brunt_unknowns *u, brunt_boundaries *boundaries, const double *mass, double sign) {
    for (int64_t k = 0; k < (int64_t)u->count * u->dim; k++) {
        double J[3] = {0}, turn[3] = {0}, x[3] = {0};
        if (!u->images.bearers[k]) continue;
        const int32_t n = (int32_t)(k / u->dim);
        const int a = (int)(k % u->dim);
        for (int i = 0; i < u->dim; i++) x[i] = u->position[n * (int64_t)u->dim + i];
        J[a] = sign * (mass ? mass[n] : 1) * u->velocity[k];
        for (int i = 0; i < 3; i++) turn[i] = x[(i + 1) % 3] * J[(i + 2) % 3] - x[(i + 2) % 3] * J[(i + 1) % 3];
        const double share = brunt_unknowns_bearers(u, k);
        for (int i = 0; i < 3; i++) J[i] *= share, turn[i] *= share;
        for (int m = 0; m < boundaries->symmetry_count; m++)
            if (u->images.bearers[k] >> m & 1)
                brunt_impulse_account_reaction(&boundaries->boundary[boundaries->symmetry[m].boundary].last, J, turn);
    }
}

void brunt_unknowns_divide(brunt_unknowns *u, brunt_world *world) {
    // Of FLIP's share particles take changes over alone.
    const double taken = world->settings.transfer == BRUNT_FLIP ? 1 - world->settings.flip : 1;
    const bool carries = u->images.any && world->settings.scheme != BRUNT_STATIC;
    if (carries) bear(u, &world->boundaries, NULL, -taken);
    divide(u, (int64_t)u->mesh_count * u->dim, u->velocity);
    if (carries) bear(u, &world->boundaries, u->mass, taken);
}

void brunt_unknowns_accelerate(const brunt_unknowns *u, const double *force, double *acceleration) {
    const size_t all = (size_t)u->count * (size_t)u->dim;
    memcpy(acceleration, force, all * sizeof *acceleration);
    divide(u, 0, acceleration);
    for (size_t k = 0; k < all; k++)
        if (u->held[k]) acceleration[k] = 0;
}

// ------------------------------------------------------------------------------------------ what is held

double brunt_unknowns_image_sign(const brunt_unknowns *u, int64_t k) {
    return u->images.sign[k] * u->images.sign[u->images.front[k / u->dim] * (int64_t)u->dim + k % u->dim];
}

void brunt_unknowns_hold_images(brunt_unknowns *u) {
    for (int64_t k = 0; k < (int64_t)u->count * u->dim; k++) {
        const int64_t front = u->images.front[k / u->dim] * (int64_t)u->dim + k % u->dim;
        if (front == k) continue;
        u->held[k] = u->held[front], u->holder[k] = u->holder[front];
        u->target[k] = brunt_unknowns_image_sign(u, k) * u->target[front];
        u->end[k] = brunt_unknowns_image_sign(u, k) * u->end[front];
    }
}
