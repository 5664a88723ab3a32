#include "boundary/facets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/vector.h"

enum { LEAF = 4, DEEP = 64, FOUND = 256 };
static const double ON = 1e-9; // of the range: so near the way to a place has no direction

// The nearest point of a part.
typedef struct found {
    int32_t part, feature[2]; // its corners that the point is between: an edge's, one twice; -1: it is within the part
    double at[3], d[3], square;
} found;

// ------------------------------------------------------------------------------------------ the tree

typedef struct sorted {
    double along;
    int32_t part;
} sorted;

static int compare(const void *a, const void *b) {
    const sorted *p = a, *q = b;
    return p->along != q->along ? (p->along < q->along ? -1 : 1) : (p->part > q->part) - (p->part < q->part);
}

static void add_part(const brunt_facets *f, int32_t part, struct brunt_facets_box *box) {
    for (int c = 0; c < f->dim; c++)
        for (int a = 0; a < 3; a++) {
            box->low[a] = fmin(box->low[a], f->point[f->corner[part][c]][a]);
            box->high[a] = fmax(box->high[a], f->point[f->corner[part][c]][a]);
        }
}

// Parts [first, end) in the order of their middles along the longest axis of their box.
static void order_parts(brunt_facets *f, const struct brunt_facets_box *box, sorted *list, int32_t (*copy)[3]) {
    int axis = 0;
    for (int a = 1; a < 3; a++)
        if (box->high[a] - box->low[a] > box->high[axis] - box->low[axis]) axis = a;
    const int32_t first = box->first, count = box->end - first;
    for (int32_t k = 0; k < count; k++) {
        list[k] = (sorted){0, k};
        for (int c = 0; c < f->dim; c++) list[k].along += f->point[f->corner[first + k][c]][axis];
        memcpy(copy[k], f->corner[first + k], sizeof *copy);
    }
    qsort(list, (size_t)count, sizeof *list, compare);
    for (int32_t k = 0; k < count; k++) memcpy(f->corner[first + k], copy[list[k].part], sizeof *copy);
}

// Boxes of parts [first, end): theirs, then those of the first half, then of the other.
static void make_boxes(brunt_facets *f, int32_t first, int32_t end, sorted *list, int32_t (*copy)[3]) {
    const int32_t at = f->box_count++;
    struct brunt_facets_box *box = &f->box[at];
    *box = (struct brunt_facets_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, first, end, 0};
    for (int32_t k = first; k < end; k++) add_part(f, k, box);
    if (end - first <= LEAF) return;
    order_parts(f, box, list, copy);
    const int32_t middle = first + (end - first) / 2;
    make_boxes(f, first, middle, list, copy);
    f->box[at].other = f->box_count;
    make_boxes(f, middle, end, list, copy);
}

// ------------------------------------------------------------------------------------------ making

static int take_parts(brunt_facets *f, const brunt_boundary_surface_def *def) {
    for (int32_t k = 0; k < def->facet_count; k++)
        for (int second = 0; second <= (f->dim == 3 && def->facet[k][3] >= 0); second++) {
            int32_t *corner = f->corner[f->count++];
            corner[0] = def->facet[k][0], corner[1] = def->facet[k][1 + second];
            corner[2] = f->dim == 3 ? def->facet[k][2 + second] : -1;
        }
    return BRUNT_OK;
}

static void find_normal(const brunt_facets *f, int32_t part, double n[3]) {
    static const double up[3] = {0, 0, 1};
    const int32_t *corner = f->corner[part];
    double e[2][3];
    less(f->point[corner[1]], f->point[corner[0]], e[0]);
    if (f->dim == 3)
        less(f->point[corner[2]], f->point[corner[0]], e[1]), cross(e[0], e[1], n);
    else
        cross(up, e[0], n);
    const double size = sqrt(dot(n, n));
    for (int a = 0; a < 3; a++) n[a] /= size;
}

int brunt_facets_make(brunt_facets *f, const brunt_boundary_surface_def *def, int dim, brunt_error *error) {
    const size_t parts = 2 * (size_t)def->facet_count;
    sorted *list = NULL;
    int32_t(*copy)[3] = NULL;
    *f = (brunt_facets){.dim = dim, .point_count = def->point_count};
    if (BRUNT_NEW(f->point, def->point_count, "corners of a boundary", error) ||
        BRUNT_NEW(f->corner, parts, "parts of a boundary", error) ||
        BRUNT_NEW(f->normal, parts, "normals of a boundary", error) ||
        BRUNT_NEW(f->box, 2 * parts, "boxes of a boundary", error))
        return BRUNT_FAILED;
    memcpy(f->point, def->point, (size_t)def->point_count * sizeof *f->point);
    take_parts(f, def);
    int status = BRUNT_NEW(list, parts, "parts of a boundary", error);
    if (!status) status = BRUNT_NEW(copy, parts, "parts of a boundary", error);
    if (!status) make_boxes(f, 0, f->count, list, copy);
    brunt_free(list), brunt_free(copy);
    for (int32_t k = 0; k < f->count && !status; k++) find_normal(f, k, f->normal[k]);
    for (int a = 0; a < 3 && !status; a++) f->low[a] = f->box[0].low[a], f->high[a] = f->box[0].high[a];
    return status;
}

