#include "contact/barrier/barrier_parts.h"

#include <stdlib.h>

void brunt_barrier_shares(brunt_barrier_pair *pair, bool a_has_facets, bool b_has_facets) {
    const bool both = a_has_facets && b_has_facets;
    pair->share[0] = b_has_facets ? (both ? 0.5 : 1) : 0;
    pair->share[1] = a_has_facets ? (both ? 0.5 : 1) : 0;
    pair->share[2] = both ? 0.5 : 0;
}

static uint64_t bodies_of(int32_t a, int32_t b) {
    return a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
}

static int by_bodies(const void *left, const void *right) {
    const barrier_key *x = left, *y = right;
    return (x->bodies > y->bodies) - (x->bodies < y->bodies);
}

int brunt_barrier_set_pairs(brunt_barrier *b, const brunt_barrier_pair *pairs, int32_t count, brunt_error *error) {
    if (BRUNT_CAPACITY(b->pair, (size_t)count + 1, 0, "pairs of bodies that may meet", error) ||
        BRUNT_CAPACITY(b->key, (size_t)count + 1, 0, "pairs of bodies that may meet", error))
        return BRUNT_FAILED;
    b->pair_count = count, b->range = 0;
    for (int32_t i = 0; i < count; i++) {
        const brunt_barrier_pair *p = &pairs[i];
        BRUNT_ASSERT(p->a >= 0 && p->b >= 0 && p->distance > 0 && p->offset >= 0 && p->stiffness > 0 &&
                     p->friction >= 0);
        BRUNT_ASSERT(p->friction == 0 || p->slip_speed > 0);
        b->pair[i] = *p;
        b->key[i] = (barrier_key){bodies_of(p->a, p->b), i};
        b->range = fmax(b->range, p->distance + p->offset);
    }
    qsort(b->key, (size_t)count, sizeof *b->key, by_bodies);
    for (int32_t i = 1; i < count; i++)
        if (b->key[i].bodies == b->key[i - 1].bodies)
            return brunt_fail(error, BRUNT_FAILED, "bodies %d and %d are a pair of contact twice",
                              b->pair[b->key[i].pair].a, b->pair[b->key[i].pair].b);
    return BRUNT_OK;
}

int32_t barrier_law_between(const brunt_barrier *b, int32_t own, int32_t other, int8_t *side) {
    const uint64_t bodies = bodies_of(own, other);
    int32_t low = 0, high = b->pair_count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (b->key[middle].bodies < bodies)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == b->pair_count || b->key[low].bodies != bodies) return BRUNT_NONE;
    *side = b->pair[b->key[low].pair].a == own ? 1 : -1;
    return b->key[low].pair;
}

barrier_law barrier_law_of(const brunt_barrier *b, int32_t law) {
    if (law < b->pair_count) {
        const brunt_barrier_pair *p = &b->pair[law];
        return (barrier_law){p->distance, p->stiffness, p->friction, p->slip_speed,
                             p->energy ? p->energy : brunt_barrier_at};
    }
    const brunt_barrier_plane *p = &b->step.planes[law - b->pair_count];
    return (barrier_law){p->distance, p->stiffness, p->friction, p->slip_speed,
                         p->energy ? p->energy : brunt_barrier_at};
}

double barrier_share_of(const brunt_barrier *b, int32_t law, int8_t side, bool edges) {
    return b->pair[law].share[edges ? 2 : side > 0 ? 0 : 1];
}

double barrier_plane_offset(const brunt_barrier *b, const brunt_barrier_plane *plane, int32_t point) {
    return plane->offset ? plane->offset[barrier_body_of(b, point)] : 0;
}

bool brunt_barrier_has_friction(const brunt_barrier *b) {
    for (int32_t i = 0; i < b->pair_count; i++)
        if (b->pair[i].friction > 0) return true;
    for (int32_t i = 0; i < b->step.plane_count; i++)
        if (b->step.planes[i].friction > 0) return true;
    return false;
}
