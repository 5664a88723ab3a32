// Contact by impulses between nodes and grid-averaged surfaces: forms "surface" and "smooth".
//
// Per pair of bodies A and B, all sums over what lies within reach of grid node i, N the quadratic B-spline:
//   1. S = sum N a_f, s = sum N a_f n_f of each body's faces; d = unit(c_A^4 s_A/|s_A| - c_B^4 s_B/|s_B|), from A to B,
//      with the coherence c = |s|/S: where a surface turns by much, the other's direction counts. Once more with only
//      those faces that look along d, which drops the far side of thin bodies.
//   2. the facing surface of each body: W = sum N a, X = sum N a x_f / W, n = unit(sum N a n_f) of faces along d;
//      M = sum N m of nodes along d, the mass that takes reactions
//   3. sweeps; in each, nodes p of one body (the slaves) against the surface of the other (the master):
//      gap g = sum w n . (x_p - X), u = v_p - sum w v_i, w the masked and normalised N; where u.n < target = -g/dt, an
//      impulse with Coulomb's limit, and its reaction through the grid to the master's nodes
// Masters' effective masses come from the slaves that press at the same time, so that a sweep cannot raise the kinetic
// energy (Cauchy for the sum on the grid, Jensen for what nodes get back).
//
// "smooth" takes C = grad v of each node from its faces and extends affinely:
//   v_i = sum N m (v_q + C_q (x_i - x_q))/M,  C_i = sum N m C_q/M,  v(x_p) = sum w (v_i + C_i (x_p - x_i))
// and hands reactions back by the exact transpose, down to the nodes of the faces. As u is 0 for every rigid motion of
// both bodies, impulses with their reactions have no resultant and no moment. Coulomb's slip uses plain averages: with
// affine ones a bouncing block creeps sideways twice as far. "surface" uses plain averages for all, and a rigid spin of
// the nodes it changed takes the moment away that is left, for pairs without prescribed nodes.
//
// Prescribed components have infinite mass: a cluster that holds one moves with it, and reactions end there.
// Tried and worse: impulses at grid nodes (half a cell of overlap at edges), faces as carriers of momentum (half the
// approach stays), memory of slip, pushing out in "smooth" (adds up to 7 % of energy: M knows nothing of the moments).
#include <math.h>
#include <string.h>

#include "contact/methods/augury_work.h"
#include "base/memory.h"
#include "base/parallel.h"

enum { NODE_GRAIN = 64, WIDTH = 3, STENCIL = 27 };
// Cosines against d, or of slave and master normal: faces that make up d in its second round, facing faces, facing
// nodes, nodes that may be slaves.
static const double ALONG = 0.2, FACING_FACE = 0.7, FACING_NODE = 0.3, SLAVE = 0.1;
static const double OPPOSED = 0.2; // of c_A^4 + c_B^4: bodies whose normals agree that well with none between them
static const double LEAST_WEIGHT = 1e-4, LEAST_NORMAL = 0.3;
static const double DEEPEST = 1.5;     // [cells] beyond it a node is taken to be on the far side
static const double SLOP = 0.02;       // [cells] left alone by the push
static const double PUSH = 0.2;        // share of the overlap to be undone in a step
static const double RESTITUTION = 0.5; // of the approach, the most a push gives back: above, it adds energy
static const double STUCK = 1e-6;      // of Coulomb's limit that a node is below of when it sticks
static const double REACH = 3;         // [cells] between points that share a node

typedef struct surface_sums {
    double of[4]; // S, s
} surface_sums;

// One body's part of a grid node where both are.
typedef struct side {
    double area, X[3], n[3];     // W, [m], unit
    double mass, held[3];        // M [kg], and of the nodes with prescribed component
    double share[3], inverse[3]; // 1 over the mass that counts; 0 where it is infinite
    bool master, rigid;          // has surface and mass; has held components
    double v[3], plain[3], C[9]; // [m/s], [1/s]
    double F[3], T[9], pressing; // [N s], [N m s], [kg] of slaves
} side;
typedef struct shared_node {
    double x[3]; // [m]
    side side[2];
} shared_node;
typedef struct heading {
    double d[4]; // apart from the rest: it is asked for most often
} heading;

typedef struct entry {
    double w;
    int32_t at; // shared node
} entry;

// A node of the skin that is near the other body.
typedef struct party {
    int32_t node, touched;
    int16_t master_count, slave_count; // of its entries, STENCIL places each
    bool meets, pressed;               // has a master surface; was held back in some sweep
    double n[3], gap;                  // of the master surface, outward
    double u[3], along, target;        // [m/s] this sweep: relative velocity, its normal part, least allowed
    double J[3];                       // [N s] this sweep
    double push, drag, friction_loss;  // [N s], [J] in all: sums of sizes
    bool presses;
} party;

// A node whose velocity this pair may change.
typedef struct touched_node {
    int32_t node;
    bool master;
    double before[3], hold[3]; // [m/s], [N s] on prescribed components
    double area, C[9], D[9];   // "smooth": of its facets; grad v; the dipole it takes
} touched_node;

// A flat piece of a face: triangle, or segment in 2D. A quadrilateral is its four triangles with half weights, so that
// no diagonal is preferred.
typedef struct facet {
    int8_t corner[3], count;
    double weight, n[3], g[3][3]; // area, normal, gradients of the corners' shape functions
} facet;
typedef struct used_face {
    int32_t face;
    int8_t facet_count;
    facet facet[4];
    double L[9], E[9]; // sum of weight * grad v; sum of its nodes' D / area
} used_face;

// What was done for one pair, booked when all pairs are through: losses need the final velocities.
typedef struct deed {
    int32_t pair, first, end, body_b; // impulses first .. end - 1
    double friction_loss, area;
} deed;

