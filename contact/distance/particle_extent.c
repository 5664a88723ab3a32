// Where a body's surface really is, seen from a node.
//
// A grid knows a body only through its kernel, which feels it up to a cell and a half away. The particles know better:
// each carries how far it was from the body's surface at the start (its reach). The ball of that radius is material, so
// the surface along a direction n is the farthest point x.n + r any particle near the node has, with r = reach |F^T n|:
// the deformed distance of a material plane whose deformed normal is n.
#include "contact/distance/particle_extent.h"

#include <math.h>

#include "base/simd.h"

int brunt_extent_runs(const brunt_body *body, int32_t slot, int node, brunt_slot_run runs[BRUNT_MAX_SLOT_RUNS]) {
    const brunt_grid *grid = &body->grid;
    const int deep = grid->dim == 3 ? grid->order : 0;
    int local[3], count = 0;
    brunt_node_local(grid, node, local);
    for (int kx = 0; kx <= grid->order; kx++)
        for (int ky = 0; ky <= grid->order; ky++)
            for (int kz = deep; kz >= 0; kz--) { // upwards, as bins lie in memory
                int at[3] = {local[0] - kx, local[1] - ky, local[2] - kz}, corner = 0;
                for (int a = 0; a < grid->dim; a++) {
                    corner = 2 * corner + (at[a] < 0);
                    if (at[a] < 0) at[a] += grid->side;
                }
                const int32_t b = grid->slots[slot].source[corner];
                if (b < 0) continue;
                const int32_t *start =
                    grid->bin_start + (int64_t)b * BRUNT_BIN_STARTS + brunt_node_index(grid, at[0], at[1], at[2]);
                const int64_t first = grid->blocks[b].first + start[0];
                if (start[1] == start[0]) continue;
                if (count > 0 && runs[count - 1].first + runs[count - 1].count == first)
                    runs[count - 1].count += start[1] - start[0];
                else
                    runs[count++] = (brunt_slot_run){first, start[1] - start[0]};
            }
    return count;
}

// Weight of a node along one axis; d: how far the particle is from it [cells].
static double weight_1d(int order, double d) {
    const double a = fabs(d);
    if (order == 1) return 1 - a;
    if (order == 2) return a < 0.5 ? 0.75 - a * a : 0.5 * (1.5 - a) * (1.5 - a);
    return a < 1 ? 2.0 / 3 + a * a * (0.5 * a - 1) : (2 - a) * (2 - a) * (2 - a) / 6;
}

// Where the place `undeformed` has gone to with a particle.
static void carry(brunt_particles *p, int64_t s, const double undeformed[3], double x[3]) {
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient),
                *const *now = brunt_field(p, BRUNT_FIELD_position), *const *X = brunt_kernel_position(p);
    for (int r = 0; r < p->dim; r++) {
        x[r] = (double)now[r][s];
        for (int c = 0; c < p->dim; c++) x[r] += (double)F[r * p->dim + c][s] * (undeformed[c] - (double)X[c][s]);
    }
}

void brunt_extent_deformed(brunt_body *body, int32_t slot, int node, double x[3]) {
    brunt_particles *p = &body->particles;
    real *const *X = brunt_kernel_position(p);
    brunt_slot_run runs[BRUNT_MAX_SLOT_RUNS];
    const int count = brunt_extent_runs(body, slot, node, runs);
    double all = 0, moment[3] = {0}, at[3];
    for (int q = 0; q < count; q++)
        for (int64_t s = runs[q].first; s < runs[q].first + runs[q].count; s++) {
            double weight = (double)brunt_field(p, BRUNT_FIELD_mass)[0][s];
            for (int a = 0; a < p->dim; a++)
                weight *= weight_1d(body->grid.order, ((double)X[a][s] - x[a]) * (double)body->grid.inv_h);
            carry(p, s, x, at);
            all += weight;
            for (int a = 0; a < p->dim; a++) moment[a] += weight * at[a];
        }
    for (int a = 0; a < p->dim && all > 0; a++) x[a] = moment[a] / all;
}

// F^T n of a particle.
BRUNT_INLINE void pull_back(brunt_body *body, int64_t s, int dim, const double n[3], double out[3]) {
    const int stride = body->particles.point_dim;
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    for (int c = 0; c < 3; c++) {
        out[c] = 0;
        for (int r = 0; r < dim && c < dim; r++) out[c] += (double)F[r * stride + c][s] * n[r];
    }
}

BRUNT_INLINE double extent_along(brunt_body *body, int64_t s, int dim, const double n[3]) {
    double t[3];
    pull_back(body, s, dim, n, t);
    return (double)brunt_field(&body->particles, BRUNT_FIELD_reach)[0][s] *
           sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
}

double brunt_extent_along(brunt_body *body, int64_t s, const double n[3]) {
    return body->particles.dim == 3 ? extent_along(body, s, 3, n) : extent_along(body, s, body->particles.dim, n);
}

void brunt_extent_fetch(brunt_body *body, int64_t s) {
    const int dim = body->particles.dim, stride = body->particles.point_dim;
    real *const *F = brunt_field(&body->particles, BRUNT_FIELD_deformation_gradient);
    __builtin_prefetch(&brunt_field(&body->particles, BRUNT_FIELD_reach)[0][s]);
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) __builtin_prefetch(&F[r * stride + c][s]);
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
    pull_back(body, s, p->dim, n, t);
    for (int a = 0; a < 3; a++) kernel_arm[a] = -length * reach * reach / (extent * extent) * t[a];
    for (int r = 0; r < p->dim; r++) {
        arm[r] = 0;
        for (int c = 0; c < p->dim; c++) arm[r] += (double)F[r * p->point_dim + c][s] * kernel_arm[c];
    }
}
