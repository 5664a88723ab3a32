// The surfaces as a step sees them: bounds, positions, velocities, normals; and velocities back to the bodies.
#include "contact/surface/surface_parts.h"

#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "base/quad.h"

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

static inline quad quad_of(const real *p) { return (quad){(double)p[0], (double)p[1], (double)p[2], (double)p[3]}; }

// Squares of four vectors.
static inline quad squares_of(const quad v[4]) {
    const quad a = __builtin_shufflevector(v[0], v[1], 0, 4, 1, 5), b = __builtin_shufflevector(v[2], v[3], 0, 4, 1, 5),
               c = __builtin_shufflevector(v[0], v[1], 2, 6, 2, 6), d = __builtin_shufflevector(v[2], v[3], 2, 6, 2, 6),
               x = __builtin_shufflevector(a, b, 0, 1, 4, 5), y = __builtin_shufflevector(a, b, 2, 3, 6, 7),
               z = __builtin_shufflevector(c, d, 0, 1, 4, 5);
    quad square = x * x;
    square += y * y;
    square += z * z;
    return square;
}

// Bounds of the nodes begin .. end of body k; and their places, if it was active a step ago, as it most often still is.
static struct brunt_surface_piece bound_nodes(brunt_contact_surface *s, int k, int32_t begin, int32_t end) {
    const brunt_fem_body *fem = s->fem[k];
    const double *own = s->motion.frame;
    const quad frame = {own[0], own[1], own[2]};
    quad low = quad_set(INFINITY), high = quad_set(-INFINITY), sum = {0}, fastest = {0};
    for (int32_t four = begin; four < end; four += 4) {
        quad v[4] = {{0}, {0}, {0}, {0}};
        for (int i = 0; i < 4 && four + i < end; i++) {
            const int32_t n = four + i;
            const real *at = brunt_fem_node(fem, s->node[n]);
            if (n + AHEAD < end) __builtin_prefetch(brunt_fem_node(fem, s->node[n + AHEAD]));
            const quad x = quad_of(at), velocity = quad_of(at + BRUNT_FEM_V);
            low = quad_min(x, low), high = quad_max(x, high);
            sum += velocity, v[i] = velocity - frame;
            if (s->motion.was_active[k]) take_place(s, n, at);
        }
        fastest = quad_max(squares_of(v), fastest);
    }
    struct brunt_surface_piece piece = {.fastest = 0};
    for (int a = 0; a < 3; a++) piece.low[a] = low[a], piece.high[a] = high[a], piece.sum[a] = sum[a];
    for (int i = 0; i < 4; i++) piece.fastest = fastest[i] > piece.fastest ? fastest[i] : piece.fastest;
    return piece;
}

static void bound_pieces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_contact_surface *s = ((const job *)context)->surface;
    int k = body_of_piece(s, PIECE, (int32_t)begin);
    for (int64_t p = begin; p < end; p++) {
        while (k + 1 < s->fem_count && first_piece(s, k + 1) <= p) k++;
        const int32_t first = s->node_range[k] + ((int32_t)p - first_piece(s, k)) * PIECE, last = first + PIECE;
        s->motion.piece[p] = bound_nodes(s, k, first, last < s->node_end[k] ? last : s->node_end[k]);
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

void brunt_surface_gather_places(brunt_contact_surface *s, int threads, brunt_timer *timer) {
    job j = {.surface = s};
    brunt_surface_bounds(s, threads, timer);
    for (int k = 0; k < s->fem_count; k++) s->active[k] = true;
    brunt_parallel(threads, s->node_count, GRAIN, gather_places, &j, timer);
    brunt_surface_make_faces(s, threads, timer);
}

static inline void make_normal(brunt_contact_surface *s, int k, int32_t n) {
    quad sum = {0};
    double area = 0, whole = 0, size = 0;
    for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++) {
        const int32_t f = s->face_of[q];
        const int corners = brunt_face_corners(s->face[f]);
        const double share = corners == 4 ? 0.25 * s->face_area[f] : s->face_area[f] / corners;
        area += share;
        if (s->axisymmetric) whole += brunt_surface_nodal_area(s, f, n);
        sum += quad_set(share) * quad_load(s->face_normal[f]);
    }
    if (s->axisymmetric && s->x[n][0] == 0) sum[0] = 0; // the other side of the axis
    for (int a = 0; a < 3; a++) size += sum[a] * sum[a];
    size = sqrt(size);
    s->area[n] = s->axisymmetric ? whole : area;
    const bool eroded = s->renewal.eroded && s->renewal.eroded[s->body[n]] && !s->fem[k]->traits->membrane;
    const bool any = size > (eroded ? CLEAR : 1e-9) * area;
    sum = any ? sum / quad_set(size) : (quad){0};
    for (int a = 0; a < 3; a++) s->normal[n][a] = sum[a];
}

