#include "linear/order.h"

#include <metis.h>

#include "base/error.h"
#include "base/memory.h"

_Static_assert(sizeof(idx_t) == sizeof(int32_t), "METIS with 32-bit indices");

typedef struct graph {
    idx_t *first, *neighbour, *order, *place;
} graph;

static bool is_alone(const brunt_block_matrix *a, int32_t r) { return a->first[r + 1] - a->first[r] == 1; }

// Columns of each row but its own, of nodes that couple with others: `number` is theirs among these.
static void take_graph(const brunt_block_matrix *a, const int32_t *number, graph *g) {
    idx_t count = 0, row = 0;
    for (int32_t r = 0; r < a->nodes; r++) {
        if (is_alone(a, r)) continue;
        g->first[row++] = count;
        for (int64_t k = a->first[r]; k < a->first[r + 1]; k++)
            if (a->column[k] != r) g->neighbour[count++] = number[a->column[k]];
    }
    g->first[row] = count;
}

static int order_nodes(const brunt_block_matrix *a, graph *g, idx_t nodes, int32_t *position, brunt_error *error) {
    idx_t options[METIS_NOPTIONS];
    take_graph(a, position, g);
    METIS_SetDefaultOptions(options); // with its own fixed seed: the same graph gives the same order
    const int done = METIS_NodeND(&nodes, g->first, g->neighbour, NULL, options, g->order, g->place);
    for (int32_t n = 0; n < a->nodes && done == METIS_OK; n++)
        if (position[n] < nodes) position[n] = g->place[position[n]];
    if (done == METIS_OK) return BRUNT_OK;
    return brunt_fail(error, BRUNT_FAILED, "METIS gave no order of %d nodes: %s.", nodes,
                      done == METIS_ERROR_MEMORY ? "out of memory" : "it refused the graph");
}

int brunt_elimination_order(const brunt_block_matrix *a, int32_t *position, int32_t *coupled, brunt_error *error) {
    const int64_t edges = brunt_block_matrix_blocks(a) - a->nodes;
    if (edges > INT32_MAX)
        return brunt_fail(error, BRUNT_FAILED,
                          "The direct solver takes matrices of up to %d blocks; this one has %lld.", INT32_MAX,
                          (long long)edges);
    int32_t count = 0, alone = 0;
    for (int32_t n = 0; n < a->nodes; n++) position[n] = is_alone(a, n) ? -1 - alone++ : count++;
    for (int32_t n = 0; n < a->nodes; n++)
        if (position[n] < 0) position[n] = count - 1 - position[n];
    *coupled = count;
    if (edges == 0) return BRUNT_OK;
    graph g = {brunt_alloc(((size_t)count + 1) * sizeof(idx_t)), brunt_alloc((size_t)edges * sizeof(idx_t)),
               brunt_alloc((size_t)count * sizeof(idx_t)), brunt_alloc((size_t)count * sizeof(idx_t))};
    const int code = g.first && g.neighbour && g.order && g.place
                         ? order_nodes(a, &g, count, position, error)
                         : brunt_fail(error, BRUNT_FAILED, "Out of memory for the order of %d nodes.", a->nodes);
    brunt_free(g.first), brunt_free(g.neighbour), brunt_free(g.order), brunt_free(g.place);
    return code;
}
