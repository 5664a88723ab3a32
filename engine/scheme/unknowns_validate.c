// What must hold of the unknowns at the end of a step; looked at in debug builds (world/validate.c).
#include <math.h>

#include "base/error.h"
#include "scheme/unknowns.h"

// Nodes of meshes, then of grids: a body has those that it is the first to reach.
static void validate_order(const brunt_unknowns *u, const brunt_bodies *bodies) {
    int32_t next = 0;
    for (int k = 0; k < bodies->fem_count; k++) {
        BRUNT_ASSERT(u->base[k] == next);
        next += bodies->fem[k].node_count;
    }
    BRUNT_ASSERT(u->mesh_count == next && u->grid_base[0] == next && u->grid_base[bodies->mpm_count] <= u->count);
    for (int i = 0; i < bodies->mpm_count; i++) {
        const int32_t low = u->tie[i] == i ? u->grid_base[i] : u->mesh_count, high = u->grid_base[i + 1];
        BRUNT_ASSERT(u->tie[i] >= 0 && u->tie[i] <= i && u->tie[u->tie[i]] == u->tie[i] && u->grid_base[i] <= high);
        for (int64_t k = 0; k < (int64_t)bodies->mpm[i].grid.slot_count * BRUNT_BLOCK_NODES; k++)
            BRUNT_ASSERT(u->number[i][k] == -1 || (u->number[i][k] >= low && u->number[i][k] < high));
    }
}

static void validate_components(const brunt_unknowns *u, int boundaries) {
    for (int32_t n = 0; n < u->count; n++) BRUNT_ASSERT(u->mass[n] >= 0 && isfinite(u->mass[n]));
    for (int64_t k = 0; k < (int64_t)u->count * u->dim; k++) {
        BRUNT_ASSERT(isfinite(u->position[k]) && isfinite(u->velocity[k]));
        BRUNT_ASSERT(u->held[k] <= 1 && u->holder[k] >= 0 && u->holder[k] <= boundaries);
        BRUNT_ASSERT(!u->held[k] || (isfinite(u->target[k]) && isfinite(u->end[k])));
    }
}

// A leader follows none; followers ascend.
static void validate_images(const brunt_unknowns *u) {
    const brunt_images *images = &u->images;
    for (int32_t n = 0; n < u->count; n++) {
        const int32_t leader = images->leader[n];
        BRUNT_ASSERT(leader >= 0 && leader <= n && images->leader[leader] == leader);
        const int32_t front = images->front[n];
        BRUNT_ASSERT(front >= 0 && front < u->count && images->front[front] == front &&
                     images->leader[front] == leader);
    }
    for (int32_t i = 0; i < images->fold.count; i++) {
        const int32_t n = images->follower[i];
        BRUNT_ASSERT(n >= 0 && n < u->count && images->leader[n] != n && (!i || images->follower[i - 1] < n));
    }
    for (int64_t k = 0; k < (int64_t)u->count * u->dim; k++)
        BRUNT_ASSERT(fabs(images->sign[k]) <= 1 && images->mass[k] >= 0 && images->bearers[k] >> BRUNT_MAX_PLANES == 0);
}

void brunt_unknowns_validate(const brunt_unknowns *u, const brunt_bodies *bodies, int boundaries) {
    BRUNT_ASSERT((u->dim == 2 || u->dim == 3) && u->count >= 0);
    if (!u->count) return; // no step has been taken
    validate_order(u, bodies);
    for (int w = 0; w < boundaries; w++)
        BRUNT_ASSERT(u->plane[w] == -1 || (u->plane[w] >= u->grid_base[bodies->mpm_count] && u->plane[w] < u->count));
    validate_components(u, boundaries);
    if (u->images.any) validate_images(u);
}
