// The surfaces as a step sees them: bounds, positions, velocities, normals; and velocities back to the bodies.
#include "contact/surface/surface_parts.h"

#include <math.h>
#include <string.h>

#include "base/parallel.h"

enum { GRAIN = BRUNT_SURFACE_GRAIN, PIECE = BRUNT_SURFACE_PIECE };
// Nodes of a surface are anywhere among those of their body: what a loop comes to so many later is fetched meanwhile.
enum { AHEAD = 12 };
// Share of a node's faces, by area, that must be left of their sum for it to have a normal, where elements have left:
// that of a cube's corner is 0.58, of four faces of a wall and two at its end 0.33. Below, faces look every way, and
// the little that is left of them points anywhere.
static const double CLEAR = 0.3;

typedef struct job {
    brunt_contact_surface *surface;
    double dt;
    const double *gravity;
} job;

static int32_t first_piece(const brunt_contact_surface *s, int k) { return s->node_range[k] / PIECE + k; }

// The last body whose pieces, of so many nodes, begin at `piece` or before.
static int body_of_piece(const brunt_contact_surface *s, int32_t size, int32_t piece) {
    int low = 0, high = s->fem_count;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        *(s->node_range[middle] / size + middle <= piece ? &low : &high) = middle;
    }
    return low;
}

// The place of a node. What was told of it, if it was near something, is taken back.
static inline void take_place(brunt_contact_surface *s, int32_t n, const real *at) {
    for (int a = 0; a < 3; a++) s->motion.was[n][a] = s->x[n][a], s->x[n][a] = (double)at[a];
    if (s->motion.near[n]) {
        for (int a = 0; a < 3; a++) s->output.impulse[n][a] = 0;
        s->output.gap[n] = INFINITY;
        s->output.state[n] = 0;
    }
    s->motion.near[n] = s->face_first[n + 1] == s->face_first[n];
}

// Bounds of pieces; and the places of what was active a step ago, which most often still is.
static void bound_pieces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_contact_surface *s = ((const job *)context)->surface;
    int k = body_of_piece(s, PIECE, (int32_t)begin);
    for (int64_t p = begin; p < end; p++) {
        while (k + 1 < s->fem_count && first_piece(s, k + 1) <= p) k++;
        double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
        double sum[3] = {0}, fastest = 0;
        const int32_t first = s->node_range[k] + ((int32_t)p - first_piece(s, k)) * PIECE;
        for (int32_t n = first; n < first + PIECE && n < s->node_end[k]; n++) {
            const real *at = brunt_fem_node(s->fem[k], s->node[n]);
            if (n + AHEAD < s->node_end[k]) __builtin_prefetch(brunt_fem_node(s->fem[k], s->node[n + AHEAD]));
            double square = 0;
            for (int a = 0; a < 3; a++) {
                double x = (double)at[a], v = (double)at[BRUNT_FEM_V + a], own = v - s->motion.frame[a];
                low[a] = x < low[a] ? x : low[a], high[a] = x > high[a] ? x : high[a];
                sum[a] += v;
                square += own * own;
            }
            fastest = square > fastest ? square : fastest;
            if (s->motion.was_active[k]) take_place(s, n, at);
        }
        struct brunt_surface_piece *piece = &s->motion.piece[p];
        memcpy(piece->low, low, sizeof low), memcpy(piece->high, high, sizeof high);
        memcpy(piece->sum, sum, sizeof sum);
        piece->fastest = fastest;
    }
}

// Of its pieces, in their order.
static void bound_body(brunt_contact_surface *s, int k) {
    const int32_t count = s->node_end[k] - s->node_range[k], first = first_piece(s, k);
    struct brunt_surface_piece all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, {0}, 0};
    for (int32_t p = first; p < first + (count + PIECE - 1) / PIECE; p++) {
        const struct brunt_surface_piece *piece = &s->motion.piece[p];
        for (int a = 0; a < 3; a++) {
            all.low[a] = piece->low[a] < all.low[a] ? piece->low[a] : all.low[a];
            all.high[a] = piece->high[a] > all.high[a] ? piece->high[a] : all.high[a];
            all.sum[a] += piece->sum[a];
        }
        all.fastest = piece->fastest > all.fastest ? piece->fastest : all.fastest;
    }
    for (int a = 0; a < 3; a++) {
        s->low[k][a] = all.low[a], s->high[k][a] = all.high[a];
        s->motion.mean[k][a] = count ? all.sum[a] / count : 0;
    }
    s->motion.speed[k] = sqrt(all.fastest);
}

