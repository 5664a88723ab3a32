// The order of elements and nodes in memory.
//
// Elements follow a Hilbert curve through their centroids, so that a block of consecutive ones is compact and
// neighbours in space are neighbours in memory. The curve's grid is laid so that blocks of a structured mesh are cubes
// of cubes: its unit is the edge of a cube as large as the mean hexahedron, or as 6 mean tetrahedra, or 2 mean
// triangles.
#include "fem/layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/simd.h"
#include "base/array.h"
#include "base/memory.h"

// J. Skilling, Programming the Hilbert curve, AIP Conf. Proc. 707 (2004) 381.
uint64_t brunt_hilbert_key(int dim, int bits, const uint32_t *coordinate) {
    uint32_t x[3] = {0}, flip = 0, top = (uint32_t)1 << (bits - 1);
    for (int a = 0; a < dim; a++) x[a] = coordinate[a];
    for (uint32_t q = top; q > 1; q >>= 1)
        for (int a = 0; a < dim; a++) {
            uint32_t low = q - 1, swap = (x[0] ^ x[a]) & low;
            if (x[a] & q)
                x[0] ^= low;
            else
                x[0] ^= swap, x[a] ^= swap;
        }
    for (int a = 1; a < dim; a++) x[a] ^= x[a - 1];
    for (uint32_t q = top; q > 1; q >>= 1)
        if (x[dim - 1] & q) flip ^= q - 1;
    uint64_t key = 0;
    for (int b = bits - 1; b >= 0; b--)
        for (int a = 0; a < dim; a++) key = key << 1 | (((x[a] ^ flip) >> b) & 1);
    return key;
}

typedef struct placed_element {
    uint64_t key;
    int32_t element;
} placed_element;

static int by_key(const void *left, const void *right) {
    const placed_element *a = left, *b = right;
    if (a->key != b->key) return a->key < b->key ? -1 : 1;
    return (a->element > b->element) - (a->element < b->element);
}

static void corners_of(const brunt_mesh *mesh, int nodes, int32_t element, double (*x)[3]) {
    for (int a = 0; a < nodes; a++)
        memcpy(x[a], mesh->nodes[mesh->elements[(int64_t)element * nodes + a]], sizeof x[a]);
}

static void sort_elements(const brunt_element *type, const brunt_mesh *mesh, placed_element *order) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, extent = 0, volume = 0, x[BRUNT_ELEMENT_NODES][3];
    for (int pass = 0; pass < 2; pass++)
        for (int32_t n = 0; n < mesh->node_count; n++)
            for (int a = 0; a < type->traits->dimension; a++) {
                if (pass == 0)
                    low[a] = fmin(low[a], mesh->nodes[n][a]);
                else
                    extent = fmax(extent, mesh->nodes[n][a] - low[a]);
            }
    for (int32_t e = 0; e < mesh->element_count; e++) {
        corners_of(mesh, type->traits->nodes, e, x);
        volume += fabs(type->volume((const double(*)[3])x));
    }
    const int span = type->traits->span;
    bool simplex = type->traits->nodes == span + 1;
    double share = volume / mesh->element_count * (simplex ? span == 3 ? 6 : 2 : 1);
    double unit = pow(share, 1.0 / span);
    const int bits = type->traits->dimension == 3 ? 21 : 31;
    // 2^-fraction units are one step of the grid; the whole extent must fit.
    int fraction = bits - 1 - (int)ceil(log2(extent / unit + 1));
    double scale = ldexp(1 / unit, fraction), limit = ldexp(1, bits) - 1;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        uint32_t at[3] = {0};
        corners_of(mesh, type->traits->nodes, e, x);
        for (int a = 0; a < type->traits->dimension; a++) {
            double sum = 0;
            for (int k = 0; k < type->traits->nodes; k++) sum += x[k][a];
            at[a] = (uint32_t)fmin(fmax((sum / type->traits->nodes - low[a]) * scale, 0), limit);
        }
        order[e] = (placed_element){brunt_hilbert_key(type->traits->dimension, bits, at), e};
    }
    qsort(order, (size_t)mesh->element_count, sizeof *order, by_key);
}

// Small bodies get small blocks, so that there are enough of them for some threads.
static int block_size(const brunt_element *type, int32_t elements) {
    int size = type->block;
    const int span = type->traits->span;
    for (int k = 0; k < (span == 3 ? 1 : 2) && elements < 16 * size; k++) size /= span == 3 ? 8 : 4;
    return size;
}

