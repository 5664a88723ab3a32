#include "mpm/transfer.h"

#include <math.h>
#include <string.h>

#include "base/simd.h"
#include "grid/bspline.h"
#include "mpm/node_window.h"

// ------------------------------------------------------------------------------------------ shared by all instances

#define SYMMETRIC_INDEX(dim, r, c) ((r) == (c) ? (r) : (dim) == 2 ? 3 : (r) + (c) == 1 ? 3 : (r) + (c) == 3 ? 4 : 5)

typedef struct scatter_arrays {
    const real *x[3], *v[3], *C[9], *tau[6], *F[9], *mass, *volume;
    const uint8_t *bin;
    const real *all[32];
    int count; // for the prefetches
} scatter_arrays;

static void scatter_arrays_of(brunt_body *body, scatter_arrays *f) {
    brunt_particles *p = &body->particles;
    f->count = 0;
#define TAKE(to, field, n)                                                                                             \
    for (int c = 0; c < (n); c++) f->all[f->count++] = (to)[c] = brunt_field(p, BRUNT_FIELD_##field)[c]
    for (int a = 0; a < p->dim; a++) f->all[f->count++] = f->x[a] = brunt_kernel_place(p)[a];
    if (brunt_total_lagrangian(p)) TAKE(f->F, deformation_gradient, BRUNT_MATRIX(p->dim));
    TAKE(f->v, velocity, p->dim);
    TAKE(f->C, affine, p->field[BRUNT_FIELD_affine].components);
    TAKE(f->tau, kirchhoff_stress, BRUNT_SYMMETRIC(p->dim)); // of rings, those that are not zero
    TAKE(&f->mass, mass, 1);
    TAKE(&f->volume, reference_volume, 1);
#undef TAKE
    f->bin = p->bin;
}

// Bins ahead of the hardware's own prefetching, which follows fewer streams than there are arrays.
BRUNT_INLINE void prefetch_scatter(const scatter_arrays *f, int64_t s) {
    for (int k = 0; k < f->count; k++) __builtin_prefetch(f->all[k] + s + 6 * BRUNT_LANES, 0, 2);
}

// Of total-Lagrangian bodies: the inverse of a matrix with rows one after the other.
BRUNT_INLINE void inverse_matrix(int dim, const lanes *F, lanes *inverse) {
    if (dim == 2) {
        const lanes over = 1 / (F[0] * F[3] - F[1] * F[2]);
        inverse[0] = over * F[3], inverse[1] = -over * F[1], inverse[2] = -over * F[2], inverse[3] = over * F[0];
        return;
    }
    lanes cofactor[9];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            cofactor[3 * r + c] = F[3 * r1 + c1] * F[3 * r2 + c2] - F[3 * r1 + c2] * F[3 * r2 + c1];
        }
    const lanes over = 1 / (F[0] * cofactor[0] + F[1] * cofactor[1] + F[2] * cofactor[2]);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) inverse[3 * r + c] = over * cofactor[3 * c + r];
}

// Bound of the square of the greatest 1 / principal stretch of the particles at s: Gershgorin's circles of F^-T F^-1,
// exact along the axes.
BRUNT_INLINE lanes inverse_stretch(int dim, real *const *F, int64_t s) {
    lanes A[9], inverse[9], bound = (lanes){0};
    for (int c = 0; c < dim * dim; c++) A[c] = lanes_load(F[c] + s);
    inverse_matrix(dim, A, inverse);
    for (int r = 0; r < dim; r++) {
        lanes row = (lanes){0};
        for (int c = 0; c < dim; c++) {
            lanes product = (lanes){0};
            for (int k = 0; k < dim; k++) product += inverse[r * dim + k] * inverse[c * dim + k];
            row += c == r ? product : lanes_abs(product);
        }
        bound = lanes_max(bound, row);
    }
    return bound;
}

