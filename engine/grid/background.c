// Where points lie in a mesh of triangles, and what links them to its nodes.
#include "grid/background.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "grid/grid.h"

// Of a triangle's height: points that rounding puts outside of all triangles are in them yet.
static const double ROUNDING_SHARE = 1e-9;

void brunt_background_weights(const brunt_background *b, int32_t triangle, const double x[2], double weight[3],
                              double slope[3][2]) {
    const int32_t *corner = b->corner[triangle];
    const double *p = b->node[corner[0]], *q = b->node[corner[1]], *r = b->node[corner[2]];
    const double one[2] = {q[0] - p[0], q[1] - p[1]}, two[2] = {r[0] - p[0], r[1] - p[1]};
    const double over = 1 / (one[0] * two[1] - one[1] * two[0]);
    const double g[2][2] = {{over * two[1], -over * two[0]}, {-over * one[1], over * one[0]}};
    for (int k = 0; k < 2; k++) weight[k + 1] = g[k][0] * (x[0] - p[0]) + g[k][1] * (x[1] - p[1]);
    weight[0] = 1 - weight[1] - weight[2];
    for (int a = 0; slope && a < 2; a++) slope[1][a] = g[0][a], slope[2][a] = g[1][a], slope[0][a] = -g[0][a] - g[1][a];
}

// ------------------------------------------------------------------------------------------ squares

static int32_t square_of(const brunt_background *b, int axis, double x) {
    const double at = floor((x - b->low[axis]) / b->square);
    return at < 0 ? 0 : at >= b->squares[axis] ? b->squares[axis] - 1 : (int32_t)at;
}

int32_t brunt_background_find(const brunt_background *b, const double x[2]) {
    int32_t found = BRUNT_NONE;
    double deepest = -ROUNDING_SHARE;
    if (!isfinite(x[0]) || !isfinite(x[1])) return BRUNT_NONE;
    const int64_t at = (int64_t)square_of(b, 0, x[0]) * b->squares[1] + square_of(b, 1, x[1]);
    for (int32_t k = b->first[at]; k < b->first[at + 1]; k++) {
        double w[3];
        brunt_background_weights(b, b->listed[k], x, w, NULL);
        const double least = fmin(w[0], fmin(w[1], w[2]));
        if (least > deepest) found = b->listed[k], deepest = least;
    }
    return found;
}

// Counts triangles into their squares, or with `list` writes them there.
static void list_triangles(brunt_background *b, bool list) {
    for (int32_t t = 0; t < b->triangle_count; t++) {
        int32_t from[2], to[2];
        for (int a = 0; a < 2; a++) {
            const double x[3] = {b->node[b->corner[t][0]][a], b->node[b->corner[t][1]][a], b->node[b->corner[t][2]][a]};
            const double low = fmin(x[0], fmin(x[1], x[2])), high = fmax(x[0], fmax(x[1], x[2]));
            from[a] = square_of(b, a, low - ROUNDING_SHARE * (high - low));
            to[a] = square_of(b, a, high + ROUNDING_SHARE * (high - low));
        }
        for (int32_t i = from[0]; i <= to[0]; i++)
            for (int32_t j = from[1]; j <= to[1]; j++) {
                const int64_t at = (int64_t)i * b->squares[1] + j;
                if (list)
                    b->listed[b->first[at]++] = t;
                else
                    b->first[at + 1]++;
            }
    }
}

