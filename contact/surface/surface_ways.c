// How far what is near each other has moved against each other since the last step: of groups of nodes that follow each
// other, against those groups alone that have facets near them.
//
// What is known of a node and a facet stays known until they have come as much nearer, whatever lies between. Groups
// are compared by boxes about their nodes: a facet that a node may see has all of its corners in groups whose boxes
// are no further away than that and the widest facet. Where two groups are further apart what they do is not counted,
// and what is known of their nodes is no more than that they are.
#include "contact/surface/surface_parts.h"

#include <math.h>

#include "base/parallel.h"

enum { GRAIN = BRUNT_SURFACE_GRAIN, MOST_GROUPS = 512 };

typedef struct brunt_surface_way way;

int32_t brunt_surface_chunks(const brunt_contact_surface *s) {
    return s->node_range[s->fem_count] / GRAIN + s->fem_count;
}

static int32_t chunks_a_group(const brunt_contact_surface *s) {
    const int32_t most = (brunt_surface_chunks(s) + MOST_GROUPS - 1) / MOST_GROUPS;
    return most > 1 ? most : 1;
}

way brunt_surface_no_way(void) {
    way none;
    for (int a = 0; a < 3; a++) none.low[a] = none.from[a] = INFINITY, none.high[a] = none.to[a] = -INFINITY;
    return none;
}

static void add_way(way *all, const way *more) {
    for (int a = 0; a < 3; a++) {
        all->low[a] = more->low[a] < all->low[a] ? more->low[a] : all->low[a];
        all->high[a] = more->high[a] > all->high[a] ? more->high[a] : all->high[a];
    }
}

static bool are_near(const way *a, const way *b, double by) {
    for (int k = 0; k < 3; k++)
        if (a->from[k] - by > b->to[k] || b->from[k] - by > a->to[k]) return false;
    return true;
}

typedef struct job {
    brunt_contact_surface *surface;
    double by; // [m] from group to group
} job;

// Each group in the place of its first chunk.
static void join_chunks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_contact_surface *s = ((const job *)context)->surface;
    const int32_t each = chunks_a_group(s);
    for (int64_t g = begin; g < end; g++) {
        way *all = &s->motion.chunk[g * each];
        for (int64_t c = g * each + 1; c < (g + 1) * each && c < brunt_surface_chunks(s); c++) {
            const way *more = &s->motion.chunk[c];
            add_way(all, more);
            for (int a = 0; a < 3; a++) {
                all->from[a] = more->from[a] < all->from[a] ? more->from[a] : all->from[a];
                all->to[a] = more->to[a] > all->to[a] ? more->to[a] : all->to[a];
            }
        }
    }
}

static void compare_groups(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_contact_surface *s = j->surface;
    const int32_t each = chunks_a_group(s), count = (brunt_surface_chunks(s) + each - 1) / each;
    for (int64_t g = begin; g < end; g++) {
        const way *own = &s->motion.chunk[g * each];
        way all = *own;
        double square = 0;
        for (int32_t h = 0; h < count && own->from[0] <= own->to[0]; h++)
            if (are_near(own, &s->motion.chunk[h * each], j->by)) add_way(&all, &s->motion.chunk[h * each]);
        for (int a = 0; a < 3 && all.low[a] <= all.high[a]; a++)
            square += (all.high[a] - all.low[a]) * (all.high[a] - all.low[a]);
        s->motion.apart[g] = sqrt(square);
    }
}

void brunt_surface_compare_ways(brunt_contact_surface *s, int threads, brunt_timer *timer) {
    job j = {s, s->motion.seen};
    double widest = 0;
    for (int32_t c = 0; c < (s->face_count + GRAIN - 1) / GRAIN; c++) widest = fmax(widest, s->motion.widest[c]);
    j.by += widest;
    const int32_t each = chunks_a_group(s), count = (brunt_surface_chunks(s) + each - 1) / each;
    if (each > 1) brunt_parallel(threads, count, 1, join_chunks, &j, timer);
    brunt_parallel(threads, count, 1, compare_groups, &j, timer);
    s->motion.group = each;
}
