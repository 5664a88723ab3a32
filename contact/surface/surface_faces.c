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

static inline void store_three(double *p, quad a) {
    for (int k = 0; k < 3; k++) p[k] = a[k];
}

// The corners of a face, the last for those that it has not.
static inline int corners_of(const brunt_contact_surface *s, const int32_t node[4], quad corner[4]) {
    const int n = brunt_face_corners(node);
    for (int c = 0; c < 4; c++) corner[c] = quad_load(s->x[node[c < n ? c : n - 1]]);
    return n;
}

static inline void make_face(brunt_contact_surface *s, int32_t f, const quad corner[4], int n) {
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

// Bounds; and what reaches into the room about what is near the body is made, and its nodes are marked, which several
// threads may.
static double bound_faces(brunt_contact_surface *s, int k, int32_t begin, int32_t end) {
    const double *zone = s->motion.zone[k];
    const quad from = {zone[0], zone[1], zone[2]}, to = {zone[3], zone[4], zone[5]};
    double widest = 0;
    for (int32_t f = begin; f < end; f++) {
        const int32_t *node = s->face[f];
        if (f + AHEAD < end)
            for (int c = 0; c < brunt_face_corners(s->face[f + AHEAD]); c++)
                __builtin_prefetch(s->x[s->face[f + AHEAD][c]]);
        quad corner[4];
        const int n = corners_of(s, node, corner);
        const quad low = quad_min(quad_min(corner[2], corner[3]), quad_min(corner[0], corner[1])),
                   high = quad_max(quad_max(corner[2], corner[3]), quad_max(corner[0], corner[1]));
        store_three(s->face_box[f], low), store_three(s->face_box[f] + 3, high);
        s->motion.made[f] = !(quad_bits((low > to) | (high < from)) & 7);
        if (!s->motion.made[f]) continue;
        const quad way = high - low;
        for (int a = 0; a < 3; a++) widest = way[a] > widest ? way[a] : widest;
        for (int c = 0; c < n; c++) __atomic_store_n(&s->motion.near[node[c]], 1, __ATOMIC_RELAXED);
        make_face(s, f, corner, n);
    }
    return widest;
}

// The other faces of nodes that are near, whose normals and areas they share in.
static double make_others(brunt_contact_surface *s, int k, int32_t begin, int32_t end) {
    (void)k;
    for (int32_t f = begin; f < end; f++) {
        const int32_t *node = s->face[f];
        if (s->motion.made[f]) continue;
        bool near = false;
        for (int c = 0; c < brunt_face_corners(node); c++) near = near || s->motion.near[node[c]];
        if (!near) continue;
        quad corner[4];
        const int n = corners_of(s, node, corner);
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
