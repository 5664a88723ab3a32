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

void brunt_barrier_set_pairs(brunt_barrier *b, const brunt_barrier_pair_source *source) {
    b->source = *source;
    b->pair_count = b->key_count = 0;
    b->here_count = b->clear.count = 0;
}

const brunt_barrier_pair *brunt_barrier_pairs(const brunt_barrier *b, int32_t *count) {
    *count = b->pair_count;
    return b->pair;
}

bool barrier_bodies_meet(const brunt_barrier *b, int32_t own, int32_t other, bool edges) {
    brunt_barrier_pair pair;
    if (!b->source.between(b->source.self, own < other ? own : other, own < other ? other : own, &pair)) return false;
    return pair.share[edges ? 2 : pair.a == own ? 0 : 1] > 0;
}

// ------------------------------------------------------------------------------------------ of what is near

// Where the key of two bodies is among those of the pairs; where it would stand.
static int32_t place_of(const brunt_barrier *b, uint64_t bodies) {
    int32_t low = 0, high = b->pair_count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (b->key[middle].bodies < bodies)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

// A key for two bodies, unless they are a pair already, or the last that was looked for.
static int collect(brunt_barrier *b, int32_t own, int32_t other, uint64_t *last, brunt_error *error) {
    const uint64_t bodies = bodies_of(own, other);
    if (bodies == *last) return BRUNT_OK;
    *last = bodies;
    const int32_t place = place_of(b, bodies);
    if (place < b->pair_count && b->key[place].bodies == bodies) return BRUNT_OK;
    if (BRUNT_CAPACITY(b->key, (size_t)b->key_count + 1, (size_t)b->key_count, "pairs of bodies", error))
        return BRUNT_FAILED;
    b->key[b->key_count++] = (barrier_key){bodies, BRUNT_NONE};
    return BRUNT_OK;
}

// A pair for each key that is new, in the order of their bodies: whatever order they were found in.
static int make_pairs(brunt_barrier *b, brunt_error *error) {
    const int32_t known = b->pair_count, collected = b->key_count;
    qsort(b->key + known, (size_t)(collected - known), sizeof *b->key, by_bodies);
    if (BRUNT_CAPACITY(b->pair, (size_t)collected, (size_t)known, "pairs of bodies", error)) return BRUNT_FAILED;
    for (int32_t i = known; i < collected; i++) {
        const uint64_t bodies = b->key[i].bodies;
        if (i > known && bodies == b->key[i - 1].bodies) continue;
        brunt_barrier_pair *pair = &b->pair[b->pair_count];
        const bool meet = b->source.between(b->source.self, (int32_t)(bodies >> 32), (int32_t)bodies, pair);
        BRUNT_ASSERT(meet && fmax(pair->distance, 2 * pair->reach) > 0);
        BRUNT_ASSERT(fmax(pair->distance, 2 * pair->reach) + pair->offset <= b->source.range);
        b->key[b->pair_count] = (barrier_key){bodies, b->pair_count};
        b->pair_count++;
    }
    b->key_count = b->pair_count;
    qsort(b->key, (size_t)b->key_count, sizeof *b->key, by_bodies);
    return BRUNT_OK;
}

int barrier_find_pairs(brunt_barrier *b, brunt_error *error) {
    uint64_t last = UINT64_MAX; // no two bodies
    for (int64_t t = 0; t < b->task_count; t++) {
        const int32_t task = b->task[t], edge = -1 - task;
        const brunt_near_list *list = task < 0 ? &b->edges : &b->facets;
        const int32_t at = task < 0 ? edge : task,
                      own = task < 0 ? b->body[b->edge[edge][0]] : barrier_body_of(b, task);
        for (int64_t i = list->first[at]; i < list->first[at + 1]; i++) {
            const int32_t other = b->body[task < 0 ? b->edge[list->item[i]][0] : b->facet[list->item[i]][0]];
            if (collect(b, own, other, &last, error)) return BRUNT_FAILED;
        }
    }
    return b->key_count > b->pair_count ? make_pairs(b, error) : BRUNT_OK;
}

int32_t barrier_law_between(const brunt_barrier *b, int32_t own, int32_t other, int8_t *side) {
    const int32_t pair = b->key[place_of(b, bodies_of(own, other))].pair;
    *side = b->pair[pair].a == own ? 1 : -1;
    return b->step.plane_count + pair;
}

barrier_law barrier_law_of(const brunt_barrier *b, int32_t law) {
    if (barrier_law_is_plane(b, law)) {
        const brunt_barrier_plane *p = &b->step.planes[law];
        return (barrier_law){p->distance,   p->stiffness, p->friction,
                             p->slip_speed, p->reach,     p->energy ? p->energy : brunt_barrier_at};
    }
    const brunt_barrier_pair *p = barrier_pair_of(b, law);
    return (barrier_law){p->distance,   p->stiffness, p->friction,
                         p->slip_speed, p->reach,     p->energy ? p->energy : brunt_barrier_at};
}

double barrier_share_of(const brunt_barrier *b, int32_t law, int8_t side, bool edges) {
    return barrier_pair_of(b, law)->share[edges ? 2 : side > 0 ? 0 : 1];
}

double barrier_plane_offset(const brunt_barrier *b, const brunt_barrier_plane *plane, int32_t point) {
    return plane->offset ? plane->offset[barrier_body_of(b, point)] : 0;
}

bool brunt_barrier_has_friction(const brunt_barrier *b) {
    bool rubs = b->source.friction;
    for (int32_t i = 0; i < b->step.plane_count; i++) rubs = rubs || b->step.planes[i].friction > 0;
    return rubs;
}
