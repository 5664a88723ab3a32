// Surfaces that hold material points are cut into pieces, with boundary particles on them.
//
// Facets that meet without an edge are a region, together with small ones beside it. Its particles are parts of its
// triangles, each in 4^k; it is cut in two across its greatest extent, and the halves again, until as many pieces are
// there as its area has room for. A turn of a radian counts as the length of a piece, so that the two sides of a thin
// body are not one. Regions, directions and pieces follow from the surface, not from how it is cut into triangles, nor
// from where the grid is.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vector.h"
#include "boundary/boundary_pieces.h"

static const double FINE = 1.5;  // edges of parts of triangles, of the wanted distance of particles
static const double FULL = 0.9;  // of the rectangle around a region: one that fills it is cut as a rectangle
static const double SAME = 1e-6; // pieces: places that are not told apart
static const double FOLDS = 0.5; // cosine of the turn between facets at a corner that do not go on into each other
static const double PLAIN = 0.5; // of a region's normals: their mean is its direction
static const double SIDES = 0.1; // of a region's border: it has sides across each other

typedef struct triangle {
    int32_t corner[3], facet, region;
    double normal[3], area; // [m^2]
    double bend[3][3];      // of each edge: how the normal is other there, half way to the next one's
    double around[3][3];    // of each corner: the mean normal of what goes on there without an edge
} triangle;

// Of a triangle, from `low` to `high` if it is forward.
typedef struct border {
    int32_t low, high, triangle;
    int side;
    bool forward;
} border;

typedef struct region {
    double axis[3][3], normal[3], area, low[3], high[3];
    double turn[2], length; // of its border: sum of the directions, four times turned, and of the lengths
    int32_t first, end;     // particles
} region;

// A particle where it is sorted: its place along the axis, then along the others.
typedef struct sorted {
    int64_t key[3];
    int32_t particle;
} sorted;

typedef struct cutter {
    brunt_boundary_surface *s;
    const brunt_boundary_surface_def *def;
    triangle *triangle;
    border *border;
    region *region;
    brunt_boundary_particle *particle;
    sorted *order;
    int32_t triangles, particles;
    double size; // [m] of a piece
} cutter;

static const double *corner_of(const cutter *c, int32_t t, int k) { return c->def->point[c->triangle[t].corner[k]]; }

// ------------------------------------------------------------------------------------------ triangles

// How many parts an edge of a triangle is cut into.
static int32_t parts_of(const cutter *c, int32_t t) {
    const double wanted = FINE * c->s->cell / c->def->particles * (1 + SAME);
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = corner_of(c, t, k), *b = corner_of(c, t, (k + 1) % 3);
        longest = fmax(longest, hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]));
    }
    int32_t parts = 1;
    while (longest > wanted * parts && parts < 1 << 14) parts *= 2;
    return parts;
}

static int add_triangle(cutter *c, int32_t facet, int second, brunt_error *error) {
    const int32_t *corner = c->def->facet[facet];
    triangle *t = &c->triangle[c->triangles];
    double e[2][3];
    *t = (triangle){{corner[0], corner[1 + second], corner[2 + second]}, .facet = facet, .region = c->triangles};
    const double *a = c->def->point[t->corner[0]];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++) e[i][k] = c->def->point[t->corner[1 + i]][k] - a[k];
    cross(e[0], e[1], t->normal);
    const double size = sqrt(dot(t->normal, t->normal));
    if (!(size > 1e-12 * (dot(e[0], e[0]) + dot(e[1], e[1]))))
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "boundaries (%s).mesh: facet %d at (%g, %g, %g) has no area: its corners are on a line",
                          c->s->boundary->name, facet + 1, a[0], a[1], a[2]);
    t->area = 0.5 * size;
    for (int k = 0; k < 3; k++) t->normal[k] /= size;
    c->triangles++;
    return BRUNT_OK;
}

static int add_triangles(cutter *c, brunt_error *error) {
    double particles = 0;
    for (int32_t f = 0; f < c->def->facet_count; f++)
        for (int second = 0; second <= (c->def->facet[f][3] >= 0); second++) {
            BRUNT_TRY(add_triangle(c, f, second, error));
            particles += pow(parts_of(c, c->triangles - 1), 2);
        }
    if (particles < BRUNT_BOUNDARY_PARTICLE_LIMIT) {
        c->particles = (int32_t)particles;
        return BRUNT_OK;
    }
    return brunt_fail(
        error, BRUNT_BAD_INPUT,
        "boundaries (%s).mesh: %g boundary particles, of which a cell has %d along its edges, are too many",
        c->s->boundary->name, particles, c->def->particles);
}

