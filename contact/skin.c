#include "skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "threads.h"

enum { GRAIN = 256 };
static const double SHALLOW =
    0.25; // mean edges: how far a node may get behind a sheet, at most, and still be sent back

// ------------------------------------------------------------------------------------------ topology

static int corners(const int32_t face[4]) { return face[2] < 0 ? 2 : face[3] < 0 ? 3 : 4; }

// Nodes that have a face, ascending; `number` gets their skin numbers, from `first`. Their count, or -1: out of memory.
static int32_t number_nodes(const brunt_fem_body *fem, const brunt_faces *faces, int32_t first, int32_t *number) {
    for (int32_t n = 0; n < fem->node_count; n++) number[n] = -1;
    for (int32_t f = 0; f < faces->count; f++)
        for (int k = 0; k < corners(faces->node[f]); k++) number[faces->node[f][k]] = 0;
    int32_t next = first;
    for (int32_t n = 0; n < fem->node_count; n++)
        if (number[n] == 0) number[n] = next++;
    return next - first;
}

static int allocate(brunt_skin *s) {
    size_t n = (size_t)s->node_count + 1, f = (size_t)s->face_count + 1;
    s->x = brunt_alloc(n * sizeof *s->x), s->v = brunt_alloc(n * sizeof *s->v),
    s->old = brunt_alloc(n * sizeof *s->old);
    s->mass = brunt_alloc(n * sizeof *s->mass), s->inverse = brunt_alloc(n * sizeof *s->inverse);
    s->normal = brunt_alloc(n * sizeof *s->normal), s->area = brunt_alloc(n * sizeof *s->area);
    s->gap = brunt_alloc(n * sizeof *s->gap), s->impulse = brunt_alloc(n * sizeof *s->impulse);
    s->state = brunt_alloc(n);
    s->chunk_moved = brunt_alloc((n / GRAIN + 1) * sizeof *s->chunk_moved);
    s->face_normal = brunt_alloc(f * sizeof *s->face_normal), s->face_centre = brunt_alloc(f * sizeof *s->face_centre);
    s->face_area = brunt_alloc(f * sizeof *s->face_area), s->face_box = brunt_alloc(f * sizeof *s->face_box);
    s->face_first = brunt_alloc((n + 1) * sizeof *s->face_first);
    s->face_of = brunt_alloc(4 * f * sizeof *s->face_of);
    return s->x && s->v && s->old && s->mass && s->inverse && s->normal && s->area && s->gap && s->impulse &&
                   s->state && s->chunk_moved && s->face_normal && s->face_centre && s->face_area && s->face_box &&
                   s->face_first && s->face_of
               ? 0
               : -1;
}

static void link_faces(brunt_skin *s) {
    for (int32_t f = 0; f < s->face_count; f++)
        for (int k = 0; k < corners(s->face[f]); k++) s->face_first[s->face[f][k] + 2]++;
    for (int32_t n = 2; n <= s->node_count + 1; n++) s->face_first[n] += s->face_first[n - 1];
    for (int32_t f = 0; f < s->face_count; f++)
        for (int k = 0; k < corners(s->face[f]); k++) s->face_of[s->face_first[s->face[f][k] + 1]++] = f;
}

static double edge_sum(const brunt_skin *s, int32_t *edges) {
    double sum = 0;
    for (int32_t f = 0; f < s->face_count; f++) {
        int n = corners(s->face[f]);
        int k = 0;
        while (s->face_range[k + 1] <= f) k++;
        if (f >= s->face_end[k]) continue;
        for (int e = 0; e < (n == 2 ? 1 : n); e++) {
            const real *a = brunt_fem_node(s->fem[k], s->node[s->face[f][e]]),
                       *b = brunt_fem_node(s->fem[k], s->node[s->face[f][(e + 1) % n]]);
            double square = 0;
            for (int c = 0; c < 3; c++) square += (double)((a[c] - b[c]) * (a[c] - b[c]));
            sum += sqrt(square);
            ++*edges;
        }
    }
    return sum;
}

