// Blocks whose particles have changed, sorted where they are: the others keep every array as it is.
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "mpm/sort_parts.h"

int sort_changes_clear(sort_job *j, brunt_error *error) {
    brunt_sort_workspace *w = j->workspace;
    const size_t blocks = (size_t)j->grid->block_count;
    if (BRUNT_CAPACITY(w->changed, blocks + 1, 0, "marks of blocks of particles", error)) return BRUNT_FAILED;
    memset(w->changed, 0, blocks);
    return BRUNT_OK;
}

// Movers by the block they come to, ranges in their order, so that they stay in the order of the blocks they come from.
static void list_arrivals(sort_job *j) {
    brunt_sort_workspace *w = j->workspace;
    const int32_t blocks = j->grid->block_count;
    int32_t *first = w->arrivals; // of block b at b + 1, until all are listed
    memset(first, 0, ((size_t)blocks + 2) * sizeof *first);
    for (int q = 0; q < j->range_count; q++)
        for (int64_t k = 0; k < j->ranges[q].mover_count; k++) first[j->ranges[q].mover[k].to + 2]++;
    for (int32_t b = 0; b < blocks; b++) first[b + 2] += first[b + 1];
    for (int q = 0; q < j->range_count; q++)
        for (int64_t k = 0; k < j->ranges[q].mover_count; k++) {
            const sort_mover *m = &j->ranges[q].mover[k];
            w->arrival[first[m->to + 1]++] = *m;
            w->changed[m->to] = 1;
            w->total[m->from]--, w->total[m->to]++;
        }
}

int sort_changes_count(sort_job *j, bool *fits, brunt_error *error) {
    brunt_sort_workspace *w = j->workspace;
    const int32_t blocks = j->grid->block_count;
    size_t movers = 0;
    for (int q = 0; q < j->range_count; q++) movers += (size_t)j->ranges[q].mover_count;
    if (BRUNT_CAPACITY(w->total, (size_t)blocks, 0, "blocks of particles", error) ||
        BRUNT_CAPACITY(w->arrivals, (size_t)blocks + 2, 0, "blocks of particles", error) ||
        BRUNT_CAPACITY(w->arrival, movers + 1, 0, "particles that change their block", error))
        return BRUNT_FAILED;
    for (int32_t b = 0; b < blocks; b++) w->total[b] = j->grid->blocks[b].count;
    list_arrivals(j);
    *fits = true;
    w->most = 0;
    for (int32_t b = 0; b < blocks; b++) {
        if (w->total[b] == 0 || w->total[b] > j->grid->blocks[b].room) *fits = false;
        const int64_t seen = j->grid->blocks[b].count + w->arrivals[b + 1] - w->arrivals[b];
        if (seen > w->most) w->most = seen;
    }
    return BRUNT_OK;
}

// What arrives is taken up before any block changes.
static void carry(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const sort_job *j = context;
    const brunt_particles *p = j->particles;
    brunt_sort_workspace *w = j->workspace;
    const int64_t movers = w->arrivals[j->grid->block_count];
    for (int64_t m = begin; m < end; m++) {
        const int64_t s = w->arrival[m].slot;
        for (int k = 0; k < p->scalar_count; k++) w->carried[k * movers + m] = p->scalar[k][s];
        w->carried_id[m] = p->id[s];
    }
}

// A block's new order: places among the old ones, and behind them those of its arrivals. Stable: in a bin first what
// comes from blocks before, then what was there, then what comes from blocks behind. How many places of the new order
// are as they were.
static int32_t order_block(const sort_job *j, int32_t b, int32_t *order) {
    brunt_particles *p = j->particles;
    const brunt_sort_workspace *w = j->workspace;
    const brunt_block *block = &j->grid->blocks[b];
    const int32_t arrivals = w->arrivals[b + 1] - w->arrivals[b], had = block->count;
    const sort_mover *arrival = w->arrival + w->arrivals[b];
    const uint64_t *key = p->key + block->first;
    int32_t *start = j->grid->bin_start + (size_t)b * BRUNT_BIN_STARTS, at[BRUNT_BIN_STARTS];
    int32_t before = 0, same = 0;
    while (before < arrivals && arrival[before].from < b) before++;
    memset(start, 0, BRUNT_BIN_STARTS * sizeof *start);
    for (int32_t i = 0; i < arrivals; i++) start[arrival[i].bin + 1]++;
    for (int32_t i = 0; i < had; i++)
        if (key[i] >> 6 == (uint64_t)b) start[(key[i] & 63) + 1]++;
    for (int k = 0; k < BRUNT_BLOCK_NODES; k++) start[k + 1] += start[k];
    memcpy(at, start, sizeof at);
    for (int32_t i = 0; i < before; i++) order[at[arrival[i].bin]++] = had + i;
    for (int32_t i = 0; i < had; i++)
        if (key[i] >> 6 == (uint64_t)b) order[at[key[i] & 63]++] = i;
    for (int32_t i = before; i < arrivals; i++) order[at[arrival[i].bin]++] = had + i;
    const int32_t count = start[BRUNT_BLOCK_NODES];
    while (same < count && same < had && order[same] == same) same++;
    return same;
}