// ------------------------------------------------------------------------------------------ borders

static int compare_borders(const void *a, const void *b) {
    const border *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static void list_borders(cutter *c) {
    for (int32_t t = 0; t < c->triangles; t++)
        for (int k = 0; k < 3; k++) {
            const int32_t a = c->triangle[t].corner[k], b = c->triangle[t].corner[(k + 1) % 3];
            c->border[3 * t + k] = (border){a < b ? a : b, a < b ? b : a, t, k, a < b};
        }
    qsort(c->border, (size_t)c->triangles * 3, sizeof *c->border, compare_borders);
}

// How many triangles have the edge at `first`.
static int32_t sharing(const cutter *c, int32_t first) {
    int32_t end = first;
    while (end < 3 * c->triangles && c->border[end].low == c->border[first].low &&
           c->border[end].high == c->border[first].high)
        end++;
    return end - first;
}

static int32_t region_of(triangle *t, int32_t k) {
    while (t[k].region != k) k = t[k].region = t[t[k].region].region;
    return k;
}

static void unite(cutter *c, int32_t one, int32_t other) {
    const int32_t r = region_of(c->triangle, one), s = region_of(c->triangle, other);
    c->triangle[r > s ? r : s].region = r > s ? s : r;
}

static void bend_edge(const cutter *c, const border *mine, const border *other) {
    triangle *t = &c->triangle[mine->triangle];
    const double *n = t->normal, *m = c->triangle[other->triangle].normal, size = sqrt(2 + 2 * dot(n, m));
    for (int k = 0; k < 3; k++) t->bend[mine->side][k] = (n[k] + m[k]) / size - n[k];
}

// Triangles that meet without an edge are of one region, which is that of the first of them.
static int join(cutter *c, brunt_error *error) {
    for (int32_t e = 0, count; e < 3 * c->triangles; e += count) {
        const border *p = &c->border[e], *q = p + 1;
        if ((count = sharing(c, e)) != 2) continue;
        const triangle *a = &c->triangle[p->triangle], *b = &c->triangle[q->triangle];
        const double *x = c->def->point[p->low];
        if (p->forward == q->forward)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "boundaries (%s).mesh: facets %d and %d turn against each other at (%g, %g, %g): the "
                              "corners of all go round the same way, so that their normals are on one side",
                              c->s->boundary->name, a->facet + 1, b->facet + 1, x[0], x[1], x[2]);
        if (dot(a->normal, b->normal) <= BRUNT_BOUNDARY_CORNER) continue;
        unite(c, p->triangle, q->triangle);
        bend_edge(c, p, q), bend_edge(c, q, p);
    }
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ normals of corners

static double angle_at(const cutter *c, int32_t t, int k) {
    const double *x = corner_of(c, t, k), *y = corner_of(c, t, (k + 1) % 3), *z = corner_of(c, t, (k + 2) % 3);
    double a[3], b[3];
    for (int i = 0; i < 3; i++) a[i] = y[i] - x[i], b[i] = z[i] - x[i];
    return acos(fmax(-1, fmin(1, dot(a, b) / sqrt(dot(a, a) * dot(b, b)))));
}

static int compare_sorted(const void *a, const void *b);

// Means of the normals around each corner, by the angles there, of triangles of one region that do not fold.
static int find_corners(cutter *c, brunt_error *error) {
    const int32_t count = 3 * c->triangles;
    sorted *list;
    if (BRUNT_NEW(list, count, "corners of a boundary", error)) return BRUNT_FAILED;
    for (int32_t i = 0; i < count; i++) {
        const triangle *t = &c->triangle[i / 3];
        list[i] = (sorted){{t->corner[i % 3], region_of(c->triangle, i / 3)}, i};
    }
    qsort(list, (size_t)count, sizeof *list, compare_sorted);
    for (int32_t first = 0, end; first < count; first = end) {
        for (end = first; end < count && !memcmp(list[end].key, list[first].key, sizeof list->key);) end++;
        for (int32_t i = first; i < end; i++) {
            triangle *t = &c->triangle[list[i].particle / 3];
            double *n = t->around[list[i].particle % 3], square = 0;
            for (int32_t j = first; j < end; j++) {
                const int32_t other = list[j].particle / 3;
                const double *m = c->triangle[other].normal, weight = angle_at(c, other, list[j].particle % 3);
                for (int k = 0; k < 3 && dot(m, t->normal) > FOLDS; k++) n[k] += weight * m[k];
            }
            for (int k = 0; k < 3; k++) square += n[k] * n[k];
            for (int k = 0; k < 3; k++) n[k] /= sqrt(square);
        }
    }
    brunt_free(list);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ regions

// Directions of a region: its mean normal and two across it, from an axis of space; of one that turns much, of space.
static void take_axes(region *r) {
    const double size = sqrt(dot(r->normal, r->normal));
    int least = 0;
    memset(r->axis, 0, sizeof r->axis);
    for (int k = 0; k < 3; k++) r->axis[k][k] = 1;
    if (!(size > PLAIN * r->area)) return;
    double n[3];
    for (int k = 0; k < 3; k++) n[k] = r->normal[k] / size;
    for (int k = 1; k < 3; k++)
        if (fabs(n[k]) < fabs(n[least]) - SAME) least = k;
    for (int k = 0; k < 3; k++) r->axis[0][k] = (k == least) - n[least] * n[k];
    const double length = sqrt(dot(r->axis[0], r->axis[0]));
    for (int k = 0; k < 3; k++) r->axis[0][k] /= length, r->axis[2][k] = n[k];
    cross(r->axis[2], r->axis[0], r->axis[1]);
}

// An edge of its border, with directions that are a quarter of a turn apart counted as one.
static void add_side(region *r, const double *a, const double *b) {
    const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double x = dot(d, r->axis[0]), y = dot(d, r->axis[1]), size = hypot(x, y);
    if (!(size > 0)) return;
    const double angle = 4 * atan2(y, x);
    r->turn[0] += size * cos(angle), r->turn[1] += size * sin(angle), r->length += size;
}

static void turn_axes(region *r) {
    if (!(r->length > 0) || hypot(r->turn[0], r->turn[1]) < SIDES * r->length) return;
    const double angle = atan2(r->turn[1], r->turn[0]) / 4, x = cos(angle), y = sin(angle);
    for (int k = 0; k < 3; k++) {
        const double a = r->axis[0][k], b = r->axis[1][k];
        r->axis[0][k] = x * a + y * b, r->axis[1][k] = x * b - y * a;
    }
}

static void measure_regions(cutter *c) {
    memset(c->region, 0, (size_t)c->triangles * sizeof *c->region);
    for (int32_t t = 0; t < c->triangles; t++) c->triangle[t].region = region_of(c->triangle, t);
    for (int32_t t = 0; t < c->triangles; t++) {
        region *r = &c->region[c->triangle[t].region];
        for (int k = 0; k < 3; k++) r->normal[k] += c->triangle[t].area * c->triangle[t].normal[k];
        r->area += c->triangle[t].area;
    }
    for (int32_t t = 0; t < c->triangles; t++) take_axes(&c->region[t]);
    for (int32_t e = 0, count; e < 3 * c->triangles; e += count) {
        count = sharing(c, e);
        for (int32_t i = e; i < e + count; i++) {
            const int32_t mine = c->triangle[c->border[i].triangle].region;
            bool within = false;
            for (int32_t j = e; j < e + count; j++)
                within = within || (i != j && c->triangle[c->border[j].triangle].region == mine);
            const double *low = c->def->point[c->border[e].low], *high = c->def->point[c->border[e].high];
            if (!within) add_side(&c->region[mine], low, high);
        }
    }
    for (int32_t t = 0; t < c->triangles; t++) {
        region *r = &c->region[t];
        turn_axes(r);
        for (int k = 0; k < 3; k++) r->low[k] = INFINITY, r->high[k] = -INFINITY;
    }
    for (int32_t t = 0; t < c->triangles; t++)
        for (int k = 0; k < 9; k++) {
            region *r = &c->region[c->triangle[t].region];
            const double along = dot(corner_of(c, t, k / 3), r->axis[k % 3]);
            r->low[k % 3] = fmin(r->low[k % 3], along), r->high[k % 3] = fmax(r->high[k % 3], along);
        }
}

// Extents of a region, the greatest first.
static void extents(const region *r, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = r->high[k] - r->low[k];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++)
            if (out[i] < out[i + 1]) {
                const double keep = out[i];
                out[i] = out[i + 1], out[i + 1] = keep;
            }
}

static bool is_small(const cutter *c, const region *r) {
    double extent[3];
    extents(r, extent);
    return r->area > 0 && r->area < BRUNT_BOUNDARY_SHORT * c->size * extent[0];
}

// With which region each shares its longest border, and how long that is.
typedef struct beside {
    int32_t region;
    double length;
} beside;

// Regions too narrow for pieces of their own go to those that they have the longest edge with. Whether there were any.
static bool unite_small(cutter *c, beside *best) {
    bool any = false;
    for (int32_t t = 0; t < c->triangles; t++) best[t] = (beside){-1, 0};
    for (int32_t e = 0, count; e < 3 * c->triangles; e += count) {
        if ((count = sharing(c, e)) < 2) continue;
        const double *a = c->def->point[c->border[e].low], *b = c->def->point[c->border[e].high];
        const double length = hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
        for (int32_t i = 0; i < count; i++) {
            const int32_t mine = c->triangle[c->border[e + i].triangle].region,
                          other = c->triangle[c->border[e + (i + 1) % count].triangle].region;
            if (mine != other && length > best[mine].length * (1 + SAME)) best[mine] = (beside){other, length};
        }
    }
    for (int32_t t = 0; t < c->triangles; t++)
        if (best[t].region >= 0 && is_small(c, &c->region[t])) unite(c, t, best[t].region), any = true;
    return any;
}

static int find_regions(cutter *c, brunt_error *error) {
    enum { ROUNDS = 40 };
    beside *best;
    if (BRUNT_NEW(best, c->triangles, "regions of a boundary", error)) return BRUNT_FAILED;
    measure_regions(c);
    for (int round = 0; round < ROUNDS && unite_small(c, best); round++) measure_regions(c);
    brunt_free(best);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ particles

// The normal at a place of a triangle, by its shares of the corners: of one that is small beside a piece it goes evenly
// from corner to corner; on others it turns within half a piece of the edges where they go on.
static void normal_at(const cutter *c, int32_t t, const double share[3], double n[3]) {
    const triangle *of = &c->triangle[t];
    double length[3], round = 0, square = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = corner_of(c, t, k), *b = corner_of(c, t, (k + 1) % 3);
        round += length[k] = hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
    }
    const double inner = 2 * of->area / round, reach = 0.5 * c->size;
    const bool small = inner < reach;
    for (int a = 0; a < 3; a++) {
        n[a] = of->normal[a];
        for (int k = 0; k < 3 && small; k++) n[a] += share[k] * (of->around[k][a] - of->normal[a]);
    }
    for (int k = 0; k < 3 && !small; k++) {
        const double away = share[(k + 2) % 3] * 2 * of->area / length[k], near = fmax(0, 1 - away / reach);
        for (int a = 0; a < 3; a++) n[a] += near * of->bend[k][a];
    }
    for (int a = 0; a < 3; a++) square += n[a] * n[a];
    for (int a = 0; a < 3; a++) n[a] /= sqrt(square);
}

static void add_particles(cutter *c, int32_t t) {
    const triangle *of = &c->triangle[t];
    const int32_t parts = parts_of(c, t);
    const double *a = corner_of(c, t, 0), *b = corner_of(c, t, 1), *d = corner_of(c, t, 2);
    for (int32_t i = 0; i < parts; i++)
        for (int32_t j = 0; j < parts - i; j++)
            for (int down = 0; down <= (i + j < parts - 1); down++) {
                brunt_boundary_particle *p = &c->particle[c->particles++];
                const double third = (1 + down) / 3.0, v = (i + third) / parts, w = (j + third) / parts;
                p->weight = of->area / parts / parts, p->piece = of->region;
                for (int k = 0; k < 3; k++) p->x[k] = a[k] + v * (b[k] - a[k]) + w * (d[k] - a[k]);
                normal_at(c, t, (const double[3]){1 - v - w, v, w}, p->normal);
            }
}

static int compare_sorted(const void *a, const void *b) {
    const sorted *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->key[k] != q->key[k]) return p->key[k] < q->key[k] ? -1 : 1;
    return (p->particle > q->particle) - (p->particle < q->particle);
}

