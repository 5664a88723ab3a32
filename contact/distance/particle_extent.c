// Where a body's surface really is, seen from a node.
//
// A grid knows a body only through its kernel, which feels it up to a cell and a half away. The particles know better:
// each carries how far it was from the body's surface at the start (its reach). The ball of that radius is material, so
// the surface along a direction n is the farthest point x.n + r any particle near the node has, with r = reach |F^T n|:
// the deformed distance of a material plane whose deformed normal is n.
#include "contact/distance/particle_extent.h"

#include <math.h>

#include "base/array.h"
#include "base/memory.h"

// Weight and slope [1/cell] of one node along one axis; u: cells from the base node, k: the node, counted from the
// base.
static void weight_1d(int order, double u, int k, double *w, double *g) {
    double d = u - k, a = fabs(d), s = d < 0 ? -1 : 1;
    if (order == 1) {
        *w = 1 - a, *g = -s;
    } else if (order == 2) {
        if (a < 0.5)
            *w = 0.75 - a * a, *g = -2 * d;
        else
            *w = 0.5 * (1.5 - a) * (1.5 - a), *g = -s * (1.5 - a);
    } else if (a < 1) {
        *w = 2.0 / 3 + a * a * (0.5 * a - 1), *g = s * a * (1.5 * a - 2);
    } else {
        *w = (2 - a) * (2 - a) * (2 - a) / 6, *g = -s * 0.5 * (2 - a) * (2 - a);
    }
}

void brunt_extent_visit(brunt_body *body, int32_t slot, int node, brunt_extent_visit_fn *visit, void *context) {
    const brunt_grid *grid = &body->grid;
    int local[3];
    brunt_node_local(grid, node, local);
    for (int kx = 0; kx <= grid->order; kx++)
        for (int ky = 0; ky <= grid->order; ky++)
            for (int kz = 0; kz <= (grid->dim == 3 ? grid->order : 0); kz++) {
                int at[3] = {local[0] - kx, local[1] - ky, local[2] - kz}, corner = 0;
                const int base[3] = {kx, ky, kz}; // the node is number base[] of the bin's nodes
                for (int a = 0; a < grid->dim; a++) {
                    corner = 2 * corner + (at[a] < 0);
                    if (at[a] < 0) at[a] += grid->side;
                }
                int32_t b = grid->slots[slot].source[corner];
                if (b < 0) continue;
                const int32_t *start =
                    grid->bin_start + (int64_t)b * BRUNT_BIN_STARTS + brunt_node_index(grid, at[0], at[1], at[2]);
                for (int32_t i = start[0]; i < start[1]; i++) visit(context, body, grid->blocks[b].first + i, base);
            }
}

typedef struct gradient_sum {
    double node[3], sum[3], volume, moment[3];
} gradient_sum;

static void add_gradient(void *context, brunt_body *body, int64_t s, const int base[3]) {
    gradient_sum *g = context;
    brunt_particles *p = &body->particles;
    const brunt_grid *grid = &body->grid;
    real *const *x = brunt_field(p, BRUNT_FIELD_position);
    // Rings count by their area: their volume grows with r, and so would seem to have a surface that faces the axis.
    double volume = (double)brunt_plane_volume(p, s), w[3] = {1, 1, 1}, slope[3] = {0, 0, 0};
    if (body->keeps && volume == 0) volume = pow(body->spacing, p->dim); // freed of stress, not of its place
    for (int a = 0; a < p->dim; a++) {
        double u = ((double)x[a][s] - g->node[a]) * (double)grid->inv_h + base[a];
        weight_1d(grid->order, u, base[a], &w[a], &slope[a]);
    }
    g->sum[0] += volume * slope[0] * w[1] * w[2];
    g->sum[1] += volume * w[0] * slope[1] * w[2];
    g->sum[2] += volume * w[0] * w[1] * slope[2];
    double share = volume * w[0] * w[1] * w[2];
    g->volume += share;
    for (int a = 0; a < p->dim; a++) g->moment[a] += share * ((double)x[a][s] - g->node[a]);
}

void brunt_extent_gradient(brunt_body *body, int32_t slot, int node, double gradient[3], double centre[3]) {
    gradient_sum g = {.volume = 0};
    const brunt_grid *grid = &body->grid;
    brunt_node_position(grid, grid->slots[slot].coord, node, g.node);
    brunt_extent_visit(body, slot, node, add_gradient, &g);
    // A particle right of the node has a negative slope there: the sum of V grad_x N points away from the body; its
    // gradient as a field over space, which is asked for, is the opposite.
    double scale = -(double)grid->inv_h / pow((double)grid->h, grid->dim);
    for (int a = 0; a < 3; a++) {
        gradient[a] = scale * g.sum[a];
        centre[a] = g.volume > 0 ? g.moment[a] / g.volume : 0;
    }
}

