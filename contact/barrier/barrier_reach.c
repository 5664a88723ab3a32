// How far material points may go while u moves by p: no farther than the nodes that move them.
#include "contact/barrier/barrier_parts.h"

enum { GRAIN = 1024 };
#define SPARE (1 + 1e-9) // rounding of sums of weights and displacements

// The most that each worker has found.
typedef struct found {
    double size, spread, move[3];
    int32_t low, high;
    double finite; // 0, or not a number
} found;

typedef struct extent_work {
    const barrier_way *way;
    found *found;
} extent_work;

static void measure_particles(void *context, int64_t begin, int64_t end, int worker) {
    const extent_work *w = context;
    const brunt_barrier *b = w->way->b;
    const brunt_barrier_particles *p = &b->step.particles;
    found f = w->found[worker];
    for (int64_t i = begin; i < end; i++) {
        double spread = 0;
        for (int k = 0; k < b->dim; k++) {
            const double size = fabs(p->x[i][k]) + fabs(p->x[i][k] - b->origin[k]);
            if (size > f.size) f.size = size;
        }
        for (int64_t k = p->first[i]; k < p->first[i + 1]; k++) {
            spread += fabs(p->weight[k]);
            if (p->node[k] < f.low) f.low = p->node[k];
            if (p->node[k] >= f.high) f.high = p->node[k] + 1;
        }
        if (spread > f.spread) f.spread = spread;
    }
    w->found[worker] = f;
}

static void measure_nodes(void *context, int64_t begin, int64_t end, int worker) {
    const extent_work *w = context;
    const barrier_way *way = w->way;
    const int64_t dim = way->b->dim, low = way->b->extent.low;
    found f = w->found[worker];
    for (int64_t n = low + begin; n < low + end; n++)
        for (int k = 0; k < dim; k++) {
            const double move =
                (way->u ? fabs(way->u[n * dim + k]) : 0) + (way->p ? way->part * fabs(way->p[n * dim + k]) : 0);
            if (move > f.move[k]) f.move[k] = move;
            f.finite += move - move;
        }
    w->found[worker] = f;
}

static void take_extent(extent_work *w, const brunt_team *team) {
    brunt_barrier *b = w->way->b;
    barrier_extent *e = &b->extent;
    *e = (barrier_extent){.known = true, .low = INT32_MAX};
    brunt_parallel(team->threads, b->step.particles.count, GRAIN, measure_particles, w, team->timer);
    for (int t = 0; t < BRUNT_THREAD_LIMIT; t++) {
        const found *f = &w->found[t];
        e->size = fmax(e->size, f->size), e->spread = fmax(e->spread, f->spread);
        if (f->low < e->low) e->low = f->low;
        if (f->high > e->high) e->high = f->high;
    }
}

double barrier_take_reach(barrier_way *way, const brunt_team *team) {
    const barrier_extent *e = &way->b->extent;
    found all[BRUNT_THREAD_LIMIT];
    extent_work work = {way, all};
    double most = 0;
    for (int t = 0; t < BRUNT_THREAD_LIMIT; t++) all[t] = (found){.low = INT32_MAX};
    for (int k = 0; k < 3; k++) way->reach[k] = 0;
    if (way->b->step.particles.count == 0) return 0;
    if (!e->known) take_extent(&work, team);
    brunt_parallel(team->threads, e->high - e->low, GRAIN, measure_nodes, &work, team->timer);
    for (int t = 0; t < BRUNT_THREAD_LIMIT; t++)
        for (int k = 0; k < way->b->dim; k++) {
            if (!(all[t].finite == 0)) way->reach[k] = INFINITY;
            way->reach[k] = fmax(way->reach[k], SPARE * e->spread * all[t].move[k]);
            most = fmax(most, way->reach[k]);
        }
    return most < INFINITY ? e->size + most : e->size;
}
