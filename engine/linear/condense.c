#include "linear/condense.h"

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "linear/assembly.h"

enum { BODY_GRAIN = 8 };
static const char WHAT[] = "bodies to condense";

// ------------------------------------------------------------------------------------------ dense matrices

// A = U^T U of the upper triangle, in place. False: it is not positive definite.
static bool take_factor(int n, double *a) {
    for (int k = 0; k < n; k++) {
        double *top = a + (int64_t)k * n;
        if (!(top[k] > 0)) return false;
        const double part = 1 / sqrt(top[k]);
        for (int j = k; j < n; j++) top[j] *= part;
        for (int i = k + 1; i < n; i++) {
            const double f = top[i];
            double *row = a + (int64_t)i * n;
            if (f == 0) continue;
            for (int j = i; j < n; j++) row[j] -= f * top[j];
        }
    }
    return true;
}

// Y += f X
static void add_row(int m, double f, const double *X, double *Y) {
    for (int j = 0; j < m; j++) Y[j] += f * X[j];
}

// X = (U^T U)^-1 X, of m columns.
static void solve_rows(int n, const double *U, int m, double *X) {
    for (int k = 0; k < n; k++) {
        double *x = X + (int64_t)k * m;
        for (int j = 0; j < m; j++) x[j] /= U[(int64_t)k * n + k];
        for (int i = k + 1; i < n; i++)
            if (U[(int64_t)k * n + i] != 0) add_row(m, -U[(int64_t)k * n + i], x, X + (int64_t)i * m);
    }
    for (int k = n - 1; k >= 0; k--) {
        double *x = X + (int64_t)k * m;
        for (int i = k + 1; i < n; i++)
            if (U[(int64_t)k * n + i] != 0) add_row(m, -U[(int64_t)k * n + i], X + (int64_t)i * m, x);
        for (int j = 0; j < m; j++) x[j] /= U[(int64_t)k * n + k];
    }
}

static double dot(int n, const double *a, const double *b) {
    double s[4] = {0};
    int i = 0;
    for (; i + 4 <= n; i += 4)
        for (int q = 0; q < 4; q++) s[q] += a[i + q] * b[i + q];
    for (; i < n; i++) s[0] += a[i] * b[i];
    return (s[0] + s[1]) + (s[2] + s[3]);
}

// The same of one column.
static void solve_one(int n, const double *U, double *x) {
    for (int k = 0; k < n; k++) {
        const double *row = U + (int64_t)k * n;
        x[k] /= row[k];
        add_row(n - k - 1, -x[k], row + k + 1, x + k + 1);
    }
    for (int k = n - 1; k >= 0; k--) {
        const double *row = U + (int64_t)k * n;
        x[k] = (x[k] - dot(n - k - 1, row + k + 1, x + k + 1)) / row[k];
    }
}

// A of `all` nodes without those gone: S of the kept ones, U and C of the gone; `side` is room for what C has.
typedef struct parted {
    int dim, all, kept_count, gone_count;
    const double *A;
    const int32_t *kept, *gone;
    double *S, *U, *C;
} parted;

// Rows and columns of A for lists of nodes.
static void take_part(const parted *p, const int32_t *rows, int m, const int32_t *columns, int n, double *part) {
    const int dim = p->dim;
    for (int a = 0; a < m * dim; a++)
        for (int b = 0; b < n * dim; b++)
            part[(int64_t)a * n * dim + b] =
                p->A[(int64_t)(rows[a / dim] * dim + a % dim) * p->all * dim + columns[b / dim] * dim + b % dim];
}

