// Looks a mesh over: numbers in range, elements that can be computed with, things given twice.
//
// The shape of an element is its least scaled Jacobian (Knupp 2000, "Achieving finite element mesh quality via
// optimization of the Jacobian matrix norm", Int. J. Numer. Meth. Engng 48; normalised as in Stimpson et al. 2007, "The
// Verdict geometric quality library"): at each corner the determinant of the edges that meet there over the product of
// their lengths, times sqrt(2) for a tetrahedron and 2/sqrt(3) for a triangle, so that the regular element has 1.
#include "brunt.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/vector.h"
#include "geometry/element_traits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Below this scaled Jacobian an element is flat: its sign is rounding when nodes lie up to 1e5 edges from the origin.
static const double flat = 1e-10;
// Nodes nearer than this share of the longest edge are at the same place.
static const double same_position = 1e-9;

enum { INVERTED, DEGENERATE, TWICE, SAME_POSITION, UNREFERENCED, LISTED = 10 };

// ---------------------------------------------------------------------------------------------------- lists of numbers

// How many were met, and the first of them.
typedef struct list {
    int32_t count, first[LISTED];
} list;

static void note(list *l, int32_t number) {
    if (l->count < LISTED) l->first[l->count] = number;
    l->count++;
}

// Puts a bad one where it belongs when they are not met in ascending order.
static void note_sorted(list *l, int32_t number) {
    int kept = l->count < LISTED ? l->count : LISTED, at = kept;
    while (at > 0 && l->first[at - 1] > number) at--;
    for (int i = kept < LISTED ? kept : LISTED - 1; i > at; i--) l->first[i] = l->first[i - 1];
    if (at < LISTED) l->first[at] = number;
    l->count++;
}

// "element 3 is", "elements 3, 17 and 5 more are", numbers from 1.
static void say(char *out, size_t size, const char *what, const list *l) {
    size_t at = (size_t)snprintf(out, size, "%s%s", what, l->count > 1 ? "s" : "");
    int listed = l->count < LISTED ? l->count : LISTED;
    for (int i = 0; i < listed && at < size; i++) {
        const char *before = i == 0 ? " " : i == l->count - 1 ? " and " : ", ";
        at += (size_t)snprintf(out + at, size - at, "%s%lld", before, l->first[i] + 1LL);
    }
    if (l->count > listed && at < size)
        at += (size_t)snprintf(out + at, size - at, " and %d more", (int)(l->count - listed));
    if (at < size) snprintf(out + at, size - at, l->count > 1 ? " are" : " is");
}

static int fail_list(brunt_error *error, const char *what, const list *l, const char *why) {
    char subject[256];
    say(subject, sizeof subject, what, l);
    return brunt_fail(error, BRUNT_BAD_INPUT, "%s %s", subject, why);
}

// ---------------------------------------------------------------------------------------------------- numbers

static int check_numbers(const brunt_mesh *mesh, brunt_error *error) {
    if ((unsigned)mesh->kind >= BRUNT_ELEMENT_KINDS)
        return brunt_fail(error, BRUNT_BAD_INPUT, "a mesh of unknown element kind %d", (int)mesh->kind);
    if (mesh->node_count <= 0 || mesh->element_count <= 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "a mesh of %d nodes and %d elements: at least one element is wanted",
                          (int)mesh->node_count, (int)mesh->element_count);
    int nodes = brunt_element_nodes(mesh->kind);
    list bad = {0};
    for (int32_t e = 0; e < mesh->element_count; e++) {
        bool out = false;
        for (int a = 0; a < nodes; a++) {
            int32_t n = mesh->elements[(size_t)e * (size_t)nodes + (size_t)a];
            out |= n < 0 || n >= mesh->node_count;
        }
        if (out) note(&bad, e);
    }
    if (bad.count) return fail_list(error, "element", &bad, "given with node numbers that the mesh does not have");
    list off = {0}, far = {0};
    for (int32_t n = 0; n < mesh->node_count; n++) {
        const double *x = mesh->nodes[n];
        if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2])) note(&bad, n);
        if (fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2]))) > BRUNT_GREATEST_NUMBER) note(&far, n);
        if (brunt_element_dimension(mesh->kind) == 2 && x[2] != 0) note(&off, n);
    }
    if (bad.count) return fail_list(error, "node", &bad, "at a place that is not a finite number");
    if (far.count) return fail_list(error, "node", &far, "too far from the origin to be computed with");
    if (off.count) return fail_list(error, "node", &off, "off the x-y plane: a mesh of two dimensions has z = 0");
    return BRUNT_OK;
}