// The other side of a sheet: the nodes from `first` on and the faces from `first_face` on once more, facing the other
// way.
static void add_back(brunt_skin *s, int32_t first, int32_t nodes, int32_t first_face, int32_t faces) {
    for (int32_t n = first; n < first + nodes; n++) s->node[n + nodes] = s->node[n], s->body[n + nodes] = s->body[n];
    for (int32_t f = first_face; f < first_face + faces; f++) {
        const int32_t *front = s->face[f];
        int32_t *back = s->face[f + faces];
        const int n = corners(front);
        back[3] = -1;
        for (int c = 0; c < n; c++) back[c] = front[n - 1 - c] + nodes;
    }
}

static int add_body(brunt_skin *s, int k, size_t *nodes, size_t *faces, size_t *owners) {
    brunt_fem_body *fem = s->fem[k];
    brunt_faces found;
    if (brunt_fem_faces(fem, &found)) return -1;
    const int sides = fem->element->sheet ? 2 : 1;
    int32_t *number = brunt_alloc((size_t)(fem->node_count + 1) * sizeof *number);
    int32_t count = number ? number_nodes(fem, &found, s->node_count, number) : -1;
    size_t n = (size_t)s->node_count + (size_t)(count > 0 ? count : 0) * (size_t)sides,
           f = (size_t)s->face_count + (size_t)found.count * (size_t)sides;
    bool failed =
        count < 0 ||
        brunt_reserve((void **)&s->node, nodes, (n + 1) * sizeof *s->node, (size_t)s->node_count * sizeof *s->node) ||
        brunt_reserve((void **)&s->body, owners, (n + 1) * sizeof *s->body, (size_t)s->node_count * sizeof *s->body) ||
        brunt_reserve((void **)&s->face, faces, (f + 1) * sizeof *s->face, (size_t)s->face_count * sizeof *s->face);
    for (int32_t i = 0; !failed && i < fem->node_count; i++)
        if (number[i] >= 0) s->node[number[i]] = i, s->body[number[i]] = fem->index;
    for (int32_t i = 0; !failed && i < found.count; i++)
        for (int c = 0; c < 4; c++)
            s->face[s->face_count + i][c] = found.node[i][c] < 0 ? -1 : number[found.node[i][c]];
    if (!failed && sides == 2) add_back(s, s->node_count, count, s->face_count, found.count);
    s->node_end[k] = s->node_count + (count > 0 ? count : 0), s->face_end[k] = s->face_count + found.count;
    s->node_count = (int32_t)n, s->face_count = (int32_t)f;
    s->node_range[k + 1] = s->node_count, s->face_range[k + 1] = s->face_count;
    brunt_free(number);
    brunt_faces_free(&found);
    return failed ? -1 : 0;
}

// Least height of the elements behind a body's surface [m], as volume over area of the face: what it may have been
// entered by, and still be told from what is behind it.
static int least_height(const brunt_fem_body *fem, double *least) {
    brunt_faces found;
    if (brunt_fem_faces(fem, &found)) return -1;
    *least = INFINITY;
    for (int32_t f = 0; f < found.count; f++) {
        double x[BRUNT_ELEMENT_NODES][3], e[3], g[3], square = 0;
        const int32_t *node = found.node[f];
        for (int c = 0; c < fem->element->nodes; c++) {
            const real *at = brunt_fem_node(
                fem, fem->element_node[(size_t)found.element[f] * (size_t)fem->element->nodes + (size_t)c]);
            for (int a = 0; a < 3; a++) x[c][a] = (double)at[a];
        }
        const bool quad = corners(node) == 4;
        const real *p = brunt_fem_node(fem, node[0]), *q = brunt_fem_node(fem, node[1]),
                   *r = brunt_fem_node(fem, node[2]), *t = quad ? brunt_fem_node(fem, node[3]) : r;
        for (int a = 0; a < 3; a++)
            e[a] = (double)(quad ? r[a] - p[a] : q[a] - p[a]), g[a] = (double)(quad ? t[a] - q[a] : r[a] - p[a]);
        for (int a = 0; a < 3; a++) {
            double n = 0.5 * (e[(a + 1) % 3] * g[(a + 2) % 3] - e[(a + 2) % 3] * g[(a + 1) % 3]);
            square += n * n;
        }
        if (square > 0) *least = fmin(*least, fem->element->volume((const double(*)[3])x) / sqrt(square));
    }
    brunt_faces_free(&found);
    return 0;
}