typedef struct deformed_sum {
    double undeformed[3], weight, moment[3];
} deformed_sum;

static void add_deformed(void *context, brunt_body *body, int64_t s, const int base[3]) {
    deformed_sum *d = context;
    brunt_particles *p = &body->particles;
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient), *const *x = brunt_field(p, BRUNT_FIELD_position),
                *const *X = brunt_kernel_position(p);
    double weight = (double)brunt_field(p, BRUNT_FIELD_mass)[0][s], w, g;
    for (int a = 0; a < p->dim; a++) {
        double u = ((double)X[a][s] - d->undeformed[a]) * (double)body->grid.inv_h + base[a];
        weight_1d(body->grid.order, u, base[a], &w, &g);
        weight *= w;
    }
    d->weight += weight;
    for (int r = 0; r < p->dim; r++) {
        double at = (double)x[r][s];
        for (int c = 0; c < p->dim; c++) at += (double)F[r * p->dim + c][s] * (d->undeformed[c] - (double)X[c][s]);
        d->moment[r] += weight * at;
    }
}

void brunt_extent_deformed(brunt_body *body, int32_t slot, int node, double x[3]) {
    deformed_sum d = {.undeformed = {x[0], x[1], x[2]}};
    brunt_extent_visit(body, slot, node, add_deformed, &d);
    for (int a = 0; a < body->particles.dim && d.weight > 0; a++) x[a] = d.moment[a] / d.weight;
}

// F^T n of a particle.
static void pull_back(brunt_body *body, int64_t s, const double n[3], double out[3]) {
    const int dim = body->particles.dim, stride = body->particles.point_dim;
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    for (int c = 0; c < 3; c++) {
        out[c] = 0;
        for (int r = 0; r < dim && c < dim; r++) out[c] += (double)F[r * stride + c][s] * n[r];
    }
}

double brunt_extent_along(brunt_body *body, int64_t s, const double n[3]) {
    double t[3];
    pull_back(body, s, n, t);
    return (double)brunt_field(&body->particles, BRUNT_FIELD_reach)[0][s] *
           sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
}

// The farthest point of the ellipsoid is x - r F t / |t|, t = F^T n: X - r t / |t| of the undeformed ball.
void brunt_extent_arm(brunt_body *body, int64_t s, const double n[3], double distance, double arm[3],
                      double kernel_arm[3]) {
    const brunt_particles *p = &body->particles;
    const double extent = brunt_extent_along(body, s, n), length = fmin(extent, distance);
    for (int a = 0; a < 3; a++) arm[a] = kernel_arm[a] = -length * n[a];
    if (!brunt_total_lagrangian(p)) return;
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    const double reach = (double)brunt_field(&body->particles, BRUNT_FIELD_reach)[0][s];
    double t[3];
    pull_back(body, s, n, t);
    for (int a = 0; a < 3; a++) kernel_arm[a] = -length * reach * reach / (extent * extent) * t[a];
    for (int r = 0; r < p->dim; r++) {
        arm[r] = 0;
        for (int c = 0; c < p->dim; c++) arm[r] += (double)F[r * p->point_dim + c][s] * kernel_arm[c];
    }
}

// Rows of a cloud's memory, `stride` numbers each.
enum { CLOUD_X = 0, CLOUD_F = 3, CLOUD_REACH = 12, CLOUD_ALONG = 13, CLOUD_ROWS = 14, CLOUD_LANES = 8 };

typedef struct cloud_fill {
    brunt_extent_cloud *cloud;
    double node[3];
} cloud_fill;

static void count_particle(void *context, brunt_body *body, int64_t s, const int base[3]) {
    (void)body, (void)s, (void)base;
    ++*(int *)context;
}

static void add_particle(void *context, brunt_body *body, int64_t s, const int base[3]) {
    (void)base;
    const cloud_fill *fill = context;
    brunt_particles *p = &body->particles;
    real *const *x = brunt_field(p, BRUNT_FIELD_position), *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    double *to = fill->cloud->data + fill->cloud->count++;
    const size_t stride = fill->cloud->stride;
    for (int r = 0; r < 3; r++) {
        to[(size_t)(CLOUD_X + r) * stride] = r < p->dim ? (double)x[r][s] - fill->node[r] : 0;
        for (int c = 0; c < 3; c++)
            to[(size_t)(CLOUD_F + 3 * r + c) * stride] =
                r < p->dim && c < p->dim ? (double)F[r * p->point_dim + c][s] : 0;
    }
    to[CLOUD_REACH * stride] = (double)brunt_field(p, BRUNT_FIELD_reach)[0][s];
}

