#include "mpm/audit.h"

#include <math.h>
#include <string.h>

#include "grid/bspline.h"

// One serial pass in the order of the particles, summed in extended precision: the drift it measures is near rounding
// itself.
brunt_audit brunt_body_audit(brunt_body *body) { return brunt_slots_audit(body, NULL, body->particles.slots); }

// The affine part has the lever arms of the undeformed kernel; F takes them to where they are.
static void deformed_spin(brunt_particles *p, int64_t s, double B[3][3]) {
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    for (int r = 0; r < p->dim; r++) {
        double row[3] = {0};
        for (int c = 0; c < p->dim; c++)
            for (int k = 0; k < p->dim; k++) row[c] += B[r][k] * (double)F[c * p->dim + k][s];
        memcpy(B[r], row, sizeof row);
    }
}

// `slots` NULL: all.
brunt_audit brunt_slots_audit(brunt_body *body, const int64_t *slots, int64_t count) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim;
    const brunt_grid *grid = &body->grid;
    real *const *x = brunt_field(p, BRUNT_FIELD_position), *const *v = brunt_field(p, BRUNT_FIELD_velocity);
    real *const *C = brunt_field(p, BRUNT_FIELD_affine), *const *place = brunt_kernel_position(p);
    const real *mass = brunt_field(p, BRUNT_FIELD_mass)[0];
    const bool affine = p->field[BRUNT_FIELD_affine].components > 0, axisymmetric = brunt_axisymmetric(p);
    long double total_mass = 0, kinetic = 0, linear[3] = {0}, angular[3] = {0}, centre[3] = {0}, scale_linear = 0,
                scale_angular = 0;
    for (int64_t n = 0; n < count; n++) {
        const int64_t s = slots ? slots[n] : n;
        if (p->id[s] < 0) continue;
        double m = (double)mass[s], X[3] = {0}, V[3] = {0}, spin[3] = {0}, square = 0, B[3][3] = {{0}};
        for (int k = 0; k < dim; k++) X[k] = (double)x[k][s], V[k] = (double)v[k][s], square += V[k] * V[k];
        for (int k = 0; affine && k < dim; k++) {
            double D = (double)bspline_moment(grid->order, lanes_set(place[k][s] - (real)grid->origin[k]), grid->h,
                                              grid->inv_h)[0];
            for (int r = 0; r < dim; r++) {
                double c = (double)C[r * dim + k][s];
                B[r][k] = c * D;
                square += c * c * D;
            }
        }
        if (brunt_total_lagrangian(p)) deformed_spin(p, s, B);
        if (axisymmetric) { // the circle's sums; only sizes are left of what cancels
            total_mass += m;
            kinetic += 0.5 * m * square;
            linear[1] += m * V[1];
            centre[1] += m * X[1];
            scale_linear += m * sqrt(square);
            continue;
        }
        for (int k = 0; k < 3; k++) spin[k] = B[(k + 2) % 3][(k + 1) % 3] - B[(k + 1) % 3][(k + 2) % 3];
        total_mass += m;
        kinetic += 0.5 * m * square;
        double size = 0;
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            linear[k] += m * V[k];
            centre[k] += m * X[k];
            angular[k] += m * (X[i] * V[j] - X[j] * V[i] + spin[k]);
            size += X[k] * X[k];
        }
        scale_linear += m * sqrt(square);
        scale_angular += m * sqrt(square * size);
    }
    brunt_audit a = {.mass = (double)total_mass,
                     .kinetic = (double)kinetic,
                     .scale_linear = (double)scale_linear,
                     .scale_angular = (double)scale_angular};
    for (int k = 0; k < 3; k++) {
        a.linear[k] = (double)linear[k];
        a.angular[k] = (double)angular[k];
        a.centre[k] = total_mass > 0 ? (double)(centre[k] / total_mass) : 0;
    }
    return a;
}