static bool reduce(const parted *p, double *side) {
    const int dim = p->dim, k = p->kept_count * dim, g = p->gone_count * dim;
    take_part(p, p->kept, p->kept_count, p->kept, p->kept_count, p->S);
    take_part(p, p->gone, p->gone_count, p->gone, p->gone_count, p->U);
    take_part(p, p->gone, p->gone_count, p->kept, p->kept_count, p->C);
    memcpy(side, p->C, (size_t)g * (size_t)k * sizeof *side);
    if (!take_factor(g, p->U)) return false;
    solve_rows(g, p->U, k, p->C);
    for (int i = 0; i < g; i++)
        for (int a = 0; a < k; a++)
            if (side[(int64_t)i * k + a] != 0)
                add_row(k, -side[(int64_t)i * k + a], p->C + (int64_t)i * k, p->S + (int64_t)a * k);
    for (int a = 0; a < k; a++)
        for (int b = 0; b < a; b++) {
            double *one = &p->S[(int64_t)a * k + b], *other = &p->S[(int64_t)b * k + a];
            *one = *other = 0.5 * (*one + *other);
        }
    return true;
}

// ------------------------------------------------------------------------------------------ meshes

// About the middle of the nodes, turns by their mean distance from it: about z, in three dimensions about x and y as
// well.
static void take_modes(brunt_condensed_mesh *mesh, const double *x) {
    const int dim = mesh->dim;
    double middle[3] = {0}, square = 0;
    for (int k = 0; k < mesh->nodes * dim; k++) middle[k % dim] += x[k] / mesh->nodes;
    for (int k = 0; k < mesh->nodes * dim; k++) square += (x[k] - middle[k % dim]) * (x[k] - middle[k % dim]);
    const double size = sqrt(square / mesh->nodes);
    for (int k = 0; k < mesh->nodes * dim; k++) {
        const int a = k % dim, n = k / dim;
        double *mode = mesh->mode + k * mesh->motions;
        for (int m = 0; m < mesh->motions; m++) mode[m] = m == a;
        for (int p = 0; p < mesh->motions - dim; p++) { // from axis `one` to axis `other`
            const int one = p == 1, other = p == 0 ? 1 : 2;
            if (a == one) mode[dim + p] = -(x[n * dim + other] - middle[other]) / size;
            if (a == other) mode[dim + p] = (x[n * dim + one] - middle[one]) / size;
        }
    }
}

int brunt_condensed_mesh_make(brunt_condensed_mesh *mesh, int dim, int nodes, const double *K, const double *x,
                              const uint8_t *on_rim, brunt_error *error) {
    *mesh = (brunt_condensed_mesh){.dim = dim, .motions = dim * (dim + 1) / 2, .nodes = nodes};
    for (int n = 0; n < nodes; n++) *(on_rim[n] ? &mesh->rim_count : &mesh->inner_count) += 1;
    const size_t rim = (size_t)(mesh->rim_count * dim), inner = (size_t)(mesh->inner_count * dim);
    double *side;
    int status = BRUNT_NEW(side, inner * rim + 1, WHAT, error);
    if (!status)
        status = BRUNT_NEW(mesh->rim, rim + 1, WHAT, error) || BRUNT_NEW(mesh->inner, inner + 1, WHAT, error) ||
                 BRUNT_NEW(mesh->mode, nodes * dim * mesh->motions, WHAT, error) ||
                 BRUNT_NEW(mesh->K, rim * rim + 1, WHAT, error) || BRUNT_NEW(mesh->U, inner * inner + 1, WHAT, error) ||
                 BRUNT_NEW(mesh->C, inner * rim + 1, WHAT, error);
    if (!status) {
        int r = 0, i = 0;
        take_modes(mesh, x);
        for (int n = 0; n < nodes; n++) *(on_rim[n] ? &mesh->rim[r++] : &mesh->inner[i++]) = n;
        const parted p = {dim,       nodes,       mesh->rim_count, mesh->inner_count, K,
                          mesh->rim, mesh->inner, mesh->K,         mesh->U,           mesh->C};
        if (!reduce(&p, side))
            status = brunt_fail(error, BRUNT_FAILED,
                                "the Hessian of a mesh of %d nodes is not positive definite with "
                                "its rim held",
                                nodes);
    }
    brunt_free(side);
    if (status) brunt_condensed_mesh_free(mesh);
    return status ? BRUNT_FAILED : BRUNT_OK;
}

void brunt_condensed_mesh_free(brunt_condensed_mesh *mesh) {
    brunt_free(mesh->rim), brunt_free(mesh->inner), brunt_free(mesh->K), brunt_free(mesh->U), brunt_free(mesh->C);
    brunt_free(mesh->mode);
    *mesh = (brunt_condensed_mesh){0};
}

