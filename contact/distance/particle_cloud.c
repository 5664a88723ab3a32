// Extents of what a body has near a place, and its volume fraction there: sums and maxima over rows of numbers, a
// register of particles at once.
//
// Along a unit vector n an ellipsoid ends sqrt(n . B n) from its centre, at the point x + B n / sqrt(n . B n).
#include "contact/distance/particle_cloud.h"

#include <math.h>

#include "base/array.h"
#include "base/memory.h"
#include "base/simd.h"

int brunt_cloud_reserve(brunt_cloud *cloud, int count, brunt_error *error) {
    cloud->stride = ((size_t)count / BRUNT_SPARE + 2) * BRUNT_SPARE;
    cloud->count = cloud->runs = 0, cloud->flat = false;
    if (BRUNT_CAPACITY_IN(cloud->data, cloud->bytes, BRUNT_ROWS * cloud->stride, 0,
                          "numbers of particles about a place", error))
        return BRUNT_FAILED;
    cloud->b = cloud->data + BRUNT_ROW_B * cloud->stride, cloud->b_stride = cloud->stride;
    return BRUNT_OK;
}

void brunt_cloud_point(brunt_cloud *cloud, const double x[3]) {
    double *to = cloud->data + cloud->count++;
    for (int r = 0; r < BRUNT_ROWS; r++) to[(size_t)r * cloud->stride] = r < 3 ? x[r] : 0;
    cloud->runs = 1, cloud->run[0] = (brunt_run){0, 0}, cloud->run[1].from = cloud->count; // its own
}

int brunt_cloud_source(const brunt_cloud *cloud, int i) {
    int q = 0;
    while (i >= cloud->run[q + 1].from) q++;
    return cloud->run[q].first + i - cloud->run[q].from;
}

int brunt_cloud_find(const brunt_cloud *cloud, int source) {
    for (int q = 0; q < cloud->runs; q++) {
        const int i = source - cloud->run[q].first + cloud->run[q].from;
        if (source >= cloud->run[q].first && i < cloud->run[q + 1].from) return i;
    }
    return BRUNT_NONE;
}

void brunt_cloud_free(brunt_cloud *cloud) { brunt_free(cloud->data); }

// ------------------------------------------------------------------------------------------------- volume fraction

// Weight of a node along one axis, and minus its slope [1/cell]; d: how far the particle is from it [cells]. A parabola
// (cubics: one of each side) and what the kernel's outer parts add to it.
static inline double weight(int order, double d, double *slope) {
    const double a = fabs(d), s = d < 0 ? -1 : 1;
    if (order == 1) {
        *slope = s;
        return 1 - a;
    }
    if (order == 2) {
        const double above = d > 0.5 ? d - 0.5 : 0, below = d < -0.5 ? d + 0.5 : 0, beyond = above + below;
        *slope = 2 * d - 3 * beyond;
        return 0.75 - d * d + 1.5 * beyond * beyond;
    }
    const double outer = 2 - a, inner = a < 1 ? 1 - a : 0;
    *slope = s * (0.5 * outer * outer - 2 * inner * inner);
    return (outer * outer * outer - 4 * inner * inner * inner) / 6;
}

// Minus the sum of V grad N, in cells.
BRUNT_INLINE void sum_slopes(const brunt_cloud *cloud, int order, bool flat, double inv_h, double sum[3]) {
    const size_t stride = cloud->stride;
    const double *restrict x = cloud->data, *restrict y = x + stride, *restrict z = x + 2 * stride,
                           *restrict volume = x + BRUNT_ROW_VOLUME * stride;
    const int count = (cloud->count + BRUNT_DOUBLES - 1) / BRUNT_DOUBLES * BRUNT_DOUBLES; // whole registers
    double gx = 0, gy = 0, gz = 0;
#pragma omp simd reduction(+ : gx, gy, gz)
    for (int i = 0; i < count; i++) {
        double sx, sy, sz = 0;
        const double wx = weight(order, x[i] * inv_h, &sx), wy = weight(order, y[i] * inv_h, &sy),
                     wz = flat ? 1 : weight(order, z[i] * inv_h, &sz), v = volume[i], vz = v * wz;
        gx += vz * sx * wy, gy += vz * wx * sy, gz += v * wx * wy * sz;
    }
    sum[0] = gx, sum[1] = gy, sum[2] = gz;
}