void brunt_facets_free(brunt_facets *f) {
    brunt_free(f->point), brunt_free(f->corner), brunt_free(f->normal), brunt_free(f->box);
    *f = (brunt_facets){.count = 0};
}

size_t brunt_facets_bytes(const brunt_facets *f) {
    return (size_t)f->point_count * sizeof *f->point + (size_t)f->count * (sizeof *f->corner + sizeof *f->normal) +
           (size_t)f->box_count * sizeof *f->box;
}

void brunt_facets_validate(const brunt_facets *f) {
    for (int32_t b = 0; b < f->box_count; b++) {
        const struct brunt_facets_box *box = &f->box[b];
        BRUNT_ASSERT(box->first >= 0 && box->first < box->end && box->end <= f->count);
        BRUNT_ASSERT(box->other == 0 || (box->other > b && box->other < f->box_count));
    }
    for (int32_t k = 0; k < f->count; k++) BRUNT_ASSERT(fabs(dot(f->normal[k], f->normal[k]) - 1) < 1e-9);
}

// ------------------------------------------------------------------------------------------ nearest points

// On the edge from corner i to corner j of a part.
static void nearest_on_edge(const brunt_facets *f, int i, int j, const double x[3], found *out) {
    const int32_t *corner = f->corner[out->part];
    const double *p = f->point[corner[i]], *q = f->point[corner[j]];
    double e[3], r[3], square = 0;
    less(q, p, e), less(x, p, r);
    const double share = fmax(0, fmin(1, dot(e, r) / dot(e, e)));
    found here = {.part = out->part};
    here.feature[0] = share < 1 ? corner[i] : corner[j], here.feature[1] = share > 0 ? corner[j] : corner[i];
    if (here.feature[0] > here.feature[1]) {
        const int32_t kept = here.feature[0];
        here.feature[0] = here.feature[1], here.feature[1] = kept;
    }
    if (f->dim == 2 && share > 0 && share < 1) here.feature[0] = here.feature[1] = -1;
    for (int a = 0; a < 3; a++) {
        here.at[a] = share == 0 ? p[a] : share == 1 ? q[a] : p[a] + share * e[a];
        here.d[a] = x[a] - here.at[a], square += here.d[a] * here.d[a];
    }
    here.square = square;
    if (square < out->square) *out = here;
}

// Whether x is right before or behind the triangle; how high above its plane.
static bool is_above(const brunt_facets *f, int32_t part, const double x[3], double *height) {
    const int32_t *corner = f->corner[part];
    const double *n = f->normal[part];
    double e[3], r[3], out[3];
    for (int k = 0; k < 3; k++) {
        less(f->point[corner[(k + 1) % 3]], f->point[corner[k]], e), less(x, f->point[corner[k]], r);
        cross(e, r, out);
        if (k == 0) *height = dot(r, n);
        if (!(dot(out, n) > 0)) return false;
    }
    return true;
}

static found nearest_on_part(const brunt_facets *f, int32_t part, const double x[3]) {
    found out = {.part = part, .feature = {-1, -1}, .square = INFINITY};
    double height;
    if (f->dim == 3 && is_above(f, part, x, &height)) {
        for (int a = 0; a < 3; a++) out.d[a] = height * f->normal[part][a], out.at[a] = x[a] - out.d[a];
        out.square = height * height;
        return out;
    }
    for (int k = 0; k < (f->dim == 3 ? 3 : 1); k++) nearest_on_edge(f, k, (k + 1) % f->dim, x, &out);
    return out;
}

// ------------------------------------------------------------------------------------------ edges and corners

static bool same_feature(const found *a, const found *b) {
    return a->feature[0] == b->feature[0] && a->feature[1] == b->feature[1];
}

static bool has_corner(const brunt_facets *f, int32_t part, int32_t corner) {
    for (int c = 0; c < f->dim; c++)
        if (f->corner[part][c] == corner) return true;
    return false;
}

static double angle_at(const brunt_facets *f, int32_t part, int32_t corner) {
    int c = 0;
    while (f->corner[part][c] != corner) c++;
    double a[3], b[3];
    less(f->point[f->corner[part][(c + 1) % 3]], f->point[corner], a);
    less(f->point[f->corner[part][(c + 2) % 3]], f->point[corner], b);
    return acos(fmax(-1, fmin(1, dot(a, b) / sqrt(dot(a, a) * dot(b, b)))));
}

