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
#include "materials/trial.h"

// tau; gives lambda tr E.
BRUNT_INLINE lanes stress_of(int dim, const real *k, const lanes B[6], lanes tau[6]) {
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU];
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
    return pressure;
}

BRUNT_INLINE lanes law(int dim, const real *k, const lanes H[9], lanes change, const lanes B[6], lanes tau[6]) {
    (void)H, (void)change;
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU];
    lanes pressure = stress_of(dim, k, B, tau);
    // rho0 c^2 = (lambda + 2 mu) b_nn^2 + tau_nn along n; tension is kept, compression (which slows the wave) is not.
    lanes stretch = stretch_squared_bound(dim, B), zero = lanes_set(0);
    lanes tension = lanes_max(pressure, zero) * stretch + mu * stretch * lanes_max(stretch - 1, zero);
    return k[ELASTIC_INVERSE_DENSITY] * ((lambda + 2 * mu) * stretch * stretch + tension);
}

BRUNT_INLINE lanes density_of(int dim, const real *k, const lanes H[9]) {
    lanes B[6];
    B[ZZ] = lanes_set(0);
    finger_strain(dim, H, B);
    lanes trace = (real)0.5 * plane_trace(dim, B);
    lanes density = (real)0.5 * k[ELASTIC_LAMBDA] * trace * trace;
    density += (real)0.25 * k[ELASTIC_MU] * contraction(dim, B);
    return density;
}

ELASTIC_FUNCTIONS(law, density_of)

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
    r->cross = plane * nu * (square[0] * square[1]);
    r->energy = half * (E[0] * S[0] + E[1] * S[1]);
    r->thickness = lanes_sqrt(1 - 2 * (nu / (1 - nu)) * (E[0] + E[1]));
    r->shear = half * ((S[0] + S[1]) + mu * (square[0] + square[1]));
}

PLANE_STRESS_FUNCTIONS(plane_stress_response_of)

// --------------------------------------------------------------------------------- implicit steps

// a(G, G) = lambda (b : G)^2 + tau : G^T G + mu (tr(G b G b) + G b : b G)
BRUNT_INLINE void tangent_at(int dim, const real *k, const lanes B[6], const lanes tau[6], lanes a[45]) {
    static const int place[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};
    lanes b[3][3];
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) b[r][c] = B[place[r][c]] + (real)(r == c);
    clear_tangent(dim, a);
    add_geometric(dim, tau, a);
    for (int m = 0; m < dim * dim; m++)
        for (int n = m; n < dim * dim; n++) {
            const int r = m / dim, p = m % dim, s = n / dim, q = n % dim;
            a[tangent_place(dim, m, n)] +=
                k[ELASTIC_LAMBDA] * b[r][p] * b[s][q] + k[ELASTIC_MU] * (b[r][s] * b[p][q] + b[r][q] * b[p][s]);
        }
}

BRUNT_INLINE void respond_dim(int dim, const real *k, const brunt_trial_points *trial) {
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU];
    for (int32_t i = 0; i < trial->count; i += BRUNT_LANES) {
        lanes H[9], B[6], tau[6], a[45];
        load_trial_gradient(dim, trial->F, i, H);
        B[ZZ] = lanes_set(0);
        finger_strain(dim, H, B);
        lanes trace = (real)0.5 * plane_trace(dim, B);
        if (trial->density)
            put_density(trial, i, 1 + volume_change(dim, H),
                        (real)0.5 * lambda * trace * trace + (real)0.25 * mu * contraction(dim, B), false);
        if (!trial->stress[0] && !trial->tangent[0]) continue;
        stress_of(dim, k, B, tau);
        if (trial->stress[0]) put_stress(dim, trial, i, tau);
        if (!trial->tangent[0]) continue;
        tangent_at(dim, k, B, tau, a);
        put_tangent(dim, trial, i, a, false);
    }
}

TRIAL_RESPOND

PLANE_STRESS_RESPOND(plane_stress_response_of)

static const brunt_model_potential potential = {.respond = respond, .respond_membrane = respond_membrane};

const brunt_model brunt_st_venant_kirchhoff = {
    .name = "st-venant-kirchhoff",
    .doc = "Hooke's law for Green's strain: large rotations, moderate strains",
    ELASTIC_MODEL,
    .potential = &potential,
    .flops = {54, 136, 59},
    PLANE_STRESS_MODEL,
};