#define ROOM(X)                                                                                                        \
    X(surface_sums, sums) /* by grid node, 2 each */                                                                   \
    X(int32_t, shared_of) /* by grid node, -1: none */                                                                 \
    X(uint8_t, visitors)  /* by block: bit b, faces of b reach it; bit 2, points in it may reach what both do */       \
    X(heading, heading)   /* d, by shared node */                                                                      \
    X(shared_node, shared)                                                                                             \
    X(entry, entries) /* by party: STENCIL as master, STENCIL as slave */                                              \
    X(party, party)   /* nodes of a's cloud, then of b's */                                                            \
    X(touched_node, touched)                                                                                           \
    X(used_face, face)                                                                                                 \
    X(int32_t, touched_of) /* by node of the skin, -1 between pairs */                                                 \
    X(int32_t, face_of)    /* by face of the skin, likewise */                                                         \
    X(bool, held)          /* by body of the skin: has prescribed nodes */                                             \
    X(brunt_augury_impulse, impulse)                                                                                   \
    X(deed, deed)

struct brunt_augury_meet {
#define DECLARE(type, name)                                                                                            \
    type *name;                                                                                                        \
    size_t name##_capacity;
    ROOM(DECLARE)
#undef DECLARE
    int32_t shared_count, touched_count, face_count, impulse_count, deed_count;
    int32_t marked_nodes, marked_faces; // entries of touched_of and face_of that are -1
};

typedef struct job {
    const brunt_contact_context *m;
    brunt_contact_surface *skin;
    brunt_augury_workspace *w;
    brunt_augury_meet *meet;
    bool affine;
    double friction;
    int32_t party_first[3], touched_first[3], face_first[3];
    int of;     // body whose cloud is at work, 0 or 1
    int master; // this sweep
} job;

#define NEED(meet, name, count, keep)                                                                                  \
    brunt_reserve((void **)&(meet)->name, &(meet)->name##_capacity, ((size_t)(count) + 1) * sizeof *(meet)->name,      \
                  (size_t)(keep) * sizeof *(meet)->name)

void brunt_augury_meet_free(brunt_augury_meet *meet) {
    if (!meet) return;
#define FREE(type, name) brunt_free(meet->name);
    ROOM(FREE)
#undef FREE
    brunt_free(meet);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static double normalise(double a[3]) {
    double size = sqrt(dot(a, a));
    for (int k = 0; k < 3; k++) a[k] = size > 0 ? a[k] / size : 0;
    return size;
}

// ------------------------------------------------------------------------------------------ geometry

typedef struct adder {
    brunt_augury_grid *grid;
    brunt_augury_cloud *cloud;
} adder;

static int add_point(void *context, int32_t item, const double x[3]) {
    adder *to = context;
    return brunt_augury_cloud_add(to->grid, to->cloud, item, x);
}

// Points of each body within reach of the other's box. 1 when there are some of each, 0, or -1: out of memory.
static int collect(job *j, int a, int b) {
    brunt_augury_workspace *w = j->w;
    const brunt_contact_surface *s = j->skin;
    const double reach = REACH * j->m->cell;
    brunt_augury_grid_start(&w->grid, s->dim, WIDTH, j->m->cell);
    for (int c = 0; c < 4; c++) w->cloud[c].count = 0;
    for (int c = 3; c >= 0; c--) { // faces first: without them nothing is left to do
        const int of = c % 2 ? b : a, other = c % 2 ? a : b;
        brunt_augury_box box;
        for (int k = 0; k < 3; k++) box.low[k] = s->low[other][k] - reach, box.high[k] = s->high[other][k] + reach;
        adder to = {&w->grid, &w->cloud[c]};
        if (brunt_augury_near_visit(&w->near, s, of, c >= 2, &box, add_point, &to)) return -1;
        if (!w->cloud[c].count) return 0;
    }
    return brunt_augury_grid_finish(&w->grid, w->cloud, 4) ? -1 : 1;
}

// Most points near a box are not near the body in it: blocks from which no node is reached that faces of both reach are
// left out throughout.
static int mark_blocks(job *j) {
    const brunt_augury_grid *grid = &j->w->grid;
    if (NEED(j->meet, visitors, grid->block_count, 0)) return -1;
    uint8_t *mark = j->meet->visitors;
    memset(mark, 0, (size_t)grid->block_count);
    for (int round = 0; round < 2; round++)
        for (int32_t c = 0; c < grid->colour_first[BRUNT_AUGURY_COLOURS]; c++) {
            const int32_t b = grid->coloured[c];
            const int32_t *first[2] = {&j->w->cloud[2].block_first[b], &j->w->cloud[3].block_first[b]};
            const int bits = (first[0][1] > first[0][0]) | (first[1][1] > first[1][0]) << 1;
            for (int k = 0; k < 8; k++) {
                if (!(grid->reached[b] >> k & 1)) continue;
                if (!round)
                    mark[grid->next[b][k]] |= (uint8_t)bits;
                else if ((mark[grid->next[b][k]] & 3) == 3)
                    mark[b] |= 4;
            }
        }
    return 0;
}

static bool worth(const job *j, const brunt_augury_point *p) { return j->meet->visitors[p->block] & 4; }

static void add_faces(void *context, int32_t begin, int32_t end) {
    const job *j = context;
    const brunt_augury_cloud *cloud = &j->w->cloud[2 + j->of];
    if (!worth(j, &cloud->point[begin])) return;
    for (int32_t k = begin; k < end; k++) {
        const int32_t f = cloud->item[k];
        const double *n = j->skin->face_normal[f], area = j->skin->face_area[f];
        const double add[4] = {area, area * n[0], area * n[1], area * n[2]};
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL];
        int count = brunt_augury_stencil(&j->w->grid, &cloud->point[k], at, w);
        for (int e = 0; e < count; e++) {
            double *s = j->meet->sums[2 * at[e] + j->of].of;
            for (int a = 0; a < 4; a++) s[a] += w[e] * add[a];
        }
    }
}

