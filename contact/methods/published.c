// Contact by grid transfers as published: "A momentum preserving frictional contact algorithm based on affine
// particle-in-cell grid transfers" (augury). Equation numbers are the paper's.
//
// All boundary nodes of all bodies, V = {v, B}, go to one grid and back: H V (10)-(12), (17)-(20), with the spline of
// appendix B (its weights corrected, augury_grid.h), D = cell^2/2. What bodies are to have is V + Delta with
// Delta = G V, G = H - 1 (34), and N times Delta += G W (37), where W is what is not wanted of Delta (42)-(46): all of
// it where it pulls the surface outward, and its tangential part beyond Coulomb's limit. Corrected: the limit is -mu
// dv.n (41), dv_t = dv - (dv.n) n (42), and no slip has no direction (44). tau = dt: v + Delta is what nodes get.
//
// No constraints of the common solver are made of it: it filters velocities, of nodes in contact or not, and has no gap
// that must not close. Coulomb's limit is that of coulomb.h, and impulses are what nodes have been changed by.
//
// Angular momentum is exact for APIC when the spin of B is counted: sum m x v + sum m (B^T : eps).
// Nodes with prescribed motion take part with their mass, as in the paper, and keep their velocity; their supports take
// the impulse. What it cannot do is measured in the tests: it slides hardly at all, and takes energy out of free
// surfaces, each step.
#include <math.h>
#include <string.h>

#include "contact/constraint/coulomb.h"
#include "contact/methods/augury_work.h"
#include "base/array.h"
#include "base/memory.h"
#include "base/parallel.h"

enum { NODE_GRAIN = 128, WIDTH = 4, FIELD_GRAIN = 1024 };

// Mass and momentum, then velocity, of a grid node.
typedef struct blend {
    double mass, v[3];
} blend;

// V of a node, and what the transfers make of it.
typedef struct state {
    double v[3], B[9];
} state;

struct brunt_published_work {
    blend *blend;      // by grid node
    state *in, *delta; // by point of the cloud
    int32_t *pair;     // by body of the surface: where it is recorded, -1: it takes no part
    size_t blend_capacity, in_capacity, delta_capacity, pair_capacity;
};

typedef struct job {
    const brunt_contact_context *m;
    brunt_contact_surface *surface;
    brunt_augury_workspace *w;
    brunt_published_work *filter;
    bool affine;
    double moment; // D [m^2]
} job;

void brunt_published_work_free(brunt_published_work *filter) {
    if (!filter) return;
    brunt_free(filter->blend);
    brunt_free(filter->in);
    brunt_free(filter->delta);
    brunt_free(filter->pair);
    brunt_free(filter);
}

// ------------------------------------------------------------------------------------------ transfers

static void add_mass(void *context, int32_t begin, int32_t end) {
    const job *j = context;
    for (int32_t k = begin; k < end; k++) {
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL];
        int count = brunt_augury_stencil(&j->w->grid, &j->w->cloud[0].point[k], at, w);
        for (int e = 0; e < count; e++) j->filter->blend[at[e]].mass += w[e] * j->surface->mass[j->w->cloud[0].item[k]];
    }
}

// Where the nodes of a stencil lie from its point, in the order of brunt_augury_stencil.
static void stencil_offsets(const brunt_augury_grid *grid, const brunt_augury_point *p,
                            double r[BRUNT_AUGURY_STENCIL][3]) {
    const int deep = grid->dim == 3 ? WIDTH : 1;
    int n = 0;
    for (int c2 = 0; c2 < deep; c2++)
        for (int c1 = 0; c1 < WIDTH; c1++)
            for (int c0 = 0; c0 < WIDTH; c0++, n++) {
                r[n][0] = p->first[0] + c0 * grid->cell;
                r[n][1] = p->first[1] + c1 * grid->cell;
                r[n][2] = p->first[2] + c2 * grid->cell;
            }
}

// (11), (17)
static void add_momentum(void *context, int32_t begin, int32_t end) {
    const job *j = context;
    for (int32_t k = begin; k < end; k++) {
        const brunt_augury_point *p = &j->w->cloud[0].point[k];
        const state *V = &j->filter->in[k];
        const double mass = j->surface->mass[j->w->cloud[0].item[k]];
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL], r[BRUNT_AUGURY_STENCIL][3], C[9];
        int count = brunt_augury_stencil(&j->w->grid, p, at, w);
        if (j->affine) stencil_offsets(&j->w->grid, p, r);
        for (int a = 0; a < 9; a++) C[a] = V->B[a] / j->moment;
        for (int e = 0; e < count; e++) {
            blend *b = &j->filter->blend[at[e]];
            for (int a = 0; a < 3; a++) {
                double v = V->v[a];
                if (j->affine) v += C[3 * a] * r[e][0] + C[3 * a + 1] * r[e][1] + C[3 * a + 2] * r[e][2];
                b->v[a] += w[e] * mass * v;
            }
        }
    }
}

static void clear_momentum(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t i = begin; i < end; i++)
        for (int a = 0; a < 3; a++) j->filter->blend[i].v[a] = 0;
}

