// Particles that are to leave a body that erodes, or have left it and stay as mass: while a step updates them, their
// deformation gradient stands still. (What leaves is found out at the end of the step,
// engine/account/erosion_points.c.)
#include "mpm/mpm_body.h"
#include "base/simd.h"
#include "mpm/transfer.h"

// det(I + dt L), the factor of J, that counts as turned inside out: rounding may take the product below 0 from there.
#ifdef BRUNT_FLOAT
static const real LEAST_FACTOR = 1e-3f;
#else
static const real LEAST_FACTOR = 1e-7;
#endif

static lanes determinant(int dim, const lanes A[9]) {
    if (dim == 2) return A[0] * A[3] - A[1] * A[2];
    return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) + A[2] * (A[3] * A[7] - A[4] * A[6]);
}

// The factor of J in the plane, or in space; the gradient of tile `i` with rows one after the other: L, or of
// total-Lagrangian bodies Fdot.
static lanes volume_factor(real *const *gradient, int64_t i, brunt_particles *p, int64_t s, real dt) {
    const bool total = brunt_total_lagrangian(p);
    real *const *F = brunt_field(p, BRUNT_FIELD_deformation_gradient);
    lanes A[9] = {{0}}, old[9] = {{0}};
    for (int c = 0; c < p->dim * p->dim; c++) {
        old[c] = total ? lanes_load(F[c] + s) : lanes_set(c % (p->dim + 1) == 0);
        A[c] = dt * lanes_load(gradient[c] + i) + old[c];
    }
    return total ? determinant(p->dim, A) / determinant(p->dim, old) : determinant(p->dim, A);
}

int32_t brunt_keep_inverted(brunt_body *body, const brunt_block *block, real dt, real *const *gradient,
                            real *hoop_stretch) {
    brunt_particles *p = &body->particles;
    const int dim = p->dim;
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    int32_t turned = 0;
    for (int64_t i = 0; i < block->count; i += BRUNT_LANES) {
        const int64_t s = block->first + i;
        lanes factor = volume_factor(gradient, i, p, s, dt);
        for (int l = 0; l < BRUNT_LANES; l++) {
            const bool freed = volume[s + l] == 0, inside_out = !freed && factor[l] < LEAST_FACTOR;
            p->order[s + l] = inside_out && body->erodes_inverted ? BRUNT_LEAVES_INVERTED : BRUNT_STAYS;
            if (p->order[s + l] == BRUNT_STAYS && !freed) continue;
            turned += !freed;
            for (int c = 0; c < dim * dim; c++) gradient[c][i + l] = 0;
        }
        if (brunt_axisymmetric(p))
            lanes_store(hoop_stretch + i, lanes_load(brunt_field(p, BRUNT_FIELD_deformation_gradient)[8] + s));
    }
    return turned;
}

int32_t brunt_keep_inverted_hoops(brunt_body *body, const brunt_block *block, real dt, real *hoop,
                                  const real *hoop_stretch) {
    brunt_particles *p = &body->particles;
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    real *stretch = brunt_field(p, BRUNT_FIELD_deformation_gradient)[8];
    int32_t turned = 0;
    for (int64_t i = 0; i < block->count; i++) {
        const int64_t s = block->first + i;
        const bool freed = volume[s] == 0, marked = p->order[s] != BRUNT_STAYS;
        const bool crossed = !freed && !marked && body->erodes_inverted && 1 + dt * hoop[i] < LEAST_FACTOR;
        if (crossed) p->order[s] = BRUNT_LEAVES_INVERTED, turned++;
        if (freed || marked || crossed) hoop[i] = 0, stretch[s] = hoop_stretch[i];
    }
    return turned;
}

void brunt_still_stress(brunt_body *body, const brunt_block *block) {
    brunt_particles *p = &body->particles;
    const lanes none = (lanes){0};
    const real *volume = brunt_field(p, BRUNT_FIELD_reference_volume)[0];
    real *const *stress = brunt_field(p, BRUNT_FIELD_kirchhoff_stress);
    for (int64_t s = block->first; s < block->first + block->count; s += BRUNT_LANES)
        for (int c = 0; c < BRUNT_SYMMETRIC(p->point_dim); c++)
            lanes_store(stress[c] + s, lanes_select(lanes_load(volume + s) > none, lanes_load(stress[c] + s), none));
}