// Whether an edge of a part at `corner` is no other part's.
static bool ends_at(const brunt_facets *f, const found *list, int count, int32_t part, int32_t corner) {
    for (int c = 0; c < 3; c++) {
        const int32_t beside = f->corner[part][c];
        int others = 0;
        if (beside == corner) continue;
        for (int k = 0; k < count; k++)
            others +=
                list[k].part != part && has_corner(f, list[k].part, corner) && has_corner(f, list[k].part, beside);
        if (!others) return true;
    }
    return false;
}

// Whether all parts that share the feature of list[at] have their nearest point there, of which it is the first; their
// mean normal, and whether the surface ends there.
static bool is_nearest(const brunt_facets *f, const found *list, int count, int at, double n[3], bool *rim) {
    const found *one = &list[at];
    const bool corner = one->feature[0] == one->feature[1];
    int sharing = 0;
    memset(n, 0, 3 * sizeof *n);
    *rim = false;
    for (int k = 0; k < count; k++) {
        const int32_t part = list[k].part;
        if (!has_corner(f, part, one->feature[0]) || !has_corner(f, part, one->feature[1])) continue;
        if (!same_feature(one, &list[k]) || k < at) return false;
        const double weight = f->dim == 3 && corner ? angle_at(f, part, one->feature[0]) : 1;
        for (int a = 0; a < 3; a++) n[a] += weight * f->normal[part][a];
        if (f->dim == 3 && corner) *rim = *rim || ends_at(f, list, count, part, one->feature[0]);
        sharing++;
    }
    const double size = sqrt(dot(n, n));
    for (int a = 0; a < 3 && size > 0; a++) n[a] /= size;
    if (f->dim == 2 || !corner) *rim = sharing == 1;
    return size > 0;
}

// The place of list[at], if it is one.
static bool make_touch(const brunt_facets *f, const found *list, int count, int at, double range, brunt_touch *out) {
    const found *one = &list[at];
    double n[3];
    *out = (brunt_touch){.distance = 0};
    memcpy(n, f->normal[one->part], sizeof n);
    if (one->feature[0] >= 0 && !is_nearest(f, list, count, at, n, &out->rim)) return false;
    const double size = sqrt(one->square);
    const double side = dot(one->d, n) < 0 ? -1 : 1;
    const bool plain = one->feature[0] < 0 || size < ON * range;
    out->distance = plain ? dot(one->d, n) : side * size;
    for (int a = 0; a < 3; a++) out->normal[a] = plain ? n[a] : side * one->d[a] / size, out->at[a] = one->at[a];
    return true;
}

// ------------------------------------------------------------------------------------------ the search

static bool is_far(const struct brunt_facets_box *box, const double x[3], double range) {
    double square = 0;
    for (int a = 0; a < 3; a++) {
        const double below = box->low[a] - x[a], above = x[a] - box->high[a],
                     away = below > 0   ? below
                            : above > 0 ? above
                                        : 0;
        square += away * away;
    }
    return square > range * range;
}

static bool is_off_plane(const brunt_facets *f, int32_t part, const double x[3], double range) {
    const double *p = f->point[f->corner[part][0]], *n = f->normal[part];
    const double height = (x[0] - p[0]) * n[0] + (x[1] - p[1]) * n[1] + (x[2] - p[2]) * n[2];
    return height > range || height < -range;
}

// Those that are not farther than `range`; FOUND: there may be more.
static int32_t list_parts(const brunt_facets *f, const double x[3], double range, found list[FOUND]) {
    int32_t stack[DEEP], count = 0;
    int depth = 0;
    stack[depth++] = 0;
    while (depth) {
        const struct brunt_facets_box *box = &f->box[stack[--depth]];
        if (is_far(box, x, range)) continue;
        if (box->other) {
            stack[depth++] = box->other, stack[depth++] = (int32_t)(box - f->box) + 1;
            continue;
        }
        for (int32_t k = box->first; k < box->end && count < FOUND; k++) {
            if (is_off_plane(f, k, x, range)) continue;
            list[count] = nearest_on_part(f, k, x);
            count += list[count].square <= range * range;
        }
    }
    return count;
}

bool brunt_facets_are_far(const brunt_facets *f, const double x[3], double range) {
    found list[FOUND];
    return list_parts(f, x, range, list) == 0;
}

int brunt_facets_near(const brunt_facets *f, const double x[3], double range, brunt_touch *out) {
    found list[FOUND];
    int32_t parts = list_parts(f, x, range, list);
    while (parts == FOUND) range /= 2, parts = list_parts(f, x, range, list); // of fine ones the nearest
    int count = 0;
    for (int32_t k = 0; k < parts && count < BRUNT_TOUCH_LIMIT; k++)
        count += make_touch(f, list, parts, k, range, &out[count]);
    return count;
}