// The direction from the first to the second body; 0 where there is none.
static bool direction(const surface_sums s[2], double d[3]) {
    double c[2];
    for (int a = 0; a < 3; a++) d[a] = 0;
    if (!(s[0].of[0] > 0 && s[1].of[0] > 0)) return false;
    for (int k = 0; k < 2; k++) {
        const double *normal = s[k].of + 1;
        double size = sqrt(dot(normal, normal)), coherence = size / s[k].of[0], square = coherence * coherence;
        c[k] = coherence > 1e-9 ? square * square : 0;
        for (int a = 0; a < 3 && c[k] > 0; a++) d[a] += (k ? -c[k] : c[k]) * normal[a] / size;
    }
    double size = sqrt(dot(d, d));
    bool clear = c[0] + c[1] > 1e-6 && size >= OPPOSED * (c[0] + c[1]);
    for (int a = 0; a < 3; a++) d[a] = clear ? d[a] / size : 0;
    return clear;
}

// Second round of the sums, and the facing surfaces: faces that look along d by more than `least`.
static void add_looking_faces(const job *j, int32_t begin, int32_t end, double least, bool facing) {
    const brunt_augury_cloud *cloud = &j->w->cloud[2 + j->of];
    const double sign = j->of ? -1 : 1;
    if (!worth(j, &cloud->point[begin])) return;
    for (int32_t k = begin; k < end; k++) {
        const int32_t f = cloud->item[k];
        const double *n = j->skin->face_normal[f], *x = j->skin->face_centre[f], area_f = j->skin->face_area[f];
        const double add[4] = {area_f, area_f * n[0], area_f * n[1], area_f * n[2]};
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL];
        int count = brunt_augury_stencil(&j->w->grid, &cloud->point[k], at, w);
        for (int e = 0; e < count; e++) {
            const int32_t i = j->meet->shared_of[at[e]];
            if (i < 0 || sign * dot(j->meet->heading[i].d, n) <= least) continue;
            if (facing) {
                side *s = &j->meet->shared[i].side[j->of];
                const double area = w[e] * add[0];
                s->area += area;
                for (int a = 0; a < 3; a++) s->X[a] += area * x[a], s->n[a] += area * n[a];
            } else {
                double *s = j->meet->sums[2 * at[e] + j->of].of;
                for (int a = 0; a < 4; a++) s[a] += w[e] * add[a];
            }
        }
    }
}

static void refine_faces(void *context, int32_t begin, int32_t end) {
    add_looking_faces(context, begin, end, ALONG, false);
}
static void face_faces(void *context, int32_t begin, int32_t end) {
    add_looking_faces(context, begin, end, FACING_FACE, true);
}

static void add_masses(void *context, int32_t begin, int32_t end) {
    const job *j = context;
    const brunt_augury_cloud *cloud = &j->w->cloud[j->of];
    const double sign = j->of ? -1 : 1;
    if (!worth(j, &cloud->point[begin])) return;
    for (int32_t k = begin; k < end; k++) {
        const int32_t p = cloud->item[k];
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL];
        int count = brunt_augury_stencil(&j->w->grid, &cloud->point[k], at, w);
        for (int e = 0; e < count; e++) {
            const int32_t i = j->meet->shared_of[at[e]];
            if (i < 0 || sign * dot(j->meet->heading[i].d, j->skin->normal[p]) <= FACING_NODE) continue;
            side *s = &j->meet->shared[i].side[j->of];
            s->mass += w[e] * j->skin->mass[p];
            for (int a = 0; a < 3; a++)
                if (!(j->skin->inverse[p][a] > 0)) s->held[a] += w[e] * j->skin->mass[p], s->rigid = true;
        }
    }
}

static void scatter(job *j, int cloud, brunt_augury_scatter_fn *each) {
    j->of = cloud % 2;
    brunt_augury_scatter(&j->w->grid, &j->w->cloud[cloud], each, j, j->m->threads, j->m->timer);
}

// The grid nodes where the two meet, and the direction there. 1 when there are any, 0, or -1: out of memory.
static int orient(job *j) {
    brunt_augury_meet *meet = j->meet;
    const int32_t nodes = j->w->grid.block_count * j->w->grid.block_nodes;
    if (NEED(meet, sums, 2 * nodes, 0) || NEED(meet, shared_of, nodes, 0) || mark_blocks(j)) return -1;
    memset(meet->sums, 0, 2 * (size_t)nodes * sizeof *meet->sums);
    for (int b = 0; b < 2; b++) scatter(j, 2 + b, add_faces);
    meet->shared_count = 0;
    for (int32_t i = 0; i < nodes; i++) {
        surface_sums *s = &meet->sums[2 * i];
        double d[3];
        meet->shared_of[i] = -1;
        if (s[0].of[0] == 0 || s[1].of[0] == 0 || !direction(s, d)) continue;
        if (NEED(meet, shared, meet->shared_count + 1, meet->shared_count) ||
            NEED(meet, heading, meet->shared_count + 1, meet->shared_count))
            return -1;
        shared_node *n = &meet->shared[meet->shared_count];
        *n = (shared_node){.x = {0}};
        meet->heading[meet->shared_count] = (heading){{d[0], d[1], d[2]}};
        brunt_augury_position(&j->w->grid, i, n->x);
        meet->shared_of[i] = meet->shared_count++;
        s[0] = s[1] = (surface_sums){0};
    }
    if (!meet->shared_count) return 0;
    for (int b = 0; b < 2; b++) scatter(j, 2 + b, refine_faces);
    bool any = false;
    for (int32_t i = 0; i < nodes; i++)
        if (meet->shared_of[i] >= 0) any |= direction(&meet->sums[2 * i], meet->heading[meet->shared_of[i]].d);
    return any;
}

// Facing surfaces and masses.
static void face_each_other(job *j) {
    brunt_augury_meet *meet = j->meet;
    for (int b = 0; b < 2; b++) scatter(j, 2 + b, face_faces), scatter(j, b, add_masses);
    for (int32_t i = 0; i < meet->shared_count; i++)
        for (int b = 0; b < 2; b++) {
            side *s = &meet->shared[i].side[b];
            s->master = s->mass > 0 && s->area > 0;
            if (!s->master) continue;
            normalise(s->n);
            for (int a = 0; a < 3; a++) {
                s->X[a] /= s->area;
                s->share[a] = 1 / (s->held[a] > 0 ? s->held[a] : s->mass);
                s->inverse[a] = s->held[a] > 0 ? 0 : 1 / s->mass;
            }
        }
}