// ------------------------------------------------------------------------------------------ bodies

// Nodes that hold a body, and one to spare.
static int least_kept(const brunt_condensed_mesh *mesh) { return mesh->dim + 1; }

static int make_body(brunt_condensation *c, int k, brunt_error *error) {
    brunt_condensed_body *b = &c->body[k];
    const brunt_condensed_mesh *mesh = b->mesh;
    const int dim = mesh->dim;
    const size_t rim = (size_t)mesh->rim_count, size = rim * (size_t)dim, all = (size_t)(mesh->nodes * dim);
    BRUNT_ASSERT(b->base + mesh->nodes <= c->nodes && mesh->rim_count >= least_kept(mesh));
    for (int i = 0; i < mesh->rim_count; i++)
        c->owner[b->base + mesh->rim[i]] = k, c->place[b->base + mesh->rim[i]] = i;
    for (int i = 0; i < mesh->inner_count; i++)
        c->owner[b->base + mesh->inner[i]] = k, c->place[b->base + mesh->inner[i]] = -1 - i;
    return BRUNT_NEW(b->touched, rim, WHAT, error) || BRUNT_NEW(b->is_kept, rim, WHAT, error) ||
           BRUNT_NEW(b->kept, rim, WHAT, error) || BRUNT_NEW(b->gone, rim, WHAT, error) ||
           BRUNT_NEW(b->parts, size * size, WHAT, error) ||
           BRUNT_NEW(b->carry, size * (size_t)mesh->motions, WHAT, error) || BRUNT_NEW(b->solved, all, WHAT, error);
}

int brunt_condensation_make(brunt_condensation *c, int32_t nodes, int terms, brunt_error *error) {
    int64_t rims = 1;
    for (int k = 0; k < c->count; k++) rims += c->body[k].mesh->rim_count;
    c->nodes = nodes;
    if (BRUNT_NEW(c->owner, nodes + 1, WHAT, error) || BRUNT_NEW(c->place, nodes + 1, WHAT, error) ||
        BRUNT_NEW(c->left_out, terms, WHAT, error) || BRUNT_NEW(c->first, c->count + 1, WHAT, error) ||
        BRUNT_NEW(c->node, rims, WHAT, error))
        return BRUNT_FAILED;
    for (int32_t n = 0; n < nodes; n++) c->owner[n] = -1;
    for (int k = 0; k < c->count; k++)
        if (make_body(c, k, error)) return BRUNT_FAILED;
    return BRUNT_OK;
}

void brunt_condensation_free(brunt_condensation *c) {
    for (int k = 0; c->body && k < c->count; k++) {
        brunt_condensed_body *b = &c->body[k];
        brunt_free(b->touched), brunt_free(b->is_kept), brunt_free(b->kept), brunt_free(b->gone);
        brunt_free(b->parts), brunt_free(b->solved), brunt_free(b->carry);
    }
    brunt_free(c->body), brunt_free(c->owner), brunt_free(c->place), brunt_free(c->left_out);
    brunt_free(c->first), brunt_free(c->node), brunt_free(c->dense);
    *c = (brunt_condensation){0};
}

size_t brunt_condensation_bytes(const brunt_condensation *c) {
    size_t numbers = 0;
    for (int k = 0; k < c->count; k++) {
        const brunt_condensed_mesh *mesh = c->body[k].mesh;
        const size_t rim = (size_t)(mesh->rim_count * mesh->dim);
        numbers += rim * rim + (size_t)(mesh->nodes * mesh->dim);
    }
    return numbers * sizeof(double) + c->dense_capacity;
}

// ------------------------------------------------------------------------------------------ what is touched