static void make_velocity(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t i = begin; i < end; i++) {
        blend *b = &j->filter->blend[i];
        for (int a = 0; a < 3; a++) b->v[a] = b->mass > 0 ? b->v[a] / b->mass : 0;
    }
}

// (19), (20): Delta += G W = H W - W
static void collect_change(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t k = begin; k < end; k++) {
        const brunt_augury_point *p = &j->w->cloud[0].point[k];
        const state *in = &j->filter->in[k];
        state out = {{0}, {0}};
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL], r[BRUNT_AUGURY_STENCIL][3];
        int count = brunt_augury_stencil(&j->w->grid, p, at, w);
        if (j->affine) stencil_offsets(&j->w->grid, p, r);
        for (int e = 0; e < count; e++) {
            const double *v = j->filter->blend[at[e]].v;
            for (int a = 0; a < 3; a++) {
                out.v[a] += w[e] * v[a];
                if (!j->affine) continue;
                for (int b = 0; b < 3; b++) out.B[3 * a + b] += w[e] * v[a] * r[e][b];
            }
        }
        state *delta = &j->filter->delta[k];
        for (int a = 0; a < 3; a++) delta->v[a] += out.v[a] - in->v[a];
        for (int a = 0; a < 9 && j->affine; a++) delta->B[a] += out.B[a] - in->B[a];
    }
}

// Delta += G W, with W in `in`.
static void apply_G(job *j) {
    const int64_t nodes = (int64_t)j->w->grid.block_count * j->w->grid.block_nodes;
    const int threads = j->m->threads;
    brunt_parallel(threads, nodes, FIELD_GRAIN, clear_momentum, j, j->m->timer);
    brunt_augury_scatter(&j->w->grid, &j->w->cloud[0], add_momentum, j, threads, j->m->timer);
    brunt_parallel(threads, nodes, FIELD_GRAIN, make_velocity, j, j->m->timer);
    brunt_parallel(threads, j->w->cloud[0].count, NODE_GRAIN, collect_change, j, j->m->timer);
}

// ------------------------------------------------------------------------------------------ what is not wanted

static int owner(const brunt_contact_surface *s, int32_t node) {
    int low = 0, high = s->fem_count;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (s->node_range[middle] <= node)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static double friction_of(const job *j, int32_t node) {
    return j->m->pairs[j->filter->pair[owner(j->surface, node)]].friction;
}

// The part of a change along the outward normal, and the tangential one with its size. Their allowed size is returned.
static double split(const job *j, int32_t node, const double dv[3], double *along, double tangential[3], double *size) {
    const double *n = j->surface->normal[node];
    *along = dv[0] * n[0] + dv[1] * n[1] + dv[2] * n[2];
    double square = 0;
    for (int a = 0; a < 3; a++) tangential[a] = dv[a] - *along * n[a], square += tangential[a] * tangential[a];
    *size = sqrt(square);
    return brunt_coulomb_size(friction_of(j, node), fmax(0, -*along), *size);
}

// W of (44)-(46)
static void find_unwanted(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t k = begin; k < end; k++) {
        const state *delta = &j->filter->delta[k];
        state *W = &j->filter->in[k];
        double along, tangential[3], size;
        double allowed = split(j, j->w->cloud[0].item[k], delta->v, &along, tangential, &size);
        for (int a = 0; a < 3; a++) {
            double beyond = size > 0 ? tangential[a] * (1 - allowed / size) : 0;
            W->v[a] = along > 0 ? delta->v[a] : beyond;
        }
        for (int a = 0; a < 9 && j->affine; a++) W->B[a] = delta->B[a];
    }
}

// ------------------------------------------------------------------------------------------ a step

static void start_points(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    for (int64_t k = begin; k < end; k++) {
        const int32_t n = j->w->cloud[0].item[k];
        state *in = &j->filter->in[k];
        j->filter->delta[k] = (state){{0}, {0}};
        memcpy(in->v, j->surface->v[n], sizeof in->v);
        if (j->affine)
            memcpy(in->B, j->surface->affine[n], sizeof in->B);
        else
            memset(in->B, 0, sizeof in->B);
    }
}

static void finish_points(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    brunt_contact_surface *s = j->surface;
    for (int64_t k = begin; k < end; k++) {
        const int32_t n = j->w->cloud[0].item[k];
        const state *delta = &j->filter->delta[k];
        for (int a = 0; a < 3; a++)
            if (s->inverse[n][a] > 0) s->v[n][a] += delta->v[a];
        for (int a = 0; a < 9 && j->affine; a++) s->affine[n][a] += delta->B[a];
    }
}