// ---------------------------------------------------------------------------------------------------- one element

static void edge(const double *from, const double *to, double *e) {
    for (int d = 0; d < 3; d++) e[d] = to[d] - from[d];
}
static double length(const double *e) { return sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]); }
static double triple(const double *a, const double *b, const double *c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

typedef struct element_look {
    double volume;            // [m^3], 2D and membranes [m^2]
    double least, shape;      // [m^3] least determinant at a corner; [-] least scaled one
    double shortest, longest; // [m] edges
} element_look;

static void look_at_corner(const double *x, const double *const to[3], int dimension, double factor,
                           element_look *look) {
    double e[3][3], product = 1, determinant;
    for (int i = 0; i < dimension; i++) {
        edge(x, to[i], e[i]);
        double l = length(e[i]);
        product *= l;
        look->shortest = fmin(look->shortest, l);
        look->longest = fmax(look->longest, l);
    }
    determinant = dimension == 3 ? triple(e[0], e[1], e[2]) : e[0][0] * e[1][1] - e[0][1] * e[1][0];
    double scaled = product > 0 ? factor * determinant / product : 0;
    look->least = fmin(look->least, determinant);
    if (!(scaled >= look->shape)) look->shape = scaled; // one that is not a number stays
}

// Corners of a membrane's element as seen along its normal, that of its diagonals: area and shape are what they make in
// that plane. One that is folded upon itself is flat there, one whose sides cross has corners that turn back.
static void view_along_normal(int nodes, const double (*x)[3], double (*plane)[3]) {
    double first[3], second[3], normal[3], across[3];
    edge(x[0], nodes == 4 ? x[2] : x[1], first);
    edge(nodes == 4 ? x[1] : x[0], nodes == 4 ? x[3] : x[2], second);
    cross(first, second, normal);
    cross(normal, first, across);
    const double along = length(first), square = length(normal) * along;
    for (int n = 0; n < nodes; n++) {
        double d[3];
        edge(x[0], x[n], d);
        plane[n][0] = along > 0 ? (d[0] * first[0] + d[1] * first[1] + d[2] * first[2]) / along : 0;
        plane[n][1] = square > 0 ? (d[0] * across[0] + d[1] * across[1] + d[2] * across[2]) / square : 0;
        plane[n][2] = 0;
    }
}

// Of a membrane, x are in its plane.
static element_look look_at_corners(const brunt_element_traits *element, const double (*x)[3]) {
    element_look look = {.least = INFINITY, .shape = INFINITY, .shortest = INFINITY};
    for (int a = 0; a < element->nodes; a++) {
        const double *to[3] = {0};
        for (int i = 0; i < element->span; i++) to[i] = x[element->corner[a][i]];
        look_at_corner(x[a], to, element->span, element->shape->regular, &look);
    }
    look.volume = brunt_element_volume(element, x);
    return look;
}

static element_look look_at(const brunt_element_traits *element, const double (*x)[3]) {
    if (!element->membrane) return look_at_corners(element, x);
    const int nodes = element->nodes;
    double plane[4][3];
    view_along_normal(nodes, x, plane);
    element_look look = look_at_corners(element, (const double(*)[3])plane);
    look.shortest = INFINITY, look.longest = 0;
    for (int a = 0; a < nodes; a++) {
        double e[3];
        edge(x[a], x[(a + 1) % nodes], e);
        look.shortest = fmin(look.shortest, length(e)), look.longest = fmax(look.longest, length(e));
    }
    return look;
}

// True when the element has a node twice.
static bool gather(const brunt_mesh *mesh, int32_t e, double (*x)[3]) {
    int nodes = brunt_element_nodes(mesh->kind);
    const int32_t *node = mesh->elements + (size_t)e * (size_t)nodes;
    bool twice = false;
    for (int a = 0; a < nodes; a++) {
        memcpy(x[a], mesh->nodes[node[a]], sizeof *x);
        for (int b = 0; b < a; b++) twice |= node[a] == node[b];
    }
    return twice;
}

static void look_at_elements(const brunt_mesh *mesh, brunt_mesh_quality *quality, list found[5]) {
    quality->smallest = quality->worst_shape = quality->shortest_edge = INFINITY;
    quality->largest = -INFINITY;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double x[BRUNT_ELEMENT_NODES][3];
        bool twice = gather(mesh, e, x);
        element_look look = look_at(brunt_element_traits_of(mesh->kind), (const double(*)[3])x);
        if (twice || !(fabs(look.shape) > flat) || !isfinite(look.volume))
            note(&found[DEGENERATE], e);
        else if (look.shape < 0)
            note(&found[INVERTED], e);
        quality->volume += look.volume;
        quality->smallest = fmin(quality->smallest, look.volume);
        quality->largest = fmax(quality->largest, look.volume);
        quality->shortest_edge = fmin(quality->shortest_edge, look.shortest);
        quality->longest_edge = fmax(quality->longest_edge, look.longest);
        if (!(look.shape >= quality->worst_shape)) quality->worst_shape = look.shape, quality->worst = e;
    }
}

