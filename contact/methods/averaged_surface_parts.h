// What the files of contact by averaged surfaces share. Private to them; averaged_surface.c says what it is about.
#pragma once

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "contact/methods/augury_work.h"

enum { WIDTH = 3, STENCIL = 27 };
static const double STENCIL_WIDTH = 3; // [cells] between points that share a node

typedef struct surface_sums {
    double of[4]; // S, s
} surface_sums;

// One body's part of a grid node where both are.
typedef struct side {
    double area, X[3], n[3];     // W, [m], unit
    double mass, fixed[3];       // M [kg], and of the nodes with prescribed component
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

// A node of the surface that is near the other body.
typedef struct averaged_node {
    int32_t node, touched;
    int16_t master_count, slave_count; // of its entries, STENCIL places each
    bool meets, pressed;               // has a master surface; was held back in some sweep
    double n[3], gap;                  // of the master surface, outward
    double u[3], along, target;        // [m/s] this sweep: relative velocity, its normal part, least allowed
    double J[3];                       // [N s] this sweep
    double normal_impulse, friction_impulse, friction_loss; // [N s], [J] in all: sums of sizes
    bool presses;
} averaged_node;

// A node whose velocity this pair may change.
typedef struct changed_node {
    int32_t node;
    bool master;
    double before[3], fixed_impulse[3]; // [m/s], [N s] on prescribed components
    double area, C[9], D[9];            // "smooth": of its facets; grad v; the dipole it takes
} changed_node;

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

// What was done for one pair, recorded when all pairs are through: losses need the final velocities.
typedef struct pair_account {
    int32_t pair, first, end, body_b; // impulses first .. end - 1
    double friction_loss, area;
} pair_account;

#define ARRAYS(X)                                                                                                      \
    X(surface_sums, sums) /* by grid node, 2 each */                                                                   \
    X(int32_t, shared_of) /* by grid node, -1: none */                                                                 \
    X(uint8_t, visitors)  /* by block: bit b, faces of b reach it; bit 2, points in it may reach what both do */       \
    X(heading, heading)   /* d, by shared node */                                                                      \
    X(shared_node, shared)                                                                                             \
    X(entry, entries)               /* by party: STENCIL as master, STENCIL as slave */                                \
    X(averaged_node, averaged_node) /* nodes of a's cloud, then of b's */                                              \
    X(changed_node, touched)                                                                                           \
    X(used_face, face)                                                                                                 \
    X(int32_t, touched_of) /* by node of the surface, -1 between pairs */                                              \
    X(int32_t, face_of)    /* by face of the surface, likewise */                                                      \
    X(bool, fixed)         /* by body of the surface: has prescribed nodes */                                          \
    X(brunt_node_impulse, impulse)                                                                                     \
    X(pair_account, pair_account)

struct brunt_averaged_work {
#define DECLARE(type, name)                                                                                            \
    type *name;                                                                                                        \
    size_t name##_capacity;
    ARRAYS(DECLARE)
#undef DECLARE
    int32_t shared_count, touched_count, face_count, impulse_count, pair_account_count;
    int32_t marked_nodes, marked_faces; // entries of touched_of and face_of that are -1
};

typedef struct averaged_job {
    const brunt_contact_context *m;
    brunt_contact_surface *surface;
    brunt_augury_workspace *w;
    brunt_averaged_work *work;
    bool affine;
    double friction;
    int32_t node_first[3], touched_first[3], face_first[3];
    int of;     // body whose cloud is at work, 0 or 1
    int master; // this sweep
} averaged_job;

#define NEED(work, name, count, keep, what, error)                                                                     \
    BRUNT_CAPACITY((work)->name, (size_t)(count) + 1, (size_t)(keep), what, error)

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static inline double normalise(double a[3]) {
    double size = sqrt(dot(a, a));
    for (int k = 0; k < 3; k++) a[k] = size > 0 ? a[k] / size : 0;
    return size;
}

static inline void cross(const double a[3], const double b[3], double c[3]) {
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, l = (k + 2) % 3;
        c[k] = a[i] * b[l] - a[l] * b[i];
    }
}

static inline entry *entries_of(const averaged_job *j, const averaged_node *p, bool as_master) {
    return j->work->entries + ((p - j->work->averaged_node) * 2 + !as_master) * STENCIL;
}

static inline void give_impulse(const averaged_job *j, changed_node *t, const double F[3]) {
    for (int a = 0; a < 3; a++) {
        double inverse = j->surface->inverse[t->node][a];
        if (inverse > 0)
            j->surface->v[t->node][a] += F[a] * inverse;
        else
            t->fixed_impulse[a] += F[a];
    }
}

// --- averaged_geometry.c: where the two bodies of a pair meet, and their surfaces there
// Points of each body within reach of the other's box, if there are `some` of each. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
int brunt_averaged_collect(averaged_job *j, int a, int b, bool *some, brunt_error *error);
// The grid nodes where the two meet, and the direction there, if there are `some`. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
int brunt_averaged_orient(averaged_job *j, bool *some, brunt_error *error);
// Facing surfaces and masses.
void brunt_averaged_face(averaged_job *j);
// What each node of the two has of the grid, as master and as slave, and where it meets a surface.
void brunt_averaged_list_entries(void *context, int64_t begin, int64_t end, int worker);
// To the grid, from the points of a cloud.
void brunt_averaged_scatter(averaged_job *j, int cloud, brunt_augury_scatter_fn *each);

// --- averaged_gradient.c: velocity gradients of a surface by its facets, and the transpose
void brunt_averaged_make_facets(const brunt_contact_surface *s, used_face *f);
void brunt_averaged_measure_faces(void *context, int64_t begin, int64_t end, int worker);
void brunt_averaged_measure_nodes(void *context, int64_t begin, int64_t end, int worker);
void brunt_averaged_load_faces(void *context, int64_t begin, int64_t end, int worker);
void brunt_averaged_give_dipoles(void *context, int64_t begin, int64_t end, int worker);

// --- averaged_sweep.c
void brunt_averaged_run(averaged_job *j, int64_t count, brunt_task_fn *task);
// One sweep, with nodes of the body other than j->master as slaves. Whether any of them was held back.
bool brunt_averaged_sweep(averaged_job *j);
