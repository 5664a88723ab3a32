// St Venant-Kirchhoff: S = lambda tr(E) I + 2 mu E with Green's strain E = (F^T F - I) / 2; Hooke's law for finite
// rotations.
//
// Seen from the current configuration, tau = F S F^T = lambda tr(E) b + mu (b^2 - b); with B = b - I: tr E = tr B / 2,
// b^2 - b = B + B^2, tr E^2 = tr B^2 / 4, so F^T F is never formed. The law softens in strong compression (its stress
// vanishes again as J -> 0): it is for large rotations, not for large strains.
//
// In plane stress W = E'/2 (E1^2 + E2^2 + 2 nu E1 E2) with E' = E / (1 - nu^2) and the principal Green strains of the
// plane, tau_i = l_i^2 S_i.
#include "materials/plane_stress.h"

BRUNT_INLINE brunt_update_result update_dim(int dim, const real *k, const brunt_material_points *points) {
    update_record record = update_begin();
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU];
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9], B[6], tau[6];
        load_displacement_gradient(dim, points, i, H);
        note_deformation(&record, 1 + volume_change(dim, H), i);
        finger_strain(dim, H, B);
        lanes pressure = (real)0.5 * lambda * plane_trace(dim, B), scale = pressure + mu;
        if (dim == 2) {
            tau[XX] = pressure + scale * B[XX] + mu * (B[XX] * B[XX] + B[XY] * B[XY]);
            tau[YY] = pressure + scale * B[YY] + mu * (B[XY] * B[XY] + B[YY] * B[YY]);
            tau[ZZ] = pressure;
            tau[XY] = scale * B[XY] + mu * (B[XY] * (B[XX] + B[YY]));
        } else {
            tau[XX] = pressure + scale * B[XX] + mu * (B[XX] * B[XX] + B[XY] * B[XY] + B[XZ] * B[XZ]);
            tau[YY] = pressure + scale * B[YY] + mu * (B[XY] * B[XY] + B[YY] * B[YY] + B[YZ] * B[YZ]);
            tau[ZZ] = pressure + scale * B[ZZ] + mu * (B[XZ] * B[XZ] + B[YZ] * B[YZ] + B[ZZ] * B[ZZ]);
            tau[XY] = scale * B[XY] + mu * (B[XY] * (B[XX] + B[YY]) + B[XZ] * B[YZ]);
            tau[YZ] = scale * B[YZ] + mu * (B[YZ] * (B[YY] + B[ZZ]) + B[XY] * B[XZ]);
            tau[XZ] = scale * B[XZ] + mu * (B[XZ] * (B[XX] + B[ZZ]) + B[XY] * B[YZ]);
        }
        store_stress(dim, points, i, tau);
        // rho0 c^2 = (lambda + 2 mu) b_nn^2 + tau_nn along n; tension is kept, compression (which slows the wave) is
        // not.
        lanes stretch = stretch_squared_bound(dim, B), zero = lanes_set(0);
        lanes tension = lanes_max(pressure, zero) * stretch + mu * stretch * lanes_max(stretch - 1, zero);
        note_speed(&record, k[ELASTIC_INVERSE_DENSITY] * ((lambda + 2 * mu) * stretch * stretch + tension));
    }
    return update_end(&record, points, NULL);
}

BRUNT_INLINE void energy_dim(int dim, const real *k, const brunt_material_points *points, brunt_point_energy *energy) {
    lane_total stored = {0};
    for (int32_t i = 0; i < points->count; i += BRUNT_LANES) {
        lanes H[9], B[6];
        load_displacement_gradient(dim, points, i, H);
        B[ZZ] = lanes_set(0);
        finger_strain(dim, H, B);
        lanes trace = (real)0.5 * plane_trace(dim, B);
        lanes density = (real)0.5 * k[ELASTIC_LAMBDA] * trace * trace;
        density += (real)0.25 * k[ELASTIC_MU] * contraction(dim, B);
        total_add(&stored, lanes_load(points->volume + i) * density);
    }
    energy->internal += total_end(&stored);
}

static brunt_update_result update(const real *constants, const brunt_material_points *points) {
    return points->dim == 2 ? update_dim(2, constants, points) : update_dim(3, constants, points);
}

static void add_energy(const real *constants, const brunt_material_points *points, brunt_point_energy *energy) {
    if (points->dim == 2)
        energy_dim(2, constants, points, energy);
    else
        energy_dim(3, constants, points, energy);
}

BRUNT_INLINE void plane_stress_response_of(const real *k, bool tension_only, const lanes e[2],
                                           plane_stress_response *r) {
    const real nu = k[ELASTIC_NU], mu = k[ELASTIC_MU], plane = k[ELASTIC_PLANE], half = (real)0.5;
    lanes E[2] = {e[0] + half * (e[0] * e[0]), e[1] + half * (e[1] * e[1])};
    if (tension_only) r->taut = relax_linear(nu, E);
    lanes S[2] = {plane * (E[0] + nu * E[1]), plane * (E[1] + nu * E[0])};
    lanes square[2] = {1 + 2 * E[0], 1 + 2 * E[1]}; // l_i^2
    for (int i = 0; i < 2; i++) {
        r->tau[i] = square[i] * S[i];
        r->along[i] = r->tau[i] + plane * (square[i] * square[i]);
    }
    r->energy = half * (E[0] * S[0] + E[1] * S[1]);
    r->thickness = lanes_sqrt(1 - 2 * (nu / (1 - nu)) * (E[0] + E[1]));
    r->shear = half * ((S[0] + S[1]) + mu * (square[0] + square[1]));
}

static brunt_update_result update_plane_stress(const real *constants, const brunt_material_points *points) {
    return points->tension_only ? plane_stress_update(plane_stress_response_of, true, constants, points)
                                : plane_stress_update(plane_stress_response_of, false, constants, points);
}

static void add_energy_plane_stress(const real *constants, const brunt_material_points *points,
                                    brunt_point_energy *energy) {
    if (points->tension_only)
        plane_stress_energy(plane_stress_response_of, true, constants, points, energy);
    else
        plane_stress_energy(plane_stress_response_of, false, constants, points, energy);
}

const brunt_model brunt_st_venant_kirchhoff = {
    .name = "st-venant-kirchhoff",
    .doc = "Hooke's law for Green's strain: large rotations, moderate strains",
    .parameters = elastic_parameters,
    .parameter_count = COUNT_OF(elastic_parameters),
    .prepare = elastic_prepare,
    .flops = {54, 136, 59},
    .update = update,
    .energy = add_energy,
    .wave_speed = elastic_wave_speed,
    .update_plane_stress = update_plane_stress,
    .energy_plane_stress = add_energy_plane_stress,
    .wave_speed_plane_stress = plane_stress_wave_speed,
};