// Elements into blocks and slots, nodes numbered by first use.
static void place_elements(brunt_fem_body *body, const brunt_mesh *mesh, const placed_element *order, int size,
                           int32_t *number) {
    const int nodes = body->traits->nodes;
    memset(number, -1, (size_t)mesh->node_count * sizeof *number);
    int32_t slot = 0, used = 0;
    for (int32_t b = 0; b < body->block_count; b++) {
        int32_t first = b * size, count = body->element_count - first < size ? body->element_count - first : size;
        body->block[b] = (brunt_fem_block){.first = slot, .count = count};
        int32_t padded = (count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
        for (int32_t k = 0; k < padded; k++, slot++) {
            int32_t element = order[first + (k < count ? k : count - 1)].element;
            body->element_id[slot] = k < count ? element : -1;
            for (int a = 0; a < nodes; a++) {
                int32_t node = mesh->elements[(int64_t)element * nodes + a];
                if (number[node] < 0) {
                    body->node_id[used] = node;
                    number[node] = used++;
                }
                body->element_node[(int64_t)slot * nodes + a] = number[node];
            }
        }
    }
    body->node_count = used;
}

static int ascending(const void *left, const void *right) {
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
    return (a > b) - (a < b);
}

// Nodes of each block in ascending order, and the elements' nodes as places among them. `number`: of each node, its
// place in the block at hand, else -1.
static void place_nodes(brunt_fem_body *body, int32_t *number) {
    const int nodes = body->traits->nodes;
    memset(number, -1, (size_t)body->node_count * sizeof *number);
    int32_t at = 0, greatest = 0;
    for (int32_t b = 0; b < body->block_count; b++) {
        brunt_fem_block *block = &body->block[b];
        int64_t begin = (int64_t)block->first * nodes, end = begin + (int64_t)block->count * nodes;
        int64_t last = begin + (int64_t)((block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES) * nodes;
        block->node_first = at;
        for (int64_t k = begin; k < end; k++) {
            int32_t node = body->element_node[k];
            if (number[node] >= 0) continue;
            number[node] = 0;
            body->block_node[at++] = node;
        }
        block->node_count = at - block->node_first;
        if (block->node_count > greatest) greatest = block->node_count;
        int32_t *list = body->block_node + block->node_first;
        qsort(list, (size_t)block->node_count, sizeof *list, ascending);
        for (int32_t k = 0; k < block->node_count; k++) number[list[k]] = k;
        for (int64_t k = begin; k < last; k++) body->local[k] = (uint16_t)number[body->element_node[k]];
        for (int32_t k = 0; k < block->node_count; k++) number[list[k]] = -1;
    }
    body->partial_count = at;
    body->block_nodes = (greatest + 3) / 4 * 4;
}

static void invert_blocks(brunt_fem_body *body) {
    int32_t *first = body->partial_first;
    for (int32_t k = 0; k < body->partial_count; k++) first[body->block_node[k] + 1]++;
    for (int32_t n = 0; n < body->node_count; n++) first[n + 1] += first[n];
    for (int32_t k = 0; k < body->partial_count; k++) body->partial_of[first[body->block_node[k]]++] = k;
    for (int32_t n = body->node_count; n > 0; n--) first[n] = first[n - 1];
    first[0] = 0;
}

// The nodes of each block, and the blocks of each node. A block has at most as many nodes as its elements have corners.
static int number_blocks(brunt_fem_body *body, size_t corners, int32_t *number, brunt_error *error) {
    static const char what[] = "nodes of blocks of a mesh";
    if (BRUNT_NEW(body->block_node, corners, what, error)) return BRUNT_FAILED;
    int32_t *list = body->block_node;
    place_nodes(body, number);
    const int status = BRUNT_NEW(body->block_node, body->partial_count, what, error);
    if (!status) memcpy(body->block_node, list, (size_t)body->partial_count * sizeof *list);
    brunt_free(list);
    if (status || BRUNT_NEW(body->partial_first, body->node_count + 1, "nodes of a mesh", error) ||
        BRUNT_NEW(body->partial_of, body->partial_count, what, error))
        return BRUNT_FAILED;
    invert_blocks(body);
    return BRUNT_OK;
}

int brunt_fem_layout(brunt_fem_body *body, const brunt_mesh *mesh, brunt_error *error) {
    const brunt_element *type = body->element;
    const int size = block_size(type, mesh->element_count);
    body->element_count = mesh->element_count;
    body->block_count = (mesh->element_count + size - 1) / size;
    body->slots = (body->block_count - 1) * ((size + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES);
    int32_t rest = mesh->element_count - (body->block_count - 1) * size;
    body->slots += (rest + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    size_t corners = (size_t)body->slots * (size_t)type->traits->nodes, nodes = (size_t)mesh->node_count;
    placed_element *order;
    int32_t *number = NULL;
    int status = BRUNT_NEW(order, mesh->element_count, "elements in order", error);
    if (!status && (BRUNT_NEW(number, nodes, "numbers of nodes of a mesh", error) ||
                    BRUNT_NEW(body->block, body->block_count, "blocks of a mesh", error) ||
                    BRUNT_NEW(body->element_id, body->slots, "elements of a mesh", error) ||
                    BRUNT_NEW(body->element_node, corners, "nodes of elements of a mesh", error) ||
                    BRUNT_NEW(body->local, corners, "nodes of elements of a mesh", error) ||
                    BRUNT_NEW(body->node_id, nodes, "nodes of a mesh", error)))
        status = BRUNT_FAILED;
    if (!status) {
        sort_elements(type, mesh, order);
        place_elements(body, mesh, order, size, number);
        status = number_blocks(body, corners, number, error);
    }
    brunt_free(order);
    brunt_free(number);
    return status;
}
