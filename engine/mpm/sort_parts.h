// What the files of the sort share. Private to them.
#pragma once

#include "base/parallel.h"
#include "base/simd.h"
#include "grid/grid.h"
#include "mpm/particles.h"

enum { SORT_RANGES = 64, BLOCK_GRAIN = 2, SLOT_GRAIN = 1024 };

// A particle that goes to another block: its slot, both blocks by rank, its new bin.
typedef struct sort_mover {
    int32_t slot, from, to;
    uint8_t bin;
} sort_mover;

// What one range of particles finds in the first round.
typedef struct sort_range {
    int64_t begin, end;
    int32_t first_block, end_block; // that it is of, once there are blocks
    int64_t bad;                    // slot of a particle that cannot be placed, -1
    bool lost;                      // there was no memory for one more that is missing, or moves
    bool moved;                     // some particle is not where the last sort put it
    uint64_t *missing;
    size_t missing_capacity;
    int64_t missing_count;
    int32_t *count;
    size_t count_capacity; // particles per block, then the next place in it
    sort_mover *mover;     // in the order of their slots
    size_t mover_capacity;
    int64_t mover_count;
} sort_range;

// Kept from step to step, so that a step allocates nothing once the body has been everywhere.
struct brunt_sort_workspace {
    sort_range ranges[SORT_RANGES];
    int64_t *total; // of each block: particles it has, or will have
    size_t total_capacity;
    uint64_t *keys;
    size_t keys_capacity;
    // Of blocks that are sorted where they are.
    uint8_t *changed; // of each block: some particle comes, goes, or changes its bin
    size_t changed_capacity;
    int32_t *arrivals; // of each block: where those that come begin in `arrival`, one more at the end
    size_t arrivals_capacity;
    sort_mover *arrival; // by the block they come to, in the order of the blocks they come from
    size_t arrival_capacity;
    real *carried; // what they have, an array for each scalar; their ids
    size_t carried_capacity;
    int64_t *carried_id;
    size_t carried_id_capacity;
    real *old; // of each thread: an array of a block as it was, and what comes
    size_t old_capacity;
    int64_t *old_id;
    size_t old_id_capacity;
    int64_t most; // of these, for each thread
};

typedef struct sort_job {
    brunt_grid *grid;
    brunt_particles *particles;
    sort_range *ranges;
    int range_count;
    brunt_sort_workspace *workspace;
    int threads;
    brunt_timer *timer; // may be NULL
    bool renewed;       // ranks of blocks are not those of the last sort: what it stored no longer compares
    int group;          // scalars being moved: BRUNT_SORT_GROUP of them from here
} sort_job;

static inline int64_t brunt_padded(int64_t count) { return (count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES; }

// --- sort_blocks.c
// No block has changed. BRUNT_OK, or BRUNT_FAILED: out of memory.
int sort_changes_clear(sort_job *job, brunt_error *error);
// Lists the arrivals of each block, after a look in which no block was missing; `*fits`: every block has one particle
// at least, and room for all it will have. BRUNT_OK, or BRUNT_FAILED: out of memory.
int sort_changes_count(sort_job *job, bool *fits, brunt_error *error);
// Sorts the blocks that change where they are. BRUNT_OK, or BRUNT_FAILED: out of memory; nothing has moved then.
int sort_changed(sort_job *job, brunt_error *error);