// The new order of a block: the first `same` places are as they were; `fill`: as many as there are with padding.
typedef struct block_order {
    const int32_t *order;
    int32_t had, arrivals, same, count, fill;
} block_order;

// An array to its new order; what arrives is `more`, padding has the last one's. `old`: room for what there was.
static void reorder(const block_order *o, real *to, const real *more, real *old) {
    memcpy(old, to, (size_t)o->had * sizeof *old);
    memcpy(old + o->had, more, (size_t)o->arrivals * sizeof *old);
    for (int32_t i = o->same; i < o->count; i++) to[i] = old[o->order[i]];
    for (int32_t i = o->count; i < o->fill; i++) to[i] = to[o->count - 1];
}

static void sort_block(sort_job *j, int32_t b, int worker) {
    brunt_particles *p = j->particles;
    brunt_sort_workspace *w = j->workspace;
    brunt_block *block = &j->grid->blocks[b];
    int32_t *order = p->order + block->first;
    const int64_t first = block->first, from = w->arrivals[b], movers = w->arrivals[j->grid->block_count];
    const int32_t arrivals = (int32_t)(w->arrivals[b + 1] - from), had = block->count, count = (int32_t)w->total[b];
    const int32_t same = order_block(j, b, order), fill = (int32_t)brunt_padded(count > had ? count : had);
    const block_order to = {order, had, arrivals, same, count, fill};
    real *old = w->old + w->most * worker;
    int64_t *old_id = w->old_id + w->most * worker, *id = p->id + first;
    for (int k = 0; k < p->scalar_count; k++) reorder(&to, p->scalar[k] + first, w->carried + k * movers + from, old);
    memcpy(old_id, id, (size_t)had * sizeof *id);
    memcpy(old_id + had, w->carried_id + from, (size_t)arrivals * sizeof *id);
    real *mass = brunt_field(p, BRUNT_FIELD_mass)[0] + first,
         *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0] + first;
    const int32_t *start = j->grid->bin_start + (size_t)b * BRUNT_BIN_STARTS;
    for (int bin = 0; bin < BRUNT_BLOCK_NODES; bin++)
        for (int32_t i = start[bin]; i < start[bin + 1]; i++) {
            id[i] = old_id[order[i]];
            p->bin[first + i] = (uint8_t)bin, p->key[first + i] = (uint64_t)b << 6 | (uint64_t)bin;
        }
    for (int32_t i = count; i < fill; i++) {
        id[i] = -1, mass[i] = volume[i] = 0;
        p->bin[first + i] = p->bin[first + count - 1], p->key[first + i] = p->key[first + count - 1];
    }
    block->count = count;
}

static void sort_marked(void *context, int64_t begin, int64_t end, int worker) {
    sort_job *j = context;
    for (int64_t b = begin; b < end; b++)
        if (j->workspace->changed[b]) sort_block(j, (int32_t)b, worker);
}

int sort_changed(sort_job *j, brunt_error *error) {
    brunt_sort_workspace *w = j->workspace;
    brunt_particles *p = j->particles;
    const int32_t blocks = j->grid->block_count;
    const size_t movers = (size_t)w->arrivals[blocks], most = (size_t)(w->most * j->threads);
    if (BRUNT_CAPACITY(w->carried, movers * (size_t)p->scalar_count + 1, 0, "particles that change their block",
                       error) ||
        BRUNT_CAPACITY(w->carried_id, movers + 1, 0, "particles that change their block", error) ||
        BRUNT_CAPACITY(w->old, most, 0, "particles of blocks", error) ||
        BRUNT_CAPACITY(w->old_id, most, 0, "particles of blocks", error))
        return BRUNT_FAILED;
    brunt_parallel(j->threads, (int64_t)movers, 64, carry, j, j->timer);
    brunt_parallel(j->threads, blocks, BLOCK_GRAIN, sort_marked, j, j->timer);
    for (int32_t b = 0; b < blocks; b++) p->moved += w->changed[b] ? j->grid->blocks[b].count : 0;
    return BRUNT_OK;
}