// Of the nodes that are near something: velocities, masses and normals, and how far they have gone.
static void gather_near(const job *j, int k, int32_t begin, int32_t end, struct brunt_surface_way *way) {
    brunt_contact_surface *s = j->surface;
    const brunt_fem_body *fem = s->fem[k];
    for (int32_t n = begin; n < end; n++) {
        if (!s->motion.near[n]) continue;
        const int32_t node = s->node[n];
        const real *at = brunt_fem_node(fem, node);
        if (n + AHEAD < end && s->motion.near[n + AHEAD]) {
            __builtin_prefetch(brunt_fem_node(fem, s->node[n + AHEAD]));
            brunt_fem_fetch_force(fem, s->node[n + AHEAD]);
        }
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

// The nodes of one body in a chunk.
typedef struct chunk_of_nodes {
    int body;
    int32_t begin, end;
} chunk_of_nodes;

static chunk_of_nodes chunk_at(const brunt_contact_surface *s, int32_t c) {
    const int k = body_of_piece(s, GRAIN, c);
    const int32_t first = s->node_range[k] + (c - brunt_surface_chunk(s, k, s->node_range[k])) * GRAIN;
    return (chunk_of_nodes){k, first, first + GRAIN < s->node_range[k + 1] ? first + GRAIN : s->node_range[k + 1]};
}

static void gather_chunks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_contact_surface *s = j->surface;
    for (int64_t c = begin; c < end; c++) {
        const chunk_of_nodes of = chunk_at(s, (int32_t)c);
        struct brunt_surface_way way = brunt_surface_no_way();
        if (s->active[of.body]) gather_near(j, of.body, of.begin, of.end, &way);
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

static void scatter_near(const brunt_contact_surface *s, int k, int32_t begin, int32_t end) {
    const brunt_fem_body *fem = s->fem[k];
    for (int32_t n = begin; n < end; n++) {
        if (n + AHEAD < end && s->motion.near[n + AHEAD])
            __builtin_prefetch(brunt_fem_node(fem, s->node[n + AHEAD]), 1);
        if (!s->motion.near[n]) continue;
        real *at = brunt_fem_node(fem, s->node[n]);
        for (int a = 0; a < 3; a++) at[BRUNT_FEM_V + a] = (real)s->v[n][a];
    }
}

static void scatter_chunks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_contact_surface *s = ((const job *)context)->surface;
    for (int64_t c = begin; c < end; c++) {
        const chunk_of_nodes of = chunk_at(s, (int32_t)c);
        if (s->active[of.body])
            scatter_near(s, of.body, of.begin, of.end < s->node_end[of.body] ? of.end : s->node_end[of.body]);
    }
}

void brunt_surface_scatter_velocity(brunt_contact_surface *s, double dt, int threads, brunt_timer *timer) {
    job j = {.surface = s};
    if (s->fem_count) brunt_parallel(threads, brunt_surface_chunks(s), 1, scatter_chunks, &j, timer);
    for (int a = 0; a < 3; a++) {
        s->motion.frame[a] = 0;
        for (int k = 0; k < s->fem_count; k++) s->motion.frame[a] += s->motion.mean[k][a] / s->fem_count;
        s->motion.frame_step[a] = s->motion.frame[a] * dt;
    }
}