// Particles follow each other by regions.
static void sort_regions(cutter *c) {
    c->particles = 0;
    for (int32_t t = 0; t < c->triangles; t++) add_particles(c, t);
    for (int32_t p = 0; p < c->particles; p++) c->order[p] = (sorted){{c->particle[p].piece}, p};
    qsort(c->order, (size_t)c->particles, sizeof *c->order, compare_sorted);
    for (int32_t p = 0; p < c->particles; p++) {
        region *r = &c->region[c->order[p].key[0]];
        if (r->end == 0) r->first = p;
        r->end = p + 1;
    }
}

// ------------------------------------------------------------------------------------------ pieces

// A particle's place along axis k of a region, then how its normal turns along it, as a length.
static double place_of(const cutter *c, const region *r, int32_t particle, int k) {
    const brunt_boundary_particle *p = &c->particle[particle];
    return k < 3 ? dot(p->x, r->axis[k]) : c->size * dot(p->normal, r->axis[k - 3]);
}

// The axis of greatest extent, and that; the area.
static int widest(const cutter *c, const region *r, int32_t first, int32_t end, double *extent, double *area) {
    int best = 0;
    *extent = *area = 0;
    for (int32_t i = first; i < end; i++) *area += c->particle[c->order[i].particle].weight;
    for (int k = 0; k < 6; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t i = first; i < end; i++) {
            const double at = place_of(c, r, c->order[i].particle, k);
            low = fmin(low, at), high = fmax(high, at);
        }
        if (high - low > *extent * (1 + SAME) + SAME * c->size) best = k, *extent = high - low;
    }
    *extent += sqrt(*area / (end - first)); // particles are in the middle of what they stand for
    return best;
}

