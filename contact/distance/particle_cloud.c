// Extents of what a body has near a node, and its volume fraction there: sums and maxima over rows of numbers, eight
// particles at once.
//
// The ball of radius `reach` about a particle is an ellipsoid by now, with the matrix B = reach^2 F F^T: along a unit
// vector n it ends sqrt(n . B n) from its centre, at the point x + B n / sqrt(n . B n). With half axes a >= b >= c a
// ball of radius c^2 / a, as it is curved where its longest axis ends, rolls about in it and touches every point.
#include "contact/distance/particle_cloud.h"

#include <math.h>

#include "base/array.h"
#include "base/memory.h"

// Rows of a cloud's memory, `stride` numbers each: place relative to the node, B (xx yy zz yz xz xy), volume, radius of
// the ball that rolls about in it, and one to work in.
enum { X = 0, B = 3, VOLUME = 9, BALL = 10, ALONG = 11, ROWS = 12, LANES = 8 };

static int set_capacity(brunt_cloud *cloud, int count, brunt_error *error) {
    cloud->stride = ((size_t)count + LANES - 1) / LANES * LANES;
    cloud->count = 0;
    return BRUNT_CAPACITY_IN(cloud->data, cloud->bytes, ROWS * cloud->stride, 0, "numbers of particles about a node",
                             error);
}

// Of ellipsoids in dim dimensions. The eigenvalues of B are within sqrt((dim - 1) / dim) |B - mean| of their mean, in
// two dimensions just there.
static void take_ball(double *restrict to, size_t stride, int count, int dim) {
    const double *restrict b = to + B * stride, share = 1.0 / dim, within = 1 - share;
    double *restrict ball = to + BALL * stride;
#pragma omp simd
    for (int i = 0; i < count; i++) {
        const double *c = b + i;
        const double xx = c[0], yy = c[stride], zz = c[2 * stride], yz = c[3 * stride], xz = c[4 * stride],
                     xy = c[5 * stride], mean = share * (xx + yy + zz), dx = xx - mean, dy = yy - mean,
                     dz = dim == 3 ? zz - mean : 0,
                     square = dx * dx + dy * dy + dz * dz + 2 * (yz * yz + xz * xz + xy * xy),
                     off = sqrt(within * square), low = mean - off;
        ball[i] = low > 0 ? low / sqrt(mean + off) : 0;
    }
}

// Of particles [first, first + count) of three dimensions.
static void take_solid(brunt_particles *p, int64_t first, int count, double *restrict to, size_t stride) {
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    const real *restrict reach = brunt_field(p, BRUNT_FIELD_reach)[0] + first,
                         *restrict volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0] + first;
    const real *restrict xx = F[0] + first, *restrict xy = F[1] + first, *restrict xz = F[2] + first,
                         *restrict yx = F[3] + first, *restrict yy = F[4] + first, *restrict yz = F[5] + first,
                         *restrict zx = F[6] + first, *restrict zy = F[7] + first, *restrict zz = F[8] + first;
    double *restrict b = to + B * stride, *restrict v = to + VOLUME * stride;
#pragma omp simd
    for (int i = 0; i < count; i++) {
        const double r = (double)reach[i], square = r * r;
        const double f0 = (double)xx[i], f1 = (double)xy[i], f2 = (double)xz[i], f3 = (double)yx[i], f4 = (double)yy[i],
                     f5 = (double)yz[i], f6 = (double)zx[i], f7 = (double)zy[i], f8 = (double)zz[i];
        b[i] = square * (f0 * f0 + f1 * f1 + f2 * f2);
        b[(size_t)i + stride] = square * (f3 * f3 + f4 * f4 + f5 * f5);
        b[(size_t)i + 2 * stride] = square * (f6 * f6 + f7 * f7 + f8 * f8);
        b[(size_t)i + 3 * stride] = square * (f3 * f6 + f4 * f7 + f5 * f8);
        b[(size_t)i + 4 * stride] = square * (f0 * f6 + f1 * f7 + f2 * f8);
        b[(size_t)i + 5 * stride] = square * (f0 * f3 + f1 * f4 + f2 * f5);
        v[i] = (double)volume[i] * (f0 * (f4 * f8 - f5 * f7) - f1 * (f3 * f8 - f5 * f6) + f2 * (f3 * f7 - f4 * f6));
    }
}

// Of two dimensions. Rings count by their area: their volume grows with r, and would seem to have a surface that faces
// the axis.
static void take_plane(brunt_particles *p, int64_t first, int count, double *restrict to, size_t stride) {
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    const real *reach = brunt_field(p, BRUNT_FIELD_reach)[0] + first;
    const real *xx = F[0] + first, *xy = F[1] + first, *yx = F[p->point_dim] + first, *yy = F[p->point_dim + 1] + first;
    for (int i = 0; i < count; i++) {
        const double r = (double)reach[i], square = r * r;
        const double f0 = (double)xx[i], f1 = (double)xy[i], f3 = (double)yx[i], f4 = (double)yy[i];
        double *b = to + B * stride + i;
        b[0] = square * (f0 * f0 + f1 * f1), b[stride] = square * (f3 * f3 + f4 * f4);
        b[2 * stride] = b[3 * stride] = b[4 * stride] = 0, b[5 * stride] = square * (f0 * f3 + f1 * f4);
        to[VOLUME * stride + (size_t)i] = (double)brunt_plane_volume(p, first + i);
    }
}