// ---------------------------------------------------------------------------------------------------- given twice

typedef struct keyed {
    uint64_t key;
    int32_t element;
} keyed;

static int by_key(const void *a, const void *b) {
    const keyed *p = a, *q = b;
    if (p->key != q->key) return p->key < q->key ? -1 : 1;
    return (p->element > q->element) - (p->element < q->element);
}

static void sorted_nodes(const brunt_mesh *mesh, int32_t e, int32_t *sorted) {
    int nodes = brunt_element_nodes(mesh->kind);
    for (int a = 0; a < nodes; a++) {
        int32_t n = mesh->elements[(size_t)e * (size_t)nodes + (size_t)a];
        int at = a;
        for (; at > 0 && sorted[at - 1] > n; at--) sorted[at] = sorted[at - 1];
        sorted[at] = n;
    }
}

// Elements with the same set of nodes as one before, found among those whose sets have the same hash.
static bool find_twice(const brunt_mesh *mesh, list *found) {
    int nodes = brunt_element_nodes(mesh->kind);
    size_t bytes = (size_t)nodes * sizeof(int32_t);
    keyed *keys = brunt_alloc((size_t)mesh->element_count * sizeof *keys);
    if (!keys) return false;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        int32_t set[BRUNT_ELEMENT_NODES];
        sorted_nodes(mesh, e, set);
        keys[e] = (keyed){.element = e};
        for (int a = 0; a < nodes; a++) keys[e].key = brunt_hash_add(keys[e].key, (uint64_t)set[a]);
    }
    qsort(keys, (size_t)mesh->element_count, sizeof *keys, by_key);
    for (int32_t i = 0, run = 0; i < mesh->element_count; i++) {
        if (keys[i].key != keys[run].key) run = i;
        int32_t set[BRUNT_ELEMENT_NODES], other[BRUNT_ELEMENT_NODES];
        for (int32_t j = run; j < i; j++) {
            sorted_nodes(mesh, keys[i].element, set);
            sorted_nodes(mesh, keys[j].element, other);
            if (memcmp(set, other, bytes)) continue;
            note_sorted(found, keys[i].element);
            break;
        }
    }
    brunt_free(keys);
    return true;
}

