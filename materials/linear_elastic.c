// Linear elasticity with small strain: eps = sym(F) - I, sigma = lambda tr(eps) I + 2 mu eps.
//
// Not invariant under rotation, by definition: a rigid turn by theta strains it by 1 - cos(theta). It is here for the
// closed forms of the linear theory (vibration, Hertz); use st-venant-kirchhoff for the same law with finite rotation.
//
// The stored energy V0 (lambda/2 tr(eps)^2 + mu eps:eps) has the first Piola-Kirchhoff stress P = sigma(eps), and the
// stress power under F' = L F is P : L F = (P F^T) : L. So the Kirchhoff stress of this energy is P F^T = sigma + sigma
// H^T, not sigma: with sigma alone the ledger would miss work of first order in the strain. Its skew part, of second
// order, is what a model that is not objective does to angular momentum; it is left out, so the stress is symmetric and
// the power is exact for every motion whose velocity gradient is symmetric.
//
// A membrane is seen from a frame that turns with it, where the small strain is Biot's, e_i = l_i - 1: in plane stress
// W = E'/2 (e1^2 + e2^2 + 2 nu e1 e2) with E' = E / (1 - nu^2). That is invariant under rotation, and tau_i = l_i
// dW/de_i.
#include "materials/plane_stress.h"
#include "materials/trial.h"

BRUNT_INLINE void small_strain(int dim, const lanes H[9], lanes eps[6]) {
    const real half = (real)0.5;
    eps[XX] = H[0];
    eps[YY] = H[dim + 1];
    if (dim == 2) {
        eps[XY] = half * (H[1] + H[2]);
        return;
    }
    eps[ZZ] = H[8];
    eps[XY] = half * (H[1] + H[3]);
    eps[YZ] = half * (H[5] + H[7]);
    eps[XZ] = half * (H[2] + H[6]);
}

BRUNT_INLINE lanes law(int dim, const real *k, const lanes H[9], lanes change, const lanes B[6], lanes tau[6]) {
    (void)change;
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU], half = (real)0.5;
    lanes eps[6], sigma[6];
    small_strain(dim, H, eps);
    lanes pressure = lambda * plane_trace(dim, eps);
    sigma[XX] = pressure + 2 * mu * eps[XX];
    sigma[YY] = pressure + 2 * mu * eps[YY];
    sigma[XY] = 2 * mu * eps[XY];
    if (dim == 2) {
        tau[XX] = sigma[XX] + (sigma[XX] * H[0] + sigma[XY] * H[1]);
        tau[YY] = sigma[YY] + (sigma[XY] * H[2] + sigma[YY] * H[3]);
        tau[ZZ] = pressure;
        tau[XY] = sigma[XY] + half * ((sigma[XX] * H[2] + sigma[XY] * H[3]) + (sigma[XY] * H[0] + sigma[YY] * H[1]));
    } else {
        sigma[ZZ] = pressure + 2 * mu * eps[ZZ];
        sigma[YZ] = 2 * mu * eps[YZ];
        sigma[XZ] = 2 * mu * eps[XZ];
        // rows of sigma times rows of H
        const lanes *x = H, *y = H + 3, *z = H + 6;
        lanes sx[3] = {sigma[XX], sigma[XY], sigma[XZ]}, sy[3] = {sigma[XY], sigma[YY], sigma[YZ]},
              sz[3] = {sigma[XZ], sigma[YZ], sigma[ZZ]};
        tau[XX] = sigma[XX] + (sx[0] * x[0] + sx[1] * x[1] + sx[2] * x[2]);
        tau[YY] = sigma[YY] + (sy[0] * y[0] + sy[1] * y[1] + sy[2] * y[2]);
        tau[ZZ] = sigma[ZZ] + (sz[0] * z[0] + sz[1] * z[1] + sz[2] * z[2]);
        tau[XY] = sigma[XY] +
                  half * ((sx[0] * y[0] + sx[1] * y[1] + sx[2] * y[2]) + (sy[0] * x[0] + sy[1] * x[1] + sy[2] * x[2]));
        tau[YZ] = sigma[YZ] +
                  half * ((sy[0] * z[0] + sy[1] * z[1] + sy[2] * z[2]) + (sz[0] * y[0] + sz[1] * y[1] + sz[2] * y[2]));
        tau[XZ] = sigma[XZ] +
                  half * ((sx[0] * z[0] + sx[1] * z[1] + sx[2] * z[2]) + (sz[0] * x[0] + sz[1] * x[1] + sz[2] * x[2]));
    }
    // Per reference length the speed is constant; a length now is stretched.
    return (lambda + 2 * mu) * k[ELASTIC_INVERSE_DENSITY] * stretch_squared_bound(dim, B);
}