// What the stress at the end of the step does over the block's particles [W]. The rate it works on is that of the
// motion as it stands at the end, Fdot F^-1 = L (I + dt L)^-1 = L - dt L L + O(dt^2).
static double stress_power(brunt_body *body, const brunt_block *block, real dt, real *const *gradient) {
    brunt_particles *p = &body->particles; // of rings the part in the plane: its components have the same places
    const int dim = p->dim;
    real *const *tau = brunt_field(p, BRUNT_FIELD_kirchhoff_stress);
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    lanes sum = (lanes){0};
    for (int64_t i = 0; i < block->count; i += BRUNT_LANES) {
        int64_t s = block->first + i;
        lanes power = (lanes){0}, L[9];
        for (int c = 0; c < dim * dim; c++) L[c] = lanes_load(gradient[c] + i);
        for (int r = 0; r < dim; r++)
            for (int c = 0; c < dim; c++) {
                lanes rate = L[r * dim + c];
                for (int k = 0; k < dim; k++) rate -= dt * L[r * dim + k] * L[k * dim + c];
                power += lanes_load(tau[SYMMETRIC_INDEX(dim, r, c)] + s) * rate;
            }
        sum += lanes_load(volume + s) * power;
    }
    return (double)lanes_sum(sum);
}

// What the hoop stress of rings does, likewise [W].
static double hoop_power(brunt_body *body, const brunt_block *block, real dt, const real *hoop) {
    const real *tau = brunt_field(&body->particles, BRUNT_FIELD_kirchhoff_stress)[2];
    const real *volume = brunt_field(&body->particles, BRUNT_FIELD_reference_volume)[0];
    lanes sum = (lanes){0};
    for (int64_t i = 0; i < block->count; i += BRUNT_LANES) {
        int64_t s = block->first + i;
        const lanes rate = lanes_load(hoop + i);
        sum += lanes_load(volume + s) * lanes_load(tau + s) * (rate - dt * rate * rate);
    }
    return (double)lanes_sum(sum);
}

// The nine components of a ring's velocity gradient.
static void ring_rates(const brunt_workspace *work, int32_t padded, real *rates[9]) {
    real *zero = work->out[BRUNT_OUT_ZERO];
    memset(zero, 0, (size_t)padded * sizeof *zero);
    for (int c = 0; c < 9; c++) rates[c] = zero;
    rates[0] = work->out[2], rates[1] = work->out[3], rates[3] = work->out[4], rates[4] = work->out[5];
    rates[8] = work->out[BRUNT_OUT_HOOP];
}

static void update_material(brunt_body *body, const brunt_block *block, real dt, brunt_workspace *work,
                            real *const *gradient, brunt_block_report *report) {
    int32_t padded = (block->count + BRUNT_LANES - 1) / BRUNT_LANES * BRUNT_LANES;
    brunt_material_points points[BRUNT_COMPONENTS];
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        points[k] = brunt_body_points(body, (brunt_component)k, block->first, padded);
        points[k].dt = dt;
        for (int c = 0; c < BRUNT_MATRIX(points[k].dim); c++) points[k].L[c] = gradient[c];
    }
    brunt_update_result result =
        brunt_material_update(&body->material, points, work->plastic, work->viscous, work->strain);
    if (result.bad >= 0) {
        report->bad = (int32_t)block->first + result.bad;
        report->reason = result.reason;
    }
    report->wave_speed = result.wave_speed;
    report->failed = result.failed;
}

// ------------------------------------------------------------------------------------------ instances

#define DIM 2
#define ORDER 1
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 1
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 1
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 1
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 2
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 2
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 3
#define AFFINE 0
#define AXIS 0
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 3
#define AFFINE 1
#define AXIS 0
#include "mpm/p2g.inc"

#define DIM 2
#define ORDER 1
#define TRANSFER 0
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 0
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 1
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 1
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 2
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 2
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 0
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 0
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 1
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 1
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 2
#define STAGE 1
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 1
#define TRANSFER 2
#define STAGE 2
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#include "mpm/g2p.inc"