// P (P^T P)^-1 of the modes P of kept nodes. False: they are in one place.
static bool take_carry(const brunt_condensed_body *b) {
    const brunt_condensed_mesh *mesh = b->mesh;
    const int dim = mesh->dim, motions = mesh->motions;
    double gram[BRUNT_RIGID * BRUNT_RIGID] = {0};
    for (int k = 0; k < b->kept_count * dim; k++) {
        const double *mode = mesh->mode + (mesh->rim[b->kept[k / dim]] * dim + k % dim) * motions;
        memcpy(b->carry + k * motions, mode, (size_t)motions * sizeof *mode);
        for (int p = 0; p < motions; p++) add_row(motions, mode[p], mode, gram + p * motions);
    }
    if (!take_factor(motions, gram)) return false;
    for (int k = 0; k < b->kept_count * dim; k++) solve_rows(motions, gram, 1, b->carry + k * motions);
    return true;
}

static bool reduce_body(brunt_condensed_body *b) {
    const brunt_condensed_mesh *mesh = b->mesh;
    const int dim = mesh->dim;
    int gone = 0;
    b->kept_count = 0;
    for (int i = 0; i < mesh->rim_count; i++) *(b->is_kept[i] ? &b->kept[b->kept_count++] : &b->gone[gone++]) = i;
    double *side = brunt_alloc(((size_t)gone * (size_t)b->kept_count * (size_t)(dim * dim) + 1) * sizeof *side);
    const int64_t size = (int64_t)b->kept_count * dim, left = (int64_t)gone * dim;
    b->S = b->parts, b->U = b->S + size * size, b->C = b->U + left * left;
    const parted p = {dim, mesh->rim_count, b->kept_count, gone, mesh->K, b->kept, b->gone, b->S, b->U, b->C};
    const bool done = side && reduce(&p, side) && take_carry(b);
    for (int64_t k = 0; k < size * size; k++) b->S[k] *= b->scale;
    if (!done) b->kept_count = 0;
    brunt_free(side);
    return done;
}

static void reduce_bodies(void *context, int64_t begin, int64_t end, int worker) {
    brunt_condensation *c = context;
    (void)worker;
    for (int64_t k = begin; k < end; k++) {
        brunt_condensed_body *b = &c->body[k];
        const int rim = b->mesh->rim_count, least = least_kept(b->mesh);
        for (int q = 0; q < least; q++) b->touched[q * rim / least] = 1;
        if (b->kept_count > 0 && !memcmp(b->touched, b->is_kept, (size_t)rim)) continue;
        memcpy(b->is_kept, b->touched, (size_t)rim);
        reduce_body(b);
    }
}