static entry *entries_of(const job *j, const party *p, bool as_master) {
    return j->meet->entries + ((p - j->meet->party) * 2 + !as_master) * STENCIL;
}

// Where the surface of the other body is, as the slave sees it.
static void find_surface(const job *j, party *p, double sum) {
    entry *e = entries_of(j, p, false);
    const int other = p - j->meet->party < j->party_first[1];
    const double *x = j->skin->x[p->node];
    p->meets = false;
    p->gap = 0;
    p->n[0] = p->n[1] = p->n[2] = 0;
    if (sum < LEAST_WEIGHT) return;
    for (int k = 0; k < p->slave_count; k++) {
        const side *s = &j->meet->shared[e[k].at].side[other];
        e[k].w /= sum;
        for (int a = 0; a < 3; a++) p->n[a] += e[k].w * s->n[a], p->gap += e[k].w * s->n[a] * (x[a] - s->X[a]);
    }
    p->meets = normalise(p->n) >= LEAST_NORMAL && -dot(p->n, j->skin->normal[p->node]) > SLAVE &&
               p->gap >= -DEEPEST * j->m->cell;
    if (p->meets && p->gap < j->skin->gap[p->node]) j->skin->gap[p->node] = p->gap;
}

static void list_entries(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t k = begin; k < end; k++) {
        party *p = &j->meet->party[k];
        const int of = k >= j->party_first[1];
        const int32_t in_cloud = (int32_t)k - j->party_first[of];
        const brunt_augury_cloud *cloud = &j->w->cloud[of];
        *p = (party){.node = cloud->item[in_cloud], .touched = -1};
        if (!worth(j, &cloud->point[in_cloud])) continue;
        entry *master = entries_of(j, p, true), *slave = entries_of(j, p, false);
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL], sum = 0;
        int count = brunt_augury_stencil(&j->w->grid, &cloud->point[in_cloud], at, w);
        for (int e = 0; e < count; e++) {
            const int32_t i = j->meet->shared_of[at[e]];
            if (i < 0) continue;
            const shared_node *n = &j->meet->shared[i];
            double looks = (of ? -1 : 1) * dot(j->meet->heading[i].d, j->skin->normal[p->node]);
            if (looks > FACING_NODE && n->side[of].master) master[p->master_count++] = (entry){w[e], i};
            if (looks > SLAVE && n->side[!of].master) slave[p->slave_count++] = (entry){w[e], i}, sum += w[e];
        }
        find_surface(j, p, sum);
    }
}

// ------------------------------------------------------------------------------------------ facets: grad v of a
// surface

static void cross(const double a[3], const double b[3], double c[3]) {
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, l = (k + 2) % 3;
        c[k] = a[i] * b[l] - a[l] * b[i];
    }
}

static facet make_triangle(const brunt_contact_surface *s, const int32_t *node, int p, int q, int r, double weight) {
    facet t = {.corner = {(int8_t)p, (int8_t)q, (int8_t)r}, .count = 3};
    double e1[3], e2[3];
    for (int a = 0; a < 3; a++) {
        e1[a] = s->x[node[q]][a] - s->x[node[p]][a];
        e2[a] = s->x[node[r]][a] - s->x[node[p]][a];
    }
    cross(e1, e2, t.n);
    double twice = normalise(t.n);
    if (!(twice > 0)) return t;
    cross(e2, t.n, t.g[1]);
    cross(t.n, e1, t.g[2]);
    t.weight = weight * twice / 2;
    for (int a = 0; a < 3; a++) {
        t.g[1][a] /= twice, t.g[2][a] /= twice;
        t.g[0][a] = -t.g[1][a] - t.g[2][a];
    }
    return t;
}

static facet make_segment(const brunt_contact_surface *s, int32_t face) {
    const int32_t *node = s->face[face];
    facet t = {.corner = {0, 1, 0}, .count = 2, .weight = s->face_area[face]};
    double length = 0;
    for (int a = 0; a < 2; a++) {
        t.n[a] = s->face_normal[face][a];
        t.g[1][a] = s->x[node[1]][a] - s->x[node[0]][a];
        length += t.g[1][a] * t.g[1][a];
    }
    for (int a = 0; a < 2; a++) t.g[1][a] = length > 0 ? t.g[1][a] / length : 0, t.g[0][a] = -t.g[1][a];
    return t;
}

static void make_facets(const brunt_contact_surface *s, used_face *f) {
    const int32_t *node = s->face[f->face];
    f->facet_count = 0;
    if (node[2] < 0) {
        f->facet[f->facet_count++] = make_segment(s, f->face);
    } else if (node[3] < 0) {
        f->facet[f->facet_count++] = make_triangle(s, node, 0, 1, 2, 1);
    } else {
        f->facet[f->facet_count++] = make_triangle(s, node, 0, 1, 2, 0.5);
        f->facet[f->facet_count++] = make_triangle(s, node, 0, 2, 3, 0.5);
        f->facet[f->facet_count++] = make_triangle(s, node, 0, 1, 3, 0.5);
        f->facet[f->facet_count++] = make_triangle(s, node, 1, 2, 3, 0.5);
    }
}

// grad v of a facet, as far as it shows: what its corners say along it, and the rotation of its normal,
//   L = sum_k v_k (x) g_k - (n . v_k) g_k (x) n,
// which is exact for rigid motions.
static void measure_faces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t i = begin; i < end; i++) {
        used_face *f = &j->meet->face[j->face_first[j->master] + i];
        const int32_t *node = j->skin->face[f->face];
        memset(f->L, 0, sizeof f->L);
        for (int t = 0; t < f->facet_count; t++) {
            const facet *c = &f->facet[t];
            for (int k = 0; k < c->count; k++) {
                const double *v = j->skin->v[node[c->corner[k]]], *g = c->g[k], rise = dot(c->n, v);
                for (int a = 0; a < 3; a++)
                    for (int b = 0; b < 3; b++) f->L[3 * a + b] += c->weight * (v[a] * g[b] - rise * g[a] * c->n[b]);
            }
        }
    }
}

