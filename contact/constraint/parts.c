// Parts of a set: slabs across its longest way, of as many chunks each.
//
// What a sweep gives a node is added up in the order of the points. Where one thread goes over all of a node's points
// in that order it adds at once; the few nodes that points of several parts press on are given by entry, and added by
// column. The sum is the same, to the bit, whatever the parts.
#include "contact/constraint/parts.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "contact/constraint/block.h"
#include "contact/constraint/columns.h"

enum { GRAIN = BRUNT_CONSTRAINT_GRAIN, LEAST_CHUNKS = 4 }; // LEAST_CHUNKS: that are worth a thread

static int32_t chunks_of(const brunt_constraint_set *p) { return (p->constraint_count + GRAIN - 1) / GRAIN; }

static int by_place(const void *a, const void *b) {
    const struct brunt_chunk_place *p = a, *q = b;
    return p->x < q->x ? -1 : p->x > q->x ? 1 : p->chunk - q->chunk;
}

static const double *place_of(const brunt_constraint_set *p, int32_t chunk) { return p->constraint[chunk * GRAIN].x; }

static int longest_axis(const brunt_constraint_set *p) {
    double length[3];
    for (int a = 0; a < 3; a++) {
        double low = place_of(p, 0)[a], high = low;
        for (int32_t c = 1; c < chunks_of(p); c++) {
            const double x = place_of(p, c)[a];
            low = x < low ? x : low, high = x > high ? x : high;
        }
        length[a] = high - low;
    }
    const int longest = length[1] > length[0];
    return length[2] > length[longest] ? 2 : longest;
}

static int divide(brunt_constraint_set *p, brunt_error *error) {
    const int32_t chunks = chunks_of(p);
    const int axis = longest_axis(p);
    if (BRUNT_CAPACITY(p->part_of, (size_t)chunks, 0, "parts of contact points", error) ||
        BRUNT_CAPACITY(p->chunk_place, (size_t)chunks, 0, "places of contact points", error))
        return BRUNT_FAILED;
    for (int32_t c = 0; c < chunks; c++) p->chunk_place[c] = (struct brunt_chunk_place){place_of(p, c)[axis], c};
    qsort(p->chunk_place, (size_t)chunks, sizeof *p->chunk_place, by_place);
    for (int32_t c = 0; c < chunks; c++)
        p->part_of[p->chunk_place[c].chunk] = (int32_t)((int64_t)c * p->parts / chunks);
    return BRUNT_OK;
}

// A task over the chunks of parts.
typedef struct part_job {
    const brunt_constraint_set *p;
    brunt_task_fn *task;
} part_job;

static void run_parts(void *context, int64_t begin, int64_t end, int worker) {
    const part_job *j = context;
    const int32_t chunks = chunks_of(j->p);
    for (int64_t part = begin; part < end; part++)
        for (int32_t c = 0; c < chunks; c++)
            if (j->p->part_of[c] == part) j->task((void *)j->p, c, c + 1, worker);
}

void brunt_constraints_over_parts(brunt_constraint_set *p, int threads, brunt_task_fn *task, brunt_timer *timer) {
    if (p->parts > 1)
        brunt_parallel_each(threads, p->parts, run_parts, &(part_job){p, task}, timer);
    else
        brunt_parallel(p->parts ? 1 : threads, chunks_of(p), 1, task, p, timer);
}

static uint8_t *marks_of(const brunt_constraint_set *p, int64_t part) {
    return p->marks + (size_t)part * (size_t)p->dof_node_count;
}

static void mark_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t c = begin; c < end; c++) {
        uint8_t *mark = marks_of(p, p->part_of[c]);
        for (int64_t k = c * GRAIN; k < (c + 1) * GRAIN && k < p->constraint_count; k += BRUNT_DOUBLES) {
            const brunt_constraint_block *b = &p->block[k / BRUNT_DOUBLES];
            for (int e = 0; e < b->count; e++)
                for (int l = 0; l < BRUNT_DOUBLES; l++) mark[b->dof_node[e][l]] = 1;
            for (int64_t i = k; i < k + BRUNT_DOUBLES && i < p->constraint_count && !b->count; i++)
                for (int e = 0; e < p->constraint[i].count; e++) mark[brunt_constraint_node(p, i, e)] = 1;
        }
    }
}

