// Structured meshes of boxes whose elements grow along the axes: fine where something happens, coarse where nothing
// does.
//
// With g(x) the factor on the edge length, an axis has N = int dx / (size g) elements, rounded to a whole number n, and
// its nodes lie where the integral is k N / n. g is linear between its points and constant beyond them, so that both
// the integral and its inverse are closed: int_0^x dx / (g0 + m x) = ln(1 + m x / g0) / m.
#include "brunt.h"
#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { NODE_LIMIT = 100000000 }; // as of other meshes of shapes

// A stretch of an axis: from x [m] on, over length [m], the factor goes from g0 to g1; `count` elements before its
// start.
typedef struct stretch {
    double x, length, g0, g1, before;
} stretch;

static double factor_at(const brunt_curve *g, double x) {
    const double(*p)[2] = (const double(*)[2])g->points;
    if (!g->count) return 1;
    if (x <= p[0][0]) return p[0][1];
    for (int32_t k = 0; k + 1 < g->count; k++)
        if (x <= p[k + 1][0]) return p[k][1] + (p[k + 1][1] - p[k][1]) * ((x - p[k][0]) / (p[k + 1][0] - p[k][0]));
    return p[g->count - 1][1];
}

static double elements_of(const stretch *s, double size, double along) {
    const double slope = (s->g1 - s->g0) / s->length;
    if (fabs(s->g1 - s->g0) < 1e-12 * s->g0) return along / (size * s->g0);
    return log1p(slope * along / s->g0) / (size * slope);
}

static double place_of(const stretch *s, double size, double elements) {
    const double slope = (s->g1 - s->g0) / s->length;
    if (fabs(s->g1 - s->g0) < 1e-12 * s->g0) return s->x + elements * size * s->g0;
    return s->x + s->g0 * expm1(elements * size * slope) / slope;
}

// Cuts [low, high] at the points of the curve. Returns how many stretches there are; `elements`: of all.
static int32_t cut(const brunt_curve *g, double low, double high, double size, stretch *out, double *elements) {
    int32_t count = 0;
    double from = low;
    *elements = 0;
    for (int32_t k = 0; k <= g->count && from < high; k++) {
        double to = k < g->count ? g->points[k][0] : high;
        if (to > high) to = high;
        if (!(to > from)) continue;
        out[count] = (stretch){from, to - from, factor_at(g, from), factor_at(g, to), *elements};
        *elements += elements_of(&out[count], size, to - from);
        from = to;
        count++;
    }
    return count;
}

// Nodes of an axis: *count elements, their ends ascending in new memory; none when there are NODE_LIMIT or more of
// them.
static int divide(const brunt_curve *g, double low, double high, double size, int32_t *count, double **nodes,
                  brunt_error *error) {
    double elements;
    stretch *stretches;
    if (BRUNT_NEW(stretches, g->count + 2, "stretches of a graded axis", error)) return BRUNT_FAILED;
    const int32_t n = cut(g, low, high, size, stretches, &elements);
    *count = elements < 1 ? 1 : elements < NODE_LIMIT ? (int32_t)round(elements) : NODE_LIMIT;
    if (*count == NODE_LIMIT) {
        brunt_free(stretches);
        return BRUNT_OK;
    }
    const int status = BRUNT_NEW(*nodes, *count + 1, "nodes of a graded axis", error);
    for (int32_t k = 0, at = 0; !status && k <= *count; k++) {
        double wanted = elements * k / *count;
        while (at + 1 < n && stretches[at + 1].before <= wanted) at++;
        (*nodes)[k] = k == 0 ? low : k == *count ? high : place_of(&stretches[at], size, wanted - stretches[at].before);
    }
    brunt_free(stretches);
    return status;
}

static int check(const brunt_shape *box, int dimension, double size, const brunt_curve grading[3], brunt_error *error) {
    if (box->kind != BRUNT_BOX) return brunt_fail(error, BRUNT_BAD_INPUT, "grading: only a box can be graded");
    if (!(size > 0) || !isfinite(size))
        return brunt_fail(error, BRUNT_BAD_INPUT, "an edge length of %g m, a positive one is wanted", size);
    for (int a = 0; a < dimension; a++) {
        const double extent = box->max[a] - box->min[a];
        if (!(extent > 0) || !isfinite(extent))
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "the extent of a shape to be meshed is %g m, a positive length is wanted", extent);
        for (int32_t k = 0; k < grading[a].count; k++) {
            const double *p = grading[a].points[k];
            if (!(p[1] > 0) || !isfinite(p[1]) || !isfinite(p[0]) || (k && !(p[0] > grading[a].points[k - 1][0])))
                return brunt_fail(error, BRUNT_BAD_INPUT,
                                  "grading.%c: factors above 0 at ascending places are wanted, not %g at %g m",
                                  "xyz"[a], p[1], p[0]);
        }
    }
    return BRUNT_OK;
}

int brunt_mesh_graded(const brunt_shape *box, int dimension, brunt_element_kind kind, double size,
                      const brunt_curve grading[3], brunt_mesh *mesh, brunt_error *error) {
    *mesh = (brunt_mesh){0};
    int status = check(box, dimension, size, grading, error);
    // The mesh of a box of unit elements, then every layer of nodes to its place.
    brunt_shape units = {.kind = BRUNT_BOX};
    double *nodes[3] = {NULL, NULL, NULL}, all = 1;
    for (int a = 0; a < dimension && !status; a++) {
        int32_t count = 0;
        status = divide(&grading[a], box->min[a], box->max[a], size, &count, &nodes[a], error);
        units.max[a] = count;
        all *= count + 1.0;
    }
    if (!status && !(all < NODE_LIMIT))
        status = brunt_fail(error, BRUNT_BAD_INPUT,
                            "an edge length of %g m makes more than 100 million nodes of this shape", size);
    if (!status) status = brunt_mesh_shape(&units, dimension, kind, 1, mesh, error);
    for (int32_t n = 0; !status && n < mesh->node_count; n++)
        for (int a = 0; a < dimension; a++) mesh->nodes[n][a] = nodes[a][(int32_t)round(mesh->nodes[n][a])];
    for (int a = 0; a < 3; a++) brunt_free(nodes[a]);
    return status;
}