static void measure_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t i = begin; i < end; i++) {
        touched_node *t = &j->meet->touched[j->touched_first[j->master] + i];
        if (!t->master) continue;
        memset(t->C, 0, sizeof t->C);
        memset(t->D, 0, sizeof t->D);
        for (int32_t q = j->skin->face_first[t->node]; q < j->skin->face_first[t->node + 1]; q++) {
            const double *L = j->meet->face[j->meet->face_of[j->skin->face_of[q]]].L;
            for (int a = 0; a < 9 && t->area > 0; a++) t->C[a] += L[a] / t->area;
        }
    }
}

// The transpose of the two: dipoles D of nodes to faces, and from there impulses on their corners,
//   F_k = weight (E g_k - n (g_k . E n)).
static void load_faces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t i = begin; i < end; i++) {
        used_face *f = &j->meet->face[j->face_first[j->master] + i];
        memset(f->E, 0, sizeof f->E);
        for (int k = 0; k < 4 && j->skin->face[f->face][k] >= 0; k++) {
            const touched_node *t = &j->meet->touched[j->meet->touched_of[j->skin->face[f->face][k]]];
            for (int a = 0; a < 9 && t->master && t->area > 0; a++) f->E[a] += t->D[a] / t->area;
        }
    }
}

static void give(const job *j, touched_node *t, const double F[3]) {
    for (int a = 0; a < 3; a++) {
        double inverse = j->skin->inverse[t->node][a];
        if (inverse > 0)
            j->skin->v[t->node][a] += F[a] * inverse;
        else
            t->hold[a] += F[a];
    }
}

static void give_dipoles(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t i = begin; i < end; i++) {
        touched_node *t = &j->meet->touched[j->touched_first[j->master] + i];
        double F[3] = {0};
        for (int32_t q = j->skin->face_first[t->node]; q < j->skin->face_first[t->node + 1]; q++) {
            const int32_t used = j->meet->face_of[j->skin->face_of[q]];
            if (used < 0) continue;
            const used_face *f = &j->meet->face[used];
            for (int c = 0; c < f->facet_count; c++)
                for (int k = 0; k < f->facet[c].count; k++) {
                    const facet *p = &f->facet[c];
                    if (j->skin->face[f->face][p->corner[k]] != t->node) continue;
                    double Eg[3], En[3];
                    for (int a = 0; a < 3; a++) Eg[a] = dot(f->E + 3 * a, p->g[k]), En[a] = dot(f->E + 3 * a, p->n);
                    double bend = dot(p->g[k], En);
                    for (int a = 0; a < 3; a++) F[a] += p->weight * (Eg[a] - bend * p->n[a]);
                }
        }
        give(j, t, F);
    }
}

// ------------------------------------------------------------------------------------------ sweeps

// Share of a master's mass that counts at a grid node, for a component: all, or where something is held only that.
static double mass_share(const side *s, double w, double mass, double inverse, int a) {
    return s->held[a] > 0 && inverse > 0 ? 0 : w * mass * s->share[a];
}

static void send_motion(void *context, int32_t begin, int32_t end) {
    const job *j = context;
    const brunt_contact_surface *skin = j->skin;
    for (int32_t k = begin; k < end; k++) {
        const party *p = &j->meet->party[j->party_first[j->of] + k];
        const entry *e = entries_of(j, p, true);
        const double *v = skin->v[p->node], *x = skin->x[p->node], mass = skin->mass[p->node];
        const double *C = j->affine && p->master_count ? j->meet->touched[p->touched].C : NULL;
        for (int q = 0; q < p->master_count; q++) {
            shared_node *n = &j->meet->shared[e[q].at];
            side *s = &n->side[j->of];
            double r[3] = {n->x[0] - x[0], n->x[1] - x[1], n->x[2] - x[2]};
            for (int a = 0; a < 3; a++) {
                double w = mass_share(s, e[q].w, mass, skin->inverse[p->node][a], a);
                s->v[a] += w * v[a];
                if (!C) continue;
                s->plain[a] += w * v[a];
                s->v[a] += w * dot(C + 3 * a, r);
                for (int b = 0; b < 3; b++) s->C[3 * a + b] += w * C[3 * a + b];
            }
        }
    }
}

// Least velocity away from the surface: arrive there at the end of the step and no further; out of an overlap gently.
static double least_velocity(const job *j, double gap, double along) {
    const double slop = SLOP * j->m->cell;
    if (gap >= 0) return -gap / j->m->dt;
    if (j->affine || gap >= -slop) return 0;
    return fmin(PUSH * (-gap - slop) / j->m->dt, RESTITUTION * fmax(0, -along));
}

static bool can_move(const brunt_contact_surface *s, int32_t node) {
    return s->inverse[node][0] > 0 || s->inverse[node][1] > 0 || s->inverse[node][2] > 0;
}

static void look(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t k = begin; k < end; k++) {
        party *p = &j->meet->party[j->party_first[!j->master] + k];
        p->presses = false;
        if (!p->meets) continue;
        const entry *e = entries_of(j, p, false);
        const double *x = j->skin->x[p->node], *v = j->skin->v[p->node];
        double affine[3] = {0}, plain[3] = {0};
        for (int q = 0; q < p->slave_count; q++) {
            const shared_node *n = &j->meet->shared[e[q].at];
            const side *s = &n->side[j->master];
            for (int a = 0; a < 3; a++) affine[a] += e[q].w * s->v[a];
            if (!j->affine) continue;
            double r[3] = {x[0] - n->x[0], x[1] - n->x[1], x[2] - n->x[2]};
            for (int a = 0; a < 3; a++) plain[a] += e[q].w * s->plain[a], affine[a] += e[q].w * dot(s->C + 3 * a, r);
        }
        const double *slip = j->affine ? plain : affine;
        double rest = 0;
        p->along = 0;
        for (int a = 0; a < 3; a++) {
            p->along += (v[a] - affine[a]) * p->n[a];
            p->u[a] = v[a] - slip[a];
            rest += p->u[a] * p->n[a];
        }
        for (int a = 0; a < 3; a++) p->u[a] -= rest * p->n[a]; // tangential from here on
        p->target = least_velocity(j, p->gap, p->along);
        // A node that cannot give way leaves it to the other surface's nodes to stop at its own, which they do exactly,
        // until it is inside: pressing on a free surface through the grid throws that back by some 5 % of the approach.
        bool waits = p->gap >= -SLOP * j->m->cell && !can_move(j->skin, p->node);
        p->presses = p->along < p->target && !waits;
    }
}