void brunt_cloud_gradient(const brunt_cloud *cloud, const brunt_grid *grid, double gradient[3]) {
    const double inv_h = (double)grid->inv_h;
    const bool flat = grid->dim < 3;
    if (grid->order == 1)
        sum_slopes(cloud, 1, flat, inv_h, gradient);
    else if (grid->order == 2 && flat)
        sum_slopes(cloud, 2, true, inv_h, gradient);
    else if (grid->order == 2)
        sum_slopes(cloud, 2, false, inv_h, gradient);
    else
        sum_slopes(cloud, 3, flat, inv_h, gradient);
    // A particle right of the node has a negative slope there: the sum of V grad_x N points away from the body; its
    // gradient as a field over space, which is asked for, is the opposite.
    double scale = inv_h;
    for (int a = 0; a < grid->dim; a++) scale *= inv_h;
    for (int a = 0; a < 3; a++) gradient[a] *= scale;
}

// ------------------------------------------------------------------------------------------------------------ extents

// What goes farthest so far, in each lane, and where it is.
typedef struct farthest {
    doubles most;
    doubles_mask where;
} farthest;

// How far the centres of the particles from number i of the cloud on go, x . n, and what they reach beyond it, sqrt(n .
// B n).
BRUNT_INLINE doubles go_along(const brunt_cloud *cloud, int64_t i, const double n[3]) {
    const size_t stride = cloud->stride;
    const double *x = cloud->data + i;
    return doubles_load(x) * n[0] + doubles_load(x + stride) * n[1] + doubles_load(x + 2 * stride) * n[2];
}
BRUNT_INLINE doubles beyond_along(const double *b, size_t stride, const double nn[6]) {
    doubles square = {0};
    for (size_t r = 0; r < 6; r++) square += nn[r] * doubles_load(b + r * stride);
    return doubles_sqrt(doubles_max(square, (doubles){0}));
}

// `more`: which of them count.
BRUNT_INLINE void compare(doubles along, doubles_mask more, doubles_mask at, farthest *of) {
    more &= along > of->most;
    of->where = doubles_mask_select(more, at, of->where);
    of->most = doubles_select(more, along, of->most);
}

// The first of those that one and two have found that goes farthest.
BRUNT_INLINE double farther(const farthest *one, const farthest *two, int *which) {
    const double greatest = doubles_greatest(doubles_max(one->most, two->most));
    const doubles_mask far = doubles_set_mask(INT32_MAX),
                       first = doubles_mask_select(one->most == greatest, one->where, far),
                       second = doubles_mask_select(two->most == greatest, two->where, far);
    *which = (int)doubles_mask_least(doubles_mask_select(first < second, first, second));
    return greatest;
}

// Two registers in turn, neither of which waits for the other.
static double centres_extent(const brunt_cloud *cloud, const double n[3], int *which) {
    farthest one = {doubles_set(-INFINITY), doubles_set_mask(INT32_MAX)}, two = one;
    const doubles_mask all = doubles_set_mask(-1);
    const int64_t end = cloud->count;
    int64_t i = 0;
    doubles_mask at = doubles_lane();
    for (; i + 2 * BRUNT_DOUBLES <= end; i += 2 * BRUNT_DOUBLES, at += 2 * BRUNT_DOUBLES) {
        compare(go_along(cloud, i, n), all, at, &one);
        compare(go_along(cloud, i + BRUNT_DOUBLES, n), all, at + BRUNT_DOUBLES, &two);
    }
    for (; i < end; i += BRUNT_DOUBLES, at += BRUNT_DOUBLES) compare(go_along(cloud, i, n), at < end, at, &one);
    return farther(&one, &two, which);
}

static double reaches_extent(const brunt_cloud *cloud, const double n[3], int *which) {
    const double nn[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2], 2 * n[1] * n[2], 2 * n[0] * n[2], 2 * n[0] * n[1]};
    farthest one = {doubles_set(-INFINITY), doubles_set_mask(INT32_MAX)}, two = one;
    const doubles_mask lane = doubles_lane();
    const size_t stride = cloud->b_stride;
    for (int q = 0; q < cloud->runs; q++) {
        const double *b = cloud->b + cloud->run[q].first;
        const int64_t end = cloud->run[q + 1].from;
        int64_t i = cloud->run[q].from;
        for (doubles_mask at = lane + i; i < end; i += 2 * BRUNT_DOUBLES, b += 2 * BRUNT_DOUBLES) {
            compare(go_along(cloud, i, n) + beyond_along(b, stride, nn), at < end, at, &one);
            at += BRUNT_DOUBLES;
            if (i + BRUNT_DOUBLES < end)
                compare(go_along(cloud, i + BRUNT_DOUBLES, n) + beyond_along(b + BRUNT_DOUBLES, stride, nn), at < end,
                        at, &two);
            at += BRUNT_DOUBLES;
        }
    }
    return farther(&one, &two, which);
}

