// Compressible neo-Hookean solid (Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, section
// 6.4):
//   psi = mu/2 (tr b - 3) - mu ln J + lambda/2 (ln J)^2,   tau = mu (b - I) + lambda ln(J) I.
#include "elastic.h"

BRUNT_INLINE brunt_update_result update_dim(int dim, const real *k, const brunt_points *points) {
    update_record record = update_begin();
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU];
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9], B[6], tau[6];
        load_displacement_gradient(dim, points, i, H);
        lanes change = volume_change(dim, H);
        note_deformation(&record, 1 + change, i);
        finger_strain(dim, H, B);
        lanes log_J = lanes_log1p(change), pressure = lambda * log_J;
        tau[XX] = mu * B[XX] + pressure;
        tau[YY] = mu * B[YY] + pressure;
        tau[ZZ] = dim == 3 ? mu * B[ZZ] + pressure : pressure;
        tau[XY] = mu * B[XY];
        if (dim == 3) {
            tau[YZ] = mu * B[YZ];
            tau[XZ] = mu * B[XZ];
        }
        store_stress(dim, points, i, tau);
        // Along n: rho0 c^2 = lambda (1 - ln J) + mu (1 + b_nn) for the longitudinal wave, mu b_nn for the transverse
        // one.
        lanes stretch = stretch_squared_bound(dim, B);
        lanes modulus = lanes_max(lambda - pressure + mu, lanes_set(0)) + mu * stretch;
        note_speed(&record, k[ELASTIC_INVERSE_DENSITY] * modulus);
    }
    return update_end(&record, points, NULL);
}

BRUNT_INLINE void energy_dim(int dim, const real *k, const brunt_points *points, brunt_point_energy *energy) {
    lane_total stored = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9], B[6];
        load_displacement_gradient(dim, points, i, H);
        finger_strain(dim, H, B);
        lanes log_J = lanes_log1p(volume_change(dim, H));
        lanes density = k[ELASTIC_MU] * ((real)0.5 * plane_trace(dim, B) - log_J) +
                        (real)0.5 * k[ELASTIC_LAMBDA] * log_J * log_J;
        total_add(&stored, lanes_load(points->volume + i) * density);
    }
    energy->internal += total_end(&stored);
}

static brunt_update_result update(const real *constants, const brunt_points *points) {
    return points->dim == 2 ? update_dim(2, constants, points) : update_dim(3, constants, points);
}

static void add_energy(const real *constants, const brunt_points *points, brunt_point_energy *energy) {
    if (points->dim == 2) energy_dim(2, constants, points, energy);
    else energy_dim(3, constants, points, energy);
}

const brunt_model brunt_neo_hookean = {
    .name = "neo-hookean",
    .doc = "compressible neo-Hookean solid with ln J volumetric term (Bonet and Wood): large elastic strains",
    .parameters = elastic_parameters,
    .parameter_count = COUNT_OF(elastic_parameters),
    .prepare = elastic_prepare,
    .update = update,
    .energy = add_energy,
    .wave_speed = elastic_wave_speed,
};