static void send_pressing(void *context, int32_t begin, int32_t end) {
    const job *j = context;
    for (int32_t k = begin; k < end; k++) {
        const party *p = &j->meet->party[j->party_first[j->of] + k];
        if (!p->presses) continue;
        const entry *e = entries_of(j, p, false);
        for (int q = 0; q < p->slave_count; q++)
            j->meet->shared[e[q].at].side[j->of].pressing += e[q].w * j->skin->mass[p->node];
    }
}

// What an impulse of 1 along a unit vector does to the relative velocity, others pressing too [1/kg].
static double compliance(const brunt_contact_surface *skin, const party *p, const double yield[3],
                         const double along[3]) {
    double sum = 0;
    for (int a = 0; a < 3; a++)
        sum += along[a] * along[a] * (skin->inverse[p->node][a] + yield[a] / skin->mass[p->node]);
    return sum;
}

static void press(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    brunt_contact_surface *skin = j->skin;
    for (int64_t k = begin; k < end; k++) {
        party *p = &j->meet->party[j->party_first[!j->master] + k];
        if (!p->presses) continue;
        const entry *e = entries_of(j, p, false);
        double yield[3] = {0};
        for (int q = 0; q < p->slave_count; q++) {
            const side *s = j->meet->shared[e[q].at].side;
            for (int a = 0; a < 3; a++) yield[a] += e[q].w * s[!j->master].pressing * s[j->master].inverse[a];
        }
        double normal = compliance(skin, p, yield, p->n);
        p->presses = normal > 0; // else neither of the two can move
        if (!p->presses) continue;
        double push = (p->target - p->along) / normal, drag = 0, t[3] = {p->u[0], p->u[1], p->u[2]};
        double slip = normalise(t), tangential = compliance(skin, p, yield, t);
        if (j->friction > 0 && slip > 0 && tangential > 0) {
            drag = fmin(slip / tangential, j->friction * push);
            p->friction_loss += drag * (slip - 0.5 * drag * tangential);
        }
        p->push += push, p->drag += drag;
        for (int a = 0; a < 3; a++) p->J[a] = push * p->n[a] - drag * t[a];
        give(j, &j->meet->touched[p->touched], p->J);
        p->pressed = true;
        skin->state[p->node] = p->drag < j->friction * p->push * (1 - STUCK) ? 1 : 2;
    }
}

static void send_reaction(void *context, int32_t begin, int32_t end) {
    const job *j = context;
    for (int32_t k = begin; k < end; k++) {
        const party *p = &j->meet->party[j->party_first[j->of] + k];
        if (!p->presses) continue;
        const entry *e = entries_of(j, p, false);
        const double *x = j->skin->x[p->node];
        for (int q = 0; q < p->slave_count; q++) {
            shared_node *n = &j->meet->shared[e[q].at];
            side *s = &n->side[!j->of];
            for (int a = 0; a < 3; a++) {
                double F = e[q].w * p->J[a];
                s->F[a] -= F;
                for (int b = 0; b < 3 && j->affine; b++) s->T[3 * a + b] -= F * (x[b] - n->x[b]);
            }
        }
    }
}

static void take_reaction(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_contact_surface *skin = j->skin;
    for (int64_t k = begin; k < end; k++) {
        const party *p = &j->meet->party[j->party_first[j->master] + k];
        if (!p->master_count) continue;
        const entry *e = entries_of(j, p, true);
        touched_node *t = &j->meet->touched[p->touched];
        const double *x = skin->x[p->node], mass = skin->mass[p->node];
        double F[3] = {0}, D[9] = {0};
        for (int q = 0; q < p->master_count; q++) {
            const shared_node *n = &j->meet->shared[e[q].at];
            const side *s = &n->side[j->master];
            for (int a = 0; a < 3; a++) {
                double w = mass_share(s, e[q].w, mass, skin->inverse[p->node][a], a);
                F[a] += w * s->F[a];
                for (int b = 0; b < 3 && j->affine; b++)
                    D[3 * a + b] += w * (s->F[a] * (n->x[b] - x[b]) + s->T[3 * a + b]);
            }
        }
        give(j, t, F);
        if (j->affine) memcpy(t->D, D, sizeof D);
    }
}

static void run(job *j, int64_t count, brunt_task_fn *task) {
    int threads = count < BRUNT_AUGURY_PARALLEL ? 1 : j->m->threads;
    brunt_parallel(threads, count, NODE_GRAIN, task, j, j->m->timer);
}

// One sweep, with nodes of the body other than j->master as slaves. Whether any of them was held back.
static bool sweep(job *j) {
    brunt_augury_meet *meet = j->meet;
    const int master = j->master, slave = !master;
    const int64_t masters = j->party_first[master + 1] - j->party_first[master];
    const int64_t slaves = j->party_first[slave + 1] - j->party_first[slave];
    const int64_t faces = j->face_first[master + 1] - j->face_first[master];
    const int64_t touched = j->touched_first[master + 1] - j->touched_first[master];
    for (int32_t i = 0; i < meet->shared_count; i++) {
        side *s = &meet->shared[i].side[master];
        for (int a = 0; a < 3; a++) s->v[a] = s->plain[a] = s->F[a] = 0;
        for (int a = 0; a < 9; a++) s->C[a] = s->T[a] = 0;
        meet->shared[i].side[slave].pressing = 0;
    }
    if (j->affine) run(j, faces, measure_faces), run(j, touched, measure_nodes);
    scatter(j, master, send_motion);
    run(j, slaves, look);
    bool any = false;
    for (int64_t k = 0; k < slaves; k++) any |= meet->party[j->party_first[slave] + k].presses;
    if (!any) return false;
    scatter(j, slave, send_pressing);
    run(j, slaves, press);
    scatter(j, slave, send_reaction);
    run(j, masters, take_reaction);
    if (j->affine) run(j, faces, load_faces), run(j, touched, give_dipoles);
    return true;
}

