// The faces of the surfaces as a step sees them: bounds of all; and of those that are near something, or have a node
// that is, normals, centres and areas.
#include "contact/surface/surface_parts.h"

#include <math.h>

#include "base/parallel.h"
#include "base/quad.h"

enum { GRAIN = BRUNT_SURFACE_GRAIN, AHEAD = 12 }; // AHEAD: faces whose nodes are fetched meanwhile

// What is done with the faces begin .. end of one body. The widest of those that are near [m].
typedef double look_at_faces(brunt_contact_surface *s, int k, int32_t begin, int32_t end);

typedef struct job {
    brunt_contact_surface *surface;
    look_at_faces *look;
    double *widest; // of each chunk; NULL: not asked for
} job;

static void look_at_chunks(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    brunt_contact_surface *s = j->surface;
    int k = 0;
    for (int64_t c = begin; c < end; c++) {
        const int32_t first = (int32_t)c * GRAIN, last = first + GRAIN < s->face_count ? first + GRAIN : s->face_count;
        double widest = 0;
        while (s->face_range[k + 1] <= first) k++;
        for (int body = k; body < s->fem_count && s->face_range[body] < last; body++) {
            const int32_t from = first > s->face_range[body] ? first : s->face_range[body],
                          to = last < s->face_range[body + 1] ? last : s->face_range[body + 1];
            const double wide = s->active[body] ? j->look(s, body, from, to) : 0;
            widest = wide > widest ? wide : widest;
        }
        if (j->widest) j->widest[c] = widest;
    }
}

typedef double pair __attribute__((vector_size(16), aligned(sizeof(double)), may_alias));

static inline void store_three(double *p, quad a) {
    *(pair *)p = __builtin_shufflevector(a, a, 0, 1);
    p[2] = a[2];
}

#define ALWAYS static inline __attribute__((always_inline))

// So many corners of a face, and the last again for those that it has not.
ALWAYS void corners_of(const brunt_contact_surface *s, const int32_t node[4], int n, quad corner[4]) {
    corner[0] = quad_load(s->x[node[0]]), corner[1] = quad_load(s->x[node[1]]);
    corner[2] = n > 2 ? quad_load(s->x[node[2]]) : corner[1];
    corner[3] = n > 3 ? quad_load(s->x[node[3]]) : corner[2];
}

// Of a triangle, or a segment, the first again for those that it has not.
static inline void fetch_corners(const brunt_contact_surface *s, const int32_t node[4]) {
    for (int c = 0; c < 4; c++) __builtin_prefetch(s->x[node[c] < 0 ? node[0] : node[c]]);
}

ALWAYS void make_face(brunt_contact_surface *s, int32_t f, const quad corner[4], int n) {
    const quad p = corner[0], q = corner[1], r = corner[2], t = corner[3], zero = {0};
    const quad e = n > 3 ? r - p : q - p, g = n > 3 ? t - q : r - p,
               centre = (p + q + (n > 2 ? r : zero) + (n > 3 ? t : zero)) / quad_set(n);
    quad normal = {e[1], -e[0]};
    if (n > 2)
        normal = 0.5 * (__builtin_shufflevector(e, e, 1, 2, 0, 3) * __builtin_shufflevector(g, g, 2, 0, 1, 3) -
                        __builtin_shufflevector(e, e, 2, 0, 1, 3) * __builtin_shufflevector(g, g, 1, 2, 0, 3));
    double size = 0;
    for (int a = 0; a < 3; a++) size += normal[a] * normal[a];
    size = sqrt(size);
    s->face_area[f] = size;
    store_three(s->face_centre[f], centre);
    store_three(s->face_normal[f], size > 0 ? normal / quad_set(size) : zero);
}

// Room about what is near a body; the widest face that reaches into it.
typedef struct near_zone {
    quad low, high, widest;
} near_zone;

// Bounds; and what reaches into the zone is made, and its nodes are marked, which several threads may.
ALWAYS void bound_face(brunt_contact_surface *s, int32_t f, int n, near_zone *zone) {
    const int32_t *node = s->face[f];
    quad corner[4];
    corners_of(s, node, n, corner);
    const quad low = quad_min(quad_min(corner[2], corner[3]), quad_min(corner[0], corner[1])),
               high = quad_max(quad_max(corner[2], corner[3]), quad_max(corner[0], corner[1]));
    store_three(s->face_box[f], low), store_three(s->face_box[f] + 3, high);
    s->motion.made[f] = !(quad_bits((low > zone->high) | (high < zone->low)) & 7);
    if (!s->motion.made[f]) return;
    zone->widest = quad_max(high - low, zone->widest);
    for (int c = 0; c < n; c++) __atomic_store_n(&s->motion.near[node[c]], 1, __ATOMIC_RELAXED);
    make_face(s, f, corner, n);
}

static double bound_faces(brunt_contact_surface *s, int k, int32_t begin, int32_t end) {
    const double *room = s->motion.zone[k];
    near_zone zone = {{room[0], room[1], room[2]}, {room[3], room[4], room[5]}, {0}};
    for (int32_t f = begin; f < end; f++) {
        if (f + AHEAD < end) fetch_corners(s, s->face[f + AHEAD]);
        const int n = brunt_face_corners(s->face[f]);
        if (n == 4)
            bound_face(s, f, 4, &zone);
        else
            bound_face(s, f, n, &zone);
    }
    return fmax(fmax(zone.widest[0], zone.widest[1]), zone.widest[2]);
}

// The other faces of nodes that are near, whose normals and areas they share in.
static double make_others(brunt_contact_surface *s, int k, int32_t begin, int32_t end) {
    (void)k;
    for (int32_t f = begin; f < end; f++) {
        if (s->motion.made[f]) continue;
        const int32_t *node = s->face[f];
        bool near = false;
        for (int c = 0; c < brunt_face_corners(node); c++) near = near || s->motion.near[node[c]];
        if (!near) continue;
        const int n = brunt_face_corners(node);
        quad corner[4];
        corners_of(s, node, n, corner);
        make_face(s, f, corner, n);
        s->motion.made[f] = 1;
    }
    return 0;
}

void brunt_surface_make_faces(brunt_contact_surface *s, int threads, brunt_timer *timer) {
    const int64_t chunks = (s->face_count + GRAIN - 1) / GRAIN;
    brunt_parallel(threads, chunks, 1, look_at_chunks, &(job){s, bound_faces, s->motion.widest}, timer);
    brunt_parallel(threads, chunks, 1, look_at_chunks, &(job){s, make_others, NULL}, timer);
}
