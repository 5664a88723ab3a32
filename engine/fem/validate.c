// What must hold of a mesh body between two steps; looked at in debug builds (world/validate.c).
#include <math.h>

#include "base/error.h"
#include "base/simd.h"
#include "fem/fem_body.h"

// Element slots of a block: real ones first, with the nodes that the block knows, then copies that weigh nothing.
static void validate_slots(const brunt_fem_body *body, const brunt_fem_block *block) {
    const int nodes = body->element->traits->nodes;
    const real *volume = body->scalar[body->field[BRUNT_ELEMENT_reference_volume].first];
    const int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    for (int32_t k = 0; k < padded; k++) {
        const int32_t slot = block->first + k;
        BRUNT_ASSERT((body->element_id[slot] >= 0) == (k < block->count));
        BRUNT_ASSERT(k < block->count ? volume[slot] > 0 : volume[slot] == 0);
        for (int a = 0; a < nodes; a++) {
            const int32_t at = slot * nodes + a, local = body->local[at];
            BRUNT_ASSERT(local < block->node_count);
            BRUNT_ASSERT(body->block_node[block->node_first + local] == body->element_node[at]);
        }
    }
}

static void validate_blocks(const brunt_fem_body *body) {
    int32_t elements = 0, slot = 0, node = 0;
    for (int32_t b = 0; b < body->block_count; b++) {
        const brunt_fem_block *block = &body->block[b];
        BRUNT_ASSERT(block->first % BRUNT_LANES == 0 && block->first >= slot && block->count >= 0);
        BRUNT_ASSERT(block->node_first == node && block->node_count <= body->block_nodes);
        validate_slots(body, block);
        slot = block->first + block->count, node += block->node_count, elements += block->count;
    }
    BRUNT_ASSERT(slot <= body->slots && node == body->partial_count && elements == body->element_count);
}

void brunt_fem_validate(const brunt_fem_body *body) {
    validate_blocks(body);
    BRUNT_ASSERT(body->partial_first[0] == 0 && body->partial_first[body->node_count] == body->partial_count);
    for (int32_t n = 0; n < body->node_count; n++) {
        BRUNT_ASSERT(body->partial_first[n] <= body->partial_first[n + 1]);
        for (int32_t k = body->partial_first[n]; k < body->partial_first[n + 1]; k++)
            BRUNT_ASSERT(body->block_node[body->partial_of[k]] == n);
        for (int a = 0; a < body->dim; a++)
            BRUNT_ASSERT(isfinite((double)body->node[(size_t)n * BRUNT_FEM_NODE_REALS + (size_t)a]));
    }
    BRUNT_ASSERT(body->hourglass_overlap >= 0 && body->hourglass_overlap <= 1);
}
