// What must hold of a body of material points between two steps; looked at in debug builds (world/validate.c).
#include "base/error.h"
#include "base/simd.h"
#include "mpm/mpm_body.h"

// Slots of a block: by bin, real particles first, then copies that weigh nothing.
static void validate_block(brunt_body *body, int32_t b) {
    brunt_particles *p = &body->particles;
    const brunt_block *block = &body->grid.blocks[b];
    const int32_t *start = body->grid.bin_start + (size_t)b * BRUNT_BIN_STARTS;
    const real *mass = brunt_field(p, BRUNT_FIELD_mass)[0];
    const int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    BRUNT_ASSERT(block->first % BRUNT_LANES == 0 && block->count > 0 && block->first + padded <= p->slots);
    BRUNT_ASSERT(start[0] == 0 && start[BRUNT_BLOCK_NODES] == block->count);
    for (int k = 0; k < BRUNT_BLOCK_NODES; k++) BRUNT_ASSERT(start[k] <= start[k + 1]);
    for (int32_t i = 0; i < padded; i++) {
        const int64_t s = block->first + i;
        BRUNT_ASSERT((p->id[s] >= 0) == (i < block->count) && p->id[s] < p->made);
        BRUNT_ASSERT(i < block->count ? mass[s] > 0 : mass[s] == 0);
        if (i < block->count) BRUNT_ASSERT(start[p->bin[s]] <= i && i < start[p->bin[s] + 1]);
    }
}

void brunt_body_validate(brunt_body *body) {
    const brunt_particles *p = &body->particles;
    BRUNT_ASSERT(p->count <= p->slots && p->slots <= p->capacity && p->count <= p->made);
    if (body->grid.block_count) brunt_grid_validate(&body->grid);
    if (!body->grid.block_count || p->holes) return; // not sorted since it was made, read, or has lost some
    int64_t count = 0;
    for (int32_t b = 0; b < body->grid.block_count; b++) {
        validate_block(body, b);
        count += body->grid.blocks[b].count;
    }
    BRUNT_ASSERT(count == p->count);
}