BRUNT_INLINE lanes density_of(int dim, const real *k, const lanes H[9]) {
    lanes eps[6];
    eps[ZZ] = lanes_set(0);
    small_strain(dim, H, eps);
    lanes trace = plane_trace(dim, eps);
    return (real)0.5 * k[ELASTIC_LAMBDA] * trace * trace + k[ELASTIC_MU] * contraction(dim, eps);
}

ELASTIC_FUNCTIONS(law, density_of)

BRUNT_INLINE void plane_stress_response_of(const real *k, bool tension_only, const lanes strain[2],
                                           plane_stress_response *r) {
    const real nu = k[ELASTIC_NU], mu = k[ELASTIC_MU], plane = k[ELASTIC_PLANE], half = (real)0.5;
    lanes e[2] = {strain[0], strain[1]};
    if (tension_only) r->taut = relax_linear(nu, e);
    lanes biot[2] = {plane * (e[0] + nu * e[1]), plane * (e[1] + nu * e[0])}; // dW/de_i
    lanes l[2] = {1 + e[0], 1 + e[1]};
    for (int i = 0; i < 2; i++) {
        r->tau[i] = l[i] * biot[i];
        r->along[i] = plane * (l[i] * l[i]);
    }
    r->cross = plane * nu * (l[0] * l[1]);
    r->energy = half * (e[0] * biot[0] + e[1] * biot[1]);
    r->thickness = 1 - nu / (1 - nu) * (e[0] + e[1]);
    r->shear = mu + half * (biot[0] + biot[1]) / (l[0] + l[1]);
}

PLANE_STRESS_FUNCTIONS(plane_stress_response_of)

// --------------------------------------------------------------------------------- implicit steps

// tau = P F^T as it is, with its skew part. P is linear in F: with A_iAjB its slopes,
//   a_iajb = A_iAjB F_aA F_bB = lambda F_ai F_bj + mu (delta_ij b_ab + F_bi F_aj).
BRUNT_INLINE void respond_dim(int dim, const real *k, const brunt_trial_points *trial) {
    static const int place[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};
    const real lambda = k[ELASTIC_LAMBDA], mu = k[ELASTIC_MU];
    for (int32_t i = 0; i < trial->count; i += BRUNT_LANES) {
        lanes H[9], F[9], eps[6];
        load_trial_gradient(dim, trial->F, i, H);
        for (int c = 0; c < dim * dim; c++) F[c] = H[c] + (real)(c % (dim + 1) == 0);
        eps[ZZ] = lanes_set(0);
        small_strain(dim, H, eps);
        lanes trace = plane_trace(dim, eps);
        if (trial->density)
            put_density(trial, i, 1 + volume_change(dim, H),
                        (real)0.5 * lambda * trace * trace + mu * contraction(dim, eps), false);
        for (int r = 0; r < dim && trial->stress[0]; r++)
            for (int a = 0; a < dim; a++) {
                lanes tau = lambda * trace * F[a * dim + r];
                for (int c = 0; c < dim; c++) tau += 2 * mu * eps[place[r][c]] * F[a * dim + c];
                lanes_store(trial->stress[r * dim + a] + i, tau);
            }
        for (int m = 0; m < dim * dim && trial->tangent[0]; m++)
            for (int n = m; n < dim * dim; n++) {
                const int r = m / dim, a = m % dim, s = n / dim, b = n % dim;
                lanes sum = lambda * F[a * dim + r] * F[b * dim + s] + mu * F[b * dim + r] * F[a * dim + s];
                for (int c = 0; c < dim && r == s; c++) sum += mu * F[a * dim + c] * F[b * dim + c];
                lanes_store(trial->tangent[tangent_place(dim, m, n)] + i, sum);
            }
    }
}

TRIAL_RESPOND

PLANE_STRESS_RESPOND(plane_stress_response_of)

static const brunt_model_potential potential = {.respond = respond, .respond_membrane = respond_membrane};

const brunt_model brunt_linear_elastic = {
    .name = "linear-elastic",
    .doc = "Hooke's law with small strain: for small rotations only",
    .small_strain = true,
    ELASTIC_MODEL,
    .potential = &potential,
    .flops = {51, 151, 46},
    PLANE_STRESS_MODEL,
};