static void find_shared(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t s = begin; s < end; s++) {
        int parts = 0;
        for (int part = 0; part < p->parts; part++) parts += marks_of(p, part)[s];
        p->shared[s] = parts > 1;
    }
}

// How many nodes each part has alone, and lists them.
static void count_own(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t part = begin; part < end; part++) {
        const uint8_t *mark = marks_of(p, part);
        int32_t count = 0;
        for (int32_t s = 0; s < p->dof_node_count; s++) count += mark[s] & !p->shared[s];
        p->own_first[part + 1] = count;
    }
}

static void list_own(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_constraint_set *p = context;
    for (int64_t part = begin; part < end; part++) {
        const uint8_t *mark = marks_of(p, part);
        int32_t at = p->own_first[part];
        for (int32_t s = 0; s < p->dof_node_count; s++)
            if (mark[s] && !p->shared[s]) p->own[at++] = s;
    }
}

// Nodes by the part that has them alone, then those that are shared.
static int list_nodes(brunt_constraint_set *p, int threads, brunt_timer *timer, brunt_error *error) {
    if (BRUNT_CAPACITY(p->own, (size_t)p->dof_node_count + 1, 0, "nodes of parts", error) ||
        BRUNT_CAPACITY(p->own_first, (size_t)p->parts + 2, 0, "parts of contact points", error))
        return BRUNT_FAILED;
    brunt_parallel_each(threads, p->parts, count_own, p, timer);
    p->own_first[0] = 0;
    for (int part = 0; part < p->parts; part++) p->own_first[part + 1] += p->own_first[part];
    brunt_parallel_each(threads, p->parts, list_own, p, timer);
    int32_t at = p->own_first[p->parts];
    for (int32_t s = 0; s < p->dof_node_count; s++)
        if (p->shared[s]) p->own[at++] = s;
    p->own_first[p->parts + 1] = at;
    return BRUNT_OK;
}

// No parts: every node is shared, and has its column.
static int share_all(brunt_constraint_set *p, int threads, brunt_timer *timer, brunt_error *error) {
    p->parts = 0;
    memset(p->shared, true, (size_t)p->dof_node_count);
    return brunt_constraints_make_columns(p, threads, timer, error);
}

int brunt_constraints_make_parts(brunt_constraint_set *p, int threads, brunt_timer *timer, brunt_error *error) {
    const int32_t chunks = chunks_of(p);
    if (BRUNT_CAPACITY(p->shared, (size_t)p->dof_node_count + 1, 0, "nodes that contact moves", error))
        return BRUNT_FAILED;
    // Accelerated sweeps and friction points look at whole columns.
    if (p->accelerated || p->friction_point_count) return share_all(p, threads, timer, error);
    p->parts = threads < chunks / LEAST_CHUNKS ? threads : chunks / LEAST_CHUNKS;
    if (p->parts < 2) {
        p->parts = 1;
        memset(p->shared, false, (size_t)p->dof_node_count);
        return BRUNT_OK;
    }
    const size_t marks = (size_t)p->parts * (size_t)p->dof_node_count;
    if (divide(p, error) || BRUNT_CAPACITY(p->marks, marks, 0, "marks of nodes that contact moves", error))
        return BRUNT_FAILED;
    memset(p->marks, 0, marks);
    brunt_constraints_over_parts(p, threads, mark_nodes, timer);
    brunt_parallel(threads, p->dof_node_count, GRAIN, find_shared, p, timer);
    if (list_nodes(p, threads, timer, error)) return BRUNT_FAILED;
    return brunt_constraints_make_columns(p, threads, timer, error);
}