static void sort_along(cutter *c, const region *r, int32_t first, int32_t end, int axis) {
    for (int32_t i = first; i < end; i++)
        for (int k = 0; k < 3; k++) {
            const int along = k == 0 ? axis : (axis + k) % 3;
            const double at = place_of(c, r, c->order[i].particle, along);
            c->order[i].key[k] = (int64_t)floor(at / (SAME * c->size) + 0.37); // no particle is there by design
        }
    qsort(c->order + first, (size_t)(end - first), sizeof *c->order, compare_sorted);
}

static double weight_of(const cutter *c, int32_t i) { return c->particle[c->order[i].particle].weight; }

// Where so much of the area ends.
static int32_t divide(const cutter *c, int32_t first, int32_t end, double wanted) {
    double sum = 0;
    int32_t i = first;
    for (; i < end - 1; i++) {
        if (i > first && sum + 0.5 * weight_of(c, i) > wanted) break;
        sum += weight_of(c, i);
    }
    return i;
}

// Where normals are half way from the first to the last; the share of the area before that.
static int32_t divide_turn(const cutter *c, int32_t first, int32_t end, double *share) {
    const int64_t half = c->order[first].key[0] + (c->order[end - 1].key[0] - c->order[first].key[0]) / 2;
    double before = 0, all = 0;
    int32_t middle = first;
    for (int32_t i = first; i < end; i++) {
        if (c->order[i].key[0] <= half) middle = i + 1, before += weight_of(c, i);
        all += weight_of(c, i);
    }
    *share = before / all;
    return middle;
}