void brunt_surface_bounds(brunt_contact_surface *s, int threads, brunt_timer *timer) {
    job j = {.surface = s};
    if (!s->fem_count) return;
    const int64_t pieces = s->node_range[s->fem_count] / PIECE + s->fem_count;
    brunt_parallel(threads, pieces, 1, bound_pieces, &j, timer);
    for (int k = 0; k < s->fem_count; k++) bound_body(s, k);
}

static void find_speeds(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_contact_surface *s = ((const job *)context)->surface;
    for (int64_t k = begin; k < end; k++) {
        const real *v = s->fem[k]->node + BRUNT_FEM_V;
        double fastest = 0;
#pragma GCC unroll 4
        for (int32_t n = s->node_range[k]; n < s->node_end[k]; n++) {
            const real *at = v + (size_t)s->node[n] * BRUNT_FEM_NODE_REALS;
            const double square = (double)(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
            fastest = fastest > square ? fastest : square;
        }
        s->motion.speed[k] = sqrt(fastest);
    }
}

void brunt_surface_rest(brunt_contact_surface *s, bool anew, int threads, brunt_timer *timer) {
    job j = {.surface = s};
    memset(s->motion.frame, 0, sizeof s->motion.frame);
    memset(s->motion.frame_step, 0, sizeof s->motion.frame_step);
    if (anew) brunt_surface_bounds(s, threads, timer);
    brunt_parallel(threads, s->fem_count, 1, find_speeds, &j, timer);
    for (int k = 0; k < s->fem_count; k++) {
        double *kept = s->motion.kept[k];
        if (anew) {
            memcpy(kept, s->low[k], sizeof s->low[k]), memcpy(kept + 3, s->high[k], sizeof s->high[k]);
            s->motion.travel[k] = 0;
        }
        for (int a = 0; a < s->dim; a++) {
            s->low[k][a] = kept[a] - s->motion.travel[k];
            s->high[k][a] = kept[3 + a] + s->motion.travel[k];
        }
    }
    s->motion.rests = true;
}

void brunt_surface_rest_moves(brunt_contact_surface *s, double dt) {
    for (int k = 0; k < s->fem_count; k++) s->motion.travel[k] += s->motion.speed[k] * dt * (1 + 1e-6);
}

// The first node or face from `item` on, by their `range`, that an active body has; `k` becomes that body.
static int32_t next_active(const brunt_contact_surface *s, const int32_t *range, int32_t item, int *k) {
    for (; *k < s->fem_count && (range[*k + 1] <= item || !s->active[*k]); ++*k)
        if (item < range[*k + 1]) item = range[*k + 1];
    return item;
}

// Those that bounds did not ask for: of bodies that become active, and of the backs of membranes.
static void gather_places(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_contact_surface *s = ((const job *)context)->surface;
    int k = 0;
    for (int32_t n = (int32_t)begin; (n = next_active(s, s->node_range, n, &k)) < end; n++)
        if (!s->motion.was_active[k] || n >= s->node_end[k]) take_place(s, n, brunt_fem_node(s->fem[k], s->node[n]));
}

static void make_normal(brunt_contact_surface *s, int k, int32_t n) {
    double sum[3] = {0}, area = 0, whole = 0, size = 0;
    for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++) {
        int32_t f = s->face_of[q];
        double share = s->face_area[f] / brunt_face_corners(s->face[f]);
        area += share;
        whole += brunt_surface_nodal_area(s, f, n);
        for (int a = 0; a < 3; a++) sum[a] += share * s->face_normal[f][a];
    }
    if (s->axisymmetric && s->x[n][0] == 0) sum[0] = 0; // the other side of the axis
    for (int a = 0; a < 3; a++) size += sum[a] * sum[a];
    size = sqrt(size);
    s->area[n] = whole;
    const bool eroded = s->renewal.eroded && s->renewal.eroded[s->body[n]] && !s->fem[k]->traits->membrane;
    for (int a = 0; a < 3; a++) s->normal[n][a] = size > (eroded ? CLEAR : 1e-9) * area ? sum[a] / size : 0;
}

static inline void fetch_force(const brunt_fem_body *fem, int32_t node) {
    __builtin_prefetch(brunt_fem_node(fem, node));
    for (int32_t k = fem->partial_first[node]; k < fem->partial_first[node + 1]; k++)
        __builtin_prefetch(fem->partial + (size_t)fem->partial_of[k] * 4);
}