static uint64_t cell_hash(const double *cell) {
    uint64_t hash = 0;
    for (int d = 0; d < 3; d++) {
        uint64_t bits;
        double value = cell[d] + 0.0; // -0 and 0 are one cell
        memcpy(&bits, &value, sizeof bits);
        hash = brunt_hash_add(hash, bits);
    }
    return hash;
}

// Nodes within `extent` of one before. A node is put into its cell of a grid of spacing 16 reach, and looked for in all
// the cells within reach, which is nearly always one. Those found are not put in, so that a cell never holds many.
static bool find_same_position(const brunt_mesh *mesh, double extent, list *found) {
    if (!(extent > 0) || !isfinite(extent)) return true; // the elements are in disorder, and reported
    uint64_t buckets = 1;
    while (buckets < 2 * (uint64_t)mesh->node_count) buckets *= 2;
    int32_t *head = brunt_alloc(buckets * sizeof *head), *next = brunt_alloc((size_t)mesh->node_count * sizeof *next);
    for (int32_t n = 0; n < mesh->node_count && head && next; n++) {
        const double *x = mesh->nodes[n];
        double own[3], low[3], high[3], spacing = 16 * extent;
        for (int d = 0; d < 3; d++) {
            own[d] = floor(x[d] / spacing);
            low[d] = floor((x[d] - extent) / spacing), high[d] = floor((x[d] + extent) / spacing);
        }
        bool met = false;
        for (int corner = 0; corner < 8 && !met; corner++) {
            double cell[3];
            bool again = false; // this cell was looked at: low and high are one
            for (int d = 0; d < 3; d++) {
                cell[d] = corner >> d & 1 ? high[d] : low[d];
                again |= (corner >> d & 1) && high[d] == low[d];
            }
            if (again) continue;
            for (int32_t m = head[cell_hash(cell) & (buckets - 1)]; m && !met; m = next[m - 1]) {
                double e[3];
                edge(mesh->nodes[m - 1], x, e);
                met = length(e) <= extent;
            }
        }
        if (met) {
            note(found, n);
        } else {
            uint64_t bucket = cell_hash(own) & (buckets - 1);
            next[n] = head[bucket];
            head[bucket] = n + 1;
        }
    }
    bool done = head && next;
    brunt_free(head);
    brunt_free(next);
    return done;
}

static bool find_unreferenced(const brunt_mesh *mesh, list *found) {
    uint8_t *used = brunt_alloc((size_t)mesh->node_count);
    if (!used) return false;
    size_t count = (size_t)mesh->element_count * (size_t)brunt_element_nodes(mesh->kind);
    for (size_t i = 0; i < count; i++) used[mesh->elements[i]] = 1;
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (!used[n]) note(found, n);
    brunt_free(used);
    return true;
}

// ------------------------------------------------------------------------------------------------- sides of membranes

// An edge of an element that runs from its lesser to its greater node, or back.
typedef struct border {
    int32_t least, greatest, element;
    bool back;
} border;

static int by_border(const void *a, const void *b) {
    const border *p = a, *q = b;
    if (p->least != q->least) return p->least < q->least ? -1 : 1;
    if (p->greatest != q->greatest) return p->greatest < q->greatest ? -1 : 1;
    return (p->element > q->element) - (p->element < q->element);
}

// Pairs of elements that run along the edge they share in the same direction: one shows its front where the other shows
// its back. Where more than two meet, at a seam, any way will do.
typedef struct turned {
    int32_t count, first, second; // how many pairs, and the elements of the first
} turned;

