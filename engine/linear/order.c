#include "linear/order.h"

#include <metis.h>

#include "base/error.h"
#include "base/memory.h"

_Static_assert(sizeof(idx_t) == sizeof(int32_t), "METIS with 32-bit indices");

typedef struct graph {
    idx_t *first, *neighbour, *order;
} graph;

// Columns of each row but its own.
static void take_graph(const brunt_block_matrix *a, graph *g) {
    idx_t count = 0;
    for (int32_t r = 0; r < a->nodes; r++) {
        g->first[r] = count;
        for (int64_t k = a->first[r]; k < a->first[r + 1]; k++)
            if (a->column[k] != r) g->neighbour[count++] = a->column[k];
    }
    g->first[a->nodes] = count;
}

static int order_nodes(const brunt_block_matrix *a, graph *g, int32_t *position, brunt_error *error) {
    idx_t nodes = a->nodes, options[METIS_NOPTIONS];
    take_graph(a, g);
    METIS_SetDefaultOptions(options); // with its own fixed seed: the same graph gives the same order
    const int done = METIS_NodeND(&nodes, g->first, g->neighbour, NULL, options, g->order, position);
    if (done == METIS_OK) return BRUNT_OK;
    return brunt_fail(error, BRUNT_FAILED, "METIS gave no order of %d nodes: %s.", a->nodes,
                      done == METIS_ERROR_MEMORY ? "out of memory" : "it refused the graph");
}

int brunt_elimination_order(const brunt_block_matrix *a, int32_t *position, brunt_error *error) {
    const int64_t edges = brunt_block_matrix_blocks(a) - a->nodes;
    if (edges > INT32_MAX)
        return brunt_fail(error, BRUNT_FAILED,
                          "The direct solver takes matrices of up to %d blocks; this one has %lld.", INT32_MAX,
                          (long long)edges);
    for (int32_t n = 0; n < a->nodes; n++) position[n] = n;
    if (edges == 0) return BRUNT_OK;
    graph g = {brunt_alloc(((size_t)a->nodes + 1) * sizeof(idx_t)), brunt_alloc((size_t)edges * sizeof(idx_t)),
               brunt_alloc((size_t)a->nodes * sizeof(idx_t))};
    const int code = g.first && g.neighbour && g.order
                         ? order_nodes(a, &g, position, error)
                         : brunt_fail(error, BRUNT_FAILED, "Out of memory for the order of %d nodes.", a->nodes);
    brunt_free(g.first), brunt_free(g.neighbour), brunt_free(g.order);
    return code;
}