// The account of each body: the first pair of it whose other body is near, else its first. Where more than two bodies
// share nodes, where an impulse comes from is not known: the sums are exact, their division among pairs is nominal.
static int find_pairs(job *j, brunt_error *error) {
    const brunt_contact_context *m = j->m;
    const brunt_contact_surface *s = j->surface;
    brunt_published_work *f = j->filter;
    if (BRUNT_CAPACITY(f->pair, (size_t)s->fem_count + 1, 0, "bodies with surfaces", error) ||
        brunt_augury_near_find(&j->w->near, m, WIDTH * m->cell, error))
        return BRUNT_FAILED;
    for (int k = 0; k < s->fem_count; k++) f->pair[k] = -1;
    for (int32_t q = j->w->near.count - 1; q >= 0; q--) {
        const brunt_augury_neighbours *near = &j->w->near.found[q];
        f->pair[near->a] = f->pair[near->b] = near->pair;
    }
    for (int k = 0; k < s->fem_count; k++) {
        if (!s->active[k] || s->node_range[k + 1] == s->node_range[k])
            f->pair[k] = -1;
        else
            for (int o = 0; o < m->body_count && f->pair[k] < 0; o++) {
                int32_t pair = brunt_pair_of(m->pair_map, brunt_augury_body(s, k), o);
                if (pair >= 0 && m->pairs[pair].meets & BRUNT_MEET_AT_FACETS) f->pair[k] = pair;
            }
    }
    return BRUNT_OK;
}

// The grid under all nodes that take part.
static int make_grid(job *j, brunt_error *error) {
    brunt_augury_workspace *w = j->w;
    const brunt_contact_surface *s = j->surface;
    brunt_augury_grid_start(&w->grid, s->dim, WIDTH, j->m->cell);
    j->moment = brunt_augury_moment(&w->grid);
    w->cloud[0].count = 0;
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_range[k]; n < s->node_range[k + 1] && j->filter->pair[k] >= 0; n++)
            if (brunt_augury_cloud_add(&w->grid, &w->cloud[0], n, s->x[n], error)) return BRUNT_FAILED;
    if (brunt_augury_grid_finish(&w->grid, w->cloud, 1, error)) return BRUNT_FAILED;
    brunt_published_work *f = j->filter;
    size_t nodes = (size_t)w->grid.block_count * (size_t)w->grid.block_nodes + 1,
           points = (size_t)w->cloud[0].count + 1;
    if (BRUNT_CAPACITY(f->blend, nodes, 0, "nodes of the contact grid", error) ||
        BRUNT_CAPACITY(f->in, points, 0, "points in the contact grid", error) ||
        BRUNT_CAPACITY(f->delta, points, 0, "points in the contact grid", error))
        return BRUNT_FAILED;
    memset(f->blend, 0, nodes * sizeof *f->blend);
    return BRUNT_OK;
}

// Friction is what the tangential changes cost that Coulomb allows, where a surface is pushed in.
static void account_losses(job *j) {
    brunt_contact_surface *s = j->surface;
    const brunt_augury_cloud *cloud = &j->w->cloud[0];
    for (int32_t k = 0; k < cloud->count; k++) {
        const int32_t n = cloud->item[k];
        const int body = owner(s, n);
        brunt_pair *pair = &j->m->pairs[j->filter->pair[body]];
        const double *dv = j->filter->delta[k].v;
        brunt_node_impulse J = {n, {0}};
        double along, tangential[3], size, friction_loss = 0;
        double allowed = split(j, n, dv, &along, tangential, &size);
        for (int a = 0; a < s->dim; a++) {
            J.J[a] = s->inverse[n][a] > 0 ? dv[a] / s->inverse[n][a] : s->mass[n] * dv[a];
            double part = size > 0 ? tangential[a] * allowed / size : 0;
            friction_loss -= s->mass[n] * part * 0.5 * (s->old[n][a] + s->v[n][a]);
        }
        double loss = brunt_impulse_account_node(s, &pair->last, &J, s->body[n] == pair->b);
        pair->last.friction_loss += friction_loss;
        pair->last.normal_loss += loss - friction_loss;
    }
}

int brunt_augury_paper(const brunt_contact_context *m, brunt_transfer transfer, brunt_augury_workspace **work,
                       brunt_error *error) {
    brunt_augury_workspace *w = brunt_augury_work(work, error);
    if (!w) return BRUNT_FAILED;
    if (!w->published && BRUNT_NEW(w->published, 1, "room for the published form", error)) return BRUNT_FAILED;
    job j = {.m = m,
             .surface = m->surface,
             .w = w,
             .filter = w->published,
             .affine = transfer == BRUNT_APIC && m->surface->affine};
    if (find_pairs(&j, error) || make_grid(&j, error)) return BRUNT_FAILED;
    const int64_t count = w->cloud[0].count;
    brunt_augury_scatter(&w->grid, &w->cloud[0], add_mass, &j, m->threads, m->timer);
    brunt_parallel(m->threads, count, NODE_GRAIN, start_points, &j, m->timer);
    apply_G(&j);
    for (int k = 0; k < m->iterations; k++) {
        brunt_parallel(m->threads, count, NODE_GRAIN, find_unwanted, &j, m->timer);
        apply_G(&j);
    }
    brunt_parallel(m->threads, count, NODE_GRAIN, finish_points, &j, m->timer);
    account_losses(&j);
    return BRUNT_OK;
}