// ------------------------------------------------------------------------------------------ a pair

// Slot of a node that may change.
static int32_t touch(job *j, int32_t node) {
    brunt_augury_meet *meet = j->meet;
    if (meet->touched_of[node] >= 0) return meet->touched_of[node];
    if (NEED(meet, touched, meet->touched_count + 1, meet->touched_count)) return -1;
    touched_node *t = &meet->touched[meet->touched_count];
    *t = (touched_node){.node = node};
    memcpy(t->before, j->skin->v[node], sizeof t->before);
    return meet->touched_of[node] = meet->touched_count++;
}

static int touch_face(job *j, int32_t face) {
    brunt_augury_meet *meet = j->meet;
    if (meet->face_of[face] >= 0) return 0;
    if (NEED(meet, face, meet->face_count + 1, meet->face_count)) return -1;
    meet->face[meet->face_count].face = face;
    make_facets(j->skin, &meet->face[meet->face_count]);
    meet->face_of[face] = meet->face_count++;
    for (int k = 0; k < 4 && j->skin->face[face][k] >= 0; k++)
        if (touch(j, j->skin->face[face][k]) < 0) return -1;
    return 0;
}

// Everything that may change, body by body. 0, or -1: out of memory.
static int touch_all(job *j) {
    brunt_augury_meet *meet = j->meet;
    const brunt_contact_surface *s = j->skin;
    meet->touched_count = meet->face_count = 0;
    for (int b = 0; b < 2; b++) {
        j->touched_first[b] = meet->touched_count, j->face_first[b] = meet->face_count;
        for (int32_t k = j->party_first[b]; k < j->party_first[b + 1]; k++) {
            party *p = &meet->party[k];
            if (!p->master_count && !p->meets) continue;
            if ((p->touched = touch(j, p->node)) < 0) return -1;
            meet->touched[p->touched].master = p->master_count > 0;
            if (!j->affine || !p->master_count) continue;
            for (int32_t q = s->face_first[p->node]; q < s->face_first[p->node + 1]; q++) {
                if (touch_face(j, s->face_of[q])) return -1;
                const used_face *f = &meet->face[meet->face_of[s->face_of[q]]];
                for (int c = 0; c < f->facet_count; c++) meet->touched[p->touched].area += f->facet[c].weight;
            }
        }
    }
    j->touched_first[2] = meet->touched_count, j->face_first[2] = meet->face_count;
    return 0;
}

static void untouch_all(brunt_augury_meet *meet) {
    for (int32_t k = 0; k < meet->touched_count; k++) meet->touched_of[meet->touched[k].node] = -1;
    for (int32_t k = 0; k < meet->face_count; k++) meet->face_of[meet->face[k].face] = -1;
    meet->touched_count = meet->face_count = 0;
}

static bool changed(const job *j, const touched_node *t) {
    return memcmp(t->before, j->skin->v[t->node], sizeof t->before) != 0;
}

// Solves I w = T for a symmetric I (xx yy zz xy xz yz) that may be nearly singular. False: nothing to turn.
static bool spin_of(const double I[6], const double T[3], double w[3]) {
    const double some = 1e-7 * (I[0] + I[1] + I[2]);
    const double a = I[0] + some, b = I[1] + some, c = I[2] + some, d = I[3], e = I[4], f = I[5];
    const double c0 = b * c - f * f, c1 = e * f - d * c, c2 = d * f - b * e, det = a * c0 + d * c1 + e * c2;
    if (!(det > 0)) return false;
    const double inv[6] = {c0 / det, (a * c - e * e) / det, (a * b - d * d) / det, c1 / det,
                           c2 / det, (d * e - a * f) / det};
    double left[3] = {T[0], T[1], T[2]};
    w[0] = w[1] = w[2] = 0;
    for (int k = 0; k < 3; k++) { // the little that was added to I is taken back by refinement
        w[0] += inv[0] * left[0] + inv[3] * left[1] + inv[4] * left[2];
        w[1] += inv[3] * left[0] + inv[1] * left[1] + inv[5] * left[2];
        w[2] += inv[4] * left[0] + inv[5] * left[1] + inv[2] * left[2];
        left[0] = T[0] - (I[0] * w[0] + I[3] * w[1] + I[4] * w[2]);
        left[1] = T[1] - (I[3] * w[0] + I[1] * w[1] + I[5] * w[2]);
        left[2] = T[2] - (I[4] * w[0] + I[5] * w[1] + I[2] * w[2]);
    }
    return true;
}

// Gives the nodes that changed the rigid spin that takes back the moment of their impulses.
static void repair_moment(job *j) {
    const brunt_augury_meet *meet = j->meet;
    brunt_contact_surface *s = j->skin;
    double mass = 0, centre[3] = {0}, T[3] = {0}, I[6] = {0}, w[3];
    for (int32_t k = 0; k < meet->touched_count; k++) {
        const touched_node *t = &meet->touched[k];
        if (!changed(j, t)) continue;
        mass += s->mass[t->node];
        for (int a = 0; a < 3; a++) centre[a] += s->mass[t->node] * s->x[t->node][a];
    }
    if (!(mass > 0)) return;
    for (int a = 0; a < 3; a++) centre[a] /= mass;
    for (int32_t k = 0; k < meet->touched_count; k++) {
        const touched_node *t = &meet->touched[k];
        if (!changed(j, t)) continue;
        const double m = s->mass[t->node];
        double r[3], dv[3], moment[3];
        for (int a = 0; a < 3; a++) r[a] = s->x[t->node][a] - centre[a], dv[a] = s->v[t->node][a] - t->before[a];
        cross(r, dv, moment);
        for (int a = 0; a < 3; a++) T[a] += m * moment[a], I[a] += m * (dot(r, r) - r[a] * r[a]);
        I[3] -= m * r[0] * r[1], I[4] -= m * r[0] * r[2], I[5] -= m * r[1] * r[2];
    }
    if (!spin_of(I, T, w)) return;
    for (int32_t k = 0; k < meet->touched_count; k++) {
        const touched_node *t = &meet->touched[k];
        if (!changed(j, t)) continue;
        double r[3], turn[3];
        for (int a = 0; a < 3; a++) r[a] = s->x[t->node][a] - centre[a];
        cross(w, r, turn);
        for (int a = 0; a < s->dim; a++) s->v[t->node][a] -= turn[a];
    }
}