static bool find_turned(const brunt_mesh *mesh, turned *found) {
    const int nodes = brunt_element_nodes(mesh->kind);
    const size_t count = (size_t)mesh->element_count * (size_t)nodes;
    border *edges = brunt_alloc(count * sizeof *edges);
    if (!edges) return false;
    for (size_t i = 0; i < count; i++) {
        const size_t corner = i % (size_t)nodes;
        int32_t p = mesh->elements[i], q = mesh->elements[i - corner + (corner + 1) % (size_t)nodes];
        edges[i] = (border){p < q ? p : q, p < q ? q : p, (int32_t)(i / (size_t)nodes), p > q};
    }
    qsort(edges, count, sizeof *edges, by_border);
    for (size_t i = 0, same; i < count; i += same) {
        for (same = 1; i + same < count && edges[i + same].least == edges[i].least &&
                       edges[i + same].greatest == edges[i].greatest;)
            same++;
        if (same != 2 || edges[i].back != edges[i + 1].back) continue;
        if (!found->count++ || edges[i].element < found->first)
            found->first = edges[i].element, found->second = edges[i + 1].element;
    }
    brunt_free(edges);
    return true;
}

static int check_sides(const brunt_mesh *mesh, brunt_error *error) {
    turned found = {0};
    if (!find_turned(mesh, &found))
        return brunt_fail(error, BRUNT_FAILED, "no memory to check a mesh of %d nodes", (int)mesh->node_count);
    if (!found.count) return BRUNT_OK;
    char more[48] = "";
    if (found.count > 1) snprintf(more, sizeof more, ", as are %d more pairs", (int)(found.count - 1));
    return brunt_fail(
        error, BRUNT_BAD_INPUT,
        "elements %lld and %lld are turned to opposite sides%s: neighbours in a membrane have their nodes in "
        "the same sense, counter-clockwise seen from the front",
        found.first + 1LL, found.second + 1LL, more);
}

// ---------------------------------------------------------------------------------------------------- all of it

static int judge(const list found[5], brunt_error *error) {
    static const char *const why[3] = {
        [INVERTED] = "inside out (nodes given in the wrong order, or the mesh is tangled)",
        [DEGENERATE] = "flat, or given with a node twice",
        [TWICE] = "given twice",
    };
    char message[sizeof error->message] = "";
    size_t at = 0;
    for (int k = 0; k <= TWICE; k++) {
        if (!found[k].count) continue;
        char subject[256];
        say(subject, sizeof subject, "element", &found[k]);
        at += (size_t)snprintf(message + at, sizeof message - at, "%s%s %s", at ? "; " : "", subject, why[k]);
    }
    return at ? brunt_fail(error, BRUNT_BAD_INPUT, "%s", message) : BRUNT_OK;
}

int brunt_mesh_check(const brunt_mesh *mesh, brunt_mesh_quality *quality, brunt_error *error) {
    *quality = (brunt_mesh_quality){.first = {-1, -1, -1, -1, -1}, .worst = -1};
    int status = check_numbers(mesh, error);
    if (status) return status;
    list found[5] = {0};
    look_at_elements(mesh, quality, found);
    if (!find_twice(mesh, &found[TWICE]) || !find_unreferenced(mesh, &found[UNREFERENCED]) ||
        !find_same_position(mesh, same_position * quality->longest_edge, &found[SAME_POSITION]))
        return brunt_fail(error, BRUNT_FAILED, "no memory to check a mesh of %d nodes", (int)mesh->node_count);
    quality->inverted = found[INVERTED].count;
    quality->degenerate = found[DEGENERATE].count;
    quality->duplicate_elements = found[TWICE].count;
    quality->duplicate_nodes = found[SAME_POSITION].count;
    quality->unreferenced = found[UNREFERENCED].count;
    for (int k = 0; k < 5; k++)
        if (found[k].count) quality->first[k] = found[k].first[0];
    status = judge(found, error);
    return status || !brunt_element_is_membrane(mesh->kind) ? status : check_sides(mesh, error);
}