int brunt_cloud_gather(brunt_body *body, int32_t slot, int node, brunt_cloud *cloud, brunt_error *error) {
    brunt_slot_run runs[BRUNT_MAX_SLOT_RUNS];
    const int run_count = brunt_extent_runs(body, slot, node, runs);
    int count = 0;
    for (int q = 0; q < run_count; q++) count += runs[q].count;
    if (set_capacity(cloud, count, error)) return BRUNT_FAILED;
    brunt_particles *p = &body->particles;
    real *const *x = brunt_field(p, BRUNT_FIELD_position);
    double at[3];
    brunt_node_position(&body->grid, body->grid.slots[slot].coord, node, at);
    for (int q = 0; q < run_count; q++) {
        const int64_t first = runs[q].first;
        double *to = cloud->data + cloud->count;
        for (int a = 0; a < 3; a++)
            for (int i = 0; i < runs[q].count; i++)
                to[(size_t)(X + a) * cloud->stride + (size_t)i] = a < p->dim ? (double)x[a][first + i] - at[a] : 0;
        if (p->dim == 3)
            take_solid(p, first, runs[q].count, to, cloud->stride);
        else
            take_plane(p, first, runs[q].count, to, cloud->stride);
        take_ball(to, cloud->stride, runs[q].count, p->dim);
        cloud->count += runs[q].count;
    }
    double *volume = cloud->data + VOLUME * cloud->stride, place = 1;
    for (int a = 0; a < p->dim; a++) place *= body->spacing;
    for (int i = 0; body->keeps && i < count; i++)
        if (volume[i] == 0) volume[i] = place; // freed of stress, not of its place
    return BRUNT_OK;
}

int brunt_cloud_points(brunt_cloud *cloud, int count, brunt_error *error) { return set_capacity(cloud, count, error); }

void brunt_cloud_point(brunt_cloud *cloud, const double x[3]) {
    double *to = cloud->data + cloud->count++;
    for (int a = 0; a < 3; a++) to[(size_t)(X + a) * cloud->stride] = x[a];
    for (int r = B; r < ALONG; r++) to[(size_t)r * cloud->stride] = 0;
}

void brunt_cloud_free(brunt_cloud *cloud) { brunt_free(cloud->data); }

// -------------------------------------------------------------------------------------------------- volume fraction

// Weight of a node along one axis, and minus its slope [1/cell]; d: how far the particle is from it [cells].
static inline double weight(int order, double d, double *slope) {
    const double a = fabs(d), s = d < 0 ? -1 : 1, inner = 1 - a, middle = 1.5 - a, outer = 2 - a;
    switch (order) {
    case 1: *slope = s; return inner;
    case 2: *slope = a < 0.5 ? 2 * d : s * middle; return a < 0.5 ? 0.75 - a * a : 0.5 * middle * middle;
    default:
        *slope = s * (a < 1 ? a * (2 - 1.5 * a) : 0.5 * outer * outer);
        return a < 1 ? 2.0 / 3 + a * a * (0.5 * a - 1) : outer * outer * outer / 6;
    }
}

typedef struct gradient_sum {
    double gradient[3], volume, moment[3];
} gradient_sum;

static inline __attribute__((always_inline)) gradient_sum sum_gradient(const brunt_cloud *cloud, int order, bool flat,
                                                                       double inv_h) {
    const size_t stride = cloud->stride;
    const double *restrict x = cloud->data, *restrict y = x + stride, *restrict z = x + 2 * stride,
                           *restrict volume = x + VOLUME * stride;
    double gx = 0, gy = 0, gz = 0, all = 0, mx = 0, my = 0, mz = 0;
#pragma omp simd reduction(+ : gx, gy, gz, all, mx, my, mz)
    for (int i = 0; i < cloud->count; i++) {
        double sx, sy, sz = 0;
        const double wx = weight(order, x[i] * inv_h, &sx), wy = weight(order, y[i] * inv_h, &sy),
                     wz = flat ? 1 : weight(order, z[i] * inv_h, &sz), share = volume[i] * wx * wy * wz;
        gx += volume[i] * sx * wy * wz, gy += volume[i] * wx * sy * wz, gz += volume[i] * wx * wy * sz;
        all += share, mx += share * x[i], my += share * y[i], mz += share * z[i];
    }
    return (gradient_sum){{gx, gy, gz}, all, {mx, my, mz}};
}