// Squares of about a triangle each.
static int make_squares(brunt_background *b, brunt_error *error) {
    double high[2], area = 0;
    for (int a = 0; a < 2; a++) {
        b->low[a] = INFINITY, high[a] = -INFINITY;
        for (int32_t n = 0; n < b->node_count; n++)
            b->low[a] = fmin(b->low[a], b->node[n][a]), high[a] = fmax(high[a], b->node[n][a]);
    }
    for (int32_t n = 0; n < b->node_count; n++) area += b->area[n];
    const double width = high[0] - b->low[0], height = high[1] - b->low[1];
    b->square = fmax(sqrt(area / b->triangle_count), sqrt(width * height / (4.0 * b->triangle_count)));
    b->square = fmax(b->square, fmax(width, height) / (4.0 * b->triangle_count));
    b->squares[0] = (int32_t)floor(width / b->square) + 1, b->squares[1] = (int32_t)floor(height / b->square) + 1;
    const int64_t all = (int64_t)b->squares[0] * b->squares[1];
    if (BRUNT_NEW(b->first, all + 1, "squares of a background mesh", error)) return BRUNT_FAILED;
    list_triangles(b, false);
    for (int64_t k = 0; k < all; k++) b->first[k + 1] += b->first[k];
    if (BRUNT_NEW(b->listed, b->first[all] + 1, "squares of a background mesh", error)) return BRUNT_FAILED;
    list_triangles(b, true);
    memmove(b->first + 1, b->first, (size_t)all * sizeof *b->first);
    b->first[0] = 0;
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ edges

// An edge of a triangle: its ends in ascending order, the node across, and whether that is to the left of it.
typedef struct side {
    int32_t end[2], across, triangle;
    bool left;
} side;

static int compare_sides(const void *a, const void *b) {
    const side *p = a, *q = b;
    for (int k = 0; k < 2; k++)
        if (p->end[k] != q->end[k]) return p->end[k] < q->end[k] ? -1 : 1;
    return (p->across > q->across) - (p->across < q->across);
}

// Edges by the blocks of the nodes that they begin at.
static int list_edges(brunt_background *b, brunt_error *error) {
    const int32_t blocks = (b->node_count + BRUNT_BLOCK_NODES - 1) / BRUNT_BLOCK_NODES;
    if (BRUNT_NEW(b->edge_first, blocks + 1, "edges of a background mesh", error)) return BRUNT_FAILED;
    for (int32_t e = 0; e < b->edge_count; e++) b->edge_first[b->edge[e][0] / BRUNT_BLOCK_NODES + 1]++;
    for (int32_t k = 0; k < blocks; k++) b->edge_first[k + 1] += b->edge_first[k];
    return BRUNT_OK;
}

static int find_edges(brunt_background *b, brunt_error *error) {
    const int32_t count = 3 * b->triangle_count;
    side *sides;
    if (BRUNT_NEW(sides, count, "edges of a background mesh", error)) return BRUNT_FAILED;
    for (int32_t k = 0; k < count; k++) {
        const int32_t *corner = b->corner[k / 3], p = corner[(k + 1) % 3], q = corner[(k + 2) % 3];
        sides[k] = (side){{p < q ? p : q, p < q ? q : p}, corner[k % 3], k / 3, p < q};
    }
    qsort(sides, (size_t)count, sizeof *sides, compare_sides);
    int status = BRUNT_NEW(b->edge, count / 2 + 1, "edges of a background mesh", error);
    for (int32_t k = 0; !status && k + 1 < count; k++)
        if (sides[k].end[0] == sides[k + 1].end[0] && sides[k].end[1] == sides[k + 1].end[1]) {
            const int32_t nodes[4] = {sides[k].end[0], sides[k].end[1], sides[k].across, sides[k + 1].across};
            memcpy(b->edge[b->edge_count++], nodes, sizeof nodes);
            if (sides[k].left == sides[k + 1].left)
                status = brunt_fail(error, BRUNT_BAD_INPUT,
                                    "grid.cells.mesh: elements %d and %d lie on the same side of their edge: they "
                                    "overlap",
                                    sides[k].triangle + 1, sides[k + 1].triangle + 1);
        }
    brunt_free(sides);
    return status ? status : list_edges(b, error);
}

// ------------------------------------------------------------------------------------------ the whole

int brunt_background_make(brunt_background *b, const brunt_mesh *mesh, brunt_error *error) {
    *b = (brunt_background){.node_count = mesh->node_count, .triangle_count = mesh->element_count};
    if (BRUNT_NEW(b->node, b->node_count, "nodes of a background mesh", error) ||
        BRUNT_NEW(b->area, b->node_count, "nodes of a background mesh", error) ||
        BRUNT_NEW(b->corner, b->triangle_count, "triangles of a background mesh", error))
        return BRUNT_FAILED;
    for (int32_t n = 0; n < b->node_count; n++)
        for (int a = 0; a < 2; a++) b->node[n][a] = mesh->nodes[n][a];
    memcpy(b->corner, mesh->elements, (size_t)b->triangle_count * sizeof *b->corner);
    for (int32_t t = 0; t < b->triangle_count; t++) {
        const double *p = b->node[b->corner[t][0]], *q = b->node[b->corner[t][1]], *r = b->node[b->corner[t][2]];
        const double twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        for (int k = 0; k < 3; k++) b->area[b->corner[t][k]] += twice / 6;
    }
    return make_squares(b, error) ? BRUNT_FAILED : find_edges(b, error);
}

void brunt_background_free(brunt_background *b) {
    void *const all[] = {b->node, b->corner, b->area, b->edge, b->edge_first, b->first, b->listed};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) brunt_free(all[k]);
    *b = (brunt_background){.node_count = 0};
}