int brunt_condensation_touch(brunt_condensation *c, const brunt_team *team, brunt_stencils *lists, int *count,
                             bool more, brunt_error *error) {
    if (!c) return BRUNT_OK;
    for (int k = 0; k < c->count && !more; k++) memset(c->body[k].touched, 0, (size_t)c->body[k].mesh->rim_count);
    for (int l = 0; l < *count; l++)
        for (int64_t i = 0; i < (lists[l].count ? lists[l].first[lists[l].count] : 0); i++) {
            const int32_t n = lists[l].node[i];
            if (n >= c->nodes || c->owner[n] < 0) continue;
            BRUNT_ASSERT(c->place[n] >= 0); // surfaces alone are touched
            c->body[c->owner[n]].touched[c->place[n]] = 1;
        }
    brunt_parallel(team->threads, c->count, BODY_GRAIN, reduce_bodies, c, team->timer);
    c->first[0] = 0;
    for (int k = 0; k < c->count; k++) {
        const brunt_condensed_body *b = &c->body[k];
        if (b->kept_count == 0)
            return brunt_fail(error, BRUNT_FAILED,
                              "Body %d of a crowd cannot be condensed onto the nodes that others "
                              "touch: out of memory, or no factor.",
                              k);
        c->first[k + 1] = c->first[k] + b->kept_count;
        for (int i = 0; i < b->kept_count; i++) c->node[c->first[k] + i] = b->base + b->mesh->rim[b->kept[i]];
    }
    for (int k = 0; k < c->count; k++) {
        const int64_t size = (int64_t)c->body[k].kept_count * c->body[k].mesh->dim;
        c->dense_size = size * size > c->dense_size ? size * size : c->dense_size;
    }
    if (BRUNT_CAPACITY(c->dense, (size_t)(c->dense_size * team->threads), 0, WHAT, error)) return BRUNT_FAILED;
    lists[(*count)++] = (brunt_stencils){.count = c->count, .first = c->first, .node = c->node};
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ the matrix

typedef struct fill_work {
    const brunt_condensation *c;
    brunt_block_matrix *m;
} fill_work;

// Row n of the body's becomes that of the unit matrix; what it had on the diagonal is added to `gram`, by rigid
// motions.
static void leave_out(const brunt_condensed_body *b, brunt_block_matrix *m, int n, double *gram) {
    const int dim = b->mesh->dim, motions = b->mesh->motions;
    double *d = brunt_block_matrix_diagonal(m, b->base + n);
    for (int a = 0; a < dim; a++) {
        const double *mode = b->mesh->mode + (n * dim + a) * motions;
        for (int p = 0; p < motions; p++) add_row(motions, d[a * (dim + 1)] * mode[p], mode, gram + p * motions);
        for (int e = 0; e < dim; e++) d[a * dim + e] = e == a;
    }
}

// S, and what rigid motions have of the nodes that are left out, the same of kept ones.
static void take_dense(const brunt_condensed_body *b, const double *gram, double *dense) {
    const int size = b->kept_count * b->mesh->dim, motions = b->mesh->motions;
    memcpy(dense, b->S, (size_t)size * (size_t)size * sizeof *dense);
    for (int i = 0; i < size; i++) {
        double row[BRUNT_RIGID] = {0};
        for (int p = 0; p < motions; p++) add_row(motions, b->carry[i * motions + p], gram + p * motions, row);
        for (int j = 0; j < size; j++)
            for (int p = 0; p < motions; p++) dense[i * size + j] += row[p] * b->carry[j * motions + p];
    }
}

static void fill_bodies(void *context, int64_t begin, int64_t end, int worker) {
    const fill_work *w = context;
    double *dense = w->c->dense + worker * w->c->dense_size;
    for (int64_t k = begin; k < end; k++) {
        const brunt_condensed_body *b = &w->c->body[k];
        const brunt_condensed_mesh *mesh = b->mesh;
        const int32_t *kept = w->c->node + w->c->first[k];
        double gram[BRUNT_RIGID * BRUNT_RIGID] = {0};
        for (int i = 0; i < mesh->inner_count; i++) leave_out(b, w->m, mesh->inner[i], gram);
        for (int i = 0; i < mesh->rim_count - b->kept_count; i++) leave_out(b, w->m, mesh->rim[b->gone[i]], gram);
        take_dense(b, gram, dense);
        brunt_block_matrix_add(w->m, kept, b->kept_count, dense);
    }
}

void brunt_condensation_fill(const brunt_condensation *c, const brunt_team *team, brunt_block_matrix *m) {
    fill_work work = {c, m};
    if (c) brunt_parallel(team->threads, c->count, BODY_GRAIN, fill_bodies, &work, team->timer);
}

// ------------------------------------------------------------------------------------------ right sides, solutions

typedef struct vector_work {
    const brunt_condensation *c;
    double *x;
    void (*each)(const brunt_condensed_body *body, double *x); // x: of its nodes
} vector_work;

enum { SIDE = 1024 }; // components of a body's side, at most

// To or from the components of listed nodes: numbers in the rim (or, `of` NULL, nodes themselves).
typedef struct node_list {
    int dim, count;
    const int32_t *node;
} node_list;

static node_list list_of(const brunt_condensed_mesh *mesh, const int32_t *node, int count) {
    return (node_list){mesh->dim, count, node};
}

static void take_nodes(const double *x, const int32_t *of, node_list l, double *part) {
    for (int i = 0; i < l.count; i++)
        for (int a = 0; a < l.dim; a++) part[i * l.dim + a] = x[(of ? of[l.node[i]] : l.node[i]) * (int64_t)l.dim + a];
}

static void put_nodes(double *x, const int32_t *of, node_list l, const double *part) {
    for (int i = 0; i < l.count; i++)
        for (int a = 0; a < l.dim; a++) x[(of ? of[l.node[i]] : l.node[i]) * (int64_t)l.dim + a] = part[i * l.dim + a];
}

// f_k -= C^T f_g, and f_g becomes K_gg^-1 f_g of the mesh as it is scaled.
static void gather_part(int k, int g, const double *U, const double *C, double scale, double *kept, double *gone) {
    for (int i = 0; i < g; i++) add_row(k, -gone[i], C + (int64_t)i * k, kept);
    solve_one(g, U, gone);
    for (int i = 0; i < g; i++) gone[i] /= scale;
}

static void gather_body(const brunt_condensed_body *b, double *x) {
    const brunt_condensed_mesh *mesh = b->mesh;
    const int dim = mesh->dim, left = mesh->rim_count - b->kept_count;
    double *inner = b->solved + mesh->rim_count * dim, rim[SIDE], kept[SIDE];
    take_nodes(x, NULL, list_of(mesh, mesh->inner, mesh->inner_count), inner);
    take_nodes(x, NULL, list_of(mesh, mesh->rim, mesh->rim_count), rim);
    gather_part(mesh->rim_count * dim, mesh->inner_count * dim, mesh->U, mesh->C, b->scale, rim, inner);
    take_nodes(rim, NULL, list_of(mesh, b->gone, left), b->solved);
    take_nodes(rim, NULL, list_of(mesh, b->kept, b->kept_count), kept);
    gather_part(b->kept_count * dim, left * dim, b->U, b->C, b->scale, kept, b->solved);
    memset(x, 0, (size_t)(mesh->nodes * dim) * sizeof *x);
    put_nodes(x, mesh->rim, list_of(mesh, b->kept, b->kept_count), kept);
}

// x_g -= C x_k
static void spread_part(int k, int g, const double *C, const double *kept, double *gone) {
    for (int i = 0; i < g; i++) gone[i] -= dot(k, C + (int64_t)i * k, kept);
}

static void spread_body(const brunt_condensed_body *b, double *x) {
    const brunt_condensed_mesh *mesh = b->mesh;
    const int dim = mesh->dim, left = mesh->rim_count - b->kept_count;
    double *inner = b->solved + mesh->rim_count * dim, rim[SIDE], kept[SIDE];
    take_nodes(x, mesh->rim, list_of(mesh, b->kept, b->kept_count), kept);
    spread_part(b->kept_count * dim, left * dim, b->C, kept, b->solved);
    put_nodes(x, mesh->rim, list_of(mesh, b->gone, left), b->solved);
    take_nodes(x, NULL, list_of(mesh, mesh->rim, mesh->rim_count), rim);
    spread_part(mesh->rim_count * dim, mesh->inner_count * dim, mesh->C, rim, inner);
    put_nodes(x, NULL, list_of(mesh, mesh->inner, mesh->inner_count), inner);
}

static void run_bodies(void *context, int64_t begin, int64_t end, int worker) {
    const vector_work *w = context;
    (void)worker;
    for (int64_t k = begin; k < end; k++)
        w->each(&w->c->body[k], w->x + (int64_t)w->c->body[k].base * w->c->body[k].mesh->dim);
}

void brunt_condensation_gather(const brunt_condensation *c, const brunt_team *team, double *f) {
    vector_work work = {c, f, gather_body};
    if (c) brunt_parallel(team->threads, c->count, BODY_GRAIN, run_bodies, &work, team->timer);
}

void brunt_condensation_spread(const brunt_condensation *c, const brunt_team *team, double *x) {
    vector_work work = {c, x, spread_body};
    if (c) brunt_parallel(team->threads, c->count, BODY_GRAIN, run_bodies, &work, team->timer);
}

void brunt_condensation_clear(const brunt_condensation *c, double *x) {
    for (int k = 0; c && k < c->count; k++) {
        const brunt_condensed_body *b = &c->body[k];
        const brunt_condensed_mesh *mesh = b->mesh;
        for (int i = 0; i < mesh->nodes; i++) {
            const int place = c->place[b->base + i];
            if (place >= 0 && b->is_kept[place]) continue;
            memset(x + (b->base + i) * (int64_t)mesh->dim, 0, (size_t)mesh->dim * sizeof *x);
        }
    }
}