int brunt_extent_gather(brunt_body *body, int32_t slot, int node, brunt_extent_cloud *cloud, brunt_error *error) {
    int count = 0;
    brunt_extent_visit(body, slot, node, count_particle, &count);
    cloud->stride = ((size_t)count + CLOUD_LANES - 1) / CLOUD_LANES * CLOUD_LANES;
    cloud->count = 0;
    if (BRUNT_CAPACITY_IN(cloud->data, cloud->bytes, CLOUD_ROWS * cloud->stride, 0, "numbers of particles about a node",
                          error))
        return BRUNT_FAILED;
    cloud_fill fill = {.cloud = cloud};
    brunt_node_position(&body->grid, body->grid.slots[slot].coord, node, fill.node);
    brunt_extent_visit(body, slot, node, add_particle, &fill);
    return BRUNT_OK;
}

int brunt_extent_cloud_points(brunt_extent_cloud *cloud, int count, brunt_error *error) {
    cloud->stride = ((size_t)count + CLOUD_LANES - 1) / CLOUD_LANES * CLOUD_LANES;
    cloud->count = 0;
    return BRUNT_CAPACITY_IN(cloud->data, cloud->bytes, CLOUD_ROWS * cloud->stride, 0,
                             "numbers of particles about a node", error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

void brunt_extent_cloud_point(brunt_extent_cloud *cloud, const double x[3]) {
    double *to = cloud->data + cloud->count++;
    for (int a = 0; a < 3; a++) to[(size_t)(CLOUD_X + a) * cloud->stride] = x[a];
    for (int r = CLOUD_F; r < CLOUD_ALONG; r++) to[(size_t)r * cloud->stride] = 0;
}

void brunt_extent_cloud_free(brunt_extent_cloud *cloud) { brunt_free(cloud->data); }

// x . n + share reach |F^T n| of each particle.
static void extents(const brunt_extent_cloud *cloud, double share, const double n[3]) {
    const double *const data = cloud->data;
    const size_t stride = cloud->stride;
    const double *restrict x = data, *restrict y = data + stride, *restrict z = data + 2 * stride,
                           *restrict F = data + CLOUD_F * stride, *restrict reach = data + CLOUD_REACH * stride;
    double *restrict along = cloud->data + CLOUD_ALONG * stride;
#pragma omp simd
    for (int i = 0; i < cloud->count; i++) along[i] = x[i] * n[0] + y[i] * n[1] + z[i] * n[2];
    if (share == 0) return;
#pragma omp simd
    for (int i = 0; i < cloud->count; i++) {
        const double *f = F + i;
        const double t0 = f[0] * n[0] + f[3 * stride] * n[1] + f[6 * stride] * n[2],
                     t1 = f[stride] * n[0] + f[4 * stride] * n[1] + f[7 * stride] * n[2],
                     t2 = f[2 * stride] * n[0] + f[5 * stride] * n[1] + f[8 * stride] * n[2];
        along[i] += share * reach[i] * sqrt(t0 * t0 + t1 * t1 + t2 * t2);
    }
}

double brunt_extent_of(const brunt_extent_cloud *cloud, double share, const double n[3], double farthest[3]) {
    for (int a = 0; a < 3; a++) farthest[a] = 0;
    if (!cloud->count) return -INFINITY;
    extents(cloud, share, n);
    const double *data = cloud->data, *along = data + CLOUD_ALONG * cloud->stride;
    int most = 0;
    for (int i = 1; i < cloud->count; i++)
        if (along[i] > along[most]) most = i;
    // The ball of the reach is an ellipsoid by now: its farthest point is x + r F F^T n / |F^T n|.
    const double *of = data + most;
    double t[3], size = 0;
    for (int c = 0; c < 3; c++) {
        t[c] = 0;
        for (int r = 0; r < 3; r++) t[c] += of[(size_t)(CLOUD_F + 3 * r + c) * cloud->stride] * n[r];
        size += t[c] * t[c];
    }
    size = sqrt(size);
    const double r = share * of[CLOUD_REACH * cloud->stride];
    for (int a = 0; a < 3; a++) {
        farthest[a] = of[(size_t)(CLOUD_X + a) * cloud->stride];
        for (int c = 0; c < 3 && size > 0; c++)
            farthest[a] += r * of[(size_t)(CLOUD_F + 3 * a + c) * cloud->stride] * t[c] / size;
    }
    return along[most];
}