// What sheets need besides, when there are any.
static int add_sheets(brunt_skin *s) {
    int32_t last = 0;
    bool any = false;
    for (int k = 0; k < s->fem_count; k++) {
        any = any || s->fem[k]->element->sheet;
        last = s->fem[k]->index > last ? s->fem[k]->index : last;
    }
    if (!any) return 0;
    s->front = brunt_alloc(((size_t)s->node_count + 1) * sizeof *s->front);
    s->side = brunt_alloc(((size_t)last + 1) * sizeof *s->side);
    if (!s->front || !s->side) return -1;
    for (int k = 0; k < s->fem_count; k++) {
        const brunt_fem_body *fem = s->fem[k];
        const int32_t first = s->node_range[k], nodes = s->node_end[k] - first;
        brunt_side *side = &s->side[fem->index];
        for (int32_t n = first; n < s->node_range[k + 1]; n++) s->front[n] = n < s->node_end[k] ? n : n - nodes;
        if (!fem->element->sheet) {
            if (least_height(fem, &side->shallow)) return -1;
            side->shallow *= 0.5;
            continue;
        }
        side->faces = s->face_end[k] - s->face_range[k];
        side->half = 0.5 * (double)fem->contact_thickness;
        s->thickest = fmax(s->thickest, (double)fem->contact_thickness);
    }
    return 0;
}

int brunt_skin_make(brunt_skin *s, brunt_fem_body **fem, int count, bool affine) {
    *s = (brunt_skin){.fem_count = count, .dim = count ? fem[0]->dim : 3};
    size_t k1 = (size_t)count + 1, nodes = 0, faces = 0, owners = 0;
    s->fem = brunt_alloc(k1 * sizeof *s->fem);
    s->node_range = brunt_alloc(k1 * sizeof *s->node_range), s->face_range = brunt_alloc(k1 * sizeof *s->face_range);
    s->low = brunt_alloc(k1 * sizeof *s->low), s->high = brunt_alloc(k1 * sizeof *s->high);
    s->mean = brunt_alloc(k1 * sizeof *s->mean), s->speed = brunt_alloc(k1 * sizeof *s->speed);
    s->active = brunt_alloc(k1), s->was_active = brunt_alloc(k1);
    s->node_end = brunt_alloc(k1 * sizeof *s->node_end), s->face_end = brunt_alloc(k1 * sizeof *s->face_end);
    if (!s->node_end || !s->face_end || !s->fem || !s->node_range || !s->face_range || !s->low || !s->high ||
        !s->active || !s->was_active || !s->mean || !s->speed)
        return -1;
    for (int k = 0; k < count; k++) {
        s->fem[k] = fem[k];
        if (add_body(s, k, &nodes, &faces, &owners)) return -1;
    }
    s->face_body = brunt_alloc(((size_t)s->face_count + 1) * sizeof *s->face_body);
    if (!s->face_body || allocate(s) || add_sheets(s)) return -1;
    for (int k = 0; k < count; k++)
        for (int32_t f = s->face_range[k]; f < s->face_range[k + 1]; f++) s->face_body[f] = fem[k]->index;
    for (int32_t n = 0; n < s->node_count; n++) s->gap[n] = INFINITY;
    link_faces(s);
    int32_t edges = 0;
    double sum = edge_sum(s, &edges);
    s->mean_edge = edges ? sum / edges : 0;
    for (int k = 0; s->side && k < count; k++)
        s->side[fem[k]->index].shallow = fmin(s->side[fem[k]->index].shallow, SHALLOW * s->mean_edge);
    if (affine && !(s->affine = brunt_alloc(((size_t)s->node_count + 1) * sizeof *s->affine))) return -1;
    return 0;
}