double brunt_cloud_extent(const brunt_cloud *cloud, bool reach, const double n[3], int *which) {
    return reach ? reaches_extent(cloud, n, which) : centres_extent(cloud, n, which);
}

void brunt_cloud_end(const brunt_cloud *cloud, int i, bool reach, const double n[3], double end[3]) {
    const size_t stride = cloud->b_stride;
    for (int a = 0; a < 3; a++) end[a] = cloud->data[(size_t)a * cloud->stride + (size_t)i];
    if (!reach) return;
    const double *b = cloud->b + brunt_cloud_source(cloud, i);
    const double Bn[3] = {b[0] * n[0] + b[5 * stride] * n[1] + b[4 * stride] * n[2],
                          b[5 * stride] * n[0] + b[stride] * n[1] + b[3 * stride] * n[2],
                          b[4 * stride] * n[0] + b[3 * stride] * n[1] + b[2 * stride] * n[2]};
    const double square = Bn[0] * n[0] + Bn[1] * n[1] + Bn[2] * n[2];
    for (int a = 0; a < 3 && square > 0; a++) end[a] += Bn[a] / sqrt(square);
}

// Radius of the ball: with half axes a >= b >= c one of radius c^2 / a, as an ellipsoid is curved where its longest
// axis ends, rolls about in it and touches every point. The eigenvalues of B are within sqrt((dim - 1) / dim) |B -
// mean| of their mean, in two dimensions just there.
BRUNT_INLINE doubles ball_of(const doubles b[6], bool flat) {
    const double share = flat ? 0.5 : 1.0 / 3;
    const doubles none = {0}, mean = share * (b[0] + b[1] + b[2]), xx = b[0] - mean, yy = b[1] - mean,
                  zz = flat ? none : b[2] - mean,
                  square = xx * xx + yy * yy + zz * zz + 2 * (b[3] * b[3] + b[4] * b[4] + b[5] * b[5]),
                  by = doubles_sqrt((1 - share) * square), low = mean - by;
    return doubles_select(low > 0, low / doubles_sqrt(mean + by), none);
}

static double least_of(doubles a) {
    double least = INFINITY;
    for (int l = 0; l < BRUNT_DOUBLES; l++) least = a[l] < least ? a[l] : least;
    return least;
}

double brunt_cloud_ball(const brunt_cloud *cloud) {
    doubles least = doubles_set(INFINITY);
    for (int q = 0; q < cloud->runs; q++) {
        const double *row = cloud->b + cloud->run[q].first;
        const int64_t count = cloud->run[q + 1].from - cloud->run[q].from;
        for (int64_t i = 0; i < count; i += BRUNT_DOUBLES) {
            doubles b[6];
            for (int r = 0; r < 6; r++) b[r] = doubles_load(row + (size_t)r * cloud->b_stride + i);
            const doubles ball = ball_of(b, cloud->flat);
            least = doubles_select((ball < least) & (doubles_lane() < count - i), ball, least);
        }
    }
    return least_of(least);
}

// The same of one particle.
static double ball_of_one(const double *of, size_t stride, bool flat) {
    const double share = flat ? 0.5 : 1.0 / 3, yz = of[3 * stride], xz = of[4 * stride], xy = of[5 * stride];
    const double mean = share * (of[0] + of[stride] + of[2 * stride]), xx = of[0] - mean, yy = of[stride] - mean,
                 zz = flat ? 0 : of[2 * stride] - mean,
                 square = xx * xx + yy * yy + zz * zz + 2 * (yz * yz + xz * xz + xy * xy),
                 by = sqrt((1 - share) * square), low = mean - by;
    return low > 0 ? low / sqrt(mean + by) : 0;
}

double brunt_cloud_ball_of(const brunt_cloud *cloud, const int *some, int count) {
    double least = INFINITY;
    for (int k = 0; k < count; k++) {
        const double ball = ball_of_one(cloud->b + brunt_cloud_source(cloud, some[k]), cloud->b_stride, cloud->flat);
        least = ball < least ? ball : least;
    }
    return least;
}