void brunt_cloud_gradient(const brunt_cloud *cloud, const brunt_grid *grid, double gradient[3], double centre[3]) {
    const double inv_h = (double)grid->inv_h;
    const bool flat = grid->dim < 3;
    const gradient_sum sum = grid->order == 1 ? sum_gradient(cloud, 1, flat, inv_h)
                             : grid->order == 2
                                 ? flat ? sum_gradient(cloud, 2, true, inv_h) : sum_gradient(cloud, 2, false, inv_h)
                                 : sum_gradient(cloud, 3, flat, inv_h);
    // A particle right of the node has a negative slope there: the sum of V grad_x N points away from the body; its
    // gradient as a field over space, which is asked for, is the opposite.
    double scale = inv_h;
    for (int a = 0; a < grid->dim; a++) scale *= inv_h;
    for (int a = 0; a < 3; a++) {
        gradient[a] = scale * sum.gradient[a];
        centre[a] = sum.volume > 0 ? sum.moment[a] / sum.volume : 0;
    }
}

// ------------------------------------------------------------------------------------------------------------ extents

// x . n of each, plus sqrt(n . B n) where their reach counts, in its row.
static void take_extents(const brunt_cloud *cloud, bool reach, const double n[3], double *restrict along) {
    const size_t stride = cloud->stride;
    const double *restrict x = cloud->data, *restrict y = x + stride, *restrict z = x + 2 * stride,
                           *restrict b = x + B * stride;
    const double n0 = n[0], n1 = n[1], n2 = n[2], xx = n0 * n0, yy = n1 * n1, zz = n2 * n2, yz = 2 * n1 * n2,
                 xz = 2 * n0 * n2, xy = 2 * n0 * n1;
    if (!reach) {
#pragma omp simd
        for (int i = 0; i < cloud->count; i++) along[i] = x[i] * n0 + y[i] * n1 + z[i] * n2;
        return;
    }
#pragma omp simd
    for (int i = 0; i < cloud->count; i++) {
        const double *c = b + i;
        const double square = c[0] * xx + c[stride] * yy + c[2 * stride] * zz + c[3 * stride] * yz +
                              c[4 * stride] * xz + c[5 * stride] * xy;
        along[i] = x[i] * n0 + y[i] * n1 + z[i] * n2 + sqrt(square > 0 ? square : 0);
    }
}

// The greatest of a row, which is filled up with what is less than all.
static double greatest_of(const brunt_cloud *cloud, double *along) {
    double most[LANES], greatest = -INFINITY;
    for (size_t i = (size_t)cloud->count; i < cloud->stride; i++) along[i] = -INFINITY;
    for (int k = 0; k < LANES; k++) most[k] = -INFINITY;
    for (size_t i = 0; i < cloud->stride; i += LANES)
        for (int k = 0; k < LANES; k++) most[k] = along[i + (size_t)k] > most[k] ? along[i + (size_t)k] : most[k];
    for (int k = 0; k < LANES; k++) greatest = most[k] > greatest ? most[k] : greatest;
    return greatest;
}

double brunt_cloud_extent(const brunt_cloud *cloud, bool reach, const double n[3], int *which) {
    double *along = cloud->data + ALONG * cloud->stride;
    take_extents(cloud, reach, n, along);
    const double greatest = greatest_of(cloud, along);
    *which = 0;
    while (*which < cloud->count && along[*which] != greatest) ++*which;
    return *which < cloud->count ? greatest : -INFINITY;
}

void brunt_cloud_end(const brunt_cloud *cloud, int i, bool reach, const double n[3], double end[3]) {
    const size_t stride = cloud->stride;
    const double *of = cloud->data + i, *b = of + B * stride;
    for (int a = 0; a < 3; a++) end[a] = of[(size_t)(X + a) * stride];
    if (!reach) return;
    const double Bn[3] = {b[0] * n[0] + b[5 * stride] * n[1] + b[4 * stride] * n[2],
                          b[5 * stride] * n[0] + b[stride] * n[1] + b[3 * stride] * n[2],
                          b[4 * stride] * n[0] + b[3 * stride] * n[1] + b[2 * stride] * n[2]};
    const double square = Bn[0] * n[0] + Bn[1] * n[1] + Bn[2] * n[2];
    for (int a = 0; a < 3 && square > 0; a++) end[a] += Bn[a] / sqrt(square);
}

double brunt_cloud_ball(const brunt_cloud *cloud) {
    const double *ball = cloud->data + BALL * cloud->stride;
    double least = INFINITY;
    for (int i = 0; i < cloud->count; i++) least = ball[i] < least ? ball[i] : least;
    return least;
}

double brunt_cloud_ball_of(const brunt_cloud *cloud, const int *some, int count) {
    double least = INFINITY;
    for (int i = 0; i < count; i++) least = fmin(least, cloud->data[BALL * cloud->stride + (size_t)some[i]]);
    return least;
}