static int ascending(const void *a, const void *b) {
    return (*(const int32_t *)a > *(const int32_t *)b) - (*(const int32_t *)a < *(const int32_t *)b);
}

// Faces of the front within two rings of node n, each once, into `list`, which has room for them. Their count.
static int32_t list_rings(const brunt_skin *s, int32_t n, int32_t *list) {
    int32_t count = 0, kept = 0;
    for (int32_t p = s->face_first[n]; p < s->face_first[n + 1]; p++)
        for (int c = 0; c < corners(s->face[s->face_of[p]]); c++) {
            const int32_t other = s->face[s->face_of[p]][c];
            for (int32_t q = s->face_first[other]; q < s->face_first[other + 1]; q++) list[count++] = s->face_of[q];
        }
    qsort(list, (size_t)count, sizeof *list, ascending);
    for (int32_t i = 0; i < count; i++)
        if (!i || list[i] != list[i - 1]) list[kept++] = list[i];
    return kept;
}

int brunt_skin_rings(brunt_skin *s, const bool *self) {
    size_t most = 0;
    for (int32_t n = 0; n < s->node_count; n++) {
        const size_t at = (size_t)(s->face_first[n + 1] - s->face_first[n]);
        most = at > most ? at : most;
    }
    size_t room = 0, used = 0;
    int32_t *list = brunt_alloc((4 * most * most + 1) * sizeof *list);
    s->ring_first = brunt_alloc(((size_t)s->node_count + 2) * sizeof *s->ring_first);
    bool failed = !list || !s->ring_first;
    for (int k = 0; !failed && k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; !failed && n < s->node_range[k + 1]; n++) {
            const int32_t count = self[k] && n < s->node_end[k] ? list_rings(s, n, list) : 0;
            failed = brunt_reserve((void **)&s->ring_face, &room, (used + (size_t)count + 1) * sizeof *list,
                                   used * sizeof *list);
            if (failed) break;
            memcpy(s->ring_face + used, list, (size_t)count * sizeof *list);
            used += (size_t)count;
            s->ring_first[n + 1] = (int32_t)used;
        }
    brunt_free(list);
    return failed ? -1 : 0;
}

void brunt_skin_free(brunt_skin *s) {
    void *owned[] = {s->fem,        s->node_range,  s->face_range,  s->low,         s->high,       s->active,
                     s->node,       s->body,        s->face,        s->face_body,   s->x,          s->v,
                     s->old,        s->mass,        s->inverse,     s->normal,      s->area,       s->gap,
                     s->impulse,    s->state,       s->face_normal, s->face_centre, s->face_area,  s->face_box,
                     s->was_active, s->chunk_moved, s->mean,        s->speed,       s->face_first, s->face_of,
                     s->affine,     s->node_end,    s->face_end,    s->front,       s->side,       s->ring_first,
                     s->ring_face};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
    *s = (brunt_skin){0};
}

// ------------------------------------------------------------------------------------------ each step

typedef struct job {
    brunt_skin *skin;
    double dt;
    const double *gravity;
} job;