// Of the nodes that are near something: velocities, masses and normals, and how far they have gone.
static void gather_near(const job *j, int k, int32_t begin, int32_t end, struct brunt_surface_way *way) {
    brunt_contact_surface *s = j->surface;
    const brunt_fem_body *fem = s->fem[k];
    for (int32_t n = begin; n < end; n++) {
        if (!s->motion.near[n]) continue;
        const int32_t node = s->node[n];
        const real *at = brunt_fem_node(fem, node);
        if (n + AHEAD < end && s->motion.near[n + AHEAD]) fetch_force(fem, s->node[n + AHEAD]);
        real force[3];
        brunt_fem_internal_force(fem, node, force);
        double inverse = 1 / (double)at[BRUNT_FEM_MASS];
        s->mass[n] = fem->damping_mass * (double)at[BRUNT_FEM_MASS]; // drag takes its share of impulses
        for (int a = 0; a < 3; a++) {
            bool held = (fem->held && fem->held[node] >> a & 1) || a >= s->dim;
            double load = (double)force[a] + (fem->load ? (double)fem->load[4 * (size_t)node + (size_t)a] : 0);
            const double x = s->x[n][a], step = x - s->motion.was[n][a];
            way->low[a] = step < way->low[a] ? step : way->low[a];
            way->high[a] = step > way->high[a] ? step : way->high[a];
            way->from[a] = x < way->from[a] ? x : way->from[a], way->to[a] = x > way->to[a] ? x : way->to[a];
            s->v[n][a] = (double)at[BRUNT_FEM_V + a];
            s->old[n][a] = held ? s->v[n][a] : s->v[n][a] - j->dt * (load * inverse + j->gravity[a]);
            s->inverse[n][a] = held ? 0 : inverse / fem->damping_mass;
        }
        make_normal(s, k, n);
    }
}

static void gather_chunks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_contact_surface *s = j->surface;
    for (int64_t c = begin; c < end; c++) {
        const int k = body_of_piece(s, GRAIN, (int32_t)c);
        const int32_t first = s->node_range[k] + ((int32_t)c - brunt_surface_chunk(s, k, s->node_range[k])) * GRAIN,
                      last = first + GRAIN < s->node_range[k + 1] ? first + GRAIN : s->node_range[k + 1];
        struct brunt_surface_way way = brunt_surface_no_way();
        if (s->active[k]) gather_near(j, k, first, last, &way);
        s->motion.chunk[c] = way;
    }
}

void brunt_surface_gather_state(brunt_contact_surface *s, double dt, const double gravity[3], int threads,
                                brunt_timer *timer) {
    job j = {s, dt, gravity};
    bool more = s->membrane.front;
    for (int k = 0; k < s->fem_count; k++) more = more || (s->active[k] && !s->motion.was_active[k]);
    if (more) brunt_parallel(threads, s->node_count, GRAIN, gather_places, &j, timer);
    brunt_surface_make_faces(s, threads, timer);
    if (s->fem_count) brunt_parallel(threads, brunt_surface_chunks(s), 1, gather_chunks, &j, timer);
    brunt_surface_compare_ways(s, threads, timer);
    for (int k = 0; k < s->fem_count; k++) {
        s->motion.anew[k] = s->active[k] && !s->motion.was_active[k];
        s->motion.was_active[k] = s->active[k];
    }
}

static void scatter_nodes(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_contact_surface *s = ((const job *)context)->surface;
    int k = 0;
    for (int32_t n = (int32_t)begin; (n = next_active(s, s->node_range, n, &k)) < end; n++) {
        if (n + AHEAD < s->node_end[k]) __builtin_prefetch(brunt_fem_node(s->fem[k], s->node[n + AHEAD]), 1);
        if (n >= s->node_end[k] || !s->motion.near[n]) continue;
        real *at = brunt_fem_node(s->fem[k], s->node[n]);
        for (int a = 0; a < 3; a++) at[BRUNT_FEM_V + a] = (real)s->v[n][a];
    }
}

void brunt_surface_scatter_velocity(brunt_contact_surface *s, double dt, int threads, brunt_timer *timer) {
    job j = {.surface = s};
    brunt_parallel(threads, s->node_count, GRAIN, scatter_nodes, &j, timer);
    for (int a = 0; a < 3; a++) {
        s->motion.frame[a] = 0;
        for (int k = 0; k < s->fem_count; k++) s->motion.frame[a] += s->motion.mean[k][a] / s->fem_count;
        s->motion.frame_step[a] = s->motion.frame[a] * dt;
    }
}