// Directions across the normals of a piece: those of its mean normal, turned as little as can be.
static void take_tangents(cutter *c, const region *r, int32_t first, int32_t end) {
    double n[3] = {0, 0, 0}, t[2][3];
    for (int32_t i = first; i < end; i++)
        for (int k = 0; k < 3; k++)
            n[k] += c->particle[c->order[i].particle].weight * c->particle[c->order[i].particle].normal[k];
    const double size = sqrt(dot(n, n));
    for (int k = 0; k < 3; k++) n[k] = size > 0 ? n[k] / size : r->axis[2][k];
    const int from = fabs(dot(n, r->axis[0])) < 0.8 ? 0 : 1;
    for (int k = 0; k < 3; k++) t[0][k] = r->axis[from][k] - dot(n, r->axis[from]) * n[k];
    const double length = sqrt(dot(t[0], t[0]));
    for (int k = 0; k < 3; k++) t[0][k] /= length;
    cross(n, t[0], t[1]);
    for (int32_t i = first; i < end; i++) {
        brunt_boundary_particle *p = &c->particle[c->order[i].particle];
        const double both = 1 + dot(n, p->normal);
        for (int a = 0; a < 2; a++) {
            const double share = both > SAME ? dot(t[a], p->normal) / both : 0;
            for (int k = 0; k < 3; k++) p->tangent[a][k] = t[a][k] - share * (n[k] + p->normal[k]);
        }
    }
}