static void bound_bodies(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_skin *s = ((const job *)context)->skin;
    for (int64_t k = begin; k < end; k++) {
        double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
        double sum[3] = {0}, fastest = 0;
        const int32_t count = s->node_end[k] - s->node_range[k];
        for (int32_t n = s->node_range[k]; n < s->node_end[k]; n++) {
            const real *at = brunt_fem_node(s->fem[k], s->node[n]);
            double square = 0;
            for (int a = 0; a < 3; a++) {
                double x = (double)at[a], v = (double)at[BRUNT_FEM_V + a], own = v - s->frame[a];
                low[a] = x < low[a] ? x : low[a], high[a] = x > high[a] ? x : high[a];
                sum[a] += v;
                square += own * own;
            }
            fastest = square > fastest ? square : fastest;
        }
        for (int a = 0; a < 3; a++) s->low[k][a] = low[a], s->high[k][a] = high[a], s->mean[k][a] = sum[a] / count;
        s->speed[k] = sqrt(fastest);
    }
}

void brunt_skin_bounds(brunt_skin *s, int threads, double *seconds) {
    job j = {.skin = s};
    brunt_parallel(threads, s->fem_count, 1, bound_bodies, &j, seconds);
}

// The first node or face from `item` on, by their `range`, that an active body has; `k` becomes that body.
static int32_t next_active(const brunt_skin *s, const int32_t *range, int32_t item, int *k) {
    for (; *k < s->fem_count && (range[*k + 1] <= item || !s->active[*k]); ++*k)
        if (item < range[*k + 1]) item = range[*k + 1];
    return item;
}

static void take_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    brunt_skin *s = j->skin;
    int k = 0;
    double furthest = 0;
    for (int32_t n = (int32_t)begin; (n = next_active(s, s->node_range, n, &k)) < end; n++) {
        const brunt_fem_body *fem = s->fem[k];
        const int32_t node = s->node[n];
        const real *at = brunt_fem_node(fem, node);
        real force[3];
        brunt_fem_internal_force(fem, node, force);
        double inverse = 1 / (double)at[BRUNT_FEM_MASS], moved = 0;
        s->mass[n] = (double)at[BRUNT_FEM_MASS];
        for (int a = 0; a < 3; a++) {
            bool held = (fem->held && fem->held[node] >> a & 1) || a >= s->dim;
            double load = (double)force[a] + (fem->load ? (double)fem->load[4 * (size_t)node + (size_t)a] : 0);
            double step = (double)at[a] - s->x[n][a] - s->frame_step[a];
            moved += step * step;
            s->x[n][a] = (double)at[a];
            s->v[n][a] = (double)at[BRUNT_FEM_V + a];
            s->old[n][a] = held ? s->v[n][a] : s->v[n][a] - j->dt * (load * inverse + j->gravity[a]);
            s->inverse[n][a] = held ? 0 : inverse;
            s->impulse[n][a] = 0;
        }
        s->gap[n] = INFINITY;
        s->state[n] = 0;
        furthest = moved > furthest ? moved : furthest;
    }
    s->chunk_moved[begin / GRAIN] = furthest;
}

static void take_chunks(void *context, int64_t begin, int64_t end, int worker) {
    const int32_t count = ((const job *)context)->skin->node_count;
    for (int64_t c = begin; c < end; c++)
        take_nodes(context, c * GRAIN, (c + 1) * GRAIN < count ? (c + 1) * GRAIN : count, worker);
}

