#include "mpm/points_update.h"

#include <string.h>

#include "base/simd.h"
#include "mpm/tensors.h"

// What the stress at the end of the step does over the block's particles [W]. The rate it works on is that of the
// motion as it stands at the end, Fdot F^-1 = L (I + dt L)^-1 = L - dt L L + O(dt^2).
BRUNT_INLINE double plane_power_of(int dim, brunt_body *body, const brunt_block *block, real dt,
                                   real *const *gradient) {
    brunt_particles *p = &body->particles; // of rings the part in the plane: its components have the same places
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

static double plane_power(brunt_body *body, const brunt_block *block, real dt, real *const *gradient) {
    return body->particles.dim == 3 ? plane_power_of(3, body, block, dt, gradient)
                                    : plane_power_of(2, body, block, dt, gradient);
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

double brunt_stress_power(brunt_body *body, const brunt_block *block, real dt, real *const *gradient,
                          const real *hoop) {
    const double power = plane_power(body, block, dt, gradient);
    return hoop ? power + hoop_power(body, block, dt, hoop) : power;
}

void brunt_hoop_rates(const brunt_workspace *work, int32_t padded, real *rates[9]) {
    real *zero = work->out[BRUNT_OUT_ZERO];
    memset(zero, 0, (size_t)padded * sizeof *zero);
    for (int c = 0; c < 9; c++) rates[c] = zero;
    rates[0] = work->out[2], rates[1] = work->out[3], rates[3] = work->out[4], rates[4] = work->out[5];
    rates[8] = work->out[BRUNT_OUT_HOOP];
}

void brunt_update_points(brunt_body *body, const brunt_block *block, real dt, brunt_workspace *work,
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