// Rings: their gathers use the bins of plane strain above.
#define DIM 2
#define ORDER 1
#define AFFINE 0
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 1
#define AFFINE 1
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 0
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 1
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 0
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 1
#define AXIS 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 0
#define STAGE 1
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 0
#define STAGE 2
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 1
#define STAGE 1
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 1
#define STAGE 2
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 2
#define STAGE 1
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 1
#define TRANSFER 2
#define STAGE 2
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 1
#include "mpm/g2p.inc"

// Total-Lagrangian bodies: their gathers use the bins above.
#define DIM 2
#define ORDER 2
#define AFFINE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define AFFINE 1
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define AFFINE 1
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 2
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define AFFINE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 2
#define AFFINE 1
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 2
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define AFFINE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 3
#define AFFINE 1
#define AXIS 0
#define TOTAL 1
#include "mpm/p2g.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 0
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 1
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"
#define DIM 3
#define ORDER 3
#define TRANSFER 2
#define STAGE 0
#define AXIS 0
#define TOTAL 1
#include "mpm/g2p.inc"

#define SCATTERS(d, axis)                                                                                              \
    {                                                                                                                  \
        {scatter_##d##_1_0_##axis, scatter_##d##_1_1_##axis}, {scatter_##d##_2_0_##axis, scatter_##d##_2_1_##axis}, {  \
            scatter_##d##_3_0_##axis, scatter_##d##_3_1_##axis                                                         \
        }                                                                                                              \
    }
#define GATHERS(name)                                                                                                  \
    {                                                                                                                  \
        {name##_1_0_2, name##_1_1_2, name##_1_2_2}, {name##_2_0_0, name##_2_1_0, name##_2_2_0}, {                      \
            name##_3_0_0, name##_3_1_0, name##_3_2_0                                                                   \
        }                                                                                                              \
    }

// Plane strain, space, rings.
static int table_row(int dim, bool axisymmetric) { return axisymmetric ? 2 : dim - 2; }

brunt_p2g_fn *brunt_find_scatter(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_p2g_fn *const table[3][3][2] = {SCATTERS(2, 0), SCATTERS(3, 0), SCATTERS(2, 1)};
    return table[table_row(dim, axisymmetric)][kernel - 1][transfer == BRUNT_APIC];
}

brunt_g2p_fn *brunt_find_gather(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_g2p_fn *const table[3][3][3] = {GATHERS(gather_2), GATHERS(gather_3), GATHERS(gather_axis_2)};
    return table[table_row(dim, axisymmetric)][kernel - 1][transfer];
}

brunt_p2g_fn *brunt_find_total_scatter(int dim, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_p2g_fn *const table[2][3][2] = {
        {{NULL}, {scatter_total_2_2_0_0, scatter_total_2_2_1_0}, {scatter_total_2_3_0_0, scatter_total_2_3_1_0}},
        {{NULL}, {scatter_total_3_2_0_0, scatter_total_3_2_1_0}, {scatter_total_3_3_0_0, scatter_total_3_3_1_0}}};
    return table[dim - 2][kernel - 1][transfer == BRUNT_APIC];
}

brunt_g2p_fn *brunt_find_total_gather(int dim, brunt_kernel kernel, brunt_transfer transfer) {
#define TOTALS(d, order)                                                                                               \
    { gather_total_##d##_##order##_0_0, gather_total_##d##_##order##_1_0, gather_total_##d##_##order##_2_0 }
    static brunt_g2p_fn *const table[2][3][3] = {{{NULL}, TOTALS(2, 2), TOTALS(2, 3)},
                                                 {{NULL}, TOTALS(3, 2), TOTALS(3, 3)}};
#undef TOTALS
    return table[dim - 2][kernel - 1][transfer];
}

brunt_g2p_fn *brunt_find_advance(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_g2p_fn *const table[3][3] = {{gather_2_1_0_1, gather_2_1_1_1, gather_2_1_2_1},
                                              {gather_3_1_0_1, gather_3_1_1_1, gather_3_1_2_1},
                                              {gather_axis_2_1_0_1, gather_axis_2_1_1_1, gather_axis_2_1_2_1}};
    return kernel == BRUNT_LINEAR ? table[table_row(dim, axisymmetric)][transfer] : NULL;
}