static void cut(cutter *c, const region *r, int32_t first, int32_t end, int32_t pieces) {
    brunt_boundary_surface *s = c->s;
    if (pieces <= 1 || end - first <= 1) {
        take_tangents(c, r, first, end);
        for (int32_t i = first; i < end; i++) c->particle[c->order[i].particle].piece = s->pieces;
        s->first[++s->pieces] = end;
        return;
    }
    double extent, area;
    const int axis = widest(c, r, first, end, &extent, &area);
    const double columns = fmin(pieces, fmax(2, round(extent / sqrt(area / pieces))));
    double share = floor(columns / 2) / columns;
    int32_t middle = 0;
    sort_along(c, r, first, end, axis);
    if (axis >= 3) middle = divide_turn(c, first, end, &share);
    const int32_t left = (int32_t)fmin(pieces - 1, fmax(1, round(pieces * share)));
    if (axis < 3) middle = divide(c, first, end, area * left / pieces);
    cut(c, r, first, middle, left);
    cut(c, r, middle, end, pieces - left);
}

// As many as the wanted size goes into the area, or, of a rectangle, into its edges; into its length at least.
static int32_t pieces_of(const cutter *c, const region *r) {
    double extent[3];
    const double room = c->size * c->size;
    extents(r, extent);
    const double full = r->area / (extent[0] * extent[1]), along = fmax(1, floor(extent[0] / c->size + SAME)),
                 across = fmax(1, floor(extent[1] / c->size + SAME));
    const double count = full > FULL && full < 2 - FULL ? along * across : fmax(along, floor(r->area / room + SAME));
    return (int32_t)fmin(count, r->end - r->first);
}

static int cut_regions(cutter *c, brunt_error *error) {
    brunt_boundary_surface *s = c->s;
    int32_t pieces = 0;
    for (int32_t t = 0; t < c->triangles; t++)
        if (c->region[t].end > 0) pieces += pieces_of(c, &c->region[t]);
    if (BRUNT_NEW(s->first, pieces + 1, "pieces of a boundary", error) ||
        BRUNT_NEW(s->particle, c->particles, "particles of a boundary", error))
        return BRUNT_FAILED;
    for (int32_t t = 0; t < c->triangles; t++) {
        const region *r = &c->region[t];
        if (r->end > 0) cut(c, r, r->first, r->end, pieces_of(c, r));
    }
    for (int32_t i = 0; i < c->particles; i++) s->particle[i] = c->particle[c->order[i].particle];
    s->particle_count = c->particles;
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ all

static int cut_all(cutter *c, brunt_error *error) {
    if (BRUNT_NEW(c->triangle, 2 * (size_t)c->def->facet_count, "facets of a boundary", error)) return BRUNT_FAILED;
    BRUNT_TRY(add_triangles(c, error));
    if (BRUNT_NEW(c->border, 3 * (size_t)c->triangles, "edges of a boundary", error) ||
        BRUNT_NEW(c->region, c->triangles, "regions of a boundary", error) ||
        BRUNT_NEW(c->particle, c->particles, "particles of a boundary", error) ||
        BRUNT_NEW(c->order, c->particles, "particles of a boundary", error))
        return BRUNT_FAILED;
    list_borders(c);
    BRUNT_TRY(join(c, error));
    BRUNT_TRY(find_corners(c, error));
    BRUNT_TRY(find_regions(c, error));
    sort_regions(c);
    return cut_regions(c, error);
}

int brunt_boundary_cut_facets(brunt_boundary_surface *s, const brunt_boundary_surface_def *def, brunt_error *error) {
    cutter c = {.s = s, .def = def, .size = def->piece * s->cell};
    const int status = cut_all(&c, error);
    brunt_free(c.triangle), brunt_free(c.border), brunt_free(c.region), brunt_free(c.particle), brunt_free(c.order);
    return status;
}