// Notes what was done. 0, or -1: out of memory.
static int note(job *j, const brunt_augury_neighbours *who) {
    brunt_augury_meet *meet = j->meet;
    const brunt_contact_surface *s = j->skin;
    if (NEED(meet, impulse, meet->impulse_count + meet->touched_count, meet->impulse_count) ||
        NEED(meet, deed, meet->deed_count + 1, meet->deed_count))
        return -1;
    deed *d = &meet->deed[meet->deed_count];
    *d = (deed){.pair = who->pair, .first = meet->impulse_count, .body_b = brunt_augury_body(s, who->b)};
    for (int32_t k = 0; k < meet->touched_count; k++) {
        const touched_node *t = &meet->touched[k];
        brunt_augury_impulse *J = &meet->impulse[meet->impulse_count];
        bool any = false;
        J->node = t->node;
        for (int a = 0; a < 3; a++) {
            double inverse = s->inverse[t->node][a];
            J->J[a] = inverse > 0 ? (s->v[t->node][a] - t->before[a]) / inverse : t->hold[a];
            any |= J->J[a] != 0;
        }
        meet->impulse_count += any;
    }
    double area[2] = {0};
    for (int32_t k = 0; k < j->party_first[2]; k++) {
        const party *p = &meet->party[k];
        d->friction_loss += p->friction_loss;
        if (p->pressed) area[k >= j->party_first[1]] += s->area[p->node];
    }
    d->area = fmax(area[0], area[1]);
    d->end = meet->impulse_count;
    meet->deed_count += d->end > d->first;
    return 0;
}

static int meet_pair(job *j, const brunt_augury_neighbours *who) {
    brunt_augury_meet *meet = j->meet;
    j->friction = j->m->pairs[who->pair].friction;
    int some = collect(j, who->a, who->b);
    if (some > 0) some = orient(j);
    if (some <= 0) return some;
    face_each_other(j);
    j->party_first[0] = 0;
    j->party_first[1] = j->w->cloud[0].count;
    j->party_first[2] = j->party_first[1] + j->w->cloud[1].count;
    if (NEED(meet, party, j->party_first[2], 0) || NEED(meet, entries, 2 * STENCIL * (size_t)j->party_first[2], 0))
        return -1;
    run(j, j->party_first[2], list_entries);
    int status = touch_all(j);
    // Two sweeps in a row without work: nothing will change any more.
    for (int k = 0, idle = 0; !status && k < j->m->iterations && idle < 2; k++) {
        j->master = (k + j->m->step) % 2 != 0;
        idle = sweep(j) ? 0 : idle + 1;
    }
    if (!status && !j->affine && !meet->held[who->a] && !meet->held[who->b]) repair_moment(j);
    if (!status) status = note(j, who);
    untouch_all(meet);
    return status;
}

// ------------------------------------------------------------------------------------------ a step

static void find_held(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_contact_surface *s = j->skin;
    for (int64_t k = begin; k < end; k++) {
        j->meet->held[k] = false;
        if (!s->active[k]) continue;
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1]; n++)
            for (int a = 0; a < s->dim; a++) j->meet->held[k] |= !(s->inverse[n][a] > 0);
    }
}

static int prepare(job *j) {
    brunt_augury_meet *meet = j->meet;
    const brunt_contact_surface *s = j->skin;
    if (NEED(meet, touched_of, s->node_count, meet->marked_nodes) ||
        NEED(meet, face_of, s->face_count, meet->marked_faces) || NEED(meet, held, s->fem_count, 0))
        return -1;
    for (; meet->marked_nodes < s->node_count; meet->marked_nodes++) meet->touched_of[meet->marked_nodes] = -1;
    for (; meet->marked_faces < s->face_count; meet->marked_faces++) meet->face_of[meet->marked_faces] = -1;
    meet->impulse_count = meet->deed_count = 0;
    brunt_parallel(j->m->threads, s->fem_count, 1, find_held, j, j->m->timer);
    return brunt_augury_near_runs(&j->w->near, s, j->m->threads, j->m->timer);
}

static void book(const job *j) {
    for (int32_t k = 0; k < j->meet->deed_count; k++) {
        const deed *d = &j->meet->deed[k];
        brunt_impulse_account *action = &j->m->pairs[d->pair].last;
        double loss = 0;
        for (int32_t i = d->first; i < d->end; i++) {
            const brunt_augury_impulse *J = &j->meet->impulse[i];
            loss += brunt_augury_book(j->skin, action, J, j->skin->body[J->node] == d->body_b);
        }
        action->friction_loss += d->friction_loss;
        action->normal_loss += loss - d->friction_loss;
        action->area += d->area;
    }
}

int brunt_augury_surface(const brunt_contact_context *m, bool affine, brunt_augury_workspace **work) {
    brunt_augury_workspace *w = brunt_augury_work(work);
    if (!w) return -1;
    if (!w->meet && !(w->meet = brunt_alloc(sizeof *w->meet))) return -1;
    if (brunt_augury_near_find(&w->near, m, REACH * m->cell)) return -1;
    if (!w->near.count) return 0;
    job j = {.m = m, .skin = m->skin, .w = w, .meet = w->meet, .affine = affine};
    if (prepare(&j)) return -1;
    for (int32_t k = 0; k < w->near.count; k++)
        if (meet_pair(&j, &w->near.found[k])) return -1;
    book(&j);
    return 0;
}