static void make_faces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_skin *s = ((const job *)context)->skin;
    int k = 0;
    for (int32_t f = (int32_t)begin; (f = next_active(s, s->face_range, f, &k)) < end; f++) {
        const int32_t *node = s->face[f];
        const int n = corners(node);
        double normal[3] = {0}, size = 0;
        const double *p = s->x[node[0]], *q = s->x[node[1]], *r = n > 2 ? s->x[node[2]] : p,
                     *t = n > 3 ? s->x[node[3]] : p;
        double e[3], g[3];
        for (int a = 0; a < 3; a++) {
            e[a] = n > 3 ? r[a] - p[a] : q[a] - p[a];
            g[a] = n > 3 ? t[a] - q[a] : n > 2 ? r[a] - p[a] : 0;
            s->face_centre[f][a] = (p[a] + q[a] + (n > 2 ? r[a] : 0) + (n > 3 ? t[a] : 0)) / n;
        }
        if (n == 2) {
            normal[0] = e[1], normal[1] = -e[0];
        } else {
            for (int a = 0; a < 3; a++) {
                int i = (a + 1) % 3, l = (a + 2) % 3;
                normal[a] = 0.5 * (e[i] * g[l] - e[l] * g[i]);
            }
        }
        for (int a = 0; a < 3; a++) size += normal[a] * normal[a];
        size = sqrt(size);
        s->face_area[f] = size;
        for (int a = 0; a < 3; a++) {
            double low = p[a] < q[a] ? p[a] : q[a], high = p[a] < q[a] ? q[a] : p[a];
            if (n > 2) low = r[a] < low ? r[a] : low, high = r[a] > high ? r[a] : high;
            if (n > 3) low = t[a] < low ? t[a] : low, high = t[a] > high ? t[a] : high;
            s->face_box[f][a] = low, s->face_box[f][3 + a] = high;
        }
        for (int a = 0; a < 3; a++) s->face_normal[f][a] = size > 0 ? normal[a] / size : 0;
    }
}

static void make_normals(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_skin *s = ((const job *)context)->skin;
    int k = 0;
    for (int32_t n = (int32_t)begin; (n = next_active(s, s->node_range, n, &k)) < end; n++) {
        double sum[3] = {0}, area = 0, size = 0;
        for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++) {
            int32_t f = s->face_of[q];
            double share = s->face_area[f] / corners(s->face[f]);
            area += share;
            for (int a = 0; a < 3; a++) sum[a] += share * s->face_normal[f][a];
        }
        for (int a = 0; a < 3; a++) size += sum[a] * sum[a];
        size = sqrt(size);
        s->area[n] = area;
        for (int a = 0; a < 3; a++) s->normal[n][a] = size > 1e-9 * area ? sum[a] / size : 0;
    }
}

void brunt_skin_take(brunt_skin *s, double dt, const double gravity[3], int threads, double *seconds) {
    job j = {s, dt, gravity};
    brunt_parallel(threads, (s->node_count + GRAIN - 1) / GRAIN, 1, take_chunks, &j, seconds);
    s->moved = 0;
    for (int32_t c = 0; c < (s->node_count + GRAIN - 1) / GRAIN; c++) s->moved = fmax(s->moved, s->chunk_moved[c]);
    s->moved = sqrt(s->moved);
    for (int k = 0; k < s->fem_count; k++) {
        if (s->active[k] && !s->was_active[k]) s->moved = INFINITY; // where it was before is not known
        s->was_active[k] = s->active[k];
    }
    brunt_parallel(threads, s->face_count, GRAIN, make_faces, &j, seconds);
    brunt_parallel(threads, s->node_count, GRAIN, make_normals, &j, seconds);
}

static void give_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_skin *s = ((const job *)context)->skin;
    int k = 0;
    for (int32_t n = (int32_t)begin; (n = next_active(s, s->node_range, n, &k)) < end; n++) {
        if (n >= s->node_end[k]) continue;
        real *at = brunt_fem_node(s->fem[k], s->node[n]);
        for (int a = 0; a < 3; a++) at[BRUNT_FEM_V + a] = (real)s->v[n][a];
    }
}

void brunt_skin_give(brunt_skin *s, double dt, int threads, double *seconds) {
    job j = {.skin = s};
    brunt_parallel(threads, s->node_count, GRAIN, give_nodes, &j, seconds);
    for (int a = 0; a < 3; a++) {
        s->frame[a] = 0;
        for (int k = 0; k < s->fem_count; k++) s->frame[a] += s->mean[k][a] / s->fem_count;
        s->frame_step[a] = s->frame[a] * dt;
    }
}
